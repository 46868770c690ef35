//! Rays against triangles and spheres in double precision, on the kernel's trees in single precision.
//!
//! A tree is built from positions relative to the middle of their box, in units of about half its size, so that rounding to f32
//! is relative to the size of what is in it. The kernel says which primitive a ray hits; where on it is computed in f64, on the
//! positions as they were given.

mod all_hits;
mod arguments;
mod cast;
mod chunk;
mod closest;
mod frame;
mod geometry;
mod hit_arrays;
mod inside;
mod order;
mod point_queries;
mod points;
mod python;
mod queries;
mod refine;
mod tree;

pub(crate) use python::PyTree as Tree;
