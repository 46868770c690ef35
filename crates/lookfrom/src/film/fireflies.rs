//! Firefly suppression: the excess of outliers is spread over the neighbouring pixels.
//!
//! A path that hits a small bright light by chance makes its pixel far too bright (a firefly), while its neighbours
//! miss that light. Clamping it would darken the picture. Here the excess is spread over the pixels around, so that the
//! sum over the picture is preserved: noise is traded for blur where it is worst.
//!
//! A single sample that carries a pixel makes its standard error about as large as its mean. So a pixel is a firefly if its
//! standard error is most of its mean, it is brighter than the median of its eight neighbours by more than three of their
//! standard errors (their median), none of them is a quarter as bright, and no pixel of the 5 × 5 around whose mean is
//! known better is half as bright: edges, lamps and highlights have such neighbours. Thus nothing is taken for a firefly
//! in a picture that converges. The excess above the median goes in equal parts to the 5 × 5 pixels around.

use std::collections::VecDeque;
use std::ops::Range;

use super::plane::SIDE;
use super::{Film, Picture};
use crate::core::parallel;
use lookfrom_scene::settings::PixelBounds;

/// Number of standard errors beyond which a difference is significant.
const STANDARD_ERRORS: f64 = 3.0;

/// Standard error over mean above which few samples carry a pixel: of n samples of which k have equal light and the others
/// none, it is about 1 / √k.
const CARRIED_BY_FEW: f64 = 0.7;

/// Light of a neighbour over that of a pixel from which on the pixel does not stand alone.
const NOT_ALONE: f64 = 0.25;

/// Light of a pixel nearby whose mean is known over that of a pixel from which on the pixel belongs to its edge.
const AT_EDGE: f64 = 0.5;

/// The radius in pixels over which an excess is spread.
const RADIUS: u32 = 2;

/// A pixel that single samples make far too bright.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Firefly {
    /// Column and row from the top left.
    pub pixel: [u32; 2],
    /// Its luminance beyond the median of its neighbours.
    pub excess: f64,
    /// The fraction of its light that it keeps where the excess is spread.
    pub kept: f64,
}

impl Film {
    /// The fireflies of the film, those with the largest excess first.
    pub fn fireflies(&self) -> Vec<Firefly> {
        let mut found = self.fireflies_by_rows();
        found.sort_by(|a, b| b.excess.total_cmp(&a.excess));
        found
    }

    /// The means of all pixels, as in [`Film::picture`], with the excess of fireflies spread over their neighbours. The
    /// sum over the picture is the same up to rounding.
    pub fn picture_without_fireflies(&self) -> Picture {
        let mut picture = self.picture();
        let mut fireflies = self.fireflies_by_rows().into_iter().peekable();
        if fireflies.peek().is_none() {
            return picture;
        }
        let area = self.area();
        let width = self.width as usize;
        // The light that rows get, from row `y - RADIUS` on.
        let mut spread: VecDeque<Vec<[f64; 3]>> = VecDeque::new();
        for y in area.y0..area.y1 + RADIUS {
            let first = y.saturating_sub(RADIUS);
            spread.resize((y + RADIUS + 1 - first) as usize, vec![[0.0; 3]; width]);
            while let Some(Firefly { pixel: [x, _], kept, .. }) =
                fireflies.next_if(|found| found.pixel[1] == y)
            {
                let light = &mut picture.pixels[y as usize * width + x as usize];
                let excess = light.map(|light| f64::from(light) * (1.0 - kept));
                *light = light.map(|light| (f64::from(light) * kept) as f32);
                let around = around(area, x, y, RADIUS);
                let share = 1.0 / around.pixels() as f64;
                for y in around.y0..around.y1 {
                    for x in around.x0..around.x1 {
                        let sums = &mut spread[(y - first) as usize][x as usize];
                        for (sum, excess) in sums.iter_mut().zip(excess) {
                            *sum += excess * share;
                        }
                    }
                }
            }
            // No later row reaches the first one.
            if y >= RADIUS
                && let Some(spread) = spread.pop_front()
            {
                let row = &mut picture.pixels[first as usize * width..][..width];
                for (light, spread) in row.iter_mut().zip(spread) {
                    for (light, spread) in light.iter_mut().zip(spread) {
                        *light = (f64::from(*light) + spread) as f32;
                    }
                }
            }
        }
        picture
    }

    /// The fireflies of the film, row by row.
    fn fireflies_by_rows(&self) -> Vec<Firefly> {
        let PixelBounds { y0, y1, .. } = self.area();
        let first = y0 / SIDE;
        // Rows of blocks, each of which is decoded once, but for the rows that it shares with the next.
        let found = parallel::collect(y1.div_ceil(SIDE).saturating_sub(first) as usize, |number| {
            let top = (first + number as u32) * SIDE;
            self.fireflies_of_rows(top.max(y0)..(top + SIDE).min(y1))
        });
        found.concat()
    }

    /// The fireflies of these rows of [`Film::area`].
    fn fireflies_of_rows(&self, rows: Range<u32>) -> Vec<Firefly> {
        let PixelBounds { x0, y0, x1, y1 } = self.area();
        let area = PixelBounds {
            x0,
            y0: rows.start.saturating_sub(RADIUS).max(y0),
            x1,
            y1: (rows.end + RADIUS).min(y1),
        };
        let mut pixels = Vec::with_capacity(area.pixels() as usize);
        for y in area.y0..area.y1 {
            self.row(y, x0, x1, |pixel| pixels.push([pixel.luminance(), pixel.standard_error()]));
        }
        let known = Known { area, pixels };
        let places = rows.flat_map(|y| (x0..x1).map(move |x| [x, y]));
        places.filter_map(|pixel| known.firefly(pixel)).collect()
    }
}

/// Luminances of the pixels of an area, with their errors.
struct Known {
    area: PixelBounds,
    /// Luminance and its standard error, row by row.
    pixels: Vec<[f64; 2]>,
}

impl Known {
    fn at(&self, [x, y]: [u32; 2]) -> [f64; 2] {
        self.pixels[self.area.index(x, y)]
    }

    /// The other pixels at most `radius` away along each axis.
    fn others(&self, [x, y]: [u32; 2], radius: u32) -> impl Iterator<Item = [f64; 2]> {
        let area = around(self.area, x, y, radius);
        (area.y0..area.y1)
            .flat_map(move |row| (area.x0..area.x1).map(move |column| [column, row]))
            .filter(move |&place| place != [x, y])
            .map(|place| self.at(place))
    }

    /// The firefly that a pixel is, if it is one: see the head of this file.
    fn firefly(&self, pixel: [u32; 2]) -> Option<Firefly> {
        let [own, error] = self.at(pixel);
        // Few pixels are carried by few samples: only these are compared with others.
        if !(own > 0.0 && error > CARRIED_BY_FEW * own) {
            return None;
        }
        if self.others(pixel, 1).any(|[light, _]| light >= NOT_ALONE * own) {
            return None;
        }
        let mut at_edge = self.others(pixel, RADIUS);
        if at_edge.any(|[light, error]| error <= CARRIED_BY_FEW * light && light >= AT_EDGE * own) {
            return None;
        }
        let (mut lights, mut errors): (Vec<f64>, Vec<f64>) =
            self.others(pixel, 1).map(|[light, error]| (light, error)).unzip();
        let (median, error) = (median(&mut lights)?, median(&mut errors)?);
        // The error of a pixel with one sample is infinite; infinities compare as they should.
        let is_one = median >= 0.0 && own - median > STANDARD_ERRORS * error;
        is_one.then(|| Firefly { pixel, excess: own - median, kept: median / own })
    }
}

/// The pixels at most `radius` away along each axis.
fn around(area: PixelBounds, x: u32, y: u32, radius: u32) -> PixelBounds {
    PixelBounds {
        x0: x.saturating_sub(radius).max(area.x0),
        y0: y.saturating_sub(radius).max(area.y0),
        x1: (x + radius + 1).min(area.x1),
        y1: (y + radius + 1).min(area.y1),
    }
}

/// The median; the lower of the two for an even number.
fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len().checked_sub(1)? / 2).copied()
}
