//! Thin-film iridescence (Belcour & Barla 2017).
//!
//! Light that is reflected back and forth in the film interferes with itself, delayed by the film's optical path.
//! The sum over all orders of reflection (Airy 1833) is a Fourier series in that path: Belcour & Barla 2017. For
//! four wavelengths it is summed in closed form; in RGB mode its first terms are integrated against the observer's
//! sensitivities, which Belcour & Barla fitted with Gaussians. As in `KHR_materials_iridescence`, both boundaries
//! follow Schlick's approximation, polarisation is ignored, and the base is a dielectric of the index that
//! corresponds to its reflectance.

use std::f32::consts::{PI, TAU};

use lookfrom_simd::{Float, Mask, Real};

use crate::core::math::schlick;
use crate::core::spectrum::Spectrum;

/// A film over a surface, air above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinFilm<R = f32> {
    /// Index of refraction, at least 1.
    pub eta: R,
    /// Thickness in nm.
    pub thickness: R,
    /// The lanes' wavelengths in nm; `None` for red, green and blue.
    pub wavelengths: Option<[R; 4]>,
}

/// Reflectance at normal incidence of a boundary between indices.
#[inline(always)]
fn straight<R: Real>(eta: R, around: R) -> R {
    let ratio = (eta - around) / (eta + around);
    ratio * ratio
}

/// The reflectances of the two boundaries for light in the film at an angle.
#[derive(Clone, Copy)]
struct Lane<R> {
    /// Reflectance of the upper boundary.
    upper: R,
    /// Reflectance of the lower boundary.
    lower: R,
    /// Phase shift by the boundaries per round trip.
    phase: R,
}

/// A Fourier series.
#[derive(Clone, Copy)]
struct Series<R> {
    /// The mean over all phases.
    mean: R,
    /// The first coefficient.
    first: R,
    /// The ratio of those that follow.
    ratio: R,
}

impl<R: Real> Lane<R> {
    #[inline(always)]
    fn series(&self) -> Series<R> {
        let one = self.upper.like(1.0);
        let through = one - self.upper;
        let both = Float::clamp(self.upper * self.lower, 0.0, 0.9999);
        let sent = through * through * self.lower / (one - both);
        Series { mean: self.upper + sent, first: sent - through, ratio: Float::sqrt(both) }
    }
}

/// Light in the film at an angle.
struct Inside<R> {
    /// The film's index.
    eta: R,
    /// Reflectance of the upper boundary.
    upper: R,
    /// Schlick's weight of grazing incidence on the lower boundary.
    beyond: R,
}

impl<R: Real> Inside<R> {
    /// For a surface of a reflectance at normal incidence.
    #[inline(always)]
    fn over(&self, f0: R) -> Lane<R> {
        let (zero, one, pi) = (f0.like(0.0), f0.like(1.0), f0.like(PI));
        let root = Float::sqrt(Float::clamp(f0 + 1e-4, 0.0, 0.9999));
        let base = (one + root) / (one - root);
        let lower0 = straight(base, self.eta);
        // A phase shift of π for reflection off the denser side: at one of the two boundaries here,
        // for a denser base.
        let inner = R::select(self.eta.lt(one), zero, pi);
        let phase = inner + R::select(base.lt(self.eta), pi, zero);
        Lane { upper: self.upper, lower: lower0 + (one - lower0) * self.beyond, phase }
    }
}

impl<R: Real> ThinFilm<R> {
    /// The weight of the film, 0 … 1: a smooth step from zero thickness to 0.03 nm, below which Schlick's approximation would still reflect
    /// grazing light at boundaries between equal indices.
    #[inline(always)]
    pub(super) fn presence(&self) -> R {
        let t = Float::clamp(self.thickness / 0.03, 0.0, 1.0);
        t * t * (t.like(3.0) - t * 2.0)
    }

    /// The reflectance at a cosine, for a surface that has the reflectance `f0` at normal incidence
    /// without the film; always within 0 … 1. Not inlined, since it is needed in many places.
    #[inline(never)]
    pub(super) fn fresnel(&self, cos: R, f0: Spectrum<R>) -> Spectrum<R> {
        cos.at_level(
            #[inline(always)]
            || {
                let (zero, one) = (cos.like(0.0), cos.like(1.0));
                // On the way to zero thickness its index goes to that of air.
                let eta = (self.eta - 1.0) * self.presence() + 1.0;
                let sin2 = Float::max(one - cos * cos, zero) / (eta * eta);
                let is_total = !sin2.lt(one);
                if is_total.all() {
                    return Spectrum::splat(one);
                }
                let cos_inside = Float::sqrt(one - sin2);
                let upper0 = straight(eta, one);
                let upper = upper0 + (one - upper0) * schlick(cos);
                let inside = Inside { eta, upper, beyond: schlick(cos_inside) };
                let [a, b, c, d] = f0.0;
                let lanes = [inside.over(a), inside.over(b), inside.over(c)];
                let path = eta * 2.0 * self.thickness * cos_inside;
                let reflected = match self.wavelengths {
                    Some(lambda) => Spectrum([
                        at_wavelength(&lanes[0], path / lambda[0]),
                        at_wavelength(&lanes[1], path / lambda[1]),
                        at_wavelength(&lanes[2], path / lambda[2]),
                        at_wavelength(&inside.over(d), path / lambda[3]),
                    ]),
                    None => in_rgb(&lanes, path),
                };
                Spectrum::select(is_total, Spectrum::splat(one), reflected)
            },
        )
    }
}

/// The whole series at one wavelength, for the optical path in wavelengths:
/// `Σ r^m cos mδ = (r cos δ − r²) / (1 − 2 r cos δ + r²)`.
#[inline(always)]
fn at_wavelength<R: Real>(lane: &Lane<R>, turns: R) -> R {
    let Series { mean, first, ratio } = lane.series();
    let cos = ((turns - Float::floor(turns)) * TAU + lane.phase).map(libm::cosf);
    let sum = ratio * (cos - ratio) / (ratio.like(1.0) - ratio * 2.0 * cos + ratio * ratio);
    Float::clamp(mean + first * 2.0 * sum, 0.0, 1.0)
}

/// Two terms of the series, integrated against the observer's sensitivities.
#[inline(always)]
fn in_rgb<R: Real>(lanes: &[Lane<R>; 3], path: R) -> Spectrum<R> {
    let series = [lanes[0].series(), lanes[1].series(), lanes[2].series()];
    let phase = [lanes[0].phase, lanes[1].phase, lanes[2].phase];
    let once = sensitivity(path, phase);
    let twice = sensitivity(path * 2.0, [phase[0] * 2.0, phase[1] * 2.0, phase[2] * 2.0]);
    Spectrum([
        two_terms(&series[0], once[0], twice[0]),
        two_terms(&series[1], once[1], twice[1]),
        two_terms(&series[2], once[2], twice[2]),
        path.like(0.0),
    ])
}

/// A series by its mean and two terms, each with what is seen of it.
#[inline(always)]
fn two_terms<R: Real>(series: &Series<R>, once: R, twice: R) -> R {
    let &Series { mean, first, ratio } = series;
    let sum = mean + first * 2.0 * ratio * once + first * 2.0 * (ratio * ratio) * twice;
    Float::clamp(sum, 0.0, 1.0)
}

/// The Fourier transform of the observer's sensitivities at an optical path in nm, in linear Rec. 709.
#[inline(always)]
fn sensitivity<R: Real>(path: R, shift: [R; 3]) -> [R; 3] {
    /// Gaussians over wave number: height, mean, variance; the last one adds to x.
    const FIT: [[f32; 3]; 4] = [
        [5.4856e-13, 1.6810e6, 4.3278e9],
        [4.4201e-13, 1.7953e6, 9.3046e9],
        [5.2481e-13, 2.2084e6, 6.6121e9],
        [9.7470e-14, 2.2399e6, 4.5282e9],
    ];
    let phase = path * TAU * 1e-9;
    let [x, y, z] =
        [term(FIT[0], phase, shift[0]), term(FIT[1], phase, shift[1]), term(FIT[2], phase, shift[2])];
    let x = x + term(FIT[3], phase, shift[0]);
    [
        x * 3.240_454_2 - y * 1.537_138_5 - z * 0.498_531_4,
        x * -0.969_266 + y * 1.876_010_8 + z * 0.041_556,
        x * 0.055_643_4 - y * 0.204_025_9 + z * 1.057_225_2,
    ]
}

/// The Fourier transform of a Gaussian.
#[inline(always)]
fn term<R: Real>([height, middle, variance]: [f32; 3], phase: R, shift: R) -> R {
    let spread = (-phase * phase * variance).map(libm::expf);
    (phase * middle + shift).map(libm::cosf) * (height * (TAU * variance).sqrt()) * spread / 1.0685e-7
}
