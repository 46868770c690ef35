//! What does the camera see where nothing stands, if not the light that comes from there?
//!
//! A background of one's own is laid behind the picture when it is developed; here it only says what hides it.
//!
//! Only rays that come straight from the camera (or passed gaps in surfaces) are asked: mirrors and glass show the
//! surroundings. The floor of shadows (see `world::catcher`) is seen as the backdrop, too, so that its shadows lie on it.

use glam::Vec3;
use lookfrom_bvh::Hit;
use lookfrom_scene::settings::Background;

use super::Renderer;
use crate::integrator::{Catcher, Event, Next, Path, Probe, Shadow, Term, power_heuristic};
use crate::light::Light;
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
    /// The same, and the path has met what comes next.
    LeftFloor,
}

impl Renderer {
    /// Whether rays from the camera are asked at all.
    pub(super) fn has_backdrop(&self) -> bool {
        self.image().background != Background::Environment || self.world.catcher_irradiance.is_some()
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
            let met = &mut met[path.slot as usize];
            self.show_backdrop(&mut path, &hit, met, next);
            if *met == Met::Nothing && self.image().background != Background::Environment {
                next.probe.notice(|| Event::Met { path, hit });
                continue;
            }
            (paths[kept], hits[kept]) = (path, hit);
            kept += 1;
        }
        paths.truncate(kept);
        hits.truncate(kept);
    }

    /// Shows the backdrop to a ray from the camera, and says in `met` what it met; after `Nothing`, all is seen. Light from
    /// the floor is weighed so that it looks like the backdrop where no shadow falls.
    ///
    /// The path tracer's floor shows the backdrop less what is in the way of the light: the light that its samples would find
    /// if nothing stood there is expected, and subtracted ([`Renderer::expect_light`]). Where nothing does, nothing is left to
    /// be noise.
    fn show_backdrop<P: Probe>(&self, path: &mut Path, hit: &Hit, met: &mut Met, next: &mut Next<'_, P>) {
        let lanes = next.samples.lanes[path.slot as usize];
        if *met == Met::Floor && path.depth == 1 {
            *met = Met::LeftFloor;
            let expected = self.sky_found(path, &lanes);
            next.add(path, Term::Sky, expected * -1.0);
        }
        if path.depth > 0 {
            return;
        }
        *met = match hit.is_hit() {
            false => Met::Nothing,
            true if self.integrator.catcher() != Catcher::Surface
                && self.world.hits_catcher(&path.ray, hit) =>
            {
                Met::Floor
            }
            true => Met::Thing,
        };
        if *met == Met::Floor {
            let behind = self.behind(path, &lanes);
            if self.integrator.catcher() == Catcher::ControlVariate {
                next.add(path, Term::Sky, path.beta * behind);
            }
            let direction = Vec3::from_array(path.ray.direction);
            path.beta *= self.world.catcher_correction(direction, behind, &lanes);
        }
    }

    /// Subtracts what the lights infinitely far that paths asked at the floor just now bring if nothing is in the way.
    pub(super) fn expect_light<P: Probe>(&self, met: &[Met], next: &mut Next<'_, P>) {
        if self.integrator.catcher() != Catcher::ControlVariate {
            return;
        }
        let is_far = |shadow: &Shadow| match shadow.term {
            Term::Light(light) => {
                matches!(self.world.lights[light as usize], Light::Environment(_) | Light::Distant { .. })
            }
            _ => false,
        };
        for index in 0..next.samples.shadows.len() {
            let shadow = next.samples.shadows[index];
            if met[shadow.slot as usize] == Met::Floor && is_far(&shadow) {
                next.add_to(shadow.slot, shadow.address, Term::Sky, shadow.contribution * -1.0);
            }
        }
    }

    /// What the path tracer adds if a path that left the floor meets nothing.
    fn sky_found(&self, path: &Path, lanes: &Lanes) -> Spectrum {
        if self.integrator.catcher() != Catcher::ControlVariate {
            return Spectrum::BLACK;
        }
        let direction = Vec3::from_array(path.ray.direction).normalize();
        let at = path.reference();
        let lit =
            self.world.environments.iter().filter(|&&index| self.world.lights[index as usize].illuminates());
        lit.fold(Spectrum::BLACK, |sum, &index| {
            let light_pdf = self.world.light_pdf(index, &at, direction, None);
            let weight = power_heuristic(path.departure.pdf, light_pdf);
            sum + path.beta * self.world.sky_of(index, &path.ray, lanes) * weight
        })
    }

    fn behind(&self, path: &Path, lanes: &Lanes) -> Spectrum {
        match self.image().background {
            Background::Environment => self.world.sky(&path.ray, lanes),
            // White, so that what is seen is the share that shadows leave.
            Background::Color(_) | Background::Transparent => self.world.light_of([1.0; 3], lanes),
        }
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
            _ if self.image().background == Background::Environment => {
                (self.rgb(radiance * weight, lanes), 1.0)
            }
            Met::Thing => (self.rgb(radiance * weight, lanes), 1.0),
            Met::Nothing => ([0.0; 3], 0.0),
            Met::Floor | Met::LeftFloor => ([0.0; 3], 1.0 - math::luminance(self.rgb(radiance, lanes))),
        }
    }
}
