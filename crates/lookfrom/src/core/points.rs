//! Points on surfaces with bounds of their errors, at any width: [`lookfrom_bvh::Point`] in lanes, bit for bit.

use lookfrom_bvh::Affine;
use lookfrom_simd::{Bits, Float, Real, Simd, f32x8};

use crate::core::lanes::{LANES, by_lane, gather_f64};
use crate::core::vector::Vector;

/// Unit of rounding of f64, 2⁻⁵³, as in [`lookfrom_bvh::Point`].
const UNIT: f64 = f64::EPSILON / 2.0;

/// Unit of rounding of f32, 2⁻²⁴.
const UNIT32: f64 = f32::EPSILON as f64 / 2.0;

/// Points and bounds of their errors, in double precision.
#[derive(Clone, Copy)]
pub(crate) struct Points<R: Real> {
    pub(crate) position: Vector<R::Double>,
    pub(crate) error: Vector<R::Double>,
}

impl<R: Real> Points<R> {
    /// As [`lookfrom_bvh::Point::on_triangle_with_normal`].
    #[inline(always)]
    pub(crate) fn on_triangles(corners: [Vector<R>; 3], u: R, v: R) -> (Self, Vector<R::Double>) {
        let [p0, p1, p2] = [corners[0].widen(), corners[1].widen(), corners[2].widen()];
        let (u, v) = (u.widen(), v.widen());
        let (e1, e2) = (p1 - p0, p2 - p0);
        let n = e1.cross(e2);
        let (a1, a2) = (e1.abs(), e2.abs());
        let reach = a1 + a2;
        let length = n.length();
        let magnitude = Vector {
            x: a1.y * a2.z + a1.z * a2.y,
            y: a1.z * a2.x + a1.x * a2.z,
            z: a1.x * a2.y + a1.y * a2.x,
        };
        let decision = magnitude.dot(reach) * (8.0 * UNIT) / length;
        let decision = Float::select(Float::is_finite(decision), decision, decision.like(0.0));
        let position = p0 + e1 * u + e2 * v;
        let magnitude = p0.abs() + (e1 * u).abs() + (e2 * v).abs() + reach;
        let error =
            magnitude * magnitude.x.like(8.0 * UNIT) + Vector { x: decision, y: decision, z: decision };
        (Self { position, error }, n)
    }

    /// The ways from origins to just before these points, which have a normal and are seen from there in the direction `wi`:
    /// so that a ray ends before the surface of the points, although its direction is rounded.
    #[inline(always)]
    pub(crate) fn just_before(
        self,
        normal: Vector<R::Double>,
        wi: Vector<R>,
        origins: Vector<R>,
    ) -> Vector<R> {
        let origins = origins.widen();
        let Vector { x, y, z } = (self.position - origins).abs();
        let length = Float::max(Float::max(Float::max(x.like(0.0), x), y), z);
        let slack = length * f64::from(f32::EPSILON);
        let error = Vector { x: self.error.x + slack, y: self.error.y + slack, z: self.error.z + slack };
        let end = Self { position: self.position, error }.leave(normal, -wi);
        Vector::narrow(end.widen() - origins)
    }

    /// As [`lookfrom_bvh::Point::on_sphere`].
    #[inline(always)]
    pub(crate) fn on_spheres(center: Vector<R::Double>, radius: R::Double, hit: Vector<R::Double>) -> Self {
        let zero = radius.like(0.0);
        let f = hit - center;
        let length = f.length();
        let stretch = Float::select(length.gt(zero), radius / length, zero);
        let reach = radius * 2.0;
        let error = (center.abs() + Vector { x: reach, y: reach, z: reach }) * radius.like(8.0 * UNIT);
        Self { position: center + f * stretch, error }
    }

    /// As [`lookfrom_bvh::Point::leave`].
    #[inline(always)]
    pub(crate) fn leave(&self, unit_normal: Vector<R::Double>, direction: Vector<R>) -> Vector<R> {
        self.exits(unit_normal).toward(direction)
    }

    /// The ways out of the error bounds, along the unit normals and against them.
    #[inline(always)]
    pub(crate) fn exits<'a>(&self, unit_normal: Vector<R::Double>) -> Exits<'a, R> {
        let step = unit_normal * self.clearance(unit_normal);
        Exits { position: self.position, normal: unit_normal, step, lift: None }
    }

    /// The length of the way along the unit normals that leads out of the error bounds.
    #[inline(always)]
    pub(crate) fn clearance(&self, unit_normal: Vector<R::Double>) -> R::Double {
        let Self { position, error } = *self;
        let reach = unit_normal.abs().times(error + position.abs() * position.x.like(4.0 * UNIT));
        (reach.x + reach.y + reach.z) * (1.0 + 1e-6)
    }
}

/// The smooth surface that coarse meshes stand for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lift<R: Real> {
    /// The way to it from points, to the outside; zero where there is none.
    pub(crate) way: Vector<R>,
    /// Its normal, of unit length.
    pub(crate) ns: Vector<R>,
}

impl<R: Real> Lift<R> {
    /// The directions that lead to the outside of such a surface, whatever the side of the triangle.
    #[inline(always)]
    pub(crate) fn is_above(&self, direction: Vector<R>) -> <R::Double as Float>::Mask {
        let zero = self.way.x.widen().like(0.0);
        let is_lifted = self.way.widen().length_squared().gt(zero);
        is_lifted & self.ns.widen().dot(direction.widen()).gt(zero)
    }
}

/// The ways from points out of the bounds of their errors: for rays that leave surfaces.
pub(crate) struct Exits<'a, R: Real> {
    position: Vector<R::Double>,
    normal: Vector<R::Double>,
    /// On the side of the normal.
    step: Vector<R::Double>,
    lift: Option<&'a Lift<R>>,
}

impl<'a, R: Real> Exits<'a, R> {
    /// The ways from smooth surfaces, where directions are above those.
    #[inline(always)]
    pub(crate) fn lifted(self, lift: Option<&'a Lift<R>>) -> Self {
        Self { lift, ..self }
    }

    /// The origins of rays in some directions.
    #[inline(always)]
    pub(crate) fn toward(&self, direction: Vector<R>) -> Vector<R> {
        let cos = self.normal.dot(direction.widen());
        let mut is_behind = cos.lt(cos.like(0.0));
        let mut position = self.position;
        if let Some(lift) = self.lift {
            let is_above = lift.is_above(direction);
            is_behind = is_behind & !is_above;
            position = Vector::select(is_above, position + lift.way.widen(), position);
        }
        let normal = self.normal.negate_where(is_behind);
        let moved = position + self.step.negate_where(is_behind);
        Vector {
            x: round_away(moved.x, normal.x, direction.x),
            y: round_away(moved.y, normal.y, direction.y),
            z: round_away(moved.z, normal.z, direction.z),
        }
    }
}

/// Affine maps at any width, with what bounds of errors need.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement<R: Real> {
    /// The linear part, by rows.
    pub(crate) matrix: [Vector<R::Double>; 3],
    /// The image of the origin.
    pub(crate) translation: Vector<R::Double>,
    /// The inverse of the linear part, by rows.
    pub(crate) inverse: [Vector<R::Double>; 3],
    /// The amplification of errors by the map and its inverse: a bound of |M M⁻¹ − 1| and of the rounding in it.
    pub(crate) amplification: [Vector<R::Double>; 3],
}

impl Placement<f32> {
    /// Of one map and the inverse of its linear part.
    pub(crate) fn new(affine: &Affine, inverse_matrix: &[[f64; 3]; 3]) -> Self {
        StoredPlacement { affine, inverse: inverse_matrix, amplification: &amplification(affine) }.placement()
    }
}

/// The amplification of errors by a map and its inverse, by rows: see [`Placement::amplification`].
pub(crate) fn amplification(affine: &Affine) -> [[f64; 3]; 3] {
    let matrix = &affine.matrix;
    let inverse = affine.inverse().map_or([[0.0; 3]; 3], |inverse| inverse.matrix);
    [0, 1, 2].map(|i| {
        [0, 1, 2].map(|j| {
            let mut product = if i == j { -1.0 } else { 0.0 };
            let mut magnitude = 0.0;
            for k in 0..3 {
                product += matrix[i][k] * inverse[k][j];
                magnitude += (matrix[i][k] * inverse[k][j]).abs();
            }
            product.abs() + 8.0 * UNIT * magnitude
        })
    })
}

/// The parts of a placement where they are: of instances the kernel has the map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StoredPlacement<'a> {
    /// The map.
    pub(crate) affine: &'a Affine,
    /// The inverse of its linear part, by rows.
    pub(crate) inverse: &'a [[f64; 3]; 3],
    /// Its [`amplification`].
    pub(crate) amplification: &'a [[f64; 3]; 3],
}

impl StoredPlacement<'_> {
    /// The placement.
    #[inline]
    pub(crate) fn placement(&self) -> Placement<f32> {
        Placement {
            matrix: self.affine.matrix.map(Vector::from),
            translation: self.affine.translation.into(),
            inverse: self.inverse.map(Vector::from),
            amplification: self.amplification.map(Vector::from),
        }
    }
}

impl<R: Real> Placement<R> {
    /// The images of directions.
    #[inline(always)]
    pub(crate) fn vector(&self, v: Vector<R::Double>) -> Vector<R::Double> {
        let [x, y, z] = self.matrix;
        Vector { x: x.dot(v), y: y.dot(v), z: z.dot(v) }
    }

    /// The directions whose images these are.
    #[inline(always)]
    pub(crate) fn vector_back(&self, v: Vector<R::Double>) -> Vector<R::Double> {
        let [x, y, z] = self.inverse;
        Vector { x: x.dot(v), y: y.dot(v), z: z.dot(v) }
    }

    /// The images of surface normals; not of unit length.
    #[inline(always)]
    pub(crate) fn normal(&self, n: Vector<R::Double>) -> Vector<R::Double> {
        let [x, y, z] = self.inverse;
        x * n.x + y * n.y + z * n.z
    }
}

/// One map in each lane.
#[inline(always)]
pub(crate) fn gather_placements<S: Simd>(simd: S, rows: &[&Placement<f32>; LANES]) -> Placement<f32x8<S>> {
    macro_rules! gathered {
        ($field:ident, $row:literal) => {
            gather_f64(simd, &by_lane!(lane => <[f64; 3]>::from(rows[lane].$field[$row])))
        };
        ($field:ident) => {
            [gathered!($field, 0), gathered!($field, 1), gathered!($field, 2)]
        };
    }
    let translation = gather_f64(simd, &by_lane!(lane => <[f64; 3]>::from(rows[lane].translation)));
    let (matrix, inverse) = (gathered!(matrix), gathered!(inverse));
    Placement { matrix, translation, inverse, amplification: gathered!(amplification) }
}

impl<R: Real> Points<R> {
    /// As [`lookfrom_bvh::Point::transformed`].
    #[inline(always)]
    pub(crate) fn placed(&self, placement: &Placement<R>) -> Self {
        let Placement { matrix: [a, b, c], translation, amplification: [d, e, f], .. } = *placement;
        let relative = placement.vector(self.position);
        let position = relative + translation;
        let size = self.position.abs();
        let way = relative.abs() * size.x.like(1.0 + 1e-6);
        // Per coordinate of the object: the error there, with the rounding of the ray's origin to f32.
        let unit = way.x.like(UNIT32 * (1.0 + 1e-6));
        let own = [
            self.error.x + size.x * (8.0 * UNIT) + unit * size.x,
            self.error.y + size.y * (8.0 * UNIT) + unit * size.y,
            self.error.z + size.z * (8.0 * UNIT) + unit * size.z,
        ];
        let ends = way + translation.abs() + position.abs();
        let error = Vector {
            x: carried(d, way, a, own) + ends.x * (4.0 * UNIT),
            y: carried(e, way, b, own) + ends.y * (4.0 * UNIT),
            z: carried(f, way, c, own) + ends.z * (4.0 * UNIT),
        };
        Self { position, error }
    }
}

/// One coordinate of the error that a map carries over: of rows of its amplification and of its matrix.
#[inline(always)]
fn carried<D: Float>(amplification: Vector<D>, way: Vector<D>, row: Vector<D>, own: [D; 3]) -> D {
    let row = row.abs();
    let x = amplification.x * way.x + row.x * own[0];
    let y = x + amplification.y * way.y + row.y * own[1];
    y + amplification.z * way.z + row.z * own[2]
}

/// As the nearest f32 that is not before `x` on the way along a normal; simply the nearest where that is 0. `like` is
/// any number as wide.
#[inline(always)]
fn round_away<R: Real>(x: R::Double, normal: R::Double, like: R) -> R {
    let nearest = R::narrow(x);
    let wide = nearest.widen();
    let zero = x.like(0.0);
    let (up, down) = (normal.gt(zero), normal.lt(zero));
    let falls_short = like.narrow_mask((up & wide.lt(x)) | (down & wide.gt(x)));
    let up = like.narrow_mask(up);
    // One step in the order of the numbers is one step of the bits, forward or back by sign; from zero it is the least
    // number of that side.
    let bits = nearest.to_bits();
    let is_positive = nearest.gt(nearest.like(0.0));
    let grows = (is_positive & up) | (!is_positive & !up);
    let stepped = bits.wrapping_add(R::select_bits(grows, bits.like(1), bits.like(u32::MAX)));
    let least = R::select_bits(up, bits.like(1), bits.like(0x8000_0001));
    let stepped = R::select_bits(Float::eq(nearest, nearest.like(0.0)), least, stepped);
    R::from_bits(R::select_bits(falls_short, stepped, bits))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use lookfrom_bvh::Point;
    use lookfrom_simd::{Kernel, Level, Simd, dispatch, f32x8, prelude::*};

    use super::*;
    use crate::core::lanes::{gather, scatter, scatter_f64};
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
            let corners =
                [0, 1, 2].map(|corner| gather(simd, &by_lane!(lane => self.0[lane].corners[corner])));
            let [u, v] = [0, 1].map(|k| f32x8::load_array(simd, by_lane!(lane => self.0[lane].on[k])));
            let (points, across) = Points::on_triangles(corners, u, v);
            let ng = across.normalize();
            let directions = gather(simd, &by_lane!(lane => self.0[lane].direction));
            let origins = scatter(points.leave(ng, directions));
            let (s, t) = warp::basis_about(Vector::narrow(ng));
            let basis = [scatter(s), scatter(t)];
            let (positions, errors) = (scatter_f64(points.position), scatter_f64(points.error));
            let disks = warp::concentric_disk([u, v]);
            std::array::from_fn(|lane| Answer {
                position: positions[lane],
                error: errors[lane],
                origin: origins[lane],
                basis: basis.map(|axis| axis[lane]),
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
            disk: warp::concentric_disk([u, v]),
        }
    }

    #[test]
    fn placed_points_are_those_of_the_kernel() {
        for count in 0..20_000_u64 {
            let number = |k: u64| {
                let bits = hash::pair(count, k);
                let exponent = (bits % 41) as i32 - 20;
                ((bits >> 40) as f64 / 16_777_216.0 - 0.5) * libm::exp2(f64::from(exponent))
            };
            let vector = |k: u64| [number(k), number(k + 1), number(k + 2)];
            let map = Affine { matrix: [vector(0), vector(3), vector(6)], translation: vector(9) };
            let point = Point { position: vector(12), error: vector(15).map(f64::abs) };
            let points = Points::<f32> { position: point.position.into(), error: point.error.into() };
            let placed = points.placed(&Placement::new(&map, &map.matrix));
            let expected = point.transformed(&map);
            let placed = Point { position: placed.position.into(), error: placed.error.into() };
            assert_eq!(placed, expected);
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
