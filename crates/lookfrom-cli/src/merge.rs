//! `lookfrom merge`: films of parts of a picture, added up.

use std::path::Path;

use lookfrom::session::{FilmFile, Format};
use lookfrom_scene::plural::counted;
use lookfrom_scene::{Disk, Inputs};

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
    let mut whole: Option<FilmFile> = None;
    let mut bad = Vec::new();
    for path in &arguments.films {
        let added = film::read_from(&files, path, budget).and_then(|mut part| {
            let to = target.as_ref().map_or(Path::new("."), Target::folder);
            film::rebase(&mut part.provenance, folder_or_here(path.parent()), to);
            match &mut whole {
                None => whole = Some(part),
                Some(whole) => whole.merge(&part).map_err(exit::in_scene(path))?,
            }
            Ok(())
        });
        if let Err(failure) = added {
            if !(arguments.check && arguments.quiet) {
                failure.report();
            }
            bad.push(path);
        }
    }
    if arguments.check {
        bad.iter().try_for_each(|path| answer(&path.display().to_string()))?;
    }
    if !bad.is_empty() {
        return Ok(BAD_SCENE);
    }
    if let (Some(target), Some(whole)) = (&target, whole) {
        target.keep_inputs(&inputs)?;
        let developed = whole.develop(&whole.provenance.development);
        film::write_file(target, &whole, &developed, &inputs)?;
        if !arguments.quiet {
            let (films, samples) = (arguments.films.len(), whole.film.ledger().most());
            let (films, samples) = (counted(films, "film"), counted(samples, "sample"));
            say(&format!("{films} → {}: {samples} per pixel", target.name()));
        }
    }
    Ok(DONE)
}
