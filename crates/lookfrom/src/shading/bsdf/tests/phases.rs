//! Phase functions.

use std::f32::consts::PI;

use super::{COLUMNS, ROWS, cell, direction, number, numbers, over_cells};
use crate::core::statistics::{chi_square_deviate, corrected_bound};
use crate::shading::bsdf::*;

#[test]
fn phases_are_normal_and_of_mean_cosine_g() {
    use henyey_greenstein::HenyeyGreenstein;
    for g in [-0.7, 0.0, 0.0005, 0.4, 0.9] {
        let phase = HenyeyGreenstein::new(g);
        let wo = direction(40.0, 70.0);
        let sum: f64 = over_cells(&|wi| f64::from(phase.p(wo.into(), wi.into())), 1e-6).iter().sum();
        assert!((sum - 1.0).abs() < 1e-4, "{g}: {sum}");
        let n = 100_000;
        let mean =
            (0..n).map(|i| f64::from(-phase.sample(wo.into(), numbers(17, i).1).dot(wo.into()))).sum::<f64>()
                / n as f64;
        assert!((mean - f64::from(g)).abs() < 0.01, "{g}: {mean}");
        let mut counts = vec![0; ROWS * COLUMNS];
        (0..n).for_each(|i| counts[cell(phase.sample(wo.into(), numbers(19, i).1).into())] += 1);
        let expected = over_cells(&|wi| f64::from(phase.p(wo.into(), wi.into())) * n as f64, 1e-2);
        assert!(chi_square_deviate(&counts, &expected) < corrected_bound(5), "{g}");
    }
}

#[test]
fn phases_of_two_lobes_are_normal_and_sampled_as_they_are() {
    use lookfrom_scene::medium::DraineLobe;
    use two_lobes::TwoLobes;
    let of_droplets = [0.1, 0.2, 0.7, 1.49, 1.5, 3.0, 5.0, 12.0, 50.0].map(TwoLobes::of_droplets);
    let rayleigh = TwoLobes::new(0.0, DraineLobe { g: 0.0, alpha: 1.0, share: 1.0 });
    let backward = TwoLobes::new(-0.6, DraineLobe { g: 0.5, alpha: 0.0, share: 0.25 });
    let forward = TwoLobes::new(0.3, DraineLobe { g: -0.75, alpha: 2.0, share: 0.5 });
    // Rayleigh's is 3 (1 + μ²) / 16 π.
    for mu in [-1.0, -0.3, 0.0, 0.8] {
        let wi = Vec3::new((1.0_f32 - mu * mu).sqrt(), 0.0, mu);
        let expected = 3.0 * (1.0 + mu * mu) / (16.0 * PI);
        assert!((rayleigh.p(Vec3::NEG_Z.into(), wi.into()) / expected - 1.0).abs() < 3e-3);
    }
    for phase in of_droplets.into_iter().chain([rayleigh, backward, forward]) {
        let diameter = format!("{phase:?}");
        // The integral and the mean cosine over 1 − μ = e^x, with peaks of any width.
        let steps = 40_000;
        let (mut sum, mut mean) = (0.0, 0.0);
        for step in 0..steps {
            let width = (2.0_f64.ln() + 30.0) / f64::from(steps);
            let apart = (-30.0 + (f64::from(step) + 0.5) * width).exp();
            let (mu, sin) = (1.0 - apart, (apart * (2.0 - apart)).sqrt());
            let wi = Vec3::new(sin as f32, 0.0, mu as f32);
            // As far apart as the sine says, which 1 − μ in single precision is not.
            let p = f64::from(phase.p(Vec3::NEG_Z.into(), wi.into()));
            let part = 2.0 * std::f64::consts::PI * p * apart * width;
            (sum, mean) = (sum + part, mean + part * mu);
        }
        assert!((sum - 1.0).abs() < 2e-4, "{diameter}: {sum}");
        let [ahead, g, alpha, weight] = [phase.ahead, phase.g, phase.alpha, phase.weight].map(f64::from);
        let draine =
            g * (1.0 + alpha * (3.0 + 2.0 * g * g) / 5.0) / (1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0);
        let expected = (1.0 - weight) * ahead + weight * draine;
        assert!((mean - expected).abs() < 2e-4, "{diameter}: {mean}, expected {expected}");

        // Samples: their mean, and their numbers between directions of equal probability of each lobe.
        let wo = direction(40.0, 70.0);
        let n = 100_000;
        let cosines = |seed| (0..n).map(move |i| -phase.sample(wo.into(), numbers(seed, i).1).dot(wo.into()));
        let sampled = cosines(17).map(f64::from).sum::<f64>() / n as f64;
        assert!((sampled - expected).abs() < 0.005, "{diameter}: {sampled}, expected {expected}");
        let mut counts = vec![0; ROWS * COLUMNS];
        (0..n).for_each(|i| counts[cell(phase.sample(wo.into(), numbers(19, i).1).into())] += 1);
        let expected = over_cells(&|wi| f64::from(phase.p(wo.into(), wi.into())) * n as f64, 1e-2);
        assert!(chi_square_deviate(&counts, &expected) < corrected_bound(12), "{diameter}");
    }
}

#[test]
fn peaks_of_droplets_are_sampled_by_their_angle() {
    use two_lobes::TwoLobes;
    // Of the lobe ahead, the part F of the samples is within 1 − μ = (1 − g) F (s + 1 − g) / (1 + g − 2 g F).
    let phase = TwoLobes { weight: 1e-6, ..TwoLobes::of_droplets(50.0) };
    let g = f64::from(phase.ahead);
    let n = 50_000;
    let wo = direction(40.0, 70.0);
    let apart: Vec<f64> = (0..n)
        .map(|i| {
            let wi: Vec3 = phase.sample(wo.into(), numbers(23, i).1).into();
            f64::from((wi + wo).length_squared()) / 2.0
        })
        .collect();
    for part in [0.05, 0.3, 0.5, 0.8, 0.99] {
        let below = 1.0 + g - 2.0 * g * part;
        let bound = (1.0 - g) * part * ((1.0 - g * g) / below + 1.0 - g) / below;
        let found = apart.iter().filter(|apart| **apart <= bound).count() as f64 / n as f64;
        // Four standard errors of a share.
        let error = (part * (1.0 - part) / n as f64).sqrt();
        assert!((found - part).abs() < 4.0 * error, "{found}, expected {part}");
    }
}

#[test]
fn phases_of_eight_lanes_are_those_of_each() {
    use crate::core::lanes::width::{Lanes, One};
    use crate::core::lanes::{LANES, load, shade_together, store};
    use henyey_greenstein::HenyeyGreenstein;
    use lookfrom_simd::{Kernel, Simd, f32x8, prelude::*};
    use phase::{Phase, Phases};
    use two_lobes::TwoLobes;

    struct Eight<'a> {
        phases: &'a [Phase; LANES],
        wo: &'a [[f32; LANES]; 3],
        u: &'a [[f32; LANES]; 2],
    }
    impl Kernel for Eight<'_> {
        type Output = ([[f32; LANES]; 3], [f32; LANES], u32);
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let phases = Phases::by_lane(simd, |lane| self.phases[lane]);
            let (wo, u) = (load(simd, self.wo), self.u.map(|u| f32x8::load_array(simd, u)));
            let wi = phases.sample(wo, u);
            (store(wi), phases.p(wo, wi).column(), phases.choose_draine(u[0]).to_bitmask() as u32)
        }
    }
    for trial in 0..2000 {
        let phases: [Phase; LANES] = std::array::from_fn(|lane| match (trial + lane) % 3 {
            0 => Phase::HenyeyGreenstein(HenyeyGreenstein::new(
                number(41, (trial * 8 + lane) as u64) * 1.9 - 0.95,
            )),
            _ => Phase::TwoLobes(TwoLobes::of_droplets(50.0 * number(42, (trial * 8 + lane) as u64))),
        });
        let phases = if trial % 4 == 0 { [phases[trial % 8]; LANES] } else { phases };
        let rows: Vec<Vec3> =
            (0..LANES as u32).map(|lane| direction(20.0 * lane as f32, 31.0 * trial as f32)).collect();
        let wo = [0, 1, 2].map(|axis| std::array::from_fn(|lane| rows[lane][axis]));
        let u = [43, 44].map(|seed| std::array::from_fn(|lane| number(seed, (trial * 8 + lane) as u64)));
        let (wi, p, chosen) = shade_together(Eight { phases: &phases, wo: &wo, u: &u });
        for lane in 0..LANES {
            let one = Phases::by_lane(One, |_| phases[lane]);
            let u = u.map(|u| u[lane]);
            let expected = one.sample(rows[lane].into(), u);
            let found = [0, 1, 2].map(|axis| wi[axis][lane]);
            assert_eq!(
                found.map(f32::to_bits),
                <[f32; 3]>::from(expected).map(f32::to_bits),
                "{:?}",
                phases[lane]
            );
            assert_eq!(p[lane].to_bits(), one.p(rows[lane].into(), expected).to_bits());
            assert_eq!(chosen >> lane & 1 != 0, one.choose_draine(u[0]));
        }
    }
}
