//! The light of one source at eight points, without occlusion: as `Light::sample` has it.

use std::f32::consts::PI;

use lookfrom_simd::{Float, Real, Simd, f32x8, f64x8, mask32x8, prelude::*};

use super::coefficients::Modes;
use crate::core::lanes::LANES;
use crate::core::points::Points;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::integrator::sample_streams::SampleStreams;
use crate::light::{AreaLight, Light, fade, sample_area_lights};
use crate::world::World;

/// Light that arrives at eight points.
pub(super) struct Arriving<S: Simd> {
    /// Toward the source, of unit length.
    pub(super) wi: Vector<f32x8<S>>,
    /// I_j of the notes: radiance over π and over the density of the direction.
    pub(super) li: Spectrum<f32x8<S>>,
    /// The lanes at which light arrives.
    pub(super) exists: mask32x8<S>,
    /// Where shadow rays end.
    pub(super) target: Ends<S>,
}

/// The ends of shadow rays.
pub(super) enum Ends<S: Simd> {
    /// The source is infinitely far away.
    Nowhere,
    /// Points in space.
    Points(Vector<f64x8<S>>),
    /// Points of surfaces, with their normals.
    Surfaces(Points<f32x8<S>>, Vector<f64x8<S>>),
}

impl<S: Simd> Arriving<S> {
    /// The light of a source; `None` for kinds that are not sampled in lanes. `streams` has the random numbers where the
    /// source needs some.
    #[inline(always)]
    pub(super) fn from(
        simd: S,
        (source, index): (&Light, u32),
        world: &World,
        streams: impl FnOnce() -> SampleStreams<S>,
        points: Vector<f64x8<S>>,
        modes: &Modes<'_>,
    ) -> Option<Self> {
        let pi = f32x8::splat(simd, PI);
        match source {
            Light::Point { position, intensity, falloff } => {
                let position = Vector::splat(points.x, position.to_array());
                let way = position - points;
                let distance = way.length();
                let wi = Vector { x: way.x / distance, y: way.y / distance, z: way.z / distance };
                let intensity = modes.emission(simd, world, intensity);
                Some(Self {
                    wi: Vector::narrow(wi),
                    li: intensity * fade::<f32x8<S>>(*falloff, distance) / pi,
                    exists: pi.narrow_mask(distance.gt(f64x8::splat(simd, 0.0))),
                    target: Ends::Points(position),
                })
            }
            Light::Distant { toward, irradiance } => Some(Self {
                wi: Vector::splat(pi, toward.to_array()),
                li: modes.emission(simd, world, irradiance) / pi,
                exists: mask32x8::splat(simd, true),
                target: Ends::Nowhere,
            }),
            Light::Area(light) => {
                Self::from_area(simd, light, world, streams().two_with_pixel(index), points, modes)
            }
            _ => None,
        }
    }

    #[inline(always)]
    fn from_area(
        simd: S,
        light: &AreaLight,
        world: &World,
        u: [f32x8<S>; 2],
        points: Vector<f64x8<S>>,
        modes: &Modes<'_>,
    ) -> Option<Self> {
        let (samples, in_lanes) = sample_area_lights(simd, &[Some(light); LANES], u, points);
        let samples = samples?;
        let li = modes.emission(simd, world, &light.radiance);
        let is_front = samples.normal.dot(samples.wi.widen()).lt(f64x8::splat(simd, 0.0));
        let mut exists = samples.is_valid & !li.is_black() & mask32x8::from_bitmask(simd, in_lanes.into());
        if !light.two_sided {
            exists &= samples.pdf.narrow_mask(is_front);
        }
        Some(Self {
            wi: samples.wi,
            li: li / (samples.pdf * PI),
            exists,
            target: Ends::Surfaces(samples.points, samples.normal),
        })
    }
}
