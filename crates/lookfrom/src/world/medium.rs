//! The media of a world, as rays travel in them.

use glam::Vec3;
use lookfrom_bvh::{Hit, Ray};

use super::World;
use crate::core::elementary;
use crate::core::spectrum::Spectrum;
use crate::medium::{Cover, Medium, Way};
use crate::shading::interior_stack::InteriorStack;
use crate::shading::texture::SpectralMode;

/// The end of media that fill space, for rays that meet nothing. It depends on their origins alone, so that light is the same by whatever way it
/// is found, and a camera far away sees as much of the medium as there is before the scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EndOfSpace {
    /// The middle of the scene, in render space.
    pub(super) center: Vec3,
    /// Twice its radius.
    pub(super) reach: f32,
}

impl EndOfSpace {
    /// The length of the way of a ray.
    fn length(self, ray: &Ray) -> f32 {
        (Vec3::from_array(ray.origin) - self.center).length() + self.reach
    }
}

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

    /// The length of the way of a ray to what it hits. Where it hits nothing, to the end of a medium that fills space, and infinite in others.
    pub(crate) fn length(&self, media: InteriorStack, ray: &Ray, hit: &Hit) -> f32 {
        match (hit.is_hit(), media.space(), self.end_of_space) {
            (true, ..) => Vec3::from_array(ray.direction).length() * hit.t,
            (false, Some(_), Some(end)) => end.length(ray),
            (false, ..) => f32::INFINITY,
        }
    }

    /// The length of the way of a ray to a light infinitely far away, in a medium that fills space: twice the scene's radius, as in pbrt, where
    /// that has no end.
    pub(crate) fn length_to_sky(&self, ray: &Ray) -> f32 {
        self.end_of_space.map_or(2.0 * self.radius, |end| end.length(ray))
    }

    /// The way of a ray to what it hits, or to the end of a medium that fills space, and what of it a medium that scatters or emits light covers;
    /// `None` where there is none.
    pub(crate) fn cover(&self, media: InteriorStack, ray: &Ray, hit: &Hit) -> Option<(Way, Cover)> {
        if !hit.is_hit() && media.space().is_none() {
            return None;
        }
        let way = Way::new(ray, self.length(media, ray, hit));
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
