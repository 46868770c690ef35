//! Vectors of three components, of any width and precision.

pub use lookfrom_simd::Vector;
