//! `[[sphere]]`, `[[mesh]]` and the other shapes: their common keys, and flat shapes.

use glam::{DMat4, DVec3, Vec3};

use super::table::{Groups, Kinds, Table};
use super::value::Value;
use super::{Reader, curve, light, quadric, transform};
use crate::composite;
use crate::error::Result;
use crate::material::Scalar;
use crate::medium::Sides;
use crate::scene::MaterialId;
use crate::shape::{Emission, Geometry, Mesh, Part, Pieces, Shape};

/// The keys of shapes, by kind, in addition to those in [`common`].
pub(super) const KEYS: Kinds = &[
    ("sphere", &["center", "radius", "z_min", "z_max", "phi_max"]),
    ("triangle", &["vertices", "normals", "uvs"]),
    ("quad", &["corner", "edge_u", "edge_v"]),
    ("plane", &["point", "normal", "size"]),
    ("disk", &["center", "normal", "radius", "inner_radius", "phi_max", "height"]),
    ("cylinder", &["from", "to", "radius", "phi_max", "z"]),
    ("cone", &["from", "to", "radius", "tip_radius", "closed", "segments"]),
    ("torus", &["center", "axis", "radius", "tube", "segments"]),
    ("lathe", &["from", "axis", "profile", "smooth", "segments"]),
    ("box", &["min", "max"]),
    ("solid", &["operation", "of", "segments"]),
    ("heightfield", &["file", "size", "height"]),
    ("text", &["text", "font", "size", "depth", "align", "line_spacing"]),
    (
        "mesh",
        &[
            "file",
            "scene",
            "animation",
            "at",
            "variant",
            "camera",
            "lights",
            "positions",
            "triangles",
            "subdivision",
            "normals",
            "uvs",
            "colors",
            "displacement",
            "pieces",
        ],
    ),
    ("patch", &["corners", "positions", "patches", "normals", "uvs"]),
    ("curve", &["points", "width", "profile", "normals", "separate"]),
    ("sphereflake", &["center", "radius", "depth"]),
    ("spheres", &["centers", "radii"]),
];
/// The array of shapes of any kind, which each name by its `type`.
pub(super) const ANY: &str = "shape";
/// Keys of all shapes.
pub(super) const COMMON: &[&str] = &[
    "name",
    "material",
    "medium",
    "sides",
    "emission",
    "power",
    "two_sided",
    "alpha",
    "reverse_orientation",
    "single_sided",
];
/// The keys of all shapes and of transforms.
pub(super) const fn common(_kind: &str) -> Groups {
    &[COMMON, transform::KEYS]
}
/// The keys of the media on both sides of a surface.
pub(super) const SIDES: &[&str] = &["inside", "outside"];
/// Keys of all shapes that are parts of a solid.
pub(super) const OPERAND: &[&str] = &["type", "name", "material", "emission", "power", "two_sided", "alpha"];
/// The keys of `[[instance]]`.
pub(super) const INSTANCE: &[&str] = &["name", "object", "material", "motion"];

/// The keys of a shape's table besides its geometry.
pub(super) struct ShapeAttributes {
    pub(super) name: Option<String>,
    pub(super) material: Option<MaterialId>,
    pub(super) emission: Option<Emission>,
    pub(super) alpha: Option<Scalar>,
}

/// The kinds of shapes.
pub(super) fn kinds() -> Vec<&'static str> {
    KEYS.iter().map(|&(kind, _)| kind).chain([ANY]).collect()
}

impl Reader<'_, '_> {
    /// All shapes in the arrays of a table.
    pub(super) fn shapes(&mut self, table: &Table<'_>) -> Vec<Shape> {
        let mut shapes = Vec::new();
        for &(kind, keys) in KEYS {
            let Some(value) = table.find(kind) else { continue };
            for table in value.tables() {
                table.allow(&[&[keys], common(kind)].concat());
                if let Err(error) = self.shape(kind, &table, &mut shapes) {
                    table.note(error);
                }
            }
        }
        for table in table.find(ANY).into_iter().flat_map(Value::tables) {
            let Some(kind) = table.kind(KEYS, None, common) else { continue };
            if let Err(error) = self.shape(kind, &table, &mut shapes) {
                table.note(error);
            }
        }
        shapes
    }

    /// The media on both sides of a surface.
    fn sides(&self, value: Value<'_>) -> Result<Sides> {
        let table = value.table("`sides`")?;
        table.allow(&[SIDES]);
        let side = |key| table.maybe(key, |value| self.medium_named(value));
        Ok(Sides { inside: side("inside"), outside: side("outside") })
    }

    fn shape(&mut self, kind: &str, table: &Table<'_>, shapes: &mut Vec<Shape>) -> Result<()> {
        let reverse_orientation = table.or("reverse_orientation", false, Value::boolean);
        table.one_of(&["medium", "sides"]);
        let medium = table.maybe("medium", |value| self.medium_named(value));
        let sides = table.maybe("sides", |value| self.sides(value));
        let single_sided = table.maybe("single_sided", Value::boolean);
        for part in self.parts(kind, table)? {
            let material = match medium {
                Some(medium) => self.filled(part.material, medium),
                None => part.material.unwrap_or_else(|| self.default_material()),
            };
            let is_default = part.material.is_none();
            let glow = || self.glows.get(&material).copied().filter(|_| is_default);
            let opacity = || self.opacities.get(&material).copied().filter(|_| is_default);
            shapes.push(Shape {
                name: part.name,
                pieces: part.pieces,
                emission: part.emission.or_else(glow),
                alpha: part.alpha.or_else(opacity),
                reverse_orientation,
                single_sided: single_sided.unwrap_or(part.single_sided),
                sides,
                world_from_object: part.world_from_object,
                ..Shape::new(table.at(), part.geometry, material)
            });
        }
        Ok(())
    }

    /// The parts of a shape at their places, with the look that its table gives them.
    pub(super) fn parts(&mut self, kind: &str, table: &Table<'_>) -> Result<Vec<Part>> {
        let attributes = self.shape_attributes(table);
        let world_from_object = transform::world_from_object(table);
        let mut parts = match (kind, table.find("file")) {
            ("mesh", Some(file)) => self.model_parts(table, file, &world_from_object)?,
            ("solid", _) => self.solid(table, &attributes)?,
            _ => {
                let (geometry, own) = self.geometry(kind, table)?;
                if !(world_from_object * own).is_finite() {
                    return Err(table
                        .error("it is too far away to compute with")
                        .hint("use smaller numbers"));
                }
                vec![Part { world_from_object: own, ..Part::new(None, geometry) }]
            }
        };
        for part in &mut parts {
            part.world_from_object = transform::after(table, &world_from_object, &part.world_from_object);
        }
        self.dress(&attributes, &mut parts);
        if kind == "mesh" {
            self.put_pieces(table, &mut parts);
        }
        Ok(parts)
    }

    pub(super) fn shape_attributes(&mut self, table: &Table<'_>) -> ShapeAttributes {
        ShapeAttributes {
            material: table.maybe("material", |value| self.material_named(value)),
            emission: self.emission(table),
            alpha: table.find("alpha").map(|_| self.share_or(table, "alpha", 1.0)),
            name: light::name(table),
        }
    }

    /// Gives parts the look that a table has for them.
    pub(super) fn dress(&self, attributes: &ShapeAttributes, parts: &mut [Part]) {
        for part in parts {
            if let Some(name) = &attributes.name {
                part.name = Some(name.clone());
                part.pieces = Pieces::default();
            }
            part.material = attributes.material.or(part.material);
            // Emission of the shape has priority over that of its material, and that over that of its file.
            let glow = attributes.material.and_then(|material| self.glows.get(&material).copied());
            part.emission = attributes.emission.or(glow).or(part.emission);
            let opacity = attributes.material.and_then(|material| self.opacities.get(&material).copied());
            part.alpha = attributes.alpha.or(opacity).or(part.alpha);
        }
    }

    /// A geometry, and the transform from its own space.
    fn geometry(&mut self, kind: &str, table: &Table<'_>) -> Result<(Geometry, DMat4)> {
        let geometry = match kind {
            "sphere" => return quadric::sphere_or_part(table),
            "disk" => return quadric::disk(table),
            "cylinder" => return quadric::cylinder(table),
            "cone" => return self.cone(table),
            "torus" => return self.torus(table),
            "lathe" => return self.lathe(table),
            "heightfield" => self.heightfield(table)?,
            "text" => self.text(table)?,
            "quad" => quad(table)?,
            "sphereflake" => self.sphereflake(table)?,
            "patch" if table.has("positions") => self.patches(table)?,
            "patch" => curve::patch(table)?,
            "curve" if table.has("separate") => self.separate_curves(table)?,
            "curve" => curve::curve(table, self.context.limits.elements)?,
            "spheres" => self.spheres(table)?,
            "plane" => {
                let point = table.or("point", DVec3::ZERO, Value::vector);
                let normal = table.or("normal", DVec3::Y, Value::direction);
                let size = table.or("size", 1000.0, Value::positive);
                self.mesh(table, composite::plane(point, normal, size))?
            }
            "box" => {
                let [min, max] = cuboid(table)?;
                self.mesh(table, composite::cuboid(min, max))?
            }
            "triangle" => {
                let example = "[[0, 0, 0], [1, 0, 0], [0, 1, 0]]";
                let vertices = table.need("vertices", example, [Vec3::ZERO; 3], |value| {
                    let [a, b, c] = value.list_of("three points")?;
                    Ok([point(a)?, point(b)?, point(c)?])
                });
                let mut mesh = composite::triangle(vertices);
                self.vertex_data(table, &mut mesh);
                table.sound(&["vertices"])?;
                let [a, b, c] = [0, 1, 2].map(|i| mesh.positions[i].as_dvec3());
                if (b - a).cross(c - a) == DVec3::ZERO {
                    let message = "the triangle has no area: its vertices lie on a line";
                    return Err(table.error_at("vertices", message));
                }
                self.mesh(table, mesh)?
            }
            _ => {
                let mesh = self.inline_mesh(table)?;
                let displacement = self.displacement(table);
                self.mesh(table, Mesh { displacement, ..mesh })?
            }
        };
        Ok((geometry, DMat4::IDENTITY))
    }
}

/// A point or vector that is finite as `f32`.
pub(super) fn point(value: Value<'_>) -> Result<Vec3> {
    value.singles("three numbers, [x, y, z]").map(Vec3::from_array)
}

/// The two corners of a box.
pub(super) fn cuboid(table: &Table<'_>) -> Result<[DVec3; 2]> {
    let min = table.need("min", "[-1, -1, -1]", DVec3::NEG_ONE, Value::vector);
    let max = table.need("max", "[1, 1, 1]", DVec3::ONE, Value::vector);
    table.sound(&["min", "max"])?;
    if min.cmpge(max).any() {
        return Err(table
            .error_at("max", format!("`max` {max} is not beyond `min` {min} along every axis"))
            .hint("a box without thickness is a quad"));
    }
    Ok([min, max])
}

/// A quad, of a shape or a light.
pub(super) fn quad(table: &Table<'_>) -> Result<Geometry> {
    let corner = table.need("corner", "[0, 0, 0]", DVec3::ZERO, Value::vector);
    let edge_u = table.need("edge_u", "[1, 0, 0]", DVec3::X, Value::direction);
    let edge_v = table.need("edge_v", "[0, 1, 0]", DVec3::Y, Value::direction);
    table.sound(&["edge_u", "edge_v"])?;
    if edge_u.normalize().cross(edge_v.normalize()).length_squared() < 1e-24 {
        return Err(table.error_at("edge_v", "`edge_v` is parallel to `edge_u`: the quad has no area"));
    }
    Ok(Geometry::Quad { corner, edge_u, edge_v })
}
