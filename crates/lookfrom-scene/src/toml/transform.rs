//! Transforms: `scale`, `rotate`, `translate` in this order, or a list `transform` of such steps in any order.

use std::sync::Arc;

use glam::{DMat4, DVec3, DVec4};

use super::table::Table;
use super::value::Value;
use crate::error::{Error, Result};
use crate::motion::Motion;

/// The keys of transforms.
pub(super) const KEYS: &[&str] = &["scale", "rotate", "translate", "transform"];
/// The keys of one step of `transform`.
pub(super) const STEPS: &[&str] = &["scale", "rotate", "translate", "matrix"];
/// The keys of a rotation about an axis.
pub(super) const ROTATION: &[&str] = &["axis", "angle"];

/// The most that the last row of a matrix may differ from 0, 0, 0, 1: other programs compute it.
const ROUNDING: f64 = 1e-6;

/// The matrix from object space to the parent space: affine, finite and invertible.
pub(super) fn world_from_object(table: &Table<'_>) -> DMat4 {
    if !table.has("transform") {
        return scale_rotate_translate(table);
    }
    for key in ["scale", "rotate", "translate"] {
        table.one_of(&[key, "transform"]);
    }
    table.or("transform", DMat4::IDENTITY, transform)
}

/// A list of any number of steps.
fn transform(steps: Value<'_>) -> Result<DMat4> {
    let mut matrix = DMat4::IDENTITY;
    for step in steps.list("a list of steps, such as [{ scale = 2 }, { translate = [0, 1, 0] }]")? {
        let step_table = step.table("a step of `transform`")?;
        step_table.allow(&[STEPS]);
        let Some(one) = step_table.one_of(STEPS) else {
            if step_table.means(STEPS) {
                return Err(Error::untold());
            }
            return Err(step
                .error("this step of `transform` is empty")
                .hint("give one of scale, rotate, translate, matrix in each step"));
        };
        let step_matrix = match one.key() {
            "scale" => scale(one)?,
            "rotate" => rotate(one)?,
            "translate" => DMat4::from_translation(one.vector()?),
            _ => from_rows(one)?,
        };
        // A matrix alone stays as it is: multiplied, −0 becomes 0.
        matrix = if is_matrix(steps) { step_matrix } else { step_matrix * matrix };
    }
    invertible(matrix, steps)
}

/// `scale`, `rotate` and `translate` of a table, in this order.
pub(super) fn scale_rotate_translate(table: &Table<'_>) -> DMat4 {
    let mut matrix = DMat4::IDENTITY;
    for (key, step) in [
        ("scale", scale as fn(Value<'_>) -> Result<DMat4>),
        ("rotate", rotate),
        ("translate", |value| Ok(DMat4::from_translation(value.vector()?))),
    ] {
        matrix = table.or(key, matrix, |value| invertible(step(value)? * matrix, value));
    }
    matrix
}

fn scale(value: Value<'_>) -> Result<DMat4> {
    let expected = "a number or [x, y, z], none of them 0";
    let factors = if value.is_number() {
        DVec3::splat(value.number()?)
    } else {
        DVec3::from_array(value.numbers(expected)?)
    };
    if factors.cmpeq(DVec3::ZERO).any() {
        return Err(value
            .error("`scale` is 0: the transform is not invertible")
            .hint(format!("give {expected}")));
    }
    Ok(DMat4::from_scale(factors))
}

/// A rotation: degrees about x, then y, then z, or about an axis.
pub(super) fn rotate(value: Value<'_>) -> Result<DMat4> {
    if value.is_table() {
        let table = value.table("`rotate`")?;
        table.allow(&[ROTATION]);
        let axis = table.need("axis", "[0, 1, 0]", DVec3::Y, Value::direction).normalize();
        return Ok(about(axis, table.need("angle", "90", 0.0, Value::number)));
    }
    let [x, y, z] = value.numbers("degrees about x, y and z, or { axis = [x, y, z], angle = degrees }")?;
    Ok(about(DVec3::Z, z) * about(DVec3::Y, y) * about(DVec3::X, x))
}

/// The rotation about a unit axis, counter-clockwise if the axis points at the viewer (Rodrigues).
pub(super) fn about(axis: DVec3, degrees: f64) -> DMat4 {
    let (sin, cos) = sin_cos(degrees);
    let column = |v: DVec3| (cos * v + sin * axis.cross(v) + (1.0 - cos) * axis.dot(v) * axis).extend(0.0);
    DMat4::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z), DVec4::W)
}

/// Sine and cosine of an angle in degrees, exact at right angles.
fn sin_cos(degrees: f64) -> (f64, f64) {
    let turned = degrees % 360.0;
    match turned {
        0.0 => (0.0, 1.0),
        90.0 | -270.0 => (1.0, 0.0),
        180.0 | -180.0 => (0.0, -1.0),
        270.0 | -90.0 => (-1.0, 0.0),
        _ => libm::sincos(turned.to_radians()),
    }
}

pub(super) fn from_rows(value: Value<'_>) -> Result<DMat4> {
    let numbers: [f64; 16] = value.numbers("16 numbers, row by row")?;
    let is_last = |(number, expected): (&f64, f64)| (number - expected).abs() <= ROUNDING;
    if !numbers[12..].iter().zip([0.0, 0.0, 0.0, 1.0]).all(is_last) {
        return Err(value.error("the last row of `matrix` must be 0, 0, 0, 1").hint("write it row by row"));
    }
    Ok(DMat4::from_cols_array(&numbers).transpose())
}

/// 16 numbers, row by row, of a matrix that has an inverse.
pub(super) fn invertible_rows(value: Value<'_>) -> Result<DMat4> {
    invertible(from_rows(value)?, value)
}

/// Matrices at equally spaced times while the shutter is open.
pub(super) fn motion(value: Value<'_>) -> Result<Arc<Motion>> {
    let expected = "a list of 2, 3, 5, 9, … matrices, at equally spaced times while the shutter is open, of 16 numbers each";
    let maps = value.list(expected)?.map(from_rows).collect::<Result<_>>()?;
    Motion::of_maps(maps).map(Arc::new).ok_or_else(|| {
        value
            .wrong(expected)
            .hint("one of them has to differ from the first; what stands still has no `motion`")
    })
}

/// The map of a table after an inner one. A matrix stays as it is, bit by bit, where the inner one is none.
pub(super) fn after(table: &Table<'_>, outer: &DMat4, inner: &DMat4) -> DMat4 {
    let stays = *inner == DMat4::IDENTITY && table.find("transform").is_some_and(is_matrix);
    if stays { *outer } else { *outer * *inner }
}

/// Whether a list of steps is a single matrix.
fn is_matrix(steps: Value<'_>) -> bool {
    let only = steps.list_of::<1>("");
    only.is_ok_and(|[step]| step.table("").is_ok_and(|table| table.has("matrix")))
}

fn invertible(matrix: DMat4, value: Value<'_>) -> Result<DMat4> {
    let determinant = matrix.determinant();
    let usable = matrix.is_finite() && determinant.is_normal() && matrix.inverse().is_finite();
    if usable {
        return Ok(matrix);
    }
    Err(value
        .error(format!("`{}` is not invertible: the determinant is {determinant}", value.key()))
        .hint("no scale may be 0 or too small or large to compute with, and the rows of a matrix must be independent"))
}
