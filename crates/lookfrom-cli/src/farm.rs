//! `lookfrom farm`: files for the schedulers that people have, so that many machines render one picture, or many.
//!
//! Every scheduler runs the same script, job.sh ([`script`]), once for each task, a part of a frame, and once to merge.
//! The script is safe to repeat: parts that are complete stay, those that were killed go on, damaged ones are rendered
//! again. So whatever a scheduler does, retries included, the pictures are the same.

mod dask;
mod hyperqueue;
mod openjd;
mod script;
mod slurm;

use std::fs;
use std::path::{Path, PathBuf};

use clap::ArgMatches;
use lookfrom::session::{Exposure, Options, Series, check_parts};
use lookfrom_scene::plural::counted;
use lookfrom_scene::scene::SourceFormat;
use lookfrom_scene::{Disk, Inputs, Location, Scene, Warning};

use crate::args::{Common, FarmArguments, Scheduler};
use crate::exit::{self, DONE, Failure, say};
use crate::{files, film, prepare};

/// A job, from which the files of all schedulers are made.
#[derive(Debug)]
struct Job {
    /// The name of the scene without extension, which pictures have.
    name: String,
    /// The absolute path of the scene.
    scene: PathBuf,
    /// The path of the scene relative to the job's folder.
    scene_from_folder: String,
    /// All files that it is read from, absolute.
    inputs: Vec<PathBuf>,
    /// Options of `lookfrom render` for all frames.
    options: Vec<String>,
    /// Options of each frame: one picture, or those of a turntable or an animation.
    frames: Vec<String>,
    /// Parts of each frame.
    parts: u32,
    /// The number of the first frame in the names of pictures, and the digits of all: those of `lookfrom render`.
    numbers: (u32, usize),
}

impl Job {
    /// Number of tasks.
    fn tasks(&self) -> u64 {
        self.frames.len() as u64 * u64::from(self.parts)
    }
}

/// Writes the files and returns the exit code.
pub(crate) fn run(arguments: &FarmArguments, matches: &ArgMatches) -> u8 {
    write(arguments, matches).map_or_else(|failure| failure.report(), |()| DONE)
}

fn write(arguments: &FarmArguments, matches: &ArgMatches) -> Result<(), Failure> {
    let job = job(arguments, matches)?;
    let folder = &arguments.output;
    let mut all = script::files(&job);
    let (of_scheduler, next) = match arguments.scheduler {
        Scheduler::OpenJd => (
            openjd::files(&job),
            "openjd run FOLDER/template.json -p file://FOLDER/parameters.json --step Merge --run-dependencies",
        ),
        Scheduler::Slurm => (slurm::files(&job), "sh FOLDER/submit.sh"),
        Scheduler::Dask => (dask::files(&job), "python3 FOLDER/submit.py tcp://SCHEDULER:8786"),
        Scheduler::HyperQueue => (hyperqueue::files(&job), "python3 FOLDER/submit.py"),
    };
    all.extend(of_scheduler);
    for (name, text) in all {
        let path = folder.join(name);
        let written = fs::create_dir_all(folder).and_then(|()| fs::write(&path, text));
        written.map_err(|error| Failure::Output(format!("cannot write {}: {error}", path.display())))?;
    }
    let shown = folder.display().to_string();
    let is_plain = shown.chars().all(|c| c.is_alphanumeric() || "/._-".contains(c));
    let next = next.replace("FOLDER", &if is_plain { shown } else { quoted(&shown) });
    say(&format!(
        "{}: {} × {} = {}\n  next: {next}",
        folder.display(),
        counted(job.frames.len(), "frame"),
        counted(job.parts, "part"),
        counted(job.tasks(), "task")
    ));
    Ok(())
}

fn job(arguments: &FarmArguments, matches: &ArgMatches) -> Result<Job, Failure> {
    let scene = &arguments.scene;
    let (loaded, inputs) = files::read(scene, &arguments.overrides.variables, &arguments.memory.budget())?;
    if !arguments.overrides.cryptomatte.is_empty() || !loaded.image.cryptomattes.is_empty() {
        let message =
            "what is merged has no Cryptomattes: render these on one machine, which needs few samples";
        exit::say_warnings(&[Warning::new(&Location::file(scene), message)]);
    }
    let series = arguments.series();
    let of_all = options_of_all(arguments, &series, &loaded)?;
    check_parts(loaded, &of_all, arguments.parts)?;
    let inputs = inputs.into_iter().map(|(path, _)| path);
    let environment = arguments.overrides.model.environment.iter().cloned();
    let inputs = inputs.chain(environment).map(|path| film::absolute(&path)).collect();
    let frame = |number| film::argument_of_picture(&series, number, &of_all).unwrap_or_default();
    let frames = (0..series.count()).map(frame).collect();
    let mut options = film::arguments_of_series(&film::arguments(matches), &series, &of_all);
    options.extend(
        arguments
            .overrides
            .crop
            .map(|crop| format!("--crop={},{},{},{}", crop.x0, crop.y0, crop.x1, crop.y1)),
    );
    // As it was typed: which unit is the user's affair.
    let memory = matches.get_raw("memory").into_iter().flatten();
    options.extend(memory.map(|size| format!("--memory={}", size.to_string_lossy())));
    if let Some(samples) = &arguments.overrides.samples {
        options.push(format!("--samples={}..{}", samples.start, samples.end));
    }
    let name = scene.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(Job {
        name,
        scene: film::absolute(scene),
        scene_from_folder: film::rebased(&scene.display().to_string(), Path::new(""), &arguments.output),
        inputs,
        options: options
            .iter()
            .map(|option| film::rebased_argument(option, Path::new(""), &arguments.output))
            .collect(),
        frames,
        parts: arguments.parts,
        numbers: (series.number(0)[0], series.label(0).map_or(0, |label| label.len())),
    })
}

/// The options of all pictures: of an animation the bounds and the exposure, too, as `render` chooses them once for all frames.
fn options_of_all(arguments: &FarmArguments, series: &Series, loaded: &Scene) -> Result<Options, Failure> {
    let FarmArguments { scene, overrides, memory, .. } = arguments;
    let common = Common { threads: None, strict: false, memory: *memory };
    let Series::Frames { .. } = series else { return Ok(overrides.options(&common, None)) };
    let inputs = Inputs::default();
    let environment = prepare::environment(overrides, &common, &inputs)?;
    let options = overrides.options(&common, environment.as_ref());
    let mut options = series.framed(scene, &Disk, &options).map_err(exit::in_scene(scene))?;
    let is_model = loaded.source_format != SourceFormat::Scene;
    let stops = match options.exposure {
        Some(Exposure::Stops(stops)) => stops,
        None if !is_model => loaded.image.exposure,
        _ => prepare::prepare(scene, &common, &series.options(0, &options), &inputs)?.image().exposure,
    };
    options.exposure = Some(Exposure::Stops(stops));
    Ok(options)
}

/// A word of a POSIX shell.
fn quoted(word: &str) -> String {
    format!("'{}'", word.replace('\'', r"'\''"))
}
