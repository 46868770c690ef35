//! The trace log: events of a sample, arranged by rays.
//!
//! Rays form a tree (Whitted's, the child of n is 2n or 2n + 1) or a path (n is followed by n + 1), depending on the
//! integrator.

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};
use lookfrom_bvh::{Hit, NONE};
use lookfrom_scene::settings::Integrator;

use super::candidate::Candidate;
use super::report::{
    Addition, Amount, Blocker, BranchReport, CoefficientsReport, Factor, LightReport, MetReport, RayReport,
    ShadowReport,
};
use super::scatter::{self, BounceReport, FoundReport, LightSampleReport, SampledDirectionReport};
use crate::core::spectrum::Spectrum;
use crate::integrator::{Bounce, Branch, Cut, Event, Path, Shadow, Term};
use crate::light::LightSample;
use crate::render::Renderer;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::material::{Coefficients, Shading};
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// Builds a trace log from events.
pub(super) struct TraceLogBuilder<'a> {
    renderer: &'a Renderer,
    world: &'a World,
    /// The spectral mode at the end of the sample.
    lanes: SpectralMode,
    rays: BTreeMap<u64, RayReport>,
    /// The contribution of each ray's own hit.
    added: BTreeMap<u64, Spectrum>,
    /// The sum of all contributions, added in their order.
    sum: Spectrum,
    additions: Vec<Addition>,
}

/// The finished trace log.
pub(super) struct TraceLog {
    pub(super) rays: Vec<RayReport>,
    pub(super) additions: Vec<Addition>,
    pub(super) sum: Spectrum,
    pub(super) radiance: Amount,
}

/// Whether the rays form a path: n is followed by n + 1.
fn is_path(integrator: Integrator) -> bool {
    use Integrator::{AmbientOcclusion, Path, RandomWalk, SimplePath};
    matches!(integrator, Path | SimplePath | RandomWalk | AmbientOcclusion { .. })
}

impl<'a> TraceLogBuilder<'a> {
    /// An empty log.
    pub(super) fn new(renderer: &'a Renderer, lanes: SpectralMode) -> Self {
        Self {
            renderer,
            world: renderer.world(),
            lanes,
            rays: BTreeMap::new(),
            added: BTreeMap::new(),
            sum: Spectrum::BLACK,
            additions: Vec::new(),
        }
    }

    /// Records an event, and the primitives that were tested for a hit. A ray's own event comes before all others of that ray.
    pub(super) fn record(&mut self, event: &Event, candidates: Vec<Candidate>) {
        match event {
            Event::Hit { path, hit } => {
                let ray = self.ray(path, hit, candidates);
                self.rays.insert(path.address, ray);
            }
            Event::Surface { address, coefficients, .. } => {
                let report = coefficients.as_deref().map(|k| self.coefficients(k));
                if let Some(met) = self.rays.get_mut(address).and_then(|ray| ray.met.as_mut()) {
                    met.coefficients = report;
                }
            }
            Event::LocalLight { address, light, sample, diffuse, specular } => {
                let report = self.light(*light, sample.as_ref(), *diffuse, *specular);
                self.at(*address, |ray| ray.lights.push(report));
            }
            Event::Shaded { address, shading, beta, .. } => self.shaded(*address, shading, *beta),
            Event::Found { address, light, radiance, light_pdf, weight, beta } => {
                let report = FoundReport {
                    index: *light,
                    light: self.world.names.lights[*light as usize].clone(),
                    radiance: self.amount(*radiance),
                    light_pdf: *light_pdf,
                    weight: *weight,
                    added: self.amount(Spectrum::BLACK),
                };
                let throughput = self.factor(*beta);
                self.at(*address, |ray| {
                    if throughput != ray.throughput {
                        ray.throughput_there = Some(throughput);
                    }
                    ray.found.push(report);
                });
            }
            Event::LightSampleFailed { address, light, probability, sample } => {
                let sample = sample
                    .as_ref()
                    .map(|sample| self.direction(*probability, sample, Spectrum::BLACK, None, 1.0));
                self.light_sample(*address, *light, *probability, sample);
            }
            Event::LightSampled { address, light, probability, sample, f, bsdf_pdf, weight } => {
                let is_weighted = self.renderer.settings().integrator == Integrator::Path
                    && !self.world.lights[*light as usize].is_delta();
                let bsdf_pdf = is_weighted.then_some(*bsdf_pdf);
                let sample = self.direction(*probability, sample, *f, bsdf_pdf, *weight);
                self.light_sample(*address, *light, *probability, Some(sample));
            }
            Event::Shadow { shadow, hit, passed } => self.shadow(shadow, hit, *passed),
            Event::Bounced { address, bounce } => {
                let report = self.bounce(*address, bounce);
                self.at(*address, |ray| ray.bounce = Some(report));
            }
            Event::Grew { address, branch, weight, fresnel, total_reflection, cut } => {
                let (kind, bit) = match branch {
                    Branch::Mirrored => ("reflected", 0),
                    Branch::Refracted => ("refracted", 1),
                };
                let report = BranchReport {
                    address: address << 1 | bit,
                    kind,
                    weight: self.factor(*weight),
                    fresnel: *fresnel,
                    total_reflection: *total_reflection,
                    cut: cut.map(|cut| match cut {
                        Cut::Contribution => "can no longer change the pixel",
                        Cut::Depth => "the maximum depth is reached",
                    }),
                };
                self.at(*address, |ray| ray.branches.push(report));
            }
            Event::Add { address, term, value } => self.add(*address, *term, *value),
        }
    }

    /// Finishes the log: computes the sums.
    pub(super) fn end(mut self) -> TraceLog {
        let is_path = is_path(self.renderer.settings().integrator);
        if is_path {
            self.end_paths();
        }
        let in_sequence = self.renderer.settings().integrator != Integrator::Whitted;

        // Children have larger addresses than their parents: from the last to the first, each is added to its parent.
        let mut subtrees = self.added.clone();
        let addresses: Vec<u64> = self.rays.keys().copied().collect();
        for &address in addresses.iter().rev() {
            let subtree = subtrees.get(&address).copied().unwrap_or_default();
            let parent = if in_sequence { address - 1 } else { address >> 1 };
            let has_parent = self.rays.contains_key(&parent);
            if has_parent {
                *subtrees.entry(parent).or_default() += subtree;
            }
            let own = self.amount(self.added.get(&address).copied().unwrap_or_default());
            let subtree = self.amount(subtree);
            // What no branch leads to has passed its parent's surface.
            let has_branch = self
                .rays
                .get(&parent)
                .is_some_and(|ray| ray.branches.iter().any(|branch| branch.address == address));
            self.at(address, |ray| {
                if has_parent && !is_path && !has_branch {
                    ray.kind = "straight on";
                }
                ray.parent = has_parent.then_some(parent);
                ray.added = own;
                ray.subtree = subtree;
            });
        }
        let radiance = self.amount(self.sum);
        TraceLog {
            rays: self.rays.into_values().collect(),
            additions: self.additions,
            sum: self.sum,
            radiance,
        }
    }

    /// Completes what depends on the next ray of a path: kinds of rays, and the reason why the path ends.
    fn end_paths(&mut self) {
        let settings = self.renderer.settings();
        let addresses: Vec<u64> = self.rays.keys().copied().collect();
        for address in addresses {
            let next = self.rays.get(&(address + 1)).map(|next| next.throughput.clone());
            let Some(ray) = self.rays.get_mut(&address) else { continue };
            let kind_of_next = match &mut ray.bounce {
                Some(bounce) => {
                    bounce.next_throughput.clone_from(&next);
                    match settings.integrator {
                        Integrator::RandomWalk => "scattered",
                        _ if bounce.lobe.ends_with("transmission") => "transmitted",
                        _ => "reflected",
                    }
                }
                None => "straight on",
            };
            if next.is_some() {
                self.at(address + 1, |next| next.kind = kind_of_next);
                continue;
            }
            ray.ends = Some(match (&ray.met, &ray.scattering, &ray.bounce) {
                (None, ..) => "it leaves the scene",
                (Some(_), None, _) => "ambient occlusion needs no further rays",
                (_, Some(_), None) if ray.depth >= settings.depth => "the maximum depth is reached (--depth)",
                (_, Some(_), None) => "the surface absorbs its light: no direction could be sampled",
                (.., Some(bounce)) if !bounce.survives => "Russian roulette ends it",
                (.., Some(_)) => "its throughput is 0",
            });
        }
    }

    fn at(&mut self, address: u64, change: impl FnOnce(&mut RayReport)) {
        if let Some(ray) = self.rays.get_mut(&address) {
            change(ray);
        }
    }

    /// The lanes that are in use.
    fn factor(&self, value: Spectrum) -> Factor {
        match self.lanes {
            SpectralMode::Rgb => value.rgb().to_vec(),
            SpectralMode::Spectral(_) => value.0.to_vec(),
        }
    }

    fn amount(&self, value: Spectrum) -> Amount {
        Amount { lanes: self.factor(value), rgb: self.renderer.rgb(value, &self.lanes) }
    }

    fn ray(&self, path: &Path, hit: &Hit, candidates: Vec<Candidate>) -> RayReport {
        let kind = match (path.address, path.address & 1) {
            (Path::ROOT, _) => "camera",
            (_, 0) => "reflected",
            _ => "refracted",
        };
        let pdf = path.previous.pdf;
        let surface = hit.is_hit().then(|| self.world.surface(&path.ray, hit));
        RayReport {
            address: path.address,
            parent: None,
            kind,
            depth: path.depth,
            a: in_world(self.world, path.ray.origin),
            direction: path.ray.direction,
            throughput: self.factor(path.beta),
            // Infinite stands for a specular bounce or a camera ray.
            pdf: (pdf != f32::INFINITY).then_some(pdf),
            candidates,
            met: surface.map(|surface| met_report(self.world, hit, &surface)),
            throughput_there: None,
            only_color: None,
            found: Vec::new(),
            scattering: None,
            lights: Vec::new(),
            light_sample: None,
            openness: None,
            bounce: None,
            branches: Vec::new(),
            ends: None,
            added: Amount::default(),
            subtree: Amount::default(),
        }
    }

    fn coefficients(&self, k: &Coefficients) -> CoefficientsReport {
        CoefficientsReport {
            ambient: self.factor(k.ambient),
            diffuse: self.factor(k.diffuse),
            specular: self.factor(k.specular),
            shininess: k.shininess,
            mirror: self.factor(k.mirror),
            transmission: self.factor(k.transmission),
            ior: k.ior,
        }
    }

    fn light(
        &self,
        index: u32,
        sample: Option<&LightSample>,
        diffuse: Spectrum,
        specular: Spectrum,
    ) -> LightReport {
        let intensity = sample.map(|sample| sample.li / (std::f32::consts::PI * sample.pdf));
        LightReport {
            index,
            light: self.world.names.lights[index as usize].clone(),
            wi: sample.map(|sample| sample.wi.to_array()),
            intensity: self.amount(intensity.unwrap_or_default()),
            diffuse: self.factor(diffuse),
            specular: self.factor(specular),
            shadow: None,
            added: self.amount(Spectrum::BLACK),
        }
    }

    fn shaded(&mut self, address: u64, shading: &Shading, beta: Spectrum) {
        let report = scatter::scattering(shading, |value| self.factor(value));
        let throughput = self.factor(beta);
        let only = match self.lanes {
            SpectralMode::Rgb => beta.only_lane().map(|lane| ["red", "green", "blue", ""][lane]),
            SpectralMode::Spectral(_) => None,
        };
        self.at(address, |ray| {
            let had_others = ray.throughput.iter().filter(|lane| **lane != 0.0).count() > 1;
            ray.only_color = only.filter(|_| had_others);
            ray.scattering = Some(report);
            ray.throughput_there = Some(throughput);
        });
    }

    fn direction(
        &self,
        probability: f32,
        sample: &LightSample,
        f_cos: Spectrum,
        bsdf_pdf: Option<f32>,
        weight: f32,
    ) -> SampledDirectionReport {
        SampledDirectionReport {
            wi: sample.wi.to_array(),
            light_pdf: sample.pdf,
            pdf: probability * sample.pdf,
            arrives: self.amount(sample.li),
            f_cos: self.factor(f_cos),
            bsdf_pdf,
            weight,
        }
    }

    fn light_sample(
        &mut self,
        address: u64,
        index: u32,
        probability: f32,
        sample: Option<SampledDirectionReport>,
    ) {
        let light = self.world.names.lights[index as usize].clone();
        let added = self.amount(Spectrum::BLACK);
        let report = LightSampleReport { index, light, probability, sample, shadow: None, added };
        self.at(address, |ray| ray.light_sample = Some(report));
    }

    fn shadow(&mut self, shadow: &Shadow, hit: &Hit, passed: Spectrum) {
        let world = self.world;
        let blocker = hit.is_hit().then(|| {
            let surface = world.surface(&shadow.ray, hit);
            let shape = world.names.shapes[surface.shape as usize].clone();
            Blocker { shape, passed: self.factor(passed) }
        });
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
        let report = report.get_or_insert(ShadowReport { from, to, is_endless, blockers: Vec::new() });
        report.to = to;
        report.blockers.extend(blocker);
    }

    fn bounce(&self, address: u64, bounce: &Bounce) -> BounceReport {
        let sample = &bounce.sample;
        BounceReport {
            lobe: scatter::words(sample.lobe),
            letters: scatter::letters(sample.lobe),
            wi: bounce.wi.to_array(),
            f: self.factor(sample.f),
            cos: bounce.cos,
            pdf: sample.pdf,
            pdf_is_proportional: sample.pdf_is_proportional,
            eta: sample.eta,
            throughput_before: self
                .rays
                .get(&address)
                .and_then(|ray| ray.throughput_there.clone())
                .unwrap_or_default(),
            throughput_after: self.factor(bounce.beta),
            survival: bounce.survival,
            survives: bounce.survives,
            next_throughput: None,
        }
    }

    fn add(&mut self, address: u64, term: Term, value: Spectrum) {
        self.sum += value;
        *self.added.entry(address).or_default() += value;
        let amount = self.amount(value);
        let term_name = self.term_name(term);
        self.additions.push(Addition { address, term: term_name, value: amount.clone() });
        self.at(address, |ray| match term {
            Term::Light(light) => {
                if let Some(report) = ray.lights.iter_mut().find(|report| report.index == light) {
                    report.added = amount;
                } else if let Some(report) = &mut ray.light_sample {
                    report.added = amount;
                }
            }
            Term::Found { light, .. } => {
                if let Some(report) = ray.found.iter_mut().find(|report| report.index == light) {
                    report.added = amount;
                }
            }
            Term::Sky | Term::Emission | Term::Ambient | Term::View | Term::Unoccluded => {}
        });
    }

    fn term_name(&self, term: Term) -> String {
        let name = |light: u32| &self.world.names.lights[light as usize];
        match term {
            Term::Sky => "sky".into(),
            Term::Emission => "emission".into(),
            Term::Ambient => "ambient".into(),
            Term::View => "view".into(),
            Term::Unoccluded => "open sky".into(),
            Term::Found { light, .. } => format!("found {}", name(light)),
            Term::Light(light) if is_path(self.renderer.settings().integrator) => {
                format!("sampled {}", name(light))
            }
            Term::Light(light) => name(light).clone(),
        }
    }
}

fn met_report(world: &World, hit: &Hit, surface: &SurfaceInteraction) -> MetReport {
    MetReport {
        shape: world.names.shapes[surface.shape as usize].clone(),
        primitive: hit.primitive,
        instance: (hit.instance != NONE).then_some(hit.instance),
        t: hit.t,
        point: (world.origin + DVec3::from_array(surface.point.position)).to_array(),
        error: surface.point.error,
        ng: surface.ng.to_array(),
        n: surface.ns_facing().to_array(),
        uv: surface.uv.to_array(),
        front: surface.front,
        material: world.names.materials[surface.material as usize].clone(),
        coefficients: None,
    }
}

fn in_world(world: &World, point: [f32; 3]) -> [f64; 3] {
    (world.origin + Vec3::from_array(point).as_dvec3()).to_array()
}
