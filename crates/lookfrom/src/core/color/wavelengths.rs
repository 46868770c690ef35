//! The sampled wavelengths of a path.

use std::sync::OnceLock;

use lookfrom_scene::spectrum::observer::SAMPLES;
use lookfrom_scene::spectrum::{LONGEST, SHORTEST};

use super::densely_sampled::{nearest, standard_illuminant};
use crate::core::spectrum::Spectrum;

/// Number of cells of equal probability between the shortest and the longest wavelength; a multiple of four.
const CELLS: usize = 2048;

/// The beginnings of the cells, and the end of the last.
fn ends() -> &'static [f32; CELLS + 1] {
    static ENDS: OnceLock<[f32; CELLS + 1]> = OnceLock::new();
    ENDS.get_or_init(|| {
        let tangent = |nm: u32| libm::tanh(0.0072 * (f64::from(nm) - 538.0));
        let (low, high) = (tangent(SHORTEST), tangent(LONGEST));
        std::array::from_fn(|k| {
            let share = k as f64 / CELLS as f64;
            (538.0 + libm::atanh(low + share * (high - low)) / 0.0072) as f32
        })
    })
}

/// Four wavelengths of one sample with their densities. After dispersion only the first is in use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wavelengths {
    /// In nm, between 360 and 830.
    pub(crate) lambda: [f32; 4],
    /// The density of each, per nm; 0 for terminated ones.
    pub(crate) pdf: [f32; 4],
    /// The indices of the nearest samples of measured curves, beyond their end where there is none.
    nearest: [u16; 4],
    /// The spectral power of daylight D65 of luminance 1 there.
    pub(crate) daylight: Spectrum,
}

impl Wavelengths {
    /// By wavelengths in nm and their densities per nm.
    pub fn new(lambda: [f32; 4], pdf: [f32; 4]) -> Self {
        Self { lambda, pdf, nearest: lambda.map(nearest), daylight: standard_illuminant().at(&lambda) }
    }

    /// In nm, between 360 and 830.
    pub fn lambda(&self) -> [f32; 4] {
        self.lambda
    }

    /// The density of each, per nm; 0 for terminated ones.
    pub fn pdf(&self) -> [f32; 4] {
        self.pdf
    }

    /// The samples of a curve, at whole nm, that are nearest; `None` where there is none.
    #[inline(always)]
    pub(super) fn of_curve<'a, T>(&self, samples: &'a [T; SAMPLES]) -> [Option<&'a T>; 4] {
        self.nearest.map(|index| samples.get(usize::from(index)))
    }

    /// Samples wavelengths by the sensitivity of the eye, with a density about ∝ 1 / cosh²(0.0072 (λ − 538)) on 360
    /// … 830 nm (Radziszewski, Boryczko, Alda 2009): constant in each of 2048 cells of equal probability. `u` is in
    /// [0, 1); the lanes are at u, u + ¼, u + ½, u + ¾ modulo 1.
    pub fn sample_visible(u: f32) -> Self {
        let ends = ends();
        let place = u * CELLS as f32;
        let cell = (place as usize).min(CELLS - 1);
        let within = place - cell as f32;
        let lane = |shift: usize| {
            let cell = (cell + shift * CELLS / 4) % CELLS;
            let width = ends[cell + 1] - ends[cell];
            (ends[cell] + within * width, 1.0 / (CELLS as f32 * width))
        };
        let lanes = [lane(0), lane(1), lane(2), lane(3)];
        Self::new(lanes.map(|(lambda, _)| lambda), lanes.map(|(_, pdf)| pdf))
    }

    /// Samples wavelengths of a range in nm uniformly, as [`Wavelengths::sample_visible`] those of all.
    pub fn sample_uniform(u: f32, [shortest, longest]: [f32; 2]) -> Self {
        let width = longest - shortest;
        let lane = |shift: f32| {
            let u = u + shift;
            shortest + (if u < 1.0 { u } else { u - 1.0 }) * width
        };
        Self::new([lane(0.0), lane(0.25), lane(0.5), lane(0.75)], [1.0 / width; 4])
    }

    /// Terminates all wavelengths but the first, which gets four times the weight. Idempotent.
    pub fn terminate_secondary(&mut self) {
        if !self.secondary_terminated() {
            self.pdf = [self.pdf[0] / 4.0, 0.0, 0.0, 0.0];
        }
    }

    /// True if only the first wavelength is in use.
    pub fn secondary_terminated(&self) -> bool {
        self.pdf[1..] == [0.0; 3]
    }

    /// Each lane divided by its density; 0 where that is 0.
    pub(super) fn weighted(&self, radiance: Spectrum) -> Spectrum {
        radiance.zip(Spectrum(self.pdf), |l, pdf| if pdf > 0.0 { l / pdf } else { 0.0 })
    }
}
