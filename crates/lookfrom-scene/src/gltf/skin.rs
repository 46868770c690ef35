//! Linear blend skinning (specification, §3.7.3).
//!
//! Joints are nodes anywhere in the hierarchy and replace the transform of the mesh's own node, so the vertices of a
//! skinned mesh are in world space.

use glam::{DMat3, DMat4, DVec3, Vec3};

use super::file::Document;
use super::json::{Primitive, Whole};
use super::mesh::Vertices;
use super::node::Tree;
use crate::error::Result;

/// The joint matrices of a skin.
#[derive(Clone, Debug)]
pub(super) struct Skin {
    /// Joint matrices: from the bind pose to skinned space.
    skinned_from_bound: Vec<DMat4>,
    /// From skinned space to world space: the identity or a reflection.
    pub(super) world_from_skinned: DMat4,
}

/// The joints of a vertex and their weights.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Influence {
    pub(super) joints: [u32; 4],
    pub(super) weights: [f32; 4],
}

impl Skin {
    /// The skin with this index in a node hierarchy.
    ///
    /// # Errors
    /// If the skin, its joints or its matrices do not exist.
    pub(super) fn new(document: &Document, index: Whole, asked: &str, tree: &Tree) -> Result<Self> {
        let skin = document.one_of(&document.root.skins, index, "skin", asked)?;
        let pointer = format!("/skins/{}", index.0);
        let bound = match skin.inverse_bind_matrices {
            Some(accessor) => document.vectors::<16>(accessor, &format!("{pointer}/inverseBindMatrices"))?,
            None => Vec::new(),
        };
        let mut joints = Vec::with_capacity(skin.joints.len());
        for (place, &joint) in skin.joints.iter().enumerate() {
            document.one_of(&document.root.nodes, joint, "node", &format!("{pointer}/joints/{place}"))?;
            let mut matrix = DMat4::IDENTITY;
            if let Some(columns) = bound.get(place) {
                matrix = DMat4::from_cols_array(&columns.map(f64::from));
                // The last row of an affine transform.
                for (axis, w) in [(0, 0.0), (1, 0.0), (2, 0.0), (3, 1.0)] {
                    matrix.col_mut(axis).w = w;
                }
            }
            joints.push(tree.world_from_node(joint.index()) * matrix);
        }
        Ok(Self::of(joints))
    }

    /// A skin with these joint matrices. If all of them contain a reflection, it is factored out of them, so that the
    /// triangles keep their outsides.
    pub(super) fn of(mut world_from_bound: Vec<DMat4>) -> Self {
        let mirrors = |matrix: &DMat4| matrix.determinant() < 0.0;
        let is_mirrored = !world_from_bound.is_empty() && world_from_bound.iter().all(mirrors);
        let world_from_skinned = match is_mirrored {
            true => DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0)),
            false => DMat4::IDENTITY,
        };
        // A reflection is its own inverse.
        world_from_bound.iter_mut().for_each(|matrix| *matrix = world_from_skinned * *matrix);
        Self { skinned_from_bound: world_from_bound, world_from_skinned }
    }

    /// Skins a primitive's vertices. `false` if the primitive has no joints: then it is transformed like any other mesh.
    ///
    /// # Errors
    /// If joints or weights cannot be read, if there is not one per vertex, or if a joint does not exist.
    pub(super) fn bend(
        &self,
        document: &Document,
        primitive: &Primitive,
        pointer: &str,
        vertices: &mut Vertices,
    ) -> Result<bool> {
        let mut sets: Vec<Vec<Influence>> = Vec::new();
        loop {
            let names = ["JOINTS", "WEIGHTS"].map(|what| format!("{what}_{}", sets.len()));
            let [Some(&joints), Some(&weights)] = names.each_ref().map(|name| primitive.attributes.get(name))
            else {
                break;
            };
            let [at_joints, at_weights] = names.map(|name| format!("{pointer}/attributes/{name}"));
            let joints = document.whole_vectors::<4>(joints, &at_joints)?;
            let weights = document.vectors::<4>(weights, &at_weights)?;
            let count = vertices.positions.len();
            if joints.len() != count || weights.len() != count {
                let message = format!(
                    "{} and {} for {}",
                    crate::plural::counted(joints.len(), "joint"),
                    crate::plural::counted(weights.len(), "weight"),
                    crate::plural::counted(count, "vertex")
                );
                return Err(document
                    .invalid(&at_joints, message)
                    .hint("the file was written wrongly: export it again"));
            }
            let set: Vec<Influence> = joints
                .into_iter()
                .zip(weights)
                .map(|(joints, weights)| Influence { joints, weights: weights.map(usable) })
                .collect();
            if let Some(joint) = self.beyond(&set) {
                let count = self.skinned_from_bound.len();
                let message = format!("joint {joint} is used, but the skin has only {count}");
                return Err(document
                    .invalid(&at_joints, message)
                    .hint("the file was written wrongly: export it again"));
            }
            sets.push(set);
        }
        self.apply(&sets, vertices);
        Ok(!sets.is_empty())
    }

    /// A joint that has a weight but does not exist.
    fn beyond(&self, set: &[Influence]) -> Option<u32> {
        let mut used = set.iter().flat_map(|influence| influence.joints.into_iter().zip(influence.weights));
        let is_beyond = |joint: u32| joint as usize >= self.skinned_from_bound.len();
        used.find(|&(joint, weight)| weight > 0.0 && is_beyond(joint)).map(|(joint, _)| joint)
    }

    /// Skins vertices. Each set has one influence per vertex; weights need not sum to 1. A vertex without weights follows
    /// its first joint.
    pub(super) fn apply(&self, sets: &[Vec<Influence>], vertices: &mut Vertices) {
        if sets.is_empty() {
            return;
        }
        for vertex in 0..vertices.positions.len() {
            let matrix = self.blended(sets, vertex);
            let place = &mut vertices.positions[vertex];
            *place = matrix.transform_point3(place.as_dvec3()).as_vec3();
            let linear = DMat3::from_mat4(matrix);
            if let Some(normal) = vertices.normals.get_mut(vertex) {
                *normal = direction(across(linear) * normal.as_dvec3());
            }
            if let Some(tangent) = vertices.tangents.get_mut(vertex) {
                *tangent = direction(linear * tangent.truncate().as_dvec3()).extend(tangent.w);
            }
        }
    }

    fn blended(&self, sets: &[Vec<Influence>], vertex: usize) -> DMat4 {
        let mut sum = DMat4::ZERO;
        let mut total = 0.0;
        for influence in sets.iter().map(|set| set[vertex]) {
            for (joint, weight) in influence.joints.into_iter().zip(influence.weights) {
                if let Some(matrix) = self.skinned_from_bound.get(joint as usize).filter(|_| weight > 0.0) {
                    sum += *matrix * f64::from(weight);
                    total += f64::from(weight);
                }
            }
        }
        if total > 0.0 {
            return sum * (1.0 / total);
        }
        let first = sets[0][vertex].joints[0] as usize;
        self.skinned_from_bound.get(first).copied().unwrap_or(DMat4::IDENTITY)
    }
}

/// A weight: 0 if it is not finite or negative.
fn usable(weight: f32) -> f32 {
    if weight > 0.0 && weight.is_finite() { weight } else { 0.0 }
}

/// The matrix for normals: the inverse transpose up to a positive factor, which exists for singular matrices, too.
fn across(matrix: DMat3) -> DMat3 {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    if matrix.determinant() < 0.0 { cofactors * -1.0 } else { cofactors }
}

/// The normalised vector, or 0.
fn direction(vector: DVec3) -> Vec3 {
    vector.normalize_or_zero().as_vec3()
}

#[cfg(test)]
mod tests;
