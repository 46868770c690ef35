//! Parser for decimal numbers.
//!
//! The result is the nearest number, as in the standard library, but faster for the short decimals that models consist
//! of (Clinger 1990: a product or quotient of two exact doubles is rounded once). Unusual spellings that other programs
//! write are handled by the slow path.

/// 10⁰ … 10²²: the powers of ten that are exact doubles.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

/// The `f32` nearest to the decimal number; infinite if it is too large.
pub(crate) fn parse_f32(word: &[u8]) -> Option<f32> {
    if let Some(double) = short_decimal(word) {
        let magnitude = double.abs();
        // Rounding twice is wrong only if the double is exactly halfway between two singles.
        let tie = double.to_bits() & 0x1fff_ffff == 0x1000_0000;
        if !tie && (magnitude >= f64::from(f32::MIN_POSITIVE) || magnitude == 0.0) {
            return Some(double as f32);
        }
    }
    slow(word)
}

/// The `f64` nearest to the decimal number; infinite if it is too large.
pub(crate) fn parse_f64(word: &[u8]) -> Option<f64> {
    short_decimal(word).or_else(|| slow(word))
}

/// A plain decimal whose digits and power of ten are both exact doubles.
fn short_decimal(word: &[u8]) -> Option<f64> {
    let (negative, digits) = match word.first()? {
        b'-' => (true, &word[1..]),
        b'+' => (false, &word[1..]),
        _ => (false, word),
    };
    // Longer numbers may overflow and are left to the slow path.
    if digits.len() > 24 {
        return None;
    }
    let (mut mantissa, mut count, mut exponent) = (0_u64, 0, 0_i32);
    let mut rest = digits;
    while let [digit @ b'0'..=b'9', tail @ ..] = rest {
        mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit - b'0'));
        (count, rest) = (count + 1, tail);
    }
    if let [b'.', tail @ ..] = rest {
        rest = tail;
        while let [digit @ b'0'..=b'9', tail @ ..] = rest {
            mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit - b'0'));
            (count, exponent, rest) = (count + 1, exponent - 1, tail);
        }
    }
    if count == 0 || count > 19 || mantissa > 1 << 53 {
        return None;
    }
    if let [b'e' | b'E', tail @ ..] = rest {
        let (sign, mut power) = match tail {
            [b'-', power @ ..] => (-1, power),
            [b'+', power @ ..] => (1, power),
            _ => (1, tail),
        };
        if power.is_empty() || power.len() > 4 {
            return None;
        }
        let mut written = 0;
        while let [digit @ b'0'..=b'9', tail @ ..] = power {
            written = written * 10 + i32::from(digit - b'0');
            power = tail;
        }
        exponent += sign * written;
        rest = power;
    }
    if !rest.is_empty() {
        return None;
    }
    let scale = POWERS.get(exponent.unsigned_abs() as usize)?;
    let magnitude = if exponent < 0 { mantissa as f64 / scale } else { mantissa as f64 * scale };
    Some(if negative { -magnitude } else { magnitude })
}

/// The result of the standard library's parser, after unusual spellings are normalised.
fn slow<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    let text = std::str::from_utf8(word).ok()?;
    if let Ok(number) = text.parse() {
        return Some(number);
    }
    let lower = text.to_ascii_lowercase();
    let plain = lower.trim_start_matches(['-', '+']);
    // Microsoft's C library writes `1.#QNAN`, `-1.#IND`, `1.#INF`; others write `nan(ind)`.
    if plain.starts_with("nan")
        || plain.starts_with("1.#qnan")
        || plain.starts_with("1.#snan")
        || plain.starts_with("1.#ind")
    {
        return "nan".parse().ok();
    }
    if plain.starts_with("1.#inf") {
        return "inf".parse().ok();
    }
    // Fortran writes `1.5d2`; `1.5+e2` has been seen.
    lower.replace('d', "e").replace("+e", "e+").replace("-e", "e-").parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn odd_spellings_are_understood() {
        for (word, value) in [
            ("1.", 1.0),
            ("+.5", 0.5),
            ("-2.e1", -20.0),
            ("3.1+e2", 310.0),
            ("3.1-e2", 0.031),
            ("1d2", 100.0),
        ] {
            assert_eq!(parse_f32(word.as_bytes()), Some(value), "{word}");
        }
        for word in ["nan", "-nan(ind)", "1.#QNAN", "-1.#IND000"] {
            assert!(parse_f32(word.as_bytes()).is_some_and(f32::is_nan), "{word}");
        }
        assert_eq!(parse_f32(b"1e999"), Some(f32::INFINITY));
        for word in ["", "-", ".", "e5", "1e", "1x", "0x10", "1,5", "--1", "1e+"] {
            assert_eq!(parse_f32(word.as_bytes()), None, "{word}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn agrees_with_the_standard_library(bits: u32, digits in 0..12_usize, exponent: bool) {
            let number = f32::from_bits(bits);
            prop_assume!(number.is_finite());
            let text = if exponent { format!("{number:.digits$e}") } else { format!("{number:.digits$}") };
            prop_assert_eq!(parse_f32(text.as_bytes()).map(f32::to_bits), text.parse().ok().map(f32::to_bits));
            prop_assert_eq!(parse_f64(text.as_bytes()).map(f64::to_bits), text.parse().ok().map(f64::to_bits));
        }

        #[test]
        fn agrees_on_decimals_between_singles(mantissa in 0_u64..1 << 55, exponent in -30_i32..30) {
            let text = format!("{mantissa}e{exponent}");
            prop_assert_eq!(parse_f32(text.as_bytes()).map(f32::to_bits), text.parse().ok().map(f32::to_bits));
        }

        #[test]
        fn ties_go_to_even(bits in 0x0080_0000_u32..0x4b00_0000) {
            // Exactly halfway between two singles, written with all its digits.
            let middle = 0.5 * (f64::from(f32::from_bits(bits)) + f64::from(f32::from_bits(bits + 1)));
            let text = format!("{middle:.17e}");
            prop_assert_eq!(parse_f32(text.as_bytes()).map(f32::to_bits), text.parse().ok().map(f32::to_bits));
        }
    }
}
