//! Do the modules use only what the map of the house allows, and do the libraries stay below the doors?
//!
//! Reads the sources as text, which is cheaper than a crate for every module. What each module is for is in
//! ARCHITECTURE.md; why the arrows run this way, in docs/decisions/0001-the-house.md.

use std::fs;
use std::path::{Path, PathBuf};

/// Each module of this crate and the modules it may use. Rows may name only rows above them, so that there is no circle.
const MAY_USE: &[(&str, &[&str])] = &[
    ("clock", &[]),
    ("parallel", &[]),
    ("hash", &[]),
    ("vector", &[]),
    ("elementary", &[]),
    ("optics", &["vector"]),
    ("math", &["elementary", "optics"]),
    ("spectrum", &[]),
    ("statistics", &[]),
    ("lanes", &["spectrum", "vector"]),
    ("points", &["lanes", "vector"]),
    ("warp", &["elementary", "vector"]),
    ("color", &["math", "spectrum"]),
    ("sampler", &["hash", "lanes"]),
    ("bsdf", &["elementary", "hash", "lanes", "math", "optics", "sampler", "spectrum", "vector", "warp"]),
    ("film", &["hash", "lanes", "parallel", "sampler", "spectrum"]),
    ("denoise", &["film", "parallel"]),
    ("develop", &["film"]),
    ("exposure", &["film", "math"]),
    ("noise", &["hash"]),
    ("filter", &["sampler"]),
    ("distribution", &["sampler", "lanes"]),
    ("camera", &["math", "vector", "warp"]),
    ("interior_stack", &[]),
    ("texture", &["color", "hash", "lanes", "noise", "spectrum", "vector"]),
    ("interaction", &["interior_stack", "math", "points", "texture"]),
    ("footprint", &["interaction", "texture"]),
    (
        "material",
        &[
            "bsdf",
            "footprint",
            "interior_stack",
            "math",
            "optics",
            "points",
            "spectrum",
            "interaction",
            "texture",
            "vector",
            "warp",
        ],
    ),
    ("primitive", &["lanes", "math", "points", "interaction", "texture", "vector", "warp"]),
    (
        "light",
        &[
            "distribution",
            "elementary",
            "lanes",
            "math",
            "parallel",
            "points",
            "sampler",
            "primitive",
            "spectrum",
            "interaction",
            "texture",
            "vector",
            "warp",
        ],
    ),
    (
        "world",
        &[
            "bsdf",
            "distribution",
            "footprint",
            "interior_stack",
            "light",
            "material",
            "math",
            "points",
            "primitive",
            "spectrum",
            "interaction",
            "texture",
            "warp",
        ],
    ),
    ("view", &["camera"]),
    (
        "integrator",
        &[
            "bsdf",
            "hash",
            "interior_stack",
            "lanes",
            "light",
            "material",
            "math",
            "optics",
            "points",
            "sampler",
            "primitive",
            "spectrum",
            "interaction",
            "texture",
            "vector",
            "warp",
            "world",
        ],
    ),
    (
        "render",
        &[
            "interior_stack",
            "camera",
            "clock",
            "color",
            "film",
            "filter",
            "footprint",
            "integrator",
            "lanes",
            "light",
            "material",
            "math",
            "parallel",
            "sampler",
            "spectrum",
            "interaction",
            "texture",
            "vector",
            "view",
            "warp",
            "world",
        ],
    ),
    (
        "inspect",
        &[
            "bsdf",
            "camera",
            "develop",
            "film",
            "integrator",
            "light",
            "material",
            "math",
            "render",
            "primitive",
            "spectrum",
            "interaction",
            "texture",
            "world",
        ],
    ),
    (
        "session",
        &[
            "math",
            "clock",
            "color",
            "denoise",
            "develop",
            "exposure",
            "film",
            "inspect",
            "integrator",
            "render",
            "view",
            "world",
        ],
    ),
];

/// Folders that gather modules without being one.
const GROUPS: &[&str] = &["core", "post", "shading", "view"];

/// Each crate of the workspace and the crates of the workspace that it may use. Rows may name only rows above them.
const CRATES: &[(&str, &[&str])] = &[
    ("lookfrom-simd", &[]),
    ("lookfrom-test-data", &[]),
    ("lookfrom-bvh", &["lookfrom-simd"]),
    ("lookfrom-scene", &["lookfrom-test-data"]),
    ("lookfrom", &["lookfrom-bvh", "lookfrom-scene", "lookfrom-simd", "lookfrom-test-data"]),
    ("lookfrom-view", &["lookfrom", "lookfrom-scene"]),
    ("lookfrom-cli", &["lookfrom", "lookfrom-scene", "lookfrom-view"]),
];

/// What a library must not do: only doors speak and decide when the program ends.
const FOR_DOORS: &[&str] = &["print!(", "println!(", "dbg!(", "process::exit", "process::abort"];

/// The folder of a crate of the workspace.
fn crate_folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name)
}

/// The Rust files below a folder, sorted, without the unit tests that have a file of their own.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry of the folder").path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") && !path.ends_with("tests.rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// A file's code: without comments, and without the unit tests at its end.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).expect("a source file");
    let text = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// What stands after each `crate::` (and the group): the name of a module, or nothing where a brace follows.
fn named_from_the_root(code: &str) -> Vec<String> {
    let is_identifier = |c: char| c.is_alphanumeric() || c == '_';
    let identifier = |code: &str| -> String { code.chars().take_while(|&c| is_identifier(c)).collect() };
    let named = |rest: &str| {
        let first = identifier(rest);
        match rest[first.len()..].strip_prefix("::") {
            Some(rest) if GROUPS.contains(&first.as_str()) && is_in_group(&first, &identifier(rest)) => {
                identifier(rest)
            }
            _ => first,
        }
    };
    code.match_indices("crate::")
        .filter(|(at, _)| !code[..*at].ends_with(is_identifier))
        .map(|(at, found)| named(&code[at + found.len()..]))
        .collect()
}

/// Whether a name in a group is that of a module, and not of something that the group has itself.
fn is_in_group(group: &str, name: &str) -> bool {
    crate_folder("lookfrom/src").join(group).join(name).with_extension("rs").is_file()
}

#[test]
fn the_table_has_no_circle() {
    for (row, (module, allowed)) in MAY_USE.iter().enumerate() {
        for used in *allowed {
            assert!(
                MAY_USE[..row].iter().any(|(above, _)| above == used),
                "{module} may use {used}, which is not above it in the table"
            );
        }
    }
}

#[test]
fn modules_use_only_what_the_table_allows() {
    let root = crate_folder("lookfrom/src");
    let mut faults = Vec::new();
    let files = sources(&root);
    assert!(files.len() > 20, "these are not the sources: {}", root.display());
    for path in files.iter().filter(|path| !path.ends_with("lib.rs")) {
        let inside = path.strip_prefix(&root).expect("a file of the crate");
        let names: Vec<_> =
            inside.components().map(|name| name.as_os_str().to_string_lossy().into_owned()).collect();
        // Inside of a group the modules are one folder deeper.
        let groups = usize::from(names.len() > 1 && GROUPS.contains(&names[0].as_str()));
        let depth = names.len() - groups;
        let module = names[groups].trim_end_matches(".rs");
        if groups == 0 && names.len() == 1 && GROUPS.contains(&module) && module != "view" {
            continue;
        }
        let Some((_, allowed)) = MAY_USE.iter().find(|(row, _)| *row == module) else {
            faults.push(format!("{module} is not in the table: give it a row below all that it uses"));
            continue;
        };
        let code = code(path);
        for used in named_from_the_root(&code) {
            if used.is_empty() {
                faults.push(format!("{}: write one `use crate::…` a module", inside.display()));
            } else if used != module && !allowed.contains(&used.as_str()) {
                faults.push(format!("{}: {module} → {used} is not allowed", inside.display()));
            }
        }
        // A way around `crate::` would be a way around the table.
        if code.contains(&"super::".repeat(depth)) {
            faults.push(format!("{}: `super::` leads out of the module; write `crate::`", inside.display()));
        }
    }
    assert!(faults.is_empty(), "arrows that the table in {} does not have:\n{}", file!(), faults.join("\n"));
}

#[test]
fn crates_use_only_what_the_table_allows() {
    for (row, (name, allowed)) in CRATES.iter().enumerate() {
        for used in *allowed {
            assert!(
                CRATES[..row].iter().any(|(above, _)| above == used),
                "{used} is not above {name} in the table"
            );
        }
        let folder = crate_folder(name);
        let manifest = folder.join("Cargo.toml");
        for (other, _) in CRATES.iter().filter(|(other, _)| other != name && !allowed.contains(other)) {
            let path = format!("{}::", other.replace('-', "_"));
            for file in sources(&folder.join("src")) {
                assert!(!names_the_crate(&code(&file), &path), "{} names {other}", file.display());
            }
            for dependency in [format!("{other}."), format!("{other} =")] {
                assert!(!names_the_crate(&code(&manifest), &dependency), "{name} depends on {other}");
            }
        }
    }
}

/// Whether a name stands in the code by itself, not as the end of a longer one.
fn names_the_crate(code: &str, name: &str) -> bool {
    let is_part = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
    code.match_indices(name).any(|(at, _)| !code[..at].ends_with(is_part))
}

#[test]
fn libraries_return_and_doors_speak() {
    for library in ["lookfrom", "lookfrom-bvh", "lookfrom-scene", "lookfrom-simd", "lookfrom-view"] {
        for path in sources(&crate_folder(library).join("src")) {
            for forbidden in FOR_DOORS {
                assert!(!code(&path).contains(forbidden), "{} says {forbidden}", path.display());
            }
        }
    }
}

#[test]
fn arrows_are_found() {
    let code = "use crate::light::Light;\nfn f(x: &crate::film::Film) {}\nuse other_crate::math;\nuse crate::{a, b};";
    assert_eq!(named_from_the_root(code), ["light", "film", ""]);
    assert!(
        names_the_crate("use lookfrom::world;", "lookfrom::")
            && !names_the_crate("my_lookfrom::x", "lookfrom::")
    );
}
