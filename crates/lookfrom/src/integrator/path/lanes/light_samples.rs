//! Next-event estimation for eight paths at once, up to the shadow ray.
//!
//! Triangles of one colour, sampled by area, are vectorised; every other light is sampled by scalar code and put into
//! its lane.

use glam::DVec3;
use lookfrom_bvh::Point;
use lookfrom_simd::{Float, Simd, f32x8, f64x8, prelude::*};

use super::kernel::{SampleStreams, Surfaces};
use crate::core::lanes::{LANES, by_lane, gather, gather_f64, scatter, scatter_f64};
use crate::core::points::Points;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::core::warp;
use crate::integrator::Event;
use crate::integrator::path::dimension;
use crate::light::{IncompletePdf, Light, LightSample, LightSampleContext, LightTriangle, Target};
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// The light sample of one lane; the point of a [`Target::Surface`] is in [`LightSamples`].
#[derive(Clone, Copy)]
pub(super) struct LaneSample {
    pub(super) light: u32,
    pub(super) probability: f32,
    pub(super) pdf: f32,
    pub(super) li: Spectrum,
    pub(super) is_delta: bool,
    pub(super) target: Target,
}

/// The light samples of eight lanes.
pub(super) struct LightSamples {
    /// The light that each lane samples, and the probability of its choice.
    choice: [Option<(u32, f32)>; LANES],
    pub(super) samples: [Option<LaneSample>; LANES],
    pub(super) wi: [[f32; 3]; LANES],
    /// Points on the lights that are surfaces, and the normals there.
    position: [[f64; 3]; LANES],
    error: [[f64; 3]; LANES],
    normal: [[f64; 3]; LANES],
}

impl LightSamples {
    /// No lane has a sample.
    pub(super) const NONE: Self = Self {
        choice: [None; LANES],
        samples: [None; LANES],
        wi: [[0.0; 3]; LANES],
        position: [[0.0; 3]; LANES],
        error: [[0.0; 3]; LANES],
        normal: [[0.0; 3]; LANES],
    };

    /// Samples lights in the lanes of a mask. Not inlined, since all classes of BSDFs need it.
    #[inline(never)]
    pub(super) fn new<S: Simd>(
        simd: S,
        world: &World,
        surfaces: &Surfaces<S>,
        streams: &SampleStreams<S>,
        modes: &[&SpectralMode; LANES],
        mask: u32,
    ) -> Self {
        simd.vectorize(
            #[inline(always)]
            || Self::sample(simd, world, surfaces, streams, modes, mask),
        )
    }

    #[inline(always)]
    fn sample<S: Simd>(
        simd: S,
        world: &World,
        surfaces: &Surfaces<S>,
        streams: &SampleStreams<S>,
        modes: &[&SpectralMode; LANES],
        mask: u32,
    ) -> Self {
        let [u0, u1] = streams.two(dimension::LIGHT);
        let (points, normals) = (scatter_f64(surfaces.points.position), scatter(surfaces.n));
        let at = by_lane!(lane => LightSampleContext {
            point: DVec3::from_array(points[lane]),
            n: normals[lane].into(),
        });
        let mut choice = match world.light_choice.only() {
            Some(light) => [Some((light, 1.0)); LANES],
            None => {
                let [which, _] = streams.two(dimension::CHOICE);
                world.light_choice.sample_lanes(simd, &at, which, mask)
            }
        };
        for (lane, choice) in choice.iter_mut().enumerate() {
            *choice = choice.filter(|_| mask & 1 << lane != 0);
        }
        let triangle = by_lane!(lane => {
            match choice[lane].map(|(index, _)| &world.lights[index as usize]) {
                Some(Light::Area(light)) => light.triangle(u0[lane]),
                _ => None,
            }
        });

        // Points on triangles, sampled by area.
        let mut sampled = Self { choice, ..Self::NONE };
        let (mut pdf, mut cos, mut distance, mut by_direction) =
            ([0.0; LANES], [0.0; LANES], [0.0; LANES], 0);
        if triangle.iter().any(Option::is_some) {
            let of = by_lane!(lane => triangle[lane].map_or(&LightTriangle::NONE, |(triangle, ..)| triangle));
            let corners = [
                gather(simd, &by_lane!(lane => of[lane].corners[0])),
                gather(simd, &by_lane!(lane => of[lane].corners[1])),
                gather(simd, &by_lane!(lane => of[lane].corners[2])),
            ];
            let normal = gather_f64(simd, &by_lane!(lane => of[lane].normal.unwrap_or(DVec3::Z).to_array()));
            let area = f64x8::load_array(simd, by_lane!(lane => of[lane].area));
            let fraction = by_lane!(lane => triangle[lane].map_or(1.0, |(_, fraction, _)| fraction));
            let probability = f64x8::load_array(simd, by_lane!(lane => f64::from(fraction[lane])));
            let rest =
                f32x8::load_array(simd, by_lane!(lane => triangle[lane].map_or(0.0, |(_, _, rest)| rest)));
            let [_, beta, gamma] = warp::uniform_triangle([rest, u1]);
            let (points, _) = Points::on_triangles(corners, beta, gamma);
            let to = points.position - surfaces.points.position;
            let length = to.length();
            let wi: Vector<f32x8<S>> =
                Vector::narrow(Vector { x: to.x / length, y: to.y / length, z: to.z / length });
            let cosine = normal.dot(wi.widen());
            let density = probability / area * length * length / Float::abs(cosine);
            pdf = <f32x8<S> as lookfrom_simd::Real>::narrow(density).into();
            cos = cosine.into();
            distance = length.into();
            by_direction = worth_direction(simd, &of, normal, area, surfaces.points.position);
            sampled.wi = scatter(wi);
            sampled.position = scatter_f64(points.position);
            sampled.error = scatter_f64(points.error);
            sampled.normal = scatter_f64(normal);
        }

        for lane in 0..LANES {
            let Some((index, probability)) = choice[lane] else { continue };
            let light = &world.lights[index as usize];
            if let (Some(_), Light::Area(area_light)) = (&triangle[lane], light)
                && by_direction & 1 << lane == 0
            {
                let emits = cos[lane] < 0.0 || area_light.two_sided;
                let usable = distance[lane] > 0.0 && pdf[lane].is_finite() && pdf[lane] > 0.0;
                if emits && usable {
                    let li = area_light.radiance.even(&world.textures, modes[lane]);
                    let target = Target::Surface(Point { position: [0.0; 3], error: [0.0; 3] }, DVec3::ZERO);
                    let (light, pdf) = (index, pdf[lane]);
                    sampled.samples[lane] =
                        Some(LaneSample { light, probability, pdf, li, is_delta: false, target });
                }
                continue;
            }
            let u = [u0[lane], u1[lane]];
            let Some(LightSample { wi, li, pdf, target }) =
                light.sample(&world.textures, &at[lane], u, modes[lane], IncompletePdf::Allowed)
            else {
                continue;
            };
            sampled.wi[lane] = wi.to_array();
            if let Target::Surface(point, normal) = target {
                sampled.position[lane] = point.position;
                sampled.error[lane] = point.error;
                sampled.normal[lane] = normal.to_array();
            }
            let is_delta = light.is_delta();
            sampled.samples[lane] = Some(LaneSample { light: index, probability, pdf, li, is_delta, target });
        }
        sampled
    }

    /// The light sample of a lane, for a probe.
    pub(super) fn light_sample(&self, lane: usize, sample: &LaneSample) -> LightSample {
        let target = match sample.target {
            Target::Surface(..) => {
                let point = Point { position: self.position[lane], error: self.error[lane] };
                Target::Surface(point, self.normal[lane].into())
            }
            target => target,
        };
        LightSample { wi: self.wi[lane].into(), li: sample.li, pdf: sample.pdf, target }
    }

    /// The event of a light sample that contributes nothing, for a probe; `None` where no light was sampled.
    pub(super) fn failed(&self, lane: usize, address: u64) -> Option<Event> {
        let (light, probability) = self.choice[lane]?;
        let sample = self.samples[lane].as_ref().map(|sample| self.light_sample(lane, sample));
        Some(Event::LightSampleFailed { address, light, probability, sample })
    }

    /// The directions of shadow rays, from their origins to just before the lights' surfaces: as
    /// [`crate::integrator::Shadow::new`] has them.
    #[inline(always)]
    pub(super) fn ends<S: Simd>(&self, simd: S, origins: Vector<f32x8<S>>) -> [[f32; 3]; LANES] {
        let (position, error) = (gather_f64(simd, &self.position), gather_f64(simd, &self.error));
        let origins = origins.widen();
        let Vector { x, y, z } = (position - origins).abs();
        let length = Float::max(Float::max(Float::max(x.like(0.0), x), y), z);
        let slack = length * f64::from(f32::EPSILON);
        let error = Vector { x: error.x + slack, y: error.y + slack, z: error.z + slack };
        let guarded = Points::<f32x8<S>> { position, error };
        let back = -gather(simd, &self.wi);
        let end = guarded.leave(gather_f64(simd, &self.normal), back);
        scatter(Vector::narrow(end.widen() - origins))
    }
}

/// The lanes whose triangles are large enough, as seen from the surfaces, to be sampled by direction: as the lights
/// decide it themselves.
#[inline(always)]
fn worth_direction<S: Simd>(
    simd: S,
    of: &[&LightTriangle; LANES],
    normal: Vector<f64x8<S>>,
    area: f64x8<S>,
    from: Vector<f64x8<S>>,
) -> u32 {
    let p0 = gather_f64(simd, &by_lane!(lane => of[lane].p0.to_array()));
    let e1 = gather_f64(simd, &by_lane!(lane => of[lane].e1.to_array()));
    let e2 = gather_f64(simd, &by_lane!(lane => of[lane].e2.to_array()));
    let middle = p0 - from + (e1 + e2) * area.like(1.0 / 3.0);
    let distance2 = middle.dot(middle);
    let seems = area * Float::abs(normal.dot(middle)) / (distance2 * Float::sqrt(distance2));
    let is_large = Float::gt(seems, area.like(LightTriangle::WORTH_DIRECTION)) | Float::lt(distance2, area);
    is_large.to_bitmask() as u32
}
