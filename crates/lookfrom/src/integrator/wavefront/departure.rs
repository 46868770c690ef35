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

/// The media on the other side of a surface.
#[derive(Clone, Copy)]
pub(in crate::integrator) enum Boundary<'a> {
    /// The media that the surface separates.
    Surface(&'a SurfaceInteraction),
    /// A surface that declares no media: the body of its material, if it is one, or out of it where the path has met it from inside.
    Bare {
        /// Index into the world's materials.
        material: u32,
        /// Whether the path has met the outside.
        front: bool,
    },
    /// The medium of this side.
    None,
}

impl<S> Departure<'_, S> {
    /// Whether a ray that leaves to the outside of the surface, or not, passes through it.
    #[inline]
    pub(in crate::integrator) fn crosses(&self, is_outside: bool) -> bool {
        match self.boundary {
            Boundary::Surface(&SurfaceInteraction { front, .. }) | Boundary::Bare { front, .. } => {
                is_outside != front
            }
            Boundary::None => false,
        }
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
        match self.boundary {
            Boundary::Surface(surface) => self.interior(world, surface.wo, false),
            Boundary::Bare { .. } | Boundary::None => self.path.interior,
        }
    }

    /// The media around a ray that leaves in a direction, through the surface or not.
    #[inline(always)]
    pub(in crate::integrator) fn interior(&self, world: &World, wi: Vec3, passes: bool) -> InteriorStack {
        let interior = self.path.interior;
        match self.boundary {
            Boundary::Surface(surface) => interior.leaving(&world.materials, surface, wi, passes),
            Boundary::Bare { material, front } if passes && world.materials[material as usize].is_body() => {
                if front {
                    interior.entered(material)
                } else {
                    interior.left(material)
                }
            }
            Boundary::Bare { .. } | Boundary::None => interior,
        }
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
