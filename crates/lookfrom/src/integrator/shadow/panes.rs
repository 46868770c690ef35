//! Panes: thin sheets that light passes straight on. Shadow rays of path tracing pass them as well, so that lights behind windows are
//! found by sampling lights, not by chance.
//!
//! A path that passes a pane keeps the density with which its direction was sampled at the vertex before: the light that it finds
//! behind is weighted against the light sample of that vertex, whose shadow ray passes the same panes.

use super::ShadowLight;
use crate::core::spectrum::Spectrum;
use crate::integrator::light_paths::LastScattering;
use crate::integrator::{LightPaths, Shadow};
use crate::shading::bsdf::Bsdf;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::interior_stack::InteriorStack;
use crate::shading::material::ShadingContext;
use crate::shading::texture::SpectralMode;
use crate::world::World;

impl ShadowLight {
    /// The light that passes a pane; none where the ray has passed as many as it may.
    pub(super) fn passed_pane(
        &self,
        world: &World,
        surface: &SurfaceInteraction,
        mode: &SpectralMode,
    ) -> Spectrum {
        if self.panes == 0 {
            return Spectrum::BLACK;
        }
        let context = ShadingContext {
            mode: &mut { *mode },
            throughput: &mut mode.one(),
            interior: InteriorStack::default(),
            u: 0.0,
            seed: 0.0,
        };
        match world.shading(surface, context) {
            Some(shading) if let Bsdf::ThinDielectric(pane) = shading.bsdf => {
                mode.one() * pane.transmittance(shading.cos(surface.wo))
            }
            _ => Spectrum::BLACK,
        }
    }

    /// Goes on behind a pane.
    pub(super) fn leave_pane(
        &mut self,
        light_paths: Option<&LightPaths>,
        last_scatterings: &mut [LastScattering],
    ) {
        self.panes = self.panes.saturating_sub(1);
        if let Some(light_paths) = light_paths
            && self.last_scattering != Shadow::NO_SCATTERING
        {
            light_paths.pass_pane(&mut last_scatterings[self.last_scattering as usize]);
        }
    }
}
