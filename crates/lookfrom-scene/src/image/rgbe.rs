//! The colours that Radiance pictures can hold: three mantissas of 8 bits with a common exponent (Ward 1991, "Real Pixels").

/// The exponents, of numbers from ½ to 1 times a power of two, that a pixel can hold; below them it is black.
const LEAST: i32 = -127;
const MOST: i32 = 127;

/// The nearest colour that a pixel can hold, which an encoder then has no need to round. A negative value, and what is no number, is 0;
/// what is too bright is the brightest that there is.
pub(super) fn nearest(color: [f32; 3]) -> [f32; 3] {
    let brightest = 255.0 * power(MOST - 8);
    let color = color.map(|value| f64::from(value.max(0.0)).min(brightest));
    let greatest = color.into_iter().fold(0.0, f64::max);
    let exponent = exponent(greatest);
    if exponent < LEAST {
        return [0.0; 3];
    }
    // A mantissa has 256 steps, of which the greatest one's is from 128 to 255.
    let step = power(exponent - 8);
    let step = if (greatest / step).round() < 256.0 { step } else { 2.0 * step };
    color.map(|value| ((value / step).round() * step) as f32)
}

/// The exponent of a number of at least 0 as one from ½ to 1 times a power of two; far below all others for 0.
fn exponent(value: f64) -> i32 {
    (value.to_bits() >> 52) as i32 - 1022
}

/// 2 to a whole power.
fn power(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}
