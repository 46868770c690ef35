//! Tests of Perlin noise against its table.

use super::*;

/// The definition in f64, in pbrt's form: two of the coordinates, each with a sign, selected by four bits of the
/// hash.
fn slow([x, y, z]: [f64; 3]) -> f64 {
    let fade = |t: f64| 6.0 * t.powi(5) - 15.0 * t.powi(4) + 10.0 * t.powi(3);
    let at = |i: f64| usize::from(PERMUTATION[i.rem_euclid(256.0) as usize]) as f64;
    let mut sum = 0.0;
    for corner in 0..8 {
        let [i, j, k] = [corner & 1, corner >> 1 & 1, corner >> 2].map(f64::from);
        let [dx, dy, dz] = [x - (x.floor() + i), y - (y.floor() + j), z - (z.floor() + k)];
        let hash = at(at(at(x.floor() + i) + y.floor() + j) + z.floor() + k) as u32 & 15;
        let u = if hash < 8 || hash == 12 || hash == 13 { dx } else { dy };
        let v = if hash < 4 || hash == 12 || hash == 13 { dy } else { dz };
        let slope = if hash & 1 == 1 { -u } else { u } + if hash & 2 == 2 { -v } else { v };
        sum += fade(1.0 - dx.abs()) * fade(1.0 - dy.abs()) * fade(1.0 - dz.abs()) * slope;
    }
    sum
}

/// A coordinate of random size up to 2^`most`.
fn coordinate(trial: u64, most: i32) -> f32 {
    let bits = crate::core::hash::mix(trial + 1);
    2_f32.powi(most - (bits % 16) as i32) * ((bits >> 40) as f32 / 8_388_608.0 - 1.0)
}

#[test]
fn the_table_is_a_permutation() {
    let mut sorted = PERMUTATION;
    sorted.sort_unstable();
    assert!(sorted.iter().zip(0..=255).all(|(&a, b)| a == b));
}

#[test]
fn noise_agrees_with_its_definition() {
    for trial in 0..50_000 {
        let p = [0, 1, 2].map(|k| coordinate(trial * 3 + k, 10));
        let (fast, slow) = (noise(Vec3::from(p)), slow(p.map(f64::from)));
        assert!((f64::from(fast) - slow).abs() < 2e-6, "{p:?}: {fast}, not {slow}");
    }
}

#[test]
fn noise_side_by_side_is_noise() {
    for trial in 0..50_000 {
        let p = [0, 1, 2].map(|k| coordinate(trial * 3 + k, 40));
        assert_eq!(lanes::noises(p.into()), noise(Vec3::from(p)), "{p:?}");
    }
    for p in [[f32::NAN, 0.5, 0.5], [0.5, f32::INFINITY, 0.5], [0.5, 0.5, f32::MIN], [-0.25, 1e9, -1e18]] {
        assert_eq!(lanes::noises(p.into()), noise(Vec3::from(p)), "{p:?}");
    }
}

#[test]
fn known_values() {
    for trial in 0..1000 {
        let p = Vec3::from([0, 1, 2].map(|k| coordinate(trial * 3 + k, 9))).round();
        assert_eq!(noise(p), 0.0);
    }
    // Computed independently of this program, by the published table.
    for (p, expected) in KNOWN {
        let found = noise(Vec3::from(p));
        assert!((found - expected).abs() < 1e-6, "{p:?}: {found}, not {expected}");
    }
}

const KNOWN: [([f32; 3], f32); 4] = [
    ([0.5, 0.5, 0.5], -0.125),
    ([3.25, -7.5, 0.125], -0.20355396),
    ([-0.75, 255.5, 100.25], -0.15176344),
    ([1.5, 2.75, 0.5], 0.56677246),
];

#[test]
fn sums_are_of_octaves() {
    let p = Vec3::new(0.3, -4.7, 12.1);
    let octaves: Vec<f32> = [1.0, 1.99, 1.99 * 1.99].map(|frequency| noise(p * frequency)).into();
    let expected = octaves[0] + 0.6 * octaves[1] + 0.36 * octaves[2];
    assert!((fbm(p, 0.6, 3) - expected).abs() < 1e-6);
    let expected = octaves[0].abs() + 0.6 * octaves[1].abs() + 0.36 * octaves[2].abs() + 0.216 * 0.2;
    assert!((turbulence(p, 0.6, 3) - expected).abs() < 1e-6);
}

#[test]
fn noise_is_finite_everywhere() {
    for x in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, 1e18, -3e9, 1e-40] {
        for p in [Vec3::splat(x), Vec3::new(0.5, x, 0.5), Vec3::new(x, 0.25, -0.75)] {
            assert!(noise(p).is_finite(), "{p}");
        }
    }
}
