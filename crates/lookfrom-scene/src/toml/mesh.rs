//! `[[mesh]]` with vertices and triangles in the scene file; and the meshes of other shapes.

use glam::Vec2;

use super::model::CHOICE;
use super::shape::point;
use super::table::Table;
use super::value::Value;
use super::{Reader, color};
use crate::error::{Error, ErrorKind, Result};
use crate::scene::MeshId;
use crate::shape::{Geometry, Mesh};
use crate::subdivision;

impl Reader<'_, '_> {
    /// Adds a mesh after checking that its positions are finite.
    pub(super) fn mesh(&mut self, table: &Table<'_>, mesh: Mesh) -> Result<Geometry> {
        if !mesh.positions.iter().all(|position| position.is_finite()) {
            return Err(table
                .error("its corners are too far away to compute with")
                .hint("use smaller numbers"));
        }
        self.context.keep(mesh.bytes(), "the mesh", &table.at())?;
        self.scene.meshes.push(mesh);
        Ok(Geometry::Mesh(MeshId(self.scene.meshes.len() as u32 - 1)))
    }

    pub(super) fn inline_mesh(&mut self, table: &Table<'_>) -> Result<Mesh> {
        if !table.has("positions") {
            let error = table.error("`file` or `positions` is missing");
            table.lacks(
                &["file", "positions"],
                error.hint("name a model file, or give `positions` and `triangles`"),
            );
            return Err(Error::untold());
        }
        if let Some(key) = CHOICE.iter().find_map(|key| table.find(key)) {
            return Err(key.error(format!("`{}` is for a `file`, not for `positions`", key.key())));
        }
        let positions = table.need("positions", "[[0, 0, 0], [1, 0, 0], [0, 1, 0]]", Vec::new(), |value| {
            value.list("a list of points, [x, y, z]")?.map(point).collect()
        });
        let triangles = table.need("triangles", "[[0, 1, 2]]", None, |value| Ok(Some(value)));
        let mut mesh = Mesh { name: "mesh".to_owned(), positions, ..Mesh::default() };
        self.vertex_data(table, &mut mesh);
        table.sound(&["positions", "triangles"])?;
        let Some(triangles) = triangles else { return Ok(mesh) };
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
        if count > self.context.limits.elements {
            return Err(too_many(table, count, self.context.limits.elements));
        }
        if let levels @ 1.. = self.subdivision(table) {
            let meshes = std::slice::from_mut(&mut mesh);
            subdivision::subdivide_meshes(meshes, levels, &table.at(), self.context)?;
        }
        Ok(mesh)
    }

    /// Normals, texture coordinates and colours: one each per vertex.
    pub(super) fn vertex_data(&mut self, table: &Table<'_>, mesh: &mut Mesh) {
        let expected = mesh.positions.len();
        mesh.normals = for_vertices(table, "normals", expected, point);
        mesh.uvs = for_vertices(table, "uvs", expected, |item| {
            item.singles("two numbers, [u, v]").map(Vec2::from_array)
        });
        mesh.colors = for_vertices(table, "colors", expected, color::plain_color);
    }
}

/// The values of a key, one per vertex, if the key is present.
fn for_vertices<'a, T>(
    table: &Table<'a>,
    key: &str,
    expected: usize,
    decode: impl Fn(Value<'a>) -> Result<T>,
) -> Vec<T> {
    // If the vertices are invalid, their number is unknown.
    let is_counted = table.sound(&["positions", "vertices"]).is_ok();
    table.or(key, Vec::new(), |value| {
        let items = value.list("a list with a value for each vertex")?;
        if is_counted && items.len() != expected {
            let found = crate::plural::counted(items.len(), "value");
            return Err(value.error(format!("`{key}` has {found}; expected {expected}, one for each vertex")));
        }
        items.map(decode).collect()
    })
}

/// The error that there are more elements than the limit.
pub(super) fn too_many(table: &Table<'_>, count: u64, limit: u64) -> Error {
    let message = format!("{count} elements are more than the limit of {limit}");
    Error { kind: ErrorKind::Limit, ..table.error(message) }.hint("use fewer")
}
