//! One numeric source for every width: a trait of numbers that `f32` is, and eight of them side by side are.
//!
//! Code that is generic over [`Real`] is written once. At `f32` it is the reference that tests compare with, and what is asked
//! one at a time; at [`f32x8`](fearless_simd::f32x8) it is what pictures are made with. Both give the same bits, lane by lane,
//! since every operation here is one of IEEE 754's, or is defined by comparison and selection.
//!
//! `if` becomes [`Float::select`], `Option` becomes a value beside a [`Mask`]. Functions are `#[inline(always)]`, so that they
//! are compiled for the level of their caller.

mod eight;
mod one;

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Shl, Shr, Sub};

/// Yes or no, for each lane.
pub trait Mask: Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// Whether any lane is set.
    fn any(self) -> bool;

    /// Whether all lanes are set.
    #[inline(always)]
    fn all(self) -> bool {
        !(!self).any()
    }

    /// A mask as wide as this one with `value` in every lane.
    #[inline(always)]
    fn like(self, value: bool) -> Self {
        if value { self | !self } else { self & !self }
    }

    /// `yes` where the mask is set, `no` elsewhere.
    #[inline(always)]
    fn choose(self, yes: Self, no: Self) -> Self {
        (self & yes) | (!self & no)
    }
}

/// Floating-point numbers of a width and a precision.
pub trait Float:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// One of them.
    type Scalar: Copy;
    /// The result of comparisons.
    type Mask: Mask;

    /// `value` in every lane, as many as this one has.
    fn like(self, value: Self::Scalar) -> Self;
    /// Square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// Without its sign.
    fn abs(self) -> Self;
    /// The greatest integer that is not greater.
    fn floor(self) -> Self;
    /// With the sign of another.
    fn copysign(self, sign: Self) -> Self;
    /// Whether they are equal.
    fn eq(self, other: Self) -> Self::Mask;
    /// Whether it is less.
    fn lt(self, other: Self) -> Self::Mask;
    /// Whether it is greater.
    fn gt(self, other: Self) -> Self::Mask;
    /// Whether it is neither infinite nor NaN.
    fn is_finite(self) -> Self::Mask;
    /// `yes` where the mask is set, `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// The greater one; the other one where they are equal or either is NaN, on every machine.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(self.gt(other), self, other)
    }

    /// The lesser one; the other one where they are equal or either is NaN, on every machine.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }

    /// Within two bounds; NaN is the least.
    #[inline(always)]
    fn clamp(self, least: Self::Scalar, most: Self::Scalar) -> Self {
        Float::min(Float::max(self, self.like(least)), self.like(most))
    }
}

/// Unsigned integers of a width, with arithmetic that wraps around.
pub trait Bits:
    Copy
    + Debug
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + BitXor<Output = Self>
    + Shl<u32, Output = Self>
    + Shr<u32, Output = Self>
{
    /// One of them.
    type Scalar: Copy;

    /// `value` in every lane, as many as this one has.
    fn like(self, value: Self::Scalar) -> Self;
    /// The sum, less 2ⁿ if it is that large.
    fn wrapping_add(self, other: Self) -> Self;
    /// The lower half of the product.
    fn wrapping_mul(self, other: Self) -> Self;
}

/// Numbers of single precision: one, or eight side by side.
pub trait Real:
    Float<Scalar = f32>
    + Add<f32, Output = Self>
    + Sub<f32, Output = Self>
    + Mul<f32, Output = Self>
    + Div<f32, Output = Self>
{
    /// Integers of 32 bits, as many.
    type Bits: Bits<Scalar = u32>;
    /// Integers of 64 bits, as many.
    type Bits64: Bits<Scalar = u64>;
    /// Numbers of double precision, as many.
    type Double: Float<Scalar = f64> + Mul<f64, Output = Self::Double>;

    /// The representation.
    fn to_bits(self) -> Self::Bits;
    /// The numbers of a representation.
    fn from_bits(bits: Self::Bits) -> Self;
    /// Integers below 2²⁴ as numbers, exactly.
    fn from_integer(integer: Self::Bits) -> Self;
    /// Numbers of 0 … 2³¹ without their fractions; any integers for others.
    fn to_integer(self) -> Self::Bits;
    /// The entries of a table at each index.
    fn lookup(index: Self::Bits, at: impl Fn(usize) -> f32) -> Self;
    /// A function of the numbers in each lane, one lane after the other; it is told which.
    fn by_lane<const N: usize, const M: usize>(
        numbers: [Self; N],
        f: impl Fn(usize, [f32; N]) -> [f32; M],
    ) -> [Self; M];
    /// A function of each number, one by one.
    fn map(self, f: impl Fn(f32) -> f32) -> Self;
    /// A function of each pair of numbers, one by one.
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self;
    /// `yes` where the mask is set, `no` elsewhere.
    fn select_bits(mask: Self::Mask, yes: Self::Bits, no: Self::Bits) -> Self::Bits;
    /// Integers with 64 bits of equal value.
    fn extend(bits: Self::Bits) -> Self::Bits64;
    /// The lower 32 bits.
    fn low_half(bits: Self::Bits64) -> Self::Bits;
    /// Numbers of double precision of equal value.
    fn widen(self) -> Self::Double;
    /// Rounded to single precision.
    fn narrow(wide: Self::Double) -> Self;
    /// The mask of numbers of double precision as one of single precision.
    fn narrow_mask(self, mask: <Self::Double as Float>::Mask) -> Self::Mask;
    /// Runs a computation at the level of these numbers: for functions that are not inlined.
    fn at_level<T>(self, compute: impl FnOnce() -> T) -> T;
}
