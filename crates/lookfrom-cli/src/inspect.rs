//! `lookfrom inspect`: a report on one sample, or on the samples of a pixel. The inspection itself is the library's.

use lookfrom::inspect;
use lookfrom::render::{Renderer, SampleId};
use lookfrom_scene::Inputs;

use crate::args::{InspectArguments, Samples};
use crate::exit::{self, DONE, Failure};
use crate::output;
use crate::prepare::{self, prepare};
use lookfrom_scene::json;

/// Inspects samples of one pixel.
pub(crate) fn run(arguments: &InspectArguments) -> u8 {
    match follow(arguments) {
        Ok(()) => DONE,
        Err(failure) => failure.report(),
    }
}

fn follow(arguments: &InspectArguments) -> Result<(), Failure> {
    if arguments.svg.is_some() && matches!(arguments.sample, Samples::All | Samples::Range(_)) {
        let message = "--svg draws the rays of one sample: choose it by --sample N or --sample worst";
        return Err(Failure::Usage(message.into()));
    }
    prepare::use_threads(&arguments.common)?;
    let inputs = Inputs::default();
    let environment = prepare::environment(&arguments.overrides, &inputs)?;
    let InspectArguments { scene, common, overrides, .. } = arguments;
    let options = overrides.options(common, environment.as_ref());
    let session = prepare(scene, common, &options, &inputs)?;
    exit::say_warnings(session.warnings());
    let &InspectArguments { x, y, .. } = arguments;
    let (width, height) = (session.image().width, session.image().height);
    if x >= width || y >= height {
        return Err(Failure::Usage(format!(
            "pixel {x} {y} is outside of the picture of {width} × {height} pixels"
        )));
    }
    let samples = session.settings().samples;
    let chosen = match &arguments.sample {
        Samples::One(sample) => *sample..sample.saturating_add(1),
        Samples::Range(range) => range.clone(),
        Samples::Worst | Samples::All => 0..samples,
    };
    if chosen.end > samples {
        let last = chosen.end - 1;
        return Err(Failure::Usage(format!(
            "there is no sample {last}: the picture has {samples} samples per pixel, counted from 0"
        )));
    }
    let renderer = session.renderer();
    let pixel = || inspect::inspect_pixel(renderer, [x, y], chosen.clone());
    match &arguments.sample {
        Samples::One(sample) => report(renderer, *sample, arguments, &inputs),
        Samples::Worst => report(renderer, pixel()?.all[0].sample, arguments, &inputs),
        Samples::All | Samples::Range(_) => answer(&pixel()?, arguments),
    }
}

/// Prints the inspection of a sample, and writes the drawing of `--svg`.
fn report(
    renderer: &Renderer,
    sample: u32,
    arguments: &InspectArguments,
    inputs: &Inputs,
) -> Result<(), Failure> {
    let &InspectArguments { x, y, .. } = arguments;
    let inspection = inspect::inspect(renderer, SampleId { pixel: [x, y], sample });
    if let Some(path) = &arguments.svg {
        let drawing = inspect::svg(renderer, &inspection);
        output::replace_file(path, drawing.as_bytes(), inputs, "--svg")?;
    }
    answer(&inspection, arguments)
}

/// Prints a report as text or JSON.
fn answer(report: &(impl serde::Serialize + ToString), arguments: &InspectArguments) -> Result<(), Failure> {
    let text = if arguments.json { json::document(report) } else { report.to_string() };
    exit::answer(text.trim_end())
}
