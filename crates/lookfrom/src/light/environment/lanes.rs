//! Environment maps for eight paths at once: directions sampled, with guides or without, and their radiance, and what escaped rays see.
//!
//! Those without a portal, and other skies with a guide. The bits are those of [`Environment`]'s scalar methods.

use glam::Vec3;
use lookfrom_scene::texture::Wrap;
use lookfrom_simd::{Kernel, Simd, dispatch, f32x8, f64x8, level, prelude::*};

use super::guided::Chosen;
use super::{Environment, MapLayout, Sky, SkyImage, finite};
use crate::core::lanes::{LANES, by_lane, gather, row, scatter, store};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::light::IncompletePdf;
use crate::shading::texture::{self, SpectralMode, Textures};

/// Directions toward an environment in eight lanes.
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

/// Points that lights are sampled from, and their normals.
pub(crate) type Places<S> = (Vector<f64x8<S>>, Vector<f32x8<S>>);

impl Environment {
    /// As [`Environment::sample`] with incomplete densities, from points with their normals; `None` for those that are sampled one by
    /// one: through a portal, or with neither a map nor a guide.
    #[inline(always)]
    pub(crate) fn sample_lanes<S: Simd>(
        &self,
        simd: S,
        textures: &Textures,
        (points, n): Places<S>,
        u: [[f32; LANES]; 2],
        modes: &[&SpectralMode; LANES],
    ) -> Option<SkySamples> {
        let sky = self.map_in_lanes();
        let Some(guide) = &self.guide else { return Some(sky?.sample_lanes(simd, textures, u, modes)) };

        // Choose directions by the guide, step by step for all lanes: each step reads from memory, and does not wait for other lanes.
        let (points, n) = (store(Vector::<f32x8<S>>::narrow(points)), store(n));
        let histograms = by_lane!(lane => guide.histogram(row(&points, lane).into(), row(&n, lane).into()));
        let chosen = by_lane!(lane => self.choose(histograms[lane], row(&u, lane)));
        let columns = by_lane!(lane => match chosen[lane] {
            Chosen::Guide(histogram, [u, _]) => histogram.column(u),
            Chosen::Environment(_) => (0, 0.0),
        });
        let by_guide = by_lane!(lane => match chosen[lane] {
            Chosen::Guide(histogram, [_, v]) => histogram.direction(columns[lane], v),
            Chosen::Environment(_) => Vec3::ZERO,
        });

        // Without a map a sky is sampled by the guide alone.
        let Some(sky) = sky else {
            return Some(SkySamples {
                wi: by_lane!(lane => by_guide[lane].to_array()),
                li: by_lane!(lane => self.color(textures, by_guide[lane], modes[lane])),
                pdf: by_lane!(lane => self.mixed_pdf(histograms[lane], by_guide[lane], 0.0)),
            });
        };
        let numbers = by_lane!(lane => match chosen[lane] {
            Chosen::Environment(u) => u,
            Chosen::Guide(..) => [0.0; 2],
        });
        let unguided = sky.directions(simd, [0, 1].map(|axis| by_lane!(lane => numbers[lane][axis])));
        let directions = by_lane!(lane => match chosen[lane] {
            Chosen::Guide(..) => by_guide[lane],
            Chosen::Environment(_) => Vec3::from_array(unguided[lane]),
        });
        let mut samples = sky.seen(textures, &directions, modes, (1 << LANES) - 1);
        samples.pdf = by_lane!(lane => self.mixed_pdf(histograms[lane], directions[lane], samples.pdf[lane]));
        Some(samples)
    }

    /// The environment map, if it is sampled and looked up in lanes.
    #[inline]
    pub(crate) fn map_in_lanes(&self) -> Option<&SkyImage> {
        match &self.sky {
            Sky::Image(sky) if self.portal.is_none() => Some(sky),
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
        let (wi, per_solid_angle) = self.direction([u, v]);
        let pdf = f32x8::load_array(simd, pdf) * per_solid_angle;
        SkySamples { wi: scatter(wi), li: self.lights(simd, textures, [u, v], modes), pdf: pdf.into() }
    }

    /// Sampled directions.
    #[inline(always)]
    fn directions<S: Simd>(&self, simd: S, u: [[f32; LANES]; 2]) -> [[f32; 3]; LANES] {
        let (uv, _) = self.choice(IncompletePdf::Allowed).sample_lanes(u);
        let u = f32x8::load_array(simd, by_lane!(lane => uv[lane][0]));
        let v = f32x8::load_array(simd, by_lane!(lane => uv[lane][1]));
        scatter(self.direction([u, v]).0)
    }

    /// The radiance at (u, v): look-ups side by side, where spectra are not interpolated.
    #[inline(always)]
    fn lights<S: Simd>(
        &self,
        simd: S,
        textures: &Textures,
        uv: [f32x8<S>; 2],
        modes: &[&SpectralMode; LANES],
    ) -> [Spectrum; LANES] {
        if modes.iter().any(|mode| self.blends_apart(mode)) {
            let [u, v]: [[f32; LANES]; 2] = uv.map(Into::into);
            return by_lane!(lane => self.radiance_at(textures, [u[lane], v[lane]], modes[lane]));
        }
        let (image, uv) = (textures.image(self.image), self.in_picture(uv));
        let texels = match self.layout {
            MapLayout::LatitudeLongitude => {
                let texels = texture::look_up_lanes(simd, image, uv, [Wrap::Repeat, Wrap::Clamp]);
                texels.map(|[r, g, b, _]| [r, g, b])
            }
            MapLayout::Octahedral => texture::nearest_lanes(image, uv),
        };
        by_lane!(lane => self.radiance(texels[lane], modes[lane]))
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
        let MapPoints { uv, per_solid_angle, li } =
            dispatch(level(), Seen { sky: self, textures, directions: &wi, modes });
        let choice = self.choice(IncompletePdf::Allowed);
        let pdf = choice.pdf_lanes(&uv, with_density);
        let pdf = by_lane!(lane => finite(pdf[lane] * per_solid_angle[lane]));
        SkySamples { wi, li, pdf }
    }
}

/// Points of an environment map, the factors there from densities over the map to those over solid angle, and the radiance.
struct MapPoints {
    uv: [[f32; 2]; LANES],
    per_solid_angle: [f32; LANES],
    li: [Spectrum; LANES],
}

/// The places in directions.
struct Seen<'a> {
    sky: &'a SkyImage,
    textures: &'a Textures,
    directions: &'a [[f32; 3]; LANES],
    modes: &'a [&'a SpectralMode; LANES],
}

impl Kernel for Seen<'_> {
    type Output = MapPoints;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> MapPoints {
        let Self { sky, textures, directions, modes } = self;
        let ([u, v], per_solid_angle) = sky.uv(gather(simd, directions));
        let li = sky.lights(simd, textures, [u, v], modes);
        let [u, v]: [[f32; LANES]; 2] = [u.into(), v.into()];
        MapPoints { uv: by_lane!(lane => [u[lane], v[lane]]), per_solid_angle: per_solid_angle.into(), li }
    }
}

#[cfg(test)]
mod tests;
