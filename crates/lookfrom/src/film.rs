//! The film: sums of samples per pixel in fixed point, independent of their order.
//!
//! Sums of floating-point numbers depend on their order, sums of integers do not. So each pixel holds three fixed-point
//! sums of 128 bits, 64 of them behind the binary point, and as many of squares, for the variance; any division of the
//! work among threads, tiles, passes or machines ends in the same bytes *by construction*. AOVs, for layers and
//! denoiser, are in [`crate::aov`]; what the sums tell of a pixel, in `means` and `weighted`; noise estimates in `noise`; firefly suppression in
//! `fireflies`; blocks to which threads add, in `detached`; which sums it has, in `layout`, which samples, in `ledger`; its numbers as
//! channels of a file, in `stored`. Conversion for display is in [`crate::post::develop`].
//!
//! In a tile, which a thread fills, a pixel takes 112 bytes, as many for variances in the sensor's channels, and those of AOVs, where they are
//! enabled. The film keeps them packed, in `plane` and `packed`: in about half of that.

pub mod allocation;
mod buckets;
mod detached;
mod fireflies;
mod first_hits;
mod layout;
mod ledger;
mod light_paths;
mod means;
mod motion;
mod noise;
mod packed;
mod picture;
mod pixel;
mod plane;
mod stored;
mod sums;
mod tile;
mod weighted;

use self::buckets::BucketSums;
pub use self::fireflies::Firefly;
pub(crate) use self::layout::Layout;
pub use self::ledger::{Overlap, SampleLedger};
use self::light_paths::LightPathSums;
use self::motion::MotionSums;
pub use self::picture::Picture;
pub(crate) use self::picture::composited;
use self::pixel::Pixel;
use self::plane::Plane;
pub(crate) use self::stored::StoredRows;
use self::stored::{Sums, for_each_plane};
pub(crate) use self::sums::SampleSums;
pub use self::tile::FilmTile;
use self::weighted::WeightSums;

use std::ops::Range;

use lookfrom_scene::settings::{ImageSettings, PixelBounds};
use lookfrom_scene::spectrum::space::xyz_of_rec709 as xyz;
use lookfrom_scene::{Error, ErrorKind, Location, Result};

use crate::aov::{AovSums, LayerSums, PixelMatte};
pub use crate::aov::{Aovs, DenoiserFeatures, FEATURE_SAMPLES};
pub use crate::core::fixed_point::BRIGHTEST;
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
    /// Of filter weights, where these differ.
    weights: Plane<WeightSums>,
    /// As alphas, light and buckets, with the magnitudes of the weights: of all light, then for each layer of light-path expressions.
    unsigned_alphas: Plane<i128>,
    unsigned_light: Vec<Plane<LightPathSums>>,
    unsigned_buckets: Vec<Plane<i128>>,
    dropped: u64,
    first_dropped: Option<SampleId>,
    ledger: SampleLedger,
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
            weights: plane(layout.weights, size)?,
            unsigned_alphas: plane(layout.unsigned_alphas(), size)?,
            unsigned_light: (0..layout.unsigned_light()).map(|_| plane(true, size)).collect::<Result<_>>()?,
            unsigned_buckets: (0..layout.unsigned_buckets())
                .map(|_| plane(true, size))
                .collect::<Result<_>>()?,
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
        let pixels = u64::from(image.width) * u64::from(image.height);
        let mattes = image.cryptomattes.len() as u64 * PixelMatte::BYTES;
        let layout = Layout::of_image(image).memory([image.width, image.height], area_of(image));
        layout.saturating_add(pixels.saturating_mul(mattes))
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
        let mut detached = self.detach(tile)?;
        detached.add(tile);
        self.attach(detached);
        Ok(())
    }

    /// Whether sums of an area can be added.
    fn check_same(&self, area: PixelBounds, layout: Layout) -> Result<()> {
        if area.is_empty() {
            return Ok(());
        }
        if self.area.intersection(area) != area {
            let PixelBounds { x0, y0, x1, y1 } = area;
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

    /// The ledger of the samples that it holds, pixel by pixel.
    pub fn ledger(&self) -> &SampleLedger {
        &self.ledger
    }

    pub(crate) fn set_dropped(&mut self, count: u64, first: Option<SampleId>) {
        (self.dropped, self.first_dropped) = (count, first);
    }

    /// Makes an area, which contains its own and is within the picture, that of the film.
    pub fn enlarge(&mut self, area: PixelBounds) {
        let whole = PixelBounds::of_size(self.width, self.height);
        self.area = self.area.union(area.intersection(whole));
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

    /// Whether the film has motion vectors.
    pub fn has_motion(&self) -> bool {
        !self.motions.is_empty()
    }

    /// Whether the film has AOVs.
    pub fn has_layers(&self) -> bool {
        !self.layers.is_empty()
    }

    /// Number of samples that were dropped because they were not finite.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }

    /// The least id of a dropped sample, which replays it: the same whatever the order of the work.
    pub fn first_dropped(&self) -> Option<SampleId> {
        self.first_dropped
    }
}

/// The pixels of a film for these settings.
pub(crate) fn area_of(image: &ImageSettings) -> PixelBounds {
    let whole = PixelBounds::of_size(image.width, image.height);
    whole.intersection(image.crop.unwrap_or(whole))
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
