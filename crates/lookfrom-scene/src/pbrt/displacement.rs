//! Displacement of PLY meshes.
//!
//! pbrt bisects the edges of such a mesh until they are short, and moves its vertices by a texture. What is bisected here is
//! displaced when the world is compiled.

use glam::DMat4;

use super::Reader;
use super::params::Parameters;
use super::text::Place;
use crate::error::{ErrorKind, Result};
use crate::material::Scalar;
use crate::scene::MeshId;
use crate::tessellation::{BYTES_OF_TRIANGLE, ShortEdges};

/// Maximum number of triangles of a displaced mesh.
const MOST_TRIANGLES: u64 = 1 << 26;

/// A mesh to be displaced.
pub(super) struct Displaced {
    /// The mesh of the model, and that of what is displaced.
    meshes: [MeshId; 2],
    amount: Scalar,
    /// The length in world space that all edges are shorter than: positive.
    edge_length: f32,
    world_from_object: DMat4,
    place: Place,
}

impl Reader<'_, '_> {
    /// The mesh of a shape with a `displacement`; that of its model, if it has none.
    pub(super) fn displaced(&mut self, p: &Parameters, model: MeshId) -> Result<MeshId> {
        let edge_length = p.positive("displacement.edgelength", 1.0)?;
        let Some(amount) = self.scalar_or_none(p, "displacement")? else { return Ok(model) };
        let displaced = MeshId(self.scene.meshes.len() as u32);
        self.scene.meshes.push(crate::shape::Mesh::default());
        self.displaced.push(Displaced {
            meshes: [model, displaced],
            amount,
            edge_length,
            world_from_object: self.state.matrix,
            place: p.place.clone(),
        });
        Ok(displaced)
    }

    /// Makes the displaced meshes of their models.
    pub(super) fn tessellate_displaced(&mut self) -> Result<()> {
        for Displaced { meshes, amount, edge_length, world_from_object, place } in
            std::mem::take(&mut self.displaced)
        {
            let [model, displaced] = meshes.map(MeshId::index);
            let model = &self.scene.meshes[model];
            if model.uvs.is_empty() && !model.triangles.is_empty() {
                let message =
                    format!("{:?} has no texture coordinates, which its displacement needs", model.name);
                return Err(place.invalid(message).hint("take \"displacement\" out, or unwrap the mesh"));
            }
            let length = f64::from(edge_length * self.displacement_edge_scale);
            let edges = ShortEdges { matrix: &world_from_object, length };
            let most = self.context.limits.elements.min(MOST_TRIANGLES);
            let Some(count) = edges.count(model, most) else {
                let message = format!(
                    "with edges shorter than {length}, the displaced mesh has more than the limit of {most} triangles"
                );
                return Err(place
                    .error(ErrorKind::Limit, message)
                    .hint("raise \"float displacement.edgelength\""));
            };
            let at = place.location();
            let memory = self.context.budget.reserve(count * BYTES_OF_TRIANGLE, "the displaced mesh", &at)?;
            let mut fine = edges.tessellate(model);
            fine.displacement = Some(amount);
            drop(memory);
            self.context.keep(fine.bytes(), "the displaced mesh", &at)?;
            self.scene.meshes[displaced] = fine;
        }
        Ok(())
    }
}
