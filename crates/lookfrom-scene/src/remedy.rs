//! Remedies: what would help, as values, which each front end puts into its own words.

use std::fmt;

/// A remedy for an error, or a way to have otherwise what a warning tells. Its text names options, but no command's flags;
/// [`Error::worded`](crate::Error::worded) and [`Warning::worded`](crate::Warning::worded) take the words of a front end.
#[derive(Clone, Debug, PartialEq)]
pub enum Remedy {
    /// Words that suit every front end.
    Words(String),
    /// The option `up` with the name of an axis: the other custom of the file's format.
    Up(&'static str),
    /// The option `exposure` in stops, which fixes the exposure that was chosen.
    Exposure(f32),
    /// A colour as the option `background`, or a format that holds transparency.
    OpaqueBackground,
    /// The option `instanced_lights`.
    InstancedLights,
    /// A higher limit as the option `memory`.
    MoreMemory,
    /// A smaller picture, or films of its parts, or a higher limit as the option `memory`.
    SmallerPicture,
    /// The option `film`, which keeps the sums of samples.
    KeptFilm,
    /// The options that decide the pixels and sums of a film, as when it was begun.
    SamePicture,
    /// Light of wavelengths by the option `color`, or no spectral film by `spectral_buckets`.
    SpectralLight,
}

impl From<&str> for Remedy {
    fn from(words: &str) -> Self {
        Self::Words(words.to_owned())
    }
}

impl From<String> for Remedy {
    fn from(words: String) -> Self {
        Self::Words(words)
    }
}

impl fmt::Display for Remedy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Words(words) => words,
            Self::Up(axis) => return write!(f, "the option `up` = {axis} shows it otherwise"),
            Self::Exposure(stops) => return write!(f, "the option `exposure` = {stops} repeats it"),
            Self::OpaqueBackground => {
                "PNG, WebP and OpenEXR hold transparency; a colour as the `background` is for all formats"
            }
            Self::InstancedLights => "with the option `instanced_lights` each instance is a light",
            Self::MoreMemory => {
                "the option `memory` sets another limit; if the size is not true, the file is damaged"
            }
            Self::SmallerPicture => {
                "a smaller picture takes less; films of crops of it can be rendered one by one and merged, without having \
                 all in memory if they are not denoised; the option `memory` sets another limit"
            }
            Self::KeptFilm => "render it with the option `film`",
            Self::SamePicture => {
                "the size, crop, layers, light paths, spectral buckets, background and denoising must be as when it was begun"
            }
            Self::SpectralLight => {
                "with the option `color` = spectral light has wavelengths; `spectral_buckets` = 0 makes a picture of colours alone"
            }
        })
    }
}
