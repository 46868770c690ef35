//! The inspection of a pixel: each of its samples, the brightest first, and what the picture makes of them.

use std::ops::Range;

use lookfrom_scene::settings::{Background, ImageSettings, PixelBounds};
use lookfrom_scene::{Error, ErrorKind, Location, Result};
use serde::Serialize;

use super::expression::{self, Contribution, LARGEST, brightness};
use super::{Inspection, inspect_in_short};
use crate::core::math::luminance;
use crate::film::{Film, FilmTile, Picture};
use crate::post::develop::{srgb8_before, srgba8};
use crate::render::{Renderer, SampleId};

/// The film of one pixel.
const ONE: PixelBounds = PixelBounds { x0: 0, y0: 0, x1: 1, y1: 1 };

/// The samples of a pixel, and what the picture makes of them.
#[derive(Clone, Debug, Serialize)]
pub struct PixelInspection {
    /// Column and row from the top left.
    pub pixel: [u32; 2],
    /// The number of samples.
    pub samples: u32,
    /// Number of the first of them.
    pub first_sample: u32,
    /// Number of samples that are not finite, which the film leaves out.
    pub dropped: u32,
    /// The mean of the others, bit for bit that of a film with these samples: linear Rec. 709.
    pub mean: [f32; 3],
    /// The unbiased estimate of the variance of one sample, per channel; `None` for fewer than two.
    pub variance: Option<[f64; 3]>,
    /// The standard error of the mean of independent samples (that of stratified ones is less): √(variance / samples).
    pub standard_error: Option<[f64; 3]>,
    /// The mean as in an 8-bit picture, without denoising and treatment of fireflies: exposure, tone map, sRGB.
    pub color8: [u8; 3],
    /// The largest contributions of all samples, largest first.
    pub contributions: Vec<Contribution>,
    /// Every sample: the brightest first, and before it those that are not finite.
    pub all: Vec<SampleSummary>,
}

/// One sample of a pixel in short.
#[derive(Clone, Debug, Serialize)]
pub struct SampleSummary {
    /// Number of the sample in its pixel.
    pub sample: u32,
    /// The value that the film received.
    pub film: [f32; 3],
    /// Its luminance.
    pub luminance: f32,
    /// Number of reflections, refractions and bounces before the hit that made the largest contribution; of a sample
    /// without light, of its longest way.
    pub depth: u32,
    /// The light of the largest contribution; `None` for a sample without light.
    pub light: Option<String>,
    /// The largest contribution as an expression ([`Contribution::expression`]).
    pub expression: String,
}

/// Traces samples of a pixel and reports what they contribute, largest first.
///
/// # Errors
/// `Request` for a pixel outside of the picture, and for a range without samples.
pub fn inspect_pixel(renderer: &Renderer, pixel: [u32; 2], samples: Range<u32>) -> Result<PixelInspection> {
    let image = &renderer.view().image;
    let request = |message: String| Err(Error::new(ErrorKind::Request, &Location::default(), message));
    let [x, y] = pixel;
    if x >= image.width || y >= image.height {
        let (width, height) = (image.width, image.height);
        return request(format!(
            "pixel {x} {y} is outside of the picture of {width} × {height} pixels, which are counted from 0"
        ));
    }
    if samples.is_empty() {
        let Range { start, end } = samples;
        return request(format!("no samples in {start}..{end}; the end of a range is above its start"));
    }

    let mut tile = FilmTile::for_image(ONE, &image.of_light(1, 1))?;
    let mut all = Vec::new();
    let mut contributions: Vec<Contribution> = Vec::new();
    for sample in samples.clone() {
        let inspection = inspect_in_short(renderer, SampleId { pixel, sample });
        add(&mut tile, &inspection);
        all.push(SampleSummary::new(&inspection));
        contributions.extend(inspection.contributions);
        contributions.sort_by(|a, b| brightness(b.value).total_cmp(&brightness(a.value)));
        contributions.truncate(LARGEST);
    }
    all.sort_by(|a, b| brightness(b.film).total_cmp(&brightness(a.film)));

    let finite: Vec<[f64; 3]> = all
        .iter()
        .filter(|sample| sample.film.iter().all(|c| c.is_finite()))
        .map(|sample| sample.film.map(f64::from))
        .collect();
    let variance = variance(&finite);
    let (mean, color8) = developed(&tile, image)?;
    Ok(PixelInspection {
        pixel,
        samples: samples.len() as u32,
        first_sample: samples.start,
        dropped: (all.len() - finite.len()) as u32,
        mean,
        variance,
        standard_error: variance
            .map(|variance| variance.map(|channel| (channel / finite.len() as f64).sqrt())),
        color8,
        contributions,
        all,
    })
}

/// The unbiased variance of one of at least two samples, in two passes, per channel.
fn variance(samples: &[[f64; 3]]) -> Option<[f64; 3]> {
    let n = samples.len() as f64;
    (samples.len() > 1).then(|| {
        std::array::from_fn(|channel| {
            let values = || samples.iter().map(|sample| sample[channel]);
            let mean = values().sum::<f64>() / n;
            values().map(|value| (value - mean) * (value - mean)).sum::<f64>() / (n - 1.0)
        })
    })
}

impl SampleSummary {
    fn new(inspection: &Inspection) -> Self {
        let &Inspection { sample, film, .. } = inspection;
        let luminance = luminance(film);
        match inspection.contributions.first() {
            Some(Contribution { depth, light, expression, .. }) => Self {
                sample,
                film,
                luminance,
                depth: *depth,
                light: Some(light.clone()),
                expression: expression.clone(),
            },
            None => Self {
                sample,
                film,
                luminance,
                depth: inspection.rays.iter().map(|ray| ray.depth).max().unwrap_or(0),
                light: None,
                expression: expression::dark(inspection),
            },
        }
    }
}

/// Adds a sample to the film of one pixel.
fn add(tile: &mut FilmTile, inspection: &Inspection) {
    let &Inspection { sample, film, alpha, filter_weight, .. } = inspection;
    tile.add_weighted(0, 0, sample, film, alpha, filter_weight);
}

/// The picture of one pixel, and its bytes.
fn developed(tile: &FilmTile, image: &ImageSettings) -> Result<([f32; 3], [u8; 3])> {
    let mut film = Film::for_image(&image.of_light(1, 1))?;
    film.add_tile(tile)?;
    Ok((film.mean(0, 0), bytes(&film.picture(), image)))
}

/// The bytes of a picture of one pixel.
fn bytes(picture: &Picture, image: &ImageSettings) -> [u8; 3] {
    let &ImageSettings { exposure, tonemap, background, .. } = image;
    let bytes = match background {
        Background::Transparent => srgba8(picture, exposure, tonemap),
        Background::Color(color) => srgb8_before(picture, color, exposure, tonemap),
        Background::Environment => srgb8_before(picture, [0.0; 3], exposure, tonemap),
    };
    [bytes[0], bytes[1], bytes[2]]
}

/// The colour of a sample alone as in an 8-bit picture.
pub(super) fn color8(image: &ImageSettings, inspection: &Inspection) -> [u8; 3] {
    let &Inspection { film, alpha, filter_weight, .. } = inspection;
    let alpha =
        if image.background == Background::Environment { Vec::new() } else { vec![alpha * filter_weight] };
    bytes(&Picture { width: 1, height: 1, pixels: vec![film], alpha }, image)
}
