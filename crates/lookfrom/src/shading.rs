//! Shading: surface interactions, textures, materials, BSDFs, interior stacks.

pub mod bsdf;
pub mod bssrdf;
pub mod footprint;
pub mod interaction;
pub mod interior_stack;
pub mod material;
pub mod texture;
