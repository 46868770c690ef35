//! `[image]` and `[render]`: settings of the image and of the integrator.

use super::Reader;
use super::color::plain_color;
use super::table::Table;
use super::value::Value;
use crate::error::{Error, ErrorKind, Result};
use crate::scene::VertexNormals;
use crate::settings::{
    Allocation, Background, Band, ColorMode, CryptomatteKind, Filter, FilterShape, ImageSettings, Integrator,
    Layers, LightPathLayer, LightSampler, MOST_PIXELS, PixelBounds, Portals, RenderSettings, Sampler, Sensor,
    SpectralFilm, Tonemap,
};
use crate::spectrum::CameraSensor;

/// The keys of `[image]`.
pub(super) const IMAGE: &[&str] = &[
    "width",
    "height",
    "exposure",
    "tonemap",
    "crop",
    "filter",
    "sensor",
    "imaging_ratio",
    "white_balance",
    "max_component",
    "layers",
    "light_paths",
    "cryptomatte",
    "spectral_buckets",
    "wavelengths",
    "bands",
    "background",
    "denoise",
];
/// The keys of `filter` as a table.
pub(super) const FILTER: &[&str] = &["type", "radius", "sigma", "b", "c", "tau"];
/// The keys of `[render]`.
pub(super) const RENDER: &[&str] = &[
    "integrator",
    "samples",
    "allocation",
    "depth",
    "min_contribution",
    "sampler",
    "seed",
    "transparent_shadows",
    "color",
    "light_sampler",
    "portals",
    "regularize",
    "occlusion_distance",
    "thin_passages_count",
    "occlusion_directions",
    "open_fronts",
    "hide_lights",
    "media",
    "endless_media",
    "vertex_normals",
    "add_light",
];
/// The words for the background, besides colours.
pub(super) const BACKGROUNDS: &[(&str, Background)] =
    &[("environment", Background::Environment), ("transparent", Background::Transparent)];
/// The words for the directions of ambient occlusion, and whether they are weighted by their cosine.
pub(super) const OCCLUSION_DIRECTIONS: &[(&str, bool)] = &[("cosine", true), ("uniform", false)];
/// The words for the use of vertex normals.
pub(super) const VERTEX_NORMALS: &[(&str, VertexNormals)] =
    &[("smooth", VertexNormals::Smooth), ("as_given", VertexNormals::AsGiven)];

/// Resolution, filter, sensor and tone mapping, but for the bands of a spectral film.
pub(super) fn image(table: &Table<'_>) -> ImageSettings {
    table.allow(&[IMAGE]);
    let default = ImageSettings::default();
    let side = |key, default: u32| table.or(key, default.into(), |value| value.integer(1, u32::MAX.into()));
    let (width, height) = (side("width", default.width), side("height", default.height));
    let is_sized = table.sound(&["width", "height"]).is_ok();
    if is_sized && width * height > MOST_PIXELS {
        let mut error =
            table.error(format!("{width}×{height} pixels are more than the limit of {MOST_PIXELS}"));
        error.kind = ErrorKind::Limit;
        table.note(error.hint("make the picture smaller"));
    }
    let (width, height) = (width as u32, height as u32);
    ImageSettings {
        width,
        height,
        crop: table.or("crop", None, |value| crop(value, is_sized.then_some([width, height])).map(Some)),
        filter: table.or("filter", default.filter, filter),
        exposure: table.or("exposure", default.exposure, |value| {
            value.single_where("stops from -64 to 64", |stops| (-64.0..=64.0).contains(&stops))
        }),
        tonemap: table.or("tonemap", default.tonemap, |value| value.choice(Tonemap::WORDS)),
        sensor: Sensor {
            camera: table.or("sensor", None, camera),
            imaging_ratio: table.or("imaging_ratio", default.sensor.imaging_ratio, above_zero),
            white_balance: table.or("white_balance", None, |value| kelvin(value).map(Some)),
            max_component: table.or("max_component", default.sensor.max_component, above_zero),
        },
        layers: table.or("layers", default.layers, layers),
        light_paths: table.or("light_paths", Vec::new(), light_paths),
        cryptomattes: table.or("cryptomatte", Vec::new(), cryptomattes),
        spectral_film: spectral_film(table),
        background: table.or("background", default.background, background),
        denoise: table.or("denoise", default.denoise, Value::boolean),
    }
}

/// A word, or a colour.
fn background(value: Value<'_>) -> Result<Background> {
    let word = BACKGROUNDS.iter().find(|(word, _)| value.as_text() == Some(word));
    word.map_or_else(|| plain_color(value).map(Background::Color), |(_, background)| Ok(*background))
}

/// AOVs by a word; `true` is for those of the geometry.
fn layers(value: Value<'_>) -> Result<Layers> {
    match value.boolean() {
        Ok(true) => Ok(Layers::Geometry),
        Ok(false) => Ok(Layers::None),
        Err(_) => value.choice(Layers::WORDS),
    }
}

/// Kinds of Cryptomattes by their words, or the word for one.
fn cryptomattes(value: Value<'_>) -> Result<Vec<CryptomatteKind>> {
    let kind = |value: Value<'_>| value.choice(CryptomatteKind::WORDS);
    if value.as_text().is_some() {
        return Ok(vec![kind(value)?]);
    }
    let kinds = value.list("\"object\", \"material\" or a list of both")?.map(kind);
    Ok(CryptomatteKind::distinct(kinds.collect::<Result<Vec<_>>>()?))
}

/// The spectral film, if there are buckets or a range of wavelengths.
fn spectral_film(table: &Table<'_>) -> Option<SpectralFilm> {
    let most = SpectralFilm::MOST_BUCKETS.into();
    let buckets = table.or("spectral_buckets", None, |value| value.integer(1, most).map(Some));
    let range = table.or("wavelengths", None, |value| wavelengths(value).map(Some));
    (buckets.is_some() || range.is_some()).then(|| SpectralFilm {
        buckets: buckets.unwrap_or(0) as u32,
        range: range.unwrap_or(SpectralFilm::ALL),
        bands: Vec::new(),
    })
}

fn wavelengths(value: Value<'_>) -> Result<[f32; 2]> {
    let range = value.singles(SpectralFilm::RANGE)?;
    match SpectralFilm::is_range(range) {
        true => Ok(range),
        false => Err(value.error(format!("`wavelengths` is {range:?}; expected {}", SpectralFilm::RANGE))),
    }
}

impl Reader<'_, '_> {
    /// A spectral film with bands: a name and a spectrum each.
    pub(super) fn with_bands(&mut self, mut film: SpectralFilm, value: Value<'_>) -> Result<SpectralFilm> {
        let table = value.table("bands: a name and a colour by wavelength each")?;
        for entry in table.entries() {
            let response = self.curve(entry, &[])?;
            let response = self.scene.curves[response.index()].clone();
            let band = Band { name: entry.key().to_owned(), response };
            film.add(band).map_err(|message| entry.error(message))?;
        }
        Ok(film)
    }
}

/// Names of layers, each with its light-path expression.
fn light_paths(value: Value<'_>) -> Result<Vec<LightPathLayer>> {
    let layers = value.table("light_paths")?;
    let layer = |value: Value<'_>| {
        let expression = value.text("a light-path expression such as \"C<RD>L\"")?.to_owned();
        Ok(LightPathLayer { name: value.key().to_owned(), expression, at: value.at() })
    };
    layers.entries().map(layer).collect()
}

/// A camera's sensor; `None` for the standard observer.
fn camera(value: Value<'_>) -> Result<Option<CameraSensor>> {
    let cameras = CameraSensor::all().map(|sensor| (sensor.name(), Some(sensor)));
    value.choice(&std::iter::once((Sensor::OBSERVER, None)).chain(cameras).collect::<Vec<_>>())
}

fn above_zero(value: Value<'_>) -> Result<f32> {
    value.single_where("a number greater than 0", |number| number > 0.0)
}

/// A colour temperature in the supported range.
pub(super) fn kelvin(value: Value<'_>) -> Result<f32> {
    value.single_where("kelvin from 500 to 100000", |kelvin| (500.0..=100_000.0).contains(&kelvin))
}

/// A crop window; the image's size is not known if it is invalid.
fn crop(value: Value<'_>, size: Option<[u32; 2]>) -> Result<PixelBounds> {
    let expected = "four whole numbers, [x0, y0, x1, y1]";
    let mut edges = [0; 4];
    for (edge, item) in edges.iter_mut().zip(value.list_of::<4>(expected)?) {
        *edge = item.integer(0, u32::MAX.into())? as u32;
    }
    let [x0, y0, x1, y1] = edges;
    let Some([width, height]) = size else { return Ok(PixelBounds { x0, y0, x1, y1 }) };
    if x0 < x1 && x1 <= width && y0 < y1 && y1 <= height {
        return Ok(PixelBounds { x0, y0, x1, y1 });
    }
    Err(value
        .error(format!(
            "the crop from ({x0}, {y0}) to ({x1}, {y1}) is not a part of a picture of {width}×{height}"
        ))
        .hint("x0 < x1 and y0 < y1 count pixels from the top left"))
}

fn filter(value: Value<'_>) -> Result<Filter> {
    if !value.is_table() {
        return value.choice(Filter::WORDS);
    }
    let table = value.table("`filter`")?;
    table.allow(&[FILTER]);
    let chosen = table.need("type", "\"gaussian\"", None, |value| value.choice(Filter::WORDS).map(Some));
    let Some(Filter { mut shape, radius }) = chosen else { return Err(Error::untold()) };
    let parameters: Vec<&str> = shape.parameters().into_iter().map(|(name, _)| name).collect();
    table.allow(&[&["type", "radius"], &parameters]);
    let radius = table.or("radius", radius, |value| {
        if value.is_number() {
            return pixels(value).map(|both| [both; 2]);
        }
        let [x, y] = value.list_of("a radius in pixels, or [x, y]")?;
        Ok([pixels(x)?, pixels(y)?])
    });
    let share = |value: Value<'_>| value.single_where("a number from 0 to 1", |s| (0.0..=1.0).contains(&s));
    match &mut shape {
        FilterShape::Box | FilterShape::Triangle | FilterShape::BlackmanHarris => {}
        FilterShape::Gaussian { sigma } => *sigma = table.or("sigma", *sigma, pixels),
        FilterShape::Mitchell { b, c } => {
            *b = table.or("b", *b, share);
            *c = table.or("c", *c, share);
        }
        FilterShape::Sinc { tau } => *tau = table.or("tau", *tau, pixels),
    }
    Ok(Filter { shape, radius })
}

/// A length of a filter.
fn pixels(value: Value<'_>) -> Result<f32> {
    value.single_where("pixels, more than 0 and at most 16", |r| r > 0.0 && r <= Filter::WIDEST)
}

/// The integrator and its settings.
pub(super) fn render(table: &Table<'_>) -> RenderSettings {
    table.allow(&[RENDER]);
    let default = RenderSettings::default();
    let mut integrator = table.or("integrator", default.integrator, |value| value.choice(Integrator::WORDS));
    if let Integrator::AmbientOcclusion { cosine } = &mut integrator {
        *cosine = table.or("occlusion_directions", *cosine, |value| value.choice(OCCLUSION_DIRECTIONS));
    }
    RenderSettings {
        integrator,
        samples: table.or("samples", default.samples.into(), |value| value.integer(1, 1 << 24)) as u32,
        allocation: table.or("allocation", default.allocation, |value| value.choice(Allocation::WORDS)),
        depth: table.or("depth", default.depth.into(), |value| value.integer(0, i32::MAX as u64)) as u32,
        min_contribution: table.or("min_contribution", default.min_contribution, |value| {
            value.single_where("a number from 0 to 1", |share| (0.0..=1.0).contains(&share))
        }),
        sampler: table.or("sampler", default.sampler, |value| value.choice(Sampler::WORDS)),
        seed: table.or("seed", default.seed, |value| value.integer(0, u64::MAX)),
        transparent_shadows: table.or("transparent_shadows", default.transparent_shadows, Value::boolean),
        color: table.or("color", default.color, |value| value.choice(ColorMode::WORDS)),
        light_sampler: table
            .or("light_sampler", default.light_sampler, |value| value.choice(LightSampler::WORDS)),
        portals: table.or("portals", default.portals, |value| value.choice(Portals::WORDS)),
        regularize: table.or("regularize", default.regularize, Value::boolean),
        occlusion_distance: table.or("occlusion_distance", default.occlusion_distance, above_zero),
        thin_passages_count: table.or("thin_passages_count", default.thin_passages_count, Value::boolean),
        media: table.or("media", default.media, Value::boolean),
        endless_media: table.or("endless_media", default.endless_media, Value::boolean),
        open_fronts: table.or("open_fronts", default.open_fronts, Value::boolean),
        hide_lights: table.or("hide_lights", default.hide_lights, Value::boolean),
    }
}
