//! Fresnel's equations, roughness and known values.

use super::{any_size, beckmann, direction, gold, grey, over_cells, rough};
use crate::shading::bsdf::microfacet::TrowbridgeReitz;
use crate::shading::bsdf::*;

/// Fresnel's formulas in complex arithmetic, in f64.
fn fresnel_complex(cos: f64, eta: f64, k: f64) -> f64 {
    type Complex = (f64, f64);
    let mul = |a: Complex, b: Complex| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
    let div = |a: Complex, b: Complex| {
        let n = b.0 * b.0 + b.1 * b.1;
        ((a.0 * b.0 + a.1 * b.1) / n, (a.1 * b.0 - a.0 * b.1) / n)
    };
    let sqrt = |a: Complex| {
        let r = a.0.hypot(a.1);
        let re = (0.5 * (r + a.0.abs())).sqrt();
        let other = if re == 0.0 { 0.0 } else { 0.5 * a.1.abs() / re };
        if a.0 >= 0.0 { (re, other.copysign(a.1)) } else { (other, re.copysign(a.1)) }
    };
    let n: Complex = (eta, k);
    let sin2_t = div((1.0 - cos * cos, 0.0), mul(n, n));
    let cos_t = sqrt((1.0 - sin2_t.0, -sin2_t.1));
    let across = |a: Complex, b: Complex| {
        let r = div((a.0 - b.0, a.1 - b.1), (a.0 + b.0, a.1 + b.1));
        r.0 * r.0 + r.1 * r.1
    };
    let parallel = across((n.0 * cos, n.1 * cos), cos_t);
    let perpendicular = across((cos, 0.0), mul(n, cos_t));
    0.5 * (parallel + perpendicular)
}

#[test]
fn metals_mirror_what_complex_numbers_say() {
    for trial in 0..20_000 {
        let (eta, k) = (any_size(11, trial, 12), any_size(12, trial, 12));
        let cos = any_size(13, trial, 20).min(1.0);
        let got = fresnel::conductor(cos, grey(eta), grey(k)).0[2];
        let expected = fresnel_complex(f64::from(cos), f64::from(eta), f64::from(k));
        assert!((f64::from(got) - expected).abs() < 1e-5, "{eta} {k} {cos}: {got} {expected}");
    }
}

#[test]
fn known_reflectances() {
    // ((η − 1)² + k²) / ((η + 1)² + k²), at normal incidence.
    let (eta, k) = gold();
    let straight = fresnel::conductor(1.0, eta, k);
    for (lane, expected) in [0.9662, 0.8009, 0.3232].into_iter().enumerate() {
        let (eta, k) = (eta.0[lane], k.0[lane]);
        let formula = ((eta - 1.0).powi(2) + k * k) / ((eta + 1.0).powi(2) + k * k);
        assert!((straight.0[lane] - formula).abs() < 1e-5);
        assert!((formula - expected).abs() < 3e-3, "{formula}");
    }
    // All metals reflect all light at grazing incidence.
    assert!((fresnel::conductor(0.0, eta, k).0[1] - 1.0).abs() < 1e-6);
    // A metal made from a reflectance has that reflectance.
    for r in [0.0, 0.02, 0.5, 0.99] {
        let (eta, k) = fresnel::conductor_of_reflectance(grey(r));
        assert!((fresnel::conductor(1.0, eta, k).0[0] - r).abs() < 1e-5);
    }
    // An unused lane of zeros stays finite.
    assert!(fresnel::conductor(1.0, Spectrum::BLACK, Spectrum::BLACK).0[3].is_finite());
    // Glass from inside, at normal incidence and beyond the critical angle.
    assert!((fresnel::dielectric(-1.0, 1.5) - 0.04).abs() < 1e-6);
    assert_eq!(fresnel::dielectric(-0.5, 1.5), 1.0);
}

#[test]
fn roughness_is_as_in_pbrt() {
    let lobe = |x, y| Bsdf::conductor(grey(1.0), grey(3.0), rough(x, y)).lobes();
    assert!(lobe(0.0009, 0.0).is_specular());
    // One rough direction is sufficient.
    assert!(!lobe(0.0011, 0.0).is_specular());
    assert_eq!(TrowbridgeReitz::from_roughness([0.25, 0.04], true), rough(0.5, 0.2));
    assert_eq!(TrowbridgeReitz::from_roughness([0.25, 0.04], false), rough(0.25, 0.04));
    for (before, after) in [(0.0, 0.1), (0.04, 0.1), (0.1, 0.2), (0.2, 0.3), (0.29, 0.3), (0.5, 0.5)] {
        let mut roughness = rough(before, before);
        roughness.regularize();
        assert_eq!(roughness, rough(after, after));
    }
    let mut glass = Bsdf::dielectric(1.5, TrowbridgeReitz::SMOOTH);
    glass.regularize();
    assert_eq!(glass, Bsdf::dielectric(1.5, rough(0.1, 0.1)));
}

#[test]
fn facets_cover_the_surface_and_what_is_seen_of_it() {
    let usual = [rough(0.5, 0.5), rough(0.2, 0.7), rough(0.1, 0.1)].map(Microfacets::from);
    let others = [beckmann(0.5, 0.5), beckmann(0.2, 0.7), beckmann(0.1, 0.1)];
    for roughness in usual.into_iter().chain(others) {
        let projected = |wm: Vec3| f64::from(roughness.d(wm.into()) * wm.z.max(0.0));
        let sum: f64 = over_cells(&projected, 1e-6).iter().sum();
        assert!((sum - 1.0).abs() < 1e-4, "{sum}");
        for wo in [direction(20.0, 10.0), direction(75.0, 80.0)] {
            let seen = |wm: Vec3| {
                if wm.z <= 0.0 {
                    return 0.0;
                }
                f64::from(roughness.visible_per_cosine(wo.into(), wm.into()) * wo.dot(wm).max(0.0))
            };
            let sum: f64 = over_cells(&seen, 1e-6).iter().sum();
            assert!((sum - 1.0).abs() < 1e-4, "{wo}: {sum}");
        }
    }
}
