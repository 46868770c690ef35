//! Media that fill bodies and space, as rays travel in them.

use super::World;
use crate::core::spectrum::Spectrum;
use crate::shading::interior_stack::InteriorStack;
use crate::shading::texture::{SpectralMode, SpectrumTexture, TexturePoint};

/// An absorbing medium.
#[derive(Clone, Copy, Debug)]
pub struct Medium {
    /// Absorption coefficient, per unit of length.
    pub absorption: SpectrumTexture,
    /// Factor of it: ≥ 0.
    pub scale: f32,
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

    /// The extinction coefficient of the medium that a ray is in, and a factor of it; `None` in a vacuum.
    pub(crate) fn extinction(&self, media: InteriorStack, mode: &SpectralMode) -> Option<(Spectrum, f32)> {
        let medium = self.medium(media)?;
        Some((self.textures.spectrum(&medium.absorption, &TexturePoint::NOWHERE, mode), medium.scale))
    }

    /// The medium that a ray is in.
    fn medium(&self, media: InteriorStack) -> Option<&Medium> {
        media.medium(&self.materials).and_then(|index| self.media.get(index as usize))
    }
}
