//! Firefly suppression: the excess of outliers is spread over the neighbouring pixels.
//!
//! A path that hits a small bright light by chance makes its pixel far too bright (a firefly), while its neighbours
//! miss that light. Clamping it would darken the picture. Here the excess is spread over the pixels around, so that the
//! sum over the picture is preserved: noise is traded for blur where it is worst.
//!
//! A pixel is a firefly if it is brighter than the median of its eight neighbours by more than three of their standard
//! errors (their median), and by less than three of its own. A pixel that is really bright (a light, a highlight) is so
//! by many of its own standard errors, and stays. The excess above the median goes in equal parts to the 5 × 5 pixels
//! around.

use super::pixel::Pixel;
use super::{Film, Picture};
use lookfrom_scene::settings::PixelBounds;

/// Number of standard errors beyond which a difference is significant.
const STANDARD_ERRORS: f64 = 3.0;

/// The radius in pixels over which an excess is spread.
const RADIUS: u32 = 2;

/// A pixel that single samples make far too bright.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Firefly {
    /// Column and row from the top left.
    pub pixel: [u32; 2],
    /// Its luminance beyond the median of its neighbours.
    pub excess: f64,
}

impl Film {
    /// The fireflies of the film that are at least twice as bright as the median of their neighbours, those with the
    /// largest excess first.
    pub fn fireflies(&self) -> Vec<Firefly> {
        let area = self.area();
        let luminance = |x, y| self.tile.pixel(x, y).map_or(0.0, Pixel::luminance);
        let rows = (area.y0..area.y1).flat_map(|y| (area.x0..area.x1).map(move |x| (x, y)));
        let lights: Vec<f64> = rows.clone().map(|(x, y)| luminance(x, y)).collect();
        let width = (area.x1 - area.x0) as usize;
        let at = |x: u32, y: u32| lights[(y - area.y0) as usize * width + (x - area.x0) as usize];
        // Few pixels are so much brighter than half of their neighbours: only of these the errors are compared.
        let stands_out = |x: u32, y: u32| {
            let (half, near) = (0.5 * at(x, y), around(area, x, y, 1));
            let (mut darker, mut all) = (0, 0);
            for row in near.y0..near.y1 {
                for column in near.x0..near.x1 {
                    darker += u32::from(at(column, row) <= half);
                    all += 1;
                }
            }
            half > 0.0 && 2 * darker >= all - 1
        };
        let mut found: Vec<Firefly> = rows
            .filter(|&(x, y)| stands_out(x, y))
            .filter_map(|(x, y)| {
                let [own, median] = self.outlier(x, y)?;
                (own >= 2.0 * median).then_some(Firefly { pixel: [x, y], excess: own - median })
            })
            .collect();
        found.sort_by(|a, b| b.excess.total_cmp(&a.excess));
        found
    }

    /// The means of all pixels, as in [`Film::picture`], with the excess of fireflies spread over their neighbours. The
    /// sum over the picture is the same up to rounding.
    pub fn picture_without_fireflies(&self) -> Picture {
        let mut picture = self.picture();
        let area = self.area();
        let width = self.width as usize;
        let mut spread = vec![[0.0_f64; 3]; picture.pixels.len()];
        for y in area.y0..area.y1 {
            for x in area.x0..area.x1 {
                let kept = self.kept(x, y);
                if kept >= 1.0 {
                    continue;
                }
                let light = &mut picture.pixels[y as usize * width + x as usize];
                let excess = light.map(|light| f64::from(light) * (1.0 - kept));
                *light = light.map(|light| (f64::from(light) * kept) as f32);
                let around = around(area, x, y, RADIUS);
                let share = 1.0 / (f64::from(around.x1 - around.x0) * f64::from(around.y1 - around.y0));
                for y in around.y0..around.y1 {
                    for x in around.x0..around.x1 {
                        let sums = &mut spread[y as usize * width + x as usize];
                        for (sum, excess) in sums.iter_mut().zip(excess) {
                            *sum += excess * share;
                        }
                    }
                }
            }
        }
        for (light, spread) in picture.pixels.iter_mut().zip(spread) {
            for (light, spread) in light.iter_mut().zip(spread) {
                *light = (f64::from(*light) + spread) as f32;
            }
        }
        picture
    }

    /// The fraction of its light that a pixel keeps: 1 unless it is a firefly.
    fn kept(&self, x: u32, y: u32) -> f64 {
        self.outlier(x, y).map_or(1.0, |[own, median]| median / own)
    }

    /// The luminance of a firefly, and the median of its neighbours; `None` for other pixels.
    fn outlier(&self, x: u32, y: u32) -> Option<[f64; 2]> {
        let at = |x, y| {
            let pixel = self.tile.pixel(x, y)?;
            Some((pixel.luminance(), pixel.standard_error()))
        };
        let (own, own_error) = at(x, y)?;
        let area = around(self.area(), x, y, 1);
        let (mut lights, mut errors): (Vec<f64>, Vec<f64>) = (area.y0..area.y1)
            .flat_map(|row| (area.x0..area.x1).map(move |column| (column, row)))
            .filter(|&place| place != (x, y))
            .filter_map(|(column, row)| at(column, row))
            .unzip();
        let (median, error) = (median(&mut lights)?, median(&mut errors)?);
        let excess = own - median;
        // The error of a pixel with one sample is infinite; infinities compare as they should.
        let is_firefly = own > 0.0
            && median >= 0.0
            && excess > STANDARD_ERRORS * error
            && excess < STANDARD_ERRORS * own_error;
        is_firefly.then_some([own, median])
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
