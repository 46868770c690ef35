//! Scenes that are written as documents of our own format give the same pictures, bit by bit.

use std::path::{Path, PathBuf};

use lookfrom::session::{Options, Session};
use lookfrom_scene::toml::write::{Sources, write};
use lookfrom_scene::{Budget, Disk, Files, Inputs, Memory};

/// Small pictures, whose settings become those of the document.
fn small() -> Options {
    Options {
        width: Some(24),
        samples: Some(2),
        denoise: Some(false),
        keep_scene: true,
        ..Options::default()
    }
}

/// The bits of a session's picture.
fn bits(session: &Session) -> Vec<u32> {
    let finished = session.render(&()).unwrap_or_else(|error| panic!("{error}"));
    let numbers = finished.picture.pixels.as_flattened().iter().chain(&finished.picture.alpha);
    numbers.map(|number| number.to_bits()).collect()
}

/// Renders a file and its document, and compares.
fn check(path: &Path, options: &Options) {
    check_among(path, &Disk, options);
}

/// As [`check`], of a file among others.
fn check_among(path: &Path, files: &dyn Files, options: &Options) {
    let name = path.display();
    let inputs = Inputs::default();
    let recorded = inputs.record(files, "");
    let session = Session::read(path, &recorded, options).unwrap_or_else(|error| panic!("{name}: {error}"));
    let expected = bits(&session);
    let scene = session.into_scene().expect("the scene is kept");
    let sources = Sources { files, paths: inputs.paths(), budget: Budget::default() };
    let written = write(&scene, "s", &sources).unwrap_or_else(|error| panic!("{name}: {error}"));
    let mut files = Memory::default();
    files.0.insert("s.toml".into(), written.text.into_bytes());
    files.0.extend(written.files.into_iter().map(|(name, bytes)| (name.into(), bytes)));
    let again = Session::read(Path::new("s.toml"), &files, &Options::default());
    let again = again.unwrap_or_else(|error| panic!("{name}: {error}"));
    assert!(again.info().added.is_empty(), "{name}: {:?} added", again.info().added);
    assert!(bits(&again) == expected, "{name}: another picture");
}

/// The files in a folder of the repository.
fn files_in(folder: &str) -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(folder);
    let paths =
        std::fs::read_dir(root).expect("the folder is there").map(|entry| entry.expect("an entry").path());
    let is_scene = |path: &PathBuf| {
        let extension = path.extension().unwrap_or_default().to_string_lossy().into_owned();
        ["toml", "pbrt", "xml", "glb", "gltf", "obj", "ply", "stl", "hair"].contains(&&*extension)
    };
    let mut paths: Vec<PathBuf> = paths.filter(is_scene).collect();
    paths.sort();
    paths
}

#[test]
fn every_scene_of_the_repository_has_the_same_picture() {
    for path in ["scenes", "scenes/models", "docs/guide/scenes"].into_iter().flat_map(files_in) {
        check(&path, &small());
    }
}

/// What only scenes of pbrt say: encodings, spectra that end, parts of quadrics, totals with factors, media on sides, motion.
#[test]
fn a_scene_of_pbrt_with_much_in_it_has_the_same_picture() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let scene = std::fs::read(root.join("tests/library/converted/odd.pbrt")).expect("our own scene");
    let tiles = std::fs::read(root.join("../../scenes/images/tiles.png")).expect("our own picture");
    let files = Memory([("odd.pbrt".into(), scene), ("tiles.png".into(), tiles)].into());
    check_among(Path::new("odd.pbrt"), &files, &Options { width: None, ..small() });
}

#[test]
fn options_become_a_part_of_the_scene() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let model = root.join("scenes/models/knot.obj");
    check(&model, &Options { floor: true, fov: Some(20.0), ..small() });
    let view = lookfrom_scene::studio::Viewpoint::WORDS[0].1;
    check(&model, &Options { view: Some(view), ..small() });
    let mut moving = small();
    (moving.import.at, moving.import.shutter) = (Some(1.25), Some(4.0));
    check(&root.join("docs/guide/scenes/animation.toml"), &moving);
}

#[test]
#[ignore = "needs LOOKFROM_SHARED"]
fn shared_scenes_have_the_same_picture() {
    let scenes = [
        "scenes/hair/scene.pbrt",
        "scenes/lens-realistic/scene.pbrt",
        "scenes/lights-image/scene.pbrt",
        "scenes/measured/scene.pbrt",
        "scenes/medium-cloud/scene.pbrt",
        "scenes/medium-grid/scene.pbrt",
        "scenes/medium-rgbgrid/scene.pbrt",
        "scenes/motion-blur/scene.pbrt",
        "scenes/subsurface/scene.pbrt",
        "scenes/veach-bidir/scene.pbrt",
        "mitsuba/tests/scenes/bsdf_spheres/test_texturedprincipled1_path.xml",
        "mitsuba/tests/scenes/instancing/test_instancing_path.xml",
        "corpus/gltf/FlightHelmet/FlightHelmet.gltf",
        "corpus/gltf/Fox/Fox.glb",
    ];
    for name in scenes {
        check(&lookfrom_test_data::shared(name), &small());
    }
}
