//! A few lanes of f32 side by side.
//!
//! Plain arrays whose loops the compiler turns into vector instructions. The box test and the triangle filter are
//! written in terms of this type, so explicit SIMD has one place to go to.

use std::ops::{Add, BitOr, Mul, Sub};

/// `N` numbers that are calculated with at once.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lanes<const N: usize>(pub(crate) [f32; N]);

/// One truth value a lane: all bits set or none, as vector comparisons give it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mask<const N: usize>([u32; N]);

impl<const N: usize> Lanes<N> {
    #[inline(always)]
    pub(crate) fn splat(x: f32) -> Self {
        Self([x; N])
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        let mut result = [0.0; N];
        for lane in 0..N {
            result[lane] = f(self.0[lane], other.0[lane]);
        }
        Self(result)
    }

    /// The smaller of two; the second where either is NaN.
    #[inline(always)]
    pub(crate) fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    /// The greater of two; the second where either is NaN.
    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }

    /// Which lanes are below those of another; never where either is NaN.
    #[inline(always)]
    pub(crate) fn below(self, other: Self) -> Mask<N> {
        let mut result = [0; N];
        for lane in 0..N {
            result[lane] = if self.0[lane] < other.0[lane] { u32::MAX } else { 0 };
        }
        Mask(result)
    }

    /// Which lanes are not above those of another; never where either is NaN.
    #[inline(always)]
    pub(crate) fn at_most(self, other: Self) -> Mask<N> {
        let mut result = [0; N];
        for lane in 0..N {
            result[lane] = if self.0[lane] <= other.0[lane] { u32::MAX } else { 0 };
        }
        Mask(result)
    }
}

impl<const N: usize> Mask<N> {
    #[inline(always)]
    pub(crate) fn and(self, other: Self) -> Self {
        let mut result = [0; N];
        for lane in 0..N {
            result[lane] = self.0[lane] & other.0[lane];
        }
        Self(result)
    }

    /// Bit i for lane i.
    #[inline(always)]
    pub(crate) fn bits(self) -> u32 {
        let mut bits = 0;
        for lane in 0..N {
            bits |= self.0[lane] & (1 << lane);
        }
        bits
    }
}

impl<const N: usize> BitOr for Mask<N> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        let mut result = [0; N];
        for lane in 0..N {
            result[lane] = self.0[lane] | other.0[lane];
        }
        Self(result)
    }
}

impl<const N: usize> Add for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<const N: usize> Sub for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl<const N: usize> Mul for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}
