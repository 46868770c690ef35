//! Triangle and bilinear meshes.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::Reader;
use super::loop_subdivision::subdivide;
use super::params::{ParameterType, Parameters};
use crate::error::{Error, ErrorKind, Result};
use crate::scene::MeshId;
use crate::shape::{Geometry, Mesh, Patches};

/// Maximum number of triangles of a subdivision: otherwise a few words of a file could exhaust the memory.
const MOST_SUBDIVIDED: u64 = 1 << 24;

impl Reader<'_, '_> {
    pub(super) fn triangle_mesh(&mut self, p: &Parameters) -> Result<Option<Geometry>> {
        p.ignore(&["faceIndices"]);
        let positions = points(p)?;
        let triangles = faces::<3>(p, positions.len())?;
        // pbrt's v runs along normal × tangent in world space, even under reflections.
        let mirrors = self.state.matrix.determinant() < 0.0;
        let handedness = if mirrors == self.state.reverse_orientation { 1.0 } else { -1.0 };
        let mesh = Mesh {
            name: "trianglemesh".into(),
            normals: self.one_a_vertex(p, "N", p.vectors("N", ParameterType::Normal)?, positions.len()),
            tangents: self
                .one_a_vertex(p, "S", p.vectors("S", ParameterType::Vector3)?, positions.len())
                .into_iter()
                .map(|tangent| tangent.extend(handedness))
                .collect(),
            uvs: self.uvs(p, positions.len())?,
            positions,
            triangles,
            ..Mesh::default()
        };
        Ok(self.push_mesh(mesh))
    }

    pub(super) fn ply_mesh(&mut self, p: &Parameters) -> Result<Geometry> {
        let parameter = p.find("filename", &[ParameterType::String])?;
        let Some(name) = p.file_name()? else {
            let error = p.place.invalid(format!("{} has no \"string filename\"", p.title));
            return Err(error.hint("name a .ply or .ply.gz file"));
        };
        let place = parameter.map_or(&p.place, |parameter| &parameter.place);
        let path = self.resolve(name);
        let mesh = self.model(path, place);
        self.displaced(p, mesh).map(Geometry::Mesh)
    }

    pub(super) fn bilinear_mesh(&mut self, p: &Parameters) -> Result<Option<Geometry>> {
        // The picture directs pbrt's sampling of a light; what it emits is the picture of the light.
        p.ignore(&["faceIndices", "emissionfilename"]);
        let positions = points(p)?;
        let patches = faces::<4>(p, positions.len())?;
        if patches.is_empty() {
            return Ok(None);
        }
        Ok(Some(Geometry::Bilinear(Arc::new(Patches {
            normals: self.one_a_vertex(p, "N", p.vectors("N", ParameterType::Normal)?, positions.len()),
            uvs: self.uvs(p, positions.len())?,
            positions,
            patches,
        }))))
    }

    pub(super) fn loop_subdivision(&mut self, p: &Parameters) -> Result<Option<Geometry>> {
        p.ignore(&["scheme"]);
        let levels = p.integer("levels", 3, 0, 15)? as u32;
        let positions = points(p)?;
        let triangles = faces::<3>(p, positions.len())?;
        // Each level splits each triangle into four.
        let count = (triangles.len() as u64) << (2 * levels);
        let limit = self.context.limits.elements.min(MOST_SUBDIVIDED);
        if count > limit {
            let message =
                format!("{count} triangles after {levels} levels are more than the limit of {limit}");
            return Err(p.place.error(ErrorKind::Limit, message).hint("lower \"integer levels\""));
        }
        // Each level is made from the one before it: vertices, their neighbours and triangles.
        let _memory = self.context.budget.reserve(count * 100, "the subdivided mesh", &p.place.location())?;
        let mesh =
            subdivide(&positions, &triangles, levels).map_err(|message| p.refuse("indices", &message))?;
        Ok(self.push_mesh(mesh))
    }

    pub(super) fn push_mesh(&mut self, mesh: Mesh) -> Option<Geometry> {
        if mesh.triangles.is_empty() {
            return None;
        }
        self.scene.meshes.push(mesh);
        Some(Geometry::Mesh(MeshId(self.scene.meshes.len() as u32 - 1)))
    }

    fn uvs(&mut self, p: &Parameters, count: usize) -> Result<Vec<Vec2>> {
        Ok(self.one_a_vertex(p, "uv", p.points2("uv")?, count))
    }

    /// Values at vertices, dropped with a warning unless there is one per vertex.
    fn one_a_vertex<T>(&mut self, p: &Parameters, name: &str, values: Vec<T>, count: usize) -> Vec<T> {
        if values.is_empty() || values.len() == count {
            return values;
        }
        let message = format!(
            "{name:?} has {} for {}: left out",
            crate::plural::counted(values.len(), "value"),
            crate::plural::counted(count, "vertex")
        );
        self.context.warn(&p.place.location(), message);
        Vec::new()
    }
}

fn points(p: &Parameters) -> Result<Vec<Vec3>> {
    let positions = p.vectors("P", ParameterType::Point3)?;
    if positions.is_empty() {
        let error = p.place.invalid(format!("{} has no \"point3 P\"", p.title));
        return Err(error.hint("add its vertices: \"point3 P\" [ 0 0 0  1 0 0  0 1 0 ]"));
    }
    Ok(positions)
}

/// The corners of each face: `N` indices each, or all vertices if there are exactly `N`.
fn faces<const N: usize>(p: &Parameters, count: usize) -> Result<Vec<[u32; N]>> {
    let indices = p.integers("indices")?;
    if indices.is_empty() {
        if count == N {
            return Ok(vec![std::array::from_fn(|i| i as u32)]);
        }
        let error = p.place.invalid(format!("{} has no \"integer indices\"", p.title));
        return Err(error.hint(format!("give {N} indices of vertices for each face")));
    }
    if !indices.len().is_multiple_of(N) {
        return Err(p.refuse("indices", &format!("{N} indices for each face, found {}", indices.len())));
    }
    let out_of_range = |index: &i32| usize::try_from(*index).map_or(true, |index| index >= count);
    if let Some(order) = indices.iter().position(out_of_range) {
        return Err(index_error(p, order, indices[order], count));
    }
    Ok(indices.chunks_exact(N).map(|face| std::array::from_fn(|i| face[i] as u32)).collect())
}

fn index_error(p: &Parameters, order: usize, index: i32, count: usize) -> Error {
    p.refuse("indices", &format!("indices from 0 to {}, found {index} as number {}", count - 1, order + 1))
        .hint(format!(
            "{} in \"point3 P\"; indices count from 0",
            crate::plural::there_are(count as u64, "vertex")
        ))
}
