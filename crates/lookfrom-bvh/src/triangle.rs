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
use crate::simd::{Chosen, Lanes};
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
    /// `corners[corner][axis][lane]`; unused lanes repeat lane 0.
    corners: [[[f32; BLOCK]; 3]; 3],
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
            Self { corners: [[[0.0; BLOCK]; 3]; 3], geometry: [NONE; BLOCK], primitive: [NONE; BLOCK] };
        for lane in 0..BLOCK {
            let (corners, geometry, primitive) = triangles.get(lane).unwrap_or(&triangles[0]);
            for corner in 0..3 {
                for axis in 0..3 {
                    block.corners[corner][axis][lane] = corners[corner][axis];
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
        let mut corners = [[0.0; 3]; 3];
        for corner in 0..3 {
            for axis in 0..3 {
                corners[corner][axis] = self.corners[corner][axis][lane];
            }
        }
        corners
    }

    /// Which lanes are left when those are excluded that the ray surely does not meet at a t in `[t_min, t_max]`.
    #[inline(always)]
    pub(crate) fn filter(&self, ray: &Prepared, t_max: f32) -> Chosen {
        let mut values = Values::default();
        self.values(ray, &mut values);
        let Values { least, most, bound, first, last } = &values;
        // A miss has two edge functions of surely different signs, or is surely out of range. Comparisons with NaN are
        // false, and exclude nothing.
        Chosen::which::<BLOCK>(|lane| {
            let outside = (least[lane] < -bound[lane]) & (most[lane] > bound[lane]);
            let out_of_range = (last[lane] < ray.t_min) | (first[lane] > t_max);
            !(outside | out_of_range)
        })
    }

    /// What the filter compares.
    #[inline(never)]
    fn values(&self, ray: &Prepared, values: &mut Values) {
        let splat = Lanes::<BLOCK>::splat;

        // Move the origin to 0.
        let [kx, ky, kz] = ray.axes.map(|axis| axis % 3);
        let (ox, oy, oz) = (splat(ray.origin[kx]), splat(ray.origin[ky]), splat(ray.origin[kz]));
        let [p0, p1, p2] = &self.corners;
        let (ax, ay, az) = (Lanes(p0[kx]) - ox, Lanes(p0[ky]) - oy, Lanes(p0[kz]) - oz);
        let (bx, by, bz) = (Lanes(p1[kx]) - ox, Lanes(p1[ky]) - oy, Lanes(p1[kz]) - oz);
        let (cx, cy, cz) = (Lanes(p2[kx]) - ox, Lanes(p2[ky]) - oy, Lanes(p2[kz]) - oz);

        // Bound the error of any coordinate.
        let largest_a = ax.abs().max(ay.abs()).max(az.abs());
        let largest_b = bx.abs().max(by.abs()).max(bz.abs());
        let largest_c = cx.abs().max(cy.abs()).max(cz.abs());
        let error = largest_a.max(largest_b).max(largest_c) * splat(CORNER_ERROR) + splat(ray.rounding);

        // Shear, so that the ray runs along the third axis.
        let (sx, sy) = (splat(ray.shear[0]), splat(ray.shear[1]));
        let (ax, ay) = (ax - sx * az, ay - sy * az);
        let (bx, by) = (bx - sx * bz, by - sy * bz);
        let (cx, cy) = (cx - sx * cz, cy - sy * cz);

        // Take the edge functions and the bound of their errors.
        let u = cx * by - cy * bx;
        let v = ax * cy - ay * cx;
        let w = bx * ay - by * ax;
        let size = (ax.abs() + ay.abs()) + (bx.abs() + by.abs()) + (cx.abs() + cy.abs());
        let bound = error * (size + error) + splat(f32::MIN_POSITIVE);
        // Between which t the corners are.
        let scale = splat(ray.reciprocal_length);
        let (ta, tb, tc) = (az * scale, bz * scale, cz * scale);
        let room = error * scale.abs();

        values.least = u.min(v).min(w).0;
        values.most = u.max(v).max(w).0;
        values.bound = bound.0;
        values.first = (ta.min(tb).min(tc) - room).0;
        values.last = (ta.max(tb).max(tc) + room).0;
    }
}

/// What the filter calculates of each triangle: the least and the greatest edge function and the bound of their errors;
/// the t before and after which no corner is.
#[derive(Default)]
struct Values {
    least: [f32; BLOCK],
    most: [f32; BLOCK],
    bound: [f32; BLOCK],
    first: [f32; BLOCK],
    last: [f32; BLOCK],
}

/// Decides whether and where a ray meets a triangle, with `t_min < t`. The caller compares t with the ray's end.
pub(crate) fn decide(ray: &Prepared, corners: &[[f32; 3]; 3]) -> Option<Crossing> {
    let (p0, p1, p2) = (wide(corners[0]), wide(corners[1]), wide(corners[2]));
    let [kx, ky, kz] = ray.axes;

    // Move the origin to 0 and shear, so that the ray runs along the third axis. Multiplying by the direction's
    // length there, in place of dividing by it, keeps whole numbers whole: edges and corners are met exactly.
    let d = ray.direction64;
    let sheared = |p: [f64; 3]| {
        let p = subtract(p, ray.origin64);
        [d[kz] * p[kx] - d[kx] * p[kz], d[kz] * p[ky] - d[ky] * p[kz], p[kz]]
    };
    let (a, b, c) = (sheared(p0), sheared(p1), sheared(p2));

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
            let keep = block.filter(&ray, f32::INFINITY).first(1).count();
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
