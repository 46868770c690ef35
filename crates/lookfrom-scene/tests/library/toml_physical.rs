//! Our own format says all that physically based scenes are made of: materials, curves, lights, textures, shapes.

mod lights;
mod materials;
mod media;
mod openpbr;
mod textures;

use std::path::Path;

use glam::{DVec3, Vec3};
use lookfrom_scene::camera::{Projection, Window};
use lookfrom_scene::material::{MaterialKind, Scalar};
use lookfrom_scene::settings::{ColorMode, Integrator, Layers, LightSampler, SpectralFilm};
use lookfrom_scene::shape::{Geometry, Profile};
use lookfrom_scene::spectrum::CameraSensor;
use lookfrom_scene::{LoadContext, Memory, Scene, image, load};

fn read_files(texts: &[(&str, &str)]) -> Scene {
    let mut files = Memory::default();
    for (name, text) in texts {
        files.0.insert(name.into(), text.as_bytes().to_vec());
    }
    files.0.insert("half.png".into(), image::encode_png(1, 1, &[128; 3]).expect("a picture"));
    let scene = load::scene(Path::new(texts[0].0), &mut LoadContext::new(&files));
    scene.unwrap_or_else(|error| panic!("{error}\nin\n{}", texts[0].1))
}

fn read(text: &str) -> Scene {
    read_files(&[("a.toml", text)])
}

fn kind<'a>(scene: &'a Scene, name: &str) -> &'a MaterialKind {
    &scene.materials.iter().find(|material| material.name == name).expect("a material").kind
}

#[test]
fn physical_materials_are_path_traced_unless_the_file_says_otherwise() {
    let integrator = |texts: &[(&str, &str)]| read_files(texts).render.integrator;
    let physical = "[materials.a]\ntype = \"diffuse\"\n";
    assert_eq!(integrator(&[("a.toml", "[materials.a]\ndiffuse = 1")]), Integrator::Whitted);
    assert_eq!(integrator(&[("a.toml", physical)]), Integrator::Path);
    let silent = format!("{physical}[render]\nsamples = 3");
    assert_eq!(integrator(&[("a.toml", &silent)]), Integrator::Path);
    let named = format!("{physical}[render]\nintegrator = \"whitted\"");
    assert_eq!(integrator(&[("a.toml", &named)]), Integrator::Whitted);
    let importing = "import = \"b.toml\"\n[render]\nsamples = 3";
    assert_eq!(integrator(&[("a.toml", importing), ("b.toml", &named)]), Integrator::Path);
    assert_eq!(integrator(&[("a.toml", "import = \"b.toml\""), ("b.toml", &named)]), Integrator::Whitted);
    let both = [
        ("a.toml", "import = [\"b.toml\", \"c.toml\"]"),
        ("b.toml", &silent),
        ("c.toml", "[render]\nintegrator = \"id\""),
    ];
    assert_eq!(integrator(&both), Integrator::Path);
}

#[test]
fn settings_and_cameras() {
    let scene = read(
        r#"
[render]
integrator = "ambient_occlusion"
color = "spectral"
light_sampler = "power"
regularize = true
occlusion_distance = 3
[image]
sensor = "sony_ilce_9"
imaging_ratio = 2
white_balance = 5000
max_component = 10
layers = true
spectral_buckets = 20
wavelengths = [400, 700.5]
bands = { red = { curve = [[600, 0], [700, 1]] }, all = { constant = 2 } }
[camera]
lookfrom = [0, 0, 5]
lookat = [0, 0, 0]
window = { x = [-1, 2], y = [0, 1] }
"#,
    );
    let render = &scene.render;
    assert_eq!(render.integrator, Integrator::AmbientOcclusion { cosine: true });
    assert_eq!((render.color, render.light_sampler), (ColorMode::Spectral, LightSampler::Power));
    assert_eq!((render.regularize, render.occlusion_distance), (true, 3.0));
    let sensor = scene.image.sensor;
    assert_eq!(sensor.camera.map(CameraSensor::name), Some("sony_ilce_9"));
    assert_eq!((sensor.imaging_ratio, sensor.white_balance, sensor.max_component), (2.0, Some(5000.0), 10.0));
    assert_eq!(scene.image.layers, Layers::Geometry);
    let film = scene.image.spectral_film.as_ref().expect("a spectral film");
    assert_eq!((film.buckets, film.range), (20, [400.0, 700.5]));
    let bands: Vec<(&str, f64)> =
        film.bands.iter().map(|band| (&*band.name, band.width([400.0, 700.0]))).collect();
    assert_eq!(bands, [("all", 600.0), ("red", 50.0)]);
    let film = |image: &str| read(&format!("[image]\n{image}")).image.spectral_film;
    assert_eq!(film("spectral_buckets = 3"), Some(SpectralFilm { buckets: 3, ..SpectralFilm::NONE }));
    assert_eq!(
        film("wavelengths = [500, 600]"),
        Some(SpectralFilm { range: [500.0, 600.0], ..SpectralFilm::NONE })
    );
    assert_eq!(film(""), None);
    let bands = film("bands = { a = { kelvin = 3000 } }").expect("a film of bands alone");
    assert_eq!((bands.buckets, bands.range, bands.bands.len()), (0, SpectralFilm::ALL, 1));
    let camera = scene.camera.expect("a camera");
    assert_eq!(camera.window, Some(Window { x: [-1.0, 2.0], y: [0.0, 1.0] }));
    for (word, projection) in
        [("equirectangular", Projection::Equirectangular), ("octahedral", Projection::Octahedral)]
    {
        let scene =
            read(&format!("[camera]\nlookfrom = [0, 0, 1]\nlookat = [0, 0, 0]\nprojection = \"{word}\""));
        assert_eq!(scene.camera.expect("a camera").projection, projection);
    }
}

#[test]
fn shapes_stand_where_they_say() {
    let scene = read(
        r#"
[[sphere]]
center = [1, 0, 0]
radius = 2
z_max = 1
translate = [0, 3, 0]
[[disk]]
center = [0, 4, 0]
normal = [0, 2, 0]
radius = 2
inner_radius = 1
alpha = 0.5
reverse_orientation = true
[[cylinder]]
from = [1, 1, 1]
to = [1, 1, -3]
radius = 0.5
phi_max = 90
[[patch]]
corners = [[0, 0, 0], [1, 0, 0], [0, 0, 1], [1, 1, 1]]
uvs = [[0, 0], [2, 0], [0, 2], [2, 2]]
[[curve]]
points = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0], [4, 0, 0], [5, 0, 0], [6, 0, 0]]
width = [3, 2, 1]
profile = "ribbon"
normals = [[0, 2, 0], [0, 1, 0], [0, 0, 1]]
"#,
    );
    let place = |index: usize, x: f64, y: f64, z: f64| {
        scene.shapes[index].world_from_object.transform_point3(DVec3::new(x, y, z))
    };
    // Kinds are read in the order of the guide.
    assert!(matches!(
        scene.shapes[0].geometry,
        Geometry::PartialSphere { radius: 2.0, z: [-2.0, 1.0], phi_max: 360.0 }
    ));
    assert_eq!(place(0, 0.0, 0.0, 0.0), DVec3::new(1.0, 3.0, 0.0));
    assert!(matches!(
        scene.shapes[1].geometry,
        Geometry::PartialDisk { height: 0.0, radius: 2.0, inner_radius: 1.0, phi_max: 360.0 }
    ));
    assert_eq!(place(1, 0.0, 0.0, 1.0), DVec3::new(0.0, 5.0, 0.0));
    assert_eq!(
        (scene.shapes[1].alpha, scene.shapes[1].reverse_orientation),
        (Some(Scalar::Value(0.5)), true)
    );
    assert!(scene.shapes[1].world_from_object.determinant() > 0.0);
    assert!(matches!(scene.shapes[2].geometry, Geometry::Cylinder { z: [0.0, 4.0], phi_max: 90.0, .. }));
    assert_eq!(place(2, 0.0, 0.0, 4.0), DVec3::new(1.0, 1.0, -3.0));
    let Geometry::Bilinear(patches) = &scene.shapes[3].geometry else { panic!("a patch") };
    assert_eq!((patches.positions[3], patches.patches.len(), patches.uvs.len()), (Vec3::ONE, 1, 4));
    let Geometry::Curves(strands) = &scene.shapes[4].geometry else { panic!("curves") };
    assert_eq!(
        (strands.len(), strands[0].points[3], strands[1].width),
        (2, strands[1].points[0], [2.0, 1.0])
    );
    assert_eq!(strands[0].profile, Profile::Ribbon([Vec3::Y, Vec3::Y]));
}
