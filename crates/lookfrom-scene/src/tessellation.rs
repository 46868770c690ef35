//! Tessellation of meshes for displacement: triangles are bisected until all their edges are short.
//!
//! The longest edge of a triangle is split in the middle (longest-edge bisection: Rivara 1984). Only edges that are too long are
//! split, and the two triangles of an edge share its middle: there are no cracks between them.

use std::collections::HashMap;

use glam::{DMat4, Vec3};

use crate::shape::Mesh;

/// Bytes that a triangle takes while a mesh is tessellated: itself, its part of the vertices and of the middles of edges.
pub(crate) const BYTES_OF_TRIANGLE: u64 = 128;

/// The condition of a tessellation: in the space of `matrix` each edge becomes shorter than `length`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShortEdges<'a> {
    pub(crate) matrix: &'a DMat4,
    /// Positive.
    pub(crate) length: f64,
}

impl ShortEdges<'_> {
    /// The number of triangles that a mesh would have, or `None` if they are more than `most`.
    pub(crate) fn count(&self, mesh: &Mesh, most: u64) -> Option<u64> {
        let mut count = mesh.triangles.len() as u64;
        let mut left = Vec::new();
        for triangle in &mesh.triangles {
            left.push(triangle.map(|vertex| mesh.positions[vertex as usize]));
            while let Some(corners) = left.pop() {
                let Some(first) = self.longest(corners) else { continue };
                count += 1;
                if count > most {
                    return None;
                }
                let [a, b, c] = rotated(corners, first);
                let middle = middle(a, b);
                left.extend([[middle, b, c], [a, middle, c]]);
            }
        }
        (count <= most).then_some(count)
    }

    /// The mesh with bisected triangles; vertices in the middle of edges have the means of the ends' attributes. Tangents are
    /// left out.
    pub(crate) fn tessellate(&self, mesh: &Mesh) -> Mesh {
        let mut fine = Mesh { triangles: Vec::new(), tangents: Vec::new(), ..mesh.clone() };
        let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
        let mut left = Vec::new();
        for triangle in &mesh.triangles {
            left.push(*triangle);
            while let Some(triangle) = left.pop() {
                let Some(first) = self.longest(triangle.map(|vertex| fine.positions[vertex as usize])) else {
                    fine.triangles.push(triangle);
                    continue;
                };
                let [a, b, c] = rotated(triangle, first);
                let middle = *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| fine.add_middle(a, b));
                left.extend([[middle, b, c], [a, middle, c]]);
            }
        }
        fine
    }

    /// The corner at which the longest edge begins, if that is too long.
    fn longest(&self, corners: [Vec3; 3]) -> Option<usize> {
        let length = |from: usize| {
            let edge = (corners[(from + 1) % 3] - corners[from]).as_dvec3();
            self.matrix.transform_vector3(edge).length()
        };
        let lengths = [length(0), length(1), length(2)];
        let first = (0..3).max_by(|&a, &b| lengths[a].total_cmp(&lengths[b]))?;
        (lengths[first] >= self.length).then_some(first)
    }
}

fn rotated<T: Copy>(corners: [T; 3], first: usize) -> [T; 3] {
    [corners[first], corners[(first + 1) % 3], corners[(first + 2) % 3]]
}

fn middle(a: Vec3, b: Vec3) -> Vec3 {
    0.5 * a + 0.5 * b
}

impl Mesh {
    /// Adds a vertex in the middle between two; its index.
    fn add_middle(&mut self, a: u32, b: u32) -> u32 {
        let [a, b] = [a, b].map(|vertex| vertex as usize);
        self.positions.push(middle(self.positions[a], self.positions[b]));
        if !self.normals.is_empty() {
            let [a, b] = [a, b].map(|vertex| self.normals[vertex].normalize_or_zero());
            self.normals.push((a + b).normalize_or_zero());
        }
        for uvs in std::iter::once(&mut self.uvs).chain(&mut self.more_uvs).filter(|uvs| !uvs.is_empty()) {
            uvs.push(0.5 * uvs[a] + 0.5 * uvs[b]);
        }
        if !self.colors.is_empty() {
            self.colors.push(std::array::from_fn(|i| 0.5 * self.colors[a][i] + 0.5 * self.colors[b][i]));
        }
        if !self.opacities.is_empty() {
            self.opacities.push(0.5 * self.opacities[a] + 0.5 * self.opacities[b]);
        }
        self.positions.len() as u32 - 1
    }

    /// At each vertex the mean direction of the normals of the triangles around it, of unit length; zero where there is none.
    pub fn mean_normals(&self) -> Vec<Vec3> {
        let mut normals = vec![Vec3::ZERO; self.positions.len()];
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|vertex| self.positions[vertex as usize].as_dvec3());
            let normal = (b - a).cross(c - b).normalize_or_zero().as_vec3();
            for &vertex in triangle {
                normals[vertex as usize] += normal;
            }
        }
        normals.into_iter().map(Vec3::normalize_or_zero).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use glam::{DVec3, Vec2};

    use super::*;

    /// A tetrahedron of uneven edges.
    fn tetrahedron() -> Mesh {
        Mesh {
            positions: [[0.0, 0.0, 0.0], [3.0, 0.1, 0.0], [0.2, 1.0, 0.3], [0.4, 0.3, 2.0]]
                .map(Into::into)
                .to_vec(),
            triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
            uvs: vec![Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE],
            ..Mesh::default()
        }
    }

    #[test]
    fn edges_are_short_and_shared_by_two_triangles() {
        let matrix = DMat4::from_scale(DVec3::new(2.0, 1.0, 0.5));
        let edges = ShortEdges { matrix: &matrix, length: 0.3 };
        let coarse = tetrahedron();
        let fine = edges.tessellate(&coarse);
        assert_eq!(edges.count(&coarse, u64::MAX), Some(fine.triangles.len() as u64));
        let mut directed = BTreeMap::new();
        for corners in &fine.triangles {
            for (from, to) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (corners[i], corners[j])) {
                let [a, b] = [from, to].map(|vertex| fine.positions[vertex as usize].as_dvec3());
                assert!(matrix.transform_vector3(b - a).length() < 0.3);
                assert_eq!(directed.insert((from, to), ()), None, "one triangle on this side");
            }
        }
        // A closed surface stays closed: each edge has a triangle on both of its sides.
        assert!(directed.keys().all(|&(from, to)| directed.contains_key(&(to, from))));
        let area = |mesh: &Mesh| -> f64 {
            let corners = |t: &[u32; 3]| t.map(|vertex| mesh.positions[vertex as usize].as_dvec3());
            mesh.triangles.iter().map(corners).map(|[a, b, c]| (b - a).cross(c - a).length()).sum()
        };
        assert!((area(&fine) / area(&coarse) - 1.0).abs() < 1e-5);
        // The first vertex that is added is in the middle of the longest edge.
        assert_eq!((fine.uvs.len(), fine.uvs[4]), (fine.positions.len(), Vec2::new(0.5, 0.0)));
    }

    #[test]
    fn what_would_never_end_is_refused() {
        // No f32 lies between neighbours: their edge stays as long as it is.
        let next = f32::from_bits(1.0_f32.to_bits() + 1);
        let mesh = Mesh {
            positions: [[1.0, 0.0, 0.0], [next, 0.0, 0.0], [1.0, 1.0, 0.0]].map(Into::into).to_vec(),
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let edges = ShortEdges { matrix: &DMat4::IDENTITY, length: 1e-30 };
        assert_eq!(edges.count(&mesh, 1 << 16), None);
        let long = ShortEdges { matrix: &DMat4::IDENTITY, length: 2.0 };
        assert_eq!((long.count(&mesh, 1), long.count(&mesh, 0)), (Some(1), None));
    }

    #[test]
    fn mean_normals_count_each_triangle_once() {
        // Three faces of a cube's corner, one of them of two triangles.
        let mesh = Mesh {
            positions: [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [9., 9., 9.]]
                .map(Into::into)
                .to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [0, 3, 1]],
            ..Mesh::default()
        };
        let normals = mesh.mean_normals();
        assert!((normals[0] - Vec3::new(1.0, 2.0, 1.0).normalize()).length() < 1e-6, "{}", normals[0]);
        assert_eq!(normals[4], Vec3::ZERO);
    }
}
