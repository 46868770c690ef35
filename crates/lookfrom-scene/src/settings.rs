//! Settings of the image and of the integrator, with their defaults.

mod spectral_film;

pub use self::spectral_film::{Band, SpectralFilm};

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

impl ImageSettings {
    /// A picture of another size with the light alone: whole, without AOVs, layers and denoising.
    #[must_use]
    pub fn of_light(&self, width: u32, height: u32) -> Self {
        Self { width, height, crop: None, denoise: false, ..self.clone() }.without_layers()
    }

    /// The same picture, with no layers of an EXR beside it.
    #[must_use]
    pub fn without_layers(self) -> Self {
        let spectral_film = self.spectral_film.as_ref().map(SpectralFilm::of_picture);
        Self { layers: Layers::None, light_paths: Vec::new(), spectral_film, ..self }
    }
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

/// The pixel reconstruction filter: along each axis one curve, which ends at the radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filter {
    /// The curve.
    pub shape: FilterShape,
    /// Its radius in pixels along x and y: > 0.
    pub radius: [f32; 2],
}

/// The curve of a filter along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FilterShape {
    /// A constant. With a radius of half a pixel it covers exactly the pixel.
    Box,
    /// A tent function.
    Triangle,
    /// A Gaussian, shifted down so that it is 0 at the radius.
    Gaussian {
        /// Standard deviation in pixels: > 0.
        sigma: f32,
    },
    /// Mitchell & Netravali 1988, with its parameters B and C.
    Mitchell {
        /// B: blurring.
        b: f32,
        /// C: ringing.
        c: f32,
    },
    /// The four-term Blackman–Harris window.
    BlackmanHarris,
    /// A sinc, under the central lobe of a wider one (Lanczos): sharp, with ringing.
    Sinc {
        /// Half the width of the wider one in pixels: > 0.
        tau: f32,
    },
}

impl FilterShape {
    /// The filter with the same radius along both axes.
    pub const fn of_radius(self, radius: f32) -> Filter {
        Filter { shape: self, radius: [radius; 2] }
    }

    /// The word for this shape.
    pub fn word(self) -> &'static str {
        match self {
            Self::Box => "box",
            Self::Triangle => "triangle",
            Self::Gaussian { .. } => "gaussian",
            Self::Mitchell { .. } => "mitchell",
            Self::BlackmanHarris => "blackman_harris",
            Self::Sinc { .. } => "sinc",
        }
    }

    /// The names and values of its parameters.
    pub fn parameters(self) -> Vec<(&'static str, f32)> {
        match self {
            Self::Box | Self::Triangle | Self::BlackmanHarris => Vec::new(),
            Self::Gaussian { sigma } => vec![("sigma", sigma)],
            Self::Mitchell { b, c } => vec![("b", b), ("c", c)],
            Self::Sinc { tau } => vec![("tau", tau)],
        }
    }
}

impl Filter {
    /// The words for the filters, in scene files and on the command line, with their default radii and parameters.
    pub const WORDS: &'static [(&'static str, Self)] = &[
        ("box", FilterShape::Box.of_radius(0.5)),
        ("triangle", FilterShape::Triangle.of_radius(1.0)),
        ("gaussian", FilterShape::Gaussian { sigma: 0.5 }.of_radius(1.5)),
        ("mitchell", FilterShape::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }.of_radius(2.0)),
        ("blackman_harris", FilterShape::BlackmanHarris.of_radius(1.5)),
        ("sinc", FilterShape::Sinc { tau: 3.0 }.of_radius(4.0)),
    ];
}

/// `name:radius`, or `name:x:y` where the radii differ, and further parameters.
impl std::fmt::Display for Filter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [x, y] = self.radius;
        write!(f, "{}:{x}", self.shape.word())?;
        if x != y {
            write!(f, ":{y}")?;
        }
        self.shape.parameters().into_iter().try_for_each(|(name, value)| write!(f, " {name} {value}"))
    }
}

impl Default for Filter {
    fn default() -> Self {
        FilterShape::BlackmanHarris.of_radius(1.5)
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

/// The integrator and its settings.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderSettings {
    /// The integrator.
    pub integrator: Integrator,
    /// Samples per pixel, in the mean: ≥ 1.
    pub samples: u32,
    /// The allocation of the samples to the pixels.
    pub allocation: Allocation,
    /// The maximum path depth: the number of reflections, refractions and scatterings.
    pub depth: u32,
    /// Minimum throughput of a branch of the ray tree; branches below it are cut off (Whitted's adaptive depth control).
    pub min_contribution: f32,
    /// The sample sequence.
    pub sampler: Sampler,
    /// The seed of the random numbers.
    pub seed: u64,
    /// Whether shadow rays pass straight through transparent objects, tinted by them.
    pub transparent_shadows: bool,
    /// The meaning of the four lanes of a spectrum: RGB or wavelengths.
    pub color: ColorMode,
    /// The light sampler: the choice of one light of many.
    pub light_sampler: LightSampler,
    /// The openings through which path tracing samples an environment.
    pub portals: Portals,
    /// Whether the path tracer roughens BSDFs after the first diffuse bounce (regularization): less noise, but biased.
    pub regularize: bool,
    /// The maximum distance of ambient occlusion.
    pub occlusion_distance: f32,
    /// Whether media are rendered: those on the sides of surfaces ([`Sides`](crate::medium::Sides)) and around the camera.
    /// Otherwise interfaces block shadow rays, but no others, as in pbrt's integrators without media. Absorption inside
    /// materials is always rendered.
    pub media: bool,
    /// Whether passing straight through a thin dielectric counts for the depth of a path, as in pbrt; in Mitsuba's integrators of media it
    /// does not.
    pub thin_passages_count: bool,
    /// Whether half of the light passes single-sided surfaces from their fronts, where most of what is seen of the scene from
    /// outside are their backs: rooms and domes that the camera looks into from outside.
    pub open_fronts: bool,
    /// Whether the camera sees no shapes that emit light, directly or through what is passed without counting for the depth. Reflections and
    /// shadows of them remain.
    pub hide_lights: bool,
}

/// The allocation of a picture's samples to its pixels (of strata: Neyman 1934).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Allocation {
    /// Each pixel gets the same number.
    #[default]
    Uniform,
    /// Half of them evenly, the other half where the first has shown noise: adaptive sampling without bias.
    Adaptive,
}

impl Allocation {
    /// The words for the allocations, in scene files and on the command line.
    pub const WORDS: &'static [(&'static str, Self)] =
        &[("uniform", Self::Uniform), ("adaptive", Self::Adaptive)];

    /// The word for this allocation.
    pub fn word(self) -> &'static str {
        word_of(Self::WORDS, self)
    }
}

/// The meaning of the four lanes of a spectrum: RGB or wavelengths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorMode {
    /// Linear Rec. 709.
    #[default]
    Rgb,
    /// Four wavelengths, sampled anew for each camera ray.
    Spectral,
}

impl ColorMode {
    /// The words for the modes, in scene files and on the command line.
    pub const WORDS: &'static [(&'static str, Self)] = &[("rgb", Self::Rgb), ("spectral", Self::Spectral)];

    /// The word for this mode.
    pub fn word(self) -> &'static str {
        word_of(Self::WORDS, self)
    }
}

/// The openings through which path tracing samples an environment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Portals {
    /// The portals that environment lights name.
    #[default]
    Named,
    /// Those, and without one the directions in which a pre-pass has seen the environment from the places that paths visit.
    Auto,
}

impl Portals {
    /// The words for the choices, in scene files and on the command line.
    pub const WORDS: &'static [(&'static str, Self)] = &[("named", Self::Named), ("auto", Self::Auto)];

    /// The word for this choice.
    pub fn word(self) -> &'static str {
        word_of(Self::WORDS, self)
    }
}

/// The light sampler: the choice of one light of many.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightSampler {
    /// With equal probabilities.
    Uniform,
    /// By emitted power.
    Power,
    /// By importance at the shaded point, in a light BVH (Conty Estevez & Kulla 2018).
    #[default]
    Bvh,
}

impl LightSampler {
    /// The words for the light samplers, in scene files and on the command line.
    pub const WORDS: &'static [(&'static str, Self)] =
        &[("uniform", Self::Uniform), ("power", Self::Power), ("bvh", Self::Bvh)];

    /// The word for this light sampler.
    pub fn word(self) -> &'static str {
        word_of(Self::WORDS, self)
    }
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self {
            integrator: Integrator::Whitted,
            samples: 16,
            allocation: Allocation::Uniform,
            depth: 8,
            min_contribution: 1.0 / 512.0,
            sampler: Sampler::Sobol,
            seed: 0,
            transparent_shadows: true,
            color: ColorMode::Rgb,
            light_sampler: LightSampler::Bvh,
            portals: Portals::default(),
            regularize: false,
            occlusion_distance: f32::INFINITY,
            media: true,
            thin_passages_count: true,
            open_fronts: false,
            hide_lights: false,
        }
    }
}

/// The integrators.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integrator {
    /// Appel 1968: the nearest surface, local shading, one shadow ray to each light.
    Raycast,
    /// Whitted 1980: recursive ray tracing.
    #[default]
    Whitted,
    /// Path tracing (Kajiya 1986) with next-event estimation and multiple importance sampling.
    Path,
    /// Path tracing with next-event estimation alone, without multiple importance sampling: a check of `Path`.
    SimplePath,
    /// Path tracing with uniformly sampled directions, without light sampling: a check of both.
    RandomWalk,
    /// Ambient occlusion.
    AmbientOcclusion {
        /// Whether directions are cosine-weighted.
        cosine: bool,
    },
    /// Shading normals as colours.
    Normals,
    /// Distance from the camera along the view axis.
    Depth,
    /// Texture coordinates as colours.
    Uv,
    /// A colour for each shape.
    Id,
}

impl Integrator {
    /// Whether its pictures show the light of the scene's lights.
    pub fn needs_light(self) -> bool {
        matches!(self, Self::Raycast | Self::Whitted | Self::Path | Self::SimplePath | Self::RandomWalk)
    }

    /// The words for the integrators, in scene files and on the command line.
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

    /// Whether paths are sampled stochastically.
    pub fn is_path_traced(self) -> bool {
        matches!(self, Self::Path | Self::SimplePath | Self::RandomWalk)
    }

    /// The word for this integrator. Ambient occlusion has one for both of its ways to sample directions.
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
    /// Independent random numbers.
    Independent,
}

impl Sampler {
    /// The words for the samplers, in scene files and on the command line.
    pub const WORDS: &'static [(&'static str, Self)] =
        &[("sobol", Self::Sobol), ("independent", Self::Independent)];

    /// The word for this sampler.
    pub fn word(self) -> &'static str {
        word_of(Self::WORDS, self)
    }
}

/// The word for a value; every value has one.
fn word_of<T: PartialEq + Copy>(words: &[(&'static str, T)], value: T) -> &'static str {
    words.iter().find(|(_, of_word)| *of_word == value).map_or("?", |(word, _)| word)
}
