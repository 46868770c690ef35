//! Measured spectra by name.
//!
//! The spectra of pbrt-v4, for its scenes: indices of refraction and absorption coefficients of metals, glasses, and
//! standard illuminants. Illuminants are scaled so that their luminance Y is 1. A table that ends within the visible range
//! is extended with its last value. The numbers are in `named.txt`.

use super::{Curve, observer};

const TABLES: &str = include_str!("named.txt");

/// Aliases: the actual names of the glasses.
const ALIASES: &[(&str, &str)] =
    &[("glass-SF5", "glass-F5"), ("glass-SF10", "glass-F10"), ("glass-SF11", "glass-F11")];

/// The spectrum with this name; see [`names`].
pub fn named(name: &str) -> Option<Curve> {
    let name = ALIASES.iter().find(|(alias, _)| *alias == name).map_or(name, |(_, meant)| meant);
    let mut wavelengths = "";
    for (found, rest) in tables() {
        // `same` refers to the previous table, so keep the last wavelengths.
        if !rest.trim_start().starts_with("same") {
            wavelengths = rest;
        }
        if found == name {
            let curve = table(rest, wavelengths)?.extended();
            let is_illuminant = name.contains("illum-");
            return if is_illuminant { curve_of_luminance_one(curve) } else { Some(curve) };
        }
    }
    None
}

/// The CIE's standard illuminant D50, whose chromaticity is (0.3457, 0.3585): the D series at 5003 K. (`stdillum-D50` is pbrt-v4's, which is
/// bluer.)
pub fn d50() -> Option<Curve> {
    curve_of_luminance_one(super::daylight::daylight(5000.0).extended())
}

/// All names that [`named`] knows, for suggestions.
pub fn names() -> impl Iterator<Item = &'static str> {
    tables().map(|(name, _)| name).chain(ALIASES.iter().map(|(alias, _)| *alias))
}

/// The name of each table, and the text after it.
fn tables() -> impl Iterator<Item = (&'static str, &'static str)> {
    TABLES.split("\n\n").skip(1).filter_map(|table| table.split_once('\n'))
}

/// Parses a table, whose wavelengths may be those of the previous one.
fn table(own: &str, wavelengths_in: &str) -> Option<Curve> {
    let numbers =
        |text: &str| -> Vec<f32> { text.split_whitespace().filter_map(|word| word.parse().ok()).collect() };
    let (head, body) = wavelengths_in.split_once('\n')?;
    let wavelengths = match head.split_once(" + ") {
        Some((first, step)) => {
            let (first, step): (f32, f32) = (first.parse().ok()?, step.parse().ok()?);
            (0..numbers(body).len()).map(|i| first + step * i as f32).collect()
        }
        // All wavelengths first, then as many values.
        None => {
            let mut both = numbers(wavelengths_in);
            both.truncate(both.len() / 2);
            both
        }
    };
    let own =
        numbers(own.split_once('\n').filter(|(head, _)| head.contains('+')).map_or(own, |(_, body)| body));
    let values = own[own.len() - wavelengths.len()..].to_vec();
    Some(Curve::Tabulated { wavelengths, values })
}

fn curve_of_luminance_one(curve: Curve) -> Option<Curve> {
    let luminance = observer::xyz(&curve)[1];
    curve.scaled((1.0 / luminance) as f32)
}
