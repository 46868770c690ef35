//! Preparation of a scene for rendering: options, auto-framing, lighting, and defaults for settings that are left open.

use std::path::Path;

use glam::DVec3;
use lookfrom_scene::scene::SourceFormat;
use lookfrom_scene::settings::{Allocation, RenderSettings};
use lookfrom_scene::studio::{Turntable, Viewpoint};
use lookfrom_scene::{CameraChoice, ImportOptions, Location, Remedy, Result, Scene, Warning, load, studio};

use super::options::{MOST_SAMPLES, Options};
use crate::film::allocation::LEAST_MEAN;
use crate::render::StopCriteria;

/// Results of the preparation besides the scene.
pub(super) struct Prepared {
    /// Additions to the scene.
    pub(super) added: Vec<&'static str>,
    /// The turntable, if enabled; the scene itself is not turned yet.
    pub(super) turntable: Option<Turntable>,
    /// Whether a model is lit by the lights of its file, whose unit nobody knows.
    pub(super) has_own_lights: bool,
}

/// Applies options to a scene, and chooses defaults for what both leave open.
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
    if let Some(format) = options.format {
        format.check_background(scene.image.background)?;
    }
    let origin = scene.source_format;
    decide_settings(scene, options);
    if scene.render.allocation == Allocation::Adaptive && scene.render.samples < LEAST_MEAN {
        let samples = scene.render.samples;
        warn(&format!(
            "adaptive allocation needs at least {LEAST_MEAN} samples per pixel: all pixels get {samples}"
        ));
        scene.render.allocation = Allocation::Uniform;
    }
    let is_empty = scene.bounds().is_empty();
    if is_empty {
        warn("this scene has no geometry: the picture shows only the background");
    }
    let mut of_gltf = ImportOptions { instanced_lights: false, ..options.import.clone() };
    // The camera of any file can be ignored, and any scene may have a clock.
    if of_gltf.camera == CameraChoice::None {
        of_gltf.camera = CameraChoice::First;
    }
    let may_be_toml = load::is_toml(file) || file == Path::new(load::PIPE);
    if origin == SourceFormat::Scene && may_be_toml {
        (of_gltf.at, of_gltf.shutter) = (None, None);
    }
    if of_gltf != ImportOptions::default() && origin != SourceFormat::Gltf {
        warn("`animation`, `at`, `variant`, `scene` and `camera` are for glTF files; this file is not one");
    }
    if options.floor && !scene.render.integrator.is_path_traced() {
        warn("a shadow-catching floor needs the path tracer; with this integrator it is grey");
    }

    let viewpoint = options.viewpoint();
    let mut up = options.up.or(scene.z_is_up.then_some(DVec3::Z));
    if scene.z_is_up && options.up.is_none() {
        let notice = Warning::notice(&Location::file(file), "z is up, as is the custom of this format");
        warnings.push(notice.remedy(Remedy::Up("y")));
    }
    if options.chooses_view() {
        // The camera of a view from above has another one.
        up = up.or_else(|| studio::up_of_camera(scene)).or(Some(DVec3::Y));
        scene.camera = None;
    }
    let had_camera = scene.camera.is_some();
    let lights = scene.lights.len();
    // The camera comes first: inside a room other lights are added.
    let turntable = options.turn.map(|_| Turntable::new(scene, up, options.lookat));
    match &turntable {
        Some(turntable) => turntable.frame(scene, &viewpoint),
        None => studio::frame(scene, up, &viewpoint, options.framed),
    }
    let middle = scene.bounds().center();
    if let Some(camera) = &mut scene.camera {
        options.apply_to_camera(camera, middle)?;
    }
    if let Some(environment) = &options.environment {
        studio::surround(scene, environment.clone(), up);
    }
    match origin {
        SourceFormat::Scene => studio::add_lights_and_camera(scene, up),
        _ => studio::add_studio_and_camera(scene, up),
    }
    let mut added = Vec::new();
    if !had_camera {
        added.push("camera");
    }
    if scene.lights.len() > lights && options.environment.is_none() {
        added.push("lights");
    }
    // The studio is one of the camera, wherever that is.
    let around = viewpoint.azimuth - Viewpoint::THREE_QUARTER.azimuth;
    let (is_model, has_studio) = (origin != SourceFormat::Scene, added.contains(&"lights"));
    if is_model && has_studio && around != 0.0 {
        studio::turn_environments(scene, up, around);
    }
    let is_lit_anew = has_studio || options.environment.is_some();
    let has_own_lights = is_model && !is_lit_anew && scene.render.integrator.needs_light();
    if let Some(degrees) = options.rotate_environment {
        studio::turn_environments(scene, up, degrees);
    }
    // A view that is asked for is no addition.
    let is_framed = options.chooses_view() || options.import.camera == CameraChoice::None;
    let lacks_camera = added.contains(&"camera") && !is_framed;
    if let Some(message) = told(lacks_camera, has_studio).filter(|_| !is_model && !is_empty) {
        warnings.push(Warning::notice(&Location::file(file), message));
    }
    if options.floor {
        studio::add_floor(scene, up, options.framed);
        added.push("floor");
    }
    Ok(Prepared { added, turntable, has_own_lights })
}

/// What a scene lacked and was given.
fn told(lacks_camera: bool, lacks_lights: bool) -> Option<&'static str> {
    match (lacks_camera, lacks_lights) {
        (true, true) => {
            Some("there is no camera and no light: one that sees everything is added, and a light")
        }
        (true, false) => Some("there is no camera: one that sees everything is added"),
        (false, true) => Some("there is no light: one is added"),
        (false, false) => None,
    }
}

/// Chooses defaults for samples and denoising.
fn decide_settings(scene: &mut Scene, options: &Options) {
    let is_model = scene.source_format != SourceFormat::Scene;
    if is_model {
        // Models are denoised by default.
        scene.image.denoise = options.denoise.unwrap_or(scene.render.integrator.is_path_traced());
    }
    if !settle_limits(&mut scene.render, options) && options.samples.is_none() && is_model {
        scene.render.samples = studio::samples_for_models(&scene.image);
    }
}

/// Settles what limits mean for samples: one of noise decides itself which pixels get them, and it, or one of time, replaces a number
/// that no option asks for; but what is allocated must be known beforehand. Returns whether the number was replaced.
pub(super) fn settle_limits(render: &mut RenderSettings, options: &Options) -> bool {
    let StopCriteria { time, noise } = options.stop;
    if noise.is_some() {
        render.allocation = Allocation::Uniform;
    }
    let is_allocated = render.allocation == Allocation::Adaptive;
    let is_replaced = options.samples.is_none() && (time.is_some() || noise.is_some()) && !is_allocated;
    if is_replaced {
        render.samples = MOST_SAMPLES;
    }
    is_replaced
}
