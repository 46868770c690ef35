//! Compilation of lights that are not shapes.

use std::f32::consts::PI;
use std::sync::Arc;

use glam::{DMat4, DVec3, Mat3, Vec3};
use lookfrom_scene::image::Image;
use lookfrom_scene::light::{
    Edge, Light as Written, LightKind, MapRows, Power, Projected, Sky as WrittenSky,
};
use lookfrom_scene::material::Color;
use lookfrom_scene::texture::TexelFilter;

use crate::core::distribution::Piecewise2D;
use crate::core::math;
use crate::core::warp;
use crate::light::{
    EmissionSpectrum, Environment, Goniometric, Light, MapLayout, Opening, Portal, Projection, Scale, Sky,
    SkyImage, Total, brightest_around,
};
use crate::shading::texture::{SpectrumTexture, SpectrumType, TexturePoint, Textures};

/// Places on each side of the square of texture coordinates at which the power of a picture is measured, and its brightness, by which lights
/// are chosen.
const PLACES_OF_POWER: u32 = 512;
const PLACES_OF_BRIGHTNESS: u32 = 16;

/// A world's lights, while they are collected.
pub(super) struct Lights<'a> {
    pub(super) lights: Vec<Light>,
    pub(super) names: Vec<String>,
    /// By light: its largest radiance (or intensity), approximately.
    pub(super) brightness: Vec<f32>,
    pub(super) ambient: [f32; 3],
    pub(super) textures: &'a Textures,
    /// The origin of render space in the world.
    pub(super) origin: DVec3,
}

impl<'a> Lights<'a> {
    pub(super) fn new(textures: &'a Textures, origin: DVec3) -> Self {
        let (lights, names, brightness) = (Vec::new(), Vec::new(), Vec::new());
        Self { lights, names, brightness, ambient: [0.0; 3], textures, origin }
    }

    /// Adds a light of a brightness and returns its index.
    pub(super) fn push(&mut self, light: Light, brightness: f32, name: String) -> u32 {
        self.lights.push(light);
        self.names.push(name);
        self.brightness.push(brightness);
        self.lights.len() as u32 - 1
    }

    /// The emission spectrum of a colour with the given power; `of_white` is the total power of the light if its colour
    /// is white of luminance 1.
    pub(super) fn emission_spectrum(&self, color: Color, power: &Power, of_white: f32) -> EmissionSpectrum {
        EmissionSpectrum { color: self.illuminant(color), scale: self.scale(color, power, of_white).value() }
    }

    /// The scale of that emission spectrum.
    pub(super) fn scale(&self, color: Color, power: &Power, of_white: f32) -> Scale {
        // Other colours have luminance 1 if they are white; the luminance of a curve follows from its values.
        let of_curve = match color {
            Color::Curve(curve) if !power.absolute => Some(self.textures.curve(curve).to_xyz()[1]),
            _ => None,
        };
        let total = power.total.map(|power| {
            let luminance = match of_curve {
                Some(_) => 1.0,
                None => self.mean_over_places(PLACES_OF_POWER, &self.illuminant(color), math::luminance),
            };
            Total { power, of_white, luminance }
        });
        Scale { factor: power.scale, of_curve, total }
    }

    pub(super) fn illuminant(&self, color: Color) -> SpectrumTexture {
        self.textures.spectrum_texture(color, SpectrumType::Illuminant)
    }

    /// The largest of the three components of an emission spectrum, in the mean over its texture.
    pub(super) fn brightness_of(&self, emission_spectrum: &EmissionSpectrum) -> f32 {
        emission_spectrum.scale
            * self.mean_over_places(PLACES_OF_BRIGHTNESS, &emission_spectrum.color, |rgb| {
                rgb.into_iter().fold(0.0, f32::max)
            })
    }

    /// The mean of a measure of a colour over a grid of texture coordinates, of as many places on each side.
    fn mean_over_places(&self, side: u32, color: &SpectrumTexture, measure: impl Fn([f32; 3]) -> f32) -> f32 {
        let at = |uv: [f32; 2]| {
            let point = TexturePoint { uv: uv.into(), ..TexturePoint::NOWHERE };
            measure(self.textures.rgb(color, &point))
        };
        match color.varies() {
            true => {
                let places = (0..side * side).map(|k| [k % side, k / side]);
                let value = |place: [u32; 2]| at(place.map(|i| (i as f32 + 0.5) / side as f32));
                (places.map(|place| f64::from(value(place))).sum::<f64>() / f64::from(side * side)) as f32
            }
            false => at([0.5; 2]),
        }
    }

    /// Adds a light of the scene.
    pub(super) fn add(&mut self, written: &Written) {
        let (power, origin) = (&written.power, self.origin);
        // The scene's intensities are those of Whitted's I_j: π times as much in radiometric units, unless the total
        // power is given.
        let whitted = |emission_spectrum: EmissionSpectrum| EmissionSpectrum {
            scale: if power.total.is_some() { emission_spectrum.scale } else { emission_spectrum.scale * PI },
            ..emission_spectrum
        };
        let (kind, light, brightness) = match &written.kind {
            LightKind::Ambient { color } => {
                self.ambient = std::array::from_fn(|c| self.ambient[c] + color[c]);
                return;
            }
            LightKind::Point { position, intensity, falloff } => {
                let intensity = whitted(self.emission_spectrum(*intensity, power, 4.0 * PI));
                let position = *position - origin;
                let brightness = self.brightness_of(&intensity);
                ("point light", Light::Point { position, intensity, falloff: *falloff }, brightness)
            }
            LightKind::Distant { direction, intensity } => {
                let irradiance = whitted(self.emission_spectrum(*intensity, power, 1.0));
                let brightness = self.brightness_of(&irradiance);
                let toward = -direction.normalize().as_vec3();
                ("distant light", Light::Distant { toward, irradiance }, brightness)
            }
            LightKind::Spot { position, direction, intensity, cone_angle, inner_angle, edge, falloff } => {
                let angles = [cone_angle, inner_angle].map(|angle| angle.to_radians());
                let [cos_outer, cos_inner] = angles.map(libm::cos);
                let per_unit = 2.0
                    * PI
                    * match edge {
                        Edge::Smooth => smooth_cone(angles),
                        Edge::Linear => linear_cone(angles),
                    };
                let intensity = whitted(self.emission_spectrum(*intensity, power, per_unit));
                let brightness = self.brightness_of(&intensity);
                let light = Light::Spot {
                    position: *position - origin,
                    axis: direction.normalize(),
                    intensity,
                    cos_outer,
                    cos_inner,
                    edge: *edge,
                    falloff: *falloff,
                };
                ("spot light", light, brightness)
            }
            LightKind::Projection { image, filter, quantity, intensity, cone, fov, world_from_light } => {
                let light = Projection {
                    filter: *filter,
                    quantity: *quantity,
                    cone: cone.map(|angles| angles.map(|angle| libm::cos(angle.to_radians()))),
                    ..self.projection(image.index(), *fov, world_from_light, origin)
                };
                let white = self.emission_spectrum(Color::gray(*intensity), power, self.power_of(&light));
                let scale = whitted(white).scale * intensity;
                let light = Projection { scale, ..light };
                let brightness = scale * mean(self.textures.image(image.index()));
                ("projection light", Light::Projection(light), brightness)
            }
            LightKind::Goniometric { intensity, image, filter, world_from_light } => {
                let mean = mean(self.textures.image(image.index()));
                let intensity = whitted(self.emission_spectrum(*intensity, power, 4.0 * PI * mean));
                let brightness = self.brightness_of(&intensity) * mean;
                let light = Goniometric {
                    position: world_from_light.w_axis.truncate() - origin,
                    light_from_render: Mat3::from_mat4(world_from_light.inverse().as_mat4()),
                    image: image.index(),
                    filter: *filter,
                    intensity,
                };
                ("goniometric light", Light::Goniometric(light), brightness)
            }
            LightKind::Environment { sky, portal, illuminates } => {
                let (sky, brightness) = self.sky(sky, power, portal.is_some());
                let portal = portal.map(|corners| {
                    let opening = Opening::new(corners.map(|corner| corner - origin));
                    Box::new(self.portal(opening, &sky))
                });
                let light =
                    Light::Environment(Environment { sky, portal, illuminates: *illuminates, guide: None });
                ("environment", light, brightness)
            }
        };
        let name = written.name.clone().unwrap_or_else(|| format!("{kind} ({})", written.at));
        self.push(light, brightness, name);
    }

    fn projection(&self, image: usize, fov: f32, world_from_light: &DMat4, origin: DVec3) -> Projection {
        let picture = self.textures.image(image);
        let aspect = picture.width as f32 / picture.height as f32;
        let half = libm::tanf(0.5 * fov.to_radians());
        let light_from_render = Mat3::from_mat4(world_from_light.inverse().as_mat4());
        Projection {
            position: world_from_light.w_axis.truncate() - origin,
            light_from_render,
            image,
            filter: TexelFilter::Nearest,
            quantity: Projected::Intensity,
            cone: None,
            axis: world_from_light.z_axis.truncate().normalize(),
            scale: 1.0,
            half_size: if aspect > 1.0 { [half * aspect, half] } else { [half, half / aspect] },
        }
    }

    /// The power of a projection whose white texels have an intensity of 1 W/sr.
    fn power_of(&self, light: &Projection) -> f32 {
        let image = self.textures.image(light.image);
        let [half_x, half_y] = light.half_size;
        let place = |i: u32, size: u32, half: f32| half * (2.0 * (i as f32 + 0.5) / size as f32 - 1.0);
        let of_render = light.light_from_render.inverse();
        // A cone varies within the texels of small pictures.
        let parts = if light.cone.is_some() { 256_u32.div_ceil(image.width.min(image.height)) } else { 1 };
        let [width, height] = [image.width, image.height].map(|size| size * parts);
        let mut sum = 0.0;
        for (row, column) in (0..height).flat_map(|row| (0..width).map(move |column| (row, column))) {
            let (x, y) = (place(column, width, half_x), place(row, height, half_y));
            let cos = 1.0 / (1.0 + x * x + y * y).sqrt();
            let toward = (of_render * Vec3::new(x, y, 1.0)).as_dvec3().normalize();
            let texel = image.texel((row / parts * image.width + column / parts) as usize);
            sum +=
                f64::from(math::luminance(texel) * cos * cos * cos * light.by_angle(light.axis.dot(toward)));
        }
        4.0 * half_x * half_y * (sum / (f64::from(width) * f64::from(height))) as f32
    }

    fn portal(&self, opening: Opening, sky: &Sky) -> Portal {
        match sky {
            Sky::Image(sky) => sky.through(opening, self.textures),
            _ => Portal::plain(opening),
        }
    }

    fn sky(&self, sky: &WrittenSky, power: &Power, has_portal: bool) -> (Sky, f32) {
        let (image, scale, world_from_light, layout, rows) = match sky {
            WrittenSky::Constant(color) => {
                let emission_spectrum = self.emission_spectrum(*color, power, PI);
                return (Sky::Constant(emission_spectrum), self.brightness_of(&emission_spectrum));
            }
            WrittenSky::Gradient { zenith, horizon, nadir } => {
                // Irradiance on a surface that faces up: the integral of ((1 − y) horizon + y zenith) y.
                let upward = std::array::from_fn(|c| (horizon[c] + 2.0 * zenith[c]) / 3.0);
                let scale = self.emission_spectrum(Color::Value(upward), power, PI).scale;
                let [zenith, horizon, nadir] = [zenith, horizon, nadir]
                    .map(|rgb| EmissionSpectrum { color: self.illuminant(Color::Value(*rgb)), scale });
                return (Sky::Gradient { zenith, horizon, nadir }, self.brightness_of(&horizon));
            }
            WrittenSky::Image { image, scale, world_from_light, rows } => {
                (image.index(), scale, world_from_light, MapLayout::LatitudeLongitude, *rows)
            }
            WrittenSky::Octahedral { image, scale, world_from_light } => {
                (image.index(), scale, world_from_light, MapLayout::Octahedral, MapRows::Bands)
            }
        };
        let picture = self.textures.image(image);
        let factor =
            self.emission_spectrum(Color::gray(1.0), power, illuminance(picture, *scale, layout)).scale;
        let weights = weights(picture, layout);
        let solid_angles = weights.iter().map(|&(_, area)| f64::from(area)).sum::<f64>();
        let average =
            weights.iter().map(|&(light, area)| f64::from(light * area)).sum::<f64>() / solid_angles;
        let choice = |light: &dyn Fn(f32) -> f32| {
            // A portal samples within the part that is visible through it.
            if has_portal {
                return (Piecewise2D::new(&[], 0, 0), 0.0);
            }
            let weights: Vec<f32> =
                weights.iter().map(|&(brightness, area)| light(brightness) * area).collect();
            let (width, height) = (picture.width as usize, picture.height as usize);
            let sum = weights.iter().map(|&weight| f64::from(weight)).sum();
            (Piecewise2D::new(&weights, width, height), sum)
        };
        let (complete, sum) = choice(&|brightness| brightness);
        let (compensated, excess) = choice(&|brightness| (brightness - average as f32).max(0.0));
        let scale = scale.map(|c| c * factor);
        let height = picture.height as f32;
        let brightness = average as f32 * scale.into_iter().fold(0.0, f32::max);
        let sky = SkyImage {
            image,
            scale,
            layout,
            picture_v: match rows {
                MapRows::Bands => [1.0, 0.0],
                // The middles of the first and last row are at v = 0 and 1.
                MapRows::ToPoles => [(height - 1.0) / height, 0.5 / height],
            },
            world_from_light: Mat3::from_mat4(world_from_light.as_mat4()),
            complete: Arc::new(complete),
            compensated: Arc::new(compensated),
            mean: average as f32,
            sums: [sum, excess],
        };
        (Sky::Image(Box::new(sky)), brightness)
    }
}

/// The integral of [`Edge::Smooth`] over the solid angle of a cone, divided by 2π; its half-angles in radians.
fn smooth_cone([outer, inner]: [f64; 2]) -> f32 {
    // 1 − cos, without cancellation.
    let [outer, inner] = [outer, inner].map(|angle| 2.0 * libm::sin(0.5 * angle) * libm::sin(0.5 * angle));
    (0.5 * (outer + inner)) as f32
}

/// The integral of [`Edge::Linear`] over the solid angle of a cone, divided by 2π; its half-angles in radians.
fn linear_cone([outer, inner]: [f64; 2]) -> f32 {
    if outer == inner {
        return smooth_cone([outer, inner]);
    }
    (1.0 - (libm::sin(outer) - libm::sin(inner)) / (outer - inner)) as f32
}

/// Mean of all channels of all texels.
fn mean(image: &Image) -> f32 {
    let sum: f64 = image.texels().flatten().map(f64::from).sum();
    (sum / (3 * image.len()) as f64) as f32
}

/// The illuminance from an environment map, multiplied by `scale`, on a surface that faces up in the light's space:
/// along +y for latitude and longitude, along +z for the octahedral square.
fn illuminance(image: &Image, scale: [f32; 3], layout: MapLayout) -> f32 {
    let (width, height) = (image.width as f32, image.height as f32);
    let mut sum = 0.0;
    for (index, texel) in (0..).zip(image.texels()) {
        let s = ((index % image.width) as f32 + 0.5) / width;
        let t = ((index / image.width) as f32 + 0.5) / height;
        let (cos, solid_angle) = match layout {
            MapLayout::LatitudeLongitude => (libm::cosf(PI * t), 2.0 * PI * PI * libm::sinf(PI * t)),
            MapLayout::Octahedral => (warp::octahedral_direction([s, t]).dot(Vec3::Z), 4.0 * PI),
        };
        let color = std::array::from_fn(|c| (texel[c] * scale[c]).max(0.0));
        sum += f64::from(math::luminance(color) * cos.max(0.0) * solid_angle);
    }
    (sum / f64::from(width * height)) as f32
}

/// Upper bound of the brightness of each texel of an environment map, and its relative solid angle.
fn weights(image: &Image, layout: MapLayout) -> Vec<(f32, f32)> {
    let (width, height) = (image.width as usize, image.height as usize);
    if layout == MapLayout::Octahedral {
        let texels = (0..width * height).map(|index| [index % width, index / width]);
        return texels.map(|texel| (brightest_around(image, layout, texel), 1.0)).collect();
    }
    // The brightest of each texel and its neighbours in a row, then of these in three rows: as `brightest_around` has it.
    let widened = |y: usize| -> Vec<f32> {
        let brightness = |x: usize| image.texel(y * width + x).into_iter().fold(0.0, f32::max);
        let row: Vec<f32> = (0..width).map(brightness).collect();
        let around = |x: usize| row[(x + width - 1) % width].max(row[x]).max(row[(x + 1) % width]);
        (0..width).map(around).collect()
    };
    let rows: Vec<Vec<f32>> = (0..height).map(widened).collect();
    let mut weights = Vec::with_capacity(width * height);
    for y in 0..height {
        let sin_theta = libm::sinf(PI * (y as f32 + 0.5) / height as f32);
        let around = &rows[y.saturating_sub(1)..(y + 2).min(height)];
        let brightest = |x: usize| around.iter().map(|row| row[x]).fold(0.0, f32::max);
        weights.extend((0..width).map(|x| (brightest(x), sin_theta)));
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_the_brightest_around_each_texel() {
        for [width, height] in [[1, 1], [2, 1], [1, 3], [5, 4], [8, 3]] {
            let value = |index: u32| (index.wrapping_mul(2_654_435_761) >> 8) as f32 - 4e6;
            let texels = (0..width * height).map(|index| [0, 1, 2].map(|c| value(3 * index + c))).collect();
            let image = Image::from_linear("map", width, height, texels);
            for layout in [MapLayout::LatitudeLongitude, MapLayout::Octahedral] {
                for (index, (brightest, _)) in weights(&image, layout).into_iter().enumerate() {
                    let texel = [index % width as usize, index / width as usize];
                    assert_eq!(brightest, brightest_around(&image, layout, texel), "{layout:?} {texel:?}");
                }
            }
        }
    }
}
