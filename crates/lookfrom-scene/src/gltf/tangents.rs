//! Tangents of meshes whose file has none, by MikkTSpace (specification, §3.7.2.1; Mikkelsen 2008).
//!
//! The crate `bevy_mikktspace` computes the tangents that normal maps are baked with. They belong to corners of
//! triangles, so vertices whose corners differ, as at the seams of mirrored texture coordinates, are split.

use std::collections::BTreeMap;

use bevy_mikktspace::{Geometry, Ops, TangentSpace, generate_tangents};
use glam::{Vec2, Vec3, Vec4};

use super::mesh::Vertices;

/// Adds tangents for one set of texture coordinates, if the vertices have normals and that set, but no tangents yet. w is
/// 1 where v, which runs up, grows along normal × tangent, and −1 where it grows in the opposite direction, as in glTF's
/// own tangents. A vertex that no triangle uses has the tangent 0.
pub(super) fn complete(vertices: &mut Vertices, triangles: &mut [[u32; 3]], set: u32) {
    let Some(uvs) = vertices.uvs.get(set as usize).filter(|uvs| !uvs.is_empty()) else { return };
    if vertices.normals.is_empty() || !vertices.tangents.is_empty() {
        return;
    }
    let corners = tangents(&vertices.positions, &vertices.normals, uvs, triangles);
    split(vertices, triangles, &corners);
}

/// The tangent of each corner of each triangle.
pub(super) fn tangents(
    positions: &[Vec3],
    normals: &[Vec3],
    uvs: &[Vec2],
    triangles: &[[u32; 3]],
) -> Vec<[Vec4; 3]> {
    let mut surface =
        TriangleMesh { positions, normals, uvs, triangles, tangents: vec![[Vec4::W; 3]; triangles.len()] };
    // The error type has no values.
    let Ok(()) = generate_tangents(&mut surface) else { return surface.tangents };
    surface.tangents
}

struct TriangleMesh<'a> {
    positions: &'a [Vec3],
    normals: &'a [Vec3],
    uvs: &'a [Vec2],
    triangles: &'a [[u32; 3]],
    tangents: Vec<[Vec4; 3]>,
}

/// Arithmetic with identical bits on every platform.
struct Portable;

impl Ops for Portable {
    fn sqrt(x: f32) -> f32 {
        x.sqrt()
    }

    fn acos(x: f32) -> f32 {
        libm::acos(f64::from(x)) as f32
    }
}

impl TriangleMesh<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.triangles[face][corner] as usize
    }
}

impl Geometry<Portable> for TriangleMesh<'_> {
    fn num_faces(&self) -> usize {
        self.triangles.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.positions[self.vertex(face, corner)].to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.normals[self.vertex(face, corner)].to_array()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        self.uvs[self.vertex(face, corner)].to_array()
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        let tangent = space.map_or(Vec4::W, |space| Vec4::from_array(space.tangent_encoded()));
        self.tangents[face][corner] = if tangent.is_finite() { tangent } else { Vec4::W };
    }
}

/// Assigns the tangents of corners to their vertices; a vertex that already has a different one is copied.
fn split(vertices: &mut Vertices, triangles: &mut [[u32; 3]], corners: &[[Vec4; 3]]) {
    let mut given: Vec<Option<Vec4>> = vec![None; vertices.positions.len()];
    let mut copies: BTreeMap<(u32, [u32; 4]), u32> = BTreeMap::new();
    for (triangle, tangents) in triangles.iter_mut().zip(corners) {
        for (corner, &tangent) in triangle.iter_mut().zip(tangents) {
            let first = *given[*corner as usize].get_or_insert(tangent);
            if first != tangent {
                let bits = tangent.to_array().map(f32::to_bits);
                *corner = *copies.entry((*corner, bits)).or_insert_with(|| {
                    given.push(Some(tangent));
                    vertices.repeat(*corner as usize)
                });
            }
        }
    }
    vertices.tangents = given.into_iter().map(|tangent| tangent.unwrap_or(Vec4::W)).collect();
}

#[cfg(test)]
mod tests;
