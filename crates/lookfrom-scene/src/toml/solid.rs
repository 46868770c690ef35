//! `[[solid]]`: constructive solid geometry, the union, intersection or difference of closed shapes.
//!
//! Solids of balls, boxes, cylinders and tori are exact. All others are meshes: those of boxes alone, with another shape, whose surfaces
//! are flush somewhere, that shine, have very many bodies, or for which `segments` are given.

use std::sync::Arc;

use glam::{DMat4, DVec3, DVec4};

use super::material::DEFAULT;
use super::mesh::too_many;
use super::shape::{KEYS, OPERAND, ShapeAttributes, cuboid};
use super::table::Table;
use super::value::Value;
use super::{Reader, revolution, transform};
use crate::boolean::{BYTES_PER_TRIANGLE, Flaw, MeshSolid, OperandSurface};
use crate::budget::Reservation;
use crate::composite;
use crate::error::{Error, ErrorKind, Result};
use crate::scene::{Bounds, MeshId};
use crate::shape::{Geometry, Mesh, Part, Pieces, Sphere};
use crate::solid::{Body, Combination, Form, MOST_BODIES, Operation, Solid};

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
/// Of the mesh that tells whether anything is left of a solid.
const COARSE: u64 = 8;
/// Maximum depth of solids in solids.
const DEEPEST: usize = 16;
/// Sizes and places of bodies beyond these are left to meshes, which find fault with them.
const SIZES: [f64; 2] = [1e-15, 1e15];

/// State shared by a solid and all that is in it.
struct Build {
    /// The parts that the result may have, in the order in which they are written: their geometry is that of the operand.
    parts: Vec<Part>,
    /// Whether any shape says of how many pieces its circles are.
    says_segments: bool,
    /// Triangles of all operands so far.
    triangles: u64,
    depth: usize,
    memory: Vec<Reservation>,
}

/// A solid as it is written.
enum SolidTree<'t> {
    Body(BodyOperand<'t>),
    /// An operand that is a mesh.
    Mesh(MeshSolid),
    Combined(Operation, Table<'t>, Vec<Self>),
}

/// A body that needs no mesh.
struct BodyOperand<'t> {
    /// The number of its part.
    number: u32,
    form: Form,
    /// From its own space to that of the outermost solid.
    matrix: DMat4,
    kind: &'static str,
    segments: u64,
    table: Table<'t>,
}

impl Reader<'_, '_> {
    /// The parts of a solid: what is left of each operand. The look is that of the solid itself.
    pub(super) fn solid(&mut self, table: &Table<'_>, attributes: &ShapeAttributes) -> Result<Vec<Part>> {
        let mut build =
            Build { parts: Vec::new(), says_segments: false, triangles: 0, depth: 0, memory: Vec::new() };
        // Lights and cameras of models in a solid would not be moved with it.
        let was_in_object = std::mem::replace(&mut self.in_object, true);
        let tree = self.combined(table, DMat4::IDENTITY, &mut build);
        self.in_object = was_in_object;
        let tree = tree?;
        if !build.says_segments
            && !self.shines(attributes, &build.parts)
            && let Some(solid) = exact(&tree)
            && !self.meshed(&tree, Some(COARSE), &mut build)?.surfaces().is_empty()
        {
            let solid = Arc::new(solid);
            let surface = |(body, part): (u32, Part)| Part {
                geometry: Geometry::SolidSurface { solid: solid.clone(), body },
                world_from_object: DMat4::IDENTITY,
                ..part
            };
            return Ok((0..).zip(build.parts).map(surface).collect());
        }
        let surfaces = self.meshed(&tree, None, &mut build)?.surfaces();
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
            part.pieces = Pieces::default();
            parts.push(part);
        }
        Ok(parts)
    }

    /// Whether any of the parts emits light, once they have the look of the solid.
    fn shines(&self, attributes: &ShapeAttributes, parts: &[Part]) -> bool {
        let mut parts = parts.to_vec();
        self.dress(attributes, &mut parts);
        let default_shines = || self.materials.get(DEFAULT).is_some_and(|id| self.glows.contains_key(id));
        parts.iter().any(|part| part.emission.is_some() || part.material.is_none() && default_shines())
    }

    /// The solid that a table describes; `matrix` is the transform from its space to that of the outermost one.
    fn combined<'t>(&mut self, table: &Table<'t>, matrix: DMat4, build: &mut Build) -> Result<SolidTree<'t>> {
        if build.depth == DEEPEST {
            let error = table.error(format!("solids in solids are more than {DEEPEST} deep"));
            return Err(Error { kind: ErrorKind::Limit, ..error });
        }
        let example = "\"difference\"";
        let operation = table.need("operation", example, Operation::Union, |value| value.choice(OPERATIONS));
        let segments = table.or("segments", self.segments, |value| value.integer(3, MOST_SEGMENTS));
        build.says_segments |= table.has("segments");
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
        let mut operands = Vec::new();
        let mut is_sound = table.sound(&["operation", "segments"]).is_ok();
        for item in items.into_iter().take_while(|item| !item.document.is_full()) {
            match self.operand(item, matrix, build) {
                Ok(operand) => operands.push(operand),
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
        Ok(SolidTree::Combined(operation, table.clone(), operands))
    }

    /// Gives the material of the first operand to parts without one.
    fn share_material(&self, parts: &mut [Part]) {
        let Some(material) = parts.first().and_then(|part| part.material) else { return };
        for part in parts.iter_mut().filter(|part| part.material.is_none()) {
            part.material = Some(material);
            part.emission = part.emission.or_else(|| self.glows.get(&material).copied());
        }
    }

    fn operand<'t>(&mut self, item: Value<'t>, outer: DMat4, build: &mut Build) -> Result<SolidTree<'t>> {
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
        build.says_segments |= table.has("segments");
        let is_of_file = table.has("file");
        let meshes = self.scene.meshes.len();
        let mut parts = self.parts(kind, &table)?;
        let number = build.parts.len() as u32;
        let form = form(kind, &table, &parts)?;
        let operand = match form {
            Some(form) => {
                let own = parts[0].world_from_object;
                // Without a map around it, a matrix stays as it is, bit by bit.
                let matrix = if outer == DMat4::IDENTITY { own } else { outer * own };
                Ok(SolidTree::Body(BodyOperand {
                    number,
                    form,
                    matrix,
                    kind,
                    segments: self.segments,
                    table,
                }))
            }
            None => self.closed(&table, kind, outer, &parts, build).map(SolidTree::Mesh),
        };
        if !is_of_file {
            // Nothing else has the mesh of an operand; those of files may be used again.
            self.scene.meshes.truncate(meshes);
        }
        build.parts.append(&mut parts);
        operand
    }

    /// The mesh of a solid, with so many pieces of a circle, or as many as each table says.
    fn meshed(
        &mut self,
        tree: &SolidTree<'_>,
        segments: Option<u64>,
        build: &mut Build,
    ) -> Result<MeshSolid> {
        match tree {
            SolidTree::Mesh(solid) => Ok(solid.clone()),
            SolidTree::Body(body) => {
                let segments = segments.unwrap_or(body.segments);
                let pieces = match body.form {
                    Form::Cuboid { .. } => 12,
                    Form::Torus { .. } => 2 * segments * revolution::SEGMENTS,
                    Form::Ball { .. } | Form::Cylinder { .. } => segments * segments.max(4),
                };
                self.admit(&body.table, pieces, build)?;
                let (mesh, own) = tessellated(&body.form, segments);
                let surface = OperandSurface { number: body.number, mesh: &mesh, matrix: body.matrix * own };
                // Only what is thicker than its circle crosses itself, which takes a while to find out.
                let may_cross = matches!(body.form, Form::Torus { .. });
                MeshSolid::new(&[surface], may_cross).map_err(|flaw| flawed(&body.table, body.kind, flaw))
            }
            SolidTree::Combined(operation, table, operands) => {
                let solids = operands
                    .iter()
                    .map(|operand| self.meshed(operand, segments, build))
                    .collect::<Result<_>>()?;
                let limit = self.context.limits.elements;
                MeshSolid::combined(*operation, solids, &|count| {
                    if count > limit {
                        return Err(too_many(table, count, limit));
                    }
                    self.context.budget.reserve(count * BYTES_PER_TRIANGLE, "the solid", &table.at())
                })
            }
        }
    }

    /// Counts triangles of an operand, and asks for their memory.
    fn admit(&mut self, table: &Table<'_>, triangles: u64, build: &mut Build) -> Result<()> {
        build.triangles = build.triangles.saturating_add(triangles);
        let limit = self.context.limits.elements;
        if build.triangles > limit {
            return Err(too_many(table, build.triangles, limit));
        }
        let memory = triangles.saturating_mul(BYTES_PER_TRIANGLE);
        build.memory.push(self.context.budget.reserve(memory, "the solid", &table.at())?);
        Ok(())
    }

    /// The solid that the meshes of a shape bound together.
    fn closed(
        &mut self,
        table: &Table<'_>,
        kind: &str,
        outer: DMat4,
        parts: &[Part],
        build: &mut Build,
    ) -> Result<MeshSolid> {
        let mesh_of = |part: &Part| match part.geometry {
            Geometry::Mesh(id) => Ok(id),
            _ => Err(flawed(table, kind, Flaw::Open)),
        };
        let meshes: Vec<MeshId> = parts.iter().map(mesh_of).collect::<Result<_>>()?;
        let triangles = meshes.iter().map(|id| self.scene.meshes[id.index()].triangles.len() as u64);
        self.admit(table, triangles.fold(0, u64::saturating_add), build)?;
        let surfaces: Vec<OperandSurface<'_>> = (build.parts.len() as u32..)
            .zip(parts.iter().zip(meshes))
            .map(|(number, (part, id))| OperandSurface {
                number,
                mesh: &self.scene.meshes[id.index()],
                matrix: outer * part.world_from_object,
            })
            .collect();
        MeshSolid::new(&surfaces, kind != "cone").map_err(|flaw| flawed(table, kind, flaw))
    }
}

/// The form of a shape, if it is one that needs no mesh.
fn form(kind: &str, table: &Table<'_>, parts: &[Part]) -> Result<Option<Form>> {
    Ok(match parts.first().map(|part| &part.geometry) {
        Some(Geometry::Sphere(Sphere { center, radius })) => {
            Some(Form::Ball { center: *center, radius: *radius })
        }
        Some(&Geometry::Cylinder { radius, z, phi_max: 360.0 }) => Some(Form::Cylinder { radius, z }),
        Some(&Geometry::Torus { radius, tube }) => Some(Form::Torus { radius, tube }),
        Some(Geometry::Mesh(_)) if kind == "box" => {
            let [min, max] = cuboid(table)?;
            Some(Form::Cuboid { min, max })
        }
        _ => None,
    })
}

/// The solid of a tree that consists of bodies, if they are not all boxes, and no two of them have flush surfaces.
fn exact(tree: &SolidTree<'_>) -> Option<Solid> {
    let mut bodies = Vec::new();
    let combination = combination(tree, &mut bodies)?;
    let [least, most] = SIZES;
    let is_moderate = |Bounds { min, max }: Bounds| {
        (max - min).min_element() > least && min.abs().max(max.abs()).max_element() < most
    };
    let solid = Solid::new(bodies, combination);
    let is_flat = |body: &Body| matches!(body.form(), Form::Cuboid { .. });
    let is_suitable = solid.bodies().len() <= MOST_BODIES
        && !solid.bodies().iter().all(is_flat)
        && solid.bodies().iter().all(|body| is_moderate(body.own_bounds()))
        && !solid.has_flush_surfaces();
    is_suitable.then_some(solid)
}

/// The combination of a tree, whose bodies are added to others.
fn combination(tree: &SolidTree<'_>, bodies: &mut Vec<Body>) -> Option<Combination> {
    match tree {
        SolidTree::Mesh(_) => None,
        SolidTree::Body(body) => {
            bodies.push(Body::new(body.form, body.matrix)?);
            Some(Combination::Body(body.number))
        }
        SolidTree::Combined(operation, _, operands) => {
            let operands = operands.iter().map(|operand| combination(operand, bodies));
            Some(Combination::Combined(*operation, operands.collect::<Option<_>>()?))
        }
    }
}

/// The mesh of a form, and the transform from its space.
fn tessellated(form: &Form, segments: u64) -> (Mesh, DMat4) {
    let segments = segments as u32;
    match *form {
        Form::Ball { center, radius } => {
            let place = DMat4::from_translation(center) * DMat4::from_scale(DVec3::splat(radius));
            // Poles of uv lie on the y axis, and u goes from +x toward −z.
            let upright = DMat4::from_cols(DVec4::X, DVec4::NEG_Z, DVec4::Y, DVec4::W);
            (revolution::ball(segments), place * upright)
        }
        Form::Cylinder { radius, z } => (revolution::closed_cylinder(radius, z, segments), DMat4::IDENTITY),
        Form::Cuboid { min, max } => (composite::cuboid(min, max), DMat4::IDENTITY),
        Form::Torus { radius, tube } => (revolution::torus(radius, tube, segments), DMat4::IDENTITY),
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
