//! Surfaces and light: the point that a ray met, its textures and material, the scattering function there, and what the ray is
//! inside of.

pub mod bsdf;
pub mod interaction;
pub mod interior_stack;
pub mod material;
pub mod texture;
