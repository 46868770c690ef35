#![doc = include_str!("../README.md")]
// Axes and lanes are indices into several arrays at once, and `!(a < b)` is how NaN is meant to fail.
#![allow(clippy::needless_range_loop, clippy::neg_cmp_op_on_partial_ord)]

mod aabb;
mod affine;
mod beam;
mod build;
mod bvh;
mod closest_point;
mod dispatch;
mod double;
mod ellipsoid;
mod exact;
mod filter;
mod group;
mod instance;
mod masks;
mod node;
mod origin;
mod packet;
mod prepared;
mod procedural;
mod query;
mod ray;
pub mod reference;
mod refit;
mod selection;
mod sphere;
#[cfg(test)]
mod testing;
mod traverse;
mod triangle;
mod validate;
mod vector;
mod waiting;
mod watch;

pub use aabb::Aabb;
pub use affine::Affine;
pub use build::{BuildError, Builder, Quality, Triangles};
pub use bvh::Bvh;
pub use closest_point::ClosestPoint;
pub use double::{HitF64, RayF64};
pub use origin::Point;
pub use procedural::{Procedural, ProceduralHit};
pub use ray::{Hit, NONE, OriginPrimitive, Ray};
pub use refit::{Moved, RefitError};
pub use selection::{Faces, Selected, Selection};
pub use sphere::Sphere;
pub use validate::{Invalid, Statistics};
pub use watch::Observer;
