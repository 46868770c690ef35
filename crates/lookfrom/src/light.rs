//! Lights: samples as seen from a point, and their densities.
//!
//! In radiometric units: a written intensity `I` of a point light is `π I` W/sr here, so that a white diffuse surface
//! (`k_d / π`) that faces it from a distance of 1 is seen with radiance `I` (the convention of `lookfrom_scene::light`).

mod area;
mod choice;
mod cone;
mod environment;
mod picture;
mod portal;
mod tree;

#[cfg(test)]
mod tests;

use glam::{DVec3, Vec3};
use lookfrom_bvh::Point;
use lookfrom_scene::light::Falloff;

use crate::core::spectrum::Spectrum;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::texture::{SpectralMode, SpectrumTexture, TexturePoint, Textures};
use cone::Cone;
use tree::LightBounds;

pub(crate) use area::LightTriangle;
pub use area::{AreaLight, EmitterBounds, LightPoint, LightShape, MeshLight, PatchLight, QuadricLight};
pub use choice::LightChoice;
pub use environment::{Environment, Layout, Sky, SkyImage};
pub use picture::{Goniometric, Projection};
pub use portal::{Opening, Portal};

/// A light, ready to be sampled. Positions are in render space.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Light {
    /// From a point to all sides.
    Point {
        /// Where.
        position: DVec3,
        /// W/sr.
        intensity: EmissionSpectrum,
        /// How it fades.
        falloff: Falloff,
    },
    /// From infinitely far.
    Distant {
        /// Toward the light, unit length.
        toward: Vec3,
        /// W/m² on a surface that faces it.
        irradiance: EmissionSpectrum,
    },
    /// From a point into a cone.
    Spot {
        /// Where.
        position: DVec3,
        /// The axis, away from the light, unit length.
        axis: Vec3,
        /// W/sr on the axis.
        intensity: EmissionSpectrum,
        /// Cosine of the angle beyond which it is dark.
        cos_outer: f32,
        /// Cosine of the angle up to which it is full.
        cos_inner: f32,
        /// How it fades.
        falloff: Falloff,
    },
    /// From a point, a picture thrown into a rectangle.
    Projection(Projection),
    /// From a point, more or less by direction.
    Goniometric(Goniometric),
    /// From a surface.
    Area(AreaLight),
    /// From all around.
    Environment(Environment),
}

/// The colour of a light and how much there is of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissionSpectrum {
    /// Of the type [`SpectrumType::Illuminant`](crate::shading::texture::SpectrumType::Illuminant).
    pub color: SpectrumTexture,
    /// Multiplies it.
    pub scale: f32,
}

impl EmissionSpectrum {
    /// The light at a point, in radiometric units.
    #[inline]
    pub fn at(&self, textures: &Textures, point: &TexturePoint, lanes: &SpectralMode) -> Spectrum {
        textures.spectrum(&self.color, point, lanes) * self.scale
    }

    /// The light of a colour that is the same everywhere.
    pub fn even(&self, textures: &Textures, lanes: &SpectralMode) -> Spectrum {
        self.at(textures, &TexturePoint::NOWHERE, lanes)
    }
}

/// Where light arrives.
#[derive(Clone, Copy, Debug)]
pub struct LightSampleContext {
    /// In render space.
    pub point: DVec3,
    /// The unit normal that the light is weighed with.
    pub n: Vec3,
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

impl LightSample {
    /// The one direction to a light at a point in space.
    fn of_point(wi: Vec3, li: Spectrum, position: DVec3) -> Self {
        Self { wi, li, pdf: 1.0, target: Target::Point(position) }
    }
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

/// Whether lights are sampled alone or beside materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IncompletePdf {
    /// Every direction from which light comes may be chosen.
    Forbidden,
    /// Directions of even, dim light are left to the sampling of materials.
    Allowed,
}

impl Light {
    /// Whether surfaces are lit by it; otherwise it is only seen.
    pub fn illuminates(&self) -> bool {
        !matches!(self, Self::Environment(environment) if !environment.illuminates)
    }

    /// Whether it has one direction only at any place: no direction chosen otherwise finds it.
    pub fn is_delta(&self) -> bool {
        !matches!(self, Self::Area(_) | Self::Environment(_))
    }

    /// Whether it needs to be sampled where BSDFs are sampled as well.
    fn is_sampled(&self) -> bool {
        match self {
            Self::Environment(environment) => environment.illuminates && environment.is_uneven(),
            Self::Area(light) => light.is_sampled(),
            _ => true,
        }
    }

    /// One way from the light to a place, or `None` where there is none. `u ∈ [0, 1)²`.
    pub fn sample(
        &self,
        textures: &Textures,
        at: &LightSampleContext,
        u: [f32; 2],
        lanes: &SpectralMode,
        incomplete_pdf: IncompletePdf,
    ) -> Option<LightSample> {
        let from = at.point;
        match self {
            Self::Point { position, intensity, falloff } => {
                let (wi, distance) = toward(from, *position)?;
                let li = intensity.even(textures, lanes) * fade(*falloff, distance);
                Some(LightSample::of_point(wi, li, *position))
            }
            Self::Distant { toward, irradiance } => {
                let li = irradiance.even(textures, lanes);
                Some(LightSample { wi: *toward, li, pdf: 1.0, target: Target::Infinity })
            }
            Self::Spot { position, axis, intensity, cos_outer, cos_inner, falloff } => {
                let (wi, distance) = toward(from, *position)?;
                let cone = smooth_step(*cos_outer, *cos_inner, axis.dot(-wi));
                if cone <= 0.0 {
                    return None;
                }
                let li = intensity.even(textures, lanes) * (fade(*falloff, distance) * cone);
                Some(LightSample::of_point(wi, li, *position))
            }
            Self::Projection(projection) => projection.sample(textures, from, lanes),
            Self::Goniometric(goniometric) => goniometric.sample(textures, from, lanes),
            Self::Area(light) => light.sample(textures, from, u, lanes),
            Self::Environment(environment) => environment.sample(textures, at, u, lanes, incomplete_pdf),
        }
    }

    /// The density over solid angle with which [`Light::sample`] chooses a unit direction at a place, in which a ray met
    /// this light: at `surface`, or nowhere for an environment.
    pub fn pdf(
        &self,
        at: &LightSampleContext,
        wi: Vec3,
        surface: Option<&SurfaceInteraction>,
        incomplete_pdf: IncompletePdf,
    ) -> f32 {
        match (self, surface) {
            (Self::Area(light), Some(surface)) => light.pdf(at.point, surface, wi),
            (Self::Environment(environment), None) => environment.pdf(at, wi, incomplete_pdf),
            _ => 0.0,
        }
    }

    /// How much it sends out where its radiance (or intensity) is 1, roughly; `radius` is that of the scene.
    fn power_per_brightness(&self, radius: f32) -> f64 {
        use std::f64::consts::PI;
        match self {
            Self::Point { .. } | Self::Goniometric(_) | Self::Spot { .. } => 4.0 * PI,
            Self::Projection(_) => 1.0,
            Self::Area(light) => PI * light.area(),
            Self::Environment(Environment { portal: Some(portal), .. }) => PI * portal.area(),
            Self::Distant { .. } => PI * f64::from(radius) * f64::from(radius),
            Self::Environment(_) => 4.0 * PI * PI * f64::from(radius) * f64::from(radius),
        }
    }

    /// Where it stands and how much it sends out: `power`, in any unit; `None` for lights infinitely far.
    fn bounds(&self, power: f32) -> Option<LightBounds> {
        let at_point = |position: &DVec3, normals: Cone, rim: f32| LightBounds {
            min: position.as_vec3(),
            max: position.as_vec3(),
            normals,
            cos_emission: libm::cosf(rim),
            two_sided: false,
            power,
        };
        // Slightly wider than they are, so that rounding leaves no rim in the dark.
        const SLACK: f32 = 1e-3;
        const WIDEST_RIM: f32 = std::f32::consts::FRAC_PI_2;
        Some(match self {
            Self::Point { position, .. } | Self::Goniometric(Goniometric { position, .. }) => {
                at_point(position, Cone::ALL, WIDEST_RIM)
            }
            Self::Projection(light) => {
                let rim = cone::angle(light.cos_corner()) + SLACK;
                at_point(&light.position, Cone { axis: light.axis(), cos: 1.0 }, rim.min(WIDEST_RIM))
            }
            Self::Spot { position, axis, cos_outer, cos_inner, .. } => {
                let [outer, inner] = [cos_outer, cos_inner].map(|cos| cone::angle(*cos));
                // The cosine to the cone stands for the fall-off, and must not get to 0 within it.
                let rim = (outer - inner + SLACK).min(WIDEST_RIM - 0.25);
                let cos = libm::cosf((outer + SLACK - rim).clamp(0.0, std::f32::consts::PI));
                at_point(position, Cone { axis: *axis, cos }, rim)
            }
            Self::Area(light) => {
                let extent = light.emitter_bounds();
                LightBounds {
                    min: extent.min.as_vec3(),
                    max: extent.max.as_vec3(),
                    normals: Cone { axis: extent.axis, cos: extent.cos_normals },
                    cos_emission: 0.0,
                    two_sided: extent.two_sided,
                    power,
                }
            }
            Self::Distant { .. } | Self::Environment(_) => return None,
        })
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
