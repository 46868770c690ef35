//! Colour: wavelengths to RGB, and RGB to spectra.
//!
//! In spectral mode a sample follows four [`Wavelengths`] at once (hero wavelength sampling: Wilkie et al. 2014). Colours
//! that enter as RGB are lifted to smooth spectra ([`Sigmoid`], [`Unbounded`]: Jakob and Hanika 2019), measured curves are
//! sampled at whole nm ([`DenselySampledSpectrum`]), and what arrives at the film is seen by a [`Sensor`]. All of it agrees with pbrt-v4
//! (Pharr, Jakob, Humphreys 2023), with one difference of units: here light of luminance 1 is seen as 1, where pbrt has
//! lights divide by their luminous integral and the sensor not. RGB is linear with the primaries of Rec. 709.

mod calibration;
mod densely_sampled;
mod sensor;
mod sigmoid;
mod solve;
mod table;
mod wavelengths;

use std::sync::OnceLock;

use lookfrom_scene::spectrum::{observer, space};

pub use densely_sampled::{DenselySampledSpectrum, standard_illuminant};
pub use sensor::Sensor;
pub use sigmoid::{Sigmoid, Unbounded};
pub use wavelengths::Wavelengths;

use crate::core::spectrum::Spectrum;

/// The XYZ of a sample's radiance: an estimate whose mean is the colour of the light, where 1 is Y of the constant 1.
pub fn xyz_of(radiance: Spectrum, wavelengths: &Wavelengths) -> [f32; 3] {
    static MATCHING: OnceLock<[DenselySampledSpectrum; 3]> = OnceLock::new();
    let matching = MATCHING.get_or_init(|| {
        let per_lane = 1.0 / (4.0 * observer::Y_INTEGRAL);
        observer::matching().map(|function| {
            DenselySampledSpectrum::from_samples(function.map(|f| (f64::from(f) * per_lane) as f32))
        })
    });
    let weighted = wavelengths.weighted(radiance);
    matching.each_ref().map(|function| (function.at(&wavelengths.lambda) * weighted).0.into_iter().sum())
}

/// Linear Rec. 709 of an XYZ; what lies outside the gamut has negative components.
pub fn rgb_from_xyz(xyz: [f32; 3]) -> [f32; 3] {
    space::apply(&matrices().1, xyz.map(f64::from)).map(|value| value as f32)
}

/// XYZ of linear Rec. 709; (1, 1, 1) has Y = 1.
pub fn xyz_from_rgb(rgb: [f32; 3]) -> [f32; 3] {
    space::apply(&matrices().0, rgb.map(f64::from)).map(|value| value as f32)
}

/// XYZ from Rec. 709, and back.
fn matrices() -> &'static (space::Matrix, space::Matrix) {
    static MATRICES: OnceLock<(space::Matrix, space::Matrix)> = OnceLock::new();
    MATRICES.get_or_init(|| {
        let xyz_from_rgb = space::xyz_from("srgb").expect("a space of our own");
        (xyz_from_rgb, space::inverse(&xyz_from_rgb))
    })
}

#[cfg(test)]
mod tests;
