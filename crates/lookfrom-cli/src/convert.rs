//! `lookfrom convert`: a scene or model of any format as a scene in our own, with its files beside it.

use std::path::Path;

use lookfrom::session::Options;
use lookfrom_scene::plural::counted;
use lookfrom_scene::toml::write::{Sources, Written, write};
use lookfrom_scene::{Inputs, load};

use crate::args::ConvertArguments;
use crate::exit::{self, DONE, Failure};
use crate::output::{folder_or_here, keep_inputs, replace_file};
use crate::pipe::Piped;
use crate::prepare::{self, prepare};
use crate::report::bytes;

/// Converts the scene and returns the exit code.
pub(crate) fn run(arguments: &ConvertArguments) -> u8 {
    convert(arguments).map_or_else(|failure| failure.report(), |()| DONE)
}

fn convert(arguments: &ConvertArguments) -> Result<(), Failure> {
    prepare::use_threads(&arguments.common)?;
    let output = &arguments.output;
    let name = name_of(output)?;
    let place = folder_or_here(output.parent());
    if arguments.overrides.model.turn.is_some() {
        let message = "--turn turns a picture, not the scene: give --lookfrom and --rotate-environment";
        return Err(Failure::Usage(message.to_owned()));
    }
    if arguments.overrides.samples.as_ref().is_some_and(|samples| samples.start > 0) {
        let message = "--samples FROM..BEFORE is for a part of a picture; a scene has a number of samples: --samples BEFORE";
        return Err(Failure::Usage(message.to_owned()));
    }
    if !arguments.force {
        check_new(output)?;
        check_new(&place.join(name))?;
    }
    let inputs = Inputs::default();
    let environment = prepare::environment(&arguments.overrides, &arguments.common, &inputs)?;
    let options = arguments.overrides.options(&arguments.common, environment.as_ref());
    let options = Options { keep_scene: true, ..options };
    let session = prepare(&arguments.scene, &arguments.common, &options, &inputs)?;
    if !arguments.quiet {
        exit::say_warnings(session.warnings());
    }
    let Some(scene) = session.into_scene() else { return Ok(()) };
    let sources = Sources { files: &Piped, paths: inputs.paths(), budget: options.budget.clone() };
    let written = write(&scene, name, &sources).map_err(exit::in_scene(&arguments.scene))?;
    drop(scene);
    written.check(name, &options.budget).map_err(exit::in_scene(&arguments.scene))?;
    put(&written, place, output, &inputs)?;
    if !arguments.quiet {
        exit::say(&told(&written, output, name));
    }
    Ok(())
}

/// The name of a scene by that of its file.
fn name_of(output: &Path) -> Result<&str, Failure> {
    let name = output.file_stem().and_then(|stem| stem.to_str());
    name.filter(|_| load::is_toml(output)).ok_or_else(|| {
        let shown = output.display();
        Failure::Usage(format!("{shown} is no name of a scene in our own format\n  help: -o NAME.toml"))
    })
}

/// Refuses to write where something is.
fn check_new(path: &Path) -> Result<(), Failure> {
    match path.symlink_metadata() {
        Err(_) => Ok(()),
        Ok(_) => {
            let shown = path.display();
            Err(Failure::Usage(format!(
                "{shown} exists already\n  help: give another name, or --force to replace it"
            )))
        }
    }
}

/// Writes the files, each whole or not at all, and then the document that names them; none where one would replace an input.
fn put(written: &Written, place: &Path, output: &Path, inputs: &Inputs) -> Result<(), Failure> {
    keep_inputs(output, inputs, "-o")?;
    for (name, _) in &written.files {
        keep_inputs(&place.join(name), inputs, "-o")?;
    }
    for (name, bytes) in &written.files {
        replace_file(&place.join(name), bytes, inputs, "-o")?;
    }
    replace_file(output, written.text.as_bytes(), inputs, "-o")
}

/// The summary of the files that were written.
fn told(written: &Written, output: &Path, name: &str) -> String {
    let text = format!("{}: {}", output.display(), bytes(written.text.len() as u64));
    match written.files.len() {
        0 => text,
        count => {
            let sum = written.files.iter().map(|(_, bytes)| bytes.len() as u64).sum();
            format!("{text}, and {} in {name}/, {}", counted(count, "file"), bytes(sum))
        }
    }
}
