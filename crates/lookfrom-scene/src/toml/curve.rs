//! `[[patch]]` and `[[curve]]`: bilinear patches and cubic curves.

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};

use super::mesh::too_many;
use super::shape::point;
use super::table::Table;
use super::value::{Value, unit};
use crate::error::Result;
use crate::shape::{Geometry, Patches, Profile, Strand};

/// The words for profiles; normals of ribbons are given besides.
pub(super) const PROFILES: &[(&str, Profile)] = &[
    ("flat", Profile::Flat),
    ("cylinder", Profile::Cylinder),
    ("cylinder_pbrt", Profile::PbrtCylinder),
    ("ribbon", Profile::Ribbon([Vec3::Z; 2])),
];

/// A bilinear patch with four corners.
pub(super) fn patch(table: &Table<'_>) -> Result<Geometry> {
    let example = "[[0, 0, 0], [1, 0, 0], [0, 0, 1], [1, 0, 1]]";
    let corners = table.need("corners", example, [Vec3::ZERO; 4], |value| {
        four(value, "four points, at (u, v) = (0, 0), (1, 0), (0, 1), (1, 1)", point)
    });
    let normals = table.maybe("normals", |value| four(value, "four normals, one for each corner", point));
    let uvs = table.maybe("uvs", |value| {
        let pair = |value: Value<'_>| value.singles("two numbers, [u, v]").map(Vec2::from_array);
        four(value, "four pairs [u, v], one for each corner", pair)
    });
    table.sound(&["corners"])?;
    let [a, b, c, d] = corners.map(Vec3::as_dvec3);
    let is_flat_at = |p: DVec3, q: DVec3, r: DVec3| (q - p).cross(r - p) == DVec3::ZERO;
    if is_flat_at(a, b, c) && is_flat_at(d, b, c) {
        let message = "the patch has no area: its corners lie on a line";
        return Err(table.error_at("corners", message).hint("move one of them"));
    }
    Ok(Geometry::Bilinear(Arc::new(Patches {
        positions: corners.to_vec(),
        patches: vec![[0, 1, 2, 3]],
        normals: normals.map_or(Vec::new(), |normals| normals.to_vec()),
        uvs: uvs.map_or(Vec::new(), |uvs| uvs.to_vec()),
    })))
}

fn four<T>(value: Value<'_>, expected: &str, decode: impl Fn(Value<'_>) -> Result<T>) -> Result<[T; 4]> {
    let [a, b, c, d] = value.list_of(expected)?;
    Ok([decode(a)?, decode(b)?, decode(c)?, decode(d)?])
}

/// Cubic Bézier curves, each of which begins where the previous one ends.
pub(super) fn curve(table: &Table<'_>, limit: u64) -> Result<Geometry> {
    let profile = table.or("profile", Profile::Flat, |value| value.choice(PROFILES));
    let example = "[[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 2, 0]]";
    let points = table.need("points", example, Vec::new(), |value| {
        let expected = "4, 7, 10, … points: each curve has two between its ends";
        let items = value.list(expected)?;
        let count = items.len();
        if count as u64 > limit {
            return Err(too_many(table, count as u64, limit));
        }
        if count < 4 || count % 3 != 1 {
            return Err(value.wrong(expected).hint("curves that follow one another share an end"));
        }
        items.map(point).collect::<Result<Vec<Vec3>>>()
    });
    table.sound(&["points"])?;
    let joints = points.len() / 3 + 1;
    let widths = table.need("width", "0.1", Vec::new(), |value| widths(value, joints));
    table.sound(&["profile"])?;
    let normals = ribbon(table, joints)?;
    table.sound(&["width"])?;
    let strands = (0..joints - 1).map(|i| Strand {
        points: [0, 1, 2, 3].map(|j| points[3 * i + j]),
        width: [widths[i], widths[i + 1]],
        profile: match &normals {
            Some(normals) => Profile::Ribbon([normals[i], normals[i + 1]]),
            None => profile,
        },
    });
    Ok(Geometry::Curves(strands.collect()))
}

/// One width for all, or one per joint.
fn widths(value: Value<'_>, joints: usize) -> Result<Vec<f32>> {
    let width = |value: Value<'_>| value.single_where("a number greater than 0", |width| width > 0.0);
    if value.is_number() {
        return Ok(vec![width(value)?; joints]);
    }
    let expected = format!("a number, or a list of {joints}, one for each end of a curve");
    let items = value.list(&expected)?;
    if items.len() != joints {
        return Err(value.wrong(&expected));
    }
    items.map(width).collect()
}

/// The unit normals of a ribbon at its joints; `None` for other profiles.
fn ribbon(table: &Table<'_>, joints: usize) -> Result<Option<Vec<Vec3>>> {
    let is_ribbon = table.find("profile").and_then(Value::as_text) == Some("ribbon");
    let expected = format!("a list of {joints} vectors, one for each end of a curve");
    match (table.find("normals"), is_ribbon) {
        (None, false) => Ok(None),
        (Some(value), false) => Err(value
            .error("`normals` are for ribbons")
            .hint("leave them out, or add `profile = \"ribbon\"`")),
        (None, true) => Err(table
            .error("`normals` are missing: they orient the ribbon")
            .hint(format!("add `normals`, {expected}"))),
        (Some(value), true) => {
            let items = value.list(&expected)?;
            if items.len() != joints {
                return Err(value.wrong(&expected));
            }
            items.map(|item| Ok(unit(item)?.as_vec3())).collect::<Result<_>>().map(Some)
        }
    }
}
