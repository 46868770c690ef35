//! Transform directives, which multiply onto the current transformation matrix.
//!
//! Matrices multiply column vectors; a file's sixteen numbers are in column-major order. Computed in double precision,
//! where pbrt uses single.

use glam::{DMat4, DVec3, DVec4};

use super::lexer::{Lexer, Token};
use super::text::Place;
use crate::error::Result;

pub(super) fn numbers<const N: usize>(lexer: &mut Lexer<'_>) -> Result<[f64; N]> {
    let mut numbers = [0.0; N];
    for number in &mut numbers {
        *number = lexer.double()?;
    }
    Ok(numbers)
}

/// An affine matrix from sixteen numbers in brackets.
pub(super) fn matrix(lexer: &mut Lexer<'_>, place: &Place) -> Result<DMat4> {
    let start = lexer.here();
    if lexer.token()? != Some(Token::Open) {
        return Err(lexer.wrong(start, "`[` and 16 numbers"));
    }
    let columns: [f64; 16] = numbers(lexer)?;
    let start = lexer.here();
    if lexer.token()? != Some(Token::Close) {
        return Err(lexer.wrong(start, "`]` after 16 numbers"));
    }
    let matrix = DMat4::from_cols_array(&columns);
    let row = matrix.row(3);
    if row.truncate() != DVec3::ZERO || row.w == 0.0 {
        let error =
            place.invalid("the matrix is projective: its 4th, 8th, 12th number are not 0, or its last is");
        return Err(error.hint("numbers are columns, one after another: the translation is the last column"));
    }
    Ok(matrix * (1.0 / row.w))
}

/// The matrix from world space to the space of a viewer at `eye`: x to the right, y up, z forward, left-handed.
pub(super) fn look_at([ex, ey, ez, lx, ly, lz, ux, uy, uz]: [f64; 9], place: &Place) -> Result<DMat4> {
    let (eye, at, up) = (DVec3::new(ex, ey, ez), DVec3::new(lx, ly, lz), DVec3::new(ux, uy, uz));
    let forward = (at - eye).try_normalize();
    let forward = forward
        .ok_or_else(|| place.invalid("LookAt: the eye (3 numbers) and the look-at point (3) are the same"))?;
    let right = up.normalize_or_zero().cross(forward).try_normalize().filter(|_| up != DVec3::ZERO);
    let right = right.ok_or_else(|| {
        place
            .invalid("LookAt: up (the last 3 numbers) is parallel to the view direction")
            .hint("give any direction that points up in the image")
    })?;
    let true_up = forward.cross(right);
    let world_from_eye =
        DMat4::from_cols(right.extend(0.0), true_up.extend(0.0), forward.extend(0.0), eye.extend(1.0));
    Ok(world_from_eye.inverse())
}

/// Rotation by an angle in degrees around an axis.
pub(super) fn rotate([angle, x, y, z]: [f64; 4], place: &Place) -> Result<DMat4> {
    let axis = DVec3::new(x, y, z).try_normalize();
    let axis = axis.ok_or_else(|| place.invalid("Rotate: the axis (the last 3 numbers) has no direction"))?;
    let (sin, cos) = libm::sincos(angle.to_radians());
    let column = |e: DVec3| {
        let along = axis * axis.dot(e);
        (along + (e - along) * cos + axis.cross(e) * sin).extend(0.0)
    };
    Ok(DMat4::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z), DVec4::W))
}

/// Whether the matrix is invertible, and all its values are finite.
pub(super) fn is_invertible(matrix: &DMat4) -> bool {
    let determinant = matrix.determinant();
    determinant != 0.0 && determinant.is_finite() && matrix.is_finite() && matrix.inverse().is_finite()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::text::Text;
    use super::*;

    fn place() -> Place {
        Place::new(&Text::new(Path::new("a"), Vec::new().into()), 0)
    }

    #[test]
    fn rotations_turn_as_right_hands_do() {
        let quarter = rotate([90.0, 0.0, 0.0, 5.0], &place()).expect("an axis");
        assert!((quarter.transform_vector3(DVec3::X) - DVec3::Y).length() < 1e-15);
        assert!(rotate([90.0, 0.0, 0.0, 0.0], &place()).is_err());
        // Compared with glam's rotation.
        let axis = DVec3::new(1.0, -2.0, 0.5);
        let ours = rotate([33.0, axis.x, axis.y, axis.z], &place()).expect("an axis");
        assert!(ours.abs_diff_eq(DMat4::from_axis_angle(axis.normalize(), 33_f64.to_radians()), 1e-14));
    }

    #[test]
    fn the_eye_looks_along_z() {
        let eye_from_world =
            look_at([1.0, 2.0, 3.0, 1.0, 2.0, 9.0, 0.0, 1.0, 0.0], &place()).expect("a view");
        assert_eq!(eye_from_world.transform_point3(DVec3::new(1.0, 2.0, 5.0)), DVec3::new(0.0, 0.0, 2.0));
        assert_eq!(eye_from_world.transform_vector3(DVec3::X), DVec3::X);
        assert!(look_at([0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0], &place()).is_err());
        assert!(look_at([0.0; 9], &place()).is_err());
    }

    #[test]
    fn no_inverse_is_seen() {
        assert!(is_invertible(&DMat4::from_scale(DVec3::new(1e-60, 1.0, -1.0))));
        assert!(!is_invertible(&DMat4::from_scale(DVec3::new(0.0, 1.0, 1.0))));
        assert!(!is_invertible(&DMat4::from_translation(DVec3::splat(f64::NAN))));
    }
}
