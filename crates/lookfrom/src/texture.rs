//! Colour over surfaces: from a point of a surface to a spectrum or a number.
//!
//! The textures' parameters are those of `lookfrom_scene::texture`; here they only lose their names. What pbrt-v4 has too
//! (Pharr, Jakob, Humphreys 2023) means here what it means there, but for one thing: there are no ray differentials, so
//! pictures are not filtered beyond bilinear, squares have sharp edges and noise has all its octaves.
//!
//! `mapping`: where in a pattern; `picture`, `pattern`: what is there; `reading`: what that becomes.

mod constants;
mod mapping;
mod pattern;
mod picture;
mod reading;

use std::f32::consts::PI;

use glam::{DVec3, Vec2, Vec3};
use lookfrom_scene::image::Image;
use lookfrom_scene::material::{Color, Scalar};
use lookfrom_scene::scene::{CurveId, TextureId};
use lookfrom_scene::shape::Mesh;
use lookfrom_scene::spectrum::Curve;
use lookfrom_scene::texture::{Channel, TextureKind, Wrap};

pub use self::mapping::sphere_uv;
pub use self::picture::look_up;

use self::constants::Constants;
use self::picture::look_up_channel;
use self::reading::{Lifted, Number, Reading, Rgb};
use crate::color::{Dense, Wavelengths};
use crate::noise::{self, perlin};
use crate::spectrum::Spectrum;

/// What a colour is used for decides which spectrum three primaries stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Usage {
    /// A part of the light: a smooth spectrum within 0 … 1; components beyond are clamped.
    Albedo,
    /// Any amount, such as an index of refraction: a smooth spectrum.
    Unbounded,
    /// Light: a smooth spectrum times daylight D65, which is white. A curve is the light itself.
    Illuminant,
}

/// What the four lanes mean for a sample.
#[derive(Clone, Copy, Debug)]
pub enum Lanes {
    /// Linear Rec. 709 and a 0.
    Rgb,
    /// Four wavelengths.
    Spectral(Wavelengths),
}

/// Every texture, picture and curve of a world.
#[derive(Clone, Debug, Default)]
pub struct Textures {
    kinds: Vec<TextureKind>,
    images: Vec<Image>,
    curves: Vec<Measured>,
    constants: Constants,
}

/// A curve, and what it is in RGB mode.
#[derive(Clone, Debug)]
struct Measured {
    dense: Dense,
    /// As a reflectance or an index of refraction.
    reflectance: [f32; 3],
    /// As light.
    emission: [f32; 3],
}

/// How many sets of texture coordinates there are besides the first.
pub const MORE_UV_SETS: usize = Mesh::MOST_UV_SETS - 1;

/// What a texture may depend on.
#[derive(Clone, Copy, Debug)]
pub struct TexturePoint {
    /// Texture coordinates.
    pub uv: Vec2,
    /// Those of further sets.
    pub more_uvs: [Vec2; MORE_UV_SETS],
    /// In the world (not render space).
    pub world: DVec3,
    /// The mesh's own linear colour.
    pub color: [f32; 3],
    /// The mesh's own opacity.
    pub opacity: f32,
    /// Normal in the world, of unit length; on which side does not matter. pbrt-v4 takes the geometric one.
    pub n: Vec3,
}

impl Lanes {
    /// The factor that changes nothing.
    #[inline]
    pub fn one(&self) -> Spectrum {
        match self {
            Self::Rgb => Spectrum::ONE,
            Self::Spectral(_) => Spectrum([1.0; 4]),
        }
    }
}

impl TexturePoint {
    /// For colours that are the same everywhere.
    pub const NOWHERE: Self = Self {
        uv: Vec2::ZERO,
        more_uvs: [Vec2::ZERO; MORE_UV_SETS],
        world: DVec3::ZERO,
        color: [1.0; 3],
        opacity: 1.0,
        n: Vec3::Z,
    };
}

impl Textures {
    /// Takes over a scene's textures, pictures and curves, whose ids are then indices here.
    pub fn new(mut kinds: Vec<TextureKind>, images: Vec<Image>, curves: Vec<Curve>) -> Self {
        for index in 0..kinds.len() {
            if let Some(picture) = scaled_picture(&kinds, index) {
                kinds[index] = picture;
            }
        }
        let measured = |curve: Curve| {
            let dense = Dense::from(&curve);
            Measured { reflectance: dense.to_rgb_reflectance(), emission: dense.to_rgb(), dense }
        };
        let curves = curves.into_iter().map(measured).collect();
        Self { kinds, images, curves, constants: Constants::default() }
    }

    /// Makes ready for being asked for these colours often: the constants of a scene.
    pub fn expect(&mut self, colors: &[[f32; 3]]) {
        self.constants = Constants::new(colors);
    }

    /// A picture by its index.
    pub fn image(&self, index: usize) -> &Image {
        &self.images[index]
    }

    /// A curve by its id.
    pub fn curve(&self, id: CurveId) -> &Dense {
        &self.curves[id.index()].dense
    }

    /// The colour at a point, in the lanes of a sample. Never negative where no texture scales by less than 0 or mixes beyond
    /// its ends.
    #[inline(always)]
    pub fn spectrum(&self, color: Color, usage: Usage, at: &TexturePoint, lanes: &Lanes) -> Spectrum {
        // What is asked most often needs no call.
        if let (Color::Value(rgb), Lanes::Rgb) = (color, lanes) {
            return Rgb(usage).color(rgb);
        }
        self.spectrum_of_any(color, usage, at, lanes)
    }

    /// The same for a reflectance: 0 … 1 in every lane.
    #[inline(always)]
    pub fn albedo(&self, color: Color, at: &TexturePoint, lanes: &Lanes) -> Spectrum {
        self.spectrum(color, Usage::Albedo, at, lanes).map(|lane| lane.clamp(0.0, 1.0))
    }

    fn spectrum_of_any(&self, color: Color, usage: Usage, at: &TexturePoint, lanes: &Lanes) -> Spectrum {
        match lanes {
            Lanes::Rgb => self.read(color, at, &Rgb(usage)),
            Lanes::Spectral(wavelengths) => {
                let lifted = Lifted { usage, lambda: &wavelengths.lambda, constants: &self.constants };
                self.read(color, at, &lifted)
            }
        }
    }

    /// The colour at a point, in linear Rec. 709.
    pub fn rgb(&self, color: Color, usage: Usage, at: &TexturePoint) -> [f32; 3] {
        self.read(color, at, &Rgb(usage)).rgb()
    }

    /// The number at a point. A picture's is the mean of its channels; its first channel, where the nearest texel is asked
    /// for.
    pub fn scalar(&self, scalar: Scalar, at: &TexturePoint) -> f32 {
        self.number(scalar, at)
    }

    /// Whether a number is 1 everywhere on a mesh with or without opacities: as far as that can be told without looking at
    /// texels.
    pub fn is_one(&self, scalar: Scalar, has_opacities: bool) -> bool {
        let Scalar::Texture(id) = scalar else { return scalar == Scalar::Value(1.0) };
        let is_one = |color: Color| match color {
            Color::Value(rgb) => rgb == [1.0; 3],
            Color::Curve(_) => false,
            Color::Texture(id) => self.is_one(Scalar::Texture(id), has_opacities),
        };
        match &self.kinds[id.index()] {
            TextureKind::Image { image, wrap, channel: Channel::Alpha, scale, invert: false, .. } => {
                *scale == 1.0 && !wrap.contains(&Wrap::Black) && !self.images[image.index()].has_alpha()
            }
            TextureKind::VertexAlpha => !has_opacities,
            TextureKind::Product { a, b } => is_one(*a) && is_one(*b),
            TextureKind::Scale { color, by } => is_one(*color) && self.is_one(*by, has_opacities),
            TextureKind::Threshold { value, edge } => *edge <= 1.0 && self.is_one(*value, has_opacities),
            _ => false,
        }
    }

    fn number(&self, scalar: Scalar, at: &TexturePoint) -> f32 {
        match scalar {
            Scalar::Value(value) => value,
            Scalar::Texture(id) => self.texture(id, at, &Number),
        }
    }

    fn read<R: Reading>(&self, color: Color, at: &TexturePoint, reading: &R) -> R::Value {
        match color {
            Color::Value(rgb) => reading.color(rgb),
            Color::Curve(id) => reading.curve(&self.curves[id.index()]),
            Color::Texture(id) => self.texture(id, at, reading),
        }
    }

    // Most colours are the same everywhere: what asks for them stays short.
    #[inline(never)]
    fn texture<R: Reading>(&self, id: TextureId, at: &TexturePoint, reading: &R) -> R::Value {
        let space = |mapping| mapping::coordinates(mapping, at).as_vec3();
        match &self.kinds[id.index()] {
            TextureKind::Image { image, mapping, wrap, filter, channel, scale, invert } => {
                let place = space(mapping);
                // v runs up, rows run down
                let st = [place.x, 1.0 - place.y];
                let image = &self.images[image.index()];
                let rgb = match channel {
                    Channel::Rgb => look_up(image, st, *wrap, *filter),
                    channel => [look_up_channel(image, *channel, st, *wrap, *filter); 3],
                };
                reading.texel(rgb.map(|c| scale * c), *invert, *filter)
            }
            TextureKind::Checker { even, odd, mapping } => {
                let is_even = pattern::is_even(mapping::off_border(mapping, at));
                self.read(if is_even { *even } else { *odd }, at, reading)
            }
            TextureKind::Noise { low, high, octaves, mapping } => {
                let amount = 0.5 + 0.5 * noise::fbm(mapping::off_border(mapping, at).as_vec3(), *octaves);
                self.blend(*low, *high, amount.clamp(0.0, 1.0), at, reading)
            }
            TextureKind::Marble { vein, base, octaves, turbulence, mapping } => {
                let p = mapping::off_border(mapping, at).as_vec3();
                let wave = libm::sinf(PI * (p.x + turbulence * noise::turbulence(p, *octaves))).abs();
                self.blend(*vein, *base, wave.sqrt().clamp(0.0, 1.0), at, reading)
            }
            TextureKind::Scale { color, by } => match self.number(*by, at) {
                0.0 => reading.number(0.0),
                by => self.read(*color, at, reading) * by,
            },
            TextureKind::Mix { low, high, amount } => {
                self.blend(*low, *high, self.number(*amount, at), at, reading)
            }
            TextureKind::DirectionMix { low, high, direction } => {
                self.blend(*low, *high, at.n.dot(*direction).abs(), at, reading)
            }
            TextureKind::Bilinear { corners, mapping } => {
                let Vec3 { x: u, y: v, .. } = space(mapping);
                let [c00, c01, c10, c11] = corners.map(|corner| self.read(corner, at, reading));
                c00 * ((1.0 - u) * (1.0 - v)) + c01 * ((1.0 - u) * v) + c10 * (u * (1.0 - v)) + c11 * (u * v)
            }
            TextureKind::Dots { inside, outside, mapping } => {
                let is_inside = pattern::is_in_dot(space(mapping).truncate());
                self.read(if is_inside { *inside } else { *outside }, at, reading)
            }
            TextureKind::Fbm { octaves, roughness, mapping } => {
                reading.number(perlin::fbm(space(mapping), *roughness, *octaves))
            }
            TextureKind::Wrinkled { octaves, roughness, mapping } => {
                reading.number(perlin::turbulence(space(mapping), *roughness, *octaves))
            }
            TextureKind::Windy { mapping } => reading.number(pattern::windy(space(mapping))),
            TextureKind::PbrtMarble { octaves, roughness, scale, variation, mapping } => {
                let p = space(mapping) * *scale;
                reading.reflectance(pattern::marble(p, *roughness, *octaves, *variation))
            }
            TextureKind::VertexColor { tint } => {
                reading.color(std::array::from_fn(|c| at.color[c] * tint[c]))
            }
            TextureKind::VertexAlpha => reading.number(at.opacity),
            TextureKind::Product { a, b } => {
                self.read(*a, at, reading) * self.read(*b, at, &reading.of_factor())
            }
            TextureKind::Threshold { value, edge } => {
                reading.number(if self.number(*value, at) >= *edge { 1.0 } else { 0.0 })
            }
        }
    }

    /// From `low` at 0 to `high` at 1; what does not count is not looked at.
    fn blend<R: Reading>(
        &self,
        low: Color,
        high: Color,
        amount: f32,
        at: &TexturePoint,
        reading: &R,
    ) -> R::Value {
        if amount == 0.0 {
            return self.read(low, at, reading);
        }
        if amount == 1.0 {
            return self.read(high, at, reading);
        }
        self.read(low, at, reading) * (1.0 - amount) + self.read(high, at, reading) * amount
    }
}

/// What a picture scaled by constants is: a picture of another scale, as in pbrt-v4, where an albedo beyond 1 is clamped (and
/// a picture inverted) after that scale. `None` for any other texture.
fn scaled_picture(kinds: &[TextureKind], index: usize) -> Option<TextureKind> {
    let mut factor = 1.0;
    let mut kind = &kinds[index];
    while let TextureKind::Scale { color: Color::Texture(id), by: Scalar::Value(by) } = kind {
        factor *= by;
        kind = &kinds[id.index()];
    }
    let mut picture = kind.clone();
    match &mut picture {
        TextureKind::Image { scale, .. } if factor != 1.0 => *scale *= factor,
        TextureKind::Image { .. } => {}
        _ => return None,
    }
    Some(picture)
}

#[cfg(test)]
mod tests;
