//! A few f32 side by side.
//!
//! Plain arrays whose loops the compiler turns into vector instructions, which it does where results end up in memory one
//! after another: so the box test and the triangle filter are functions that are not inlined and write arrays, and
//! comparisons follow on these. Explicit SIMD, when it comes, goes here.

use std::ops::{Add, Mul, Sub};

/// `N` numbers that are calculated with at once.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lanes<const N: usize>(pub(crate) [f32; N]);

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
        self.zip(self, |a, _| a.abs())
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

/// The numbers of the lanes that were chosen, from the least; bit i stands for lane i.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Chosen(u32);

impl Chosen {
    /// The lanes for which something holds.
    #[inline(always)]
    pub(crate) fn which<const N: usize>(holds: impl Fn(usize) -> bool) -> Self {
        let mut bits = 0;
        for lane in 0..N {
            bits |= u32::from(holds(lane)) << lane;
        }
        Self(bits)
    }

    /// Only the first lanes.
    #[inline(always)]
    pub(crate) fn first(self, count: u32) -> Self {
        Self(self.0 & ((1 << count) - 1))
    }
}

impl Iterator for Chosen {
    type Item = usize;
    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let lane = (self.0 != 0).then(|| self.0.trailing_zeros() as usize);
        self.0 &= self.0.wrapping_sub(1);
        lane
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chosen_lanes_come_in_order() {
        assert_eq!(Chosen::which::<8>(|lane| [1, 2, 5, 7].contains(&lane)).collect::<Vec<_>>(), [1, 2, 5, 7]);
        assert_eq!(Chosen::which::<4>(|_| true).first(3).collect::<Vec<_>>(), [0, 1, 2]);
        assert_eq!(Chosen::which::<4>(|_| false).next(), None);
    }
}
