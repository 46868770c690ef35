//! `lookfrom resume`: the rest of a render that was stopped, or more samples.

use std::path::{Path, PathBuf};

use clap::Parser;
use lookfrom::session::{FilmFile, Format, Provenance};
use lookfrom_scene::Inputs;
use lookfrom_scene::settings::PixelBounds;

use crate::args::{Arguments, Command, RenderArguments, ResumeArguments};
use crate::exit::{self, Failure};
use crate::film;
use crate::interrupt;
use crate::output::{Target, folder_or_here};
use crate::picture::{self, Job, Outlet};
use crate::prepare::{self, prepare};
use crate::render;

/// Goes on with a film and returns the exit code.
pub(crate) fn run(arguments: &ResumeArguments) -> u8 {
    resume(arguments).unwrap_or_else(|failure| failure.report())
}

fn resume(arguments: &ResumeArguments) -> Result<u8, Failure> {
    prepare::use_threads(&arguments.common)?;
    let output = arguments.output.as_ref().unwrap_or(&arguments.film);
    if Format::of_path(output) != Some(Format::Exr) {
        let message = format!("{} is no .exr, which a film needs", output.display());
        return Err(Failure::Usage(message));
    }
    let target = Target::File(output.clone(), Format::Exr);
    target.check()?;
    let mut film = film::read(&arguments.film, &arguments.common.memory.budget())?;
    let folder = folder_or_here(arguments.film.parent());
    film::rebase(&mut film.provenance, folder, Path::new(""));
    find_files(&mut film.provenance, arguments, folder)?;
    let typed = film.provenance.arguments.clone();
    let of_render = render_arguments(arguments, &film)?;
    let scene = &of_render.scenes[0];
    let inputs = Inputs::default();
    let environment = prepare::environment(&of_render.overrides, &arguments.common, &inputs)?;
    let options = render::options(&of_render, &target, environment.as_ref());
    interrupt::listen();
    let session = prepare(scene, &of_render.common, &options, &inputs)?;
    if !arguments.quiet {
        exit::say_warnings(session.warnings());
    }
    target.keep_inputs(&inputs)?;
    interrupt::keeping(|| {
        let job = Job { arguments: &of_render, typed: &typed, inputs: &inputs, place: None };
        let summary = picture::render(scene, &target, &session, Some(film), &job, &mut Outlet::Target)?;
        picture::told(&summary, &of_render)
    })
}

/// Finds the scene and the environment map of a film, which may be named without folders.
///
/// # Errors
/// `Usage` where the scene is not found.
fn find_files(
    provenance: &mut Provenance,
    arguments: &ResumeArguments,
    folder: &Path,
) -> Result<(), Failure> {
    let here = Path::new(".");
    if let (Some(scene), None) = (&provenance.scene, &arguments.scene_file) {
        let missing = || {
            Failure::Usage(format!(
                "{} is of {scene}, which is neither there nor in this folder\n  help: name it: --scene-file SCENE",
                arguments.film.display()
            ))
        };
        let found = film::found(scene, [folder, here]).ok_or_else(missing)?;
        provenance.scene = Some(found.display().to_string());
    }
    let scene = arguments.scene_file.clone().or_else(|| provenance.scene.clone().map(PathBuf::from));
    let of_scene = scene.as_deref().map_or(here, |scene| folder_or_here(scene.parent()));
    for argument in &mut provenance.arguments {
        let Some(path) = argument.strip_prefix(film::ENVIRONMENT) else { continue };
        let found = || film::found(path, [folder, of_scene, here]);
        if let Some(path) = arguments.environment.clone().or_else(found) {
            *argument = format!("{}{}", film::ENVIRONMENT, path.display());
        }
    }
    Ok(())
}

/// The arguments of the render that the film is of, with those that were typed now.
fn render_arguments(arguments: &ResumeArguments, film: &FilmFile) -> Result<RenderArguments, Failure> {
    let provenance = &film.provenance;
    let scene = match &arguments.scene_file {
        Some(scene) => scene.clone().into_os_string(),
        None => provenance.scene.clone().unwrap_or_default().into(),
    };
    if scene.is_empty() {
        let message = format!("{} does not say which scene it is of", arguments.film.display());
        return Err(Failure::Usage(format!("{message}\n  help: name it: --scene-file SCENE")));
    }
    let mut words = vec!["lookfrom".into(), "render".into(), scene];
    words.extend(provenance.arguments.iter().map(Into::into));
    let parsed = Arguments::try_parse_from(words).map_err(|error| {
        Failure::Usage(format!(
            "{}: its arguments are not understood: {}",
            arguments.film.display(),
            error.kind()
        ))
    })?;
    let Command::Render(mut of_render) = parsed.command else {
        return Err(Failure::Usage(format!("{} is no film of a render", arguments.film.display())));
    };
    let PixelBounds { x0, y0, x1, y1 } = film.film.area();
    let is_crop = (x0, y0, x1, y1) != (0, 0, film.film.width(), film.film.height());
    of_render.overrides.crop = is_crop.then_some(film.film.area());
    of_render.keep.film = true;
    of_render.keep.checkpoint = arguments.checkpoint;
    (of_render.quiet, of_render.json) = (arguments.quiet, arguments.json);
    of_render.common = arguments.common;
    of_render.time = arguments.time;

    // The samples: those asked for now, or those that are missing; from the first that the film has.
    let first = film.film.ledger().range().map_or(0, |range| range.start);
    let first = provenance.goal.as_ref().map_or(first, |goal| goal.start);
    let before = provenance.noise().and_then(|noise| noise.parse().ok());
    of_render.noise = arguments.noise.or(before.filter(|_| arguments.samples.is_none()));
    let end = match (arguments.samples, &provenance.goal) {
        (Some(samples), _) => Some(samples),
        (None, Some(goal)) if arguments.noise.is_none() => Some(goal.end),
        _ => None,
    };
    of_render.overrides.samples = end.map(|end| first..end);
    if end.is_none() && of_render.time.is_none() && arguments.noise.is_none() {
        let message = format!("{} has all its samples", arguments.film.display());
        return Err(Failure::Usage(format!(
            "{message}\n  help: for more: --samples N, --time TIME or --noise ERROR"
        )));
    }
    Ok(of_render)
}
