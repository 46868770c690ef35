//! Fibres of hair and fur: Chiang, Bitterli, Tappan & Burley 2016, "A Practical and Controllable Hair and Fur Model for Production Path
//! Tracing", after Marschner et al. 2003 and d'Eon et al. 2011.
//!
//! A fibre is a cylinder of glass with tilted scales and pigment inside. Light leaves it after p stretches of its way inside: p = 0 (R) is
//! reflected by the scales, 1 (TT) passes through, 2 (TRT) is reflected once at the back, and the last lobe has all that stays longer.
//! Each lobe is `A_p M_p(θ_i, θ_o) N_p(φ)`: the attenuation by pigment and by Fresnel's equations, the spread along the fibre and the spread
//! around it. x is the direction of the fibre; θ is the angle to the plane across it, φ the angle around it from y to z. Definitions of
//! parameters follow pbrt-v4.

use std::f32::consts::{FRAC_1_PI, PI};

use lookfrom_simd::{Float, Mask, Real, Simd, f32x8, prelude::*};

use super::lanes::{LaneBsdf, RowBsdf};
use super::{Description, DirectionSample, Lobes, ScatteringFunction, fresnel, is_grazing};
use crate::core::elementary::{angle_in_turns, exp, ln, sin_cos_of_turns};
use crate::core::lanes::{LANES, by_lane, gather_spectrum};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;

/// Number of lobes.
const COUNT: usize = 4;

/// Least roughness of both kinds, as in pbrt-v4: below, lobes are narrower than numbers can tell.
const LEAST_ROUGHNESS: f32 = 0.01;

/// Least cosine to the normal of sampled directions.
const LEAST_COSINE: f32 = 1e-9;

/// A fibre where a ray meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hair<R = f32> {
    /// Place across the fibre, −1 … 1 from one edge to the other; 0 in its middle.
    pub(crate) h: R,
    /// Index of refraction, inside over outside.
    pub(crate) eta: R,
    /// Absorption coefficient, per radius of the fibre.
    pub(crate) absorption: Spectrum<R>,
    /// Longitudinal variance v of R; that of TT is v / 4, that of others 4 v.
    pub(crate) variance: R,
    /// Scale s of the logistic distribution around the fibre.
    pub(crate) scale: R,
    /// Sines and cosines of α, 2α and 4α, where α is the angle of the scales.
    pub(crate) tilts: [[R; 2]; 3],
}

/// A fibre seen from the outgoing direction.
#[derive(Clone, Copy, Debug)]
pub struct SeenHair<R> {
    /// φ_o in turns.
    phi: R,
    /// Angles of incidence and of refraction around the fibre, γ_o and γ_t, in turns.
    gammas: [R; 2],
    /// sin θ_o and cos θ_o, turned by the scales for each lobe.
    inclinations: [[R; 2]; COUNT],
    /// Longitudinal variance of each lobe.
    variances: [R; COUNT],
    /// A_p.
    attenuations: [Spectrum<R>; COUNT],
    /// The probability of each lobe.
    chances: [R; COUNT],
}

impl Hair {
    /// By the place across the fibre h (−1 … 1), its index of refraction, absorption per radius, the roughness along it β_m and around it β_n
    /// (0 … 1), and the angle α of its scales in degrees.
    pub fn new(h: f32, eta: f32, absorption: Spectrum, [beta_m, beta_n]: [f32; 2], alpha: f32) -> Self {
        let [m, n] = [beta_m, beta_n].map(|beta| Float::clamp(beta, LEAST_ROUGHNESS, 1.0));
        // Fits of the variance and of the scale by the roughness (Chiang et al. 2016, eqs. 7 and 8).
        let deviation = 0.726 * m + 0.812 * m * m + 3.7 * nth_power(m, 20);
        let scale = 0.265 * n + 1.194 * n * n + 5.372 * nth_power(n, 22);
        let (sin, cos) = libm::sincosf(alpha.clamp(-90.0, 90.0).to_radians());
        let doubled = |[sin, cos]: [f32; 2]| [2.0 * sin * cos, cos * cos - sin * sin];
        let once = [sin, cos];
        let twice = doubled(once);
        Self {
            h: Float::clamp(h, -1.0, 1.0),
            eta: fresnel::valid_eta(eta),
            absorption: absorption.map(|lane| Float::max(lane, 0.0)),
            variance: deviation * deviation,
            scale: scale * (PI / 8.0).sqrt(),
            tilts: [once, twice, doubled(twice)],
        }
    }

    /// This fibre met at another place, with other pigment.
    #[must_use]
    pub(crate) fn at(self, h: f32, absorption: Spectrum) -> Self {
        let absorption = absorption.map(|lane| Float::max(lane, 0.0));
        Self { h: Float::clamp(h, -1.0, 1.0), absorption, ..self }
    }

    /// The absorption coefficient per radius of fibres that together reflect a colour: `(ln R / spread)²`.
    pub fn absorption_of_reflectance(reflectance: Spectrum, beta_n: f32) -> Spectrum {
        reflectance.map(|lane| {
            let ratio = ln(Float::clamp(lane, f32::MIN_POSITIVE, 1.0)) / Self::spread(beta_n);
            ratio * ratio
        })
    }

    /// The number by which the square root of the absorption is a reflectance's logarithm (Chiang et al. 2016, eq. 9).
    pub(crate) fn spread(beta_n: f32) -> f32 {
        let n = Float::clamp(beta_n, LEAST_ROUGHNESS, 1.0);
        ((((0.245 * n + 5.574) * n - 10.73) * n + 2.532) * n - 0.215) * n + 5.969
    }
}

/// xⁿ by multiplications.
fn nth_power(x: f32, n: u32) -> f32 {
    (0..n).fold(1.0, |power, _| power * x)
}

impl<R: Real> Hair<R> {
    #[inline(always)]
    fn seen(&self, wo: Vector<R>) -> SeenHair<R> {
        let one = self.h.like(1.0);
        let (sin, cos) = (wo.x, Float::sqrt(wo.y * wo.y + wo.z * wo.z));

        // Refraction around the fibre, with the index of refraction of rays that are inclined to it.
        let inside = sin / self.eta;
        let cos_inside = Float::sqrt(Float::max(one - inside * inside, self.h.like(1e-12)));
        let sin_o = self.h;
        let cos_o = Float::sqrt(Float::max(one - sin_o * sin_o, self.h.like(0.0)));
        let bent = Float::sqrt(Float::max(self.eta * self.eta - sin * sin, self.h.like(1e-12)));
        let sin_t = Float::clamp(self.h * cos / bent, -1.0, 1.0);
        let cos_t = Float::sqrt(Float::max(one - sin_t * sin_t, self.h.like(0.0)));

        // Attenuations: each stretch inside is a chord, longer by its inclination.
        let fresnel = fresnel::dielectric(cos * cos_o, self.eta);
        let passed = one - fresnel;
        let chord = cos_t * 2.0 / cos_inside;
        let transmittance = self.absorption.map(
            #[inline(always)]
            |absorption| exp(-(absorption * chord)),
        );
        let through = transmittance * (passed * passed);
        let turned_back = through * transmittance * fresnel;
        let rest = transmittance.map(
            #[inline(always)]
            |passed| {
                let kept = passed * fresnel;
                kept / Float::max(one - kept, one.like(1e-7))
            },
        );
        let attenuations = [Spectrum::splat(fresnel), through, turned_back, turned_back * rest];
        let sums =
            [attenuations[0].sum(), attenuations[1].sum(), attenuations[2].sum(), attenuations[3].sum()];
        let total = Float::max(sums[0] + sums[1] + sums[2] + sums[3], one.like(f32::MIN_POSITIVE));
        let chances = [sums[0] / total, sums[1] / total, sums[2] / total, sums[3] / total];

        // Scales turn R by −2α, TT by α and TRT by 4α.
        let [once, twice, four_times] = self.tilts;
        let inclinations = [
            turned([sin, cos], [-twice[0], twice[1]]),
            turned([sin, cos], once),
            turned([sin, cos], four_times),
            [sin, cos],
        ];
        let (narrow, wide) = (self.variance * 0.25, self.variance * 4.0);
        SeenHair {
            phi: angle_in_turns(wo.z, wo.y),
            gammas: [angle_in_turns(sin_o, cos_o), angle_in_turns(sin_t, cos_t)],
            inclinations,
            variances: [self.variance, narrow, wide, wide],
            attenuations,
            chances,
        }
    }

    /// `M_p N_p` of each lobe.
    #[inline(always)]
    fn spreads(&self, seen: &SeenHair<R>, wi: Vector<R>) -> [R; COUNT] {
        let inclination = [wi.x, Float::sqrt(wi.y * wi.y + wi.z * wi.z)];
        let phi = angle_in_turns(wi.z, wi.y) - seen.phi;
        let [r, tt, trt, rest] = seen.inclinations;
        let [v_r, v_tt, v_trt, v_rest] = seen.variances;
        [
            longitudinal(inclination, r, v_r) * self.azimuthal(phi - seen.deflection(0)),
            longitudinal(inclination, tt, v_tt) * self.azimuthal(phi - seen.deflection(1)),
            longitudinal(inclination, trt, v_trt) * self.azimuthal(phi - seen.deflection(2)),
            longitudinal(inclination, rest, v_rest) * (0.5 * FRAC_1_PI),
        ]
    }

    /// The logistic distribution of the scale s on one turn, per radian, at an angle in turns.
    #[inline(always)]
    fn azimuthal(&self, turns: R) -> R {
        let around = Float::abs(turns - Float::floor(turns + 0.5)) * (2.0 * PI);
        let one = turns.like(1.0);
        let e = exp(-(around / self.scale));
        e / (self.scale * (one + e) * (one + e)) / self.within_turn()
    }

    /// The part of the logistic distribution that is within one turn.
    #[inline(always)]
    fn within_turn(&self) -> R {
        let one = self.scale.like(1.0);
        let end = exp(-(one.like(PI) / self.scale));
        (one - end) / (one + end)
    }

    /// An angle in turns, of the density [`Self::azimuthal`].
    #[inline(always)]
    fn sample_azimuthal(&self, u: R) -> R {
        let one = u.like(1.0);
        let within = self.within_turn();
        let below = Float::clamp(u * within + (one - within) * 0.5, 1e-7, 1.0 - 1e-7);
        let turns = self.scale * (0.5 * FRAC_1_PI) * ln(below / (one - below));
        Float::clamp(turns, -0.5, 0.5)
    }
}

impl<R: Real> SeenHair<R> {
    /// The angle around the fibre by which a lobe's middle is deflected, in turns: `2 p γ_t − 2 γ_o + p π`.
    #[inline(always)]
    fn deflection(&self, p: u32) -> R {
        let [outside, inside] = self.gammas;
        let p = p as f32;
        inside * (2.0 * p) - outside * 2.0 + 0.5 * p
    }
}

/// A sine and a cosine ≥ 0 turned by an angle of which there are both.
#[inline(always)]
fn turned<R: Real>([sin, cos]: [R; 2], [by_sin, by_cos]: [R; 2]) -> [R; 2] {
    [sin * by_cos + cos * by_sin, Float::abs(cos * by_cos - sin * by_sin)]
}

/// The spread along a fibre of the variance v, by the sines and cosines of both inclinations (d'Eon et al. 2011, eq. 7):
/// `I₀(cos θ_i cos θ_o / v) exp(−sin θ_i sin θ_o / v) / (2 v sinh(1 / v))`, with all exponents taken together.
#[inline(always)]
fn longitudinal<R: Real>([sin_i, cos_i]: [R; 2], [sin_o, cos_o]: [R; 2], v: R) -> R {
    // 1 − cos(θ_i + θ_o), without cancellation.
    let (across, along) = (cos_i - cos_o, sin_i + sin_o);
    let apart = (across * across + along * along) * 0.5;
    let norm = v * (v.like(1.0) - exp(v.like(-2.0) / v));
    scaled_bessel(cos_i * cos_o / v) * exp(-(apart / v)) / norm
}

/// `I₀(x) e⁻ˣ` for x ≥ 0 to 3·10⁻⁷, by the fits of Abramowitz & Stegun 1964, 9.8.1 and 9.8.2.
#[inline(always)]
fn scaled_bessel<R: Real>(x: R) -> R {
    let least = Float::min(x, x.like(3.75));
    let t = least * (1.0 / 3.75);
    let t = t * t;
    let near = (((((t * 0.004_581_3 + 0.036_076_8) * t + 0.265_973_2) * t + 1.206_749_2) * t + 3.089_942_4)
        * t
        + 3.515_622_9)
        * t
        + 1.0;
    let most = Float::max(x, x.like(3.75));
    let u = most.like(3.75) / most;
    let far = (((((((u * 0.003_923_77 - 0.016_476_33) * u + 0.026_355_37) * u - 0.020_577_06) * u
        + 0.009_162_81)
        * u
        - 0.001_575_65)
        * u
        + 0.002_253_19)
        * u
        + 0.013_285_92)
        * u
        + 0.398_942_3;
    R::select(x.lt(x.like(3.75)), near * exp(-least), far / Float::sqrt(most))
}

impl<R: Real> LaneBsdf<R> for Hair<R> {
    type Prepared = (Vector<R>, SeenHair<R>);

    #[inline(always)]
    fn prepare(&self, wo: Vector<R>) -> Self::Prepared {
        (wo, self.seen(wo))
    }

    #[inline(always)]
    fn f(&self, prepared: &Self::Prepared, wi: Vector<R>) -> Spectrum<R> {
        self.f_and_pdf(prepared, wi).0
    }

    #[inline(always)]
    fn pdf(&self, prepared: &Self::Prepared, wi: Vector<R>) -> R {
        self.f_and_pdf(prepared, wi).1
    }

    #[inline(always)]
    fn f_and_pdf(&self, (_, seen): &Self::Prepared, wi: Vector<R>) -> (Spectrum<R>, R) {
        let spreads = self.spreads(seen, wi);
        let (zero, black) = (wi.z.like(0.0), Spectrum::splat(wi.z.like(0.0)));
        let (mut f, mut pdf) = (black, zero);
        let mut p = 0;
        while p < COUNT {
            f += seen.attenuations[p] * spreads[p];
            pdf = pdf + seen.chances[p] * spreads[p];
            p += 1;
        }
        let is_lit = !is_grazing(wi);
        (Spectrum::select(is_lit, f / Float::abs(wi.z), black), R::select(is_lit, pdf, zero))
    }

    #[inline(always)]
    fn sample(&self, prepared: &Self::Prepared, uc: R, [u, around]: [R; 2]) -> DirectionSample<R> {
        let (wo, seen) = prepared;
        let (zero, one) = (uc.like(0.0), uc.like(1.0));

        // Choose a lobe; what is left of its number chooses the angle around the fibre.
        let mut is_chosen = uc.lt(zero).like(true);
        let [mut sin, mut cos] = seen.inclinations[0];
        let (mut v, mut deflection) = (seen.variances[0], seen.deflection(0));
        let (mut start, mut chance) = (zero, seen.chances[0]);
        let mut p = 1;
        while p < COUNT {
            let next = start + chance;
            is_chosen = is_chosen & !uc.lt(next) & seen.chances[p].gt(zero);
            sin = R::select(is_chosen, seen.inclinations[p][0], sin);
            cos = R::select(is_chosen, seen.inclinations[p][1], cos);
            v = R::select(is_chosen, seen.variances[p], v);
            deflection = R::select(is_chosen, seen.deflection(p as u32), deflection);
            start = R::select(is_chosen, next, start);
            chance = R::select(is_chosen, seen.chances[p], chance);
            p += 1;
        }
        let left = Float::clamp((uc - start) / chance, 0.0, 1.0 - f32::EPSILON);

        // The inclination: d'Eon et al. 2013, "Importance sampling for physically-based hair fiber models".
        let least = exp(v.like(-2.0) / v);
        let down = Float::max(-(v * ln(Float::max(u, u.like(1e-5)) + (one - u) * least)), zero);
        let down = Float::min(down, down.like(2.0));
        let (cone_sin, cone_cos) = (Float::sqrt(down * (down.like(2.0) - down)), one - down);
        let (_, cone_x) = sin_cos_of_turns(around);
        let sin_i = Float::clamp(cone_sin * cone_x * cos - cone_cos * sin, -1.0, 1.0);
        let cos_i = Float::sqrt(Float::max(one - sin_i * sin_i, zero));

        // The angle around the fibre; the last lobe has all.
        let turns = R::select(is_chosen, left, deflection + self.sample_azimuthal(left)) + seen.phi;
        let (phi_sin, phi_cos) = sin_cos_of_turns(turns);
        // No direction is lost by its cosine to a normal that fibres do not have.
        let z = cos_i * phi_sin;
        let z = R::select(Float::abs(z).gt(z.like(LEAST_COSINE)), z, z.like(LEAST_COSINE));
        let wi = Vector { x: sin_i, y: cos_i * phi_cos, z };
        let (f, pdf) = self.f_and_pdf(prepared, wi);
        let no = is_chosen.like(false);
        DirectionSample {
            wi,
            f,
            pdf,
            eta: one,
            is_specular: no,
            is_diffuse: no,
            is_transmission: (wo.z * wi.z).lt(zero),
            is_valid: pdf.gt(zero) & !is_grazing(wi),
        }
    }

    #[inline(always)]
    fn has_density(&self) -> R::Mask {
        self.h.lt(self.h).like(true)
    }
}

impl ScatteringFunction for Hair {
    fn lobes(&self) -> Lobes {
        Lobes::REFLECTION | Lobes::TRANSMISSION | Lobes::GLOSSY
    }

    fn description(&self) -> Description {
        Description {
            kind: "hair",
            does: "a fibre: light is reflected by its scales, passes through it, or is reflected inside",
            numbers: vec![
                ("h", self.h.into()),
                ("eta", self.eta.into()),
                ("absorption", self.absorption.into()),
                ("variance", self.variance.into()),
                ("scale", self.scale.into()),
                ("sin α", self.tilts[0][0].into()),
            ],
        }
    }
}

impl RowBsdf for Hair {
    type Lanes<S: Simd> = Hair<f32x8<S>>;

    #[inline(always)]
    fn gather<S: Simd>(simd: S, rows: &[&Self; LANES]) -> Self::Lanes<S> {
        let mut tilts = [[f32x8::splat(simd, 0.0); 2]; 3];
        let mut angle = 0;
        while angle < 3 {
            tilts[angle][0] = f32x8::load_array(simd, by_lane!(lane => rows[lane].tilts[angle][0]));
            tilts[angle][1] = f32x8::load_array(simd, by_lane!(lane => rows[lane].tilts[angle][1]));
            angle += 1;
        }
        Hair {
            h: f32x8::load_array(simd, by_lane!(lane => rows[lane].h)),
            eta: f32x8::load_array(simd, by_lane!(lane => rows[lane].eta)),
            absorption: gather_spectrum(simd, &by_lane!(lane => rows[lane].absorption)),
            variance: f32x8::load_array(simd, by_lane!(lane => rows[lane].variance)),
            scale: f32x8::load_array(simd, by_lane!(lane => rows[lane].scale)),
            tilts,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::hash;
    use crate::core::warp;

    fn unit(seed: u64, index: u64) -> f32 {
        (hash::pair(seed, index) >> 40) as f32 / 16_777_216.0
    }

    /// I₀(x) e⁻ˣ by the series of I₀.
    fn series(x: f64) -> f64 {
        let (mut term, mut sum) = (1.0, 1.0);
        for k in 1..2000 {
            term *= (x / (2.0 * f64::from(k))).powi(2);
            sum += term;
        }
        sum * (-x).exp()
    }

    #[test]
    fn the_scaled_bessel_function_is_its_series() {
        for index in 0..4000 {
            let x = libm::exp2f(22.0 * unit(1, index) - 14.0);
            let (found, expected) = (f64::from(scaled_bessel(x)), series(f64::from(x)));
            assert!((found / expected - 1.0).abs() < 1e-6, "{x}: {found}, not {expected}");
        }
        assert!(scaled_bessel(1e30_f32) > 0.0);
    }

    /// White fibres reflect all light, whatever their roughness and wherever they are met: by uniform directions, and by samples.
    #[test]
    fn white_hair_in_a_white_furnace_is_white() {
        for (round, betas) in [[0.2, 0.3], [0.5, 0.25], [0.3, 0.9], [1.0, 1.0]].into_iter().enumerate() {
            for turn in 0..6 {
                let seed = (10 * round + turn) as u64;
                let h = 2.0 * unit(2, seed) - 1.0;
                let fibre = Hair::new(h, 1.55, Spectrum::BLACK, betas, 3.0);
                let wo = warp::uniform_sphere([unit(3, seed), unit(4, seed)]);
                let prepared = LaneBsdf::prepare(&fibre, wo.into());
                let n = 200_000;
                let (mut uniform, mut squares, mut sampled) = (0.0, 0.0, 0.0);
                for index in 0..n {
                    let index = index + (seed << 32);
                    let u = [unit(5, index), unit(6, index)];
                    let wi = warp::uniform_sphere(u);
                    let f = LaneBsdf::f(&fibre, &prepared, wi.into());
                    let value = f64::from(f.0[0] * wi.z.abs() / warp::UNIFORM_SPHERE_PDF);
                    uniform += value;
                    squares += value * value;
                    let sample = LaneBsdf::sample(&fibre, &prepared, unit(7, index), u);
                    if sample.is_valid {
                        sampled += f64::from(sample.f.0[0] * sample.wi.z.abs() / sample.pdf);
                    }
                }
                let n = n as f64;
                let (mean, sampled) = (uniform / n, sampled / n);
                let error = ((squares / n - mean * mean) / n).sqrt();
                assert!((mean - 1.0).abs() < 5.0 * error, "{fibre:?} from {wo}: {mean} ± {error}");
                assert!((sampled - 1.0).abs() < 2e-3, "{fibre:?} from {wo}: {sampled}");
            }
        }
    }

    #[test]
    fn much_hair_has_the_colour_that_was_asked_for() {
        for (reflectance, beta_n) in [(0.1, 0.3), (0.5, 0.1), (0.9, 0.8)] {
            let absorption = Hair::absorption_of_reflectance(Spectrum([reflectance; 4]), beta_n).0[0];
            let back = (-absorption.sqrt() * Hair::spread(beta_n)).exp();
            assert!((back - reflectance).abs() < 1e-4, "{reflectance}: {back}");
        }
    }
}
