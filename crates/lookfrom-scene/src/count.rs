//! Counts of shapes, triangles, lights and other parts of a scene.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::light::LightKind;
use crate::scene::Scene;
use crate::shape::Geometry;

/// Counts of a scene's contents. Shapes of an object count once, whatever the number of its instances.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Counts {
    /// Shapes by kind; kinds that do not occur are left out.
    pub shapes: BTreeMap<&'static str, u64>,
    /// Triangles of meshes, once per shape that uses the mesh, and two per quad.
    pub triangles: u64,
    /// Vertices of meshes, as they are stored.
    pub vertices: u64,
    /// Spheres, including those of clouds.
    pub spheres: u64,
    /// Groups of shapes, which instances place.
    pub objects: u64,
    /// Instances of objects.
    pub instances: u64,
    /// Number of materials.
    pub materials: u64,
    /// Number of media.
    pub media: u64,
    /// Number of textures.
    pub textures: u64,
    /// Images used by textures and environments.
    pub images: Vec<ImageCount>,
    /// Lights by kind; shapes that emit light are "emissive shape".
    pub lights: BTreeMap<&'static str, u64>,
}

/// An image that a scene uses.
#[derive(Clone, Debug, Serialize)]
pub struct ImageCount {
    /// The name of its file, or its name in its file.
    pub name: String,
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
}

impl Counts {
    /// The counts of a scene.
    pub fn of(scene: &Scene) -> Self {
        let mut counts = Self {
            vertices: scene.meshes.iter().map(|mesh| mesh.positions.len() as u64).sum(),
            objects: scene.objects.len() as u64,
            instances: scene.instances.len() as u64,
            materials: scene.materials.len() as u64,
            media: scene.media.len() as u64,
            textures: scene.textures.len() as u64,
            images: scene
                .images
                .iter()
                .map(|image| ImageCount {
                    name: image.name.clone(),
                    width: image.width,
                    height: image.height,
                })
                .collect(),
            ..Self::default()
        };
        let in_objects = scene.objects.iter().flat_map(|object| &object.shapes);
        for shape in scene.shapes.iter().chain(in_objects) {
            let (kind, triangles, spheres) = match &shape.geometry {
                Geometry::Sphere(_) => ("sphere", 0, 1),
                Geometry::Spheres(spheres) => ("cloud of spheres", 0, spheres.len()),
                Geometry::Quad { .. } => ("quad", 2, 0),
                Geometry::Disk { .. } => ("disk", 0, 0),
                Geometry::PartialSphere { .. } => ("partial sphere", 0, 0),
                Geometry::PartialDisk { .. } => ("partial disk", 0, 0),
                Geometry::Cylinder { .. } => ("cylinder", 0, 0),
                Geometry::Torus { .. } => ("torus", 0, 0),
                Geometry::SolidSurface { .. } => ("surface of a solid", 0, 0),
                Geometry::Bilinear(_) => ("bilinear mesh", 0, 0),
                Geometry::Curves(_) => ("curves", 0, 0),
                Geometry::Mesh(id) => ("mesh", scene.meshes[id.index()].triangles.len(), 0),
            };
            *counts.shapes.entry(kind).or_default() += 1;
            counts.triangles += triangles as u64;
            counts.spheres += spheres as u64;
            if shape.emission.is_some() {
                *counts.lights.entry("emissive shape").or_default() += 1;
            }
        }
        for light in &scene.lights {
            let kind = match light.kind {
                LightKind::Environment { illuminates: false, .. } => "backdrop",
                _ => light.kind.word(),
            };
            *counts.lights.entry(kind).or_default() += 1;
        }
        counts
    }
}
