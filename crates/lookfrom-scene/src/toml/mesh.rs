//! `[[mesh]]` with vertices and triangles in the scene file, or as arrays of NumPy; and the meshes of other shapes.

use glam::{Vec2, Vec3};

use super::model::CHOICE;
use super::shape::point;
use super::table::Table;
use super::value::Value;
use super::{Reader, color};
use crate::error::{Error, ErrorKind, Location, Result};
use crate::material::Scalar;
use crate::npy;
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
        let example = "[[0, 0, 0], [1, 0, 0], [0, 1, 0]]";
        let positions = table.need("positions", example, Vec::new(), |value| match self.array(value)? {
            Some(rows) => rows.iter().map(|row| finite(value, *row).map(Vec3::from_array)).collect(),
            None => value.list("a list of points, [x, y, z]")?.map(point).collect(),
        });
        let triangles = table.need("triangles", "[[0, 1, 2]]", None, |value| Ok(Some(value)));
        let mut mesh = Mesh { name: "mesh".to_owned(), positions, ..Mesh::default() };
        self.vertex_data(table, &mut mesh);
        table.sound(&["positions", "triangles"])?;
        let Some(triangles) = triangles else { return Ok(mesh) };
        let count = mesh.positions.len();
        let no_vertex = |item: Value<'_>, vertex: f64| {
            item.error(format!("there is no vertex {vertex}: `positions` has {count}"))
                .hint("vertices count from 0")
        };
        mesh.triangles = match self.array::<3>(triangles)? {
            Some(rows) => {
                let is_vertex =
                    |number: &f64| *number >= 0.0 && *number < count as f64 && number.fract() == 0.0;
                let corners = |row: &[f64; 3]| match row.iter().find(|number| !is_vertex(number)) {
                    Some(number) => Err(no_vertex(triangles, *number)),
                    None => Ok(row.map(|number| number as u32)),
                };
                rows.iter().map(corners).collect::<Result<_>>()?
            }
            None => {
                let corners = |value: Value<'_>| {
                    let mut corners = [0; 3];
                    let items = value.list_of::<3>("three vertices, [i, j, k]")?;
                    for (corner, item) in corners.iter_mut().zip(items) {
                        let vertex = item.integer(0, u32::MAX.into())?;
                        if vertex >= count as u64 {
                            return Err(no_vertex(item, vertex as f64));
                        }
                        *corner = vertex as u32;
                    }
                    Ok(corners)
                };
                triangles.list("a list of triangles, [i, j, k]")?.map(corners).collect::<Result<_>>()?
            }
        };
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

    /// The displacement of a mesh's vertices along their normals.
    pub(super) fn displacement(&mut self, table: &Table<'_>) -> Option<Scalar> {
        table.maybe("displacement", |value| self.scalar_where(value, "a number", |_| true))
    }

    /// A mesh of a file that is displaced: each once.
    pub(super) fn displaced(
        &mut self,
        table: &Table<'_>,
        mesh: MeshId,
        displacement: Scalar,
    ) -> Result<MeshId> {
        if let Some((_, known)) = self.displaced.iter().find(|(of, _)| *of == (mesh, displacement)) {
            return Ok(*known);
        }
        let of_file = self.scene.meshes[mesh.index()].clone();
        let Geometry::Mesh(id) = self.mesh(table, Mesh { displacement: Some(displacement), ..of_file })?
        else {
            return Ok(mesh);
        };
        self.displaced.push(((mesh, displacement), id));
        Ok(id)
    }

    /// Normals, texture coordinates and colours: one each per vertex.
    pub(super) fn vertex_data(&mut self, table: &Table<'_>, mesh: &mut Mesh) {
        let expected = mesh.positions.len();
        mesh.normals = self.for_vertices(table, "normals", expected, point, Vec3::from_array);
        mesh.uvs = self.for_vertices(
            table,
            "uvs",
            expected,
            |item| item.singles("two numbers, [u, v]").map(Vec2::from_array),
            Vec2::from_array,
        );
        mesh.colors = self.for_vertices(table, "colors", expected, color::plain_color, |color| color);
        if mesh.colors.iter().flatten().any(|light| *light < 0.0) {
            table.note(table.error_at("colors", "a colour is negative; expected numbers of 0 and above"));
        }
    }

    /// The values of a key, one per vertex, if the key is present.
    pub(super) fn for_vertices<'a, T, const N: usize>(
        &self,
        table: &Table<'a>,
        key: &str,
        expected: usize,
        decode: impl Fn(Value<'a>) -> Result<T>,
        of_row: impl Fn([f32; N]) -> T,
    ) -> Vec<T> {
        // If the vertices are invalid, their number is unknown.
        let is_counted = table.sound(&["positions", "vertices"]).is_ok();
        let check = |value: Value<'a>, count: usize| {
            if is_counted && count != expected {
                let found = crate::plural::counted(count, "value");
                let message = format!("`{key}` has {found}; expected {expected}, one for each vertex");
                return Err(value.error(message));
            }
            Ok(())
        };
        table.or(key, Vec::new(), |value| {
            if let Some(rows) = self.array::<N>(value)? {
                check(value, rows.len())?;
                return rows.iter().map(|row| finite(value, *row).map(&of_row)).collect();
            }
            let items = value.list("a list with a value for each vertex")?;
            check(value, items.len())?;
            items.map(decode).collect()
        })
    }

    /// The rows of `{ npy = "FILE" }`, an array in a file; `None` for a value that is no table.
    pub(super) fn array<const N: usize>(&self, value: Value<'_>) -> Result<Option<Vec<[f64; N]>>> {
        if !value.is_table() {
            return Ok(None);
        }
        let table = value.table("the array")?;
        table.allow(&[&["npy"]]);
        let path = table.need("npy", "\"positions.npy\"", None, |file| {
            self.resolve(file, "the name of a .npy file").map(Some)
        });
        let Some(path) = path else { return Err(Error::untold()) };
        let blame = |error| value.blame(error);
        let bytes = self.context.read(&path).map_err(blame)?;
        npy::rows(&bytes, &Location::file(&path), self.context.limits.elements).map(Some)
    }
}

/// The numbers of a row of an array, which are finite as `f32`.
pub(super) fn finite<const N: usize>(value: Value<'_>, row: [f64; N]) -> Result<[f32; N]> {
    let row = row.map(|number| number as f32);
    if row.iter().all(|number| number.is_finite()) {
        return Ok(row);
    }
    Err(value
        .error(format!("`{}` has numbers that are not finite as 32-bit floating-point numbers", value.key())))
}

/// The error that there are more elements than the limit.
pub(super) fn too_many(table: &Table<'_>, count: u64, limit: u64) -> Error {
    let message = format!("{count} elements are more than the limit of {limit}");
    Error { kind: ErrorKind::Limit, ..table.error(message) }.hint("use fewer")
}
