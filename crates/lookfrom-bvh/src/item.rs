//! Items of leaves that are no triangles: spheres, procedural shapes; the leaves as ranges of them.

use crate::sphere::Sphere;

/// The content of a leaf without triangles: a range of items in the array of their kind.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Leaf {
    Spheres { first: u32, count: u32 },
    Procedurals { first: u32, count: u32 },
    Instances { first: u32, count: u32 },
}

/// A sphere and its ids.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SphereItem {
    pub(crate) shape: Sphere,
    pub(crate) geometry: u32,
    pub(crate) primitive: u32,
}

/// One of a procedural's shapes: `shape` is the procedural's index in `Bvh::procedural_shapes`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ProceduralItem {
    pub(crate) shape: u32,
    pub(crate) geometry: u32,
    pub(crate) primitive: u32,
}
