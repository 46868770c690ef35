//! Settings of the image: resolution, sensor, tone mapping, layers.

use super::{CryptomatteKind, Filter, SpectralFilm, word_of};
use crate::error::Location;
use crate::image::srgb_from_linear;
use crate::spectrum::CameraSensor;

/// The names that [`is_channel_name`] allows, in words.
pub const CHANNEL_NAME: &str = "letters, digits, _ and -";

/// Whether a scene may give this name to channels of an EXR.
pub fn is_channel_name(name: &str) -> bool {
    !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-')
}

/// Maximum number of pixels of a picture: 2³⁰.
pub const MOST_PIXELS: u64 = 1 << 30;

/// Resolution, filter, sensor and tone mapping of the image.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageSettings {
    /// Width in pixels, `nx`.
    pub width: u32,
    /// Height in pixels, `ny`.
    pub height: u32,
    /// The crop window: only this part is rendered; the image keeps its full size.
    pub crop: Option<PixelBounds>,
    /// The pixel reconstruction filter.
    pub filter: Filter,
    /// In stops: the image is multiplied by 2^exposure before tone mapping.
    pub exposure: f32,
    /// The tone mapping from linear light to [0, 1].
    pub tonemap: Tonemap,
    /// The sensor.
    pub sensor: Sensor,
    /// The AOVs written to an EXR in addition to the image.
    pub layers: Layers,
    /// Further layers of an EXR: parts of the light, by light-path expressions.
    pub light_paths: Vec<LightPathLayer>,
    /// Cryptomattes of an EXR, each kind at most once.
    pub cryptomattes: Vec<CryptomatteKind>,
    /// The spectral film; `None` for one of colours alone, whose wavelengths are sampled by the sensitivity of the eye.
    pub spectral_film: Option<SpectralFilm>,
    /// The background of the image where the camera sees no surface.
    pub background: Background,
    /// Whether the image is denoised.
    pub denoise: bool,
}

impl ImageSettings {
    /// Changes the size. The crop window stays the same part of the image, to the next pixel outward.
    pub fn resize(&mut self, width: u32, height: u32) {
        let [old_width, old_height] = [self.width, self.height].map(|size| u64::from(size.max(1)));
        self.crop = self.crop.map(|PixelBounds { x0, y0, x1, y1 }| {
            let down = |edge: u32, new: u32, old: u64| (u64::from(edge) * u64::from(new) / old) as u32;
            let up = |edge: u32, new: u32, old: u64| (u64::from(edge) * u64::from(new)).div_ceil(old) as u32;
            PixelBounds {
                x0: down(x0, width, old_width),
                y0: down(y0, height, old_height),
                x1: up(x1, width, old_width),
                y1: up(y1, height, old_height),
            }
        });
        (self.width, self.height) = (width, height);
    }

    /// A picture of another size with the light alone: whole, without AOVs, layers and denoising.
    #[must_use]
    pub fn of_light(&self, width: u32, height: u32) -> Self {
        Self { width, height, crop: None, denoise: false, ..self.clone() }.without_layers()
    }

    /// Settings of the picture alone, without layers of an EXR beside it.
    #[must_use]
    pub fn without_layers(self) -> Self {
        let spectral_film = self.spectral_film.as_ref().map(SpectralFilm::of_picture);
        Self {
            layers: Layers::None,
            light_paths: Vec::new(),
            cryptomattes: Vec::new(),
            spectral_film,
            ..self
        }
    }
}

/// The background of the image where the camera sees no surface; illumination does not depend on it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Background {
    /// The environment lights.
    #[default]
    Environment,
    /// A constant colour: linear Rec. 709.
    Color([f32; 3]),
    /// None: the image has an alpha channel.
    Transparent,
}

/// `environment`, `transparent` or `#rrggbb` in sRGB.
impl std::fmt::Display for Background {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Environment => f.write_str("environment"),
            Self::Transparent => f.write_str("transparent"),
            Self::Color(rgb) => {
                let [r, g, b] = rgb.map(|c| (255.0 * srgb_from_linear(c) + 0.5) as u8);
                write!(f, "#{r:02x}{g:02x}{b:02x}")
            }
        }
    }
}

/// The sensor that converts light to colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// The camera whose spectral responses are used; `None` for the CIE 1931 standard observer.
    pub camera: Option<CameraSensor>,
    /// Multiplies all light: exposure time × ISO / 100 in pbrt's films.
    pub imaging_ratio: f32,
    /// The colour temperature, in kelvin, of light that appears white; `None` leaves colours unchanged, except for a camera,
    /// where it is [`Sensor::DAYLIGHT`].
    pub white_balance: Option<f32>,
    /// The maximum of a sample's channels; brighter samples are scaled down to it: biased, against fireflies. Channels are
    /// those of the sensor, before white balance: the camera's red, green and blue, or X, Y and Z. Infinity for no limit.
    pub max_component: f32,
}

impl Sensor {
    /// The word for the standard observer, besides the names of cameras.
    pub const OBSERVER: &str = "cie1931";

    /// The default white balance of a camera, in kelvin.
    pub const DAYLIGHT: f32 = 6500.0;

    /// Whether its channels are X, Y and Z of the image.
    pub fn measures_xyz(&self) -> bool {
        self.camera.is_none() && self.white_balance.is_none()
    }
}

impl Default for Sensor {
    fn default() -> Self {
        Self { camera: None, imaging_ratio: 1.0, white_balance: None, max_component: f32::INFINITY }
    }
}

/// The AOVs written to an EXR in addition to the image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layers {
    /// None.
    #[default]
    None,
    /// Albedo, normals, position, depth, uv and variance of the first visible surface.
    Geometry,
    /// As [`Layers::Geometry`], and motion vectors from the opening to the closing of the shutter.
    Motion,
}

impl Layers {
    /// The words for them.
    pub const WORDS: &[(&str, Self)] =
        &[("none", Self::None), ("geometry", Self::Geometry), ("motion", Self::Motion)];
}

/// A layer with the light that came on certain ways.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightPathLayer {
    /// Its name: that of its channels, before `.R`, `.G` and `.B`.
    pub name: String,
    /// The light-path expression, in the notation of Open Shading Language.
    pub expression: String,
    /// The location of its expression, for errors.
    pub at: Location,
}

impl Default for ImageSettings {
    fn default() -> Self {
        Self {
            width: 640,
            height: 480,
            crop: None,
            filter: Filter::default(),
            exposure: 0.0,
            tonemap: Tonemap::default(),
            sensor: Sensor::default(),
            layers: Layers::None,
            light_paths: Vec::new(),
            cryptomattes: Vec::new(),
            spectral_film: None,
            background: Background::default(),
            denoise: false,
        }
    }
}

/// A part of the image in pixels from the top left: `x0 ≤ x < x1`, `y0 ≤ y < y1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelBounds {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// One past the last column.
    pub x1: u32,
    /// One past the last row.
    pub y1: u32,
}

impl PixelBounds {
    /// No pixels.
    pub const EMPTY: Self = Self { x0: 0, y0: 0, x1: 0, y1: 0 };

    /// All pixels of a picture.
    pub fn of_size(width: u32, height: u32) -> Self {
        Self { x0: 0, y0: 0, x1: width, y1: height }
    }

    /// Columns and rows; 0 where it ends before it begins.
    pub fn size(self) -> [u32; 2] {
        [self.x1.saturating_sub(self.x0), self.y1.saturating_sub(self.y0)]
    }

    /// The number of pixels.
    pub fn pixels(self) -> u64 {
        let [width, height] = self.size();
        u64::from(width) * u64::from(height)
    }

    /// Whether it has no pixels.
    pub fn is_empty(self) -> bool {
        self.size().contains(&0)
    }

    /// Whether a pixel is in it.
    pub fn contains(self, x: u32, y: u32) -> bool {
        (self.x0..self.x1).contains(&x) && (self.y0..self.y1).contains(&y)
    }

    /// The number of a pixel in it, row by row.
    pub fn index(self, x: u32, y: u32) -> usize {
        (y - self.y0) as usize * (self.x1 - self.x0) as usize + (x - self.x0) as usize
    }

    /// The pixels of both; [`Self::EMPTY`] where there are none.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        let both = Self {
            x0: self.x0.max(other.x0),
            y0: self.y0.max(other.y0),
            x1: self.x1.min(other.x1),
            y1: self.y1.min(other.y1),
        };
        if both.is_empty() { Self::EMPTY } else { both }
    }

    /// The smallest rectangle around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            x0: self.x0.min(other.x0),
            y0: self.y0.min(other.y0),
            x1: self.x1.max(other.x1),
            y1: self.y1.max(other.y1),
        }
    }
}

/// The tone mapping from linear light to [0, 1], before the sRGB curve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tonemap {
    /// Clamping at 1.
    #[default]
    Clamp,
    /// x / (1 + x) on luminance (Reinhard et al. 2002).
    Reinhard,
    /// A filmic curve (the fit of Narkowicz 2015 to ACES).
    Filmic,
    /// Khronos PBR Neutral (2024): preserves colours and compresses highlights; the default for glTF.
    PbrNeutral,
    /// The reference rendering and output transforms of ACES 1.0 (the fit of Stephen Hill).
    Aces,
    /// AgX (Troy Sobotka 2022), as in Blender's default look.
    Agx,
}

impl Tonemap {
    /// The words for the tone mappers, in scene files and on the command line.
    pub const WORDS: &'static [(&'static str, Self)] = &[
        ("clamp", Self::Clamp),
        ("reinhard", Self::Reinhard),
        ("filmic", Self::Filmic),
        ("pbr_neutral", Self::PbrNeutral),
        ("aces", Self::Aces),
        ("agx", Self::Agx),
    ];

    /// The word for this tone mapper.
    pub fn word(self) -> &'static str {
        word_of(Self::WORDS, self)
    }
}
