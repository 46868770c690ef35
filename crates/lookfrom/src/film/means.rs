//! Estimates from a film's sums: the mean of each pixel, the variance of one sample, and pictures of means.

use lookfrom_scene::settings::PixelBounds;

use super::Film;
use super::picture::{Picture, composited};
use super::plane::Plane;
use super::stored::Sums;
use super::weighted::{Weighted, WeightedPixel, Weights};
use crate::aov::{Aovs, DenoiserFeatures};
use crate::core::hash;
use crate::core::parallel;

impl Film {
    /// The mean of a pixel's samples: exact up to one rounding to f64 for the sum, one for the quotient and one to f32. Where their filter
    /// weights differ, an estimate with less noise. Black where there are none, and outside of [`Film::area`].
    pub fn mean(&self, x: u32, y: u32) -> [f32; 3] {
        self.pixel(x, y).map_or([0.0; 3], |pixel| pixel.mean())
    }

    /// The mean of a pixel composited by its alpha over a background, as [`Picture::before`] does.
    pub fn mean_before(&self, x: u32, y: u32, background: [f32; 3]) -> [f32; 3] {
        let mean = self.mean(x, y);
        self.alpha(x, y).map_or(mean, |alpha| composited(mean, alpha, background))
    }

    /// The unbiased estimate of the variance of *one* sample of a pixel in X, Y and Z (CIE 1931, see [`xyz_of_rec709`](lookfrom_scene::spectrum::space::xyz_of_rec709); the
    /// second is that of the luminance). Divided by [`Film::samples`] it is that of the mean of independent samples;
    /// that of stratified ones is less. Infinite with fewer than two samples, and outside of [`Film::area`]. The sum of
    /// squares saturates at 2⁸⁰.
    pub fn variance(&self, x: u32, y: u32) -> [f32; 3] {
        self.pixel(x, y).map_or([f32::INFINITY; 3], |pixel| pixel.variance().map(|variance| variance as f32))
    }

    /// The variance of *one* sample of a pixel in the channels of the sensor, estimated like [`Film::variance`]; `None`
    /// where the film has no memory for it (no AOVs, or a sensor that measures X, Y and Z), and outside of
    /// [`Film::area`].
    pub fn channel_variance(&self, x: u32, y: u32) -> Option<[f32; 3]> {
        let pixel = self.sums_of(&self.channels, x, y)?;
        let sums = WeightedPixel { pixel, weights: Weights::new(pixel.samples, None), unsigned: None };
        Some(sums.variance_of(|mean| mean).map(|variance| variance as f32))
    }

    /// The mean AOVs of a pixel: the albedo over all samples (a miss is black), all others over the samples with a hit.
    /// `None` where the film has no memory for them, where no sample hit anything, and outside of [`Film::area`].
    pub fn aovs(&self, x: u32, y: u32) -> Option<Aovs> {
        self.sums_of(&self.layers, x, y)?.mean()
    }

    /// The mean light of a pixel in each layer of light-path expressions; black outside of [`Film::area`].
    pub fn light_paths(&self, x: u32, y: u32) -> impl Iterator<Item = [f32; 3]> {
        let weights = self.weights(x, y);
        let unsigned = self.unsigned_light.iter().skip(1).map(Some).chain(std::iter::repeat(None));
        self.light_paths.iter().zip(unsigned).map(move |(layer, unsigned)| {
            let unsigned = unsigned.and_then(|unsigned| self.sums_of(unsigned, x, y));
            self.sums_of(layer, x, y).map_or([0.0; 3], |sums| sums.mean(unsigned, weights))
        })
    }

    /// The motion vector of a pixel, from the opening to the closing of the shutter, in pixels to the right and upwards: the mean over the
    /// samples with a hit, 0 without any. `None` where the film has no memory for it, and outside of [`Film::area`].
    pub fn motion(&self, x: u32, y: u32) -> Option<[f32; 2]> {
        self.sums_of(&self.motions, x, y).map(|sums| sums.mean())
    }

    /// The denoiser features of a pixel; `None` where the film has no memory for them or no samples, and outside of
    /// [`Film::area`].
    pub fn denoiser_features(&self, x: u32, y: u32) -> Option<DenoiserFeatures> {
        self.sums_of(&self.features, x, y)?.features()
    }

    /// The variance of the alpha of *one* sample of a pixel, estimated like [`Film::variance`]. 0 where the film has no
    /// alpha or is not made for the denoiser, and outside of [`Film::area`].
    pub fn alpha_variance(&self, x: u32, y: u32) -> f32 {
        let sums = self.alpha_sums(x, y).zip(self.sums_of(&self.alpha_squares, x, y));
        sums.map_or(0.0, |(sums, squares)| self.weights(x, y).variance_of(sums, squares) as f32)
    }

    /// Number of samples of a pixel, without those that were dropped.
    pub fn samples(&self, x: u32, y: u32) -> u64 {
        self.sums_of(&self.pixels, x, y).map_or(0, |pixel| pixel.samples)
    }

    /// The means of all pixels, black outside of [`Film::area`].
    pub fn picture(&self) -> Picture {
        self.picture_of(PixelBounds { x0: 0, y0: 0, x1: self.width, y1: self.height })
    }

    /// A hash of the means of all pixels, in 16 hexadecimal digits: equal pictures of different machines have the same.
    pub fn hash(&self) -> String {
        let bytes = self.picture().pixels.into_iter().flatten().flat_map(f32::to_le_bytes);
        format!("{:016x}", hash::of_bytes(bytes))
    }

    /// The means of the pixels of a rectangle, black outside of [`Film::area`]: a picture of its size.
    pub fn picture_of(&self, part: PixelBounds) -> Picture {
        let [width, height] = part.size();
        let mut pixels = vec![[0.0; 3]; width as usize * height as usize];
        let PixelBounds { x0, y0, x1, y1 } = part.intersection(self.area);
        if x0 < x1 {
            parallel::for_chunks_mut(&mut pixels, width as usize, |row, pixels| {
                let y = part.y0 + row as u32;
                if (y0..y1).contains(&y) {
                    let mut means = pixels[(x0 - part.x0) as usize..].iter_mut();
                    self.row(y, x0, x1, |pixel| {
                        if let Some(mean) = means.next() {
                            *mean = pixel.mean();
                        }
                    });
                }
            });
        }
        Picture { width, height, pixels, alpha: self.alpha_of(part) }
    }

    /// Alpha of the pixels of a rectangle; empty where the film has none.
    fn alpha_of(&self, part: PixelBounds) -> Vec<f32> {
        if self.alphas.is_empty() {
            return Vec::new();
        }
        let rows = parallel::collect((part.y1 - part.y0) as usize, |row| -> Vec<f32> {
            (part.x0..part.x1).filter_map(|x| self.alpha(x, part.y0 + row as u32)).collect()
        });
        rows.concat()
    }

    /// The mean alpha of a pixel, 0 without samples; `None` if the film has no alpha.
    pub(crate) fn alpha(&self, x: u32, y: u32) -> Option<f32> {
        let mean = self.alpha_sums(x, y).map_or(0.0, |sums| self.weights(x, y).mean(sums) as f32);
        (!self.alphas.is_empty()).then_some(mean)
    }

    fn alpha_sums(&self, x: u32, y: u32) -> Option<Weighted> {
        let signed = self.sums_of(&self.alphas, x, y)?;
        Some(Weighted { signed, unsigned: self.sums_of(&self.unsigned_alphas, x, y) })
    }

    /// Sums of a kind of a pixel; `None` where there are none, and outside of [`Film::area`].
    pub(super) fn sums_of<T: Sums>(&self, plane: &Plane<T>, x: u32, y: u32) -> Option<T> {
        let PixelBounds { x0, y0, x1, y1 } = self.area;
        let is_inside = (x0..x1).contains(&x) && (y0..y1).contains(&y);
        if is_inside { plane.get(x, y) } else { None }
    }
}
