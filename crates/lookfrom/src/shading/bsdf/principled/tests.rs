//! Tests of the principled BSDF: energy and limits. Densities and reciprocity are tested with all others.

use super::*;
use crate::core::color::DenselySampledSpectrum;
use crate::shading::bsdf::BsdfSample;
use crate::shading::bsdf::tests::{direction, number, numbers, weight_of_energy};
use crate::shading::bsdf::{Bsdf, fresnel};

fn grey(value: f32) -> Spectrum {
    Spectrum([value; 4])
}

fn rough(alpha: f32) -> TrowbridgeReitz {
    TrowbridgeReitz::new(alpha, alpha)
}

fn of(parameters: Principled) -> Bsdf {
    Bsdf::Principled(parameters.clamped())
}

impl Principled {
    /// These layers with more of another model.
    pub(in crate::shading::bsdf) fn with_model<M>(self, model: M) -> Principled<f32, M> {
        let Self {
            base_color,
            metallic,
            roughness,
            eta,
            f0,
            f0_greatest,
            f90,
            transmission,
            is_solid,
            diffuse_transmission,
            diffuse_transmission_color,
            clearcoat,
            clearcoat_roughness,
            clearcoat_normal,
            sheen_color,
            sheen_greatest,
            sheen_roughness,
            iridescence,
            film,
            lane_weights,
            model: Gltf,
        } = self;
        Principled {
            base_color,
            metallic,
            roughness,
            eta,
            f0,
            f0_greatest,
            f90,
            transmission,
            is_solid,
            diffuse_transmission,
            diffuse_transmission_color,
            clearcoat,
            clearcoat_roughness,
            clearcoat_normal,
            sheen_color,
            sheen_greatest,
            sheen_roughness,
            iridescence,
            film,
            lane_weights,
            model,
        }
    }
}

/// BSDFs for the tests of densities: every lobe alone as far as possible, and mixtures.
pub(in crate::shading::bsdf) fn subjects() -> Vec<(&'static str, Bsdf)> {
    let base = Principled { base_color: Spectrum([0.8, 0.5, 0.2, 0.3]), ..Principled::default() };
    let glass = Principled { transmission: 1.0, roughness: rough(0.3), ..base };
    let film = ThinFilm { eta: 1.8, thickness: 500.0, wavelengths: None };
    let sheen = Principled {
        sheen_color: Spectrum([0.9, 0.4, 0.2, 0.1]),
        sheen_greatest: 0.9,
        sheen_roughness: 0.5,
        roughness: rough(0.6),
        ..base
    };
    let coat = Principled { clearcoat: 0.9, clearcoat_roughness: rough(0.1), ..base };
    let tilted = direction(15.0, 40.0);
    let all = |name, parameters| (name, of(parameters));
    vec![
        all("principled plastic", Principled { roughness: rough(0.25), ..base }),
        all("principled smooth plastic", base),
        all("principled metal", Principled { metallic: 1.0, roughness: rough(0.4), ..base }),
        all(
            "principled brushed metal",
            Principled { metallic: 1.0, roughness: TrowbridgeReitz::new(0.6, 0.15), ..base },
        ),
        all("principled thin sheet", glass),
        all("principled body", Principled { is_solid: true, ..glass }),
        all("principled body of air", Principled { is_solid: true, eta: 1.0, ..glass }),
        all(
            "principled leaf",
            Principled { diffuse_transmission: 0.6, roughness: rough(0.5), f90: 0.5, f0: grey(0.02), ..base },
        ),
        all("principled velvet", sheen),
        all("principled lacquer", Principled { metallic: 1.0, roughness: rough(0.5), ..coat }),
        all("principled smooth lacquer", Principled { clearcoat_roughness: rough(0.0), ..coat }),
        all(
            "principled tilted lacquer",
            Principled { clearcoat_normal: tilted.into(), roughness: rough(0.4), ..coat },
        ),
        all("principled film", Principled { iridescence: 0.9, film, roughness: rough(0.3), ..base }),
        all(
            "principled everything",
            Principled {
                metallic: 0.3,
                transmission: 0.4,
                is_solid: true,
                diffuse_transmission: 0.3,
                iridescence: 0.5,
                film,
                clearcoat: 0.5,
                clearcoat_roughness: rough(0.2),
                ..sheen
            },
        ),
    ]
}

/// The albedo: the mean weight of the samples, with its standard error.
fn albedo(bsdf: &Bsdf, wo: Vec3, lane: usize) -> (f64, f64) {
    const N: u64 = 20_000;
    let (mut sum, mut squares) = (0.0, 0.0);
    for index in 0..N {
        // Stratified over the choice of lobe.
        let (uc, u) = numbers(29, index);
        let uc = (index as f32 + uc) / N as f32;
        if let Some(s) = bsdf.sample(wo, uc, u) {
            let weight = f64::from(weight_of_energy(bsdf, wo, &s).0[lane]);
            sum += weight;
            squares += weight * weight;
        }
    }
    let mean = sum / N as f64;
    (mean, ((squares / N as f64 - mean * mean).max(0.0) / N as f64).sqrt())
}

const ANGLES: [f32; 6] = [0.0, 30.0, 55.0, 70.0, 80.0, 86.0];

#[test]
fn white_stays_white_in_a_furnace() {
    let mut faults = Vec::new();
    for roughness in [0.0, 0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1.0_f32] {
        let white = Principled { roughness: rough(roughness * roughness), ..Principled::default() };
        let white_mirror = Principled { f0: grey(0.3), f0_greatest: 0.3, ..white };
        for (name, parameters) in [
            ("plastic", white),
            ("strong plastic", white_mirror),
            ("metal", Principled { metallic: 1.0, ..white }),
            ("half metal", Principled { metallic: 0.5, ..white }),
            ("sheet", Principled { transmission: 1.0, ..white }),
            ("leaf", Principled { diffuse_transmission: 0.4, ..white }),
        ] {
            let bsdf = of(parameters);
            for angle in ANGLES {
                let (mean, error) = albedo(&bsdf, direction(angle, 20.0), 0);
                if !((mean - 1.0).abs() < 0.005 + 3.0 * error) {
                    faults.push(format!("{name}, roughness {roughness}, {angle}°: {mean:.4} ± {error:.4}"));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn bodies_of_white_glass_keep_all_light() {
    let mut faults = Vec::new();
    for roughness in [0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1.0_f32] {
        for eta in [0.5, 0.9, 1.01, 1.1, 1.33, 1.5, 2.0_f32] {
            let straight = ((eta - 1.0) / (eta + 1.0)).powi(2);
            let glass = Principled {
                eta,
                f0: grey(straight),
                f0_greatest: straight,
                transmission: 1.0,
                is_solid: true,
                roughness: rough(roughness * roughness),
                ..Principled::default()
            };
            for (name, parameters) in [
                ("glass", glass),
                ("brushed", Principled { roughness: TrowbridgeReitz::new(0.1, 0.8), ..glass }),
                ("without a mirror", Principled { f0: grey(0.0), f0_greatest: 0.0, f90: 0.0, ..glass }),
            ] {
                let bsdf = of(parameters);
                for angle in ANGLES.into_iter().flat_map(|angle| [angle, 180.0 - angle]) {
                    for index in 0..100 {
                        // Not only in the mean: for every sample.
                        let (uc, u) = numbers(37, index);
                        let wo = direction(angle, 20.0);
                        let sample = bsdf.sample(wo, uc, u);
                        let weight = sample.map_or(0.0, |s| weight_of_energy(&bsdf, wo, &s).0[0]);
                        if !((weight - 1.0).abs() < 1e-3) {
                            faults.push(format!(
                                "{name}, roughness {roughness}, index {eta}, {angle}°: {weight} {sample:?}"
                            ));
                        }
                    }
                }
            }
        }
    }
    assert!(faults.is_empty(), "{} faults\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn nothing_gives_more_than_it_gets() {
    let mut faults = Vec::new();
    for trial in 0..60 {
        let any = |k: u64| number(100 + k, trial);
        let often = |k: u64| if any(k) < 0.5 { 0.0 } else { any(k + 20) };
        let lanes = |k: u64| Spectrum([any(k), 1.0, any(k + 1), any(k + 2)]);
        let alpha = |k: u64| any(k) * any(k);
        let eta = 1.0 + 1.5 * any(1);
        let straight = ((eta - 1.0) / (eta + 1.0)).powi(2);
        let is_drawn_out = any(2) < 0.3;
        let parameters = Principled {
            base_color: lanes(3),
            metallic: often(6),
            roughness: TrowbridgeReitz::new(alpha(7), alpha(if is_drawn_out { 8 } else { 7 })),
            eta,
            f0: grey(straight),
            f0_greatest: straight,
            transmission: often(9),
            is_solid: any(10) < 0.5,
            diffuse_transmission: often(11),
            diffuse_transmission_color: lanes(12),
            clearcoat: often(15),
            clearcoat_roughness: rough(alpha(16)),
            sheen_color: lanes(40) * 0.999,
            sheen_greatest: if any(17) < 0.5 { 0.999 } else { 1.0 },
            sheen_roughness: any(18),
            iridescence: often(19),
            film: ThinFilm { eta: 1.0 + any(60), thickness: 1000.0 * any(61), wavelengths: None },
            ..Principled::default()
        };
        let bare = Principled { sheen_color: Spectrum::BLACK, sheen_greatest: 0.0, ..parameters };
        for parameters in [parameters, bare] {
            let bsdf = of(parameters);
            for angle in [0.0, 60.0, 83.0, 120.0] {
                let (mean, error) = albedo(&bsdf, direction(angle, 70.0), 1);
                // The albedo of a film over rough facets is taken from one facet, that of anisotropic facets from
                // isotropic ones.
                let guess = if is_drawn_out || parameters.iridescence > 0.0 { 0.02 } else { 0.005 };
                if !(mean < 1.0 + guess + 4.0 * error) {
                    faults.push(format!("{trial} {angle}°: {mean:.4} ± {error:.4}: {parameters:?}"));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{} faults\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn limits_are_what_is_there_already() {
    let close = |a: f32, b: f32, bound: f32| (a - b).abs() <= bound * b.abs().max(1e-2);
    let mut near = (0, 0);
    for alpha in [0.0, 0.2] {
        let glass = of(Principled {
            transmission: 1.0,
            is_solid: true,
            roughness: rough(alpha),
            ..Principled::default()
        });
        let pbrt = Bsdf::dielectric(1.5, rough(alpha));
        for (k, angle) in [0.0, 40.0, 75.0, 110.0, 140.0, 175.0].into_iter().enumerate() {
            let wo = direction(angle, 30.0);
            for index in 0..200 {
                let (uc, u) = numbers(k as u64, index);
                let [ours, theirs] = [&glass, &pbrt].map(|bsdf| bsdf.sample(wo, uc, u));
                let (Some(ours), Some(theirs)) = (ours, theirs) else {
                    // From inside, a rough one maps random numbers to facet normals in another order.
                    assert!(
                        alpha > 0.0 || ours.is_some() == theirs.is_some(),
                        "{angle}: {ours:?} {theirs:?}"
                    );
                    continue;
                };
                if ours.lobe != theirs.lobe {
                    // On the boundary between the two sides.
                    assert!((uc - theirs.pdf).abs() < 1e-3 || alpha > 0.0);
                    continue;
                }
                assert!(close(ours.eta, theirs.eta, 1e-5));
                if !ours.lobe.is_specular() {
                    // Except for the light that pbrt's facets mask, and what they send to the wrong side.
                    let seen = rough(alpha).g(wo.into(), theirs.wi.into()) / rough(alpha).g1(wo.into());
                    let [f, pbrts] = [&glass, &pbrt].map(|bsdf| bsdf.f(wo, theirs.wi).0[0]);
                    assert!(f * seen > 0.998 * pbrts, "{angle}: {f} {pbrts}");
                    near.0 += u32::from(close(f * seen, pbrts, 5e-3));
                    let [pdf, pbrts] = [&glass, &pbrt].map(|bsdf| bsdf.pdf(wo, theirs.wi));
                    assert!(pdf > 0.998 * pbrts, "{angle}: {pdf} {pbrts}");
                    near.1 += 1;
                    continue;
                }
                assert!((ours.wi - theirs.wi).length() < 1e-4);
                let weight = |s: &BsdfSample| s.f.0[0] * s.wi.z.abs() / s.pdf;
                assert!(close(weight(&ours), weight(&theirs), 1e-3), "{angle}: {ours:?} {theirs:?}");
                assert!(close(ours.pdf, theirs.pdf, 2e-3), "{angle}: {ours:?} {theirs:?}");
            }
        }
    }
    assert!(near.1 > 400 && near.0 * 10 > near.1 * 9, "{near:?}");
    // A metal with Schlick's approximation is close to one of the same reflectance, within the
    // approximation's error.
    let reflectance = Spectrum([0.9, 0.6, 0.3, 0.5]);
    let metal = of(Principled {
        metallic: 1.0,
        base_color: reflectance,
        roughness: rough(0.1),
        ..Principled::default()
    });
    let pbrt = Bsdf::conductor_of_reflectance(reflectance, rough(0.1));
    for (wo, wi) in
        [(direction(10.0, 0.0), direction(12.0, 170.0)), (direction(35.0, 0.0), direction(30.0, 175.0))]
    {
        let [ours, theirs] = [&metal, &pbrt].map(|bsdf| bsdf.f(wo, wi));
        for lane in 0..4 {
            assert!(close(ours.0[lane], theirs.0[lane], 0.02), "{ours:?} {theirs:?}");
        }
        let [ours, theirs] = [&metal, &pbrt].map(|bsdf| bsdf.pdf(wo, wi));
        assert!(close(ours, theirs, 0.02), "{ours} {theirs}");
    }
    // A diffuse body without specular reflection is Lambertian.
    let matte = of(Principled {
        base_color: reflectance,
        f0: Spectrum::BLACK,
        f0_greatest: 0.0,
        f90: 0.0,
        roughness: rough(0.5),
        ..Principled::default()
    });
    let lambert = Bsdf::diffuse(reflectance);
    for (wo, wi) in
        [(direction(10.0, 0.0), direction(60.0, 130.0)), (direction(80.0, 0.0), direction(30.0, 10.0))]
    {
        let [ours, theirs] = [&matte, &lambert].map(|bsdf| bsdf.f(wo, wi).0[1]);
        assert!(close(ours, theirs, 1e-3), "{ours} {theirs}");
    }
}

#[test]
fn a_film_is_airys_sum_and_the_eye_sees_its_integral() {
    for (eta, f0) in [(1.3_f32, 0.04_f32), (1.8, 0.04), (1.33, 0.6), (2.2, 0.9)] {
        for thickness in [0.0, 150.0, 420.0, 900.0] {
            for cos in [1.0, 0.7, 0.3_f32] {
                // Ray by ray: the first reflection, and all that leave after more round trips, as
                // complex amplitudes.
                let airy = |nm: f64| {
                    let eta = if thickness > 0.0 { f64::from(eta) } else { 1.0 };
                    let schlick = |f0: f64, cos: f64| f0 + (1.0 - f0) * (1.0 - cos).powi(5);
                    let straight = |a: f64, b: f64| ((a - b) / (a + b)).powi(2);
                    let cos = f64::from(cos);
                    let inside = (1.0 - (1.0 - cos * cos) / (eta * eta)).sqrt();
                    let root = (f64::from(f0) + 1e-4).sqrt();
                    let base = (1.0 + root) / (1.0 - root);
                    let upper = schlick(straight(eta, 1.0), cos).sqrt();
                    // Amplitudes: negative at a boundary to a denser side.
                    let below =
                        schlick(straight(base, eta), inside).sqrt() * if base < eta { 1.0 } else { -1.0 };
                    let phase = std::f64::consts::TAU * 2.0 * eta * f64::from(thickness) * inside / nm;
                    let (mut re, mut im) = (-upper, 0.0);
                    let mut amplitude = (1.0 - upper * upper) * below;
                    for round in 1..200 {
                        re += amplitude * (phase * f64::from(round)).cos();
                        im += amplitude * (phase * f64::from(round)).sin();
                        amplitude *= upper * below;
                    }
                    re * re + im * im
                };
                let lambda = [450.0, 520.0, 600.0, 680.0];
                let film = ThinFilm { eta, thickness, wavelengths: Some(lambda) };
                let got = film.fresnel(cos, grey(f0));
                for (got, nm) in got.0.into_iter().zip(lambda) {
                    let expected = airy(f64::from(nm));
                    assert!(
                        (f64::from(got) - expected).abs() < 4e-3,
                        "{eta} {f0} {thickness} {cos} {nm}: {got} {expected}"
                    );
                }
                // In RGB mode: the integral, of an equal-energy illuminant white-balanced.
                let seen = ThinFilm { wavelengths: None, ..film }.fresnel(cos, grey(f0)).rgb();
                let expected = DenselySampledSpectrum::from_samples(std::array::from_fn(|k| {
                    airy(360.0 + k as f64) as f32
                }))
                .to_rgb_reflectance();
                for (got, expected) in seen.into_iter().zip(expected) {
                    assert!(
                        (got - expected).abs() < 0.12,
                        "{eta} {f0} {thickness} {cos}: {seen:?} {expected}"
                    );
                }
            }
        }
    }
}

/// Schlick's curve at its boundaries, of one index on both sides, is no reason for another picture.
#[test]
fn a_film_of_zero_thickness_is_none() {
    let film = ThinFilm { eta: 1.8, thickness: 0.0, wavelengths: None };
    for body in [
        Principled { metallic: 1.0, base_color: grey(0.5), ..Principled::default() },
        Principled { roughness: rough(0.3), ..Principled::default() },
        Principled { transmission: 1.0, roughness: rough(0.3), is_solid: true, ..Principled::default() },
    ] {
        let plain = of(body);
        let filmed = of(Principled { iridescence: 1.0, film, ..body });
        let (wo, wi) = (direction(70.0, 10.0), direction(60.0, 200.0));
        assert_eq!(filmed.f(wo, wi), plain.f(wo, wi));
        let thin = ThinFilm { thickness: 100.0, ..film };
        let changed = of(Principled { iridescence: 1.0, film: thin, ..body });
        assert_eq!(changed.f(wo, wi) == plain.f(wo, wi), body.roughness == rough(0.0));
        assert_eq!(albedo(&filmed, wo, 0), albedo(&plain, wo, 0));
    }
}

#[test]
fn invalid_parameters_do_no_harm() {
    assert!(size_of::<Principled>() <= 208, "{}", size_of::<Principled>());
    let kept = Principled::default().clamped();
    assert_eq!(kept.base_color, grey(1.0));
    assert!((kept.f0.0[0] - fresnel::dielectric(1.0, 1.5)).abs() < 1e-5);
    let film = ThinFilm { eta: 1.3, thickness: 400.0, wavelengths: Some([400.0, 500.5, 600.0, 780.25]) };
    assert_eq!(Principled { film, ..Principled::default() }.clamped().film, film);
    let nonsense =
        Principled { metallic: f32::NAN, eta: f32::NAN, base_color: grey(f32::NAN), ..Principled::default() };
    let kept = nonsense.clamped();
    assert_eq!((kept.metallic, kept.eta, kept.base_color), (0.0, 0.0, grey(0.0)));
}
