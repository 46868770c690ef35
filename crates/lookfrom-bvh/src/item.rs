//! Leaves that have no triangles, and their procedural shapes.

/// The content of a leaf without triangles: a block of spheres, or a range of items in the array of their kind.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Leaf {
    Spheres { block: u32 },
    Procedurals { first: u32, count: u32 },
    Instances { first: u32, count: u32 },
}

/// One of a procedural's shapes: `shape` is the procedural's index in `Bvh::procedural_shapes`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ProceduralItem {
    pub(crate) shape: u32,
    pub(crate) geometry: u32,
    pub(crate) primitive: u32,
}
