//! Transforms: each is applied after those before it.

use glam::{DMat4, DVec3};
use roxmltree::Node;

use super::value;
use super::xml::Reading;
use super::xml::Text;
use crate::camera::{Look, up_across};
use crate::error::{Error, Result};

/// The matrix of a `transform` element.
pub(super) fn matrix(reading: &mut Reading<'_, '_>, node: Node<'_, '_>, text: &Text) -> Result<DMat4> {
    let mut matrix = DMat4::IDENTITY;
    for child in node.children().filter(Node::is_element) {
        let step = step(reading, child, text)?;
        matrix = step * matrix;
        if !matrix.is_finite() {
            return Err(Error::invalid(
                &text.at(child.range().start),
                "the numbers of this transform are too large",
            ));
        }
    }
    Ok(matrix)
}

fn step(reading: &mut Reading<'_, '_>, node: Node<'_, '_>, text: &Text) -> Result<DMat4> {
    let at = text.at(node.range().start);
    let tag = node.tag_name().name();
    let known: &[&str] = match tag {
        "translate" | "scale" => &["x", "y", "z", "value"],
        "rotate" => &["x", "y", "z", "value", "angle"],
        "matrix" => &["value"],
        "lookat" | "lookAt" | "look_at" => &["origin", "target", "up"],
        _ => {
            let error = Error::invalid(&at, format!("<{tag}> is not a known transform"));
            return Err(error.hint("there are: lookat, matrix, rotate, scale, translate"));
        }
    };
    reading.check_attributes(node, known, text)?;
    Ok(match tag {
        "translate" => DMat4::from_translation(components(reading, node, text, 0.0)?),
        "scale" => DMat4::from_scale(components(reading, node, text, 1.0)?),
        "rotate" => {
            let axis = components(reading, node, text, 0.0)?;
            let unit = axis
                .try_normalize()
                .ok_or_else(|| Error::invalid(&at, "the axis of this rotation has no direction"))?;
            // Versions from 2 on take the axis as it is.
            let axis = if reading.is_old() { unit } else { axis };
            let angle = match reading.attribute(node, "angle", text)? {
                Some((angle, at)) => value::float(&angle, &at)?,
                None => return Err(Error::invalid(&at, "this rotation has no `angle` (in degrees)")),
            };
            rotation(axis, angle)
        }
        "matrix" => {
            let Some((numbers, at)) = reading.attribute(node, "value", text)? else {
                return Err(Error::invalid(&at, "this matrix has no `value`"));
            };
            let numbers = value::floats(&numbers, &at)?;
            match numbers.len() {
                16 => {
                    let rows: [f64; 16] = std::array::from_fn(|index| numbers[index]);
                    if rows[12..] != [0.0, 0.0, 0.0, 1.0] {
                        let message = "the last row of a matrix has to be 0 0 0 1";
                        return Err(Error::new(crate::error::ErrorKind::Unsupported, &at, message));
                    }
                    DMat4::from_cols_array(&rows).transpose()
                }
                9 => {
                    let rows = std::array::from_fn(|index| numbers[index]);
                    DMat4::from_mat3(glam::DMat3::from_cols_array(&rows).transpose())
                }
                count => {
                    return Err(Error::invalid(&at, format!("a matrix has 16 or 9 numbers, found {count}")));
                }
            }
        }
        _ => {
            let mut point = |name: &str| match reading.attribute(node, name, text)? {
                Some((written, at)) => value::vector(&written, &at).map(Some),
                None => Ok(None),
            };
            let (origin, target, up) = (point("origin")?, point("target")?, point("up")?);
            let (Some(origin), Some(target)) = (origin, target) else {
                return Err(Error::invalid(&at, "a lookat has an `origin` and a `target`"));
            };
            look_at(origin, target, up).ok_or_else(|| {
                Error::invalid(
                    &at,
                    "`target` has to be another point than `origin`, and not in the direction of `up`",
                )
            })?
        }
    })
}

/// Rotation around an axis, by an angle in degrees (Rodrigues 1840): around one that is not of unit length it scales and shears, too.
fn rotation(axis: DVec3, degrees: f64) -> DMat4 {
    let (sin, cos) = match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        other => libm::sincos(other.to_radians()),
    };
    let turned = |v: DVec3| v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos));
    DMat4::from_mat3(glam::DMat3::from_cols(turned(DVec3::X), turned(DVec3::Y), turned(DVec3::Z)))
}

/// The transform from a space with x to the left, y up and z forward, at `origin`.
fn look_at(origin: DVec3, target: DVec3, up: Option<DVec3>) -> Option<DMat4> {
    let forward = (target - origin).try_normalize()?;
    let up = up.filter(|up| *up != DVec3::ZERO).unwrap_or_else(|| up_across(forward));
    Look { lookfrom: origin, lookat: target, up }.matrix()
}

/// Three components: `x`, `y` and `z`, or all in `value`.
fn components(reading: &mut Reading<'_, '_>, node: Node<'_, '_>, text: &Text, default: f64) -> Result<DVec3> {
    if let Some((written, at)) = reading.attribute(node, "value", text)? {
        return value::vector(&written, &at);
    }
    let mut component = |name: &str| match reading.attribute(node, name, text)? {
        Some((written, at)) => value::float(&written, &at),
        None => Ok(default),
    };
    Ok(DVec3::new(component("x")?, component("y")?, component("z")?))
}
