//! Do free flights have the density that is told, and do they keep the light?

use lookfrom_scene::settings::Sampler as Kind;

use super::*;
use crate::core::sampler::Sampler;

/// A medium whose lanes differ widely, the last without extinction.
fn medium() -> Coefficients {
    Coefficients {
        absorption: Spectrum([0.5, 0.0, 1.0, 0.0]),
        scattering: Spectrum([0.5, 4.0, 0.2, 0.0]),
        emission: Spectrum::BLACK,
    }
}

const BETA: Spectrum = Spectrum([0.2, 0.9, 0.4, 0.5]);

/// Flights by points of a grid.
fn flights(limit: f32) -> impl Iterator<Item = Flight> {
    const SIDE: u32 = 1024;
    let place = |k: u32| (k as f32 + 0.5) / SIDE as f32;
    (0..SIDE * SIDE).map(move |k| Flight::sample(&medium(), BETA, limit, [place(k % SIDE), place(k / SIDE)]))
}

#[test]
fn distances_have_their_density() {
    let limit = 2.5;
    let sum: f32 = BETA.0.iter().sum();
    // The distribution function by the sum over lanes, against the part of the flights (Kolmogorov's distance).
    let distribution = |t: f32| -> f64 {
        let ends = |lane: usize| BETA.0[lane] / sum * (1.0 - (-medium().extinction().0[lane] * t).exp());
        (0..4).map(|lane| f64::from(ends(lane))).sum()
    };
    let mut distances: Vec<f32> = flights(limit).map(|flight| flight.distance).collect();
    distances.sort_by(f32::total_cmp);
    let count = distances.len() as f64;
    let ends = distances.iter().enumerate().filter(|(_, distance)| **distance < limit);
    let farthest =
        ends.map(|(rank, &t)| (distribution(t) - (rank as f64 + 0.5) / count).abs()).fold(0.0, f64::max);
    assert!(farthest < 2e-3, "{farthest}");
    // And the densities are its derivative.
    for flight in flights(limit).filter(Flight::is_scattered).step_by(10_007) {
        let (t, step) = (flight.distance, 1e-3);
        let slope = (distribution(t + step) - distribution(t - step)) / f64::from(2.0 * step);
        assert!((f64::from(flight.density) / slope - 1.0).abs() < 5e-3, "{flight:?}: {slope}");
    }
}

#[test]
fn light_is_kept_in_the_mean() {
    for limit in [0.3_f32, 2.5] {
        let (mut passed, mut scattered, mut count) = ([0.0; 4], [0.0; 4], 0.0);
        for flight in flights(limit) {
            let sum = if flight.is_scattered() { &mut scattered } else { &mut passed };
            *sum = std::array::from_fn(|lane| sum[lane] + f64::from(flight.after.0[lane]));
            count += 1.0;
        }
        for lane in 0..4 {
            let [sigma, scattering, beta] =
                [medium().extinction(), medium().scattering, BETA].map(|of| f64::from(of.0[lane]));
            let through = (-sigma * f64::from(limit)).exp();
            let albedo = if sigma == 0.0 { 0.0 } else { scattering / sigma };
            let expected = [beta * through, beta * albedo * (1.0 - through)];
            for (sum, expected) in [passed[lane], scattered[lane]].into_iter().zip(expected) {
                assert!((sum / count - expected).abs() < 2e-3, "{limit}, {lane}: {sum} {expected}");
            }
        }
    }
}

#[test]
fn a_medium_that_absorbs_nothing_keeps_the_sum_of_lanes() {
    let medium = Coefficients { absorption: Spectrum::BLACK, ..medium() };
    for u in [[0.0, 0.0], [0.1, 0.3], [0.4, 0.999], [0.9, 0.5], [0.99, 0.2]] {
        let flight = Flight::sample(&medium, BETA, 0.7, u);
        let [before, after] = [flight.before, flight.after].map(|beta| beta.0.iter().sum::<f32>());
        assert!((after / before - 1.0).abs() < 1e-5, "{flight:?}");
    }
}

#[test]
fn extremes_stay_finite() {
    for sigma in [0.0, 1e-30, 1e18] {
        let even = Spectrum([sigma; 4]);
        let medium = Coefficients { absorption: Spectrum::BLACK, scattering: even, ..medium() };
        for limit in [1e-30, 1.0, f32::INFINITY] {
            for u in [0.0, 0.5, 1.0 - f32::EPSILON / 2.0] {
                let flight = Flight::sample(&medium, BETA, limit, [u, u]);
                assert!(flight.after.is_finite(), "{sigma} {limit} {u}: {flight:?}");
            }
        }
    }
}

#[test]
fn flights_side_by_side_are_those_of_one() {
    let sampler = Sampler::new(Kind::Sobol, 1);
    let flying = |k: u32| Flying {
        stream: SampleStream { sampler: sampler.of_pixel([k, 3]), sample: k % 5, address: u64::from(k) },
        coefficients: medium(),
        throughput: if k.is_multiple_of(7) { Spectrum([0.0, 0.0, 0.3, 0.0]) } else { BETA },
        limit: if k.is_multiple_of(3) { f32::INFINITY } else { 0.1 * k as f32 },
    };
    let flying: Vec<Flying> = (1..100).map(flying).collect();
    let alone: Vec<Flight> = flying.iter().map(Flying::fly).collect();
    assert_eq!(format!("{:?}", Flying::fly_all(&flying)), format!("{alone:?}"));
}
