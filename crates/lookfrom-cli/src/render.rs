//! `lookfrom render`: pictures of scenes and models.

use std::path::Path;
use std::sync::mpsc::Receiver;
use std::time::Instant;

use lookfrom::render::StopCriteria;
use lookfrom::session::{FilmFile, Format, Options, Session};
use lookfrom_scene::Inputs;
use lookfrom_scene::image::Image;

use crate::args::RenderArguments;
use crate::exit::{self, DONE, Failure, INTERRUPTED, answer, say};
use crate::film::{self, Checkpoints};
use crate::output::Target;
use crate::prepare::{self, prepare};
use crate::preview::{Preview, SoFar};
use crate::progress::Watcher;
use crate::report::{self, Summary};
use crate::{interrupt, naming};

/// Renders every scene and returns the exit code. A scene that fails does not stop the others; its code is kept. Films keep
/// `typed`, the arguments by which their sessions can be opened again.
pub(crate) fn run(arguments: &RenderArguments, typed: &[String]) -> u8 {
    let ready = naming::targets(&arguments.scenes, arguments.output.as_deref(), arguments.json)
        .and_then(|targets| arguments.encoding.apply(targets))
        .and_then(|targets| prepare::use_threads(&arguments.common).map(|()| targets));
    let ready = ready.and_then(|targets| match arguments.write_every {
        Some(_) if targets.iter().any(Target::is_stdout) => {
            Err(Failure::Usage("--write-every needs an output file; -o - is stdout".to_owned()))
        }
        _ => Ok(targets),
    });
    let ready = ready.and_then(|targets| match arguments.turntable {
        Some(_) if targets.iter().any(Target::is_stdout) => {
            Err(Failure::Usage("--turntable writes several files; -o - is stdout".to_owned()))
        }
        _ => Ok(targets),
    });
    let ready = ready.and_then(|targets| {
        match arguments.keep.film && targets.iter().any(|target| target.format() != Format::Exr) {
            true => Err(Failure::Usage(
                "--film needs an .exr: -o NAME.exr; make other pictures of it by lookfrom develop".to_owned(),
            )),
            false => Ok(targets),
        }
    });
    let inputs = Inputs::default();
    let ready = ready.and_then(|targets| Ok((targets, prepare::environment(&arguments.overrides, &inputs)?)));
    let (targets, environment) = match ready {
        Ok(ready) => ready,
        Err(failure) => return failure.report(),
    };
    interrupt::listen();
    // A picture may overwrite an input of a later scene. Where no output file exists yet, nothing can be lost.
    if targets.len() > 1 && targets.iter().flat_map(|target| pictures(target, arguments)).any(|t| t.exists())
    {
        prepare::read_ahead(&arguments.scenes, &arguments.overrides, &inputs);
    }
    let mut code = DONE;
    for (index, (scene, target)) in arguments.scenes.iter().zip(&targets).enumerate() {
        let of_scene = match render_all(scene, target, (arguments, typed), environment.as_ref(), &inputs) {
            Ok(of_scene) => of_scene,
            Err(failure) => {
                let of_failure = failure.report();
                if arguments.json {
                    let _ = answer(&report::failure(scene, &failure)).map_err(|failure| failure.report());
                }
                of_failure
            }
        };
        if interrupt::asked() && (of_scene == INTERRUPTED || index + 1 < targets.len()) {
            return INTERRUPTED;
        }
        if code == DONE {
            code = of_scene;
        }
    }
    code
}

/// Targets of the pictures of one scene: one, or those of a turntable.
fn pictures(target: &Target, arguments: &RenderArguments) -> Vec<Target> {
    match arguments.turntable {
        None => vec![target.clone()],
        Some(count) => (0..count).map(|number| target.numbered(number, count)).collect(),
    }
}

/// Renders all pictures of one scene, which is read once, prints the summaries and returns the exit code.
fn render_all(
    path: &Path,
    target: &Target,
    (arguments, typed): (&RenderArguments, &[String]),
    environment: Option<&Image>,
    inputs: &Inputs,
) -> Result<u8, Failure> {
    let targets = pictures(target, arguments);
    let start = arguments.overrides.model.turn.unwrap_or(0.0);
    let mut options = options(arguments, target, environment);
    options.turn = options.turn.or(arguments.turntable.map(|_| start));
    let mut session = prepare(path, &arguments.common, &options, inputs)?;
    if !arguments.quiet {
        exit::say_warnings(session.warnings());
    }
    keep_inputs(path, &targets, inputs)?;
    for (number, target) in targets.iter().enumerate() {
        let degrees = start + 360.0 * number as f64 / targets.len() as f64;
        if number > 0 {
            session.set_turn(degrees).map_err(exit::in_scene(path))?;
        }
        let mut typed = typed.to_vec();
        if arguments.turntable.is_some() {
            typed.retain(|argument| !argument.starts_with("--turn="));
            typed.push(format!("--turn={degrees}"));
        }
        let code = interrupt::keeping(|| -> Result<u8, Failure> {
            let film = if arguments.keep.go_on { film::existing(target)? } else { None };
            let summary = render_picture(path, target, &session, film, (arguments, &typed), inputs)?;
            told(&summary, arguments)
        })?;
        if code != DONE {
            return Ok(code);
        }
    }
    Ok(DONE)
}

/// Refuses pictures that would overwrite an input, and a scene that reads a picture of this call.
fn keep_inputs(path: &Path, targets: &[Target], inputs: &Inputs) -> Result<(), Failure> {
    targets.iter().try_for_each(|target| target.keep_inputs(inputs))?;
    let scene = path.display().to_string();
    match inputs.own_output(&scene) {
        None => Ok(()),
        Some(input) => Err(Failure::Output(format!(
            "{scene} reads {}, which this call has just written as the picture of another scene\n  help: render them \
             in two calls, or give the pictures a folder of their own with -o",
            input.path.display()
        ))),
    }
}

/// The options of a session for one target.
pub(crate) fn options(arguments: &RenderArguments, target: &Target, environment: Option<&Image>) -> Options {
    Options {
        stop: StopCriteria { time: arguments.time, noise: arguments.noise },
        adaptive: arguments.adaptive,
        fireflies: arguments.fireflies,
        format: Some(target.format()),
        film: arguments.keep.film,
        part: arguments.keep.part,
        ..arguments.overrides.options(&arguments.common, environment)
    }
}

/// Renders a picture, or the rest of one whose `film` is there, and writes it.
pub(crate) fn render_picture(
    path: &Path,
    target: &Target,
    session: &Session,
    film: Option<FilmFile>,
    (arguments, typed): (&RenderArguments, &[String]),
    inputs: &Inputs,
) -> Result<Summary, Failure> {
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
        let watcher = Watcher::start(arguments.quiet, arguments.time, preview, checkpoints.as_ref());
        let finished = match film {
            Some(film) => session.resume(film, &watcher),
            None => session.render(&watcher),
        };
        watcher.finish();
        finished
    });
    let render_time = report::seconds(started.elapsed());
    let finished = finished.map_err(in_scene)?;

    // Write, unless the render was stopped before the first sample.
    let started = Instant::now();
    let has_picture = finished.rendered.samples_taken > 0;
    if has_picture {
        match &provenance {
            Some(provenance) => film::write(target, provenance, &finished, inputs)?,
            None => {
                let bytes = finished.encode(target.format());
                let bytes = bytes
                    .map_err(|error| Failure::Output(format!("{}: {}", target.name(), error.message)))?;
                target.write(&bytes, inputs)?;
            }
        }
    }
    let mut summary = Summary::new(session, &finished);
    summary.output = has_picture.then(|| target.name());
    summary.denoised &= has_picture;
    // They take time that nobody should wait for who does not read of them.
    if arguments.json || !arguments.quiet {
        summary.find_fireflies(session, &finished);
    }
    summary.measured(render_time, report::seconds(started.elapsed()));
    Ok(summary)
}

/// Prints the summary of a picture, and returns the exit code.
pub(crate) fn told(summary: &Summary, arguments: &RenderArguments) -> Result<u8, Failure> {
    if !arguments.quiet {
        say(&summary.for_people());
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
        let bytes = bytes.map_err(|error| Failure::Output(format!("{}: {}", target.name(), error.message)));
        if let Err(failure) = bytes.and_then(|bytes| target.write(&bytes, inputs))
            && !told
        {
            say(&format!("warning: no preview: {failure}"));
            told = true;
        }
    }
}
