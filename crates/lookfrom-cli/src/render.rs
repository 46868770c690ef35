//! `lookfrom render`: pictures of scenes and models.

use std::path::Path;
use std::time::Instant;

use lookfrom::render::Frame;

use crate::args::RenderArguments;
use crate::exit::{self, DONE, Failure, INTERRUPTED, answer, say};
use crate::output::{self, Target};
use crate::prepare::{self, Prepared, prepare};
use crate::progress::Watcher;
use crate::report::{self, Dropped, Seconds, Summary};
use crate::values::{self, INTEGRATORS};
use crate::{header, interrupt};

/// Renders every scene; goes on after one that fails, with the code of the first failure.
pub(crate) fn run(arguments: &RenderArguments) -> u8 {
    let ready = output::targets(&arguments.scenes, arguments.output.as_deref(), arguments.json)
        .and_then(|targets| prepare::use_threads(&arguments.common).map(|()| targets));
    let targets = match ready {
        Ok(targets) => targets,
        Err(failure) => return failure.report(),
    };
    interrupt::listen();
    let mut code = DONE;
    for (index, (scene, target)) in arguments.scenes.iter().zip(&targets).enumerate() {
        let of_scene = match render(scene, target, arguments) {
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

/// Renders one scene and says what was done; gives the exit code.
fn render(path: &Path, target: &Target, arguments: &RenderArguments) -> Result<u8, Failure> {
    let prepared = prepare(path, &arguments.common, &arguments.overrides)?;
    if !arguments.quiet {
        exit::listed(&prepared.warnings).iter().for_each(|line| say(&format!("warning: {line}")));
    }
    let frame = Frame::new(&prepared.world, &prepared.image, &prepared.render);
    let frame = frame.map_err(exit::in_scene(path))?;
    interrupt::keeping(|| {
        let summary = render_frame(path, target, &prepared, &frame, arguments)?;
        if !arguments.quiet {
            say(&summary.for_people());
        }
        if arguments.json {
            answer(&summary.as_json())?;
        }
        Ok(if summary.cancelled { INTERRUPTED } else { DONE })
    })
}

fn render_frame(
    path: &Path,
    target: &Target,
    prepared: &Prepared,
    frame: &Frame<'_>,
    arguments: &RenderArguments,
) -> Result<Summary, Failure> {
    // Render.
    let watcher = Watcher::start(arguments.quiet);
    let started = Instant::now();
    let rendered = frame.render(arguments.common.threads.map(usize::from), &watcher);
    let render_time = report::seconds(started.elapsed());
    let samples_done = watcher.finish();
    let rendered = rendered.map_err(exit::in_scene(path))?;
    let film = &rendered.film;

    // Write; before the first sample there is nothing that could be called a picture.
    let area = film.area();
    let pixels = u64::from(area.x1 - area.x0) * u64::from(area.y1 - area.y0);
    let samples_taken = samples_done / pixels;
    let started = Instant::now();
    if samples_done > 0 {
        let attributes = header::attributes(path, prepared, rendered.cancelled.then_some(samples_taken));
        let bytes = target.encode(&film.picture(), &prepared.image, &attributes)?;
        target.write(&bytes)?;
    }

    let rays = rendered.rays;
    Ok(Summary {
        scene: path.display().to_string(),
        output: (samples_done > 0).then(|| target.name()),
        width: prepared.image.width,
        height: prepared.image.height,
        samples: prepared.render.samples,
        samples_taken,
        integrator: values::name(INTEGRATORS, &prepared.render.integrator),
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
        cancelled: rendered.cancelled,
        dropped_samples: Dropped { count: film.dropped(), first: film.first_dropped().map(Into::into) },
    })
}
