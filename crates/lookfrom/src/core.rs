//! Foundations: spectra and colour, sampling, noise, vectors in lanes.

pub(crate) mod clock;
pub mod color;
pub mod distribution;
pub(crate) mod eight;
pub mod filter;
pub(crate) mod hash;
pub mod math;
pub mod noise;
pub(crate) mod parallel;
pub mod sampler;
pub mod spectrum;
#[cfg(test)]
pub(crate) mod statistics;
pub mod warp;
