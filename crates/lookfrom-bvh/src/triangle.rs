//! The exact intersection of a ray with a triangle: Woop, Benthin, Wald (2013), in f64.
//!
//! Every triangle goes through two tests. The conservative test (see `conservative`) takes eight triangles at once
//! in f32 and excludes those that the ray surely misses. The exact test takes one triangle in f64. It alone
//! determines hits, so the same bits result for every tree and on every machine.
//!
//! The exact test is watertight: "Watertight Ray/Triangle Intersection". Corners are translated to the ray's origin
//! and sheared so that the ray runs along one axis. A corner's two remaining coordinates are the same for every
//! triangle that shares it, and the signs of the edge functions are right for these coordinates: rounding is
//! monotonic, so a difference of two rounded products has the sign of the exact one or is 0, and then the rounding
//! errors of the products decide. So rays see a plane mesh without gaps. An edge belongs to both of its triangles.
//!
//! `t` is that of the plane, `n·(p0 − o) / n·d`, from differences of f32 values that f64 holds (nearly) exactly:
//! its sign is right to about 10⁻¹⁵ of the triangle's size, however near the origin is to the plane.

use std::ops::Neg;

use crate::exact::{ExactRay, Rounded};
use crate::vector::{Number, cross, cross_magnitude, dot, subtract, wide};
use lookfrom_simd::{Float, Real, Simd, f32x8, f64x8};

/// The intersection with a triangle: `t`, and the barycentric weights of its second and third corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing<T = f32> {
    pub(crate) t: T,
    pub(crate) u: T,
    pub(crate) v: T,
}

/// The hit of a ray with a triangle, with `t_min < t`. The caller compares t with the ray's end.
///
/// No component of the edges at the first corner is larger than `extent` (up to rounding to f32).
#[inline(always)]
pub(crate) fn intersect_exact<T: Rounded>(
    ray: &ExactRay<T>,
    corners: &[[f32; 3]; 3],
    extent: f32,
) -> Option<Crossing<T>> {
    let sheared = Sheared::new(ray, corners);
    if !sheared.is_met() {
        return None;
    }
    let meeting = meet_exactly(ray, corners);
    let extent = f64::from(extent);
    let product = extent * widest(ray.direction);
    let determinant = meeting.determinant.abs();
    let crossing =
        if determinant > CLEAR * product * (extent + widest(subtract(wide(corners[0]), ray.origin))) {
            meeting.round()
        } else if determinant > GRAZING * 6.5 * product * extent {
            // No product of the determinant is larger: t is right, but the weights may have lost their digits.
            let [u, v] = sheared.weights();
            Crossing { t: T::rounded(meeting.t), u, v }
        } else {
            sheared.grazing(ray, corners)
        };
    (crossing.t > ray.t_min).then_some(crossing)
}

/// The largest magnitude.
fn widest([x, y, z]: [f64; 3]) -> f64 {
    x.abs().max(y.abs()).max(z.abs())
}

/// The crossing with a triangle that the conservative test found surely crossed, so that the rest of [`intersect_exact`]
/// is not needed, up to its comparison with the ray's range. Its determinant is clear: it is the sum of three edge
/// functions that exceed their error, and that error is `error_bounds::ERROR` relative to the same product as [`CLEAR`].
#[inline(always)]
pub(crate) fn intersect_sure(ray: &ExactRay, corners: &[[f32; 3]; 3]) -> Crossing {
    meet_exactly(ray, corners).round()
}

/// Crossings of eight rays with their triangles, which they surely hit: t, and the weights of the second and third corners.
#[inline(always)]
pub(crate) fn intersect_sure_lanes<S: Simd>(
    origin: [f32x8<S>; 3],
    direction: [f32x8<S>; 3],
    [p0, p1, p2]: [[f32x8<S>; 3]; 3],
) -> [f32x8<S>; 3] {
    let corners = [wide_lanes(p0), wide_lanes(p1), wide_lanes(p2)];
    let Meeting { t, u, v, .. } =
        meet(wide_lanes(origin), wide_lanes(direction), corners, |x: f64x8<S>| x.like(1.0) / x);
    [Real::narrow(t), Real::narrow(positive(u)), Real::narrow(positive(v))]
}

#[inline(always)]
fn wide_lanes<S: Simd>([x, y, z]: [f32x8<S>; 3]) -> [f64x8<S>; 3] {
    [Real::widen(x), Real::widen(y), Real::widen(z)]
}

/// A weight: less than 0 only because of rounding.
#[inline(always)]
fn positive<T: Float<Scalar = f64>>(x: T) -> T {
    let zero = x.like(0.0);
    T::select(x.gt(zero), x, zero)
}

/// True if the ray hits the front face of a triangle: the face from which its corners are seen counter-clockwise.
/// The signs are those of the exact test, so a ray leaves a closed mesh through as many back faces as it enters
/// through front faces.
pub(crate) fn is_front<T: Rounded>(ray: &ExactRay<T>, corners: &[[f32; 3]; 3]) -> bool {
    let Sheared { edges: [u, v, w], along, .. } = Sheared::new(ray, corners);
    (u + v + w > 0.0) == (along > 0.0)
}

/// True if a ray that hits a triangle crosses it: it would still hit it if it were moved aside by an infinitely small amount,
/// the same for all triangles. So at an edge it crosses one of two triangles that lie on different sides of it, and both or
/// neither of two on the same side: Edelsbrunner, Muecke (1990), "Simulation of Simplicity".
#[cold]
#[inline(never)]
pub(crate) fn is_crossed<T: Rounded>(ray: &ExactRay<T>, corners: &[[f32; 3]; 3]) -> bool {
    let Sheared { corners: [a, b, c], edges: [u, v, w], .. } = Sheared::new(ray, corners);
    let is_left = |edge: f64, p: [f64; 3], q: [f64; 3]| {
        if edge != 0.0 {
            edge > 0.0
        } else if p[1] != q[1] {
            // Moved by ε along the first axis, …
            p[1] > q[1]
        } else {
            // … and by ε² along the second.
            p[0] < q[0]
        }
    };
    let sides = [is_left(u, c, b), is_left(v, a, c), is_left(w, b, a)];
    sides == [true; 3] || sides == [false; 3]
}

/// An intersection before it is rounded.
struct Meeting<T> {
    determinant: T,
    t: T,
    u: T,
    v: T,
}

impl Meeting<f64> {
    #[inline(always)]
    fn round<T: Rounded>(&self) -> Crossing<T> {
        Crossing { t: T::rounded(self.t), u: T::rounded(positive(self.u)), v: T::rounded(positive(self.v)) }
    }
}

#[inline(always)]
fn meet_exactly<T: Rounded>(ray: &ExactRay<T>, corners: &[[f32; 3]; 3]) -> Meeting<f64> {
    let corners = [wide(corners[0]), wide(corners[1]), wide(corners[2])];
    meet(ray.origin, ray.direction, corners, |x| 1.0 / x)
}

/// The intersection of a ray with the plane of a triangle: Cramer's rule in the form of Möller and
/// Trumbore (1997).
#[inline(always)]
fn meet<T: Number + Neg<Output = T>>(
    origin: [T; 3],
    direction: [T; 3],
    [p0, p1, p2]: [[T; 3]; 3],
    invert: impl Fn(T) -> T,
) -> Meeting<T> {
    let [e1, e2] = [subtract(p1, p0), subtract(p2, p0)];
    let c = subtract(p0, origin);
    let n = cross(e1, e2);
    let r = cross(c, direction);
    let determinant = dot(n, direction);
    let inverse = invert(determinant);
    Meeting { determinant, t: dot(n, c) * inverse, u: dot(e2, r) * inverse, v: -dot(e1, r) * inverse }
}

/// A triangle translated to the ray's origin and sheared so that the ray runs along the third axis, with its edge
/// functions.
struct Sheared {
    corners: [[f64; 3]; 3],
    edges: [f64; 3],
    /// The direction's component along that axis.
    along: f64,
}

impl Sheared {
    #[inline(always)]
    fn new<T: Rounded>(ray: &ExactRay<T>, corners: &[[f32; 3]; 3]) -> Self {
        let [kx, ky, kz] = ray.axes();
        let d = ray.direction;
        // Multiplying by the direction's length instead of dividing by it keeps integers exact: edges and corners
        // are hit exactly.
        let shear = |corner: usize| {
            let p = subtract(wide(corners[corner]), ray.origin);
            [d[kz] * p[kx] - d[kx] * p[kz], d[kz] * p[ky] - d[ky] * p[kz], p[kz]]
        };
        let [a, b, c] = [shear(0), shear(1), shear(2)];
        let edges = [edge_function(c, b), edge_function(a, c), edge_function(b, a)];
        Self { corners: [a, b, c], edges, along: d[kz] }
    }

    /// True if the ray hits the triangle or its edges. A triangle seen edge-on is not hit.
    #[inline(always)]
    fn is_met(&self) -> bool {
        let [u, v, w] = self.edges;
        // Without short-circuit evaluation: the signs cannot be predicted.
        let outside = ((u < 0.0) | (v < 0.0) | (w < 0.0)) & ((u > 0.0) | (v > 0.0) | (w > 0.0));
        !outside & (u + v + w != 0.0)
    }

    /// The crossing where the ray runs nearly along the triangle's plane. NaN where it is behind the
    /// ray's start.
    #[cold]
    #[inline(never)]
    fn grazing<T: Rounded>(&self, ray: &ExactRay<T>, corners: &[[f32; 3]; 3]) -> Crossing<T> {
        let (p0, p1, p2) = (wide(corners[0]), wide(corners[1]), wide(corners[2]));
        let [e1, e2] = [subtract(p1, p0), subtract(p2, p0)];
        let (n, d) = (cross(e1, e2), ray.direction);
        let determinant = dot(n, d);
        let magnitude = dot(cross_magnitude(e1, e2), d.map(f64::abs));
        let ([u, v, w], [a, b, c]) = (self.edges, self.corners);
        let sum = u + v + w;
        let mut t = if determinant.abs() > DETERMINANT_ERROR * magnitude {
            dot(n, subtract(p0, ray.origin)) / determinant
        } else {
            // The ray runs along the plane, within the accuracy of f64: t is somewhere between the corners.
            (u * a[2] + v * b[2] + w * c[2]) / (sum * self.along)
        };
        if !(T::rounded(t) > ray.t_min) {
            t = f64::NAN;
        } else if determinant.abs() < GRAZING * magnitude {
            // Keep it inside the triangle's box, where every tree finds it.
            t = clamp_to_box(ray, corners, t);
        }
        let [u, v] = self.weights();
        Crossing { t: T::rounded(t), u, v }
    }

    /// The weights of the second and third corner: never outside of the triangle, however far away that is.
    fn weights<T: Rounded>(&self) -> [T; 2] {
        let [u, v, w] = self.edges;
        let sum = u + v + w;
        [T::rounded(v / sum), T::rounded(w / sum)]
    }
}

/// Relative error of the determinant n·d, with a large margin: 2⁻⁴⁸ (rounding: about 6 · 2⁻⁵³).
const DETERMINANT_ERROR: f64 = 3.552_713_678_800_501e-15;

/// Below this relative determinant, 2⁻³⁰, the errors of t and of the edge functions may differ by more than 2⁻²² of
/// the triangle's size, which comes close to the margin of the box test.
const GRAZING: f64 = 9.313_225_746_154_785e-10;

/// Above this relative determinant, 2⁻¹⁷, the weights of Cramer's rule have the accuracy of f32.
const CLEAR: f64 = 7.629_394_531_25e-6;

/// `p.x q.y − p.y q.x` with the right sign.
#[inline(always)]
fn edge_function(p: [f64; 3], q: [f64; 3]) -> f64 {
    let [first, second] = [p[0] * q[1], p[1] * q[0]];
    if first == second {
        // The rounding errors of the products decide.
        return product_error(p[0], q[1], first) - product_error(p[1], q[0], second);
    }
    first - second
}

/// `a · b − product` exactly, where `product` is a · b rounded: Dekker (1971), with Veltkamp's splitting.
#[cold]
fn product_error(a: f64, b: f64, product: f64) -> f64 {
    let split = |x: f64| {
        let scaled = x * 134_217_729.0; // 2²⁷ + 1
        let high = scaled - (scaled - x);
        (high, x - high)
    };
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    ((ah * bh - product) + ah * bl + al * bh) + al * bl
}

/// Clamps t to the interval in which the ray is inside the triangle's box.
fn clamp_to_box<T: Rounded>(ray: &ExactRay<T>, corners: &[[f32; 3]; 3], t: f64) -> f64 {
    let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        if ray.direction[axis] != 0.0 {
            let at = |p: &[f32; 3]| (f64::from(p[axis]) - ray.origin[axis]) / ray.direction[axis];
            let [a, b, c] = [at(&corners[0]), at(&corners[1]), at(&corners[2])];
            near = near.max(a.min(b).min(c));
            far = far.min(a.max(b).max(c));
        }
    }
    t.min(far).max(near)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::Ray;

    #[test]
    fn the_error_of_a_product_is_exact() {
        let (a, b) = (1.0 + 2.0_f64.powi(-40), 1.0 - 2.0_f64.powi(-40));
        assert_eq!(a * b, 1.0);
        assert_eq!(product_error(a, b, a * b), -(2.0_f64.powi(-80)));
    }

    #[test]
    fn a_wide_plane_one_ulp_beneath_the_origin() {
        // The plane is at height 0.1; the ray starts there, one ulp above and one below, and leaves at a slant.
        let height = 0.1_f32;
        let corners = [[-1e6, -1e6, height], [1e6, -1e6, height], [3.0, 1e6, height]];
        for direction in [[0.3, -0.2, 1.0], [0.3, -0.2, 1e-6], [1e3, 0.0, 1e-3]] {
            for (z, above) in [(height, true), (height.next_up(), true), (height.next_down(), false)] {
                let ray = ExactRay::new(&Ray::new([0.1, -0.3, z], direction));
                assert_eq!(intersect_exact(&ray, &corners, 4e6).is_none(), above, "{direction:?} from {z}");
            }
        }
    }
}
