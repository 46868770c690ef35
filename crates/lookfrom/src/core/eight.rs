//! Points, normals and frames of eight surfaces at once, one in each lane of the SIMD vectors.
//!
//! The SIMD versions of [`lookfrom_bvh::Point`], of [`crate::core::warp`] and of glam's vectors: each lane has bit
//! for bit the scalar result, because it performs the same operations in the same order. Functions are
//! `#[inline(always)]`, so that they are compiled for the SIMD level of their caller.

use lookfrom_simd::{Simd, f32x8, f64x8, i32x8, mask32x8, mask64x8, prelude::*};

/// Number of lanes.
pub(crate) const LANES: usize = 8;

/// Eight numbers in single precision.
pub(crate) type Narrow<S> = f32x8<S>;

/// Eight numbers in double precision.
pub(crate) type Wide<S> = f64x8<S>;

/// Unit of rounding of f64, 2⁻⁵³, as in [`lookfrom_bvh::Point`].
const UNIT: f64 = f64::EPSILON / 2.0;

/// Eight vectors of three components.
#[derive(Clone, Copy)]
pub(crate) struct Vectors<T>(pub(crate) [T; 3]);

/// An array of an expression's values for each lane. (Closures of `from_fn` and `map` are not compiled for the SIMD
/// level.)
macro_rules! by_lane {
    ($lane:ident => $value:expr) => {{
        let mut $lane = 0;
        let first = $value;
        let mut all = [first; $crate::core::eight::LANES];
        $lane = 1;
        while $lane < $crate::core::eight::LANES {
            all[$lane] = $value;
            $lane += 1;
        }
        all
    }};
}

/// An array of an expression's values for each axis.
macro_rules! by_axis {
    ($axis:ident => $value:expr) => {
        [
            {
                let $axis = 0;
                $value
            },
            {
                let $axis = 1;
                $value
            },
            {
                let $axis = 2;
                $value
            },
        ]
    };
}

pub(crate) use {by_axis, by_lane};

/// Converts to double precision.
#[inline(always)]
pub(crate) fn widen<S: Simd>(x: Narrow<S>) -> Wide<S> {
    let (low, high) = x.widen();
    low.combine(high)
}

/// Rounds to single precision.
#[inline(always)]
pub(crate) fn narrow<S: Simd>(x: Wide<S>) -> Narrow<S> {
    let (low, high) = x.split();
    low.narrow(high)
}

impl<S: Simd> Vectors<Wide<S>> {
    /// One vector in each lane.
    #[inline(always)]
    pub(crate) fn of_rows(simd: S, rows: &[[f64; 3]; LANES]) -> Self {
        Self(by_axis!(i => f64x8::load_array(simd, by_lane!(lane => rows[lane][i]))))
    }

    #[inline(always)]
    pub(crate) fn dot(self, other: Self) -> Wide<S> {
        let (Self([ax, ay, az]), Self([bx, by, bz])) = (self, other);
        ax * bx + ay * by + az * bz
    }

    #[inline(always)]
    pub(crate) fn sub(self, other: Self) -> Self {
        let (Self([ax, ay, az]), Self([bx, by, bz])) = (self, other);
        Self([ax - bx, ay - by, az - bz])
    }

    #[inline(always)]
    pub(crate) fn add(self, other: Self) -> Self {
        let (Self([ax, ay, az]), Self([bx, by, bz])) = (self, other);
        Self([ax + bx, ay + by, az + bz])
    }

    #[inline(always)]
    pub(crate) fn scale(self, factor: Wide<S>) -> Self {
        Self(by_axis!(i => self.0[i] * factor))
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        Self(by_axis!(i => self.0[i].abs()))
    }

    #[inline(always)]
    fn cross(self, other: Self) -> Self {
        let (Self([ax, ay, az]), Self([bx, by, bz])) = (self, other);
        Self([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
    }

    #[inline(always)]
    pub(crate) fn length(self) -> Wide<S> {
        self.dot(self).sqrt()
    }

    /// Normalised, in the same way as glam.
    #[inline(always)]
    pub(crate) fn normalize(self, simd: S) -> Self {
        self.scale(f64x8::splat(simd, 1.0) / self.length())
    }

    #[inline(always)]
    pub(crate) fn narrow(self) -> Vectors<Narrow<S>> {
        Vectors(by_axis!(i => narrow(self.0[i])))
    }
}

impl<S: Simd> Vectors<Narrow<S>> {
    /// One vector in each lane.
    #[inline(always)]
    pub(crate) fn of_rows(simd: S, rows: &[[f32; 3]; LANES]) -> Self {
        Self(by_axis!(i => f32x8::load_array(simd, by_lane!(lane => rows[lane][i]))))
    }

    #[inline(always)]
    pub(crate) fn dot(self, other: Self) -> Narrow<S> {
        let (Self([ax, ay, az]), Self([bx, by, bz])) = (self, other);
        ax * bx + ay * by + az * bz
    }

    #[inline(always)]
    pub(crate) fn scale(self, factor: Narrow<S>) -> Self {
        Self(by_axis!(i => self.0[i] * factor))
    }

    #[inline(always)]
    pub(crate) fn add(self, other: Self) -> Self {
        let (Self([ax, ay, az]), Self([bx, by, bz])) = (self, other);
        Self([ax + bx, ay + by, az + bz])
    }

    /// Normalised, in the same way as glam.
    #[inline(always)]
    pub(crate) fn normalize(self, simd: S) -> Self {
        self.scale(f32x8::splat(simd, 1.0) / self.dot(self).sqrt())
    }

    #[inline(always)]
    pub(crate) fn widen(self) -> Vectors<Wide<S>> {
        Vectors(by_axis!(i => widen(self.0[i])))
    }

    /// The vector in a lane.
    #[inline(always)]
    pub(crate) fn lane(&self, lane: usize) -> [f32; 3] {
        by_axis!(i => self.0[i][lane])
    }
}

/// Points on surfaces with their error bounds: the SIMD version of [`lookfrom_bvh::Point`].
#[derive(Clone, Copy)]
pub(crate) struct Points<S: Simd> {
    pub(crate) position: Vectors<Wide<S>>,
    pub(crate) error: Vectors<Wide<S>>,
}

impl<S: Simd> Points<S> {
    /// The SIMD version of [`lookfrom_bvh::Point::on_triangle_with_normal`].
    #[inline(always)]
    pub(crate) fn on_triangles(
        simd: S,
        corners: [Vectors<Narrow<S>>; 3],
        u: Narrow<S>,
        v: Narrow<S>,
    ) -> (Self, Vectors<Wide<S>>) {
        let zero = f64x8::splat(simd, 0.0);
        let [p0, p1, p2] = by_axis!(k => corners[k].widen());
        let (u, v) = (widen(u), widen(v));
        let (e1, e2) = (p1.sub(p0), p2.sub(p0));
        let position = by_axis!(i => p0.0[i] + u * e1.0[i] + v * e2.0[i]);

        let n = e1.cross(e2);
        let (a1, a2) = (e1.abs(), e2.abs());
        let reach = a1.add(a2);
        let length = n.length();
        let (Vectors([ax, ay, az]), Vectors([bx, by, bz])) = (a1, a2);
        let magnitude = Vectors([ay * bz + az * by, az * bx + ax * bz, ax * by + ay * bx]);
        let decision = magnitude.dot(reach) * (8.0 * UNIT) / length;
        let decision = decision.is_finite().select(decision, zero);
        let error = by_axis!(i => {
            let magnitude = p0.0[i].abs() + (u * e1.0[i]).abs() + (v * e2.0[i]).abs() + reach.0[i];
            magnitude * (8.0 * UNIT) + decision
        });
        (Self { position: Vectors(position), error: Vectors(error) }, n)
    }

    /// The SIMD version of [`lookfrom_bvh::Point::leave`].
    #[inline(always)]
    pub(crate) fn leave(
        &self,
        simd: S,
        unit_normal: Vectors<Wide<S>>,
        direction: Vectors<Wide<S>>,
    ) -> Vectors<Narrow<S>> {
        let zero = f64x8::splat(simd, 0.0);
        let (one, minus) = (f64x8::splat(simd, 1.0), f64x8::splat(simd, -1.0));
        let side = unit_normal.dot(direction).simd_lt(zero).select(minus, one);
        let normal = unit_normal.scale(side);
        let [x, y, z] =
            by_axis!(i => normal.0[i].abs() * (self.error.0[i] + self.position.0[i].abs() * (4.0 * UNIT)));
        let step = (x + y + z) * (1.0 + 1e-6);
        Vectors(by_axis!(i => {
            let moved = self.position.0[i] + step * normal.0[i];
            let still = normal.0[i].simd_eq(zero);
            round_toward(simd, moved, normal.0[i].simd_gt(zero), still)
        }))
    }
}

/// Rounds to the nearest f32 that is not below (`up`) or not above; to the nearest where `still`.
#[inline(always)]
fn round_toward<S: Simd>(simd: S, x: Wide<S>, up: mask64x8<S>, still: mask64x8<S>) -> Narrow<S> {
    let nearest = narrow(x);
    let wide = widen(nearest);
    let wrong = (up & wide.simd_lt(x)) | (!up & wide.simd_gt(x));
    let wrong = narrow_mask(simd, wrong & !still);
    let up = narrow_mask(simd, up);
    // The next float is one step of the bits, forward or back by sign; from zero it is the smallest number of that
    // sign.
    let bits: i32x8<S> = nearest.bitcast();
    let (one, back) = (i32x8::splat(simd, 1), i32x8::splat(simd, -1));
    let zero = i32x8::splat(simd, 0);
    let positive = bits.simd_ge(zero);
    let grows = (positive & up) | (!positive & !up);
    let stepped = bits + grows.select(one, back);
    let least = up.select(one, i32x8::splat(simd, i32::MIN + 1));
    let stepped = nearest.simd_eq(f32x8::splat(simd, 0.0)).select(least, stepped);
    wrong.select(stepped, bits).bitcast()
}

/// Converts a mask of double precision to single precision.
#[inline(always)]
fn narrow_mask<S: Simd>(simd: S, mask: mask64x8<S>) -> mask32x8<S> {
    mask32x8::from_bitmask(simd, mask.to_bitmask())
}

/// Orthonormal frames about unit normals: the SIMD version of [`crate::core::warp::orthonormal_basis`].
#[inline(always)]
pub(crate) fn orthonormal_bases<S: Simd>(simd: S, n: Vectors<Narrow<S>>) -> [Vectors<Narrow<S>>; 2] {
    let one = f32x8::splat(simd, 1.0);
    let Vectors([x, y, z]) = n;
    let sign = one.copysign(z);
    let a = f32x8::splat(simd, -1.0) / (sign + z);
    let b = x * y * a;
    [Vectors([one + sign * x * x * a, sign * b, -sign * x]), Vectors([b, sign + y * y * a, -y])]
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use lookfrom_bvh::Point;
    use lookfrom_simd::{Kernel, Level, dispatch};

    use super::*;
    use crate::core::{hash, warp};

    /// The input of a test case: corners, u and v, a direction, a point of the square.
    #[derive(Clone, Copy, Debug)]
    struct Question {
        corners: [[f32; 3]; 3],
        on: [f32; 2],
        direction: [f32; 3],
    }

    #[derive(Debug, PartialEq)]
    struct Answer {
        position: [f64; 3],
        error: [f64; 3],
        origin: [f32; 3],
        basis: [[f32; 3]; 2],
        disk: [f32; 2],
    }

    struct Ask<'a>(&'a [Question; LANES]);

    impl Kernel for Ask<'_> {
        type Output = [Answer; LANES];
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let rows = |of: &dyn Fn(usize) -> [f32; 3]| {
                Vectors::<Narrow<S>>::of_rows(simd, &std::array::from_fn(of))
            };
            let corners = [0, 1, 2].map(|corner| rows(&|lane| self.0[lane].corners[corner]));
            let [u, v] = [0, 1].map(|k| f32x8::load_array(simd, by_lane!(lane => self.0[lane].on[k])));
            let (points, across) = Points::on_triangles(simd, corners, u, v);
            let ng = across.normalize(simd);
            let origins = points.leave(simd, ng, rows(&|lane| self.0[lane].direction).widen());
            let basis = orthonormal_bases(simd, ng.narrow());
            let disks = warp::concentric_disks(simd, [u, v]);
            std::array::from_fn(|lane| Answer {
                position: points.position.0.map(|x| x[lane]),
                error: points.error.0.map(|x| x[lane]),
                origin: origins.lane(lane),
                basis: basis.map(|v| v.lane(lane)),
                disk: disks.map(|x| x[lane]),
            })
        }
    }

    fn one_by_one(question: &Question) -> Answer {
        let Question { corners: [p0, p1, p2], on: [u, v], direction } = *question;
        let (point, across) = Point::on_triangle_with_normal(p0, p1, p2, u, v);
        let ng = glam::DVec3::from_array(across).normalize();
        let (s, t) = warp::orthonormal_basis(ng.as_vec3());
        Answer {
            position: point.position,
            error: point.error,
            origin: point.leave(ng.to_array(), direction),
            basis: [s, t].map(|v: Vec3| v.to_array()),
            disk: warp::concentric_disk([u, v]).to_array(),
        }
    }

    #[test]
    fn eight_at_once_are_eight_one_by_one() {
        let mut levels = vec![Level::baseline(), Level::new()];
        #[cfg(target_arch = "x86_64")]
        levels.extend(Level::new().as_avx2().map(Level::Avx2));
        let mut count = 0_u64;
        let mut number = || {
            count += 1;
            hash::pair(count, 5)
        };
        for round in 0..4000 {
            let mut real = |least: i32, greatest: i32| {
                let bits = number();
                let mantissa = (bits >> 40) as f64 / 16_777_216.0 - 0.5;
                let exponent = least + (bits % (greatest - least + 1) as u64) as i32;
                (mantissa * libm::exp2(f64::from(exponent))) as f32
            };
            let questions: [Question; LANES] = std::array::from_fn(|lane| {
                let mut corners = [[0.0; 3]; 3].map(|corner: [f32; 3]| corner.map(|_| real(-20, 20)));
                // Some lie in an axis-aligned plane, as walls do.
                if (round + lane) % 3 == 0 {
                    corners.iter_mut().for_each(|corner| corner[lane % 3] = 1.5);
                }
                let on =
                    if lane == 7 && round % 5 == 0 { [0.5; 2] } else { [0.5 + real(0, 0), 0.5 + real(0, 0)] };
                Question { corners, on, direction: [0.0; 3].map(|_: f32| real(-20, 20)) }
            });
            for &level in &levels {
                let answers = dispatch(level, Ask(&questions));
                for (question, answer) in questions.iter().zip(answers) {
                    let expected = one_by_one(question);
                    // A triangle of zero area gives NaN, whose bits do not matter.
                    if expected.origin.iter().all(|x| x.is_finite()) {
                        assert_eq!(answer, expected, "{question:?}");
                    }
                }
            }
        }
    }
}
