//! Tiles of a film, each filled by one thread.

use std::ops::Range;

use lookfrom_scene::Result;
use lookfrom_scene::settings::{ImageSettings, PixelBounds};

use super::buckets::{BucketSums, counted};
use super::layout::Layout;
use super::ledger::SampleLedger;
use super::light_paths::LightPathSums;
use super::motion::MotionSums;
use super::pixel::Pixel;
use super::weighted::WeightSums;
use super::{BRIGHTEST, FEATURE_SAMPLES, MOST_PIXELS, SampleId, too_large, twice, xyz};
use crate::aov::{AovSums, Aovs, LayerSums};
use crate::core::fixed_point::{fixed_point, fixed_point_square};

/// The light of a rectangle of a film, for one thread to fill.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FilmTile {
    pub(super) area: PixelBounds,
    pub(super) layout: Layout,
    pub(super) pixels: Vec<Pixel>,
    /// One per pixel, or none.
    pub(super) layers: Vec<LayerSums>,
    /// Sums of the sensor's channels and of their squares: one per pixel, or none.
    pub(super) channels: Vec<Pixel>,
    /// One per pixel, or none.
    pub(super) features: Vec<AovSums>,
    /// One per pixel, or none.
    pub(super) motions: Vec<MotionSums>,
    /// For each layer of light-path expressions, one per pixel.
    pub(super) light_paths: Vec<Vec<LightPathSums>>,
    /// For each bucket of a spectral film, one per pixel.
    pub(super) buckets: Vec<Vec<BucketSums>>,
    /// Sums of alpha, in multiples of 2⁻⁶⁴: one per pixel, or none.
    pub(super) alphas: Vec<i128>,
    /// Sums of their squares, in multiples of 2⁻⁴⁸: one per pixel, or none.
    pub(super) alpha_squares: Vec<u128>,
    /// Of filter weights: one per pixel, or none.
    pub(super) weights: Vec<WeightSums>,
    /// As alphas, light and buckets, with the magnitudes of the weights: of all light, then for each layer of light-path expressions.
    pub(super) unsigned_alphas: Vec<i128>,
    pub(super) unsigned_light: Vec<Vec<LightPathSums>>,
    pub(super) unsigned_buckets: Vec<Vec<i128>>,
    pub(super) dropped: u64,
    pub(super) first_dropped: Option<SampleId>,
    /// The samples that were [recorded](FilmTile::record).
    pub(super) ledger: SampleLedger,
}

impl FilmTile {
    /// A black tile. An area that ends before it begins is empty.
    ///
    /// An error if the area has more than [`MOST_PIXELS`] or there is no memory for it.
    pub fn new(area: PixelBounds) -> Result<Self> {
        Self::for_image(area, &ImageSettings::default())
    }

    /// As [`FilmTile::new`], with memory for everything that the settings need: AOVs, alpha.
    ///
    /// # Errors
    /// `Limit` as [`FilmTile::new`].
    pub fn for_image(area: PixelBounds, image: &ImageSettings) -> Result<Self> {
        Self::with_layout(area, Layout::of_image(image))
    }

    /// A black tile with the sums of a layout.
    pub(super) fn with_layout(area: PixelBounds, layout: Layout) -> Result<Self> {
        let count = area.pixels();
        if count > MOST_PIXELS {
            return Err(too_large(format!("{count} pixels; at most {MOST_PIXELS} are possible")));
        }
        let of = |has: bool| if has { count } else { 0 };
        Ok(Self {
            area,
            layout,
            pixels: empty(count)?,
            layers: empty(of(layout.aovs))?,
            channels: empty(of(layout.sensor))?,
            features: empty(of(layout.features))?,
            motions: empty(of(layout.motion))?,
            light_paths: (0..layout.light_paths).map(|_| empty(count)).collect::<Result<_>>()?,
            buckets: (0..layout.buckets).map(|_| empty(count)).collect::<Result<_>>()?,
            alphas: empty(of(layout.alpha))?,
            alpha_squares: empty(of(layout.alpha_squares()))?,
            weights: empty(of(layout.weights))?,
            unsigned_alphas: empty(of(layout.unsigned_alphas()))?,
            unsigned_light: (0..layout.unsigned_light()).map(|_| empty(count)).collect::<Result<_>>()?,
            unsigned_buckets: (0..layout.unsigned_buckets()).map(|_| empty(count)).collect::<Result<_>>()?,
            dropped: 0,
            first_dropped: None,
            ledger: SampleLedger::default(),
        })
    }

    /// Whether the tile has AOVs.
    pub fn has_layers(&self) -> bool {
        !self.layers.is_empty()
    }

    /// Whether the first hit of a sample is needed: whether [`FilmTile::add_first_hit`] does anything.
    pub fn wants_first_hit(&self, sample: u32) -> bool {
        self.has_layers() || !self.features.is_empty() && sample < FEATURE_SAMPLES
    }

    /// Whether the tile has layers of light-path expressions.
    pub fn has_light_paths(&self) -> bool {
        !self.light_paths.is_empty()
    }

    /// Adds the light of one sample, which has been multiplied by a filter weight, to the layers of light-path expressions, in their
    /// order, unless the sample is dropped: unless its whole light, `rgb`, is not finite.
    ///
    /// # Panics
    /// If the pixel is outside of the tile.
    pub fn add_light_paths(
        &mut self,
        x: u32,
        y: u32,
        rgb: [f32; 3],
        weight: f32,
        layers: impl Iterator<Item = [f32; 3]>,
    ) {
        let index = self.index_inside(x, y);
        if rgb.iter().all(|light| light.is_finite()) {
            for (number, light) in layers.enumerate() {
                self.light_paths[number][index].add(light);
                let layer = self.unsigned_light.get_mut(number + 1);
                layer
                    .into_iter()
                    .for_each(|layer| layer[index].add(light.map(|light| unsigned(light, weight))));
            }
        }
    }

    /// Whether the tile has the buckets of a spectral film.
    pub fn has_buckets(&self) -> bool {
        !self.buckets.is_empty()
    }

    /// Adds the light of one sample, multiplied by its filter weight, to the buckets of a spectral film, unless the sample is dropped, as in
    /// [`FilmTile::add_light_paths`]: for each of its wavelengths the number of its bucket, the radiance, and for how many wavelengths of
    /// uniform density it counts.
    ///
    /// # Panics
    /// If the pixel is outside of the tile, or there is no such bucket.
    pub fn add_spectrum(
        &mut self,
        x: u32,
        y: u32,
        rgb: [f32; 3],
        weight: f32,
        wavelengths: impl Iterator<Item = (usize, f32, u32)>,
    ) {
        let index = self.index_inside(x, y);
        if rgb.iter().all(|light| light.is_finite()) {
            for (bucket, radiance, count) in wavelengths {
                self.buckets[bucket][index].add(radiance, count);
                if let Some(sums) = self.unsigned_buckets.get_mut(bucket) {
                    sums[index] = sums[index].wrapping_add(counted(unsigned(radiance, weight), count));
                }
            }
        }
    }

    /// Whether the sensor's channels are needed: whether [`FilmTile::add_channels`] does anything.
    pub fn has_channels(&self) -> bool {
        !self.channels.is_empty()
    }

    /// The pixels it covers.
    pub fn area(&self) -> PixelBounds {
        self.area
    }

    /// Adds the light of one sample to its pixel.
    ///
    /// Each of red, green and blue is clamped to ±[`BRIGHTEST`], then added exactly if its magnitude is at least 2⁻⁴⁰,
    /// else truncated towards zero at 2⁻⁶⁴. A sample that is not finite in all three is dropped and counted, and its id
    /// is kept.
    ///
    /// # Panics
    /// If the pixel is outside of the tile.
    pub fn add(&mut self, x: u32, y: u32, sample: u32, rgb: [f32; 3]) {
        self.add_weighted(x, y, sample, rgb, 1.0, 1.0);
    }

    /// As [`FilmTile::add`], of light that has been multiplied by a filter weight, and adds the weight and the sample's alpha times
    /// it, if the tile has them: a sample whose alpha is not finite is dropped as well.
    ///
    /// # Panics
    /// If the pixel is outside of the tile.
    pub fn add_weighted(&mut self, x: u32, y: u32, sample: u32, rgb: [f32; 3], alpha: f32, weight: f32) {
        let index = self.index_inside(x, y);
        let alpha = alpha * weight;
        if !alpha.is_finite() || !rgb.iter().all(|light| light.is_finite()) {
            self.drop_samples(1, Some(SampleId { pixel: [x, y], sample }));
            return;
        }
        self.pixels[index].add(rgb, xyz);
        if let Some(light) = self.unsigned_light.first_mut() {
            self.weights[index].add(weight);
            light[index].add(rgb.map(|light| unsigned(light, weight)));
        }
        if let Some(sum) = self.alphas.get_mut(index) {
            *sum = sum.wrapping_add(fixed_point(alpha));
            if let Some(sum) = self.unsigned_alphas.get_mut(index) {
                *sum = sum.wrapping_add(fixed_point(unsigned(alpha, weight)));
            }
            if let Some(squares) = self.alpha_squares.get_mut(index) {
                let square = fixed_point_square(f64::from(alpha.clamp(-BRIGHTEST, BRIGHTEST)));
                *squares = squares.saturating_add(square);
            }
        }
    }

    /// Adds the first hit of one sample, `None` for a miss, where there is memory for it: to the AOVs, and for the
    /// first [`FEATURE_SAMPLES`] of a pixel to the denoiser features. A hit that is not finite counts as a miss.
    ///
    /// # Panics
    /// If the pixel is outside of the tile.
    pub fn add_first_hit(&mut self, x: u32, y: u32, sample: u32, met: Option<&Aovs>) {
        self.merge_aovs([x, y], &LayerSums::of_sample(sample, met), sample < FEATURE_SAMPLES);
    }

    /// Adds sums to the AOVs of a pixel, and if they count for the denoiser to its features, where there is memory for them.
    #[inline]
    pub(super) fn merge_aovs(&mut self, [x, y]: [u32; 2], sums: &LayerSums, are_features: bool) {
        let index = self.index_inside(x, y);
        self.layers.get_mut(index).into_iter().for_each(|layer| layer.merge(sums));
        let features = self.features.get_mut(index).filter(|_| are_features);
        features.into_iter().for_each(|features| features.merge(&sums.shared));
    }

    /// Whether motion vectors are needed: whether [`FilmTile::add_motion`] does anything.
    pub fn has_motion(&self) -> bool {
        !self.motions.is_empty()
    }

    /// Adds the motion vector of the first hit of one sample, where there is memory for it: in pixels, to the right and upwards.
    ///
    /// # Panics
    /// If the pixel is outside of the tile.
    pub fn add_motion(&mut self, x: u32, y: u32, motion: [f32; 2]) {
        let index = self.index_inside(x, y);
        self.motions.get_mut(index).into_iter().for_each(|sums| sums.add(motion));
    }

    /// Adds the sensor's channels of one sample, where there is memory for them and all are finite.
    ///
    /// # Panics
    /// If the pixel is outside of the tile.
    pub fn add_channels(&mut self, x: u32, y: u32, channels: [f32; 3]) {
        let index = self.index_inside(x, y);
        let sums = self.channels.get_mut(index).filter(|_| channels.iter().all(|value| value.is_finite()));
        sums.into_iter().for_each(|sums| sums.add(channels, |channels| channels));
    }

    /// Records that the tile has these samples of all its pixels, those that were dropped included. Films of recorded
    /// tiles know what they hold; [`Renderer::render_tile`](crate::render::Renderer::render_tile) records what it adds.
    ///
    /// # Errors
    /// `Invalid` where it has one of them already.
    pub fn record(&mut self, samples: Range<u32>) -> Result<()> {
        self.record_part(self.area, samples)
    }

    /// Records that it has these samples of the pixels of a part.
    ///
    /// # Errors
    /// As [`FilmTile::record`].
    pub(crate) fn record_part(&mut self, part: PixelBounds, samples: Range<u32>) -> Result<()> {
        self.ledger.add(part, samples).map_err(|overlap| twice(&overlap))
    }

    pub(super) fn drop_samples(&mut self, count: u64, first: Option<SampleId>) {
        self.dropped = self.dropped.saturating_add(count);
        self.first_dropped = self.first_dropped.into_iter().chain(first).min();
    }

    pub(super) fn index(&self, x: u32, y: u32) -> Option<usize> {
        self.area.contains(x, y).then(|| self.area.index(x, y))
    }

    pub(super) fn index_inside(&self, x: u32, y: u32) -> usize {
        let index = self.index(x, y);
        index.unwrap_or_else(|| panic!("pixel ({x}, {y}) is outside of the tile {:?}", self.area))
    }

    /// The indices of the pixels of columns `from` to `to` (exclusive) of row `y`. They must be inside.
    pub(super) fn row(&self, y: u32, from: u32, to: u32) -> Range<usize> {
        self.area.index(from, y)..self.area.index(to, y)
    }
}

/// A number that was multiplied by a weight, as multiplied by the weight's magnitude.
fn unsigned(number: f32, weight: f32) -> f32 {
    if weight < 0.0 { -number } else { number }
}

/// `count` zeros; an error if there is no memory for them.
fn empty<T: Clone + Default>(count: u64) -> Result<Vec<T>> {
    let mut values = room(count)?;
    values.resize(count as usize, T::default());
    Ok(values)
}

/// Memory for `count` values; an error if there is none.
pub(super) fn room<T>(count: u64) -> Result<Vec<T>> {
    let mut values = Vec::new();
    match values.try_reserve_exact(count as usize) {
        Ok(()) => Ok(values),
        Err(_) => Err(too_large(format!("no memory for {count} times {} bytes", size_of::<T>()))),
    }
}
