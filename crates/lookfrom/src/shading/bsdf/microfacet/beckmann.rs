//! Beckmann's distribution of microfacet normals: slopes are normally distributed.
//!
//! Visible normals are sampled by their slopes: across the view they are normally distributed, along it the distribution function
//! is inverted by Newton's method in the variable in which it is nearly linear, erfc.
//!
//! Beckmann & Spizzichino 1963; Smith 1967 (masking); Walter et al. 2007; Heitz & d'Eon 2014 (visible normals); Jakob 2014 (the
//! inversion, and its beginning).

use std::f32::consts::PI;

use lookfrom_simd::{Float, Real};

use super::TrowbridgeReitz;
use crate::core::elementary::{exp, ln};
use crate::core::vector::Vector;

/// 1/√π.
const FRAC_1_SQRT_PI: f32 = 0.564_189_6;

/// As [`TrowbridgeReitz::d`]. Not inlined, as the next two, since few surfaces need it, in many places; and cold, so that those places keep
/// their registers.
#[cold]
#[inline(never)]
pub(super) fn d<R: Real>(alpha: TrowbridgeReitz<R>, wm: Vector<R>) -> R {
    wm.z.at_level(
        #[inline(always)]
        || {
            let cos2 = wm.z * wm.z;
            let (x, y) = (wm.x / alpha.alpha_x, wm.y / alpha.alpha_y);
            let density = exp(-(x * x + y * y) / cos2) / (alpha.alpha_x * PI * alpha.alpha_y * cos2 * cos2);
            R::select(cos2.lt(cos2.like(1e-8)), cos2.like(0.0), density)
        },
    )
}

/// Smith's Λ: `½ (exp(−a²) / (a √π) − erfc a)`, where a is the cotangent of the direction's angle over α.
#[cold]
#[inline(never)]
pub(super) fn lambda<R: Real>(alpha: TrowbridgeReitz<R>, w: Vector<R>) -> R {
    w.z.at_level(
        #[inline(always)]
        || {
            let (x, y) = (alpha.alpha_x * w.x, alpha.alpha_y * w.y);
            let tangent = Float::sqrt((x * x + y * y) / (w.z * w.z));
            let a = w.z.like(1.0) / Float::max(tangent, w.z.like(1e-6));
            exp(-a * a) * (tangent * FRAC_1_SQRT_PI - scaled_erfc(a)) * 0.5
        },
    )
}

/// As [`TrowbridgeReitz::sample`].
#[cold]
#[inline(never)]
pub(super) fn sample<R: Real>(alpha: TrowbridgeReitz<R>, wo: Vector<R>, u: [R; 2]) -> Vector<R> {
    wo.z.at_level(
        #[inline(always)]
        || {
            let (zero, one) = (wo.z.like(0.0), wo.z.like(1.0));
            let up = wo.negate_where(wo.z.lt(zero));
            // Stretched so that α is 1, the azimuth of the view, and the tangent of its angle to the normal.
            let (x, y) = (alpha.alpha_x * up.x, alpha.alpha_y * up.y);
            let radius = Float::sqrt(x * x + y * y);
            let is_tilted = radius.gt(zero);
            let (cos, sin) = (R::select(is_tilted, x / radius, one), R::select(is_tilted, y / radius, zero));
            let tangent = Float::clamp(radius / up.z, 0.0, GREATEST_TANGENT);
            let [along, across] = [slope_along_view(tangent, u[0]), slope_of_erfc(u[1] * 2.0)];
            let slope_x = (cos * along - sin * across) * alpha.alpha_x;
            let slope_y = (sin * along + cos * across) * alpha.alpha_y;
            Vector { x: -slope_x, y: -slope_y, z: one }.normalize()
        },
    )
}

/// The greatest tangent that views are told apart by.
const GREATEST_TANGENT: f32 = 1e6;

/// The slope s, in the direction of the view, of a visible facet where α is 1. Below it is the fraction of them
/// `(p + t exp(−s²) / √π) / (q + t exp(−1/t²) / √π)` with the tangent t of the view, p = erfc(−s) and q = erfc(−1/t).
#[inline(always)]
fn slope_along_view<R: Real>(tangent: R, u: R) -> R {
    let u = Float::clamp(u, LEAST, 1.0 - LEAST);
    let cotangent = u.like(1.0) / Float::max(tangent, u.like(1.0 / GREATEST_TANGENT));
    let gauss = exp(-cotangent * cotangent);
    let most = u.like(2.0) - scaled_erfc(cotangent) * gauss;
    let wanted = u * (most + tangent * FRAC_1_SQRT_PI * gauss);
    // In a grazing view the fraction is exp(−s²), for s < 0.
    let mut p = most * u * scaled_erfc(Float::sqrt(-ln(u)));
    let mut steps = 3;
    while steps > 0 {
        let slope = slope_of_erfc(p);
        let excess = p + tangent * FRAC_1_SQRT_PI * exp(-slope * slope) - wanted;
        // It is 0 at the horizon of the view only.
        let derivative = Float::max(u.like(1.0) - slope * tangent, u.like(1e-4));
        p = Float::min(Float::max(p - excess / derivative, u.like(1e-10)), most);
        steps -= 1;
    }
    slope_of_erfc(p)
}

/// The numbers next to 0 and 1 that are told apart: slopes beyond have no visible part.
const LEAST: f32 = 1e-6;

/// exp(x²) erfc(x) for x ≥ 0, where erfc has the absolute error 1.5 · 10⁻⁷ (Hastings 1955; Abramowitz & Stegun 1964, 7.1.26).
#[inline(always)]
fn scaled_erfc<R: Real>(x: R) -> R {
    let t = x.like(1.0) / (x * 0.327_591_1 + 1.0);
    let sum = (((t * 1.061_405_4 - 1.453_152_1) * t + 1.421_413_8) * t - 0.284_496_72) * t + 0.254_829_6;
    sum * t
}

/// The s for which erfc(−s) is p, 0 < p < 2 (Giles 2010, in single precision).
#[inline(always)]
fn slope_of_erfc<R: Real>(p: R) -> R {
    let p = Float::clamp(p, 1e-10, 2.0 - 2e-7);
    let w = -ln(p * (-p + 2.0));
    let near = polynomial(
        w - 2.5,
        &[
            1.501_409_4,
            0.246_640_73,
            -4.177_681_6e-3,
            -1.253_725e-3,
            2.185_808_7e-4,
            -4.391_506_5e-6,
            -3.523_387_7e-6,
            3.432_739_4e-7,
            2.810_226_4e-8,
        ],
    );
    let far = polynomial(
        Float::sqrt(w) - 3.0,
        &[
            2.832_976_8,
            1.001_674,
            9.438_870_5e-3,
            -7.622_461_3e-3,
            5.739_507_7e-3,
            -3.673_428_4e-3,
            1.349_343_2e-3,
            1.009_505_6e-4,
            -2.002_142_6e-4,
        ],
    );
    R::select(w.lt(w.like(5.0)), near, far) * (p - 1.0)
}

/// A polynomial by its coefficients from the constant on.
#[inline(always)]
fn polynomial<R: Real>(x: R, coefficients: &[f32; 9]) -> R {
    let mut sum = x.like(coefficients[8]);
    let mut power = 8;
    while power > 0 {
        power -= 1;
        sum = sum * x + coefficients[power];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_have_the_error_function() {
        for k in 1..4000 {
            let p = k as f32 / 2000.0;
            let slope = f64::from(slope_of_erfc(p));
            assert!((libm::erfc(-slope) - f64::from(p)).abs() < 1e-6, "{p}: {slope}");
        }
        for exponent in 3..8 {
            let p = 10_f32.powi(-exponent);
            let slope = f64::from(slope_of_erfc(p));
            assert!((libm::erfc(-slope) / f64::from(p) - 1.0).abs() < 1e-3, "{p}: {slope}");
        }
    }

    #[test]
    fn complements_are_known() {
        for k in 0..2000 {
            let x = k as f32 / 200.0;
            let found = f64::from(scaled_erfc(x)) * libm::exp(-f64::from(x * x));
            // The error of the fit, and of rounding.
            assert!((found - libm::erfc(f64::from(x))).abs() < 5e-7, "{x}: {found}");
        }
    }

    #[test]
    fn as_many_slopes_are_below_one_as_should_be() {
        for tangent in [0.0, 1e-3, 0.1, 0.3, 1.0, 3.0, 10.0, 1e3, 1e6] {
            let t = f64::from(tangent).max(1e-6);
            let below =
                |slope: f64| libm::erfc(-slope) + t * libm::exp(-slope * slope) / std::f64::consts::PI.sqrt();
            for k in 0..1000 {
                let u = (k as f32 + 0.5) / 1000.0;
                let slope = f64::from(slope_along_view(tangent, u));
                assert!(slope * t < 1.0 + 1e-4, "{tangent} {u}: {slope} faces away");
                let found = below(slope) / below(1.0 / t);
                assert!((found - f64::from(u)).abs() < 5e-6, "{tangent} {u}: {slope} has {found}");
            }
        }
    }
}
