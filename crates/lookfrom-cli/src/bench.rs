//! `lookfrom bench`: rendering speed, and error × time.

use std::path::Path;
use std::time::Instant;

use lookfrom::film::Film;
use lookfrom::render::{Rendered, StopCriteria};
use lookfrom::session::{MOST_SAMPLES, Options};
use lookfrom_scene::image::compare::{Sampled, compare};
use lookfrom_scene::{Disk, Inputs, LoadContext};
use serde::Serialize;

use crate::args::BenchArguments;
use crate::compare::read;
use crate::exit::{self, DONE, Failure, answer};
use crate::prepare::{self, prepare};
use crate::report;
use lookfrom_scene::json;

/// Default number of samples per pixel.
const SAMPLES: u32 = 16;

/// Measurements of a scene; docs/guide/command.md explains the keys.
#[derive(Debug, Serialize)]
pub(crate) struct Measured {
    scene: String,
    samples: u64,
    read_seconds: f64,
    build_seconds: f64,
    render_seconds: f64,
    samples_per_s: f64,
    rays_per_s: f64,
    relative_mse: f64,
    error_time: f64,
    bias: [f64; 3],
}

/// Measures every scene and returns the exit code. A scene that fails does not stop the others; its code is kept.
pub(crate) fn run(arguments: &BenchArguments) -> u8 {
    let usage = (arguments.reference.is_some() && arguments.scenes.len() > 1)
        .then(|| Failure::Usage("--reference works with one scene only".to_owned()));
    if let Some(failure) = usage.or_else(|| prepare::use_threads(&arguments.common).err()) {
        return failure.report();
    }
    let mut code = DONE;
    let mut heading = !arguments.json;
    for scene in &arguments.scenes {
        let told = measure(scene, arguments).and_then(|measured| {
            if std::mem::take(&mut heading) {
                answer(HEADING)?;
            }
            answer(&if arguments.json { json::line(&measured) } else { measured.row() })
        });
        if let Err(failure) = told {
            let of_scene = failure.report();
            if code == DONE {
                code = of_scene;
            }
        }
    }
    code
}

const HEADING: &str =
    "scene                     samples  seconds  Msamples/s   Mrays/s  relative MSE  error × s";

fn measure(path: &Path, arguments: &BenchArguments) -> Result<Measured, Failure> {
    // No file is written, so no input can be overwritten.
    let inputs = Inputs::default();
    let environment = prepare::environment(&arguments.overrides, &arguments.common, &inputs)?;
    let most = if arguments.time.is_some() { MOST_SAMPLES } else { SAMPLES };
    let options = Options {
        samples: Some(arguments.overrides.samples.as_ref().map_or(most, |samples| samples.end)),
        // Light transport is measured, without the denoiser.
        denoise: Some(false),
        stop: StopCriteria { time: arguments.time, noise: None },
        ..arguments.overrides.options(&arguments.common, environment.as_ref())
    };
    let session = prepare(path, &arguments.common, &options, &inputs)?;
    exit::say_warnings(session.warnings());

    // The measured render.
    let _memory = session.room_for_picture().map_err(exit::in_scene(path))?;
    let renderer = session.renderer();
    let started = Instant::now();
    let rendered = renderer.render_until(&options.stop, options.threads, &());
    let Rendered { film, rays, samples_taken, .. } = rendered.map_err(exit::in_scene(path))?;
    let seconds = report::seconds(started.elapsed()).max(1e-6);
    let pixels = film.area().pixels();

    // The reference.
    let reference = match &arguments.reference {
        Some(file) => {
            let files = inputs.record(&Disk, "the comparison");
            read(file, None, None, &mut LoadContext::within(&arguments.common.memory.budget(), &files))?
        }
        None => {
            let mut other = session.settings().clone();
            (other.samples, other.seed) = (arguments.reference_samples, other.seed.wrapping_add(1));
            let other = renderer.with_settings(other).map_err(exit::in_scene(path))?;
            sampled(&other.render(options.threads, &()).map_err(exit::in_scene(path))?.film)
        }
    };
    let comparison = compare(&sampled(&film), &reference).map_err(exit::in_scene(path))?;
    Ok(Measured {
        scene: path.display().to_string(),
        samples: (samples_taken as f64 / pixels as f64).round() as u64,
        read_seconds: report::seconds(session.info().read),
        build_seconds: report::seconds(session.info().build),
        render_seconds: seconds,
        samples_per_s: samples_taken as f64 / seconds,
        rays_per_s: rays.total() as f64 / seconds,
        relative_mse: comparison.relative_mse,
        error_time: comparison.relative_mse * seconds,
        bias: comparison.relative,
    })
}

fn sampled(film: &Film) -> Sampled {
    let picture = film.picture();
    Sampled::of_colors(picture.width, picture.pixels)
}

impl Measured {
    fn row(&self) -> String {
        let Self { samples, render_seconds, relative_mse, error_time, .. } = self;
        let path = Path::new(&self.scene);
        // Scenes of other programs often share a file name (`scene.pbrt`) and differ in the folder.
        let parts: Vec<_> =
            path.components().rev().take(2).map(|part| part.as_os_str().to_string_lossy()).collect();
        let name = parts.into_iter().rev().collect::<Vec<_>>().join("/");
        format!(
            "{name:<25} {samples:>7}  {render_seconds:>7.2}  {:>10.3}  {:>8.2}  {relative_mse:>12.6}  {error_time:>9.5}",
            self.samples_per_s * 1e-6,
            self.rays_per_s * 1e-6,
        )
    }
}
