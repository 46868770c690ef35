//! The header of an OpenEXR file: everything that determines its light, and nothing else, so that the same picture has
//! the same bytes whatever the number of threads, the time and the machine.

use std::ops::Range;
use std::path::Path;

use glam::DVec3;
use lookfrom_scene::camera::{Projection, View, Window};
use lookfrom_scene::contents::Moment;
use lookfrom_scene::image::compare::{CHANNELS_ATTRIBUTE, channels_text};
use lookfrom_scene::settings::{Allocation, Background, ImageSettings, Layers, PixelBounds, Portals, Sensor};

use super::{Development, Fireflies, Session, spectral};
use crate::aov::CRYPTOMATTE_ATTRIBUTES;
use crate::core::color;
use crate::film::Film;

/// The texts of the header that any number of samples has in common, sorted by name.
pub(super) fn header(session: &Session) -> Vec<(String, String)> {
    let (image, render) = (session.renderer.view().image(), session.renderer.settings());
    let camera = &session.camera;
    let mut texts = vec![
        ("software", format!("lookfrom {}", env!("CARGO_PKG_VERSION"))),
        (SCENE, file_name(&session.name)),
        ("size", format!("{} {}", image.width, image.height)),
        ("integrator", session.renderer.integrator().to_owned()),
        ("depth", render.depth.to_string()),
        ("color", render.color.word().to_owned()),
        ("light_sampler", render.light_sampler.word().to_owned()),
        ("regularize", render.regularize.to_string()),
        ("min_contribution", render.min_contribution.to_string()),
        ("transparent_shadows", render.transparent_shadows.to_string()),
        ("thin_passages_count", render.thin_passages_count.to_string()),
        ("open_fronts", render.open_fronts.to_string()),
        ("seed", render.seed.to_string()),
        ("sampler", render.sampler.word().to_owned()),
        ("filter", image.filter.to_string()),
        ("tonemap", "none".to_owned()),
        ("camera.distance", camera.distance.to_string()),
    ];
    texts.extend(sensor(image));
    if render.portals != Portals::default() {
        texts.push(("portals", render.portals.word().to_owned()));
    }
    if render.endless_media {
        texts.push(("endless_media", render.endless_media.to_string()));
    }
    if render.hide_lights {
        texts.push(("hide_lights", render.hide_lights.to_string()));
    }
    if let Some(noise) = session.stop.noise {
        texts.push((NOISE, noise.to_string()));
    }
    if render.allocation == Allocation::Adaptive {
        texts.push((
            ALLOCATION,
            format!("{}, {} samples per pixel in the mean", render.allocation.word(), render.samples),
        ));
    }
    if let Some(Moment { time, fps, shutter }) = session.info.contents.moment {
        texts.push(("time", time.to_string()));
        texts.push(("fps", fps.to_string()));
        texts.push(("shutter", shutter.to_string()));
    }
    match camera.view {
        View::Look { lookfrom, lookat, up } => {
            texts.push(("camera.lookfrom", spaced(lookfrom)));
            texts.push(("camera.lookat", spaced(lookat)));
            texts.push(("camera.up", spaced(up)));
        }
        View::Matrix(matrix) => {
            let columns = matrix.to_cols_array().map(|number| number.to_string());
            texts.push(("camera.matrix_by_columns", columns.join(" ")));
        }
    }
    match &camera.projection {
        Projection::Perspective { fov } => texts.push(("camera.fov", fov.to_string())),
        Projection::Orthographic { height } => texts.push(("camera.height", height.to_string())),
        Projection::Equirectangular | Projection::EquirectangularPbrt => {
            texts.push(("camera.projection", "equirectangular".to_owned()));
        }
        Projection::Octahedral => texts.push(("camera.projection", "octahedral".to_owned())),
        Projection::LensSystem(system) => {
            texts.push(("camera.lens", system.name.clone()));
            texts.push(("camera.focus_distance", system.focus_distance.to_string()));
        }
        Projection::Irradiance { surface } => {
            texts.push(("camera.projection", "irradiance".to_owned()));
            texts.push(("camera.surface", surface.clone()));
        }
    }
    if let Some(Window { x: [left, right], y: [bottom, top] }) = camera.window {
        texts.push(("camera.window", format!("{left} {right} {bottom} {top}")));
    }
    if let Some(lens) = camera.lens {
        texts.push(("camera.lens_radius", lens.radius.to_string()));
        texts.push(("camera.focus_distance", lens.focus_distance.to_string()));
    }
    let mut texts: Vec<_> = texts.into_iter().map(|(name, text)| (name.to_owned(), text)).collect();
    let light_paths = image.light_paths.iter().enumerate();
    texts.extend(
        light_paths.map(|(index, layer)| {
            (format!("{LIGHT_PATH}{index:02}.{}", layer.name), layer.expression.clone())
        }),
    );
    texts.extend(image.spectral_film.iter().flat_map(spectral::texts));
    texts.sort();
    texts
}

/// The names of texts with light-path expressions begin with this; a number, a point and the name of the layer follow.
const LIGHT_PATH: &str = "light_path.";

/// The names of the layers of light-path expressions, in their order, among sorted texts.
pub(super) fn light_paths(texts: &[(String, String)]) -> impl Iterator<Item = &str> {
    texts.iter().filter_map(|(name, _)| light_path_of(name))
}

/// The layer of light-path expressions that a text is about, by the name of the text.
pub(super) fn light_path_of(name: &str) -> Option<&str> {
    Some(name.strip_prefix(LIGHT_PATH)?.split_once('.')?.1)
}

/// The name of the text with the crop.
const CROP: &str = "crop";

/// The columns and the rows that were rendered, if not all were, by the texts.
pub(super) fn crop(texts: &[(String, String)]) -> Option<[Range<u32>; 2]> {
    let (_, text) = texts.iter().find(|(name, _)| name == CROP)?;
    let numbers: Vec<u32> = text.split(' ').map_while(|number| number.parse().ok()).collect();
    let [x0, y0, x1, y1] = numbers.try_into().ok()?;
    Some([x0..x1, y0..y1])
}

/// The name of the text with the name of the scene's file.
pub(super) const SCENE: &str = "scene";

/// The name of the text with the relative error at which the picture gets no more samples.
pub(super) const NOISE: &str = "noise";

/// The name of the text of adaptive allocation.
pub(super) const ALLOCATION: &str = "allocation";

/// Names of the texts that [`finished`] adds.
const OF_FINISHED: [&str; 7] =
    ["samples", "samples_taken", "exposure", "background", "fireflies", "denoised", CROP];

/// The texts of a finished picture: those that all have in common, which samples it has, and its post-processing.
pub(super) fn finished(
    common: &[(String, String)],
    film: &Film,
    development: &Development,
    is_denoised: bool,
) -> Vec<(String, String)> {
    let (area, ledger) = (film.area(), film.ledger());
    let mean = (ledger.total() / area.pixels().max(1)).to_string();
    let (samples, mean) = match ledger.uniform(area).as_deref() {
        Some([samples]) if samples.start == 0 => (samples.end.to_string(), None),
        Some([samples]) => (format!("{}..{}", samples.start, samples.end), None),
        _ => (ledger.most().to_string(), Some(mean)),
    };
    let mut texts = with_samples(common, samples, mean);
    let mut add = |name: &str, text: String| texts.push((name.to_owned(), text));
    // The exposure of 8-bit pictures; the light in this file is as it was computed.
    add("exposure", development.exposure.to_string());
    if development.background != Background::Environment {
        add("background", development.background.to_string());
    }
    if development.fireflies == Fireflies::Spread {
        add("fireflies", "median".to_owned());
    }
    if is_denoised {
        add(
            "denoised",
            "non-local means; noisy.R, noisy.G and noisy.B are the light as it was computed".to_owned(),
        );
    }
    let PixelBounds { x0, y0, x1, y1 } = area;
    if (x0, y0, x1, y1) != (0, 0, film.width(), film.height()) {
        add(CROP, format!("{x0} {y0} {x1} {y1}"));
    }
    texts.sort();
    texts
}

/// The common texts with numbers of samples: of a pixel, at most, and in the mean where it differs between pixels.
pub(super) fn with_samples(
    common: &[(String, String)],
    samples: String,
    mean: Option<String>,
) -> Vec<(String, String)> {
    let mut texts = common.to_vec();
    texts.push(("samples".to_owned(), samples));
    texts.extend(mean.map(|mean| ("samples_taken".to_owned(), mean)));
    texts
}

/// The common texts among those of a finished picture.
pub(super) fn common(mut texts: Vec<(String, String)>) -> Vec<(String, String)> {
    texts.retain(|(name, _)| {
        !OF_FINISHED.contains(&name.as_str()) && !name.starts_with(CRYPTOMATTE_ATTRIBUTES)
    });
    texts
}

/// Settings of the sensor that differ from the default, and the channels of the variances among the AOVs.
fn sensor(image: &ImageSettings) -> Vec<(&'static str, String)> {
    let Sensor { camera, imaging_ratio, white_balance, max_component } = image.sensor;
    let default = Sensor::default();
    let mut texts = Vec::new();
    if let Some(camera) = camera {
        texts.push(("sensor", camera.name().to_owned()));
    }
    if imaging_ratio != default.imaging_ratio {
        texts.push(("imaging_ratio", imaging_ratio.to_string()));
    }
    if let Some(kelvin) = white_balance {
        texts.push(("white_balance", kelvin.to_string()));
    }
    if max_component != default.max_component {
        texts.push(("max_component", max_component.to_string()));
    }
    if image.layers != Layers::None {
        let channels = *color::Sensor::new(&image.sensor).variance_from_rgb();
        texts.push((CHANNELS_ATTRIBUTE, channels_text(&channels)));
    }
    texts
}

/// The name of a file without its folder, which may be another one on another machine.
fn file_name(path: &str) -> String {
    Path::new(path).file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Three numbers with spaces between them.
fn spaced(v: DVec3) -> String {
    format!("{} {} {}", v.x, v.y, v.z)
}
