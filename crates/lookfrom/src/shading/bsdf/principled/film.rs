//! Thin-film iridescence (Belcour & Barla 2017).
//!
//! Light that is reflected back and forth in the film interferes with itself, delayed by the film's optical path.
//! The sum over all orders of reflection (Airy 1833) is a Fourier series in that path: Belcour & Barla 2017. For
//! four wavelengths it is summed in closed form; in RGB mode its first terms are integrated against the observer's
//! sensitivities, which Belcour & Barla fitted with Gaussians. As in `KHR_materials_iridescence`, both boundaries
//! follow Schlick's approximation, polarisation is ignored, and the base is a dielectric of the index that
//! corresponds to its reflectance.

use std::f32::consts::{PI, TAU};

use crate::core::math::schlick;
use crate::core::spectrum::Spectrum;

/// A film over a surface, air above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    /// Index of refraction, at least 1.
    pub eta: f32,
    /// Thickness in nm.
    pub thickness: f32,
    /// The lanes' wavelengths in nm; `None` for red, green and blue.
    pub wavelengths: Option<[f32; 4]>,
}

/// Reflectance at normal incidence of a boundary between indices.
fn straight(eta: f32, around: f32) -> f32 {
    let ratio = (eta - around) / (eta + around);
    ratio * ratio
}

/// The reflectances of the two boundaries for light in the film at an angle.
struct Lane {
    /// Reflectance of the upper boundary.
    upper: f32,
    /// Reflectance of the lower boundary.
    lower: f32,
    /// Phase shift by the boundaries per round trip.
    phase: f32,
}

impl Lane {
    /// The mean over all phases, the first coefficient of the series, and the ratio of those that follow.
    fn series(&self) -> (f32, f32, f32) {
        let through = 1.0 - self.upper;
        let both = (self.upper * self.lower).clamp(0.0, 0.9999);
        let sent = through * through * self.lower / (1.0 - both);
        (self.upper + sent, sent - through, both.sqrt())
    }
}

impl Film {
    /// The reflectance at a cosine, for a surface that has the reflectance `f0` at normal incidence
    /// without the film.
    pub(super) fn fresnel(&self, cos: f32, f0: Spectrum) -> Spectrum {
        // A film of zero thickness vanishes: its index goes to that of air.
        let t = (self.thickness / 0.03).clamp(0.0, 1.0);
        let eta = 1.0 + (self.eta - 1.0) * t * t * (3.0 - 2.0 * t);
        let sin2 = (1.0 - cos * cos).max(0.0) / (eta * eta);
        if sin2 >= 1.0 {
            return Spectrum([1.0; 4]);
        }
        let cos_inside = (1.0 - sin2).sqrt();
        let upper0 = straight(eta, 1.0);
        let upper = upper0 + (1.0 - upper0) * schlick(cos);
        let beyond = schlick(cos_inside);
        // A phase shift of π for reflection off the denser side: at one of the two boundaries here,
        // for a denser base.
        let lane = |f0: f32| {
            let root = (f0 + 1e-4).clamp(0.0, 0.9999).sqrt();
            let base = (1.0 + root) / (1.0 - root);
            let lower0 = straight(base, eta);
            let inner = if eta < 1.0 { 0.0 } else { PI };
            let phase = inner + if base < eta { PI } else { 0.0 };
            Lane { upper, lower: lower0 + (1.0 - lower0) * beyond, phase }
        };
        let path = 2.0 * eta * self.thickness * cos_inside;
        match self.wavelengths {
            Some(lambda) => {
                Spectrum(std::array::from_fn(|k| at_wavelength(&lane(f0.0[k]), path / lambda[k])))
            }
            None => in_rgb(&[0, 1, 2].map(|k| lane(f0.0[k])), path),
        }
    }
}

/// The whole series at one wavelength, for the optical path in wavelengths:
/// `Σ r^m cos mδ = (r cos δ − r²) / (1 − 2 r cos δ + r²)`.
fn at_wavelength(lane: &Lane, turns: f32) -> f32 {
    let (mean, first, ratio) = lane.series();
    let cos = libm::cosf(TAU * (turns - turns.floor()) + lane.phase);
    let sum = ratio * (cos - ratio) / (1.0 - 2.0 * ratio * cos + ratio * ratio);
    (mean + 2.0 * first * sum).clamp(0.0, 1.0)
}

/// Two terms of the series, integrated against the observer's sensitivities.
fn in_rgb(lanes: &[Lane; 3], path: f32) -> Spectrum {
    let series = [0, 1, 2].map(|k| lanes[k].series());
    let mut sum = [0, 1, 2].map(|k| series[k].0);
    let mut power = [1.0; 3];
    for m in 1..=2 {
        let seen = sensitivity(m as f32 * path, [0, 1, 2].map(|k| m as f32 * lanes[k].phase));
        for k in 0..3 {
            power[k] *= series[k].2;
            sum[k] += 2.0 * series[k].1 * power[k] * seen[k];
        }
    }
    Spectrum::from_rgb(sum.map(|c| c.clamp(0.0, 1.0)))
}

/// The Fourier transform of the observer's sensitivities at an optical path in nm, in linear Rec. 709.
fn sensitivity(path: f32, shift: [f32; 3]) -> [f32; 3] {
    /// Gaussians over wave number: height, mean, variance; the last one adds to x.
    const FIT: [[f32; 3]; 4] = [
        [5.4856e-13, 1.6810e6, 4.3278e9],
        [4.4201e-13, 1.7953e6, 9.3046e9],
        [5.2481e-13, 2.2084e6, 6.6121e9],
        [9.7470e-14, 2.2399e6, 4.5282e9],
    ];
    let phase = TAU * path * 1e-9;
    let term = |[height, middle, variance]: [f32; 3], shift: f32| {
        let spread = libm::expf(-phase * phase * variance);
        height * (TAU * variance).sqrt() * libm::cosf(middle * phase + shift) * spread / 1.0685e-7
    };
    let [x, y, z] = [0, 1, 2].map(|k| term(FIT[k], shift[k]));
    let x = x + term(FIT[3], shift[0]);
    [
        3.240_454_2 * x - 1.537_138_5 * y - 0.498_531_4 * z,
        -0.969_266 * x + 1.876_010_8 * y + 0.041_556 * z,
        0.055_643_4 * x - 0.204_025_9 * y + 1.057_225_2 * z,
    ]
}
