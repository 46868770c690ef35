//! Reader for `.spd` files.
//!
//! Pairs of a wavelength in nm and a value, separated by white space; `#` begins a comment to the end of the line.

use std::path::Path;

use super::Curve;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;
use crate::model::number::parse_f32;
use crate::model::text;

/// Reads a table of wavelengths and values.
///
/// # Errors
/// `Io` and `Limit` as [`LoadContext::read`], `Limit` for more entries than [`crate::Limits::elements`]; `Syntax` for words
/// that are not numbers and a wavelength without a value; `Invalid` for wavelengths that do not increase, for numbers that
/// are not finite, and for a file without entries.
pub fn read_spd(path: &Path, context: &mut LoadContext<'_>) -> Result<Curve> {
    const HINT: &str = "each line is a wavelength in nm and a value, such as `550 0.25`";
    let bytes = context.read(path)?;
    let file = Location::file(path);
    let text = text::utf8(&bytes);
    let (mut wavelengths, mut values) = (Vec::new(), Vec::new());
    let mut pending = None;
    for (i, line) in text.split(|&byte| byte == b'\n' || byte == b'\r').enumerate() {
        let at = || file.at(u32::try_from(i + 1).unwrap_or(u32::MAX), 0);
        let line = line.split(|&byte| byte == b'#').next().unwrap_or_default();
        for word in line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()) {
            let shown: String = String::from_utf8_lossy(word).chars().take(40).collect();
            let number = parse_f32(word).ok_or_else(|| {
                if values.is_empty() && path.extension().is_none_or(|extension| extension != "spd") {
                    // Whatever it is, it is not quoted.
                    let message = "this is not a table of a spectrum: it does not begin with two numbers";
                    return Error::syntax(&file, message).hint(HINT);
                }
                Error::syntax(&at(), format!("expected a number, found `{shown}`")).hint(HINT)
            })?;
            if !number.is_finite() {
                return Err(Error::invalid(&at(), format!("`{shown}` is not a finite number")).hint(HINT));
            }
            let Some(wavelength) = pending.take() else {
                if let Some(before) = wavelengths.last().filter(|&&before| number <= before) {
                    let message = format!("the wavelength {number} is not above the previous one, {before}");
                    return Err(
                        Error::invalid(&at(), message).hint("sort the lines by wavelength, each once")
                    );
                }
                pending = Some(number);
                continue;
            };
            if wavelengths.len() as u64 >= context.limits.elements {
                let message = format!("more than the limit of {} entries", context.limits.elements);
                return Err(Error::new(ErrorKind::Limit, &at(), message).hint("use fewer"));
            }
            wavelengths.push(wavelength);
            values.push(number);
        }
    }
    if let Some(wavelength) = pending {
        return Err(
            Error::syntax(&file, format!("the last wavelength, {wavelength}, has no value")).hint(HINT)
        );
    }
    if wavelengths.is_empty() {
        return Err(Error::invalid(&file, "no wavelength is given").hint(HINT));
    }
    Ok(Curve::Tabulated { wavelengths, values })
}
