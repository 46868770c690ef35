//! Meshes from faces with separate indices for position, texture coordinates and normal.
//!
//! One mesh per material: polygons are triangulated, corners with equal indices share a vertex, and normals are generated
//! where smoothing groups require them: face normals weighted by the angle at the corner (Thürmer & Wüthrich 1998), so
//! that they do not depend on the triangulation.

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};

use super::statement::{Corner, Face, Group, NONE, Statements};
use crate::error::{Location, Result};
use crate::files::LoadContext;
use crate::model::polygon::{Triangulator, has_area};
use crate::model::tally::Tally;
use crate::model::weld::Weld;
use crate::shape::{Mesh, Piece, Pieces};

/// All meshes of a file.
pub(super) struct Meshes {
    pub(super) groups: Vec<MeshGroup>,
    /// The locations and names of material libraries.
    pub(super) libraries: Vec<(Location, Vec<u8>)>,
}

/// The faces or the lines of one material.
pub(super) struct MeshGroup {
    pub(super) material: Option<Vec<u8>>,
    pub(super) object: Option<Arc<str>>,
    pub(super) elements: Elements,
}

/// The elements of a group.
pub(super) enum Elements {
    /// A mesh, and the objects that it is made of.
    Mesh(Box<Mesh>, Pieces),
    /// The ends of lines, and the colour of each, where vertices have colours.
    Lines(Vec<[Vec3; 2]>, Vec<[f32; 3]>),
}

/// Counts of elements that could not be used.
#[derive(Default)]
struct Tallies {
    not_finite: Tally,
    flat: Tally,
    values: Tally,
    lines: Tally,
}

/// Builds the meshes; groups without triangles are left out.
pub(super) fn meshes(
    mut statements: Statements,
    file: &Location,
    context: &mut LoadContext<'_>,
) -> Result<Meshes> {
    let mut tallies = Tallies::default();
    let mut triangulator = Triangulator::new();
    make_values_finite(&mut statements, &mut tallies.values);
    smooth(&mut statements, &mut triangulator);
    let mut groups = Vec::new();
    for group in std::mem::take(&mut statements.groups) {
        let mesh_group =
            |elements| MeshGroup { material: group.material.clone(), object: group.object.clone(), elements };
        let (mut mesh, pieces) = mesh(&group, &statements, &mut triangulator, &mut tallies);
        if !mesh.triangles.is_empty() {
            mesh.name = file.file.to_string();
            groups.push(mesh_group(Elements::Mesh(Box::new(mesh), pieces)));
        }
        let (ends, colors) = lines(&group, &statements, &mut tallies.lines);
        if !ends.is_empty() {
            groups.push(mesh_group(Elements::Lines(ends, colors)));
        }
    }
    tallies.lines.warn("line", "left out: a coordinate is infinite or not a number", file, context);
    tallies.not_finite.warn("face", "left out: a coordinate is infinite or not a number", file, context);
    tallies.flat.notice("triangle", "left out: without area", file, context);
    tallies.values.warn("normal or texture coordinate", "ignored: infinite or not a number", file, context);
    if triangulator.gave_up() {
        context.warn(
            file,
            "concave polygons with very many corners: some were triangulated as if they were convex",
        );
    }
    Ok(Meshes { groups, libraries: statements.libraries })
}

fn make_values_finite(statements: &mut Statements, tally: &mut Tally) {
    for normal in statements.normals.iter_mut().filter(|normal| !normal.is_finite()) {
        *normal = Vec3::ZERO;
        tally.add(0);
    }
    for uv in statements.uvs.iter_mut().filter(|uv| !uv.is_finite()) {
        *uv = Vec2::ZERO;
        tally.add(0);
    }
}

/// Calls `each` with the corners and face of every triangle of a group, and `skipped` with the lines of faces whose
/// positions are not finite.
fn triangles(
    group: &Group,
    positions: &[Vec3],
    triangulator: &mut Triangulator,
    mut skipped: impl FnMut(u32),
    mut each: impl FnMut([usize; 3], [Vec3; 3], &Face),
) {
    let mut points = Vec::new();
    let mut cut = Vec::new();
    let mut start = 0;
    for face in &group.faces {
        let corners = &group.corners[start..start + face.corners as usize];
        points.clear();
        points.extend(corners.iter().map(|corner| positions[corner.position as usize]));
        if points.iter().all(|point| point.is_finite()) {
            cut.clear();
            triangulator.cut(&points, &mut cut);
            for triangle in &cut {
                let local = triangle.map(|i| i as usize);
                each(local.map(|i| start + i), local.map(|i| points[i]), face);
            }
        } else {
            skipped(face.line);
        }
        start += face.corners as usize;
    }
}

/// Adds a normal to each corner that has none and lies in a smoothing group: one per position and group.
fn smooth(statements: &mut Statements, triangulator: &mut Triangulator) {
    let Statements { groups, positions, normals, .. } = statements;
    let mut weld = Weld::new();
    let mut sums: Vec<DVec3> = Vec::new();
    for group in &*groups {
        if group.faces.iter().all(|face| face.smoothing == 0) {
            continue;
        }
        triangles(
            group,
            positions,
            triangulator,
            |_| {},
            |corners, points, &Face { smoothing, .. }| {
                let points = points.map(Vec3::as_dvec3);
                let facet = (points[1] - points[0]).cross(points[2] - points[0]).normalize_or_zero();
                for (i, corner) in corners.into_iter().enumerate() {
                    let Corner { position, normal, .. } = group.corners[corner];
                    if normal == NONE && smoothing != 0 {
                        let id = weld.id([position, smoothing]) as usize;
                        sums.resize(sums.len().max(id + 1), DVec3::ZERO);
                        sums[id] += facet * angle(points[i], points[(i + 1) % 3], points[(i + 2) % 3]);
                    }
                }
            },
        );
    }
    let first = normals.len() as u32;
    normals.extend(sums.iter().map(|sum| sum.normalize_or_zero().as_vec3()));
    for group in groups {
        let mut start = 0;
        for face in &group.faces {
            let corners = &mut group.corners[start..start + face.corners as usize];
            start += face.corners as usize;
            for corner in corners.iter_mut().filter(|corner| corner.normal == NONE && face.smoothing != 0) {
                let id = weld.id([corner.position, face.smoothing]);
                // Corners of skipped faces have no sum, and no triangle uses them.
                if (id as usize) < sums.len() {
                    corner.normal = first + id;
                }
            }
        }
    }
}

/// The angle at `tip`, in radians; 0 if a side has no length.
fn angle(tip: DVec3, a: DVec3, b: DVec3) -> f64 {
    let (a, b) = ((a - tip).normalize_or_zero(), (b - tip).normalize_or_zero());
    if a == DVec3::ZERO || b == DVec3::ZERO { 0.0 } else { libm::acos(a.dot(b).clamp(-1.0, 1.0)) }
}

fn mesh(
    group: &Group,
    statements: &Statements,
    triangulator: &mut Triangulator,
    tallies: &mut Tallies,
) -> (Mesh, Pieces) {
    let mut mesh = Mesh::default();
    let mut pieces = Vec::new();
    let mut last = NONE;
    let mut weld = Weld::new();
    let Tallies { not_finite, flat, .. } = tallies;
    triangles(
        group,
        &statements.positions,
        triangulator,
        |line| not_finite.add(line),
        |corners, points, face| {
            if has_area(points) {
                if face.object != last {
                    last = face.object;
                    let name = statements.objects.get(last as usize).cloned();
                    pieces.push(Piece { first: mesh.triangles.len() as u32, name });
                }
                mesh.triangles.push(corners.map(|corner| {
                    let Corner { position, uv, normal } = group.corners[corner];
                    weld.id([position, uv, normal])
                }));
            } else {
                flat.add(face.line);
            }
        },
    );
    let keys = weld.keys();
    mesh.positions = keys.iter().map(|key| statements.positions[key[0] as usize]).collect();
    if keys.iter().any(|key| key[1] != NONE) {
        mesh.uvs = keys.iter().map(|key| value(&statements.uvs, key[1], Vec2::ZERO)).collect();
    }
    if keys.iter().any(|key| key[2] != NONE) {
        mesh.normals = keys.iter().map(|key| value(&statements.normals, key[2], Vec3::ZERO)).collect();
    }
    if !statements.colors.is_empty() {
        mesh.colors = keys.iter().map(|key| value(&statements.colors, key[0], [1.0; 3])).collect();
    }
    (mesh, Pieces::new(pieces))
}

/// The lines of a group, and their colours.
fn lines(group: &Group, statements: &Statements, dropped: &mut Tally) -> (Vec<[Vec3; 2]>, Vec<[f32; 3]>) {
    let (mut ends, mut colors) = (Vec::new(), Vec::new());
    for line in &group.lines {
        let [a, b] = line.map(|position| statements.positions[position as usize]);
        if !a.is_finite() || !b.is_finite() {
            dropped.add(0);
        } else if a != b {
            ends.push([a, b]);
            if !statements.colors.is_empty() {
                let color = |position| Vec3::from(value(&statements.colors, position, [1.0; 3]));
                colors.push(color(line[0]).midpoint(color(line[1])).to_array());
            }
        }
    }
    (ends, colors)
}

fn value<T: Copy>(values: &[T], index: u32, otherwise: T) -> T {
    values.get(index as usize).copied().unwrap_or(otherwise)
}
