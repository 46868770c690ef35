//! The film: sums of samples per pixel in fixed point, independent of their order.
//!
//! Step 7 on the way of a pixel. Sums of floating-point numbers depend on their order, sums of integers do not. So each
//! pixel holds three fixed-point sums of 128 bits, 64 of them behind the binary point, and as many of squares, for the
//! variance; any division of the work among threads, tiles, passes or machines ends in the same bytes *by
//! construction*. What a camera sees first, for layers and denoiser, is in [`aov`]; what its sensor measures, in `channels`; how much
//! noise there is, in `noise`; what becomes of single samples that outshine a pixel, in `fireflies`. How a picture is shown
//! is left to [`crate::post::develop`].
//!
//! A pixel takes 112 bytes, and as much more as [`aov`] and `channels` say where they are asked for.

pub mod aov;
mod channels;
mod fireflies;
mod noise;

use self::aov::{AovSums, LayerSums};
pub use self::aov::{Aovs, DenoiserFeatures, FEATURE_SAMPLES};
use self::channels::ChannelSums;

use lookfrom_scene::settings::{Background, ImageSettings, Layers, PixelBounds};
use lookfrom_scene::spectrum::space::xyz_of_rec709 as xyz;
use lookfrom_scene::{Error, ErrorKind, Location, Result};
use std::cmp::Ordering;
use std::ops::Range;

/// Films have at most this many pixels: 2²⁸, which take 28 GiB.
pub const MOST_PIXELS: u64 = 1 << 28;

/// Light is taken for at most this much: 2⁴⁰ in either direction. So the sums hold at least 2²³ samples of the very
/// brightest, and far more of any other.
pub const BRIGHTEST: f32 = 1_099_511_627_776.0;

/// The light that a picture's samples brought, pixel by pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Film {
    width: u32,
    height: u32,
    tile: FilmTile,
}

/// The light of a rectangle of a film, for one thread to fill.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FilmTile {
    area: PixelBounds,
    pixels: Vec<Pixel>,
    /// As many as there are pixels, or none.
    layers: Vec<LayerSums>,
    /// As many as there are pixels, or none.
    channels: Vec<ChannelSums>,
    /// As many as there are pixels, or none.
    features: Vec<AovSums>,
    /// Sums of how much samples hide of what is behind, in multiples of 2⁻⁶⁴: as many as there are pixels, or none.
    alphas: Vec<i128>,
    /// Sums of their squares, in multiples of 2⁻⁴⁸: as many as there are pixels, or none.
    alpha_squares: Vec<u128>,
    dropped: u64,
    first_dropped: Option<SampleId>,
}

/// Which sample of which pixel. The order is that of reading: row, column, sample.
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
    /// How much each pixel hides of what is behind the picture, 0 … 1 but for noise; the colours are multiplied by it. Empty
    /// where nothing is behind.
    pub alpha: Vec<f32>,
}

impl Picture {
    /// Puts a smaller picture in the place of a part of this one, whose upper left corner is at column `x0` and row `y0`.
    /// What lies outside is left out.
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

    /// The picture before a background of light as it is, of which alpha shows its share; one without alpha stays the same.
    pub fn before(mut self, background: [f32; 3]) -> Self {
        for (pixel, alpha) in self.pixels.iter_mut().zip(std::mem::take(&mut self.alpha)) {
            let share = 1.0 - alpha.clamp(0.0, 1.0);
            *pixel = std::array::from_fn(|c| pixel[c] + share * background[c]);
        }
        self
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Pixel {
    /// Multiples of 2⁻⁶⁴. Additions wrap, which keeps them independent of their order even where they overflow.
    sums: [i128; 3],
    /// Multiples of 2⁻⁴⁸. Additions stop at the end, which is independent of their order, too, where nothing is negative.
    squares: [u128; 3],
    samples: u64,
}

impl Film {
    /// A black film for a picture of `width` × `height` pixels, of which only `crop` (cut to the picture) is held.
    ///
    /// An error if the picture has more than [`MOST_PIXELS`] or there is no memory for it.
    pub fn new(width: u32, height: u32, crop: Option<PixelBounds>) -> Result<Self> {
        Self::with_layers(width, height, crop, Layers::None)
    }

    /// As [`Film::new`], with room for what the layers need besides light.
    pub fn with_layers(width: u32, height: u32, crop: Option<PixelBounds>, layers: Layers) -> Result<Self> {
        Self::for_image(&ImageSettings { width, height, crop, layers, ..ImageSettings::default() })
    }

    /// A black film with room for all that a picture is asked for: layers, alpha.
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

    /// Adds the light of one sample to its pixel, as [`FilmTile::add`] does.
    ///
    /// # Panics
    /// If the pixel is outside of [`Film::area`].
    pub fn add(&mut self, x: u32, y: u32, sample: u32, rgb: [f32; 3]) {
        self.tile.add(x, y, sample, rgb);
    }

    /// Adds what a tile holds. What lies outside of [`Film::area`] is left out; samples that the tile dropped are
    /// counted all the same.
    pub fn add_tile(&mut self, tile: &FilmTile) {
        self.tile.merge(tile);
    }

    /// Adds what another film of the same picture holds: other samples, or other pixels.
    ///
    /// An error if the pictures differ in size.
    pub fn merge(&mut self, other: &Self) -> Result<()> {
        if (self.width, self.height) != (other.width, other.height) {
            let message = format!(
                "a film of {} × {} pixels cannot be added to one of {} × {}",
                other.width, other.height, self.width, self.height
            );
            return Err(Error::invalid(&Location::default(), message)
                .hint("merge only renders of the same scene at the same size"));
        }
        self.add_tile(&other.tile);
        Ok(())
    }

    /// The mean of a pixel's samples: exact up to one rounding to f64 for the sum, one for the quotient and one to f32.
    /// Black where there are none, and outside of [`Film::area`].
    pub fn mean(&self, x: u32, y: u32) -> [f32; 3] {
        self.tile.pixel(x, y).map_or([0.0; 3], Pixel::mean)
    }

    /// The variance of *one* sample of a pixel in X, Y and Z (CIE 1931, as [`xyz`] has them; so the second is that of the
    /// luminance), estimated from its samples without bias. Divided by [`Film::samples`] it is that of the mean of
    /// independent samples; well-spread ones vary less. Infinite with fewer than two samples, and outside of
    /// [`Film::area`]. Squares of more than 2⁸⁰ in all are not counted on.
    pub fn variance(&self, x: u32, y: u32) -> [f32; 3] {
        self.tile
            .pixel(x, y)
            .map_or([f32::INFINITY; 3], |pixel| pixel.variance().map(|variance| variance as f32))
    }

    /// The variance of *one* sample of a pixel in the channels of the sensor, estimated as [`Film::variance`] is; `None` where the
    /// film has no room for it (no layers, or a sensor that measures X, Y and Z), and outside of [`Film::area`].
    pub fn channel_variance(&self, x: u32, y: u32) -> Option<[f32; 3]> {
        self.tile.channels.get(self.tile.index(x, y)?).map(ChannelSums::variance)
    }

    /// What the camera sees first in a pixel, in the mean over its samples: the albedo over all of them (nothing is black), all
    /// else over those that met something. `None` where the film has no room for it, where no sample met anything, and outside
    /// of [`Film::area`].
    pub fn aovs(&self, x: u32, y: u32) -> Option<Aovs> {
        self.tile.layers.get(self.tile.index(x, y)?)?.mean()
    }

    /// Whether there is room for layers.
    pub fn has_layers(&self) -> bool {
        self.tile.has_layers()
    }

    /// What the denoiser compares a pixel by; `None` where the film has no room for it or no samples, and outside of
    /// [`Film::area`].
    pub fn denoiser_features(&self, x: u32, y: u32) -> Option<DenoiserFeatures> {
        self.tile.features.get(self.tile.index(x, y)?)?.features()
    }

    /// The variance of how much *one* sample of a pixel hides of what is behind, estimated as [`Film::variance`] is. 0 where the
    /// film has no alpha or no room for what the denoiser is told, and outside of [`Film::area`].
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

    /// How many samples a pixel holds, without those that were dropped.
    pub fn samples(&self, x: u32, y: u32) -> u64 {
        self.tile.pixel(x, y).map_or(0, |pixel| pixel.samples)
    }

    /// How many samples were dropped because they were not finite.
    pub fn dropped(&self) -> u64 {
        self.tile.dropped
    }

    /// The least address of a dropped sample, which replays it: the same whatever the order of the work.
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

    /// How much each pixel of a rectangle hides of what is behind; empty where that was not asked for.
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

impl FilmTile {
    /// A black tile. An area that ends before it begins is empty.
    ///
    /// An error if the area has more than [`MOST_PIXELS`] or there is no memory for it.
    pub fn new(area: PixelBounds) -> Result<Self> {
        Self::with_layers(area, Layers::None)
    }

    /// As [`FilmTile::new`], with room for what the layers need besides light.
    pub fn with_layers(area: PixelBounds, layers: Layers) -> Result<Self> {
        Self::for_image(area, &ImageSettings { layers, ..ImageSettings::default() })
    }

    /// As [`FilmTile::new`], with room for all that a picture is asked for: layers, alpha.
    ///
    /// # Errors
    /// `Limit` as [`FilmTile::new`].
    pub fn for_image(area: PixelBounds, image: &ImageSettings) -> Result<Self> {
        let count = u64::from(area.x1.saturating_sub(area.x0)) * u64::from(area.y1.saturating_sub(area.y0));
        if count > MOST_PIXELS {
            return Err(too_large(format!("{count} pixels; at most {MOST_PIXELS} are possible")));
        }
        let pixels = empty(count)?;
        let layers = match image.layers {
            Layers::None => Vec::new(),
            Layers::Geometry => empty(count)?,
        };
        let channels = match image.layers {
            Layers::Geometry if !image.sensor.measures_xyz() => empty(count)?,
            _ => Vec::new(),
        };
        let features = if image.denoise { empty(count)? } else { Vec::new() };
        let (alphas, alpha_squares) = match image.background {
            Background::Environment => (Vec::new(), Vec::new()),
            Background::Color(_) | Background::Transparent => {
                (empty(count)?, if image.denoise { empty(count)? } else { Vec::new() })
            }
        };
        let (dropped, first_dropped) = (0, None);
        Ok(Self { area, pixels, layers, channels, features, alphas, alpha_squares, dropped, first_dropped })
    }

    /// Whether there is room for layers.
    pub fn has_layers(&self) -> bool {
        !self.layers.is_empty()
    }

    /// Whether there is room for what the camera's ray of a sample met: whether [`FilmTile::add_first_hit`] does anything.
    pub fn wants_first_hit(&self, sample: u32) -> bool {
        self.has_layers() || !self.features.is_empty() && sample < FEATURE_SAMPLES
    }

    /// Whether there is room for what the sensor measures: whether [`FilmTile::add_channels`] does anything.
    pub fn has_channels(&self) -> bool {
        !self.channels.is_empty()
    }

    /// The pixels it covers.
    pub fn area(&self) -> PixelBounds {
        self.area
    }

    /// Adds the light of one sample to its pixel.
    ///
    /// Each of red, green and blue is cut to ±[`BRIGHTEST`], then added exactly if its magnitude is at least 2⁻⁴⁰, else
    /// cut towards zero at 2⁻⁶⁴. A sample that is not finite in all three is dropped, counted and remembered by its
    /// address.
    ///
    /// # Panics
    /// If the pixel is outside of the tile.
    pub fn add(&mut self, x: u32, y: u32, sample: u32, rgb: [f32; 3]) {
        self.add_with_alpha(x, y, sample, rgb, 1.0);
    }

    /// As [`FilmTile::add`], and adds how much the sample hides of what is behind, where there is room for that: a sample
    /// for which this is not finite is dropped as well.
    ///
    /// # Panics
    /// If the pixel is outside of the tile.
    pub fn add_with_alpha(&mut self, x: u32, y: u32, sample: u32, rgb: [f32; 3], alpha: f32) {
        let index = self.index_inside(x, y);
        if !alpha.is_finite() || !rgb.iter().all(|light| light.is_finite()) {
            self.drop_samples(1, Some(SampleId { pixel: [x, y], sample }));
            return;
        }
        let pixel = &mut self.pixels[index];
        for (sum, light) in pixel.sums.iter_mut().zip(rgb) {
            *sum = sum.wrapping_add(fixed_point(light));
        }
        let cut = rgb.map(|light| f64::from(light.clamp(-BRIGHTEST, BRIGHTEST)));
        for (sum, value) in pixel.squares.iter_mut().zip(xyz(cut)) {
            *sum = sum.saturating_add(fixed_point_square(value));
        }
        pixel.samples = pixel.samples.saturating_add(1);
        if let Some(sum) = self.alphas.get_mut(index) {
            *sum = sum.wrapping_add(fixed_point(alpha));
            if let Some(squares) = self.alpha_squares.get_mut(index) {
                let square = fixed_point_square(f64::from(alpha.clamp(-BRIGHTEST, BRIGHTEST)));
                *squares = squares.saturating_add(square);
            }
        }
    }

    /// Adds what the camera's ray of one sample met, `None` for nothing, where there is room for it: to the layers, and of the
    /// first [`FEATURE_SAMPLES`] of a pixel to what the denoiser compares. What is not finite counts as nothing.
    ///
    /// # Panics
    /// If the pixel is outside of the tile.
    pub fn add_first_hit(&mut self, x: u32, y: u32, sample: u32, met: Option<&Aovs>) {
        let index = self.index_inside(x, y);
        if let Some(sums) = self.layers.get_mut(index) {
            sums.add(sample, met);
        }
        if sample < FEATURE_SAMPLES
            && let Some(sums) = self.features.get_mut(index)
        {
            sums.add(sample, met);
        }
    }

    /// Adds what the sensor's channels measured of one sample, where there is room for it and all is finite.
    ///
    /// # Panics
    /// If the pixel is outside of the tile.
    pub fn add_channels(&mut self, x: u32, y: u32, channels: [f32; 3]) {
        let index = self.index_inside(x, y);
        if let Some(sums) = self.channels.get_mut(index) {
            sums.add(channels);
        }
    }

    /// Adds what another tile holds within the area of this one.
    fn merge(&mut self, other: &Self) {
        let PixelBounds { x0, y0, x1, y1 } = common(self.area, other.area);
        for y in y0..y1 {
            let rows = [self.row(y, x0, x1), other.row(y, x0, x1)];
            merge_row(&mut self.pixels, &other.pixels, &rows, Pixel::merge);
            merge_row(&mut self.alphas, &other.alphas, &rows, |sum, add| *sum = sum.wrapping_add(*add));
            merge_row(&mut self.alpha_squares, &other.alpha_squares, &rows, |sum, add| {
                *sum = sum.saturating_add(*add);
            });
            merge_row(&mut self.layers, &other.layers, &rows, LayerSums::merge);
            merge_row(&mut self.channels, &other.channels, &rows, ChannelSums::merge);
            merge_row(&mut self.features, &other.features, &rows, AovSums::merge);
        }
        self.drop_samples(other.dropped, other.first_dropped);
    }

    fn drop_samples(&mut self, count: u64, first: Option<SampleId>) {
        self.dropped = self.dropped.saturating_add(count);
        self.first_dropped = self.first_dropped.into_iter().chain(first).min();
    }

    fn pixel(&self, x: u32, y: u32) -> Option<&Pixel> {
        self.index(x, y).map(|index| &self.pixels[index])
    }

    fn index(&self, x: u32, y: u32) -> Option<usize> {
        let PixelBounds { x0, y0, x1, y1 } = self.area;
        let inside = (x0..x1).contains(&x) && (y0..y1).contains(&y);
        inside.then(|| (y - y0) as usize * (x1 - x0) as usize + (x - x0) as usize)
    }

    fn index_inside(&self, x: u32, y: u32) -> usize {
        let index = self.index(x, y);
        index.unwrap_or_else(|| panic!("pixel ({x}, {y}) is outside of the tile {:?}", self.area))
    }

    /// Where the pixels of columns `from` to before `to` of row `y` are. They must be inside.
    fn row(&self, y: u32, from: u32, to: u32) -> Range<usize> {
        let PixelBounds { x0, y0, x1, .. } = self.area;
        let start = (y - y0) as usize * (x1 - x0) as usize;
        start + (from - x0) as usize..start + (to - x0) as usize
    }
}

impl Pixel {
    fn merge(&mut self, add: &Self) {
        for (sum, add) in self.sums.iter_mut().zip(add.sums) {
            *sum = sum.wrapping_add(add);
        }
        for (sum, add) in self.squares.iter_mut().zip(add.squares) {
            *sum = sum.saturating_add(add);
        }
        self.samples = self.samples.saturating_add(add.samples);
    }

    fn mean(&self) -> [f32; 3] {
        if self.samples == 0 {
            return [0.0; 3];
        }
        let scale = self.samples as f64 * TWO_TO_64;
        self.sums.map(|sum| (sum as f64 / scale) as f32)
    }

    /// Of one sample, in X, Y and Z: the mean of the squares less the square of the mean, times n / (n − 1).
    fn variance(&self) -> [f64; 3] {
        if self.samples < 2 {
            return [f64::INFINITY; 3];
        }
        let n = self.samples as f64;
        let mean = xyz(self.sums.map(|sum| sum as f64 / (n * TWO_TO_64)));
        std::array::from_fn(|channel| {
            unbiased_variance(n, mean[channel], self.squares[channel] as f64 / (n * TWO_TO_48))
        })
    }
}

/// Of one of `n` > 1 samples, by their mean and that of their squares.
fn unbiased_variance(n: f64, mean: f64, mean_of_squares: f64) -> f64 {
    // Rounding leaves a little of equal samples, on either side of zero.
    (mean_of_squares - mean * mean).max(0.0) * (n / (n - 1.0))
}

/// Adds some of `theirs` to as many of `mine`, unless one of the two films has no room for them.
fn merge_row<T>(mine: &mut [T], theirs: &[T], [to, from]: &[Range<usize>; 2], add: impl Fn(&mut T, &T)) {
    if let (Some(mine), Some(theirs)) = (mine.get_mut(to.clone()), theirs.get(from.clone())) {
        mine.iter_mut().zip(theirs).for_each(|(mine, theirs)| add(mine, theirs));
    }
}

const TWO_TO_47: f64 = 140_737_488_355_328.0;
const TWO_TO_48: f64 = 281_474_976_710_656.0;
const TWO_TO_63: f64 = 9_223_372_036_854_775_808.0;
const TWO_TO_64: f64 = 18_446_744_073_709_551_616.0;

/// The square of a finite number, rounded to f64, as a multiple of 2⁻⁴⁸; at most the greatest there is.
fn fixed_point_square(value: f64) -> u128 {
    let square = value * value * TWO_TO_48;
    // The cast cuts at both ends; nearly always 64 bits do, and they take a fraction of the time.
    if square < TWO_TO_63 { u128::from(square as u64) } else { square as u128 }
}

/// As many zeros as there is memory for.
fn empty<T: Clone + Default>(count: u64) -> Result<Vec<T>> {
    let mut values = Vec::new();
    if values.try_reserve_exact(count as usize).is_err() {
        return Err(too_large(format!("no memory for {count} pixels of {} bytes", size_of::<T>())));
    }
    values.resize(count as usize, T::default());
    Ok(values)
}

/// A finite number as a multiple of 2⁻⁶⁴, cut towards zero.
fn fixed_point(light: f32) -> i128 {
    // An f32 in f64 can be multiplied by a power of two exactly. From 2⁻²⁴ on it is a whole multiple of 2⁻⁴⁷: then, which is
    // nearly always, 64 bits do, and they take a fraction of the time.
    let light = f64::from(light.clamp(-BRIGHTEST, BRIGHTEST));
    let upper = light * TWO_TO_47;
    let cut = upper as i64;
    if upper.abs() < TWO_TO_63 && cut as f64 == upper {
        i128::from(cut) << 17
    } else {
        (light * TWO_TO_64) as i128
    }
}

/// What two rectangles share; where that is nothing, the empty rectangle at the origin.
fn common(a: PixelBounds, b: PixelBounds) -> PixelBounds {
    let (x0, x1) = (a.x0.max(b.x0), a.x1.min(b.x1));
    let (y0, y1) = (a.y0.max(b.y0), a.y1.min(b.y1));
    if x0 < x1 && y0 < y1 {
        PixelBounds { x0, y0, x1, y1 }
    } else {
        PixelBounds { x0: 0, y0: 0, x1: 0, y1: 0 }
    }
}

fn too_large(message: String) -> Error {
    Error::new(ErrorKind::Limit, &Location::default(), message)
        .hint("make the picture smaller, or render it in several crops of a smaller one")
}

#[cfg(test)]
mod tests;
