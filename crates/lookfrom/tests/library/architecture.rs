//! ARCHITECTURE.md and the list of decisions, compared with the files of the repository.
//!
//! A paragraph of ARCHITECTURE.md that begins with `**crate**` describes that crate. Every lower-case word in backticks there
//! is the name of a module, written `name` or `name/`; other names in backticks (`World::compile`, `.spd`) are free. The page is
//! short: a list of files is what `ls` is for.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The most words of the page.
const MOST_WORDS: usize = 900;

/// Module files that are not named.
const UNMAPPED: &[&str] = &["lib", "main", "tests"];

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn text(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The names of all entries of a folder.
fn entries(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    entries.map(|entry| entry.expect("an entry of the folder").path()).collect()
}

/// The modules whose files or folders are directly in a folder.
fn modules_in(folder: &Path) -> BTreeSet<String> {
    let is_module =
        |path: &PathBuf| path.is_dir() || path.extension().is_some_and(|extension| extension == "rs");
    let name = |path: PathBuf| path.file_stem().expect("a name").to_string_lossy().into_owned();
    let mut found: BTreeSet<_> = entries(folder).into_iter().filter(is_module).map(name).collect();
    UNMAPPED.iter().for_each(|name| {
        found.remove(*name);
    });
    found
}

/// The modules below a folder, at any depth.
fn modules_below(folder: &Path) -> BTreeSet<String> {
    let mut found = modules_in(folder);
    for path in entries(folder).into_iter().filter(|path| path.is_dir()) {
        found.extend(modules_below(&path));
    }
    found
}

/// The modules that a paragraph names.
fn named(paragraph: &str) -> BTreeSet<String> {
    let is_module = |word: &&str| {
        word.starts_with(|c: char| c.is_ascii_lowercase())
            && word.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
    };
    let quoted = paragraph.split('`').skip(1).step_by(2).map(|word| word.trim_end_matches('/'));
    quoted.filter(is_module).map(str::to_owned).collect()
}

#[test]
fn architecture_names_the_modules_that_exist() {
    let map = text(&repository().join("ARCHITECTURE.md"));
    let mut faults = Vec::new();
    for folder in entries(&repository().join("crates")) {
        let name = folder.file_name().expect("a name").to_string_lossy().into_owned();
        let title = format!("**{name}**");
        let Some(paragraph) = map.split("\n\n").find(|paragraph| paragraph.starts_with(&title)) else {
            faults.push(format!("the crate {name} has no paragraph that begins with {title}"));
            continue;
        };
        let (named, sources) = (named(paragraph), folder.join("src"));
        let absent = named.difference(&modules_below(&sources)).cloned().collect::<Vec<_>>();
        if !absent.is_empty() {
            faults.push(format!("{name} has no module {}", absent.join(", ")));
        }
    }
    let words = map.split_whitespace().count();
    if words > MOST_WORDS {
        faults.push(format!("{words} words are more than {MOST_WORDS}"));
    }
    assert!(faults.is_empty(), "ARCHITECTURE.md and the sources differ:\n{}", faults.join("\n"));
}

/// The paths of the links in a Markdown text that lead to files.
fn links(markdown: &str) -> Vec<&str> {
    let targets = markdown.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let paths = targets.map(|target| target.split('#').next().unwrap_or_default());
    paths.filter(|path| !path.is_empty() && !path.contains(':')).collect()
}

#[test]
fn decisions_are_listed_and_their_links_lead_to_files() {
    let folder = repository().join("docs/decisions");
    let list = text(&folder.join("README.md"));
    let mut faults = Vec::new();
    let files = entries(&folder);
    assert!(files.len() > 2, "{} has no decisions", folder.display());
    for path in files.iter().filter(|path| path.extension().is_some_and(|extension| extension == "md")) {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        if name != "README.md" && !links(&list).contains(&name.as_str()) {
            faults.push(format!("docs/decisions/README.md does not list {name}"));
        }
        for link in links(&text(path)) {
            if !folder.join(link).exists() {
                faults.push(format!("{name} links to {link}, which does not exist"));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn names_and_links_are_found() {
    let paragraph = "**x**: `scene` · `toml/` (`World::compile` of `.spd`, `Best`), `a_2`";
    assert_eq!(named(paragraph), ["a_2", "scene", "toml"].map(str::to_owned).into());
    assert_eq!(links("[a](b.md#c) [d](#e) [f](https://g.h) ![i](j/k.png)"), ["b.md", "j/k.png"]);
}
