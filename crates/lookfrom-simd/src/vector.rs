//! Vectors of three components, of any width and precision: one vector, or eight side by side.
//!
//! The operations are those of the crate `glam` in its order, so that code which is generic over [`Real`] and code that
//! uses its vectors agree bit for bit.

use std::ops::{Add, Mul, Neg, Sub};

use crate::real::{Float, Real};

#[cfg(feature = "glam")]
mod of_glam;

/// Three components, each as wide as `F`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector<F> {
    /// The first component.
    pub x: F,
    /// The second.
    pub y: F,
    /// The third.
    pub z: F,
}

impl<F: Float> Vector<F> {
    /// By its components.
    #[inline(always)]
    pub fn new(x: F, y: F, z: F) -> Self {
        Self { x, y, z }
    }

    /// A vector in each lane, of which there are as many as in `like`.
    #[inline(always)]
    pub fn splat(like: F, [x, y, z]: [F::Scalar; 3]) -> Self {
        Self { x: like.like(x), y: like.like(y), z: like.like(z) }
    }

    /// The scalar product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> F {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// The square of the length.
    #[inline(always)]
    pub fn length_squared(self) -> F {
        self.dot(self)
    }

    /// The vector product.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    /// The vector product's terms without their signs: the magnitude that its rounding errors are relative to.
    #[inline(always)]
    pub fn cross_magnitude(self, other: Self) -> Self {
        let (a, b) = (self.abs(), other.abs());
        Self { x: a.y * b.z + a.z * b.y, y: a.z * b.x + a.x * b.z, z: a.x * b.y + a.y * b.x }
    }

    /// The length.
    #[inline(always)]
    pub fn length(self) -> F {
        Float::sqrt(self.dot(self))
    }

    /// The product, component by component.
    #[inline(always)]
    pub fn times(self, other: Self) -> Self {
        Self { x: self.x * other.x, y: self.y * other.y, z: self.z * other.z }
    }

    /// Component by component without its sign.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Self { x: Float::abs(self.x), y: Float::abs(self.y), z: Float::abs(self.z) }
    }

    /// `yes` where the mask is set, `no` elsewhere.
    #[inline(always)]
    pub fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        Self {
            x: F::select(mask, yes.x, no.x),
            y: F::select(mask, yes.y, no.y),
            z: F::select(mask, yes.z, no.z),
        }
    }

    /// The opposite vector where the mask is set.
    #[inline(always)]
    pub fn negate_where(self, mask: F::Mask) -> Self {
        Self::select(mask, -self, self)
    }
}

impl<F: Float<Scalar: From<f32>>> Vector<F> {
    /// The vector of unit length in this direction. A vector without a length, or too short to tell, becomes NaN.
    #[inline(always)]
    pub fn normalize(self) -> Self {
        self * self.length_recip()
    }

    #[inline(always)]
    fn length_recip(self) -> F {
        let length = self.length();
        length.like(F::Scalar::from(1.0)) / length
    }

    /// The vector of unit length in this direction, and whether there is one.
    #[inline(always)]
    pub fn try_normalize(self) -> (Self, F::Mask) {
        let recip = self.length_recip();
        (self * recip, Float::is_finite(recip) & recip.gt(recip.like(F::Scalar::from(0.0))))
    }
}

impl<R: Real> Vector<R> {
    /// In double precision.
    #[inline(always)]
    pub fn widen(self) -> Vector<R::Double> {
        Vector { x: self.x.widen(), y: self.y.widen(), z: self.z.widen() }
    }

    /// Rounded to single precision.
    #[inline(always)]
    pub fn narrow(wide: Vector<R::Double>) -> Self {
        Self { x: R::narrow(wide.x), y: R::narrow(wide.y), z: R::narrow(wide.z) }
    }
}

impl<F: Float> Add for Vector<F> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl<F: Float> Sub for Vector<F> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl<F: Float> Mul<F> for Vector<F> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: F) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }
}

impl<F: Float> Neg for Vector<F> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z }
    }
}

impl<F> From<Vector<F>> for [F; 3] {
    #[inline(always)]
    fn from(v: Vector<F>) -> Self {
        [v.x, v.y, v.z]
    }
}

impl<F> From<[F; 3]> for Vector<F> {
    #[inline(always)]
    fn from([x, y, z]: [F; 3]) -> Self {
        Self { x, y, z }
    }
}
