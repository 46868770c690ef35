//! OpenPBR's surface as it is passed from vertex to vertex: small, since every BSDF takes as much memory as the largest.
//!
//! Colours and weights of 0 … 1 are kept in 16 bits, to 2⁻¹² of their value, with 0 and 1 exact.
//! Numbers are made of them where a surface is prepared, or eight are gathered.

use glam::Vec3;

use super::lanes::{ClassTraits, LaneBsdf};
use super::microfacet::TrowbridgeReitz;
use super::principled::film::ThinFilm;
use super::principled::open_pbr::OpenPbr;
use super::principled::{LocalScattering, Principled};
use super::{Description, DirectionSample, Lobes, MicrofacetFactors, ScatteringFunction};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;

/// A number of 0 … 1 as five bits of its exponent and eleven of its fraction; below 2⁻³⁰ it is 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Share(u16);

impl Share {
    /// The bits of an `f32` that are dropped.
    const DROPPED: u32 = 12;
    /// The bits that are kept of the number that 0 stands for.
    const LEAST: u32 = 96 << 11;
}

/// A colour of 0 … 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Tint([Share; 4]);

impl From<f32> for Share {
    /// The nearest share; NaN is 0.
    fn from(number: f32) -> Self {
        let share = if number > 0.0 { number.min(1.0) } else { 0.0 };
        let kept = (share.to_bits() + (1 << (Self::DROPPED - 1))) >> Self::DROPPED;
        Self(kept.saturating_sub(Self::LEAST) as u16)
    }
}

impl From<Share> for f32 {
    #[inline]
    fn from(Share(kept): Share) -> Self {
        match kept {
            0 => 0.0,
            _ => Self::from_bits((u32::from(kept) + Share::LEAST) << Share::DROPPED),
        }
    }
}

impl From<Spectrum> for Tint {
    fn from(Spectrum(lanes): Spectrum) -> Self {
        Self(lanes.map(Share::from))
    }
}

impl From<Tint> for Spectrum {
    #[inline]
    fn from(Tint(lanes): Tint) -> Self {
        Self(lanes.map(f32::from))
    }
}

/// The layers of OpenPBR, by the parameters of [`Principled`] and [`OpenPbr`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenPbrSurface {
    base_color: Tint,
    lane_weights: Tint,
    /// 0 in RGB.
    wavelengths: [f32; 4],
    roughness: TrowbridgeReitz,
    coat_roughness: TrowbridgeReitz,
    eta: f32,
    coat_eta: f32,
    coat_normal: [f32; 2],
    coat_tangent: [f32; 2],
    film_eta: f32,
    film_thickness: f32,
    specular_color: Tint,
    transmission_color: Tint,
    diffuse_transmission_color: Tint,
    coat_color: Tint,
    fuzz_color: Tint,
    metallic: Share,
    specular_weight: Share,
    f0: Share,
    f90: Share,
    transmission: Share,
    diffuse_transmission: Share,
    diffuse_roughness: Share,
    coat: Share,
    coat_f90: Share,
    coat_darkening: Share,
    fuzz: Share,
    fuzz_roughness: Share,
    film: Share,
    is_solid: bool,
}

impl OpenPbrSurface {
    /// From layers, with every parameter clamped to its valid range.
    ///
    /// The reflectance at normal incidence is `f0_greatest` times the specular colour; the weight of fuzz is
    /// `sheen_greatest`.
    pub(crate) fn new(layers: &Principled<f32, OpenPbr>) -> Self {
        let open = &layers.model;
        let plain = layers.clamped();
        let within =
            |number: f32, least: f32, most: f32| if number > least { number.min(most) } else { least };
        let Vector { x, y, z } = plain.clearcoat_normal;
        let coat_normal = if z > 0.0 { [x, y] } else { [0.0; 2] };
        let tangent = [open.coat_tangent.x, open.coat_tangent.y];
        let coat_tangent = if tangent.iter().all(|x| x.is_finite()) { tangent } else { [1.0, 0.0] };
        Self {
            base_color: plain.base_color.into(),
            lane_weights: plain.lane_weights.into(),
            wavelengths: plain.film.wavelengths.unwrap_or_default(),
            roughness: layers.roughness,
            coat_roughness: layers.clearcoat_roughness,
            eta: plain.eta,
            f0: plain.f0_greatest.into(),
            coat_eta: within(open.coat_eta, 1.0, 1e3),
            coat_normal,
            coat_tangent,
            film_eta: plain.film.eta,
            film_thickness: plain.film.thickness,
            specular_color: open.specular_color.into(),
            transmission_color: open.transmission_color.into(),
            diffuse_transmission_color: plain.diffuse_transmission_color.into(),
            coat_color: open.coat_color.into(),
            fuzz_color: plain.sheen_color.into(),
            metallic: plain.metallic.into(),
            specular_weight: open.specular_weight.into(),
            f90: plain.f90.into(),
            transmission: plain.transmission.into(),
            diffuse_transmission: plain.diffuse_transmission.into(),
            diffuse_roughness: open.diffuse_roughness.into(),
            coat: plain.clearcoat.into(),
            coat_f90: open.coat_f90.into(),
            coat_darkening: open.coat_darkening.into(),
            fuzz: plain.sheen_greatest.into(),
            fuzz_roughness: plain.sheen_roughness.into(),
            film: plain.iridescence.into(),
            is_solid: plain.is_solid,
        }
    }

    /// The layers as numbers.
    #[inline]
    pub(crate) fn layers(&self) -> Principled<f32, OpenPbr> {
        let specular_color = Spectrum::from(self.specular_color);
        let f0 = f32::from(self.f0);
        let [x, y] = self.coat_normal;
        let ratio = (self.coat_eta - 1.0) / (self.coat_eta + 1.0);
        Principled {
            base_color: self.base_color.into(),
            metallic: self.metallic.into(),
            roughness: self.roughness,
            eta: self.eta,
            f0: specular_color * f0,
            f0_greatest: f0,
            f90: self.f90.into(),
            transmission: self.transmission.into(),
            is_solid: self.is_solid,
            diffuse_transmission: self.diffuse_transmission.into(),
            diffuse_transmission_color: self.diffuse_transmission_color.into(),
            clearcoat: self.coat.into(),
            clearcoat_roughness: self.coat_roughness,
            clearcoat_normal: Vector { x, y, z: (1.0 - x * x - y * y).max(1e-6).sqrt() },
            sheen_color: self.fuzz_color.into(),
            sheen_greatest: self.fuzz.into(),
            sheen_roughness: self.fuzz_roughness.into(),
            iridescence: self.film.into(),
            film: ThinFilm {
                eta: self.film_eta,
                thickness: self.film_thickness,
                wavelengths: (self.wavelengths != [0.0; 4]).then_some(self.wavelengths),
            },
            lane_weights: self.lane_weights.into(),
            model: OpenPbr {
                specular_color,
                specular_weight: self.specular_weight.into(),
                transmission_color: self.transmission_color.into(),
                diffuse_roughness: self.diffuse_roughness.into(),
                coat_color: self.coat_color.into(),
                coat_eta: self.coat_eta,
                coat_f0: ratio * ratio,
                coat_f90: self.coat_f90.into(),
                coat_tangent: Vector { x: self.coat_tangent[0], y: self.coat_tangent[1], z: 0.0 },
                coat_darkening: self.coat_darkening.into(),
                darkened: Spectrum([1.0; 4]),
            },
        }
    }
}

impl LaneBsdf<f32> for OpenPbrSurface {
    type Prepared = LocalScattering<f32, OpenPbr>;

    fn traits(&self) -> ClassTraits {
        ClassTraits { needs_agreement: true, ..ClassTraits::PLAIN }
    }

    fn prepare(&self, wo: Vector<f32>) -> Self::Prepared {
        self.layers().prepare(wo)
    }

    fn f(&self, prepared: &Self::Prepared, wi: Vector<f32>) -> Spectrum {
        prepared.f(wi)
    }

    fn pdf(&self, prepared: &Self::Prepared, wi: Vector<f32>) -> f32 {
        prepared.pdf(wi)
    }

    fn f_and_pdf(&self, prepared: &Self::Prepared, wi: Vector<f32>) -> (Spectrum, f32) {
        prepared.f_and_pdf(wi)
    }

    fn sample(&self, prepared: &Self::Prepared, uc: f32, u: [f32; 2]) -> DirectionSample<f32> {
        prepared.sample(uc, u)
    }

    fn has_density(&self) -> bool {
        self.layers().has_density()
    }

    fn diffuse_share(&self, prepared: &Self::Prepared, wi: Vector<f32>, f: Spectrum) -> Spectrum {
        prepared.diffuse_f(wi).share_of(f)
    }
}

impl ScatteringFunction for OpenPbrSurface {
    fn lobes(&self) -> Lobes {
        self.layers().lobes()
    }

    fn regularize(&mut self) {
        self.roughness.regularize();
        self.coat_roughness.regularize();
    }

    fn factors(&self, wo: Vec3, wi: Vec3, is_specular: bool) -> Vec<MicrofacetFactors> {
        self.layers().factors(wo, wi, is_specular)
    }

    fn description(&self) -> Description {
        let layers = self.layers();
        let open = &layers.model;
        let mut description = layers.description();
        description.numbers.extend([
            ("specular color", open.specular_color.into()),
            ("transmission color", open.transmission_color.into()),
            ("diffuse roughness", open.diffuse_roughness.into()),
            ("coat color", open.coat_color.into()),
            ("coat eta", open.coat_eta.into()),
        ]);
        description
    }
}

#[cfg(test)]
pub(in crate::shading::bsdf) mod tests;
