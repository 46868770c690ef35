//! Geometry of a tree as it was given: in f64.

use std::sync::Arc;

use lookfrom_bvh::Affine;
use prefetch_index::prefetch_index;

use super::frame::Bounds;
use super::tree::Tree;

/// Primitives of one kind. Whoever makes one has checked indices and that all numbers are finite.
#[derive(Clone, Debug)]
pub(super) enum Geometry {
    Triangles { vertices: Vec<[f64; 3]>, faces: Vec<[u32; 3]> },
    Spheres { centers: Vec<[f64; 3]>, radii: Vec<f64> },
}

/// A geometry, and who sees it.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub(super) geometry: Geometry,
    pub(super) masks: Masks,
}

/// Who sees a geometry or an instance: queries with a mask that has a bit in common with it.
#[derive(Clone, Debug)]
pub(super) enum Masks {
    Everyone,
    OfAll(u32),
    OfEach(Vec<u32>),
}

/// A tree in a place.
#[derive(Clone, Debug)]
pub(super) struct Instance {
    pub(super) tree: Arc<Tree>,
    pub(super) world_from_object: Affine,
    pub(super) object_from_world: Affine,
    pub(super) mask: Option<u32>,
}

/// A primitive.
#[derive(Clone, Copy, Debug)]
pub(super) enum Primitive {
    Triangle([[f64; 3]; 3]),
    Sphere { center: [f64; 3], radius: f64 },
}

impl Geometry {
    /// Number of primitives.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Triangles { faces, .. } => faces.len(),
            Self::Spheres { centers, .. } => centers.len(),
        }
    }

    #[inline]
    pub(super) fn primitive(&self, number: usize) -> Primitive {
        match self {
            Self::Triangles { vertices, faces } => {
                Primitive::Triangle(faces[number].map(|index| vertices[index as usize]))
            }
            Self::Spheres { centers, radii } => {
                Primitive::Sphere { center: centers[number], radius: radii[number] }
            }
        }
    }

    #[inline]
    pub(super) fn fetch_face(&self, number: usize) {
        match self {
            Self::Triangles { faces, .. } => prefetch_index(faces, number),
            Self::Spheres { centers, .. } => prefetch_index(centers, number),
        }
    }

    #[inline]
    pub(super) fn fetch_vertices(&self, number: usize) {
        if let Self::Triangles { vertices, faces } = self {
            for &index in &faces[number] {
                prefetch_index(vertices, index as usize);
                // A vertex that starts at the end of a line of the cache ends in the next one.
                prefetch_index(vertices, index as usize + 1);
            }
        }
    }

    /// Grows a box to contain all primitives. Vertices that no triangle has do not count.
    pub(super) fn grow(&self, bounds: &mut Bounds) {
        match self {
            Self::Triangles { vertices, faces } => {
                faces.iter().flatten().for_each(|&index| bounds.add(vertices[index as usize], 0.0));
            }
            Self::Spheres { centers, radii } => {
                centers.iter().zip(radii).for_each(|(&center, &radius)| bounds.add(center, radius));
            }
        }
    }
}

impl Instance {
    /// Grows a box to contain it.
    pub(super) fn grow(&self, bounds: &mut Bounds) {
        let Some(object) = self.tree.bounds() else { return };
        for corner in 0..8 {
            let p = [0, 1, 2]
                .map(|axis| if corner >> axis & 1 == 0 { object.min[axis] } else { object.max[axis] });
            bounds.add(self.world_from_object.point(p), 0.0);
        }
    }
}
