//! The kernel as a program uses it: geometry and rays in, hits out.
//!
//! One program for all files, since each would compile and link the kernel for itself.

mod brute_force;
mod build;
mod capsules;
mod closest_point;
mod counts;
mod crossings;
mod double;
mod extremes;
mod hit_points;
mod instances;
mod motion;
mod origins;
mod query;
mod refit;
mod selection;
mod shapes;
#[path = "../../src/testing.rs"]
mod testing;
mod vector;
mod watertight;
