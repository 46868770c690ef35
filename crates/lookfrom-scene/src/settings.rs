//! Settings of the image and of the integrator, with their defaults.

mod cryptomatte;
mod filter;
mod image;
mod render;
mod spectral_film;

pub use self::cryptomatte::CryptomatteKind;
pub use self::filter::{Filter, FilterShape};
pub use self::image::{
    Background, CHANNEL_NAME, ImageSettings, Layers, LightPathLayer, MOST_PIXELS, PixelBounds, Sensor,
    Tonemap, is_channel_name,
};
pub use self::render::{Allocation, ColorMode, Integrator, LightSampler, Portals, RenderSettings, Sampler};
pub use self::spectral_film::{Band, SpectralFilm};

/// The word for a value; every value has one.
fn word_of<T: PartialEq + Copy>(words: &[(&'static str, T)], value: T) -> &'static str {
    words.iter().find(|(_, of_word)| *of_word == value).map_or("?", |(word, _)| word)
}
