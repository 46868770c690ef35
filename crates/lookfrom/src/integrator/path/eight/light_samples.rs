//! Next-event estimation for eight paths at once: the SIMD version of `PathTracer::sample_light` up to the shadow ray.
//!
//! Triangles of one colour, sampled by area, are vectorised; every other light is sampled by scalar code and put into
//! its lane.

use glam::DVec3;
use lookfrom_bvh::Point;
use lookfrom_simd::{Simd, f32x8, f64x8, prelude::*};

use super::{FlatDiffuseHit, SampleStreams, Surfaces, dimension};
use crate::core::eight::{LANES, Narrow, Points, Vectors, Wide, by_axis, by_lane, narrow};
use crate::core::spectrum::Spectrum;
use crate::integrator::Event;
use crate::light::{IncompletePdf, Light, LightSample, LightSampleContext, LightTriangle, Target};
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// The light sample of one lane.
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
pub(super) struct LightSamples<S: Simd> {
    /// The light that each lane samples, and the probability of its choice.
    choice: [Option<(u32, f32)>; LANES],
    pub(super) samples: [Option<LaneSample>; LANES],
    pub(super) wi: Vectors<Narrow<S>>,
    /// Points on the lights that are surfaces, and the normals there.
    points: Points<S>,
    normal: Vectors<Wide<S>>,
}

impl<S: Simd> LightSamples<S> {
    #[inline(always)]
    pub(super) fn new(
        simd: S,
        world: &World,
        plain: &[FlatDiffuseHit<'_>; LANES],
        surfaces: &Surfaces<S>,
        stream: &SampleStreams<S>,
        lanes: &[SpectralMode],
    ) -> Self {
        let [u0, u1] = stream.two(simd, dimension::LIGHT);
        let from: [[f64; LANES]; 3] = by_axis!(i => surfaces.points.position.0[i].into());
        let at = by_lane!(lane => LightSampleContext {
            point: DVec3::from_array(by_axis!(i => from[i][lane])),
            n: surfaces.n.lane(lane).into(),
        });
        let choice = match world.light_choice.only() {
            Some(light) => [Some((light, 1.0)); LANES],
            None => {
                let [which, _] = stream.two(simd, dimension::CHOICE);
                by_lane!(lane => world.light_choice.sample(&at[lane], which[lane]))
            }
        };
        let triangle = by_lane!(lane => {
            match choice[lane].map(|(index, _)| &world.lights[index as usize]) {
                Some(Light::Area(light)) => light.triangle(u0[lane]),
                _ => None,
            }
        });

        // Points on triangles, sampled by area.
        let of = by_lane!(lane => triangle[lane].map_or(&LightTriangle::NONE, |(triangle, ..)| triangle));
        let corners =
            by_axis!(k => Vectors::<Narrow<S>>::of_rows(simd, &by_lane!(lane => of[lane].corners[k])));
        let normal = Vectors::<Wide<S>>::of_rows(
            simd,
            &by_lane!(lane => of[lane].normal.unwrap_or(DVec3::Z).to_array()),
        );
        let area = f64x8::load_array(simd, by_lane!(lane => of[lane].area));
        let share = by_lane!(lane => triangle[lane].map_or(1.0, |(_, share, _)| share));
        let probability = f64x8::load_array(simd, by_lane!(lane => f64::from(share[lane])));
        let rest = f32x8::load_array(simd, by_lane!(lane => triangle[lane].map_or(0.0, |(_, _, rest)| rest)));
        let [beta, gamma] = uniform_triangles(simd, rest, u1);
        let (points, _) = Points::on_triangles(simd, corners, beta, gamma);
        let to = points.position.sub(surfaces.points.position);
        let distance = to.length();
        let wi = Vectors(by_axis!(i => narrow(to.0[i] / distance)));
        let cos = normal.dot(wi.widen());
        let pdf = probability / area * distance * distance / cos.abs();
        let pdf: [f32; LANES] = narrow(pdf).into();
        let cos: [f64; LANES] = cos.into();
        let near: [f64; LANES] = distance.into();
        let by_direction = worth_direction(simd, &of, normal, area, surfaces.points.position);

        let mut wi = by_lane!(lane => wi.lane(lane));
        let mut place: [Option<(Point, DVec3)>; LANES] = [None; LANES];
        let mut samples = [None; LANES];
        for lane in 0..LANES {
            let Some((index, probability)) = choice[lane] else { continue };
            let light = &world.lights[index as usize];
            let lanes = &lanes[plain[lane].path.slot as usize];
            if let (Some(_), Light::Area(area_light)) = (&triangle[lane], light)
                && by_direction & 1 << lane == 0
            {
                let emits = cos[lane] < 0.0 || area_light.two_sided;
                let usable = near[lane] > 0.0 && pdf[lane].is_finite() && pdf[lane] > 0.0;
                if emits && usable {
                    let li = area_light.radiance.even(&world.textures, lanes);
                    let target = Target::Surface(Point { position: [0.0; 3], error: [0.0; 3] }, DVec3::ZERO);
                    samples[lane] = Some(LaneSample {
                        light: index,
                        probability,
                        pdf: pdf[lane],
                        li,
                        is_delta: false,
                        target,
                    });
                }
                continue;
            }
            let Some(sample) =
                light.sample(&world.textures, &at[lane], [u0[lane], u1[lane]], lanes, IncompletePdf::Allowed)
            else {
                continue;
            };
            wi[lane] = sample.wi.to_array();
            if let Target::Surface(point, normal) = sample.target {
                place[lane] = Some((point, normal));
            }
            let LightSample { pdf, li, target, .. } = sample;
            samples[lane] =
                Some(LaneSample { light: index, probability, pdf, li, is_delta: light.is_delta(), target });
        }

        // Put the samples of scalar code into their lanes.
        let (mut points, mut normal) = (points, normal);
        for (lane, place) in place.iter().enumerate() {
            if let Some((point, of_light)) = place {
                for axis in 0..3 {
                    points.position.0[axis][lane] = point.position[axis];
                    points.error.0[axis][lane] = point.error[axis];
                    normal.0[axis][lane] = of_light[axis];
                }
            }
        }
        Self { choice, samples, wi: Vectors::<Narrow<S>>::of_rows(simd, &wi), points, normal }
    }

    /// The light sample of a lane, for a probe.
    pub(super) fn light_sample(&self, lane: usize, answer: &LaneSample) -> LightSample {
        let target = match answer.target {
            Target::Surface(..) => {
                let position = by_axis!(i => self.points.position.0[i][lane]);
                let error = by_axis!(i => self.points.error.0[i][lane]);
                Target::Surface(Point { position, error }, by_axis!(i => self.normal.0[i][lane]).into())
            }
            target => target,
        };
        LightSample { wi: self.wi.lane(lane).into(), li: answer.li, pdf: answer.pdf, target }
    }

    /// The event of a light sample that contributes nothing, for a probe; `None` where there is no light.
    pub(super) fn in_vain(&self, lane: usize, address: u64) -> Option<Event> {
        let (light, probability) = self.choice[lane]?;
        let sample = self.samples[lane].as_ref().map(|answer| self.light_sample(lane, answer));
        Some(Event::LightSampleFailed { address, light, probability, sample })
    }

    /// Directions of shadow rays, from their origins to just before the lights' surfaces: the SIMD version of
    /// [`crate::integrator::Shadow::new`].
    #[inline(always)]
    pub(super) fn ends(&self, simd: S, origins: &Vectors<Narrow<S>>) -> Vectors<Narrow<S>> {
        let origins = origins.widen();
        let Vectors([x, y, z]) = self.points.position.sub(origins).abs();
        let length = f64x8::splat(simd, 0.0).max(x).max(y).max(z);
        let slack = length * f64::from(f32::EPSILON);
        let error = Vectors(by_axis!(i => self.points.error.0[i] + slack));
        let guarded = Points { position: self.points.position, error };
        let back = self.wi.widen().scale(f64x8::splat(simd, -1.0));
        guarded.leave(simd, self.normal, back).widen().sub(origins).narrow()
    }
}

/// SIMD version of [`crate::core::warp::uniform_triangle`]: β and γ.
#[inline(always)]
fn uniform_triangles<S: Simd>(simd: S, u: Narrow<S>, v: Narrow<S>) -> [Narrow<S>; 2] {
    let (half, one) = (f32x8::splat(simd, 0.5), f32x8::splat(simd, 1.0));
    let above = v.simd_gt(u);
    let (half_u, half_v) = (half * u, half * v);
    let alpha = above.select(half_u, u - half_v);
    let beta = above.select(v - half_u, half_v);
    [beta, one - (alpha + beta)]
}

/// Bit mask of the lanes whose triangles may be sampled by solid angle: the SIMD version of the first half of the test
/// in `light::area::mesh`.
#[inline(always)]
fn worth_direction<S: Simd>(
    simd: S,
    of: &[&LightTriangle; LANES],
    normal: Vectors<Wide<S>>,
    area: Wide<S>,
    from: Vectors<Wide<S>>,
) -> u32 {
    let p0 = Vectors::<Wide<S>>::of_rows(simd, &by_lane!(lane => of[lane].p0.to_array()));
    let e1 = Vectors::<Wide<S>>::of_rows(simd, &by_lane!(lane => of[lane].e1.to_array()));
    let e2 = Vectors::<Wide<S>>::of_rows(simd, &by_lane!(lane => of[lane].e2.to_array()));
    let middle = p0.sub(from).add(e1.add(e2).scale(f64x8::splat(simd, 1.0 / 3.0)));
    let distance2 = middle.dot(middle);
    let seems = area * normal.dot(middle).abs() / (distance2 * distance2.sqrt());
    let large = seems.simd_gt(f64x8::splat(simd, LightTriangle::WORTH_DIRECTION)) | distance2.simd_lt(area);
    large.to_bitmask() as u32
}
