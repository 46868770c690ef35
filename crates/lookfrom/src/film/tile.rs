//! Tiles of a film, each filled by one thread.

use std::ops::Range;

use lookfrom_scene::settings::{Background, ImageSettings, Layers, PixelBounds};
use lookfrom_scene::{Error, Location, Result};

use super::aov::{AovSums, LayerSums};
use super::channels::ChannelSums;
use super::ledger::{Overlap, SampleLedger};
use super::light_paths::LightPathSums;
use super::pixel::{Pixel, fixed_point, fixed_point_square};
use super::{Aovs, BRIGHTEST, FEATURE_SAMPLES, MOST_PIXELS, SampleId, common, too_large, xyz};

/// The light of a rectangle of a film, for one thread to fill.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FilmTile {
    pub(super) area: PixelBounds,
    pub(super) pixels: Vec<Pixel>,
    /// One per pixel, or none.
    pub(super) layers: Vec<LayerSums>,
    /// One per pixel, or none.
    pub(super) channels: Vec<ChannelSums>,
    /// One per pixel, or none.
    pub(super) features: Vec<AovSums>,
    /// For each layer of light-path expressions, one per pixel.
    pub(super) light_paths: Vec<Vec<LightPathSums>>,
    /// Sums of alpha, in multiples of 2⁻⁶⁴: one per pixel, or none.
    pub(super) alphas: Vec<i128>,
    /// Sums of their squares, in multiples of 2⁻⁴⁸: one per pixel, or none.
    pub(super) alpha_squares: Vec<u128>,
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
        Self::with_layers(area, Layers::None)
    }

    /// As [`FilmTile::new`], with memory for AOVs.
    pub fn with_layers(area: PixelBounds, layers: Layers) -> Result<Self> {
        Self::for_image(area, &ImageSettings { layers, ..ImageSettings::default() })
    }

    /// As [`FilmTile::new`], with memory for everything that the settings need: AOVs, alpha.
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
        let light_paths = image.light_paths.iter().map(|_| empty(count)).collect::<Result<_>>()?;
        let (dropped, first_dropped, ledger) = (0, None, SampleLedger::default());
        Ok(Self {
            area,
            pixels,
            layers,
            channels,
            features,
            light_paths,
            alphas,
            alpha_squares,
            dropped,
            first_dropped,
            ledger,
        })
    }

    /// An empty tile of other pixels, with sums of the same kinds.
    pub(super) fn empty_like(&self, area: PixelBounds) -> Result<Self> {
        let Self {
            area: _, pixels: _, layers, channels, features, light_paths, alphas, alpha_squares, ..
        } = self;
        let plain = Self::new(area)?;
        let count = plain.pixels.len() as u64;
        let of = |is_empty: bool| if is_empty { 0 } else { count };
        Ok(Self {
            layers: empty(of(layers.is_empty()))?,
            channels: empty(of(channels.is_empty()))?,
            features: empty(of(features.is_empty()))?,
            light_paths: light_paths.iter().map(|_| empty(count)).collect::<Result<_>>()?,
            alphas: empty(of(alphas.is_empty()))?,
            alpha_squares: empty(of(alpha_squares.is_empty()))?,
            ..plain
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

    /// Adds the light of one sample to the layers of light-path expressions, in their order, unless the sample is dropped:
    /// unless its whole light, `rgb`, is not finite.
    ///
    /// # Panics
    /// If the pixel is outside of the tile.
    pub fn add_light_paths(&mut self, x: u32, y: u32, rgb: [f32; 3], layers: impl Iterator<Item = [f32; 3]>) {
        let index = self.index_inside(x, y);
        if rgb.iter().all(|light| light.is_finite()) {
            self.light_paths.iter_mut().zip(layers).for_each(|(layer, light)| layer[index].add(light));
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
        self.add_with_alpha(x, y, sample, rgb, 1.0);
    }

    /// As [`FilmTile::add`], and adds the sample's alpha, if the tile has alpha: a sample whose alpha is not finite is
    /// dropped as well.
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

    /// Adds the first hit of one sample, `None` for a miss, where there is memory for it: to the AOVs, and for the
    /// first [`FEATURE_SAMPLES`] of a pixel to the denoiser features. A hit that is not finite counts as a miss.
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

    /// Adds the sensor's channels of one sample, where there is memory for them and all are finite.
    ///
    /// # Panics
    /// If the pixel is outside of the tile.
    pub fn add_channels(&mut self, x: u32, y: u32, channels: [f32; 3]) {
        let index = self.index_inside(x, y);
        if let Some(sums) = self.channels.get_mut(index) {
            sums.add(channels);
        }
    }

    /// Records that the tile has these samples of all its pixels, those that were dropped included. Films of recorded
    /// tiles know what they hold; [`Renderer::render_tile`](crate::render::Renderer::render_tile) records what it adds.
    ///
    /// # Errors
    /// `Invalid` where it has one of them already.
    pub fn record(&mut self, samples: Range<u32>) -> Result<()> {
        self.record_part(self.area, samples)
    }

    /// The same for the pixels of a part.
    ///
    /// # Errors
    /// As [`FilmTile::record`].
    pub(crate) fn record_part(&mut self, part: PixelBounds, samples: Range<u32>) -> Result<()> {
        self.ledger.add(part, samples).map_err(|overlap| twice(&overlap))
    }

    /// Adds the sums of another tile, whose pixels are all within this one.
    ///
    /// # Errors
    /// `Invalid` for other pixels, other kinds of sums, or samples that both have; then nothing has changed.
    pub(super) fn merge(&mut self, other: &Self) -> Result<()> {
        let PixelBounds { x0, y0, x1, y1 } = other.area;
        if x0 < x1 && y0 < y1 && common(self.area, other.area) != other.area {
            let mine = self.area;
            return Err(invalid(format!(
                "pixels {x0},{y0},{x1},{y1} cannot be added to a film of the pixels {},{},{},{}",
                mine.x0, mine.y0, mine.x1, mine.y1
            )));
        }
        if x0 < x1 && y0 < y1 && !self.pixels.is_empty() && self.kinds() != other.kinds() {
            return Err(invalid(format!(
                "a film of {} cannot be added to one of {}",
                other.kinds(),
                self.kinds()
            )));
        }
        self.ledger.merge(&other.ledger).map_err(|overlap| twice(&overlap))?;
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
            for (mine, theirs) in self.light_paths.iter_mut().zip(&other.light_paths) {
                merge_row(mine, theirs, &rows, LightPathSums::merge);
            }
        }
        self.drop_samples(other.dropped, other.first_dropped);
        Ok(())
    }

    /// The kinds of sums, for messages.
    fn kinds(&self) -> String {
        let kinds = [
            ("alpha", !self.alphas.is_empty()),
            ("AOVs", !self.layers.is_empty()),
            ("variances in the sensor's channels", !self.channels.is_empty()),
            ("denoiser features", !self.features.is_empty()),
        ];
        let kinds = kinds.iter().filter(|(_, has)| *has).map(|(kind, _)| format!(" and {kind}"));
        let light_paths = match self.light_paths.len() {
            0 => None,
            1 => Some(" and 1 layer of light paths".to_owned()),
            count => Some(format!(" and {count} layers of light paths")),
        };
        std::iter::once("light".to_owned()).chain(kinds).chain(light_paths).collect()
    }

    pub(super) fn drop_samples(&mut self, count: u64, first: Option<SampleId>) {
        self.dropped = self.dropped.saturating_add(count);
        self.first_dropped = self.first_dropped.into_iter().chain(first).min();
    }

    pub(super) fn pixel(&self, x: u32, y: u32) -> Option<&Pixel> {
        self.index(x, y).map(|index| &self.pixels[index])
    }

    pub(super) fn index(&self, x: u32, y: u32) -> Option<usize> {
        let PixelBounds { x0, y0, x1, y1 } = self.area;
        let inside = (x0..x1).contains(&x) && (y0..y1).contains(&y);
        inside.then(|| (y - y0) as usize * (x1 - x0) as usize + (x - x0) as usize)
    }

    pub(super) fn index_inside(&self, x: u32, y: u32) -> usize {
        let index = self.index(x, y);
        index.unwrap_or_else(|| panic!("pixel ({x}, {y}) is outside of the tile {:?}", self.area))
    }

    /// The indices of the pixels of columns `from` to `to` (exclusive) of row `y`. They must be inside.
    pub(super) fn row(&self, y: u32, from: u32, to: u32) -> Range<usize> {
        let PixelBounds { x0, y0, x1, .. } = self.area;
        let start = (y - y0) as usize * (x1 - x0) as usize;
        start + (from - x0) as usize..start + (to - x0) as usize
    }
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

/// Adds a range of `theirs` to one of `mine`, where there are such sums.
fn merge_row<T>(mine: &mut [T], theirs: &[T], [to, from]: &[Range<usize>; 2], add: impl Fn(&mut T, &T)) {
    if let (Some(mine), Some(theirs)) = (mine.get_mut(to.clone()), theirs.get(from.clone())) {
        mine.iter_mut().zip(theirs).for_each(|(mine, theirs)| add(mine, theirs));
    }
}

/// `count` zeros; an error if there is no memory for them.
fn empty<T: Clone + Default>(count: u64) -> Result<Vec<T>> {
    let mut values = Vec::new();
    if values.try_reserve_exact(count as usize).is_err() {
        return Err(too_large(format!("no memory for {count} pixels of {} bytes", size_of::<T>())));
    }
    values.resize(count as usize, T::default());
    Ok(values)
}
