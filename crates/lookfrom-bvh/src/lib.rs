//! Rays against geometry: what does a ray hit first, is anything in its way, what are all its hits?
//!
//! A kernel of its own, in safe Rust: triangles, spheres, shapes of your own ([`Procedural`]) and instances of all of
//! these, in one tree. For pictures, and as much for CAD, robotics and learning, since it does not slip:
//!
//! - **watertight**: no ray passes between two triangles that share an edge or a corner;
//! - **decided in double precision**: single precision only excludes, so the bits of an answer depend neither on the
//!   tree, its quality or the number of threads, nor on the machine; equal distances are decided by ids;
//! - **no epsilons**: [`Point`] gives origins for rays that leave a surface, one or two units in the last place away;
//! - **no bad input**: NaN, infinities, triangles without area, a million primitives in one place are all fine.
//!
//! ```
//! use lookfrom_bvh::{Builder, Hit, Point, Ray, Triangles};
//!
//! // A square of two triangles in the plane z = 0.
//! let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
//! let indices = [[0, 1, 2], [0, 2, 3]];
//! let mut builder = Builder::new();
//! builder.triangles(Triangles { positions: &positions, indices: &indices });
//! let bvh = builder.build()?;
//!
//! // What does a ray from above hit?
//! let hit = bvh.closest_hit(&Ray::new([0.75, 0.25, 2.0], [0.0, 0.0, -1.0]));
//! assert_eq!((hit.t, hit.geometry, hit.primitive), (2.0, 0, 0));
//!
//! // A ray from there, back up, does not hit the square again.
//! let [p0, p1, p2] = indices[hit.primitive as usize].map(|index| positions[index as usize]);
//! let up = [0.1_f32, 0.2, 1.0];
//! let origin = Point::on_triangle(p0, p1, p2, hit.u, hit.v).origin([0.0, 0.0, 1.0], up);
//! assert_eq!(bvh.closest_hit(&Ray::new(origin, up)), Hit::MISS);
//!
//! // Is anything in the way between two points? t runs from 0 to 1.
//! let (from, to) = ([0.5, 0.5, 1.0], [0.5, 0.5, -1.0]);
//! let direction = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
//! assert!(bvh.occluded(&Ray::new(from, direction).until(1.0)));
//! # Ok::<(), lookfrom_bvh::BuildError>(())
//! ```
//!
//! Start reading at [`Bvh`]; the loop is in `traverse`, the two tests in `node` and `triangle`, and [`mod@reference`] has the
//! same in its simplest form.

// Axes and lanes are indices into several arrays at once, and `!(a < b)` is how NaN is meant to fail.
#![allow(clippy::needless_range_loop, clippy::neg_cmp_op_on_partial_ord)]

mod aabb;
mod affine;
mod build;
mod bvh;
mod closest_point;
mod ellipsoid;
mod instance;
mod node;
mod origin;
mod prepared;
mod procedural;
mod query;
mod ray;
pub mod reference;
mod refit;
mod simd;
mod sphere;
#[cfg(test)]
mod testing;
mod traverse;
mod triangle;
mod validate;
mod vector;

pub use aabb::Aabb;
pub use affine::Affine;
pub use build::{BuildError, Builder, Quality, Triangles};
pub use bvh::Bvh;
pub use closest_point::ClosestPoint;
pub use origin::Point;
pub use procedural::{Procedural, ProceduralHit};
pub use ray::{Hit, NONE, Ray};
pub use refit::{Moved, RefitError};
pub use sphere::Sphere;
pub use traverse::Watch;
pub use validate::{Invalid, Statistics};
