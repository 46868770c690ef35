//! Tests of OpenPBR's surface: the specification's formulas at single points, energy, precision. Densities and reciprocity are
//! tested with all others.

use lookfrom_scene::material::OpenPbr as Written;

use super::*;
use crate::shading::bsdf::principled::open_pbr::{
    base_reflectance, grazing_reflectance, index_of_reflectance, mean_reflectance, modulated_index,
    reflectance, roughness_below,
};
use crate::shading::bsdf::principled::{Gltf, Model};
use crate::shading::bsdf::tests::{direction, number, numbers, weight_of_energy};
use crate::shading::bsdf::{Bsdf, fresnel};

type Layers = Principled<f32, OpenPbr>;

fn grey(value: f32) -> Spectrum {
    Spectrum([value; 4])
}

fn rough(alpha: f32) -> TrowbridgeReitz {
    TrowbridgeReitz::new(alpha, alpha)
}

fn of(layers: Layers) -> Bsdf {
    Bsdf::OpenPbr(OpenPbrSurface::new(&layers))
}

/// A base of a colour and a roughness.
fn base(color: Spectrum, roughness: f32) -> Layers {
    let glass = reflectance(1.5);
    Principled {
        base_color: color,
        roughness: rough(roughness * roughness),
        f0: grey(glass),
        ..Principled::default()
    }
    .with_model(OpenPbr::default())
}

/// Layers with another model's parameters.
fn with(layers: Layers, change: impl Fn(&mut OpenPbr)) -> Layers {
    let mut layers = layers;
    change(&mut layers.model);
    layers
}

/// BSDFs for the tests of densities.
pub(in crate::shading::bsdf) fn subjects() -> Vec<(&'static str, Bsdf)> {
    let paint = base(Spectrum([0.8, 0.5, 0.2, 0.3]), 0.5);
    let tint = Spectrum([0.3, 0.6, 0.9, 0.5]);
    let coat = Principled { clearcoat: 0.9, clearcoat_roughness: rough(0.1), ..paint };
    let fuzzy = Principled { sheen_color: tint, sheen_greatest: 0.9, sheen_roughness: 0.4, ..paint };
    vec![
        ("openpbr rough diffuse", of(with(paint, |open| open.diffuse_roughness = 0.8))),
        (
            "openpbr tinted metal",
            of(with(Principled { metallic: 1.0, ..paint }, |open| {
                (open.specular_color, open.specular_weight) = (tint, 0.8);
            })),
        ),
        (
            "openpbr brushed coat",
            of(with(Principled { clearcoat_roughness: TrowbridgeReitz::new(0.3, 0.06), ..coat }, |open| {
                (open.coat_color, open.coat_darkening) = (tint, 0.0);
                open.coat_tangent = Vector { x: 0.6, y: 0.8, z: 0.1 };
            })),
        ),
        ("openpbr darkened smooth coat", of(Principled { clearcoat_roughness: rough(0.0), ..coat })),
        ("openpbr fuzz", of(fuzzy)),
        (
            "openpbr fuzz on a darkened, tilted coat",
            of(with(
                Principled {
                    clearcoat: 0.8,
                    clearcoat_roughness: rough(0.2),
                    clearcoat_normal: direction(15.0, 40.0).into(),
                    metallic: 0.3,
                    ..fuzzy
                },
                |open| (open.coat_color, open.diffuse_roughness) = (tint, 0.4),
            )),
        ),
        (
            "openpbr thin wall",
            of(with(
                Principled {
                    diffuse_transmission: 0.4,
                    diffuse_transmission_color: tint,
                    transmission: 0.3,
                    ..paint
                },
                |open| (open.transmission_color, open.diffuse_roughness) = (tint, 0.7),
            )),
        ),
        (
            "openpbr body",
            of(with(Principled { transmission: 1.0, is_solid: true, ..paint }, |open| {
                open.transmission_color = tint;
            })),
        ),
    ]
}

/// The albedo: the mean weight of the samples, with its standard error.
fn albedo(bsdf: &Bsdf, wo: Vec3) -> (f64, f64) {
    const N: u64 = 20_000;
    let (mut sum, mut squares) = (0.0, 0.0);
    for index in 0..N {
        let (uc, u) = numbers(31, index);
        let uc = (index as f32 + uc) / N as f32;
        if let Some(s) = bsdf.sample(wo, uc, u) {
            let weight = f64::from(weight_of_energy(bsdf, wo, &s).0[1]);
            sum += weight;
            squares += weight * weight;
        }
    }
    let mean = sum / N as f64;
    (mean, ((squares / N as f64 - mean * mean).max(0.0) / N as f64).sqrt())
}

#[test]
fn white_stays_white_in_a_furnace() {
    let mut faults = Vec::new();
    let white = |roughness| base(grey(1.0), roughness);
    let matte = |roughness: f32| {
        let plain = Principled { f0: grey(0.0), f0_greatest: 0.0, f90: 0.0, ..white(0.3) };
        with(plain, |open| open.diffuse_roughness = roughness)
    };
    for step in [0.0, 0.3, 0.6, 1.0_f32] {
        for (name, layers, bound) in [
            ("matte", matte(step), 0.003),
            ("rough diffuse", with(white(0.3), |open| open.diffuse_roughness = step), 0.012),
            ("plastic", white(step), 0.005),
            ("metal", Principled { metallic: 1.0, ..white(step) }, 0.005),
            (
                "fuzz",
                Principled {
                    sheen_color: grey(1.0),
                    sheen_greatest: 1.0,
                    sheen_roughness: step,
                    ..white(0.5)
                },
                0.005,
            ),
        ] {
            let bsdf = of(layers);
            for angle in [0.0, 30.0, 55.0, 70.0, 80.0, 86.0] {
                let (mean, error) = albedo(&bsdf, direction(angle, 20.0));
                if !((mean - 1.0).abs() < bound + 4.0 * error) {
                    faults.push(format!("{name} {step}, {angle}°: {mean:.4} ± {error:.4}"));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn nothing_gives_more_than_it_gets() {
    let mut faults = Vec::new();
    for trial in 0..60 {
        let any = |k: u64| number(200 + k, trial);
        let often = |k: u64| if any(k) < 0.5 { 0.0 } else { any(k + 20) };
        let lanes = |k: u64| Spectrum([any(k), 1.0, any(k + 1), any(k + 2)]);
        let eta = 1.0 + 1.5 * any(1);
        let coat_eta = 1.0 + any(2);
        let f0 = base_reflectance(eta, 0.0, 1.6, 1.0);
        let layers = Principled {
            base_color: lanes(3),
            metallic: often(6),
            eta,
            f0: grey(f0),
            f0_greatest: f0,
            f90: grazing_reflectance(eta),
            transmission: often(9),
            is_solid: any(10) < 0.5,
            diffuse_transmission: often(11),
            diffuse_transmission_color: lanes(12),
            clearcoat: often(15),
            clearcoat_roughness: rough(any(16) * any(16)),
            sheen_color: lanes(40) * often(17),
            sheen_greatest: often(17),
            sheen_roughness: any(18),
            ..base(grey(1.0), any(7))
        };
        let bsdf = of(with(layers, |open| {
            *open = OpenPbr {
                specular_color: lanes(50),
                specular_weight: 1.0,
                transmission_color: lanes(53),
                diffuse_roughness: often(56),
                coat_color: lanes(57),
                coat_eta,
                coat_f90: grazing_reflectance(coat_eta),
                coat_darkening: often(61),
                ..OpenPbr::default()
            };
        }));
        for angle in [0.0, 60.0, 83.0, 120.0] {
            let (mean, error) = albedo(&bsdf, direction(angle, 70.0));
            if !(mean < 1.012 + 4.0 * error) {
                faults.push(format!("{trial} {angle}°: {mean:.4} ± {error:.4}: {layers:?}"));
            }
        }
    }
    assert!(faults.is_empty(), "{} faults\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn anisotropy_keeps_the_mean_square_of_slopes() {
    for (roughness, anisotropy) in [(0.3, 0.0), (0.5, 0.5), (0.8, 0.9), (1.0, 1.0_f32)] {
        let [along, across] = Written::alphas(roughness, anisotropy);
        assert!((across - (1.0 - anisotropy) * along).abs() < 1e-6);
        let alpha = roughness * roughness;
        assert!((along * along + across * across - 2.0 * alpha * alpha).abs() < 1e-6, "{along} {across}");
    }
    // √(2 / 1.25) r² by hand.
    assert!((Written::alphas(0.5, 0.5)[0] - 0.316_228).abs() < 1e-5);
}

#[test]
fn a_metal_has_its_tint_at_82_degrees() {
    let f0 = Spectrum([0.9, 0.7, 0.3, 0.0]);
    let tint = Spectrum([1.0, 0.5, 0.8, 0.0]);
    let open = OpenPbr { specular_color: tint, ..OpenPbr::default() };
    let at = |cos: f32| {
        let schlick = f0.map(|lane| lane + (1.0 - lane) * (1.0 - cos).powi(5));
        (open.tinted_metal(cos, f0, schlick), schlick)
    };
    let (edge, schlick) = at(1.0 / 7.0);
    for lane in 0..4 {
        assert!((edge.0[lane] - tint.0[lane] * schlick.0[lane]).abs() < 1e-5, "{edge:?} {schlick:?}");
    }
    // Neither end is tinted.
    for cos in [0.0, 1.0] {
        let (tinted, schlick) = at(cos);
        assert!((0..4).all(|lane| (tinted.0[lane] - schlick.0[lane]).abs() < 1e-6));
    }
    // The mean is that of the curve, where it is not below 0.
    let open = OpenPbr { specular_color: grey(0.6), ..open };
    let f0 = Spectrum([0.9, 0.7, 0.5, 0.95]);
    let mut sum = [0.0_f64; 4];
    for k in 0..4000 {
        let cos = (k as f32 + 0.5) / 4000.0;
        let schlick = f0.map(|lane| lane + (1.0 - lane) * (1.0 - cos).powi(5));
        let tinted = open.tinted_metal(cos, f0, schlick);
        (0..4).for_each(|lane| sum[lane] += f64::from(2.0 * cos * tinted.0[lane] / 4000.0));
    }
    let mean = open.mean_of_metal(f0);
    assert!((0..4).all(|lane| (f64::from(mean.0[lane]) - sum[lane]).abs() < 1e-4), "{mean:?} {sum:?}");
}

#[test]
fn reflectances_are_those_of_the_formulas() {
    for eta in [1.05, 1.3, 1.5, 2.0, 3.5_f32] {
        let mean: f64 = (0..20_000)
            .map(|k| (f64::from(k) + 0.5) / 20_000.0)
            .map(|cos| 2.0 * cos * f64::from(fresnel::dielectric(cos as f32, eta)) / 20_000.0)
            .sum();
        assert!((f64::from(mean_reflectance(eta)) - mean).abs() < 2e-5, "{eta}: {mean}");
        let [f0, f90] = [reflectance(eta), grazing_reflectance(eta)];
        assert!((f64::from(f0 + (f90 - f0) / 21.0) - mean).abs() < 1e-4 || f90 == 1.0, "{eta}");
        assert!((index_of_reflectance(f0) - eta).abs() < 1e-4);
        // Half the reflectance is that of a lower index.
        let lower = modulated_index(eta, 0.5);
        assert!((reflectance(lower) - 0.5 * f0).abs() < 1e-6);
    }
    assert!((modulated_index(1.5, 0.0) - 1.0).abs() < 1e-6);
    // η_s = lerp(1.5, 1.5 / 1.6, ½) = 1.21875.
    assert!((base_reflectance(1.5, 0.5, 1.6, 1.0) - (0.21875_f32 / 2.21875).powi(2)).abs() < 1e-7);
    assert_eq!(base_reflectance(1.5, 0.0, 1.6, 1e6), 1.0);
    // (0.3⁴ + 2 · 0.5⁴)^¼ by hand, and half way to it.
    assert!((roughness_below(1.0, 0.5, 0.3) - 0.603_95).abs() < 1e-4);
    assert!((roughness_below(0.5, 0.5, 0.3) - 0.451_98).abs() < 1e-4);
    assert_eq!(roughness_below(1.0, 1.0, 0.5), 1.0);
}

#[test]
fn a_coat_darkens_by_the_light_that_returns() {
    let eta = 1.5;
    let open = OpenPbr {
        coat_eta: eta,
        coat_f0: reflectance(eta),
        coat_f90: grazing_reflectance(eta),
        coat_darkening: 1.0,
        ..OpenPbr::default()
    };
    let at = |layers: Layers| OpenPbr::seen(&layers, Vector { x: 0.0, y: 0.0, z: 1.0 }).darkened.0[0];
    // A matte base of albedo ½ without a mirror: K = 1 − (1 − 0.0918) / 2.25 = 0.5963 and (1 − K) / (1 − K / 2) = 0.5752; Schlick's mean
    // is a little less.
    let matte = Principled {
        base_color: grey(0.5),
        f0: grey(0.0),
        f0_greatest: 0.0,
        f90: 0.0,
        clearcoat: 1.0,
        ..base(grey(0.5), 0.3)
    };
    let matte = Layers { model: open, ..matte };
    assert!((at(matte) - 0.5752).abs() < 4e-3, "{}", at(matte));
    // Half a coat, half the darkening.
    let half = with(Principled { clearcoat: 0.5, ..matte }, |open| open.coat_darkening = 0.5);
    assert!((at(half) - (1.0 + 0.25 * (at(matte) - 1.0))).abs() < 1e-6);
    assert_eq!(at(with(matte, |open| open.coat_darkening = 0.0)), 1.0);
    // A smooth metal: K is the coat's reflectance along ω_o.
    let metal = Principled { metallic: 1.0, roughness: TrowbridgeReitz::SMOOTH, ..matte };
    assert!((at(metal) - 0.96 / 0.98).abs() < 1e-4, "{}", at(metal));
    // White stays white.
    let white = Principled { base_color: grey(1.0), ..matte };
    assert!((at(white) - 1.0).abs() < 1e-3);
}

#[test]
fn a_coloured_coat_has_its_colour_at_normal_incidence() {
    let tint = Spectrum([0.2, 0.5, 0.9, 1.0]);
    let open = OpenPbr { coat_color: tint, coat_eta: 1.6, ..OpenPbr::default() };
    let straight = open.coat_transmittance([1.0, 1.0], true);
    assert!((0..4).all(|lane| (straight.0[lane] - tint.0[lane]).abs() < 1e-5), "{straight:?}");
    // 60°: a way of 1 / √(1 − ¾ / 2.56) each.
    let oblique = open.coat_transmittance([0.5, 0.5], true).0[1];
    assert!((oblique - 0.5_f32.powf(1.0 / (1.0 - 0.75 / 2.56_f32).sqrt())).abs() < 1e-5, "{oblique}");
}

#[test]
fn layers_are_gltfs_where_nothing_is_added() {
    // OpenPBR with its additions off is glTF's surface, but for the sixteen bits.
    let plain = Principled {
        base_color: Spectrum([0.8, 0.5, 0.25, 0.3]),
        metallic: 0.25,
        transmission: 0.5,
        roughness: rough(0.2),
        ..Principled::default()
    };
    let tinted = OpenPbr { transmission_color: plain.base_color, ..OpenPbr::default() };
    let [gltf, ours] = [Bsdf::Principled(plain.clamped()), of(plain.with_model(tinted))];
    let mut lit = 0;
    for index in 0..2000 {
        let direction = |k| crate::core::warp::uniform_sphere([number(k, index), number(k + 1, index)]);
        let (wo, wi) = (direction(60), direction(62));
        let [a, b] = [&gltf, &ours].map(|bsdf| bsdf.f(wo, wi).0[0]);
        assert!((a - b).abs() <= 1e-3 * a.max(b), "{wo} {wi}: {a} {b}");
        lit += u32::from(a > 0.0);
    }
    assert!(lit > 1500, "{lit}");
    let _: Gltf = plain.model;
}

#[test]
fn shares_are_precise() {
    for value in [0.0, 1.0, 0.5, 0.25, 0.75] {
        assert_eq!(f32::from(Share::from(value)), value);
    }
    for trial in 0..4000 {
        let value = number(70, trial) * 2.0_f32.powi(-((trial % 28) as i32));
        let kept = f32::from(Share::from(value));
        assert!((kept - value).abs() <= value / 4096.0 + 1e-9, "{value} {kept}");
    }
    assert_eq!([f32::NAN, -1.0, 1e-30, 2.0].map(|x| f32::from(Share::from(x))), [0.0, 0.0, 0.0, 1.0]);
    // As much as there is before the mark of variants in the largest BSDF.
    assert!(size_of::<OpenPbrSurface>() <= 148, "{}", size_of::<OpenPbrSurface>());
}
