//! Which coefficients give a sigmoid spectrum exactly this colour?
//!
//! Newton's method from a guess. Without one: along the straight way from grey, whose solution is known, to the colour, in
//! steps as long as Newton's method can follow.

use std::sync::OnceLock;

use lookfrom_scene::spectrum::observer::{self, SAMPLES};
use lookfrom_scene::spectrum::{SHORTEST, space};

use super::sigmoid::{MIDDLE, REACH};
use super::{matrices, standard_illuminant};

/// What light reflected at one wavelength adds to the colour.
#[derive(Clone, Copy)]
struct Node {
    /// The wavelength as the polynomial sees it.
    t: f64,
    /// Linear Rec. 709 under D65 per reflectance.
    weight: [f64; 3],
}

/// Each nm with the colour it adds; the weights sum to white.
fn nodes() -> &'static [Node; SAMPLES] {
    static NODES: OnceLock<[Node; SAMPLES]> = OnceLock::new();
    NODES.get_or_init(|| {
        let (matching, light) = (observer::matching(), standard_illuminant().samples());
        std::array::from_fn(|i| {
            let power = f64::from(light[i]) / observer::Y_INTEGRAL;
            let xyz = matching.each_ref().map(|function| f64::from(function[i]) * power);
            let t = (f64::from(SHORTEST) + i as f64 - f64::from(MIDDLE)) / f64::from(REACH);
            Node { t, weight: space::apply(&matrices().1, xyz) }
        })
    })
}

/// The colour of a sigmoid spectrum, and how it changes with each coefficient (row: component, column: coefficient).
fn color([a, b, c]: [f64; 3]) -> ([f64; 3], space::Matrix) {
    let (mut rgb, mut slopes) = ([0.0; 3], [[0.0; 3]; 3]);
    for &Node { t, weight } in nodes() {
        let x = (a * t + b) * t + c;
        let inverse = 1.0 / (1.0 + x * x).sqrt();
        let value = 0.5 + 0.5 * x * inverse;
        let slope = 0.5 * inverse * inverse * inverse;
        for channel in 0..3 {
            rgb[channel] += weight[channel] * value;
            let slope = weight[channel] * slope;
            for (sum, power) in slopes[channel].iter_mut().zip([t * t, t, 1.0]) {
                *sum += slope * power;
            }
        }
    }
    (rgb, slopes)
}

/// How near to the colour is near enough, as a part of its greatest component.
const NEAR: f64 = 1e-9;

/// Newton's method; `None` where it does not arrive.
pub(super) fn newton(rgb: [f64; 3], guess: [f64; 3]) -> Option<[f64; 3]> {
    let size = rgb[0].max(rgb[1]).max(rgb[2]);
    let mut coefficients = guess;
    for _ in 0..12 {
        let (found, slopes) = color(coefficients);
        let error: [f64; 3] = std::array::from_fn(|i| rgb[i] - found[i]);
        if error.iter().all(|error| error.abs() <= NEAR * size) {
            return Some(coefficients);
        }
        let step = space::apply(&space::inverse(&slopes), error);
        for (coefficient, step) in coefficients.iter_mut().zip(step) {
            *coefficient += step;
        }
        if !coefficients.iter().all(|coefficient| coefficient.abs() < 1e6) {
            return None;
        }
    }
    None
}

/// The coefficients for a colour within [0, 1]³ that is not grey; the nearest that were found where there are none.
pub(super) fn solve(rgb: [f64; 3]) -> [f64; 3] {
    let grey =
        (0.5 * (rgb[0].max(rgb[1]).max(rgb[2]) + rgb[0].min(rgb[1]).min(rgb[2]))).clamp(1e-12, 1.0 - 1e-6);
    let mut coefficients = [0.0, 0.0, (grey - 0.5) / (grey * (1.0 - grey)).sqrt()];
    let (mut way, mut step) = (0.0, 0.5);
    while way < 1.0 && step > 1e-5 {
        let next = f64::min(way + step, 1.0);
        match newton(rgb.map(|component| grey + next * (component - grey)), coefficients) {
            Some(found) => (coefficients, way, step) = (found, next, 2.0 * step),
            None => step *= 0.25,
        }
    }
    coefficients
}
