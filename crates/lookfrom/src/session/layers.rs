//! AOVs of a film as EXR channels, with the names of pbrt's `gbuffer` film.

use lookfrom_scene::settings::Background;

use super::encode::behind;
use crate::film::{Film, Picture};

/// Channel names, in the order of [`to_array`](crate::film::Aovs::to_array); `depth` is ours, the others are pbrt's.
const AOVS: [&str; 15] = [
    "Albedo.R", "Albedo.G", "Albedo.B", "N.X", "N.Y", "N.Z", "Ns.X", "Ns.Y", "Ns.Z", "P.X", "P.Y", "P.Z",
    "depth", "u", "v",
];

/// Channel names of the variances of one sample; as in pbrt, those of the sensor's channels: X, Y and Z, or a camera's
/// red, green and blue. The header states which (`variance.from_rgb`).
const VARIANCES: [&str; 3] = ["Variance.R", "Variance.G", "Variance.B"];

/// The channels of a film's picture before denoising, over the same background as the denoised one.
pub(super) fn noisy(background: Background, picture: Picture) -> Vec<(String, Vec<f32>)> {
    let picture = picture.before(behind(background));
    let channel = |index: usize| picture.pixels.iter().map(|pixel| pixel[index]).collect();
    [("noisy.R", 0), ("noisy.G", 1), ("noisy.B", 2)]
        .map(|(name, index)| (name.to_owned(), channel(index)))
        .to_vec()
}

/// The channels of the layers of light-path expressions, by their names.
pub(super) fn of_light_paths<'a>(
    film: &Film,
    names: impl Iterator<Item = &'a str>,
) -> Vec<(String, Vec<f32>)> {
    let mut channels: Vec<(String, Vec<f32>)> = names
        .flat_map(|name| ["R", "G", "B"].map(|letter| (format!("{name}.{letter}"), Vec::new())))
        .collect();
    if channels.is_empty() {
        return channels;
    }
    for (x, y) in (0..film.height()).flat_map(|y| (0..film.width()).map(move |x| (x, y))) {
        for ((_, channel), value) in channels.iter_mut().zip(film.light_paths(x, y).flatten()) {
            channel.push(value);
        }
    }
    channels
}

/// The AOV channels of a film, 0 where there is no hit.
pub(super) fn channels(film: &Film) -> Vec<(String, Vec<f32>)> {
    let pixels = || (0..film.height()).flat_map(|y| (0..film.width()).map(move |x| (x, y)));
    let mut channels: Vec<(String, Vec<f32>)> = AOVS
        .iter()
        .chain(&VARIANCES)
        .map(|name| ((*name).to_owned(), Vec::with_capacity(pixels().count())))
        .collect();
    for (x, y) in pixels() {
        let variances = film.channel_variance(x, y).unwrap_or_else(|| film.variance(x, y));
        let variances = variances.map(|variance| if variance.is_finite() { variance } else { 0.0 });
        let values = film.aovs(x, y).unwrap_or_default().to_array().into_iter().chain(variances);
        for ((_, channel), value) in channels.iter_mut().zip(values) {
            channel.push(value);
        }
    }
    channels
}
