//! Lights that are not shapes: from what was written to what can be sampled.

use std::f32::consts::PI;

use glam::{DVec3, Mat3};
use lookfrom_scene::image::Image;
use lookfrom_scene::light::{Light as Written, LightKind, Sky as WrittenSky};
use lookfrom_scene::material::Color;

use crate::distribution::Piecewise2D;
use crate::light::{Environment, Light, Sky, SkyImage};
use crate::spectrum::Spectrum;

/// A world's lights, while they are gathered.
#[derive(Default)]
pub(super) struct Lights {
    pub(super) lights: Vec<Light>,
    pub(super) names: Vec<String>,
    pub(super) ambient: Spectrum,
}

impl Lights {
    /// Adds a light and gives its index.
    pub(super) fn push(&mut self, light: Light, name: String) -> u32 {
        self.lights.push(light);
        self.names.push(name);
        self.lights.len() as u32 - 1
    }

    /// Adds a light as it was written; `origin` is where render space begins in the world.
    pub(super) fn add(&mut self, written: &Written, origin: DVec3, images: &[Image]) {
        // Written intensities are those of Whitted's I_j: π times as much in radiometric units.
        let power = |intensity: Color| match intensity {
            Color::Value(rgb) => Spectrum::from_rgb(rgb) * PI,
            _ => Spectrum([PI; 4]),
        };
        let (kind, light) = match &written.kind {
            LightKind::Ambient { color } => {
                self.ambient += Spectrum::from_rgb(*color);
                return;
            }
            LightKind::Point { position, intensity, falloff } => (
                "point light",
                Light::Point {
                    position: *position - origin,
                    intensity: power(*intensity),
                    falloff: *falloff,
                },
            ),
            LightKind::Distant { direction, intensity } => (
                "distant light",
                Light::Distant { toward: -direction.normalize().as_vec3(), irradiance: power(*intensity) },
            ),
            LightKind::Spot { position, direction, intensity, cone_angle, inner_angle, falloff } => (
                "spot light",
                Light::Spot {
                    position: *position - origin,
                    axis: direction.normalize().as_vec3(),
                    intensity: power(*intensity),
                    cos_outer: libm::cos(cone_angle.to_radians()) as f32,
                    cos_inner: libm::cos(inner_angle.to_radians()) as f32,
                    falloff: *falloff,
                },
            ),
            LightKind::Projection { .. } | LightKind::Goniometric { .. } => return,
            LightKind::Environment { sky, illuminates, .. } => (
                "environment",
                Light::Environment(Environment { sky: compile_sky(sky, images), illuminates: *illuminates }),
            ),
        };
        let name = written.name.clone().unwrap_or_else(|| format!("{kind} ({})", written.at));
        self.push(light, name);
    }
}

fn compile_sky(sky: &WrittenSky, images: &[Image]) -> Sky {
    let color = |rgb: &[f32; 3]| Spectrum::from_rgb(*rgb);
    match sky {
        WrittenSky::Constant(Color::Value(rgb)) => Sky::Constant(color(rgb)),
        WrittenSky::Constant(_) | WrittenSky::Octahedral { .. } => Sky::Constant(Spectrum::ONE),
        WrittenSky::Gradient { zenith, horizon, nadir } => {
            Sky::Gradient { zenith: color(zenith), horizon: color(horizon), nadir: color(nadir) }
        }
        WrittenSky::Image { image, scale, world_from_light } => Sky::Image(Box::new(SkyImage {
            image: image.index(),
            scale: color(scale),
            world_from_light: Mat3::from_mat4(world_from_light.as_mat4()),
            choice: by_brightness(&images[image.index()]),
        })),
    }
}

/// Chooses directions by the brightness of the picture there. A bilinear look-up reaches into the neighbours of a texel,
/// so each part weighs as much as the brightest texel around it: nothing that is seen is never chosen.
fn by_brightness(image: &Image) -> Piecewise2D {
    let (width, height) = (image.width as usize, image.height as usize);
    let brightness = |x: usize, y: usize| image.texels[y * width + x].into_iter().fold(0.0, f32::max);
    let mut weights = Vec::with_capacity(width * height);
    for y in 0..height {
        let sin_theta = libm::sinf(PI * (y as f32 + 0.5) / height as f32);
        let rows = y.saturating_sub(1)..(y + 2).min(height);
        for x in 0..width {
            let around = [x + width - 1, x, x + 1].map(|x| x % width);
            let brightest = rows.clone().flat_map(|y| around.map(|x| brightness(x, y))).fold(0.0, f32::max);
            weights.push(brightest * sin_theta);
        }
    }
    Piecewise2D::new(&weights, width, height)
}
