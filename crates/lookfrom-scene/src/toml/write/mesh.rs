//! Meshes: small ones in the document, others as PLY files beside it.

use super::Writer;
use super::text::{Fields, Item};
use crate::ply;
use crate::scene::MeshId;
use crate::shape::Mesh;

/// The most vertices and triangles of a mesh in the document.
const MOST_INLINE: usize = 12;

impl Writer<'_> {
    /// Puts a mesh. Shapes that share one share its file, but not a mesh in the document, which is no larger than that.
    pub(super) fn mesh(&mut self, fields: &mut Fields, id: MeshId) {
        let mesh = &self.scene.meshes[id.index()];
        if is_small(mesh) && !self.shared[id.index()] {
            let Mesh { positions, triangles, normals, uvs, colors, .. } = mesh;
            fields.put("positions", Item::list(positions.iter().copied()));
            fields.put("triangles", Item::list(triangles.iter().copied()));
            if !normals.is_empty() {
                fields.put("normals", Item::list(normals.iter().copied()));
            }
            if !uvs.is_empty() {
                fields.put("uvs", Item::list(uvs.iter().copied()));
            }
            if !colors.is_empty() {
                fields.put("colors", Item::list(colors.iter().copied()));
            }
        } else {
            let file = match self.meshes.get(&id) {
                Some(file) => file.clone(),
                None => {
                    let file = self.file(&mesh.name, "ply", ply::write(mesh));
                    self.meshes.insert(id, file.clone());
                    file
                }
            };
            fields.put("file", file);
        }
        self.put_displacement(fields, mesh.displacement);
    }
}

/// Whether a mesh is small and has nothing that only a file can tell.
fn is_small(mesh: &Mesh) -> bool {
    let Mesh {
        name: _,
        positions,
        triangles,
        normals: _,
        uvs: _,
        more_uvs,
        colors,
        opacities,
        tangents,
        displacement: _,
        is_of_solid,
        later,
    } = mesh;
    let is_plain = more_uvs.is_empty() && opacities.is_empty() && tangents.is_empty() && later.is_empty();
    is_plain
        && colors.as_flattened().iter().all(|light| *light >= 0.0)
        && !is_of_solid
        && !triangles.is_empty()
        && positions.len().max(triangles.len()) <= MOST_INLINE
}
