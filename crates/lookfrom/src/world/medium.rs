//! Media that fill bodies and space, as rays travel in them. They are the same everywhere.

use lookfrom_scene::material::Color;
use lookfrom_scene::medium::Medium as Written;

use super::World;
use crate::core::spectrum::Spectrum;
use crate::light::EmissionSpectrum;
use crate::shading::bsdf::henyey_greenstein::HenyeyGreenstein;
use crate::shading::interior_stack::InteriorStack;
use crate::shading::texture::{SpectralMode, SpectrumTexture, SpectrumType, TexturePoint, Textures};

/// A homogeneous medium.
#[derive(Clone, Copy, Debug)]
pub struct Medium {
    /// Absorption coefficient, per unit of length.
    pub absorption: SpectrumTexture,
    /// Scattering coefficient and phase function; `None` in a medium that only absorbs.
    pub scattering: Option<Scattering>,
    /// The radiance that it emits, times the absorption coefficient, per unit of length.
    pub emission: Option<EmissionSpectrum>,
    /// Factor of both coefficients: ≥ 0.
    pub scale: f32,
}

/// Scattering coefficient and phase function of a medium.
#[derive(Clone, Copy, Debug)]
pub struct Scattering {
    /// Scattering coefficient, per unit of length.
    pub coefficient: SpectrumTexture,
    /// Its distribution over directions.
    pub phase: HenyeyGreenstein,
}

/// The coefficients of a medium that scatters or emits light, per unit of length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coefficients {
    /// σ_a.
    pub(crate) absorption: Spectrum,
    /// σ_s.
    pub(crate) scattering: Spectrum,
    /// The radiance that σ_a is multiplied by.
    pub(crate) emission: Spectrum,
    /// `None` where nothing is scattered.
    pub(crate) phase: Option<HenyeyGreenstein>,
}

impl Medium {
    /// A medium that only absorbs.
    pub(super) fn absorbing(textures: &Textures, absorption: [f32; 3]) -> Self {
        let absorption = textures.spectrum_texture(Color::Value(absorption), SpectrumType::Unbounded);
        Self { absorption, scattering: None, emission: None, scale: 1.0 }
    }

    /// As it is written in a scene.
    pub(super) fn compile(textures: &Textures, written: &Written) -> Self {
        let coefficient = |color| textures.spectrum_texture(color, SpectrumType::Unbounded);
        let scattering = written.scatters().then(|| Scattering {
            coefficient: coefficient(written.scattering),
            phase: HenyeyGreenstein::new(written.g),
        });
        let emission = written.emits().then(|| EmissionSpectrum {
            color: textures.spectrum_texture(written.emission, SpectrumType::Illuminant),
            scale: written.emission_scale,
        });
        Self { absorption: coefficient(written.absorption), scattering, emission, scale: written.scale }
    }
}

impl Coefficients {
    /// Largest coefficient, above which a way has no length; sums and products of it are finite.
    const MOST: f32 = 1e18;

    /// σ_t = σ_a + σ_s.
    pub(crate) fn extinction(&self) -> Spectrum {
        self.absorption + self.scattering
    }

    /// The radiance that a way of a length adds where it begins: ∫₀ᵈ e^(−σ_t t) σ_a L_e dt.
    pub(crate) fn emitted(&self, length: f32) -> Spectrum {
        let per_length = self.absorption * self.emission;
        let effective_length =
            |sigma: f32| if sigma == 0.0 { 0.0 } else { -libm::expm1f(-sigma * length) / sigma };
        per_length * self.extinction().map(effective_length)
    }
}

impl World {
    /// Transmittance of the medium that a ray is in over `distance` (Beer's law). Over an infinite distance it is 0 in
    /// a medium that fills space, and 1 in a body, which must end somewhere although the ray did not hit its surface.
    #[inline]
    pub fn transmittance(&self, media: InteriorStack, distance: f32, mode: &SpectralMode) -> Spectrum {
        if media.is_empty() { mode.one() } else { self.transmittance_inside(media, distance, mode) }
    }

    #[inline(never)]
    fn transmittance_inside(&self, media: InteriorStack, distance: f32, mode: &SpectralMode) -> Spectrum {
        let Some((sigma, scale)) = self.extinction(media, mode) else { return mode.one() };
        if scale == 0.0 || distance.is_infinite() && media.space().is_none() {
            return mode.one();
        }
        let length = scale * distance;
        mode.one() * sigma.map(|sigma| if sigma == 0.0 { 1.0 } else { libm::expf(-sigma * length) })
    }

    /// The extinction coefficient of the medium that a ray is in, what it absorbs and scatters, and a factor of it; `None` in
    /// a vacuum.
    pub(crate) fn extinction(&self, media: InteriorStack, mode: &SpectralMode) -> Option<(Spectrum, f32)> {
        let medium = self.medium(media)?;
        let coefficient = |of: &SpectrumTexture| self.textures.spectrum(of, &TexturePoint::NOWHERE, mode);
        let absorption = coefficient(&medium.absorption);
        Some(match &medium.scattering {
            None => (absorption, medium.scale),
            Some(scattering) => (absorption + coefficient(&scattering.coefficient), medium.scale),
        })
    }

    /// The coefficients of the medium that a ray is in; `None` where it neither scatters nor emits.
    pub(crate) fn coefficients(&self, media: InteriorStack, mode: &SpectralMode) -> Option<Coefficients> {
        let medium = self.medium(media)?;
        if medium.scattering.is_none() && medium.emission.is_none() {
            return None;
        }
        let coefficient = |of: &SpectrumTexture| {
            let written = self.textures.spectrum(of, &TexturePoint::NOWHERE, mode);
            mode.one() * written.map(|sigma| (sigma * medium.scale).clamp(0.0, Coefficients::MOST))
        };
        let emission = medium.emission.as_ref().map(|emission| emission.even(&self.textures, mode));
        Some(Coefficients {
            absorption: coefficient(&medium.absorption),
            scattering: medium.scattering.map(|of| coefficient(&of.coefficient)).unwrap_or_default(),
            emission: emission.unwrap_or_default(),
            phase: medium.scattering.map(|of| of.phase),
        })
    }

    /// The medium that a ray is in.
    fn medium(&self, media: InteriorStack) -> Option<&Medium> {
        media.medium(&self.materials).and_then(|index| self.media.get(index as usize))
    }
}
