//! Points on surfaces with bounds of their errors, and the origins of rays that leave them: at any width.
//!
//! Origins are not offset by an epsilon, but are just beyond the error of the point: after Wächter & Binder (2019),
//! "A Fast and Robust Method for Avoiding Self-Intersection", and the error bounds of Pharr, Jakob, Humphreys,
//! Physically Based Rendering. Points are computed in f64, so their errors are far below the spacing of f32.
//! It remains to round each coordinate to f32 *away* from the surface: a step of about one unit in the last place.
//!
//! Proof: a triangle, a sphere seen from outside, and any affine image of them lie on one side of the tangent plane
//! at the origin point. The ray's origin is on the other side and its direction leads away, so the whole ray is on
//! the other side. Inside a sphere, rounding moves each coordinate toward that of the centre (itself an f32), hence
//! inwards. Inside an instanced sphere this holds only as long as its radii of curvature are large compared with
//! the spacing of f32.

use crate::real::{Float, Real};
use crate::rounding::{UNIT, round_toward};
use crate::vector::Vector;

/// Points on surfaces, in double precision.
#[derive(Clone, Copy, Debug)]
pub struct Points<R: Real> {
    /// The position.
    pub position: Vector<R::Double>,
    /// The maximum distance of the surface, as rays see it, from the position: for each coordinate, not negative.
    /// It includes all errors except that of rounding the origin of a ray to f32, which [`Exits`] take into account.
    pub error: Vector<R::Double>,
}

impl<R: Real> Points<R> {
    /// The points `p0 + u (p1 − p0) + v (p2 − p0)` of triangles at hits, and `(p1 − p0) × (p2 − p0)`.
    ///
    /// An error of `u` or `v` moves them within the plane, so the bound does not include them.
    #[inline(always)]
    pub fn on_triangles(corners: [Vector<R>; 3], u: R, v: R) -> (Self, Vector<R::Double>) {
        let [p0, p1, p2] = [corners[0].widen(), corners[1].widen(), corners[2].widen()];
        let (u, v) = (u.widen(), v.widen());
        let (e1, e2) = (p1 - p0, p2 - p0);
        let position = p0 + e1 * u + e2 * v;

        // Errors of hits relative to the plane: those of n = e1 × e2, relative to its length.
        let n = e1.cross(e2);
        let reach = e1.abs() + e2.abs();
        let decision = e1.cross_magnitude(e2).dot(reach) * (8.0 * UNIT) / n.length();
        let decision = Float::select(Float::is_finite(decision), decision, decision.like(0.0));
        let magnitude = p0.abs() + (e1 * u).abs() + (e2 * v).abs() + reach;
        let error =
            magnitude * magnitude.x.like(8.0 * UNIT) + Vector { x: decision, y: decision, z: decision };
        (Self { position, error }, n)
    }

    /// The ways from origins to just before these points, which have a normal and are seen from there in the direction `wi`:
    /// so that a ray ends before the surface of the points, although its direction is rounded.
    #[inline(always)]
    pub fn just_before(self, normal: Vector<R::Double>, wi: Vector<R>, origins: Vector<R>) -> Vector<R> {
        let origins = origins.widen();
        let Vector { x, y, z } = (self.position - origins).abs();
        let length = Float::max(Float::max(Float::max(x.like(0.0), x), y), z);
        let slack = length * f64::from(f32::EPSILON);
        let error = Vector { x: self.error.x + slack, y: self.error.y + slack, z: self.error.z + slack };
        let end = Self { position: self.position, error }.leave(normal, -wi);
        Vector::narrow(end.widen() - origins)
    }

    /// The points of spheres that are nearest to hits, which should be on the spheres up to their errors.
    #[inline(always)]
    pub fn on_spheres(center: Vector<R::Double>, radius: R::Double, hit: Vector<R::Double>) -> Self {
        let zero = radius.like(0.0);
        let f = hit - center;
        let length = f.length();
        let stretch = Float::select(length.gt(zero), radius / length, zero);
        let reach = radius * 2.0;
        let error = (center.abs() + Vector { x: reach, y: reach, z: reach }) * radius.like(8.0 * UNIT);
        Self { position: center + f * stretch, error }
    }

    /// The origins of rays that leave the points in some directions.
    #[inline(always)]
    pub fn leave(&self, unit_normal: Vector<R::Double>, direction: Vector<R>) -> Vector<R> {
        self.exits(unit_normal).toward(direction)
    }

    /// The ways out of the error bounds, along the unit normals and against them.
    #[inline(always)]
    pub fn exits<'a>(&self, unit_normal: Vector<R::Double>) -> Exits<'a, R> {
        let step = unit_normal * self.clearance(unit_normal);
        Exits { position: self.position, normal: unit_normal, step, lift: None }
    }

    /// The length of the way along the unit normals that leads out of the error bounds.
    #[inline(always)]
    pub fn clearance(&self, unit_normal: Vector<R::Double>) -> R::Double {
        let Self { position, error } = *self;
        let reach = unit_normal.abs().times(error + position.abs() * position.x.like(4.0 * UNIT));
        (reach.x + reach.y + reach.z) * (1.0 + 1e-6)
    }
}

/// The smooth surfaces that coarse meshes stand for.
#[derive(Clone, Copy, Debug)]
pub struct Lift<R: Real> {
    /// The way to it from points, to the outside; zero where there is none.
    pub way: Vector<R>,
    /// Its normal, of unit length.
    pub ns: Vector<R>,
}

impl<R: Real> Lift<R> {
    /// Whether directions lead to the outside of such a surface, whatever the side of the triangle.
    #[inline(always)]
    pub fn is_above(&self, direction: Vector<R>) -> <R::Double as Float>::Mask {
        self.is_above_wide(direction.widen())
    }

    #[inline(always)]
    fn is_above_wide(&self, direction: Vector<R::Double>) -> <R::Double as Float>::Mask {
        let zero = self.way.x.widen().like(0.0);
        let is_lifted = self.way.widen().length_squared().gt(zero);
        is_lifted & self.ns.widen().dot(direction).gt(zero)
    }
}

/// The ways from points out of the bounds of their errors: for rays that leave surfaces.
#[derive(Clone, Copy, Debug)]
pub struct Exits<'a, R: Real> {
    position: Vector<R::Double>,
    normal: Vector<R::Double>,
    /// On the side of the normal.
    step: Vector<R::Double>,
    lift: Option<&'a Lift<R>>,
}

impl<'a, R: Real> Exits<'a, R> {
    /// The ways from smooth surfaces, where directions are above those.
    #[inline(always)]
    pub fn lifted(self, lift: Option<&'a Lift<R>>) -> Self {
        Self { lift, ..self }
    }

    /// Whether directions lead to the side of the normal, or are above smooth surfaces.
    #[inline(always)]
    pub fn are_outside(&self, direction: Vector<R>) -> <R::Double as Float>::Mask {
        let cos = self.normal.dot(direction.widen());
        let is_beside = cos.gt(cos.like(0.0));
        match self.lift {
            Some(lift) => is_beside | lift.is_above(direction),
            None => is_beside,
        }
    }

    /// The origins of rays in some directions.
    #[inline(always)]
    pub fn toward(&self, direction: Vector<R>) -> Vector<R> {
        self.toward_wide(direction.widen())
    }

    /// The origins of rays in some directions of double precision.
    #[inline(always)]
    pub fn toward_wide(&self, direction: Vector<R::Double>) -> Vector<R> {
        let cos = self.normal.dot(direction);
        let mut is_behind = cos.lt(cos.like(0.0));
        let mut position = self.position;
        if let Some(lift) = self.lift {
            let is_above = lift.is_above_wide(direction);
            is_behind = is_behind & !is_above;
            position = Vector::select(is_above, position + lift.way.widen(), position);
        }
        let normal = self.normal.negate_where(is_behind);
        let moved = position + self.step.negate_where(is_behind);
        Vector {
            x: round_away(moved.x, normal.x),
            y: round_away(moved.y, normal.y),
            z: round_away(moved.z, normal.z),
        }
    }
}

/// The nearest f32 that is not before `x` on the way along a normal; simply the nearest where that is 0.
#[inline(always)]
fn round_away<R: Real>(x: R::Double, normal: R::Double) -> R {
    let zero = x.like(0.0);
    round_toward(x, normal.gt(zero), normal.lt(zero))
}

#[cfg(test)]
mod tests;
