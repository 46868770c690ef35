//! Textures, and names of colours.

use glam::{DVec3, Vec3};
use lookfrom_scene::material::{Color, MaterialKind, Scalar};
use lookfrom_scene::texture::{Mapping, MipFilter, TexelFilter, TextureKind};

use super::{kind, read};

#[test]
fn textures_live_where_they_say() {
    let scene = read(
        r#"
[textures.a]
type = "image"
file = "half.png"
encoding = "linear"
multiply = 0.5
space = "planar"
axis_v = [0, 0, 3]
offset = [1, 2]
[textures.b]
type = "dots"
space = "spherical"
translate = [0, 5, 0]
[textures.c]
type = "bilinear"
corners = [0, "a", 1, { type = "windy" }]
[textures.d]
type = "direction_mix"
direction = [0, 0, -4]
[textures.e]
type = "mix"
amount = "f"
[textures.f]
type = "fbm"
roughness = 0.25
[textures.g]
type = "wrinkled"
"#,
    );
    let texture = |name: &str| &scene.textures.iter().find(|texture| texture.name == name).expect("it").kind;
    let TextureKind::Image { image, mapping: Mapping::Planar { axes, offset, .. }, scale, .. } =
        *texture("a")
    else {
        panic!("a picture on a plane")
    };
    assert_eq!(scene.images[image.index()].texel(0)[0], 128.0 / 255.0);
    assert_eq!((axes, offset, scale), ([Vec3::X, 3.0 * Vec3::Z], [1.0, 2.0], 0.5));
    // The pole is above the middle.
    let TextureKind::Dots { mapping: Mapping::Spherical { texture_from_world }, .. } = *texture("b") else {
        panic!("dots on a sphere")
    };
    assert_eq!(texture_from_world.transform_point3(DVec3::new(0.0, 6.0, 0.0)), DVec3::Z);
    assert_eq!(texture_from_world.transform_point3(DVec3::new(0.0, 5.0, -1.0)), DVec3::Y);
    let TextureKind::Bilinear { corners, .. } = *texture("c") else { panic!("bilinear") };
    assert_eq!((corners[0], corners[2]), (Color::BLACK, Color::gray(1.0)));
    assert!(matches!(*texture("d"), TextureKind::DirectionMix { direction: Vec3::NEG_Z, .. }));
    assert!(matches!(*texture("e"), TextureKind::Mix { amount: Scalar::Texture(_), .. }));
    assert!(matches!(*texture("f"), TextureKind::Fbm { octaves: 8, roughness: 0.25, .. }));
    assert!(matches!(*texture("g"), TextureKind::Wrinkled { roughness: 0.5, .. }));
}

#[test]
fn far_textures_are_filtered_as_they_say() {
    let scene = read(
        r#"
[textures.a]
type = "image"
file = "half.png"
[textures.b]
type = "image"
file = "half.png"
filter = "trilinear"
[textures.c]
type = "image"
file = "half.png"
filter = "ewa"
footprint = 0.5
anisotropy = 16
[textures.d]
type = "checker"
footprint = 1
[textures.e]
type = "fbm"
"#,
    );
    let kinds: Vec<_> = scene.textures.iter().map(|texture| texture.kind.clone()).collect();
    let filters: Vec<_> = kinds
        .iter()
        .filter_map(|kind| match kind {
            TextureKind::Image { filter, .. } => Some(*filter),
            _ => None,
        })
        .collect();
    let mip = |filter, footprint| TexelFilter::Mip { filter, footprint };
    let ewa = MipFilter::Ewa { anisotropy: 16.0 };
    assert_eq!(filters, [TexelFilter::Bilinear, mip(MipFilter::Trilinear, 0.25), mip(ewa, 0.5)]);
    assert!(matches!(kinds[3], TextureKind::Checker { footprint: 1.0, .. }));
    assert_eq!(TextureKind::need_footprints(&kinds), [false, true, true, true, false]);
}

#[test]
fn colours_have_names_unless_textures_have_them() {
    let reflectance = |text: &str| {
        let scene = read(&format!(
            "[materials.a]\ntype = \"diffuse\"\nreflectance = {text}\n[textures.plum]\ntype = \"checker\"\n"
        ));
        let MaterialKind::Diffuse { reflectance } = *kind(&scene, "a") else { panic!("{text}") };
        reflectance
    };
    assert_eq!(reflectance("\"tomato\""), reflectance("\"#ff6347\""));
    assert_eq!(reflectance("\"DarkSlateGray\""), reflectance("\"#2f4f4f\""));
    assert!(matches!(reflectance("\"plum\""), Color::Texture(_)));
    let scene = read("[[light]]\ntype = \"point\"\nposition = [0, 1, 0]\nintensity = \"white\"\n");
    assert_eq!(scene.lights.len(), 1);
}
