//! Textures: from a point of a surface to a spectrum or a number.
//!
//! The parameters are those of `lookfrom_scene::texture`; here only the names are resolved. Where pbrt-v4 has the
//! same texture (Pharr, Jakob, Humphreys 2023), it means the same, with pbrt's approximation of footprints
//! (`shading/footprint`) in place of ray differentials.
//!
//! `input`: the inputs of materials and lights; `node`: the textures themselves; `mapping`: texture coordinates;
//! `picture`, `mip`, `pattern`: image lookups, those in MIP maps, and procedural patterns; `look_ups`: those of eight points at once; `evaluation`:
//! conversion to numbers, RGB or spectra; `shared`: values of textures that are used many times at a point.

mod constants;
mod evaluation;
mod input;
pub(crate) mod lanes;
mod look_ups;
mod mapping;
mod mip;
mod node;
mod pattern;
mod picture;
mod shared;

use std::f32::consts::PI;

use glam::{DVec3, Vec2, Vec3};
use lookfrom_scene::image::Image;
use lookfrom_scene::material::{Color, Illuminant};
use lookfrom_scene::scene::{CurveId, TextureId};
use lookfrom_scene::settings::ColorMode;
use lookfrom_scene::shape::Mesh;
use lookfrom_scene::spectrum::Curve;
use lookfrom_scene::texture::{Channel, Mapping, TextureKind, Wrap};

pub(crate) use self::input::uplift;
pub use self::input::{FloatTexture, SpectrumTexture, SpectrumType};
pub use self::look_ups::{LookUps, LookedUp, PictureSet, PicturedFloat};
pub(crate) use self::mapping::sphere_uv;
pub use self::picture::{blended_texels, look_up};
pub(crate) use self::picture::{look_up_lanes, nearest_lanes};

use self::evaluation::{Evaluation, FloatEvaluation, RgbEvaluation, SpectralEvaluation};
use self::input::Input;
use self::look_ups::Picture;
use self::node::Node;
use self::shared::Values;
use crate::core::color::{DenselySampledSpectrum, Wavelengths};
use crate::core::noise;
use crate::core::noise::perlin::{self, Octaves};
use crate::core::spectrum::Spectrum;
use crate::shading::footprint::SurfaceFootprint;

/// The meaning of a sample's four lanes.
#[derive(Clone, Copy, Debug)]
pub enum SpectralMode {
    /// Linear Rec. 709 and a 0.
    Rgb,
    /// Four wavelengths.
    Spectral(Wavelengths),
}

/// All textures, images and curves of a world.
#[derive(Clone, Debug, Default)]
pub struct Textures {
    nodes: Vec<Node>,
    /// For each node, whether the values of its parts are kept while it is evaluated.
    keeps_values: Vec<bool>,
    /// Pictures as the nodes read them.
    pictures: Vec<Picture>,
    images: Vec<Image>,
    /// The coarser levels of the images' MIP maps; none of images that are not filtered.
    coarser_levels: Vec<Vec<Image>>,
    /// Whether each texture depends on the footprint of pixels.
    need_footprints: Vec<bool>,
    curves: Vec<Measured>,
    /// True if constants are uplifted to spectra when they are compiled.
    uplifts: bool,
}

/// A measured curve, and its colours in RGB mode.
#[derive(Clone, Debug)]
struct Measured {
    dense: DenselySampledSpectrum,
    /// As a reflectance or an index of refraction.
    reflectance: [f32; 3],
    /// As an illuminant.
    emission: [f32; 3],
}

/// Number of texture coordinate sets besides the first.
pub const MORE_UV_SETS: usize = Mesh::MOST_UV_SETS - 1;

/// The inputs of texture evaluation.
#[derive(Clone, Copy, Debug)]
pub struct TexturePoint<'a> {
    /// Texture coordinates.
    pub uv: Vec2,
    /// Texture coordinates of further sets.
    pub more_uvs: [Vec2; MORE_UV_SETS],
    /// Position in world space (not render space).
    pub world: DVec3,
    /// The mesh's vertex colour (linear).
    pub color: [f32; 3],
    /// The mesh's vertex opacity.
    pub opacity: f32,
    /// Normal in world space, of unit length, on either side. pbrt-v4 takes the geometric one.
    pub n: Vec3,
    /// Whether it is seen from the side opposite to the surface's geometric normal.
    pub is_inside: bool,
    /// The part of the surface that a pixel shows; `None` for a point alone.
    pub footprint: Option<SurfaceFootprint>,
    /// Pictures that were looked up here beforehand.
    pub looked_up: Option<LookedUp<'a>>,
    /// The values here of textures that are used many times.
    pub(crate) values: Option<&'a Values>,
}

impl SpectralMode {
    /// The multiplicative identity.
    #[inline]
    pub fn one(&self) -> Spectrum {
        match self {
            Self::Rgb => Spectrum::ONE,
            Self::Spectral(_) => Spectrum([1.0; 4]),
        }
    }
}

/// The spectrum of a colour that is not known before it is evaluated, such as a texel's.
#[inline]
pub fn spectrum_of(rgb: [f32; 3], spectrum_type: SpectrumType, mode: &SpectralMode) -> Spectrum {
    match mode {
        SpectralMode::Rgb => RgbEvaluation(spectrum_type).color(rgb),
        SpectralMode::Spectral(wavelengths) => SpectralEvaluation { spectrum_type, wavelengths }.color(rgb),
    }
}

impl TexturePoint<'_> {
    /// For textures that are constant.
    pub const NOWHERE: Self = Self {
        uv: Vec2::ZERO,
        more_uvs: [Vec2::ZERO; MORE_UV_SETS],
        world: DVec3::ZERO,
        color: [1.0; 3],
        opacity: 1.0,
        n: Vec3::Z,
        is_inside: false,
        footprint: None,
        looked_up: None,
        values: None,
    };

    /// The point without what was looked up for it, or near which others are.
    #[inline]
    pub(crate) fn alone(&self) -> TexturePoint<'static> {
        TexturePoint { looked_up: None, values: None, ..*self }
    }
}

impl Textures {
    /// A scene's textures, images and curves, indexed by their ids. `color` is the mode that most images will be
    /// rendered in: constants are prepared for it.
    pub fn new(kinds: &[TextureKind], images: Vec<Image>, curves: Vec<Curve>, color: ColorMode) -> Self {
        let measured = |curve: Curve| {
            let dense = DenselySampledSpectrum::from(&curve);
            Measured { reflectance: dense.to_rgb_reflectance(), emission: dense.to_rgb(), dense }
        };
        let curves = curves.into_iter().map(measured).collect();
        let uplifts = color == ColorMode::Spectral;
        let (nodes, pictures) = Node::compile_all(kinds, &images, uplifts);
        let mut coarser_levels = vec![Vec::new(); images.len()];
        for picture in pictures.iter().filter(|picture| picture.filter.takes_levels()) {
            let (Some(levels), Some(image)) =
                (coarser_levels.get_mut(picture.image), images.get(picture.image))
            else {
                continue;
            };
            if levels.is_empty() {
                *levels = image.coarser_levels();
            }
        }
        Self {
            nodes,
            keeps_values: shared::keeps_values(kinds),
            pictures,
            images,
            coarser_levels,
            need_footprints: TextureKind::need_footprints(kinds),
            curves,
            uplifts,
        }
    }

    /// Whether a texture depends on the footprint of pixels, itself or by what it uses.
    pub(crate) fn needs_footprint(&self, id: TextureId) -> bool {
        self.need_footprints.get(id.index()).copied().unwrap_or(false)
    }

    /// A colour of the scene, compiled for its spectrum type.
    pub fn spectrum_texture(&self, color: Color, spectrum_type: SpectrumType) -> SpectrumTexture {
        SpectrumTexture::new(Input::new(color, self.uplifts), spectrum_type, &self.curves)
    }

    /// η or k of a metal. A curve under light of equal energy has the colour of an emission, which daylight does not weight.
    pub(crate) fn index_of_refraction(&self, color: Color, illuminant: Illuminant) -> SpectrumTexture {
        let spectrum_type = match (color, illuminant) {
            (Color::Curve(_), Illuminant::EqualEnergy) => SpectrumType::Illuminant,
            _ => SpectrumType::Unbounded,
        };
        self.spectrum_texture(color, spectrum_type)
    }

    /// Whether constants are uplifted to spectra when they are compiled: whether those will be evaluated.
    pub(crate) fn uplifts(&self) -> bool {
        self.uplifts
    }

    /// An image by its index.
    pub fn image(&self, index: usize) -> &Image {
        &self.images[index]
    }

    /// A curve by its id.
    pub fn curve(&self, id: CurveId) -> &DenselySampledSpectrum {
        &self.curves[id.index()].dense
    }

    /// The spectrum at a point, in the lanes of a sample. Never negative unless a texture scales by less than 0 or
    /// extrapolates a mix.
    #[inline(always)]
    pub fn spectrum(&self, texture: &SpectrumTexture, at: &TexturePoint, mode: &SpectralMode) -> Spectrum {
        // The most frequent case needs no call.
        match mode {
            SpectralMode::Rgb if !texture.varies() => texture.rgb,
            _ => self.spectrum_of_any(texture, at, mode),
        }
    }

    /// The spectrum of a reflectance: within 0 … 1 in every lane.
    #[inline(always)]
    pub fn albedo(&self, texture: &SpectrumTexture, at: &TexturePoint, mode: &SpectralMode) -> Spectrum {
        self.spectrum(texture, at, mode).map(|lane| lane.clamp(0.0, 1.0))
    }

    fn spectrum_of_any(&self, texture: &SpectrumTexture, at: &TexturePoint, mode: &SpectralMode) -> Spectrum {
        let SpectrumTexture { input, spectrum_type, .. } = texture;
        match mode {
            SpectralMode::Rgb => self.read(input, at, &RgbEvaluation(*spectrum_type)),
            SpectralMode::Spectral(wavelengths) => {
                self.read(input, at, &SpectralEvaluation { spectrum_type: *spectrum_type, wavelengths })
            }
        }
    }

    /// The colour at a point, in linear Rec. 709.
    pub fn rgb(&self, texture: &SpectrumTexture, at: &TexturePoint) -> [f32; 3] {
        self.read(&texture.input, at, &RgbEvaluation(texture.spectrum_type)).rgb()
    }

    /// The number at a point. For an image, the mean of its channels; with nearest filtering, its first channel.
    #[inline]
    pub fn float(&self, texture: FloatTexture, at: &TexturePoint) -> f32 {
        match texture {
            FloatTexture::Constant(value) => value,
            FloatTexture::Texture(id) => self.texture(id, at, &FloatEvaluation),
        }
    }

    /// True if a number is known to be 1 everywhere on a mesh with or without opacities, without examining texels.
    pub fn is_one(&self, number: FloatTexture, has_opacities: bool) -> bool {
        let FloatTexture::Texture(id) = number else { return number.is(1.0) };
        let is_one = |input: &Input| match input {
            Input::Constant(constant) => constant.rgb == [1.0; 3],
            Input::Curve(_) => false,
            Input::Texture(id) => self.is_one(FloatTexture::Texture(*id), has_opacities),
        };
        match &self.nodes[id.index()] {
            Node::Image { picture, channel: Channel::Alpha, scale, invert: false } => {
                let Picture { image, wraps, .. } = &self.pictures[*picture as usize];
                *scale == 1.0 && !wraps.contains(&Wrap::Black) && !self.images[*image].has_alpha()
            }
            Node::VertexAlpha => !has_opacities,
            Node::Product { a, b } => is_one(a) && is_one(b),
            Node::Scale { color, by } => is_one(color) && self.is_one(*by, has_opacities),
            Node::Threshold { value, edge } => *edge <= 1.0 && self.is_one(*value, has_opacities),
            _ => false,
        }
    }

    fn read<R: Evaluation>(&self, input: &Input, at: &TexturePoint, evaluation: &R) -> R::Value {
        match input {
            Input::Constant(constant) => evaluation.constant(constant),
            Input::Curve(id) => evaluation.curve(&self.curves[id.index()]),
            Input::Texture(id) => self.texture(*id, at, evaluation),
        }
    }

    // Out of line: most colours are constant, and their callers stay short.
    #[inline(never)]
    fn texture<R: Evaluation>(&self, id: TextureId, at: &TexturePoint, evaluation: &R) -> R::Value {
        match at.values {
            Some(values) => values.get(id, evaluation.spectrum_type(), || self.evaluate(id, at, evaluation)),
            None if self.keeps_values[id.index()] => {
                let values = Values::default();
                self.evaluate(id, &TexturePoint { values: Some(&values), ..*at }, evaluation)
            }
            None => self.evaluate(id, at, evaluation),
        }
    }

    #[inline(always)]
    fn evaluate<R: Evaluation>(&self, id: TextureId, at: &TexturePoint, evaluation: &R) -> R::Value {
        let space = |mapping| mapping::coordinates(mapping, at).as_vec3();
        match &self.nodes[id.index()] {
            Node::Image { picture, channel, scale, invert } => {
                let [r, g, b, alpha] = self.look_up(*picture, at);
                let rgb = match channel {
                    Channel::Rgb => [r, g, b],
                    Channel::Red => [r; 3],
                    Channel::Green => [g; 3],
                    Channel::Blue => [b; 3],
                    Channel::Alpha => [alpha; 3],
                };
                let filter = self.pictures[*picture as usize].filter;
                evaluation.texel(rgb.map(|c| scale * c), *invert, filter)
            }
            Node::Checker { even, odd, footprint, mapping } => {
                let p = mapping::off_border(mapping, at);
                match averaged(*footprint, mapping, at) {
                    Some(steps) => self.blend(even, odd, pattern::odd_share(p, steps), at, evaluation),
                    None => self.read(if pattern::is_even(p) { even } else { odd }, at, evaluation),
                }
            }
            Node::Noise { low, high, octaves, mapping } => {
                let amount = 0.5 + 0.5 * noise::fbm(mapping::off_border(mapping, at).as_vec3(), *octaves);
                self.blend(low, high, amount.clamp(0.0, 1.0), at, evaluation)
            }
            Node::Marble { vein, base, octaves, turbulence, mapping } => {
                let p = mapping::off_border(mapping, at).as_vec3();
                let wave = libm::sinf(PI * (p.x + turbulence * noise::turbulence(p, *octaves))).abs();
                self.blend(vein, base, wave.sqrt().clamp(0.0, 1.0), at, evaluation)
            }
            Node::Scale { color, by } => match self.float(*by, at) {
                0.0 => evaluation.number(0.0),
                by => self.read(color, at, evaluation) * by,
            },
            Node::Mix { low, high, amount } => self.blend(low, high, self.float(*amount, at), at, evaluation),
            Node::DirectionMix { low, high, direction } => {
                self.blend(low, high, at.n.dot(*direction).abs(), at, evaluation)
            }
            Node::Sides { outside, inside } => {
                self.read(if at.is_inside { inside } else { outside }, at, evaluation)
            }
            Node::Bilinear { corners, mapping } => {
                let Vec3 { x: u, y: v, .. } = space(mapping);
                let [c00, c01, c10, c11]: [R::Value; 4] =
                    std::array::from_fn(|k| self.read(&corners[k], at, evaluation));
                c00 * ((1.0 - u) * (1.0 - v)) + c01 * ((1.0 - u) * v) + c10 * (u * (1.0 - v)) + c11 * (u * v)
            }
            Node::Dots { inside, outside, mapping } => {
                let is_inside = pattern::is_in_dot(space(mapping).truncate());
                self.read(if is_inside { inside } else { outside }, at, evaluation)
            }
            Node::Fbm { octaves, roughness, footprint, mapping } => {
                let octaves = Octaves::new(*octaves, detail(*footprint, mapping, at));
                evaluation.number(perlin::fbm(space(mapping), *roughness, octaves))
            }
            Node::Wrinkled { octaves, roughness, footprint, mapping } => {
                let octaves = Octaves::new(*octaves, detail(*footprint, mapping, at));
                evaluation.number(perlin::turbulence(space(mapping), *roughness, octaves))
            }
            Node::Windy { footprint, mapping } => {
                evaluation.number(pattern::windy(space(mapping), detail(*footprint, mapping, at)))
            }
            Node::PbrtMarble { octaves, roughness, scale, variation, footprint, mapping } => {
                let p = space(mapping) * *scale;
                let octaves = Octaves::new(*octaves, scale.abs() * detail(*footprint, mapping, at));
                evaluation.reflectance(pattern::marble(p, *roughness, octaves, *variation))
            }
            Node::VertexColor { tint } => evaluation.color(std::array::from_fn(|c| at.color[c] * tint[c])),
            Node::VertexAlpha => evaluation.number(at.opacity),
            Node::Product { a, b } => {
                self.read(a, at, evaluation) * self.read(b, at, &evaluation.of_factor())
            }
            Node::Threshold { value, edge } => {
                evaluation.number(if self.float(*value, at) >= *edge { 1.0 } else { 0.0 })
            }
            Node::Quotient { a, b } => {
                let [a, b] = [a, b].map(|number| self.float(*number, at));
                evaluation.number(if b == 0.0 { 0.0 } else { a / b })
            }
        }
    }

    /// Linear interpolation from `low` at 0 to `high` at 1; an input of weight 0 is not evaluated.
    fn blend<R: Evaluation>(
        &self,
        low: &Input,
        high: &Input,
        amount: f32,
        at: &TexturePoint,
        evaluation: &R,
    ) -> R::Value {
        if amount == 0.0 {
            return self.read(low, at, evaluation);
        }
        if amount == 1.0 {
            return self.read(high, at, evaluation);
        }
        self.read(low, at, evaluation) * (1.0 - amount) + self.read(high, at, evaluation) * amount
    }
}

/// The steps that a pattern is averaged over, by the width of its footprint in pixels; `None` where it is not.
fn averaged(footprint: f32, mapping: &Mapping, at: &TexturePoint) -> Option<[DVec3; 2]> {
    match footprint > 0.0 {
        true => mapping::changes(mapping, at).map(|steps| steps.map(|step| step * f64::from(footprint))),
        false => None,
    }
}

/// The width of the detail of noise that is left out; 0 for none.
fn detail(footprint: f32, mapping: &Mapping, at: &TexturePoint) -> f32 {
    averaged(footprint, mapping, at).map_or(0.0, |[x, y]| x.length().max(y.length()) as f32)
}

#[cfg(test)]
mod tests;
