//! Fireflies of a finished film, and the samples that made them.

use lookfrom_scene::settings::PixelBounds;
use serde::Serialize;

use super::Session;
use crate::core::math::luminance;
use crate::core::parallel;
use crate::film::{Film, Firefly};
use crate::inspect::light_seen_by_bounces;
use crate::render::SampleId;

/// Maximum number of samples that are traced again.
const MOST_TRACED: usize = 1 << 18;

/// The share of a firefly's excess that one sample has at least.
const CARRIED_BY_ONE: f64 = 0.5;

/// Pixels that single samples make far too bright.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Outliers {
    /// Number of all, as far as their samples were traced again.
    pub count: usize,
    /// The fireflies with the largest excess over their neighbours.
    pub brightest: Vec<Outlier>,
}

/// One of them.
#[derive(Clone, Debug, Serialize)]
pub struct Outlier {
    /// Column.
    pub x: u32,
    /// Row from the top.
    pub y: u32,
    /// Its brightest sample.
    pub sample: u32,
    /// The way of most of that sample's light, such as "camera → floor (D) → window".
    pub expression: String,
}

impl Session {
    /// The fireflies of a film that this session rendered; of the brightest `most`, the sample to be inspected.
    ///
    /// The samples of each are traced again: one of them has to carry the pixel, by light that it found after a bounce. A
    /// small lamp that the camera sees itself makes few samples bright, too, and nothing is wrong with it.
    pub fn fireflies(&self, film: &Film, most: usize) -> Outliers {
        let fireflies = film.fireflies();
        let mut traced = 0;
        let samples: Vec<Vec<SampleId>> = fireflies
            .iter()
            .map(|firefly| samples_of(film, firefly.pixel))
            .take_while(|samples| {
                traced += samples.len();
                traced <= MOST_TRACED
            })
            .collect();
        let found = parallel::collect(samples.len(), |index| {
            let brightest = self.carrying_sample(&fireflies[index], &samples[index])?;
            Some((brightest, light_seen_by_bounces(self.renderer(), brightest)?))
        });
        let mut outliers = Outliers::default();
        for (SampleId { pixel: [x, y], sample }, expression) in found.into_iter().flatten() {
            outliers.count += 1;
            if outliers.brightest.len() < most {
                outliers.brightest.push(Outlier { x, y, sample, expression });
            }
        }
        outliers
    }

    /// The brightest sample of a pixel, if it carries most of the excess.
    fn carrying_sample(&self, firefly: &Firefly, samples: &[SampleId]) -> Option<SampleId> {
        let (traced, _) = self.renderer().trace(samples);
        let lights = traced.iter().map(|traced| f64::from(luminance(traced.rgb)));
        let (brightest, light) = samples.iter().zip(lights).max_by(|(_, a), (_, b)| a.total_cmp(b))?;
        (light >= CARRIED_BY_ONE * firefly.excess * samples.len() as f64).then_some(*brightest)
    }
}

/// The samples of a pixel that a film holds.
fn samples_of(film: &Film, pixel: [u32; 2]) -> Vec<SampleId> {
    let [x, y] = pixel;
    let bounds = PixelBounds { x0: x, y0: y, x1: x + 1, y1: y + 1 };
    let ranges = film.ledger().uniform(bounds).unwrap_or_default();
    ranges.into_iter().flatten().map(|sample| SampleId { pixel, sample }).collect()
}
