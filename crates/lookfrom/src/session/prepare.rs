//! From a scene as its file says it to one that makes a picture: options applied, framed, lit, with the settings that are left
//! open decided.

use std::path::Path;

use lookfrom_scene::scene::SourceFormat;
use lookfrom_scene::studio::Turntable;
use lookfrom_scene::{CameraChoice, ImportOptions, Location, Result, Scene, Warning, studio};

use super::options::{MOST_SAMPLES, Options};

/// What else became of a scene that was prepared.
pub(super) struct Prepared {
    /// What was added to show it.
    pub(super) added: Vec<&'static str>,
    /// What turns it, where that is asked for; the scene itself is not turned yet.
    pub(super) turntable: Option<Turntable>,
}

/// Applies options to a scene, and decides what both leave open.
///
/// # Errors
/// `Request` where the options do not suit the scene.
pub(super) fn prepare(
    scene: &mut Scene,
    file: &Path,
    options: &Options,
    warnings: &mut Vec<Warning>,
) -> Result<Prepared> {
    let mut warn = |message: &str| {
        warnings.push(Warning::new(&Location::file(file), message));
    };
    options.apply_to_settings(&mut scene.image, &mut scene.render)?;
    let origin = scene.source_format;
    decide_settings(scene, options);
    if scene.bounds().is_empty() {
        warn("nothing stands in this scene: the picture shows the background alone");
    }
    // Any file's camera can be left aside.
    let mut of_gltf = options.import.clone();
    if of_gltf.camera == CameraChoice::None {
        of_gltf.camera = CameraChoice::First;
    }
    if of_gltf != ImportOptions::default() && origin != SourceFormat::Gltf {
        warn("--animation, --at, --variant, --scene and --camera choose from a glTF file; this file is none");
    }
    if options.floor && !scene.render.integrator.is_path_traced() {
        warn("a floor that is seen only by its shadows needs the path tracer; here it is grey");
    }

    let had_camera = scene.camera.is_some();
    let lights = scene.lights.len();
    let up = options.up;
    // The camera comes first: inside a room it needs other light.
    let turntable = options.turn.map(|_| Turntable::new(scene, up, options.lookat));
    match &turntable {
        Some(turntable) => turntable.frame(scene),
        None => studio::frame(scene, up),
    }
    options.apply_to_camera(scene)?;
    if let Some(environment) = &options.environment {
        studio::surround(scene, environment.clone(), up);
    }
    // What glows in a glTF file is seldom meant to light it alone.
    if origin == SourceFormat::Gltf || origin == SourceFormat::Model && !studio::shines(scene) {
        studio::add_studio_and_camera(scene, up);
    } else {
        studio::add_lights_and_camera(scene, up);
    }
    let mut added = Vec::new();
    if !had_camera {
        added.push("camera");
    }
    if scene.lights.len() > lights && options.environment.is_none() {
        added.push("lights");
    }
    if let Some(degrees) = options.rotate_environment {
        studio::turn_environments(scene, up, degrees);
    }
    if options.floor {
        studio::add_floor(scene, up);
        added.push("floor");
    }
    Ok(Prepared { added, turntable })
}

/// Decides samples and denoising where nobody says otherwise.
fn decide_settings(scene: &mut Scene, options: &Options) {
    let is_model = scene.source_format != SourceFormat::Scene;
    if is_model {
        // Models are denoised until somebody says otherwise.
        scene.image.denoise = options.denoise.unwrap_or(scene.render.integrator.is_path_traced());
    }
    if options.samples.is_some() {
        return;
    }
    if options.stop.time.is_some() || options.stop.noise.is_some() {
        // A limit of time or noise takes the place of the scene's number of samples.
        scene.render.samples = MOST_SAMPLES;
    } else if is_model {
        // A model's few samples for the denoiser leave nothing to adapt.
        scene.render.samples = match options.adaptive {
            true => studio::MODEL_SAMPLES,
            false => studio::samples_for_models(&scene.image),
        };
    }
}
