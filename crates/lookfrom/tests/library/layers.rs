//! Do crates and modules use only what the map of the house allows, and do the libraries stay below the doors?
//!
//! Reads the sources as text, which is cheaper than a crate for every module. The map is in `layers/tables.rs`; what each
//! module is for, in ARCHITECTURE.md; why the arrows run this way, in docs/decisions/0001-the-house.md.

use std::fs;
use std::path::{Path, PathBuf};

use tables::{CRATES, LADDERS, Ladder, MODULES};

mod tables;

/// Folders that gather modules without being one.
const GROUPS: &[&str] = &["core", "post", "shading", "view"];

/// What a library must not do: only doors speak and decide when the program ends.
const FOR_DOORS: &[&str] = &["print!(", "println!(", "dbg!(", "process::exit", "process::abort"];

/// Calls of other programs, which have flags of their own.
const OTHER_PROGRAMS: &[&str] = &["pbrt --upgrade", "--outfile"];

/// The folder of a crate of the workspace.
fn crate_folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name)
}

/// The Rust files below a folder, sorted, without the unit tests that have a file or a folder of their own.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry of the folder").path();
        if path.ends_with("tests") {
            continue;
        }
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

/// Whether a character is a part of names.
fn is_identifier(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The name that a text begins with.
fn identifier(code: &str) -> &str {
    code.split(|c| !is_identifier(c)).next().unwrap_or_default()
}

/// The names of modules after each `crate::`, or in the braces there, also where they are in groups.
fn named_from_the_root<'a>(code: &'a str, groups: &[&str]) -> Vec<&'a str> {
    let found = code.match_indices("crate::").filter(|(at, _)| !code[..*at].ends_with(is_identifier));
    found.flat_map(|(at, found)| named_first(&code[at + found.len()..], groups)).collect()
}

/// The first name of each of the paths that a text begins with: one, or several in braces.
fn named_first<'a>(code: &'a str, groups: &[&str]) -> Vec<&'a str> {
    let Some(inside) = code.strip_prefix('{') else {
        let first = identifier(code);
        let second = code[first.len()..].strip_prefix("::").map(identifier);
        return match second {
            Some(second) if groups.contains(&first) && is_in_group(first, second) => vec![second],
            _ => vec![first],
        };
    };
    let (mut names, mut depth, mut start) = (Vec::new(), 0, 0);
    for (at, c) in inside.char_indices() {
        if depth == 0 && (c == ',' || c == '}') {
            names.extend(named_first(inside[start..at].trim(), groups));
            start = at + 1;
        }
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            _ => {}
        }
    }
    names.retain(|name| !name.is_empty());
    names
}

/// Whether a name in a group is that of a module, and not of something that the group has itself.
fn is_in_group(group: &str, name: &str) -> bool {
    crate_folder("lookfrom/src").join(group).join(name).with_extension("rs").is_file()
}

/// The names in a row of a table.
fn allows(row: &str, name: &str) -> bool {
    row.split_whitespace().any(|allowed| allowed == name)
}

#[test]
fn the_tables_have_no_circle() {
    for table in [CRATES, MODULES] {
        for (row, (name, allowed)) in table.iter().enumerate() {
            for used in allowed.split_whitespace() {
                assert!(
                    table[..row].iter().any(|(above, _)| *above == used),
                    "{name} may use {used}, which is not above it in the table"
                );
            }
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
        let Some((_, allowed)) = MODULES.iter().find(|(row, _)| *row == module) else {
            faults.push(format!("{module} is not in the table: give it a row below all that it uses"));
            continue;
        };
        let code = code(path);
        for used in named_from_the_root(&code, GROUPS) {
            if used != module && !allows(allowed, used) {
                faults.push(format!("{}: {module} → {used} is not allowed", inside.display()));
            }
        }
        // A way around `crate::` would be a way around the table.
        if code.contains(&"super::".repeat(depth)) {
            faults.push(format!("{}: `super::` leads out of the module; write `crate::`", inside.display()));
        }
    }
    assert!(faults.is_empty(), "arrows that the table does not have:\n{}", faults.join("\n"));
}

/// The pairs of modules of which one uses the other. Each module uses itself.
fn arrows(name: &str) -> Vec<(String, String)> {
    let root = crate_folder(name).join("src");
    let files = sources(&root);
    let is_root = |path: &Path| ["lib.rs", "main.rs"].iter().any(|file| path == root.join(file));
    let declared: String = files.iter().filter(|path| is_root(path)).map(|path| code(path)).collect();
    let mut arrows = Vec::new();
    for path in files.iter().filter(|path| !is_root(path)) {
        let inside = path.strip_prefix(&root).expect("a file of the crate");
        let module = inside.iter().next().expect("a file or folder").to_string_lossy();
        let module = module.trim_end_matches(".rs");
        let code = code(path);
        assert!(
            !code.contains(&"super::".repeat(inside.iter().count())),
            "{}: `super::` leads out of the module; write `crate::`",
            path.display()
        );
        arrows.push((module.to_owned(), module.to_owned()));
        let used = named_from_the_root(&code, &[]).into_iter().filter_map(|name| module_of(&declared, name));
        arrows.extend(used.map(|used| (module.to_owned(), used.to_owned())));
    }
    arrows.sort();
    arrows.dedup();
    arrows
}

/// The module of a name in the root of a crate: itself, or from where the root exports it; none for what the root defines.
fn module_of<'a>(root: &'a str, name: &'a str) -> Option<&'a str> {
    let mut items = root.split(';').map(str::trim);
    items.find_map(|item| {
        if item.ends_with(&format!("mod {name}")) {
            return Some(name);
        }
        let (_, exported) = item.split_once("pub use ")?;
        exported.split(|c| !is_identifier(c)).any(|part| part == name).then(|| identifier(exported))
    })
}

#[test]
fn other_crates_are_ladders() {
    let mut faults = Vec::new();
    for Ladder { name, rungs, exceptions } in LADDERS {
        let rung = |module: &str| rungs.iter().position(|rung| allows(rung, module));
        let mut excepted: Vec<_> = exceptions.iter().flat_map(|(_, arrows)| arrows.split(", ")).collect();
        for (module, used) in arrows(name) {
            let arrow = format!("{module} > {used}");
            if rung(&module).is_none() {
                faults.push(format!("{name}: {module} is on no rung: give it one below all that it uses"));
            } else if module != used && rung(&used) >= rung(&module) {
                match excepted.iter().position(|exception| *exception == arrow) {
                    Some(place) => _ = excepted.swap_remove(place),
                    None => faults.push(format!("{name}: {arrow}, which is not on a rung above")),
                }
            }
        }
        faults.extend(excepted.iter().map(|arrow| format!("{name}: no exception is needed for {arrow}")));
    }
    assert!(faults.is_empty(), "arrows that the ladders do not have:\n{}", faults.join("\n"));
}

#[test]
fn crates_use_only_what_the_table_allows() {
    for (name, allowed) in CRATES {
        let folder = crate_folder(name);
        let manifest = folder.join("Cargo.toml");
        for (other, _) in CRATES.iter().filter(|(other, _)| other != name && !allows(allowed, other)) {
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
fn libraries_name_no_flags() {
    for library in ["lookfrom", "lookfrom-scene"] {
        for path in sources(&crate_folder(library).join("src")) {
            let code = OTHER_PROGRAMS.iter().fold(code(&path), |code, call| code.replace(call, ""));
            let is_flag = |(at, dashes): (usize, &str)| {
                code[at + dashes.len()..].starts_with(|c: char| c.is_ascii_lowercase())
            };
            assert!(
                !code.match_indices("--").any(is_flag),
                "{} names a flag: a `Remedy` has the option",
                path.display()
            );
        }
    }
}

#[test]
fn arrows_are_found() {
    let code = "use crate::light::Light;\nfn f(x: &crate::film::Film) {}\nuse other_crate::math;\nuse crate::{a::{b, c}, d};";
    assert_eq!(named_from_the_root(code, GROUPS), ["light", "film", "a", "d"]);
    assert_eq!(module_of("mod a;\npub use b::{C, D};", "D"), Some("b"));
    assert!(
        names_the_crate("use lookfrom::world;", "lookfrom::")
            && !names_the_crate("my_lookfrom::x", "lookfrom::")
    );
}
