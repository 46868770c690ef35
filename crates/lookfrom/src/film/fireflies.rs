//! Firefly suppression: samples that outshine their pixel are spread over its neighbours.
//!
//! A path that finds a small bright thing by chance makes its pixel far too bright (a firefly), while its neighbours miss
//! that light. Cutting it off would darken the picture. Here the excess is spread over the pixels around, so that the sum over
//! the picture stays what it was: noise is traded for blur where it is worst, and the mean is honest.
//!
//! A pixel is a firefly if it is brighter than the median of its eight neighbours by more than three of their standard errors
//! (their median), and by less than three of its own. What is bright for good (a light, a highlight) is so by many of its own
//! standard errors, and stays. The excess above the median goes in equal parts to the 5 × 5 pixels around.

use super::{Film, Picture};
use lookfrom_scene::settings::PixelBounds;

/// How many standard errors are too many to be chance, and few enough to be.
const STANDARD_ERRORS: f64 = 3.0;

/// Pixels to each side that share an excess.
const RADIUS: u32 = 2;

impl Film {
    /// The means of all pixels, as [`Film::picture`] has them, with the excess of fireflies spread over their
    /// surroundings. The sum over the picture is the same but for rounding.
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

    /// The share of its light that a pixel keeps: 1 unless it is a firefly.
    fn kept(&self, x: u32, y: u32) -> f64 {
        let at = |x, y| {
            let pixel = self.tile.pixel(x, y)?;
            Some((pixel.luminance(), pixel.standard_error()))
        };
        let Some((own, own_error)) = at(x, y) else { return 1.0 };
        let area = around(self.area(), x, y, 1);
        let (mut lights, mut errors): (Vec<f64>, Vec<f64>) = (area.y0..area.y1)
            .flat_map(|row| (area.x0..area.x1).map(move |column| (column, row)))
            .filter(|&place| place != (x, y))
            .filter_map(|(column, row)| at(column, row))
            .unzip();
        let (Some(median), Some(error)) = (median(&mut lights), median(&mut errors)) else { return 1.0 };
        let excess = own - median;
        // One sample a pixel says nothing of its error; infinities compare as they should.
        let firefly = own > 0.0
            && median >= 0.0
            && excess > STANDARD_ERRORS * error
            && excess < STANDARD_ERRORS * own_error;
        if firefly { median / own } else { 1.0 }
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

/// The middle one, or the lower of the two.
fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len().checked_sub(1)? / 2).copied()
}
