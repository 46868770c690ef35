//! Eight BSDFs side by side against each on its own, bit for bit.

use glam::Vec3;
use lookfrom_simd::{Kernel, Level, dispatch_wide, is_wide};

use super::*;
use crate::core::hash;
use crate::core::lanes::{gather, scatter, scatter_spectrum};
use crate::shading::bsdf::disney::Disney;
use crate::shading::bsdf::hair::Hair;
use crate::shading::bsdf::layered::{CoatInterior, CoatLayer};
use crate::shading::bsdf::measured::Measured;
use crate::shading::bsdf::normalized_fresnel::NormalizedFresnel;
use crate::shading::bsdf::open_pbr::OpenPbrSurface;
use crate::shading::bsdf::plastic::{Interface, Plastic};
use crate::shading::bsdf::principled::film::ThinFilm;
use crate::shading::bsdf::principled::open_pbr::OpenPbr;
use crate::shading::bsdf::principled::{Gltf, Principled};
use crate::shading::bsdf::tests::{measured, merl, of_any_kind};
use crate::shading::bsdf::thin_dielectric::ThinDielectric;
use crate::shading::bsdf::tinted::{Tint, TintedDielectric};
use crate::shading::bsdf::{Bsdf, BsdfSample};
use lookfrom_scene::material::{CoatEstimate, Energy};

/// Two directions and three numbers.
#[derive(Clone, Copy, Debug)]
struct Query {
    wo: Vec3,
    wi: Vec3,
    uc: f32,
    u: [f32; 2],
}

/// `f`, the density and a sample, as bits.
#[derive(Debug, PartialEq)]
struct Values {
    f: [u32; 4],
    pdf: u32,
    sample: Option<([u32; 9], Lobes)>,
}

/// NaN has any bits.
fn bits(x: f32) -> u32 {
    if x.is_nan() { f32::NAN.to_bits() } else { x.to_bits() }
}

impl Values {
    fn new(f: Spectrum, pdf: f32, sample: Option<BsdfSample>) -> Self {
        let sample = sample.map(|BsdfSample { wi, f, pdf, eta, lobe, .. }| {
            let ([x, y, z], [a, b, c, d]) = (wi.to_array(), f.0);
            ([x, y, z, a, b, c, d, pdf, eta].map(bits), lobe)
        });
        Self { f: f.0.map(bits), pdf: bits(pdf), sample }
    }
}

struct Eight<'a, B>(&'a [&'a B; LANES], &'a [Query; LANES]);

impl<B: RowBsdf> Kernel for Eight<'_, B> {
    type Output = [Values; LANES];

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let bsdf = B::gather(simd, self.0);
        let query = self.1;
        let wo = gather(simd, &by_lane!(lane => query[lane].wo.to_array()));
        let wi = gather(simd, &by_lane!(lane => query[lane].wi.to_array()));
        let load = |values: [f32; LANES]| f32x8::load_array(simd, values);
        let u = [load(by_lane!(lane => query[lane].u[0])), load(by_lane!(lane => query[lane].u[1]))];
        let prepared = bsdf.prepare(wo);
        let sample = bsdf.sample(&prepared, load(by_lane!(lane => query[lane].uc)), u).if_useful();
        let (f, pdf) = (scatter_spectrum(bsdf.f(&prepared, wi)), bsdf.pdf(&prepared, wi));
        let both = bsdf.f_and_pdf(&prepared, wi);
        let both = (scatter_spectrum(both.0), both.1);
        let (sampled_f, sampled_wi) = (scatter_spectrum(sample.f), scatter(sample.wi));
        let mask = |mask: lookfrom_simd::mask32x8<S>, lane: usize| mask.to_bitmask() & 1 << lane != 0;
        let traits = bsdf.traits();
        std::array::from_fn(|lane| {
            let scalar = mask(sample.is_valid, lane).then(|| BsdfSample {
                wi: sampled_wi[lane].into(),
                f: sampled_f[lane],
                pdf: sample.pdf[lane],
                lobe: Lobes::sampled(
                    mask(sample.is_specular, lane),
                    mask(sample.is_diffuse, lane),
                    mask(sample.is_transmission, lane),
                ),
                eta: sample.eta[lane],
                pdf_is_proportional: traits.pdf_is_proportional,
            });
            let values = Values::new(f[lane], pdf[lane], scalar);
            assert_eq!(both.0[lane].0.map(bits), values.f);
            assert!(f[lane].is_black() || bits(both.1[lane]) == values.pdf);
            values
        })
    }
}

/// A number of random exponent within 2^±`size`.
fn any(seed: u64, index: u64, size: i32) -> f32 {
    let bits = hash::pair(seed, index);
    let exponent = (bits % (2 * size as u64 + 1)) as i32 - size;
    (libm::exp2(f64::from(exponent)) * (1.0 + (bits >> 40) as f64 / 16_777_216.0)) as f32
}

fn unit(seed: u64, index: u64) -> f32 {
    (hash::pair(seed, index) >> 40) as f32 / 16_777_216.0
}

/// A direction, often near the axes or the surface, on either side.
fn direction(seed: u64, index: u64) -> Vec3 {
    let component = |k: u64| {
        let sign = if hash::pair(seed + k, index) >> 50 & 1 == 0 { 1.0 } else { -1.0 };
        f64::from(sign * any(seed + k, index, 6))
    };
    glam::DVec3::new(component(1), component(2), component(3)).normalize().as_vec3()
}

fn roughness(seed: u64, index: u64) -> TrowbridgeReitz {
    TrowbridgeReitz::new(any(seed, index, 12), any(seed + 1, index, 12))
}

/// Facets of any kind, and in a quarter of all rounds of one kind.
fn microfacets(seed: u64, index: u64) -> Microfacets {
    let round = index / 8;
    let kind = if round.is_multiple_of(4) { round / 4 } else { hash::pair(seed, index) >> 20 };
    of_any_kind(kind, roughness(seed, index))
}

fn spectrum(seed: u64, index: u64) -> Spectrum {
    Spectrum(std::array::from_fn(|lane| any(seed + lane as u64, index, 4).min(1.0)))
}

fn energy(index: u64) -> Energy {
    if hash::pair(75, index).is_multiple_of(2) { Energy::Conserved } else { Energy::SingleScattering }
}

fn coat(index: u64) -> CoatLayer {
    CoatLayer {
        eta: if index.is_multiple_of(5) { 1.0 } else { any(31, index, 1) },
        roughness: microfacets(33, index),
        thickness: any(35, index, 8),
        albedo: if index.is_multiple_of(3) { spectrum(37, index) } else { Spectrum::BLACK },
        g: 2.0 * unit(41, index) - 1.0,
        max_depth: 1 + (index % 12) as u16,
        samples: 1 + (index % 2) as u16,
        interior: index.is_multiple_of(4).then(|| CoatInterior {
            internal_reflectance: unit(43, index),
            transmission: index
                .is_multiple_of(8)
                .then(|| std::array::from_fn(|k| unit(44 + k as u64, index) - 0.5)),
        }),
        estimate: if index.is_multiple_of(7) { CoatEstimate::Pbrt } else { CoatEstimate::Unbiased },
    }
}

/// Compares eight BSDFs of a class with `Bsdf`'s own answers.
fn compare<B: RowBsdf>(bsdf: impl Fn(u64) -> Bsdf) {
    let level = Level::new();
    if !is_wide(level) {
        return;
    }
    let (mut samples, mut values, mut specular) = (0, 0, true);
    for round in 0..8000 {
        let index = |lane: usize| 8 * round + lane as u64;
        let bsdfs: [Bsdf; LANES] = std::array::from_fn(|lane| bsdf(index(lane)));
        let rows: [&B; LANES] = std::array::from_fn(|lane| B::of(&bsdfs[lane]).unwrap());
        let queries: [Query; LANES] = std::array::from_fn(|lane| {
            let index = index(lane);
            let u = [unit(3, index), unit(4, index)];
            Query { wo: direction(10, index), wi: direction(20, index), uc: unit(5, index), u }
        });
        let values_together = dispatch_wide(level, Eight(&rows, &queries)).unwrap();
        for (lane, together) in values_together.into_iter().enumerate() {
            let Query { wo, wi, uc, u } = queries[lane];
            let bsdf = &bsdfs[lane];
            let alone = Values::new(bsdf.f(wo, wi), bsdf.pdf(wo, wi), bsdf.sample(wo, uc, u));
            assert_eq!(together, alone, "{bsdf:?} {:?}", queries[lane]);
            samples += u32::from(alone.sample.is_some());
            values += u32::from(alone.f != [0; 4]);
            specular &= !bsdf.lobes().is_non_specular();
        }
    }
    let has_values = if specular { values == 0 } else { values > 1000 };
    assert!(samples > 10_000 && has_values, "{samples} samples, {values} values");
}

/// A number of 0 … 1, often one of both.
fn share(seed: u64, index: u64) -> f32 {
    match hash::pair(seed, index) >> 30 & 3 {
        0 => 0.0,
        1 => 1.0,
        2 => unit(seed, index),
        _ => any(seed, index, 12).min(1.0),
    }
}

/// Surfaces with any of the features of glTF's material.
fn principled(index: u64) -> Principled {
    let has = |seed| hash::pair(seed, index).is_multiple_of(3);
    let greatest = |color: Spectrum| color.max_lane();
    let normal = direction(100, index);
    let f0 = spectrum(104, index);
    let sheen_color = if has(108) { spectrum(109, index) } else { Spectrum::BLACK };
    let alpha = any(113, index, 12);
    // Eight are in one mode.
    let is_spectral = (index / 8).is_multiple_of(2);
    let lambda = std::array::from_fn(|k| 380.0 + 400.0 * unit(114 + k as u64, index));
    Principled {
        base_color: spectrum(118, index),
        metallic: share(122, index),
        roughness: if has(123) { TrowbridgeReitz::SMOOTH } else { roughness(124, index) },
        eta: [1.0, 0.0, any(126, index, 3), any(127, index, 1)][(index % 4) as usize],
        f0,
        f0_greatest: greatest(f0),
        f90: share(128, index),
        transmission: share(129, index),
        is_solid: hash::pair(130, index).is_multiple_of(2),
        diffuse_transmission: share(131, index),
        diffuse_transmission_color: spectrum(132, index),
        clearcoat: if has(136) { share(137, index) } else { 0.0 },
        clearcoat_roughness: TrowbridgeReitz::new(alpha, alpha),
        clearcoat_normal: if has(138) { Vec3::Z } else { normal.with_z(normal.z.abs()) }.into(),
        sheen_color,
        sheen_greatest: greatest(sheen_color),
        sheen_roughness: share(139, index),
        iridescence: if has(140) { share(141, index) } else { 0.0 },
        film: ThinFilm {
            eta: 1.0 + any(142, index, 3),
            thickness: any(143, index, 11),
            wavelengths: is_spectral.then_some(lambda),
        },
        lane_weights: spectrum(144, index),
        model: Gltf,
    }
    .clamped()
}

#[test]
fn principled_surfaces_in_lanes() {
    compare::<Principled>(|index| Bsdf::Principled(principled(index)));
}

#[test]
fn openpbr_surfaces_in_lanes() {
    compare::<OpenPbrSurface>(|index| {
        let has = |seed| hash::pair(seed, index).is_multiple_of(3);
        let layers = Principled { clearcoat_roughness: roughness(150, index), ..principled(index) };
        Bsdf::OpenPbr(OpenPbrSurface::new(&layers.with_model(OpenPbr {
            specular_color: if has(152) { spectrum(153, index) } else { Spectrum([1.0; 4]) },
            specular_weight: share(157, index),
            transmission_color: spectrum(158, index),
            diffuse_roughness: if has(162) { share(163, index) } else { 0.0 },
            coat_color: if has(164) { spectrum(165, index) } else { Spectrum([1.0; 4]) },
            coat_eta: 1.0 + any(169, index, 2),
            coat_f90: share(170, index),
            coat_tangent: direction(171, index).into(),
            coat_darkening: share(175, index),
            ..OpenPbr::default()
        })))
    });
}

#[test]
fn diffuse_in_lanes() {
    compare::<Diffuse>(|index| Bsdf::diffuse(spectrum(50, index)));
}

#[test]
fn conductors_in_lanes() {
    compare::<Conductor>(|index| {
        let lanes = |seed| Spectrum(std::array::from_fn(|lane| any(seed + lane as u64, index, 20)));
        let conductor = Conductor::new(lanes(60), lanes(64), microfacets(68, index));
        Bsdf::Conductor(conductor.with_energy(energy(index)).with_specular_reflectance(spectrum(76, index)))
    });
}

#[test]
fn dielectrics_in_lanes() {
    compare::<Dielectric>(|index| {
        let eta = if index.is_multiple_of(7) { 1.0 } else { any(70, index, 3) };
        Bsdf::dielectric(eta, microfacets(71, index)).with_energy(energy(index))
    });
}

#[test]
fn panes_in_lanes() {
    compare::<ThinDielectric>(|index| {
        let eta = if index.is_multiple_of(7) { 1.0 } else { any(70, index, 3) };
        let tint = Tint { reflectance: spectrum(196, index), transmittance: spectrum(226, index) };
        Bsdf::ThinDielectric(ThinDielectric::new(eta).with_tint(tint))
    });
}

#[test]
fn light_that_leaves_media_in_lanes() {
    compare::<NormalizedFresnel>(|index| Bsdf::NormalizedFresnel(NormalizedFresnel::new(any(70, index, 3))));
}

#[test]
fn stained_glass_in_lanes() {
    compare::<TintedDielectric>(|index| {
        let eta = if index.is_multiple_of(7) { 1.0 } else { any(70, index, 3) };
        Bsdf::TintedDielectric(TintedDielectric {
            boundary: Dielectric::new(eta, microfacets(71, index)).with_energy(energy(index)),
            tint: Tint { reflectance: spectrum(196, index), transmittance: spectrum(226, index) },
        })
    });
}

#[test]
fn plastic_in_lanes() {
    let interfaces: Vec<&Interface> = (0..24)
        .map(|k| {
            let alpha = if k < 3 { 0.0 } else { unit(180, k) };
            let facets = of_any_kind(k, TrowbridgeReitz::new(alpha, alpha));
            Interface::kept(if k == 7 { 1.0 } else { any(181, k, 1) }, facets)
        })
        .collect();
    compare::<Plastic>(|index| {
        // Of one kind in some rounds.
        let by = if (index / 8).is_multiple_of(3) { index / 8 } else { hash::pair(182, index) >> 20 };
        let interface = interfaces[by as usize % interfaces.len()];
        let mut plastic = Plastic::new(
            spectrum(183, index),
            if index.is_multiple_of(5) { Spectrum::BLACK } else { spectrum(187, index) },
            hash::pair(191, index).is_multiple_of(2),
            interface,
        );
        if index.is_multiple_of(11) {
            plastic.regularize();
        }
        Bsdf::Plastic(plastic)
    });
}

#[test]
fn measured_materials_in_lanes() {
    let kinds = [measured(1), measured(5), merl()];
    compare::<Measured>(|index| {
        // Of one kind in some rounds; eight are in one mode.
        let round = index / 8;
        let kind = if round.is_multiple_of(3) { round / 3 } else { hash::pair(192, index) >> 20 };
        let Bsdf::Measured(measured) = kinds[kind as usize % kinds.len()] else { panic!("another class") };
        let lambda = std::array::from_fn(|k| 340.0 + 400.0 * unit(193 + k as u64, index));
        Bsdf::Measured(measured.at(round.is_multiple_of(2).then_some(lambda)))
    });
}

#[test]
fn hair_in_lanes() {
    compare::<Hair>(|index| {
        let absorption = spectrum(80, index) * any(84, index, 5);
        let betas = [unit(85, index), unit(86, index)];
        let h = 2.0 * unit(87, index) - 1.0;
        Bsdf::Hair(Hair::new(h, any(88, index, 1), absorption, betas, 20.0 * unit(89, index) - 10.0))
    });
}

#[test]
fn layered_surfaces_in_lanes() {
    compare::<Layered<Diffuse>>(|index| Bsdf::coated_diffuse(spectrum(80, index), &coat(index)));
    compare::<Layered<Conductor>>(|index| {
        let (eta, k) = (spectrum(90, index), spectrum(94, index) * 4.0);
        Bsdf::coated_conductor(eta, k, roughness(98, index), &coat(index))
    });
}

#[test]
fn disneys_surfaces_in_lanes() {
    compare::<Disney>(|index| {
        let has = |seed| hash::pair(seed, index).is_multiple_of(3);
        let is_thin = has(200);
        let of_body = |number: f32| if is_thin { 0.0 } else { number };
        let mut surface = Disney {
            base: spectrum(201, index),
            tint: spectrum(205, index) * any(209, index, 3),
            roughness: share(210, index),
            aspect: 0.3 + 0.7 * unit(211, index),
            eta: Disney::valid_eta(any(212, index, 3)),
            spec_tint: share(213, index),
            spec_trans: share(214, index),
            sheen: if has(215) { any(216, index, 3) } else { 0.0 },
            sheen_tint: share(217, index),
            flatness: share(218, index),
            is_thin,
            metallic: of_body(share(219, index)),
            clearcoat: of_body(if has(220) { share(221, index) } else { 0.0 }),
            clearcoat_alpha: 0.1 - 0.099 * unit(222, index),
            diff_trans: if is_thin { share(223, index) } else { 0.0 },
        };
        if index.is_multiple_of(11) {
            surface.regularize();
        }
        Bsdf::Disney(surface)
    });
}
