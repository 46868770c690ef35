//! Spectra: light as four lanes.
//!
//! In RGB mode the lanes are linear Rec. 709 red, green, blue and an unused fourth that is always 0. In spectral
//! mode they are four wavelengths. All arithmetic of materials and lights is lane-wise; the meaning of a lane
//! matters only where colour enters (textures, light colours) and leaves (the film).

use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Sub};

/// Radiance, or a factor of it, in four lanes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(16))]
pub struct Spectrum(pub [f32; 4]);

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

    /// Applies `f` to each lane.
    pub fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Self(self.0.map(f))
    }

    /// Applies `f` to each pair of lanes.
    pub fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|lane| f(self.0[lane], other.0[lane])))
    }

    /// The largest lane.
    pub fn max_lane(self) -> f32 {
        self.0.into_iter().fold(f32::NEG_INFINITY, f32::max)
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

    /// True if all lanes are 0.
    pub fn is_black(self) -> bool {
        self.0 == [0.0; 4]
    }
}

macro_rules! lane_wise {
    ($($trait:ident $method:ident $operator:tt)*) => {$(
        impl $trait for Spectrum {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $operator b)
            }
        }
    )*};
}

lane_wise! { Add add + Sub sub - Mul mul * }

impl Mul<f32> for Spectrum {
    type Output = Self;
    fn mul(self, factor: f32) -> Self {
        self.map(|lane| lane * factor)
    }
}

impl Div<f32> for Spectrum {
    type Output = Self;
    fn div(self, divisor: f32) -> Self {
        self.map(|lane| lane / divisor)
    }
}

impl AddAssign for Spectrum {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl MulAssign for Spectrum {
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}
