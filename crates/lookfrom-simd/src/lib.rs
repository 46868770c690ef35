#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod dispatch;
mod lane_mask;
mod level;
mod placement;
mod points;
mod real;
mod rounding;
mod transpose;
mod vector;

pub use dispatch::{Kernel, dispatch, dispatch_wide, is_wide, run_at_baseline};
pub use fearless_simd::{
    Level, Simd, f32x4, f32x8, f32x16, f64x4, f64x8, i32x8, mask32x8, mask64x8, prelude, u32x4, u32x8, u64x8,
};
pub use lane_mask::LaneMask;
pub use level::{UnmetLevel, choose_level, level};
pub use placement::{Placement, amplification};
pub use points::{Exits, Lift, Points};
pub use real::{Bits, Float, Mask, Real};
pub use rounding::round_toward;
pub use transpose::transposed;
pub use vector::Vector;
