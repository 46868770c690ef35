//! `lookfrom files`: all files that a scene is read from, for packing and for job descriptions.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use lookfrom_scene::digest::{Digested, FileDigest};
use lookfrom_scene::{Budget, Disk, LoadContext, Scene, load};
use serde::Serialize;

use crate::args::{FilesArguments, VariableArguments};
use crate::exit::{DONE, Failure, answer, answer_bytes};
use crate::report::bytes;
use lookfrom_scene::json;

/// Lists the files of every scene, each once, and returns the exit code.
pub(crate) fn run(arguments: &FilesArguments) -> u8 {
    list(arguments).map_or_else(|failure| failure.report(), |()| DONE)
}

/// An input file as JSON.
#[derive(Serialize)]
pub(crate) struct InputFile {
    path: String,
    bytes: u64,
    sha256: String,
}

impl From<(PathBuf, FileDigest)> for InputFile {
    fn from((path, FileDigest { bytes, sha256 }): (PathBuf, FileDigest)) -> Self {
        Self { path: path.display().to_string(), bytes, sha256 }
    }
}

fn list(arguments: &FilesArguments) -> Result<(), Failure> {
    let mut files: BTreeMap<PathBuf, FileDigest> = BTreeMap::new();
    for scene in &arguments.scenes {
        files.extend(read(scene, &arguments.variables, &arguments.memory.budget())?.1);
    }
    for (path, digest) in files {
        if arguments.null {
            answer_bytes(&[path.as_os_str().as_encoded_bytes(), &[0]].concat())?;
        } else if arguments.json {
            answer(&json::line(&InputFile::from((path, digest))))?;
        } else {
            answer(&path.display().to_string())?;
        }
    }
    Ok(())
}

/// Files that were read with their sizes, a line each.
pub(crate) fn in_words(paths: &[PathBuf]) -> String {
    let size =
        |path: &PathBuf| std::fs::metadata(path).map_or("not there".to_owned(), |file| bytes(file.len()));
    let line = |path: &PathBuf| format!("  {:<10} {}, {}", "file", path.display(), size(path));
    paths.iter().map(line).collect::<Vec<_>>().join("\n")
}

/// A scene, and its files with their digests.
pub(crate) fn read(
    scene: &Path,
    variables: &VariableArguments,
    budget: &Budget,
) -> Result<(Scene, Vec<(PathBuf, FileDigest)>), Failure> {
    let files = Digested::new(&Disk);
    let mut context = LoadContext { variables: variables.variables(), ..LoadContext::within(budget, &files) };
    (context.import.at, context.import.shutter) = (variables.at, variables.shutter);
    let scene = load::scene(scene, &mut context)?;
    Ok((scene, files.digests(Path::new(""))))
}
