//! Further channels of a picture in an EXR: AOVs, with the names of pbrt's `gbuffer` film, light-path expressions, Cryptomattes, the
//! buckets of a spectral film, and the light before denoising. They are made row by row as they are written.

use lookfrom_scene::settings::Background;

use super::encode::behind;
use crate::aov::Cryptomatte;
use crate::film::Film;

/// Channel names, in the order of [`to_array`](crate::film::Aovs::to_array); `depth` is ours, the others are pbrt's.
const AOVS: [&str; 15] = [
    "Albedo.R", "Albedo.G", "Albedo.B", "N.X", "N.Y", "N.Z", "Ns.X", "Ns.Y", "Ns.Z", "P.X", "P.Y", "P.Z",
    "depth", "u", "v",
];

/// The colours and normals among [`AOVS`].
const SHADES: &[&str] = AOVS.split_at(9).0;

/// Channel names of the variances of one sample; as in pbrt, those of the sensor's channels: X, Y and Z, or a camera's
/// red, green and blue. The header states which (`variance.from_rgb`).
const VARIANCES: [&str; 3] = ["Variance.R", "Variance.G", "Variance.B"];

/// Names of the channels of motion vectors: pixels to the right, and upwards.
const MOTION: [&str; 2] = ["motion.X", "motion.Y"];

/// Names of the channels of the light before denoising.
const NOISY: [&str; 3] = ["noisy.R", "noisy.G", "noisy.B"];

/// Further channels of a picture, whose numbers are told row by row.
pub(super) enum Layers<'a> {
    /// By their names, of all pixels.
    Given(&'a [(String, Vec<f32>)]),
    /// The layers of a film.
    OfFilm {
        /// The film.
        film: &'a Film,
        /// The names of the layers of light-path expressions.
        light_paths: Vec<&'a str>,
        /// Cryptomattes of its picture.
        cryptomattes: &'a [Cryptomatte],
        /// The names of the channels of a spectral film.
        buckets: Vec<String>,
        /// The background of the light before denoising, if the picture is denoised.
        noisy: Option<Background>,
    },
}

impl Layers<'_> {
    /// The names of the channels.
    pub(super) fn names(&self) -> Vec<String> {
        match self {
            Self::Given(layers) => layers.iter().map(|(name, _)| name.clone()).collect(),
            Self::OfFilm { film, light_paths, cryptomattes, buckets, noisy } => {
                let aovs = AOVS.iter().chain(&VARIANCES).filter(|_| film.has_layers());
                let motion = MOTION.iter().filter(|_| film.has_motion());
                let noisy = NOISY.iter().filter(|_| noisy.is_some());
                let of_light_paths =
                    light_paths.iter().flat_map(|name| ["R", "G", "B"].map(|c| format!("{name}.{c}")));
                let names = aovs.chain(motion).map(|name| (*name).to_owned()).chain(of_light_paths);
                let buckets = buckets.iter().take(film.buckets()).cloned();
                let names = names.chain(cryptomattes.iter().flat_map(Cryptomatte::channels));
                names.chain(buckets).chain(noisy.map(|name| (*name).to_owned())).collect()
            }
        }
    }

    /// Whether a channel, by its name, is of a colour or a normal, of which 16 bits keep all that one sees; others measure or
    /// number something. Where a layer comes from another file, that is unknown.
    pub(super) fn is_shade(&self, name: &str) -> bool {
        let Self::OfFilm { light_paths, .. } = self else { return false };
        let is_of_light_path = |layer: &str| light_paths.contains(&layer);
        SHADES.contains(&name)
            || NOISY.contains(&name)
            || name.rsplit_once('.').is_some_and(|(layer, _)| is_of_light_path(layer))
    }

    /// The texts of a file's header that tell what its channels are.
    pub(super) fn attributes(&self) -> Vec<(String, String)> {
        match self {
            Self::Given(_) => Vec::new(),
            Self::OfFilm { cryptomattes, .. } => {
                cryptomattes.iter().flat_map(Cryptomatte::attributes).collect()
            }
        }
    }

    /// Calls `put` with the number of a channel, a column, and the channel's number there, for all of a row. AOVs are 0 where there
    /// is no hit.
    pub(super) fn row(&self, row: u32, width: u32, put: &mut dyn FnMut(usize, u32, f32)) {
        match self {
            Self::Given(layers) => {
                let start = row as usize * width as usize;
                for (channel, (_, numbers)) in layers.iter().enumerate() {
                    for (x, number) in (0..width).zip(&numbers[start..]) {
                        put(channel, x, *number);
                    }
                }
            }
            Self::OfFilm { film, light_paths, cryptomattes, buckets, noisy } => {
                for x in 0..width {
                    let mut channel = 0;
                    let mut put_next = |number: f32| {
                        put(channel, x, number);
                        channel += 1;
                    };
                    if film.has_layers() {
                        aovs(film, x, row).into_iter().for_each(&mut put_next);
                    }
                    if film.has_motion() {
                        film.motion(x, row).unwrap_or_default().into_iter().for_each(&mut put_next);
                    }
                    if !light_paths.is_empty() {
                        film.light_paths(x, row).flatten().for_each(&mut put_next);
                    }
                    let pixel = row as usize * width as usize + x as usize;
                    let mattes = cryptomattes.iter().flat_map(|matte| matte.numbers(pixel));
                    mattes.for_each(&mut put_next);
                    film.spectrum(x, row).take(buckets.len()).for_each(&mut put_next);
                    if let Some(background) = noisy {
                        film.mean_before(x, row, behind(*background)).into_iter().for_each(&mut put_next);
                    }
                }
            }
        }
    }
}

/// The AOVs of a pixel and its variances, in the order of their names.
fn aovs(film: &Film, x: u32, y: u32) -> impl IntoIterator<Item = f32> {
    let variances = film.channel_variance(x, y).unwrap_or_else(|| film.variance(x, y));
    let variances = variances.map(|variance| if variance.is_finite() { variance } else { 0.0 });
    film.aovs(x, y).unwrap_or_default().to_array().into_iter().chain(variances)
}
