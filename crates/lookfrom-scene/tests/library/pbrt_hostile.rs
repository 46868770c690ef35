//! Bytes of any kind given for a scene of pbrt: an error or a scene, never a panic, and in good time.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use lookfrom_scene::{ErrorKind, LoadContext, Memory, Result, Scene, load};
use proptest::prelude::*;

/// Far more than what is linear takes here, and far less than what is quadratic does.
const GOOD_TIME: Duration = Duration::from_secs(5);

fn read(bytes: &[u8]) -> Result<Scene> {
    let files = Memory([(PathBuf::from("a.pbrt"), bytes.to_vec()), ("b.pbrt".into(), bytes.to_vec())].into());
    let mut context = LoadContext::new(&files);
    context.limits.elements = 10_000;
    context.limits.texels = 10_000;
    load::scene(Path::new("a.pbrt"), &mut context)
}

/// Reads a text as a scene and checks what every reader promises.
fn survive(bytes: &[u8]) {
    match read(bytes) {
        Err(error) => assert!(!error.message.is_empty() && !error.at.file.is_empty()),
        Ok(scene) => {
            for mesh in &scene.meshes {
                let count = mesh.positions.len();
                assert!(mesh.triangles.iter().flatten().all(|&vertex| (vertex as usize) < count));
                assert!(mesh.positions.iter().all(|position| position.is_finite()));
            }
            for shape in scene.shapes.iter().chain(scene.objects.iter().flat_map(|object| &object.shapes)) {
                assert!(shape.material.index() < scene.materials.len());
            }
        }
    }
}

#[test]
fn circles_of_includes_end() {
    let error = read(b"Include \"b.pbrt\"").expect_err("a includes b, b includes itself");
    assert!(error.message.contains("b.pbrt → b.pbrt"), "{error}");
    // Other names for the same file are not seen through; the depth is.
    let error = read(b"Include \"./b.pbrt\"").expect_err("no end");
    assert!(matches!(error.kind, ErrorKind::Limit | ErrorKind::Io | ErrorKind::Invalid), "{error}");
}

#[test]
fn includes_of_includes_do_not_multiply_without_end() {
    // Each of 15 files includes the next eight times.
    let mut files = Memory::default();
    for level in 0..15 {
        let text = format!("Include \"{}.pbrt\"\n", level + 1).repeat(8);
        files.0.insert(format!("{level}.pbrt").into(), text.into_bytes());
    }
    files.0.insert("15.pbrt".into(), Vec::new());
    let error = load::scene(Path::new("0.pbrt"), &mut LoadContext::new(&files)).expect_err("too many");
    assert_eq!(error.kind, ErrorKind::Limit);
}

#[test]
fn many_unknown_parameters_are_told_in_good_time() {
    let parameters: String = (0..100_000).map(|number| format!("\"float a{number}\" 1 ")).collect();
    let start = Instant::now();
    assert!(read(format!("WorldBegin Shape \"sphere\" {parameters}").as_bytes()).is_ok());
    assert!(start.elapsed() < GOOD_TIME, "{:?}", start.elapsed());
}

#[test]
fn parameters_of_deep_attributes_are_shared() {
    // One list for each level would take 14 GB.
    let text = format!("WorldBegin {}", "AttributeBegin Attribute \"shape\" \"float a\" 1 ".repeat(60_000));
    assert_eq!(read(text.as_bytes()).map(drop).map_err(|error| error.kind), Err(ErrorKind::Syntax));
}

#[test]
fn deep_attributes_are_refused() {
    let text = format!("WorldBegin {}", "AttributeBegin ".repeat(1_000_000));
    assert_eq!(read(text.as_bytes()).map(drop).map_err(|error| error.kind), Err(ErrorKind::Limit));
    let text = format!("WorldBegin {}{}", "AttributeBegin ".repeat(9_999), "AttributeEnd ".repeat(9_999));
    assert!(read(text.as_bytes()).is_ok());
}

#[test]
fn matrices_may_run_out_of_numbers() {
    let text =
        format!("WorldBegin {} Shape \"sphere\" LightSource \"point\"", "Scale 1e200 1e200 1e200 ".repeat(9));
    survive(text.as_bytes());
    survive(b"WorldBegin Scale 1e-200 1 1 Scale 1e-200 1 1 Shape \"sphere\" Texture \"a\" \"float\" \"fbm\"");
}

#[test]
fn every_beginning_of_a_scene_is_survived() {
    for text in corpus() {
        for end in 0..text.len() {
            survive(&text[..end]);
        }
    }
}

/// A scene with something of everything, and the scenes of the golden errors.
fn corpus() -> Vec<Vec<u8>> {
    let all = include_str!("pbrt/all.pbrt");
    assert!(read(all.as_bytes()).is_ok(), "{:?}", read(all.as_bytes()).err());
    let errors = include_str!("pbrt/errors.txt").split("\n=====\n");
    let texts = errors.filter_map(|case| case.split("\n-----\n").next()).map(|text| text.as_bytes().to_vec());
    texts.chain([all.as_bytes().to_vec()]).collect()
}

/// What a hostile hand would put into a scene.
const PIECES: [&str; 24] = [
    "0",
    "-1",
    "1e38",
    "-1e-38",
    "nan",
    "1e999",
    "2147483647",
    "-2147483648",
    "[",
    "]",
    "\"",
    "\\",
    "#",
    "\n",
    "[]",
    "\"\"",
    " true ",
    "AttributeBegin ",
    "AttributeEnd ",
    "ObjectBegin \"a\" ",
    "Scale 0 1e-300 1e300 ",
    "WorldBegin ",
    "é",
    "\u{0}",
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        survive(&bytes);
    }

    #[test]
    fn changed_scenes(
        which in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), 0..PIECES.len(), 0_usize..12), 1..5),
    ) {
        let texts = corpus();
        let mut text = texts[which.index(texts.len())].clone();
        for (place, piece, removed) in changes {
            let start = place.index(text.len() + 1);
            let end = (start + removed).min(text.len());
            text.splice(start..end, PIECES[piece].bytes());
        }
        survive(&text);
    }
}
