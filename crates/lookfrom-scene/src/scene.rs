//! The scene description: plain, editable data in arenas, with names and source locations. Crate `lookfrom` compiles it to a
//! `World` for rendering.
//!
//! Units: the scene's own length; angles in degrees; colours are linear Rec. 709 (sRGB primaries), unbounded above.

use glam::{DMat4, DVec3};

use crate::camera::Camera;
use crate::contents::Contents;
use crate::error::Location;
use crate::image::Image;
use crate::light::Light;
use crate::material::Material;
use crate::medium::Medium;
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
            /// As an index into its arena.
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
    /// Whether the file says all that there is, so that no light is added to show it: a scene of pbrt without lights is
    /// black.
    pub is_complete: bool,
    /// The format of the file that it was read from.
    pub source_format: SourceFormat,
    /// The animations, variants, cameras and scenes of the file.
    pub contents: Contents,
    /// The camera; `None` where the file has none: then the scene is framed by its bounds.
    pub camera: Option<Camera>,
    /// Size, filter and development of the picture.
    pub image: ImageSettings,
    /// The integrator and its settings.
    pub render: RenderSettings,
    /// Surfaces' looks.
    pub materials: Vec<Material>,
    /// Colour over surfaces.
    pub textures: Vec<Texture>,
    /// Participating media.
    pub media: Vec<Medium>,
    /// Values by wavelength, shared by whatever has a colour.
    pub curves: Vec<Curve>,
    /// Decoded pictures, shared by textures and environment lights.
    pub images: Vec<Image>,
    /// Triangles, shared by shapes.
    pub meshes: Vec<Mesh>,
    /// Shapes of the world outside objects.
    pub shapes: Vec<Shape>,
    /// Groups of shapes that instances repeat.
    pub objects: Vec<Object>,
    /// Repetitions of objects.
    pub instances: Vec<Instance>,
    /// Lights that are not shapes; area lights are shapes with [`Shape::emission`].
    pub lights: Vec<Light>,
}

/// The format of the file that a scene was read from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum SourceFormat {
    /// A scene of ours or of pbrt, or no file.
    #[default]
    Scene,
    /// A glTF file.
    Gltf,
    /// A model of another format, which has neither a camera nor lights.
    Model,
}

/// A named group of shapes, invisible until an [`Instance`] places it.
#[derive(Clone, Debug)]
pub struct Object {
    /// The name that instances refer to.
    pub name: String,
    /// The location in the file.
    pub at: Location,
    /// Its shapes; their `world_from_object` leads to the space of this group.
    pub shapes: Vec<Shape>,
}

/// One repetition of an object.
#[derive(Clone, Debug)]
pub struct Instance {
    /// The location in the file.
    pub at: Location,
    /// The object that is instanced.
    pub object: ObjectId,
    /// From the object's space to the world: any invertible affine matrix, mirrors included.
    pub world_from_object: DMat4,
    /// Takes the place of every material in the object.
    pub material: Option<MaterialId>,
}

/// An axis-aligned box; empty when `min > max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Least corner.
    pub min: DVec3,
    /// Greatest corner.
    pub max: DVec3,
}

impl Bounds {
    /// Holds nothing; the identity of [`Bounds::union`].
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// The least box around both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The least box around this one and a point.
    pub fn with(self, point: DVec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// Whether it holds nothing.
    pub fn is_empty(self) -> bool {
        !(self.min.x <= self.max.x && self.min.y <= self.max.y && self.min.z <= self.max.z)
    }

    /// Middle.
    pub fn center(self) -> DVec3 {
        0.5 * (self.min + self.max)
    }

    /// Half the diagonal: the radius of the sphere around the box.
    pub fn radius(self) -> f64 {
        if self.is_empty() { 0.0 } else { 0.5 * (self.max - self.min).length() }
    }

    /// The box around the transformed box.
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
    /// The box around everything that is placed in the world.
    pub fn bounds(&self) -> Bounds {
        let of = |shapes: &[Shape]| {
            shapes.iter().fold(Bounds::EMPTY, |bounds, shape| bounds.union(shape.bounds(&self.meshes)))
        };
        let objects: Vec<Bounds> = self.objects.iter().map(|object| of(&object.shapes)).collect();
        self.instances.iter().fold(of(&self.shapes), |bounds, instance| {
            bounds.union(objects[instance.object.index()].transformed(&instance.world_from_object))
        })
    }
}
