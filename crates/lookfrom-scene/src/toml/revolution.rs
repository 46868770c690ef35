//! `[[cone]]`, `[[torus]]` and `[[lathe]]`: a profile that turns around an axis, as a mesh with exact normals; tori by themselves are exact.
//!
//! A profile goes from the axis below outward, up and back to the axis: then its surface faces outward.

use std::f64::consts::{PI, TAU};

use glam::{DMat4, DVec2, DVec3, Vec2, Vec3};

use super::Reader;
use super::mesh::too_many;
use super::quadric::{along, around};
use super::table::Table;
use super::value::Value;
use crate::error::Result;
use crate::shape::{Geometry, Mesh};

/// The number of straight pieces around the axis, and along a circle.
pub(super) const SEGMENTS: u64 = 96;
const MOST_SEGMENTS: u64 = 1 << 16;
/// Straight pieces between two points of a smooth profile.
const PIECES: u32 = 16;

/// A point of a profile: its distance from the axis, its height along it, and the normal there, of any length.
#[derive(Clone, Copy, Debug)]
struct Ring {
    point: DVec2,
    normal: DVec2,
}

/// A piece of a profile. Neighbours that share a normal are smooth, others have an edge between them.
type Piece = [Ring; 2];

impl Reader<'_, '_> {
    /// A closed cone or frustum between two points, and the transform from its own space.
    pub(super) fn cone(&mut self, table: &Table<'_>) -> Result<(Geometry, DMat4)> {
        let from = table.need("from", "[0, 0, 0]", DVec3::ZERO, Value::vector);
        let to = table.need("to", "[0, 1, 0]", DVec3::Y, Value::vector);
        let radius = table.need("radius", "0.5", 1.0, Value::positive);
        let tip_radius = table.or("tip_radius", 0.0, Value::not_negative);
        let is_closed = table.or("closed", true, Value::boolean);
        table.sound(&["from", "to", "radius"])?;
        let axis = to - from;
        let height = axis.length();
        if !height.is_normal() {
            return Err(table
                .error_at("to", "`to` is the same point as `from`, or too near or too far away")
                .hint("give the centre of the base and the tip"));
        }
        let mut points = vec![DVec2::new(radius, 0.0), DVec2::new(tip_radius, height)];
        if is_closed {
            points.insert(0, DVec2::ZERO);
            points.extend((tip_radius > 0.0).then_some(DVec2::new(0.0, height)));
        }
        self.revolved(table, "cone", &edged(&points), along(from, axis / height))
    }

    /// A torus, and the transform from its own space: exact, but a mesh where it is said of how many pieces.
    pub(super) fn torus(&mut self, table: &Table<'_>) -> Result<(Geometry, DMat4)> {
        let center = table.or("center", DVec3::ZERO, Value::vector);
        let axis = table.or("axis", DVec3::Y, Value::direction);
        let radius = table.need("radius", "1", 1.0, Value::positive);
        let tube = table.need("tube", "0.25", 0.25, Value::positive);
        table.sound(&["axis", "radius", "tube"])?;
        let own = around(center, axis);
        if table.has("segments") {
            return self.revolved(table, "torus", &tube_around(radius, tube), own);
        }
        Ok((Geometry::Torus { radius, tube }, own))
    }

    /// A profile around an axis, and the transform from its own space.
    pub(super) fn lathe(&mut self, table: &Table<'_>) -> Result<(Geometry, DMat4)> {
        let from = table.or("from", DVec3::ZERO, Value::vector);
        let axis = table.or("axis", DVec3::Y, Value::direction);
        let is_smooth = table.or("smooth", true, Value::boolean);
        let example = "[[0, 0], [0.4, 0.1], [0.3, 1]]";
        let expected = "two numbers, [radius, height], of which the radius is at least 0";
        let points = table.need("profile", example, Vec::new(), |value| {
            let points = value.list("a list of points, [radius, height]")?;
            let point = |value: Value<'_>| {
                let [radius, height] = value.numbers(expected)?;
                if radius < 0.0 { Err(value.wrong(expected)) } else { Ok(DVec2::new(radius, height)) }
            };
            points.map(point).collect::<Result<Vec<_>>>()
        });
        table.sound(&["axis", "profile"])?;
        if points.len() < 2 {
            let message = format!(
                "a profile of {}; expected at least two",
                crate::plural::counted(points.len(), "point")
            );
            return Err(table.error_at("profile", message));
        }
        if let Some(pair) = points.windows(2).find(|pair| pair[0] == pair[1]) {
            let message = format!("the profile has the point {} twice in a row", pair[0]);
            return Err(table.error_at("profile", message).hint("leave one of them out"));
        }
        let pieces = if is_smooth { smooth(&points) } else { edged(&points) };
        self.revolved(table, "lathe", &pieces, along(from, axis.normalize()))
    }

    /// A profile turned around the z axis as a mesh; `own` is the transform of its space.
    fn revolved(
        &mut self,
        table: &Table<'_>,
        name: &str,
        pieces: &[Piece],
        own: DMat4,
    ) -> Result<(Geometry, DMat4)> {
        let segments = table.or("segments", self.segments, |value| value.integer(3, MOST_SEGMENTS));
        let limit = self.context.limits.elements;
        let count = 2 * segments * pieces.len() as u64;
        if count > limit {
            return Err(too_many(table, count, limit));
        }
        let _memory = self.context.budget.reserve(count * 56, "the mesh", &table.at())?;
        let mesh = Mesh { name: name.to_owned(), ..revolve(pieces, segments as u32) };
        Ok((self.mesh(table, mesh)?, own))
    }
}

/// A sphere of radius 1 whose poles lie on the z axis.
pub(super) fn ball(segments: u32) -> Mesh {
    let rings = (segments / 2).max(2);
    let at = |index: u32| {
        let (sin, cos) = libm::sincos(PI * f64::from(index) / f64::from(rings));
        let normal = DVec2::new(if index.is_multiple_of(rings) { 0.0 } else { sin }, -cos);
        Ring { point: normal, normal }
    };
    let pieces: Vec<Piece> = (0..rings).map(|index| [at(index), at(index + 1)]).collect();
    revolve(&pieces, segments)
}

/// A torus around the z axis.
pub(super) fn torus(radius: f64, tube: f64, segments: u32) -> Mesh {
    revolve(&tube_around(radius, tube), segments)
}

/// The profile of a torus.
fn tube_around(radius: f64, tube: f64) -> Vec<Piece> {
    let at = |index: u64| {
        let (sin, cos) = libm::sincos(TAU * index as f64 / SEGMENTS as f64);
        let normal = DVec2::new(cos, sin);
        Ring { point: DVec2::new(radius, 0.0) + tube * normal, normal }
    };
    (0..SEGMENTS).map(|index| [at(index), at((index + 1) % SEGMENTS)]).collect()
}

/// A cylinder around the z axis with both of its ends; v goes from 0 to 1 along each of the three.
pub(super) fn closed_cylinder(radius: f64, [low, high]: [f64; 2], segments: u32) -> Mesh {
    let point = DVec2::new;
    let profile = [point(0.0, low), point(radius, low), point(radius, high), point(0.0, high)];
    let mut mesh = revolve(&edged(&profile), segments);
    for (index, uv) in mesh.uvs.iter_mut().enumerate() {
        uv.y = (index % 2) as f32;
    }
    mesh
}

/// Straight pieces between points, with edges between them.
fn edged(points: &[DVec2]) -> Vec<Piece> {
    let piece = |pair: &[DVec2]| {
        let normal = outward(pair[1] - pair[0]);
        [pair[0], pair[1]].map(|point| Ring { point, normal })
    };
    points.windows(2).map(piece).collect()
}

/// The smooth curve through points: centripetal Catmull–Rom (Yuksel, Schaefer, Keyser 2011), without loops and cusps.
fn smooth(points: &[DVec2]) -> Vec<Piece> {
    // The ends go on straight.
    let (first, last) = (points[0], points[points.len() - 1]);
    let before = 2.0 * first - points[1];
    let behind = 2.0 * last - points[points.len() - 2];
    let all: Vec<DVec2> =
        std::iter::once(before).chain(points.iter().copied()).chain(std::iter::once(behind)).collect();
    let mut pieces = Vec::new();
    for four in all.windows(4) {
        let [p0, p1, p2, p3] = [four[0], four[1], four[2], four[3]];
        let step = |a: DVec2, b: DVec2| (b - a).length().sqrt();
        let [d1, d2, d3] = [step(p0, p1), step(p1, p2), step(p2, p3)];
        // Tangents by the parameter of the span, from 0 to 1.
        let m1 = d2 * ((p1 - p0) / d1 - (p2 - p0) / (d1 + d2) + (p2 - p1) / d2);
        let m2 = d2 * ((p2 - p1) / d2 - (p3 - p1) / (d2 + d3) + (p3 - p2) / d3);
        let at = |index: u32| {
            let t = f64::from(index) / f64::from(PIECES);
            let (t2, t3) = (t * t, t * t * t);
            let point = (2.0 * t3 - 3.0 * t2 + 1.0) * p1
                + (t3 - 2.0 * t2 + t) * m1
                + (3.0 * t2 - 2.0 * t3) * p2
                + (t3 - t2) * m2;
            let tangent = (6.0 * t2 - 6.0 * t) * (p1 - p2)
                + (3.0 * t2 - 4.0 * t + 1.0) * m1
                + (3.0 * t2 - 2.0 * t) * m2;
            Ring { point: point.max(DVec2::new(0.0, f64::NEG_INFINITY)), normal: outward(tangent) }
        };
        pieces.extend((0..PIECES).map(|index| [at(index), at(index + 1)]));
    }
    pieces
}

/// The normal of a profile that goes in this direction.
fn outward(tangent: DVec2) -> DVec2 {
    DVec2::new(tangent.y, -tangent.x)
}

/// The mesh of a profile around the z axis. u is the fraction of a turn, v that of the profile's length.
fn revolve(pieces: &[Piece], segments: u32) -> Mesh {
    let length = |piece: &Piece| (piece[1].point - piece[0].point).length();
    let whole: f64 = pieces.iter().map(length).sum();
    let mut mesh = Mesh::default();
    let mut v = 0.0;
    for piece in pieces {
        let first = mesh.positions.len() as u32;
        let ends = [v, v + length(piece) / whole];
        v = ends[1];
        for column in 0..=segments {
            let u = f64::from(column) / f64::from(segments);
            // The last column is the first again, but for u.
            let (sin, cos) = libm::sincos(TAU * f64::from(column % segments) / f64::from(segments));
            let around = |p: DVec2| DVec3::new(p.x * cos, p.x * sin, p.y).as_vec3();
            for (Ring { point, normal }, v) in piece.iter().zip(ends) {
                mesh.positions.push(around(*point));
                mesh.normals.push(around(normal.normalize_or_zero()));
                mesh.uvs.push(Vec2::new(u as f32, v as f32));
            }
        }
        for column in 0..segments {
            let [a, b] = [first + 2 * column, first + 2 * column + 2];
            let on_axis = piece.map(|ring| ring.point.x == 0.0);
            mesh.triangles.extend((!on_axis[0]).then_some([a, b, b + 1]));
            mesh.triangles.extend((!on_axis[1]).then_some([a, b + 1, a + 1]));
        }
    }
    debug_assert!(mesh.normals.iter().all(|normal: &Vec3| normal.is_finite()));
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The volume inside of a closed mesh (the divergence theorem): positive if it faces outward.
    fn volume(mesh: &Mesh) -> f64 {
        let corner = |vertex: u32| mesh.positions[vertex as usize].as_dvec3();
        let parts = mesh.triangles.iter().map(|triangle| {
            let [a, b, c] = triangle.map(corner);
            a.dot(b.cross(c)) / 6.0
        });
        parts.sum()
    }

    /// The factor of the area of a polygon with so many sides in a circle of 1.
    fn polygon(sides: f64) -> f64 {
        0.5 * sides * (TAU / sides).sin()
    }

    #[test]
    fn cones_have_their_volume() {
        let points = [DVec2::ZERO, DVec2::new(2.0, 0.0), DVec2::new(1.0, 3.0), DVec2::new(0.0, 3.0)];
        let mesh = revolve(&edged(&points), 24);
        let expected = polygon(24.0) * 3.0 / 3.0 * (4.0 + 2.0 + 1.0);
        assert!((volume(&mesh) / expected - 1.0).abs() < 1e-6, "{}", volume(&mesh));
        // No triangle is degenerate.
        assert_eq!(mesh.triangles.len(), 24 * 4);
    }

    #[test]
    fn normals_are_those_of_the_surface() {
        let half = |index: u32| {
            let (sin, cos) = (0.1 * f64::from(index) - 1.5).sin_cos();
            DVec2::new(2.0 * cos, 2.0 * sin)
        };
        let circle: Vec<DVec2> = (0..31).map(half).collect();
        let mesh = revolve(&smooth(&circle), 48);
        for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
            let (position, normal) = (position.as_dvec3(), normal.as_dvec3());
            assert!((position.length() - 2.0).abs() < 2e-3, "{position}");
            // At its ends a curve goes on straight, half a step of 0.1 off the circle.
            assert!(normal.dot(position.normalize()) > 0.998, "{position} {normal}");
        }
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
            let normal = mesh.normals[triangle[0] as usize];
            assert!((b - a).cross(c - a).dot(normal) > 0.0);
        }
    }
}
