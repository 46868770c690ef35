//! The object spaces of quadrics at any width: from points there to points in render space, with bounds of all errors.

use lookfrom_bvh::Affine;
use lookfrom_simd::{Float, Real, Simd, f32x8, f64x8, prelude::*};

use super::UNIT;
use crate::core::lanes::{LANES, by_lane};
use crate::core::points::{Placement, Points, gather_placements, placement};
use crate::core::vector::Vector;

/// The transforms of quadrics.
#[derive(Clone, Copy, Debug)]
pub(crate) struct QuadricFrames<R: Real> {
    render_from_object: Placement<R>,
    /// −1 where outside and inside are exchanged, otherwise 1.
    orientation: R::Double,
}

impl QuadricFrames<f32> {
    pub(super) fn new(render_from_object: &Affine, object_from_render: &Affine, reverse: bool) -> Self {
        Self {
            render_from_object: placement(render_from_object, &object_from_render.matrix),
            orientation: if reverse { -1.0 } else { 1.0 },
        }
    }
}

impl<R: Real> QuadricFrames<R> {
    /// Points of render space, in object space.
    #[inline(always)]
    pub(crate) fn point_in_object(&self, p: Vector<R::Double>) -> Vector<R::Double> {
        self.vector_in_object(p - self.render_from_object.translation)
    }

    /// Directions of render space, in object space.
    #[inline(always)]
    pub(crate) fn vector_in_object(&self, v: Vector<R::Double>) -> Vector<R::Double> {
        self.render_from_object.vector_back(v)
    }

    /// Points of quadrics in render space and the outward unit normals there, by the points and the unit normals away from
    /// the axis in object space. `error` bounds the distance from the surface in object space. `radius` is that of the
    /// curvature there: infinite for a disk.
    #[inline(always)]
    pub(crate) fn place(
        &self,
        position: Vector<R::Double>,
        outward: Vector<R::Double>,
        error: Vector<R::Double>,
        radius: R::Double,
    ) -> (Points<R>, Vector<R::Double>) {
        let mut points = Points { position, error }.placed(&self.render_from_object);
        let normal = self.render_from_object.normal(outward);
        // The surface curves away from its tangent plane over the distance that rounding to f32 may move the origin of a
        // leaving ray.
        let least = radius.like(f64::from(f32::MIN_POSITIVE));
        let rounding = points.position.abs() * radius.like(f64::from(f32::EPSILON))
            + Vector { x: least, y: least, z: least };
        let [x, y, z] = self.render_from_object.inverse;
        let sideways =
            Vector { x: x.abs().dot(rounding), y: y.abs().dot(rounding), z: z.abs().dot(rounding) };
        let bend = sideways.length_squared() * 0.5 / (radius * normal.length());
        points.error = points.error + Vector { x: bend, y: bend, z: bend };
        (points, normal.normalize() * self.orientation)
    }

    /// [`QuadricFrames::place`] for points of whole spheres around the origin, and unit normals there.
    #[inline(always)]
    pub(crate) fn place_on_spheres(
        &self,
        position: Vector<R::Double>,
        radius: R::Double,
    ) -> (Points<R>, Vector<R::Double>) {
        let error = radius * (16.0 * UNIT);
        self.place(position, position.normalize(), Vector { x: error, y: error, z: error }, radius)
    }
}

/// One frame in each lane.
#[inline(always)]
pub(crate) fn gather_frames<S: Simd>(
    simd: S,
    rows: &[&QuadricFrames<f32>; LANES],
) -> QuadricFrames<f32x8<S>> {
    QuadricFrames {
        render_from_object: gather_placements(simd, &by_lane!(lane => &rows[lane].render_from_object)),
        orientation: f64x8::load_array(simd, by_lane!(lane => rows[lane].orientation)),
    }
}
