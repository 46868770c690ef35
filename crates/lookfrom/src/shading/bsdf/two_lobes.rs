//! A phase function of two lobes: one of Henyey & Greenstein 1941 and one of Draine 2003, which has the light that is scattered back, too.
//!
//! Of water droplets in fog and clouds, by Mie's theory for many sizes around a diameter, it is a fit: Jendersie & d'Eon 2023, "An
//! Approximate Mie Scattering Function for Fog and Cloud Rendering". There the first is a narrow peak ahead. Both lobes are
//!
//! ```text
//! p(μ) = (1 − g²) / (4π (1 + g² − 2 g μ)^(3/2)) · (1 + α μ²) / (1 + α (1 + 2 g²) / 3),   μ = cos θ
//! ```
//!
//! with α = 0 for the first. Peaks are a tenth of a degree wide: all is computed from 1 − μ, which has no cancellation there.

use std::f32::consts::FRAC_1_PI;

use lookfrom_scene::medium::DraineLobe;
use lookfrom_simd::{Float, Real};

use crate::core::elementary::sin_cos_of_turns;
use crate::core::math::both;
use crate::core::vector::Vector;
use crate::core::warp;

/// A mix of two lobes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoLobes<R = f32> {
    /// Mean cosine of the lobe of Henyey and Greenstein.
    pub(crate) ahead: R,
    /// g and …
    pub(crate) g: R,
    /// … α of Draine's lobe.
    pub(crate) alpha: R,
    /// Its share.
    pub(crate) weight: R,
}

/// Least and greatest diameter, in micrometres.
pub const DIAMETERS: [f32; 2] = [0.1, 50.0];

/// Least magnitude of g in Draine's lobe: numbers of its samples have the denominator g³.
const LEAST: f64 = 1e-3;

/// Steps to the sample of Draine's lobe, after which cosines are right to 2·10⁻⁷: Newton's double the number of right digits, bisections add one
/// in two.
const STEPS: u32 = 12;

impl TwoLobes {
    /// For water droplets of a diameter in micrometres, clamped to [`DIAMETERS`]: the fits of the paper's table, which has three ranges here.
    pub fn of_droplets(diameter: f32) -> Self {
        let [least, most] = DIAMETERS.map(f64::from);
        let d = f64::from(diameter).clamp(least, most);
        let (exp, cos, ln) = (libm::exp, libm::cos, libm::log(d));
        let [ahead, g, alpha, weight] = if d >= 5.0 {
            [
                exp(-0.0990567 / (d - 1.67154)),
                exp(-2.20679 / (d + 3.91029) - 0.428934),
                exp(3.62489 - 8.29288 / (d + 5.52825)),
                exp(-0.599085 / (d - 0.641583) - 0.665888),
            ]
        } else if d >= 1.5 {
            let twice = libm::log(ln);
            [
                0.0604931 * twice + 0.940256,
                0.500411 - 0.081287 / (libm::tan(ln) - 2.0 * ln + 1.27551),
                7.30354 * ln + 6.31675,
                0.026914 * (ln - cos(5.68947 * (twice - 0.0292149))) + 0.376475,
            ]
        } else {
            let inner = cos((ln - 0.238604) * (ln + 1.00667) / (0.507522 - 0.15677 * ln));
            [
                0.862 - 0.143 * ln * ln,
                0.379685 * cos(1.19692 * inner + 1.37932 * ln + 0.0625835) + 0.344213,
                250.0,
                0.146209 * cos(3.38707 * ln + 2.11193) + 0.316072 + 0.0778917 * ln,
            ]
        };
        let g = if g.abs() < LEAST { LEAST } else { g };
        Self { ahead: ahead as f32, g: g as f32, alpha: alpha as f32, weight: weight as f32 }
    }

    /// A lobe of Henyey and Greenstein with a mean cosine, and one of Draine, of which g = 0 is replaced by the least magnitude.
    pub fn new(g: f32, draine: DraineLobe) -> Self {
        let own = if f64::from(draine.g.abs()) < LEAST { LEAST as f32 } else { draine.g };
        Self { ahead: g, g: own, alpha: draine.alpha, weight: draine.share }
    }
}

impl<R: Real> TwoLobes<R> {
    /// The value of the phase function, per solid angle; also the density of [`Self::sample`].
    #[inline(always)]
    pub fn p(self, wo: Vector<R>, wi: Vector<R>) -> R {
        let [ahead, back] = self.lobes(wo, wi);
        ahead * (self.weight.like(1.0) - self.weight) + back * self.weight
    }

    /// The values of both lobes, which [`Self::p`] weights.
    #[inline(always)]
    pub(crate) fn lobes(self, wo: Vector<R>, wi: Vector<R>) -> [R; 2] {
        // 1 − μ = 1 + wo·wi of unit vectors.
        let apart = (wo + wi).length_squared() * 0.5;
        let mu = apart.like(1.0) - apart;
        both(
            [(self.ahead, mu.like(0.0)), (self.g, self.alpha)],
            #[inline(always)]
            |(g, alpha): (R, R)| {
                let (one, g2) = (g.like(1.0), g * g);
                let ahead = one - g;
                let square = Float::max(ahead * ahead + g * 2.0 * apart, g.like(f32::MIN_POSITIVE));
                let shape = (alpha * mu * mu + 1.0) / (alpha * (g2 * 2.0 + 1.0) / 3.0 + 1.0);
                (one - g2) * (0.25 * FRAC_1_PI) / (square * Float::sqrt(square)) * shape
            },
        )
    }

    /// Whether the number that a sample is chosen with chooses Draine's lobe.
    #[inline(always)]
    pub(crate) fn chooses_draine(self, u: R) -> R::Mask {
        u.lt(self.weight)
    }

    /// A direction distributed by [`Self::p`].
    #[inline(always)]
    pub fn sample(self, wo: Vector<R>, [u, v]: [R; 2]) -> Vector<R> {
        let one = u.like(1.0);
        let is_draine = self.chooses_draine(u);
        let back = self.draine(u / self.weight);
        let ahead = henyey_greenstein(self.ahead, (u - self.weight) / (one - self.weight));
        let apart = Float::clamp(R::select(is_draine, back, ahead), 0.0, 2.0);
        let sin = Float::sqrt(apart * (one * 2.0 - apart));
        let (sin_phi, cos_phi) = sin_cos_of_turns(v);
        let (s, t) = warp::basis_about(wo);
        (s * (sin * cos_phi) + t * (sin * sin_phi) - wo * (one - apart)).normalize()
    }

    /// 1 − μ of Draine's lobe, by the inverse of its cumulative distribution. Over s = √(1 + g² − 2 g μ), of which both ends are known, the
    /// density is (1 + α μ²) / s² times a constant, and its integral
    ///
    /// ```text
    /// α s³ / 12 g² − α (1 + g²) s / 2 g² − (1 + α (1 + g²)² / 4 g²) / s
    /// ```
    ///
    /// The root is found by Newton's method over 1 / s, with bisection where that would leave the interval that has it. In double precision, since terms
    /// cancel where g is small.
    #[inline(always)]
    fn draine(self, u: R) -> R {
        let (g, alpha, u) = (self.g.widen(), self.alpha.widen(), u.widen());
        let one = g.like(1.0);
        let (squares, of_square) = (one + g * g, alpha / (g * g * 4.0));
        let [cubic, linear, inverse] =
            [of_square * (1.0 / 3.0), of_square * squares * 2.0, one + of_square * squares * squares];
        let size = Float::abs(g);
        let (mut low, mut high) = (one - size, one + size);
        let [first, last] = both(
            [low, high],
            #[inline(always)]
            |s| cubic * s * s * s - linear * s - inverse / s,
        );
        let wanted = first + (last - first) * u;
        // The root where α = 0: then the integral is linear in 1 / s.
        let mut s = low * high / (high + (low - high) * u);
        for _ in 0..STEPS {
            let mu = (squares - s * s) / (g * 2.0);
            let density = (one + alpha * mu * mu) / (s * s);
            let beyond = cubic * s * s * s - linear * s - inverse / s - wanted;
            let is_above = beyond.gt(one.like(0.0));
            high = Float::select(is_above, s, high);
            low = Float::select(is_above, low, s);
            let next = s / (one + beyond / (density * s));
            // A root that has been found is at an end of the interval.
            let is_outside = next.lt(low) | next.gt(high);
            s = Float::select(is_outside, low * high * 2.0 / (low + high), next);
        }
        let ahead = one - g;
        R::narrow((s - ahead) * (s + ahead) / (g * 2.0))
    }
}

/// 1 − μ of the lobe of Henyey and Greenstein, for g > 0.
#[inline(always)]
fn henyey_greenstein<R: Real>(g: R, u: R) -> R {
    let one = u.like(1.0);
    let below = one + g - g * 2.0 * u;
    let s = (one - g * g) / below;
    (one - g) * u * (s + one - g) / below
}
