//! Options for pictures of models: surroundings, framing, and the parts of a file to show.
//!
//! The doc comments here are the help texts.

use std::path::PathBuf;

use clap::Args;
use lookfrom_scene::scene::Bounds;
use lookfrom_scene::settings::Background;
use lookfrom_scene::studio::Viewpoint;
use lookfrom_scene::subdivision::MOST_LEVELS;
use lookfrom_scene::{CameraChoice, ImportOptions};

use super::variables::VariableArguments;
use crate::values;

/// The surroundings of a model, and the selected parts of its file.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct ModelArguments {
    /// Width and height in pixels at once: 256 (a square) or 640x360
    #[arg(long, value_name = "N|WxH", value_parser = values::size, conflicts_with_all = ["width", "height"])]
    pub(crate) size: Option<[u32; 2]>,

    /// Environment light: an equirectangular map (.hdr, .exr) in place of the studio, or of a scene's own environments
    #[arg(long, value_name = "FILE")]
    pub(crate) environment: Option<PathBuf>,

    /// Rotate environment maps around the up vector, counter-clockwise as seen from above
    #[arg(long, value_name = "DEGREES", value_parser = values::between(-36000.0f64, 36000.0), allow_hyphen_values = true)]
    pub(crate) rotate_environment: Option<f64>,

    /// Background where the camera sees no surface: environment, transparent, white, black or #rrggbb
    ///
    /// The light stays that of the environment. Transparent pictures need PNG or WebP (straight alpha) or EXR (premultiplied
    /// alpha). A colour is shown as given, without exposure and tone map.
    #[arg(long, value_name = "BACKGROUND", value_parser = values::background)]
    pub(crate) background: Option<Background>,

    /// Add a shadow-catcher floor under the model: only the shadows on it are visible (with the path tracer)
    #[arg(long)]
    pub(crate) floor: bool,

    /// View that the scene is framed from, in place of its camera; persp is that of models without a camera
    ///
    /// The whole scene is in the picture. front, right, back, left, top, bottom and iso have parallel rays, unless --fov gives them a
    /// perspective.
    #[arg(long, value_name = "NAME", value_parser = values::word(Viewpoint::WORDS), conflicts_with_all = ["lookfrom", "camera"])]
    pub(crate) view: Option<Viewpoint>,

    /// Azimuth of the view, counter-clockwise as seen from above: 0 is the front, 90 the right side
    #[arg(long, value_name = "DEGREES", value_parser = values::between(-36000.0f64, 36000.0), allow_hyphen_values = true, conflicts_with_all = ["lookfrom", "camera"])]
    pub(crate) azimuth: Option<f64>,

    /// Elevation of the view above the horizon, -90 to 90
    #[arg(long, value_name = "DEGREES", value_parser = values::between(-90.0f64, 90.0), allow_hyphen_values = true, conflicts_with_all = ["lookfrom", "camera"])]
    pub(crate) elevation: Option<f64>,

    /// Box that is framed where the scene has no camera or a view replaces it, and that --floor lies under, in place of that around all
    #[arg(long, value_name = "X0,Y0,Z0,X1,Y1,Z1", value_parser = values::bounds, allow_hyphen_values = true, conflicts_with = "turn")]
    pub(crate) bounds: Option<Bounds>,

    /// Orbit the camera around the point that it looks at, with the environment: one picture of --turntable
    #[arg(long, value_name = "DEGREES", value_parser = values::between(-36000.0f64, 36000.0), allow_hyphen_values = true)]
    pub(crate) turn: Option<f64>,

    /// Animation that poses the model of a glTF file, by name or number from 0
    #[arg(long, value_name = "NAME|N")]
    pub(crate) animation: Option<String>,

    /// Material variant of a glTF file, by name or number from 0
    #[arg(long, value_name = "NAME|N")]
    pub(crate) variant: Option<String>,

    /// Scene of a glTF file, by name or number from 0
    #[arg(long = "scene", value_name = "NAME|N")]
    pub(crate) scene_of_file: Option<String>,

    /// Subdivide meshes this many times into smooth surfaces (Catmull-Clark), 0 to 8
    ///
    /// Quadrilaterals and other polygons of OBJ files are the cage; in other formats two triangles, one after the other, that make a
    /// flat quadrilateral are one face of it.
    #[arg(long, value_name = "LEVELS", value_parser = clap::value_parser!(u32).range(0..=i64::from(MOST_LEVELS)), default_value_t = 0, hide_default_value = true)]
    pub(crate) subdivide: u32,

    /// Let area lights in objects of pbrt's scenes emit light, each instance on its own; in pbrt they do not
    #[arg(long)]
    pub(crate) instanced_lights: bool,

    /// Camera of a glTF file, by name or number from 0; none frames any scene as if it had no camera
    #[arg(long, value_name = "NAME|N")]
    pub(crate) camera: Option<String>,
}

impl ModelArguments {
    /// The import options: which scene, camera, animation and variant of a file to use, at a time in seconds.
    pub(crate) fn choice(&self, variables: &VariableArguments) -> ImportOptions {
        ImportOptions {
            animation: self.animation.clone(),
            at: variables.at,
            shutter: variables.shutter,
            variant: self.variant.clone(),
            scene: self.scene_of_file.clone(),
            camera: match self.camera.as_deref() {
                None => CameraChoice::First,
                Some("none") => CameraChoice::None,
                Some(name) => CameraChoice::Named(name.to_owned()),
            },
            subdivision: self.subdivide,
            instanced_lights: self.instanced_lights,
        }
    }
}
