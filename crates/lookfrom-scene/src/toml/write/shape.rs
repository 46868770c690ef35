//! Shapes: their geometry, their look and their place.

use glam::{DMat4, DVec3, Vec2, Vec3};

use super::Writer;
use super::cannot;
use super::names::spoken;
use super::placing::{center_and_axis, put_transform, same_bits};
use super::text::{Fields, Item};
use crate::composite::{sphereflake, sphereflake_count};
use crate::error::Result;
use crate::material::Scalar;
use crate::npy;
use crate::shape::{Emission, Geometry, Patches, Piece, Profile, Shape, Sphere, Strand};
use crate::toml::curve::PROFILES;
use crate::toml::quadric::{DEEPEST_FLAKE, along};
use crate::toml::word_of;

/// The most elements of a shape that are written into the document; more are arrays of NumPy.
const MOST_INLINE: usize = 16;

impl Writer<'_> {
    /// The kind of a shape and its table, or those of all surfaces of a solid.
    pub(super) fn shape(&mut self, surfaces: &[Shape]) -> Result<(&'static str, Fields)> {
        let shape = &surfaces[0];
        let Shape {
            name: _,
            pieces,
            at: _,
            geometry,
            sides,
            reverse_orientation,
            single_sided,
            world_from_object,
            material: _,
            emission: _,
            alpha: _,
        } = shape;
        let mut fields = Fields::default();
        let (kind, is_placed) = match geometry {
            Geometry::SolidSurface { solid, .. } => {
                self.put_solid(&mut fields, solid, surfaces)?;
                ("solid", false)
            }
            _ => {
                put_name(&mut fields, shape);
                let placed = self.geometry(&mut fields, geometry, world_from_object)?;
                if !pieces.is_empty() {
                    fields.put("pieces", Item::list(pieces.iter().map(piece)));
                }
                self.put_look(&mut fields, shape)?;
                placed
            }
        };
        if let Some(sides) = sides {
            let mut table = Fields::default();
            for (key, medium) in [("inside", sides.inside), ("outside", sides.outside)] {
                if let Some(medium) = medium {
                    table.put(key, self.media.of(medium.index()));
                }
            }
            fields.put("sides", table);
        }
        fields.put_unless("reverse_orientation", *reverse_orientation, false);
        fields.put_unless("single_sided", *single_sided, false);
        if !is_placed {
            put_transform(&mut fields, world_from_object);
        }
        Ok((kind, fields))
    }

    /// Puts the material, emission and alpha of a shape.
    pub(super) fn put_look(&mut self, fields: &mut Fields, shape: &Shape) -> Result<()> {
        fields.put("material", self.materials.of(shape.material.index()));
        if let Some(Emission { radiance, power, two_sided }) = &shape.emission {
            self.put_light(fields, ["emission", "power"], *radiance, power)?;
            fields.put_unless("two_sided", *two_sided, false);
        }
        if let Some(alpha) = shape.alpha {
            fields.put("alpha", self.scalar(alpha));
        }
        Ok(())
    }

    /// Puts a geometry; whether its keys give the place of the shape, too.
    pub(super) fn geometry(
        &mut self,
        fields: &mut Fields,
        geometry: &Geometry,
        matrix: &DMat4,
    ) -> Result<(&'static str, bool)> {
        Ok(match geometry {
            Geometry::Sphere(Sphere { center, radius }) => {
                fields.put_unless("center", *center, DVec3::ZERO);
                fields.put_unless("radius", *radius, 1.0);
                ("sphere", false)
            }
            Geometry::Spheres(spheres) => (self.spheres(fields, spheres), false),
            Geometry::Quad { corner, edge_u, edge_v } => {
                fields.put("corner", *corner);
                fields.put("edge_u", *edge_u);
                fields.put("edge_v", *edge_v);
                ("quad", false)
            }
            Geometry::Disk { center, normal, radius } => {
                fields.put("center", *center);
                fields.put("normal", *normal);
                fields.put("radius", *radius);
                ("disk", false)
            }
            Geometry::Mesh(id) => {
                self.mesh(fields, *id);
                ("mesh", false)
            }
            Geometry::PartialSphere { radius, z: [low, high], phi_max } => {
                let center = matrix.w_axis.truncate();
                let is_placed = same_bits(matrix, &(DMat4::IDENTITY * DMat4::from_translation(center)));
                if is_placed {
                    fields.put_unless("center", center, DVec3::ZERO);
                }
                fields.put_unless("radius", *radius, 1.0);
                fields.put_unless("z_min", *low, -radius);
                fields.put_unless("z_max", *high, *radius);
                // One of these keys makes it a part.
                if *phi_max != 360.0 || (*low, *high) == (-radius, *radius) {
                    fields.put("phi_max", *phi_max);
                }
                ("sphere", is_placed)
            }
            Geometry::PartialDisk { height, radius, inner_radius, phi_max } => {
                let placed = center_and_axis(matrix);
                let (center, normal) = placed.unwrap_or((DVec3::ZERO, DVec3::Z));
                fields.put("center", center);
                fields.put("normal", normal);
                fields.put("radius", *radius);
                fields.put_unless("height", *height, 0.0);
                fields.put_unless("inner_radius", *inner_radius, 0.0);
                if *phi_max != 360.0 || (*height, *inner_radius) == (0.0, 0.0) {
                    fields.put("phi_max", *phi_max);
                }
                ("disk", placed.is_some())
            }
            Geometry::Cylinder { radius, z: [low, high], phi_max } => {
                let from = matrix.w_axis.truncate();
                let to = from + matrix.z_axis.truncate() * *high;
                let length = (to - from).length();
                let own = along(from, (to - from) / length);
                let is_placed = *low == 0.0 && length == *high && same_bits(matrix, &(DMat4::IDENTITY * own));
                match is_placed {
                    true => {
                        fields.put("from", from);
                        fields.put("to", to);
                    }
                    false => fields.put("z", [*low, *high]),
                }
                fields.put("radius", *radius);
                fields.put_unless("phi_max", *phi_max, 360.0);
                ("cylinder", is_placed)
            }
            Geometry::Torus { radius, tube } => {
                let placed = center_and_axis(matrix);
                let (center, axis) = placed.unwrap_or((DVec3::ZERO, DVec3::Z));
                fields.put_unless("center", center, DVec3::ZERO);
                fields.put_unless("axis", axis, DVec3::Y);
                fields.put("radius", *radius);
                fields.put("tube", *tube);
                ("torus", placed.is_some())
            }
            Geometry::SolidSurface { .. } => return Err(cannot("a surface of a solid without the solid")),
            Geometry::Bilinear(patches) => {
                self.patches(fields, patches);
                ("patch", false)
            }
            Geometry::Curves(strands) => {
                self.curves(fields, strands)?;
                ("curve", false)
            }
        })
    }

    fn spheres(&mut self, fields: &mut Fields, spheres: &[Sphere]) -> &'static str {
        let depth =
            (0..=DEEPEST_FLAKE as u32).find(|depth| sphereflake_count(*depth) == spheres.len() as u64);
        if let (Some(depth), Some(&Sphere { center, radius })) = (depth, spheres.first())
            && sphereflake(center, radius, depth) == spheres
        {
            fields.put("center", center);
            fields.put("radius", radius);
            fields.put("depth", depth);
            return "sphereflake";
        }
        let centers = spheres.iter().map(|sphere| sphere.center.to_array());
        let are_equal = spheres.windows(2).all(|pair| pair[0].radius == pair[1].radius);
        let radii = spheres.iter().map(|sphere| sphere.radius);
        if spheres.len() <= MOST_INLINE {
            fields.put("centers", Item::list(centers));
        } else {
            let bytes = npy::write_f64(&[spheres.len(), 3], centers.flatten());
            fields.put("centers", self.array("centers", bytes));
        }
        match spheres.first() {
            Some(first) if are_equal => fields.put("radii", first.radius),
            _ if spheres.len() <= MOST_INLINE => fields.put("radii", Item::list(radii)),
            _ => {
                let bytes = npy::write_f64(&[spheres.len(), 1], radii);
                fields.put("radii", self.array("radii", bytes));
            }
        }
        "spheres"
    }

    fn patches(&mut self, fields: &mut Fields, patches: &Patches) {
        let Patches { positions, patches, normals, uvs } = patches;
        let vectors = |writer: &mut Self, fields: &mut Fields, key: &str, of: &[Vec3]| match of {
            [] => {}
            few if few.len() <= MOST_INLINE => fields.put(key, Item::list(few.iter().copied())),
            many => fields.put(key, writer.vectors(key, many)),
        };
        // The one patch of a document has no area of its own to check here.
        vectors(self, fields, "positions", positions);
        if positions.is_empty() {
            fields.put("positions", Item::List(Vec::new()));
        }
        match patches.len() <= MOST_INLINE {
            true => fields.put("patches", Item::list(patches.iter().copied())),
            false => {
                let bytes = npy::write_u32(&[patches.len(), 4], patches.as_flattened().iter().copied());
                fields.put("patches", self.array("patches", bytes));
            }
        }
        vectors(self, fields, "normals", normals);
        match uvs.len() {
            0 => {}
            few if few <= MOST_INLINE => fields.put("uvs", Item::list(uvs.iter().copied())),
            many => {
                let bytes = npy::write_f32(&[many, 2], uvs.iter().flat_map(Vec2::to_array));
                fields.put("uvs", self.array("uvs", bytes));
            }
        }
    }

    fn curves(&mut self, fields: &mut Fields, strands: &[Strand]) -> Result<()> {
        let profile = strands.first().map_or(Profile::Flat, |strand| strand.profile);
        let word = |profile: &Profile| match profile {
            Profile::Flat | Profile::Cylinder | Profile::PbrtCylinder => word_of(PROFILES, profile),
            Profile::Ribbon(_) => "ribbon",
        };
        if strands.iter().any(|strand| word(&strand.profile) != word(&profile)) {
            return Err(cannot("curves of several profiles in one shape"));
        }
        let ends: Vec<[Vec3; 2]> = strands
            .iter()
            .filter_map(|strand| match strand.profile {
                Profile::Ribbon(normals) => Some(normals),
                Profile::Flat | Profile::Cylinder | Profile::PbrtCylinder => None,
            })
            .collect();
        let is_chain = strands.windows(2).all(|pair| {
            let [before, after] = [&pair[0], &pair[1]];
            before.points[3] == after.points[0] && before.width[1] == after.width[0]
        }) && ends.windows(2).all(|pair| pair[0][1] == pair[1][0]);
        let is_short = is_chain && !strands.is_empty() && strands.len() <= MOST_INLINE;
        let mut points: Vec<Vec3> = strands.iter().flat_map(|strand| strand.points).collect();
        let mut widths: Vec<f32> = strands.iter().flat_map(|strand| strand.width).collect();
        let mut normals: Vec<Vec3> = ends.into_iter().flatten().collect();
        if is_short {
            // Curves that follow one another share their ends.
            let places = |length: usize, each: usize| (0..length).filter(move |k| *k < each || k % each != 0);
            points = places(points.len(), 4).map(|place| points[place]).collect();
            widths = places(widths.len(), 2).map(|place| widths[place]).collect();
            normals = places(normals.len(), 2).map(|place| normals[place]).collect();
            fields.put("points", Item::list(points));
        } else {
            fields.put("points", self.vectors("points", &points));
        }
        match widths.first() {
            Some(first) if widths.iter().all(|width| width == first) => fields.put("width", *first),
            _ if is_short => fields.put("width", Item::list(widths)),
            _ => {
                let bytes = npy::write_f32(&[widths.len(), 1], widths.iter().copied());
                fields.put("width", self.array("widths", bytes));
            }
        }
        if !matches!(profile, Profile::Flat) {
            fields.put("profile", word(&profile));
        }
        if !normals.is_empty() {
            let exact = |normal: &Vec3| Item::List(normal.to_array().map(Item::exact).to_vec());
            match is_short {
                true => fields.put("normals", Item::List(normals.iter().map(exact).collect())),
                false => fields.put("normals", self.vectors("normals", &normals)),
            }
        }
        if !is_short {
            fields.put("separate", true);
        }
        Ok(())
    }

    /// The table of an array of vectors.
    fn vectors(&mut self, name: &str, vectors: &[Vec3]) -> Fields {
        let bytes = npy::write_f32(&[vectors.len(), 3], vectors.iter().flat_map(Vec3::to_array));
        self.array(name, bytes)
    }

    /// The table of an array of NumPy, in a file of its own.
    pub(super) fn array(&mut self, name: &str, bytes: Vec<u8>) -> Fields {
        Fields::one("npy", self.file(name, "npy", bytes))
    }

    /// The displacement of a mesh.
    pub(super) fn put_displacement(&self, fields: &mut Fields, displacement: Option<Scalar>) {
        if let Some(height) = displacement {
            fields.put("displacement", self.scalar(height));
        }
    }
}

/// Puts the name of a shape, if it has one.
pub(super) fn put_name(fields: &mut Fields, shape: &Shape) {
    if let Some(name) = &shape.name {
        fields.put("name", spoken("shape", name));
    }
}

/// The table of a piece.
fn piece(Piece { first, name }: &Piece) -> Fields {
    let mut fields = Fields::default();
    if let Some(name) = name {
        fields.put("name", spoken("piece", name));
    }
    fields.put("first", *first);
    fields
}
