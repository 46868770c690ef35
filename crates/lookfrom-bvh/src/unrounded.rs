//! Shapes before they were rounded to f32: for closest points in double precision.

use crate::vector::wide;

/// The shapes of a tree as they were before they were rounded to f32, for [`Bvh::closest_point_unrounded`](crate::Bvh::closest_point_unrounded). They are
/// in the space of the tree, or of the instance's tree; `instance` is [`NONE`](crate::NONE) outside of instances.
pub trait Unrounded {
    /// The corners of a triangle.
    fn triangle(&self, instance: u32, geometry: u32, primitive: u32) -> [[f64; 3]; 3];

    /// The centre and the radius of a sphere.
    fn sphere(&self, instance: u32, geometry: u32, primitive: u32) -> ([f64; 3], f64);

    /// An upper bound of how far, in the world, a point of a shape is from the rounded shape.
    fn error(&self) -> f64;
}

/// The source of shapes for a search, and the precision of its distances.
pub(crate) trait Shapes {
    fn triangle(&self, ids: [u32; 3], rounded: [[f32; 3]; 3]) -> [[f64; 3]; 3];
    fn sphere(&self, ids: [u32; 3], rounded: ([f32; 3], f32)) -> ([f64; 3], f64);
    fn error(&self) -> f64;

    /// A distance in the precision in which distances are compared.
    fn distance(&self, distance: f64) -> f64;
}

/// The shapes as they are in the tree, with distances in f32.
pub(crate) struct InTree;

impl Shapes for InTree {
    fn triangle(&self, _: [u32; 3], rounded: [[f32; 3]; 3]) -> [[f64; 3]; 3] {
        rounded.map(wide)
    }

    fn sphere(&self, _: [u32; 3], (center, radius): ([f32; 3], f32)) -> ([f64; 3], f64) {
        (wide(center), radius.into())
    }

    fn error(&self) -> f64 {
        0.0
    }

    fn distance(&self, distance: f64) -> f64 {
        f64::from(distance as f32)
    }
}

impl<U: Unrounded> Shapes for &U {
    fn triangle(&self, [instance, geometry, primitive]: [u32; 3], _: [[f32; 3]; 3]) -> [[f64; 3]; 3] {
        U::triangle(self, instance, geometry, primitive)
    }

    fn sphere(&self, [instance, geometry, primitive]: [u32; 3], _: ([f32; 3], f32)) -> ([f64; 3], f64) {
        U::sphere(self, instance, geometry, primitive)
    }

    fn error(&self) -> f64 {
        U::error(self)
    }

    fn distance(&self, distance: f64) -> f64 {
        distance
    }
}
