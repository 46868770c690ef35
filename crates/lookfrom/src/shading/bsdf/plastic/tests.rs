//! Tests of plastic: values of Mitsuba 3, light that it keeps, and its tables.

use lookfrom_scene::material::{self as written, Distribution, Masking};

use super::*;
use crate::core::optics;
use crate::core::vector::Vector;
use crate::shading::bsdf::Bsdf;
use crate::shading::bsdf::layered::{PLANE, lattice};
use crate::shading::bsdf::microfacet::TrowbridgeReitz;
use crate::shading::bsdf::tests::{direction, numbers, weight_of_energy};

/// Facets of α.
fn facets(alpha: f32, distribution: Distribution, masking: Masking) -> Microfacets {
    let roughness = TrowbridgeReitz::new(alpha, alpha);
    Microfacets::new(roughness, written::Microfacets { distribution, masking })
}

fn plastic(reflectance: [f32; 3], is_nonlinear: bool, facets: Microfacets) -> Plastic {
    let interface = Interface::kept(1.5, facets);
    Plastic::new(Spectrum::from_rgb(reflectance), Spectrum([1.0; 4]), is_nonlinear, interface)
}

const PAIRS: [[(f32, f32); 2]; 4] = [
    [(20.0, 10.0), (30.0, 100.0)],
    [(60.0, 0.0), (50.0, 170.0)],
    [(85.0, 0.0), (70.0, 175.0)],
    [(40.0, 10.0), (42.0, 190.0)],
];

/// Values of Mitsuba 3.9 for albedos of 0.2 and 0.9, without the cosine: α, `nonlinear`, and of the pairs of directions.
const BECKMANN: [(f32, bool, [[f32; 2]; 4]); 6] = [
    (0.0, false, [[0.064554, 0.29049], [0.060232, 0.27104], [0.022525, 0.10136], [0.063801, 0.28711]]),
    (0.0, true, [[0.029555, 0.25304], [0.027576, 0.23609], [0.010313, 0.088292], [0.029211, 0.25009]]),
    (0.1, false, [[0.062096, 0.27941], [0.23497, 0.43718], [0.35055, 0.44889], [0.69166, 0.90625]]),
    (0.1, true, [[0.029445, 0.24539], [0.20459, 0.40553], [0.33577, 0.4335], [0.65942, 0.87266]]),
    (0.4, false, [[0.065578, 0.24248], [0.14272, 0.30485], [2.1305, 2.2604], [0.089875, 0.26255]]),
    (0.4, true, [[0.043675, 0.22263], [0.12265, 0.28666], [2.1144, 2.2458], [0.068495, 0.24318]]),
];
const GGX: [(f32, bool, [[f32; 2]; 4]); 4] = [
    (0.1, false, [[0.061157, 0.26389], [0.2148, 0.40274], [1.6596, 1.77], [0.66673, 0.86642]]),
    (0.1, true, [[0.03241, 0.23531], [0.18815, 0.37624], [1.6439, 1.7544], [0.63842, 0.83827]]),
    (0.4, false, [[0.048614, 0.18278], [0.1068, 0.22555], [0.90743, 0.98965], [0.075039, 0.20404]]),
    (0.4, true, [[0.037138, 0.17404], [0.096643, 0.21781], [0.9004, 0.98429], [0.064004, 0.19563]]),
];

#[test]
fn plastic_is_that_of_mitsuba() {
    let beckmann = BECKMANN.map(|row| (Distribution::Beckmann, row));
    let ggx = GGX.map(|row| (Distribution::TrowbridgeReitz, row));
    for (distribution, (alpha, is_nonlinear, values)) in beckmann.into_iter().chain(ggx) {
        let facets = facets(alpha, distribution, Masking::Separable);
        let bsdf = plastic([0.2, 0.5, 0.9], is_nonlinear, facets);
        for ([wi, wo], expected) in PAIRS.into_iter().zip(values) {
            let [wi, wo] = [wi, wo].map(|(theta, phi)| direction(theta, phi));
            let [dark, _, bright, _] = Bsdf::Plastic(bsdf).f(wo, wi).0;
            for (found, expected) in [dark, bright].into_iter().zip(expected) {
                // There masking is a fit within 0.35 % of Smith's, and the reflectance inside a smooth surface another.
                let error = (found / expected - 1.0).abs();
                assert!(error < 5e-3, "{distribution:?} {alpha} {wo} {wi}: {found}, expected {expected}");
            }
        }
    }
}

/// The mean weights of samples on the side of ω_o and on the other.
fn albedos(bsdf: &Bsdf, wo: Vec3) -> [f64; 2] {
    const COUNT: u64 = 100_000;
    let mut sums = [0.0; 2];
    for index in 0..COUNT {
        let (uc, u) = numbers(7, index);
        if let Some(sample) = bsdf.sample(wo, uc, u) {
            let weight = f64::from(weight_of_energy(bsdf, wo, &sample).0[0]);
            sums[usize::from(sample.lobe.is_transmission())] += weight;
        }
    }
    sums.map(|sum| sum / COUNT as f64)
}

#[test]
fn white_plastic_keeps_all_light_where_it_is_smooth_and_never_makes_any() {
    for wo in [Vec3::Z, direction(40.0, 20.0), direction(75.0, 90.0), direction(110.0, 200.0)] {
        let smooth = Microfacets::from(TrowbridgeReitz::SMOOTH);
        for is_nonlinear in [false, true] {
            let [found, _] = albedos(&Bsdf::Plastic(plastic([1.0; 3], is_nonlinear, smooth)), wo);
            assert!((found - 1.0).abs() < 2e-3, "{wo}: {found}");
        }
        for alpha in [0.01, 0.1, 0.3, 0.7] {
            for distribution in [Distribution::Beckmann, Distribution::TrowbridgeReitz] {
                for masking in [Masking::Correlated, Masking::Separable] {
                    let facets = facets(alpha, distribution, masking);
                    let [found, _] = albedos(&Bsdf::Plastic(plastic([1.0; 3], true, facets)), wo);
                    assert!((0.3..1.002).contains(&found), "{facets:?} {wo}: {found}");
                }
            }
        }
    }
}

#[test]
fn tables_hold_what_facets_reflect_and_refract() {
    for distribution in [Distribution::Beckmann, Distribution::TrowbridgeReitz] {
        for masking in [Masking::Correlated, Masking::Separable] {
            for alpha in [0.05, 0.3] {
                let facets = facets(alpha, distribution, masking);
                let interface = Interface::new(1.5, facets);
                let glass = Bsdf::dielectric(1.5, facets);
                for entry in [4, 8, 20, 40, 63] {
                    let cos = entry as f32 / (COSINES - 1) as f32;
                    let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
                    let sides = albedos(&glass, wo);
                    for (found, expected) in interface.sides.iter().zip(sides) {
                        let found = f64::from(found[entry]);
                        assert!((found - expected).abs() < 4e-3, "{facets:?} {cos}: {found}, {expected}");
                    }
                }
            }
        }
    }
}

/// The entries of the tables of [`Interface::new`], facet by facet.
fn reflected_and_refracted(facets: Microfacets, eta: f32, cos: f32, points: &[[f32; 2]]) -> [f32; 2] {
    let wo = Vector { x: (1.0 - cos * cos).max(0.0).sqrt(), y: 0.0, z: cos };
    let seen = |wi| {
        let [g, g1] = facets.g_and_g1(wo, wi);
        f64::from(g / g1)
    };
    let mut sums = [0.0; 2];
    for &u in points {
        let wm = facets.sample(wo, u);
        let fresnel = optics::fresnel_dielectric(wo.dot(wm), eta);
        let reflected = optics::reflect(wo, wm);
        if reflected.z > 0.0 {
            sums[0] += f64::from(fresnel) * seen(reflected);
        }
        let (refracted, is_refracted) = optics::refract(wo, wm, eta);
        if is_refracted && refracted.z < 0.0 {
            sums[1] += f64::from(1.0 - fresnel) * seen(refracted);
        }
    }
    sums.map(|sum| (sum / points.len() as f64) as f32)
}

#[test]
fn tables_have_the_bits_of_facets_one_by_one() {
    for (distribution, masking) in
        [(Distribution::Beckmann, Masking::Correlated), (Distribution::TrowbridgeReitz, Masking::Separable)]
    {
        for alpha in [0.01, 0.4] {
            let facets = facets(alpha, distribution, masking);
            for eta in [1.5, 0.7] {
                let interface = Interface::new(eta, facets);
                let points: Vec<[f32; 2]> = lattice(2048, PLANE).collect();
                for entry in [0, 1, 31, 63] {
                    let cos = (entry as f32 / (COSINES - 1) as f32).max(1e-6);
                    let found = [0, 1].map(|side| interface.sides[side][entry].to_bits());
                    let expected = reflected_and_refracted(facets, eta, cos, &points);
                    assert_eq!(found, expected.map(f32::to_bits), "{facets:?} {eta} {cos}");
                }
            }
        }
    }
}

#[test]
fn interfaces_are_made_once() {
    let facets = facets(0.2, Distribution::Beckmann, Masking::Correlated);
    assert!(std::ptr::eq(Interface::kept(1.4, facets), Interface::kept(1.4, facets)));
    assert!(!std::ptr::eq(Interface::kept(1.4, facets), Interface::kept(1.5, facets)));
}
