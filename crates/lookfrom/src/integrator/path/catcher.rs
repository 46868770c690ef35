//! Shadow catchers in path tracing: surfaces that show the background, less the light that is blocked.
//!
//! Paths that leave the catcher estimate the light that arrives there, and its reflectance is such that unshadowed it
//! would look like the background (see `world::catcher`). With multiple importance sampling the light that a path's
//! samples would find without any blocker is a control variate: its expectation is shown and the sample subtracted, so
//! that there is no noise where nothing casts a shadow.

use glam::Vec3;
use lookfrom_scene::settings::Background;

use super::{LightSampling, PathTracer};
use super::{Path, StepOutput};
use crate::core::math::power_heuristic;
use crate::core::spectrum::Spectrum;
use crate::integrator::{Alpha, Probe, Term};
use crate::light::Light;
use crate::shading::texture::SpectralMode;
use crate::world::World;

impl PathTracer {
    /// Shows the background to a path from the camera that hit a shadow catcher, and weights the light that the path
    /// gathers from there on.
    pub(super) fn show_behind<P: Probe>(
        &self,
        world: &World,
        path: &mut Path,
        output: &mut StepOutput<'_, P>,
    ) {
        let mode = output.mode(path);
        let slot = path.slot as usize;
        output.queues.alpha[slot] = Alpha::Shadow(output.queues.radiance[slot]);
        let behind = match output.background {
            Background::Environment => world.sky(&path.ray, &mode),
            // White: the light of the sample is the unshadowed part.
            Background::Color(_) | Background::Transparent => world.light_of([1.0; 3], &mode),
        };
        if self.has_control_variate() {
            output.add(path, Term::Sky, path.beta * behind);
        }
        path.beta *= world.catcher_correction(Vec3::from_array(path.ray.direction), behind, &mode);
    }

    /// Subtracts the unoccluded contribution of an infinite light that was sampled at a catcher.
    pub(super) fn expect_light<P: Probe>(
        &self,
        light: &Light,
        path: &Path,
        contribution: Spectrum,
        output: &mut StepOutput<'_, P>,
    ) {
        let is_far = matches!(light, Light::Environment(_) | Light::Distant { .. });
        if is_far && self.has_control_variate() {
            output.add(path, Term::Sky, contribution * -1.0);
        }
    }

    /// Subtracts the light that a path leaving a catcher finds if nothing is in the way.
    pub(super) fn expect_sky<P: Probe>(&self, world: &World, path: &Path, output: &mut StepOutput<'_, P>) {
        if self.has_control_variate() {
            let expected = sky_found(world, path, &output.mode(path));
            output.add(path, Term::Sky, expected * -1.0);
        }
    }

    /// Whether a path that leaves a catcher and the scene finds the light that [`Self::expect_sky`] subtracts: nothing is
    /// left of both.
    pub(super) fn finds_what_it_expects(&self, path: &Path) -> bool {
        self.has_control_variate() && path.interior.is_empty()
    }

    fn has_control_variate(&self) -> bool {
        self.light_sampling == LightSampling::MultipleImportance
    }
}

/// The light of the environments that a path adds if it hits nothing.
fn sky_found(world: &World, path: &Path, mode: &SpectralMode) -> Spectrum {
    let direction = Vec3::from_array(path.ray.direction).normalize();
    let at = path.state.light_context(0.0);
    let lit = world.environments.iter().filter(|&&index| world.lights[index as usize].illuminates());
    lit.fold(Spectrum::BLACK, |sum, &index| {
        let light_pdf = world.light_pdf(index, &at, direction, None);
        let weight = power_heuristic(path.state.pdf, light_pdf);
        sum + path.beta * world.sky_of(index, &path.ray, mode) * weight
    })
}
