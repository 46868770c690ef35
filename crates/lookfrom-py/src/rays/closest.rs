//! Closest points in f64: the tree finds them, on the positions as they were given.

use lookfrom_bvh::{ClosestPointF64, Unrounded};

use super::frame::times;
use super::geometry::Primitive;
use super::tree::Tree;

/// A tree's shapes in the frames in which they were rounded.
struct InFrame<'a>(&'a Tree);

impl InFrame<'_> {
    fn primitive(&self, instance: u32, geometry: u32, primitive: u32) -> Primitive {
        let (place, _) = self.0.place(instance);
        match place.primitive(geometry, primitive) {
            Primitive::Triangle(corners) => Primitive::Triangle(corners.map(|p| place.frame.point(p))),
            Primitive::Sphere { center, radius } => {
                Primitive::Sphere { center: place.frame.point(center), radius: radius * place.frame.scale }
            }
        }
    }
}

impl Unrounded for InFrame<'_> {
    fn triangle(&self, instance: u32, geometry: u32, primitive: u32) -> [[f64; 3]; 3] {
        match self.primitive(instance, geometry, primitive) {
            Primitive::Triangle(corners) => corners,
            Primitive::Sphere { center, .. } => [center; 3],
        }
    }

    fn sphere(&self, instance: u32, geometry: u32, primitive: u32) -> ([f64; 3], f64) {
        match self.primitive(instance, geometry, primitive) {
            Primitive::Sphere { center, radius } => (center, radius),
            Primitive::Triangle([corner, ..]) => (corner, 0.0),
        }
    }

    /// Coordinates are up to 2 and so rounded by up to 2⁻²⁴: with a margin for radii and for the maps of instances.
    fn error(&self) -> f64 {
        2.0_f64.powi(-20)
    }
}

impl Tree {
    /// The point of all surfaces that is nearest to another one, and at most `max_distance` away.
    pub(super) fn closest_point(&self, point: [f64; 3], max_distance: f64) -> Option<ClosestPointF64> {
        let frame = &self.frame;
        let found = self.bvh.closest_point_unrounded(
            frame.point(point),
            max_distance * frame.scale,
            &InFrame(self),
        )?;
        let position = match self.place(found.instance) {
            // On the triangle as it was given.
            (place, None) => match place.primitive(found.geometry, found.primitive) {
                Primitive::Triangle(corners) => weighted(&corners, found.u, found.v),
                Primitive::Sphere { .. } => self.in_world(found.position),
            },
            (_, Some(_)) => self.in_world(found.position),
        };
        Some(ClosestPointF64 { position, distance: found.distance / frame.scale, ..found })
    }

    fn in_world(&self, p: [f64; 3]) -> [f64; 3] {
        let p = times(p, 1.0 / self.frame.scale);
        [0, 1, 2].map(|axis| p[axis] + self.frame.origin[axis])
    }
}

/// The point of a triangle with these weights of its second and third corner.
pub(super) fn weighted([a, b, c]: &[[f64; 3]; 3], u: f64, v: f64) -> [f64; 3] {
    [0, 1, 2].map(|axis| a[axis] + u * (b[axis] - a[axis]) + v * (c[axis] - a[axis]))
}
