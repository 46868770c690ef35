//! Colour: wavelengths to RGB, and RGB to spectra.
//!
//! In spectral mode a sample follows four [`Wavelengths`] at once (hero wavelength sampling: Wilkie et al. 2014).
//! RGB colours are uplifted to smooth spectra ([`Sigmoid`], [`Unbounded`]: Jakob and Hanika 2019), measured curves
//! are sampled at whole nm ([`DenselySampledSpectrum`]), and a [`Sensor`] converts radiance to RGB at the film. All
//! of it agrees with pbrt-v4 (Pharr, Jakob, Humphreys 2023), with one difference of units: here the sensor maps
//! light of luminance 1 to 1; in pbrt, lights are divided by their luminous integral and the sensor is not. RGB is
//! linear with the primaries of Rec. 709.

mod blackbody;
mod calibration;
mod densely_sampled;
mod sensor;
mod sigmoid;
mod solve;
mod table;
mod wavelengths;

use std::sync::OnceLock;

use lookfrom_scene::spectrum::{observer, space};

pub use blackbody::{blackbody, blackbody_rgb};
pub use densely_sampled::{DenselySampledSpectrum, standard_illuminant};
pub use sensor::Sensor;
pub use sigmoid::{Sigmoid, Unbounded};
pub use wavelengths::Wavelengths;

use crate::core::spectrum::Spectrum;

/// XYZ of a sample's radiance: an estimate whose mean is the colour of the light, where 1 is Y of the constant 1.
pub fn xyz_of(radiance: Spectrum, wavelengths: &Wavelengths) -> [f32; 3] {
    static MATCHING: OnceLock<[DenselySampledSpectrum; 3]> = OnceLock::new();
    let matching = MATCHING.get_or_init(|| {
        let per_lane = 1.0 / (4.0 * observer::Y_INTEGRAL);
        observer::matching().map(|function| {
            DenselySampledSpectrum::from_samples(function.map(|f| (f64::from(f) * per_lane) as f32))
        })
    });
    let weighted = wavelengths.weighted(radiance);
    matching.each_ref().map(|function| (function.at_sampled(wavelengths) * weighted).0.into_iter().sum())
}

/// XYZ to linear Rec. 709; colours outside the gamut have negative components.
pub fn rgb_from_xyz(xyz: [f32; 3]) -> [f32; 3] {
    space::apply(&matrices().1, xyz.map(f64::from)).map(|value| value as f32)
}

/// Linear Rec. 709 to XYZ; (1, 1, 1) has Y = 1.
pub fn xyz_from_rgb(rgb: [f32; 3]) -> [f32; 3] {
    space::apply(&matrices().0, rgb.map(f64::from)).map(|value| value as f32)
}

/// The matrices from Rec. 709 to XYZ, and back.
fn matrices() -> &'static (space::Matrix, space::Matrix) {
    static MATRICES: OnceLock<(space::Matrix, space::Matrix)> = OnceLock::new();
    MATRICES.get_or_init(|| {
        let xyz_from_rgb = space::xyz_from("srgb").expect("a space of our own");
        (xyz_from_rgb, space::inverse(&xyz_from_rgb))
    })
}

#[cfg(test)]
mod tests;
