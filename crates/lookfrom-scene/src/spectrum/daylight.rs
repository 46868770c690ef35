//! Spectra of daylight by correlated colour temperature.
//!
//! The CIE's D series (CIE 15; Judd, MacAdam, Wyszecki 1964): a chromaticity on the daylight locus, and the mixture of
//! three measured components with this chromaticity.

use super::Curve;

/// Daylight of a correlated colour temperature in kelvin, on the scale of the 1960s (6500 is D65), not normalised.
///
/// Below 4000 K, where the series is not defined, it is a blackbody, as in pbrt-v4.
pub fn daylight(kelvin: f32) -> Curve {
    // Planck's second radiation constant was revised after the illuminants had been named.
    let kelvin = kelvin * (1.4388 / 1.4380);
    if !(kelvin >= 4000.0) {
        return Curve::Blackbody { kelvin };
    }
    let t = 1.0 / f64::from(kelvin);
    let x = if kelvin <= 7000.0 {
        ((-4.607e9 * t + 2.9678e6) * t + 99.11) * t + 0.244063
    } else {
        ((-2.0064e9 * t + 1.9018e6) * t + 247.48) * t + 0.23704
    };
    let y = -3.0 * x * x + 2.87 * x - 0.275;
    // Weights of the two components of variation
    let m = 0.0241 + 0.2562 * x - 0.7341 * y;
    let m1 = (-1.3515 - 1.7703 * x + 5.9114 * y) / m;
    let m2 = (0.03 - 31.4424 * x + 30.0717 * y) / m;
    let (mut wavelengths, mut values) = (Vec::new(), Vec::new());
    for (i, line) in include_str!("daylight.txt").lines().filter(|line| !line.starts_with('#')).enumerate() {
        let mut component = line.split_whitespace().map(|word| word.parse::<f64>().unwrap_or(0.0));
        let mut next = || component.next().unwrap_or(0.0);
        let value = next() + m1 * next() + m2 * next();
        wavelengths.push(300.0 + 5.0 * i as f32);
        values.push((value * 0.01) as f32);
    }
    Curve::Tabulated { wavelengths, values }
}
