//! Warps: from the unit square to directions and to points on shapes.
//!
//! Each warp takes `u` in [0, 1)² and keeps neighbouring numbers close together, so that well-distributed samples
//! stay well distributed; its density is beside it. All directions are derived from the disk: Shirley & Chiu's map
//! has no seam, and Archimedes' theorem (a sphere has the area of its circumscribed cylinder) extends it to spheres
//! and cones. The choice of warp is left to lights and materials.
//!
//! Shirley & Chiu 1997 (disk); Malley (hemisphere by the disk); Heitz 2019 (triangle); Duff et al. 2017 (basis).

use std::f32::consts::{FRAC_1_PI, PI};

use glam::Vec3;
use lookfrom_simd::{Float, Real};

use crate::core::elementary::{angle_in_turns, sin_cos_of_eighths, sin_cos_of_turns};
use crate::core::vector::Vector;

/// A uniform point in the unit disk: the density over area is [`CONCENTRIC_DISK_PDF`]. The centre of the square
/// maps to the centre of the disk, concentric squares to circles.
#[inline(always)]
pub fn concentric_disk<R: Real>([u, v]: [R; 2]) -> [R; 2] {
    let (a, b) = (u * 2.0 - 1.0, v * 2.0 - 1.0);
    // The radius is the side of the square through the point, the angle the place along that side.
    let is_wide = (a * a).gt(b * b);
    let (radius, along) = (R::select(is_wide, a, b), R::select(is_wide, b, a));
    let (sin, cos) = sin_cos_of_eighths(along / radius);
    // Beyond the diagonal the angle is π/2 less what it is before.
    let (x, y) = (radius * R::select(is_wide, cos, sin), radius * R::select(is_wide, sin, cos));
    let zero = u.like(0.0);
    let is_centre = Float::eq(radius, zero);
    [R::select(is_centre, zero, x), R::select(is_centre, zero, y)]
}

/// Density of [`concentric_disk`] over area: 1/π.
pub const CONCENTRIC_DISK_PDF: f32 = FRAC_1_PI;

/// A cosine-distributed direction about +z, with density [`cosine_hemisphere_pdf`], of unit length up to rounding; its
/// cosine is always positive.
#[inline(always)]
pub fn cosine_about_z<R: Real>(u: [R; 2]) -> Vector<R> {
    let [x, y] = concentric_disk(u);
    // Lift the rim slightly (2⁻¹², far below anything visible), so that no density is 0.
    let height = Float::sqrt(Float::max(x.like(1.0) - (x * x + y * y), x.like(1.0 / 16_777_216.0)));
    Vector { x, y, z: height }
}

/// [`cosine_about_z`] about `n`, which must have unit length.
pub fn cosine_hemisphere(u: [f32; 2], n: Vec3) -> Vec3 {
    let Vector { x, y, z } = cosine_about_z(u);
    let (s, t) = orthonormal_basis(n);
    x * s + y * t + z * n
}

/// Density of [`cosine_hemisphere`] over solid angle, by the cosine to the normal. 0 below.
#[inline(always)]
pub fn cosine_hemisphere_pdf<R: Real>(cos_theta: R) -> R {
    Float::max(cos_theta, cos_theta.like(0.0)) * FRAC_1_PI
}

/// A uniform direction, of unit length up to rounding: the density over solid angle is [`UNIFORM_SPHERE_PDF`].
pub fn uniform_sphere(u: [f32; 2]) -> Vec3 {
    uniform_cone(u, 2.0).into()
}

/// Density of [`uniform_sphere`] over solid angle: 1/4π.
pub const UNIFORM_SPHERE_PDF: f32 = 0.25 * FRAC_1_PI;

/// A uniform direction within a cone about +z, of unit length up to rounding: the density is [`uniform_cone_pdf`].
///
/// The cone is given by `1 − cos` of the angle between its axis and its side: 0 … 2. This form allows arbitrarily
/// thin cones; where sin² is known (radius²/distance² of a sphere), `1 − cos = sin² / (1 + √(1 − sin²))`.
#[inline(always)]
pub fn uniform_cone<R: Real>(u: [R; 2], one_minus_cos_theta_max: R) -> Vector<R> {
    let [x, y] = concentric_disk(u);
    // The depth below the pole is uniform, like the square of the disk's radius.
    let depth = Float::min(x * x + y * y, x.like(1.0)) * one_minus_cos_theta_max;
    // sin θ = √(depth (2 − depth)), along the disk's direction.
    let widen = Float::sqrt(one_minus_cos_theta_max * Float::max(x.like(2.0) - depth, x.like(0.0)));
    Vector { x: x * widen, y: y * widen, z: x.like(1.0) - depth }
}

/// Density of [`uniform_cone`] over solid angle within the cone; infinite for a cone of zero width.
pub fn uniform_cone_pdf(one_minus_cos_theta_max: f32) -> f32 {
    1.0 / (2.0 * PI * one_minus_cos_theta_max)
}

/// Barycentric coordinates α, β, γ ≥ 0 of a uniform point in a triangle; their sum is 1 up to rounding. The density
/// over area is [`uniform_triangle_pdf`].
#[inline(always)]
pub fn uniform_triangle<R: Real>([u, v]: [R; 2]) -> [R; 3] {
    // Fold the square along its diagonal, each half moving toward the other two corners.
    let is_above = v.gt(u);
    let (half_u, half_v) = (u * 0.5, v * 0.5);
    let alpha = R::select(is_above, half_u, u - half_v);
    let beta = R::select(is_above, v - half_u, half_v);
    [alpha, beta, u.like(1.0) - (alpha + beta)]
}

/// Density of [`uniform_triangle`] for a triangle of this area.
pub fn uniform_triangle_pdf(area: f32) -> f32 {
    1.0 / area
}

/// The direction of a point in the unit square under the equal-area octahedral mapping (Clarberg 2008, in pbrt-v4's
/// layout): +z is the centre, −z the corners. Points beyond the edges are wrapped around the fold.
pub fn octahedral_direction([mut u, mut v]: [f32; 2]) -> Vec3 {
    // Beyond an edge the square continues with itself rotated by 180°.
    if !(0.0..=1.0).contains(&u) {
        (u, v) = (if u < 0.0 { -u } else { 2.0 - u }, 1.0 - v);
    }
    if !(0.0..=1.0).contains(&v) {
        (u, v) = (1.0 - u, if v < 0.0 { -v } else { 2.0 - v });
    }
    octahedral_direction_within([u, v]).into()
}

/// [`octahedral_direction`] of points within the square, at any width.
#[inline(always)]
pub fn octahedral_direction_within<R: Real>([u, v]: [R; 2]) -> Vector<R> {
    let one = u.like(1.0);
    let (x, y) = (u * 2.0 - one, v * 2.0 - one);
    let (width, height) = (Float::abs(x), Float::abs(y));
    let signed_distance = one - (width + height);
    let r = one - Float::abs(signed_distance);
    // The angle in eighths of a turn, 0 … 2.
    let is_pole = Float::eq(r, r.like(0.0));
    let eighths = (height - width) / R::select(is_pole, one, r) + one;
    let (sin, cos) = sin_cos_of_turns(eighths * 0.125);
    let square = r * r;
    let sin_theta = r * Float::sqrt(Float::max(square.like(2.0) - square, square.like(0.0)));
    Vector {
        x: Float::copysign(cos, x) * sin_theta,
        y: Float::copysign(sin, y) * sin_theta,
        z: Float::copysign(one - square, signed_distance),
    }
}

/// The inverse of [`octahedral_direction`] for unit directions.
#[inline(always)]
pub fn octahedral_square<R: Real>(direction: Vector<R>) -> [R; 2] {
    let [x, y, z] = [Float::abs(direction.x), Float::abs(direction.y), Float::abs(direction.z)];
    let (zero, one) = (x.like(0.0), x.like(1.0));
    // √(1 − |z|) of a unit vector, without the cancellation near the poles.
    let r = Float::min(Float::sqrt((x * x + y * y) / (one + z)), one);
    let angle = angle_in_turns(Float::min(x, y), Float::max(x, y)) * 4.0;
    let share = R::select(x.lt(y), one - angle, angle);
    let (u, v) = (r - share * r, share * r);
    let is_below = direction.z.lt(zero);
    let (u, v) = (R::select(is_below, one - v, u), R::select(is_below, one - u, v));
    [(Float::copysign(u, direction.x) + one) * 0.5, (Float::copysign(v, direction.y) + one) * 0.5]
}

/// Two unit vectors that make a right-handed orthonormal basis (s, t, n) with the unit vector `n`, up to rounding.
pub fn orthonormal_basis(n: Vec3) -> (Vec3, Vec3) {
    let (s, t) = basis_about(n.into());
    (s.into(), t.into())
}

/// [`orthonormal_basis`] at any width.
#[inline(always)]
pub fn basis_about<F: Float<Scalar: From<f32>>>(n: Vector<F>) -> (Vector<F>, Vector<F>) {
    // The only branch is the sign of z, which keeps the denominator away from 0.
    let Vector { x, y, z } = n;
    let one = x.like(F::Scalar::from(1.0));
    let sign = Float::copysign(one, z);
    let a = -one / (sign + z);
    let b = x * y * a;
    (
        Vector { x: one + sign * x * x * a, y: sign * b, z: -sign * x },
        Vector { x: b, y: sign + y * y * a, z: -y },
    )
}

#[cfg(test)]
mod tests;
