//! Light: compile a scene, sample, shade, integrate and accumulate it into a picture.
//!
//! bytes —read→ [`lookfrom_scene::Scene`] —compile→ [`world::World`] —render→ [`film::Film`] —develop→ pixels.
//! Start reading at [`render`].

pub mod bsdf;
pub mod camera;
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
pub mod light;
pub mod material;
pub mod math;
pub mod noise;
pub mod render;
pub mod sampler;
pub mod shape;
pub mod spectrum;
#[cfg(test)]
mod statistics;
pub mod surface;
pub mod texture;
pub mod warp;
pub mod world;
