//! Media that fill bodies and space: their coefficients, the same everywhere or by the place, and the points where rays collide
//! with them.

mod cloud;
mod cover;
mod grid;
mod majorants;
mod profile;
mod tracking;
mod varying;
mod way;

use std::sync::Arc;

use glam::DVec3;
use lookfrom_scene::material::Color;
use lookfrom_scene::medium::{Extinction as WrittenExtinction, Medium as Written};
use lookfrom_simd::Real;

pub(crate) use cover::Cover;
pub use profile::Profile;
pub use tracking::{Collision, Tracking};
pub(crate) use tracking::{Estimate, TrackedRay};
pub use varying::Varying;
pub(crate) use way::Way;

use crate::core::spectrum::Spectrum;
use crate::light::EmissionSpectrum;
use crate::shading::bsdf::henyey_greenstein::HenyeyGreenstein;
use crate::shading::bsdf::phase::Phase;
use crate::shading::bsdf::two_lobes::TwoLobes;
use crate::shading::texture::{SpectralMode, SpectrumTexture, SpectrumType, TexturePoint, Textures};

/// A medium.
#[derive(Clone, Debug)]
pub struct Medium {
    /// Extinction coefficient σ_t, per unit of length.
    pub extinction: Extinction,
    /// The distribution of scattered light over directions; `None` in a medium that only absorbs.
    pub phase: Option<Phase>,
    /// The radiance that it emits, times the absorption coefficient, per unit of length.
    pub emission: Option<EmissionSpectrum>,
    /// Factor of both coefficients: ≥ 0.
    pub scale: f32,
    /// Factors of them by the place; `None` in a homogeneous medium.
    pub varying: Option<Arc<Varying>>,
}

/// Extinction coefficient of a medium: [`lookfrom_scene::medium::Extinction`] with spectra.
#[derive(Clone, Copy, Debug)]
pub enum Extinction {
    /// By its parts, σ_a and σ_s.
    Parts {
        /// Absorption coefficient, per unit of length.
        absorption: SpectrumTexture,
        /// Scattering coefficient, per unit of length; `None` where it is 0.
        scattering: Option<SpectrumTexture>,
    },
    /// By their sum.
    Sum {
        /// σ_t, per unit of length.
        sum: SpectrumTexture,
        /// σ_s / σ_t.
        albedo: SpectrumTexture,
    },
}

impl Extinction {
    fn compile(textures: &Textures, written: &Written) -> Self {
        let coefficient = |color| textures.spectrum_texture(color, SpectrumType::Unbounded);
        match written.extinction {
            WrittenExtinction::Parts { absorption, scattering } => Self::Parts {
                absorption: coefficient(absorption),
                scattering: written.scatters().then(|| coefficient(scattering)),
            },
            WrittenExtinction::Sum { sum, albedo } => Self::Sum {
                sum: coefficient(sum),
                albedo: textures.spectrum_texture(albedo, SpectrumType::Albedo),
            },
        }
    }

    /// σ_a and σ_s where the density is 1.
    pub(crate) fn parts(&self, textures: &Textures, mode: &SpectralMode) -> [Spectrum; 2] {
        let value = |of: &SpectrumTexture| textures.spectrum(of, &TexturePoint::NOWHERE, mode);
        match self {
            Self::Parts { absorption, scattering } => {
                [value(absorption), scattering.as_ref().map_or(Spectrum::BLACK, value)]
            }
            Self::Sum { sum, albedo } => {
                let (sum, albedo) = (value(sum), value(albedo));
                [sum * albedo.map(|albedo| 1.0 - albedo), sum * albedo]
            }
        }
    }
}

/// The coefficients of a medium that scatters or emits light, per unit of length.
#[derive(Clone, Copy, Debug, Default)]
pub struct Coefficients<R = f32> {
    /// σ_a.
    pub absorption: Spectrum<R>,
    /// σ_s.
    pub scattering: Spectrum<R>,
    /// The radiance that σ_a is multiplied by.
    pub emission: Spectrum<R>,
}

impl Medium {
    /// A medium that only absorbs.
    pub(crate) fn absorbing(textures: &Textures, absorption: [f32; 3]) -> Self {
        let absorption = textures.spectrum_texture(Color::Value(absorption), SpectrumType::Unbounded);
        let extinction = Extinction::Parts { absorption, scattering: None };
        Self { extinction, phase: None, emission: None, scale: 1.0, varying: None }
    }

    /// As it is written in a scene, whose render space has an origin in the world. A medium without an end is cut off by a box around a
    /// sphere, by its centre in the world and its radius.
    pub(crate) fn compile(
        textures: &Textures,
        written: &Written,
        origin: DVec3,
        around: (DVec3, f64),
    ) -> Self {
        let phase = written.scatters().then(|| match (written.droplets, written.draine) {
            (Some(diameter), _) => Phase::TwoLobes(TwoLobes::of_droplets(diameter)),
            (None, Some(lobe)) if lobe.share > 0.0 => Phase::TwoLobes(TwoLobes::new(written.g, lobe)),
            _ => Phase::HenyeyGreenstein(HenyeyGreenstein::new(written.g)),
        });
        let luminance = match written.emission {
            Color::Curve(curve) => textures.curve(curve).to_xyz()[1],
            Color::Value(_) | Color::Texture(_) => 1.0,
        };
        let emission = written.emits().then(|| EmissionSpectrum {
            color: textures.spectrum_texture(written.emission, SpectrumType::Illuminant),
            scale: if luminance > 0.0 { written.emission_scale / luminance } else { 0.0 },
        });
        let varying = written.variation.as_ref();
        Self {
            extinction: Extinction::compile(textures, written),
            phase,
            emission,
            scale: written.scale,
            varying: varying.map(|varying| Arc::new(Varying::compile(textures, varying, origin, around))),
        }
    }

    /// The coefficients, where the density is 1.
    pub(crate) fn coefficients(&self, textures: &Textures, mode: &SpectralMode) -> Coefficients {
        let [absorption, scattering] = self
            .extinction
            .parts(textures, mode)
            .map(|part| mode.one() * part.map(|sigma| (sigma * self.scale).clamp(0.0, Coefficients::MOST)));
        let emission = self.emission.as_ref().map(|emission| emission.even(textures, mode));
        Coefficients { absorption, scattering, emission: emission.unwrap_or_default() }
    }
}

impl<R: Real> Coefficients<R> {
    /// σ_t = σ_a + σ_s.
    #[inline(always)]
    pub fn extinction(&self) -> Spectrum<R> {
        self.absorption + self.scattering
    }
}

impl Coefficients {
    /// Largest coefficient, above which a way has no length; sums and products of it are finite.
    const MOST: f32 = 1e18;

    /// The majorant where the bound of the density is 1: a little more than σ_t, which interpolation may exceed by rounding.
    fn most(&self) -> f32 {
        const MARGIN: f32 = 1.0 + 1.0 / 65_536.0;
        self.extinction().max_lane() * MARGIN
    }

    /// The radiance that a way of a length adds where it begins: ∫₀ᵈ e^(−σ_t t) σ_a L_e dt.
    pub(crate) fn emitted(&self, length: f32) -> Spectrum {
        let per_length = self.absorption * self.emission;
        let effective_length =
            |sigma: f32| if sigma == 0.0 { 0.0 } else { -libm::expm1f(-sigma * length) / sigma };
        per_length * self.extinction().map(effective_length)
    }
}

#[cfg(test)]
mod tests;
