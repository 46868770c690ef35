//! Backgrounds in place of the environment, as integrators show them to the camera.
//!
//! The background itself is laid behind the picture when that is developed; samples only say what hides it. Rays that come
//! straight from the camera (or passed gaps in surfaces) see it; mirrors and glass show the environment.

use lookfrom_scene::settings::Background;

use super::{Path, Probe, StepOutput, Term};
use crate::world::World;

/// What a sample hides of a background of the view's own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Alpha {
    /// All of it: something stands there.
    #[default]
    Opaque,
    /// Nothing: the sample shows the background.
    Transparent,
    /// The part that is in shadow: the sample shows a shadow catcher, and its light is the part of white that is left.
    Shadow,
}

impl<P: Probe> StepOutput<'_, P> {
    /// For a path that met nothing: whether it shows the view's own background instead of the environment, and so is done. Its
    /// sample is transparent then.
    pub fn shows_background(&mut self, path: &Path) -> bool {
        let shows = path.depth == 0 && self.background != Background::Environment;
        if shows {
            self.queues.alpha[path.slot as usize] = Alpha::Transparent;
        }
        shows
    }

    /// Adds what a path that met nothing sees: the environments, or the view's own background.
    pub(super) fn add_surroundings(&mut self, world: &World, path: &Path) {
        if !self.shows_background(path) {
            self.add(path, Term::Sky, path.beta * world.sky(&path.ray, &self.lanes(path)));
        }
    }
}
