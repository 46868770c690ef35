//! Texture evaluation: values as numbers, RGB, or spectra at four wavelengths.
//!
//! An evaluation converts the leaves (constants, texels, curves); the inner nodes blend the results. So in spectral
//! mode spectra are blended, as in pbrt-v4.

use std::ops::{Add, Mul};

use lookfrom_scene::texture::{MipFilter, TexelFilter};

use super::input::{Constant, uplift};
use super::shared::Kept;
use super::{Measured, SpectrumType};
use crate::core::color::{Unbounded, Wavelengths};
use crate::core::spectrum::Spectrum;

/// A way to evaluate leaves.
pub(super) trait Evaluation {
    /// Result of the evaluation.
    type Value: Kept + Add<Output = Self::Value> + Mul<Output = Self::Value> + Mul<f32, Output = Self::Value>;

    /// The use of the values: one texture may be evaluated for several. `None` for a number.
    fn spectrum_type(&self) -> Option<SpectrumType>;

    /// The evaluation for the second factor of a product: of an illuminant, only one of the two factors is an
    /// illuminant.
    fn of_factor(&self) -> Self;

    /// A colour in linear Rec. 709, or a number three times.
    fn color(&self, rgb: [f32; 3]) -> Self::Value;

    /// A compiled colour.
    fn constant(&self, constant: &Constant) -> Self::Value {
        self.color(constant.rgb)
    }

    /// A colour that is a reflectance, whatever the spectrum type of the texture.
    fn reflectance(&self, rgb: [f32; 3]) -> Self::Value;

    /// The number of a procedural pattern, which may be negative.
    fn number(&self, value: f32) -> Self::Value {
        self.color([value; 3])
    }

    /// A texel, already scaled; `invert` stands for 1 − value.
    fn texel(&self, rgb: [f32; 3], invert: bool, _filter: TexelFilter) -> Self::Value {
        self.color(if invert { rgb.map(|c| 1.0 - c) } else { rgb })
    }

    /// A curve.
    fn curve(&self, curve: &Measured) -> Self::Value;
}

/// Evaluation as one number.
pub(super) struct FloatEvaluation;

impl Evaluation for FloatEvaluation {
    type Value = f32;

    fn spectrum_type(&self) -> Option<SpectrumType> {
        None
    }

    fn of_factor(&self) -> Self {
        Self
    }

    fn color(&self, rgb: [f32; 3]) -> f32 {
        mean(rgb)
    }

    fn reflectance(&self, rgb: [f32; 3]) -> f32 {
        mean(rgb)
    }

    fn number(&self, value: f32) -> f32 {
        value
    }

    /// The mean of the channels; but with pbrt's nearest filtering, the first channel.
    fn texel(&self, rgb: [f32; 3], invert: bool, filter: TexelFilter) -> f32 {
        let value = match filter {
            TexelFilter::Nearest | TexelFilter::Mip { filter: MipFilter::Nearest, .. } => rgb[0],
            TexelFilter::Bilinear | TexelFilter::Mip { .. } => mean(rgb),
        };
        if invert { (1.0 - value).max(0.0) } else { value }
    }

    fn curve(&self, curve: &Measured) -> f32 {
        mean(curve.reflectance)
    }
}

/// The mean, and exactly the channel where all are the same.
fn mean([r, g, b]: [f32; 3]) -> f32 {
    if r == g && g == b { r } else { (r + g + b) / 3.0 }
}

/// Evaluation as linear Rec. 709, by spectrum type.
pub(super) struct RgbEvaluation(pub SpectrumType);

impl Evaluation for RgbEvaluation {
    type Value = Spectrum;

    fn spectrum_type(&self) -> Option<SpectrumType> {
        Some(self.0)
    }

    fn of_factor(&self) -> Self {
        Self(of_factor(self.0))
    }

    #[inline]
    fn color(&self, rgb: [f32; 3]) -> Spectrum {
        Spectrum::from_rgb(within(self.0, rgb))
    }

    fn reflectance(&self, rgb: [f32; 3]) -> Spectrum {
        Spectrum::from_rgb(rgb)
    }

    fn curve(&self, curve: &Measured) -> Spectrum {
        let rgb = if self.0 == SpectrumType::Illuminant { curve.emission } else { curve.reflectance };
        Spectrum::from_rgb(within(self.0, rgb))
    }
}

/// Evaluation at four wavelengths, by spectrum type.
pub(super) struct SpectralEvaluation<'a> {
    pub(super) spectrum_type: SpectrumType,
    pub(super) wavelengths: &'a Wavelengths,
}

impl SpectralEvaluation<'_> {
    /// The values of an uplifted colour of this type.
    #[inline]
    fn lifted(&self, uplift: &Unbounded) -> Spectrum {
        let values = uplift.at(&self.wavelengths.lambda);
        match self.spectrum_type {
            SpectrumType::Illuminant => values * self.wavelengths.daylight,
            SpectrumType::Albedo | SpectrumType::Unbounded => values,
        }
    }
}

impl Evaluation for SpectralEvaluation<'_> {
    type Value = Spectrum;

    fn spectrum_type(&self) -> Option<SpectrumType> {
        Some(self.spectrum_type)
    }

    fn of_factor(&self) -> Self {
        SpectralEvaluation { spectrum_type: of_factor(self.spectrum_type), ..*self }
    }

    fn color(&self, rgb: [f32; 3]) -> Spectrum {
        self.lifted(&uplift(self.spectrum_type, rgb))
    }

    fn constant(&self, constant: &Constant) -> Spectrum {
        match &constant.uplifts {
            Some(uplifts) => self.lifted(uplifts.of(self.spectrum_type)),
            None => self.color(constant.rgb),
        }
    }

    fn reflectance(&self, rgb: [f32; 3]) -> Spectrum {
        SpectralEvaluation { spectrum_type: SpectrumType::Albedo, ..*self }.color(rgb)
    }

    fn curve(&self, curve: &Measured) -> Spectrum {
        curve.dense.at_sampled(self.wavelengths)
    }
}

fn of_factor(spectrum_type: SpectrumType) -> SpectrumType {
    if spectrum_type == SpectrumType::Illuminant { SpectrumType::Unbounded } else { spectrum_type }
}

/// Clamped to at least 0, for an albedo also to at most 1; 0 for NaN.
#[inline]
pub(super) fn within(spectrum_type: SpectrumType, rgb: [f32; 3]) -> [f32; 3] {
    let rgb = rgb.map(|c| c.max(0.0));
    if spectrum_type == SpectrumType::Albedo { rgb.map(|c| c.min(1.0)) } else { rgb }
}
