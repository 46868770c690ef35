//! Arguments of several pictures of a scene: turntables, views, frames, sheets.
//!
//! The doc comments here are the help texts.

use std::ops::Range;

use clap::Args;
use lookfrom::session::Series;

use crate::values::{self, Views};

#[derive(Args, Clone, Debug)]
pub(crate) struct SeriesArguments {
    /// Render this many pictures of each scene, evenly around it, as on a turntable: NAME-000.png, NAME-001.png …
    ///
    /// The camera orbits an upright axis, counter-clockwise as seen from above; environment light turns with it, other lights
    /// stay with the scene. The axis goes through the point that the scene's camera looks at (or --lookat), else through
    /// the centre of the visible geometry. A model is framed so that nothing is cropped at any angle.
    #[arg(long, value_name = "N", value_parser = values::whole(1u32, 100_000), conflicts_with = "bounds")]
    pub(crate) turntable: Option<u32>,

    /// Render these views of each scene, as --view has them, or all: NAME-front.png, NAME-right.png …
    #[arg(long, value_name = "NAME,…", value_parser = values::views, conflicts_with_all = ["turntable", "view", "lookfrom", "camera"])]
    pub(crate) views: Option<Views>,

    /// Render these frames of the animations of a scene or model, FROM..BEFORE, at --fps: NAME-0000.png, NAME-0001.png …
    ///
    /// Frame 0 is at the animation's begin, frame F at F / fps seconds. A model without a camera is framed once, for all poses.
    #[arg(long, value_name = "FROM..BEFORE", value_parser = values::frames, allow_hyphen_values = true, conflicts_with_all = ["turntable", "views", "at", "turn"])]
    pub(crate) frames: Option<Range<u32>>,

    /// Put all pictures of the call onto one sheet of so many columns and rows; without rows as many as it takes
    #[arg(long, value_name = "N|CxR", value_parser = values::sheet, conflicts_with_all = ["write_every", "film", "skip_existing"])]
    pub(crate) sheet: Option<(u32, Option<u32>)>,

    /// Leave out pictures whose files exist. Ctrl-C then leaves none that is half done; --continue is that of films
    #[arg(long, conflicts_with_all = ["write_every", "film"])]
    pub(crate) skip_existing: bool,
}

impl SeriesArguments {
    /// The pictures of each scene, with so many frames per second.
    pub(crate) fn series(&self, fps: f64) -> Series {
        match self {
            Self { turntable: Some(count), .. } => Series::Turntable(*count),
            Self { views: Some(views), .. } => Series::Views(views.clone()),
            Self { frames: Some(frames), .. } => Series::Frames { frames: frames.clone(), fps },
            _ => Series::One,
        }
    }
}
