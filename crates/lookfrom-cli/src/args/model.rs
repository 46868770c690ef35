//! Options for pictures of models: surroundings, framing, and the parts of a file to show.
//!
//! The doc comments here are the help texts.

use std::path::PathBuf;

use clap::Args;
use lookfrom_scene::settings::Background;
use lookfrom_scene::{CameraChoice, ImportOptions};

use crate::values;

/// What surrounds a model, and what of its file is meant.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Models and their surroundings")]
pub(crate) struct ModelArguments {
    /// Columns and rows at once: 256 (a square) or 640x360
    #[arg(long, value_name = "N|WxH", value_parser = values::size, conflicts_with_all = ["width", "height"])]
    pub(crate) size: Option<[u32; 2]>,

    /// Light from all around: a picture in latitude and longitude (.hdr, .exr) in place of the studio, or of a scene's own
    /// environments
    #[arg(long, value_name = "FILE")]
    pub(crate) environment: Option<PathBuf>,

    /// Turn pictures of the surroundings around what is up, against the clock as seen from above
    #[arg(long, value_name = "DEGREES", value_parser = values::between(-36000.0f64, 36000.0), allow_hyphen_values = true)]
    pub(crate) rotate_environment: Option<f64>,

    /// What the camera sees where nothing stands: environment, transparent, white, black or #rrggbb
    ///
    /// The light stays that of the environment. Transparent pictures are for PNG (not multiplied by alpha) and EXR
    /// (multiplied). A colour is shown as it is, without exposure and tone map.
    #[arg(long, value_name = "WHAT", value_parser = values::background)]
    pub(crate) background: Option<Background>,

    /// Lay a floor under the model that is seen only by the shadows on it (with the path tracer)
    #[arg(long)]
    pub(crate) floor: bool,

    /// Turn the camera around what it looks at, and pictures of the surroundings with it: one picture of --turntable
    #[arg(long, value_name = "DEGREES", value_parser = values::between(-36000.0f64, 36000.0), allow_hyphen_values = true)]
    pub(crate) turn: Option<f64>,

    /// The animation of a glTF file in whose pose the model stands, by name or number from 0
    #[arg(long, value_name = "NAME|N")]
    pub(crate) animation: Option<String>,

    /// When in the animation: 1.5s, 500ms, 1.5
    #[arg(long, value_name = "TIME", value_parser = values::moment)]
    pub(crate) at: Option<f64>,

    /// The variant of a glTF file's materials, by name or number from 0
    #[arg(long, value_name = "NAME|N")]
    pub(crate) variant: Option<String>,

    /// The scene of a glTF file, by name or number from 0
    #[arg(long = "scene", value_name = "NAME|N")]
    pub(crate) scene_of_file: Option<String>,

    /// The camera of a glTF file, by name or number from 0; or none: any scene is framed as if it had no camera
    #[arg(long, value_name = "NAME|N")]
    pub(crate) camera: Option<String>,
}

impl ModelArguments {
    /// What is asked of files that hold several things.
    pub(crate) fn choice(&self) -> ImportOptions {
        ImportOptions {
            animation: self.animation.clone(),
            at: self.at.unwrap_or(0.0),
            variant: self.variant.clone(),
            scene: self.scene_of_file.clone(),
            camera: match self.camera.as_deref() {
                None => CameraChoice::First,
                Some("none") => CameraChoice::None,
                Some(name) => CameraChoice::Named(name.to_owned()),
            },
        }
    }
}
