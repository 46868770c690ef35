//! One numeric source for every width: a trait of numbers that `f32` is, and eight of them side by side are.
//!
//! Code that is generic over [`Real`] is written once. At `f32` it is the reference that tests compare with, and what is asked
//! one at a time; at [`f32x8`] it is what pictures are made with. Both give the same bits, lane by lane, since every operation
//! here is one of IEEE 754's, or is defined by comparison and selection.
//!
//! `if` becomes [`Float::select`], `Option` becomes a value beside a [`Mask`]. Functions are `#[inline(always)]`, so that they
//! are compiled for the level of their caller.

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Shl, Shr, Sub};

use fearless_simd::{Simd, f32x8, f64x8, i32x8, mask32x8, mask64x8, prelude::*, u32x8, u64x8};

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

impl Mask for bool {
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
}

macro_rules! one {
    ($float:ty) => {
        impl Float for $float {
            type Scalar = $float;
            type Mask = bool;

            #[inline(always)]
            fn like(self, value: $float) -> Self {
                value
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                self.sqrt()
            }
            #[inline(always)]
            fn abs(self) -> Self {
                self.abs()
            }
            #[inline(always)]
            fn floor(self) -> Self {
                self.floor()
            }
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                self.copysign(sign)
            }
            #[inline(always)]
            fn eq(self, other: Self) -> bool {
                self == other
            }
            #[inline(always)]
            fn lt(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn gt(self, other: Self) -> bool {
                self > other
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                self.is_finite()
            }
            #[inline(always)]
            fn select(mask: bool, yes: Self, no: Self) -> Self {
                if mask { yes } else { no }
            }
        }
    };
}

one!(f32);
one!(f64);

macro_rules! one_integer {
    ($integer:ty) => {
        impl Bits for $integer {
            type Scalar = $integer;

            #[inline(always)]
            fn like(self, value: $integer) -> Self {
                value
            }
            #[inline(always)]
            fn wrapping_add(self, other: Self) -> Self {
                self.wrapping_add(other)
            }
            #[inline(always)]
            fn wrapping_mul(self, other: Self) -> Self {
                self.wrapping_mul(other)
            }
        }
    };
}

one_integer!(u32);
one_integer!(u64);

impl Real for f32 {
    type Bits = u32;
    type Bits64 = u64;
    type Double = f64;

    #[inline(always)]
    fn to_bits(self) -> u32 {
        self.to_bits()
    }
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        Self::from_bits(bits)
    }
    #[inline(always)]
    fn from_integer(integer: u32) -> Self {
        integer as Self
    }
    #[inline(always)]
    fn to_integer(self) -> u32 {
        self as u32
    }
    #[inline(always)]
    fn lookup(index: u32, at: impl Fn(usize) -> f32) -> Self {
        at(index as usize)
    }
    #[inline(always)]
    fn by_lane<const N: usize, const M: usize>(
        numbers: [Self; N],
        f: impl Fn(usize, [f32; N]) -> [f32; M],
    ) -> [Self; M] {
        f(0, numbers)
    }
    #[inline(always)]
    fn map(self, f: impl Fn(f32) -> f32) -> Self {
        f(self)
    }
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        f(self, other)
    }
    #[inline(always)]
    fn select_bits(mask: bool, yes: u32, no: u32) -> u32 {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn extend(bits: u32) -> u64 {
        u64::from(bits)
    }
    #[inline(always)]
    fn low_half(bits: u64) -> u32 {
        bits as u32
    }
    #[inline(always)]
    fn widen(self) -> f64 {
        f64::from(self)
    }
    #[inline(always)]
    fn narrow(wide: f64) -> Self {
        wide as Self
    }
    #[inline(always)]
    fn narrow_mask(self, mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn at_level<T>(self, compute: impl FnOnce() -> T) -> T {
        compute()
    }
}

macro_rules! eight {
    ($float:ident, $scalar:ty, $mask:ident) => {
        impl<S: Simd> Mask for $mask<S> {
            #[inline(always)]
            fn any(self) -> bool {
                self.any_true()
            }
            #[inline(always)]
            fn all(self) -> bool {
                self.all_true()
            }
        }

        impl<S: Simd> Float for $float<S> {
            type Scalar = $scalar;
            type Mask = $mask<S>;

            #[inline(always)]
            fn like(self, value: $scalar) -> Self {
                Self::splat(self.simd, value)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                SimdFloat::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                SimdBase::abs(self)
            }
            #[inline(always)]
            fn floor(self) -> Self {
                SimdFloat::floor(self)
            }
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                SimdFloat::copysign(self, sign)
            }
            #[inline(always)]
            fn eq(self, other: Self) -> $mask<S> {
                self.simd_eq(other)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> $mask<S> {
                self.simd_lt(other)
            }
            #[inline(always)]
            fn gt(self, other: Self) -> $mask<S> {
                self.simd_gt(other)
            }
            #[inline(always)]
            fn is_finite(self) -> $mask<S> {
                SimdFloat::is_finite(self)
            }
            #[inline(always)]
            fn select(mask: $mask<S>, yes: Self, no: Self) -> Self {
                mask.select(yes, no)
            }
        }
    };
}

eight!(f32x8, f32, mask32x8);
eight!(f64x8, f64, mask64x8);

macro_rules! eight_integers {
    ($integer:ident, $scalar:ty) => {
        impl<S: Simd> Bits for $integer<S> {
            type Scalar = $scalar;

            #[inline(always)]
            fn like(self, value: $scalar) -> Self {
                Self::splat(self.simd, value)
            }
            #[inline(always)]
            fn wrapping_add(self, other: Self) -> Self {
                self + other
            }
            #[inline(always)]
            fn wrapping_mul(self, other: Self) -> Self {
                self * other
            }
        }
    };
}

eight_integers!(u32x8, u32);
eight_integers!(u64x8, u64);

impl<S: Simd> Real for f32x8<S> {
    type Bits = u32x8<S>;
    type Bits64 = u64x8<S>;
    type Double = f64x8<S>;

    #[inline(always)]
    fn to_bits(self) -> u32x8<S> {
        self.bitcast()
    }
    #[inline(always)]
    fn from_bits(bits: u32x8<S>) -> Self {
        bits.bitcast()
    }
    #[inline(always)]
    fn from_integer(integer: u32x8<S>) -> Self {
        // Below 2²⁴, so that a signed number holds it too.
        let integer: i32x8<S> = integer.bitcast();
        integer.to_float()
    }
    #[inline(always)]
    fn to_integer(self) -> u32x8<S> {
        let integer: i32x8<S> = self.to_int();
        integer.bitcast()
    }
    #[inline(always)]
    fn lookup(index: u32x8<S>, at: impl Fn(usize) -> f32) -> Self {
        let indices: [u32; 8] = index.into();
        let mut all = [0.0; 8];
        for (number, index) in all.iter_mut().zip(indices) {
            *number = at(index as usize);
        }
        Self::load_array(index.simd, all)
    }
    #[inline(always)]
    fn by_lane<const N: usize, const M: usize>(
        numbers: [Self; N],
        f: impl Fn(usize, [f32; N]) -> [f32; M],
    ) -> [Self; M] {
        const { assert!(N > 0) };
        let mut columns = [[0.0; 8]; N];
        let mut k = 0;
        while k < N {
            columns[k] = numbers[k].into();
            k += 1;
        }
        let mut results = [[0.0; 8]; M];
        let mut lane = 0;
        while lane < 8 {
            let mut row = [0.0; N];
            for (number, column) in row.iter_mut().zip(&columns) {
                *number = column[lane];
            }
            for (column, result) in results.iter_mut().zip(f(lane, row)) {
                column[lane] = result;
            }
            lane += 1;
        }
        let mut all = [numbers[0]; M];
        for (all, column) in all.iter_mut().zip(results) {
            *all = Self::load_array(numbers[0].simd, column);
        }
        all
    }
    #[inline(always)]
    fn map(self, f: impl Fn(f32) -> f32) -> Self {
        let mut all: [f32; 8] = self.into();
        for number in &mut all {
            *number = f(*number);
        }
        Self::load_array(self.simd, all)
    }
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        let (mut all, others): ([f32; 8], [f32; 8]) = (self.into(), other.into());
        for (number, other) in all.iter_mut().zip(others) {
            *number = f(*number, other);
        }
        Self::load_array(self.simd, all)
    }
    #[inline(always)]
    fn select_bits(mask: mask32x8<S>, yes: u32x8<S>, no: u32x8<S>) -> u32x8<S> {
        mask.select(yes, no)
    }
    #[inline(always)]
    fn extend(bits: u32x8<S>) -> u64x8<S> {
        let (low, high) = bits.widen();
        low.combine(high)
    }
    #[inline(always)]
    fn low_half(bits: u64x8<S>) -> u32x8<S> {
        let (low, high) = bits.split();
        low.narrow(high)
    }
    #[inline(always)]
    fn widen(self) -> f64x8<S> {
        let (low, high) = SimdWiden::widen(self);
        low.combine(high)
    }
    #[inline(always)]
    fn narrow(wide: f64x8<S>) -> Self {
        let (low, high) = wide.split();
        low.narrow(high)
    }
    #[inline(always)]
    fn narrow_mask(self, mask: mask64x8<S>) -> mask32x8<S> {
        mask32x8::from_bitmask(self.simd, mask.to_bitmask())
    }
    #[inline(always)]
    fn at_level<T>(self, compute: impl FnOnce() -> T) -> T {
        self.simd.vectorize(compute)
    }
}
