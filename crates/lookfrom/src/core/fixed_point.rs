//! Fixed-point numbers of films: multiples of powers of two, of which sums do not depend on the order.

/// Light is clamped to this, 2⁴⁰, in either direction. So the sums hold at least 2²³ samples of the brightest, and far
/// more of any other.
pub const BRIGHTEST: f32 = 1_099_511_627_776.0;

const TWO_TO_17: f64 = 131_072.0;
pub(crate) const TWO_TO_32: f64 = 4_294_967_296.0;
pub(crate) const TWO_TO_47: f64 = 140_737_488_355_328.0;
pub(crate) const TWO_TO_48: f64 = 281_474_976_710_656.0;
pub(crate) const TWO_TO_63: f64 = 9_223_372_036_854_775_808.0;
pub(crate) const TWO_TO_64: f64 = 18_446_744_073_709_551_616.0;

/// The square of a finite number, rounded to f64, as a multiple of 2⁻⁴⁸; saturates.
pub(crate) fn fixed_point_square(value: f64) -> u128 {
    let square = value * value * TWO_TO_48;
    // The cast saturates; 63 bits nearly always suffice, and take a fraction of the time.
    if square < TWO_TO_63 { u128::from(square as i64 as u64) } else { square as u128 }
}

/// A finite number as a multiple of 2⁻⁶⁴, clamped to ±[`BRIGHTEST`], truncated towards zero.
pub(crate) fn fixed_point(value: f32) -> i128 {
    // An f32 in f64 can be multiplied by a power of two exactly. From 2⁻²⁴ on it is a whole multiple of 2⁻⁴⁷: then,
    // which is nearly always, 64 bits suffice, and take a fraction of the time.
    let value = f64::from(value.clamp(-BRIGHTEST, BRIGHTEST));
    let upper = value * TWO_TO_47;
    let cut = upper as i64;
    if upper.abs() < TWO_TO_63 && cut as f64 == upper {
        i128::from(cut) << 17
    } else {
        (value * TWO_TO_64) as i128
    }
}
/// A sum of numbers by [`fixed_point`] as the nearest f64, as the cast gives it. Nearly always they are multiples of 2⁻⁴⁷ and 64 bits
/// suffice, which takes a fraction of the time.
pub(crate) fn nearest_f64(sum: i128) -> f64 {
    const BELOW: u32 = 17;
    let upper = (sum >> BELOW) as i64;
    if i128::from(upper) << BELOW == sum { upper as f64 * TWO_TO_17 } else { sum as f64 }
}

/// A sum of squares by [`fixed_point_square`] as the nearest f64, as the cast gives it.
pub(crate) fn nearest_f64_of_squares(sum: u128) -> f64 {
    u64::try_from(sum).map_or_else(|_| sum as f64, |sum| sum as f64)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn sums_are_those_of_the_cast(sum: i128, squares: u128, down in 0_u32..128, cut in 0_u32..40) {
            let sum = sum >> down >> cut << cut;
            prop_assert_eq!(nearest_f64(sum).to_bits(), (sum as f64).to_bits());
            let squares = squares >> down;
            prop_assert_eq!(nearest_f64_of_squares(squares).to_bits(), (squares as f64).to_bits());
        }
    }
}
