//! From a film to a picture: noise filtered out, light developed to what a file holds.

pub mod denoise;
pub mod develop;
