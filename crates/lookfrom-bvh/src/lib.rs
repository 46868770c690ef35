#![doc = include_str!("../README.md")]
// Axes and lanes are indices into several arrays at once, and `!(a < b)` is intended to be true for NaN.
#![allow(clippy::needless_range_loop, clippy::neg_cmp_op_on_partial_ord)]

mod aabb;
mod affine;
mod batch;
mod build;
mod bvh;
mod closest_point;
mod coherence;
mod collector;
mod common_origin;
mod conservative;
mod dispatch;
mod ellipsoid;
mod exact;
mod faces;
mod interleaved;
mod item;
mod masks;
mod node;
mod observer;
mod origin;
mod origin_primitive;
mod packet;
mod packet_bounds;
mod prepared;
mod procedural;
mod query;
mod ray;
mod ray8;
mod ray_f64;
pub mod reference;
mod refit;
mod settings;
mod single;
mod sphere;
mod stack;
mod statistics;
#[cfg(test)]
mod testing;
mod trace_ray;
mod traverse;
mod traverse_f64;
mod triangle;
mod validate;
mod vector;
mod visibility;

pub use aabb::Aabb;
pub use affine::Affine;
pub use build::{BuildError, Builder, Quality, Triangles};
pub use bvh::Bvh;
pub use closest_point::ClosestPoint;
pub use faces::Faces;
pub use observer::Observer;
pub use origin::Point;
pub use origin_primitive::OriginPrimitive;
pub use procedural::{Procedural, ProceduralHit};
pub use query::Query;
pub use ray::{Hit, NONE, Ray};
pub use ray_f64::{HitF64, RayF64};
pub use refit::{Moved, RefitError};
pub use sphere::Sphere;
pub use statistics::Statistics;
pub use trace_ray::TraceRay;
pub use validate::Invalid;
