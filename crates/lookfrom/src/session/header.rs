//! The header of an OpenEXR file: everything that determines its light, and nothing else, so that the same picture has
//! the same bytes whatever the number of threads, the time and the machine.

use glam::DVec3;
use lookfrom_scene::camera::{Projection, View};
use lookfrom_scene::image::compare::{CHANNELS_ATTRIBUTE, channels_text};
use lookfrom_scene::settings::{Background, ImageSettings, Layers, PixelBounds, Sensor};

use super::Session;
use crate::core::color;

/// Numbers of samples and post-processing of a picture.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Taken {
    /// Maximum number of samples of a pixel.
    pub(super) samples: u32,
    /// Mean number of samples per pixel, rounded down, where it differs between pixels or the render was stopped.
    pub(super) mean: Option<u64>,
    /// The relative error at which a tile gets no more samples.
    pub(super) noise: Option<f64>,
    /// Whether fireflies are spread.
    pub(super) fireflies_spread: bool,
    /// Whether the picture is denoised.
    pub(super) denoised: bool,
}

/// The texts of the header, by name.
pub(super) fn header(session: &Session, taken: &Taken) -> Vec<(String, String)> {
    let (image, render) = (session.renderer.view().image(), session.renderer.settings());
    let camera = &session.camera;
    let mut texts = vec![
        ("software", format!("lookfrom {}", env!("CARGO_PKG_VERSION"))),
        ("scene", session.name.clone()),
        ("size", format!("{} {}", image.width, image.height)),
        ("integrator", session.renderer.integrator().to_owned()),
        ("samples", taken.samples.to_string()),
        ("depth", render.depth.to_string()),
        ("color", render.color.word().to_owned()),
        ("light_sampler", render.light_sampler.word().to_owned()),
        ("regularize", render.regularize.to_string()),
        ("min_contribution", render.min_contribution.to_string()),
        ("transparent_shadows", render.transparent_shadows.to_string()),
        ("seed", render.seed.to_string()),
        ("sampler", render.sampler.word().to_owned()),
        ("filter", image.filter.to_string()),
        // The exposure of 8-bit pictures; the light in this file is as it was computed.
        ("exposure", image.exposure.to_string()),
        ("tonemap", "none".to_owned()),
        ("camera.distance", camera.distance.to_string()),
    ];
    texts.extend(sensor(image));
    if image.background != Background::Environment {
        texts.push(("background", image.background.to_string()));
    }
    if let Some(mean) = taken.mean {
        texts.push(("samples_taken", mean.to_string()));
    }
    if let Some(noise) = taken.noise {
        texts.push(("noise", noise.to_string()));
    }
    if taken.fireflies_spread {
        texts.push(("fireflies", "median".to_owned()));
    }
    if taken.denoised {
        texts.push((
            "denoised",
            "non-local means; noisy.R, noisy.G and noisy.B are the light as it was computed".to_owned(),
        ));
    }
    if let Some(PixelBounds { x0, y0, x1, y1 }) = image.crop {
        texts.push(("crop", format!("{x0} {y0} {x1} {y1}")));
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
    match camera.projection {
        Projection::Perspective { fov } => texts.push(("camera.fov", fov.to_string())),
        Projection::Orthographic { height } => texts.push(("camera.height", height.to_string())),
        Projection::Equirectangular | Projection::EquirectangularPbrt => {
            texts.push(("camera.projection", "equirectangular".to_owned()));
        }
        Projection::Octahedral => texts.push(("camera.projection", "octahedral".to_owned())),
    }
    if let Some(lens) = camera.lens {
        texts.push(("camera.lens_radius", lens.radius.to_string()));
        texts.push(("camera.focus_distance", lens.focus_distance.to_string()));
    }
    texts.into_iter().map(|(name, text)| (name.to_owned(), text)).collect()
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
    if image.layers == Layers::Geometry {
        let channels = *color::Sensor::new(&image.sensor).variance_from_rgb();
        texts.push((CHANNELS_ATTRIBUTE, channels_text(&channels)));
    }
    texts
}

/// Three numbers with spaces between them.
fn spaced(v: DVec3) -> String {
    format!("{} {} {}", v.x, v.y, v.z)
}
