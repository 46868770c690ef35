//! Events of lights: samples, shadow rays.

use glam::{DVec3, Vec3};
use lookfrom_bvh::Hit;
use lookfrom_scene::settings::Integrator;

use super::TraceLogBuilder;
use crate::core::spectrum::Spectrum;
use crate::inspect::candidate::{self, TraversalReport};
use crate::inspect::report::{Blocker, LightReport, ShadowReport};
use crate::inspect::scatter::{FoundSampling, LightSampleReport, SampledDirectionReport};
use crate::integrator::{Shadow, Term};
use crate::light::derivation::Derivation;
use crate::light::{IncompletePdf, Light, LightSample, LightSampleContext, Target};
use crate::world::World;

impl TraceLogBuilder<'_> {
    /// The light of Whitted's model; `terms` are the diffuse and the specular one.
    pub(super) fn light(
        &self,
        address: u64,
        index: u32,
        sample: Option<&LightSample>,
        terms: [Spectrum; 2],
    ) -> LightReport {
        let intensity = sample.map(|sample| sample.li / (std::f32::consts::PI * sample.pdf));
        let met = self.rays.get(&address).and_then(|ray| ray.met.as_ref());
        let [n, wo] = met.map_or([Vec3::ZERO; 2], |met| [met.n, met.wo].map(Vec3::from_array));
        let h = sample.map(|sample| (wo + sample.wi).normalize_or_zero());
        LightReport {
            index,
            light: self.world.names.lights[index as usize].clone(),
            wi: sample.map(|sample| sample.wi.to_array()),
            n_dot_l: sample.map(|sample| n.dot(sample.wi)),
            h: h.map(|h| h.to_array()),
            n_dot_h: h.map(|h| n.dot(h)),
            arrives: self.amount(sample.map(|sample| sample.li).unwrap_or_default()),
            pdf: sample.map(|sample| sample.pdf),
            point: sample.and_then(|sample| target(self.world, sample)),
            derivations: sample.map(|sample| self.derivations(address, index, sample)).unwrap_or_default(),
            intensity: self.amount(intensity.unwrap_or_default()),
            diffuse: self.factor(terms[0]),
            specular: self.factor(terms[1]),
            shadow: None,
            added: self.amount(Spectrum::BLACK),
        }
    }

    /// The formulas of a light's sample at the hit of a ray.
    fn derivations(&self, address: u64, light: u32, sample: &LightSample) -> Vec<Derivation> {
        let Some((at, incomplete_pdf)) = self.light_context(address) else { return Vec::new() };
        let of_sample = self.derivations_at(&at, light, sample, incomplete_pdf);
        self.emission(light, sample.li).into_iter().chain(of_sample).collect()
    }

    /// The point and the normal for which lights are sampled at the hit of a ray, or where a medium scatters it.
    fn light_context(&self, address: u64) -> Option<(LightSampleContext, IncompletePdf)> {
        if let Some(point) = self.in_media.get(&address) {
            let at = LightSampleContext { point: point.as_dvec3(), n: Vec3::ZERO, time: self.time };
            return Some((at, IncompletePdf::Allowed));
        }
        let (_, surface) = self.hits.get(&address)?;
        let surface = surface.as_ref()?;
        let point = DVec3::from_array(surface.point.position);
        // Along paths light is sampled by the frame of the BSDF, and BSDF sampling finds what light sampling leaves out.
        let (n, incomplete_pdf) = match self.shadings.get(&address) {
            Some((shading, _)) => (shading.n(), IncompletePdf::Allowed),
            None => (surface.ns_facing(), IncompletePdf::Forbidden),
        };
        Some((LightSampleContext { point, n, time: self.time }, incomplete_pdf))
    }

    /// The derivations at a point, without the radiance of an area light.
    fn derivations_at(
        &self,
        at: &LightSampleContext,
        light: u32,
        sample: &LightSample,
        incomplete_pdf: IncompletePdf,
    ) -> Vec<Derivation> {
        if !self.is_whole {
            return Vec::new();
        }
        let light = &self.world.lights[light as usize];
        light.derivations(&self.world.textures, at, sample, &self.mode, incomplete_pdf)
    }

    /// The formula of an area light's radiance.
    pub(super) fn emission(&self, light: u32, radiance: Spectrum) -> Option<Derivation> {
        if !self.is_whole {
            return None;
        }
        self.world.lights[light as usize].emission(&self.world.textures, radiance, &self.mode)
    }

    /// The density with which light sampling at the surface before finds the light that a ray hit.
    pub(super) fn found_sampling(
        &self,
        address: u64,
        light: u32,
        radiance: Spectrum,
        light_pdf: f32,
    ) -> Option<FoundSampling> {
        let (path, surface) = self.hits.get(&address)?;
        let samples_lights =
            matches!(self.renderer.settings().integrator, Integrator::Path | Integrator::SimplePath);
        let of_light = &self.world.lights[light as usize];
        let is_left_out = light_pdf == 0.0 && !matches!(of_light, Light::Environment(_));
        if !samples_lights || path.state.pdf.is_infinite() || is_left_out {
            return None;
        }
        let at = path.state.light_context(self.time);
        let surface = surface.as_ref();
        let wi =
            surface.map_or_else(|| Vec3::from_array(path.ray.direction).normalize(), |surface| -surface.wo);
        let choice = self.world.light_choice();
        let probability = choice.probability(&at, light);
        if probability == 0.0 {
            return None;
        }
        let density = of_light.pdf(&at, wi, surface, IncompletePdf::Allowed);
        let target = surface.map_or(Target::Infinity, |surface| Target::Surface(surface.point, surface.ng));
        let sample = LightSample { wi, li: radiance, pdf: density, target };
        Some(FoundSampling {
            probability,
            choice: self.choice_at(&at, light),
            density,
            derivations: self.derivations_at(&at, light, &sample, IncompletePdf::Allowed),
        })
    }

    /// The formulas of a light's probability at the hit of a ray.
    fn choice(&self, address: u64, light: u32) -> Vec<Derivation> {
        self.light_context(address).map(|(at, _)| self.choice_at(&at, light)).unwrap_or_default()
    }

    fn choice_at(&self, at: &LightSampleContext, light: u32) -> Vec<Derivation> {
        if !self.is_whole {
            return Vec::new();
        }
        let world = self.world;
        world.light_choice().derivations(&world.lights, &world.textures, at, light)
    }

    pub(super) fn direction(
        &self,
        address: u64,
        (light, probability): (u32, f32),
        sample: &LightSample,
        f_cos: Spectrum,
        bsdf_pdf: Option<f32>,
        weight: f32,
    ) -> SampledDirectionReport {
        SampledDirectionReport {
            wi: sample.wi.to_array(),
            light_pdf: sample.pdf,
            pdf: probability * sample.pdf,
            point: target(self.world, sample),
            derivations: self.derivations(address, light, sample),
            is_delta: self.world.lights[light as usize].is_delta(),
            arrives: self.amount(sample.li),
            f_cos: self.factor(f_cos),
            microfacets: Vec::new(),
            bsdf_pdf,
            weight,
        }
    }

    pub(super) fn light_sample(
        &mut self,
        address: u64,
        index: u32,
        probability: f32,
        mut sample: Option<SampledDirectionReport>,
    ) {
        if let Some(sample) = sample.as_mut().filter(|sample| sample.f_cos.iter().any(|lane| *lane != 0.0)) {
            sample.microfacets = self.microfacets(address, Vec3::from_array(sample.wi), false);
        }
        let light = self.world.names.lights[index as usize].clone();
        let added = self.amount(Spectrum::BLACK);
        let choice = self.choice(address, index);
        let report = LightSampleReport { index, light, probability, choice, sample, shadow: None, added };
        self.at(address, |ray| ray.light_sample = Some(report));
    }

    pub(super) fn shadow(&mut self, shadow: &Shadow, hit: &Hit, passed: Spectrum) {
        let world = self.world;
        let blocker = hit.is_hit().then(|| {
            let surface = world.surface_at(&shadow.ray, hit, self.time);
            let shape = world.names.shapes[surface.shape as usize].of(surface.primitive);
            let point = (world.origin + DVec3::from_array(surface.point.position)).to_array();
            Blocker { shape, t: hit.t, point, passed: self.factor(passed) }
        });
        // A ray of a probe stops at a first surface that blocks it: only one that reaches the light has a rest.
        let rest = (!hit.is_hit()).then(|| self.factor(passed));
        let departure = self.departure(shadow.address, &shadow.ray);
        let traversal = match self.is_whole {
            true => candidate::of_shadow(world, &shadow.ray, self.time),
            false => TraversalReport::default(),
        };
        let collisions = self.null_collisions(shadow, if hit.is_hit() { hit.t } else { shadow.ray.t_max });
        let Some(ray) = self.rays.get_mut(&shadow.address) else { return };
        let report = match shadow.term {
            Term::Light(light) => match ray.lights.iter_mut().find(|report| report.index == light) {
                Some(report) => &mut report.shadow,
                None => match &mut ray.light_sample {
                    Some(report) => &mut report.shadow,
                    None => return,
                },
            },
            _ => &mut ray.openness,
        };
        let [origin, direction] =
            [shadow.ray.origin, shadow.ray.direction].map(|v| Vec3::from_array(v).as_dvec3());
        // behind a transparent surface the rest of the way is shorter
        let is_endless = shadow.ray.t_max.is_infinite();
        let length = if is_endless { 1.0 } else { f64::from(shadow.ray.t_max) };
        let [from, to] = [origin, origin + direction * length].map(|point| (world.origin + point).to_array());
        let report = report.get_or_insert(ShadowReport {
            from,
            departure,
            to,
            is_endless,
            blockers: Vec::new(),
            collisions: Vec::new(),
            rest: None,
            traversal: TraversalReport::default(),
        });
        report.to = to;
        report.rest = rest;
        report.traversal.nodes += traversal.nodes;
        report.traversal.culled += traversal.culled;
        report.traversal.tests += traversal.tests;
        report.blockers.extend(blocker);
        report.collisions.extend(collisions);
    }
}

/// The point on a light that a sample aims at, in the world; `None` infinitely far away.
fn target(world: &World, sample: &LightSample) -> Option<[f64; 3]> {
    let position = match sample.target {
        Target::Point(position) => position,
        Target::Surface(point, _) => DVec3::from_array(point.position),
        Target::Infinity => return None,
    };
    Some((world.origin + position).to_array())
}
