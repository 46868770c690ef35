//! The functions of expressions. Angles are in degrees; results have the same bits on any machine.

use std::f64::consts::PI;

use super::evaluate::{modulo, numbers};
use super::expression::Fault;
use super::quantity::Quantity;
use crate::suggest::nearest;

/// Functions of numbers: name, least and largest number of arguments, value.
type Function = (&'static str, usize, usize, fn(&[f64]) -> f64);

const ANY: usize = usize::MAX;

const FUNCTIONS: &[Function] = &[
    ("sin", 1, 1, |x| sine(x[0])),
    ("cos", 1, 1, |x| sine(modulo(x[0], 360.0) + 90.0)),
    ("tan", 1, 1, |x| sine(x[0]) / sine(modulo(x[0], 360.0) + 90.0)),
    ("asin", 1, 1, |x| libm::asin(x[0]) * (180.0 / PI)),
    ("acos", 1, 1, |x| libm::acos(x[0]) * (180.0 / PI)),
    ("atan", 1, 1, |x| libm::atan(x[0]) * (180.0 / PI)),
    ("atan2", 2, 2, |x| libm::atan2(x[0], x[1]) * (180.0 / PI)),
    ("sqrt", 1, 1, |x| x[0].sqrt()),
    ("exp", 1, 1, |x| libm::exp(x[0])),
    ("log", 1, 1, |x| libm::log(x[0])),
    ("abs", 1, 1, |x| x[0].abs()),
    ("sign", 1, 1, |x| if x[0] == 0.0 { 0.0 } else { x[0].signum() }),
    ("floor", 1, 1, |x| libm::floor(x[0])),
    ("ceil", 1, 1, |x| libm::ceil(x[0])),
    ("round", 1, 1, |x| libm::round(x[0])),
    ("min", 1, ANY, |x| x.iter().copied().fold(f64::INFINITY, f64::min)),
    ("max", 1, ANY, |x| x.iter().copied().fold(f64::NEG_INFINITY, f64::max)),
    ("clamp", 3, 3, |x| x[0].max(x[1]).min(x[2])),
    ("mix", 3, 3, |x| x[0] + (x[1] - x[0]) * x[2]),
    ("smoothstep", 3, 3, |x| eased((x[2] - x[0]) / (x[1] - x[0]))),
    ("random", 1, 1, |x| random(x[0])),
];

/// A number as a text with at least so many digits.
const DIGITS: &str = "digits";

/// The most digits that a text of a number is filled up to.
const MOST_DIGITS: f64 = 20.0;

/// The names of all functions.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    FUNCTIONS.iter().map(|function| function.0).chain([DIGITS])
}

/// The value of a function.
pub(super) fn call(name: &str, arguments: &[Quantity], at: usize) -> Result<Quantity, Fault> {
    if name == DIGITS {
        return digits(arguments, at);
    }
    let Some(&(name, least, most, f)) = FUNCTIONS.iter().find(|function| function.0 == name) else {
        return Err(Fault::new(at, format!("there is no function `{name}`")).hint(
            match nearest(name, names()) {
                Some(meant) => format!("did you mean `{meant}`?"),
                None => format!("there are: {}", names().collect::<Vec<_>>().join(", ")),
            },
        ));
    };
    if !(least..=most).contains(&arguments.len()) {
        let expected = if most == ANY { format!("at least {least}") } else { least.to_string() };
        let message = format!(
            "`{name}` is given {}; expected {expected}",
            crate::plural::counted(arguments.len(), "value")
        );
        return Err(Fault::new(at, message));
    }
    numbers(arguments, name, at, &f)
}

fn digits(arguments: &[Quantity], at: usize) -> Result<Quantity, Fault> {
    match arguments {
        [Quantity::Number(number), Quantity::Number(count)]
            if number.fract() == 0.0 && *number >= 0.0 && (0.0..=MOST_DIGITS).contains(count) =>
        {
            Ok(Quantity::Text(format!("{number:0width$}", width = *count as usize)))
        }
        _ => Err(Fault::new(
            at,
            format!(
                "`{DIGITS}` takes a whole number of at least 0, and the least number of its digits, up to 20"
            ),
        )),
    }
}

/// The sine of an angle in degrees: exact at multiples of 90.
fn sine(degrees: f64) -> f64 {
    let angle = modulo(degrees, 360.0);
    let quarter = libm::round(angle / 90.0);
    // Exact, as the two are near each other.
    let rest = (angle - 90.0 * quarter) * (PI / 180.0);
    match quarter as u8 % 4 {
        0 => libm::sin(rest),
        1 => libm::cos(rest),
        2 => -libm::sin(rest),
        _ => -libm::cos(rest),
    }
}

/// From 0 to 1, slowly at both ends: 3u² − 2u³.
pub(super) fn eased(u: f64) -> f64 {
    let u = if u.is_nan() { u } else { u.clamp(0.0, 1.0) };
    u * u * (3.0 - 2.0 * u)
}

/// A number in [0, 1) that looks random: the bits of the argument, mixed as by SplitMix64 (Steele, Lea & Flood 2014).
fn random(x: f64) -> f64 {
    // Both zeros are one number.
    let mut bits = (x + 0.0).to_bits().wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((bits ^ (bits >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}
