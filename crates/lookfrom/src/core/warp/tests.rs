//! Tests of warps: densities and unit length.

use super::*;
use crate::core::hash::mix;
use crate::core::lanes::{LANES, by_lane, gather, scatter};
use crate::core::sampler::{ONE_MINUS_EPSILON, Sampler};
use crate::core::statistics::chi_square_deviate;
use glam::{DVec3, Vec2};
use lookfrom_simd::{Kernel, Level, Simd, dispatch, f32x8, prelude::*};

const N: u32 = 200_000;

fn numbers() -> impl Iterator<Item = [f32; 2]> {
    let sampler = Sampler::new(lookfrom_scene::settings::Sampler::Independent, 5);
    (0..N).map(move |i| sampler.two([0, 0], i, 0))
}

/// A point in the disk.
fn disk(u: [f32; 2]) -> Vec2 {
    concentric_disk(u).into()
}

/// Numbers at the edges and the middle of the square.
fn corners() -> impl Iterator<Item = [f32; 2]> {
    let ends = [0.0, f32::EPSILON, 0.25, 0.5, 0.75, ONE_MINUS_EPSILON];
    ends.into_iter().flat_map(move |a| ends.into_iter().map(move |b| [a, b]))
}

/// Unit vectors in all directions, near the axes too: components of random exponents.
fn normals() -> impl Iterator<Item = Vec3> {
    let axes = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|n| [n, -n]);
    let random = (0..2000_u64).map(|trial| {
        let component = |k: u64| {
            let bits = mix(trial * 3 + k);
            let size = 2_f64.powi(-((bits % 30) as i32));
            size * (0.5 + (bits >> 40) as f64 / 2_f64.powi(25)) * if bits >> 8 & 1 == 1 { 1.0 } else { -1.0 }
        };
        DVec3::new(component(0), component(1), component(2)).normalize().as_vec3()
    });
    axes.chain(random)
}

/// Chi-square of numbers that should be uniform in [0, 1)², over 16 × 16 cells.
fn look_uniform(what: &str, pairs: impl Iterator<Item = [f64; 2]>) {
    let mut counts = vec![0; 256];
    let mut total = 0.0;
    for pair in pairs {
        let [i, j] = pair.map(|x| {
            assert!((-1e-6..=1.0 + 1e-6).contains(&x), "{what}: {x}");
            ((x * 16.0).max(0.0) as usize).min(15)
        });
        counts[i * 16 + j] += 1;
        total += 1.0;
    }
    let deviate = chi_square_deviate(&counts, &vec![total / 256.0; 256]);
    assert!(deviate < 4.5, "{what}: {deviate} standard deviations");
}

fn turn(x: f32, y: f32) -> f64 {
    f64::from(y).atan2(f64::from(x)) / std::f64::consts::TAU + 0.5
}

#[test]
fn the_disk_is_uniform() {
    // Radius² and angle are uniform and independent.
    look_uniform("disk", numbers().map(disk).map(|p| [f64::from(p.length_squared()), turn(p.x, p.y)]));
    for u in corners() {
        assert!(disk(u).length() <= 1.0 + f32::EPSILON, "{u:?}");
    }
    assert_eq!(disk([0.5, 0.5]), Vec2::ZERO);
}

#[test]
fn the_disk_agrees_with_the_square_ring_by_ring() {
    for u in numbers().take(10_000) {
        let [a, b] = u.map(|u| 2.0 * u - 1.0);
        let p = disk(u);
        assert!((p.length() - a.abs().max(b.abs())).abs() < 2e-7, "{u:?}");
        // Corners of the square stay on the diagonals, sides stay in their quadrant.
        assert!((p.x.abs() >= p.y.abs() - 1e-6) == (a.abs() >= b.abs()) || (a.abs() - b.abs()).abs() < 1e-5);
        assert!(p.x * a >= 0.0 && p.y * b >= 0.0);
    }
}

#[test]
fn the_sphere_is_uniform() {
    look_uniform(
        "sphere",
        numbers().map(uniform_sphere).map(|d| [0.5 + 0.5 * f64::from(d.z), turn(d.x, d.y)]),
    );
    let sum = numbers().map(|u| uniform_sphere(u).as_dvec3()).sum::<DVec3>() / f64::from(N);
    assert!(sum.length() < 0.01, "{sum}");
    assert!((UNIFORM_SPHERE_PDF * 4.0 * PI - 1.0).abs() < 1e-6);
}

#[test]
fn the_hemisphere_is_as_dense_as_the_cosine() {
    for n in normals().take(9) {
        let (s, t) = orthonormal_basis(n);
        // cos² and the angle about n are uniform.
        let directions = numbers().map(|u| cosine_hemisphere(u, n));
        look_uniform(
            "hemisphere",
            directions.map(|d| [f64::from(d.dot(n)).powi(2), turn(d.dot(s), d.dot(t))]),
        );
    }
    // The density integrates to 1: the mean of 1/pdf is the solid angle of the covered domain.
    let mean: f64 = numbers()
        .map(|u| cosine_hemisphere(u, Vec3::Z).z)
        .filter(|&z| z > 0.1)
        .map(|z| 1.0 / f64::from(cosine_hemisphere_pdf(z)))
        .sum::<f64>()
        / f64::from(N);
    assert!((mean / (0.9 * std::f64::consts::TAU) - 1.0).abs() < 0.01, "{mean}");
    assert_eq!(cosine_hemisphere_pdf(-0.5), 0.0);
}

#[test]
fn cones_are_uniform_however_thin() {
    for exponent in [0, 1, 5, 13, 24, 40, 80, 120] {
        let width = 2.0_f32 / 2_f32.powi(exponent);
        let in_cone = |u: [f32; 2]| {
            let d = Vec3::from(uniform_cone(u, width)).as_dvec3();
            // For thin cones, 1 − cos from the sine, without cancellation.
            let sin2 = d.x * d.x + d.y * d.y;
            let depth = if exponent < 2 { 1.0 - d.z } else { sin2 / (1.0 + (1.0 - sin2).sqrt()) };
            [depth / f64::from(width), d.y.atan2(d.x) / std::f64::consts::TAU + 0.5]
        };
        look_uniform("cone", numbers().map(in_cone));
        let area = std::f64::consts::TAU * f64::from(width);
        assert!((f64::from(uniform_cone_pdf(width)) * area - 1.0).abs() < 1e-6);
    }
}

#[test]
fn directions_are_of_unit_length() {
    let unit = |d: Vec3| assert!((d.as_dvec3().length() - 1.0).abs() < 5e-7, "{d} {}", d.as_dvec3().length());
    for u in corners().chain(numbers().take(2000)) {
        unit(uniform_sphere(u));
        for width in [1.0, 0.3, 1e-5, 1e-30, 0.0] {
            unit(uniform_cone(u, width).into());
        }
        for n in normals().step_by(97) {
            let d = cosine_hemisphere(u, n);
            unit(d);
            assert!(d.dot(n) > 0.0 && cosine_hemisphere_pdf(d.dot(n)) > 0.0, "{d} about {n} for {u:?}");
        }
    }
}

#[test]
fn the_triangle_is_uniform() {
    // Where points are uniform, (1 − α)² and β / (1 − α) are uniform and independent.
    look_uniform(
        "triangle",
        numbers().map(uniform_triangle).map(|[alpha, beta, _]| {
            let rest = 1.0 - f64::from(alpha);
            [rest * rest, f64::from(beta) / rest]
        }),
    );
    for u in corners().chain(numbers()) {
        let [alpha, beta, gamma] = uniform_triangle(u);
        assert!(alpha >= 0.0 && beta >= 0.0 && gamma >= 0.0, "{u:?}");
        assert!((alpha + beta + gamma - 1.0).abs() < 2e-7, "{u:?}");
    }
    assert_eq!(uniform_triangle_pdf(0.5), 2.0);
}

#[test]
fn bases_are_orthonormal_and_right_handed() {
    for n in normals() {
        let (s, t) = orthonormal_basis(n);
        let [s, t, n] = [s, t, n].map(Vec3::as_dvec3);
        for (what, value) in [
            ("|s|", s.length() - 1.0),
            ("|t|", t.length() - 1.0),
            ("s·t", s.dot(t)),
            ("s·n", s.dot(n)),
            ("t·n", t.dot(n)),
            ("s×t·n", s.cross(t).dot(n) - 1.0),
        ] {
            assert!(value.abs() < 5e-7, "{what} is {value:e} off for {n}");
        }
    }
}

#[test]
fn octahedral_squares_have_equal_areas_and_an_inverse() {
    look_uniform(
        "octahedron",
        numbers().map(octahedral_direction).map(|d| [0.5 + 0.5 * f64::from(d.z), turn(d.x, d.y)]),
    );
    for u in corners().chain(numbers().take(20_000)) {
        let direction = octahedral_direction(u);
        assert!((direction.as_dvec3().length() - 1.0).abs() < 5e-7, "{u:?}");
        // Edges of the square are folded: opposite points of an edge are one direction.
        let again = octahedral_direction(octahedral_square(direction.into()));
        assert!((again - direction).length() < 2e-6, "{u:?} {direction} {again}");
    }
    for (direction, square) in [
        (Vec3::Z, [0.5, 0.5]),
        (Vec3::X, [1.0, 0.5]),
        (-Vec3::X, [0.0, 0.5]),
        (Vec3::Y, [0.5, 1.0]),
        (Vec3::new(0.0, 0.0, -1.0), [1.0, 1.0]),
    ] {
        assert_eq!(octahedral_square(direction.into()), square);
        assert!((octahedral_direction(square) - direction).length() < 1e-6, "{direction}");
    }
}

#[test]
fn bits_are_pinned() {
    let n = Vec3::new(0.6, 0.0, -0.8);
    let bits = |d: Vec3| d.to_array().map(f32::to_bits);
    assert_eq!(bits(cosine_hemisphere([0.2, 0.9], n)), [0x3b91_5480, 0xbf2a_48f3, 0xbf3f_2604]);
    assert_eq!(bits(uniform_sphere([0.2, 0.9])), [0xbf08_8977, 0x3f4c_578c, 0xbe8f_5c24]);
    assert_eq!(bits(uniform_cone([0.7, 0.4], 1e-6).into()), [0x3a09_00c7, 0xb962_fe7c, 0x3f7f_fffd]);
}

/// Bases about eight normals, and places in the disk and on the octahedron.
struct Eight<'a>(&'a [Vec3; LANES], &'a [[f32; 2]; LANES]);

impl Kernel for Eight<'_> {
    type Output = [([f32; 3], [f32; 3], [f32; 2], [f32; 3], [f32; 2]); LANES];
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let normals = gather(simd, &by_lane!(lane => self.0[lane].to_array()));
        let (s, t) = basis_about(normals);
        let (s, t) = (scatter(s), scatter(t));
        let u = [0, 1].map(|k| f32x8::load_array(simd, by_lane!(lane => self.1[lane][k])));
        let [x, y]: [[f32; LANES]; 2] = concentric_disk(u).map(Into::into);
        let directions = scatter(octahedral_direction_within(u));
        let [column, row]: [[f32; LANES]; 2] = octahedral_square(normals).map(Into::into);
        by_lane!(lane => (s[lane], t[lane], [x[lane], y[lane]], directions[lane], [column[lane], row[lane]]))
    }
}

#[test]
fn eight_at_once_are_eight_one_by_one() {
    let mut levels = vec![Level::baseline(), Level::new()];
    #[cfg(target_arch = "x86_64")]
    levels.extend(Level::new().as_avx2().map(Level::Avx2));
    let (normals, numbers): (Vec<Vec3>, Vec<[f32; 2]>) = normals().zip(corners().chain(numbers())).unzip();
    for (normals, numbers) in normals.as_chunks::<LANES>().0.iter().zip(numbers.as_chunks::<LANES>().0) {
        let expected: [_; LANES] = std::array::from_fn(|lane| {
            let (s, t) = orthonormal_basis(normals[lane]);
            let (disk, direction) = (concentric_disk(numbers[lane]), octahedral_direction(numbers[lane]));
            let square = octahedral_square(normals[lane].into());
            (s.to_array(), t.to_array(), disk, direction.to_array(), square)
        });
        for &level in &levels {
            assert_eq!(dispatch(level, Eight(normals, numbers)), expected, "{normals:?} {numbers:?}");
        }
    }
}
