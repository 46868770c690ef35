//! From a film to the pictures of a window: light, or a layer in false colours, or a comparison.

use std::io::Cursor;

use lookfrom::film::Film;
use lookfrom::session::{Development, Format, Session};
use lookfrom_scene::Result;
use lookfrom_scene::image::{Pixels, encode_png_to_show, without_alpha};

use crate::compare;
use crate::cost::Counted;
use crate::document::Loaded;
use crate::heat::{byte, heat};
use crate::message::ViewRequest;
use crate::view::{named, refused};

/// A film and how it shall look.
pub(crate) struct Shown<'a> {
    pub(crate) session: &'a Session,
    pub(crate) film: &'a Film,
    /// Whether it is a smaller picture, which is not denoised.
    pub(crate) is_coarse: bool,
    pub(crate) loaded: &'a Loaded,
    pub(crate) request: &'a ViewRequest,
}

/// A layer of a film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Layer {
    Color,
    Albedo,
    Normal,
    ShadingNormal,
    Position,
    Depth,
    Uv,
    Error,
    Samples,
    /// Not of the film.
    Cost(Counted),
}

impl Layer {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("color", Self::Color),
        ("albedo", Self::Albedo),
        ("normal", Self::Normal),
        ("shadingNormal", Self::ShadingNormal),
        ("position", Self::Position),
        ("depth", Self::Depth),
        ("uv", Self::Uv),
        ("error", Self::Error),
        ("samples", Self::Samples),
        ("bounces", Self::Cost(Counted::Rays)),
        ("nodes", Self::Cost(Counted::Nodes)),
        ("tests", Self::Cost(Counted::Candidates)),
    ];

    fn title(self) -> &'static str {
        match self {
            Self::Color => "Light",
            Self::Albedo => "Albedo",
            Self::Normal => "Geometric normal",
            Self::ShadingNormal => "Shading normal",
            Self::Position => "Position",
            Self::Depth => "Depth",
            Self::Uv => "Texture coordinates",
            Self::Error => "Relative standard error, 0.1 % to 100 %",
            Self::Samples => "Samples",
            Self::Cost(Counted::Rays) => "Rays of the first sample",
            Self::Cost(Counted::Nodes) => "BVH nodes visited by the camera ray",
            Self::Cost(Counted::Candidates) => "Primitives tested by the camera ray",
        }
    }
}

/// Names and titles of all layers.
pub(crate) fn layers() -> impl Iterator<Item = (&'static str, &'static str)> {
    Layer::WORDS.iter().map(|&(word, layer)| (word, layer.title()))
}

/// Whether a request can be developed.
///
/// # Errors
/// `Request` for unknown words, numbers out of range, and a comparison without a reference.
pub(crate) fn check(request: &ViewRequest, loaded: &Loaded) -> Result<()> {
    layer_of(request)?;
    request.tonemap(loaded.session.image().tonemap)?;
    if !(-64.0..=64.0).contains(&request.exposure) {
        return Err(refused(format!("exposure is {}; expected -64 to 64 stops", request.exposure)));
    }
    if request.compare.is_none() {
        return Ok(());
    }
    let Some(reference) = &loaded.reference else {
        return Err(refused("there is no reference to compare with: start with --reference FILE"));
    };
    let image = loaded.session.image();
    let [width, height] = request.size.unwrap_or([image.width, image.height]);
    if (width, height) != (reference.width, reference.height) {
        return Err(refused(format!(
            "the reference has {} × {} pixels, the view {width} × {height}: compare at the size of the reference",
            reference.width, reference.height
        )));
    }
    Ok(())
}

fn layer_of(request: &ViewRequest) -> Result<Layer> {
    request.layer.as_deref().map_or(Ok(Layer::Color), |word| named(Layer::WORDS, word, "layer"))
}

/// The quantity of a heat map of the cost, if one is requested.
///
/// # Errors
/// `Request` for an unknown layer.
pub(crate) fn counted(request: &ViewRequest) -> Result<Option<Counted>> {
    Ok(match layer_of(request)? {
        Layer::Cost(counted) => Some(counted),
        _ => None,
    })
}

impl Shown<'_> {
    fn development(&self) -> Result<Development> {
        let own = self.session.development();
        Ok(Development {
            exposure: self.request.exposure,
            tonemap: self.request.tonemap(own.tonemap)?,
            denoise: self.request.denoise && !self.is_coarse,
            ..own
        })
    }

    /// The pictures as PNGs: one, or for a wipe two.
    ///
    /// # Errors
    /// As those of encoding.
    pub(crate) fn pictures(&self) -> Result<Vec<Vec<u8>>> {
        let layer = layer_of(self.request)?;
        if layer != Layer::Color {
            let size = [self.film.width(), self.film.height()];
            return Ok(vec![encode_png_to_show(size, Pixels::Rgb8(&self.layer(layer)))?]);
        }
        let developed = self.session.develop(self.film, &self.development()?);
        if let (Some(request), Some(reference)) = (self.request.compare, &self.loaded.reference) {
            return compare::pictures(&developed, self.film, reference, request.mode);
        }
        let shown = developed.shown();
        let size = [shown.width, shown.height];
        let png = match shown.has_alpha {
            true => encode_png_to_show(size, Pixels::Rgba8(&shown.rgba)),
            false => encode_png_to_show(size, Pixels::Rgb8(&without_alpha(&shown.rgba))),
        };
        Ok(vec![png?])
    }

    /// The picture as a file.
    ///
    /// # Errors
    /// As those of encoding.
    pub(crate) fn file(&self, format: Format) -> Result<Vec<u8>> {
        let mut bytes = Cursor::new(Vec::new());
        let developed = self.session.develop(self.film, &self.development()?);
        developed.write(Some(self.film), format, &mut bytes)?;
        Ok(bytes.into_inner())
    }

    /// Bytes of a layer, three per pixel.
    fn layer(&self, layer: Layer) -> Vec<u8> {
        let film = self.film;
        let places = || (0..film.height()).flat_map(|y| (0..film.width()).map(move |x| (x, y)));
        let aovs = |(x, y)| film.aovs(x, y);
        let depths = || places().filter_map(aovs).map(|aovs| aovs.position[2]);
        let (near, far) = depths().fold((f32::INFINITY, 0.0_f32), |(a, b), z| (a.min(z), b.max(z)));
        let most = places().map(|(x, y)| film.samples(x, y)).max().unwrap_or(1).max(1);
        let radius = self.loaded.session.info().bounds.radius() as f32;
        let signed = |v: [f32; 3]| v.map(|c| 0.5 + 0.5 * c);
        let color = |(x, y)| match layer {
            Layer::Error => {
                let mean = film.mean(x, y).iter().sum::<f32>();
                let variance = film.variance(x, y).iter().sum::<f32>();
                let error = (variance / film.samples(x, y).max(1) as f32).sqrt() / mean.max(1e-6);
                heat(1.0 + error.log10() / 3.0)
            }
            Layer::Samples => heat(film.samples(x, y) as f32 / most as f32),
            _ => match aovs((x, y)) {
                None => [0.0; 3],
                Some(aovs) => match layer {
                    Layer::Albedo => aovs.albedo.map(lookfrom_scene::image::srgb_from_linear),
                    Layer::Normal => signed(aovs.ng),
                    Layer::ShadingNormal => signed(aovs.ns),
                    Layer::Position => signed(aovs.position.map(|c| c / radius.max(1e-30))),
                    Layer::Uv => [aovs.uv[0].rem_euclid(1.0), aovs.uv[1].rem_euclid(1.0), 0.0],
                    _ => heat(1.0 - (aovs.position[2] - near) / (far - near).max(1e-30)),
                },
            },
        };
        places().flat_map(|place| color(place).map(byte)).collect()
    }
}
