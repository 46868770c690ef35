//! Does a ray meet a triangle, and where?
//!
//! Two steps. The *filter* takes four triangles at once in f32 and excludes those that the ray surely misses; it may be
//! calculated in any way. The *decision* takes one triangle in f64 and alone says what is hit, so that the same bits come
//! out whatever the filter, the tree or the machine.
//!
//! The decision is watertight: Woop, Benthin, Wald (2013), "Watertight Ray/Triangle Intersection". Corners are moved to
//! the ray's origin and sheared so that the ray runs along one axis. A corner's two remaining coordinates come out the
//! same for every triangle that has it, and signs of the edge functions are right for these coordinates: rounding is
//! monotonous, so a difference of two rounded products has the sign of the exact one or is 0, and then the rounding
//! errors of the products decide. So rays see a plane mesh without gaps. An edge belongs to both of its triangles.
//!
//! `t` is the plane's, `n·(p0 − o) / n·d`, from differences of f32 values that f64 holds (nearly) exactly: its sign is
//! right to about 10⁻¹⁵ of the triangle's size, however near the origin is to the plane.

use crate::prepared::Prepared;
use crate::ray::NONE;
use crate::simd::Lanes;
use crate::vector::{cross, cross_magnitude, dot, subtract, wide};

/// Triangles in a block.
pub(crate) const BLOCK: usize = 4;

/// Relative error of a corner's coordinates after translation and shear in f32: at most 8 units of rounding of the
/// largest coordinate (differences 1 each, the factor 1, the product 1, the sum 1); twice that, since it stands also for
/// the rounding of the products in the edge functions.
const CORNER_ERROR: f32 = 9.536_743e-7;

/// Four triangles, component by component.
#[derive(Clone, Debug)]
#[repr(C, align(16))]
pub(crate) struct TriangleBlock {
    /// `corners[corner][axis]`; unused lanes repeat lane 0.
    corners: [[Lanes<BLOCK>; 3]; 3],
    geometry: [u32; BLOCK],
    /// [`NONE`] in unused lanes.
    primitive: [u32; BLOCK],
}

/// Where a triangle is met: `t`, and the weights of its second and third corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    pub(crate) t: f32,
    pub(crate) u: f32,
    pub(crate) v: f32,
}

impl TriangleBlock {
    /// Packs one to four triangles: corners, geometry, primitive.
    pub(crate) fn new(triangles: &[([[f32; 3]; 3], u32, u32)]) -> Self {
        let mut block =
            Self { corners: [[Lanes::splat(0.0); 3]; 3], geometry: [NONE; BLOCK], primitive: [NONE; BLOCK] };
        for lane in 0..BLOCK {
            let (corners, geometry, primitive) = triangles.get(lane).unwrap_or(&triangles[0]);
            for corner in 0..3 {
                for axis in 0..3 {
                    block.corners[corner][axis].0[lane] = corners[corner][axis];
                }
            }
            if lane < triangles.len() {
                block.geometry[lane] = *geometry;
                block.primitive[lane] = *primitive;
            }
        }
        block
    }

    #[inline(always)]
    pub(crate) fn ids(&self, lane: usize) -> (u32, u32) {
        (self.geometry[lane], self.primitive[lane])
    }

    #[inline(always)]
    pub(crate) fn corners(&self, lane: usize) -> [[f32; 3]; 3] {
        self.corners.map(|corner| corner.map(|coordinate| coordinate.0[lane]))
    }

    /// Excludes: bit i is 0 where the ray surely does not meet triangle i at a t in `[t_min, t_max]`.
    #[inline(always)]
    pub(crate) fn filter(&self, ray: &Prepared, t_max: f32) -> u32 {
        let splat = Lanes::<BLOCK>::splat;

        // Move the origin to 0.
        let axes = ray.axes;
        let origin = axes.map(|axis| splat(ray.origin[axis]));
        let moved = self.corners.map(|corner| {
            [corner[axes[0]] - origin[0], corner[axes[1]] - origin[1], corner[axes[2]] - origin[2]]
        });

        // Bound the error of any coordinate.
        let largest = moved
            .map(|corner| corner[0].abs().max(corner[1].abs()).max(corner[2].abs()))
            .into_iter()
            .reduce(Lanes::max)
            .unwrap_or(splat(f32::INFINITY));
        let error = largest * splat(CORNER_ERROR) + splat(ray.rounding);

        // Shear, so that the ray runs along the third axis.
        let shear = ray.shear.map(splat);
        let [a, b, c] =
            moved.map(|corner| [corner[0] - shear[0] * corner[2], corner[1] - shear[1] * corner[2]]);

        // Take the edge functions and the bound of their errors.
        let u = c[0] * b[1] - c[1] * b[0];
        let v = a[0] * c[1] - a[1] * c[0];
        let w = b[0] * a[1] - b[1] * a[0];
        let size = (a[0].abs() + a[1].abs()) + (b[0].abs() + b[1].abs()) + (c[0].abs() + c[1].abs());
        let bound = error * (size + error) + splat(f32::MIN_POSITIVE);
        let negative = splat(0.0) - bound;

        // A miss has two edge functions of surely different signs.
        let some_negative = u.below(negative) | v.below(negative) | w.below(negative);
        let some_positive = bound.below(u) | bound.below(v) | bound.below(w);
        let outside = some_negative.and(some_positive);

        // Or it is surely out of range.
        let scale = splat(ray.reciprocal_length);
        let [ta, tb, tc] = moved.map(|corner| corner[2] * scale);
        let room = error * scale.abs();
        let before = (ta.max(tb).max(tc) + room).below(splat(ray.t_min));
        let beyond = splat(t_max).below(ta.min(tb).min(tc) - room);

        !(outside | before | beyond).bits() & ((1 << BLOCK) - 1)
    }
}

/// Decides whether and where a ray meets a triangle, with `t_min < t`. The caller compares t with the ray's end.
pub(crate) fn decide(ray: &Prepared, corners: &[[f32; 3]; 3]) -> Option<Crossing> {
    let [p0, p1, p2] = corners.map(wide);
    let [kx, ky, kz] = ray.axes;

    // Move the origin to 0 and shear, so that the ray runs along the third axis. Multiplying by the direction's
    // length there, in place of dividing by it, keeps whole numbers whole: edges and corners are met exactly.
    let d = ray.direction64;
    let [a, b, c] = [p0, p1, p2].map(|p| {
        let p = subtract(p, ray.origin64);
        [d[kz] * p[kx] - d[kx] * p[kz], d[kz] * p[ky] - d[ky] * p[kz], p[kz]]
    });

    // Look at the signs of the edge functions.
    let u = edge_function(c, b);
    let v = edge_function(a, c);
    let w = edge_function(b, a);
    if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
        return None;
    }
    let sum = u + v + w;
    if sum == 0.0 {
        return None;
    }

    // Meet the plane.
    let [e1, e2] = [subtract(p1, p0), subtract(p2, p0)];
    let n = cross(e1, e2);
    let determinant = dot(n, d);
    let magnitude = dot(cross_magnitude(e1, e2), d.map(f64::abs));
    let t = if determinant.abs() > DETERMINANT_ERROR * magnitude {
        dot(n, subtract(p0, ray.origin64)) / determinant
    } else {
        // The ray runs along the plane, as far as f64 can tell: t is somewhere between the corners.
        (u * a[2] + v * b[2] + w * c[2]) / (sum * d[kz])
    };
    if !(t as f32 > ray.t_min) {
        return None;
    }

    // At grazing angles keep t inside the triangle's box, where every tree looks for it.
    let t = if determinant.abs() < GRAZING * magnitude { clamp_to_box(ray, corners, t) } else { t };
    let t = t as f32;
    (t > ray.t_min).then_some(Crossing { t, u: (v / sum) as f32, v: (w / sum) as f32 })
}

/// Relative error of the determinant n·d, with much room: 2⁻⁴⁸ (rounding: about 6 · 2⁻⁵³).
const DETERMINANT_ERROR: f64 = 3.552_713_678_800_501e-15;

/// Below this relative determinant, 2⁻³⁰, the errors of t and of the edge functions may differ by more than 2⁻²² of the
/// triangle's size, which comes near the room of the box test.
const GRAZING: f64 = 9.313_225_746_154_785e-10;

/// `p.x q.y − p.y q.x` with the right sign.
#[inline(always)]
fn edge_function(p: [f64; 3], q: [f64; 3]) -> f64 {
    let [first, second] = [p[0] * q[1], p[1] * q[0]];
    if first == second {
        // What was rounded away decides.
        return product_error(p[0], q[1], first) - product_error(p[1], q[0], second);
    }
    first - second
}

/// `a · b − product` exactly, where `product` is a · b rounded: Dekker (1971), Veltkamp's splitting.
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

/// Moves t into the interval in which the ray is inside the triangle's box.
#[cold]
fn clamp_to_box(ray: &Prepared, corners: &[[f32; 3]; 3], t: f64) -> f64 {
    let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        if ray.direction64[axis] != 0.0 {
            let at = |p: &[f32; 3]| (f64::from(p[axis]) - ray.origin64[axis]) / ray.direction64[axis];
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
        // The plane runs through height 0.1; the ray starts there, one unit above and one below, and runs off slanting.
        let height = 0.1_f32;
        let corners = [[-1e6, -1e6, height], [1e6, -1e6, height], [3.0, 1e6, height]];
        for direction in [[0.3, -0.2, 1.0], [0.3, -0.2, 1e-6], [1e3, 0.0, 1e-3]] {
            for (z, above) in [(height, true), (height.next_up(), true), (height.next_down(), false)] {
                let ray = Prepared::new(&Ray::new([0.1, -0.3, z], direction)).unwrap();
                assert_eq!(decide(&ray, &corners).is_none(), above, "{direction:?} from {z}");
            }
        }
    }

    #[test]
    fn the_filter_keeps_what_is_decided_to_be_hit() {
        let mut random = crate::testing::Random::new(7);
        let (mut hits, mut kept, mut all) = (0, 0, 0);
        for _ in 0..200_000 {
            let center = random.point_with_exponents(-8, 8);
            let size = random.size(-8, 8);
            let corners = [0; 3].map(|_| random.near(center, size));
            let origin = random.point_with_exponents(-8, 8);
            let target = random.on_triangle(&corners);
            let direction = [0, 1, 2].map(|i| target[i] - origin[i]);
            let Some(ray) = Prepared::new(&Ray::new(origin, direction)) else { continue };
            let block = TriangleBlock::new(&[(corners, 0, 0)]);
            let keep = block.filter(&ray, f32::INFINITY) & 1;
            all += 1;
            kept += keep;
            if decide(&ray, &corners).is_some() {
                hits += 1;
                assert_eq!(keep, 1, "{corners:?} {ray:?}");
            }
        }
        assert!(hits > 20_000 && hits < kept && kept < all, "{hits} hits, {kept} kept of {all}");
    }
}
