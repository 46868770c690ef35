//! The trace log: events of a sample, arranged by rays.
//!
//! Rays form a tree (Whitted's, the child of n is 2n or 2n + 1) or a path (n is followed by n + 1), depending on the
//! integrator.

mod lights;
mod media;
mod rays;

use std::collections::BTreeMap;

use glam::Vec3;
use lookfrom_scene::settings::Integrator;

use super::microfacets::MicrofacetReport;
use super::report::{AbsorptionReport, Addition, Amount, BranchReport, Factor, RayReport};
use super::scatter::FoundReport;
use super::segments::RayKind;
use crate::core::spectrum::Spectrum;
use crate::integrator::{Branch, Cut, Event, Path, PreviousVertex, Term};
use crate::render::Renderer;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::material::Shading;
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// Builds a trace log from events.
pub(super) struct TraceLogBuilder<'a> {
    renderer: &'a Renderer,
    world: &'a World,
    /// The spectral mode at the end of the sample.
    mode: SpectralMode,
    /// The time of the sample while the shutter is open, from 0 to 1.
    time: f32,
    /// Whether the tests of primitives and the formulas of lights are reported.
    is_whole: bool,
    rays: BTreeMap<u64, RayReport>,
    /// The contribution of each ray's own hit.
    added: BTreeMap<u64, Spectrum>,
    /// The sum of all contributions, added in their order.
    sum: Spectrum,
    additions: Vec<Addition>,
    /// The BSDF at the hit of each ray of a path, and the direction to the viewer.
    shadings: BTreeMap<u64, (Shading, Vec3)>,
    /// Each ray, and the surface that it hit.
    hits: BTreeMap<u64, (Path<PreviousVertex>, Option<SurfaceInteraction>)>,
    /// The points where media scatter rays, in render space.
    in_media: BTreeMap<u64, Vec3>,
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
    pub(super) fn new(renderer: &'a Renderer, (mode, time): (SpectralMode, f32), is_whole: bool) -> Self {
        Self {
            renderer,
            world: renderer.world(),
            mode,
            time,
            is_whole,
            rays: BTreeMap::new(),
            added: BTreeMap::new(),
            sum: Spectrum::BLACK,
            additions: Vec::new(),
            shadings: BTreeMap::new(),
            hits: BTreeMap::new(),
            in_media: BTreeMap::new(),
        }
    }

    /// Records an event. A ray's own event comes before all others of that ray.
    pub(super) fn record(&mut self, event: &Event) {
        match event {
            Event::Hit { path, hit } => {
                let surface = hit.is_hit().then(|| self.world.surface_at(&path.ray, hit, self.time));
                let ray = self.ray(path, hit, surface.as_ref());
                self.rays.insert(path.address, ray);
                self.hits.insert(path.address, (*path, surface));
            }
            Event::Absorbed { address, interior, length, transmittance, beta } => {
                let Some(medium) = self.world.medium(*interior) else { return };
                let (sigma, scale) = self.world.extinction(medium, &self.mode);
                let material =
                    interior.material().map(|index| self.world.names.materials[index as usize].clone());
                let report = AbsorptionReport {
                    material,
                    sigma: self.factor(sigma),
                    scale,
                    length: *length,
                    transmittance: self.factor(*transmittance),
                    throughput: self.factor(*beta),
                };
                self.at(*address, |ray| {
                    ray.throughput_there = Some(report.throughput.clone());
                    ray.absorption = Some(report);
                });
            }
            Event::Flown { address, flight, point, .. } => self.flown(*address, flight, *point),
            Event::Tracked { address, tracking, point } => self.tracked(*address, tracking, *point),
            Event::ScatteredInMedium { address, sample } => self.phase(*address, sample),
            Event::Probed { address, probe } => {
                let report = self.probe(probe);
                self.at(*address, |ray| ray.probe = Some(report));
            }
            Event::Surface { address, coefficients, .. } => {
                let report = coefficients.as_deref().map(|k| self.coefficients(k));
                if let Some(met) = self.rays.get_mut(address).and_then(|ray| ray.met.as_mut()) {
                    met.coefficients = report;
                }
            }
            Event::LocalLight { address, light, sample, diffuse, specular } => {
                let report = self.light(*address, *light, sample.as_ref(), [*diffuse, *specular]);
                self.at(*address, |ray| ray.lights.push(report));
            }
            Event::Shaded { address, shading, beta, surface } => {
                self.shadings.insert(*address, (**shading, surface.wo));
                self.shaded(*address, shading, *beta);
            }
            Event::Found { address, light, radiance, light_pdf, weight, beta } => {
                let report = FoundReport {
                    index: *light,
                    light: self.world.names.lights[*light as usize].clone(),
                    radiance: self.amount(*radiance),
                    emission: self.emission(*light, *radiance),
                    light_pdf: *light_pdf,
                    sampling: self.found_sampling(*address, *light, *radiance, *light_pdf),
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
                let sample = sample.as_ref().map(|sample| {
                    self.direction(*address, (*light, *probability), sample, Spectrum::BLACK, None, 1.0)
                });
                self.light_sample(*address, *light, *probability, sample);
            }
            Event::LightSampled { address, light, probability, sample, f, bsdf_pdf, weight } => {
                let is_weighted = self.renderer.settings().integrator == Integrator::Path
                    && !self.world.lights[*light as usize].is_delta();
                let bsdf_pdf = is_weighted.then_some(*bsdf_pdf);
                let sample = self.direction(*address, (*light, *probability), sample, *f, bsdf_pdf, *weight);
                self.light_sample(*address, *light, *probability, Some(sample));
            }
            Event::Shadow { shadow, hit, passed } => self.shadow(shadow, hit, *passed),
            Event::Bounced { address, bounce } => {
                let report = self.bounce(*address, bounce);
                self.at(*address, |ray| ray.bounce = Some(report));
            }
            Event::Grew { address, branch, direction, weight, fresnel, total_reflection, cut } => {
                let (kind, bit) = match branch {
                    Branch::Mirrored => (RayKind::Reflected, 0),
                    Branch::Refracted => (RayKind::Refracted, 1),
                };
                let met = self.rays.get(address).and_then(|ray| ray.met.as_ref());
                let n = met.map_or(Vec3::ZERO, |met| Vec3::from_array(met.n));
                let eta = met.and_then(|met| {
                    let ior = met.coefficients.as_ref()?.ior;
                    (*branch == Branch::Refracted).then_some(if met.front { ior } else { 1.0 / ior })
                });
                let report = BranchReport {
                    address: address << 1 | bit,
                    kind,
                    direction: direction.to_array(),
                    cos: n.dot(*direction).abs(),
                    eta,
                    weight: self.factor(*weight),
                    fresnel: *fresnel,
                    total_reflection: *total_reflection,
                    cut: cut.map(|cut| match cut {
                        Cut::Contribution => "share below min_contribution",
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
            let departure = self.hits.get(&address).and_then(|(path, _)| self.departure(parent, &path.ray));
            // What no branch leads to has passed its parent's surface.
            let has_branch = self
                .rays
                .get(&parent)
                .is_some_and(|ray| ray.branches.iter().any(|branch| branch.address == address));
            self.at(address, |ray| {
                if has_parent && !is_path && !has_branch {
                    ray.kind = RayKind::StraightOn;
                }
                ray.parent = has_parent.then_some(parent);
                ray.departure = departure;
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
            if let Some(phase) = &mut ray.phase {
                phase.next_throughput.clone_from(&next);
            }
            let kind_of_next = match &mut ray.bounce {
                _ if ray.phase.is_some() => RayKind::Scattered,
                Some(bounce) => {
                    let probe = ray.probe.as_ref();
                    bounce.next_throughput =
                        probe.map(|probe| probe.throughput_before.clone()).or_else(|| next.clone());
                    match settings.integrator {
                        Integrator::RandomWalk => RayKind::Scattered,
                        _ if bounce.lobe.ends_with("transmission") => RayKind::Transmitted,
                        _ => RayKind::Reflected,
                    }
                }
                None => RayKind::StraightOn,
            };
            if next.is_some() {
                self.at(address + 1, |next| next.kind = kind_of_next);
                continue;
            }
            let is_scattered = ray.scattered_at().is_some();
            ray.ends = Some(match (&ray.met, &ray.scattering, &ray.bounce) {
                _ if is_scattered => match &ray.phase {
                    Some(phase) if !phase.survives => "Russian roulette ends it",
                    None if ray.depth >= settings.depth => "the maximum depth is reached",
                    _ => "its throughput is 0",
                },
                (None, ..) => "it leaves the scene",
                (Some(_), None, _) => "ambient occlusion needs no further rays",
                (_, Some(_), None) if ray.depth >= settings.depth => "the maximum depth is reached",
                (_, Some(_), None) => "the surface absorbs its light: no direction could be sampled",
                (.., Some(bounce)) if !bounce.survives => "Russian roulette ends it",
                (.., Some(_)) if ray.probe.is_some() => "no point is found where it would leave",
                (.., Some(_)) => "its throughput is 0",
            });
        }
    }

    /// The factors of the microfacets at the hit of a ray, for light from a direction.
    fn microfacets(&self, address: u64, wi: Vec3, is_specular: bool) -> Vec<MicrofacetReport> {
        let Some((shading, wo)) = self.shadings.get(&address) else { return Vec::new() };
        let factors = shading.factors(*wo, wi, is_specular);
        factors.iter().map(|factors| MicrofacetReport::new(factors, |value| self.factor(value))).collect()
    }

    fn at(&mut self, address: u64, change: impl FnOnce(&mut RayReport)) {
        if let Some(ray) = self.rays.get_mut(&address) {
            change(ray);
        }
    }

    /// The lanes that are in use.
    fn factor(&self, value: Spectrum) -> Factor {
        match self.mode {
            SpectralMode::Rgb => value.rgb().to_vec(),
            SpectralMode::Spectral(_) => value.0.to_vec(),
        }
    }

    fn amount(&self, value: Spectrum) -> Amount {
        Amount { lanes: self.factor(value), rgb: self.renderer.measured(value, &self.mode) }
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
            Term::Medium => ray.medium_emission = Some(amount),
            Term::Sky | Term::Emission | Term::Ambient | Term::View | Term::Unoccluded => {}
        });
    }

    fn term_name(&self, term: Term) -> String {
        let name = |light: u32| &self.world.names.lights[light as usize];
        match term {
            Term::Sky => "sky".into(),
            Term::Emission => "emission".into(),
            Term::Medium => "medium".into(),
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
