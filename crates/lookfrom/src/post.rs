//! Post-processing: from a film to a picture in a file.

pub mod denoise;
pub mod develop;
pub(crate) mod exposure;
