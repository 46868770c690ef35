//! Where light comes from: each light can be sampled from a point.
//!
//! In radiometric units: a written intensity `I` of a point light is `π I` W/sr here, so that a white diffuse surface
//! (`k_d / π`) that faces it from a distance of 1 is seen with radiance `I` (the convention of `lookfrom_scene::light`).

mod area;
mod environment;

use glam::{DVec3, Vec3};
use lookfrom_bvh::Point;
use lookfrom_scene::light::Falloff;

use crate::spectrum::Spectrum;
use crate::surface::Surface;
use crate::texture::Textures;

pub use area::{AreaLight, LightForm, LightTriangle};
pub use environment::{Environment, Sky, SkyImage};

/// A light, ready to be sampled. Positions are in render space.
#[derive(Clone, Debug)]
pub enum Light {
    /// From a point to all sides.
    Point {
        /// Where.
        position: DVec3,
        /// W/sr.
        intensity: Spectrum,
        /// How it fades.
        falloff: Falloff,
    },
    /// From infinitely far.
    Distant {
        /// Toward the light, unit length.
        toward: Vec3,
        /// W/m² on a surface that faces it.
        irradiance: Spectrum,
    },
    /// From a point into a cone.
    Spot {
        /// Where.
        position: DVec3,
        /// The axis, away from the light, unit length.
        axis: Vec3,
        /// W/sr on the axis.
        intensity: Spectrum,
        /// Cosine of the angle beyond which it is dark.
        cos_outer: f32,
        /// Cosine of the angle up to which it is full.
        cos_inner: f32,
        /// How it fades.
        falloff: Falloff,
    },
    /// From a surface.
    Area(AreaLight),
    /// From all around.
    Environment(Environment),
}

/// One way that light reaches a point, if nothing stands in it.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Toward the light, unit length.
    pub wi: Vec3,
    /// Radiance that arrives (for a point light: intensity after fall-off; for a distant one: irradiance) …
    pub li: Spectrum,
    /// … to be divided by this density over solid angle (1 where there is only one direction).
    pub pdf: f32,
    /// What the shadow ray aims at.
    pub target: Target,
}

/// What a shadow ray aims at.
#[derive(Clone, Copy, Debug)]
pub enum Target {
    /// A point in space with no surface.
    Point(DVec3),
    /// A point of a surface with its outside normal: the shadow ray ends just before it.
    Surface(Point, DVec3),
    /// Infinitely far in the direction `wi`.
    Infinity,
}

impl Light {
    /// Whether its light comes from infinitely far.
    pub fn is_infinitely_far(&self) -> bool {
        matches!(self, Self::Distant { .. } | Self::Environment(_))
    }

    /// One way from the light to `surface`, or `None` where there is none. `u ∈ [0, 1)²`; `n` is the unit normal that the
    /// light is weighed with, so that light from all around can be sampled by the cosine to it.
    pub fn sample(
        &self,
        textures: &Textures,
        surface: &Surface,
        n: Vec3,
        u: [f32; 2],
    ) -> Option<LightSample> {
        let from = DVec3::from_array(surface.point.position);
        match self {
            Self::Point { position, intensity, falloff } => {
                let (wi, distance) = toward(from, *position)?;
                Some(LightSample {
                    wi,
                    li: *intensity * fade(*falloff, distance),
                    pdf: 1.0,
                    target: Target::Point(*position),
                })
            }
            Self::Distant { toward, irradiance } => {
                Some(LightSample { wi: *toward, li: *irradiance, pdf: 1.0, target: Target::Infinity })
            }
            Self::Spot { position, axis, intensity, cos_outer, cos_inner, falloff } => {
                let (wi, distance) = toward(from, *position)?;
                let cone = smooth_step(*cos_outer, *cos_inner, axis.dot(-wi));
                let li = *intensity * (fade(*falloff, distance) * cone);
                (cone > 0.0).then_some(LightSample { wi, li, pdf: 1.0, target: Target::Point(*position) })
            }
            Self::Area(light) => light.sample(textures, from, u),
            Self::Environment(environment) => environment.sample(textures, n, u),
        }
    }
}

/// The unit direction and the distance, or `None` between equal points.
fn toward(from: DVec3, to: DVec3) -> Option<(Vec3, f64)> {
    let distance = (to - from).length();
    (distance > 0.0).then(|| (((to - from) / distance).as_vec3(), distance))
}

fn fade(falloff: Falloff, distance: f64) -> f32 {
    match falloff {
        Falloff::None => 1.0,
        Falloff::Linear => (1.0 / distance) as f32,
        Falloff::Quadratic => (1.0 / (distance * distance)) as f32,
    }
}

/// 0 up to `low`, 1 from `high`, a cubic between.
fn smooth_step(low: f32, high: f32, x: f32) -> f32 {
    if x >= high {
        return 1.0;
    }
    let s = ((x - low) / (high - low)).clamp(0.0, 1.0);
    s * s * (3.0 - 2.0 * s)
}
