//! The scene description: plain, editable data in arenas, with names and source locations. The crate `lookfrom` compiles it
//! to a `World` for rendering.
//!
//! Units: lengths are the scene's own; angles are in degrees; colours are linear Rec. 709 (sRGB primaries), unbounded above.

use std::sync::Arc;

use glam::{DMat4, DVec3};

use crate::camera::Camera;
use crate::contents::Contents;
use crate::error::Location;
use crate::image::Image;
use crate::light::Light;
use crate::material::Material;
use crate::medium::Medium;
use crate::motion::Motion;
use crate::settings::{ImageSettings, RenderSettings};
use crate::shape::{Mesh, Shape};
use crate::spectrum::Curve;
use crate::texture::Texture;

macro_rules! ids {
    ($($(#[$doc:meta])* $name:ident)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(pub u32);
        impl $name {
            /// The index into its arena.
            pub fn index(self) -> usize { self.0 as usize }
        }
    )*};
}

ids! {
    /// Index into [`Scene::materials`].
    MaterialId
    /// Index into [`Scene::textures`].
    TextureId
    /// Index into [`Scene::images`].
    ImageId
    /// Index into [`Scene::curves`].
    CurveId
    /// Index into [`Scene::media`].
    MediumId
    /// Index into [`Scene::meshes`].
    MeshId
    /// Index into [`Scene::objects`].
    ObjectId
}

/// A scene as it was written.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Whether the file is complete, so that no light is added automatically: a scene of pbrt without lights is black.
    pub is_complete: bool,
    /// The format of the file that it was read from.
    pub source_format: SourceFormat,
    /// The use of vertex normals.
    pub vertex_normals: VertexNormals,
    /// Whether z is up by the custom of its format, not y: of STL and HAIR files, without a camera that says so.
    pub z_is_up: bool,
    /// The animations, variants, cameras and scenes of the file.
    pub contents: Contents,
    /// The camera; `None` if the file has none: then the scene is framed by its bounds.
    pub camera: Option<Camera>,
    /// Resolution, filter, sensor and tone mapping.
    pub image: ImageSettings,
    /// The integrator and its settings.
    pub render: RenderSettings,
    /// Materials of surfaces.
    pub materials: Vec<Material>,
    /// Textures of materials.
    pub textures: Vec<Texture>,
    /// Participating media.
    pub media: Vec<Medium>,
    /// Spectra, shared by everything that has a colour.
    pub curves: Vec<Curve>,
    /// Decoded images, shared by textures and environment lights.
    pub images: Vec<Image>,
    /// Triangle meshes, shared by shapes.
    pub meshes: Vec<Mesh>,
    /// Shapes of the world outside of objects.
    pub shapes: Vec<Shape>,
    /// Groups of shapes, which instances place.
    pub objects: Vec<Object>,
    /// Placed copies of objects.
    pub instances: Vec<Instance>,
    /// Lights other than shapes; area lights are shapes with [`Shape::emission`].
    pub lights: Vec<Light>,
}

/// The format of the file that a scene was read from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum SourceFormat {
    /// A scene in our own format, of pbrt or of Mitsuba, or no file.
    #[default]
    Scene,
    /// A glTF file.
    Gltf,
    /// A model of another format, which has neither a camera nor lights.
    Model,
}

/// The use of vertex normals in shading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VertexNormals {
    /// They describe a smooth surface that the mesh stands for: where they face away from the viewer they are bent, so that
    /// silhouettes do not darken, and rays start at the smooth surface, so that facets cast no shadows on their own mesh
    /// near the terminator.
    #[default]
    Smooth,
    /// They are taken as they are, as in pbrt.
    AsGiven,
}

/// A named group of shapes, invisible until an [`Instance`] places it.
#[derive(Clone, Debug)]
pub struct Object {
    /// The name that instances refer to.
    pub name: String,
    /// The location in the file.
    pub at: Location,
    /// Its shapes; their `world_from_object` is the transform to the space of this group.
    pub shapes: Vec<Shape>,
}

/// A placed copy of an object.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Its name, if it has one: that of a glTF node, say.
    pub name: Option<Arc<String>>,
    /// The location in the file.
    pub at: Location,
    /// The instanced object.
    pub object: ObjectId,
    /// From the object's space to the world: any invertible affine matrix, including reflections. Of an instance that moves the
    /// matrix when the shutter opens.
    pub world_from_object: DMat4,
    /// Replaces every material in the object.
    pub material: Option<MaterialId>,
    /// Its motion from the object's space to the world, if it moves.
    pub motion: Option<Arc<Motion>>,
}

impl Instance {
    /// One without a name and motion, with the materials of the object.
    pub fn new(at: Location, object: ObjectId, world_from_object: DMat4) -> Self {
        Self { name: None, at, object, world_from_object, material: None, motion: None }
    }
}

/// An axis-aligned box; empty when `min > max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Minimum corner.
    pub min: DVec3,
    /// Maximum corner.
    pub max: DVec3,
}

impl Bounds {
    /// The empty box; the identity of [`Bounds::union`].
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// The smallest box around both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The smallest box around this one and a point.
    pub fn with(self, point: DVec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// Whether the box is empty.
    pub fn is_empty(self) -> bool {
        !(self.min.x <= self.max.x && self.min.y <= self.max.y && self.min.z <= self.max.z)
    }

    /// The centre.
    pub fn center(self) -> DVec3 {
        0.5 * (self.min + self.max)
    }

    /// Half the diagonal: the radius of the bounding sphere.
    pub fn radius(self) -> f64 {
        if self.is_empty() { 0.0 } else { 0.5 * (self.max - self.min).length() }
    }

    /// The bounding box of the transformed box.
    pub fn transformed(self, matrix: &DMat4) -> Self {
        if self.is_empty() {
            return self;
        }
        (0..8).fold(Self::EMPTY, |bounds, corner| {
            let pick = |bit: u32, low: f64, high: f64| if corner >> bit & 1 == 0 { low } else { high };
            bounds.with(matrix.transform_point3(DVec3::new(
                pick(0, self.min.x, self.max.x),
                pick(1, self.min.y, self.max.y),
                pick(2, self.min.z, self.max.z),
            )))
        })
    }
}

impl Scene {
    /// Bytes of its arrays. Names, materials and what else a person could have written are not counted.
    pub fn bytes(&self) -> u64 {
        let shapes = |shapes: &[Shape]| shapes.iter().map(Shape::bytes).sum::<u64>();
        self.meshes.iter().map(Mesh::bytes).sum::<u64>()
            + self.images.iter().map(Image::bytes).sum::<u64>()
            + shapes(&self.shapes)
            + self.objects.iter().map(|object| shapes(&object.shapes)).sum::<u64>()
            + size_of_val(&*self.instances) as u64
            + self
                .instances
                .iter()
                .filter_map(|instance| instance.motion.as_deref())
                .map(Motion::bytes)
                .sum::<u64>()
            + self.media.iter().map(Medium::bytes).sum::<u64>()
    }

    /// The shapes with a name that are placed in the world itself, in no object.
    pub fn shapes_named(&self, name: &str) -> impl Iterator<Item = &Shape> {
        self.shapes.iter().filter(move |shape| shape.name.as_deref() == Some(name))
    }

    /// The bounding box of everything that is placed in the world, at all times of the shutter. What is made of meshes,
    /// vertices and objects that are not there, for which [`Scene::validate`] has an error, takes no place.
    pub fn bounds(&self) -> Bounds {
        self.bounds_of_parts().fold(Bounds::EMPTY, Bounds::union)
    }

    /// As [`Scene::bounds`], of each shape that is in no object, and of each instance.
    pub fn bounds_of_parts(&self) -> impl Iterator<Item = Bounds> {
        let of_shape = |shape: &Shape| shape.bounds(&self.meshes);
        let of_object =
            |object: &Object| object.shapes.iter().map(of_shape).fold(Bounds::EMPTY, Bounds::union);
        let objects: Vec<Bounds> = self.objects.iter().map(of_object).collect();
        let of_instance = move |instance: &Instance| {
            let object = objects.get(instance.object.index()).copied().unwrap_or(Bounds::EMPTY);
            let maps = match &instance.motion {
                None => std::slice::from_ref(&instance.world_from_object),
                Some(motion) => motion.maps(),
            };
            maps.iter().map(|map| object.transformed(map)).fold(Bounds::EMPTY, Bounds::union)
        };
        self.shapes.iter().map(of_shape).chain(self.instances.iter().map(of_instance))
    }
}
