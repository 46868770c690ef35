//! The Trowbridge–Reitz (GGX) microfacet distribution, with visible normals sampled (Heitz 2018).
//!
//! The Trowbridge–Reitz (GGX) distribution with two roughnesses, Smith's masking with heights correlated, and sampling
//! of the normals that `wo` sees. What the mirrors do with light is left to conductors and dielectrics.
//!
//! Trowbridge & Reitz 1975; Walter et al. 2007; Heitz 2014 (masking), 2018 (visible normals); Dupuy & Benyoub 2023
//! (visible normals by a spherical cap).

use glam::Vec3;
use std::f32::consts::PI;

use crate::core::warp;

/// The Trowbridge–Reitz distribution of micro-normals. They are of unit length with z > 0; directions may be on either
/// side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrowbridgeReitz {
    /// Spread of the slopes along x.
    pub(crate) alpha_x: f32,
    /// Spread of the slopes along y.
    pub(crate) alpha_y: f32,
}

impl TrowbridgeReitz {
    /// No roughness at all.
    pub const SMOOTH: Self = Self { alpha_x: 0.0, alpha_y: 0.0 };

    /// By the slopes' spread along x and y. Where one is rough, the other is at least 10⁻⁴; negative or NaN is 0.
    pub fn new(alpha_x: f32, alpha_y: f32) -> Self {
        let [x, y] = [alpha_x, alpha_y].map(|alpha| if alpha > 0.0 { alpha.min(1e4) } else { 0.0 });
        let smooth = Self { alpha_x: x, alpha_y: y };
        if smooth.is_smooth() { smooth } else { Self { alpha_x: x.max(1e-4), alpha_y: y.max(1e-4) } }
    }

    /// By pbrt's roughness along x and y; with `remap` its square root is the slopes' spread.
    pub fn from_roughness(roughness: [f32; 2], remap: bool) -> Self {
        let [x, y] = if remap { roughness.map(Self::roughness_to_alpha) } else { roughness };
        Self::new(x, y)
    }

    /// The spread of slopes that pbrt means by a roughness: its square root.
    pub fn roughness_to_alpha(roughness: f32) -> f32 {
        roughness.max(0.0).sqrt()
    }

    /// Whether it is so smooth that it counts as a mirror.
    #[inline]
    pub fn is_smooth(self) -> bool {
        self.alpha_x.max(self.alpha_y) < 1e-3
    }

    /// Makes it rough enough for the later bounces of a path, as pbrt's `regularize`: below 0.3 twice as rough, within
    /// 0.1 … 0.3.
    pub fn regularize(&mut self) {
        for alpha in [&mut self.alpha_x, &mut self.alpha_y] {
            if *alpha < 0.3 {
                *alpha = (2.0 * *alpha).clamp(0.1, 0.3);
            }
        }
    }

    /// Area of micro-normals about `wm` per solid angle and per area of the surface. 0 along the horizon, as in pbrt.
    #[inline]
    pub fn d(self, wm: Vec3) -> f32 {
        let cos2 = wm.z * wm.z;
        if cos2 < 1e-8 {
            return 0.0;
        }
        let (x, y) = (wm.x / self.alpha_x, wm.y / self.alpha_y);
        let stretched = x * x + y * y + cos2;
        1.0 / (PI * self.alpha_x * self.alpha_y * stretched * stretched)
    }

    /// Hidden over visible area of the micro-surface, as seen from `w`, which must not lie in the surface.
    #[inline]
    fn lambda(self, w: Vec3) -> f32 {
        let (x, y) = (self.alpha_x * w.x, self.alpha_y * w.y);
        0.5 * ((1.0 + (x * x + y * y) / (w.z * w.z)).sqrt() - 1.0)
    }

    /// The part of the micro-surface facing `w` that `w` sees.
    #[inline]
    pub fn g1(self, w: Vec3) -> f32 {
        1.0 / (1.0 + self.lambda(w))
    }

    /// The part that both see.
    #[inline]
    pub fn g(self, wo: Vec3, wi: Vec3) -> f32 {
        1.0 / (1.0 + self.lambda(wo) + self.lambda(wi))
    }

    /// Density of [`Self::sample`] over the solid angle of micro-normals, divided by `|wo·wm|`: the form in which it is
    /// needed. `wm` must face `wo`.
    #[inline]
    pub fn visible_per_cosine(self, wo: Vec3, wm: Vec3) -> f32 {
        self.d(wm) * self.g1(wo) / wo.z.abs()
    }

    /// A micro-normal with z > 0 among those that `wo` sees (that `−wo` would see from above, when it is below).
    #[inline]
    pub fn sample(self, wo: Vec3, u: [f32; 2]) -> Vec3 {
        // Squeeze the ellipsoid of normals into a hemisphere: there the mirrored direction is uniform in a cap.
        let up = if wo.z < 0.0 { -wo } else { wo };
        let w = Vec3::new(self.alpha_x * up.x, self.alpha_y * up.y, up.z).normalize();
        let h = warp::uniform_cone(u, 1.0 + w.z) + w;
        // And back, keeping off the horizon.
        Vec3::new(self.alpha_x * h.x, self.alpha_y * h.y, h.z.max(1e-6)).normalize()
    }
}
