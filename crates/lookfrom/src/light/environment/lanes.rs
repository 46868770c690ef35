//! Environment maps for eight paths at once: directions sampled and their radiance, and what escaped rays see.
//!
//! Those of latitude and longitude without a portal. The bits are those of [`Environment`]'s scalar methods.

use glam::Vec3;
use lookfrom_scene::texture::Wrap;
use lookfrom_simd::{Kernel, Simd, dispatch, f32x8, level, prelude::*};

use super::{
    Environment, MapLayout, Sky, SkyImage, finite, latitude_longitude, latitude_longitude_direction,
};
use crate::core::lanes::{LANES, by_lane, gather, scatter};
use crate::core::spectrum::Spectrum;
use crate::light::IncompletePdf;
use crate::shading::texture::{self, SpectralMode, Textures};

/// Directions toward an environment map in eight lanes.
pub(crate) struct SkySamples {
    pub(crate) wi: [[f32; 3]; LANES],
    pub(crate) li: [Spectrum; LANES],
    /// Over solid angle.
    pub(crate) pdf: [f32; LANES],
}

impl SkySamples {
    /// Whether a lane has a sample.
    #[inline]
    pub(crate) fn is_usable(&self, lane: usize) -> bool {
        self.pdf[lane] > 0.0 && self.pdf[lane].is_finite() && !self.li[lane].is_black()
    }
}

impl Environment {
    /// The environment map, if it is sampled and looked up in lanes.
    #[inline]
    pub(crate) fn map_in_lanes(&self) -> Option<&SkyImage> {
        match &self.sky {
            Sky::Image(sky) if self.portal.is_none() && sky.layout == MapLayout::LatitudeLongitude => {
                Some(sky)
            }
            _ => None,
        }
    }
}

impl SkyImage {
    /// As [`Environment::sample`] with incomplete densities, of which not all are usable.
    #[inline(always)]
    pub(crate) fn sample_lanes<S: Simd>(
        &self,
        simd: S,
        textures: &Textures,
        u: [[f32; LANES]; 2],
        modes: &[&SpectralMode; LANES],
    ) -> SkySamples {
        let choice = self.choice(IncompletePdf::Allowed);
        let (uv, pdf) = choice.sample_lanes(u);
        let u = f32x8::load_array(simd, by_lane!(lane => uv[lane][0]));
        let v = f32x8::load_array(simd, by_lane!(lane => uv[lane][1]));
        let (of_light, per_solid_angle) = latitude_longitude_direction([u, v]);
        let pdf = f32x8::load_array(simd, pdf) * per_solid_angle;
        let wi = scatter(self.in_world(of_light));
        let rgb = self.texels(simd, textures, [u, v]);
        let li = by_lane!(lane => self.radiance(rgb[lane], modes[lane]));
        SkySamples { wi, li, pdf: pdf.into() }
    }

    /// The map's colours at (u, v).
    #[inline(always)]
    fn texels<S: Simd>(&self, simd: S, textures: &Textures, uv: [f32x8<S>; 2]) -> [[f32; 3]; LANES] {
        let image = textures.image(self.image);
        let texels = texture::look_up_lanes(simd, image, self.in_picture(uv), [Wrap::Repeat, Wrap::Clamp]);
        by_lane!(lane => {
            let [r, g, b, _] = texels[lane];
            [r, g, b]
        })
    }

    /// The radiance from unit directions, and in the lanes of a mask their densities in [`SkyImage::sample_lanes`].
    pub(crate) fn seen(
        &self,
        textures: &Textures,
        directions: &[Vec3; LANES],
        modes: &[&SpectralMode; LANES],
        with_density: u32,
    ) -> SkySamples {
        let wi = by_lane!(lane => directions[lane].to_array());
        let Places { uv, per_solid_angle, rgb } =
            dispatch(level(), Seen { sky: self, textures, directions: &wi });
        let choice = self.choice(IncompletePdf::Allowed);
        let pdf = by_lane!(lane => match with_density & 1 << lane {
            0 => 0.0,
            _ => finite(choice.pdf(uv[lane]) * per_solid_angle[lane]),
        });
        SkySamples { wi, li: by_lane!(lane => self.radiance(rgb[lane], modes[lane])), pdf }
    }
}

/// Places in an environment map, the factors there from densities over the map to those over solid angle, and the colours.
struct Places {
    uv: [[f32; 2]; LANES],
    per_solid_angle: [f32; LANES],
    rgb: [[f32; 3]; LANES],
}

/// The places in directions.
struct Seen<'a> {
    sky: &'a SkyImage,
    textures: &'a Textures,
    directions: &'a [[f32; 3]; LANES],
}

impl Kernel for Seen<'_> {
    type Output = Places;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Places {
        let Self { sky, textures, directions } = self;
        let ([u, v], per_solid_angle) = latitude_longitude(sky.of_light(gather(simd, directions)));
        let rgb = sky.texels(simd, textures, [u, v]);
        let [u, v]: [[f32; LANES]; 2] = [u.into(), v.into()];
        Places { uv: by_lane!(lane => [u[lane], v[lane]]), per_solid_angle: per_solid_angle.into(), rgb }
    }
}

#[cfg(test)]
mod tests;
