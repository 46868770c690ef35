//! The media of a world, as rays travel in them.

use glam::Vec3;
use lookfrom_bvh::{Hit, Ray};

use super::World;
use crate::core::elementary;
use crate::core::spectrum::Spectrum;
use crate::medium::{Cover, Medium, Way};
use crate::shading::interior_stack::InteriorStack;
use crate::shading::texture::SpectralMode;

impl World {
    /// Transmittance of the medium that a ray is in over a length; in a medium that varies, an estimate of it. Over an infinite
    /// distance it is 0 in a homogeneous medium that fills space, and 1 in a body, which must end somewhere although the ray did not hit its surface.
    #[inline]
    pub fn transmittance(
        &self,
        media: InteriorStack,
        (ray, length): (&Ray, f32),
        mode: &SpectralMode,
    ) -> Spectrum {
        if media.is_empty() { mode.one() } else { self.transmittance_inside(media, (ray, length), mode) }
    }

    #[inline(never)]
    fn transmittance_inside(
        &self,
        media: InteriorStack,
        (ray, length): (&Ray, f32),
        mode: &SpectralMode,
    ) -> Spectrum {
        let Some(medium) = self.medium(media) else { return mode.one() };
        if length.is_infinite() && media.space().is_none() {
            return mode.one();
        }
        if medium.varying.is_some() {
            let way = Way::new(ray, length);
            let estimate = medium.estimated_transmittance(&way, (&self.textures, mode), false);
            return estimate.map_or(mode.one(), |tracking| tracking.after);
        }
        let (sigma, scale) = self.extinction(medium, mode);
        if scale == 0.0 {
            return mode.one();
        }
        let length = scale * length;
        mode.one() * sigma.map(|sigma| if sigma == 0.0 { 1.0 } else { elementary::exp(-sigma * length) })
    }

    /// The extinction coefficient of a medium where its density is 1, what it absorbs and scatters, and a factor of it.
    pub(crate) fn extinction(&self, medium: &Medium, mode: &SpectralMode) -> (Spectrum, f32) {
        let [absorption, scattering] = medium.extinction.parts(&self.textures, mode);
        (absorption + scattering, medium.scale)
    }

    /// The way of a ray to what it hits, or without an end, and what of it a medium that scatters or emits light covers; `None` where there is
    /// none.
    pub(crate) fn cover(&self, media: InteriorStack, ray: &Ray, hit: &Hit) -> Option<(Way, Cover)> {
        let length = match hit.is_hit() {
            true => Vec3::from_array(ray.direction).length() * hit.t,
            false => media.space().map(|_| f32::INFINITY)?,
        };
        let way = Way::new(ray, length);
        Some((way, self.medium(media)?.cover(&self.textures, &way)?))
    }

    /// Whether any medium scatters or emits light.
    pub(crate) fn has_luminous_media(&self) -> bool {
        self.media.iter().any(|medium| medium.phase.is_some() || medium.emission.is_some())
    }

    /// The medium that a ray is in; `None` in a vacuum.
    #[inline]
    pub(crate) fn medium(&self, media: InteriorStack) -> Option<&Medium> {
        if media.is_empty() {
            return None;
        }
        media.medium(&self.materials).and_then(|index| self.media.get(index as usize))
    }
}
