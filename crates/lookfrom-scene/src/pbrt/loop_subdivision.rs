//! Loop subdivision surfaces (Loop 1987).
//!
//! Each level splits every triangle into four and moves the vertices; at the end the vertices are moved to the limit
//! surface, with its normals (Hoppe et al. 1994). Edges with one face are boundaries, which converge to curves of their
//! own.

use std::collections::BTreeMap;

use glam::Vec3;

use crate::shape::Mesh;

/// A mesh with adjacency. Edge `k` of a face goes from corner `k` to corner `k + 1`.
struct ControlMesh {
    positions: Vec<Vec3>,
    faces: Vec<[u32; 3]>,
    /// Across each edge: a face, or none at the boundary.
    neighbours: Vec<[Option<u32>; 3]>,
    /// For each vertex a face that contains it; at the boundary the first one of its fan.
    first_face: Vec<Option<u32>>,
    is_border: Vec<bool>,
}

/// The mesh after `levels` subdivisions, on the limit surface, with its normals. Vertices without faces stay in place.
///
/// # Errors
/// A message if more than two faces meet at an edge, or surfaces only at a vertex, or if orientations differ.
pub(super) fn subdivide(positions: &[Vec3], triangles: &[[u32; 3]], levels: u32) -> Result<Mesh, String> {
    let mut surface = ControlMesh::new(positions.to_vec(), triangles.to_vec())?;
    for _ in 0..levels {
        surface = surface.refined();
    }
    let vertices = 0..surface.positions.len();
    let limit = vertices.clone().map(|vertex| surface.limit(vertex, &surface.ring(vertex))).collect();
    let moved = ControlMesh { positions: limit, ..surface };
    let normals = vertices.map(|vertex| moved.normal(vertex, &moved.ring(vertex))).collect();
    Ok(Mesh {
        name: "loopsubdiv".into(),
        positions: moved.positions,
        triangles: moved.faces,
        normals,
        ..Mesh::default()
    })
}

impl ControlMesh {
    fn new(positions: Vec<Vec3>, faces: Vec<[u32; 3]>) -> Result<Self, String> {
        if faces.iter().any(|[a, b, c]| a == b || b == c || c == a) {
            return Err("triangles with three different corners".to_owned());
        }
        // Each edge belongs to one face in each direction.
        let mut owners: BTreeMap<(u32, u32), u32> = BTreeMap::new();
        for (index, face) in faces.iter().enumerate() {
            for k in 0..3 {
                if owners.insert((face[k], face[(k + 1) % 3]), index as u32).is_some() {
                    let (a, b) = (face[k], face[(k + 1) % 3]);
                    return Err(format!(
                        "two faces of opposite directions at each edge, found more from {a} to {b}"
                    ));
                }
            }
        }
        let across =
            |face: &[u32; 3]| std::array::from_fn(|k| owners.get(&(face[(k + 1) % 3], face[k])).copied());
        let neighbours: Vec<[Option<u32>; 3]> = faces.iter().map(across).collect();
        let surface = Self::with_neighbours(positions, faces, neighbours);
        let mut counts = vec![0; surface.positions.len()];
        surface.faces.iter().flatten().for_each(|&vertex| counts[vertex as usize] += 1);
        match counts.iter().enumerate().find(|&(vertex, &count)| surface.fan(vertex).len() != count) {
            Some((vertex, _)) => {
                Err(format!("faces that meet in edges, found a vertex, {vertex}, that joins two surfaces"))
            }
            None => Ok(surface),
        }
    }

    /// Finds the first face of the fan of each vertex.
    fn with_neighbours(
        positions: Vec<Vec3>,
        faces: Vec<[u32; 3]>,
        neighbours: Vec<[Option<u32>; 3]>,
    ) -> Self {
        let mut first_face = vec![None; positions.len()];
        let mut is_border = vec![false; positions.len()];
        for (index, face) in faces.iter().enumerate() {
            for (k, &vertex) in face.iter().enumerate() {
                let begins = neighbours[index][k].is_none();
                let first = &mut first_face[vertex as usize];
                if begins || first.is_none() {
                    *first = Some(index as u32);
                }
                is_border[vertex as usize] |= begins;
            }
        }
        Self { positions, faces, neighbours, first_face, is_border }
    }

    /// The index of the face's corner at a vertex.
    fn corner(&self, face: u32, vertex: usize) -> usize {
        self.faces[face as usize].iter().position(|&v| v as usize == vertex).unwrap_or(0)
    }

    /// The faces around a vertex, each across the edge before the vertex in the previous face.
    fn fan(&self, vertex: usize) -> Vec<u32> {
        let Some(first) = self.first_face[vertex] else { return Vec::new() };
        let mut fan = vec![first];
        let mut face = first;
        loop {
            let before = (self.corner(face, vertex) + 2) % 3;
            match self.neighbours[face as usize][before] {
                Some(next) if next != first => {
                    fan.push(next);
                    face = next;
                }
                _ => return fan,
            }
        }
    }

    /// The vertices around a vertex in order; at the boundary from one end to the other.
    fn ring(&self, vertex: usize) -> Vec<u32> {
        let fan = self.fan(vertex);
        let other =
            |face: u32, step: usize| self.faces[face as usize][(self.corner(face, vertex) + step) % 3];
        let mut ring: Vec<u32> = fan.iter().map(|&face| other(face, 1)).collect();
        if let (true, Some(&last)) = (self.is_border[vertex], fan.last()) {
            ring.push(other(last, 2));
        }
        ring
    }

    fn sum(&self, ring: &[u32]) -> Vec3 {
        ring.iter().fold(Vec3::ZERO, |sum, &vertex| sum + self.positions[vertex as usize])
    }

    /// `p` blended with the two boundary neighbours, or with all neighbours, by the weight of each.
    fn blend(&self, vertex: usize, ring: &[u32], border_share: f32, share: f32) -> Vec3 {
        let p = self.positions[vertex];
        let (ends, share) = match ring {
            [] => return p,
            &[first, .., last] if self.is_border[vertex] => (&[first, last][..], border_share),
            _ => (ring, share),
        };
        p * (1.0 - ends.len() as f32 * share) + self.sum(ends) * share
    }

    /// One level of subdivision: vertices move, edges get a vertex each, faces become four.
    fn refined(&self) -> Self {
        let mut positions: Vec<Vec3> = Vec::with_capacity(4 * self.positions.len());
        for vertex in 0..self.positions.len() {
            let ring = self.ring(vertex);
            positions.push(self.blend(vertex, &ring, 1.0 / 8.0, beta(ring.len())));
        }
        let mut middles: Vec<[u32; 3]> = vec![[u32::MAX; 3]; self.faces.len()];
        for index in 0..self.faces.len() {
            for k in 0..3 {
                if middles[index][k] != u32::MAX {
                    continue;
                }
                let [a, b, opposite] = [k, (k + 1) % 3, (k + 2) % 3].map(|c| self.faces[index][c] as usize);
                let ends = self.positions[a] + self.positions[b];
                let new = positions.len() as u32;
                middles[index][k] = new;
                positions.push(match self.neighbours[index][k] {
                    None => ends * 0.5,
                    Some(other) => {
                        let edge = self.corner(other, b);
                        middles[other as usize][edge] = new;
                        let beyond = self.faces[other as usize][(edge + 2) % 3] as usize;
                        ends * (3.0 / 8.0) + (self.positions[opposite] + self.positions[beyond]) * (1.0 / 8.0)
                    }
                });
            }
        }
        // Face f becomes 4f, 4f + 1, 4f + 2 at its corners and 4f + 3 in the middle.
        let mut faces = Vec::with_capacity(4 * self.faces.len());
        let mut neighbours = Vec::with_capacity(4 * self.faces.len());
        for (index, (&[a, b, c], &[ab, bc, ca])) in self.faces.iter().zip(&middles).enumerate() {
            faces.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
            let across = |edge: usize, vertex: u32| {
                self.neighbours[index][edge]
                    .map(|other| 4 * other + self.corner(other, vertex as usize) as u32)
            };
            let inner = |part: u32| Some(4 * index as u32 + part);
            neighbours.extend([
                [across(0, a), inner(3), across(2, a)],
                [across(0, b), across(1, b), inner(3)],
                [inner(3), across(1, c), across(2, c)],
                [inner(1), inner(2), inner(0)],
            ]);
        }
        Self::with_neighbours(positions, faces, neighbours)
    }

    /// The limit position of a vertex.
    fn limit(&self, vertex: usize, ring: &[u32]) -> Vec3 {
        let valence = ring.len();
        let gamma = if valence == 0 { 0.0 } else { 1.0 / (valence as f32 + 3.0 / (8.0 * beta(valence))) };
        self.blend(vertex, ring, 1.0 / 5.0, gamma)
    }

    /// The normal of the limit surface, not normalised, from two tangents; positions are those of the limit. As in pbrt it
    /// points to the side from which faces are clockwise.
    fn normal(&self, vertex: usize, ring: &[u32]) -> Vec3 {
        let p = self.positions[vertex];
        let at = |k: usize| self.positions[ring[k] as usize];
        let n = ring.len();
        if n < 2 {
            return Vec3::ZERO;
        }
        let (mut s, mut t) = (Vec3::ZERO, Vec3::ZERO);
        if !self.is_border[vertex] {
            for k in 0..n {
                let angle = std::f64::consts::TAU * k as f64 / n as f64;
                s += libm::cos(angle) as f32 * at(k);
                t += libm::sin(angle) as f32 * at(k);
            }
            return t.cross(s);
        }
        s = at(n - 1) - at(0);
        match n {
            2 => t = at(0) + at(1) - 2.0 * p,
            3 => t = at(1) - p,
            4 => t = 2.0 * (at(1) + at(2)) - at(0) - at(3) - 2.0 * p,
            _ => {
                let theta = std::f64::consts::PI / (n - 1) as f64;
                t = libm::sin(theta) as f32 * (at(0) + at(n - 1));
                for k in 1..n - 1 {
                    let weight = (2.0 * libm::cos(theta) - 2.0) * libm::sin(k as f64 * theta);
                    t += weight as f32 * at(k);
                }
                t = -t;
            }
        }
        s.cross(t)
    }
}

/// The weight of each neighbour for this valence (Warren's choice of Loop's weights).
fn beta(valence: usize) -> f32 {
    match valence {
        3 => 3.0 / 16.0,
        6 => 1.0 / 16.0,
        _ => 3.0 / (8.0 * valence as f32),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let points = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
        (points.map(Vec3::from).to_vec(), vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
    }

    /// A square of `n` × `n` cells in the plane z = 0, wound towards +z.
    fn grid(n: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let row = n + 1;
        let points = (0..row * row).map(|i| Vec3::new((i % row) as f32, (i / row) as f32, 0.0)).collect();
        let cells = (0..n * n).map(|i| i / n * row + i % n);
        let faces = cells.flat_map(|a| [[a, a + 1, a + row + 1], [a, a + row + 1, a + row]]).collect();
        (points, faces)
    }

    #[test]
    fn a_level_makes_four_of_one_and_stays_closed() {
        let (points, faces) = tetrahedron();
        let mesh = subdivide(&points, &faces, 3).expect("a good mesh");
        assert_eq!(mesh.triangles.len(), 4 << 6);
        // Euler's formula, with the characteristic of a sphere.
        assert_eq!(mesh.positions.len() + mesh.triangles.len() - mesh.triangles.len() * 3 / 2, 2);
        // Faces are counter-clockwise seen from outside, so normals point inwards.
        for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
            assert!(normal.normalize().dot(position.normalize()) < -0.5, "{position} {normal}");
        }
    }

    #[test]
    fn neighbours_are_those_of_a_search() {
        for (points, faces) in [tetrahedron(), grid(3)] {
            let fine = ControlMesh::new(points, faces).expect("a good mesh").refined().refined();
            let searched =
                ControlMesh::new(fine.positions.clone(), fine.faces.clone()).expect("still a good mesh");
            assert_eq!(fine.neighbours, searched.neighbours);
            assert_eq!(fine.is_border, searched.is_border);
        }
    }

    #[test]
    fn the_limit_does_not_depend_on_the_levels() {
        let (points, faces) = tetrahedron();
        let [coarse, fine] = [0, 4].map(|levels| subdivide(&points, &faces, levels).expect("a good mesh"));
        // Old vertices keep their indices.
        for vertex in 0..4 {
            assert!(coarse.positions[vertex].abs_diff_eq(fine.positions[vertex], 1e-5));
            let (a, b) = (coarse.normals[vertex].normalize(), fine.normals[vertex].normalize());
            assert!(a.dot(b) > 0.9999, "{a} {b}");
        }
    }

    #[test]
    fn what_is_flat_stays_flat_and_straight_borders_straight() {
        let (points, faces) = grid(4);
        let mesh = subdivide(&points, &faces, 2).expect("a good mesh");
        for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
            assert!(position.z.abs() < 1e-6);
            assert!(normal.normalize().dot(Vec3::Z) < -0.999, "{position} {normal}");
        }
        let low = mesh.positions.iter().fold(f32::INFINITY, |low, p| low.min(p.x));
        assert!((0.0..0.3).contains(&low), "{low}");
    }

    #[test]
    fn edges_of_three_faces_and_single_points_of_contact_are_refused() {
        let points = [Vec3::ZERO; 7];
        let fin = [[0, 1, 2], [1, 0, 3], [0, 1, 4]];
        assert!(subdivide(&points, &fin, 1).is_err_and(|message| message.contains("edge")));
        let hourglass = [[0, 1, 2], [0, 3, 4]];
        assert!(subdivide(&points, &hourglass, 1).is_err_and(|message| message.contains("joins two")));
        assert!(subdivide(&points, &[[0, 0, 1]], 1).is_err());
        assert!(subdivide(&points, &[[0, 1, 2]], 2).is_ok());
    }
}
