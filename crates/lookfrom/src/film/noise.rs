//! Noise estimates of parts of a picture.
//!
//! A pixel's *relative error* is the standard error of its luminance over its luminance plus a tenth of the picture's
//! mean: dark parts of the picture need not be as clean relative to themselves. An area's error is the mean over its
//! pixels. The standard error is estimated as if the samples were independent (stratified ones have less noise).

use super::weighted::WeightedPixel;
use super::{Film, xyz};
use lookfrom_scene::settings::PixelBounds;

/// The fraction of the picture's mean luminance that is added to a pixel's luminance where its noise is compared with it.
pub(super) const SHARE_OF_MEAN: f64 = 0.1;

impl Film {
    /// The mean luminance over [`Film::area`]; 0 for an empty one.
    pub fn mean_luminance(&self) -> f64 {
        let PixelBounds { x0, y0, x1, y1 } = self.area;
        let mut sum = 0.0;
        for y in y0..y1 {
            self.row(y, x0, x1, |pixel| sum += pixel.luminance());
        }
        let pixels = self.area.pixels();
        if pixels == 0 { 0.0 } else { sum / pixels as f64 }
    }

    /// The relative error of a part of the picture (pixels outside of [`Film::area`] are left out), where the mean
    /// luminance of the whole is `mean`: see the head of this file. Infinite if a pixel has fewer than two samples, 0
    /// for an empty area or a black picture.
    pub fn relative_error(&self, area: PixelBounds, mean: f64) -> f64 {
        let area = self.area.intersection(area);
        let PixelBounds { x0, y0, x1, y1 } = area;
        let mut sum = 0.0;
        for y in y0..y1 {
            self.row(y, x0, x1, |pixel| {
                sum += pixel.relative_error(mean);
            });
        }
        let pixels = area.pixels();
        if pixels == 0 { 0.0 } else { sum / pixels as f64 }
    }
}

impl WeightedPixel {
    /// Luminance of the mean.
    pub(super) fn luminance(&self) -> f64 {
        xyz(self.mean().map(f64::from))[1]
    }

    /// Its relative error in a picture of this mean luminance.
    pub(super) fn relative_error(&self, mean: f64) -> f64 {
        let error = self.standard_error();
        if error > 0.0 { error / (self.luminance().abs() + SHARE_OF_MEAN * mean.abs()) } else { 0.0 }
    }

    /// Standard error of the mean's luminance.
    pub(super) fn standard_error(&self) -> f64 {
        (self.variance()[1] / self.samples().max(1) as f64).sqrt()
    }
}
