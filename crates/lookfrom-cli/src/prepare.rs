//! Sessions for the command, with every input file on record so that no output overwrites one.

use std::path::{Path, PathBuf};

use lookfrom::session::{Options, Session};
use lookfrom_scene::image::{self, Image};
use lookfrom_scene::light::panorama_fault;
use lookfrom_scene::{Disk, Files, Inputs, LoadContext, Location, load};

use crate::args::{Common, Overrides};
use crate::exit::{self, Failure};
use crate::pipe::Piped;

/// A session of a scene or model file. Every file that is read joins `inputs`.
///
/// # Errors
/// `Scene` where the file cannot be read or compiled into a world, `Usage` where the options do not suit it, `Strict` where
/// `--strict` is given and there are warnings other than notes.
pub(crate) fn prepare(
    path: &Path,
    common: &Common,
    options: &Options,
    inputs: &Inputs,
) -> Result<Session, Failure> {
    prepare_from(&inputs.record(&Piped, path.display().to_string()), path, common, options)
}

/// As [`prepare`], through `files`.
///
/// # Errors
/// As [`prepare`].
pub(crate) fn prepare_from(
    files: &dyn Files,
    path: &Path,
    common: &Common,
    options: &Options,
) -> Result<Session, Failure> {
    let session = Session::read(path, files, options).map_err(exit::in_scene(path))?;
    if common.strict && exit::is_bad(session.warnings()) {
        return Err(Failure::Strict(session.warnings().to_vec()));
    }
    Ok(session)
}

/// The environment map of `--environment`, read once for all scenes.
///
/// # Errors
/// `Scene` where it cannot be read.
pub(crate) fn environment(
    overrides: &Overrides,
    common: &Common,
    inputs: &Inputs,
) -> Result<Option<Image>, Failure> {
    environment_from(&inputs.record(&Disk, "--environment"), overrides, common)
}

/// As [`environment`], through `files`.
///
/// # Errors
/// As [`environment`].
pub(crate) fn environment_from(
    files: &dyn Files,
    overrides: &Overrides,
    common: &Common,
) -> Result<Option<Image>, Failure> {
    let Some(path) = &overrides.model.environment else { return Ok(None) };
    let mut context = LoadContext::within(&common.memory.budget(), files);
    let image = image::read(path, &mut context)?;
    if let Some(fault) = panorama_fault(&image) {
        context.warn(&Location::file(path), fault);
    }
    exit::say_warnings(&context.warnings);
    Ok(Some(image))
}

/// Reads scenes only to record their input files in `inputs`. Errors are ignored here; they are reported when the scenes are
/// prepared.
pub(crate) fn read_ahead(scenes: &[PathBuf], common: &Common, overrides: &Overrides, inputs: &Inputs) {
    for scene in scenes {
        let files = inputs.record(&Piped, scene.display().to_string());
        let _ = load::scene(scene, &mut overrides.options(common, None).context(&files));
    }
}

/// Sets the number of threads for builds and renders. Call it once, before anything else.
///
/// # Errors
/// `Usage` where the threads cannot be started.
pub(crate) fn use_threads(common: &Common) -> Result<(), Failure> {
    let Some(threads) = common.threads else { return Ok(()) };
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads.into())
        .build_global()
        .map_err(|error| Failure::Usage(format!("--threads {threads}: {error}")))
}
