#![doc = include_str!("../README.md")]

pub mod core;
pub mod film;
pub mod inspect;
pub mod integrator;
pub mod light;
pub mod post;
pub mod primitive;
pub mod render;
pub mod session;
pub mod shading;
pub mod view;
pub mod world;

/// The vector and matrix types of this crate's interface.
pub use glam;

/// The word of `LOOKFROM_SIMD` where it selects nothing, for front ends to tell.
pub use lookfrom_simd::unmet_level;
