//! Environment lights: a constant, a gradient or an environment map, optionally with a portal.
//!
//! `guided`: sampling by a guide; `lanes`: environment maps for eight paths at once; `derivation`: for the inspector.

mod derivation;
mod guided;
mod lanes;

use std::f32::consts::PI;
use std::sync::Arc;

use glam::{DMat3, DVec3, Mat3, Vec3};
use lookfrom_scene::image::Image;
use lookfrom_scene::texture::{TexelFilter, Wrap};
use lookfrom_simd::{Float, Real};

use super::guide::Guide;
use super::portal::{Opening, Portal};
use super::{EmissionSpectrum, IncompletePdf, LightSample, LightSampleContext, Target};
use crate::core::distribution::Piecewise2D;
use crate::core::elementary;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::core::warp;
use crate::shading::texture::{self, SpectralMode, SpectrumType, Textures};

/// An environment light.
#[derive(Clone, Debug)]
pub struct Environment {
    /// Its colours.
    pub sky: Sky,
    /// The portal, the only opening through which it is visible.
    pub portal: Option<Box<Portal>>,
    /// Whether it illuminates surfaces; otherwise it is only visible.
    pub illuminates: bool,
    /// Directions in which it is visible, by place; `None` where they are not known, and behind a portal.
    pub(crate) guide: Option<Arc<Guide>>,
}

/// The colours of an environment.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Sky {
    /// One colour everywhere.
    Constant(EmissionSpectrum),
    /// Linear in the height y of the unit direction.
    Gradient {
        /// At y = 1.
        zenith: EmissionSpectrum,
        /// At y = 0.
        horizon: EmissionSpectrum,
        /// At y = −1.
        nadir: EmissionSpectrum,
    },
    /// An environment map.
    Image(Box<SkyImage>),
}

/// An environment map.
#[derive(Clone, Debug)]
pub struct SkyImage {
    /// Index of the picture in the world.
    pub image: usize,
    /// Factor of each channel.
    pub scale: [f32; 3],
    /// Its parametrisation of the sphere of directions.
    pub layout: MapLayout,
    /// Columns: the light's axes in the world; a rotation or a rotation with reflection.
    pub world_from_light: Mat3,
    /// Slope and offset of v in the picture by v of the layout: 1 and 0, but where the outermost rows are the poles.
    pub picture_v: [f32; 2],
    /// Distribution by luminous contribution: brightness times solid angle of each texel.
    pub complete: Arc<Piecewise2D>,
    /// MIS-compensated distribution (Karlík et al. 2019), by the excess of each texel over the mean: where BSDFs are
    /// sampled too, dim directions need no light samples.
    pub compensated: Arc<Piecewise2D>,
    /// The mean brightness over solid angle, that of `compensated`.
    pub mean: f32,
    /// The sums of the weights of both distributions, without and with compensation.
    pub sums: [f64; 2],
}

/// Parametrisation of the sphere of directions in a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MapLayout {
    /// Equirectangular. Row 0 is +y; the middle column is −z, columns to the right are toward +x.
    LatitudeLongitude,
    /// `warp::octahedral_direction`.
    Octahedral,
}

impl Environment {
    /// Incident radiance at a point from a unit direction.
    pub fn radiance(
        &self,
        textures: &Textures,
        from: DVec3,
        direction: Vec3,
        mode: &SpectralMode,
    ) -> Spectrum {
        match &self.portal {
            Some(portal) if !portal.is_seen(from, direction) => Spectrum::BLACK,
            _ => self.color(textures, direction, mode),
        }
    }

    /// The radiance, where it is the same from everywhere.
    pub(crate) fn even(&self, textures: &Textures, mode: &SpectralMode) -> Option<Spectrum> {
        match (&self.sky, &self.portal) {
            (Sky::Constant(emission_spectrum), None) => Some(emission_spectrum.even(textures, mode)),
            _ => None,
        }
    }

    /// Radiance from a unit direction, ignoring the portal.
    pub(super) fn color(&self, textures: &Textures, direction: Vec3, mode: &SpectralMode) -> Spectrum {
        match &self.sky {
            Sky::Constant(emission_spectrum) => emission_spectrum.even(textures, mode),
            Sky::Gradient { zenith, horizon, nadir } => {
                let y = direction.y.clamp(-1.0, 1.0);
                let end = if y >= 0.0 { zenith } else { nadir };
                horizon.even(textures, mode) * (1.0 - y.abs()) + end.even(textures, mode) * y.abs()
            }
            Sky::Image(sky) => match self.portal.as_ref().and_then(|portal| portal.texel(direction)) {
                Some(rgb) => sky.radiance(rgb, mode),
                None => sky.radiance_at(textures, sky.uv(direction.into()).0, mode),
            },
        }
    }

    /// This light with its environment map, if it has one, rotated in the world; the portal stays where it is.
    pub(crate) fn turned(&self, rotation: &DMat3, textures: &Textures) -> Self {
        let Sky::Image(sky) = &self.sky else { return self.clone() };
        let world_from_light = (*rotation * sky.world_from_light.as_dmat3()).as_mat3();
        let sky = SkyImage { world_from_light, ..(**sky).clone() };
        let portal = self.portal.as_ref().map(|portal| Box::new(sky.through(portal.opening(), textures)));
        Self { sky: Sky::Image(Box::new(sky)), portal, illuminates: self.illuminates, guide: None }
    }

    /// Unoccluded irradiance on a surface with the unit normal `n`, in linear Rec. 709: the integral of radiance times
    /// cosine. The portal is ignored.
    pub fn irradiance(&self, textures: &Textures, n: Vec3) -> [f32; 3] {
        let Sky::Image(sky) = &self.sky else {
            // The midpoint rule is enough for light that varies as little as this.
            const SIDE: u32 = 64;
            let place = |k: u32| (k as f32 + 0.5) / SIDE as f32;
            let sum = (0..SIDE * SIDE).fold(Spectrum::BLACK, |sum, k| {
                let wi = warp::cosine_hemisphere([place(k % SIDE), place(k / SIDE)], n);
                sum + self.color(textures, wi, &SpectralMode::Rgb)
            });
            return (sum * (PI / (SIDE * SIDE) as f32)).rgb();
        };
        let image = textures.image(sky.image);
        let (width, height) = (image.width as f32, image.height as f32);
        let mut sum = [0.0_f64; 3];
        let is_in_bands = sky.picture_v == [1.0, 0.0];
        for (index, texel) in (0..).zip(image.texels()) {
            let place = [(index % image.width) as f32 + 0.5, (index / image.width) as f32 + 0.5];
            let uv = [place[0] / width, place[1] / height];
            let (direction, per_solid_angle) = sky.direction(uv);
            let cos = Vec3::from(direction).dot(n);
            if cos > 0.0 {
                let texel = if is_in_bands { texel } else { sky.texel(textures, uv) };
                let share = f64::from(cos / per_solid_angle);
                sum = std::array::from_fn(|c| sum[c] + share * f64::from((texel[c] * sky.scale[c]).max(0.0)));
            }
        }
        sum.map(|sum| (sum / f64::from(width * height)) as f32)
    }

    /// Whether light sampling is worthwhile: its light is far from uniform.
    pub(super) fn is_uneven(&self) -> bool {
        self.portal.is_some() || matches!(self.sky, Sky::Image(_)) || self.guide.is_some()
    }

    /// A sampled direction: through the portal, by the brightness of the map, or by the cosine to the normal.
    pub(super) fn sample(
        &self,
        textures: &Textures,
        at: &LightSampleContext,
        u: [f32; 2],
        mode: &SpectralMode,
        incomplete_pdf: IncompletePdf,
    ) -> Option<LightSample> {
        if !self.illuminates {
            return None;
        }
        if let (Some(guide), IncompletePdf::Allowed) = (&self.guide, incomplete_pdf) {
            return self.sample_guided(guide, textures, at, u, mode);
        }
        let (wi, pdf, li) = match (&self.portal, &self.sky, incomplete_pdf) {
            (Some(portal), ..) => {
                let (wi, pdf) = portal.sample(at.point, u)?;
                (wi, pdf, self.color(textures, wi, mode))
            }
            (None, Sky::Image(sky), _) => {
                let (uv, pdf) = sky.choice(incomplete_pdf).sample(u);
                let li = sky.radiance_at(textures, uv, mode);
                let (wi, per_solid_angle) = sky.direction(uv);
                (wi.into(), pdf * per_solid_angle, li)
            }
            (None, _, IncompletePdf::Allowed) => return None,
            (None, _, IncompletePdf::Forbidden) => {
                let wi = match at.n == Vec3::ZERO {
                    true => warp::uniform_sphere(u),
                    false => warp::cosine_hemisphere(u, at.n),
                };
                (wi, even_pdf(at.n, wi), self.color(textures, wi, mode))
            }
        };
        let usable = pdf > 0.0 && pdf.is_finite() && !li.is_black();
        usable.then_some(LightSample { wi, li, pdf, target: Target::Infinity })
    }

    /// The solid angle density of [`Environment::sample`].
    pub(super) fn pdf(&self, at: &LightSampleContext, wi: Vec3, incomplete_pdf: IncompletePdf) -> f32 {
        match (&self.portal, &self.sky, incomplete_pdf) {
            _ if !self.illuminates => 0.0,
            _ if self.guide.is_some() && incomplete_pdf == IncompletePdf::Allowed => {
                self.mixed_pdf(self.histogram(at), wi, self.unguided_pdf(wi))
            }
            (Some(portal), ..) => finite(portal.pdf(at.point, wi)),
            (None, Sky::Image(sky), _) => sky.pdf(wi, incomplete_pdf),
            (None, _, IncompletePdf::Allowed) => 0.0,
            (None, _, IncompletePdf::Forbidden) => even_pdf(at.n, wi),
        }
    }
}

/// The density of a direction that is sampled without regard to colours: by the cosine to a normal, or uniformly without one.
fn even_pdf(n: Vec3, wi: Vec3) -> f32 {
    match n == Vec3::ZERO {
        true => warp::UNIFORM_SPHERE_PDF,
        false => warp::cosine_hemisphere_pdf(n.dot(wi)),
    }
}

fn finite(pdf: f32) -> f32 {
    if pdf.is_finite() { pdf } else { 0.0 }
}

impl SkyImage {
    /// The solid angle density of a unit direction, without a guide.
    fn pdf(&self, wi: Vec3, incomplete_pdf: IncompletePdf) -> f32 {
        let (uv, per_solid_angle) = self.uv(wi.into());
        finite(self.choice(incomplete_pdf).pdf(uv) * per_solid_angle)
    }

    fn choice(&self, incomplete_pdf: IncompletePdf) -> &Piecewise2D {
        match incomplete_pdf {
            IncompletePdf::Forbidden => &self.complete,
            IncompletePdf::Allowed => &self.compensated,
        }
    }

    /// The place in the picture of (u, v).
    #[inline(always)]
    fn in_picture<R: Real>(&self, [u, v]: [R; 2]) -> [R; 2] {
        let [slope, offset] = self.picture_v;
        [u, v * slope + offset]
    }

    /// The map's colour at (u, v).
    fn texel(&self, textures: &Textures, uv: [f32; 2]) -> [f32; 3] {
        let uv = self.in_picture(uv);
        let image = textures.image(self.image);
        match self.layout {
            MapLayout::LatitudeLongitude => {
                texture::look_up(image, uv, [Wrap::Repeat, Wrap::Clamp], TexelFilter::Bilinear)
            }
            MapLayout::Octahedral => texture::look_up(image, uv, [Wrap::Clamp; 2], TexelFilter::Nearest),
        }
    }

    /// The environment map resampled for a portal.
    pub(crate) fn through(&self, opening: Opening, textures: &Textures) -> Portal {
        let picture = textures.image(self.image);
        let size = [picture.width, picture.height];
        Portal::of_picture(opening, size, |direction| self.blended(textures, direction))
    }

    /// The map's colour in a unit direction, bilinearly interpolated between texel centres.
    pub fn blended(&self, textures: &Textures, direction: Vec3) -> [f32; 3] {
        let (uv, _) = self.uv(direction.into());
        match self.layout {
            MapLayout::LatitudeLongitude => self.texel(textures, uv),
            MapLayout::Octahedral => {
                // Look up four texels; beyond an edge of the octahedral square the coordinates are folded back.
                let image = textures.image(self.image);
                let size = [image.width as f32, image.height as f32];
                let place: [f32; 2] = std::array::from_fn(|i| uv[i] * size[i] - 0.5);
                let mut sum = [0.0; 3];
                for corner in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]] {
                    let middle: [f32; 2] =
                        std::array::from_fn(|i| (place[i].floor() + corner[i] + 0.5) / size[i]);
                    let weight: f32 =
                        (0..2).map(|i| 1.0 - (place[i] - place[i].floor() - corner[i]).abs()).product();
                    let folded = warp::octahedral_square(warp::octahedral_direction(middle).into());
                    let texel = self.texel(textures, folded);
                    sum = std::array::from_fn(|c| sum[c] + weight * texel[c]);
                }
                sum
            }
        }
    }

    /// The radiance at (u, v).
    fn radiance_at(&self, textures: &Textures, uv: [f32; 2], mode: &SpectralMode) -> Spectrum {
        match self.blends_apart(mode) {
            true => self.radiance_apart(textures, uv, mode),
            false => self.radiance(self.texel(textures, uv), mode),
        }
    }

    /// Whether the brightness and the spectrum are interpolated apart, as Mitsuba does in its maps, whose outermost rows are the poles.
    #[inline(always)]
    fn blends_apart(&self, mode: &SpectralMode) -> bool {
        self.picture_v != [1.0, 0.0] && matches!(mode, SpectralMode::Spectral(_))
    }

    /// As [`Self::radiance_at`], where both are interpolated apart.
    #[inline(never)]
    fn radiance_apart(&self, textures: &Textures, uv: [f32; 2], mode: &SpectralMode) -> Spectrum {
        let (image, uv) = (textures.image(self.image), self.in_picture(uv));
        let (mut shape, mut brightness) = (Spectrum::BLACK, 0.0);
        for (texel, weight) in texture::blended_texels(image, uv, [Wrap::Repeat, Wrap::Clamp]) {
            let rgb: [f32; 3] = std::array::from_fn(|c| (texel[c] * self.scale[c]).max(0.0));
            let twice = 2.0 * rgb.into_iter().fold(0.0, f32::max);
            if twice > 0.0 {
                let normalized = rgb.map(|channel| channel / twice);
                shape += texture::spectrum_of(normalized, SpectrumType::Illuminant, mode) * weight;
            }
            brightness += weight * twice;
        }
        shape * brightness
    }

    fn radiance(&self, rgb: [f32; 3], mode: &SpectralMode) -> Spectrum {
        let rgb = std::array::from_fn(|c| (rgb[c] * self.scale[c]).max(0.0));
        texture::spectrum_of(rgb, SpectrumType::Illuminant, mode)
    }

    /// The (u, v) of unit directions, and the factors there from a density over the unit square to one over solid angle.
    #[inline(always)]
    fn uv<R: Real>(&self, direction: Vector<R>) -> ([R; 2], R) {
        let of_light = self.of_light(direction);
        match self.layout {
            MapLayout::LatitudeLongitude => latitude_longitude(of_light),
            MapLayout::Octahedral => {
                (warp::octahedral_square(of_light), direction.x.like(OCTAHEDRAL_DENSITY))
            }
        }
    }

    /// The inverse of [`SkyImage::uv`].
    #[inline(always)]
    pub(super) fn direction<R: Real>(&self, uv: [R; 2]) -> (Vector<R>, R) {
        let (of_light, per_solid_angle) = match self.layout {
            MapLayout::LatitudeLongitude => latitude_longitude_direction(uv),
            MapLayout::Octahedral => (warp::octahedral_direction_within(uv), uv[0].like(OCTAHEDRAL_DENSITY)),
        };
        (self.in_world(of_light), per_solid_angle)
    }

    /// From the world to the light's axes.
    #[inline(always)]
    fn of_light<R: Real>(&self, v: Vector<R>) -> Vector<R> {
        let [x, y, z] = self.axes(v.x);
        Vector { x: x.dot(v), y: y.dot(v), z: z.dot(v) }
    }

    /// From the light's axes to the world.
    #[inline(always)]
    fn in_world<R: Real>(&self, v: Vector<R>) -> Vector<R> {
        let [x, y, z] = self.axes(v.x);
        x * v.x + y * v.y + z * v.z
    }

    /// The light's axes in the world.
    #[inline(always)]
    fn axes<R: Real>(&self, like: R) -> [Vector<R>; 3] {
        let [x, y, z] = self.world_from_light.to_cols_array_2d();
        [Vector::splat(like, x), Vector::splat(like, y), Vector::splat(like, z)]
    }
}

/// The brightest channel that a look-up in a texel may give: where it interpolates with neighbours, that of the texels around, so
/// that no visible light has density 0.
pub(crate) fn brightest_around(image: &Image, layout: MapLayout, [x, y]: [usize; 2]) -> f32 {
    let (width, height) = (image.width as usize, image.height as usize);
    let brightness = |x: usize, y: usize| image.texel(y * width + x).into_iter().fold(0.0, f32::max);
    if layout == MapLayout::Octahedral {
        return brightness(x, y);
    }
    let around = [x + width - 1, x, x + 1].map(|x| x % width);
    let rows = y.saturating_sub(1)..(y + 2).min(height);
    rows.flat_map(|y| around.map(|x| brightness(x, y))).fold(0.0, f32::max)
}

/// The density over solid angle of a uniform one over an octahedral square.
const OCTAHEDRAL_DENSITY: f32 = 0.25 / PI;

/// The (u, v) of a unit direction in an equirectangular picture, and the factor there from a density over the unit square to
/// one over solid angle: the sphere's area element is 2π² sin θ times that of the square.
#[inline(always)]
fn latitude_longitude<R: Real>(d: Vector<R>) -> ([R; 2], R) {
    let sin_theta = Float::sqrt(d.x * d.x + d.z * d.z);
    let u = elementary::angle_in_turns(d.x, -d.z) + 0.5;
    let v = elementary::angle_in_turns(sin_theta, d.y) * 2.0;
    ([u, v], sin_theta.like(1.0) / (sin_theta * (2.0 * PI * PI)))
}

/// The inverse of [`latitude_longitude`].
#[inline(always)]
fn latitude_longitude_direction<R: Real>([u, v]: [R; 2]) -> (Vector<R>, R) {
    let (sin_phi, cos_phi) = elementary::sin_cos_of_turns(u - 0.5);
    let (sin_theta, cos_theta) = elementary::sin_cos_of_turns(v * 0.5);
    let direction = Vector { x: sin_phi * sin_theta, y: cos_theta, z: -cos_phi * sin_theta };
    (direction, u.like(1.0) / (sin_theta * (2.0 * PI * PI)))
}
