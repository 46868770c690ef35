//! Values for the variables of scenes.
//!
//! The doc comments here are the help texts.

use clap::Args;
use lookfrom_scene::Variables;
use lookfrom_scene::variables::FPS;

use crate::values;

#[derive(Args, Clone, Debug)]
pub(crate) struct VariableArguments {
    /// Value of a variable of the scene, in place of that in its [variables]; may be repeated
    ///
    /// The value is TOML: 2.5, [1, 0, 0], { kelvin = 2700 }, "= 2 * t"; what is no TOML is a text: wood.png.
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUE", value_parser = values::definition)]
    pub(crate) define: Vec<(String, String)>,

    /// Time in animations of scenes and models: 1.5s, 500ms, 1.5
    #[arg(long, value_name = "TIME", value_parser = values::moment, allow_hyphen_values = true)]
    pub(crate) at: Option<f64>,

    /// Frames that the shutter is open, from the time on: what moves is blurred; films have 0.5
    #[arg(long, value_name = "FRAMES", value_parser = values::between(0.0f64, 1000.0), allow_hyphen_values = true)]
    pub(crate) shutter: Option<f64>,

    /// Frames per second, or a fraction such as 24000/1001: of --frames, of animated pictures, and of `frame` in a scene
    #[arg(long, value_name = "N", default_value_t = FPS, value_parser = values::frame_rate, allow_hyphen_values = true)]
    pub(crate) fps: f64,
}

impl Default for VariableArguments {
    fn default() -> Self {
        Self { define: Vec::new(), at: None, shutter: None, fps: FPS }
    }
}

impl VariableArguments {
    /// The values that replace those of the scene.
    pub(crate) fn variables(&self) -> Variables {
        Variables { values: self.define.iter().cloned().collect(), fps: self.fps }
    }
}
