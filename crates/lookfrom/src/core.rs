//! Foundations: spectra and colour, sampling, noise, vectors in lanes.

pub(crate) mod accumulator;
pub mod clock;
pub mod color;
pub mod distribution;
pub(crate) mod elementary;
pub mod filter;
pub(crate) mod fixed_point;
pub(crate) mod hash;
pub(crate) mod lanes;
pub mod math;
pub mod noise;
pub mod optics;
pub(crate) mod parallel;
pub(crate) mod points;
pub mod sampler;
pub mod spectrum;
#[cfg(test)]
pub(crate) mod statistics;
pub mod times;
pub mod vector;
pub mod warp;
