//! What is said of broken scenes of pbrt: the place, the line, what was found, what was expected.

use std::path::{Path, PathBuf};

use crate::support::shown;
use lookfrom_scene::{LoadContext, Memory, load};

/// All that is said of a scene: its error if there is one, and then its warnings.
fn said(text: &str) -> String {
    let files = Memory([(PathBuf::from("a.pbrt"), text.as_bytes().to_vec())].into());
    let mut context = LoadContext::new(&files);
    let error = load::scene(Path::new("a.pbrt"), &mut context).err();
    let error = error.map(|error| shown(&error, &files));
    let all: Vec<String> =
        error.into_iter().chain(context.warnings.iter().map(ToString::to_string)).collect();
    if all.is_empty() { "nothing".to_owned() } else { all.join("\n") }
}

/// `tests/library/pbrt/errors.txt` has bad scenes and what is said of them; `LOOKFROM_ACCEPT=1 cargo test` writes anew what is
/// said.
#[test]
fn errors_say_where_and_what_to_do() {
    let expected = include_str!("pbrt/errors.txt");
    let texts =
        expected.split("\n=====\n").map(|case| case.split_once("\n-----\n").map_or(case, |(text, _)| text));
    let found: Vec<String> = texts.map(|text| format!("{text}\n-----\n{}", said(text))).collect();
    if std::env::var_os("LOOKFROM_ACCEPT").is_some() {
        std::fs::write("tests/library/pbrt/errors.txt", found.join("\n=====\n"))
            .expect("the expectations can be written");
        return;
    }
    assert!(found.len() > 100);
    for (found, expected) in found.iter().zip(expected.split("\n=====\n")) {
        assert_eq!(found, expected);
    }
}
