//! Rays that leave the vertices of paths.

use glam::Vec3;
use lookfrom_bvh::{OriginPrimitive, Ray};

use crate::core::spectrum::Spectrum;
use crate::integrator::{Path, Shadow, Term};
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::interior_stack::InteriorStack;
use crate::world::World;

/// A path at a vertex, as the rays that leave it need it.
#[derive(Clone, Copy)]
pub(in crate::integrator) struct Departure<'a, S = ()> {
    pub(in crate::integrator) path: &'a Path<S>,
    /// The primitive there.
    pub(in crate::integrator) origin_primitive: OriginPrimitive,
    pub(in crate::integrator) boundary: Boundary<'a>,
}

/// The media on the two sides of a surface.
#[derive(Clone, Copy)]
pub(in crate::integrator) enum Boundary<'a> {
    /// The media of a surface.
    Surface(&'a SurfaceInteraction),
    /// The media of a surface that is known by its material alone.
    Bare {
        /// Index into the world's materials.
        material: u32,
        /// Index of the media that it declares, if it does.
        interface: Option<u32>,
        /// Whether the path has met the outside.
        front: bool,
    },
    /// The medium of this side.
    None,
}

impl<S> Departure<'_, S> {
    /// Whether the path has met the outside of the surface.
    #[inline(always)]
    fn front(&self) -> bool {
        match self.boundary {
            Boundary::Surface(&SurfaceInteraction { front, .. }) | Boundary::Bare { front, .. } => front,
            Boundary::None => true,
        }
    }

    /// Whether a ray that leaves to the outside of the surface, or not, passes through it.
    #[inline]
    pub(in crate::integrator) fn crosses(&self, is_outside: bool) -> bool {
        !matches!(self.boundary, Boundary::None) && is_outside != self.front()
    }

    /// Whether the vertex is on a pane.
    pub(in crate::integrator) fn is_at_pane(&self, world: &World) -> bool {
        match self.boundary {
            Boundary::Surface(&SurfaceInteraction { material, .. }) | Boundary::Bare { material, .. } => {
                world.materials[material as usize].is_pane()
            }
            Boundary::None => false,
        }
    }

    /// The media around a ray that leaves to the side from which the path has come.
    #[inline(always)]
    pub(in crate::integrator) fn interior_beside(&self, world: &World) -> InteriorStack {
        self.interior(world, self.front(), false)
    }

    /// The media around a ray that passes through the surface in a direction.
    #[inline(always)]
    pub(in crate::integrator) fn interior_behind(&self, world: &World, wi: Vec3) -> InteriorStack {
        let is_outside = match self.boundary {
            Boundary::Surface(surface) => surface.is_outside(wi),
            Boundary::Bare { .. } | Boundary::None => !self.front(),
        };
        self.interior(world, is_outside, true)
    }

    /// The media around a ray that leaves to the outside of the surface, or not, and passes through it, or not.
    #[inline(always)]
    pub(in crate::integrator) fn interior(
        &self,
        world: &World,
        is_outside: bool,
        passes: bool,
    ) -> InteriorStack {
        let (material, interface) = match self.boundary {
            Boundary::Surface(surface) => (surface.material, surface.medium_interface),
            Boundary::Bare { material, interface, .. } => {
                (material, interface.map(|index| world.medium_interfaces[index as usize]))
            }
            Boundary::None => return self.path.interior,
        };
        let sides = (material, interface);
        self.path.interior.beside(&world.materials, sides, || is_outside, (passes, self.front()))
    }

    /// The shadow ray to a light, in the media around it, which passes no panes.
    #[inline(always)]
    pub(in crate::integrator) fn shadow(
        &self,
        ray: Ray,
        (light, contribution): (u32, Spectrum),
        interior: InteriorStack,
        last_scattering: u32,
    ) -> Shadow {
        Shadow {
            ray,
            origin_primitive: self.origin_primitive,
            contribution,
            slot: self.path.slot,
            address: self.path.address,
            term: Term::Light(light),
            interior,
            last_scattering,
            panes: 0,
        }
    }
}
