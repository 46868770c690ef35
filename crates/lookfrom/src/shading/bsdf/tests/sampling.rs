//! Samples against densities.

use super::{COLUMNS, ROWS, cell, numbers, over_cells, views, weight_of_energy, with_density};
use crate::core::parallel;
use crate::core::statistics::{chi_square_deviate, corrected_bound};
use crate::shading::bsdf::*;

#[test]
fn samples_are_as_dense_as_they_say() {
    let subjects = with_density();
    let bound = corrected_bound(subjects.len() * views().len());
    let faults = parallel::collect(subjects.len(), |subject| {
        let (name, bsdf) = &subjects[subject];
        let mut faults = Vec::new();
        // BSDFs of many lobes are costly: fewer samples.
        let is_costly =
            ["principled", "openpbr", "disney", "conserving"].iter().any(|kind| name.starts_with(kind));
        // Refraction to the wrong side has a sharp ridge, of which quadrature misses a part.
        let missed = if name.starts_with("conserving") { 2e-4 } else { 1e-5 };
        let n: u64 = if is_costly { 300_000 } else { 1_000_000 };
        for (view, wo) in views().into_iter().enumerate() {
            if is_costly && (view + subject) % 2 == 1 {
                continue;
            }
            let seed = (subject * 100 + view) as u64;
            let what = format!("{name} from {wo}");
            let mut counts = vec![0_u64; ROWS * COLUMNS + 1];
            let (mut sum, mut squares, mut energy) = (0.0, 0.0, 0.0);
            for index in 0..n {
                let (uc, u) = numbers(seed, index);
                let sample = bsdf.sample(wo, uc, u);
                let Some(sample) = sample.filter(|s| !s.lobe.is_specular()) else {
                    counts[ROWS * COLUMNS] += 1;
                    continue;
                };
                counts[cell(sample.wi)] += 1;
                let weight = f64::from(sample.f.0[0] * sample.wi.z.abs() / sample.pdf);
                sum += weight;
                squares += weight * weight;
                energy += f64::from(weight_of_energy(bsdf, wo, &sample).0[0]);
            }
            // Counts against the density; samples without a density are counted in a cell of their own.
            let pdf = |wi| f64::from(bsdf.pdf(wo, wi));
            let mut expected = over_cells(&pdf, 3e-7);
            expected.push((1.0 - expected.iter().sum::<f64>()).max(1e-9));
            expected.iter_mut().for_each(|e| *e *= n as f64);
            let deviate = chi_square_deviate(&counts, &expected);
            if !(deviate < bound) {
                faults.push(format!("{what}: {deviate:.1} standard deviations, {bound:.1} are allowed"));
            }
            // The mean weight against the integral that it estimates.
            let value = |wi: Vec3| f64::from(bsdf.f(wo, wi).0[0] * wi.z.abs());
            let integral: f64 = over_cells(&value, 3e-7).iter().sum();
            let mean = sum / n as f64;
            let error = ((squares / n as f64 - mean * mean).max(0.0) / n as f64).sqrt();
            if !((mean - integral).abs() < bound * error + missed) {
                faults.push(format!("{what}: mean weight {mean} ± {error}, integral {integral}"));
            }
            let energy = energy / n as f64;
            if !name.starts_with("whitted") && !(energy < 1.0 + 1e-4 + bound * error) {
                faults.push(format!("{what}: more light out than in: {energy} ± {error}"));
            }
        }
        faults
    })
    .concat();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn samples_carry_the_values_of_f_and_pdf() {
    let close = |a: f32, b: f32| (a - b).abs() <= 4e-3 * a.abs().max(b.abs()) + 1e-6;
    let mut checked = 0;
    for (name, bsdf) in with_density() {
        for wo in views() {
            for index in 0..2400 {
                let (uc, u) = numbers(3, index);
                let Some(sample) = bsdf.sample(wo, uc, u) else { continue };
                assert!((sample.wi.length() - 1.0).abs() < 1e-5, "{name} {}", sample.wi);
                let through = wo.z * sample.wi.z < 0.0;
                assert_eq!(through, sample.lobe.is_transmission(), "{name}");
                if sample.lobe.is_specular() {
                    continue;
                }
                let (f, pdf) = (bsdf.f(wo, sample.wi), bsdf.pdf(wo, sample.wi));
                assert!(close(f.0[0], sample.f.0[0]), "{name} {wo} {sample:?}: f = {f:?}");
                assert!(close(pdf, sample.pdf), "{name} {wo} {sample:?}: pdf = {pdf}");
                checked += 1;
            }
        }
    }
    assert!(checked > 50_000, "{checked}");
}
