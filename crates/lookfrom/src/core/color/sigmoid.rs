//! Smooth spectra of RGB colours: sigmoids of a quadratic (Jakob & Hanika 2019).
//!
//! A sigmoid of a quadratic polynomial of the wavelength is smooth, stays within [0, 1], and can represent almost
//! every surface colour (Jakob and Hanika 2019). Colours with equal red, green and blue are constants.

use lookfrom_simd::{Float, Real};

use super::solve::{Measure, solve};
use super::table::Table;
use crate::core::spectrum::Spectrum;

/// A smooth spectrum within [0, 1]: s(a t² + b t + c) with s(x) = ½ + x / (2 √(1 + x²)) and t = (λ − 595 nm) / 235 nm.
///
/// pbrt-v4 has the same functions as polynomials of λ itself; the normalised t preserves the digits of single
/// precision.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sigmoid<R = f32>(pub [R; 3]);

/// The wavelength where t is 0, in nm.
pub(super) const MIDDLE: f32 = 595.0;
/// The distance from [`MIDDLE`] to where t is ±1, in nm.
pub(super) const REACH: f32 = 235.0;

/// Beyond this the sigmoid is exactly 0 or 1 and its square is still finite.
const FLAT: f32 = 1e18;

impl Sigmoid {
    /// One value v at all wavelengths, v within [0, 1].
    pub fn constant(v: f32) -> Self {
        Self([0.0, 0.0, ((v - 0.5) / (v * (1.0 - v)).sqrt()).clamp(-FLAT, FLAT)])
    }

    /// The spectrum whose colour under D65 is nearly `rgb`, by a table, for textures. Components are clamped to [0,
    /// 1]; NaN counts as 0.
    pub fn from_rgb(rgb: [f32; 3]) -> Self {
        let rgb = clamped(rgb);
        if let Some(grey) = grey(rgb) {
            return Self::constant(grey);
        }
        Self(Table::shared().coefficients(rgb))
    }

    /// The spectrum whose colour under D65 is `rgb` up to rounding, for the constants of a scene; clamped like
    /// [`Sigmoid::from_rgb`].
    pub fn exact_from_rgb(rgb: [f32; 3]) -> Self {
        let rgb = clamped(rgb);
        if let Some(grey) = grey(rgb) {
            return Self::constant(grey);
        }
        Self(solve(Measure::exact(), rgb.map(f64::from)).map(|coefficient| coefficient as f32))
    }
}

impl Sigmoid {
    /// The largest value, from 360 to 830 nm: at an end, or at the vertex of the parabola.
    fn most(&self) -> f32 {
        let Self([a, b, _]) = *self;
        let vertex = (MIDDLE - 0.5 * REACH * b / a).clamp(360.0, 830.0);
        // Without a vertex the division has no meaning, and an end is largest.
        [360.0, 830.0, vertex].into_iter().map(|nm| self.value(nm)).fold(0.0, f32::max)
    }
}

impl<R: Real> Sigmoid<R> {
    /// The values at wavelengths in nm.
    #[inline(always)]
    pub fn at(&self, [i, j, k, l]: &[R; 4]) -> Spectrum<R> {
        Spectrum([self.value(*i), self.value(*j), self.value(*k), self.value(*l)])
    }

    /// The value at a wavelength in nm.
    #[inline(always)]
    fn value(&self, nm: R) -> R {
        let Self([a, b, c]) = *self;
        let t = (nm - MIDDLE) * (1.0 / REACH);
        let x = (a * t + b) * t + c;
        x * 0.5 / Float::sqrt(x * x + 1.0) + 0.5
    }
}

/// Each component clamped to [0, 1]; NaN counts as 0.
fn clamped(rgb: [f32; 3]) -> [f32; 3] {
    rgb.map(|component| if component > 0.0 { component.min(1.0) } else { 0.0 })
}

/// The value of an achromatic colour. A colour so dark that its spectrum would be rounded to 0 is black.
fn grey([r, g, b]: [f32; 3]) -> Option<f32> {
    if r.max(g).max(b) < 1e-9 {
        return Some(0.0);
    }
    (r == g && g == b).then_some(r)
}

/// A spectrum that may exceed 1: a scale times a smooth spectrum, for a colour of at most ½.
///
/// For indices of refraction and the like. For light, multiply by [`super::standard_illuminant`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Unbounded<R = f32> {
    /// The factor: of a colour, twice the largest component.
    pub scale: R,
    /// The spectrum that is scaled.
    pub sigmoid: Sigmoid<R>,
}

impl Unbounded {
    /// One value of 0 and above at all wavelengths, exactly.
    pub fn gray(value: f32) -> Self {
        Self { scale: value, sigmoid: Sigmoid([0.0, 0.0, FLAT]) }
    }

    /// The spectrum with the colour `rgb` (under D65), by the table. Negative components and NaN count as 0.
    pub fn from_rgb(rgb: [f32; 3]) -> Self {
        Self::with(rgb, Sigmoid::from_rgb)
    }

    /// As [`Unbounded::from_rgb`], but exactly, for the constants of a scene.
    pub fn exact_from_rgb(rgb: [f32; 3]) -> Self {
        Self::with(rgb, Sigmoid::exact_from_rgb)
    }

    /// The largest value, from 360 to 830 nm.
    pub fn most(&self) -> f32 {
        self.sigmoid.most() * self.scale
    }

    fn with(rgb: [f32; 3], lift: fn([f32; 3]) -> Sigmoid) -> Self {
        let rgb = rgb.map(|component| if component > 0.0 { component.min(f32::MAX / 4.0) } else { 0.0 });
        let scale = 2.0 * rgb[0].max(rgb[1]).max(rgb[2]);
        let sigmoid = if scale > 0.0 { lift(rgb.map(|v| v / scale)) } else { Sigmoid::constant(0.0) };
        Self { scale, sigmoid }
    }
}

impl<R: Real> Unbounded<R> {
    /// The values at wavelengths in nm.
    #[inline(always)]
    pub fn at(&self, lambda: &[R; 4]) -> Spectrum<R> {
        self.sigmoid.at(lambda) * self.scale
    }
}
