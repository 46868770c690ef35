//! What does the camera see where nothing stands, if not the light that comes from there?
//!
//! A background of one's own is laid behind the picture when it is developed; here it only says what hides it.
//!
//! Only rays that come straight from the camera (or passed gaps in surfaces) are asked: mirrors and glass show the
//! surroundings. The floor of shadows (see `world::catcher`) is seen as the backdrop, too, so that its shadows lie on it.

use glam::Vec3;
use lookfrom_bvh::Hit;
use lookfrom_scene::settings::{Background, Integrator as Kind};

use super::Frame;
use crate::integrator::{Event, Next, Path, Probe};
use crate::math;
use crate::spectrum::Spectrum;
use crate::texture::Lanes;

/// What the camera's ray of a sample met, as far as it matters for what is behind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Met {
    /// Something that stands there.
    #[default]
    Thing,
    /// Nothing.
    Nothing,
    /// The floor of shadows.
    Floor,
}

impl Frame<'_> {
    /// Whether rays from the camera are asked at all.
    pub(super) fn has_backdrop(&self) -> bool {
        self.image.background != Background::Environment || self.world.catcher_irradiance.is_some()
    }

    /// Shows the backdrop to the rays of a batch that come from the camera, and notes what they met, by slot. Those that have
    /// seen all are taken out.
    pub(super) fn show_backdrops<P: Probe>(
        &self,
        paths: &mut Vec<Path>,
        hits: &mut Vec<Hit>,
        met: &mut [Met],
        next: &mut Next<'_, P>,
    ) {
        let mut kept = 0;
        for index in 0..paths.len() {
            let (mut path, hit) = (paths[index], hits[index]);
            if path.depth == 0 {
                let slot = path.slot as usize;
                met[slot] = self.show_backdrop(&mut path, &hit, next);
                if met[slot] == Met::Nothing && self.image.background != Background::Environment {
                    next.probe.notice(|| Event::Met { path, hit });
                    continue;
                }
            }
            (paths[kept], hits[kept]) = (path, hit);
            kept += 1;
        }
        paths.truncate(kept);
        hits.truncate(kept);
    }

    /// Shows the backdrop to a ray from the camera, and says what it met; after `Nothing`, all is seen. Light from the floor
    /// is weighed so that it looks like the backdrop where no shadow falls.
    fn show_backdrop<P: Probe>(&self, path: &mut Path, hit: &Hit, next: &mut Next<'_, P>) -> Met {
        let lanes = next.samples.lanes[path.slot as usize];
        if !hit.is_hit() {
            return Met::Nothing;
        }
        if !self.is_path_traced() || !self.world.hits_catcher(&path.ray, hit) {
            return Met::Thing;
        }
        let behind = self.behind(path, &lanes);
        let direction = Vec3::from_array(path.ray.direction);
        path.beta *= self.world.catcher_correction(direction, behind, &lanes);
        Met::Floor
    }

    fn behind(&self, path: &Path, lanes: &Lanes) -> Spectrum {
        match self.image.background {
            Background::Environment => self.world.sky(&path.ray, lanes),
            // White, so that what is seen is the share that shadows leave.
            Background::Color(_) | Background::Transparent => self.world.light_of([1.0; 3], lanes),
        }
    }

    fn is_path_traced(&self) -> bool {
        matches!(self.render.integrator, Kind::Path | Kind::SimplePath | Kind::RandomWalk)
    }

    /// The colour of a sample and how much of what is behind it hides, 1 for all: of the floor of shadows a picture
    /// with another background holds only that. Single samples may be outside of 0 … 1; their mean is not but for noise.
    pub(super) fn with_alpha(
        &self,
        radiance: Spectrum,
        weight: f32,
        lanes: &Lanes,
        met: Met,
    ) -> ([f32; 3], f32) {
        match met {
            _ if self.image.background == Background::Environment => {
                (self.rgb(radiance * weight, lanes), 1.0)
            }
            Met::Thing => (self.rgb(radiance * weight, lanes), 1.0),
            Met::Nothing => ([0.0; 3], 0.0),
            Met::Floor => ([0.0; 3], 1.0 - math::luminance(self.rgb(radiance, lanes))),
        }
    }
}
