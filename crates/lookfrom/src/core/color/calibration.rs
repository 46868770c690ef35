//! Calibration of camera sensors: matrices by least squares over the swatches of a ColorChecker.
//!
//! As pbrt-v4's `PixelSensor` (after PhysLight: Langlands & Fascione 2020): the camera's response to the swatches
//! under the illuminant that is to appear white is mapped to the standard observer's XYZ of the swatches under D65.

use lookfrom_scene::settings::Sensor as Settings;
use lookfrom_scene::spectrum::daylight::daylight;
use lookfrom_scene::spectrum::observer::{self, SAMPLES};
use lookfrom_scene::spectrum::space::{self, Matrix};
use lookfrom_scene::spectrum::swatches;

use super::densely_sampled::{DenselySampledSpectrum, standard_illuminant};
use super::rgb_from_xyz;

/// Three functions of the wavelength.
type Functions = [[f32; SAMPLES]; 3];

/// The matrix from a camera's red, green and blue to XYZ, by its responses at each nm: daylight of this
/// temperature, in kelvin, appears as D65 of the same luminance. A black body too cold for a calibration is
/// replaced by [`Settings::DAYLIGHT`].
pub(super) fn xyz_from_camera(responses: &Functions, kelvin: f32) -> Matrix {
    let solved = |kelvin: f32| {
        let (white, daylight) = (DenselySampledSpectrum::from(&daylight(kelvin)), standard_illuminant());
        let observer = observer::matching();
        let lit = |light: &DenselySampledSpectrum, functions: &Functions| -> Vec<[f64; 3]> {
            swatches()
                .map(|swatch| measured(&DenselySampledSpectrum::from(&swatch), light, functions))
                .collect()
        };
        let luminance = |light: &DenselySampledSpectrum| f64::from(light.y_integral());
        // Both sides relative to the luminance of their illuminant.
        let seen = lit(&white, responses).into_iter().map(|rgb| rgb.map(|value| value / luminance(&white)));
        let meant =
            lit(daylight, observer).into_iter().map(|xyz| xyz.map(|value| value / luminance(daylight)));
        least_squares(seen.zip(meant))
    };
    let matrix = solved(kelvin);
    let is_known = space::inverse(&matrix).iter().flatten().all(|value| value.is_finite());
    if is_known { matrix } else { solved(Settings::DAYLIGHT) }
}

/// The camera's average output for linear Rec. 709, where `rgb_from_camera` is its matrix: by the colours of the
/// swatches in D65.
pub(super) fn rgb_by_camera(responses: &Functions, rgb_from_camera: &Matrix) -> Matrix {
    let daylight = standard_illuminant();
    least_squares(swatches().map(|swatch| {
        let swatch = DenselySampledSpectrum::from(&swatch);
        let of = |functions: &Functions| {
            measured(&swatch, daylight, functions).map(|sum| sum / observer::Y_INTEGRAL)
        };
        let rgb = rgb_from_xyz(of(observer::matching()).map(|value| value as f32));
        (rgb.map(f64::from), space::apply(rgb_from_camera, of(responses)))
    }))
}

/// The integrals of a reflectance times an illuminant, weighted by three functions.
fn measured(
    reflectance: &DenselySampledSpectrum,
    light: &DenselySampledSpectrum,
    functions: &Functions,
) -> [f64; 3] {
    functions.each_ref().map(|function| {
        let products = function.iter().zip(reflectance.samples()).zip(light.samples());
        products.map(|((&f, &share), &light)| f64::from(f) * f64::from(share) * f64::from(light)).sum()
    })
}

/// The matrix that maps the first of each pair to the second with least squared error: (Σ b aᵀ)(Σ a aᵀ)⁻¹.
fn least_squares(pairs: impl Iterator<Item = ([f64; 3], [f64; 3])>) -> Matrix {
    let (mut products, mut squares): (Matrix, Matrix) = Default::default();
    for (a, b) in pairs {
        for (row, column) in (0..3).flat_map(|row| (0..3).map(move |column| (row, column))) {
            products[row][column] += b[row] * a[column];
            squares[row][column] += a[row] * a[column];
        }
    }
    space::product(&products, &space::inverse(&squares))
}
