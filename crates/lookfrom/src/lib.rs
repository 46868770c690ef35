#![doc = include_str!("../README.md")]

pub mod aov;
pub mod core;
pub mod film;
pub mod inspect;
pub mod integrator;
pub mod light;
pub mod medium;
pub mod post;
pub mod primitive;
pub mod render;
pub mod session;
pub mod shading;
pub mod view;
pub mod world;

/// The vector and matrix types of this crate's interface.
pub use glam;

/// Ray casting: trees, rays and hits.
pub use lookfrom_bvh as bvh;

/// Scenes as written, their parts, and the readers of files.
pub use lookfrom_scene as scene;

/// The SIMD level of this process, which a front end may choose.
pub use lookfrom_simd::{UnmetLevel, choose_level};

/// Names that most programs need: `use lookfrom::prelude::*`.
pub mod prelude {
    pub use glam::{DMat4, DVec3, Vec2, Vec3};
    pub use lookfrom_scene::Scene;
    pub use lookfrom_scene::light::{Falloff, LightKind, Sky};
    pub use lookfrom_scene::material::{
        Color, Distribution, Energy, Ior, Masking, MaterialKind, Metal, Microfacets, Plastic, Principled,
        Roughness, Scalar, Whitted,
    };
    pub use lookfrom_scene::settings::Integrator;
    pub use lookfrom_scene::shape::{Emission, Geometry, Mesh, Shape};

    pub use crate::session::{Format, Options, Session};
}
