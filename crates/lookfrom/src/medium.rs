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
use lookfrom_scene::medium::Medium as Written;
use lookfrom_simd::Real;

pub(crate) use cover::Cover;
pub use profile::Profile;
pub use tracking::{Collision, Tracking};
pub(crate) use tracking::{Estimate, TrackedRay};
pub use varying::Varying;
pub(crate) use way::Way;

use crate::core::spectrum::Spectrum;
use crate::light::EmissionSpectrum;
use crate::shading::bsdf::droplets::Droplets;
use crate::shading::bsdf::henyey_greenstein::HenyeyGreenstein;
use crate::shading::bsdf::phase::Phase;
use crate::shading::texture::{SpectralMode, SpectrumTexture, SpectrumType, TexturePoint, Textures};

/// A medium.
#[derive(Clone, Debug)]
pub struct Medium {
    /// Absorption coefficient, per unit of length.
    pub absorption: SpectrumTexture,
    /// Scattering coefficient and phase function; `None` in a medium that only absorbs.
    pub scattering: Option<Scattering>,
    /// The radiance that it emits, times the absorption coefficient, per unit of length.
    pub emission: Option<EmissionSpectrum>,
    /// Factor of both coefficients: ≥ 0.
    pub scale: f32,
    /// Factors of them by the place; `None` in a homogeneous medium.
    pub varying: Option<Arc<Varying>>,
}

/// Scattering coefficient and phase function of a medium.
#[derive(Clone, Copy, Debug)]
pub struct Scattering {
    /// Scattering coefficient, per unit of length.
    pub coefficient: SpectrumTexture,
    /// Its distribution over directions.
    pub phase: Phase,
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
        Self { absorption, scattering: None, emission: None, scale: 1.0, varying: None }
    }

    /// As it is written in a scene, whose render space has an origin in the world. A medium without an end is cut off by a box around a
    /// sphere, by its centre in the world and its radius.
    pub(crate) fn compile(
        textures: &Textures,
        written: &Written,
        origin: DVec3,
        around: (DVec3, f64),
    ) -> Self {
        let coefficient = |color| textures.spectrum_texture(color, SpectrumType::Unbounded);
        let scattering = written.scatters().then(|| Scattering {
            coefficient: coefficient(written.scattering),
            phase: match written.droplets {
                Some(diameter) => Phase::Droplets(Droplets::new(diameter)),
                None => Phase::HenyeyGreenstein(HenyeyGreenstein::new(written.g)),
            },
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
            absorption: coefficient(written.absorption),
            scattering,
            emission,
            scale: written.scale,
            varying: varying.map(|varying| Arc::new(Varying::compile(textures, varying, origin, around))),
        }
    }

    /// The phase function; `None` where nothing is scattered.
    pub(crate) fn phase(&self) -> Option<Phase> {
        self.scattering.as_ref().map(|scattering| scattering.phase)
    }

    /// The coefficients, where the density is 1.
    pub(crate) fn coefficients(&self, textures: &Textures, mode: &SpectralMode) -> Coefficients {
        let coefficient = |of: &SpectrumTexture| {
            let written = textures.spectrum(of, &TexturePoint::NOWHERE, mode);
            mode.one() * written.map(|sigma| (sigma * self.scale).clamp(0.0, Coefficients::MOST))
        };
        let emission = self.emission.as_ref().map(|emission| emission.even(textures, mode));
        Coefficients {
            absorption: coefficient(&self.absorption),
            scattering: self.scattering.map(|of| coefficient(&of.coefficient)).unwrap_or_default(),
            emission: emission.unwrap_or_default(),
        }
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
