//! Inputs of materials, lights and textures, compiled.
//!
//! pbrt's `SpectrumTexture` and `FloatTexture`. What a scene writes as a colour is compiled for what it is used for; constants are
//! clamped, and lifted to spectra where the picture is spectral, once.

use lookfrom_scene::material::{Color, Scalar};
use lookfrom_scene::scene::{CurveId, TextureId};

use super::evaluation::{RgbEvaluation, within};
use super::{Evaluation, Measured};
use crate::core::color::{Sigmoid, Unbounded};
use crate::core::spectrum::Spectrum;

/// What a spectrum is used for, which decides the one that three primaries stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpectrumType {
    /// A part of the light: a smooth spectrum within 0 … 1; components beyond are clamped.
    Albedo,
    /// Any amount, such as an index of refraction: a smooth spectrum.
    Unbounded,
    /// Light: a smooth spectrum times daylight D65, which is white. A curve is the light itself.
    Illuminant,
}

/// A spectrum that may vary over a surface. Made by [`Textures::spectrum_texture`](super::Textures::spectrum_texture).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectrumTexture {
    pub(super) input: Input,
    pub(super) spectrum_type: SpectrumType,
    /// In RGB mode, where it is the same everywhere.
    pub(super) rgb: Spectrum,
}

/// A number that may vary over a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FloatTexture {
    /// The same everywhere.
    Constant(f32),
    /// The mean of a texture's three channels.
    Texture(TextureId),
}

/// An input of a texture, whose type depends on what the texture is used for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Input {
    /// The same everywhere.
    Constant(Constant),
    /// By wavelength, the same everywhere.
    Curve(CurveId),
    /// From a texture.
    Texture(TextureId),
}

/// A colour, and in spectral mode the spectra that it is lifted to (otherwise it is lifted when it is asked for).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Constant {
    pub(super) rgb: [f32; 3],
    pub(super) uplifts: Option<Uplifts>,
}

/// Spectra of a colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Uplifts {
    pub(super) albedo: Sigmoid,
    pub(super) unbounded: Unbounded,
}

impl SpectrumTexture {
    /// Nothing.
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

    /// Whether it is one colour everywhere.
    #[inline]
    pub fn is_constant(&self) -> bool {
        matches!(self.input, Input::Constant(_))
    }

    /// Whether it varies over the surface.
    #[inline]
    pub fn varies(&self) -> bool {
        matches!(self.input, Input::Texture(_))
    }

    /// Whether it is this colour, the same in all primaries, everywhere.
    #[inline]
    pub fn is_gray(&self, value: f32) -> bool {
        matches!(self.input, Input::Constant(Constant { rgb, .. }) if rgb == [value; 3])
    }
}

impl FloatTexture {
    /// Whether it is this number everywhere.
    #[inline]
    pub fn is(self, value: f32) -> bool {
        self == Self::Constant(value)
    }

    /// Whether it varies over the surface.
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
    /// A written colour; `uplifts` where spectra will be asked for.
    pub(super) fn new(written: Color, uplifts: bool) -> Self {
        match written {
            Color::Value(rgb) => Self::Constant(Constant {
                rgb,
                uplifts: uplifts.then(|| Uplifts {
                    albedo: Sigmoid::from_rgb(within(SpectrumType::Albedo, rgb)),
                    unbounded: Unbounded::from_rgb(within(SpectrumType::Unbounded, rgb)),
                }),
            }),
            Color::Curve(id) => Self::Curve(id),
            Color::Texture(id) => Self::Texture(id),
        }
    }
}
