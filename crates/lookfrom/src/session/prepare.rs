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
/// `Request` where the options do not suit the scene, and for numbers of them that are out of range.
pub(super) fn prepare(
    scene: &mut Scene,
    file: &Path,
    options: &Options,
    warnings: &mut Vec<Warning>,
) -> Result<Prepared> {
    options.check_numbers()?;
    options.apply_to_settings(&mut scene.image, &mut scene.render)?;
    if let Some(format) = options.format {
        format.check_background(scene.image.background)?;
    }
    decide_settings(scene, options);
    let at = Location::file(file);
    warnings.extend(unsuitable(scene, file, options).into_iter().map(|message| Warning::new(&at, message)));

    let up = options.up.or(scene.z_is_up.then_some(DVec3::Z));
    if scene.z_is_up && options.up.is_none() {
        let notice = Warning::notice(&at, "z is up, as is the custom of this format");
        warnings.push(notice.remedy(Remedy::Up("y")));
    }
    // A view from above has another camera than the scene.
    let chooses_view = options.chooses_view();
    let up = up.or_else(|| chooses_view.then(|| studio::up_of_camera(scene).unwrap_or(DVec3::Y)));

    // The camera comes first: inside a room other lights are added.
    let lacks_camera = chooses_view || scene.camera.is_none();
    let turntable = place_camera(scene, up, options)?;
    let is_model = scene.source_format != SourceFormat::Scene;
    let has_added_lights = add_lights(scene, up, options);
    let mut added = Vec::new();
    if lacks_camera {
        added.push("camera");
    }
    if has_added_lights {
        added.push("lights");
    }
    let is_lit_anew = has_added_lights || options.environment.is_some();
    let has_own_lights = is_model && !is_lit_anew && scene.render.integrator.needs_light();

    // A view that is asked for is no addition.
    let is_framed = chooses_view || options.import.camera == CameraChoice::None;
    if let Some(message) = told(lacks_camera && !is_framed, has_added_lights)
        && !is_model
        && !scene.bounds().is_empty()
    {
        warnings.push(Warning::notice(&at, message));
    }
    if options.floor {
        studio::add_floor(scene, up, options.bounds);
        added.push("floor");
    }
    Ok(Prepared { added, turntable, has_own_lights })
}

/// Messages about options and settings that do not suit a scene; settings that cannot be are replaced.
fn unsuitable(scene: &mut Scene, file: &Path, options: &Options) -> Vec<String> {
    let mut messages = Vec::new();
    if scene.render.allocation == Allocation::Adaptive && scene.render.samples < LEAST_MEAN {
        let samples = scene.render.samples;
        messages.push(format!(
            "adaptive allocation needs at least {LEAST_MEAN} samples per pixel: all pixels get {samples}"
        ));
        scene.render.allocation = Allocation::Uniform;
    }
    // Fog with lamps in it is something to see.
    let is_in_medium =
        scene.render.media && scene.camera.as_ref().is_some_and(|camera| camera.medium.is_some());
    if scene.bounds().is_empty() && !is_in_medium {
        messages.push("this scene has no geometry: the picture shows only the background".to_owned());
    }
    let mut of_gltf = ImportOptions { instanced_lights: false, subdivision: 0, ..options.import.clone() };
    // The camera of any file can be ignored, and any scene may have a clock.
    if of_gltf.camera == CameraChoice::None {
        of_gltf.camera = CameraChoice::First;
    }
    let may_be_toml = load::is_toml(file) || file == Path::new(load::PIPE);
    if scene.source_format == SourceFormat::Scene && may_be_toml {
        (of_gltf.at, of_gltf.shutter) = (None, None);
    }
    if of_gltf != ImportOptions::default() && scene.source_format != SourceFormat::Gltf {
        messages.push(
            "`animation`, `at`, `variant`, `scene` and `camera` are for glTF files; this file is not one"
                .to_owned(),
        );
    }
    if let Some(format) = options.format.filter(|format| !format.has_layers() && options.asks_for_layers()) {
        messages.push(format!("{} pictures have no layers: they are in OpenEXR (.exr) alone", format.name()));
    }
    if options.bounds.is_some() && scene.camera.is_some() && !options.chooses_view() && !options.floor {
        messages.push(
            "`bounds` are for what is framed: this scene has a camera, which `view` or `camera` replaces"
                .to_owned(),
        );
    }
    if options.floor && !scene.render.integrator.is_path_traced() {
        messages.push(
            "a shadow-catching floor needs the path tracer; with this integrator it is grey".to_owned(),
        );
    }
    messages
}

/// Gives a scene the camera that options ask for, or one that it lacks. Returns the turntable, if it is to turn.
///
/// # Errors
/// As [`Options::apply_to_camera`].
fn place_camera(scene: &mut Scene, up: Option<DVec3>, options: &Options) -> Result<Option<Turntable>> {
    if options.chooses_view() {
        scene.camera = None;
    }
    let viewpoint = options.viewpoint();
    let turntable = options.turn.map(|_| Turntable::new(scene, up, options.lookat));
    match &turntable {
        Some(turntable) => turntable.frame(scene, &viewpoint),
        None => studio::frame(scene, up, &viewpoint, options.bounds),
    }
    let middle = scene.bounds().center();
    if let Some(camera) = &mut scene.camera {
        options.apply_to_camera(camera, middle)?;
    }
    Ok(turntable)
}

/// Gives a scene the environment that options ask for, or the lights that it lacks. Returns whether it lacked any.
fn add_lights(scene: &mut Scene, up: Option<DVec3>, options: &Options) -> bool {
    let lights = scene.lights.len();
    if let Some(environment) = &options.environment {
        studio::surround(scene, environment.clone(), up);
    }
    let is_model = scene.source_format != SourceFormat::Scene;
    match is_model {
        false => studio::add_lights_and_camera(scene, up),
        true => studio::add_studio_and_camera(scene, up),
    }
    let has_added = scene.lights.len() > lights && options.environment.is_none();
    // The studio is one of the camera, wherever that is.
    let around = options.viewpoint().azimuth - Viewpoint::THREE_QUARTER.azimuth;
    if is_model && has_added && around != 0.0 {
        studio::turn_environments(scene, up, around);
    }
    if let Some(degrees) = options.rotate_environment {
        studio::turn_environments(scene, up, degrees);
    }
    has_added
}

/// A message about what a scene lacked and was given.
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

/// Checks that a picture of a scene can be made in this many parts, each with its [`part`](Options::part).
///
/// # Errors
/// `Request` where a part would have no sample, for an adaptive picture, and where the options do not suit the scene's settings.
pub fn check_parts(mut scene: Scene, options: &Options, parts: u32) -> Result<()> {
    options.apply_to_settings(&mut scene.image, &mut scene.render)?;
    decide_settings(&mut scene, options);
    // No part is smaller than the first.
    Options { part: Some([1, parts]), ..options.clone() }.range(&scene.render).map(drop)
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
