//! Densely sampled spectra: measured curves at 1 nm, looked up by wavelength.

use std::sync::OnceLock;

use lookfrom_scene::spectrum::observer::{self, SAMPLES};
use lookfrom_scene::spectrum::{Curve, SHORTEST, named};

use super::{Wavelengths, rgb_from_xyz};
use crate::core::spectrum::Spectrum;

/// A curve sampled at each nm from 360 to 830, evaluated at the nearest sample.
#[derive(Clone, Debug, PartialEq)]
pub struct DenselySampledSpectrum(Box<[f32; SAMPLES]>);

impl From<&Curve> for DenselySampledSpectrum {
    fn from(curve: &Curve) -> Self {
        Self::from_samples(std::array::from_fn(|i| curve.at((SHORTEST as usize + i) as f32)))
    }
}

impl DenselySampledSpectrum {
    /// The values at 360, 361, … 830 nm.
    pub fn from_samples(samples: [f32; SAMPLES]) -> Self {
        Self(Box::new(samples))
    }

    /// The values at 360, 361, … 830 nm.
    pub fn samples(&self) -> &[f32; SAMPLES] {
        &self.0
    }

    /// The value at each wavelength in nm; 0 outside 360 … 830.
    pub fn at(&self, lambda: &[f32; 4]) -> Spectrum {
        Spectrum(lambda.map(|nm| self.0.get(usize::from(nearest(nm))).copied().unwrap_or(0.0)))
    }

    /// The value at each wavelength of a sample.
    #[inline]
    pub(crate) fn at_sampled(&self, wavelengths: &Wavelengths) -> Spectrum {
        Spectrum(wavelengths.of_curve(&self.0).map(|value| value.copied().unwrap_or(0.0)))
    }

    /// This curve times a factor.
    pub fn scaled(&self, factor: f32) -> Self {
        Self(Box::new(self.0.map(|value| value * factor)))
    }

    /// The largest value.
    pub fn max(&self) -> f32 {
        self.0.iter().copied().fold(f32::NEG_INFINITY, f32::max)
    }

    /// The integral over the wavelengths in nm, weighted by the luminous efficiency y: pbrt-v4's divisor for
    /// emission spectra. Light of luminance 1 has [`observer::Y_INTEGRAL`]; divide by that for Y.
    pub fn y_integral(&self) -> f32 {
        self.integral(1) as f32
    }

    /// XYZ of light with this spectrum; the constant 1 has Y = 1.
    pub fn to_xyz(&self) -> [f32; 3] {
        [0, 1, 2].map(|i| (self.integral(i) / observer::Y_INTEGRAL) as f32)
    }

    /// Linear Rec. 709 of light with this spectrum: an emission in RGB mode. Saturated light has negative
    /// components.
    pub fn to_rgb(&self) -> [f32; 3] {
        rgb_from_xyz(self.to_xyz())
    }

    /// The RGB value of this curve as a reflectance (or transmittance, or index of refraction): the colour of
    /// daylight D65 times the curve, so that a constant c gives (c, c, c); never negative.
    pub fn to_rgb_reflectance(&self) -> [f32; 3] {
        let daylight = standard_illuminant();
        let lit = Self::from_samples(std::array::from_fn(|i| self.0[i] * daylight.0[i]));
        lit.to_rgb().map(|value| value.max(0.0))
    }

    fn integral(&self, function: usize) -> f64 {
        let function = &observer::matching()[function];
        function.iter().zip(self.0.iter()).map(|(&f, &value)| f64::from(f) * f64::from(value)).sum()
    }
}

/// The index of the sample nearest to a wavelength in nm; beyond the last one for a wavelength out of range.
pub(super) fn nearest(nm: f32) -> u16 {
    // Negative numbers and NaN become 0, which is out of range, too.
    let index = ((nm + 0.5) as u32).wrapping_sub(SHORTEST);
    index.min(SAMPLES as u32) as u16
}

/// D65 with Y = 1: the white of Rec. 709, whose RGB is (1, 1, 1).
pub fn standard_illuminant() -> &'static DenselySampledSpectrum {
    static D65: OnceLock<DenselySampledSpectrum> = OnceLock::new();
    D65.get_or_init(|| DenselySampledSpectrum::from(&named("stdillum-D65").expect("a curve of our own")))
}
