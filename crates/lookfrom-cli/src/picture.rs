//! One picture of `lookfrom render`: rendered, with previews and checkpoints meanwhile, and written or gathered.

use std::path::Path;
use std::sync::mpsc::Receiver;
use std::time::Instant;

use lookfrom::render::StopReason;
use lookfrom::session::{FilmFile, Finished, Session};
use lookfrom_scene::Inputs;

use crate::args::RenderArguments;
use crate::exit::{self, DONE, Failure, INTERRUPTED, answer, say};
use crate::film::{self, Checkpoints};
use crate::output::Target;
use crate::preview::{Preview, SoFar};
use crate::progress::Watcher;
use crate::report::{self, Summary};
use crate::terminal;

/// The destination of a finished picture.
pub(crate) enum Outlet<'a> {
    /// It is written to its target.
    Target,
    /// It is a part of the picture at the target, which is written later.
    Gathered(&'a mut dyn FnMut(&Finished) -> Result<(), Failure>),
}

/// The call that a picture is part of.
pub(crate) struct Job<'a> {
    pub(crate) arguments: &'a RenderArguments,
    /// The arguments by which a session with the same picture can be opened again.
    pub(crate) typed: &'a [String],
    pub(crate) inputs: &'a Inputs,
    /// The number of the picture in the call, from 1, and the number of all, if it is one of several.
    pub(crate) place: Option<[usize; 2]>,
}

/// Renders a picture, or the rest of one whose `film` is there, and writes it.
pub(crate) fn render(
    path: &Path,
    target: &Target,
    session: &Session,
    film: Option<FilmFile>,
    job: &Job<'_>,
    outlet: &mut Outlet<'_>,
) -> Result<Summary, Failure> {
    let &Job { arguments, typed, inputs, place } = job;
    let in_scene = exit::in_scene(path);
    let provenance = match arguments.keep.film {
        false => None,
        true => {
            let mut provenance = session.provenance().map_err(&in_scene)?;
            provenance.scene = Some(path.display().to_string());
            provenance.arguments = typed.to_vec();
            film::rebase(&mut provenance, Path::new(""), target.folder());
            Some(provenance)
        }
    };
    let every = arguments.keep.checkpoint.unwrap_or(film::INTERVAL);
    let checkpoints =
        provenance.as_ref().map(|provenance| Checkpoints::new(every, target, provenance, inputs));

    // Render, and write previews and checkpoints meanwhile.
    let started = Instant::now();
    let finished = std::thread::scope(|scope| {
        let preview = arguments.write_every.map(|every| {
            let (preview, pictures) = Preview::start(every, session.image());
            scope.spawn(move || write_previews(target, session, &pictures, inputs));
            preview
        });
        let doing = place.map(|[number, count]| format!("{number} of {count}  {}  ", target.name()));
        let watcher = Watcher::start(arguments.quiet, doing, arguments.time, preview, checkpoints.as_ref());
        let finished = match film {
            Some(film) => session.resume(film, &watcher),
            None => session.render(&watcher),
        };
        watcher.finish();
        finished
    });
    let render_time = report::seconds(started.elapsed());
    let finished = finished.map_err(in_scene)?;

    let is_cell = arguments.several.sheet.is_some();
    if let Some(way) = arguments.way().filter(|_| !is_cell && finished.rendered.samples_taken > 0) {
        terminal::draw(&finished.shown(), way)?;
    }

    // Write, unless the render was stopped before the first sample, or the next call would take what there is for the whole.
    let started = Instant::now();
    let is_half_done = finished.rendered.reason == StopReason::Cancelled && arguments.several.skip_existing;
    let has_picture = finished.rendered.samples_taken > 0 && !is_half_done;
    if has_picture {
        match (&provenance, outlet) {
            (Some(provenance), _) => film::write(target, provenance, &finished, inputs)?,
            (None, Outlet::Gathered(gather)) => gather(&finished)?,
            (None, Outlet::Target) => {
                target.write_by(inputs, &|mut out| finished.write(target.format(), &mut out))?;
            }
        }
    }
    let mut summary = Summary::new(session, &finished);
    summary.place = place;
    summary.output = has_picture.then(|| target.name());
    summary.denoised &= has_picture;
    // They take time that nobody should wait for who does not read of them.
    if arguments.json || !arguments.quiet {
        summary.find_fireflies(session, &finished);
    }
    if arguments.json {
        summary.hash = Some(finished.rendered.film.hash());
    }
    summary.measured(render_time, report::seconds(started.elapsed()));
    Ok(summary)
}

/// Prints the summary of a picture, and returns the exit code.
pub(crate) fn told(summary: &Summary, arguments: &RenderArguments) -> Result<u8, Failure> {
    if !arguments.quiet {
        say(&summary.for_people());
        if arguments.verbose > 0 {
            say(&summary.steps());
        }
    }
    if arguments.json {
        answer(&summary.as_json())?;
    }
    Ok(if summary.cancelled { INTERRUPTED } else { DONE })
}

/// Writes previews as they arrive. Only the first failure is reported; the final picture is written elsewhere.
fn write_previews(target: &Target, session: &Session, pictures: &Receiver<SoFar>, inputs: &Inputs) {
    let mut told = false;
    for (picture, mean) in pictures {
        let bytes = session.encode_preview(&picture, mean, target.format());
        let bytes = bytes.map_err(|error| target.cannot_encode(&error));
        if let Err(failure) = bytes.and_then(|bytes| target.write(&bytes, inputs))
            && !told
        {
            say(&format!("warning: no preview: {failure}"));
            told = true;
        }
    }
}
