//! Projection and goniometric lights.

use glam::{DVec3, Mat3};
use lookfrom_scene::image::Image;
use lookfrom_scene::light::{Edge, Projected};
use lookfrom_scene::texture::{TexelFilter, Wrap};

use super::{EmissionSpectrum, LightSample, cos_to_axis, in_cone, toward};
use crate::core::spectrum::Spectrum;
use crate::core::warp;
use crate::shading::texture::{self, SpectralMode, SpectrumType, Textures};

/// A light that projects a picture into a rectangle.
#[derive(Clone, Debug)]
pub struct Projection {
    /// Position.
    pub position: DVec3,
    /// To the light's space: +z is its axis, y is up, x to the right of the picture.
    pub light_from_render: Mat3,
    /// Index of the picture in the world.
    pub image: usize,
    /// The interpolation between its texels.
    pub filter: TexelFilter,
    /// The quantity of the picture.
    pub quantity: Projected,
    /// Cosines of the angles of a cone beyond which it is dark, and of one with full intensity.
    pub cone: Option<[f64; 2]>,
    /// The axis, unit length.
    pub axis: DVec3,
    /// W/sr of a white texel on the axis.
    pub scale: f32,
    /// Half the size of the picture at a distance of 1.
    pub half_size: [f32; 2],
}

impl Projection {
    pub(super) fn sample(
        &self,
        textures: &Textures,
        from: DVec3,
        mode: &SpectralMode,
    ) -> Option<LightSample> {
        let (wi, distance) = toward(from, self.position)?;
        let w = (self.light_from_render * -wi).normalize_or_zero();
        if w.z <= 1e-3 {
            return None;
        }
        let [s, t] = [w.x / (w.z * self.half_size[0]), w.y / (w.z * self.half_size[1])];
        if !(s.abs() <= 1.0 && t.abs() <= 1.0) {
            return None;
        }
        // rows run down
        let st = [0.5 + 0.5 * s, 0.5 - 0.5 * t];
        let rgb = texture::look_up(textures.image(self.image), st, [Wrap::Clamp; 2], self.filter);
        let white = texture::spectrum_of(rgb, SpectrumType::Illuminant, mode);
        let by_angle = self.by_angle(cos_to_axis(from, self.position, self.axis));
        let li = white * (self.scale * by_angle / (distance * distance) as f32);
        (!li.is_black()).then_some(LightSample::of_point(wi, li, self.position))
    }

    /// The factor of the intensity by the cosine of the angle to the axis.
    pub(crate) fn by_angle(&self, cos: f64) -> f32 {
        let in_cone = self.cone.map_or(1.0, |cosines| in_cone(Edge::Linear, cosines, cos));
        match self.quantity {
            Projected::Intensity => in_cone,
            Projected::Irradiance => in_cone / (cos * cos * cos) as f32,
        }
    }

    /// Cosine of the angle from the axis to a corner.
    pub(super) fn cos_corner(&self) -> f32 {
        let [x, y] = self.half_size;
        1.0 / (1.0 + x * x + y * y).sqrt()
    }
}

/// A goniometric light: a point light whose intensity depends on direction.
#[derive(Clone, Debug)]
pub struct Goniometric {
    /// Position.
    pub position: DVec3,
    /// To the light's space.
    pub light_from_render: Mat3,
    /// Index of the picture in the world: an octahedral square.
    pub image: usize,
    /// The interpolation between its texels.
    pub filter: TexelFilter,
    /// W/sr where the picture is 1.
    pub intensity: EmissionSpectrum,
}

impl Goniometric {
    pub(super) fn sample(
        &self,
        textures: &Textures,
        from: DVec3,
        mode: &SpectralMode,
    ) -> Option<LightSample> {
        let (wi, distance) = toward(from, self.position)?;
        let w = (self.light_from_render * -wi).normalize_or_zero();
        let st = warp::octahedral_square(w.into());
        let image = textures.image(self.image);
        let [r, g, b] = match self.filter {
            TexelFilter::Nearest => texture::look_up(image, st, [Wrap::Clamp; 2], TexelFilter::Nearest),
            TexelFilter::Bilinear | TexelFilter::Mip { .. } => between_octahedral_texels(image, st),
        };
        let brightness = (r + g + b) / 3.0;
        let li: Spectrum = self.intensity.even(textures, mode) * (brightness / (distance * distance) as f32);
        (!li.is_black()).then_some(LightSample::of_point(wi, li, self.position))
    }
}

/// The colour of an octahedral square, bilinearly interpolated between texel centres: at `(s, t)` in [0, 1]².
fn between_octahedral_texels(image: &Image, st: [f32; 2]) -> [f32; 3] {
    let size = image.width as i32;
    let at = st.map(|place| place * size as f32 - 0.5);
    let [x, y] = at.map(|place| place.floor() as i32);
    let [fx, fy] = [at[0] - x as f32, at[1] - y as f32];
    let mut color = [0.0; 3];
    for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let weight = (if dx == 1 { fx } else { 1.0 - fx }) * (if dy == 1 { fy } else { 1.0 - fy });
        let [column, row] = folded([x + dx, y + dy], size);
        let texel = image.texel((row * size + column) as usize);
        color = std::array::from_fn(|c| color[c] + weight * texel[c]);
    }
    color
}

/// The texel of an octahedral square that is at a place up to one texel beyond its edges: each half of an edge is folded onto the other.
fn folded([mut x, mut y]: [i32; 2], size: i32) -> [i32; 2] {
    if x < 0 || x >= size {
        [x, y] = [x.clamp(0, size - 1), size - 1 - y];
    }
    if y < 0 || y >= size {
        [x, y] = [size - 1 - x, y.clamp(0, size - 1)];
    }
    [x, y]
}
