//! Catmull–Clark subdivision surfaces (Catmull & Clark 1978).
//!
//! A cage of polygons is refined some times: each polygon of `n` corners becomes `n` quadrilaterals. Then its vertices are moved
//! to the limit surface, with the normals there (Halstead, Kass & DeRose 1993). Edges of one face, or of more than two, are
//! creases: they converge to uniform cubic B-splines of their own (Hoppe et al. 1994), and a vertex where three creases or more
//! meet, or of one face alone, stays where it is ("edge and corner" in OpenSubdiv). Texture coordinates and colours belong to the
//! corners of faces and are interpolated linearly.
//!
//! `limit` has the masks of the limit, `mesh` makes cages of triangles.

mod limit;
mod mesh;
#[cfg(test)]
mod tests;

use std::ops::Range;

use glam::{DVec3, Vec3};

use crate::budget::Reservation;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;
use crate::shape::Mesh;

/// The most levels: a quadrilateral becomes 4ⁿ.
pub const MOST_LEVELS: u32 = 8;

/// The most faces that a mesh is subdivided into.
const MOST_FACES: u64 = 1 << 24;

/// Bytes that a face takes while meshes are subdivided.
const BYTES_OF_FACE: u64 = 500;

/// Polygons over shared vertices.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cage {
    pub(crate) positions: Vec<DVec3>,
    /// The vertex of each corner, face by face.
    pub(crate) corners: Vec<u32>,
    /// The index of each face's first corner, and the number of corners.
    pub(crate) starts: Vec<usize>,
    /// A number that the parts of a face inherit.
    pub(crate) tags: Vec<u32>,
    /// Number of values of a corner, which are interpolated linearly.
    pub(crate) width: usize,
    /// They, corner by corner.
    pub(crate) values: Vec<f32>,
}

/// A part of the limit surface: quadrilaterals, four corners each.
pub(crate) struct Refined {
    pub(crate) positions: Vec<Vec3>,
    /// Vertex normals, of unit length except at vertices without faces.
    pub(crate) normals: Vec<Vec3>,
    /// As those of the cage.
    pub(crate) corners: Vec<u32>,
    pub(crate) tags: Vec<u32>,
    pub(crate) values: Vec<f32>,
}

/// Replaces meshes of a file by their limit surfaces, each by itself; warns of what is sharp for lack of a surface.
///
/// # Errors
/// `Limit` if there would be too many faces.
pub(crate) fn subdivide_meshes(
    meshes: &mut [Mesh],
    levels: u32,
    file: &Location,
    context: &mut LoadContext<'_>,
) -> Result<()> {
    for mesh in meshes {
        let cage = mesh::cage(mesh);
        if !cage.corners.is_empty() {
            let _subdividing = check(&cage, levels, file, context)?;
            mesh::replace(mesh, &cage, levels);
        }
    }
    Ok(())
}

/// Checks that a cage can be subdivided, warns of edges of more than two faces, and reserves the memory meanwhile.
///
/// # Errors
/// `Limit` if there would be too many faces.
pub(crate) fn check(
    cage: &Cage,
    levels: u32,
    file: &Location,
    context: &mut LoadContext<'_>,
) -> Result<Reservation> {
    let (count, most) = (cage.count_after(levels), context.limits.elements.min(MOST_FACES));
    if count > most {
        let message = format!(
            "{} of subdivision make {count} faces, more than the limit of {most}",
            crate::plural::counted(levels, "level")
        );
        return Err(Error::new(ErrorKind::Limit, file, message).hint("subdivide fewer times"));
    }
    let reservation = context.budget.reserve(count * BYTES_OF_FACE, "the subdivision surface", file)?;
    let branching = cage.branching_edges();
    if branching > 0 {
        let edges = if branching == 1 { "an edge has".to_owned() } else { format!("{branching} edges have") };
        context.warn(file, format!("{edges} more than two faces: the subdivision surface is sharp there"));
    }
    Ok(reservation)
}

/// The faces around the edges of a cage.
struct Adjacency {
    /// The edge from each corner to the next one of its face.
    edge_of: Vec<u32>,
    edges: Vec<Edge>,
}

struct Edge {
    vertices: [u32; 2],
    /// The corners that it begins at, of the first two faces.
    corners: [u32; 2],
    /// Number of faces.
    faces: u32,
}

impl Edge {
    fn is_crease(&self) -> bool {
        self.faces != 2
    }
}

impl Cage {
    /// The faces: the range of corners of each.
    fn faces(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        self.starts.windows(2).map(|ends| ends[0]..ends[1])
    }

    /// Ends a face after its corners were added: at least three, no two neighbours the same.
    pub(crate) fn end_face(&mut self, tag: u32) {
        if self.starts.is_empty() {
            self.starts.push(0);
        }
        self.starts.push(self.corners.len());
        self.tags.push(tag);
    }

    /// Number of quadrilaterals after some levels, of which the first is made of polygons.
    pub(crate) fn count_after(&self, levels: u32) -> u64 {
        (self.corners.len() as u64).saturating_mul(4_u64.saturating_pow(levels.saturating_sub(1)))
    }

    /// Number of edges of more than two faces.
    pub(crate) fn branching_edges(&self) -> usize {
        Adjacency::of(self).edges.iter().filter(|edge| edge.faces > 2).count()
    }

    /// The limit surface after some levels, 1 to [`MOST_LEVELS`].
    pub(crate) fn subdivided(&self, levels: u32) -> Refined {
        let mut cage = self.refined_once();
        for _ in 1..levels {
            cage = cage.refined_once();
        }
        let limit = limit::Limit::of(&cage);
        let single = |points: Vec<DVec3>| points.into_iter().map(DVec3::as_vec3).collect();
        let Self { corners, tags, values, .. } = cage;
        Refined { positions: single(limit.positions), normals: single(limit.normals), corners, tags, values }
    }

    fn refined_once(&self) -> Self {
        let adjacency = Adjacency::of(self);
        let center = |face: Range<usize>| {
            let count = face.len() as f64;
            face.fold(DVec3::ZERO, |sum, corner| sum + self.at(corner)) / count
        };
        let centers: Vec<DVec3> = self.faces().map(center).collect();
        let mut face_of = vec![0; self.corners.len()];
        for (index, face) in self.faces().enumerate() {
            face_of[face].fill(index);
        }

        // Vertices, then edges, then faces have a vertex each.
        let (first_edge, first_face) =
            (self.positions.len() as u32, (self.positions.len() + adjacency.edges.len()) as u32);
        let mut positions = self.moved(&adjacency, &centers);
        positions.extend(adjacency.edges.iter().map(|edge| {
            let [a, b] = edge.vertices.map(|vertex| self.positions[vertex as usize]);
            match edge.is_crease() {
                true => (a + b) / 2.0,
                false => {
                    let [f, g] = edge.corners.map(|corner| centers[face_of[corner as usize]]);
                    (a + b + f + g) / 4.0
                }
            }
        }));
        positions.extend(&centers);

        let mut refined = Self { positions, starts: vec![0], width: self.width, ..Self::default() };
        for (index, face) in self.faces().enumerate() {
            for corner in face.clone() {
                let (next, before) = (next_in(&face, corner), before_in(&face, corner));
                refined.corners.extend([
                    self.corners[corner],
                    first_edge + adjacency.edge_of[corner],
                    first_face + index as u32,
                    first_edge + adjacency.edge_of[before],
                ]);
                for corners in [&[corner][..], &[corner, next], &[], &[before, corner]] {
                    self.push_mean(corners, &face, &mut refined.values);
                }
                refined.end_face(self.tags[index]);
            }
        }
        refined
    }

    /// Adds the means of the values of some corners; of all corners of the face where there are none.
    fn push_mean(&self, corners: &[usize], face: &Range<usize>, values: &mut Vec<f32>) {
        for k in 0..self.width {
            let value = |corner: usize| self.values[corner * self.width + k];
            values.push(match corners {
                [] => face.clone().map(value).sum::<f32>() / face.len() as f32,
                _ => corners.iter().map(|&corner| value(corner)).sum::<f32>() / corners.len() as f32,
            });
        }
    }

    /// The position of a corner.
    fn at(&self, corner: usize) -> DVec3 {
        self.positions[self.corners[corner] as usize]
    }

    /// The vertices where the next level has them.
    fn moved(&self, adjacency: &Adjacency, centers: &[DVec3]) -> Vec<DVec3> {
        let mut around = vec![Around::default(); self.positions.len()];
        for (face, center) in self.faces().zip(centers) {
            for corner in face {
                let around = &mut around[self.corners[corner] as usize];
                around.faces += 1;
                around.centers += *center;
            }
        }
        around_edges(&mut around, &self.positions, adjacency);
        let moved = |(at, around): (&DVec3, &Around)| {
            let n = f64::from(around.faces);
            match around.kind() {
                VertexRule::Fixed => *at,
                VertexRule::Crease => *at * 0.75 + around.on_creases / 8.0,
                // The mean of the edges' midpoints is half of the vertex and half of the mean of its neighbours.
                VertexRule::Smooth => {
                    (around.centers / n + around.ends / f64::from(around.edges) + *at * (n - 2.0)) / n
                }
            }
        };
        self.positions.iter().zip(&around).map(moved).collect()
    }
}

/// Sums over what is around a vertex.
#[derive(Clone, Default)]
struct Around {
    faces: u32,
    /// Sum of the centres of the faces.
    centers: DVec3,
    edges: u32,
    /// The other ends of its edges.
    ends: DVec3,
    creases: u32,
    /// The other ends of its creases.
    on_creases: DVec3,
}

/// The rule by which a vertex moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum VertexRule {
    Fixed,
    Crease,
    Smooth,
}

impl Around {
    fn kind(&self) -> VertexRule {
        match (self.creases, self.faces) {
            (0 | 1, 1..) => VertexRule::Smooth,
            (2, 2..) => VertexRule::Crease,
            _ => VertexRule::Fixed,
        }
    }
}

fn around_edges(around: &mut [Around], positions: &[DVec3], adjacency: &Adjacency) {
    for edge in &adjacency.edges {
        for [here, there] in [edge.vertices, [edge.vertices[1], edge.vertices[0]]] {
            let (around, end) = (&mut around[here as usize], positions[there as usize]);
            around.edges += 1;
            around.ends += end;
            if edge.is_crease() {
                around.creases += 1;
                around.on_creases += end;
            }
        }
    }
}

impl Adjacency {
    fn of(cage: &Cage) -> Self {
        // Each corner begins an edge: those with the same ends are one.
        let mut sides: Vec<([u32; 2], u32)> = Vec::with_capacity(cage.corners.len());
        for face in cage.faces() {
            for corner in face.clone() {
                let (a, b) = (cage.corners[corner], cage.corners[next_in(&face, corner)]);
                sides.push(([a.min(b), a.max(b)], corner as u32));
            }
        }
        sides.sort_unstable();
        let mut edge_of = vec![0; cage.corners.len()];
        let mut edges: Vec<Edge> = Vec::new();
        for (vertices, corner) in sides {
            match edges.last_mut().filter(|edge| edge.vertices == vertices) {
                Some(edge) => {
                    edge.faces += 1;
                    edge.corners[1] = corner;
                }
                None => edges.push(Edge { vertices, corners: [corner; 2], faces: 1 }),
            }
            edge_of[corner as usize] = edges.len() as u32 - 1;
        }
        Self { edge_of, edges }
    }
}

/// The next corner of a face.
fn next_in(face: &Range<usize>, corner: usize) -> usize {
    if corner + 1 == face.end { face.start } else { corner + 1 }
}

/// The corner before one of a face.
fn before_in(face: &Range<usize>, corner: usize) -> usize {
    if corner == face.start { face.end - 1 } else { corner - 1 }
}
