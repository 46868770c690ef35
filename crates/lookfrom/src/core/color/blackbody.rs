//! Light of blackbodies: Planck's law relative to its maximum, at any temperature.

use std::sync::OnceLock;

use lookfrom_scene::spectrum::Curve;

use super::{DenselySampledSpectrum, Wavelengths};
use crate::core::spectrum::Spectrum;

/// Temperatures of the table of colours, in kelvin: between them its entries are spaced evenly in the logarithm.
const COLDEST: f32 = 400.0;
const HOTTEST: f32 = 102_400.0;
const ENTRIES: usize = 2561;

/// The spectral radiance of a blackbody relative to its largest, at the wavelengths of a sample; 0 unless `kelvin` > 0.
pub fn blackbody(kelvin: f32, wavelengths: &Wavelengths) -> Spectrum {
    /// Wien's displacement constant in nm K, and h c / (k b) of the exponent at the maximum.
    const WIEN: f32 = 2.897_772e6;
    const PEAK: f32 = 4.965_114;
    if !(kelvin > 0.0) {
        return Spectrum([0.0; 4]);
    }
    let at_peak = libm::expm1f(PEAK);
    Spectrum(wavelengths.lambda.map(|nm| {
        // In units of the wavelength of the maximum.
        let ratio = nm * kelvin / WIEN;
        let fifth = ratio * ratio * ratio * ratio * ratio;
        let denominator = fifth * libm::expm1f(PEAK / ratio);
        if denominator > 0.0 { (at_peak / denominator).min(1.0) } else { 0.0 }
    }))
}

/// The colour of that light in linear Rec. 709, clamped to its gamut: by a table, within 10⁻³ of the largest component.
pub fn blackbody_rgb(kelvin: f32) -> [f32; 3] {
    static TABLE: OnceLock<Vec<[f32; 3]>> = OnceLock::new();
    let table = TABLE.get_or_init(|| (0..ENTRIES).map(|index| rgb(temperature(index as f32))).collect());
    if !(kelvin > 0.0) {
        return [0.0; 3];
    }
    let place = libm::log2f(kelvin.clamp(COLDEST, HOTTEST) / COLDEST) * per_octave();
    let index = (place as usize).min(ENTRIES - 2);
    let t = place - index as f32;
    std::array::from_fn(|k| table[index][k] * (1.0 - t) + table[index + 1][k] * t)
}

/// Entries of the table for each doubling of the temperature.
fn per_octave() -> f32 {
    (ENTRIES - 1) as f32 / libm::log2f(HOTTEST / COLDEST)
}

fn temperature(place: f32) -> f32 {
    COLDEST * libm::exp2f(place / per_octave())
}

fn rgb(kelvin: f32) -> [f32; 3] {
    DenselySampledSpectrum::from(&Curve::Blackbody { kelvin }).to_rgb().map(|value| value.max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planck_is_that_of_scenes() {
        for kelvin in [300.0_f32, 1500.0, 4000.0, 6500.0, 30_000.0] {
            let curve = Curve::Blackbody { kelvin };
            for u in [0.1, 0.35, 0.6, 0.99] {
                let wavelengths = Wavelengths::sample_visible(u);
                for (found, nm) in blackbody(kelvin, &wavelengths).0.into_iter().zip(wavelengths.lambda) {
                    let expected = curve.at(nm);
                    assert!(
                        (found - expected).abs() <= 1e-4 * expected + 1e-30,
                        "{kelvin} K, {nm} nm: {found}, {expected}"
                    );
                }
            }
        }
        assert_eq!(blackbody(-3.0, &Wavelengths::sample_visible(0.5)), Spectrum([0.0; 4]));
    }

    #[test]
    fn colours_are_interpolated_closely() {
        for step in 0..220 {
            let kelvin = 1000.0 * libm::exp2f(step as f32 * 0.03);
            let (found, expected) = (blackbody_rgb(kelvin), rgb(kelvin));
            let most = expected.into_iter().fold(0.0, f32::max);
            for k in 0..3 {
                assert!((found[k] - expected[k]).abs() < 1e-3 * most, "{kelvin} K: {found:?}, {expected:?}");
            }
        }
    }
}
