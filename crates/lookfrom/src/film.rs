//! The film: sums of samples per pixel in fixed point, independent of their order.
//!
//! Sums of floating-point numbers depend on their order, sums of integers do not. So each pixel holds three fixed-point
//! sums of 128 bits, 64 of them behind the binary point, and as many of squares, for the variance; any division of the
//! work among threads, tiles, passes or machines ends in the same bytes *by construction*. AOVs, for layers and
//! denoiser, are in [`aov`], those of eight pixels side by side in `first_hits`; variances in the sensor's channels in
//! `channels`; noise estimates in `noise`; firefly suppression in `fireflies`; which samples it holds, in `ledger`; its
//! numbers as channels of a file, in `stored`. Conversion for display is in [`crate::post::develop`].
//!
//! A pixel takes 112 bytes, and those of [`aov`] and `channels` where they are enabled.

pub mod allocation;
pub mod aov;
mod channels;
mod fireflies;
mod first_hits;
mod ledger;
mod light_paths;
mod noise;
mod pixel;
mod stored;
mod sums;
mod tile;

pub use self::aov::{Aovs, DenoiserFeatures, FEATURE_SAMPLES};
use self::channels::ChannelSums;
pub use self::fireflies::Firefly;
pub(crate) use self::first_hits::{AovColumns, FirstHitSums};
pub use self::ledger::{Overlap, SampleLedger};
use self::pixel::{Pixel, TWO_TO_48, TWO_TO_64, fixed_point, fixed_point_square, unbiased_variance};
pub(crate) use self::sums::SampleSums;
pub use self::tile::FilmTile;

use lookfrom_scene::settings::{Background, ImageSettings, Layers, PixelBounds};
use lookfrom_scene::spectrum::space::xyz_of_rec709 as xyz;
use lookfrom_scene::{Error, ErrorKind, Location, Result};
use std::cmp::Ordering;

/// Maximum number of pixels of a film: 2²⁸, which take 28 GiB.
pub const MOST_PIXELS: u64 = 1 << 28;

/// Light is clamped to this, 2⁴⁰, in either direction. So the sums hold at least 2²³ samples of the brightest, and far
/// more of any other.
pub const BRIGHTEST: f32 = 1_099_511_627_776.0;

/// The film: sums of a picture's samples, pixel by pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Film {
    width: u32,
    height: u32,
    tile: FilmTile,
}

/// Identifies a sample of a pixel. The order is by row, column, sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleId {
    /// Column and row from the top left.
    pub pixel: [u32; 2],
    /// Number of the sample in its pixel.
    pub sample: u32,
}

impl Ord for SampleId {
    fn cmp(&self, other: &Self) -> Ordering {
        let in_order = |id: &Self| (id.pixel[1], id.pixel[0], id.sample);
        in_order(self).cmp(&in_order(other))
    }
}

impl PartialOrd for SampleId {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Linear light, row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width` × `height` pixels: red, green, blue.
    pub pixels: Vec<[f32; 3]>,
    /// Alpha of each pixel, 0 … 1 up to noise; the colours are premultiplied by it. Empty if the picture has none.
    pub alpha: Vec<f32>,
}

impl Picture {
    /// Replaces a part of this picture, with its upper left corner at column `x0` and row `y0`, by a smaller picture.
    /// Pixels outside are left out.
    pub fn replace(&mut self, x0: u32, y0: u32, part: &Self) {
        let (width, columns) = (self.width as usize, part.width.min(self.width.saturating_sub(x0)) as usize);
        if columns == 0 {
            return;
        }
        if !part.alpha.is_empty() && self.alpha.is_empty() {
            self.alpha = vec![0.0; self.pixels.len()];
        }
        for row in 0..part.height.min(self.height.saturating_sub(y0)) as usize {
            let (to, from) = ((y0 as usize + row) * width + x0 as usize, row * part.width as usize);
            self.pixels[to..to + columns].copy_from_slice(&part.pixels[from..from + columns]);
            if !part.alpha.is_empty() {
                self.alpha[to..to + columns].copy_from_slice(&part.alpha[from..from + columns]);
            }
        }
    }

    /// The picture composited by its alpha over a background of linear light; one without alpha stays the same.
    pub fn before(mut self, background: [f32; 3]) -> Self {
        for (pixel, alpha) in self.pixels.iter_mut().zip(std::mem::take(&mut self.alpha)) {
            let share = 1.0 - alpha.clamp(0.0, 1.0);
            *pixel = std::array::from_fn(|c| pixel[c] + share * background[c]);
        }
        self
    }
}

impl Film {
    /// A black film for a picture of `width` × `height` pixels, of which only `crop` (clipped to the picture) is held.
    ///
    /// An error if the picture has more than [`MOST_PIXELS`] or there is no memory for it.
    pub fn new(width: u32, height: u32, crop: Option<PixelBounds>) -> Result<Self> {
        Self::with_layers(width, height, crop, Layers::None)
    }

    /// As [`Film::new`], with memory for AOVs.
    pub fn with_layers(width: u32, height: u32, crop: Option<PixelBounds>, layers: Layers) -> Result<Self> {
        Self::for_image(&ImageSettings { width, height, crop, layers, ..ImageSettings::default() })
    }

    /// A black film with memory for everything that the settings need: AOVs, alpha.
    ///
    /// # Errors
    /// `Limit` as [`Film::new`].
    pub fn for_image(image: &ImageSettings) -> Result<Self> {
        let &ImageSettings { width, height, crop, .. } = image;
        let pixels = u64::from(width) * u64::from(height);
        if pixels > MOST_PIXELS {
            return Err(too_large(format!(
                "a picture of {width} × {height} = {pixels} pixels; at most {MOST_PIXELS} are possible"
            )));
        }
        let whole = PixelBounds { x0: 0, y0: 0, x1: width, y1: height };
        let area = common(whole, crop.unwrap_or(whole));
        Ok(Self { width, height, tile: FilmTile::for_image(area, image)? })
    }

    /// The bytes of a film for these settings, with those that are needed at the same time to develop and encode its picture:
    /// an estimate, from the sums of a pixel and from what was measured for the rest (docs/benchmarks/memory.md).
    pub fn memory(image: &ImageSettings) -> u64 {
        const DEVELOPED: usize = 32;
        const LAYERS_DEVELOPED: usize = 80;
        const DENOISER: usize = 180;
        let whole = PixelBounds { x0: 0, y0: 0, x1: image.width, y1: image.height };
        let PixelBounds { x0, y0, x1, y1 } = common(whole, image.crop.unwrap_or(whole));
        let pixels = u64::from(x1.saturating_sub(x0)) * u64::from(y1.saturating_sub(y0));
        let mut bytes = size_of::<Pixel>() + DEVELOPED;
        if image.layers != Layers::None {
            bytes += size_of::<aov::LayerSums>() + LAYERS_DEVELOPED;
        }
        if image.denoise {
            bytes += size_of::<aov::AovSums>() + DENOISER;
        }
        if image.background != Background::Environment {
            bytes += 2 * size_of::<u128>() + size_of::<f32>();
        }
        bytes += image.light_paths.len() * 2 * size_of::<light_paths::LightPathSums>();
        pixels.saturating_mul(bytes as u64)
    }

    /// Columns of the picture.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows of the picture.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The part of the picture that is held.
    pub fn area(&self) -> PixelBounds {
        self.tile.area
    }

    /// Adds the light of one sample to its pixel, as [`FilmTile::add`] does; it is not recorded in the ledger.
    ///
    /// # Panics
    /// If the pixel is outside of [`Film::area`].
    pub fn add(&mut self, x: u32, y: u32, sample: u32, rgb: [f32; 3]) {
        self.tile.add(x, y, sample, rgb);
    }

    /// Adds the sums of a tile, which is within [`Film::area`].
    ///
    /// # Errors
    /// As [`Film::merge`].
    pub fn add_tile(&mut self, tile: &FilmTile) -> Result<()> {
        self.tile.merge(tile)
    }

    /// Adds the sums of another film of the same picture: other samples, or other pixels.
    ///
    /// # Errors
    /// `Invalid` if the pictures differ in size or in what is summed, if the other has pixels outside of
    /// [`Film::area`], or both have a [recorded](FilmTile::record) sample; then nothing has changed.
    pub fn merge(&mut self, other: &Self) -> Result<()> {
        if (self.width, self.height) != (other.width, other.height) {
            let message = format!(
                "a film of {} × {} pixels cannot be added to one of {} × {}",
                other.width, other.height, self.width, self.height
            );
            return Err(Error::invalid(&Location::default(), message)
                .hint("merge only renders of the same scene at the same size"));
        }
        self.add_tile(&other.tile)
    }

    /// Which samples of which pixels it holds.
    pub fn ledger(&self) -> &SampleLedger {
        &self.tile.ledger
    }

    pub(crate) fn set_dropped(&mut self, count: u64, first: Option<SampleId>) {
        (self.tile.dropped, self.tile.first_dropped) = (count, first);
    }

    /// Makes room for all pixels of an area, which contains its own.
    ///
    /// # Errors
    /// `Limit` if there is no memory for it; then nothing has changed.
    pub fn enlarge(&mut self, area: PixelBounds) -> Result<()> {
        if area != self.area() {
            let mut enlarged = self.tile.empty_like(area)?;
            enlarged.merge(&self.tile)?;
            self.tile = enlarged;
        }
        Ok(())
    }

    /// Whether it is as [`Film::for_image`] makes it: of these pixels, with these kinds of sums.
    pub fn is_for(&self, image: &ImageSettings) -> bool {
        let PixelBounds { x0, y0, .. } = self.area();
        let one = PixelBounds { x0, y0, x1: x0 + 1, y1: y0 + 1 };
        let like = Self::for_image(&ImageSettings { crop: Some(one), ..image.clone() });
        let whole = PixelBounds { x0: 0, y0: 0, x1: image.width, y1: image.height };
        (self.width, self.height, self.area()) == (image.width, image.height, image.crop.unwrap_or(whole))
            && like.is_ok_and(|like| like.stored_channels() == self.stored_channels())
    }

    pub(crate) fn ledger_mut(&mut self) -> &mut SampleLedger {
        &mut self.tile.ledger
    }

    /// The mean of a pixel's samples: exact up to one rounding to f64 for the sum, one for the quotient and one to f32.
    /// Black where there are none, and outside of [`Film::area`].
    pub fn mean(&self, x: u32, y: u32) -> [f32; 3] {
        self.tile.pixel(x, y).map_or([0.0; 3], Pixel::mean)
    }

    /// The unbiased estimate of the variance of *one* sample of a pixel in X, Y and Z (CIE 1931, see [`xyz`]; the
    /// second is that of the luminance). Divided by [`Film::samples`] it is that of the mean of independent samples;
    /// that of stratified ones is less. Infinite with fewer than two samples, and outside of [`Film::area`]. The sum of
    /// squares saturates at 2⁸⁰.
    pub fn variance(&self, x: u32, y: u32) -> [f32; 3] {
        self.tile
            .pixel(x, y)
            .map_or([f32::INFINITY; 3], |pixel| pixel.variance().map(|variance| variance as f32))
    }

    /// The variance of *one* sample of a pixel in the channels of the sensor, estimated like [`Film::variance`]; `None`
    /// where the film has no memory for it (no AOVs, or a sensor that measures X, Y and Z), and outside of
    /// [`Film::area`].
    pub fn channel_variance(&self, x: u32, y: u32) -> Option<[f32; 3]> {
        self.tile.channels.get(self.tile.index(x, y)?).map(ChannelSums::variance)
    }

    /// The mean AOVs of a pixel: the albedo over all samples (a miss is black), all others over the samples with a hit.
    /// `None` where the film has no memory for them, where no sample hit anything, and outside of [`Film::area`].
    pub fn aovs(&self, x: u32, y: u32) -> Option<Aovs> {
        self.tile.layers.get(self.tile.index(x, y)?)?.mean()
    }

    /// The mean light of a pixel in each layer of light-path expressions; black outside of [`Film::area`].
    pub fn light_paths(&self, x: u32, y: u32) -> impl Iterator<Item = [f32; 3]> {
        let (index, samples) = (self.tile.index(x, y), self.samples(x, y));
        self.tile
            .light_paths
            .iter()
            .map(move |layer| index.map_or([0.0; 3], |index| layer[index].mean(samples)))
    }

    /// Whether the film has AOVs.
    pub fn has_layers(&self) -> bool {
        self.tile.has_layers()
    }

    /// The denoiser features of a pixel; `None` where the film has no memory for them or no samples, and outside of
    /// [`Film::area`].
    pub fn denoiser_features(&self, x: u32, y: u32) -> Option<DenoiserFeatures> {
        self.tile.features.get(self.tile.index(x, y)?)?.features()
    }

    /// The variance of the alpha of *one* sample of a pixel, estimated like [`Film::variance`]. 0 where the film has no
    /// alpha or is not made for the denoiser, and outside of [`Film::area`].
    pub fn alpha_variance(&self, x: u32, y: u32) -> f32 {
        let FilmTile { pixels, alphas, alpha_squares, .. } = &self.tile;
        let Some(index) = self.tile.index(x, y) else { return 0.0 };
        let (Some(&sum), Some(&squares)) = (alphas.get(index), alpha_squares.get(index)) else { return 0.0 };
        let samples = pixels[index].samples;
        if samples < 2 {
            return f32::INFINITY;
        }
        let n = samples as f64;
        unbiased_variance(n, sum as f64 / (n * TWO_TO_64), squares as f64 / (n * TWO_TO_48)) as f32
    }

    /// Number of samples of a pixel, without those that were dropped.
    pub fn samples(&self, x: u32, y: u32) -> u64 {
        self.tile.pixel(x, y).map_or(0, |pixel| pixel.samples)
    }

    /// Number of samples that were dropped because they were not finite.
    pub fn dropped(&self) -> u64 {
        self.tile.dropped
    }

    /// The least id of a dropped sample, which replays it: the same whatever the order of the work.
    pub fn first_dropped(&self) -> Option<SampleId> {
        self.tile.first_dropped
    }

    /// The means of all pixels, black outside of [`Film::area`].
    pub fn picture(&self) -> Picture {
        self.picture_of(PixelBounds { x0: 0, y0: 0, x1: self.width, y1: self.height })
    }

    /// The means of the pixels of a rectangle, black outside of [`Film::area`]: a picture of its size.
    pub fn picture_of(&self, part: PixelBounds) -> Picture {
        let (width, height) = (part.x1.saturating_sub(part.x0), part.y1.saturating_sub(part.y0));
        let mut pixels = vec![[0.0; 3]; width as usize * height as usize];
        let PixelBounds { x0, y0, x1, y1 } = common(part, self.tile.area);
        for y in y0..y1 {
            let start = (y - part.y0) as usize * width as usize;
            let row = &mut pixels[start + (x0 - part.x0) as usize..start + (x1 - part.x0) as usize];
            for (mean, pixel) in row.iter_mut().zip(&self.tile.pixels[self.tile.row(y, x0, x1)]) {
                *mean = pixel.mean();
            }
        }
        Picture { width, height, pixels, alpha: self.alpha(part) }
    }

    /// Alpha of the pixels of a rectangle; empty where the film has none.
    fn alpha(&self, part: PixelBounds) -> Vec<f32> {
        let FilmTile { pixels, alphas, .. } = &self.tile;
        if alphas.is_empty() {
            return Vec::new();
        }
        let mean = |index: usize| match pixels[index].samples {
            0 => 0.0,
            samples => (alphas[index] as f64 / (samples as f64 * TWO_TO_64)) as f32,
        };
        let rows = (part.y0..part.y1).flat_map(|y| (part.x0..part.x1).map(move |x| (x, y)));
        rows.map(|(x, y)| self.tile.index(x, y).map_or(0.0, mean)).collect()
    }
}

/// The intersection of two rectangles; if it is empty, the empty rectangle at the origin.
fn common(a: PixelBounds, b: PixelBounds) -> PixelBounds {
    let (x0, x1) = (a.x0.max(b.x0), a.x1.min(b.x1));
    let (y0, y1) = (a.y0.max(b.y0), a.y1.min(b.y1));
    if x0 < x1 && y0 < y1 {
        PixelBounds { x0, y0, x1, y1 }
    } else {
        PixelBounds { x0: 0, y0: 0, x1: 0, y1: 0 }
    }
}

/// The smallest rectangle around two.
pub(crate) fn union(a: PixelBounds, b: PixelBounds) -> PixelBounds {
    PixelBounds { x0: a.x0.min(b.x0), y0: a.y0.min(b.y0), x1: a.x1.max(b.x1), y1: a.y1.max(b.y1) }
}

fn too_large(message: String) -> Error {
    Error::new(ErrorKind::Limit, &Location::default(), message)
        .hint("make the picture smaller, or render it in several crops of a smaller one")
}

#[cfg(test)]
mod tests;
