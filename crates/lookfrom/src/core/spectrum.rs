//! Spectra: light as four lanes.
//!
//! In RGB mode the lanes are linear Rec. 709 red, green, blue and an unused fourth that is always 0. In spectral
//! mode they are four wavelengths. All arithmetic of materials and lights is lane-wise; the meaning of a lane
//! matters only where colour enters (textures, light colours) and leaves (the film).

use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Sub};

use lookfrom_simd::{Float, Real};

/// Radiance, or a factor of it, in four lanes; of one path, or of eight side by side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(16))]
pub struct Spectrum<R = f32>(pub [R; 4]);

impl Spectrum {
    /// No light.
    pub const BLACK: Self = Self([0.0; 4]);
    /// The multiplicative identity (in RGB mode).
    pub const ONE: Self = Self([1.0, 1.0, 1.0, 0.0]);

    /// A colour in linear Rec. 709.
    pub fn from_rgb([r, g, b]: [f32; 3]) -> Self {
        Self([r, g, b, 0.0])
    }

    /// The colour in linear Rec. 709.
    pub fn rgb(self) -> [f32; 3] {
        let [r, g, b, _] = self.0;
        [r, g, b]
    }

    /// The only lane that is not 0; `None` where there are several or none.
    pub fn only_lane(self) -> Option<usize> {
        let mut lanes = (0..4).filter(|&lane| self.0[lane] != 0.0);
        lanes.next().filter(|_| lanes.next().is_none())
    }

    /// Keeps one of the lanes that are not 0, chosen uniformly by `u ∈ [0, 1)` and multiplied by their number, so
    /// that the expectation is unchanged.
    pub fn leave_one(&mut self, u: f32) {
        let count = self.0.iter().filter(|lane| **lane != 0.0).count();
        let chosen = ((u * count as f32) as usize).min(count.saturating_sub(1));
        let mut rank = 0;
        for lane in &mut self.0 {
            if *lane != 0.0 {
                *lane = if rank == chosen { *lane * count as f32 } else { 0.0 };
                rank += 1;
            }
        }
    }
}

impl<R: Real> Spectrum<R> {
    /// Applies `f` to each lane.
    #[inline(always)]
    pub fn map(self, f: impl Fn(R) -> R) -> Self {
        let [a, b, c, d] = self.0;
        Self([f(a), f(b), f(c), f(d)])
    }

    /// Applies `f` to each pair of lanes.
    #[inline(always)]
    pub fn zip(self, other: Self, f: impl Fn(R, R) -> R) -> Self {
        let ([a, b, c, d], [e, g, h, i]) = (self.0, other.0);
        Self([f(a, e), f(b, g), f(c, h), f(d, i)])
    }

    /// One value in each lane.
    #[inline(always)]
    pub(crate) fn splat(value: R) -> Self {
        Self([value; 4])
    }

    /// The share that this is of a whole, 0 … 1 by lane; 0 of nothing.
    #[inline(always)]
    pub fn share_of(self, whole: Self) -> Self {
        self.zip(
            whole,
            #[inline(always)]
            |part, whole| {
                let zero = whole.like(0.0);
                R::select(whole.gt(zero), Float::clamp(part / whole, 0.0, 1.0), zero)
            },
        )
    }

    /// The sum of the lanes.
    #[inline(always)]
    pub(crate) fn sum(self) -> R {
        let [a, b, c, d] = self.0;
        a + b + c + d
    }

    /// The largest lane.
    #[inline(always)]
    pub fn max_lane(self) -> R {
        let [a, b, c, d] = self.0;
        Float::max(Float::max(d, c), Float::max(b, a))
    }

    /// True if all lanes are 0.
    #[inline(always)]
    pub fn is_black(self) -> R::Mask {
        let [a, b, c, d] = self.0;
        let zero = a.like(0.0);
        Float::eq(a, zero) & Float::eq(b, zero) & Float::eq(c, zero) & Float::eq(d, zero)
    }

    /// True if no lane is infinite or NaN.
    #[inline(always)]
    pub(crate) fn is_finite(self) -> R::Mask {
        let [a, b, c, d] = self.0;
        Float::is_finite(a) & Float::is_finite(b) & Float::is_finite(c) & Float::is_finite(d)
    }

    /// `yes` where the mask is set, `no` elsewhere.
    #[inline(always)]
    pub(crate) fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        let ([a, b, c, d], [e, f, g, h]) = (yes.0, no.0);
        Self([R::select(mask, a, e), R::select(mask, b, f), R::select(mask, c, g), R::select(mask, d, h)])
    }
}

macro_rules! lane_wise {
    ($($trait:ident $method:ident $operator:tt)*) => {$(
        impl<R: Real> $trait for Spectrum<R> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let ([a, b, c, d], [e, f, g, h]) = (self.0, other.0);
                Self([a $operator e, b $operator f, c $operator g, d $operator h])
            }
        }
    )*};
}

lane_wise! { Add add + Sub sub - Mul mul * }

impl<R: Real> Mul<R> for Spectrum<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: R) -> Self {
        let [a, b, c, d] = self.0;
        Self([a * factor, b * factor, c * factor, d * factor])
    }
}

impl<R: Real> Div<R> for Spectrum<R> {
    type Output = Self;
    #[inline(always)]
    fn div(self, divisor: R) -> Self {
        let [a, b, c, d] = self.0;
        Self([a / divisor, b / divisor, c / divisor, d / divisor])
    }
}

impl<R: Real> AddAssign for Spectrum<R> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<R: Real> MulAssign for Spectrum<R> {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}
