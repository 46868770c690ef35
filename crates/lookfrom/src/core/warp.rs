//! Warps: from the unit square to directions and to points on shapes.
//!
//! Each warp takes `u` in [0, 1)² and keeps neighbouring numbers close together, so that well-distributed samples
//! stay well distributed; its density is beside it. All directions are derived from the disk: Shirley & Chiu's map
//! has no seam, and Archimedes' theorem (a sphere has the area of its circumscribed cylinder) extends it to spheres
//! and cones. The choice of warp is left to lights and materials.
//!
//! Shirley & Chiu 1997 (disk); Malley (hemisphere by the disk); Heitz 2019 (triangle); Duff et al. 2017 (basis).

use glam::{Vec2, Vec3};
use lookfrom_simd::{Simd, f32x8, prelude::*};
use std::f32::consts::{FRAC_1_PI, FRAC_2_PI, FRAC_PI_4, PI};

/// A uniform point in the unit disk: the density over area is [`CONCENTRIC_DISK_PDF`]. The centre of the square
/// maps to the centre of the disk, concentric squares to circles.
pub fn concentric_disk(u: [f32; 2]) -> Vec2 {
    let [a, b] = u.map(|u| 2.0 * u - 1.0);
    if a == 0.0 && b == 0.0 {
        return Vec2::ZERO;
    }
    // The radius is half the side of the concentric square through the point, the angle is the
    // position along that side.
    let is_wide = a * a > b * b;
    let (radius, along) = if is_wide { (a, b) } else { (b, a) };
    let (sin, cos) = sin_cos_of_eighths(along / radius);
    // Beyond the diagonal the angle is π/2 minus the one before it.
    if is_wide { Vec2::new(radius * cos, radius * sin) } else { Vec2::new(radius * sin, radius * cos) }
}

/// Sine and cosine of `t` π/4 for |t| ≤ 1, to 2⁻²², by their Taylor series. Short and without branches, so that
/// eight can be computed side by side.
fn sin_cos_of_eighths(t: f32) -> (f32, f32) {
    let t2 = t * t;
    let sin = t * (SIN[0] + t2 * (SIN[1] + t2 * (SIN[2] + t2 * (SIN[3] + t2 * SIN[4]))));
    let cos = COS[0] + t2 * (COS[1] + t2 * (COS[2] + t2 * (COS[3] + t2 * (COS[4] + t2 * COS[5]))));
    (sin, cos)
}

/// (π/4)².
const SQUARE: f64 = std::f64::consts::FRAC_PI_4 * std::f64::consts::FRAC_PI_4;

/// (−1)ᵏ (π/4)²ᵏ⁺¹ / (2k + 1)!
const SIN: [f32; 5] = {
    let first = std::f64::consts::FRAC_PI_4;
    let third = -first * SQUARE / 6.0;
    let fifth = -third * SQUARE / 20.0;
    let seventh = -fifth * SQUARE / 42.0;
    let ninth = -seventh * SQUARE / 72.0;
    [first as f32, third as f32, fifth as f32, seventh as f32, ninth as f32]
};

/// (−1)ᵏ (π/4)²ᵏ / (2k)!
const COS: [f32; 6] = {
    let second = -SQUARE / 2.0;
    let fourth = -second * SQUARE / 12.0;
    let sixth = -fourth * SQUARE / 30.0;
    let eighth = -sixth * SQUARE / 56.0;
    let tenth = -eighth * SQUARE / 90.0;
    [1.0, second as f32, fourth as f32, sixth as f32, eighth as f32, tenth as f32]
};

/// [`concentric_disk`] for eight points side by side, bit for bit.
#[inline(always)]
pub(crate) fn concentric_disks<S: Simd>(simd: S, [u, v]: [f32x8<S>; 2]) -> [f32x8<S>; 2] {
    let splat = |value: f32| f32x8::splat(simd, value);
    let (zero, one, two) = (splat(0.0), splat(1.0), splat(2.0));
    let (a, b) = (two * u - one, two * v - one);
    let is_wide = (a * a).simd_gt(b * b);
    let (radius, along) = (is_wide.select(a, b), is_wide.select(b, a));
    let t = along / radius;
    let t2 = t * t;
    let [s0, s1, s2, s3, s4] = SIN;
    let sin = t * (splat(s0) + t2 * (splat(s1) + t2 * (splat(s2) + t2 * (splat(s3) + t2 * splat(s4)))));
    let [c0, c1, c2, c3, c4, c5] = COS;
    let fourth = splat(c3) + t2 * (splat(c4) + t2 * splat(c5));
    let cos = splat(c0) + t2 * (splat(c1) + t2 * (splat(c2) + t2 * fourth));
    let (x, y) = (radius * is_wide.select(cos, sin), radius * is_wide.select(sin, cos));
    let is_middle = radius.simd_eq(zero);
    [is_middle.select(zero, x), is_middle.select(zero, y)]
}

/// Density of [`concentric_disk`] over area: 1/π.
pub const CONCENTRIC_DISK_PDF: f32 = FRAC_1_PI;

/// A cosine-distributed direction about `n`, with density [`cosine_hemisphere_pdf`]. `n` must have unit length; the
/// result has unit length up to rounding, and its cosine is always positive.
pub fn cosine_hemisphere(u: [f32; 2], n: Vec3) -> Vec3 {
    let disk = concentric_disk(u);
    // Lift the rim slightly (2⁻¹², far below anything visible), so that no density is 0.
    let height = (1.0 - disk.length_squared()).max(1.0 / 16_777_216.0).sqrt();
    let (s, t) = orthonormal_basis(n);
    disk.x * s + disk.y * t + height * n
}

/// Density of [`cosine_hemisphere`] over solid angle, by the cosine to the normal. 0 below.
pub fn cosine_hemisphere_pdf(cos_theta: f32) -> f32 {
    FRAC_1_PI * cos_theta.max(0.0)
}

/// A uniform direction, of unit length up to rounding: the density over solid angle is [`UNIFORM_SPHERE_PDF`].
pub fn uniform_sphere(u: [f32; 2]) -> Vec3 {
    uniform_cone(u, 2.0)
}

/// Density of [`uniform_sphere`] over solid angle: 1/4π.
pub const UNIFORM_SPHERE_PDF: f32 = 0.25 * FRAC_1_PI;

/// A uniform direction within a cone about +z, of unit length up to rounding: the density is [`uniform_cone_pdf`].
///
/// The cone is given by `1 − cos` of the angle between its axis and its side: 0 … 2. This form allows arbitrarily
/// thin cones; where sin² is known (radius²/distance² of a sphere), `1 − cos = sin² / (1 + √(1 − sin²))`.
pub fn uniform_cone(u: [f32; 2], one_minus_cos_theta_max: f32) -> Vec3 {
    let disk = concentric_disk(u);
    // The depth below the pole is uniform, like the square of the disk's radius.
    let depth = disk.length_squared().min(1.0) * one_minus_cos_theta_max;
    // sin θ = √(depth (2 − depth)), along the disk's direction.
    let widen = (one_minus_cos_theta_max * (2.0 - depth).max(0.0)).sqrt();
    Vec3::new(disk.x * widen, disk.y * widen, 1.0 - depth)
}

/// Density of [`uniform_cone`] over solid angle within the cone; infinite for a cone of zero width.
pub fn uniform_cone_pdf(one_minus_cos_theta_max: f32) -> f32 {
    1.0 / (2.0 * PI * one_minus_cos_theta_max)
}

/// Barycentric coordinates α, β, γ ≥ 0 of a uniform point in a triangle; their sum is 1 up to rounding. The density
/// over area is [`uniform_triangle_pdf`].
pub fn uniform_triangle([u, v]: [f32; 2]) -> [f32; 3] {
    // Fold the square along its diagonal, each half moving toward the other two corners.
    let (alpha, beta) = if v > u { (0.5 * u, v - 0.5 * u) } else { (u - 0.5 * v, 0.5 * v) };
    [alpha, beta, 1.0 - (alpha + beta)]
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
    let (x, y) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    let signed_distance = 1.0 - (x.abs() + y.abs());
    let r = 1.0 - signed_distance.abs();
    let phi = if r == 0.0 { 1.0 } else { (y.abs() - x.abs()) / r + 1.0 } * FRAC_PI_4;
    let (sin, cos) = libm::sincosf(phi);
    let sin_theta = r * (2.0 - r * r).max(0.0).sqrt();
    Vec3::new(
        cos.copysign(x) * sin_theta,
        sin.copysign(y) * sin_theta,
        (1.0 - r * r).copysign(signed_distance),
    )
}

/// The inverse of [`octahedral_direction`] for a unit direction.
pub fn octahedral_square(direction: Vec3) -> [f32; 2] {
    let Vec3 { x, y, z } = direction.abs();
    let r = (1.0 - z).max(0.0).sqrt();
    let (low, high) = (x.min(y), x.max(y));
    let angle = if high == 0.0 { 0.0 } else { libm::atan2f(low, high) * FRAC_2_PI };
    let share = if x < y { 1.0 - angle } else { angle };
    let (mut u, mut v) = (r - share * r, share * r);
    if direction.z < 0.0 {
        (u, v) = (1.0 - v, 1.0 - u);
    }
    [u.copysign(direction.x), v.copysign(direction.y)].map(|c| 0.5 * (c + 1.0))
}

/// Two unit vectors that make a right-handed orthonormal basis (s, t, n) with the unit vector `n`, up to rounding.
pub fn orthonormal_basis(n: Vec3) -> (Vec3, Vec3) {
    // The only branch is the sign of z, which keeps the denominator away from 0.
    let sign = 1.0_f32.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), Vec3::new(b, sign + n.y * n.y * a, -n.y))
}

#[cfg(test)]
mod tests;
