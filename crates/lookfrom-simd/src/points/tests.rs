//! Points at every width beside a plain reference in arrays, bit for bit.

use fearless_simd::prelude::*;

use super::*;
use crate::placement::{Placement, amplification};
use crate::rounding::UNIT32;
use crate::{Kernel, Level, Simd, dispatch, f32x8, f64x8};

type Double = [f64; 3];

fn dot(a: Double, b: Double) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Double, b: Double) -> Double {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The reference: a point and its error.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Point {
    position: Double,
    error: Double,
}

impl Point {
    fn on_triangle([p0, p1, p2]: [[f32; 3]; 3], [u, v]: [f32; 2]) -> (Self, Double) {
        let [p0, p1, p2] = [p0, p1, p2].map(|p| p.map(f64::from));
        let (u, v) = (f64::from(u), f64::from(v));
        let [e1, e2] = [p1, p2].map(|p| [0, 1, 2].map(|i| p[i] - p0[i]));
        let n = cross(e1, e2);
        let reach = [0, 1, 2].map(|i| e1[i].abs() + e2[i].abs());
        let [a, b] = [e1, e2].map(|e| e.map(f64::abs));
        let terms = [a[1] * b[2] + a[2] * b[1], a[2] * b[0] + a[0] * b[2], a[0] * b[1] + a[1] * b[0]];
        let decision = 8.0 * UNIT * dot(terms, reach) / dot(n, n).sqrt();
        let decision = if decision.is_finite() { decision } else { 0.0 };
        let error = |i: usize| {
            8.0 * UNIT * (p0[i].abs() + (u * e1[i]).abs() + (v * e2[i]).abs() + reach[i]) + decision
        };
        let position = [0, 1, 2].map(|i| p0[i] + u * e1[i] + v * e2[i]);
        (Self { position, error: [0, 1, 2].map(error) }, n)
    }

    fn on_sphere(center: Double, radius: f64, hit: Double) -> Self {
        let f = [0, 1, 2].map(|i| hit[i] - center[i]);
        let length = dot(f, f).sqrt();
        let stretch = if length > 0.0 { radius / length } else { 0.0 };
        let position = [0, 1, 2].map(|i| center[i] + stretch * f[i]);
        Self { position, error: center.map(|x| 8.0 * UNIT * (x.abs() + 2.0 * radius)) }
    }

    fn placed(&self, [matrix, inverse]: &[[Double; 3]; 2], translation: Double) -> Self {
        let relative = matrix.map(|row| dot(row, self.position));
        let position = [0, 1, 2].map(|i| relative[i] + translation[i]);
        let size = self.position.map(f64::abs);
        let way = relative.map(|x| x.abs() * (1.0 + 1e-6));
        let error = |i: usize| {
            let mut error = 0.0;
            for j in 0..3 {
                let mut product = if i == j { -1.0 } else { 0.0 };
                let mut magnitude = 0.0;
                for k in 0..3 {
                    product += matrix[i][k] * inverse[k][j];
                    magnitude += (matrix[i][k] * inverse[k][j]).abs();
                }
                error += (product.abs() + 8.0 * UNIT * magnitude) * way[j];
                let own = self.error[j] + 8.0 * UNIT * size[j] + UNIT32 * (1.0 + 1e-6) * size[j];
                error += matrix[i][j].abs() * own;
            }
            error + 4.0 * UNIT * (way[i] + translation[i].abs() + position[i].abs())
        };
        Self { position, error: [0, 1, 2].map(error) }
    }

    fn leave(&self, unit_normal: Double, direction: [f32; 3]) -> [f32; 3] {
        let side = if dot(unit_normal, direction.map(f64::from)) < 0.0 { -1.0 } else { 1.0 };
        let normal = unit_normal.map(|x| x * side);
        let reach =
            [0, 1, 2].map(|i| normal[i].abs() * (self.error[i] + 4.0 * UNIT * self.position[i].abs()));
        let step = (reach[0] + reach[1] + reach[2]) * (1.0 + 1e-6);
        [0, 1, 2].map(|i| {
            let moved = self.position[i] + step * normal[i];
            let nearest = moved as f32;
            match normal[i] {
                n if n > 0.0 && f64::from(nearest) < moved => nearest.next_up(),
                n if n < 0.0 && f64::from(nearest) > moved => nearest.next_down(),
                _ => nearest,
            }
        })
    }
}

/// A triangle, a place on it, a sphere, a map and a direction.
#[derive(Clone, Copy, Debug)]
struct Case {
    corners: [[f32; 3]; 3],
    on: [f32; 2],
    sphere: (Double, f64),
    map: [[Double; 3]; 2],
    translation: Double,
    direction: [f32; 3],
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Outcome {
    on_triangle: Point,
    on_sphere: Point,
    placed: Point,
    origin: [f32; 3],
}

impl Case {
    fn by_reference(&self) -> Outcome {
        let (on_triangle, n) = Point::on_triangle(self.corners, self.on);
        let ng = n.map(|x| x * (1.0 / dot(n, n).sqrt()));
        Outcome {
            on_triangle,
            on_sphere: Point::on_sphere(self.sphere.0, self.sphere.1, on_triangle.position),
            placed: on_triangle.placed(&self.map, self.translation),
            origin: on_triangle.leave(ng, self.direction),
        }
    }
}

/// The outcomes of cases, of which `number` gives a number of each.
#[inline(always)]
fn outcomes<R: Real>(number: impl Fn(&dyn Fn(&Case) -> f64) -> R::Double) -> ([Points<R>; 3], Vector<R>) {
    let vector = |get: &dyn Fn(&Case) -> Double| Vector {
        x: number(&|case| get(case)[0]),
        y: number(&|case| get(case)[1]),
        z: number(&|case| get(case)[2]),
    };
    let single = |get: &dyn Fn(&Case) -> [f32; 3]| Vector::narrow(vector(&|case| get(case).map(f64::from)));
    let rows = |get: &dyn Fn(&Case) -> [Double; 3]| [0, 1, 2].map(|row| vector(&|case| get(case)[row]));

    let corners = [0, 1, 2].map(|corner| single(&|case| case.corners[corner]));
    let [u, v] = [0, 1].map(|k| R::narrow(number(&|case| f64::from(case.on[k]))));
    let (on_triangles, n) = Points::<R>::on_triangles(corners, u, v);
    let placement = Placement {
        matrix: rows(&|case| case.map[0]),
        translation: vector(&|case| case.translation),
        inverse: rows(&|case| case.map[1]),
        amplification: rows(&|case| amplification(&case.map[0], &case.map[1])),
    };
    let (center, radius) = (vector(&|case| case.sphere.0), number(&|case| case.sphere.1));
    let on_spheres = Points::on_spheres(center, radius, on_triangles.position);
    let origins = on_triangles.leave(n.normalize(), single(&|case| case.direction));
    ([on_triangles, on_spheres, on_triangles.placed(&placement)], origins)
}

struct Eight<'a>(&'a [Case; 8]);

impl Kernel for Eight<'_> {
    type Output = [Outcome; 8];
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> [Outcome; 8] {
        let number = |get: &dyn Fn(&Case) -> f64| f64x8::from_fn(simd, |lane| get(&self.0[lane]));
        let (points, origins) = outcomes::<f32x8<S>>(number);
        std::array::from_fn(|lane| {
            let row = |v: Vector<f64x8<S>>| [v.x[lane], v.y[lane], v.z[lane]];
            let [on_triangle, on_sphere, placed] =
                points.map(|points| Point { position: row(points.position), error: row(points.error) });
            let origin = [origins.x[lane], origins.y[lane], origins.z[lane]];
            Outcome { on_triangle, on_sphere, placed, origin }
        })
    }
}

fn one(case: &Case) -> Outcome {
    let (points, origin) = outcomes::<f32>(|get| get(case));
    let [on_triangle, on_sphere, placed] =
        points.map(|points| Point { position: points.position.into(), error: points.error.into() });
    Outcome { on_triangle, on_sphere, placed, origin: origin.into() }
}

/// Random numbers of many magnitudes.
struct Random(u64);

impl Random {
    fn double(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let exponent = (self.0 >> 33) % 41;
        ((self.0 >> 40) as f64 / 16_777_216.0 - 0.5) * (1_u64 << exponent) as f64 / 1_048_576.0
    }

    fn doubles(&mut self) -> Double {
        [self.double(), self.double(), self.double()]
    }

    fn case(&mut self, number: usize) -> Case {
        let mut corners =
            [self.doubles(), self.doubles(), self.doubles()].map(|corner| corner.map(|x| x as f32));
        // Some lie in an axis-aligned plane, as walls do.
        if number.is_multiple_of(3) {
            corners.iter_mut().for_each(|corner| corner[number % 8 % 3] = 1.5);
        }
        let map = [
            [self.doubles(), self.doubles(), self.doubles()],
            [self.doubles(), self.doubles(), self.doubles()],
        ];
        Case {
            corners,
            on: [self.double().fract().abs() as f32, self.double().fract().abs() as f32],
            sphere: (self.doubles(), self.double().abs()),
            map,
            translation: self.doubles(),
            direction: self.doubles().map(|x| x as f32),
        }
    }
}

#[test]
fn points_at_every_width_are_those_of_the_reference() {
    let mut levels = vec![Level::baseline(), Level::new()];
    #[cfg(target_arch = "x86_64")]
    levels.extend(Level::new().as_avx2().map(Level::Avx2));
    let mut random = Random(1);
    for round in 0..4000 {
        let cases: [Case; 8] = std::array::from_fn(|lane| random.case(round + lane));
        let expected = cases.map(|case| case.by_reference());
        assert_eq!(cases.map(|case| one(&case)), expected, "{cases:?}");
        for &level in &levels {
            assert_eq!(dispatch(level, Eight(&cases)), expected, "{cases:?}");
        }
    }
}
