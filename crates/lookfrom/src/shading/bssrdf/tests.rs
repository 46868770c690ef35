//! Tests of BSSRDFs: profiles against their integrals, samples against densities, probing against integration.

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};

use super::probe::Prober;
use super::table::ProfileTable;
use super::{MediumBelow, fresnel_moment};
use crate::core::hash;
use crate::core::spectrum::Spectrum;
use crate::core::statistics::chi_square_deviate;

const SAMPLES: u64 = 100_000;

fn number(index: u64, k: u64) -> f32 {
    (hash::pair(k, index) >> 40) as f32 / 16_777_216.0
}

fn grey(value: f32) -> Spectrum {
    Spectrum([value; 4])
}

/// The integral of a function from 0 to `end`, with steps that grow from there.
fn integral(end: f64, f: impl Fn(f64) -> f64) -> f64 {
    const STEPS: u32 = 20_000;
    let r = |t: f64| end * t * t * t;
    let step = |i: u32| {
        let [a, b] = [i, i + 1].map(|i| r(f64::from(i) / f64::from(STEPS)));
        (b - a) * f(0.5 * (a + b))
    };
    (0..STEPS).map(step).sum()
}

#[test]
fn a_profile_has_the_light_of_its_effective_albedo() {
    for (g, eta) in [(0.0, 1.33), (0.6, 1.5), (-0.4, 1.1)] {
        let table = ProfileTable::new(g, eta);
        for (extinction, albedo) in [(1.0, 0.3), (20.0, 0.8), (0.05, 0.99), (3.0, 0.9995), (7.0, 1.0)] {
            let profile = table.profile(extinction, albedo);
            let light =
                integral(202.0 / f64::from(extinction), |r| TAU * r * f64::from(profile.value(r as f32)));
            let expected = f64::from(table.effective_albedo(albedo));
            assert!(
                (light / expected - 1.0).abs() < 2e-3,
                "g {g}, η {eta}, albedo {albedo}: {light}, not {expected}"
            );
        }
    }
}

#[test]
fn albedos_are_found_by_their_effect() {
    let table = ProfileTable::new(0.2, 1.4);
    for albedo in [0.0, 0.01, 0.3, 0.77, 0.96, 0.999, 1.0] {
        let found = table.albedo_of(table.effective_albedo(albedo));
        assert!((found - albedo).abs() < 1e-4, "{found}, not {albedo}");
    }
    // More than any medium has, and less.
    assert_eq!([table.albedo_of(2.0), table.albedo_of(-1.0)], [1.0, 0.0]);
    let medium = MediumBelow::of_reflectance(&table, grey(0.6), grey(0.25));
    assert!((medium.effective_albedo(&table).0[1] - 0.6).abs() < 1e-4);
    assert_eq!(medium.extinction, grey(4.0));
}

#[test]
fn media_without_extinction_let_nothing_leave() {
    let table = ProfileTable::new(0.0, 1.33);
    let none = MediumBelow::of_coefficients(Spectrum::BLACK, Spectrum::BLACK);
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    assert!(Prober::new(&table, &none, (DVec3::ZERO, axes), grey(1.0)).is_none());
}

#[test]
fn distances_have_their_density() {
    const CELLS: usize = 40;
    let table = ProfileTable::new(0.0, 1.33);
    for (extinction, albedo) in [(1.0, 0.5), (8.0, 0.9), (0.1, 0.999)] {
        let profile = table.profile(extinction, albedo);
        // Cells of optical radii that grow by a factor.
        let edge = |cell: usize| 1e-3 * 1.36_f64.powi(cell as i32) / f64::from(extinction);
        let mut observed = vec![0; CELLS + 2];
        for index in 0..SAMPLES {
            let r = f64::from(profile.sample(number(index, 1)));
            observed[(0..=CELLS).take_while(|cell| r >= edge(*cell)).count()] += 1;
        }
        let within = |end: f64| integral(end, |r| TAU * r * f64::from(profile.pdf(r as f32)));
        let up_to: Vec<f64> = (0..=CELLS).map(|cell| within(edge(cell))).collect();
        assert!((within(202.0 / f64::from(extinction)) - 1.0).abs() < 2e-3);
        let mut expected = vec![up_to[0]];
        expected.extend(up_to.windows(2).map(|pair| pair[1] - pair[0]));
        expected.push((1.0 - up_to[CELLS]).max(0.0));
        let expected: Vec<f64> = expected.iter().map(|part| part * SAMPLES as f64).collect();
        let deviate = chi_square_deviate(&observed, &expected);
        assert!(deviate < 4.5, "albedo {albedo}: {deviate}");
    }
}

/// Lines through a ball, from its pole, find the light that leaves all over it.
#[test]
fn probing_integrates_over_a_surface() {
    let table = ProfileTable::new(0.0, 1.4);
    let medium =
        MediumBelow { extinction: Spectrum([2.0, 1.0, 8.0, 1.0]), albedo: Spectrum([0.9, 0.95, 0.7, 0.0]) };
    let axes = [Vec3::new(0.6, 0.8, 0.0), Vec3::new(-0.8, 0.6, 0.0), Vec3::Z];
    let beta = Spectrum([1.0, 0.5, 2.0, 0.0]);
    let prober = Prober::new(&table, &medium, (DVec3::Z, axes), beta).expect("light leaves");
    let mut sums = [0.0_f64; 3];
    for index in 0..SAMPLES {
        let u = [0, 1, 2, 3].map(|k| number(index, k));
        let Some(segment) = prober.segment([u[0], u[1]], [u[2], u[3]]) else { continue };
        let (o, d) = (segment.start.as_dvec3(), segment.direction.as_dvec3());
        let (middle, rest) = (-o.dot(d), o.dot(d).powi(2) - o.length_squared() + 1.0);
        if rest < 0.0 {
            continue;
        }
        for t in [middle - rest.sqrt(), middle + rest.sqrt()] {
            if (0.0..f64::from(segment.length)).contains(&t) {
                let p = (o + t * d).normalize();
                let (sp, pdf) = (prober.sp(p), prober.pdf(p, p.as_vec3()));
                sums = [0, 1, 2].map(|lane| sums[lane] + f64::from(sp.0[lane] / pdf));
            }
        }
    }
    for (lane, sum) in sums.iter().enumerate() {
        let profile = table.profile(medium.extinction.0[lane], medium.albedo.0[lane]);
        // By the distance from the pole: the area within is π d².
        let expected = integral(2.0, |d| TAU * d * f64::from(profile.value(d as f32)));
        let found = sum / SAMPLES as f64;
        assert!((found / expected - 1.0).abs() < 0.02, "lane {lane}: {found}, not {expected}");
    }
}

#[test]
fn moments_of_the_fresnel_reflectance_are_those_of_the_literature() {
    // Polynomials of d'Eon & Irving 2011, at the index 1.33: from outside and from inside.
    assert!((fresnel_moment(1.33, 1) - 0.032_96).abs() < 1e-4);
    assert!((fresnel_moment(1.0 / 1.33, 1) - 0.236_5).abs() < 1e-3);
    assert!((fresnel_moment(1.0 / 1.33, 2) - 0.108_6).abs() < 1e-3);
    assert_eq!(fresnel_moment(1.0, 1), 0.0);
}
