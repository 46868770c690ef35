//! The traversal of the BVH by one ray: what it costs, and which primitives it tests.

use lookfrom_bvh::{Observer, Ray};
use serde::Serialize;

use crate::world::World;

/// Maximum number of primitives that are kept.
const MOST_CANDIDATES: usize = 10_000;

/// The cost of a ray, traced alone. (In packets, rays share nodes.)
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct TraversalReport {
    /// Nodes of the BVH that it visited, in instances, too.
    pub nodes: u32,
    /// Boxes of their children that were culled: the ray misses them, or has a hit before them. The others were entered.
    pub culled: u32,
    /// Primitives that it was tested against.
    pub tests: u32,
}

/// The observer that counts, and collects the primitives: instance, geometry, primitive.
#[derive(Default)]
pub(super) struct Tested {
    pub(super) traversal: TraversalReport,
    pub(super) primitives: Vec<[u32; 3]>,
}

impl Observer for Tested {
    fn node(&mut self, _: u32, _: u32) {
        self.traversal.nodes += 1;
    }

    fn boxes(&mut self, _: u32, tested: u32, entered: u32) {
        self.traversal.culled += tested - entered;
    }

    fn candidate(&mut self, instance: u32, geometry: u32, primitive: u32) {
        self.traversal.tests += 1;
        let ids = [instance, geometry, primitive];
        if self.primitives.len() < MOST_CANDIDATES && !self.primitives.contains(&ids) {
            self.primitives.push(ids);
        }
    }
}

/// The cost of a shadow ray, which needs no more than one hit.
pub(in crate::inspect) fn of_shadow(world: &World, ray: &Ray, time: f32) -> TraversalReport {
    let mut tested = Tested::default();
    world.bvh.query().time(time).observer(&mut tested).occluded(ray);
    tested.traversal
}
