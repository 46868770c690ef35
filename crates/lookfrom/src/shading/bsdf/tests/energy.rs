//! Reciprocity, and what white surfaces keep.

use super::{
    direction, gold, grey, index_between, number, numbers, rough, uniform_direction, views, weight_of_energy,
    with_density,
};
use crate::shading::bsdf::dielectric::Mode;
use crate::shading::bsdf::microfacet::TrowbridgeReitz;
use crate::shading::bsdf::*;

#[test]
fn light_goes_both_ways() {
    let mut non_zero = 0;
    // Not reciprocal: tables of numbers, hair, Whitted's highlight, a coat with a normal of its own (whose cosines are to another normal),
    // OpenPBR's fuzz and the darkening by its coat, the facets of Disney's sheet, which face light as Mitsuba has it, and rough surfaces that conserve energy, as the glass of principled bodies does.
    let is_not = |name: &str| {
        name.starts_with("whitted")
            || name.starts_with("conserving")
            || name.starts_with("hair")
            || name.starts_with("measured")
            || name.contains("tilted")
            || name.contains("fuzz")
            || name.contains("darkened")
            || ["principled body", "principled everything", "openpbr body", "disney thin"].contains(&name)
    };
    for (name, bsdf) in with_density().into_iter().filter(|(name, _)| !is_not(name)) {
        for index in 0..4000 {
            let of = |k: u64| uniform_direction([number(5, index * 4 + k), number(5, index * 4 + k + 2)]);
            let (wo, wi) = (of(0), of(1));
            // What is refracted is scaled by the squares of the indices.
            let eta = index_between(&bsdf, wo, wi);
            let (there, back) = (bsdf.f(wo, wi).0[0] * eta, bsdf.f(wi, wo).0[0] / eta);
            // Where nearly all light is reflected, the transmitted part is a difference of almost
            // equal numbers.
            assert!(
                (there - back).abs() <= 2e-3 * there.max(back) + 1e-5,
                "{name} {wo} {wi}: {there} {back}"
            );
            non_zero += u32::from(there > 0.0);
        }
    }
    assert!(non_zero > 10_000);
}

#[test]
fn refraction_scales_radiance_by_the_index_squared() {
    for roughness in [TrowbridgeReitz::SMOOTH, rough(0.2, 0.2)] {
        let boundary = Dielectric::new(1.5, roughness);
        for (wo, eta) in [(direction(30.0, 10.0), 1.5_f32), (direction(160.0, 10.0), 1.0 / 1.5)] {
            let sample = |mode| boundary.sample(wo.into(), 0.999, [0.3, 0.7], mode, Lobes::ALL);
            let (radiance, importance) = (sample(Mode::Radiance), sample(Mode::Importance));
            assert!(radiance.is_valid && radiance.is_transmission);
            assert!((radiance.eta - eta).abs() < 1e-6);
            let ratio = importance.f.0[0] / radiance.f.0[0];
            assert!((ratio / (eta * eta) - 1.0).abs() < 1e-5, "{ratio}");
        }
    }
}

#[test]
fn nothing_is_lost_in_a_white_furnace() {
    for wo in views() {
        // BSDFs that reflect all light have weights of one.
        let white = [
            Bsdf::diffuse(grey(1.0)),
            Bsdf::diffuse_transmission(grey(0.4), grey(0.6)),
            Bsdf::conductor(grey(1.0), grey(1e8), TrowbridgeReitz::SMOOTH),
            Bsdf::dielectric(1.5, TrowbridgeReitz::SMOOTH),
            Bsdf::dielectric(0.7, TrowbridgeReitz::SMOOTH),
            Bsdf::dielectric(1.0, rough(0.3, 0.3)),
            Bsdf::thin_dielectric(1.5),
        ];
        for bsdf in white {
            for index in 0..100 {
                let (uc, u) = numbers(7, index);
                let sample = bsdf.sample(wo, uc, u).unwrap();
                assert!(
                    (weight_of_energy(&bsdf, wo, &sample).0[0] - 1.0).abs() < 1e-5,
                    "{bsdf:?} {wo} {sample:?}"
                );
            }
        }
    }
    // Sampling restricted to one side, as coats do, returns that side's part.
    let part = |side| {
        let boundary = Dielectric::new(1.5, TrowbridgeReitz::SMOOTH);
        let sample = boundary.sample(direction(60.0, 0.0).into(), 0.5, [0.5; 2], Mode::Importance, side);
        assert!(sample.is_valid && sample.pdf == 1.0);
        sample.f.0[0] * sample.wi.z.abs()
    };
    let (r, t) = (part(Lobes::REFLECTION), part(Lobes::TRANSMISSION));
    assert!(r > 0.08 && r < 0.2 && (r + t - 1.0).abs() < 1e-6, "{r} {t}");
}

#[test]
fn rough_surfaces_that_conserve_energy_stay_white() {
    const N: usize = 64;
    for trial in 0..60 {
        let of = |seed| number(seed, trial);
        let wo = uniform_direction([of(70), of(71)]);
        let roughness = rough(of(72).powi(2), if of(73) < 0.5 { of(72).powi(2) } else { of(74).powi(2) });
        let eta = 0.4 + 2.1 * of(75);
        let albedo = |bsdf: Bsdf, energy| {
            let bsdf = bsdf.with_energy(energy);
            let weight = |k: usize| {
                let u = [(k % N) as f32 + 0.5, (k / N) as f32 + 0.5].map(|x| x / N as f32);
                let sample = bsdf.sample(wo, number(76, k as u64), u);
                sample.map_or(0.0, |sample| f64::from(weight_of_energy(&bsdf, wo, &sample).0[0]))
            };
            (0..N * N).map(weight).sum::<f64>() / (N * N) as f64
        };
        // By a table, linear between its entries.
        let metal = Bsdf::conductor(grey(1.0), grey(1e8), roughness);
        let error = albedo(metal, Energy::Conserved) - 1.0;
        assert!(error.abs() < 0.02, "{roughness:?} {wo}: {error}");
        // Without a table.
        let error = albedo(Bsdf::dielectric(eta, roughness), Energy::Conserved) - 1.0;
        assert!(error.abs() < 1e-3, "{roughness:?} {eta} {wo}: {error}");
        for bsdf in [metal, Bsdf::dielectric(eta, roughness)] {
            assert!(albedo(bsdf, Energy::SingleScattering) < 1.0 + 1e-4);
        }
    }
    let dark = |energy| {
        let (eta, k) = gold();
        let bsdf = Bsdf::conductor(eta, k, rough(0.9, 0.9)).with_energy(energy);
        bsdf.f(direction(40.0, 0.0), direction(20.0, 180.0))
    };
    // A factor of what facets reflect is one of all light that they reflect once.
    let (eta, k) = gold();
    let factor = Spectrum([0.3, 0.9, 0.2, 0.5]);
    let [plain, tinted] = [Spectrum([1.0; 4]), factor].map(|factor| {
        let bsdf = Bsdf::Conductor(Conductor::new(eta, k, rough(0.9, 0.9)).with_specular_reflectance(factor));
        bsdf.f(direction(40.0, 0.0), direction(20.0, 180.0))
    });
    let close = |lane: usize| (tinted.0[lane] - plain.0[lane] * factor.0[lane]).abs() < 1e-6 * plain.0[lane];
    assert!((0..4).all(close), "{tinted:?} {plain:?}");
    // What facets reflect twice is twice coloured.
    let gains = [0, 2].map(|lane| dark(Energy::Conserved).0[lane] / dark(Energy::SingleScattering).0[lane]);
    assert!(gains[0] > gains[1] && gains[1] > 1.0, "{gains:?}");
}

#[test]
fn a_pane_reflects_the_sum_of_its_two_sides() {
    // R' = 2R / (1 + R) for two sides that reflect R each.
    let wo = direction(50.0, 0.0);
    let once = f64::from(fresnel::dielectric(wo.z, 1.5));
    let sample = Bsdf::thin_dielectric(1.5).sample(wo, 0.0, [0.0; 2]).unwrap();
    assert!((f64::from(sample.pdf) - 2.0 * once / (1.0 + once)).abs() < 1e-6);
    let through = Bsdf::thin_dielectric(1.5).sample(wo, 0.9, [0.0; 2]).unwrap();
    assert_eq!((through.wi, through.eta), (-wo, 1.0));
}
