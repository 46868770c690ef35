//! `[[solid]]`: constructive solid geometry, the union, intersection or difference of closed shapes.

use glam::{DMat4, DVec3, DVec4};

use super::mesh::too_many;
use super::shape::{KEYS, OPERAND};
use super::table::Table;
use super::value::Value;
use super::{Reader, revolution, transform};
use crate::boolean::{BYTES_PER_TRIANGLE, Flaw, OperandSurface, Operation, Solid};
use crate::budget::Reservation;
use crate::error::{Error, ErrorKind, Result};
use crate::scene::MeshId;
use crate::shape::{Geometry, Mesh, Part, Sphere};

pub(super) const OPERATIONS: &[(&str, Operation)] = &[
    ("union", Operation::Union),
    ("intersection", Operation::Intersection),
    ("difference", Operation::Difference),
];
/// The shapes that can have an inside.
pub(super) const TYPES: &[(&str, &str)] = &[
    ("sphere", "sphere"),
    ("box", "box"),
    ("cylinder", "cylinder"),
    ("cone", "cone"),
    ("torus", "torus"),
    ("lathe", "lathe"),
    ("text", "text"),
    ("mesh", "mesh"),
    (SOLID, SOLID),
];
const SOLID: &str = "solid";

/// So many pieces make 16 million triangles of a sphere.
const MOST_SEGMENTS: u64 = 1 << 12;
/// Maximum depth of solids in solids.
const DEEPEST: usize = 16;

/// State shared by a solid and all that is in it.
struct Build {
    /// The parts that the result may have, in the order in which they are written: their geometry is that of the operand.
    parts: Vec<Part>,
    /// Triangles of all operands so far.
    triangles: u64,
    depth: usize,
    memory: Vec<Reservation>,
}

impl Reader<'_, '_> {
    /// The parts of a solid: what is left of each operand.
    pub(super) fn solid(&mut self, table: &Table<'_>) -> Result<Vec<Part>> {
        let mut build = Build { parts: Vec::new(), triangles: 0, depth: 0, memory: Vec::new() };
        // Lights and cameras of models in a solid would not be moved with it.
        let was_in_object = std::mem::replace(&mut self.in_object, true);
        let solid = self.combined(table, DMat4::IDENTITY, &mut build);
        self.in_object = was_in_object;
        let surfaces = solid?.surfaces();
        if surfaces.is_empty() {
            let message = "nothing is left of the solid: its operands do not overlap, or cut away all of it";
            self.context.warn(&table.at(), message);
        }
        let mut parts = Vec::new();
        for (number, surface) in surfaces {
            let mut part = build.parts[number as usize].clone();
            part.geometry =
                self.mesh(table, Mesh { name: SOLID.to_owned(), is_of_solid: true, ..surface })?;
            part.world_from_object = DMat4::IDENTITY;
            parts.push(part);
        }
        Ok(parts)
    }

    /// The solid that a table describes; `matrix` is the transform from its space to that of the outermost one.
    fn combined(&mut self, table: &Table<'_>, matrix: DMat4, build: &mut Build) -> Result<Solid> {
        if build.depth == DEEPEST {
            let error = table.error(format!("solids in solids are more than {DEEPEST} deep"));
            return Err(Error { kind: ErrorKind::Limit, ..error });
        }
        let example = "\"difference\"";
        let operation = table.need("operation", example, Operation::Union, |value| value.choice(OPERATIONS));
        let segments = table.or("segments", self.segments, |value| value.integer(3, MOST_SEGMENTS));
        let example = "[{ type = \"box\", … }, { type = \"sphere\", … }]";
        let expected = "a list of shapes, each with a `type`";
        let items = table.need("of", example, Vec::new(), |value| Ok(value.list(expected)?.collect()));
        table.sound(&["of"])?;
        if items.is_empty() {
            return Err(table.error_at("of", "the solid is made of nothing: `of` has no shapes"));
        }
        let segments_outside = std::mem::replace(&mut self.segments, segments);
        build.depth += 1;
        let first = build.parts.len();
        let mut solids = Vec::new();
        let mut is_sound = table.sound(&["operation", "segments"]).is_ok();
        for item in items.into_iter().take_while(|item| !item.document.is_full()) {
            match self.operand(item, matrix, build) {
                Ok(solid) => solids.push(solid),
                Err(error) => {
                    item.note(error);
                    is_sound = false;
                }
            }
        }
        build.depth -= 1;
        self.segments = segments_outside;
        if !is_sound {
            return Err(Error::untold());
        }
        self.share_material(&mut build.parts[first..]);
        let limit = self.context.limits.elements;
        Solid::combined(operation, solids, &|count| {
            if count > limit {
                return Err(too_many(table, count, limit));
            }
            self.context.budget.reserve(count * BYTES_PER_TRIANGLE, "the solid", &table.at())
        })
    }

    /// Gives the material of the first operand to parts without one.
    fn share_material(&self, parts: &mut [Part]) {
        let Some(material) = parts.first().and_then(|part| part.material) else { return };
        for part in parts.iter_mut().filter(|part| part.material.is_none()) {
            part.material = Some(material);
            part.emission = part.emission.or_else(|| self.glows.get(&material).copied());
        }
    }

    fn operand(&mut self, item: Value<'_>, outer: DMat4, build: &mut Build) -> Result<Solid> {
        let table = item.table("[[solid.of]]")?;
        let kind = table.need("type", "\"box\"", None, |value| value.choice(TYPES).map(Some));
        let Some(kind) = kind else { return Err(Error::untold()) };
        let keys = KEYS.iter().find(|entry| entry.0 == kind).map_or(&[][..], |entry| entry.1);
        table.allow(&[keys, OPERAND, transform::KEYS]);
        let first = build.parts.len();
        if kind == SOLID {
            let attributes = self.shape_attributes(&table);
            let matrix = outer * transform::world_from_object(&table);
            let solid = self.combined(&table, matrix, build)?;
            self.dress(&attributes, &mut build.parts[first..]);
            return Ok(solid);
        }
        let meshes = self.scene.meshes.len();
        let mut parts = self.parts(kind, &table)?;
        let solid = self.closed(&table, kind, outer, &parts, build);
        if !table.has("file") {
            // Nothing else has the mesh of an operand; those of files may be used again.
            self.scene.meshes.truncate(meshes);
        }
        build.parts.append(&mut parts);
        solid
    }

    /// The solid that the parts of a shape bound together.
    fn closed(
        &mut self,
        table: &Table<'_>,
        kind: &str,
        outer: DMat4,
        parts: &[Part],
        build: &mut Build,
    ) -> Result<Solid> {
        let segments = self.segments;
        let pieces = |part: &Part| match &part.geometry {
            Geometry::Mesh(MeshId(id)) => self.scene.meshes[*id as usize].triangles.len() as u64,
            Geometry::Torus { .. } => 2 * segments * revolution::SEGMENTS,
            _ => segments * segments.max(4),
        };
        let count = parts.iter().map(pieces).fold(0, u64::saturating_add);
        build.triangles = build.triangles.saturating_add(count);
        let limit = self.context.limits.elements;
        if build.triangles > limit {
            return Err(too_many(table, build.triangles, limit));
        }
        let memory = self.context.budget.reserve(count * BYTES_PER_TRIANGLE, "the solid", &table.at())?;
        build.memory.push(memory);
        let made: Vec<Option<(Mesh, DMat4)>> =
            parts.iter().map(|part| tessellated(&part.geometry, segments)).collect();
        let mut surfaces = Vec::new();
        for ((index, part), made) in parts.iter().enumerate().zip(&made) {
            let (mesh, own) = match (&part.geometry, made) {
                (Geometry::Mesh(id), _) => (&self.scene.meshes[id.index()], DMat4::IDENTITY),
                (_, Some((mesh, own))) => (mesh, *own),
                _ => return Err(flawed(table, kind, Flaw::Open)),
            };
            let number = (build.parts.len() + index) as u32;
            surfaces.push(OperandSurface { number, mesh, matrix: outer * part.world_from_object * own });
        }
        // What we make of these does not cross itself, which takes a while to find out.
        let may_cross = !matches!(kind, "sphere" | "box" | "cylinder" | "cone");
        Solid::new(&surfaces, may_cross).map_err(|flaw| flawed(table, kind, flaw))
    }
}

/// The mesh of a closed quadric or torus, and the transform from its space; none for what is open.
fn tessellated(geometry: &Geometry, segments: u64) -> Option<(Mesh, DMat4)> {
    match *geometry {
        Geometry::Sphere(Sphere { center, radius }) => {
            let place = DMat4::from_translation(center) * DMat4::from_scale(DVec3::splat(radius));
            // Poles of uv lie on the y axis, and u goes from +x toward −z.
            let upright = DMat4::from_cols(DVec4::X, DVec4::NEG_Z, DVec4::Y, DVec4::W);
            Some((revolution::ball(segments as u32), place * upright))
        }
        Geometry::Cylinder { radius, z: [low, high], phi_max: 360.0 } => {
            Some((revolution::closed_cylinder(radius, [low, high], segments as u32), DMat4::IDENTITY))
        }
        Geometry::Torus { radius, tube } => {
            Some((revolution::torus(radius, tube, segments as u32), DMat4::IDENTITY))
        }
        _ => None,
    }
}

fn flawed(table: &Table<'_>, kind: &str, flaw: Flaw) -> Error {
    let (message, remedy) = match flaw {
        Flaw::Open => (
            format!("this {kind} is not closed: at each edge of a solid are two triangles, one on each side"),
            "leave out what cuts it open, or close the holes of the mesh",
        ),
        Flaw::Crossing => (
            format!("the surface of this {kind} crosses itself"),
            "give its parts one by one, as the shapes of a union",
        ),
        Flaw::Flat => (format!("this {kind} has no volume"), "a solid needs an inside"),
        Flaw::Far => (format!("this {kind} is too far away to compute with"), "use smaller numbers"),
    };
    table.error(message).hint(remedy)
}
