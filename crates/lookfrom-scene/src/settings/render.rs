//! Settings of the integrator, with their defaults.

use super::word_of;

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
    /// Whether media that fill space have no end where a ray meets nothing, as in pbrt and Mitsuba: only the light that lights infinitely far
    /// away send to a point comes from twice the radius of the scene. Otherwise the way of any ray that meets nothing, and of that light, ends
    /// after the distance of its origin from the middle of the scene and twice its radius.
    pub endless_media: bool,
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
            endless_media: false,
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
