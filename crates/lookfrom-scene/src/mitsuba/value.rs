//! Values as text: numbers, vectors, colours and spectra.

use glam::DVec3;

use super::plugin::Value;
use crate::error::{Error, Location, Result};
use crate::image::linear_from_srgb;
use crate::spectrum::Curve;

/// Whether a character separates numbers.
fn separates(c: char) -> bool {
    c.is_whitespace() || c == ','
}

/// A finite number.
pub(super) fn float(text: &str, at: &Location) -> Result<f64> {
    match text.trim().parse::<f64>() {
        // Most numbers become f32 later.
        Ok(value) if value.abs() <= f64::from(f32::MAX) => Ok(value),
        _ => Err(Error::invalid(at, format!("{text:?} is not a number, or too large"))),
    }
}

/// Numbers, separated by spaces or commas.
pub(super) fn floats(text: &str, at: &Location) -> Result<Vec<f64>> {
    text.split(separates).filter(|word| !word.is_empty()).map(|word| float(word, at)).collect()
}

/// A whole number.
pub(super) fn integer(text: &str, at: &Location) -> Result<i64> {
    text.trim().parse().map_err(|_| Error::invalid(at, format!("{text:?} is not a whole number")))
}

pub(super) fn boolean(text: &str, at: &Location) -> Result<bool> {
    match text.trim().to_ascii_lowercase().as_str() {
        "true" => Ok(true),
        "false" => Ok(false),
        _ => Err(Error::invalid(at, format!("{text:?} is neither true nor false"))),
    }
}

/// Three numbers, or one for all three.
pub(super) fn vector(text: &str, at: &Location) -> Result<DVec3> {
    match floats(text, at)?[..] {
        [value] => Ok(DVec3::splat(value)),
        [x, y, z] => Ok(DVec3::new(x, y, z)),
        ref numbers => {
            Err(Error::invalid(at, format!("expected one or three numbers, found {}", numbers.len())))
        }
    }
}

/// A colour: three numbers in linear Rec. 709, one for a grey, or `#rrggbb` in sRGB.
pub(super) fn rgb(text: &str, at: &Location) -> Result<[f32; 3]> {
    if let Some(digits) = text.trim().strip_prefix('#') {
        let number = u32::from_str_radix(digits, 16).ok().filter(|_| digits.len() == 6);
        let number = number.ok_or_else(|| {
            Error::invalid(at, format!("{text:?} is not a colour")).hint("write six digits, as in #ff8000")
        })?;
        return Ok([16, 8, 0].map(|shift| linear_from_srgb((number >> shift & 0xff) as f32 / 255.0)));
    }
    let color = vector(text, at)?.as_vec3().to_array();
    not_negative(&color, at)?;
    Ok(color)
}

fn not_negative(values: &[f32], at: &Location) -> Result<()> {
    match values.iter().find(|value| !(**value >= 0.0)) {
        Some(value) => Err(Error::invalid(at, format!("a colour has no negative values, found {value}"))),
        None => Ok(()),
    }
}

/// A constant, or pairs `wavelength:value` in nm.
pub(super) fn spectrum(text: &str, at: &Location) -> Result<Value> {
    if !text.contains(':') {
        let [value] = floats(text, at)?[..] else {
            let error = Error::invalid(at, "a spectrum is one number or pairs of a wavelength and a value");
            return Err(error.hint("write 400:0.2, 500:0.4, or <rgb> for three numbers"));
        };
        not_negative(&[value as f32], at)?;
        return Ok(Value::Curve(Curve::Constant(value as f32)));
    }
    let (mut wavelengths, mut values) = (Vec::new(), Vec::new());
    for pair in text.split(separates).filter(|pair| !pair.is_empty()) {
        let Some((wavelength, value)) = pair.split_once(':') else {
            return Err(Error::invalid(at, format!("expected wavelength:value, found {pair:?}")));
        };
        wavelengths.push(float(wavelength, at)? as f32);
        values.push(float(value, at)? as f32);
    }
    not_negative(&values, at)?;
    if let Some(pair) = wavelengths.windows(2).find(|pair| !(pair[0] < pair[1])) {
        let message = format!("wavelengths have to rise, found {} after {}", pair[1], pair[0]);
        return Err(Error::invalid(at, message));
    }
    Ok(Value::Curve(Curve::Tabulated { wavelengths, values }))
}
