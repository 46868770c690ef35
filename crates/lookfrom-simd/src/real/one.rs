//! Numbers of width one.

use super::{Bits, Float, Mask, Real};

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
