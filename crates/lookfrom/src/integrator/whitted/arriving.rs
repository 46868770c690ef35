//! The light of one source at points, without occlusion: [`LightSample`] at any width.

use lookfrom_bvh::Point;
use lookfrom_simd::{Float, Real, Simd, f32x8, f64x8, mask32x8, prelude::*};

use super::coefficients::Modes;
use crate::core::lanes::{
    LANES, bitmask, by_lane, gather, gather_f64, gather_spectrum, scatter, scatter_f64,
};
use crate::core::points::Points;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::light::{
    AreaLight, IncompletePdf, Light, LightSample, LightSampleContext, Target, fade, sample_area_lights, ways,
};
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// Light that arrives at points.
#[derive(Clone, Copy)]
pub(super) struct Arriving<R: Real> {
    /// Toward the source, of unit length.
    pub(super) wi: Vector<R>,
    /// As [`LightSample::li`].
    pub(super) li: Spectrum<R>,
    /// As [`LightSample::pdf`].
    pub(super) pdf: R,
    /// The lanes at which light arrives.
    pub(super) exists: R::Mask,
    /// As [`LightSample::target`].
    pub(super) target: Targets<R>,
}

/// The ends of shadow rays: [`Target`] at any width.
#[derive(Clone, Copy)]
pub(super) enum Targets<R: Real> {
    /// The source is infinitely far away.
    Infinity,
    /// Points in space.
    Points(Vector<R::Double>),
    /// Points of surfaces, with their normals.
    Surfaces(Points<R>, Vector<R::Double>),
}

/// Points at which the light of a source arrives.
pub(super) struct Destination<'a, R: Real> {
    pub(super) world: &'a World,
    pub(super) points: Vector<R::Double>,
    /// Shading normals, on the side of the rays.
    pub(super) n: Vector<R>,
}

/// Whether the points on a source are sampled at random.
pub(super) fn is_random(light: &Light) -> bool {
    light.illuminates() && !light.is_delta()
}

impl Arriving<f32> {
    /// The light of a source at one point, if any arrives.
    pub(super) fn at_one(
        at: &Destination<'_, f32>,
        source: &Light,
        u: [f32; 2],
        mode: &SpectralMode,
    ) -> Option<Self> {
        let context = LightSampleContext { point: at.points.into(), n: at.n.into() };
        let sample = source.sample(&at.world.textures, &context, u, mode, IncompletePdf::Forbidden)?;
        let LightSample { wi, li, pdf, target } = sample;
        let target = match target {
            Target::Infinity => Targets::Infinity,
            Target::Point(position) => Targets::Points(position.into()),
            Target::Surface(Point { position, error }, normal) => {
                let points = Points { position: position.into(), error: error.into() };
                Targets::Surfaces(points, normal.into())
            }
        };
        Some(Self { wi: wi.into(), li, pdf, exists: true, target })
    }
}

impl<S: Simd> Arriving<f32x8<S>> {
    /// The light of a source at eight points, if it arrives at any. `numbers` are called where the source needs random ones.
    #[inline(always)]
    pub(super) fn at_eight(
        simd: S,
        at: &Destination<'_, f32x8<S>>,
        source: &Light,
        numbers: impl FnOnce() -> [f32x8<S>; 2],
        modes: &Modes<'_>,
    ) -> Option<Self> {
        let (world, one) = (at.world, f32x8::splat(simd, 1.0));
        match source {
            Light::Point { position, intensity, falloff } => {
                let position = Vector::splat(at.points.x, position.to_array());
                let (wi, distance) = ways::<f32x8<S>>(at.points, position);
                Some(Self {
                    wi,
                    li: modes.emission(simd, world, intensity) * fade::<f32x8<S>>(*falloff, distance),
                    pdf: one,
                    exists: one.narrow_mask(distance.gt(distance.like(0.0))),
                    target: Targets::Points(position),
                })
            }
            Light::Distant { toward, irradiance } => Some(Self {
                wi: Vector::splat(one, toward.to_array()),
                li: modes.emission(simd, world, irradiance),
                pdf: one,
                exists: mask32x8::splat(simd, true),
                target: Targets::Infinity,
            }),
            Light::Area(light) if light.is_in_lanes() => Self::from_area(simd, at, light, numbers(), modes),
            _ if !source.illuminates() => None,
            _ => {
                let u = if is_random(source) { numbers() } else { [f32x8::splat(simd, 0.0); 2] };
                Self::from_each(simd, at, source, u, modes)
            }
        }
    }

    #[inline(always)]
    fn from_area(
        simd: S,
        at: &Destination<'_, f32x8<S>>,
        light: &AreaLight,
        u: [f32x8<S>; 2],
        modes: &Modes<'_>,
    ) -> Option<Self> {
        let (samples, in_lanes) = sample_area_lights(simd, &[Some(light); LANES], u, at.points);
        let samples = samples?;
        let li = modes.emission(simd, at.world, &light.radiance);
        let is_front = samples.normal.dot(samples.wi.widen()).lt(f64x8::splat(simd, 0.0));
        let mut exists = samples.is_valid & !li.is_black() & mask32x8::from_bitmask(simd, in_lanes.into());
        if !light.two_sided {
            exists &= samples.pdf.narrow_mask(is_front);
        }
        let target = Targets::Surfaces(samples.points, samples.normal);
        Some(Self { wi: samples.wi, li, pdf: samples.pdf, exists, target })
    }

    /// The light of a source that is not sampled in lanes.
    #[inline(never)]
    fn from_each(
        simd: S,
        at: &Destination<'_, f32x8<S>>,
        source: &Light,
        u: [f32x8<S>; 2],
        modes: &Modes<'_>,
    ) -> Option<Self> {
        simd.vectorize(
            #[inline(always)]
            || {
                let u: [[f32; LANES]; 2] = u.map(Into::into);
                let (points, normals) = (scatter_f64(at.points), scatter(at.n));
                let samples = by_lane!(lane => {
                    let at_one = Destination {
                        world: at.world,
                        points: points[lane].into(),
                        n: normals[lane].into(),
                    };
                    Arriving::at_one(&at_one, source, [u[0][lane], u[1][lane]], modes.lane(lane))
                });
                let exists = bitmask(&by_lane!(lane => samples[lane].is_some()));
                let first = samples.iter().flatten().next()?;
                let of = by_lane!(lane => samples[lane].as_ref().unwrap_or(first));
                let target = match first.target {
                    Targets::Infinity => Targets::Infinity,
                    Targets::Points(position) => Targets::Points(Vector::splat(at.points.x, position.into())),
                    Targets::Surfaces(..) => {
                        let ends = by_lane!(lane => match of[lane].target {
                            Targets::Surfaces(points, normal) => {
                                [points.position, points.error, normal].map(<[f64; 3]>::from)
                            }
                            _ => [[0.0; 3]; 3],
                        });
                        let [position, error, normal] =
                            [0, 1, 2].map(|k| gather_f64(simd, &by_lane!(lane => ends[lane][k])));
                        Targets::Surfaces(Points { position, error }, normal)
                    }
                };
                Some(Self {
                    wi: gather(simd, &by_lane!(lane => of[lane].wi.into())),
                    li: gather_spectrum(simd, &by_lane!(lane => of[lane].li)),
                    pdf: f32x8::load_array(simd, by_lane!(lane => of[lane].pdf)),
                    exists: mask32x8::from_bitmask(simd, exists.into()),
                    target,
                })
            },
        )
    }
}

impl<R: Real> Arriving<R> {
    /// `I_j` of the notes: radiance over π and over the density of the direction.
    #[inline(always)]
    pub(super) fn intensity(&self) -> Spectrum<R> {
        self.li / (self.pdf * std::f32::consts::PI)
    }
}
