//! `[[sphere]]`, `[[mesh]]` and the other shapes; `[objects]` and `[[instance]]`.

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};

use super::value::{Table, Value};
use super::{Reader, form, light, place};
use crate::error::{Error, ErrorKind, Result};
use crate::scene::{Instance, MeshId, Object, ObjectId};
use crate::shape::{Geometry, Mesh, Part, Shape, Sphere};

/// The keys of shapes, by kind, besides [`COMMON`] and those that place it.
pub(super) const KEYS: &[(&str, &[&str])] = &[
    ("sphere", &["center", "radius"]),
    ("triangle", &["vertices", "normals", "uvs"]),
    ("quad", &["corner", "edge_u", "edge_v"]),
    ("plane", &["point", "normal", "size"]),
    ("disk", &["center", "normal", "radius"]),
    ("box", &["min", "max"]),
    ("mesh", &["file", "positions", "triangles", "normals", "uvs", "colors"]),
    ("sphereflake", &["center", "radius", "depth"]),
];
/// What every shape may have.
pub(super) const COMMON: &[&str] = &["name", "material", "emission", "two_sided"];
/// The keys of `[[instance]]`.
pub(super) const INSTANCE: &[&str] = &["object", "material"];

/// The deepest sphereflake: 5.4 million spheres.
const DEEPEST_FLAKE: u64 = 7;

impl Reader<'_, '_> {
    /// All shapes of a table that holds arrays of them.
    pub(super) fn shapes(&mut self, table: &Table<'_>) -> Result<Vec<Shape>> {
        let mut shapes = Vec::new();
        for &(kind, keys) in KEYS {
            let Some(value) = table.find(kind) else { continue };
            for table in value.tables()? {
                let table = table?;
                table.allow(&[keys, COMMON, place::KEYS])?;
                self.shape(kind, &table, &mut shapes)?;
            }
        }
        Ok(shapes)
    }

    fn shape(&mut self, kind: &str, table: &Table<'_>, shapes: &mut Vec<Shape>) -> Result<()> {
        let material = table.find("material").map(|value| self.material_named(value)).transpose()?;
        let emission = self.emission(table)?;
        let name = light::name(table)?;
        let world_from_object = place::place(table)?;
        let parts = match (kind, table.find("file")) {
            ("mesh", Some(file)) => self.model_parts(table, file)?,
            _ => {
                let geometry = self.geometry(kind, table)?;
                vec![Part { name: None, geometry, material: None, emission: None }]
            }
        };
        for part in parts {
            let material = material.or(part.material).unwrap_or_else(|| self.default_material());
            // What the shape says goes before what its material says, and that before what its file says.
            let emission = emission.or_else(|| self.glows.get(&material).copied()).or(part.emission);
            let name = name.clone().or(part.name);
            shapes.push(Shape {
                name,
                emission,
                world_from_object,
                ..Shape::new(table.at(), part.geometry, material)
            });
        }
        Ok(())
    }

    /// What stands in the model file of a `[[mesh]]`.
    fn model_parts(&mut self, table: &Table<'_>, file: Value<'_>) -> Result<Vec<Part>> {
        if let Some(both) = table.one_of(&["file", "positions"])?.and(table.find("triangles")) {
            return Err(both.error("`triangles` needs `positions`, not `file`"));
        }
        table.allow(&[&["file"], COMMON, place::KEYS])?;
        self.model(file)
    }

    fn geometry(&mut self, kind: &str, table: &Table<'_>) -> Result<Geometry> {
        match kind {
            "sphere" => Ok(Geometry::Sphere(sphere(table)?)),
            "quad" => quad(table),
            "disk" => Ok(Geometry::Disk {
                center: table.need("center", "[0, 0, 0]")?.vector()?,
                normal: table.need("normal", "[0, 1, 0]")?.direction()?,
                radius: table.need("radius", "1")?.positive()?,
            }),
            "sphereflake" => self.sphereflake(table),
            "plane" => {
                let point = table.or("point", DVec3::ZERO, Value::vector)?;
                let normal = table.or("normal", DVec3::Y, Value::direction)?;
                let size = table.or("size", 1000.0, Value::positive)?;
                self.mesh(table, form::plane(point, normal, size))
            }
            "box" => {
                let (low, high) = (table.need("min", "[-1, -1, -1]")?, table.need("max", "[1, 1, 1]")?);
                let (min, max) = (low.vector()?, high.vector()?);
                if min.cmpge(max).any() {
                    return Err(high
                        .error(format!("`max` {max} is not beyond `min` {min} along every axis"))
                        .hint("a box without thickness is a quad"));
                }
                self.mesh(table, form::cuboid(min, max))
            }
            "triangle" => {
                let value = table.need("vertices", "[[0, 0, 0], [1, 0, 0], [0, 1, 0]]")?;
                let vertices = value.list_of::<3>("three points")?;
                let mut mesh =
                    form::triangle([point(vertices[0])?, point(vertices[1])?, point(vertices[2])?]);
                let [a, b, c] = [0, 1, 2].map(|i| mesh.positions[i].as_dvec3());
                if (b - a).cross(c - a) == DVec3::ZERO {
                    return Err(value.error("the triangle has no area: its vertices lie on a line"));
                }
                self.vertex_data(table, &mut mesh)?;
                self.mesh(table, mesh)
            }
            _ => {
                let mesh = self.inline_mesh(table)?;
                self.mesh(table, mesh)
            }
        }
    }

    /// Keeps a mesh whose coordinates can be computed with.
    fn mesh(&mut self, table: &Table<'_>, mesh: Mesh) -> Result<Geometry> {
        if !mesh.positions.iter().all(|position| position.is_finite()) {
            return Err(table
                .error("its corners are too far away to compute with")
                .hint("use smaller numbers"));
        }
        self.scene.meshes.push(mesh);
        Ok(Geometry::Mesh(MeshId(self.scene.meshes.len() as u32 - 1)))
    }

    fn sphereflake(&mut self, table: &Table<'_>) -> Result<Geometry> {
        let Sphere { center, radius } = sphere(table)?;
        let depth = table.or("depth", 4, |value| value.integer(0, DEEPEST_FLAKE))? as u32;
        // All of them together: a few lines of text must not fill the memory.
        self.flake_spheres = self.flake_spheres.saturating_add(form::sphereflake_count(depth));
        if self.flake_spheres > self.sources.limits.elements {
            return Err(too_many(table, self.flake_spheres, self.sources.limits.elements));
        }
        let spheres = form::sphereflake(center, radius, depth);
        if spheres.iter().all(|sphere| sphere.radius.is_normal() && sphere.center.is_finite()) {
            return Ok(Geometry::Spheres(Arc::from(spheres)));
        }
        Err(table
            .error("its spheres are too small or too far away to compute with")
            .hint("use moderate numbers"))
    }

    fn inline_mesh(&mut self, table: &Table<'_>) -> Result<Mesh> {
        if !table.has("positions") {
            return Err(table
                .error("`file` or `positions` is missing")
                .hint("name a model file, or give `positions` and `triangles`"));
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
    fn vertex_data(&mut self, table: &Table<'_>, mesh: &mut Mesh) -> Result<()> {
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
                    _ => mesh.colors.push(super::color::plain_color(item)?),
                }
            }
        }
        Ok(())
    }

    /// `[objects]`.
    pub(super) fn read_objects(&mut self, value: Value<'_>) -> Result<()> {
        for entry in value.table("[objects]")?.entries() {
            let table = entry.table(format!("[objects.{}]", entry.key()))?;
            let kinds: Vec<&'static str> = KEYS.iter().map(|&(kind, _)| kind).collect();
            table.allow(&[&kinds])?;
            if let Some(before) = self.objects.get(entry.key()) {
                return Err(super::twice(entry, "object", &self.scene.objects[before.index()].at));
            }
            let shapes = self.shapes(&table)?;
            if shapes.is_empty() {
                return Err(table
                    .error("it has no shapes")
                    .hint(format!("add one, such as [[objects.{}.sphere]]", entry.key())));
            }
            self.objects.insert(entry.key().to_owned(), ObjectId(self.scene.objects.len() as u32));
            self.scene.objects.push(Object { name: entry.key().to_owned(), at: table.at(), shapes });
        }
        Ok(())
    }

    /// One `[[instance]]`.
    pub(super) fn read_instance(&mut self, table: &Table<'_>) -> Result<()> {
        table.allow(&[INSTANCE, place::KEYS])?;
        let value = table.need("object", "\"the name of an object\"")?;
        let name = value.text("the name of an object")?;
        let object = super::named(&self.objects, "object", value, name)?;
        let material = table.find("material").map(|value| self.material_named(value)).transpose()?;
        if material.is_some_and(|id| self.glows.contains_key(&id)) {
            let message = "the emission of an instance's material is ignored: its shapes keep theirs";
            self.sources.warn(&table.at(), message);
        }
        let world_from_object = place::place(table)?;
        self.scene.instances.push(Instance { at: table.at(), object, world_from_object, material });
        Ok(())
    }
}

fn too_many(table: &Table<'_>, count: u64, limit: u64) -> Error {
    let message = format!("{count} elements are more than the limit of {limit}");
    Error { kind: ErrorKind::Limit, ..table.error(message) }.hint("use fewer, or raise `Limits::elements`")
}

/// A point or vector that is finite as `f32`.
fn point(value: Value<'_>) -> Result<Vec3> {
    value.singles("three numbers, [x, y, z]").map(Vec3::from_array)
}

fn sphere(table: &Table<'_>) -> Result<Sphere> {
    Ok(Sphere {
        center: table.or("center", DVec3::ZERO, Value::vector)?,
        radius: table.or("radius", 1.0, Value::positive)?,
    })
}

/// A quad, of a shape or a light.
pub(super) fn quad(table: &Table<'_>) -> Result<Geometry> {
    let corner = table.need("corner", "[0, 0, 0]")?.vector()?;
    let edge_u = table.need("edge_u", "[1, 0, 0]")?.direction()?;
    let second = table.need("edge_v", "[0, 1, 0]")?;
    let edge_v = second.direction()?;
    if edge_u.normalize().cross(edge_v.normalize()).length_squared() < 1e-24 {
        return Err(second.error("`edge_v` is parallel to `edge_u`: the quad has no area"));
    }
    Ok(Geometry::Quad { corner, edge_u, edge_v })
}
