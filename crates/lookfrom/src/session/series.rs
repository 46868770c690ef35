//! Several pictures of one scene: around it, from its sides, or of its animation.

use std::ops::Range;
use std::path::Path;

use lookfrom_scene::scene::Bounds;
use lookfrom_scene::studio::Viewpoint;
use lookfrom_scene::{Files, Result, load};

use super::{Options, Session};

/// The number of poses, at most, that the framing of an animation looks at.
const MOST_POSES: usize = 24;

/// The pictures of one scene.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Series {
    /// One.
    One,
    /// So many, at least one, evenly around it.
    Turntable(u32),
    /// Views, by name.
    Views(Vec<(&'static str, Viewpoint)>),
    /// Frames of its animation.
    Frames {
        /// By number: the first is at the animation's begin.
        frames: Range<u32>,
        /// Frames per second, > 0.
        fps: f64,
    },
}

impl Series {
    /// The number of pictures.
    pub fn count(&self) -> usize {
        match self {
            Self::One => 1,
            Self::Turntable(count) => *count as usize,
            Self::Views(views) => views.len(),
            Self::Frames { frames, .. } => frames.len(),
        }
    }

    /// The number of a picture in file names, and that of the last.
    pub fn number(&self, index: usize) -> [u32; 2] {
        let first = if let Self::Frames { frames, .. } = self { frames.start } else { 0 };
        let last = self.count().saturating_sub(1);
        [index, last].map(|index| first + index as u32)
    }

    /// The label of a picture in file names: its number, or the name of its view; `None` for the only one.
    pub fn label(&self, index: usize) -> Option<String> {
        let [number, last] = self.number(index);
        let numbered =
            |least: usize| format!("{number:0digits$}", digits = last.to_string().len().max(least));
        match self {
            Self::One => None,
            Self::Turntable(_) => Some(numbered(3)),
            Self::Views(views) => views.get(index).map(|(name, _)| (*name).to_owned()),
            Self::Frames { .. } => Some(numbered(4)),
        }
    }

    /// The options of a picture, from those of all.
    pub fn options(&self, index: usize, of_all: &Options) -> Options {
        let mut options = of_all.clone();
        match self {
            Self::One => {}
            Self::Turntable(_) => options.turn = self.turn(index, of_all),
            Self::Views(views) => options.view = views.get(index).map(|&(_, view)| view),
            Self::Frames { fps, .. } => {
                options.import.at = self.time(index);
                options.variables.fps = *fps;
            }
        }
        options
    }

    /// The time of a frame in seconds; `None` for other series.
    pub fn time(&self, index: usize) -> Option<f64> {
        let Self::Frames { fps, .. } = self else { return None };
        Some(f64::from(self.number(index)[0]) / fps)
    }

    /// The angle of a picture on a turntable in degrees; `None` for other series.
    pub fn turn(&self, index: usize, of_all: &Options) -> Option<f64> {
        let Self::Turntable(count) = self else { return None };
        Some(of_all.turn.unwrap_or(0.0) + 360.0 * index as f64 / f64::from(*count))
    }

    /// Makes the session of one picture that of another, where nothing needs to be read again for it; returns whether it has.
    ///
    /// # Errors
    /// As [`Session::set_turn`].
    pub fn go_to(&self, index: usize, of_all: &Options, session: &mut Session) -> Result<bool> {
        match self.turn(index, of_all) {
            Some(degrees) => session.set_turn(degrees).map(|()| true),
            None => Ok(matches!(self, Self::One)),
        }
    }

    /// The options of all pictures. Frames of an animation without a camera are framed as one: the bounds of its poses are
    /// in [`Options::bounds`], unless these have some, for which the scene is read at several times.
    ///
    /// # Errors
    /// Errors of the file's reader.
    pub fn framed(&self, path: &Path, files: &dyn Files, options: &Options) -> Result<Options> {
        let frames = match self {
            Self::Frames { frames, .. } if options.bounds.is_none() => frames,
            _ => return Ok(options.clone()),
        };
        let mut bounds = Bounds::EMPTY;
        let last = frames.len().saturating_sub(1);
        let steps = last.clamp(1, MOST_POSES - 1);
        let mut poses: Vec<usize> = (0..=steps).map(|step| last * step / steps).collect();
        poses.dedup();
        for index in poses {
            let scene = load::scene(path, &mut self.options(index, options).context(files))?;
            if scene.camera.is_some() && !options.chooses_view() && !options.floor {
                return Ok(options.clone());
            }
            bounds = bounds.union(scene.bounds());
        }
        Ok(Options { bounds: Some(bounds), ..options.clone() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_told_apart() {
        let labels =
            |series: Series| (0..series.count()).map(|k| series.label(k).unwrap()).collect::<Vec<_>>();
        assert_eq!(labels(Series::Turntable(2)), ["000", "001"]);
        assert_eq!(Series::Turntable(2000).label(7).unwrap(), "0007");
        assert_eq!(labels(Series::Frames { frames: 98..101, fps: 24.0 }), ["0098", "0099", "0100"]);
        assert_eq!(labels(Series::Views(Viewpoint::WORDS[..2].to_vec())), ["front", "right"]);
        assert_eq!((Series::One.count(), Series::One.label(0)), (1, None));
    }

    #[test]
    fn each_has_its_options() {
        let start = Options { turn: Some(10.0), ..Options::default() };
        assert_eq!(Series::Turntable(4).options(3, &start).turn, Some(280.0));
        let frames = Series::Frames { frames: 12..20, fps: 24.0 };
        assert_eq!(frames.options(6, &start).import.at, Some(0.75));
        let views = Series::Views(Viewpoint::WORDS.to_vec());
        assert_eq!(views.options(1, &start).view.map(|view| view.azimuth), Some(90.0));
    }
}
