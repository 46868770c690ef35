//! The scattering at a vertex of a sample, over the sphere of directions: the balloon of the view in 3D.

use std::f32::consts::PI;

use glam::{DVec3, Vec3};
use lookfrom::core::math::luminance;
use lookfrom::integrator::Event;
use lookfrom::render::{Renderer, SampleId};
use lookfrom::shading::interaction::SurfaceInteraction;
use lookfrom_scene::Result;

use crate::message::LobeAnswer;
use crate::view::refused;

/// Rings of directions, from the normal to its opposite.
const RINGS: usize = 32;

/// Directions of a ring.
const OF_RING: usize = 64;

/// The answer for the vertex where the ray of an address arrives.
///
/// # Errors
/// `Request` where there is no such vertex, or one that only mirrors and refracts.
pub(crate) fn answer(renderer: &Renderer, request: u64, id: SampleId, address: u64) -> Result<LobeAnswer> {
    let mut events = Vec::new();
    let (traced, _) = renderer.trace_events(&[id], &mut events);
    let mode = traced[0].mode;
    let vertex = events.iter().find_map(|event| Balloon::of(event, address));
    let Some(balloon) = vertex else {
        return Err(refused(format!("ray {address} of this sample meets no surface that scatters")));
    };
    let surface = balloon.surface();
    let chosen = events.iter().find_map(|event| match event {
        Event::Bounced { address: of, bounce } if *of == address => Some(bounce.wi.to_array()),
        _ => None,
    });
    let normal = balloon.normal();
    let tangents = normal.any_orthonormal_pair();
    let directions: Vec<Vec3> = (0..RINGS).flat_map(|ring| of_ring(ring, normal, tangents)).collect();
    let values = balloon.values(&directions, |light| luminance(renderer.rgb(light, &mode)));
    let point = DVec3::from_array(surface.point.position) + renderer.world().origin();
    Ok(LobeAnswer {
        id: request,
        address,
        point: point.into(),
        normal: normal.into(),
        wi: surface.wo.into(),
        chosen,
        theta: RINGS,
        phi: OF_RING,
        values,
        directions: directions.iter().map(Vec3::to_array).collect(),
    })
}

/// The directions at one angle to the normal.
fn of_ring(ring: usize, normal: Vec3, (x, y): (Vec3, Vec3)) -> impl Iterator<Item = Vec3> {
    let (sin, cos) = (PI * (ring as f32 + 0.5) / RINGS as f32).sin_cos();
    (0..OF_RING).map(move |number| {
        let (across, along) = (2.0 * PI * number as f32 / OF_RING as f32).sin_cos();
        (sin * (along * x + across * y) + cos * normal).normalize()
    })
}

/// The scattering at a vertex.
enum Balloon<'a> {
    /// A BSDF.
    Bsdf(&'a SurfaceInteraction, &'a lookfrom::shading::material::Shading),
    /// `k_d (N·L) + k_s (N·H)ⁿ`.
    Whitted(&'a SurfaceInteraction, &'a lookfrom::shading::bsdf::whitted::WhittedCoefficients),
}

impl<'a> Balloon<'a> {
    fn of(event: &'a Event, wanted: u64) -> Option<Self> {
        match event {
            Event::Shaded { address, surface, shading, .. } if *address == wanted => {
                Some(Self::Bsdf(surface, shading))
            }
            Event::Surface { address, surface, coefficients: Some(coefficients) } if *address == wanted => {
                Some(Self::Whitted(surface, coefficients))
            }
            _ => None,
        }
    }

    fn surface(&self) -> &'a SurfaceInteraction {
        match self {
            Self::Bsdf(surface, _) | Self::Whitted(surface, _) => surface,
        }
    }

    fn normal(&self) -> Vec3 {
        match self {
            Self::Bsdf(_, shading) => shading.n(),
            Self::Whitted(surface, _) => surface.ns_facing(),
        }
    }

    /// The luminance of what is scattered from each direction, with the cosine.
    fn values(
        &self,
        directions: &[Vec3],
        luminance: impl Fn(lookfrom::core::spectrum::Spectrum) -> f32,
    ) -> Vec<f32> {
        match *self {
            Self::Bsdf(surface, shading) => {
                let f = shading.f_toward(surface.wo);
                directions.iter().map(|wi| luminance(f(*wi) * shading.cos(*wi).abs())).collect()
            }
            Self::Whitted(surface, coefficients) => {
                let n = surface.ns_facing();
                let value = |wi: &Vec3| {
                    let (cos, half) = (n.dot(*wi), (*wi + surface.wo).normalize_or_zero());
                    let highlight = n.dot(half).max(0.0).powf(coefficients.shininess);
                    match cos > 0.0 {
                        true => luminance(coefficients.diffuse * cos + coefficients.specular * highlight),
                        false => 0.0,
                    }
                };
                directions.iter().map(value).collect()
            }
        }
    }
}
