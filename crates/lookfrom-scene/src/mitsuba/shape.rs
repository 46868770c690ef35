//! Shapes, groups of them, and instances.

use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;

use glam::{DMat4, DVec3, Vec2, Vec3, Vec4};

use super::Reader;
use super::bsdf::Surface;
use super::plugin::Plugin;
use super::serialized;
use super::xml::blame;
use super::{Attribute, Slots};
use crate::error::{Error, ErrorKind, Location, Result};
use crate::material::{BumpMapping, Color, MaterialKind, Scalar};
use crate::model;
use crate::scene::{Instance, MeshId, Object, ObjectId, Scene};
use crate::shape::{Emission, Geometry, Mesh, Part, Shape};
use crate::texture::TextureKind;

const KINDS: &[&str] = &[
    "bsplinecurve",
    "cube",
    "cylinder",
    "disk",
    "instance",
    "linearcurve",
    "merge",
    "obj",
    "ply",
    "rectangle",
    "sdfgrid",
    "serialized",
    "shapegroup",
    "sphere",
];

/// Meshes of a model, each with the map from its positions to the model's.
pub(super) type PlacedMeshes = Vec<(MeshId, DMat4)>;

/// A model that has been read already.
#[derive(PartialEq, Eq, Hash)]
pub(super) struct MeshKey {
    path: PathBuf,
    /// The number of the mesh in its file.
    index: u32,
    /// Whether its normals are those of faces.
    has_flat_faces: bool,
    /// Whether v is turned around: up in files, and so here.
    turns_v: bool,
    /// The attributes that it has.
    attributes: Vec<Attribute>,
}

impl Reader<'_, '_> {
    /// Adds a shape, or an instance, to the world. A group is there for its instances.
    pub(super) fn shape(&mut self, plugin: &Rc<Plugin>) -> Result<()> {
        match &*plugin.kind {
            "shapegroup" => self.group(plugin).map(drop),
            "instance" => self.instance(plugin),
            "merge" => {
                for (_, part) in plugin.parts("shape", &self.ids)? {
                    self.within(&part, |reader| reader.shape(&part))?;
                }
                Ok(())
            }
            _ => {
                let shapes = self.shapes(plugin)?;
                self.scene.shapes.extend(shapes);
                Ok(())
            }
        }
    }

    fn group(&mut self, plugin: &Rc<Plugin>) -> Result<ObjectId> {
        if let Some(&id) = self.groups.get(&Rc::as_ptr(plugin)) {
            return Ok(id);
        }
        let mut shapes = Vec::new();
        for (_, part) in plugin.parts("shape", &self.ids)? {
            if matches!(&*part.kind, "shapegroup" | "instance") {
                let message = format!("a {} in a shapegroup is not supported", part.title());
                return Err(Error::new(ErrorKind::Unsupported, &part.at, message));
            }
            let own = self.shapes(&part)?;
            if own.iter().any(|shape| shape.emission.is_some()) {
                let error = Error::invalid(&part.at, "a shape in a shapegroup may not emit light");
                return Err(error.hint("write it outside of the group"));
            }
            shapes.extend(own);
        }
        let id = ObjectId(self.scene.objects.len() as u32);
        let name = plugin.id.clone().unwrap_or_else(|| format!("group {}", id.0 + 1));
        self.scene.objects.push(Object { name, at: plugin.at.clone(), shapes });
        self.groups.insert(Rc::as_ptr(plugin), id);
        Ok(id)
    }

    fn instance(&mut self, plugin: &Plugin) -> Result<()> {
        let world_from_object = plugin.to_world()?;
        let group = plugin.part("shape", &self.ids)?.filter(|group| group.kind == "shapegroup");
        let Some(group) = group else {
            let error = Error::invalid(&plugin.at, "this instance has no shapegroup");
            return Err(error.hint("write <ref id=\"…\"/> with the id of one"));
        };
        let object = self.group(&group)?;
        let at = plugin.at.clone();
        let name = plugin.id.clone().map(Arc::new);
        self.scene.instances.push(Instance { name, ..Instance::new(at, object, world_from_object) });
        Ok(())
    }

    /// The shapes that a plugin stands for: one, or as many as a model has parts.
    fn shapes(&mut self, plugin: &Rc<Plugin>) -> Result<Vec<Shape>> {
        if !KINDS.contains(&&*plugin.kind) {
            return Err(plugin.unsupported(KINDS));
        }
        let to_world = plugin.to_world()?;
        let flip = plugin.boolean("flip_normals", false)?;
        let mut textured = Vec::new();
        for class in ["emitter", "bsdf"] {
            textured.extend(plugin.peek(class, &self.ids)?);
        }
        let attributes = self.attributes(textured)?;
        let geometries = self.geometries(plugin, attributes)?;
        let is_made_of_faces = match &*plugin.kind {
            "obj" | "ply" | "sdfgrid" | "serialized" => !self.has_own_normals(&geometries),
            _ => false,
        };
        self.use_disk(plugin.kind == "disk");
        let emission = match plugin.part("emitter", &self.ids)? {
            Some(emitter) => self.emission(&emitter)?,
            None => None,
        };
        let surface = match plugin.part("bsdf", &self.ids)? {
            Some(bsdf) => self.surface(&bsdf)?,
            None if emission.is_some() => Surface::opaque(Self::BLACK),
            None => Surface::opaque(Self::DEFAULT),
        };
        let emission = emission.map(|emission| self.unmasked(plugin, emission, surface.alpha));
        let sides = self.sides(plugin)?;
        if plugin.kind == "disk" && self.has_grain(surface) {
            let message =
                "the grain and normal maps of disks lie along the angle, in Mitsuba along the radius";
            self.warn_once(&plugin.at, message);
        }
        if self.is_hair(surface) && !matches!(&*plugin.kind, "bsplinecurve" | "linearcurve") {
            let message = "hair on what is no curve lies along u, and v is the place across it; in Mitsuba its normal tells that place";
            self.warn_once(&plugin.at, message);
        }
        let shape = |(geometry, own): (Geometry, DMat4)| Shape {
            name: plugin.id.clone(),
            emission,
            alpha: surface.alpha,
            sides,
            // Mitsuba has normals of faces, and those made of them, by the order of corners in the world.
            reverse_orientation: flip != (is_made_of_faces && to_world.determinant() < 0.0),
            world_from_object: to_world * own,
            ..Shape::new(plugin.at.clone(), geometry, surface.material)
        };
        Ok(geometries.into_iter().map(shape).collect())
    }

    /// Emission of a masked surface, over its opacity: that multiplies emission here, and not in Mitsuba.
    fn unmasked(&mut self, plugin: &Plugin, mut emission: Emission, alpha: Option<Scalar>) -> Emission {
        match alpha {
            Some(Scalar::Value(alpha)) if alpha > 0.0 => emission.power.scale /= alpha,
            Some(alpha @ Scalar::Texture(_)) => {
                let inverse = TextureKind::Quotient { a: Scalar::Value(1.0), b: alpha };
                let by = Scalar::Texture(self.push_texture(plugin, inverse));
                let kind = TextureKind::Scale { color: emission.radiance, by };
                emission.radiance = Color::Texture(self.push_texture(plugin, kind));
            }
            _ => {}
        }
        emission
    }

    /// Whether meshes have the normals of their file.
    fn has_own_normals(&self, geometries: &[(Geometry, DMat4)]) -> bool {
        let is_own =
            |geometry: &Geometry| matches!(geometry, Geometry::Mesh(id) if self.own_normals.contains(id));
        geometries.iter().any(|(geometry, _)| is_own(geometry))
    }

    /// Whether a surface depends on the direction of u; heights do not.
    fn has_grain(&self, surface: Surface) -> bool {
        let material = &self.scene.materials[surface.material.index()];
        material.has_grain() && !matches!(material.bump_mapping, BumpMapping::Bump(_))
    }

    /// Whether a surface is that of fibres.
    fn is_hair(&self, surface: Surface) -> bool {
        matches!(self.scene.materials[surface.material.index()].kind, MaterialKind::Hair(_))
    }

    /// Geometries with their transforms to the space of the shape.
    fn geometries(&mut self, plugin: &Plugin, attributes: Vec<Attribute>) -> Result<Vec<(Geometry, DMat4)>> {
        let one = |geometry, matrix| Ok(vec![(geometry, matrix)]);
        match &*plugin.kind {
            "sphere" => {
                let radius = plugin.positive("radius", 1.0)?;
                let center = plugin.vector("center")?.unwrap_or(DVec3::ZERO);
                let sphere = Geometry::PartialSphere { radius, z: [-radius, radius], phi_max: 360.0 };
                one(sphere, DMat4::from_translation(center))
            }
            "disk" => {
                let disk =
                    Geometry::PartialDisk { height: 0.0, radius: 1.0, inner_radius: 0.0, phi_max: 360.0 };
                one(disk, DMat4::IDENTITY)
            }
            "cylinder" => {
                let radius = plugin.positive("radius", 1.0)?;
                let p0 = plugin.vector("p0")?.unwrap_or(DVec3::ZERO);
                let p1 = plugin.vector("p1")?.unwrap_or(DVec3::Z);
                let length = (p1 - p0).length();
                let Some(axis) = (p1 - p0).try_normalize() else {
                    return Err(plugin.refuse("p1", "another point than `p0`"));
                };
                let (x, y) = axis.any_orthonormal_pair();
                // v runs from p1 to p0.
                let frame =
                    DMat4::from_cols(x.extend(0.0), y.extend(0.0), (-axis).extend(0.0), p1.extend(1.0));
                one(Geometry::Cylinder { radius, z: [0.0, length], phi_max: 360.0 }, frame)
            }
            "rectangle" => {
                let mesh = rectangle();
                one(self.push_mesh(mesh), DMat4::IDENTITY)
            }
            "cube" => {
                let mesh = cube();
                one(self.push_mesh(mesh), DMat4::IDENTITY)
            }
            "sdfgrid" => {
                let mut mesh = self.sdf_surface(plugin)?;
                mesh.normals = vertex_normals(&mesh);
                // It has the texture coordinates (0, 0) everywhere in Mitsuba.
                mesh.uvs = vec![Vec2::Y; mesh.positions.len()];
                one(self.push_mesh(mesh), DMat4::IDENTITY)
            }
            "bsplinecurve" | "linearcurve" => one(self.curves(plugin)?, DMat4::IDENTITY),
            _ => {
                let (path, at) = self.file(plugin)?;
                let has_flat_faces = plugin.boolean("face_normals", false)?;
                let turns_v = plugin.boolean("flip_tex_coords", plugin.kind == "obj")?;
                let index = match &*plugin.kind {
                    "serialized" => plugin.integer("shape_index", 0, 0, i64::from(u32::MAX))? as u32,
                    _ => 0,
                };
                let key = MeshKey { path, index, has_flat_faces, turns_v, attributes };
                let (meshes, slots) = self.model(&plugin.kind, key, &at)?;
                self.use_slots(slots);
                Ok(meshes.into_iter().map(|(id, own)| (Geometry::Mesh(id), own)).collect())
            }
        }
    }

    fn push_mesh(&mut self, mesh: Mesh) -> Geometry {
        Geometry::Mesh(self.add_mesh(mesh))
    }

    fn add_mesh(&mut self, mesh: Mesh) -> MeshId {
        self.scene.meshes.push(mesh);
        MeshId(self.scene.meshes.len() as u32 - 1)
    }

    /// The meshes of a model file and where they are in its space, without its materials.
    fn model(&mut self, kind: &str, key: MeshKey, at: &Location) -> Result<(PlacedMeshes, Slots)> {
        if let Some(known) = self.meshes.get(&key) {
            return Ok(known.clone());
        }
        let mut alone = Scene::default();
        let parts = match kind {
            "serialized" => {
                let mesh =
                    serialized::read(&key.path, key.index, self.context).map_err(|error| blame(error, at))?;
                alone.meshes.push(mesh);
                vec![Part::new(None, Geometry::Mesh(MeshId(0)))]
            }
            _ => {
                model::read_geometry(&key.path, self.context, &mut alone).map_err(|error| blame(error, at))?
            }
        };
        let MeshKey { has_flat_faces, turns_v, .. } = key;
        let (mut meshes, mut slots) = (Vec::new(), Vec::new());
        for part in parts {
            let Geometry::Mesh(id) = part.geometry else {
                self.warn_once(at, "points and lines of models are left out, as in Mitsuba");
                continue;
            };
            let mut mesh = std::mem::take(&mut alone.meshes[id.index()]);
            let has_own_normals = !has_flat_faces && !mesh.normals.is_empty();
            if has_flat_faces {
                mesh.normals.clear();
            } else if mesh.normals.is_empty() {
                mesh.normals = vertex_normals(&mesh);
                self.context.keep(size_of_val(&*mesh.normals) as u64, "normals of a mesh", at)?;
            }
            // v runs down in Mitsuba.
            if !turns_v {
                mesh.uvs.iter_mut().for_each(|uv| uv.y = 1.0 - uv.y);
            }
            if kind == "ply" && !key.attributes.is_empty() {
                slots = self.add_attributes(&mut mesh, (&key.path, at), &key.attributes)?;
            }
            let id = self.add_mesh(mesh);
            if has_own_normals {
                self.own_normals.insert(id);
            }
            meshes.push((id, part.world_from_object));
        }
        self.meshes.insert(key, (meshes.clone(), slots.clone()));
        Ok((meshes, slots))
    }

    /// Has textures show the attributes of a mesh where it has them.
    fn use_slots(&mut self, slots: Slots) {
        if self.slots != slots {
            self.slots = slots;
            self.forget_surfaces();
        }
    }

    /// Has textures lie as on disks, or as on other shapes.
    fn use_disk(&mut self, is_on_disk: bool) {
        if self.is_on_disk != is_on_disk {
            self.is_on_disk = is_on_disk;
            self.forget_surfaces();
        }
    }

    fn forget_surfaces(&mut self) {
        self.surfaces.clear();
        self.textures.clear();
    }
}

/// Normals at vertices: those of faces, weighted by the angle at the vertex (Thürmer & Wüthrich 1998); zero where there is none.
fn vertex_normals(mesh: &Mesh) -> Vec<Vec3> {
    let mut normals = vec![DVec3::ZERO; mesh.positions.len()];
    for triangle in &mesh.triangles {
        let corners = triangle.map(|vertex| mesh.positions[vertex as usize].as_dvec3());
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
        for (index, &vertex) in triangle.iter().enumerate() {
            let side = |other: usize| (corners[(index + other) % 3] - corners[index]).normalize_or_zero();
            let angle = libm::acos(side(1).dot(side(2)).clamp(-1.0, 1.0));
            normals[vertex as usize] += normal * angle;
        }
    }
    normals.into_iter().map(|normal| normal.normalize_or_zero().as_vec3()).collect()
}

/// The square from −1 to 1 that faces +z.
fn rectangle() -> Mesh {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(Vec2::from);
    Mesh {
        name: "rectangle".into(),
        positions: corners.map(|corner| corner.extend(0.0)).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        uvs: corners.map(|corner| Vec2::new(0.5 + 0.5 * corner.x, 0.5 - 0.5 * corner.y)).to_vec(),
        // The frame of normal maps is right-handed.
        tangents: vec![Vec4::new(1.0, 0.0, 0.0, 1.0); 4],
        ..Mesh::default()
    }
}

/// The cube from −1 to 1, whose faces have the picture upright along their first edge.
fn cube() -> Mesh {
    // Of each face the corner at uv (0, 0), and its edges along u and v.
    const FACES: [[[f32; 3]; 3]; 6] = [
        [[1., -1., -1.], [0., 0., 2.], [-2., 0., 0.]],
        [[1., 1., -1.], [-2., 0., 0.], [0., 0., 2.]],
        [[1., -1., -1.], [0., 2., 0.], [0., 0., 2.]],
        [[1., -1., 1.], [0., 2., 0.], [-2., 0., 0.]],
        [[-1., -1., 1.], [0., 2., 0.], [0., 0., -2.]],
        [[1., 1., -1.], [0., -2., 0.], [-2., 0., 0.]],
    ];
    let mut mesh = Mesh { name: "cube".into(), ..Mesh::default() };
    for [corner, u, v] in FACES.map(|face| face.map(Vec3::from)) {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([corner, corner + u, corner + u + v, corner + v]);
        mesh.uvs.extend([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Vec2::from));
        mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubes_and_rectangles_face_outward_with_upright_coordinates() {
        for mesh in [cube(), rectangle()] {
            for triangle in &mesh.triangles {
                let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
                let normal = (b - a).cross(c - a);
                let outward = if mesh.triangles.len() == 2 { Vec3::Z } else { a + b + c };
                assert!(normal.dot(outward) > 0.0, "{} {triangle:?}", mesh.name);
            }
        }
    }

    #[test]
    fn normals_at_vertices_do_not_depend_on_the_triangulation() {
        let corners = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.], [0., 0., 1.], [1., 0., 1.]];
        let with = |triangles: Vec<[u32; 3]>| {
            let positions = corners.map(Vec3::from).to_vec();
            vertex_normals(&Mesh { positions, triangles, ..Mesh::default() })
        };
        let one = with(vec![[0, 1, 2], [0, 2, 3], [0, 5, 1], [0, 4, 5]]);
        let other = with(vec![[0, 1, 3], [1, 2, 3], [0, 4, 1], [4, 5, 1]]);
        for (one, other) in one.iter().zip(&other) {
            assert!((*one - *other).length() < 1e-6, "{one} {other}");
        }
        assert!((one[0] - Vec3::new(0.0, 1.0, 1.0).normalize()).length() < 1e-6);
    }
}
