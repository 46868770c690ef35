//! Leaves that have no triangles, and their procedural shapes.

/// The content of a leaf without triangles: a block of spheres, a range of items in the array of their kind, or such a range and the block
/// of its items' capsules.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Leaf {
    Spheres { block: u32 },
    Procedurals { first: u32, count: u32 },
    Capsules { block: u32, first: u32, count: u8 },
    Instances { first: u32, count: u32 },
}

/// One of a procedural geometry's shapes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ProceduralItem {
    pub(crate) geometry: u32,
    pub(crate) primitive: u32,
}
