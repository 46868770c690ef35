//! Light samples of the vertices of paths, up to their shadow rays.
//!
//! Triangles, whole spheres and disks of one colour that stand still, environment maps, skies with guides, and point and distant lights
//! that all lanes sample, are sampled in lanes; every other light by [`Light::sample`], lane by lane.

use lookfrom_bvh::Point;
use lookfrom_simd::{Float, LaneMask, Real, Simd, f32x8, f64x8, prelude::*};

use super::modes::Modes;
use crate::core::lanes::width::{Mask, Width};
use crate::core::lanes::{
    Columns, LANES, bitmask, by_lane, load, load_f64, row, set_row, store, store_f64, store_spectrum,
};
use crate::core::points::Points;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::integrator::Event;
use crate::light::{
    AreaSamples, ChosenLight, EmissionSpectrum, IncompletePdf, Light, LightSample, LightSampleContext,
    Target, fade, sample_area_lights, ways,
};
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// Vertices that lights are sampled from.
pub(in crate::integrator) struct Receivers<'a, R: Real> {
    pub(in crate::integrator) points: Vector<R::Double>,
    /// The normals by which lights are chosen and sampled.
    pub(in crate::integrator) n: Vector<R>,
    pub(in crate::integrator) modes: &'a Modes<'a>,
    pub(in crate::integrator) incomplete_pdf: IncompletePdf,
}

impl Receivers<'_, f32> {
    fn context(&self) -> LightSampleContext {
        LightSampleContext { point: self.points.into(), n: self.n.into(), time: self.modes.time(0) }
    }
}

/// The light samples of eight lanes. Masks have bit i for lane i; what a lane has not sampled has no meaning.
#[derive(Clone, Debug, Default)]
pub(in crate::integrator) struct LightSamples {
    /// The light that each lane samples, or [`NO_LIGHT`], and the probability of its choice.
    light: [u32; LANES],
    pub(in crate::integrator) probability: [f32; LANES],
    /// Whether all lanes sample the light of the first.
    is_one: bool,
    /// Lanes that have a sample.
    pub(in crate::integrator) is_valid: u32,
    /// Lanes whose light comes from a single direction.
    pub(in crate::integrator) is_delta: u32,
    /// Lanes whose shadow ray ends at a [`Target::Point`], and those where it ends at a [`Target::Surface`].
    at_point: u32,
    on_surface: u32,
    pub(in crate::integrator) pdf: [f32; LANES],
    pub(in crate::integrator) li: Columns<4>,
    pub(in crate::integrator) wi: Columns<3>,
    position: Columns<3, f64>,
    error: Columns<3, f64>,
    normal: Columns<3, f64>,
}

/// No light of a lane.
const NO_LIGHT: u32 = u32::MAX;

impl LightSamples {
    /// Chooses a light in the first lane. Returns the rest of the number that chooses it.
    pub(in crate::integrator) fn choose_one(
        &mut self,
        world: &World,
        at: &Receivers<'_, f32>,
        u: f32,
    ) -> f32 {
        let none = ChosenLight { light: NO_LIGHT, probability: 0.0, rest: 0.0 };
        let chosen = world.light_choice.sample(&at.context(), u).unwrap_or(none);
        (self.light[0], self.probability[0], self.is_one) = (chosen.light, chosen.probability, true);
        chosen.rest
    }

    /// Chooses one light for all lanes.
    #[inline(always)]
    pub(in crate::integrator) fn choose_all(&mut self, light: u32) {
        (self.light, self.probability, self.is_one) = ([light; LANES], [1.0; LANES], true);
    }

    /// The light of [`LightSamples::choose_all`].
    pub(in crate::integrator) fn of_all(&self) -> u32 {
        self.light[0]
    }

    /// Chooses lights in the lanes of a mask. Returns the rests of the numbers that choose them.
    #[inline(always)]
    pub(in crate::integrator) fn choose<S: Simd>(
        &mut self,
        simd: S,
        world: &World,
        at: &Receivers<'_, f32x8<S>>,
        u: f32x8<S>,
        mask: u32,
    ) -> f32x8<S> {
        if let Some(light) = world.light_choice.only() {
            self.choose_all(light);
            return u;
        }
        self.is_one = false;
        let chosen = world.light_choice.sample_lanes(simd, at.points, at.n, u, mask);
        let mut rests = [0.0; LANES];
        for (lane, chosen) in chosen.into_iter().enumerate() {
            let none = ChosenLight { light: NO_LIGHT, probability: 0.0, rest: 0.0 };
            ChosenLight { light: self.light[lane], probability: self.probability[lane], rest: rests[lane] } =
                chosen.unwrap_or(none);
        }
        f32x8::load_array(simd, rests)
    }

    /// Samples the chosen light in the first lane.
    pub(in crate::integrator) fn sample_one(&mut self, world: &World, at: &Receivers<'_, f32>, u: [f32; 2]) {
        self.clear();
        self.sample_lane(0, world, &at.context(), u, at);
    }

    /// Samples the light that a lane has chosen, as [`Light::sample`] does.
    #[inline]
    fn sample_lane<R: Real>(
        &mut self,
        lane: usize,
        world: &World,
        context: &LightSampleContext,
        u: [f32; 2],
        at: &Receivers<'_, R>,
    ) {
        let Some(light) = world.lights.get(self.light[lane] as usize) else { return };
        let sample = light.sample(&world.textures, context, u, at.modes.lane(lane), at.incomplete_pdf);
        if let Some(sample) = sample {
            self.set(lane, &sample);
            self.is_delta |= u32::from(light.is_delta()) << lane;
        }
    }

    /// Removes all samples.
    #[inline(always)]
    fn clear(&mut self) {
        (self.is_valid, self.is_delta, self.at_point, self.on_surface) = (0, 0, 0, 0);
    }

    /// Samples the chosen lights in the lanes of a mask. Not inlined, since all classes of BSDFs need it.
    #[inline(never)]
    pub(in crate::integrator) fn sample<S: Simd>(
        &mut self,
        simd: S,
        world: &World,
        at: &Receivers<'_, f32x8<S>>,
        u: [f32x8<S>; 2],
        mask: u32,
    ) {
        simd.vectorize(
            #[inline(always)]
            || self.sample_now(simd, world, at, u, mask),
        );
    }

    #[inline(always)]
    fn sample_now<S: Simd>(
        &mut self,
        simd: S,
        world: &World,
        at: &Receivers<'_, f32x8<S>>,
        u: [f32x8<S>; 2],
        mask: u32,
    ) {
        self.clear();
        if self.is_one && self.sample_delta(simd, world, at) {
            return;
        }
        let numbers: [[f32; LANES]; 2] = [u[0].into(), u[1].into()];
        let area_lights = by_lane!(lane => {
            match world.lights.get(self.light[lane] as usize) {
                Some(Light::Area(light)) if light.motion.is_none() => Some(light),
                _ => None,
            }
        });
        let (on_surfaces, on_areas) = sample_area_lights(simd, &area_lights, u, at.points);
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
                let li = match self.is_one {
                    true => at.modes.emission(simd, world, &first.radiance),
                    false => {
                        let emissions = by_lane!(lane => match area_lights[lane] {
                            Some(light) if on_areas & 1 << lane != 0 => &light.radiance,
                            _ => &first.radiance,
                        });
                        EmissionSpectrum::even_lanes(simd, &world.textures, &emissions, at.modes.all())
                    }
                };
                self.li = store_spectrum(li);
            }
        }
        let on_skies = match at.incomplete_pdf {
            IncompletePdf::Allowed => {
                self.sample_skies(simd, world, (at.points, at.n), numbers, at.modes.all())
            }
            IncompletePdf::Forbidden => 0,
        };

        // Sample the other lights one by one.
        let others = mask & !(on_areas | on_skies);
        if others == 0 {
            return;
        }
        let (positions, normals) = (store_f64(at.points), store(at.n));
        for lane in LaneMask(others) {
            let context = LightSampleContext {
                point: row(&positions, lane).into(),
                n: row(&normals, lane).into(),
                time: at.modes.time(lane),
            };
            self.sample_lane(lane, world, &context, row(&numbers, lane), at);
        }
    }

    /// Samples the point or distant light that all lanes have chosen; false where it is of another kind.
    #[inline(always)]
    fn sample_delta<S: Simd>(&mut self, simd: S, world: &World, at: &Receivers<'_, f32x8<S>>) -> bool {
        let (wi, li) = match world.lights.get(self.light[0] as usize) {
            Some(Light::Point { position, intensity, falloff }) => {
                let position = Vector::splat(at.points.x, position.to_array());
                let (wi, distance) = ways::<f32x8<S>>(at.points, position);
                self.is_valid = distance.gt(distance.like(0.0)).to_bitmask() as u32;
                (self.at_point, self.position) = (self.is_valid, store_f64(position));
                (wi, at.modes.emission(simd, world, intensity) * fade::<f32x8<S>>(*falloff, distance))
            }
            Some(Light::Distant { toward, irradiance }) => {
                self.is_valid = (1 << LANES) - 1;
                (Vector::splat(at.n.x, toward.to_array()), at.modes.emission(simd, world, irradiance))
            }
            _ => return false,
        };
        self.is_delta = self.is_valid;
        (self.wi, self.li, self.pdf) = (store(wi), store_spectrum(li), [1.0; LANES]);
        true
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

    /// Samples environments in the lanes that have chosen them, and returns these lanes, without those whose environment is sampled
    /// one by one.
    #[inline(always)]
    fn sample_skies<S: Simd>(
        &mut self,
        simd: S,
        world: &World,
        places: (Vector<f64x8<S>>, Vector<f32x8<S>>),
        u: [[f32; LANES]; 2],
        modes: &[&SpectralMode; LANES],
    ) -> u32 {
        let mut sampled = 0;
        for &index in &world.environments {
            let chosen = bitmask(&by_lane!(lane => self.light[lane] == index));
            let Light::Environment(environment) = &world.lights[index as usize] else { continue };
            if chosen == 0 || !environment.illuminates {
                continue;
            }
            let Some(samples) = environment.sample_lanes(simd, &world.textures, places, u, modes) else {
                continue;
            };
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
    pub(in crate::integrator) fn light(&self, lane: usize) -> Option<(u32, f32)> {
        let light = self.light[lane];
        (light != NO_LIGHT).then_some((light, self.probability[lane]))
    }

    /// The light sample of a lane, for a probe.
    pub(in crate::integrator) fn light_sample(&self, lane: usize) -> LightSample {
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
    pub(in crate::integrator) fn failed(&self, lane: usize, address: u64) -> Option<Event> {
        let (light, probability) = self.light(lane)?;
        let sample = (self.is_valid & 1 << lane != 0).then(|| self.light_sample(lane));
        Some(Event::LightSampleFailed { address, light, probability, sample })
    }

    /// The directions of shadow rays from their origins, and the ends of the rays: t = 1 at points, and just before surfaces.
    #[inline(always)]
    pub(in crate::integrator) fn ways<W: Width>(
        &self,
        width: W,
        origins: Vector<W::Real>,
    ) -> (Vector<W::Real>, W::Real) {
        let mut way = load(width, &self.wi);
        if self.at_point | self.on_surface == 0 {
            return (way, width.splat(f32::INFINITY));
        }
        let position = load_f64(width, &self.position);
        if self.on_surface != 0 {
            let points = Points { position, error: load_f64(width, &self.error) };
            let end = points.just_before(load_f64(width, &self.normal), way, origins);
            way = Vector::select(width.mask(self.on_surface), end, way);
        }
        if self.at_point != 0 {
            let end = Vector::narrow(position - origins.widen());
            way = Vector::select(width.mask(self.at_point), end, way);
        }
        let ends: Mask<W> = width.mask(self.at_point | self.on_surface);
        (way, Float::select(ends, width.splat(1.0), width.splat(f32::INFINITY)))
    }
}
