//! The film: sums of samples per pixel in fixed point, independent of their order.
//!
//! Sums of floating-point numbers depend on their order, sums of integers do not. So each pixel holds three fixed-point
//! sums of 128 bits, 64 of them behind the binary point, and as many of squares, for the variance; any division of the
//! work among threads, tiles, passes or machines ends in the same bytes *by construction*. AOVs, for layers and
//! denoiser, are in [`crate::aov`]; noise estimates in `noise`; firefly suppression in `fireflies`; which sums it has, in
//! `layout`, which samples, in `ledger`; its numbers as channels of a file, in `stored`. Conversion for display is in
//! [`crate::post::develop`].
//!
//! In a tile, which a thread fills, a pixel takes 112 bytes, as many for variances in the sensor's channels, and those of AOVs, where they are
//! enabled. The film keeps them packed, in `plane`: in about half of that.

pub mod allocation;
mod buckets;
mod fireflies;
mod first_hits;
mod layout;
mod ledger;
mod light_paths;
mod motion;
mod noise;
mod pixel;
mod plane;
mod stored;
mod sums;
mod tile;

use self::buckets::BucketSums;
pub use self::fireflies::Firefly;
pub(crate) use self::layout::Layout;
pub use self::ledger::{Overlap, SampleLedger};
use self::light_paths::LightPathSums;
use self::motion::MotionSums;
use self::pixel::{Pixel, unbiased_variance};
use self::plane::Plane;
pub(crate) use self::stored::StoredRows;
use self::stored::{Sums, for_each_plane};
pub(crate) use self::sums::SampleSums;
pub use self::tile::FilmTile;

use std::ops::Range;

use lookfrom_scene::settings::{ImageSettings, PixelBounds};
use lookfrom_scene::spectrum::space::xyz_of_rec709 as xyz;
use lookfrom_scene::{Error, ErrorKind, Location, Result};

use crate::aov::{AovSums, LayerSums};
pub use crate::aov::{Aovs, DenoiserFeatures, FEATURE_SAMPLES};
pub use crate::core::fixed_point::BRIGHTEST;
use crate::core::fixed_point::{TWO_TO_48, TWO_TO_64};
use crate::core::hash;
pub use crate::core::sampler::SampleId;

/// Maximum number of pixels of a picture: 2³⁰.
pub const MOST_PIXELS: u64 = lookfrom_scene::settings::MOST_PIXELS;

/// The film: sums of a picture's samples, pixel by pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Film {
    width: u32,
    height: u32,
    area: PixelBounds,
    layout: Layout,
    pixels: Plane<Pixel>,
    layers: Plane<LayerSums>,
    /// Variances in the sensor's channels, where they are not X, Y and Z: for the AOVs, as in pbrt-v4's `gbuffer` film.
    channels: Plane<Pixel>,
    features: Plane<AovSums>,
    motions: Plane<MotionSums>,
    /// For each layer of light-path expressions.
    light_paths: Vec<Plane<LightPathSums>>,
    /// For each bucket of a spectral film.
    buckets: Vec<Plane<BucketSums>>,
    /// Sums of alpha, in multiples of 2⁻⁶⁴.
    alphas: Plane<i128>,
    /// Sums of their squares, in multiples of 2⁻⁴⁸.
    alpha_squares: Plane<u128>,
    dropped: u64,
    first_dropped: Option<SampleId>,
    ledger: SampleLedger,
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
            *pixel = composited(*pixel, alpha, background);
        }
        self
    }
}

impl Film {
    /// A black film for a picture of `width` × `height` pixels, of which only `crop` (clipped to the picture) is held.
    ///
    /// An error if the picture has more than [`MOST_PIXELS`] or there is no memory for it.
    pub fn new(width: u32, height: u32, crop: Option<PixelBounds>) -> Result<Self> {
        Self::for_image(&ImageSettings { width, height, crop, ..ImageSettings::default() })
    }

    /// A black film with memory for everything that the settings need: AOVs, alpha.
    ///
    /// # Errors
    /// `Limit` as [`Film::new`].
    pub fn for_image(image: &ImageSettings) -> Result<Self> {
        Self::with_layout([image.width, image.height], area_of(image), Layout::of_image(image))
    }

    /// A black film of an area of a picture, with the sums of a layout.
    ///
    /// # Errors
    /// `Limit` as [`Film::new`].
    pub(crate) fn with_layout([width, height]: [u32; 2], area: PixelBounds, layout: Layout) -> Result<Self> {
        fn plane<T: Sums>(has: bool, [width, height]: [u32; 2]) -> Result<Plane<T>> {
            if has { Plane::new(width, height) } else { Ok(Plane::none()) }
        }
        let pixels = u64::from(width) * u64::from(height);
        if pixels > MOST_PIXELS {
            return Err(too_large(format!(
                "a picture of {width} × {height} = {pixels} pixels; at most {MOST_PIXELS} are possible"
            )));
        }
        let size = [width, height];
        Ok(Self {
            width,
            height,
            area,
            layout,
            pixels: plane(true, size)?,
            layers: plane(layout.aovs, size)?,
            channels: plane(layout.sensor, size)?,
            features: plane(layout.features, size)?,
            motions: plane(layout.motion, size)?,
            light_paths: (0..layout.light_paths).map(|_| plane(true, size)).collect::<Result<_>>()?,
            buckets: (0..layout.buckets).map(|_| plane(true, size)).collect::<Result<_>>()?,
            alphas: plane(layout.alpha, size)?,
            alpha_squares: plane(layout.alpha_squares(), size)?,
            dropped: 0,
            first_dropped: None,
            ledger: SampleLedger::default(),
        })
    }

    /// A black tile with the same sums.
    fn tile(&self, area: PixelBounds) -> Result<FilmTile> {
        FilmTile::with_layout(area, self.layout)
    }

    /// The bytes of a film for these settings, with those that are needed at the same time to develop and encode its picture:
    /// an estimate.
    pub fn memory(image: &ImageSettings) -> u64 {
        Layout::of_image(image).memory([image.width, image.height], area_of(image))
    }

    /// As [`Film::memory`], for a film with the same sums, of an area of the same picture.
    pub(crate) fn memory_of(&self, area: PixelBounds) -> u64 {
        self.layout.memory([self.width, self.height], area)
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
        self.area
    }

    /// Adds the light of one sample to its pixel, as [`FilmTile::add`] does; it is not recorded in the ledger. The block of the pixel is
    /// packed anew: for many samples, [`Film::add_tile`] is far faster.
    ///
    /// # Panics
    /// If the pixel is outside of [`Film::area`].
    pub fn add(&mut self, x: u32, y: u32, sample: u32, rgb: [f32; 3]) {
        let area = PixelBounds { x0: x, y0: y, x1: x + 1, y1: y + 1 };
        let added = self.tile(area).and_then(|mut tile| {
            tile.add(x, y, sample, rgb);
            self.add_tile(&tile)
        });
        if let Err(error) = added {
            panic!("{error}");
        }
    }

    /// Adds the sums of a tile, which is within [`Film::area`].
    ///
    /// # Errors
    /// As [`Film::merge`].
    pub fn add_tile(&mut self, tile: &FilmTile) -> Result<()> {
        let area = tile.area;
        self.check_same(area, tile.layout)?;
        self.ledger.merge(&tile.ledger).map_err(|overlap| twice(&overlap))?;
        let columns = area.x1.saturating_sub(area.x0) as usize;
        let index = |x: u32, y: u32| (y - area.y0) as usize * columns + (x - area.x0) as usize;
        for_each_plane!([&mut] self => mine, [&] tile => theirs; {
            // Of denoiser features, only the first samples of a pixel have any.
            if theirs.iter().any(|sums| *sums != Default::default()) {
                mine.change(area, |x, y, sums| Sums::merge(sums, &theirs[index(x, y)]));
            }
        });
        self.drop_samples(tile.dropped, tile.first_dropped);
        Ok(())
    }

    /// Whether sums of an area can be added.
    fn check_same(&self, area: PixelBounds, layout: Layout) -> Result<()> {
        let PixelBounds { x0, y0, x1, y1 } = area;
        if x0 >= x1 || y0 >= y1 {
            return Ok(());
        }
        if common(self.area, area) != area {
            let mine = self.area;
            return Err(invalid(format!(
                "pixels {x0},{y0},{x1},{y1} cannot be added to a film of the pixels {},{},{},{}",
                mine.x0, mine.y0, mine.x1, mine.y1
            )));
        }
        match layout == self.layout {
            true => Ok(()),
            false => Err(invalid(format!("a film of {layout} cannot be added to one of {}", self.layout))),
        }
    }

    fn drop_samples(&mut self, count: u64, first: Option<SampleId>) {
        self.dropped = self.dropped.saturating_add(count);
        self.first_dropped = self.first_dropped.into_iter().chain(first).min();
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
        self.check_same(other.area, other.layout)?;
        self.ledger.merge(&other.ledger).map_err(|overlap| twice(&overlap))?;
        for_each_plane!([&mut] self => mine, [&] other => theirs; mine.merge(theirs));
        self.drop_samples(other.dropped, other.first_dropped);
        Ok(())
    }

    /// Which samples of which pixels it holds.
    pub fn ledger(&self) -> &SampleLedger {
        &self.ledger
    }

    pub(crate) fn set_dropped(&mut self, count: u64, first: Option<SampleId>) {
        (self.dropped, self.first_dropped) = (count, first);
    }

    /// Makes an area, which contains its own and is within the picture, that of the film.
    pub fn enlarge(&mut self, area: PixelBounds) {
        self.area =
            union(self.area, common(area, PixelBounds { x0: 0, y0: 0, x1: self.width, y1: self.height }));
    }

    /// Forgets the sums of rows, of which nothing is wanted any more, as far as whole blocks end within them.
    pub(crate) fn forget(&mut self, rows: &Range<u32>) {
        for_each_plane!([&mut] self => plane; plane.forget(rows));
    }

    /// Whether it is as [`Film::for_image`] makes it: of these pixels, with these sums.
    pub fn is_for(&self, image: &ImageSettings) -> bool {
        (self.width, self.height, self.area) == (image.width, image.height, area_of(image))
            && self.layout == Layout::of_image(image)
    }

    pub(crate) fn ledger_mut(&mut self) -> &mut SampleLedger {
        &mut self.ledger
    }

    /// The mean of a pixel's samples: exact up to one rounding to f64 for the sum, one for the quotient and one to f32.
    /// Black where there are none, and outside of [`Film::area`].
    pub fn mean(&self, x: u32, y: u32) -> [f32; 3] {
        self.pixel(x, y).map_or([0.0; 3], |pixel| pixel.mean())
    }

    /// The mean of a pixel composited by its alpha over a background, as [`Picture::before`] does.
    pub fn mean_before(&self, x: u32, y: u32, background: [f32; 3]) -> [f32; 3] {
        let mean = self.mean(x, y);
        self.alpha(x, y).map_or(mean, |alpha| composited(mean, alpha, background))
    }

    /// The unbiased estimate of the variance of *one* sample of a pixel in X, Y and Z (CIE 1931, see [`xyz`]; the
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
        self.sums_of(&self.channels, x, y)
            .map(|sums| sums.variance_of(|mean| mean).map(|variance| variance as f32))
    }

    /// The mean AOVs of a pixel: the albedo over all samples (a miss is black), all others over the samples with a hit.
    /// `None` where the film has no memory for them, where no sample hit anything, and outside of [`Film::area`].
    pub fn aovs(&self, x: u32, y: u32) -> Option<Aovs> {
        self.sums_of(&self.layers, x, y)?.mean()
    }

    /// The mean light of a pixel in each layer of light-path expressions; black outside of [`Film::area`].
    pub fn light_paths(&self, x: u32, y: u32) -> impl Iterator<Item = [f32; 3]> {
        let samples = self.samples(x, y);
        self.light_paths
            .iter()
            .map(move |layer| self.sums_of(layer, x, y).map_or([0.0; 3], |sums| sums.mean(samples)))
    }

    /// The motion vector of a pixel, from the opening to the closing of the shutter, in pixels to the right and upwards: the mean over the
    /// samples with a hit, 0 without any. `None` where the film has no memory for it, and outside of [`Film::area`].
    pub fn motion(&self, x: u32, y: u32) -> Option<[f32; 2]> {
        self.sums_of(&self.motions, x, y).map(|sums| sums.mean())
    }

    /// Whether the film has motion vectors.
    pub fn has_motion(&self) -> bool {
        !self.motions.is_empty()
    }

    /// Whether the film has AOVs.
    pub fn has_layers(&self) -> bool {
        !self.layers.is_empty()
    }

    /// The denoiser features of a pixel; `None` where the film has no memory for them or no samples, and outside of
    /// [`Film::area`].
    pub fn denoiser_features(&self, x: u32, y: u32) -> Option<DenoiserFeatures> {
        self.sums_of(&self.features, x, y)?.features()
    }

    /// The variance of the alpha of *one* sample of a pixel, estimated like [`Film::variance`]. 0 where the film has no
    /// alpha or is not made for the denoiser, and outside of [`Film::area`].
    pub fn alpha_variance(&self, x: u32, y: u32) -> f32 {
        let sums = self.sums_of(&self.alphas, x, y).zip(self.sums_of(&self.alpha_squares, x, y));
        let Some((sum, squares)) = sums else { return 0.0 };
        let samples = self.samples(x, y);
        if samples < 2 {
            return f32::INFINITY;
        }
        let n = samples as f64;
        unbiased_variance(n, sum as f64 / (n * TWO_TO_64), squares as f64 / (n * TWO_TO_48)) as f32
    }

    /// Number of samples of a pixel, without those that were dropped.
    pub fn samples(&self, x: u32, y: u32) -> u64 {
        self.pixel(x, y).map_or(0, |pixel| pixel.samples)
    }

    /// Number of samples that were dropped because they were not finite.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }

    /// The least id of a dropped sample, which replays it: the same whatever the order of the work.
    pub fn first_dropped(&self) -> Option<SampleId> {
        self.first_dropped
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
        let (width, height) = (part.x1.saturating_sub(part.x0), part.y1.saturating_sub(part.y0));
        let mut pixels = vec![[0.0; 3]; width as usize * height as usize];
        let PixelBounds { x0, y0, x1, y1 } = common(part, self.area);
        for y in y0..y1 {
            let start = (y - part.y0) as usize * width as usize;
            let row = &mut pixels[start + (x0 - part.x0) as usize..start + (x1 - part.x0) as usize];
            let mut means = row.iter_mut();
            self.pixels.row(y, x0, x1, |pixel| {
                if let Some(mean) = means.next() {
                    *mean = pixel.mean();
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
        let rows = (part.y0..part.y1).flat_map(|y| (part.x0..part.x1).map(move |x| (x, y)));
        rows.filter_map(|(x, y)| self.alpha(x, y)).collect()
    }

    /// The mean alpha of a pixel, 0 without samples; `None` if the film has no alpha.
    pub(crate) fn alpha(&self, x: u32, y: u32) -> Option<f32> {
        let mean = match (self.samples(x, y), self.sums_of(&self.alphas, x, y)) {
            (0, _) | (_, None) => 0.0,
            (samples, Some(sum)) => (sum as f64 / (samples as f64 * TWO_TO_64)) as f32,
        };
        (!self.alphas.is_empty()).then_some(mean)
    }

    /// The sums of a pixel; `None` outside of [`Film::area`].
    fn pixel(&self, x: u32, y: u32) -> Option<Pixel> {
        self.sums_of(&self.pixels, x, y)
    }

    /// Sums of a kind of a pixel; `None` where there are none, and outside of [`Film::area`].
    fn sums_of<T: Sums>(&self, plane: &Plane<T>, x: u32, y: u32) -> Option<T> {
        let PixelBounds { x0, y0, x1, y1 } = self.area;
        let is_inside = (x0..x1).contains(&x) && (y0..y1).contains(&y);
        if is_inside { plane.get(x, y) } else { None }
    }
}

/// Light, premultiplied by alpha, over a background.
pub(crate) fn composited(light: [f32; 3], alpha: f32, background: [f32; 3]) -> [f32; 3] {
    let share = 1.0 - alpha.clamp(0.0, 1.0);
    std::array::from_fn(|c| light[c] + share * background[c])
}

/// The pixels of a film for these settings.
fn area_of(image: &ImageSettings) -> PixelBounds {
    let whole = PixelBounds { x0: 0, y0: 0, x1: image.width, y1: image.height };
    common(whole, image.crop.unwrap_or(whole))
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

fn invalid(message: String) -> Error {
    Error::invalid(&Location::default(), message)
        .hint("merge only renders of the same scene, of the same size and with the same layers")
}

fn twice(Overlap { pixel: [x, y], samples }: &Overlap) -> Error {
    let Range { start, end } = samples;
    Error::invalid(
        &Location::default(),
        format!("samples {start}..{end} of pixel {x} {y} would be there twice"),
    )
    .hint("merge every part once")
}

fn too_large(message: String) -> Error {
    Error::new(ErrorKind::Limit, &Location::default(), message)
        .hint("make the picture smaller, or render it in several crops, which `lookfrom merge` adds up")
}

#[cfg(test)]
mod tests;
