//! Textures that are averaged over the footprint of pixels: their means are those of many samples, their noise is less, and near ones are as
//! they were.

use crate::one_by_one::{assert_same_film, lit_as_one_by_one, whitted};
use crate::support::{Compiled, scene};
use lookfrom_scene::Scene;
use lookfrom_scene::image::Image;
use lookfrom_scene::scene::ImageId;
use lookfrom_scene::settings::{ColorMode, Integrator, Layers};
use lookfrom_scene::texture::{Channel, Mapping, MipFilter, TexelFilter, TextureKind, Wrap};

const EWA: MipFilter = MipFilter::Ewa { anisotropy: 8.0 };

/// A picture of coloured tiles, finer than they can be seen far away.
fn tiles() -> Image {
    let texel = |x: u32, y: u32| match (x / 8 + y / 8) % 3 {
        0 => [0.9, 0.8, 0.7],
        1 => [0.1, 0.15, 0.4],
        _ => [0.02, 0.3 + 0.4 * (x % 2) as f32, 0.05],
    };
    let texels = (0..96).flat_map(|y| (0..96).map(move |x| texel(x, y))).collect();
    Image::from_linear("tiles", 96, 96, texels)
}

/// A floor to the horizon under an even sky, and a ball, both of a texture.
fn floor(kind: &TextureKind, samples: u32) -> Scene {
    let mut scene = scene(
        r#"
        [camera]
        lookfrom = [0, 1.5, 5]
        lookat = [0, 0.6, 0]
        fov = 40
        [image]
        width = 64
        height = 48
        filter = "box"
        [render]
        integrator = "path"
        depth = 1
        [[light]]
        type = "environment"
        zenith = 1
        horizon = 1
        nadir = 1
        [textures.pattern]
        type = "checker"
        [materials.pattern]
        type = "diffuse"
        reflectance = "pattern"
        [[mesh]]
        material = "pattern"
        positions = [[-200, 0, 10], [200, 0, 10], [200, 0, -400], [-200, 0, -400]]
        uvs = [[0, 0], [400, 0], [400, 410], [0, 410]]
        triangles = [[0, 1, 2], [0, 2, 3]]
        [[sphere]]
        material = "pattern"
        center = [0.8, 0.6, 0.5]
        radius = 0.5
        "#,
    );
    scene.images = vec![tiles()];
    scene.textures[0].kind = kind.clone();
    scene.render.samples = samples;
    scene
}

fn picture(filter: TexelFilter) -> TextureKind {
    TextureKind::Image {
        image: ImageId(0),
        mapping: Mapping::UV,
        wrap: [Wrap::Repeat; 2],
        filter,
        channel: Channel::Rgb,
        scale: 1.0,
        invert: false,
    }
}

fn mip(filter: MipFilter, footprint: f32) -> TextureKind {
    picture(TexelFilter::Mip { filter, footprint })
}

fn checker(footprint: f32) -> TextureKind {
    let TextureKind::Checker { even, odd, .. } = checkerboard() else { unreachable!() };
    let mapping = Mapping::Uv { scale: [8.0; 2], offset: [0.0; 2] };
    TextureKind::Checker { even, odd, footprint, mapping }
}

fn checkerboard() -> TextureKind {
    scene("[textures]\na = { type = \"checker\" }").textures[0].kind.clone()
}

fn pixels(kind: &TextureKind, samples: u32) -> Vec<[f32; 3]> {
    Compiled::new(floor(kind, samples)).film().picture().pixels
}

/// The mean of all pixels, and the mean square of how much they differ from others.
fn mean(pixels: &[[f32; 3]]) -> [f32; 3] {
    [0, 1, 2].map(|c| pixels.iter().map(|rgb| rgb[c]).sum::<f32>() / pixels.len() as f32)
}

fn error(pixels: &[[f32; 3]], truth: &[[f32; 3]]) -> f32 {
    let square = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).map(|c| (a[c] - b[c]).powi(2)).sum::<f32>();
    pixels.iter().zip(truth).map(square).sum::<f32>() / pixels.len() as f32
}

#[test]
fn they_have_the_same_mean_and_less_noise() {
    for (sharp, filtered) in [
        (picture(TexelFilter::Bilinear), vec![mip(MipFilter::Trilinear, 0.5), mip(EWA, 0.5)]),
        (checker(0.0), vec![checker(0.5)]),
    ] {
        let truth = pixels(&sharp, 256);
        let expected = mean(&truth);
        let noise = error(&pixels(&sharp, 1), &truth);
        for kind in filtered {
            let many = pixels(&kind, 64);
            for (found, expected) in mean(&many).into_iter().zip(expected) {
                assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}: {kind:?}");
            }
            let less = error(&pixels(&kind, 1), &truth);
            assert!(less < 0.5 * noise, "{less} of {noise}: {kind:?}");
        }
    }
}

#[test]
fn near_textures_are_as_they_were() {
    // The camera is so near that a texel is wider than a pixel.
    let near = |kind: &TextureKind| {
        let mut scene = floor(kind, 4);
        scene.textures[0].kind = kind.clone();
        if let TextureKind::Image { mapping, .. } = &mut scene.textures[0].kind {
            *mapping = Mapping::Uv { scale: [0.01; 2], offset: [0.3; 2] };
        }
        scene.shapes.truncate(1);
        scene.camera.as_mut().expect("one").view = lookfrom_scene::camera::View::Look {
            lookfrom: glam::DVec3::new(0.0, 1.5, 1.0),
            lookat: glam::DVec3::new(0.0, 0.0, 0.9),
            up: glam::DVec3::Y,
        };
        Compiled::new(scene).film().picture().pixels
    };
    let expected = near(&picture(TexelFilter::Bilinear));
    for filter in [MipFilter::Bilinear, MipFilter::Trilinear, EWA] {
        let found = near(&mip(filter, 0.5));
        // Frames of shading turn by the derivatives, so that the noise is other noise.
        for (found, expected) in mean(&found).into_iter().zip(mean(&expected)) {
            assert!((found - expected).abs() < 0.002, "{found} {expected} {filter:?}");
        }
    }
}

/// Every filter, and patterns within others.
fn kinds() -> Vec<TextureKind> {
    let filters = [MipFilter::Nearest, MipFilter::Bilinear, MipFilter::Trilinear, EWA];
    let mut kinds: Vec<_> = filters.into_iter().map(|filter| mip(filter, 0.5)).collect();
    kinds.push(checker(0.7));
    let mapping = Mapping::World { texture_from_world: glam::DMat4::from_scale(glam::DVec3::splat(3.0)) };
    let (octaves, roughness, footprint) = (6, 0.5, 0.5);
    kinds.push(TextureKind::Wrinkled { octaves, roughness, footprint, mapping });
    kinds
}

#[test]
fn eight_at_once_are_eight_one_by_one() {
    for kind in kinds() {
        for color in [ColorMode::Rgb, ColorMode::Spectral] {
            let mut scene = floor(&kind, 2);
            scene.render.depth = 3;
            scene.render.color = color;
            (scene.image.layers, scene.image.denoise) = (Layers::Geometry, true);
            assert_same_film(scene.clone(), &format!("{kind:?} {color:?}"));

            scene.render.integrator = Integrator::Whitted;
            scene.render.min_contribution = 0.0;
            lit_as_one_by_one(scene, whitted, &format!("{kind:?} {color:?}"));
        }
    }
}
