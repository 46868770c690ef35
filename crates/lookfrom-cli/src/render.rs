//! `lookfrom render`: pictures of scenes and models.

use std::path::Path;
use std::sync::mpsc::Receiver;
use std::time::Instant;

use lookfrom::denoise::denoised;
use lookfrom::render::{End, Enough, Frame};
use lookfrom_scene::Inputs;
use lookfrom_scene::image::Image;
use lookfrom_scene::scene::Origin;
use lookfrom_scene::settings::Layers;
use lookfrom_scene::studio;

use crate::args::{Fireflies, Overrides, RenderArguments};
use crate::exit::{self, DONE, Failure, INTERRUPTED, answer, say};
use crate::header::{self, Taken};
use crate::output::Target;
use crate::prepare::{self, Prepared, prepare};
use crate::preview::{Preview, SoFar};
use crate::progress::Watcher;
use crate::report::{self, Dropped, Seconds, Summary};
use crate::{interrupt, layers, naming};

/// The most samples that a pixel can be given.
const MOST_SAMPLES: u32 = 1 << 24;

/// What is clean enough where nobody said.
const ADAPTIVE_NOISE: f64 = 0.02;

/// Renders every scene; goes on after one that fails, with the code of the first failure.
pub(crate) fn run(arguments: &RenderArguments) -> u8 {
    let ready = naming::targets(&arguments.scenes, arguments.output.as_deref(), arguments.json)
        .and_then(|targets| prepare::use_threads(&arguments.common).map(|()| targets));
    let ready = ready.and_then(|targets| match arguments.write_every {
        Some(_) if targets.contains(&Target::Stdout) => Err(Failure::Usage(
            "--write-every needs a file to write again and again; -o - is none".to_owned(),
        )),
        _ => Ok(targets),
    });
    let ready = ready.and_then(|targets| match arguments.turntable {
        Some(_) if targets.contains(&Target::Stdout) => {
            Err(Failure::Usage("--turntable makes several files; -o - is none".to_owned()))
        }
        _ => Ok(targets),
    });
    let inputs = Inputs::default();
    let ready = ready.and_then(|targets| Ok((targets, prepare::environment(&arguments.overrides, &inputs)?)));
    let (targets, environment) = match ready {
        Ok(ready) => ready,
        Err(failure) => return failure.report(),
    };
    interrupt::listen();
    // A picture may be in the place of what a later scene reads. Where there is nothing yet, nothing can be lost.
    if targets.len() > 1 && targets.iter().flat_map(|target| pictures(target, arguments)).any(|t| t.exists())
    {
        prepare::read_ahead(&arguments.scenes, &arguments.overrides, &inputs);
    }
    let mut code = DONE;
    for (index, (scene, target)) in arguments.scenes.iter().zip(&targets).enumerate() {
        let of_scene = match render_all(scene, target, arguments, environment.as_ref(), &inputs) {
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

/// Where the pictures of one scene go: one, or those of a turntable.
fn pictures(target: &Target, arguments: &RenderArguments) -> Vec<Target> {
    match arguments.turntable {
        None => vec![target.clone()],
        Some(count) => (0..count).map(|number| target.numbered(number, count)).collect(),
    }
}

/// Renders all pictures of one scene.
fn render_all(
    path: &Path,
    target: &Target,
    arguments: &RenderArguments,
    environment: Option<&Image>,
    inputs: &Inputs,
) -> Result<u8, Failure> {
    let targets = pictures(target, arguments);
    let start = arguments.overrides.model.turn.unwrap_or(0.0);
    for number in 0..targets.len() {
        // Each picture is made as if it were the only one, so that it can be made, and inspected, alone.
        let mut overrides = arguments.overrides.clone();
        if let Some(count) = arguments.turntable {
            overrides.model.turn = Some(start + 360.0 * number as f64 / f64::from(count));
        }
        match render(path, &targets, number, arguments, &overrides, environment, inputs)? {
            DONE => {}
            code => return Ok(code),
        }
    }
    Ok(DONE)
}

/// Renders picture `number` of a scene and says what was done; gives the exit code.
fn render(
    path: &Path,
    targets: &[Target],
    number: usize,
    arguments: &RenderArguments,
    overrides: &Overrides,
    environment: Option<&Image>,
    inputs: &Inputs,
) -> Result<u8, Failure> {
    let target = &targets[number];
    let mut prepared = prepare(path, &arguments.common, overrides, environment, inputs)?;
    if number == 0 {
        if !arguments.quiet {
            exit::listed(&prepared.warnings).iter().for_each(|line| say(&format!("warning: {line}")));
        }
        keep_inputs(path, targets, inputs)?;
    }
    // A limit of time or noise replaces the scene's number of samples, not that of the command line.
    if arguments.overrides.samples.is_none() {
        if arguments.time.is_some() || arguments.noise.is_some() {
            prepared.render.samples = MOST_SAMPLES;
        } else if arguments.adaptive && prepared.origin != Origin::Scene {
            // A model's few samples for the denoiser leave nothing to adapt.
            prepared.render.samples = studio::MODEL_SAMPLES;
        }
    }
    if !target.has_layers() {
        prepared.image.layers = Layers::None;
    }
    let frame = Frame::new(&prepared.world, &prepared.image, &prepared.render);
    let frame = frame.map_err(exit::in_scene(path))?;
    interrupt::keeping(|| {
        let summary = render_frame(path, target, &prepared, &frame, arguments, inputs)?;
        if !arguments.quiet {
            say(&summary.for_people());
        }
        if arguments.json {
            answer(&summary.as_json())?;
        }
        Ok(if summary.cancelled { INTERRUPTED } else { DONE })
    })
}

/// Refuses pictures in the place of files that were read, and a scene that reads a picture of this call.
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

fn render_frame(
    path: &Path,
    target: &Target,
    prepared: &Prepared,
    frame: &Frame<'_>,
    arguments: &RenderArguments,
    inputs: &Inputs,
) -> Result<Summary, Failure> {
    // Render, and write what there is in between.
    let noise = arguments.noise.or(arguments.adaptive.then_some(ADAPTIVE_NOISE));
    let enough = Enough { time: arguments.time, noise };
    let started = Instant::now();
    let (rendered, samples_done) = std::thread::scope(|scope| {
        let preview = arguments.write_every.map(|every| {
            let (preview, pictures) = Preview::start(every);
            scope.spawn(move || write_previews(path, target, prepared, &pictures, inputs));
            preview
        });
        let watcher = Watcher::start(arguments.quiet, arguments.time, preview);
        let rendered = frame.render_until(&enough, arguments.common.threads.map(usize::from), &watcher);
        (rendered, watcher.finish())
    });
    let render_time = report::seconds(started.elapsed());
    let rendered = rendered.map_err(exit::in_scene(path))?;
    let film = &rendered.film;

    // Write; before the first sample there is nothing that could be called a picture.
    let area = film.area();
    let pixels = u64::from(area.x1 - area.x0) * u64::from(area.y1 - area.y0);
    let samples_taken = samples_done / pixels;
    let cancelled = rendered.end == End::Cancelled;
    let started = Instant::now();
    if samples_done > 0 {
        let spread = arguments.fireflies == Fireflies::Median;
        let taken = Taken {
            samples: if cancelled { prepared.render.samples } else { rendered.samples },
            mean: (cancelled || noise.is_some()).then_some(samples_taken),
            noise,
            fireflies_spread: spread,
            denoised: prepared.image.denoise,
        };
        let attributes = header::attributes(path, prepared, &taken);
        let mut picture = if spread { film.picture_without_fireflies() } else { film.picture() };
        let mut layers = if film.has_layers() { layers::channels(film) } else { Vec::new() };
        if prepared.image.denoise {
            picture = denoised(film, &picture);
            if target.has_layers() {
                layers.extend(layers::noisy(&prepared.image, film.picture()));
            }
        }
        target.write(&target.encode(&picture, &layers, &prepared.image, &attributes)?, inputs)?;
    }

    let rays = rendered.rays;
    Ok(Summary {
        scene: path.display().to_string(),
        output: (samples_done > 0).then(|| target.name()),
        width: prepared.image.width,
        height: prepared.image.height,
        samples: if cancelled { prepared.render.samples } else { rendered.samples },
        samples_taken,
        ended_by: match rendered.end {
            End::Samples => "samples",
            End::Time => "time",
            End::Noise => "noise",
            End::Cancelled => "interrupt",
        },
        relative_error: rendered.error.is_finite().then_some(rendered.error),
        integrator: prepared.render.integrator.word(),
        denoised: prepared.image.denoise && samples_done > 0,
        seconds: Seconds {
            read: report::seconds(prepared.read),
            build: report::seconds(prepared.build),
            render: render_time,
            write: report::seconds(started.elapsed()),
        },
        rays: rays.into(),
        mrays_per_s: rays.total() as f64 * 1e-6 / render_time.max(1e-6),
        peak_memory_bytes: report::peak_memory(),
        triangles: prepared.counts.triangles,
        spheres: prepared.counts.spheres,
        instances: prepared.counts.instances,
        warnings: prepared.warnings.iter().map(ToString::to_string).collect(),
        cancelled,
        dropped_samples: Dropped { count: film.dropped(), first: film.first_dropped().map(Into::into) },
    })
}

/// Writes pictures as they come. One that cannot be written is told of once; the last one, by others, is what counts.
fn write_previews(
    path: &Path,
    target: &Target,
    prepared: &Prepared,
    pictures: &Receiver<SoFar>,
    inputs: &Inputs,
) {
    let mut told = false;
    for (picture, mean) in pictures {
        let taken = Taken { samples: prepared.render.samples, mean: Some(mean), ..Taken::default() };
        let attributes = header::attributes(path, prepared, &taken);
        let bytes = target.encode(&picture, &[], &prepared.image, &attributes);
        if let Err(failure) = bytes.and_then(|bytes| target.write(&bytes, inputs))
            && !told
        {
            say(&format!("warning: no preview: {failure}"));
            told = true;
        }
    }
}
