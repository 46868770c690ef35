//! The wavelengths at which a sky is computed, and RGB from them.

use crate::spectrum::{Curve, LONGEST, SHORTEST, observer, space};

/// The number of wavelengths.
pub(super) const COUNT: usize = 16;
/// The shortest wavelength and the distance to the next, in nm.
const FIRST: f64 = 390.0;
const STEP: f64 = 21.0;

/// A value at each wavelength.
pub(super) type Bands = [f64; COUNT];

/// A function of the wavelength in nm at each wavelength.
pub(super) fn bands(of: impl Fn(f64) -> f64) -> Bands {
    std::array::from_fn(|i| of(FIRST + STEP * i as f64))
}

/// Linear Rec. 709 of a transmittance or of radiance over the sun's irradiance.
pub(super) fn rgb(values: &Bands, weights: &[[f64; 3]; COUNT]) -> [f64; 3] {
    let mut rgb = [0.0; 3];
    for (value, weight) in values.iter().zip(weights) {
        for (sum, weight) in rgb.iter_mut().zip(weight) {
            *sum += value * weight;
        }
    }
    rgb
}

/// Contribution of each wavelength to RGB under the sun's spectrum outside the atmosphere, in units of 10 000 lx. The values are
/// linear between the wavelengths.
///
/// The sun is a blackbody of 5772 K, its effective temperature (IAU 2015), which gives 1361 W/m².
pub(super) fn rgb_weights() -> [[f64; 3]; COUNT] {
    /// The irradiance by that blackbody where it is strongest, in W/m² per nm.
    const PEAK: f64 = 1.783;
    /// Lumens per watt at 555 nm.
    const EFFICACY: f64 = 683.0;
    let sun = Curve::Blackbody { kelvin: 5772.0 };
    let matching = observer::matching();
    let mut weights = [[0.0; 3]; COUNT];
    for nm in SHORTEST..=LONGEST {
        let place = ((f64::from(nm) - FIRST) / STEP).clamp(0.0, (COUNT - 1) as f64);
        let below = (place as usize).min(COUNT - 2);
        let t = place - below as f64;
        let light = f64::from(sun.at(nm as f32)) * PEAK * EFFICACY / 10_000.0;
        for (i, function) in matching.iter().enumerate() {
            let seen = light * f64::from(function[(nm - SHORTEST) as usize]);
            weights[below][i] += seen * (1.0 - t);
            weights[below + 1][i] += seen * t;
        }
    }
    let rgb_from_xyz = space::inverse(&space::XYZ_FROM_RGB);
    weights.map(|xyz| space::apply(&rgb_from_xyz, xyz))
}
