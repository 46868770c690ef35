//! Fireflies of a finished film, and the samples that made them.

use std::ops::Range;

use lookfrom_scene::settings::PixelBounds;
use serde::Serialize;

use super::Session;
use crate::film::Film;
use crate::inspect::inspect_pixel;

/// Maximum number of samples of a pixel that are traced again.
const MOST_TRACED: u32 = 4096;

/// Pixels that single samples make far too bright.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Outliers {
    /// Number of all.
    pub count: usize,
    /// Those with the largest excess over their neighbours.
    pub brightest: Vec<Outlier>,
}

/// One of them.
#[derive(Clone, Debug, Serialize)]
pub struct Outlier {
    /// Column.
    pub x: u32,
    /// Row from the top.
    pub y: u32,
    /// Its brightest sample; `None` where the pixel has more than are traced again.
    pub sample: Option<u32>,
    /// The way of most of that sample's light, such as "camera → floor (D) → window".
    pub expression: Option<String>,
}

impl Session {
    /// The fireflies of a film that this session rendered; of the brightest `most`, whose samples are traced again, the
    /// sample to be inspected.
    pub fn fireflies(&self, film: &Film, most: usize) -> Outliers {
        let found = film.fireflies();
        let brightest = found.iter().take(most).map(|firefly| {
            let [x, y] = firefly.pixel;
            let worst = samples_of(film, [x, y])
                .and_then(|samples| inspect_pixel(self.renderer(), [x, y], samples).ok())
                .and_then(|report| report.all.into_iter().next());
            let (sample, expression) = worst.map(|worst| (worst.sample, worst.expression)).unzip();
            Outlier { x, y, sample, expression }
        });
        Outliers { count: found.len(), brightest: brightest.collect() }
    }
}

/// The samples of a pixel, if they are one range of not too many.
fn samples_of(film: &Film, [x, y]: [u32; 2]) -> Option<Range<u32>> {
    let pixel = PixelBounds { x0: x, y0: y, x1: x + 1, y1: y + 1 };
    match film.ledger().uniform(pixel)?.as_slice() {
        [range] if range.len() <= MOST_TRACED as usize => Some(range.clone()),
        _ => None,
    }
}
