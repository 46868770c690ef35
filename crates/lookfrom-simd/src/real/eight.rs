//! Eight numbers side by side.

use fearless_simd::{Simd, f32x8, f64x8, i32x8, mask32x8, mask64x8, prelude::*, u32x8, u64x8};

use super::{Bits, Float, Mask, Real};

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
