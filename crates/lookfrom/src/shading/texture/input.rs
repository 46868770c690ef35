//! Compiled inputs of materials, lights and textures.
//!
//! pbrt's `SpectrumTexture` and `FloatTexture`. Colours of a scene are compiled for their spectrum type; constants
//! are clamped once and, in spectral mode, uplifted to spectra once.

use lookfrom_scene::material::{Color, Scalar};
use lookfrom_scene::scene::{CurveId, TextureId};

use super::evaluation::{RgbEvaluation, within};
use super::{Evaluation, Measured};
use crate::core::color::{Sigmoid, Unbounded};
use crate::core::spectrum::Spectrum;

/// The use of a spectrum, which determines the spectrum that three primaries are uplifted to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SpectrumType {
    /// A reflectance or transmittance: a smooth spectrum within 0 … 1; components beyond are clamped.
    Albedo,
    /// An unbounded quantity, such as an index of refraction: a smooth spectrum.
    Unbounded,
    /// A light source: a smooth spectrum times daylight D65, which is white. A curve is the emission itself.
    Illuminant,
}

/// A spectrum that may vary over a surface. Made by [`Textures::spectrum_texture`](super::Textures::spectrum_texture).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectrumTexture {
    pub(super) input: Input,
    pub(super) spectrum_type: SpectrumType,
    /// The RGB value where it is constant.
    pub(super) rgb: Spectrum,
}

/// A number that may vary over a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FloatTexture {
    /// A constant.
    Constant(f32),
    /// The mean of a texture's three channels.
    Texture(TextureId),
}

/// An input of a texture, whose type depends on what the texture is used for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Input {
    /// A constant.
    Constant(Constant),
    /// A constant spectrum, given by a curve.
    Curve(CurveId),
    /// From a texture.
    Texture(TextureId),
}

/// A colour, and in spectral mode the spectra that it is uplifted to (otherwise it is uplifted at each
/// evaluation).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Constant {
    pub(super) rgb: [f32; 3],
    pub(super) uplifts: Option<Uplifts>,
}

/// The spectra that a colour is uplifted to, of an illuminant over that of daylight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Uplifts {
    albedo: Unbounded,
    unbounded: Unbounded,
}

impl Uplifts {
    fn new(rgb: [f32; 3]) -> Self {
        let lifted = |spectrum_type| uplift(spectrum_type, rgb);
        Self { albedo: lifted(SpectrumType::Albedo), unbounded: lifted(SpectrumType::Unbounded) }
    }

    /// The spectrum for a use of the colour.
    #[inline]
    pub(super) fn of(&self, spectrum_type: SpectrumType) -> &Unbounded {
        match spectrum_type {
            SpectrumType::Albedo => &self.albedo,
            SpectrumType::Unbounded | SpectrumType::Illuminant => &self.unbounded,
        }
    }
}

/// The spectrum that a colour is uplifted to, of an illuminant over that of daylight. A grey needs no table.
pub(crate) fn uplift(spectrum_type: SpectrumType, rgb: [f32; 3]) -> Unbounded {
    let rgb = within(spectrum_type, rgb);
    match spectrum_type {
        _ if rgb[0] == rgb[1] && rgb[1] == rgb[2] => Unbounded::gray(rgb[0]),
        SpectrumType::Albedo => Unbounded { scale: 1.0, sigmoid: Sigmoid::from_rgb(rgb) },
        SpectrumType::Unbounded | SpectrumType::Illuminant => Unbounded::from_rgb(rgb),
    }
}

impl SpectrumTexture {
    /// Zero everywhere.
    pub const BLACK: Self = Self {
        input: Input::Constant(Constant { rgb: [0.0; 3], uplifts: None }),
        spectrum_type: SpectrumType::Unbounded,
        rgb: Spectrum::BLACK,
    };

    pub(super) fn new(input: Input, spectrum_type: SpectrumType, curves: &[Measured]) -> Self {
        let evaluation = RgbEvaluation(spectrum_type);
        let rgb = match input {
            Input::Constant(constant) => evaluation.constant(&constant),
            Input::Curve(id) => evaluation.curve(&curves[id.index()]),
            Input::Texture(_) => Spectrum::BLACK,
        };
        Self { input, spectrum_type, rgb }
    }

    /// True if it varies over the surface.
    #[inline]
    pub fn varies(&self) -> bool {
        matches!(self.input, Input::Texture(_))
    }

    /// True if it is no reflectance, but may be above 1.
    #[inline]
    pub(crate) fn is_unbounded(&self) -> bool {
        self.spectrum_type == SpectrumType::Unbounded
    }

    /// True if it is this grey everywhere.
    #[inline]
    pub fn is_gray(&self, value: f32) -> bool {
        matches!(self.input, Input::Constant(Constant { rgb, .. }) if rgb == [value; 3])
    }
}

impl FloatTexture {
    /// True if it is this number everywhere.
    #[inline]
    pub fn is(self, value: f32) -> bool {
        self == Self::Constant(value)
    }

    /// True if it varies over the surface.
    #[inline]
    pub fn varies(self) -> bool {
        matches!(self, Self::Texture(_))
    }
}

impl From<Scalar> for FloatTexture {
    fn from(written: Scalar) -> Self {
        match written {
            Scalar::Value(value) => Self::Constant(value),
            Scalar::Texture(id) => Self::Texture(id),
        }
    }
}

impl Input {
    /// Compiles a colour; `uplifts` where spectra will be evaluated.
    pub(super) fn new(written: Color, uplifts: bool) -> Self {
        match written {
            Color::Value(rgb) => {
                Self::Constant(Constant { rgb, uplifts: uplifts.then(|| Uplifts::new(rgb)) })
            }
            Color::Curve(id) => Self::Curve(id),
            Color::Texture(id) => Self::Texture(id),
        }
    }
}
