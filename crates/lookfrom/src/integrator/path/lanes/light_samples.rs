//! Next-event estimation for eight paths at once, up to the shadow ray.
//!
//! Triangles and spheres of one colour are vectorised; every other light is sampled by scalar code and put into its lane.

use glam::DVec3;
use lookfrom_bvh::Point;
use lookfrom_simd::{Simd, f32x8, prelude::*};

use super::surfaces::Surfaces;
use crate::core::lanes::{LANES, bitmask, by_lane, gather, gather_f64, scatter, scatter_f64};
use crate::core::points::Points;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::integrator::Event;
use crate::integrator::path::dimension;
use crate::integrator::sample_streams::SampleStreams;
use crate::light::{
    AreaSamples, IncompletePdf, Light, LightSample, LightSampleContext, Target, sample_area_lights,
};
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// The light samples of eight lanes. Masks have bit i for lane i.
pub(super) struct LightSamples {
    /// The light that each lane samples, and the probability of its choice.
    choice: [Option<(u32, f32)>; LANES],
    /// Lanes that have a sample.
    pub(super) is_valid: u32,
    /// Lanes whose light comes from a single direction.
    pub(super) is_delta: u32,
    pub(super) probability: [f32; LANES],
    pub(super) pdf: [f32; LANES],
    pub(super) li: [Spectrum; LANES],
    pub(super) wi: [[f32; 3]; LANES],
    /// Of a [`Target::Surface`], the point and the normal are in the fields below.
    target: [Target; LANES],
    position: [[f64; 3]; LANES],
    error: [[f64; 3]; LANES],
    normal: [[f64; 3]; LANES],
}

impl LightSamples {
    /// No lane has a sample.
    pub(super) const NONE: Self = Self {
        choice: [None; LANES],
        is_valid: 0,
        is_delta: 0,
        probability: [0.0; LANES],
        pdf: [0.0; LANES],
        li: [Spectrum::BLACK; LANES],
        wi: [[0.0; 3]; LANES],
        target: [Target::Infinity; LANES],
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
        let mut sampled = Self { choice, ..Self::NONE };
        let area_lights = by_lane!(lane => {
            match choice[lane].map(|(index, _)| &world.lights[index as usize]) {
                Some(Light::Area(light)) => Some(light),
                _ => None,
            }
        });
        let mut facing = [0.0; LANES];
        let (on_surfaces, in_lanes) =
            sample_area_lights(simd, &area_lights, [u0, u1], surfaces.points.position);
        if let Some(AreaSamples { points, normal, wi, pdf, .. }) = &on_surfaces {
            facing = normal.dot(wi.widen()).into();
            (sampled.wi, sampled.pdf) = (scatter(*wi), (*pdf).into());
            (sampled.position, sampled.error) = (scatter_f64(points.position), scatter_f64(points.error));
            sampled.normal = scatter_f64(*normal);
        }
        let on_skies = sampled.sample_skies(simd, world, [u0.into(), u1.into()], modes);
        let is_valid = on_surfaces.map_or(0, |samples| samples.is_valid.to_bitmask() as u32);

        for lane in 0..LANES {
            let Some((index, probability)) = choice[lane] else { continue };
            sampled.probability[lane] = probability;
            if on_skies & 1 << lane != 0 {
                continue;
            }
            let light = &world.lights[index as usize];
            if let Some(area_light) = area_lights[lane].filter(|_| in_lanes & 1 << lane != 0) {
                let emits = facing[lane] < 0.0 || area_light.two_sided;
                if emits && is_valid & 1 << lane != 0 {
                    sampled.li[lane] = area_light.radiance.even(&world.textures, modes[lane]);
                    sampled.target[lane] = ON_SURFACE;
                    sampled.is_valid |= 1 << lane;
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
            sampled.pdf[lane] = pdf;
            sampled.li[lane] = li;
            sampled.is_valid |= 1 << lane;
            sampled.is_delta |= u32::from(light.is_delta()) << lane;
            sampled.target[lane] = match target {
                Target::Surface(point, normal) => {
                    sampled.position[lane] = point.position;
                    sampled.error[lane] = point.error;
                    sampled.normal[lane] = normal.to_array();
                    ON_SURFACE
                }
                target => target,
            };
        }
        sampled
    }

    /// Samples the environment maps in the lanes that have chosen them, and returns these lanes.
    #[inline(always)]
    fn sample_skies<S: Simd>(
        &mut self,
        simd: S,
        world: &World,
        u: [[f32; LANES]; 2],
        modes: &[&SpectralMode; LANES],
    ) -> u32 {
        let mut sampled = 0;
        for &index in &world.environments {
            let chosen =
                bitmask(&by_lane!(lane => self.choice[lane].is_some_and(|(light, _)| light == index)));
            let Light::Environment(environment) = &world.lights[index as usize] else { continue };
            let Some(sky) = environment.map_in_lanes().filter(|_| chosen != 0 && environment.illuminates)
            else {
                continue;
            };
            let samples = sky.sample_lanes(simd, &world.textures, u, modes);
            for lane in (0..LANES).filter(|lane| chosen & 1 << lane != 0) {
                (self.wi[lane], self.li[lane], self.pdf[lane]) =
                    (samples.wi[lane], samples.li[lane], samples.pdf[lane]);
                self.is_valid |= u32::from(samples.is_usable(lane)) << lane;
            }
            sampled |= chosen;
        }
        sampled
    }

    /// The light that a lane samples, and the probability of its choice.
    #[inline]
    pub(super) fn light(&self, lane: usize) -> Option<(u32, f32)> {
        self.choice[lane]
    }

    /// The target of a lane's shadow ray; a [`Target::Surface`] is [`LightSamples::ends`].
    #[inline]
    pub(super) fn target(&self, lane: usize) -> &Target {
        &self.target[lane]
    }

    /// The light sample of a lane, for a probe.
    pub(super) fn light_sample(&self, lane: usize) -> LightSample {
        let target = match self.target[lane] {
            Target::Surface(..) => {
                let point = Point { position: self.position[lane], error: self.error[lane] };
                Target::Surface(point, self.normal[lane].into())
            }
            target => target,
        };
        LightSample { wi: self.wi[lane].into(), li: self.li[lane], pdf: self.pdf[lane], target }
    }

    /// The event of a light sample that contributes nothing, for a probe; `None` where no light was sampled.
    pub(super) fn failed(&self, lane: usize, address: u64) -> Option<Event> {
        let (light, probability) = self.choice[lane]?;
        let sample = (self.is_valid & 1 << lane != 0).then(|| self.light_sample(lane));
        Some(Event::LightSampleFailed { address, light, probability, sample })
    }

    /// The directions of shadow rays, from their origins to just before the lights' surfaces: as
    /// [`crate::integrator::Shadow::new`] has them.
    #[inline(always)]
    pub(super) fn ends<S: Simd>(&self, simd: S, origins: Vector<f32x8<S>>) -> [[f32; 3]; LANES] {
        let points =
            Points { position: gather_f64(simd, &self.position), error: gather_f64(simd, &self.error) };
        let normal = gather_f64(simd, &self.normal);
        scatter(points.just_before(normal, gather(simd, &self.wi), origins))
    }
}

/// A point of a surface, which is stored beside.
const ON_SURFACE: Target = Target::Surface(Point { position: [0.0; 3], error: [0.0; 3] }, DVec3::ZERO);
