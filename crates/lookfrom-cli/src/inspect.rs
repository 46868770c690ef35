//! `lookfrom inspect`: all that happens on the way of one sample. The inspection itself is the library's.

use lookfrom::inspect;
use lookfrom::render::{Frame, SampleId};
use lookfrom_scene::Inputs;

use crate::args::InspectArguments;
use crate::exit::{self, DONE, Failure, say};
use crate::prepare::{self, prepare};
use crate::{json, output};

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
    let prepared = prepare(scene, common, overrides, environment.as_ref(), &inputs)?;
    exit::listed(&prepared.warnings).iter().for_each(|line| say(&format!("warning: {line}")));
    let &InspectArguments { x, y, sample, .. } = arguments;
    let (width, height) = (prepared.image.width, prepared.image.height);
    if x >= width || y >= height {
        return Err(Failure::Usage(format!(
            "pixel {x} {y} is not in the picture of {width} × {height} pixels"
        )));
    }
    if sample >= prepared.render.samples {
        return Err(Failure::Usage(format!(
            "there is no sample {sample}: the picture has {} samples a pixel, counted from 0",
            prepared.render.samples
        )));
    }
    let frame = Frame::new(&prepared.world, &prepared.image, &prepared.render)?;
    let id = SampleId { pixel: [x, y], sample };
    report(&frame, id, arguments, &inputs)
}

/// Answers as text or JSON, and with a drawing where one is asked for.
fn report(
    frame: &Frame<'_>,
    id: SampleId,
    arguments: &InspectArguments,
    inputs: &Inputs,
) -> Result<(), Failure> {
    let inspection = inspect::inspect(frame, id);
    if let Some(path) = &arguments.svg {
        let drawing = inspect::svg(frame.world(), &inspection);
        output::replace_file(path, drawing.as_bytes(), inputs, "--svg")?;
    }
    let text = if arguments.json { json::document(&inspection) } else { inspection.to_string() };
    exit::answer(text.trim_end())
}
