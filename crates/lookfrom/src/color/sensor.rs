//! What does the film see of light?
//!
//! pbrt-v4's sensor `cie1931`: the standard observer, an exposure, and a white balance (von Kries's, in Bradford's
//! responses). The spectral responses of real cameras are left for later.

use std::sync::Arc;

use lookfrom_scene::spectrum::daylight::daylight;
use lookfrom_scene::spectrum::observer::{self, SAMPLES};
use lookfrom_scene::spectrum::space;

use super::dense::nearest;
use super::{Wavelengths, matrices};
use crate::spectrum::Spectrum;

/// The standard observer with exposure and white balance. Cheap to clone.
#[derive(Clone, Debug)]
pub struct Sensor {
    /// At each nm, what light of density 1 in one of four lanes adds to red, green, blue.
    responses: Arc<[[f32; 3]; SAMPLES]>,
    /// Exposure and white balance of a colour that is RGB already.
    balanced_from_rgb: [[f32; 3]; 3],
}

impl Default for Sensor {
    fn default() -> Self {
        Self::new(1.0, None)
    }
}

impl Sensor {
    /// A sensor that multiplies by `imaging_ratio` (exposure time in s · ISO / 100 in pbrt's files, 1 where they say nothing)
    /// and shows daylight of the temperature `white_balance` in kelvin as white. Without one, D65 is white.
    pub fn new(imaging_ratio: f32, white_balance: Option<f32>) -> Self {
        let (xyz_from_rgb, rgb_from_xyz) = matrices();
        let mut rgb_from_sensor = *rgb_from_xyz;
        if let Some(kelvin) = white_balance {
            let from = observer::xyz(&daylight(kelvin));
            let to = space::apply(xyz_from_rgb, [1.0; 3]);
            // A black body too cold to be seen has no colour to balance.
            if from.iter().all(|value| *value > 0.0) {
                rgb_from_sensor = space::product(rgb_from_xyz, &space::adapted(from, to));
            }
        }
        let rgb_from_sensor = rgb_from_sensor.map(|row| row.map(|value| value * f64::from(imaging_ratio)));
        let per_lane = 1.0 / (4.0 * observer::Y_INTEGRAL);
        let matching = observer::matching();
        let response = |i: usize| {
            let xyz = matching.each_ref().map(|function| f64::from(function[i]) * per_lane);
            space::apply(&rgb_from_sensor, xyz).map(|value| value as f32)
        };
        let balanced = space::product(&rgb_from_sensor, xyz_from_rgb);
        Self {
            responses: Arc::new(std::array::from_fn(response)),
            balanced_from_rgb: balanced.map(|row| row.map(|value| value as f32)),
        }
    }

    /// Linear Rec. 709 of a sample's radiance: an estimate whose mean is the colour. D65 of luminance 1 is (1, 1, 1).
    pub fn rgb(&self, radiance: Spectrum, wavelengths: &Wavelengths) -> [f32; 3] {
        let weighted = wavelengths.weighted(radiance);
        let mut rgb = [0.0; 3];
        for (nm, light) in wavelengths.lambda.into_iter().zip(weighted.0) {
            let Some(i) = nearest(nm) else { continue };
            for (sum, response) in rgb.iter_mut().zip(self.responses[i]) {
                *sum += response * light;
            }
        }
        rgb
    }

    /// What a colour of RGB mode looks like after exposure and white balance.
    pub fn balanced(&self, [r, g, b]: [f32; 3]) -> [f32; 3] {
        self.balanced_from_rgb.map(|[x, y, z]| x * r + y * g + z * b)
    }
}
