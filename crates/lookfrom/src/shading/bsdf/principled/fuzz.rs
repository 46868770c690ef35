//! Fuzz: fibres upright on a surface, by a cosine lobe that is transformed linearly (Zeltner, Burley & Chiang 2022,
//! "Practical Multiple-Scattering Sheen Using Linearly Transformed Cosines").
//!
//! Albedo and transformation are MaterialX's fits to the tables of the paper. The lobe is not reciprocal: its shape is that
//! of light toward the viewer.

use std::f32::consts::PI;

use lookfrom_simd::{Float, Real};

use crate::core::elementary;
use crate::core::vector::Vector;
use crate::core::warp;

/// The smallest roughness of the tables.
const SMOOTHEST: f32 = 0.01;

/// Fuzz of a roughness, seen from a direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fuzz<R> {
    /// The horizontal direction toward the viewer.
    toward: [R; 2],
    /// Two entries of the matrix from directions to those of a cosine lobe.
    stretch: R,
    shear: R,
    albedo: R,
}

/// The fraction of light that white fuzz reflects, for a direction of a cosine.
#[inline(always)]
pub(super) fn albedo<R: Real>(cos: R, roughness: R) -> R {
    let x = Float::clamp(cos, 0.0, 1.0);
    let y = Float::clamp(roughness, SMOOTHEST, 1.0);
    let width = y * (y * 1.584_91 + 0.020_660_7) / (y * (y + 1.322_27) + 0.037_942_4);
    let cubic = y * (y * (y * y * -0.959_43 + 1.793_2) - 1.148_85);
    let middle = y * (cubic - 0.193_854) / (y + 0.046_391);
    let rest = y * (y * (y * 0.119_681 - 0.020_781_8) + 6.540_23e-4) / (y * (y - 1.920_21) + 1.262_64);
    let t = (x - middle) / width;
    let bell = elementary::exp(t * t * -0.5) / (width * (2.0 * PI).sqrt());
    Float::clamp(bell + rest, 0.0, 1.0)
}

impl<R: Real> Fuzz<R> {
    /// Seen from a direction above.
    #[inline(always)]
    pub(super) fn new(roughness: R, wo: Vector<R>) -> Self {
        let (zero, one) = (wo.z.like(0.0), wo.z.like(1.0));
        let x = Float::clamp(wo.z, 0.0, 1.0);
        let y = Float::clamp(roughness, SMOOTHEST, 1.0);
        let stretch = (x * 2.581_26 + y * 0.813_703) * y / (x * x * 0.310_327 + x * y * 2.609_94 + 1.0);
        let below = x * 1.712_28 - x * y * 1.715_06 + y * y * 1.341_74 + 2.540_53e-5;
        let shear = Float::sqrt(one - x) * (y - 1.0) * y * y * y / below;
        let across = Float::sqrt(wo.x * wo.x + wo.y * wo.y);
        let is_tilted = across.gt(zero);
        let toward = [R::select(is_tilted, wo.x / across, one), R::select(is_tilted, wo.y / across, zero)];
        Self { toward, stretch, shear, albedo: albedo(wo.z, roughness) }
    }

    /// The density over solid angle of a direction above, over its cosine: that of [`Self::sample`].
    #[inline(always)]
    fn density(&self, wi: Vector<R>) -> R {
        let [x, y] = self.toward;
        let along = self.stretch * (wi.x * x + wi.y * y) + self.shear * wi.z;
        let across = self.stretch * (wi.y * x - wi.x * y);
        let length2 = Float::max(along * along + across * across + wi.z * wi.z, wi.z.like(1e-15));
        self.stretch * self.stretch / (length2 * length2 * PI)
    }

    /// `f` of white fuzz toward a direction above.
    #[inline(always)]
    pub(super) fn f(&self, wi: Vector<R>) -> R {
        self.albedo * self.density(wi)
    }

    /// Density over solid angle of the directions that are sampled, which are above.
    #[inline(always)]
    pub(super) fn pdf(&self, wi: Vector<R>) -> R {
        self.density(wi) * Float::max(wi.z, wi.z.like(0.0))
    }

    /// A direction above.
    #[inline(always)]
    pub(super) fn sample(&self, u: [R; 2]) -> Vector<R> {
        let cosine = warp::cosine_about_z(u);
        let along = (cosine.x - self.shear * cosine.z) / self.stretch;
        let across = cosine.y / self.stretch;
        let [x, y] = self.toward;
        Vector { x: along * x - across * y, y: along * y + across * x, z: cosine.z }.normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shading::bsdf::tests::direction;

    #[test]
    fn the_lobe_has_its_albedo() {
        for roughness in [0.05, 0.3, 0.7, 1.0_f32] {
            for angle in [0.0, 45.0, 80.0] {
                let wo = Vector::from(direction(angle, 70.0));
                let fuzz = Fuzz::new(roughness, wo);
                const N: usize = 1500;
                let (mut sum, mut density) = (0.0_f64, 0.0_f64);
                for k in 0..N * N {
                    let u = [((k % N) as f32 + 0.5) / N as f32, ((k / N) as f32 + 0.5) / N as f32];
                    let wi = warp::uniform_cone(u, 1.0);
                    sum += f64::from(fuzz.f(wi) * wi.z) * std::f64::consts::TAU;
                    density += f64::from(fuzz.pdf(wi)) * std::f64::consts::TAU;
                }
                let [sum, density] = [sum, density].map(|sum| sum / (N * N) as f64);
                let expected = f64::from(albedo(wo.z, roughness));
                assert!((density - 1.0).abs() < 0.01, "{roughness} {angle}: {density}");
                assert!((sum - expected).abs() < 0.01, "{roughness} {angle}: {sum} {expected}");
            }
        }
        // Fine fibres are seen from the side.
        assert!(albedo(0.05_f32, 0.2) > 3.0 * albedo(0.9_f32, 0.2));
    }

    #[test]
    fn samples_are_above() {
        let fuzz = Fuzz::new(0.2_f32, direction(70.0, 10.0).into());
        for u in [[0.1, 0.2], [0.3, 0.9], [0.9, 0.5]] {
            let wi = fuzz.sample(u);
            assert!(wi.z > 0.0 && (wi.length() - 1.0).abs() < 1e-5, "{wi:?}");
        }
    }
}
