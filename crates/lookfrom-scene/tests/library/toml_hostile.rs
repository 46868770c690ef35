//! Bytes of any kind given for a scene: an error or a scene, never a panic, and in good time.

use std::path::Path;

use lookfrom_scene::{LoadContext, Memory, load};
use proptest::prelude::*;

/// Reads text as a scene; small limits keep what it may ask for small.
fn survive(bytes: &[u8]) {
    let mut files = Memory::default();
    files.0.insert("a.toml".into(), bytes.to_vec());
    let mut context = LoadContext::new(&files);
    context.limits.elements = 10_000;
    context.limits.texels = 10_000;
    match load::scene(Path::new("a.toml"), &mut context) {
        Ok(scene) => scene.shapes.iter().for_each(|shape| assert!(shape.world_from_object.is_finite())),
        Err(error) => assert!(!error.message.is_empty() && !error.at.file.is_empty()),
    }
}

/// Our own scenes, as they stand in the repository, the guide's snippets, and the scenes of the golden errors.
fn corpus() -> Vec<Vec<u8>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut texts: Vec<Vec<u8>> = include_str!("toml/errors.txt")
        .split("\n=====\n")
        .filter_map(|case| case.split("\n-----\n").next())
        .map(|text| text.as_bytes().to_vec())
        .collect();
    let guide = std::fs::read_to_string(root.join("docs/guide/scene-format.md")).expect("the guide is there");
    let snippets = guide.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next());
    texts.extend(snippets.map(|snippet| snippet.as_bytes().to_vec()));
    for folder in ["scenes", "docs/guide/scenes"] {
        let mut paths: Vec<_> = std::fs::read_dir(root.join(folder))
            .expect("the folder is there")
            .map(|entry| entry.expect("an entry").path())
            .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
            .collect();
        paths.sort();
        texts.extend(paths.iter().map(|path| std::fs::read(path).expect("a scene")));
    }
    texts
}

/// What a hostile hand would put into a scene.
const PIECES: [&str; 24] = [
    "0",
    "-1",
    "1e308",
    "-1e-308",
    "nan",
    "inf",
    "1e39",
    "9223372036854775807",
    "[",
    "]",
    "[[",
    "]]",
    "{",
    "}",
    "\"",
    "\n",
    "=",
    "\"\"",
    "[0, 0, 0]",
    "true",
    "\"#fff\"",
    "scale = 1e-300\n",
    "é",
    "\u{0}",
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        survive(&bytes);
    }

    #[test]
    fn changed_scenes(
        which in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), 0..PIECES.len(), 0_usize..12), 1..5),
    ) {
        let texts = corpus();
        let mut bytes = texts[which.index(texts.len())].clone();
        for (place, piece, length) in changes {
            let start = place.index(bytes.len());
            let end = (start + length).min(bytes.len());
            bytes.splice(start..end, PIECES[piece].bytes());
        }
        survive(&bytes);
    }

    #[test]
    fn numbers_of_any_size(
        which in any::<prop::sample::Index>(),
        places in prop::collection::vec((any::<prop::sample::Index>(), -330_i32..310, any::<bool>()), 1..4),
    ) {
        let texts = corpus();
        let mut text = String::from_utf8(texts[which.index(texts.len())].clone()).expect("UTF-8");
        for (place, exponent, negative) in places {
            let starts: Vec<usize> = text
                .char_indices()
                .zip(text.chars().skip(1))
                .filter(|((_, before), digit)| " [".contains(*before) && digit.is_ascii_digit())
                .map(|((index, _), _)| index + 1)
                .collect();
            if starts.is_empty() {
                continue;
            }
            let start = starts[place.index(starts.len())];
            let length = text[start..].find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(0);
            let sign = if negative { "-" } else { "" };
            text.replace_range(start..start + length, &format!("{sign}1.7e{exponent}"));
        }
        survive(text.as_bytes());
    }
}
