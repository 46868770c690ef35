#![doc = include_str!("../README.md")]

pub mod bsdf;
pub mod camera;
mod clock;
pub mod color;
pub mod denoise;
pub mod develop;
pub mod distribution;
mod eight;
pub mod film;
pub mod filter;
mod hash;
pub mod inspect;
pub mod integrator;
pub mod interaction;
pub mod interior_stack;
pub mod light;
pub mod material;
pub mod math;
pub mod noise;
mod parallel;
pub mod primitive;
pub mod render;
pub mod sampler;
pub mod session;
pub mod spectrum;
#[cfg(test)]
mod statistics;
pub mod texture;
pub mod view;
pub mod warp;
pub mod world;

/// The vectors and matrices of this crate's interface.
pub use glam;
