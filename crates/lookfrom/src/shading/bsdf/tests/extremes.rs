//! Numbers of any size, and sizes of types.

use std::collections::BTreeMap;

use super::{any_size, grey, measured, merl, number, numbers, of_any_kind, rough, stained};
use crate::core::hash;
use crate::shading::bsdf::normalized_fresnel::NormalizedFresnel;
use crate::shading::bsdf::whitted::WhittedCoefficients;
use crate::shading::bsdf::*;
use lookfrom_scene::material::Energy;

#[test]
fn numbers_of_any_size_never_become_nan() {
    // Directions near the axes, the surface and each other, by components of random exponents, and now and then in the surface.
    let direction = |seed: u64, trial: u64| {
        let component = |k: u64| {
            let sign = if hash::pair(seed + k, trial) >> 50 & 1 == 0 { 1.0 } else { -1.0 };
            f64::from(sign * any_size(seed + k, trial, 45))
        };
        glam::DVec3::new(component(0), component(1), component(2)).normalize().as_vec3()
    };
    // The first of each kind.
    let mut failures = BTreeMap::new();
    let (adaptive, half_angle) = (measured(5), merl());
    for trial in 0..60_000 {
        let size = |seed| any_size(seed, trial, 60);
        let lanes = |seed| Spectrum(std::array::from_fn(|lane| any_size(seed + lane as u64, trial, 60)));
        let small = |seed| any_size(seed, trial, 12);
        let roughness = rough(small(21), small(22));
        let coat = CoatLayer {
            eta: if trial.is_multiple_of(3) { size(31) } else { 1.5 },
            roughness: of_any_kind(trial / 4, rough(small(32), small(33))),
            thickness: size(34),
            albedo: if trial.is_multiple_of(2) { lanes(35) } else { Spectrum::BLACK },
            g: 1.0 - 2.0 * number(36, trial),
            max_depth: 10,
            samples: 1,
            estimate: lookfrom_scene::material::CoatEstimate::Unbiased,
            interior: None,
        };
        let whitted = WhittedCoefficients {
            ambient: Spectrum::BLACK,
            diffuse: lanes(41),
            specular: lanes(42),
            shininess: any_size(43, trial, 20),
            mirror: lanes(44),
            transmission: lanes(45),
            ior: small(46),
            fresnel: trial.is_multiple_of(2),
        };
        let share = |seed| any_size(seed, trial, 20).min(1.0);
        let look = principled::Principled {
            base_color: lanes(80),
            metallic: share(81),
            roughness,
            eta: if trial.is_multiple_of(7) { 0.0 } else { size(82) },
            f0: lanes(83),
            f0_greatest: share(84),
            f90: share(85),
            transmission: share(86),
            is_solid: trial.is_multiple_of(2),
            diffuse_transmission: share(87),
            clearcoat: share(88),
            clearcoat_roughness: rough(small(89), small(89)),
            clearcoat_normal: direction(90, trial).with_z(direction(90, trial).z.abs()).into(),
            sheen_color: if trial.is_multiple_of(3) { lanes(91) } else { Spectrum::BLACK },
            sheen_greatest: share(92),
            sheen_roughness: share(93),
            iridescence: if trial.is_multiple_of(5) { share(94) } else { 0.0 },
            film: principled::film::ThinFilm {
                eta: size(95),
                thickness: size(96),
                wavelengths: trial.is_multiple_of(2).then_some([450.0, 500.0, 600.0, 700.0]),
            },
            ..principled::Principled::default()
        };
        let open_pbr = look.with_model(principled::open_pbr::OpenPbr {
            specular_color: lanes(110),
            specular_weight: share(111),
            transmission_color: lanes(112),
            diffuse_roughness: share(113),
            coat_color: lanes(114),
            coat_eta: size(115),
            coat_f0: 0.0,
            coat_f90: share(116),
            coat_tangent: direction(117, trial).into(),
            coat_darkening: share(118),
            darkened: grey(1.0),
        });
        let flat = |w: Vec3, every: u64| match trial.is_multiple_of(every) {
            true => w.with_z(0.0).normalize_or(Vec3::X),
            false => w,
        };
        let (wo, wi) = (flat(direction(50, trial), 17), flat(direction(60, trial), 5));
        let flake = disney::Disney {
            base: lanes(120).map(|lane| lane.min(1.0)),
            tint: grey(1.0),
            roughness: share(121),
            aspect: 1.0 - 0.7 * share(122),
            eta: disney::Disney::valid_eta(1.0 + size(123).min(1.0)),
            spec_tint: share(124),
            spec_trans: share(125),
            sheen: share(126),
            sheen_tint: share(127),
            flatness: share(128),
            is_thin: trial.is_multiple_of(3),
            metallic: share(129),
            clearcoat: share(130),
            clearcoat_alpha: 1e-3 + 0.099 * share(131),
            diff_trans: share(132),
        };
        let [white, cloudy] = [lanes(73), lanes(35)].map(|light| light.map(|lane| lane.min(1.0)));
        let (uc, u) = numbers(70, trial);
        let u = if trial.is_multiple_of(5) { [0.0, u[1]] } else { u };
        let mut bsdfs = vec![
            Bsdf::diffuse(lanes(71)),
            Bsdf::diffuse_transmission(lanes(71), lanes(72)),
            Bsdf::conductor(lanes(73), lanes(74), of_any_kind(trial, roughness)),
            Bsdf::dielectric(size(75), of_any_kind(trial, roughness)),
            Bsdf::dielectric(1.0 + any_size(76, trial, 24).min(1.0), roughness),
            Bsdf::conductor(lanes(73), lanes(74), roughness).with_energy(Energy::Conserved),
            Bsdf::dielectric(size(75), of_any_kind(trial, roughness)).with_energy(Energy::Conserved),
            Bsdf::thin_dielectric(size(75)),
            Bsdf::Hair(hair::Hair::new(
                2.0 * number(134, trial) - 1.0,
                1.55,
                lanes(135),
                [share(136), share(137)],
                2.0,
            )),
            Bsdf::Disney(flake),
            stained(size(75), of_any_kind(trial, roughness)),
            Bsdf::coated_diffuse(lanes(71), &coat),
            Bsdf::coated_conductor(lanes(73), lanes(74), roughness, &coat),
            Bsdf::Whitted(whitted),
            Bsdf::Principled(look.clamped()),
            Bsdf::OpenPbr(open_pbr::OpenPbrSurface::new(&open_pbr)),
        ];
        // Others are slow to make, or to evaluate.
        if trial.is_multiple_of(20) {
            let facets = of_any_kind(trial / 20, roughness);
            let interface = plastic::Interface::kept(1.0 + size(133).min(1.0), facets);
            let is_nonlinear = trial.is_multiple_of(40);
            bsdfs.extend([
                Bsdf::Plastic(plastic::Plastic::new(white, cloudy, is_nonlinear, interface)),
                Bsdf::NormalizedFresnel(NormalizedFresnel::new(size(138))),
                adaptive,
                half_angle,
            ]);
        }
        for bsdf in bsdfs {
            let good = |x: f32| x.is_finite() && x >= 0.0;
            let sample = bsdf.sample(wo, uc, u);
            let towards = sample.map_or(wi, |sample| sample.wi);
            assert!(towards.is_finite(), "{bsdf:?} {wo} {sample:?}");
            for wi in [wi, towards, -wo, Vec3::new(-wo.x, -wo.y, wo.z)] {
                let (f, pdf) = (bsdf.f(wo, wi), bsdf.pdf(wo, wi));
                if !(f.0.into_iter().all(good) && good(pdf)) {
                    let kind = bsdf.description().kind;
                    failures
                        .entry(kind)
                        .or_insert_with(|| format!("{bsdf:?} {wo:?} {wi:?}: f = {f:?}, pdf = {pdf}"));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn a_bsdf_is_small() {
    assert!(size_of::<Bsdf>() <= 192, "{}", size_of::<Bsdf>());
}
