//! Coefficients of the sigmoid spectrum of a colour, by Newton's method (Jakob & Hanika 2019).
//!
//! Starts from a guess, or else follows the straight line to the colour from grey, whose solution is known, in
//! steps as long as the method converges. A [`Measure`] gives the colour of a spectrum.

use std::sync::OnceLock;

use lookfrom_scene::spectrum::observer;
use lookfrom_scene::spectrum::{LONGEST, SHORTEST, space};
use lookfrom_simd::{Kernel, Simd, dispatch, f64x4, level, prelude::*};

use super::sigmoid::{MIDDLE, REACH};
use super::{matrices, standard_illuminant};

/// Number of wavelengths that are summed side by side.
const LANES: usize = 4;

/// A quadrature rule for the colour of a reflectance under D65.
pub(super) struct Measure(Vec<Step>);

/// Four wavelengths of a rule.
#[derive(Default)]
struct Step {
    /// The wavelengths in the polynomial's variable t.
    t: [f64; LANES],
    /// Linear Rec. 709 per reflectance: red, green, blue.
    weights: [[f64; LANES]; 3],
}

impl Measure {
    /// Whole nm and exactly the white of D65, as [`super::DenselySampledSpectrum`] measures colours.
    pub(super) fn exact() -> &'static Self {
        static EXACT: OnceLock<Measure> = OnceLock::new();
        EXACT.get_or_init(|| {
            let steps = (SHORTEST..=LONGEST).map(|nm| (f64::from(nm), 1.0 / observer::Y_INTEGRAL));
            Self::new(steps, &matrices().1)
        })
    }

    /// The rule of pbrt-v4's table: the observer and D65 piecewise linear over 5 nm, Simpson's 3/8 rule within, and
    /// a rounded matrix. The colours differ from the exact ones by a few 10⁻⁴, most for dark saturated ones.
    pub(super) fn of_pbrt() -> &'static Self {
        const RGB_FROM_XYZ: space::Matrix = [
            [3.240479, -1.537150, -0.498535],
            [-0.969256, 1.875991, 0.041556],
            [0.055648, -0.204043, 1.057311],
        ];
        static OF_PBRT: OnceLock<Measure> = OnceLock::new();
        OF_PBRT.get_or_init(|| {
            let last = (LONGEST - SHORTEST) / 5 * 3;
            let steps = (0..=last).map(|i| {
                let nm = f64::from(SHORTEST) + f64::from(i) * 5.0 / 3.0;
                let repeats = if i == 0 || i == last {
                    1.0
                } else if i % 3 == 0 {
                    2.0
                } else {
                    3.0
                };
                (nm, repeats)
            });
            let mut measure = Self::new(steps, &RGB_FROM_XYZ);
            // White has the luminance 1: the middle row of the inverse matrix weights red, green and blue.
            let luminance = space::apply(&space::inverse(&RGB_FROM_XYZ), measure.white())[1];
            for weight in measure.0.iter_mut().flat_map(|step| step.weights.as_flattened_mut()) {
                *weight /= luminance;
            }
            measure
        })
    }

    /// The rule with these wavelengths in nm and weights.
    fn new(wavelengths: impl Iterator<Item = (f64, f64)>, rgb_from_xyz: &space::Matrix) -> Self {
        let mut steps = Vec::new();
        let weighed = wavelengths.map(|(nm, weight)| {
            let xyz = observer::matching().each_ref().map(|function| linear(function, nm));
            let power = weight * linear(standard_illuminant().samples(), nm);
            let t = (nm - f64::from(MIDDLE)) / f64::from(REACH);
            (t, space::apply(rgb_from_xyz, xyz).map(|component| component * power))
        });
        for (i, (t, weights)) in weighed.enumerate() {
            let lane = i % LANES;
            if lane == 0 {
                steps.push(Step::default());
            }
            let step = steps.last_mut().expect("a step was begun");
            step.t[lane] = t;
            for (weights, weight) in step.weights.iter_mut().zip(weights) {
                weights[lane] = weight;
            }
        }
        Self(steps)
    }

    /// The colour of the constant 1.
    fn white(&self) -> [f64; 3] {
        [0, 1, 2].map(|channel| self.0.iter().flat_map(|step| step.weights[channel]).sum())
    }

    /// The colour of a sigmoid spectrum, and its Jacobian (row: component, column: coefficient).
    fn color(&self, coefficients: [f64; 3]) -> ([f64; 3], space::Matrix) {
        let sums = dispatch(level(), Sums { steps: &self.0, coefficients });
        let sums = sums.map(|sums| sums.map(|lanes| lanes.iter().sum::<f64>()));
        (sums.map(|[value, ..]| value), sums.map(|[_, a, b, c]| [a, b, c]))
    }
}

/// The sums of a sigmoid spectrum and of its derivatives by a, b and c over the steps of a rule: by channel, term and lane.
struct Sums<'a> {
    steps: &'a [Step],
    coefficients: [f64; 3],
}

impl Kernel for Sums<'_> {
    type Output = [[[f64; LANES]; 4]; 3];

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let [a, b, c] = self.coefficients;
        let (a, b, c) = (f64x4::splat(simd, a), f64x4::splat(simd, b), f64x4::splat(simd, c));
        let (half, one) = (f64x4::splat(simd, 0.5), f64x4::splat(simd, 1.0));
        let mut sums = [[f64x4::splat(simd, 0.0); 4]; 3];
        for Step { t, weights } in self.steps {
            let t = f64x4::load_array(simd, *t);
            let x = (a * t + b) * t + c;
            let inverse = one / (one + x * x).sqrt();
            let half_inverse = half * inverse;
            let by_c = half_inverse * inverse * inverse;
            let by_b = by_c * t;
            let terms = [half + x * half_inverse, by_b * t, by_b, by_c];
            for channel in 0..3 {
                let weights = f64x4::load_array(simd, weights[channel]);
                for term in 0..4 {
                    sums[channel][term] += weights * terms[term];
                }
            }
        }
        let arrays =
            |[value, by_a, by_b, by_c]: [f64x4<S>; 4]| [value.into(), by_a.into(), by_b.into(), by_c.into()];
        let [red, green, blue] = sums;
        [arrays(red), arrays(green), arrays(blue)]
    }
}

/// The value at `nm`, interpolated linearly between samples at multiples of 5 nm. (A sample at exactly `nm` is
/// returned as it is.)
fn linear(samples: &[f32; observer::SAMPLES], nm: f64) -> f64 {
    let at = nm - f64::from(SHORTEST);
    if at == libm::floor(at) {
        return f64::from(samples[at as usize]);
    }
    let below = (at / 5.0) as usize * 5;
    let t = (at - below as f64) / 5.0;
    f64::from(samples[below]) * (1.0 - t) + f64::from(samples[below + 5]) * t
}

/// Tolerance relative to the largest component.
const NEAR: f64 = 1e-8;

/// Newton's method; `None` where it does not converge.
pub(super) fn newton(measure: &Measure, rgb: [f64; 3], guess: [f64; 3]) -> Option<[f64; 3]> {
    let size = rgb[0].max(rgb[1]).max(rgb[2]);
    let mut coefficients = guess;
    for _ in 0..12 {
        let (found, slopes) = measure.color(coefficients);
        let error: [f64; 3] = std::array::from_fn(|i| rgb[i] - found[i]);
        let step = space::apply(&space::inverse(&slopes), error);
        for (coefficient, step) in coefficients.iter_mut().zip(step) {
            *coefficient += step;
        }
        if !coefficients.iter().all(|coefficient| coefficient.abs() < 1e6) {
            return None;
        }
        // Convergence is quadratic: the error after the step is about the square of the error before.
        if error.iter().all(|error| error.abs() * error.abs() <= NEAR * size * size) {
            return Some(coefficients);
        }
    }
    None
}

/// The coefficients for a colour within [0, 1]³; where the method does not converge, the last ones on the way.
pub(super) fn solve(measure: &Measure, rgb: [f64; 3]) -> [f64; 3] {
    let middle = 0.5 * (rgb[0].max(rgb[1]).max(rgb[2]) + rgb[0].min(rgb[1]).min(rgb[2]));
    let grey = middle.clamp(1e-12, 1.0 - 1e-6);
    let mut coefficients = [0.0, 0.0, (grey - 0.5) / (grey * (1.0 - grey)).sqrt()];
    let (mut way, mut step) = (0.0, 0.5);
    while way < 1.0 && step > 1e-5 {
        let next = f64::min(way + step, 1.0);
        match newton(measure, rgb.map(|component| grey + next * (component - grey)), coefficients) {
            Some(found) => (coefficients, way, step) = (found, next, 2.0 * step),
            None => step *= 0.25,
        }
    }
    coefficients
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::hash;

    /// The sums of [`Measure::color`], number by number as they are defined.
    fn sums_one_by_one(measure: &Measure, [a, b, c]: [f64; 3]) -> [[[f64; LANES]; 4]; 3] {
        let mut sums = [[[0.0; LANES]; 4]; 3];
        for Step { t, weights } in &measure.0 {
            for lane in 0..LANES {
                let t = t[lane];
                let x = (a * t + b) * t + c;
                let inverse = 1.0 / (1.0 + x * x).sqrt();
                let slope = 0.5 * inverse * inverse * inverse;
                let terms = [0.5 + 0.5 * x * inverse, slope * t * t, slope * t, slope];
                for (sums, weights) in sums.iter_mut().zip(weights) {
                    for (sum, term) in sums.iter_mut().zip(terms) {
                        sum[lane] += weights[lane] * term;
                    }
                }
            }
        }
        sums
    }

    #[test]
    fn sums_in_lanes_have_the_bits_of_sums_one_by_one() {
        for measure in [Measure::exact(), Measure::of_pbrt()] {
            for round in 0..2000 {
                let coefficients = [0, 1, 2].map(|index| {
                    let bits = hash::pair(round, index);
                    let mantissa = (bits >> 40) as f64 / 8_388_608.0 - 1.0;
                    mantissa * libm::exp2((bits % 40) as f64 - 19.0)
                });
                let together = dispatch(level(), Sums { steps: &measure.0, coefficients });
                let alone = sums_one_by_one(measure, coefficients);
                let bits =
                    |sums: [[[f64; LANES]; 4]; 3]| sums.map(|sums| sums.map(|lanes| lanes.map(f64::to_bits)));
                assert_eq!(bits(together), bits(alone), "{coefficients:?}");
            }
        }
    }
}
