//! `lookfrom inspect`: a report on one sample, or on the samples of a pixel. The inspection itself is the library's.

use std::path::Path;

use lookfrom::inspect::{self, LightPlace, Selection};
use lookfrom::render::SampleId;
use lookfrom::session::Session;
use lookfrom_scene::digest::Digested;
use lookfrom_scene::{Disk, Files, Inputs};
use serde::Serialize;

use crate::args::{InspectArguments, Samples};
use crate::exit::{self, DONE, Failure};
use crate::files::InputFile;
use crate::output;
use crate::prepare;
use lookfrom_scene::json;
use lookfrom_scene::plural::counted;

/// A report as JSON, with all that is needed to have it again.
#[derive(Serialize)]
struct Document<'a, T> {
    /// The version of the program.
    version: &'static str,
    /// The scene's file.
    scene: String,
    /// The typed options that change the picture.
    options: &'a [String],
    /// Columns, rows and samples per pixel of the picture.
    picture: PictureSize,
    /// The files that the scene was read from.
    inputs: Vec<InputFile>,
    /// The lights by their index.
    lights: Vec<LightPlace>,
    /// The report's own keys.
    #[serde(flatten)]
    report: &'a T,
}

#[derive(Serialize)]
struct PictureSize {
    width: u32,
    height: u32,
    samples: u32,
}

/// Inspects samples of one pixel; `typed` are the options that change the picture.
pub(crate) fn run(arguments: &InspectArguments, typed: &[String]) -> u8 {
    match follow(arguments, typed) {
        Ok(()) => DONE,
        Err(failure) => failure.report(),
    }
}

fn follow(arguments: &InspectArguments, typed: &[String]) -> Result<(), Failure> {
    let is_of_many = matches!(arguments.sample, Samples::All | Samples::Range(_));
    let options = [
        ("--svg", arguments.svg.is_some()),
        ("--ray", arguments.ray.is_some()),
        ("--bounce", arguments.bounce.is_some()),
        ("--only", arguments.only.is_some()),
    ];
    if let Some((option, _)) = options.into_iter().find(|(_, is_typed)| *is_typed && is_of_many) {
        return Err(Failure::Usage(format!(
            "{option} shows the rays of one sample: choose it by --sample N or --sample worst"
        )));
    }
    prepare::use_threads(&arguments.common)?;
    let inputs = Inputs::default();
    let InspectArguments { scene, common, overrides, .. } = arguments;
    // Only JSON lists them, and digests take time.
    let digested = Digested::new(&Disk);
    let files: &dyn Files = if arguments.json { &digested } else { &Disk };
    let environment = prepare::environment_from(&inputs.record(files, "--environment"), overrides, common)?;
    let options = overrides.options(common, environment.as_ref());
    let of_scene = inputs.record(files, scene.display().to_string());
    let session = prepare::prepare_from(&of_scene, scene, common, &options)?;
    let read = digested.digests(Path::new("")).into_iter().map(InputFile::from).collect();
    let answer = Answer { arguments, typed, session: &session, inputs: read };
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
    let of_pixel = session.samples_of_pixel();
    let (fewest, most) = (*of_pixel.start(), *of_pixel.end());
    if chosen.end > most {
        let last = chosen.end - 1;
        let at_most = if fewest < most { "at most " } else { "" };
        return Err(Failure::Usage(format!(
            "there is no sample {last}: the picture has {at_most}{} per pixel, counted from 0",
            counted(most, "sample")
        )));
    }
    let renderer = session.renderer();
    let pixel = || inspect::inspect_pixel(renderer, [x, y], chosen.clone());
    let sample = match &arguments.sample {
        Samples::One(sample) => *sample,
        Samples::Worst => pixel()?.all[0].sample,
        Samples::All | Samples::Range(_) => {
            let report = pixel()?;
            let allocated = match fewest < most {
                true => format!(
                    "\nBy the noise around it, the picture takes {fewest} to {most} samples of a pixel\n"
                ),
                false => "\n".to_owned(),
            };
            return answer.print(&report, || format!("{report}{allocated}--sample N shows each step of one"));
        }
    };
    let inspection = inspect::inspect(renderer, SampleId { pixel: [x, y], sample });
    if let Some(path) = &arguments.svg {
        let drawing = inspect::svg(renderer, &inspection, arguments.svg_view.unwrap_or_default())?;
        output::replace_file(path, drawing.as_bytes(), &inputs, "--svg")?;
    }
    let &InspectArguments { ray, bounce, only: part, .. } = arguments;
    if let Some(ray) = ray.filter(|ray| inspection.ray(*ray).is_none()) {
        let known: Vec<String> = inspection.rays.iter().map(|ray| ray.address.to_string()).collect();
        return Err(Failure::Usage(format!("there is no ray {ray}: this sample has {}", known.join(", "))));
    }
    if let Some(bounce) = bounce.filter(|bounce| inspection.rays.iter().all(|ray| ray.depth != *bounce)) {
        return Err(Failure::Usage(format!(
            "there is no bounce {bounce}: no ray of this sample comes so far"
        )));
    }
    answer.print(&inspection, || inspection.excerpt(Selection { ray, bounce, part }).to_string())
}

/// The context of a printed report.
struct Answer<'a> {
    arguments: &'a InspectArguments,
    typed: &'a [String],
    session: &'a Session,
    inputs: Vec<InputFile>,
}

impl Answer<'_> {
    /// Prints a report as text or JSON.
    fn print(self, report: &impl Serialize, text: impl FnOnce() -> String) -> Result<(), Failure> {
        let Self { arguments, typed, session, inputs } = self;
        if !arguments.json {
            return exit::answer(text().trim_end());
        }
        let image = session.image();
        exit::answer(&json::document(&Document {
            version: env!("CARGO_PKG_VERSION"),
            scene: arguments.scene.display().to_string(),
            options: typed,
            picture: PictureSize {
                width: image.width,
                height: image.height,
                samples: session.settings().samples,
            },
            inputs,
            lights: inspect::lights(session.renderer().world()).collect(),
            report,
        }))
    }
}
