//! Scenes of Mitsuba in XML: what is read of each kind of plugin, what is said of faults, and hostile files.

mod attributes;
mod blends;
mod bsdfs;
mod emitters;
mod errors;
mod films;
mod phases;
mod sensors;
mod shapes;
mod volumes;

use std::path::{Path, PathBuf};

use glam::{DMat4, DVec3, DVec4};
use lookfrom_scene::camera::Projection;
use lookfrom_scene::material::{Color, MaterialKind, Scalar};
use lookfrom_scene::shape::Shape;
use lookfrom_scene::spectrum::Curve;
use lookfrom_scene::texture::{Mapping, TextureKind};
use lookfrom_scene::{Error, ErrorKind, LoadContext, Memory, Result, Scene, load};

fn files(files: &[(&str, &str)]) -> Memory {
    Memory(files.iter().map(|(name, text)| (PathBuf::from(name), text.as_bytes().to_vec())).collect())
}

fn read_of(memory: &Memory, variables: &[(&str, &str)]) -> (Result<Scene>, Vec<String>) {
    let mut context = LoadContext::new(memory);
    context.limits.elements = 10_000;
    for (name, value) in variables {
        context.variables.values.insert((*name).to_owned(), (*value).to_owned());
    }
    let scene = load::scene(Path::new("s/a.xml"), &mut context);
    (scene, context.warnings.iter().map(ToString::to_string).collect())
}

/// The scene with these elements, and the warnings.
fn told(elements: &str) -> (Scene, Vec<String>) {
    let text = format!("<scene version=\"3.0.0\">\n{elements}\n</scene>");
    let (scene, warnings) =
        read_of(&files(&[("s/a.xml", &text), ("s/p.pfm", PICTURE), ("s/m.obj", MESH)]), &[]);
    (scene.unwrap_or_else(|error| panic!("{elements}: {error}")), warnings)
}

/// As [`told`], without warnings.
fn scene(elements: &str) -> Scene {
    let (scene, warnings) = told(elements);
    assert!(warnings.is_empty(), "{elements}: {warnings:?}");
    scene
}

fn error(elements: &str) -> Error {
    let text = format!("<scene version=\"3.0.0\">\n{elements}\n</scene>");
    read_of(&files(&[("s/a.xml", &text)]), &[]).0.expect_err(elements)
}

/// A grey picture of one texel.
const PICTURE: &str = "Pf\n1 1\n-1.0\n\0\0\0?";

const MESH: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";

/// The matrix of the only shape, with this transform.
fn matrix(steps: &str) -> DMat4 {
    let scene =
        scene(&format!("<shape type=\"cube\"><transform name=\"to_world\">{steps}</transform></shape>"));
    scene.shapes[0].world_from_object
}

/// The material of a cube with this BSDF, and its shape.
fn material(bsdf: &str) -> (MaterialKind, Shape, Vec<String>) {
    let (scene, warnings) = told(&format!("<shape type=\"cube\">{bsdf}</shape>"));
    let shape = scene.shapes[0].clone();
    (scene.materials[shape.material.index()].kind.clone(), shape, warnings)
}

fn near(a: DVec3, b: DVec3) -> bool {
    (a - b).length() < 1e-12
}

#[test]
fn parameters_have_defaults_that_come_first_or_from_outside() {
    let text = "<scene version=\"3.0.0\">\n<default name=\"kind\" value=\"per\"/><default name=\"kind\" value=\"x\"/>\n\
                <sensor type=\"$kind\"/></scene>";
    let memory = files(&[("s/a.xml", text)]);
    let (result, _) = read_of(&memory, &[]);
    let message = result.expect_err("per is no sensor").to_string();
    assert!(message.contains("s/a.xml:3:15: the sensor \"per\" is not supported"), "{message}");
    let text = r#"<scene version="3.0.0"><default name="spp" value="8"/><sensor type="perspective">
        <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler></sensor></scene>"#;
    let memory = files(&[("s/a.xml", text)]);
    let samples =
        |variables: &[(&str, &str)]| read_of(&memory, variables).0.map(|scene| scene.render.samples);
    assert_eq!(
        (samples(&[]), samples(&[("spp", "32")]), samples(&[("spp", "\"5\"")])),
        (Ok(8), Ok(32), Ok(5))
    );
    let stranger = samples(&[("sp", "32")]).expect_err("a slip");
    assert_eq!((stranger.kind, stranger.hint), (ErrorKind::Request, Some("did you mean `spp`?".into())));
    let missing = error("<shape type=\"$which\"/>");
    assert_eq!(missing.message, "the parameter `$which` has no value");
    assert_eq!((missing.at.line, missing.at.column), (2, 14));
}

#[test]
fn includes_paths_references_and_aliases_join_a_scene() {
    let main = r#"<scene version="3.0.0"><path value="../lib"/><include filename="parts.xml"/>
        <shape type="cube"><ref id="paint"/></shape>
        <shape type="cube"><ref id="later"/></shape>
        <bsdf type="diffuse" id="later"/></scene>"#;
    let parts =
        r#"<scene version="3.0.0"><include filename="deep.xml"/><alias id="red" as="paint"/></scene>"#;
    let deep = r##"<bsdf type="diffuse" id="red"><rgb name="reflectance" value="#ff0000"/></bsdf>"##;
    let memory = files(&[("s/a.xml", main), ("s/../lib/parts.xml", parts), ("s/../lib/deep.xml", deep)]);
    let (scene, warnings) = read_of(&memory, &[]);
    let scene = scene.unwrap_or_else(|error| panic!("{error}"));
    assert!(warnings.is_empty(), "{warnings:?}");
    let reflectance = |index: usize| match scene.materials[scene.shapes[index].material.index()].kind {
        MaterialKind::Diffuse { reflectance } => reflectance,
        ref other => panic!("{other:?}"),
    };
    assert_eq!((reflectance(0), reflectance(1)), (Color::Value([1.0, 0.0, 0.0]), Color::gray(0.5)));
}

#[test]
fn transforms_apply_in_the_order_of_the_file() {
    let point = |steps: &str, p: [f64; 3]| matrix(steps).transform_point3(p.into());
    let first = point("<translate x=\"1\"/><scale value=\"2\"/>", [1.0, 0.0, 0.0]);
    let other = point("<scale value=\"2, 2, 2\"/><translate value=\"1 0 0\"/>", [1.0, 0.0, 0.0]);
    assert_eq!((first, other), (DVec3::new(4.0, 0.0, 0.0), DVec3::new(3.0, 0.0, 0.0)));
    assert_eq!(point("<rotate z=\"1\" angle=\"90\"/>", [1.0, 0.0, 0.0]), DVec3::Y);
    // The axis as it is, as Mitsuba takes it: ScalarTransform4f().rotate([1, 1, 0], 40).
    let sheared = point("<rotate value=\"1 1 0\" angle=\"40\"/>", [1.0, 0.0, 0.0]);
    assert!((sheared - DVec3::new(1.0, 0.233956, -0.642788)).length() < 1e-6, "{sheared}");
    let rows = "<matrix value=\"1 0 0 5  0 2 0 6  0 0 3 7  0 0 0 1\"/>";
    assert_eq!(point(rows, [1.0; 3]), DVec3::new(6.0, 8.0, 10.0));
    assert_eq!(point("<matrix value=\"0 1 0 1 0 0 0 0 1\"/>", [1.0, 2.0, 3.0]), DVec3::new(2.0, 1.0, 3.0));
    // x to the left, y up, z forward.
    let look = matrix("<lookat origin=\"1 2 3\" target=\"1 2 -5\" up=\"0 9 0\"/>");
    assert_eq!(look.x_axis, DVec4::NEG_X);
    assert_eq!((look.y_axis, look.z_axis), (DVec4::Y, DVec4::NEG_Z));
    assert_eq!(look.w_axis, DVec4::new(1.0, 2.0, 3.0, 1.0));
}

#[test]
fn names_of_old_versions_are_understood() {
    let text = r#"<scene version="0.6.0"><sensor type="perspective"><float name="fov" value="90"/>
        <string name="fovAxis" value="y"/><transform name="toWorld"><lookAt origin="0 0 1" target="0 0 0" up="0 1 0"/>
        </transform></sensor><shape type="cube"><transform name="toWorld"><rotate x="1" y="1" z="1" angle="-120"/></transform>
        </shape></scene>"#;
    let (scene, warnings) = read_of(&files(&[("s/a.xml", text)]), &[]);
    let scene = scene.unwrap_or_else(|error| panic!("{error}"));
    // Axes were of unit length.
    assert!(near(scene.shapes[0].world_from_object.x_axis.truncate(), DVec3::Z));
    let camera = scene.camera.expect("a camera");
    assert_eq!(camera.view.lookfrom(), DVec3::Z);
    let Projection::Perspective { fov } = camera.projection else { panic!("{:?}", camera.projection) };
    assert!((fov - 90.0).abs() < 1e-12 && warnings.is_empty(), "{fov} {warnings:?}");
}

#[test]
fn properties_of_old_versions_have_other_names() {
    let text = r#"<scene version="0.5.0"><shape type="cube"><bsdf type="diffuse">
        <texture name="diffuseReflectance" type="checkerboard"><float name="uscale" value="4"/>
        <float name="voffset" value="0.25"/></texture></bsdf></shape></scene>"#;
    let (scene, warnings) = read_of(&files(&[("s/a.xml", text)]), &[]);
    let scene = scene.unwrap_or_else(|error| panic!("{error}"));
    assert!(warnings.is_empty(), "{warnings:?}");
    let new = text.replace("0.5.0", "3.0.0").replace("diffuseReflectance", "reflectance").replace(
        "<float name=\"uscale\" value=\"4\"/>\n        <float name=\"voffset\" value=\"0.25\"/>",
        "<transform name=\"to_uv\"><translate y=\"0.25\"/><scale x=\"4\" y=\"1\"/></transform>",
    );
    let (as_new, warnings) = read_of(&files(&[("s/a.xml", &new)]), &[]);
    assert!(warnings.is_empty() && new.contains("to_uv"), "{warnings:?}");
    assert_eq!(scene.textures[0].kind, as_new.expect("a scene").textures[0].kind);
}

#[test]
fn spectra_are_read_from_files() {
    let text = "<scene version=\"3.0.0\"><shape type=\"cube\"><bsdf type=\"diffuse\">\
                <spectrum name=\"reflectance\" filename=\"grey.spd\"/></bsdf></shape></scene>";
    let (scene, _) = read_of(&files(&[("s/a.xml", text), ("s/grey.spd", "400 0.25\n700 0.75\n")]), &[]);
    let scene = scene.unwrap_or_else(|error| panic!("{error}"));
    let tabulated = Curve::Tabulated { wavelengths: vec![400.0, 700.0], values: vec![0.25, 0.75] };
    assert_eq!(scene.curves, [tabulated]);
    let missing = read_of(&files(&[("s/a.xml", text)]), &[]).0.expect_err("no file");
    assert!(missing.to_string().starts_with("s/a.xml:1:103: s/grey.spd: no such file"), "{missing}");
}

#[test]
fn the_last_path_comes_first() {
    let text = r#"<scene version="3.0.0"><path value="one"/><path value="two"/>
        <shape type="obj"><string name="filename" value="m.obj"/></shape></scene>"#;
    let larger = MESH.replace("v 1 0 0", "v 2 0 0");
    let memory =
        files(&[("s/a.xml", text), ("s/m.obj", MESH), ("s/one/m.obj", MESH), ("s/two/m.obj", &larger)]);
    let scene = read_of(&memory, &[]).0.expect("a scene");
    assert_eq!(scene.meshes[0].positions[1].x, 2.0);
    // Any direction is up for a zero vector.
    assert_eq!(matrix("<lookat origin=\"0 0 0\" target=\"0 0 1\" up=\"0 0 0\"/>").z_axis, DVec4::Z);
}
