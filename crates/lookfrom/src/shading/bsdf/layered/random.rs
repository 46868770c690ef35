//! Random numbers of walks through a coat: hashes of a seed of the sample and of their directions, at any width.

use lookfrom_simd::{Bits, Real};

use crate::core::hash;
use crate::core::vector::Vector;

/// Purpose of a walk's random numbers, so that walks for different purposes are independent.
#[derive(Clone, Copy)]
pub(super) enum Purpose {
    Value = 1,
    Sample,
    Density,
}

/// Random numbers in [0, 1) that are a function of their seed.
pub(super) struct Random<R: Real>(R::Bits);

impl<R: Real> Random<R> {
    /// 2³² divided by the golden ratio, made odd.
    const GOLDEN: u32 = 0x9e37_79b9;

    #[inline(always)]
    pub(super) fn new(purpose: Purpose, seed: R, wo: Vector<R>, [a, b, c]: [R; 3]) -> Self {
        let bits = Self::add(a.to_bits().like(purpose as u32), seed);
        let bits = Self::add(Self::add(Self::add(bits, wo.x), wo.y), wo.z);
        Self(hash::mix32(Self::add(Self::add(Self::add(bits, a), b), c)))
    }

    #[inline(always)]
    fn add(bits: R::Bits, number: R) -> R::Bits {
        hash::mix32(bits.wrapping_add(bits.like(Self::GOLDEN))) ^ number.to_bits()
    }

    /// A number for the lanes of a mask; the others' sequences stay where they are.
    #[inline(always)]
    pub(super) fn one(&mut self, mask: R::Mask) -> R {
        self.0 = R::select_bits(mask, self.0.wrapping_add(self.0.like(Self::GOLDEN)), self.0);
        R::from_integer(hash::mix32(self.0) >> 8) * (1.0 / 16_777_216.0)
    }

    #[inline(always)]
    pub(super) fn two(&mut self, mask: R::Mask) -> [R; 2] {
        [self.one(mask), self.one(mask)]
    }
}
