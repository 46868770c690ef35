//! Tests of layered BSDFs: random walks against formulas, and `sample` against `f` where there are no formulas.

use glam::Vec3;

use super::*;
use crate::shading::bsdf::Bsdf;
use crate::shading::bsdf::diffuse::Diffuse;
use crate::shading::bsdf::microfacet::TrowbridgeReitz;
use crate::shading::bsdf::tests::{direction, number, numbers};
use crate::shading::bsdf::{diffuse::cosine_direction, fresnel};

/// A mean and its standard error.
#[derive(Clone, Copy, Debug)]
struct Estimate {
    mean: f64,
    error: f64,
}

fn estimate(n: u64, value: impl Fn(u64) -> f64) -> Estimate {
    let (mut sum, mut squares) = (0.0, 0.0);
    for index in 0..n {
        let value = value(index);
        sum += value;
        squares += value * value;
    }
    let mean = sum / n as f64;
    Estimate { mean, error: ((squares / n as f64 - mean * mean).max(0.0) / n as f64).sqrt() }
}

impl Estimate {
    /// Distance of the two in standard errors.
    fn distance(self, other: Self) -> f64 {
        (self.mean - other.mean).abs() / self.error.hypot(other.error).max(1e-9)
    }
}

/// ∫ f |cos θ_i| over all directions, by cosine-weighted samples.
fn integral_of_f(f: impl Fn(Vec3, Vec3) -> Spectrum, wo: Vec3, n: u64, seed: u64) -> Estimate {
    estimate(n, |index| {
        let (_, u) = numbers(seed, index);
        let wi = cosine_direction(u, wo.z).into();
        f64::from(f(wo, wi).0[0]) * std::f64::consts::PI
    })
}

/// The BSDF with an estimate and a seed of its walks.
fn with_walks(bsdf: &Bsdf, estimate: CoatEstimate, seed: f32) -> Bsdf {
    let unbiased = if estimate == CoatEstimate::Unbiased { 1.0 } else { 0.0 };
    match *bsdf {
        Bsdf::CoatedDiffuse(layered) => Bsdf::CoatedDiffuse(Layered { unbiased, seed, ..layered }),
        Bsdf::CoatedConductor(layered) => Bsdf::CoatedConductor(Layered { unbiased, seed, ..layered }),
        _ => panic!("not layered"),
    }
}

/// `f` with MIS weights of the two exit strategies that add up to one, as pbrt's do not.
fn unbiased_f(bsdf: &Bsdf, wo: Vec3, wi: Vec3) -> Spectrum {
    with_walks(bsdf, CoatEstimate::Unbiased, 0.0).f(wo, wi)
}

/// The mean weight by `sample`, of the specular or the other lobes.
fn mean_weight(bsdf: &Bsdf, wo: Vec3, n: u64, seed: u64, specular: bool) -> Estimate {
    estimate(n, |index| {
        let (uc, u) = numbers(seed, index);
        let sample = bsdf.sample(wo, uc, u);
        let sample = sample.filter(|sample| sample.lobe.is_specular() == specular);
        sample.map_or(0.0, |s| f64::from(s.f.0[0] * s.wi.z.abs() / s.pdf))
    })
}

/// The fraction of diffuse light inside that a smooth boundary reflects back.
fn internal_reflection(eta: f64) -> f64 {
    let n = 20_000;
    let sum: f64 = (0..n)
        .map(|i| {
            let cos2 = (f64::from(i) + 0.5) / f64::from(n);
            f64::from(fresnel::dielectric(-(cos2.sqrt() as f32), eta as f32))
        })
        .sum();
    sum / f64::from(n)
}

fn grey(value: f32) -> Spectrum {
    Spectrum([value; 4])
}

#[test]
fn a_smooth_coat_on_lambert_is_a_geometric_series() {
    let inside = internal_reflection(1.5);
    // A known number: 0.596 for η = 1.5.
    assert!((inside - 0.596).abs() < 1e-3, "{inside}");
    for (reflectance, max_depth, theta) in
        [(1.0, 10, 30.0), (1.0, 2, 0.0), (1.0, 9, 70.0), (0.5, 4, 60.0), (1.0, 200, 40.0)]
    {
        let coat = CoatLayer { thickness: 0.0, max_depth, ..CoatLayer::default() };
        let bsdf = Bsdf::coated_diffuse(grey(reflectance), &coat);
        let wo = direction(theta, 15.0);
        let mirrored = f64::from(fresnel::dielectric(wo.z, 1.5));
        let series = |reflections: i32| {
            let ratio = f64::from(reflectance) * inside;
            let sum = (1.0 - ratio.powi(reflections)) / (1.0 - ratio);
            (1.0 - mirrored) * f64::from(reflectance) * sum * (1.0 - inside)
        };
        // `f` connects the base with the exit at every second step, the first included; `sample` must also leave.
        let f = integral_of_f(|wo, wi| bsdf.f(wo, wi), wo, 200_000, 1);
        let expected = Estimate { mean: series(i32::from(max_depth.div_ceil(2))), error: 1e-4 };
        assert!(f.distance(expected) < 4.5, "{coat:?} {theta}: f {f:?}, series {expected:?}");
        let sampled = mean_weight(&bsdf, wo, 200_000, 2, false);
        let expected = Estimate { mean: series(i32::from(max_depth) / 2), error: 1e-4 };
        assert!(
            sampled.distance(expected) < 4.5,
            "{coat:?} {theta}: sample {sampled:?}, series {expected:?}"
        );
        let specular = mean_weight(&bsdf, wo, 200_000, 3, true);
        assert!(specular.distance(Estimate { mean: mirrored, error: 1e-5 }) < 4.5, "{specular:?} {mirrored}");
        // No energy is lost except what the cut-off drops.
        if max_depth == 200 {
            assert!((f.mean + mirrored - 1.0).abs() < 4.5 * f.error + 1e-3);
        }
    }
}

#[test]
fn the_slab_absorbs_on_each_crossing() {
    // With an index of 1, Lambertian reflection under an absorber remains: ρ e^(−d/cos θ_o) e^(−d/cos θ_i) / π.
    let coat = CoatLayer { eta: 1.0, thickness: 0.3, ..CoatLayer::default() };
    let bsdf = Bsdf::coated_diffuse(grey(0.8), &coat);
    let (wo, wi) = (direction(50.0, 0.0), direction(20.0, 100.0));
    let expected = 0.8 * (-0.3_f32 / wo.z - 0.3 / wi.z).exp() * FRAC_1_PI;
    let f = bsdf.f(wo, wi).0[0];
    assert!((f / expected - 1.0).abs() < 1e-4, "{f} {expected}");
}

#[test]
fn single_scattering_in_the_slab_has_a_formula() {
    // No boundary, black base, one step: p Λ cos / (cos_o + cos_i) (1 − e^(−d (1/cos_o + 1/cos_i))) / (cos_o cos_i).
    let coat = CoatLayer {
        eta: 1.0,
        thickness: 0.7,
        albedo: grey(0.6),
        g: 0.4,
        max_depth: 1,
        samples: 1,
        ..CoatLayer::default()
    };
    let bsdf = Bsdf::coated_diffuse(Spectrum::BLACK, &coat);
    let (wo, wi) = (direction(50.0, 0.0), direction(20.0, 100.0));
    let phase = HenyeyGreenstein::new(0.4).p(wo.into(), wi.into());
    let crossing = 0.7 * (1.0 / wo.z + 1.0 / wi.z);
    let expected = f64::from(0.6 * phase * (1.0 - (-crossing).exp()) / (wo.z + wi.z));
    // The function is one estimate per seed.
    let f = estimate(200_000, |index| {
        let bsdf = with_walks(&bsdf, CoatEstimate::Pbrt, number(5, index));
        f64::from(bsdf.f(wo, wi).0[0])
    });
    assert!(f.distance(Estimate { mean: expected, error: 1e-5 }) < 4.5, "{f:?} {expected}");
}

/// Coats and bases of all kinds, deep enough that no walk is cut off.
fn deep() -> Vec<(&'static str, Bsdf)> {
    let coat = CoatLayer { max_depth: 300, ..CoatLayer::default() };
    let rough = CoatLayer { roughness: TrowbridgeReitz::new(0.4, 0.4).into(), ..coat };
    let brushed = CoatLayer { roughness: TrowbridgeReitz::new(0.2, 0.6).into(), ..coat };
    let milky = |coat| CoatLayer { albedo: grey(0.8), thickness: 0.4, g: 0.3, ..coat };
    let metal = |alpha, coat: &CoatLayer| {
        let roughness = TrowbridgeReitz::new(alpha, alpha);
        Bsdf::coated_conductor(grey(0.3), grey(3.0), roughness, coat)
    };
    vec![
        ("smooth on white", Bsdf::coated_diffuse(grey(0.9), &coat)),
        ("rough on white", Bsdf::coated_diffuse(grey(0.9), &rough)),
        ("brushed on white", Bsdf::coated_diffuse(grey(0.9), &brushed)),
        ("smooth milk on white", Bsdf::coated_diffuse(grey(0.5), &milky(coat))),
        ("rough milk on white", Bsdf::coated_diffuse(grey(0.5), &milky(rough))),
        ("smooth on rough metal", metal(0.4, &coat)),
        ("rough on smooth metal", metal(0.0, &rough)),
        ("rough on rough metal", metal(0.4, &rough)),
        ("smooth milk on smooth metal", metal(0.0, &milky(coat))),
        ("rough milk on rough metal", metal(0.4, &milky(rough))),
        ("four walks", Bsdf::coated_diffuse(grey(0.9), &CoatLayer { samples: 4, ..rough })),
    ]
}

#[test]
fn samples_add_up_to_the_integral_of_f() {
    const N: u64 = 100_000;
    for (name, bsdf) in deep() {
        for (view, wo) in
            [direction(10.0, 30.0), direction(65.0, 200.0), direction(130.0, 80.0)].into_iter().enumerate()
        {
            let f = integral_of_f(|wo, wi| unbiased_f(&bsdf, wo, wi), wo, N, 10 + view as u64);
            let sampled = mean_weight(&bsdf, wo, N, 20 + view as u64, false);
            if name == "smooth milk on smooth metal" {
                // From a particle by a specular reflection through a smooth coat: only `sample` finds such
                // paths, as in pbrt.
                assert!(f.mean < sampled.mean, "{name} {wo}: f {f:?}, sample {sampled:?}");
            } else {
                assert!(f.distance(sampled) < 4.5, "{name} {wo}: f {f:?}, sample {sampled:?}");
            }
            let specular = mean_weight(&bsdf, wo, N / 4, 30 + view as u64, true);
            let all = sampled.mean + specular.mean;
            assert!(all < 1.0 + 4.5 * sampled.error.hypot(specular.error), "{name} {wo}: {all}");
            assert!(f.mean > 0.05, "{name}: nothing to compare");
        }
    }
}

#[test]
fn ways_out_are_weighed_as_in_pbrt() {
    // pbrt's MIS weights of the two exit strategies of a rough coat add up to a little more than one. Images are
    // compared with pbrt's, so `f` must keep that; smooth coats have one exit strategy.
    let wo = direction(10.0, 30.0);
    for (name, bsdf) in deep() {
        let kept = integral_of_f(|wo, wi| bsdf.f(wo, wi), wo, 100_000, 60);
        let unbiased = integral_of_f(|wo, wi| unbiased_f(&bsdf, wo, wi), wo, 100_000, 61);
        match name {
            "rough on white" => {
                assert!((1.06..1.11).contains(&(kept.mean / unbiased.mean)), "{kept:?} {unbiased:?}");
            }
            "smooth on white" | "smooth milk on white" | "rough on smooth metal" => {
                assert!(kept.distance(unbiased) < 4.5, "{name}: {kept:?} {unbiased:?}");
            }
            _ => {}
        }
    }
}

#[test]
fn the_mean_over_seeds_is_that_over_directions_nearby() {
    // Where directions repeat, as with a parallel camera and a distant light, only the seed makes walks differ.
    let (wo, wi) = (direction(40.0, 30.0), direction(25.0, 170.0));
    for (name, bsdf) in deep() {
        let over_seeds = estimate(40_000, |index| {
            let bsdf = with_walks(&bsdf, CoatEstimate::Unbiased, number(80, index));
            f64::from(bsdf.f(wo, wi).0[0])
        });
        let nearby = estimate(40_000, |index| {
            let jitter = |k: u64| 1e-4 * (number(81, index * 6 + k) - 0.5);
            let wo = (wo + Vec3::new(jitter(0), jitter(1), jitter(2))).normalize();
            let wi = (wi + Vec3::new(jitter(3), jitter(4), jitter(5))).normalize();
            f64::from(unbiased_f(&bsdf, wo, wi).0[0])
        });
        assert!(over_seeds.distance(nearby) < 4.5, "{name}: {over_seeds:?} {nearby:?}");
        let seed = |seed| with_walks(&bsdf, CoatEstimate::Unbiased, seed);
        let densities = [0.25, 0.75].map(|u| seed(u).pdf(wo, wi));
        assert!(densities.iter().all(|pdf| *pdf > 0.0), "{name}");
    }
}

#[test]
fn the_series_of_a_diffuse_base_is_the_mean_of_walks() {
    let coat = CoatLayer { max_depth: 300, estimate: CoatEstimate::Unbiased, ..CoatLayer::default() };
    let rough = TrowbridgeReitz::new(0.4, 0.4);
    for (eta, roughness, thickness) in [
        (1.5, TrowbridgeReitz::SMOOTH, 0.01),
        (1.5, rough, 0.01),
        (1.33, TrowbridgeReitz::new(0.2, 0.6), 0.3),
        (2.2, TrowbridgeReitz::new(0.05, 0.05), 0.1),
        (1.4, TrowbridgeReitz::new(0.6, 0.6), 0.5),
    ] {
        let coat = CoatLayer { eta, roughness: roughness.into(), thickness, ..coat };
        let interior = CoatInterior::new(eta, roughness, thickness);
        let inside = interior.internal_reflectance;
        if roughness.is_smooth() && thickness < 0.02 {
            // ∫ 2 μ F(μ) e^(−2 t / μ) dμ; without the slab it would be 0.596.
            let steps = 20_000;
            let expected: f64 = (0..steps)
                .map(|k| (f64::from(k) + 0.5) / f64::from(steps))
                .map(|mu| {
                    let reflected = f64::from(fresnel::dielectric(-(mu as f32), eta));
                    2.0 * mu * reflected * (-2.0 * f64::from(thickness) / mu).exp()
                })
                .sum();
            assert!((f64::from(inside) - expected / f64::from(steps)).abs() < 1e-3, "{inside}");
        }
        let closed = CoatLayer { interior: Some(interior), ..coat };
        for (wo, wi) in
            [(direction(20.0, 30.0), direction(35.0, 170.0)), (direction(70.0, 10.0), direction(50.0, 190.0))]
        {
            let mean = |coat: &CoatLayer, seed: u64| {
                estimate(40_000, |index| {
                    let bsdf = Bsdf::CoatedDiffuse(Layered::coated_diffuse(
                        Diffuse::new(grey(0.9)),
                        coat,
                        number(seed, index),
                    ));
                    f64::from(bsdf.f(wo, wi).0[0])
                })
            };
            let (walks, series) = (mean(&coat, 90), mean(&closed, 91));
            let error = walks.error.hypot(series.error) + 1e-3 * walks.mean;
            assert!((walks.mean - series.mean).abs() < 4.5 * error, "{coat:?}: {walks:?} {series:?}");
            assert!(series.error < 0.8 * walks.error, "{coat:?}: {walks:?} {series:?}");
            // Even rough coats need no random numbers at all.
            let is_even = roughness.alpha_x == roughness.alpha_y && !roughness.is_smooth();
            assert_eq!(interior.transmission.is_some(), is_even, "{coat:?}");
            assert!(!is_even || series.error < 1e-6 * series.mean, "{coat:?}: {series:?}");
        }
    }
}

#[test]
fn light_goes_both_ways_on_average() {
    let (wo, wi) = (direction(60.0, 30.0), direction(25.0, 170.0));
    for (name, bsdf) in deep() {
        let mean = |seed: u64, swap: bool| {
            estimate(60_000, |index| {
                let jitter = |k: u64| 1e-4 * (number(seed, index * 6 + k) - 0.5);
                let wo = (wo + Vec3::new(jitter(0), jitter(1), jitter(2))).normalize();
                let wi = (wi + Vec3::new(jitter(3), jitter(4), jitter(5))).normalize();
                let (wo, wi) = if swap { (wi, wo) } else { (wo, wi) };
                f64::from(unbiased_f(&bsdf, wo, wi).0[0])
            })
        };
        let (there, back) = (mean(40, false), mean(41, true));
        assert!(there.distance(back) < 4.5, "{name}: {there:?} {back:?}");
        // The other side scatters alike.
        let below = bsdf.f(-wo, -wi);
        assert_eq!(below, bsdf.f(wo, wi), "{name}");
        assert!(bsdf.f(wo, -wi).is_black(), "{name}");
    }
}

#[test]
fn values_are_functions_of_their_arguments() {
    let bsdf = deep()[4].1;
    let (wo, wi) = (direction(60.0, 30.0), direction(25.0, 170.0));
    let sample = || bsdf.sample(wo, 0.99, [0.3, 0.4]);
    assert_eq!(sample(), sample());
    assert_eq!(bsdf.f(wo, wi), bsdf.f(wo, wi));
    assert_eq!(bsdf.pdf(wo, wi), bsdf.pdf(wo, wi));
    assert!(sample().is_none_or(|sample| sample.pdf_is_proportional));
}

#[test]
fn the_density_is_never_zero_and_about_normal() {
    // A tenth is uniform; the rest counts the light that enters and the coat's reflection as if each were all,
    // as in pbrt.
    for (name, bsdf) in deep() {
        let wo = direction(40.0, 10.0);
        let total = estimate(50_000, |index| {
            let (_, u) = numbers(50, index);
            let wi = crate::core::warp::uniform_sphere(u);
            let pdf = bsdf.pdf(wo, wi);
            assert!(pdf >= 0.1 * 0.079, "{name} {wi}: {pdf}");
            f64::from(pdf) * 4.0 * std::f64::consts::PI
        });
        assert!(total.mean > 0.09 && total.mean < 2.5, "{name}: {total:?}");
    }
}

#[test]
fn lobes_are_named_as_in_pbrt() {
    let lobes: Vec<_> = deep().into_iter().map(|(_, bsdf)| bsdf.lobes()).collect();
    let (reflection, specular) = (Lobes::REFLECTION, Lobes::SPECULAR);
    assert_eq!(lobes[0], reflection | specular | Lobes::DIFFUSE);
    assert_eq!(lobes[1], reflection | Lobes::DIFFUSE);
    assert_eq!(lobes[5], reflection | specular | Lobes::GLOSSY);
    assert_eq!(lobes[8], reflection | specular | Lobes::DIFFUSE);
    let mirror = TrowbridgeReitz::SMOOTH;
    let mut bsdf = Bsdf::coated_conductor(grey(0.3), grey(3.0), mirror, &CoatLayer::default());
    assert_eq!(bsdf.lobes(), reflection | specular);
    assert!(bsdf.f(Vec3::Z, direction(10.0, 0.0)).is_black());
    bsdf.regularize();
    assert_eq!(bsdf.lobes(), reflection | Lobes::GLOSSY);
}
