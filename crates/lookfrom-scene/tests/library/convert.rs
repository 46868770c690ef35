//! Scenes as documents in our own format: every part of the vocabulary has words, what is written is read back to the same scene, and hostile
//! names stay names.

mod all;
mod words;

use std::path::{Path, PathBuf};

use glam::{DMat4, DVec3, Vec3};
use lookfrom_scene::camera::{Camera, View};
use lookfrom_scene::light::{Falloff, Light, LightKind, Power};
use lookfrom_scene::material::{Color, Material, MaterialKind, Roughness, Scalar};
use lookfrom_scene::scene::{Instance, MaterialId, MeshId, Object, ObjectId};
use lookfrom_scene::shape::{Geometry, Mesh, Shape};
use lookfrom_scene::toml::write::{Sources, Written, write};
use lookfrom_scene::{
    Budget, Disk, ErrorKind, Files, Inputs, LoadContext, Location, Memory, Result, Scene, load,
};
use proptest::prelude::*;

/// The document of a scene without files.
fn written(scene: &Scene) -> Result<Written> {
    let files = Memory::default();
    write(scene, "s", &Sources { files: &files, paths: Vec::new(), budget: Budget::default() })
}

/// The scene that a document says, which is proven to be the one that it was written from.
fn read_back(written: &Written) -> Scene {
    written.check("s", &Budget::default()).unwrap_or_else(|error| panic!("{error}\nin\n{}", written.text));
    let mut files = Memory::default();
    files.0.insert("s.toml".into(), written.text.clone().into_bytes());
    files.0.extend(written.files.iter().map(|(name, bytes)| (PathBuf::from(name), bytes.clone())));
    let mut context = LoadContext::new(&files);
    let scene = load::scene(Path::new("s.toml"), &mut context).unwrap_or_else(|error| panic!("{error}"));
    scene.validate().unwrap_or_else(|error| panic!("{error}"));
    scene
}

/// The document of a file's scene.
fn converted(path: &Path, files: &dyn Files) -> Result<Written> {
    let inputs = Inputs::default();
    let recorded = inputs.record(files, "");
    let scene = load::scene(path, &mut LoadContext::new(&recorded))?;
    write(&scene, "s", &Sources { files, paths: inputs.paths(), budget: Budget::default() })
}

/// The files in a folder of the repository with one of these endings.
fn files_in(folder: &str, endings: &[&str]) -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(folder);
    let entries =
        std::fs::read_dir(&root).expect("the folder is there").map(|entry| entry.expect("an entry").path());
    let has_ending =
        |path: &PathBuf| path.extension().is_some_and(|of| endings.iter().any(|ending| of == *ending));
    let mut paths: Vec<PathBuf> = entries.filter(has_ending).collect();
    paths.sort();
    paths
}

#[test]
fn every_scene_of_the_repository_is_read_back() {
    let endings = ["toml", "pbrt", "xml", "glb", "gltf", "obj", "ply", "stl", "hair"];
    let folders = ["scenes", "docs/guide/scenes", "scenes/models"];
    let paths: Vec<PathBuf> = folders.iter().flat_map(|folder| files_in(folder, &endings)).collect();
    assert!(paths.len() > 100, "{}", paths.len());
    for path in paths {
        let written = converted(&path, &Disk).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let folder = written.check("s", &Budget::default());
        folder.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        // A camera of its own, or none: then one is added when it is rendered.
        assert!(
            written.text.contains("[image]\n") && written.text.contains("[render]\n"),
            "{}",
            path.display()
        );
    }
}

#[test]
fn every_variant_of_the_vocabulary_is_read_back() {
    for (name, scene) in all::scenes() {
        scene.validate().unwrap_or_else(|error| panic!("{name}: {error}"));
        let written = written(&scene).unwrap_or_else(|error| panic!("{name}: {error}"));
        let again = written.check("s", &Budget::default());
        again.unwrap_or_else(|error| panic!("{name}: {error}\nin\n{}", written.text));
        let back = read_back(&written);
        words::same(&scene, &back).unwrap_or_else(|what| panic!("{name}: {what}\nin\n{}", written.text));
    }
}

/// A scene of one shape.
fn of_shape(shape: Shape) -> Scene {
    let kind = MaterialKind::Diffuse { reflectance: Color::gray(0.5) };
    Scene {
        camera: Some(Camera::default()),
        materials: vec![Material::new("grey", Location::default(), kind)],
        shapes: vec![shape],
        ..Scene::default()
    }
}

fn of_mesh(mesh: Mesh) -> Scene {
    let shape = Shape::new(Location::default(), Geometry::Mesh(MeshId(0)), MaterialId(0));
    Scene { meshes: vec![mesh], ..of_shape(shape) }
}

fn triangle(name: &str) -> Mesh {
    Mesh {
        name: name.to_owned(),
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    }
}

#[test]
fn a_small_scene_is_what_a_person_would_write() {
    let mut scene = of_mesh(triangle("t"));
    scene.shapes[0].world_from_object = DMat4::from_translation(DVec3::new(0.0, 0.5, 0.0));
    scene.lights.push(Light {
        name: Some("lamp".to_owned()),
        at: Location::default(),
        kind: LightKind::Point {
            position: DVec3::Y,
            intensity: Color::gray(20.0),
            falloff: Falloff::Quadratic,
        },
        power: Power::AS_WRITTEN,
    });
    let text = written(&scene).expect("a document").text;
    let expected = "\
[camera]
lookfrom = [0, 1, 5]
lookat = [0, 0, 0]
fov = 45

[image]
width = 640
height = 480

[render]
integrator = \"whitted\"
samples = 16

[materials.grey]
type = \"diffuse\"
reflectance = 0.5

[[mesh]]
positions = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
triangles = [[0, 1, 2]]
material = \"grey\"
translate = [0, 0.5, 0]

[[light]]
type = \"point\"
name = \"lamp\"
position = [0, 1, 0]
intensity = 20
";
    assert_eq!(text, expected);
}

#[test]
fn what_is_not_used_is_not_written() {
    let mut scene = of_mesh(triangle("t"));
    let kind = MaterialKind::Diffuse { reflectance: Color::gray(0.1) };
    scene.materials.push(Material::new("unused", Location::default(), kind));
    let object = |name: &str, shapes| Object { name: name.to_owned(), at: Location::default(), shapes };
    scene.objects = vec![object("empty", Vec::new()), object("unused", scene.shapes.clone())];
    let instance = |object| Instance::new(Location::default(), ObjectId(object), DMat4::IDENTITY);
    scene.instances = vec![instance(0)];
    let text = written(&scene).expect("a document").text;
    assert!(!text.contains("unused") && !text.contains("empty") && !text.contains("instance"), "{text}");
}

#[test]
fn shapes_stay_in_their_order() {
    let sphere = of_shape(Shape::new(
        Location::default(),
        Geometry::Sphere(lookfrom_scene::shape::Sphere { center: DVec3::ZERO, radius: 1.0 }),
        MaterialId(0),
    ));
    let mut scene = of_mesh(triangle("t"));
    scene.shapes.extend(sphere.shapes.clone());
    let back = read_back(&written(&scene).expect("a document"));
    assert!(matches!(back.shapes[0].geometry, Geometry::Mesh(_)));
    scene.shapes.rotate_left(1);
    let document = written(&scene).expect("a document");
    assert!(matches!(read_back(&document).shapes[0].geometry, Geometry::Sphere(_)));
    assert!(
        document.text.contains("[[sphere]]") && !document.text.contains("[[shape]]"),
        "{}",
        document.text
    );
}

#[test]
fn hostile_names_are_names_and_nothing_else() {
    let hostile = [
        "a\"b",
        "a\nb",
        "../../etc/passwd",
        "a]\n[image]\nwidth = 1\n#",
        "= 1 + 1",
        "keyframes",
        "\0",
        "",
        "#fff",
        "red",
    ];
    let many = Mesh { positions: vec![Vec3::ONE; 13], ..triangle("") };
    let mut scene = of_shape(Shape::new(Location::default(), Geometry::Mesh(MeshId(0)), MaterialId(0)));
    (scene.shapes, scene.materials) = (Vec::new(), Vec::new());
    for (index, name) in hostile.iter().cycle().take(2 * hostile.len()).enumerate() {
        let kind = MaterialKind::Diffuse { reflectance: Color::gray(index as f32 / 100.0) };
        scene.materials.push(Material::new(*name, Location::default(), kind));
        let mesh = Mesh { name: (*name).to_owned(), ..many.clone() };
        scene.meshes.push(mesh);
        let id = MeshId(index as u32);
        let shape = Shape::new(Location::default(), Geometry::Mesh(id), MaterialId(index as u32));
        scene.shapes.push(Shape { name: Some((*name).to_owned()), ..shape });
    }
    let document = written(&scene).expect("a document");
    for (name, _) in &document.files {
        let plain =
            name.strip_prefix("s/").and_then(|name| name.strip_suffix(".ply")).expect("a file of the folder");
        let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_';
        assert!(!plain.is_empty() && plain.bytes().all(is_plain), "{name:?}");
    }
    let mut names: Vec<&str> = document.files.iter().map(|(name, _)| &**name).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), scene.meshes.len());
    let back = read_back(&document);
    let grays = |scene: &Scene| -> Vec<Color> {
        let of = |shape: &Shape| match &scene.materials[shape.material.index()].kind {
            MaterialKind::Diffuse { reflectance } => *reflectance,
            other => panic!("{other:?}"),
        };
        scene.shapes.iter().map(of).collect()
    };
    assert_eq!(grays(&back), grays(&scene));
    assert_eq!(back.shapes[2].name.as_deref(), Some("../../etc/passwd"));
    assert_eq!(back.image.width, 640);
}

#[test]
fn what_is_no_number_is_refused() {
    let mut scene = of_mesh(triangle("t"));
    scene.shapes[0].world_from_object.w_axis.x = f64::NAN;
    assert_eq!(written(&scene).unwrap_err().kind, ErrorKind::Invalid);
    let mesh = Mesh { positions: vec![Vec3::NAN; 3], ..triangle("t") };
    assert_eq!(written(&of_mesh(mesh)).unwrap_err().kind, ErrorKind::Invalid);
    let normals = vec![Vec3::new(f32::NAN, 1.0, -0.0); 3];
    let error = written(&of_mesh(Mesh { normals, ..triangle("t") })).unwrap_err();
    assert!(error.message.contains("normals[0] is not finite"), "{error}");
    // A negative zero stays one.
    let normals = vec![Vec3::new(0.0, 1.0, -0.0); 3];
    let back = read_back(&written(&of_mesh(Mesh { normals, ..triangle("t") })).expect("a document"));
    assert!(back.meshes[0].normals[0].z.is_sign_negative());
}

#[test]
fn a_document_that_says_something_else_is_found_out() {
    let mut document = written(&of_mesh(triangle("t"))).expect("a document");
    document.text = document.text.replace("add_light = false", "depth = 8\nadd_light = false");
    let error = document.check("s", &Budget::default()).unwrap_err();
    assert!(error.message.contains("is `depth = 8`, and would be `add_light = false`"), "{error}");
    document.text = document.text.replace("depth = 8", "deep = 8");
    assert_eq!(document.check("s", &Budget::default()).unwrap_err().kind, ErrorKind::Invalid);
}

fn any_finite() -> impl Strategy<Value = f32> {
    any::<u32>().prop_map(f32::from_bits).prop_filter("a finite number", |number| number.is_finite())
}

proptest! {
    /// Any numbers keep their bits: of meshes, colours, roughness, places.
    #[test]
    fn numbers_keep_their_bits(
        positions in prop::collection::vec(prop::array::uniform3(any_finite()), 3..30),
        color in prop::array::uniform3(any_finite()),
        alpha in prop::array::uniform2(0.0_f32..2.0),
        matrix in prop::array::uniform12(-1e3_f64..1e3),
        lookfrom in prop::array::uniform3(-1e9_f64..1e9),
    ) {
        let mesh = Mesh {
            positions: positions.into_iter().map(Vec3::from_array).collect(),
            ..triangle("t")
        };
        let mut scene = of_mesh(mesh);
        scene.materials[0].kind = MaterialKind::Conductor {
            metal: lookfrom_scene::material::Metal::Reflectance(Color::Value(color.map(f32::abs))),
            roughness: Roughness {
                remap: color[0] > 0.0,
                ..Roughness::of_alphas(Scalar::Value(alpha[0]), Scalar::Value(alpha[1]))
            },
            energy: Default::default(),
            specular_reflectance: Color::Value(color.map(|channel| channel.abs().min(1.0))),
        };
        let rows = [&matrix[..4], &matrix[4..8], &matrix[8..], &[0.0, 0.0, 0.0, 1.0]].concat();
        let rows: [f64; 16] = rows.try_into().expect("16 numbers");
        let matrix = DMat4::from_cols_array(&rows).transpose();
        prop_assume!(matrix.determinant().is_normal());
        scene.shapes[0].world_from_object = matrix;
        scene.camera = Some(Camera {
            view: View::Look { lookfrom: lookfrom.into(), lookat: DVec3::from(lookfrom) + DVec3::Z, up: DVec3::Y },
            ..Camera::default()
        });
        let document = written(&scene).expect("a document");
        let back = read_back(&document);
        prop_assert_eq!(words::same(&scene, &back), Ok(()), "{}", document.text);
    }
}

#[test]
#[ignore = "needs LOOKFROM_SHARED"]
fn shared_scenes_are_read_back() {
    let scenes = [
        "scenes/cornell-box/scene.pbrt",
        "scenes/hair/scene.pbrt",
        "scenes/lens-realistic/scene.pbrt",
        "scenes/lights-image/scene.pbrt",
        "scenes/measured/scene.pbrt",
        "scenes/medium-cloud/scene.pbrt",
        "scenes/medium-grid/scene.pbrt",
        "scenes/medium-rgbgrid/scene.pbrt",
        "scenes/motion-blur/scene.pbrt",
        "scenes/subsurface/scene.pbrt",
        "scenes/veach-mis/scene.pbrt",
        "corpus/gltf/FlightHelmet/FlightHelmet.gltf",
    ];
    for name in scenes {
        let path = lookfrom_test_data::shared(name);
        let written = converted(&path, &Disk).unwrap_or_else(|error| panic!("{name}: {error}"));
        written.check("s", &Budget::default()).unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}
