//! From a file to a world that rays can meet: read, changed by the command line, furnished, compiled.

use std::path::Path;
use std::time::{Duration, Instant};

use lookfrom::world::World;
use lookfrom_scene::camera::Camera;
use lookfrom_scene::scene::Bounds;
use lookfrom_scene::settings::{ImageSettings, RenderSettings};
use lookfrom_scene::{Disk, Location, Sources, Warning, load, model, studio};

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
    /// What the file has, without what was added to show it.
    pub(crate) counts: Counts,
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
/// gives warnings that `--strict` does not allow.
pub(crate) fn prepare(path: &Path, common: &Common, overrides: &Overrides) -> Result<Prepared, Failure> {
    // Read.
    let started = Instant::now();
    let mut sources = Sources::new(&Disk);
    let mut scene = load::scene(path, &mut sources)?;
    let mut warnings = sources.warnings;
    let read = started.elapsed();

    // Change and furnish.
    let started = Instant::now();
    overrides.apply_to_settings(&mut scene.image, &mut scene.render)?;
    let (counts, bounds) = (Counts::of(&scene), scene.bounds());
    if bounds.is_empty() {
        let message = "nothing stands in this scene: the picture shows the background alone".to_owned();
        warnings.push(Warning { at: Location::file(path), message });
    }
    let had_camera = scene.camera.is_some();
    let (lights, shapes) = (scene.lights.len(), scene.shapes.len());
    // The eye comes first: inside a room it needs other light.
    studio::frame(&mut scene, overrides.up);
    overrides.apply_to_camera(&mut scene)?;
    let bare_model = model::is_model(path);
    if bare_model {
        studio::furnish_with_floor(&mut scene, overrides.up);
    } else {
        studio::furnish(&mut scene, overrides.up);
    }
    let mut added = Vec::new();
    if !had_camera {
        added.push("camera");
    }
    if scene.lights.len() > lights {
        added.push("lights");
    }
    if bare_model && scene.shapes.len() > shapes {
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
    Ok(Prepared { world, image, render, camera, counts, bounds, added, warnings, read, build })
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
