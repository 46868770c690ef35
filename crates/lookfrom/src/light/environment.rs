//! Light from infinitely far: a colour, a gradient or a picture all around.

use std::f32::consts::PI;

use glam::{Mat3, Vec3};
use lookfrom_scene::texture::{TexelFilter, Wrap};

use super::{LightSample, Target};
use crate::distribution::Piecewise2D;
use crate::spectrum::Spectrum;
use crate::texture::{self, Textures};
use crate::warp;

/// Light from infinitely far, all around.
#[derive(Clone, Debug)]
pub struct Environment {
    /// Its colours.
    pub sky: Sky,
    /// Whether surfaces are lit by it; otherwise it is only seen.
    pub illuminates: bool,
}

/// The colours of an environment.
#[derive(Clone, Debug)]
pub enum Sky {
    /// The same everywhere.
    Constant(Spectrum),
    /// Linear in the height y of the unit direction.
    Gradient {
        /// At y = 1.
        zenith: Spectrum,
        /// At y = 0.
        horizon: Spectrum,
        /// At y = −1.
        nadir: Spectrum,
    },
    /// A picture in latitude and longitude.
    Image(Box<SkyImage>),
}

/// A picture of the surroundings.
#[derive(Clone, Debug)]
pub struct SkyImage {
    /// Index of the picture in the world.
    pub image: usize,
    /// Multiplies it.
    pub scale: Spectrum,
    /// Columns: the light's axes in the world; a rotation.
    pub world_from_light: Mat3,
    /// By the light of each part of the picture.
    pub choice: Piecewise2D,
}

impl Environment {
    /// Radiance from a unit direction.
    pub fn radiance(&self, textures: &Textures, direction: Vec3) -> Spectrum {
        match &self.sky {
            Sky::Constant(color) => *color,
            Sky::Gradient { zenith, horizon, nadir } => {
                let y = direction.y.clamp(-1.0, 1.0);
                let end = if y >= 0.0 { *zenith } else { *nadir };
                *horizon * (1.0 - y.abs()) + end * y.abs()
            }
            Sky::Image(sky) => {
                let uv = sky.uv(direction);
                let wrap = [Wrap::Repeat, Wrap::Clamp];
                let rgb = texture::look_up(textures.image(sky.image), uv, wrap, TexelFilter::Bilinear);
                Spectrum::from_rgb(rgb) * sky.scale
            }
        }
    }

    /// One direction, by the cosine to `n` or by the picture's brightness.
    pub(super) fn sample(&self, textures: &Textures, n: Vec3, u: [f32; 2]) -> Option<LightSample> {
        if !self.illuminates {
            return None;
        }
        let (wi, pdf) = match &self.sky {
            Sky::Constant(_) | Sky::Gradient { .. } => {
                let wi = warp::cosine_hemisphere(u, n);
                (wi, warp::cosine_hemisphere_pdf(n.dot(wi)))
            }
            Sky::Image(sky) => {
                let ([s, t], pdf) = sky.choice.sample(u);
                // the picture's area element is 2π² sin θ of the sphere's
                let sin_theta = libm::sinf(t * PI);
                (sky.direction([s, t]), pdf / (2.0 * PI * PI * sin_theta))
            }
        };
        if !(pdf > 0.0 && pdf.is_finite()) {
            return None;
        }
        Some(LightSample { wi, li: self.radiance(textures, wi), pdf, target: Target::Infinity })
    }
}

impl SkyImage {
    /// Where in the picture a unit direction lies; row 0 is +y of the light's space, u = ½ is −z, u grows toward +x.
    fn uv(&self, direction: Vec3) -> [f32; 2] {
        let d = self.world_from_light.transpose() * direction;
        let u = 0.5 + libm::atan2f(d.x, -d.z) / (2.0 * PI);
        let v = libm::acosf(d.y.clamp(-1.0, 1.0)) / PI;
        [u, v]
    }

    /// The inverse of [`SkyImage::uv`].
    fn direction(&self, [u, v]: [f32; 2]) -> Vec3 {
        let (phi, theta) = ((u - 0.5) * 2.0 * PI, v * PI);
        let sin_theta = libm::sinf(theta);
        self.world_from_light
            * Vec3::new(libm::sinf(phi) * sin_theta, libm::cosf(theta), -libm::cosf(phi) * sin_theta)
    }
}
