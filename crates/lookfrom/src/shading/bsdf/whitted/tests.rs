//! Tests of Whitted's BSDF against Whitted ray tracing. (Its density is tested with all others.)

use glam::Vec3;

use super::*;
use crate::shading::bsdf::Bsdf;
use crate::shading::bsdf::tests::{direction, number, numbers, uniform_direction};

fn coefficients(trial: u64) -> WhittedCoefficients {
    let spectrum = |k: u64| Spectrum(std::array::from_fn(|lane| number(80 + k, trial * 4 + lane as u64)));
    let black_or = |k: u64| if number(90 + k, trial) < 0.3 { Spectrum::BLACK } else { spectrum(k) };
    WhittedCoefficients {
        ambient: Spectrum::BLACK,
        diffuse: black_or(0),
        specular: black_or(1),
        shininess: 200.0 * number(84, trial),
        mirror: black_or(2),
        transmission: black_or(3),
        ior: 0.6 + 2.0 * number(85, trial),
        fresnel: trial.is_multiple_of(2),
    }
}

fn close(a: Spectrum, b: Spectrum) -> bool {
    a.0.into_iter().zip(b.0).all(|(a, b)| (a - b).abs() <= 1e-4 * a.max(b) + 1e-6)
}

#[test]
fn lit_as_the_tree_of_rays_is() {
    for trial in 0..5000 {
        let whitted = coefficients(trial);
        let wo = uniform_direction([number(1, trial), number(2, trial)]);
        let wi = uniform_direction([number(3, trial), number(4, trial)]);
        let n = Vec3::new(0.0, 0.0, wo.z.signum());
        let expected = match n.dot(wi) > 0.0 {
            true => {
                let (diffuse, specular) = whitted.lit(n.into(), wo.into(), wi.into());
                (diffuse + specular) * FRAC_1_PI
            }
            false => Spectrum::BLACK,
        };
        let got = Bsdf::Whitted(whitted).f(wo, wi) * wi.z.abs();
        assert!(close(got, expected), "{whitted:?} {wo} {wi}");
    }
}

/// Materials of diffuse reflection alone have the class of Lambertian reflection ([`crate::shading::material`]).
#[test]
fn matte_it_is_lambertian_reflection_bit_for_bit() {
    for trial in 0..5000 {
        let diffuse = Spectrum(std::array::from_fn(|lane| number(80, trial * 4 + lane as u64)));
        let black = Spectrum::BLACK;
        let whitted = Bsdf::Whitted(WhittedCoefficients {
            diffuse,
            specular: black,
            mirror: black,
            transmission: black,
            ..coefficients(trial)
        });
        let lambertian = Bsdf::diffuse(diffuse);
        let wo = uniform_direction([number(1, trial), number(2, trial)]);
        let wi = uniform_direction([number(3, trial), number(4, trial)]);
        assert_eq!(whitted.f(wo, wi), lambertian.f(wo, wi));
        assert_eq!(whitted.pdf(wo, wi), lambertian.pdf(wo, wi));
        let (uc, u) = (number(5, trial), [number(6, trial), number(7, trial)]);
        assert_eq!(whitted.sample(wo, uc, u), lambertian.sample(wo, uc, u));
    }
}

#[test]
fn branches_as_the_tree_of_rays_does() {
    let mut met = [0; 3];
    for trial in 0..3000 {
        let whitted = coefficients(trial);
        let bsdf = Bsdf::Whitted(whitted);
        let wo = uniform_direction([number(1, trial), number(2, trial)]);
        let n = Vec3::new(0.0, 0.0, wo.z.signum());
        let branches = whitted.has_branches().then(|| whitted.branches(n.into(), wo.into(), wo.z > 0.0));
        let seen = whitted.seen_from(wo.into());
        let of_mirror = seen.diffuse_probability + seen.glossy_probability + 0.5 * seen.mirror_probability;
        // A specular lobe's expectation is f cos / pdf, times its probability.
        for side in [Lobes::REFLECTION, Lobes::TRANSMISSION] {
            let expected = match (&branches, side) {
                (None, _) => None,
                (Some(branches), Lobes::REFLECTION) => Some(branches.mirrored).filter(|(_, w)| !w.is_black()),
                (Some(branches), _) => Some(branches.refracted).filter(|_| branches.is_refracted),
            };
            let got = bsdf
                .sample(wo, if side == Lobes::REFLECTION { of_mirror } else { 1.0 - f32::EPSILON }, [0.5; 2])
                .filter(|sample| sample.lobe == side | Lobes::SPECULAR);
            // The largest number below one misses lobes whose probability is less than its distance to one.
            if expected.is_none_or(|(_, weight)| weight.max_lane() > 1e-3) {
                assert_eq!(
                    got.is_some(),
                    expected.is_some(),
                    "{whitted:?} {wo} {side:?}: {got:?} {expected:?}"
                );
            }
            if let (Some(got), Some((wi, weight))) = (got, expected) {
                let wi = Vec3::from(wi);
                assert!((got.wi - wi).length() < 1e-5, "{wo}: {} {wi}", got.wi);
                assert!(close(got.f * got.wi.z.abs(), weight), "{whitted:?} {wo} {side:?}");
                assert_eq!(got.eta, 1.0);
                met[usize::from(side == Lobes::TRANSMISSION)] += 1;
            }
        }
        met[2] += u32::from(branches.is_some_and(|branches| branches.total_reflection));
    }
    assert!(met.into_iter().all(|count| count > 100), "{met:?}");
}

#[test]
fn ways_on_are_chosen_as_often_as_they_say() {
    let whitted = WhittedCoefficients {
        diffuse: Spectrum([0.3; 4]),
        specular: Spectrum([0.5; 4]),
        shininess: 50.0,
        mirror: Spectrum([0.2; 4]),
        transmission: Spectrum([0.4; 4]),
        ior: 1.5,
        ..coefficients(0)
    };
    let wo = direction(40.0, 20.0);
    let n = 100_000;
    let mut met = [(0_u32, 0.0); 2];
    for index in 0..n {
        let (uc, u) = numbers(9, index);
        let sample = Bsdf::Whitted(whitted).sample(wo, uc, u);
        let Some(sample) = sample.filter(|sample| sample.lobe.is_specular()) else { continue };
        let way = &mut met[usize::from(sample.lobe.is_transmission())];
        *way = (way.0 + 1, f64::from(sample.pdf));
    }
    for (count, pdf) in met {
        let share = f64::from(count) / n as f64;
        assert!((share - pdf).abs() < 4.5 * (pdf * (1.0 - pdf) / n as f64).sqrt(), "{share} {pdf}");
    }
}
