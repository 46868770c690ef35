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

/// The SIMD level of this process, which a front end may choose.
pub use lookfrom_simd::{UnmetLevel, choose_level};
