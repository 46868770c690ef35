//! The vector operations of the tests, for numbers and for lanes of numbers.

use std::ops::{Add, Mul, Sub};

use lookfrom_simd::round_toward;

/// Numbers, or lanes of numbers.
pub(crate) trait Number: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {}

impl<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T>> Number for T {}

#[inline(always)]
pub(crate) fn wide(a: [f32; 3]) -> [f64; 3] {
    [f64::from(a[0]), f64::from(a[1]), f64::from(a[2])]
}

#[inline(always)]
pub(crate) fn subtract<T: Number>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(crate) fn dot<T: Number>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn cross<T: Number>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The cross product's terms without their signs: the magnitude that its rounding errors are relative to.
pub(crate) fn cross_magnitude(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    let [a, b] = [a.map(f64::abs), b.map(f64::abs)];
    [a[1] * b[2] + a[2] * b[1], a[2] * b[0] + a[0] * b[2], a[0] * b[1] + a[1] * b[0]]
}

/// The smallest f32 that is not below `x`.
pub(crate) fn round_up(x: f64) -> f32 {
    round_toward(x, true, false)
}

/// The largest f32 that is not above `x`.
pub(crate) fn round_down(x: f64) -> f32 {
    round_toward(x, false, true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_is_the_next_number_on_the_right_side() {
        let up = |x: f64| if f64::from(x as f32) < x { (x as f32).next_up() } else { x as f32 };
        let mut seed = 1_u64;
        for _ in 0..100_000 {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            // Random exponents of f32 and beyond.
            let bits = seed & !(0x7ff << 52) | (860 + (seed >> 20) % 300) << 52;
            let x = f64::from_bits(bits);
            assert_eq!(round_up(x).to_bits(), up(x).to_bits(), "{x:e}");
            assert_eq!(round_down(x).to_bits(), (-up(-x)).to_bits(), "{x:e}");
        }
        for x in [0.0, -0.0, 1.0, f64::INFINITY, f64::MAX, -f64::MAX, 1e-300] {
            assert_eq!((round_up(x), round_down(x)), (up(x), -up(-x)), "{x:e}");
        }
        assert!(round_up(f64::NAN).is_nan());
    }
}
