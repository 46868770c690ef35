//! `lookfrom merge`: films of parts of a picture, added up.

use std::path::{Path, PathBuf};

use lookfrom::session::{FilmFile, FilmParts, Format, Provenance};
use lookfrom_scene::plural::counted;
use lookfrom_scene::{Budget, Disk, Files, Inputs};

use crate::args::MergeArguments;
use crate::exit::{self, BAD_SCENE, DONE, Failure, answer, say};
use crate::film;
use crate::output::{Target, folder_or_here};

/// Merges films and returns the exit code. All films that are damaged or do not belong to the others are told.
pub(crate) fn run(arguments: &MergeArguments) -> u8 {
    merge(arguments).unwrap_or_else(|failure| failure.report())
}

fn merge(arguments: &MergeArguments) -> Result<u8, Failure> {
    let target = match &arguments.output {
        None => None,
        Some(output) if Format::of_path(output) == Some(Format::Exr) => {
            let target = Target::File(output.clone(), Format::Exr);
            target.check()?;
            Some(target)
        }
        Some(output) => {
            return Err(Failure::Usage(format!("{} is no .exr, which a film needs", output.display())));
        }
    };
    let budget = &arguments.memory.budget();
    let inputs = Inputs::default();
    let files = inputs.record(&Disk, "the merge");
    let to = target.as_ref().map_or(Path::new("."), Target::folder);
    let mut bad = Vec::new();
    let tell = |failure: Failure| {
        if !(arguments.check && arguments.quiet) {
            failure.report();
        }
    };
    // Each is tested by its checksum, and whether it belongs to the others.
    let mut parts = FilmParts::new(&files, budget);
    for path in &arguments.films {
        let adapt = |provenance: &mut Provenance| film::rebase(provenance, folder_or_here(path.parent()), to);
        if let Err(error) = parts.add(path, adapt) {
            tell(Failure::from(error));
            bad.push(path);
        }
    }
    let is_in_bands = !arguments.check && parts.are_bands();
    let whole = match is_in_bands || !bad.is_empty() {
        true => None,
        false => films(arguments, &files, budget, to, &mut |path, failure| {
            tell(failure);
            bad.push(path);
        }),
    };
    if arguments.check {
        bad.iter().try_for_each(|path| answer(&path.display().to_string()))?;
    }
    if !bad.is_empty() {
        return Ok(BAD_SCENE);
    }
    if let Some(target) = &target {
        target.keep_inputs(&inputs)?;
        let samples = match (&whole, parts.whole()) {
            (Some(whole), _) => {
                let developed = whole.develop(&whole.provenance.development);
                film::write_file(target, whole, &developed, &inputs)?;
                whole.film.ledger().most()
            }
            (None, whole) => {
                film::write_parts(target, &parts, &inputs)?;
                whole.map_or(0, |whole| whole.film.ledger().most())
            }
        };
        if !arguments.quiet {
            let films = counted(arguments.films.len(), "film");
            say(&format!("{films} → {}: {} per pixel", target.name(), counted(samples, "sample")));
        }
    }
    Ok(DONE)
}

/// The sum of all films, in memory. Those that cannot be added are told.
fn films<'a>(
    arguments: &'a MergeArguments,
    files: &dyn Files,
    budget: &Budget,
    to: &Path,
    report: &mut dyn FnMut(&'a PathBuf, Failure),
) -> Option<FilmFile> {
    let mut whole: Option<FilmFile> = None;
    let mut room = None;
    for path in &arguments.films {
        let added = film::read_from(files, path, budget).and_then(|mut part| {
            film::rebase(&mut part.provenance, folder_or_here(path.parent()), to);
            // What is reserved makes room for what is needed with this part.
            room = None;
            room = Some(part.room_for(whole.as_ref(), budget, path)?);
            match &mut whole {
                None => whole = Some(part),
                Some(whole) => whole.merge(&part).map_err(exit::in_scene(path))?,
            }
            Ok(())
        });
        if let Err(failure) = added {
            report(path, failure);
        }
    }
    whole
}
