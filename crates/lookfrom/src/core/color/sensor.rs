//! The sensor of a film: its channels, exposure and white balance.
//!
//! pbrt-v4's `PixelSensor`. The standard observer measures X, Y and Z and is white-balanced by von Kries scaling in
//! Bradford's cone space. A camera measures its own red, green and blue, which a matrix converts to XYZ
//! ([`super::calibration`]).

use std::sync::Arc;

use lookfrom_scene::settings::Sensor as Settings;
use lookfrom_scene::spectrum::daylight::daylight;
use lookfrom_scene::spectrum::observer::{self, SAMPLES};
use lookfrom_scene::spectrum::space::{self, Matrix};

use super::densely_sampled::DenselySampledSpectrum;
use super::{Wavelengths, calibration, matrices};
use crate::core::spectrum::Spectrum;

/// The standard observer or a camera, with exposure and white balance. Cheap to clone.
#[derive(Clone, Debug)]
pub struct Sensor {
    /// Response in red, green and blue to light of density 1 in one of four lanes, at each nm.
    responses: Arc<[[f32; 3]; SAMPLES]>,
    /// Exposure and white balance for colours that are already RGB.
    balanced_from_rgb: [[f32; 3]; 3],
    channels_from_rgb: Matrix,
    measures_xyz: bool,
}

impl Default for Sensor {
    fn default() -> Self {
        Self::new(&Settings::default())
    }
}

impl Sensor {
    /// The sensor of the image settings. The maximum component value is left to [`crate::render`].
    pub fn new(settings: &Settings) -> Self {
        let (xyz_from_rgb, rgb_from_xyz) = matrices();
        let imaging_ratio = f64::from(settings.imaging_ratio);
        let scaled = |matrix: &Matrix| matrix.map(|row| row.map(|value| value * imaging_ratio));
        let (functions, xyz_from_channels) = match settings.camera {
            Some(camera) => {
                let responses =
                    camera.responses().map(|response| *DenselySampledSpectrum::from(&response).samples());
                let kelvin = settings.white_balance.unwrap_or(Settings::DAYLIGHT);
                let matrix = calibration::xyz_from_camera(&responses, kelvin);
                (responses, Some(matrix))
            }
            None => (*observer::matching(), settings.white_balance.and_then(balance)),
        };
        let rgb_from_channels =
            xyz_from_channels.map_or(*rgb_from_xyz, |matrix| space::product(rgb_from_xyz, &matrix));
        let exposed = scaled(&rgb_from_channels);
        let per_lane = 1.0 / (4.0 * observer::Y_INTEGRAL);
        let response = |i: usize| {
            let channels = functions.each_ref().map(|function| f64::from(function[i]) * per_lane);
            space::apply(&exposed, channels).map(|value| value as f32)
        };
        let balanced = match settings.camera {
            Some(_) => scaled(&calibration::rgb_by_camera(&functions, &rgb_from_channels)),
            None => space::product(&exposed, xyz_from_rgb),
        };
        Self {
            responses: Arc::new(std::array::from_fn(response)),
            balanced_from_rgb: balanced.map(|row| row.map(|value| value as f32)),
            channels_from_rgb: space::inverse(&rgb_from_channels),
            measures_xyz: settings.measures_xyz(),
        }
    }

    /// Linear Rec. 709 of a sample's radiance: an estimate whose mean is the colour. D65 of luminance 1 is (1, 1,
    /// 1).
    pub fn rgb(&self, radiance: Spectrum, wavelengths: &Wavelengths) -> [f32; 3] {
        let weighted = wavelengths.weighted(radiance);
        let mut rgb = [0.0; 3];
        for (responses, light) in wavelengths.of_curve(&self.responses).into_iter().zip(weighted.0) {
            let Some(responses) = responses else { continue };
            for (sum, response) in rgb.iter_mut().zip(responses) {
                *sum += response * light;
            }
        }
        rgb
    }

    /// A colour of RGB mode after exposure and white balance. For a camera, whose response to a colour depends on
    /// its spectrum, by least squares over the swatches of a ColorChecker in daylight.
    pub fn balanced(&self, [r, g, b]: [f32; 3]) -> [f32; 3] {
        self.balanced_from_rgb.map(|[x, y, z]| x * r + y * g + z * b)
    }

    /// The matrix of [`Sensor::balanced`], by rows.
    pub(crate) fn balanced_matrix(&self) -> &[[f32; 3]; 3] {
        &self.balanced_from_rgb
    }

    /// The matrix from linear Rec. 709 to the channels in which the film estimates variance: those of
    /// [`Sensor::channels`], with X, Y and Z by [`space::XYZ_FROM_RGB`].
    pub fn variance_from_rgb(&self) -> &Matrix {
        if self.measures_xyz { &space::XYZ_FROM_RGB } else { &self.channels_from_rgb }
    }

    /// The sensor's channel values, before white balance, of a colour that it produced: the camera's red, green and
    /// blue, or X, Y and Z. The standard observer measures light of luminance 1 as Y = 1.
    pub fn channels(&self, rgb: [f32; 3]) -> [f32; 3] {
        space::apply(&self.channels_from_rgb, rgb.map(f64::from)).map(|value| value as f32)
    }
}

/// The matrix that adapts daylight of a temperature in kelvin to the white of D65; `None` for a black body too cold
/// to be visible, which has no colour to adapt.
fn balance(kelvin: f32) -> Option<Matrix> {
    let from = observer::xyz(&daylight(kelvin));
    let to = space::apply(&matrices().0, [1.0; 3]);
    from.iter().all(|value| *value > 0.0).then(|| space::adapted(from, to))
}

#[cfg(test)]
mod tests;
