//! Stop criteria, progress and result of a render.

use std::ops::Range;
use std::time::Duration;

use lookfrom_scene::settings::PixelBounds;
use lookfrom_scene::{Error, ErrorKind, Location, Result};

use super::Rays;
use crate::film::{Film, Picture};

/// Stop criteria, besides the number of samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StopCriteria {
    /// Stop after the pass over the picture that reaches this time. At least one sample of each pixel is taken. Never
    /// reached on wasm32-unknown-unknown, where nobody gave a clock ([`crate::core::clock`]).
    pub time: Option<Duration>,
    /// Stop when the picture's [relative error](Film::relative_error) is at most this: rounds of samples go to the pixels
    /// that lower it most. Not with samples that are allocated adaptively.
    pub noise: Option<f64>,
}

impl StopCriteria {
    /// Checks that the limit of noise is one that errors can be compared with.
    ///
    /// # Errors
    /// `Request` where it is not a number, or negative.
    pub(crate) fn check(&self) -> Result<()> {
        match self.noise {
            Some(noise) if !(noise >= 0.0) => {
                let message =
                    format!("the limit of noise is {noise}; expected a relative error of at least 0");
                Err(Error::new(ErrorKind::Request, &Location::default(), message))
            }
            _ => Ok(()),
        }
    }
}

/// The reason why a render ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum StopReason {
    /// Every pixel has all its samples.
    Samples,
    /// The time limit was reached.
    Time,
    /// The picture's error was low enough.
    Noise,
    /// It was cancelled.
    Cancelled,
}

impl StopReason {
    /// A word for summaries.
    pub fn word(self) -> &'static str {
        match self {
            Self::Samples => "samples",
            Self::Time => "time",
            Self::Noise => "noise",
            Self::Cancelled => "interrupt",
        }
    }
}

/// A tile that has received more samples.
#[derive(Clone, Debug)]
pub struct TileDone {
    /// Its pixels.
    pub area: PixelBounds,
    /// The new samples of each of them.
    pub samples: Range<u32>,
    /// Samples taken so far, of all pixels together.
    pub done: u64,
    /// Samples of all pixels together at the end; an estimate where a stop criterion may end the render.
    pub total: u64,
    /// Rays traced so far.
    pub rays: u64,
    /// The tile's picture so far, if [`Progress::wants_pixels`]: of the size of `area`, row by row from its top left,
    /// linear light.
    pub picture: Option<Picture>,
}

/// Receives the progress of a render, and may cancel it. Called from many threads; no lock is held during the call.
pub trait Progress: Sync {
    /// A tile has received more samples. Tiles may come in any order; those of one area come in the order of their samples if they have
    /// [pictures](Progress::wants_pixels).
    fn tile(&self, _done: TileDone) {}

    /// Whether tiles should come with their pictures.
    fn wants_pixels(&self) -> bool {
        false
    }

    /// Whether to stop before the next tile.
    fn cancelled(&self) -> bool {
        false
    }

    /// Whether to pause before the next tile for [`Progress::checkpoint`].
    fn wants_checkpoint(&self) -> bool {
        false
    }

    /// The film so far. No thread works on it meanwhile; a parallel loop of rayon runs on the threads of the render.
    fn checkpoint(&self, _film: &Film) {}
}

/// Ignores all progress.
impl Progress for () {}

/// The result of a render.
#[derive(Debug)]
pub struct Rendered {
    /// The film.
    pub film: Film,
    /// Numbers of rays traced.
    pub rays: Rays,
    /// The reason why it ended.
    pub reason: StopReason,
    /// Maximum number of samples of a pixel, without a cancelled pass.
    pub samples: u32,
    /// Samples of all pixels together.
    pub samples_taken: u64,
    /// The [relative error](Film::relative_error) of the whole picture.
    pub error: f64,
}
