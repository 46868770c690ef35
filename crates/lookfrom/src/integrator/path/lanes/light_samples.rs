//! Next-event estimation, up to the shadow ray.
//!
//! Triangles, whole spheres and disks of one colour, and environment maps are sampled in lanes; every other light by
//! [`Light::sample`], lane by lane.

use lookfrom_bvh::{Point, Ray};
use lookfrom_simd::{Float, LaneMask, Simd, f32x8, prelude::*};

use super::surfaces::Surfaces;
use crate::core::lanes::width::Width;
use crate::core::lanes::{
    Columns, LANES, bitmask, by_lane, load, load_f64, row, set_row, store, store_f64, store_spectrum,
};
use crate::core::points::Points;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::integrator::path::dimension;
use crate::integrator::sample_streams::SampleStreams;
use crate::integrator::{Event, shadow};
use crate::light::{
    AreaSamples, ChosenLight, EmissionSpectrum, IncompletePdf, Light, LightSample, LightSampleContext,
    Target, sample_area_lights,
};
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// The light samples of eight lanes. Masks have bit i for lane i; what a lane has not sampled has no meaning.
pub(super) struct LightSamples {
    /// The light that each lane samples, or [`NO_LIGHT`], and the probability of its choice.
    light: [u32; LANES],
    pub(super) probability: [f32; LANES],
    /// Lanes that have a sample.
    pub(super) is_valid: u32,
    /// Lanes whose light comes from a single direction.
    pub(super) is_delta: u32,
    /// Lanes whose shadow ray ends at a [`Target::Point`], and those where it ends at a [`Target::Surface`].
    at_point: u32,
    on_surface: u32,
    pub(super) pdf: [f32; LANES],
    pub(super) li: Columns<4>,
    pub(super) wi: Columns<3>,
    position: Columns<3, f64>,
    error: Columns<3, f64>,
    normal: Columns<3, f64>,
}

/// No light of a lane.
const NO_LIGHT: u32 = u32::MAX;

impl LightSamples {
    /// No lane has a sample.
    pub(super) const NONE: Self = Self {
        light: [NO_LIGHT; LANES],
        probability: [0.0; LANES],
        is_valid: 0,
        is_delta: 0,
        at_point: 0,
        on_surface: 0,
        pdf: [0.0; LANES],
        li: [[0.0; LANES]; 4],
        wi: [[0.0; LANES]; 3],
        position: [[0.0; LANES]; 3],
        error: [[0.0; LANES]; 3],
        normal: [[0.0; LANES]; 3],
    };

    /// Samples a light in the first lane, in place of what was sampled before.
    pub(super) fn sample_one(
        &mut self,
        world: &World,
        surfaces: &Surfaces<f32>,
        streams: &SampleStreams<f32>,
        mode: &SpectralMode,
    ) {
        self.clear();
        let at = LightSampleContext { point: surfaces.points.position.into(), n: surfaces.n.into() };
        let [which, v] = streams.two_with_pixel(dimension::LIGHT);
        let none = ChosenLight { light: NO_LIGHT, probability: 0.0, rest: 0.0 };
        let chosen = world.light_choice.sample(&at, which).unwrap_or(none);
        (self.light[0], self.probability[0]) = (chosen.light, chosen.probability);
        self.sample_lane(0, world, &at, [chosen.rest, v], mode);
    }

    /// Samples the light that a lane has chosen, as [`Light::sample`] does.
    #[inline]
    fn sample_lane(
        &mut self,
        lane: usize,
        world: &World,
        at: &LightSampleContext,
        u: [f32; 2],
        mode: &SpectralMode,
    ) {
        let Some(light) = world.lights.get(self.light[lane] as usize) else { return };
        if let Some(sample) = light.sample(&world.textures, at, u, mode, IncompletePdf::Allowed) {
            self.set(lane, &sample);
            self.is_delta |= u32::from(light.is_delta()) << lane;
        }
    }

    /// Removes all samples.
    #[inline(always)]
    fn clear(&mut self) {
        (self.is_valid, self.is_delta, self.at_point, self.on_surface) = (0, 0, 0, 0);
    }

    /// Samples lights in the lanes of a mask, in place of what was sampled before. Not inlined, since all classes of BSDFs
    /// need it.
    #[inline(never)]
    pub(super) fn sample<S: Simd>(
        &mut self,
        simd: S,
        world: &World,
        surfaces: &Surfaces<f32x8<S>>,
        streams: &SampleStreams<f32x8<S>>,
        modes: &[&SpectralMode; LANES],
        mask: u32,
    ) {
        simd.vectorize(
            #[inline(always)]
            || self.sample_now(simd, world, surfaces, streams, modes, mask),
        );
    }

    #[inline(always)]
    fn sample_now<S: Simd>(
        &mut self,
        simd: S,
        world: &World,
        surfaces: &Surfaces<f32x8<S>>,
        streams: &SampleStreams<f32x8<S>>,
        modes: &[&SpectralMode; LANES],
        mask: u32,
    ) {
        self.clear();
        let [which, v] = streams.two_with_pixel(dimension::LIGHT);
        let u = [self.choose(simd, world, surfaces, which, mask), v];
        let numbers: [[f32; LANES]; 2] = [u[0].into(), u[1].into()];
        let area_lights = by_lane!(lane => {
            match world.lights.get(self.light[lane] as usize) {
                Some(Light::Area(light)) => Some(light),
                _ => None,
            }
        });
        let (on_surfaces, on_areas) = sample_area_lights(simd, &area_lights, u, surfaces.points.position);
        if let Some(AreaSamples { points, normal, wi, pdf, is_valid }) = on_surfaces {
            let cosine = normal.dot(wi.widen());
            let faces = cosine.lt(cosine.like(0.0)).to_bitmask() as u32;
            let two_sided =
                bitmask(&by_lane!(lane => area_lights[lane].is_some_and(|light| light.two_sided)));
            (self.wi, self.pdf) = (store(wi), pdf.into());
            (self.position, self.error) = (store_f64(points.position), store_f64(points.error));
            self.normal = store_f64(normal);
            self.on_surface = on_areas & is_valid.to_bitmask() as u32 & (faces | two_sided);
            self.is_valid = self.on_surface;
            if let Some(first) = LaneMask(self.on_surface).next().and_then(|lane| area_lights[lane]) {
                let emissions = by_lane!(lane => match area_lights[lane] {
                    Some(light) if on_areas & 1 << lane != 0 => &light.radiance,
                    _ => &first.radiance,
                });
                let li = EmissionSpectrum::even_lanes(simd, &world.textures, &emissions, modes);
                self.li = store_spectrum(li);
            }
        }
        let on_skies = self.sample_skies(simd, world, numbers, modes);

        // Sample the other lights one by one.
        let others = mask & !(on_areas | on_skies);
        if others == 0 {
            return;
        }
        let positions = store_f64(surfaces.points.position);
        let normals = store(surfaces.n);
        for lane in LaneMask(others) {
            let at =
                LightSampleContext { point: row(&positions, lane).into(), n: row(&normals, lane).into() };
            self.sample_lane(lane, world, &at, row(&numbers, lane), modes[lane]);
        }
    }

    /// Chooses lights in the lanes of a mask; the rests of the numbers that choose them.
    #[inline(always)]
    fn choose<S: Simd>(
        &mut self,
        simd: S,
        world: &World,
        surfaces: &Surfaces<f32x8<S>>,
        which: f32x8<S>,
        mask: u32,
    ) -> f32x8<S> {
        if let Some(light) = world.light_choice.only() {
            for lane in 0..LANES {
                (self.light[lane], self.probability[lane]) = match mask & 1 << lane {
                    0 => (NO_LIGHT, 0.0),
                    _ => (light, 1.0),
                };
            }
            return which;
        }
        let chosen = world.light_choice.sample_lanes(simd, surfaces.points.position, surfaces.n, which, mask);
        let mut rests = [0.0; LANES];
        for (lane, chosen) in chosen.into_iter().enumerate() {
            let none = ChosenLight { light: NO_LIGHT, probability: 0.0, rest: 0.0 };
            ChosenLight { light: self.light[lane], probability: self.probability[lane], rest: rests[lane] } =
                chosen.unwrap_or(none);
        }
        f32x8::load_array(simd, rests)
    }

    /// The sample of a lane.
    #[inline]
    fn set(&mut self, lane: usize, sample: &LightSample) {
        let LightSample { wi, li, pdf, target } = *sample;
        set_row(&mut self.wi, lane, wi.to_array());
        set_row(&mut self.li, lane, li.0);
        self.pdf[lane] = pdf;
        self.is_valid |= 1 << lane;
        match target {
            Target::Infinity => {}
            Target::Point(position) => {
                set_row(&mut self.position, lane, position.to_array());
                self.at_point |= 1 << lane;
            }
            Target::Surface(point, normal) => {
                set_row(&mut self.position, lane, point.position);
                set_row(&mut self.error, lane, point.error);
                set_row(&mut self.normal, lane, normal.to_array());
                self.on_surface |= 1 << lane;
            }
        }
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
            let chosen = bitmask(&by_lane!(lane => self.light[lane] == index));
            let Light::Environment(environment) = &world.lights[index as usize] else { continue };
            let Some(sky) = environment.map_in_lanes().filter(|_| chosen != 0 && environment.illuminates)
            else {
                continue;
            };
            let samples = sky.sample_lanes(simd, &world.textures, u, modes);
            for lane in (0..LANES).filter(|lane| chosen & 1 << lane != 0) {
                set_row(&mut self.wi, lane, samples.wi[lane]);
                set_row(&mut self.li, lane, samples.li[lane].0);
                self.pdf[lane] = samples.pdf[lane];
                self.is_valid |= u32::from(samples.is_usable(lane)) << lane;
            }
            sampled |= chosen;
        }
        sampled
    }

    /// The light that a lane samples, and the probability of its choice.
    #[inline]
    pub(super) fn light(&self, lane: usize) -> Option<(u32, f32)> {
        let light = self.light[lane];
        (light != NO_LIGHT).then_some((light, self.probability[lane]))
    }

    /// The shadow ray of a lane from an origin; `end` is that of [`LightSamples::ends`].
    #[inline]
    pub(super) fn shadow_ray(&self, lane: usize, origin: [f32; 3], end: &Columns<3>) -> Ray {
        if self.on_surface & 1 << lane != 0 {
            return Ray { t_max: 1.0, ..Ray::new(origin, row(end, lane)) };
        }
        match self.at_point & 1 << lane {
            0 => Ray::new(origin, row(&self.wi, lane)),
            _ => shadow::toward(origin, row(&self.position, lane)),
        }
    }

    /// The light sample of a lane, for a probe.
    pub(super) fn light_sample(&self, lane: usize) -> LightSample {
        let is = |mask: u32| mask & 1 << lane != 0;
        let position = row(&self.position, lane);
        let target = if is(self.on_surface) {
            Target::Surface(Point { position, error: row(&self.error, lane) }, row(&self.normal, lane).into())
        } else if is(self.at_point) {
            Target::Point(position.into())
        } else {
            Target::Infinity
        };
        let (wi, li) = (row(&self.wi, lane).into(), Spectrum(row(&self.li, lane)));
        LightSample { wi, li, pdf: self.pdf[lane], target }
    }

    /// The event of a light sample that contributes nothing, for a probe; `None` where no light was sampled.
    pub(super) fn failed(&self, lane: usize, address: u64) -> Option<Event> {
        let (light, probability) = self.light(lane)?;
        let sample = (self.is_valid & 1 << lane != 0).then(|| self.light_sample(lane));
        Some(Event::LightSampleFailed { address, light, probability, sample })
    }

    /// The directions of shadow rays, from their origins to just before the lights' surfaces.
    #[inline(always)]
    pub(super) fn ends<W: Width>(&self, width: W, origins: Vector<W::Real>) -> Columns<3> {
        let points =
            Points { position: load_f64(width, &self.position), error: load_f64(width, &self.error) };
        let normal = load_f64(width, &self.normal);
        store(points.just_before(normal, load(width, &self.wi), origins))
    }
}
