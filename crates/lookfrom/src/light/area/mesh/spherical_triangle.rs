//! Spherical triangles, uniform sampling of their solid angle, at any width.
//!
//! Arvo (1995), "Stratified Sampling of Spherical Triangles"; the solid angle by Van Oosterom & Strackee (1983).

use lookfrom_simd::{Float, Mask, Real};

use crate::core::elementary::{atan2, sin_cos};
use crate::core::vector::Vector;

/// Range of solid angles for which triangles are sampled by direction.
const BY_DIRECTION: std::ops::RangeInclusive<f64> = 3e-4..=6.22;

/// Triangles as seen from a point each.
#[derive(Clone, Copy)]
pub(crate) struct SphericalTriangles<R: Real> {
    /// The corners, from the point.
    corners: [Vector<R::Double>; 3],
    /// The directions to them, of unit length.
    directions: [Vector<R::Double>; 3],
    solid_angle: R::Double,
}

impl<R: Real> SphericalTriangles<R> {
    /// By the corners, from the points that they are seen from.
    #[inline(always)]
    pub(crate) fn new(corners: [Vector<R::Double>; 3]) -> Self {
        let directions = [corners[0].normalize(), corners[1].normalize(), corners[2].normalize()];
        let [a, b, c] = directions;
        let volume = Float::abs(a.dot(b.cross(c)));
        let rest = a.dot(b) + b.dot(c) + c.dot(a);
        let solid_angle = atan2(volume, rest + rest.like(1.0)) * 2.0;
        Self { corners, directions, solid_angle }
    }

    /// The solid angles, and where they are neither too small nor too close to a hemisphere to be sampled.
    #[inline(always)]
    pub(crate) fn solid_angle(&self) -> (R::Double, <R::Double as Float>::Mask) {
        let angle = self.solid_angle;
        let is_outside =
            angle.lt(angle.like(*BY_DIRECTION.start())) | angle.gt(angle.like(*BY_DIRECTION.end()));
        (angle, !is_outside & Float::is_finite(angle))
    }

    /// The weights of the second and third corner of the point in a direction uniform over the solid angle; `u ∈ [0,
    /// 1)²`.
    #[inline(always)]
    pub(crate) fn sample(&self, u: [R; 2]) -> [R; 2] {
        self.barycentric(self.direction(u))
    }

    #[inline(always)]
    fn direction(&self, [u0, u1]: [R; 2]) -> Vector<R::Double> {
        let [a, b, c] = self.directions;
        // The angle at a, between the planes through the sides that meet there.
        let (to_b, to_c) = (a.cross(b), a.cross(c));
        let size = to_b.length() * to_c.length();
        let cos_alpha = to_b.dot(to_c) / size;
        let sin_alpha = Float::abs(a.dot(b.cross(c))) / size;

        // The corner on the side from a to c that cuts off the chosen part of the area.
        let (sin_part, cos_part) = sin_cos(u0.widen() * self.solid_angle);
        let sin = sin_part * cos_alpha - cos_part * sin_alpha;
        let cos = cos_part * cos_alpha + sin_part * sin_alpha;
        let x = cos - cos_alpha;
        let y = sin + sin_alpha * a.dot(b);
        let q = ((y * cos - x * sin) * cos_alpha - y) / ((y * sin + x * cos) * sin_alpha);
        let one = q.like(1.0);
        let q = Float::select(Float::eq(q, q), Float::clamp(q, -1.0, 1.0), one);
        let corner = a * q + off(c, a) * perpendicular(q);

        // A point between b and that corner.
        let z = one - u1.widen() * (one - corner.dot(b));
        (b * z + off(corner, b) * perpendicular(z)).normalize()
    }

    /// β and γ of the triangles' points in directions, clamped to the triangles.
    #[inline(always)]
    fn barycentric(&self, direction: Vector<R::Double>) -> [R; 2] {
        let [p0, p1, p2] = self.corners;
        let (e1, e2) = (p1 - p0, p2 - p0);
        let across = direction.cross(e2);
        let one = across.x.like(1.0);
        let scale = one / e1.dot(across);
        let beta = -p0.dot(across) * scale;
        let gamma = direction.dot((-p0).cross(e1)) * scale;
        let beta = Float::clamp(beta, 0.0, 1.0);
        let gamma = Float::min(Float::max(gamma, one.like(0.0)), one - beta);
        [R::narrow(beta), R::narrow(gamma)]
    }
}

/// √(1 − x²).
#[inline(always)]
fn perpendicular<F: Float<Scalar = f64>>(x: F) -> F {
    Float::sqrt(Float::max(x.like(1.0) - x * x, x.like(0.0)))
}

/// The unit vector across `axis` (of unit length) in the plane with `v`; zero where there is none.
#[inline(always)]
fn off<F: Float<Scalar = f64>>(v: Vector<F>, axis: Vector<F>) -> Vector<F> {
    let (across, exists) = (v - axis * v.dot(axis)).try_normalize();
    if exists.all() {
        return across;
    }
    let zero = v.x.like(0.0);
    Vector::select(exists, across, Vector { x: zero, y: zero, z: zero })
}
