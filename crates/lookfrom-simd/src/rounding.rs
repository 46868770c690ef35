//! Rounding: its unit in each precision, and from double to single precision in a direction.

use crate::real::{Bits, Float, Real};

/// Unit of rounding of f64, 2⁻⁵³.
pub(crate) const UNIT: f64 = f64::EPSILON / 2.0;

/// Unit of rounding of f32, 2⁻²⁴.
pub(crate) const UNIT32: f64 = f32::EPSILON as f64 / 2.0;

/// `x` rounded to the nearest f32 that is not below it (`up`) or not above it (`down`); simply to the nearest where both
/// are false. Without a branch that depends on `x`, since it could not be predicted.
#[inline(always)]
pub fn round_toward<R: Real>(
    x: R::Double,
    up: <R::Double as Float>::Mask,
    down: <R::Double as Float>::Mask,
) -> R {
    let nearest = R::narrow(x);
    let wide = nearest.widen();
    let is_wrong = nearest.narrow_mask((up & wide.lt(x)) | (down & wide.gt(x)));
    let up = nearest.narrow_mask(up);
    // One step in the order of the numbers is one step of the bits, forward or back by sign; from zero it is the least
    // number of that side.
    let bits = nearest.to_bits();
    let is_positive = nearest.gt(nearest.like(0.0));
    let grows = (is_positive & up) | (!is_positive & !up);
    let stepped = bits.wrapping_add(R::select_bits(grows, bits.like(1), bits.like(u32::MAX)));
    let least = R::select_bits(up, bits.like(1), bits.like(0x8000_0001));
    let stepped = R::select_bits(Float::eq(nearest, nearest.like(0.0)), least, stepped);
    R::from_bits(R::select_bits(is_wrong, stepped, bits))
}
