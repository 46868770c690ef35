//! The Trowbridge–Reitz (GGX) microfacet distribution, with visible normals sampled (Heitz 2018); Beckmann's is beside it.
//!
//! The distribution has two roughnesses and Smith's height-correlated masking-shadowing. The scattering by the
//! facets is left to conductors and dielectrics.
//!
//! Trowbridge & Reitz 1975; Walter et al. 2007; Heitz 2014 (masking), 2018 (visible normals); Dupuy & Benyoub 2023
//! (visible normals by a spherical cap).

mod beckmann;
mod model;

use std::f32::consts::PI;

use lookfrom_simd::{Float, Real};

use crate::core::vector::Vector;
use crate::core::warp;

pub use model::Microfacets;

/// The Trowbridge–Reitz distribution of microfacet normals. They have unit length and z > 0; directions may be on
/// either side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrowbridgeReitz<R = f32> {
    /// α along x: the spread of the slopes.
    pub(crate) alpha_x: R,
    /// α along y.
    pub(crate) alpha_y: R,
}

impl TrowbridgeReitz {
    /// No roughness.
    pub const SMOOTH: Self = Self { alpha_x: 0.0, alpha_y: 0.0 };

    /// By α along x and y. Where one is rough, the other is at least 10⁻⁴; negative or NaN is 0.
    pub fn new(alpha_x: f32, alpha_y: f32) -> Self {
        let [x, y] = [alpha_x, alpha_y].map(|alpha| if alpha > 0.0 { alpha.min(1e4) } else { 0.0 });
        let smooth = Self { alpha_x: x, alpha_y: y };
        if smooth.is_smooth() { smooth } else { Self { alpha_x: x.max(1e-4), alpha_y: y.max(1e-4) } }
    }

    /// By pbrt's roughness along x and y; with `remap` α is its square root.
    pub fn from_roughness(roughness: [f32; 2], remap: bool) -> Self {
        let [x, y] = if remap { roughness.map(Self::roughness_to_alpha) } else { roughness };
        Self::new(x, y)
    }

    /// α of a roughness, as in pbrt: its square root.
    pub fn roughness_to_alpha(roughness: f32) -> f32 {
        roughness.max(0.0).sqrt()
    }

    /// Increases the roughness for the later bounces of a path, as pbrt's `regularize`: below 0.3 it is doubled,
    /// within 0.1 … 0.3.
    pub fn regularize(&mut self) {
        for alpha in [&mut self.alpha_x, &mut self.alpha_y] {
            if *alpha < 0.3 {
                *alpha = (2.0 * *alpha).clamp(0.1, 0.3);
            }
        }
    }
}

impl<R: Real> TrowbridgeReitz<R> {
    /// True if it is so smooth that it counts as specular.
    #[inline(always)]
    pub fn is_smooth(self) -> R::Mask {
        Float::max(self.alpha_x, self.alpha_y).lt(self.alpha_x.like(1e-3))
    }

    /// D(ω_m): area of microfacets with normals about `wm`, per solid angle and per area of the surface. 0 at the
    /// horizon, as in pbrt.
    #[inline(always)]
    pub fn d(self, wm: Vector<R>) -> R {
        let cos2 = wm.z * wm.z;
        let (x, y) = (wm.x / self.alpha_x, wm.y / self.alpha_y);
        let stretched = x * x + y * y + cos2;
        let density = cos2.like(1.0) / (self.alpha_x * PI * self.alpha_y * stretched * stretched);
        R::select(cos2.lt(cos2.like(1e-8)), cos2.like(0.0), density)
    }

    /// Smith's Λ: masked over visible area of the microsurface as seen from `w`, which must not lie in the
    /// surface.
    #[inline(always)]
    fn lambda(self, w: Vector<R>) -> R {
        let (x, y) = (self.alpha_x * w.x, self.alpha_y * w.y);
        (Float::sqrt((x * x + y * y) / (w.z * w.z) + 1.0) - 1.0) * 0.5
    }

    /// Masking: the fraction of the microfacets facing `w` that is visible from `w`.
    #[inline(always)]
    pub fn g1(self, w: Vector<R>) -> R {
        w.z.like(1.0) / (self.lambda(w) + 1.0)
    }

    /// Masking-shadowing: the fraction that is visible from both directions.
    #[inline(always)]
    pub fn g(self, wo: Vector<R>, wi: Vector<R>) -> R {
        wo.z.like(1.0) / (self.lambda(wo) + 1.0 + self.lambda(wi))
    }

    /// Density of [`Self::sample`] over the solid angle of microfacet normals, divided by `|wo·wm|`: the form in
    /// which it is needed. `wm` must face `wo`.
    #[inline(always)]
    pub fn visible_per_cosine(self, wo: Vector<R>, wm: Vector<R>) -> R {
        self.d(wm) * self.g1(wo) / Float::abs(wo.z)
    }

    /// Samples a microfacet normal with z > 0 among those visible from `wo` (from its mirror image above, where
    /// it is below).
    #[inline(always)]
    pub fn sample(self, wo: Vector<R>, u: [R; 2]) -> Vector<R> {
        // Stretch the ellipsoid of normals to a hemisphere: there the reflected direction is uniform in a cap.
        let up = wo.negate_where(wo.z.lt(wo.z.like(0.0)));
        let w = Vector { x: self.alpha_x * up.x, y: self.alpha_y * up.y, z: up.z }.normalize();
        let h = warp::uniform_cone(u, w.z + 1.0) + w;
        // Transform back, and stay off the horizon.
        let z = Float::max(h.z, h.z.like(1e-6));
        Vector { x: self.alpha_x * h.x, y: self.alpha_y * h.y, z }.normalize()
    }
}
