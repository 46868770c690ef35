//! Shadow rays that wait to be traced, by their parts, so that the kernel reads rays where they are.

use glam::Vec3;
use lookfrom_bvh::{OriginPrimitive, Ray};

use super::Shadow;
use crate::core::spectrum::Spectrum;
use crate::integrator::Term;
use crate::medium::Way;
use crate::shading::interior_stack::InteriorStack;
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// Shadow rays of a batch, in the order in which their light is added.
#[derive(Debug, Default)]
pub struct Shadows {
    pub(super) rays: Vec<Ray>,
    pub(super) origin_primitives: Vec<OriginPrimitive>,
    pub(super) lights: Vec<ShadowLight>,
}

/// The payload of a shadow ray: a [`Shadow`] without its ray.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrator) struct ShadowLight {
    pub(in crate::integrator) contribution: Spectrum,
    pub(in crate::integrator) interior: InteriorStack,
    pub(in crate::integrator) address: u64,
    pub(in crate::integrator) term: Term,
    pub(in crate::integrator) slot: u32,
    pub(in crate::integrator) last_scattering: u32,
    pub(in crate::integrator) panes: u32,
}

impl Shadows {
    /// Adds a ray.
    #[inline(always)]
    pub fn push(&mut self, shadow: Shadow) {
        let Shadow {
            ray,
            origin_primitive,
            contribution,
            slot,
            address,
            term,
            interior,
            last_scattering,
            panes,
        } = shadow;
        self.rays.push(ray);
        self.origin_primitives.push(origin_primitive);
        self.lights.push(ShadowLight { contribution, interior, address, term, slot, last_scattering, panes });
    }

    /// Removes all.
    pub(in crate::integrator) fn clear(&mut self) {
        self.rays.clear();
        self.origin_primitives.clear();
        self.lights.clear();
    }
}

impl ShadowLight {
    /// The whole of the shadow.
    pub(super) fn of(&self, ray: Ray, origin_primitive: OriginPrimitive) -> Shadow {
        let Self { contribution, interior, address, term, slot, last_scattering, panes } = *self;
        Shadow { ray, origin_primitive, contribution, slot, address, term, interior, last_scattering, panes }
    }

    /// Transmittance of the medium up to a hit, or on the rest of the way.
    #[inline]
    pub(super) fn transmittance(&self, world: &World, ray: &Ray, t: f32, mode: &SpectralMode) -> Spectrum {
        if self.interior.is_empty() {
            return mode.one();
        }
        world.transmittance(self.interior, (ray, length(world, ray, t, self.interior)), mode)
    }
}

impl Shadow {
    /// The way of the ray as far as `t`, as media attenuate light on it.
    pub(crate) fn way(&self, world: &World, t: f32) -> Way {
        Way::new(&self.ray, length(world, &self.ray, t, self.interior))
    }
}

/// The length of a shadow ray as far as `t`; to a light infinitely far away that in a medium.
pub(super) fn length(world: &World, ray: &Ray, t: f32, interior: InteriorStack) -> f32 {
    let length = Vec3::from_array(ray.direction).length() * t;
    let is_far = length.is_infinite() && interior.space().is_some();
    if is_far { world.length_to_sky(ray) } else { length }
}
