//! Tests of noise: smooth, bounded, of mean 0, reproducible.

use super::*;
use glam::DVec3;

/// A point of random exponent in each coordinate, up to 2^`most`.
fn point(trial: u64, most: i32) -> Vec3 {
    let coordinate = |k: u64| {
        let bits = mix(trial * 3 + k + 1);
        let size = 2_f32.powi(most - (bits % 12) as i32);
        size * ((bits >> 40) as f32 / 8_388_608.0 - 1.0)
    };
    Vec3::new(coordinate(0), coordinate(1), coordinate(2))
}

/// The gradient at a lattice point of the first octave.
fn gradient_at(lattice: impl Into<[f64; 3]>) -> Vec3 {
    let [x, y, z] = lattice.into().map(|x| x as i32);
    gradient(column(x, y), z, 0)
}

/// The definition in f64, as a weighted sum over the eight corners.
fn slow(p: DVec3) -> f64 {
    let fade = |t: f64| 6.0 * t.powi(5) - 15.0 * t.powi(4) + 10.0 * t.powi(3);
    let mut sum = 0.0;
    for corner in 0..8 {
        let lattice =
            p.floor() + DVec3::new(f64::from(corner & 1), f64::from(corner >> 1 & 1), f64::from(corner >> 2));
        let away = p - lattice;
        let weight: f64 = away.to_array().map(|t| fade(1.0 - t.abs())).iter().product();
        let gradient = gradient_at(lattice);
        sum += weight * gradient.as_dvec3().dot(away);
    }
    sum
}

#[test]
fn noise_agrees_with_its_definition() {
    for trial in 0..50_000 {
        let p = point(trial, 10);
        let (fast, slow) = (noise(p), slow(p.as_dvec3()));
        assert!((f64::from(fast) - slow).abs() < 2e-6, "{p}: {fast}, not {slow}");
    }
}

#[test]
fn noise_is_zero_at_lattice_points_and_slopes_along_an_edge() {
    for trial in 0..2000 {
        let p = point(trial, 8).round();
        assert_eq!(noise(p), 0.0);
        let h = 1.0 / 256.0;
        let slope =
            [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| (noise(p + h * axis) - noise(p - h * axis)) / (2.0 * h));
        let expected = gradient_at(p.as_dvec3()).to_array();
        for (slope, expected) in slope.iter().zip(expected) {
            assert!((slope - expected).abs() < 1e-3, "{p}: {slope}, not {expected}");
        }
        assert_eq!(expected.map(f32::abs).iter().sum::<f32>(), 2.0);
    }
}

#[test]
fn noise_has_no_seams() {
    // Steps across faces of the lattice, including negative coordinates and zero, are no larger than elsewhere.
    let step = 1.0 / 4096.0;
    for trial in 0..50_000 {
        let mut p = point(trial, 6).to_array();
        p[trial as usize % 3] = p[trial as usize % 3].round();
        let p = Vec3::from_array(p);
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            let change = (noise(p + step * axis) - noise(p - step * axis)).abs();
            assert!(change < 2.0 * step * 3.5, "{p} along {axis}: {change}");
        }
    }
}

#[test]
fn range_and_mean() {
    const N: u64 = 1_000_000;
    let (mut sum, mut squares, mut least, mut greatest) = (0.0, 0.0, 0.0_f32, 0.0_f32);
    for trial in 0..N {
        let n = noise(point(trial, 12));
        sum += f64::from(n);
        squares += f64::from(n * n);
        (least, greatest) = (least.min(n), greatest.max(n));
    }
    let (mean, deviation) = (sum / N as f64, (squares / N as f64).sqrt());
    assert!(mean.abs() < 2e-3, "mean {mean}");
    assert!((0.2..0.35).contains(&deviation), "standard deviation {deviation}");
    assert!((-1.04..-0.8).contains(&least) && (0.8..1.04).contains(&greatest), "{least} to {greatest}");
}

#[test]
fn no_choice_of_gradients_leaves_the_stated_range() {
    // All corners at their steepest toward a point, for points on a grid in an eighth of the cell.
    const N: u32 = 100;
    let mut most = 0.0_f32;
    for i in 0..(N + 1).pow(3) {
        let place =
            Vec3::new((i % (N + 1)) as f32, (i / (N + 1) % (N + 1)) as f32, (i / (N + 1) / (N + 1)) as f32)
                / (2 * N) as f32;
        let mut sum = 0.0;
        for corner in 0..8 {
            let away = (place
                - Vec3::new((corner & 1) as f32, (corner >> 1 & 1) as f32, (corner >> 2) as f32))
            .abs();
            let weight: f32 = away.to_array().map(|t| fade(1.0 - t)).iter().product();
            // The steepest edge gradient adds the two largest coordinates.
            sum += weight * (away.element_sum() - away.min_element());
        }
        most = most.max(sum);
    }
    assert!((1.0..1.04).contains(&most), "{most}");
}

#[test]
fn the_pattern_does_not_repeat_after_256() {
    let same = (0..1000).filter(|&trial| {
        let p = point(trial, 4);
        (noise(p) - noise(p + 256.0)).abs() < 1e-3
    });
    assert!(same.count() < 20);
}

#[test]
fn octaves_add_detail_half_as_strong() {
    for trial in 0..10_000 {
        let p = point(trial, 8);
        assert_eq!(fbm(p, 0), 0.0);
        assert_eq!(fbm(p, 1), noise(p));
        assert_eq!(turbulence(p, 1), noise(p).abs());
        for octaves in 1..8 {
            let detail = (fbm(p, octaves + 1) - fbm(p, octaves)).abs();
            assert!(detail <= 1.04 * 0.5_f32.powi(octaves as i32) + 1e-6);
            assert!(turbulence(p, octaves + 1) >= turbulence(p, octaves));
            assert!(turbulence(p, octaves) >= fbm(p, octaves).abs() - 1e-6);
        }
        assert_eq!(fbm(p, u32::MAX), fbm(p, MOST_OCTAVES));
    }
}

#[test]
fn huge_and_meaningless_points_are_finite() {
    let wild =
        [0.0, -0.0, 1e-45, -1e-30, 8_388_607.5, -2_147_483_648.0, 2_147_483_648.0, 1e10, f32::MAX, f32::MIN];
    let wild = wild.into_iter().chain([f32::INFINITY, f32::NEG_INFINITY, f32::NAN]);
    for x in wild.clone() {
        for y in wild.clone() {
            for p in [Vec3::new(x, y, 0.3), Vec3::new(0.7, x, y), Vec3::new(y, 0.1, x)] {
                for value in [noise(p), fbm(p, 16), turbulence(p, u32::MAX)] {
                    assert!(value.abs() < 2.1, "{p}: {value}");
                }
            }
        }
    }
    assert_eq!(noise(Vec3::splat(1e30)), 0.0);
}

#[test]
fn bits_are_pinned() {
    let p = Vec3::new(0.3, -7.6, 1234.56);
    assert_eq!(
        [noise(p), fbm(p, 8), turbulence(p, 8)].map(f32::to_bits),
        [0xbe81_cc00, 0xbe5c_042f, 0x3eac_2452]
    );
}
