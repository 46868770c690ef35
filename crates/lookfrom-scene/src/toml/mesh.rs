//! `[[mesh]]`: vertices and triangles in the scene itself; and the meshes of other shapes.

use glam::Vec2;

use super::model::CHOICE;
use super::shape::point;
use super::table::Table;
use super::{Reader, color};
use crate::error::{Error, ErrorKind, Result};
use crate::scene::MeshId;
use crate::shape::{Geometry, Mesh};

impl Reader<'_, '_> {
    /// Keeps a mesh whose coordinates can be computed with.
    pub(super) fn mesh(&mut self, table: &Table<'_>, mesh: Mesh) -> Result<Geometry> {
        if !mesh.positions.iter().all(|position| position.is_finite()) {
            return Err(table
                .error("its corners are too far away to compute with")
                .hint("use smaller numbers"));
        }
        self.scene.meshes.push(mesh);
        Ok(Geometry::Mesh(MeshId(self.scene.meshes.len() as u32 - 1)))
    }

    pub(super) fn inline_mesh(&mut self, table: &Table<'_>) -> Result<Mesh> {
        if !table.has("positions") {
            return Err(table
                .error("`file` or `positions` is missing")
                .hint("name a model file, or give `positions` and `triangles`"));
        }
        if let Some(key) = CHOICE.iter().find_map(|key| table.find(key)) {
            return Err(key.error(format!("`{}` is for a `file`, not for `positions`", key.key())));
        }
        let positions = table.need("positions", "[[0, 0, 0], [1, 0, 0], [0, 1, 0]]")?;
        let triangles = table.need("triangles", "[[0, 1, 2]]")?;
        let mut mesh = Mesh { name: "mesh".to_owned(), ..Mesh::default() };
        for value in positions.list("a list of points, [x, y, z]")? {
            mesh.positions.push(point(value)?);
        }
        for value in triangles.list("a list of triangles, [i, j, k]")? {
            let mut corners = [0; 3];
            for (corner, item) in corners.iter_mut().zip(value.list_of::<3>("three vertices, [i, j, k]")?) {
                let vertex = item.integer(0, u32::MAX.into())?;
                if vertex >= mesh.positions.len() as u64 {
                    let count = mesh.positions.len();
                    return Err(item
                        .error(format!("there is no vertex {vertex}: `positions` has {count}"))
                        .hint("vertices count from 0"));
                }
                *corner = vertex as u32;
            }
            mesh.triangles.push(corners);
        }
        if mesh.triangles.is_empty() {
            return Err(triangles
                .error("`triangles` is empty")
                .hint("give three vertices for each triangle"));
        }
        let count = mesh.positions.len().max(mesh.triangles.len()) as u64;
        if count > self.sources.limits.elements {
            return Err(too_many(table, count, self.sources.limits.elements));
        }
        self.vertex_data(table, &mut mesh)?;
        Ok(mesh)
    }

    /// Normals, uvs and colours: each as many as there are vertices.
    pub(super) fn vertex_data(&mut self, table: &Table<'_>, mesh: &mut Mesh) -> Result<()> {
        for key in ["normals", "uvs", "colors"] {
            let Some(value) = table.find(key) else { continue };
            let items = value.list("a list with a value for each vertex")?;
            let (found, expected) = (items.len(), mesh.positions.len());
            if found != expected {
                return Err(value
                    .error(format!("`{key}` has {found} values; expected {expected}, one for each vertex")));
            }
            for item in items {
                match key {
                    "normals" => mesh.normals.push(point(item)?),
                    "uvs" => mesh.uvs.push(Vec2::from_array(item.singles("two numbers, [u, v]")?)),
                    _ => mesh.colors.push(color::plain_color(item)?),
                }
            }
        }
        Ok(())
    }
}

/// The error that there are more elements than is allowed.
pub(super) fn too_many(table: &Table<'_>, count: u64, limit: u64) -> Error {
    let message = format!("{count} elements are more than the limit of {limit}");
    Error { kind: ErrorKind::Limit, ..table.error(message) }.hint("use fewer, or raise `Limits::elements`")
}
