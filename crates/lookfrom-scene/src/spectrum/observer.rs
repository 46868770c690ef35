//! Colour matching functions.
//!
//! The CIE 1931 standard observer, at each nm from 360 to 830. XYZ values are divided by the integral of y, so that the
//! constant 1 has the luminance 1, as in pbrt-v4.

use std::sync::OnceLock;

use super::{Curve, LONGEST, SHORTEST};

/// The number of wavelengths of the observer.
pub const SAMPLES: usize = (LONGEST - SHORTEST + 1) as usize;

/// The integral of y over the wavelengths in nm, as pbrt-v4 rounds it.
pub const Y_INTEGRAL: f64 = 106.856895;

/// The colour matching functions x, y, z at 360, 361, … 830 nm.
pub fn matching() -> &'static [[f32; SAMPLES]; 3] {
    static MATCHING: OnceLock<[[f32; SAMPLES]; 3]> = OnceLock::new();
    MATCHING.get_or_init(|| {
        let mut functions = [[0.0; SAMPLES]; 3];
        for (i, line) in
            include_str!("observer.txt").lines().filter(|line| !line.starts_with('#')).enumerate()
        {
            for (function, word) in functions.iter_mut().zip(line.split_whitespace()) {
                function[i] = word.parse().expect("a number of our own");
            }
        }
        functions
    })
}

/// XYZ of this spectrum: sums in steps of 1 nm, divided by [`Y_INTEGRAL`].
pub fn xyz(light: &Curve) -> [f64; 3] {
    let samples: Vec<f32> = (SHORTEST..=LONGEST).map(|nm| light.at(nm as f32)).collect();
    matching().map(|function| {
        let sum: f64 = function.iter().zip(&samples).map(|(&f, &s)| f64::from(f) * f64::from(s)).sum();
        sum / Y_INTEGRAL
    })
}
