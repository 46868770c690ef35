//! Microfacets of a kind: one of two distributions, with one of two maskings.
//!
//! Lanes may have different kinds. What is not usual is computed only if any lane asks for it, in functions of its own.

use lookfrom_scene::material as written;
use lookfrom_scene::material::{Distribution, Masking};
use lookfrom_simd::{Float, Mask, Real};

use super::{TrowbridgeReitz, beckmann};
use crate::core::vector::Vector;

/// Microfacets of a roughness and a kind. Their normals have unit length and z > 0; directions may be on either side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Microfacets<R = f32> {
    /// α along both axes, and all there is to know where the kind is the usual one.
    pub(crate) alpha: TrowbridgeReitz<R>,
    /// The kind: ±1 for the distribution of Trowbridge and Reitz, ±2 for Beckmann's; negative where masking is separable.
    pub(crate) kind: R,
}

impl Microfacets {
    /// By α and the kind.
    pub fn new(alpha: TrowbridgeReitz, kind: written::Microfacets) -> Self {
        let distribution = match kind.distribution {
            Distribution::TrowbridgeReitz => 1.0,
            Distribution::Beckmann => 2.0,
        };
        let kind = match kind.masking {
            Masking::Correlated => distribution,
            Masking::Separable => -distribution,
        };
        Self { alpha, kind }
    }

    /// As [`TrowbridgeReitz::regularize`].
    pub fn regularize(&mut self) {
        self.alpha.regularize();
    }
}

impl From<TrowbridgeReitz> for Microfacets {
    fn from(alpha: TrowbridgeReitz) -> Self {
        Self { alpha, kind: 1.0 }
    }
}

impl<R: Real> Microfacets<R> {
    /// Whether the distribution is Beckmann's.
    #[inline(always)]
    pub(crate) fn is_beckmann(self) -> R::Mask {
        Float::abs(self.kind).gt(self.kind.like(1.5))
    }

    /// Whether masking is that of each direction alone.
    #[inline(always)]
    fn is_separable(self) -> R::Mask {
        self.kind.lt(self.kind.like(0.0))
    }

    /// As [`TrowbridgeReitz::is_smooth`].
    #[inline(always)]
    pub fn is_smooth(self) -> R::Mask {
        self.alpha.is_smooth()
    }

    /// As [`TrowbridgeReitz::d`].
    #[inline(always)]
    pub fn d(self, wm: Vector<R>) -> R {
        let usual = self.alpha.d(wm);
        let is_beckmann = self.is_beckmann();
        if !is_beckmann.any() {
            return usual;
        }
        R::select(is_beckmann, beckmann::d(self.alpha, wm), usual)
    }

    #[inline(always)]
    fn lambda(self, w: Vector<R>) -> R {
        let usual = self.alpha.lambda(w);
        let is_beckmann = self.is_beckmann();
        if !is_beckmann.any() {
            return usual;
        }
        R::select(is_beckmann, beckmann::lambda(self.alpha, w), usual)
    }

    /// As [`TrowbridgeReitz::g1`].
    #[inline(always)]
    pub fn g1(self, w: Vector<R>) -> R {
        w.z.like(1.0) / (self.lambda(w) + 1.0)
    }

    /// As [`TrowbridgeReitz::g`].
    #[inline(always)]
    pub fn g(self, wo: Vector<R>, wi: Vector<R>) -> R {
        let [g, _] = self.g_and_g1(wo, wi);
        g
    }

    /// [`Self::g`], and [`Self::g1`] of the first direction.
    #[inline(always)]
    pub(crate) fn g_and_g1(self, wo: Vector<R>, wi: Vector<R>) -> [R; 2] {
        let (one, zero) = (wo.z.like(1.0), wo.z.like(0.0));
        let (o, i) = (self.lambda(wo), self.lambda(wi));
        let sum = o + 1.0;
        let mut both = sum + i;
        let is_separable = self.is_separable();
        if is_separable.any() {
            both = both + R::select(is_separable, o * i, zero);
        }
        [one / both, one / sum]
    }

    /// As [`TrowbridgeReitz::visible_per_cosine`].
    #[inline(always)]
    pub fn visible_per_cosine(self, wo: Vector<R>, wm: Vector<R>) -> R {
        self.d(wm) * self.g1(wo) / Float::abs(wo.z)
    }

    /// As [`TrowbridgeReitz::sample`].
    #[inline(always)]
    pub fn sample(self, wo: Vector<R>, u: [R; 2]) -> Vector<R> {
        let is_beckmann = self.is_beckmann();
        if is_beckmann.all() {
            return beckmann::sample(self.alpha, wo, u);
        }
        let usual = self.alpha.sample(wo, u);
        if !is_beckmann.any() {
            return usual;
        }
        Vector::select(is_beckmann, beckmann::sample(self.alpha, wo, u), usual)
    }
}
