//! Films in files: written at intervals and at the end, and read to go on.

use std::fs::File;
use std::io::BufWriter;
use std::path::{Component, Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use clap::parser::ValueSource;
use clap::{ArgAction, ArgMatches, Args, Command};
use lookfrom::film::Film;
use lookfrom::session::{Developed, Exposure, FilmFile, FilmParts, Finished, Options, Provenance, Series};
use lookfrom_scene::scene::Bounds;
use lookfrom_scene::{Budget, Disk, ErrorKind, Files, Inputs, LoadContext, Result as SceneResult};

use crate::args::Overrides;
use crate::exit::{Failure, say};
use crate::output::{self, Target, replace_file_by};

/// The interval between checkpoints unless another one is asked for.
pub(crate) const INTERVAL: Duration = Duration::from_secs(60);

/// Options that say which samples of a picture to render, not which picture: a film states its samples itself.
const OF_SAMPLES: [&str; 2] = ["samples", "crop"];

/// The typed arguments of `lookfrom render` that a session with the same picture needs, one an element, in a fixed order.
pub(crate) fn arguments(matches: &ArgMatches) -> Vec<String> {
    let known = known();
    let mut typed = Vec::new();
    for argument in known.get_arguments() {
        let id = argument.get_id().as_str();
        let Some(name) = argument.get_long() else { continue };
        // Not every subcommand has all of them.
        let is_typed =
            matches.try_contains_id(id).is_ok() && matches.value_source(id) == Some(ValueSource::CommandLine);
        if OF_SAMPLES.contains(&id) || !is_typed {
            continue;
        }
        if matches!(argument.get_action(), ArgAction::SetTrue) {
            typed.push(format!("--{name}"));
            continue;
        }
        let values = matches.get_raw(id).into_iter().flatten();
        typed.extend(values.map(|value| format!("--{name}={}", value.to_string_lossy())));
    }
    typed
}

/// The options that say which picture to render.
fn known() -> Command {
    Overrides::augment_args(Command::new("render")).arg(clap::Arg::new("fireflies").long("fireflies"))
}

/// The arguments of all pictures of a series, by those that were typed and the options of all.
pub(crate) fn arguments_of_series(typed: &[String], series: &Series, options: &Options) -> Vec<String> {
    let exposure = match options.exposure {
        Some(Exposure::Stops(stops)) => Some(format!("--exposure={stops}")),
        _ => None,
    };
    let bounds = options.bounds.map(|Bounds { min, max }| {
        let [x0, y0, z0, x1, y1, z1] = [min.x, min.y, min.z, max.x, max.y, max.z];
        format!("--bounds={x0},{y0},{z0},{x1},{y1},{z1}")
    });
    let (varied, decided) = match series {
        Series::Turntable(_) => ("turn", [None, None]),
        Series::Views(_) => ("view", [exposure, None]),
        Series::Frames { .. } => ("at", [exposure, bounds]),
        _ => return typed.to_vec(),
    };
    let decided: Vec<String> = decided.into_iter().flatten().collect();
    let is_replaced = |name: &str| name == varied || decided.iter().any(|argument| name_of(argument) == name);
    let kept = typed.iter().filter(|argument| !is_replaced(name_of(argument))).cloned();
    kept.chain(decided.iter().cloned()).collect()
}

/// The argument by which one picture of a series differs from others.
pub(crate) fn argument_of_picture(series: &Series, number: usize, of_all: &Options) -> Option<String> {
    match series {
        Series::Turntable(_) => series.turn(number, of_all).map(|degrees| format!("--turn={degrees}")),
        Series::Views(_) => series.label(number).map(|name| format!("--view={name}")),
        Series::Frames { .. } => series.time(number).map(|seconds| format!("--at={seconds}")),
        _ => None,
    }
}

/// The arguments by which the session of one picture of a series can be opened again, in the order of [`arguments`].
pub(crate) fn arguments_of_picture(
    typed: &[String],
    series: &Series,
    number: usize,
    of_all: &Options,
) -> Vec<String> {
    let mut all = arguments_of_series(typed, series, of_all);
    all.extend(argument_of_picture(series, number, of_all));
    let known = known();
    let names: Vec<&str> = known.get_arguments().filter_map(clap::Arg::get_long).collect();
    all.sort_by_key(|argument| names.iter().position(|name| name_of(argument) == *name));
    all
}

/// The name of an option that was typed.
fn name_of(argument: &str) -> &str {
    let argument = argument.strip_prefix("--").unwrap_or(argument);
    argument.split('=').next().unwrap_or(argument)
}

/// Paths of a film's scene and environment map, relative to one folder, from what they are relative to another.
pub(crate) fn rebase(provenance: &mut Provenance, from: &Path, to: &Path) {
    if let Some(scene) = &mut provenance.scene {
        *scene = rebased(scene, from, to);
    }
    for argument in &mut provenance.arguments {
        *argument = rebased_argument(argument, from, to);
    }
}

/// The one argument that is a path.
pub(crate) const ENVIRONMENT: &str = "--environment=";

/// An argument, relative to a folder if it is a path, from what is relative to another.
pub(crate) fn rebased_argument(argument: &str, from: &Path, to: &Path) -> String {
    match argument.strip_prefix(ENVIRONMENT) {
        Some(path) => format!("{ENVIRONMENT}{}", rebased(path, from, to)),
        None => argument.to_owned(),
    }
}

/// A path relative to a folder, from what is relative to another.
pub(crate) fn rebased(path: &str, from: &Path, to: &Path) -> String {
    let [path, to] = [&from.join(path), to].map(absolute);
    let common = path.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    if common == 0 {
        return path.display().to_string();
    }
    let up = to.components().skip(common).map(|_| Component::ParentDir);
    let relative: PathBuf = up.chain(path.components().skip(common)).collect();
    relative.display().to_string()
}

/// The absolute path without `.` and `..`.
pub(crate) fn absolute(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for component in std::path::absolute(path).unwrap_or_else(|_| path.to_owned()).components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir => {
                plain.pop();
            }
            other => plain.push(other),
        }
    }
    plain
}

/// Writes the film so far at intervals.
pub(crate) struct Checkpoints<'a> {
    every: Duration,
    target: &'a Target,
    provenance: &'a Provenance,
    inputs: &'a Inputs,
    /// The end of the last one.
    last: Mutex<Instant>,
    /// Whether a failure has been told.
    told: AtomicBool,
}

impl<'a> Checkpoints<'a> {
    /// Starts the clock.
    pub(crate) fn new(
        every: Duration,
        target: &'a Target,
        provenance: &'a Provenance,
        inputs: &'a Inputs,
    ) -> Self {
        Self {
            every,
            target,
            provenance,
            inputs,
            last: Mutex::new(Instant::now()),
            told: AtomicBool::new(false),
        }
    }

    /// Whether the interval has passed since the last checkpoint.
    pub(crate) fn is_due(&self) -> bool {
        self.last.lock().unwrap_or_else(PoisonError::into_inner).elapsed() >= self.every
    }

    /// Writes the film. The first failure is a warning: the render goes on, and the next checkpoint may succeed.
    pub(crate) fn write(&self, film: &Film) {
        let written = write_by(self.target, self.inputs, |file| self.provenance.write_checkpoint(film, file));
        if let Err(failure) = written
            && !self.told.swap(true, Ordering::Relaxed)
        {
            say(&format!("warning: no checkpoint: {failure}"));
        }
        *self.last.lock().unwrap_or_else(PoisonError::into_inner) = Instant::now();
    }
}

/// Writes the film of a finished picture.
///
/// # Errors
/// `Output` where that fails.
pub(crate) fn write(
    target: &Target,
    provenance: &Provenance,
    finished: &Finished,
    inputs: &Inputs,
) -> Result<(), Failure> {
    let Finished { rendered, developed, .. } = finished;
    let provenance = of_any_folder(provenance, &rendered.film);
    rescued(target, inputs, |file| provenance.write(&rendered.film, developed, file))
}

/// Writes a film from a file, with its picture.
///
/// # Errors
/// `Output` where that fails.
pub(crate) fn write_file(
    target: &Target,
    film: &FilmFile,
    developed: &Developed,
    inputs: &Inputs,
) -> Result<(), Failure> {
    let provenance = of_any_folder(&film.provenance, &film.film);
    rescued(target, inputs, |file| provenance.write(&film.film, developed, file))
}

/// Writes films of parts as one, with its picture.
///
/// # Errors
/// `Output` where that fails, also where a part cannot be read any more.
pub(crate) fn write_parts(target: &Target, parts: &FilmParts<'_>, inputs: &Inputs) -> Result<(), Failure> {
    write_by(target, inputs, |file| parts.write(of_any_folder, file))
}

fn write_by(
    target: &Target,
    inputs: &Inputs,
    write: impl FnOnce(&mut BufWriter<File>) -> SceneResult<()>,
) -> Result<(), Failure> {
    let Target::File(path, _) = target else {
        return Err(Failure::Usage("a film needs a file; -o - is stdout".to_owned()));
    };
    replace_file_by(path, inputs, "-o", |file| write(file).map_err(|error| error.message))
}

/// The provenance in a film's file. One that has all its samples has the same bytes in any folder: it names its scene and
/// environment map without the folders, where [`found`] looks for them.
fn of_any_folder(provenance: &Provenance, film: &Film) -> Provenance {
    let mut provenance = provenance.clone();
    if provenance.is_complete(film) {
        provenance.scene = provenance.scene.as_deref().map(file_name);
        for argument in &mut provenance.arguments {
            if let Some(path) = argument.strip_prefix(ENVIRONMENT) {
                *argument = format!("{ENVIRONMENT}{}", file_name(path));
            }
        }
    }
    provenance
}

/// The file that a film names: at its place, or of the same name in one of the `folders`.
pub(crate) fn found<'a>(named: &str, folders: impl IntoIterator<Item = &'a Path>) -> Option<PathBuf> {
    let name = file_name(named);
    let elsewhere = folders.into_iter().map(|folder| folder.join(&name));
    std::iter::once(PathBuf::from(named)).chain(elsewhere).find(|path| path.is_file())
}

/// The name of a file without its folder.
fn file_name(path: &str) -> String {
    Path::new(path).file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// As [`write_by`], of what must not be lost.
fn rescued(
    target: &Target,
    inputs: &Inputs,
    write: impl Fn(&mut BufWriter<File>) -> SceneResult<()>,
) -> Result<(), Failure> {
    let written = write_by(target, inputs, &write);
    written
        .or_else(|failure| output::rescue(target, failure, |file| write(file).map_err(|error| error.message)))
}

/// Reads a film.
///
/// # Errors
/// `Scene` where it cannot be read, is damaged, or is no film.
pub(crate) fn read(path: &Path, budget: &Budget) -> Result<FilmFile, Failure> {
    read_from(&Disk, path, budget)
}

/// As [`read`], through `files`.
///
/// # Errors
/// As [`read`].
pub(crate) fn read_from(files: &dyn Files, path: &Path, budget: &Budget) -> Result<FilmFile, Failure> {
    let bytes = LoadContext::within(budget, files).read(path)?;
    Ok(FilmFile::read(&bytes, path, budget)?)
}

/// The film that a target has already, to go on with. One that is damaged is none, with a warning.
///
/// # Errors
/// `Scene` where there is a file that is no film.
pub(crate) fn existing(target: &Target, budget: &Budget) -> Result<Option<FilmFile>, Failure> {
    let Target::File(path, _) = target else { return Ok(None) };
    if !target.exists() {
        return Ok(None);
    }
    match read(path, budget) {
        Ok(film) => Ok(Some(film)),
        Err(Failure::Scene(error)) if error.kind == ErrorKind::Syntax => {
            say(&format!("warning: {error}\n  it is rendered again"));
            Ok(None)
        }
        Err(failure) => Err(failure),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_lead_to_the_same_file_from_another_folder() {
        let of = |path: &str, from: &str, to: &str| rebased(path, Path::new(from), Path::new(to));
        assert_eq!(of("a/s.toml", "/w", "/w"), "a/s.toml");
        assert_eq!(of("a/s.toml", "/w", "/w/out/parts"), "../../a/s.toml");
        assert_eq!(of("../../a/s.toml", "/w/out/parts", "/w/out"), "../a/s.toml");
        assert_eq!(of("/x/./y/../s.toml", "/w", "/x/y"), "../s.toml");
        assert_eq!(of("s.toml", "a", "a"), "s.toml");
        assert_eq!(of("s.toml", "", "b"), "../s.toml");
    }
}
