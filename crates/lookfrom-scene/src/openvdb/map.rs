//! Maps from index space to the world (`math/Maps.h`).

use glam::{DMat4, DVec3};

use super::cursor::Cursor;
use crate::error::{ErrorKind, Result};
use crate::volume::check_map;

/// Bytes of what follows the scale in a map, which it tells: the size of a cell, and three inverses of the scale.
const OF_SCALE: u64 = 4 * 24;

/// Reads a map.
///
/// # Errors
/// `Unsupported` for maps that are not linear, `Invalid` for those without an inverse.
pub(super) fn read(cursor: &mut Cursor<'_>) -> Result<DMat4> {
    let at = cursor.at;
    let name = cursor.text("the type of a map")?;
    let map = match name {
        b"UniformScaleMap" | b"ScaleMap" => DMat4::from_scale(scale(cursor)?),
        b"TranslationMap" => DMat4::from_translation(vector(cursor)?),
        b"UniformScaleTranslateMap" | b"ScaleTranslateMap" => {
            let translation = vector(cursor)?;
            let scale = DMat4::from_scale(scale(cursor)?);
            DMat4 { w_axis: translation.extend(1.0), ..scale }
        }
        // Points are rows before these matrices, so that their rows are our columns.
        b"AffineMap" | b"UnitaryMap" => {
            let mut numbers = [0.0; 16];
            for number in &mut numbers {
                *number = cursor.f64()?;
            }
            DMat4::from_cols_array(&numbers)
        }
        name => {
            let name = String::from_utf8_lossy(name);
            let message =
                format!("a map of the type {name:?}, expected scales, translations and affine maps");
            let error = cursor.bytes.error(at, ErrorKind::Unsupported, message);
            return Err(error.hint("resample the grid to one with a linear map"));
        }
    };
    if map.row(3) != DMat4::IDENTITY.row(3) {
        return Err(cursor.bytes.error(at, ErrorKind::Invalid, "a matrix that is no affine map"));
    }
    check_map(&map, cursor.bytes, at)?;
    Ok(map)
}

fn vector(cursor: &mut Cursor<'_>) -> Result<DVec3> {
    Ok(DVec3::new(cursor.f64()?, cursor.f64()?, cursor.f64()?))
}

fn scale(cursor: &mut Cursor<'_>) -> Result<DVec3> {
    let scale = vector(cursor)?;
    cursor.slice(OF_SCALE, "a map")?;
    Ok(scale)
}
