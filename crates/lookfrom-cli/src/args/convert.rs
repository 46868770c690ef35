//! Arguments of `convert`.
//!
//! The doc comments here are the help texts.

use std::path::PathBuf;

use clap::Args;

use super::{Common, Overrides};
use crate::scenes;

pub(super) const EXAMPLES: &str = "\
Examples:
  lookfrom convert scene.pbrt -o scene.toml           scene.toml, with meshes and pictures in scene/
  lookfrom convert model.glb -o model.toml --floor    with the camera, the studio and the floor of its picture
  lookfrom convert scene.toml -D radius=2 -o two.toml

What is written is read back and compared before it is put into place: it gives the same picture, bit by bit.
Exit codes: 0 done, 1 the scene cannot be read, or has what the format has no words for; 2 usage, 3 output.";

#[derive(Args, Debug)]
pub(crate) struct ConvertArguments {
    #[arg(help = scenes::one(), value_name = "SCENE")]
    pub(crate) scene: PathBuf,

    /// Output: a file NAME.toml; meshes, pictures and tables are put into the folder NAME beside it
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: PathBuf,

    /// Replace files that exist, but never those that the scene is read from; others in the folder stay
    #[arg(long)]
    pub(crate) force: bool,

    /// Print nothing but errors
    #[arg(short, long)]
    pub(crate) quiet: bool,

    #[command(flatten)]
    pub(crate) common: Common,

    #[command(flatten)]
    pub(crate) overrides: Overrides,
}
