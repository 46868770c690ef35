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

#[test]
fn octaves_are_left_out_by_their_detail() {
    let p = Vec3::new(0.3, 5.7, -1.1);
    assert_eq!(fbm(p, 0.5, Octaves::new(6, 0.0)), fbm(p, 0.5, 6));
    assert_eq!(turbulence(p, 0.5, Octaves::new(6, 1e-9)), turbulence(p, 0.5, 6));
    assert_eq!(fbm(p, 0.5, Octaves::new(6, 4.0)), 0.0);
    // The first three are whole from a width of 2⁻⁴ on; a fourth comes smoothly.
    assert_eq!(fbm(p, 0.5, Octaves::new(6, 0.0624)), fbm(p, 0.5, 3));
    assert_eq!(fbm(p, 0.5, Octaves::new(6, libm::exp2f(-4.75))), fbm(p, 0.5, 4));
    let mut before = fbm(p, 0.5, Octaves::new(8, 2.0));
    for k in 0..1000 {
        let next = fbm(p, 0.5, Octaves::new(8, libm::exp2f(1.0 - 0.01 * k as f32)));
        assert!((next - before).abs() < 0.03, "{next} after {before} at {k}");
        before = next;
    }
    assert_eq!(before, fbm(p, 0.5, 8));
}

/// pbrt-v4's `Turbulence` as it is written: the octave that is faded counts once more among those that are left out.
fn slow_turbulence(p: Vec3, roughness: f64, octaves: u32, detail: f64) -> f64 {
    let count = (-1.0 - 0.5 * libm::log2(detail * detail)).clamp(0.0, f64::from(octaves));
    let (mut sum, mut frequency, mut strength) = (0.0, 1.0_f32, 1.0);
    for _ in 0..count as u32 {
        sum += strength * f64::from(noise(frequency * p).abs());
        (frequency, strength) = (1.99 * frequency, roughness * strength);
    }
    let t = ((count.fract() - 0.3) / 0.4).clamp(0.0, 1.0);
    let smooth = t * t * (3.0 - 2.0 * t);
    sum += strength * (0.2 * (1.0 - smooth) + smooth * f64::from(noise(frequency * p).abs()));
    for _ in count as u32..octaves {
        sum += 0.2 * strength;
        strength *= roughness;
    }
    sum
}

#[test]
fn turbulence_has_the_mean_of_octaves_that_are_left_out() {
    for k in 0..5000 {
        let p = Vec3::new(0.37, 0.73, 0.19) * k as f32;
        let detail = libm::exp2f((k % 200) as f32 / 16.0 - 10.0);
        let found = f64::from(turbulence(p, 0.6, Octaves::new(7, detail)));
        let expected = slow_turbulence(p, 0.6, 7, detail.into());
        assert!((found - expected).abs() < 1e-4, "{found} {expected} at {detail}");
    }
}
