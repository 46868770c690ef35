//! Settings of the image and of the integrator, with their defaults.

use crate::image::srgb_from_linear;

use crate::spectrum::CameraSensor;

/// Size, filter and development of the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageSettings {
    /// Columns, `nx`.
    pub width: u32,
    /// Rows, `ny`.
    pub height: u32,
    /// Only this part is computed; the picture keeps its full size.
    pub crop: Option<PixelBounds>,
    /// The pixel reconstruction filter.
    pub filter: Filter,
    /// In stops: the picture is multiplied by 2^exposure before the tone map.
    pub exposure: f32,
    /// The tone mapping from linear light to [0, 1].
    pub tonemap: Tonemap,
    /// The sensor.
    pub sensor: Sensor,
    /// The AOVs of an EXR besides the picture.
    pub layers: Layers,
    /// The background of the picture where the camera sees no surface.
    pub background: Background,
    /// Whether noise is filtered out of the picture.
    pub denoise: bool,
}

/// The background of the picture where the camera sees no surface; illumination is the same for all of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Background {
    /// The environments.
    #[default]
    Environment,
    /// A colour: linear Rec. 709.
    Color([f32; 3]),
    /// Nothing: the picture has an alpha channel.
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
    /// The camera whose spectral responses it has; `None` is the CIE 1931 standard observer.
    pub camera: Option<CameraSensor>,
    /// Multiplies all light: exposure time × ISO / 100 of pbrt's films.
    pub imaging_ratio: f32,
    /// The colour temperature, in kelvin, of the light that shall look white; `None` leaves colours as they are, and is
    /// [`Sensor::DAYLIGHT`] for a camera.
    pub white_balance: Option<f32>,
    /// A sample whose greatest channel is brighter is darkened to it: a bias against fireflies. Channels are those of the
    /// sensor, before white balance: the camera's red, green and blue, or X, Y and Z. Infinite is none.
    pub max_component: f32,
}

impl Sensor {
    /// The word for the standard observer, where cameras have their names.
    pub const OBSERVER: &str = "cie1931";

    /// The white balance of a camera where nothing is said, in kelvin.
    pub const DAYLIGHT: f32 = 6500.0;

    /// Whether its channels are X, Y and Z of the picture's light.
    pub fn measures_xyz(&self) -> bool {
        self.camera.is_none() && self.white_balance.is_none()
    }
}

impl Default for Sensor {
    fn default() -> Self {
        Self { camera: None, imaging_ratio: 1.0, white_balance: None, max_component: f32::INFINITY }
    }
}

/// The AOVs of an EXR besides the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layers {
    /// None.
    #[default]
    None,
    /// Albedo, normals, position, depth, uv and variance of what the camera sees first.
    Geometry,
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
            background: Background::default(),
            denoise: false,
        }
    }
}

/// A part of the picture in pixels from the top left: `x0 ≤ x < x1`, `y0 ≤ y < y1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelBounds {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// Beyond the last column.
    pub x1: u32,
    /// Beyond the last row.
    pub y1: u32,
}

/// The pixel reconstruction filter. Radii are in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// All the same. Half a pixel is the pixel itself.
    Box {
        /// Half the width: > 0.
        radius: f32,
    },
    /// A tent.
    Triangle {
        /// Half the width: > 0.
        radius: f32,
    },
    /// A bell, shifted down so that it ends at 0.
    Gaussian {
        /// Half the width: > 0.
        radius: f32,
        /// Standard deviation: > 0.
        sigma: f32,
    },
    /// Mitchell & Netravali 1988.
    Mitchell {
        /// Half the width: > 0.
        radius: f32,
        /// Blur.
        b: f32,
        /// Ringing.
        c: f32,
    },
    /// Blackman & Harris' four-term window.
    BlackmanHarris {
        /// Half the width: > 0.
        radius: f32,
    },
}

impl Filter {
    /// The words for them, in scene files and on the command line, with the radii and shapes that they have where nothing is
    /// said.
    pub const WORDS: &'static [(&'static str, Self)] = &[
        ("box", Self::Box { radius: 0.5 }),
        ("triangle", Self::Triangle { radius: 1.0 }),
        ("gaussian", Self::Gaussian { radius: 1.5, sigma: 0.5 }),
        ("mitchell", Self::Mitchell { radius: 2.0, b: 1.0 / 3.0, c: 1.0 / 3.0 }),
        ("blackman_harris", Self::BlackmanHarris { radius: 1.5 }),
    ];
}

/// `name:radius`, and what shapes it besides.
impl std::fmt::Display for Filter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Box { radius } => write!(f, "box:{radius}"),
            Self::Triangle { radius } => write!(f, "triangle:{radius}"),
            Self::Gaussian { radius, sigma } => write!(f, "gaussian:{radius} sigma {sigma}"),
            Self::Mitchell { radius, b, c } => write!(f, "mitchell:{radius} b {b} c {c}"),
            Self::BlackmanHarris { radius } => write!(f, "blackman_harris:{radius}"),
        }
    }
}

impl Default for Filter {
    fn default() -> Self {
        Self::BlackmanHarris { radius: 1.5 }
    }
}

/// The tone mapping from linear light to [0, 1], before the sRGB curve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tonemap {
    /// Cut at 1.
    #[default]
    Clamp,
    /// x / (1 + x) on luminance (Reinhard et al. 2002).
    Reinhard,
    /// A filmic curve (the fit of Narkowicz 2015 to ACES).
    Filmic,
    /// Khronos' PBR Neutral (2024): colours as they are, highlights compressed; the default of glTF.
    PbrNeutral,
    /// The reference and output transforms of ACES 1.0 (the fit of Stephen Hill).
    Aces,
    /// AgX (Troy Sobotka 2022), as Blender's default look.
    Agx,
}

impl Tonemap {
    /// The words for them, in scene files and on the command line.
    pub const WORDS: &'static [(&'static str, Self)] = &[
        ("clamp", Self::Clamp),
        ("reinhard", Self::Reinhard),
        ("filmic", Self::Filmic),
        ("pbr_neutral", Self::PbrNeutral),
        ("aces", Self::Aces),
        ("agx", Self::Agx),
    ];

    /// Its word.
    pub fn word(self) -> &'static str {
        word_of(Self::WORDS, self)
    }
}

/// The integrator and its settings.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderSettings {
    /// The integrator.
    pub integrator: Integrator,
    /// Samples a pixel: ≥ 1.
    pub samples: u32,
    /// The maximum path depth: the number of reflections, refractions and scatterings.
    pub depth: u32,
    /// A branch of the tree whose share of the pixel falls below this is cut off (Whitted's adaptive depth control).
    pub min_contribution: f32,
    /// The sample sequence.
    pub sampler: Sampler,
    /// Another seed, other noise.
    pub seed: u64,
    /// Whether light goes straight through transparent things to what they would shadow, coloured by them.
    pub transparent_shadows: bool,
    /// The meaning of the four lanes of a spectrum: RGB or wavelengths.
    pub color: ColorMode,
    /// The light sampler: the choice of one light of many.
    pub light_sampler: LightSampler,
    /// Whether the path tracer blurs what it sees after the first diffuse bounce: less noise, slightly wrong.
    pub regularize: bool,
    /// The maximum distance of ambient occlusion.
    pub occlusion_distance: f32,
    /// Whether what fills space counts: the media on the sides of surfaces ([`Sides`](crate::medium::Sides)) and around
    /// the camera. Without them interfaces stop shadow rays, but no others, as in pbrt's integrators that know no media.
    /// What materials say of the inside of bodies counts always.
    pub media: bool,
}

/// The meaning of the four lanes of a spectrum: RGB or wavelengths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorMode {
    /// Linear Rec. 709.
    #[default]
    Rgb,
    /// Four wavelengths, chosen anew for each sample.
    Spectral,
}

impl ColorMode {
    /// The words for them, in scene files and on the command line.
    pub const WORDS: &'static [(&'static str, Self)] = &[("rgb", Self::Rgb), ("spectral", Self::Spectral)];

    /// Its word.
    pub fn word(self) -> &'static str {
        word_of(Self::WORDS, self)
    }
}

/// The light sampler: the choice of one light of many.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightSampler {
    /// All the same.
    Uniform,
    /// By what they send out.
    Power,
    /// By what they may send to where it is asked (Conty Estevez & Kulla 2018).
    #[default]
    Bvh,
}

impl LightSampler {
    /// The words for them, in scene files and on the command line.
    pub const WORDS: &'static [(&'static str, Self)] =
        &[("uniform", Self::Uniform), ("power", Self::Power), ("bvh", Self::Bvh)];

    /// Its word.
    pub fn word(self) -> &'static str {
        word_of(Self::WORDS, self)
    }
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self {
            integrator: Integrator::Whitted,
            samples: 16,
            depth: 8,
            min_contribution: 1.0 / 512.0,
            sampler: Sampler::Sobol,
            seed: 0,
            transparent_shadows: true,
            color: ColorMode::Rgb,
            light_sampler: LightSampler::Bvh,
            regularize: false,
            occlusion_distance: f32::INFINITY,
            media: true,
        }
    }
}

/// The computations there are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integrator {
    /// Appel 1968: the nearest surface, local shading, one shadow ray to each light.
    Raycast,
    /// Whitted 1980: the tree of rays.
    #[default]
    Whitted,
    /// Kajiya 1986 with everything that has been learned since: lights and materials sampled together.
    Path,
    /// The same without asking lights wisely: a check of `Path`.
    SimplePath,
    /// Directions all around at each hit: a check of both.
    RandomWalk,
    /// Ambient occlusion.
    AmbientOcclusion {
        /// Whether directions are chosen by the cosine.
        cosine: bool,
    },
    /// Shading normals as colours.
    Normals,
    /// Distance from the eye along the view axis.
    Depth,
    /// Texture coordinates as colours.
    Uv,
    /// A colour for each shape.
    Id,
}

impl Integrator {
    /// The words for them, in scene files and on the command line.
    pub const WORDS: &'static [(&'static str, Self)] = &[
        ("path", Self::Path),
        ("whitted", Self::Whitted),
        ("raycast", Self::Raycast),
        ("simple_path", Self::SimplePath),
        ("random_walk", Self::RandomWalk),
        ("ambient_occlusion", Self::AmbientOcclusion { cosine: true }),
        ("normals", Self::Normals),
        ("depth", Self::Depth),
        ("uv", Self::Uv),
        ("id", Self::Id),
    ];

    /// Whether paths are followed from surface to surface by chance.
    pub fn is_path_traced(self) -> bool {
        matches!(self, Self::Path | Self::SimplePath | Self::RandomWalk)
    }

    /// Its word. Ambient occlusion has one for both of its ways to choose directions.
    pub fn word(self) -> &'static str {
        let spoken = match self {
            Self::AmbientOcclusion { .. } => Self::AmbientOcclusion { cosine: true },
            other => other,
        };
        word_of(Self::WORDS, spoken)
    }
}

/// The sample sequence.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sampler {
    /// Owen-scrambled Sobol' points.
    #[default]
    Sobol,
    /// Independent numbers.
    Independent,
}

impl Sampler {
    /// The words for them, in scene files and on the command line.
    pub const WORDS: &'static [(&'static str, Self)] =
        &[("sobol", Self::Sobol), ("independent", Self::Independent)];

    /// Its word.
    pub fn word(self) -> &'static str {
        word_of(Self::WORDS, self)
    }
}

/// The word for a value; every value has one.
fn word_of<T: PartialEq + Copy>(words: &[(&'static str, T)], value: T) -> &'static str {
    words.iter().find(|(_, of_word)| *of_word == value).map_or("?", |(word, _)| word)
}
