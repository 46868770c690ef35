//! `lookfrom inspect`: a report on one sample. The inspection itself is the library's.

use lookfrom::inspect;
use lookfrom::render::{Renderer, SampleId};
use lookfrom_scene::Inputs;

use crate::args::InspectArguments;
use crate::exit::{self, DONE, Failure};
use crate::output;
use crate::prepare::{self, prepare};
use lookfrom_scene::json;

/// Inspects one sample of one pixel.
pub(crate) fn run(arguments: &InspectArguments) -> u8 {
    match follow(arguments) {
        Ok(()) => DONE,
        Err(failure) => failure.report(),
    }
}

fn follow(arguments: &InspectArguments) -> Result<(), Failure> {
    prepare::use_threads(&arguments.common)?;
    let inputs = Inputs::default();
    let environment = prepare::environment(&arguments.overrides, &inputs)?;
    let InspectArguments { scene, common, overrides, .. } = arguments;
    let options = overrides.options(common, environment.as_ref());
    let session = prepare(scene, common, &options, &inputs)?;
    exit::say_warnings(session.warnings());
    let &InspectArguments { x, y, sample, .. } = arguments;
    let (width, height) = (session.image().width, session.image().height);
    if x >= width || y >= height {
        return Err(Failure::Usage(format!(
            "pixel {x} {y} is outside of the picture of {width} × {height} pixels"
        )));
    }
    let samples = session.settings().samples;
    if sample >= samples {
        return Err(Failure::Usage(format!(
            "there is no sample {sample}: the picture has {samples} samples per pixel, counted from 0"
        )));
    }
    report(session.renderer(), SampleId { pixel: [x, y], sample }, arguments, &inputs)
}

/// Prints the inspection as text or JSON, and writes the drawing of `--svg`.
fn report(
    renderer: &Renderer,
    id: SampleId,
    arguments: &InspectArguments,
    inputs: &Inputs,
) -> Result<(), Failure> {
    let inspection = inspect::inspect(renderer, id);
    if let Some(path) = &arguments.svg {
        let drawing = inspect::svg(renderer, &inspection);
        output::replace_file(path, drawing.as_bytes(), inputs, "--svg")?;
    }
    let text = if arguments.json { json::document(&inspection) } else { inspection.to_string() };
    exit::answer(text.trim_end())
}
