//! The scenes of a call: files as typed, and those in folders.

use std::path::{Path, PathBuf};

use lookfrom_scene::load::{has_known_name, known_files};

use crate::exit::Failure;

/// The kinds of files that can be read, with their extensions, in the singular or with an `s`.
fn kinds(ending: &str) -> String {
    let [scene, model, volume] = known_files().map(|(content, names)| format!("{content}{ending} ({names})"));
    format!("{scene}, {model} or {volume}")
}

/// The help of an argument for one scene.
pub(crate) fn one() -> String {
    format!("A {}", kinds(""))
}

/// The help of an argument for several scenes, or what else.
pub(crate) fn several(or_else: &str) -> String {
    format!("One or more {}{or_else}", kinds("s"))
}

/// The scenes, with each folder replaced by the scenes and models in it (not in its folders), sorted by name.
///
/// # Errors
/// `Usage` for a folder without scenes or models, or one that cannot be read.
pub(crate) fn expanded(typed: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    let mut scenes = Vec::new();
    for path in typed {
        if path.is_dir() { scenes.extend(in_folder(path)?) } else { scenes.push(path.clone()) }
    }
    Ok(scenes)
}

fn in_folder(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let failed = |what: String| Failure::Usage(format!("{}: {what}", folder.display()));
    let entries = std::fs::read_dir(folder).and_then(Iterator::collect::<Result<Vec<_>, _>>);
    let entries = entries.map_err(|error| failed(format!("the folder cannot be read: {error}")))?;
    let mut scenes: Vec<PathBuf> = entries.iter().map(std::fs::DirEntry::path).collect();
    scenes.retain(|path| has_known_name(path) && path.is_file());
    scenes.sort();
    if scenes.is_empty() {
        return Err(failed(format!(
            "a folder without {}\n  help: folders in it are not searched: name them",
            kinds("s")
        )));
    }
    Ok(scenes)
}
