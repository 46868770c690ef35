//! Backgrounds in place of the environment, for camera rays.
//!
//! The background itself is laid behind the picture when that is developed; samples only give its alpha. Rays that come
//! straight from the camera (or passed surfaces by alpha) see it; mirrors and glass show the environment.

use lookfrom_bvh::Hit;
use lookfrom_scene::settings::Background;

use super::{Path, PathState, Probe, StepOutput, Term};
use crate::core::spectrum::Spectrum;
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// Alpha of a sample over the view's own background.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Alpha {
    /// The sample hides the background.
    #[default]
    Opaque,
    /// The sample shows the background, of which media on the way let this part pass: 1 where there are none.
    Transparent(f32),
    /// The sample shows a shadow catcher: its light is the unshadowed part of white, and the rest hides the background; but for this light,
    /// which media have added before it.
    Shadow(Spectrum),
}

impl<P: Probe, S: PathState> StepOutput<'_, P, S> {
    /// For a path that hit nothing: whether it shows the view's own background instead of the environment, and so ends.
    /// Its sample is then transparent, as far as media are.
    #[inline]
    pub fn shows_background(&mut self, path: &Path<S>) -> bool {
        let shows = path.depth == 0 && self.background != Background::Environment;
        if shows {
            self.queues.alpha[path.slot as usize] = Alpha::Transparent(passed(path.beta, &self.mode(path)));
        }
        shows
    }

    /// Adds the light of the environments to a path that hit nothing, unless it shows the view's own background.
    pub fn add_surroundings(&mut self, world: &World, path: &Path<S>) {
        if !self.shows_background(path) {
            self.add(
                path,
                Term::Sky,
                path.beta * world.sky(&path.ray, &self.queues.modes[path.slot as usize]),
            );
        }
    }

    /// [`StepOutput::add_surroundings`], attenuated by the medium that the path is in; `even_sky` is [`World::even_sky`].
    #[inline]
    pub(super) fn add_surroundings_behind_medium(
        &mut self,
        world: &World,
        path: &Path<S>,
        even_sky: Option<Spectrum>,
    ) {
        match even_sky {
            Some(sky) if path.interior.is_empty() => {
                if !self.shows_background(path) {
                    self.add(path, Term::Sky, path.beta * sky);
                }
            }
            _ => {
                let absorbed = self.absorbed(world, path, &Hit::MISS);
                self.add_surroundings(world, &absorbed);
            }
        }
    }
}

/// The part of light that has passed media, by the throughput of a path from the camera: the mean of its lanes.
fn passed(beta: Spectrum, mode: &SpectralMode) -> f32 {
    beta.sum() / mode.one().sum()
}
