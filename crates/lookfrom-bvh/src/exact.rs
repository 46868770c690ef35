//! The ray of the exact tests: in f64, in the world or in an object's space.

use crate::ray::Ray;
use crate::vector::wide;

/// A ray for exact tests. In an instance it is not rounded to f32.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExactRay<T = f32> {
    pub(crate) origin: [f64; 3],
    pub(crate) direction: [f64; 3],
    /// Hits need a t above this, rounded to the same type.
    pub(crate) t_min: T,
}

/// The type that results are rounded to: f32, or f64 without rounding.
pub(crate) trait Rounded: Copy + PartialOrd {
    fn rounded(x: f64) -> Self;
}

impl Rounded for f32 {
    #[inline(always)]
    fn rounded(x: f64) -> Self {
        x as Self
    }
}

impl Rounded for f64 {
    #[inline(always)]
    fn rounded(x: f64) -> Self {
        x
    }
}

impl ExactRay {
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Self {
        Self { origin: wide(ray.origin), direction: wide(ray.direction), t_min: ray.t_min }
    }
}

impl<T: Rounded> ExactRay<T> {
    /// The axes in cyclic order, with the largest component of the direction last.
    #[inline(always)]
    pub(crate) fn axes(&self) -> [usize; 3] {
        let [x, y, z] = self.direction.map(f64::abs);
        if (x > y) & (x > z) {
            [1, 2, 0]
        } else if y > z {
            [2, 0, 1]
        } else {
            [0, 1, 2]
        }
    }
}
