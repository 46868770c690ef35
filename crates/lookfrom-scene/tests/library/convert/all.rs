//! A scene for every variant of the vocabulary.

mod cameras;
mod lights;
mod materials;
mod media;
mod settings;
mod shapes;
mod textures;

use glam::{DMat4, DVec3, DVec4, Vec3};
use lookfrom_scene::camera::Camera;
use lookfrom_scene::image::{Encoding, Image};
use lookfrom_scene::material::{Color, Material, MaterialKind, Scalar};
use lookfrom_scene::medium::{Extinction, Medium};
use lookfrom_scene::scene::{CurveId, MaterialId, TextureId};
use lookfrom_scene::shape::{Geometry, Shape, Sphere};
use lookfrom_scene::spectrum::{self, Curve};
use lookfrom_scene::texture::{Mapping, Texture, TextureKind};
use lookfrom_scene::{Location, Scene};

const NOISE: TextureId = TextureId(0);

const TEXTURE: Scalar = Scalar::Texture(NOISE);

const COLOR: Color = Color::Texture(NOISE);

const TABLE: CurveId = CurveId(0);

pub(super) fn here() -> Location {
    Location::default()
}

/// A shear, which only a matrix can say.
fn shear() -> DMat4 {
    DMat4::from_cols(
        DVec4::new(1.1, 0.2, -0.0, 0.0),
        DVec4::new(0.3, 0.9, 0.1, 0.0),
        DVec4::new(-0.4, 0.0, 1.3, 0.0),
        DVec4::new(0.1, 1.0 / 3.0, -7.0, 1.0),
    )
}

fn unit() -> Vec3 {
    Vec3::new(0.3, -0.7, 0.2).normalize()
}

/// A sphere in a scene with a texture, pictures, spectra and media for others to use.
fn base() -> Scene {
    let value = |gray| Color::gray(gray);
    let noise = TextureKind::Noise { low: value(0.25), high: value(0.75), octaves: 3, mapping: Mapping::UV };
    let bytes: Vec<[u8; 4]> = (0..16_u8).map(|k| [k, 200 - k, 3 * k, 255 - 5 * k]).collect();
    let opaque: Vec<[u8; 4]> = bytes.iter().map(|[r, g, b, _]| [*r, *g, *b, 255]).collect();
    let floats: Vec<[f32; 3]> = (0..16).map(|k| [k as f32 * 0.37, 1e-8, 5000.0]).collect();
    let gamma = |x: f32| libm::powf(x, 1.8);
    let curve = |first: f32| Curve::Tabulated {
        wavelengths: vec![first, 500.0, 650.5],
        values: vec![1.5, 1.25, 1.75],
    };
    let long = Curve::Tabulated {
        wavelengths: (0..40).map(|k| 355.0 + 12.5 * k as f32).collect(),
        values: (0..40).map(|k| 1.0 + 1.0 / (k as f32 + 3.0)).collect(),
    };
    let named = |name: &str| spectrum::named(name).expect("a spectrum");
    let mut media = Vec::new();
    for name in ["fog", "air"] {
        let extinction = Extinction::Parts { absorption: Color::BLACK, scattering: value(0.5) };
        media.push(Medium { extinction, g: 0.25, ..Medium::clear(name, here()) });
    }
    let kind = MaterialKind::Diffuse { reflectance: value(0.5) };
    let shape =
        Shape::new(here(), Geometry::Sphere(Sphere { center: DVec3::ZERO, radius: 1.0 }), MaterialId(0));
    Scene {
        camera: Some(Camera::default()),
        materials: vec![Material::new("grey", here(), kind)],
        textures: vec![Texture { name: "noise".to_owned(), at: here(), kind: noise }],
        images: vec![
            Image::from_bytes("srgb", 4, 4, opaque.clone(), Encoding::Srgb),
            Image::from_bytes("linear", 4, 4, bytes.clone(), Encoding::Linear),
            Image::from_bytes("gamma", 4, 4, bytes, Encoding::Curve(&gamma)),
            Image::from_linear("floats", 4, 4, floats),
            Image::from_bytes("normals", 4, 4, opaque, Encoding::Linear),
        ],
        curves: vec![
            curve(400.0),
            Curve::Constant(1.25),
            Curve::Blackbody { kelvin: 3000.0 },
            long,
            named("glass-BK7"),
            named("metal-Au-eta"),
            named("metal-Au-k"),
            named("stdillum-F7"),
            named("stdillum-D50"),
        ],
        media,
        shapes: vec![shape],
        ..Scene::default()
    }
}

/// Scenes of a list of variants, each of which is put into a scene; every variant has to be among them.
fn each<T: Clone>(
    kind: &str,
    variants: Vec<T>,
    index: impl Fn(&T) -> usize,
    put: impl Fn(&mut Scene, T),
) -> Vec<(String, Scene)> {
    let mut found: Vec<usize> = variants.iter().map(&index).collect();
    found.sort_unstable();
    found.dedup();
    assert!(found.iter().copied().eq(0..found.len()), "of the variants of {kind} there are only {found:?}");
    let scene = |(number, variant): (usize, T)| {
        let mut scene = base();
        put(&mut scene, variant);
        (format!("{kind} {number}"), scene)
    };
    variants.into_iter().enumerate().map(scene).collect()
}

pub(super) fn scenes() -> Vec<(String, Scene)> {
    [
        materials::materials(),
        materials::bumps(),
        textures::textures(),
        textures::mappings(),
        lights::lights(),
        lights::powers(),
        shapes::geometries(),
        shapes::meshes(),
        media::media(),
        cameras::cameras(),
        settings::settings(),
        settings::looks(),
    ]
    .concat()
}
