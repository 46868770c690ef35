//! From a file to a world that rays can meet: read, changed by the command line, furnished, compiled.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use lookfrom::world::World;
use lookfrom_scene::camera::Camera;
use lookfrom_scene::contents::Contents;
use lookfrom_scene::image::{self, Image};
use lookfrom_scene::scene::{Bounds, Origin};
use lookfrom_scene::settings::{ImageSettings, RenderSettings};
use lookfrom_scene::studio::Turntable;
use lookfrom_scene::{CameraChoice, Choice, Disk, Inputs, Location, Sources, Warning, load, studio};

use crate::args::{Common, Overrides};
use crate::count::Counts;
use crate::exit::{self, Failure};

/// A world, and what is to be said about where it came from.
#[derive(Debug)]
pub(crate) struct Prepared {
    /// What light meets.
    pub(crate) world: World,
    /// The picture, with what the command line says.
    pub(crate) image: ImageSettings,
    /// The computation, with what the command line says.
    pub(crate) render: RenderSettings,
    /// The eye, with what the command line says.
    pub(crate) camera: Camera,
    /// What kind of file it was read from.
    pub(crate) origin: Origin,
    /// What the file has, without what was added to show it.
    pub(crate) counts: Counts,
    /// What can be chosen in the file.
    pub(crate) contents: Contents,
    /// The box around what the file has.
    pub(crate) bounds: Bounds,
    /// What was added to show it: "camera", "lights", "floor".
    pub(crate) added: Vec<&'static str>,
    /// What could be survived.
    pub(crate) warnings: Vec<Warning>,
    /// The time it took to read the file.
    pub(crate) read: Duration,
    /// The time it took from there to the world.
    pub(crate) build: Duration,
}

/// Makes a world of a scene or model file.
///
/// # Errors
/// `Scene` where the file cannot be read or made into a world, `Usage` where the overrides do not suit it, `Strict` where it
/// gives warnings that `--strict` does not allow. `environment` is that of the function of this name; every file that is
/// read joins `inputs`.
pub(crate) fn prepare(
    path: &Path,
    common: &Common,
    overrides: &Overrides,
    environment: Option<&Image>,
    inputs: &Inputs,
) -> Result<Prepared, Failure> {
    // Read.
    let started = Instant::now();
    let asked = &overrides.model;
    let files = inputs.record(&Disk, path.display().to_string());
    let mut sources = Sources { choice: asked.choice(), ..Sources::new(&files) };
    let mut scene = load::scene(path, &mut sources)?;
    let mut warnings = sources.warnings;
    let mut warn = |message: &str| {
        warnings.push(Warning { at: Location::file(path), message: message.to_owned() });
    };
    let read = started.elapsed();

    // Change and furnish.
    let started = Instant::now();
    overrides.apply_to_settings(&mut scene.image, &mut scene.render)?;
    let origin = scene.origin;
    if origin != Origin::Scene {
        // Models are denoised until somebody says otherwise.
        scene.image.denoise = overrides.denoise.unwrap_or(scene.render.integrator.is_path_traced());
        if overrides.samples.is_none() {
            scene.render.samples = studio::samples_for_models(&scene.image);
        }
    }
    let (counts, bounds) = (Counts::of(&scene), scene.bounds());
    let contents = std::mem::take(&mut scene.contents);
    if bounds.is_empty() {
        warn("nothing stands in this scene: the picture shows the background alone");
    }
    // Any file's camera can be left aside.
    let mut of_gltf = asked.choice();
    if of_gltf.camera == CameraChoice::None {
        of_gltf.camera = CameraChoice::First;
    }
    if of_gltf != Choice::default() && origin != Origin::Gltf {
        warn("--animation, --at, --variant, --scene and --camera choose from a glTF file; this file is none");
    }
    if asked.floor && !scene.render.integrator.is_path_traced() {
        warn("a floor that is seen only by its shadows needs the path tracer; here it is grey");
    }
    let had_camera = scene.camera.is_some();
    let lights = scene.lights.len();
    let up = overrides.up;
    // The eye comes first: inside a room it needs other light.
    let turn = asked.turn.map(|degrees| (Turntable::new(&scene, up, overrides.lookat), degrees));
    match &turn {
        Some((turntable, _)) => turntable.frame(&mut scene),
        None => studio::frame(&mut scene, up),
    }
    overrides.apply_to_camera(&mut scene)?;
    if let Some(environment) = environment {
        studio::surround(&mut scene, environment.clone(), up);
    }
    // What glows in a glTF file is seldom meant to light it alone.
    if origin == Origin::Gltf || origin == Origin::Model && !studio::shines(&scene) {
        studio::furnish_model(&mut scene, up);
    } else {
        studio::furnish(&mut scene, up);
    }
    let mut added = Vec::new();
    if !had_camera {
        added.push("camera");
    }
    if scene.lights.len() > lights && environment.is_none() {
        added.push("lights");
    }
    if let Some(degrees) = asked.rotate_environment {
        studio::turn_environments(&mut scene, up, degrees);
    }
    if let Some((turntable, degrees)) = turn {
        turntable.turn(&mut scene, degrees);
    }
    if asked.floor {
        studio::add_floor(&mut scene, up);
        added.push("floor");
    }

    // Compile.
    let (image, render) = (scene.image.clone(), scene.render.clone());
    let camera = scene.camera.clone().unwrap_or_default();
    let world = World::compile(scene, &mut warnings).map_err(exit::in_scene(path))?;
    let build = started.elapsed();
    if common.strict && !warnings.is_empty() {
        return Err(Failure::Strict(warnings));
    }
    Ok(Prepared { world, image, render, camera, origin, counts, contents, bounds, added, warnings, read, build })
}

/// The picture of the surroundings that the command line names, read once for all scenes.
///
/// # Errors
/// `Scene` where it cannot be read.
pub(crate) fn environment(overrides: &Overrides, inputs: &Inputs) -> Result<Option<Image>, Failure> {
    let Some(path) = &overrides.model.environment else { return Ok(None) };
    let files = inputs.record(&Disk, "--environment");
    Ok(Some(image::read(path, &mut Sources::new(&files))?))
}

/// Reads scenes for nothing but the files that they read, which join `inputs`. What is wrong with them is told when they are
/// prepared.
pub(crate) fn read_ahead(scenes: &[PathBuf], overrides: &Overrides, inputs: &Inputs) {
    for scene in scenes {
        let files = inputs.record(&Disk, scene.display().to_string());
        let _ = load::scene(scene, &mut Sources { choice: overrides.model.choice(), ..Sources::new(&files) });
    }
}

/// Sets how many threads build and render. Call it once, before anything else.
///
/// # Errors
/// `Usage` where there are no such threads to be had.
pub(crate) fn use_threads(common: &Common) -> Result<(), Failure> {
    let Some(threads) = common.threads else { return Ok(()) };
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads.into())
        .build_global()
        .map_err(|error| Failure::Usage(format!("--threads {threads}: {error}")))
}
