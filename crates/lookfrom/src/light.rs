//! Lights: sampling from a point, and densities.
//!
//! In radiometric units: a written intensity `I` of a point light is `π I` W/sr here, so that a white diffuse surface
//! (`k_d / π`) that faces it at a distance of 1 has radiance `I` (the convention of `lookfrom_scene::light`).

mod area;
mod choice;
mod cone;
pub(crate) mod derivation;
mod environment;
mod guide;
mod picture;
mod portal;
mod power;
mod scale;
mod tree;

#[cfg(test)]
mod tests;

use glam::{DVec3, Vec3};
use lookfrom_bvh::Point;
use lookfrom_scene::light::{Edge, Falloff};
use lookfrom_simd::{Float, Real, Simd, f32x8, prelude::*};

use crate::core::lanes::{LANES, by_lane};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::texture::{SpectralMode, SpectrumTexture, TexturePoint, Textures};
use cone::Cone;
use tree::LightBounds;

pub(crate) use area::LightMotion;
pub use area::{
    AreaLight, CurveLight, DiskLight, EmitterBounds, LightPoint, LightShape, MeshLight, PatchLight,
    QuadricLight,
};
pub(crate) use area::{AreaSamples, sample_area_lights};
pub use choice::{ChosenLight, LightChoice};
pub(crate) use environment::brightest_around;
pub use environment::{Environment, MapLayout, Sky, SkyImage};
pub use guide::Guide;
pub(crate) use guide::{GuidePoint, Query};
pub use picture::{Goniometric, Projection};
pub use portal::{Opening, Portal};
pub use scale::{Scale, Total};

/// A light, ready to be sampled. Positions are in render space.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Light {
    /// A point light, isotropic.
    Point {
        /// Its position.
        position: DVec3,
        /// W/sr.
        intensity: EmissionSpectrum,
        /// Attenuation with distance.
        falloff: Falloff,
    },
    /// A directional light, infinitely far away.
    Distant {
        /// Toward the light, unit length.
        toward: Vec3,
        /// W/m² on a surface that faces it.
        irradiance: EmissionSpectrum,
    },
    /// A spotlight.
    Spot {
        /// Its position.
        position: DVec3,
        /// The axis, away from the light, unit length.
        axis: DVec3,
        /// W/sr on the axis.
        intensity: EmissionSpectrum,
        /// Cosine of the angle beyond which it is dark.
        cos_outer: f64,
        /// Cosine of the angle up to which it has full intensity.
        cos_inner: f64,
        /// The fading between both angles.
        edge: Edge,
        /// Attenuation with distance.
        falloff: Falloff,
    },
    /// A point light that projects a picture into a rectangle.
    Projection(Projection),
    /// A point light whose intensity depends on direction.
    Goniometric(Goniometric),
    /// A surface that emits light.
    Area(AreaLight),
    /// An environment light.
    Environment(Environment),
}

/// The emission spectrum of a light: colour times scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissionSpectrum {
    /// The colour, of the type [`SpectrumType::Illuminant`](crate::shading::texture::SpectrumType::Illuminant).
    pub color: SpectrumTexture,
    /// Factor of the colour.
    pub scale: f32,
}

impl EmissionSpectrum {
    /// The emission at a point, in radiometric units.
    #[inline]
    pub fn at(&self, textures: &Textures, point: &TexturePoint, mode: &SpectralMode) -> Spectrum {
        textures.spectrum(&self.color, point, mode) * self.scale
    }

    /// The emission of a colour that is the same everywhere.
    pub fn even(&self, textures: &Textures, mode: &SpectralMode) -> Spectrum {
        self.at(textures, &TexturePoint::NOWHERE, mode)
    }

    /// The emission of eight samples, by colours that do not vary.
    #[inline(always)]
    pub(crate) fn even_lanes<S: Simd>(
        simd: S,
        textures: &Textures,
        of: &[&Self; LANES],
        modes: &[&SpectralMode; LANES],
    ) -> Spectrum<f32x8<S>> {
        let scale = f32x8::load_array(simd, by_lane!(lane => of[lane].scale));
        textures.constants(simd, &by_lane!(lane => &of[lane].color), modes) * scale
    }
}

/// The reference point that lights are sampled from.
#[derive(Clone, Copy, Debug)]
pub struct LightSampleContext {
    /// In render space.
    pub point: DVec3,
    /// Unit normal, with which the light is weighted; zero at a point of a medium, which light reaches from all sides alike.
    pub n: Vec3,
    /// The time while the shutter is open (0 … 1), for lights that move.
    pub time: f32,
}

/// A sample of a light as seen from a point, without visibility.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Toward the light, unit length.
    pub wi: Vec3,
    /// Incident radiance (for a point light: intensity after fall-off; for a distant one: irradiance) …
    pub li: Spectrum,
    /// … to be divided by this density over solid angle (1 where there is only one direction).
    pub pdf: f32,
    /// The target of the shadow ray.
    pub target: Target,
}

impl LightSample {
    /// The sample of a light at a point in space, which has only one direction.
    fn of_point(wi: Vec3, li: Spectrum, position: DVec3) -> Self {
        Self { wi, li, pdf: 1.0, target: Target::Point(position) }
    }
}

/// The target of a shadow ray.
#[derive(Clone, Copy, Debug)]
pub enum Target {
    /// A point in space with no surface.
    Point(DVec3),
    /// A point of a surface with its outward normal: the shadow ray ends just before it.
    Surface(Point, DVec3),
    /// Infinitely far away in the direction `wi`.
    Infinity,
}

/// Whether a light's density may be zero in directions from which light arrives, since BSDF sampling finds it (pbrt's
/// `allowIncompletePDFs`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IncompletePdf {
    /// Every direction from which light comes has a positive density.
    Forbidden,
    /// Directions of uniform, dim light are left to BSDF sampling.
    Allowed,
}

impl Light {
    /// Whether the light illuminates surfaces; otherwise it is only visible.
    pub fn illuminates(&self) -> bool {
        !matches!(self, Self::Environment(environment) if !environment.illuminates)
    }

    /// Whether the light comes from a single direction at any point: BSDF sampling cannot find it.
    pub fn is_delta(&self) -> bool {
        !matches!(self, Self::Area(_) | Self::Environment(_))
    }

    /// Whether the light needs to be sampled where BSDFs are sampled as well.
    fn is_sampled(&self) -> bool {
        match self {
            Self::Environment(environment) => environment.illuminates && environment.is_uneven(),
            Self::Area(light) => light.is_sampled(),
            _ => true,
        }
    }

    /// A sample of the light from a reference point; `None` if no light arrives. `u ∈ [0, 1)²`.
    pub fn sample(
        &self,
        textures: &Textures,
        at: &LightSampleContext,
        u: [f32; 2],
        mode: &SpectralMode,
        incomplete_pdf: IncompletePdf,
    ) -> Option<LightSample> {
        let from = at.point;
        match self {
            Self::Point { position, intensity, falloff } => {
                let (wi, distance) = toward(from, *position)?;
                let li = intensity.even(textures, mode) * fade::<f32>(*falloff, distance);
                Some(LightSample::of_point(wi, li, *position))
            }
            Self::Distant { toward, irradiance } => {
                let li = irradiance.even(textures, mode);
                Some(LightSample { wi: *toward, li, pdf: 1.0, target: Target::Infinity })
            }
            Self::Spot { position, axis, intensity, cos_outer, cos_inner, edge, falloff } => {
                let (wi, distance) = toward(from, *position)?;
                let cone = in_cone(*edge, [*cos_outer, *cos_inner], cos_to_axis(from, *position, *axis));
                if cone <= 0.0 {
                    return None;
                }
                let li = intensity.even(textures, mode) * (fade::<f32>(*falloff, distance) * cone);
                Some(LightSample::of_point(wi, li, *position))
            }
            Self::Projection(projection) => projection.sample(textures, from, mode),
            Self::Goniometric(goniometric) => goniometric.sample(textures, from, mode),
            Self::Area(light) => match light.place_at(at.time) {
                None => light.sample(textures, from, u, mode),
                Some(place) => place.sample(from, |from| light.sample(textures, from, u, mode)),
            },
            Self::Environment(environment) => environment.sample(textures, at, u, mode, incomplete_pdf),
        }
    }

    /// The solid angle density of a unit direction in [`Light::sample`]. A ray in that direction hit this light at
    /// `surface` (`None` for an environment).
    pub fn pdf(
        &self,
        at: &LightSampleContext,
        wi: Vec3,
        surface: Option<&SurfaceInteraction>,
        incomplete_pdf: IncompletePdf,
    ) -> f32 {
        match (self, surface) {
            (Self::Area(light), Some(surface)) => match light.place_at(at.time) {
                None => light.pdf(at.point, surface, wi),
                Some(place) => {
                    place.pdf(at.point, surface, wi, |from, surface, wi| light.pdf(from, surface, wi))
                }
            },
            (Self::Environment(environment), None) => environment.pdf(at, wi, incomplete_pdf),
            _ => 0.0,
        }
    }

    /// The bounds of the light in a light tree, with its `power` in any unit; `None` for lights infinitely far away.
    fn bounds(&self, power: f32) -> Option<LightBounds> {
        let at_point = |position: &DVec3, normals: Cone, rim: f32| LightBounds {
            min: position.as_vec3(),
            max: position.as_vec3(),
            normals,
            cos_emission: libm::cosf(rim),
            two_sided: false,
            power,
        };
        // Slightly wider than the exact angles, so that rounding leaves no rim dark.
        const SLACK: f32 = 1e-3;
        const WIDEST_RIM: f32 = std::f32::consts::FRAC_PI_2;
        Some(match self {
            Self::Point { position, .. } | Self::Goniometric(Goniometric { position, .. }) => {
                at_point(position, Cone::ALL, WIDEST_RIM)
            }
            Self::Projection(light) => {
                let rim = cone::angle(light.cos_corner()) + SLACK;
                let axis = light.axis.as_vec3();
                at_point(&light.position, Cone { axis, cos: 1.0 }, rim.min(WIDEST_RIM))
            }
            Self::Spot { position, axis, cos_outer, cos_inner, .. } => {
                let [outer, inner] = [cos_outer, cos_inner].map(|cos| cone::angle(*cos as f32));
                // The importance takes the cosine of the angle to the cone for the fall-off; it must not reach 0 within
                // it.
                let rim = (outer - inner + SLACK).min(WIDEST_RIM - 0.25);
                let cos = libm::cosf((outer + SLACK - rim).clamp(0.0, std::f32::consts::PI));
                at_point(position, Cone { axis: axis.as_vec3(), cos }, rim)
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
    let (wi, distance) = ways::<f32>(from.into(), to.into());
    (distance > 0.0).then(|| (wi.into(), distance))
}

/// Unit directions and distances; NaN between equal points.
#[inline(always)]
pub(crate) fn ways<R: Real>(from: Vector<R::Double>, to: Vector<R::Double>) -> (Vector<R>, R::Double) {
    let way = to - from;
    let distance = way.length();
    let wi = Vector { x: way.x / distance, y: way.y / distance, z: way.z / distance };
    (Vector::narrow(wi), distance)
}

/// The attenuation of a light at a distance.
#[inline(always)]
pub(crate) fn fade<R: Real>(falloff: Falloff, distance: R::Double) -> R {
    let one = Float::like(distance, 1.0);
    R::narrow(match falloff {
        Falloff::None => one,
        Falloff::Linear => one / distance,
        Falloff::Quadratic => one / (distance * distance),
    })
}

/// The cosine between the way to a point from a light at `position` and its axis; in double precision, since the cosines of a laser's
/// cone differ from 1 by less than the rounding of an f32.
fn cos_to_axis(from: DVec3, position: DVec3, axis: DVec3) -> f64 {
    (from - position).normalize().dot(axis)
}

/// The factor of a spot light by the cosine of the angle to its axis: 0 outside of its cone, 1 within the inner one.
fn in_cone(edge: Edge, [cos_outer, cos_inner]: [f64; 2], cos: f64) -> f32 {
    let factor = match edge {
        Edge::Smooth => smooth_step(cos_outer, cos_inner, cos),
        Edge::Linear if cos >= cos_inner => 1.0,
        Edge::Linear if cos <= cos_outer => 0.0,
        Edge::Linear => {
            let [outer, inner, angle] = [cos_outer, cos_inner, cos].map(libm::acos);
            (outer - angle) / (outer - inner)
        }
    };
    factor as f32
}

/// 0 up to `low`, 1 from `high`, a cubic between.
fn smooth_step(low: f64, high: f64, x: f64) -> f64 {
    if x >= high {
        return 1.0;
    }
    let s = ((x - low) / (high - low)).clamp(0.0, 1.0);
    s * s * (3.0 - 2.0 * s)
}
