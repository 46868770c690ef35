//! Eight hits on bare surfaces ([`World::bare_surface`](crate::world::World::bare_surface)) side by side.

use lookfrom_bvh::{Hit, Ray};

use crate::core::lanes::LANES;
use crate::primitive::{Mesh, Primitives};
use crate::world::{ShapeClass, World};

/// Eight hits on bare surfaces of one kind of shape.
pub(in crate::integrator) struct BareHits<'a> {
    pub(in crate::integrator) rays: [&'a Ray; LANES],
    pub(in crate::integrator) hits: [&'a Hit; LANES],
    pub(in crate::integrator) shape: ShapeClass,
}

impl BareHits<'_> {
    /// Whether all are on one primitive.
    #[inline(always)]
    pub(in crate::integrator) fn are_on_one(&self) -> bool {
        let (first, mut is_one, mut lane) = (self.hits[0], true, 1);
        while lane < LANES {
            let hit = self.hits[lane];
            is_one &= hit.primitive == first.primitive && hit.geometry == first.geometry;
            lane += 1;
        }
        is_one
    }
}

/// The mesh of a hit on a triangle.
#[inline(always)]
pub(in crate::integrator) fn mesh<'a>(world: &'a World, hit: &Hit) -> Option<&'a Mesh> {
    match &world.primitives[hit.geometry as usize] {
        Primitives::Mesh(mesh) => Some(mesh),
        _ => None,
    }
}
