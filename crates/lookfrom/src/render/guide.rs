//! The pre-pass that learns a guide to the environment: paths of a few samples, and rays from the points that they visit.
//!
//! It depends on the world, the camera and the integrator alone, by random numbers of its own: the same guide for any number of samples
//! and threads, any part of the picture, and any seed.

use std::ops::Range;
use std::sync::Arc;

use glam::Vec3;
use lookfrom_bvh::{OriginPrimitive, Ray};
use lookfrom_scene::settings::{Background, Integrator as Kind, Portals};

use super::{Batch, Renderer, SampleId};
use crate::core::parallel;
use crate::core::sampler::Sampler;
use crate::integrator::{Event, Path, Queues, Shadow, ShadowTransparency, StepOutput, Term, resolve_shadows};
use crate::light::{Guide, GuidePoint, Query};
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::interior_stack::InteriorStack;
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// Number of samples whose paths visit points, and of the first of them, which tell of most worlds that a guide does not help.
const SAMPLES: u32 = 8192;
const FIRST_SAMPLES: u32 = SAMPLES / 8;

/// The least estimated gain that is worth a guide: samples with one take 1.3 to 1.9 times as long, and estimated gains are about twice
/// those of pictures. By the first samples the estimate has more noise.
const LEAST_GAIN: f32 = 3.0;
const LEAST_GAIN_OF_FIRST: f32 = 2.5;

/// Number of samples, and of rays, that are traced together.
const TOGETHER: usize = 512;

/// The seed of the samples.
const SEED: u64 = 0x6775_6964_6573;

/// A point that a path visits, with what rays from it start at.
struct Visited {
    point: GuidePoint,
    /// `None` in a medium.
    surface: Option<Box<SurfaceInteraction>>,
}

impl Renderer {
    /// This renderer with a guide to the environment, if its settings ask for one and it helps.
    pub(super) fn with_guide(mut self) -> Self {
        let asks = self.asks_for_guide();
        let Some((light, environment)) = self.world.guidable().filter(|_| asks) else { return self };
        let world = &self.world;
        let learned = |visited: &mut [Visited], least_gain| {
            // Paths that are shaded together are told of in another order than those that are shaded alone; and neighbours must not follow
            // one another, since the learner takes points in turns.
            visited.sort_by_cached_key(|visited| visited.point.key());
            let visited = &*visited;
            let points: Vec<GuidePoint> = visited.iter().map(|visited| visited.point).collect();
            let visibility = |queries: &[Query]| visibility(world, light, visited, queries);
            Guide::learn(environment, &world.textures, &points, &visibility, least_gain)
        };
        let mut visited = self.visited(0..FIRST_SAMPLES);
        if learned(&mut visited, LEAST_GAIN_OF_FIRST).is_none() {
            return self;
        }
        visited.extend(self.visited(FIRST_SAMPLES..SAMPLES));
        if let Some(guide) = learned(&mut visited, LEAST_GAIN) {
            self.world = world.guided(light, &Arc::new(guide)).into();
        }
        self
    }

    fn asks_for_guide(&self) -> bool {
        self.settings.portals == Portals::Auto && self.settings.integrator == Kind::Path
    }

    /// Whether its settings ask for a guide, and it was given up.
    pub(crate) fn has_given_up_guide(&self) -> bool {
        self.asks_for_guide() && self.world.guidable().is_some() && !self.world.is_guided()
    }

    /// The points of all surfaces and media that paths of samples all over the picture visit, where light that is sampled counts.
    fn visited(&self, samples: Range<u32>) -> Vec<Visited> {
        let sampler = Sampler::new(self.settings.sampler, SEED);
        let renderer = Self { sampler, light_paths: None, ..self.clone() };
        let [width, height] = [self.image().width, self.image().height].map(f64::from);
        // Roberts' sequence R₂, in fractions of the picture.
        let at = |k: u32, step: f64, size: f64| ((0.5 + step * f64::from(k)).fract() * size) as u32;
        let ids: Vec<SampleId> = samples
            .map(|k| SampleId {
                pixel: [at(k, 0.754_877_666_246_692_7, width), at(k, 0.569_840_290_998_053_2, height)],
                sample: k,
            })
            .collect();
        let chunks: Vec<&[SampleId]> = ids.chunks(TOGETHER).collect();
        let visited = parallel::collect(chunks.len(), |chunk| {
            let (mut events, mut batch) = (Vec::new(), Batch::default());
            renderer.integrator.trace_events(&renderer, chunks[chunk], &mut events, &mut batch);
            events.into_iter().filter_map(Visited::of).collect::<Vec<_>>()
        });
        visited.into_iter().flatten().collect()
    }
}

impl Visited {
    /// The point of an event at which lights are sampled.
    fn of(event: Event) -> Option<Self> {
        match event {
            Event::Shaded { surface, shading, .. } => {
                let lobes = shading.bsdf.lobes();
                let (n, point) = (shading.n(), Vec3::from_array(surface.point.position.map(|x| x as f32)));
                let facing = if surface.wo.dot(n) < 0.0 { -n } else { n };
                let point = GuidePoint { point, n, facing, transmits: lobes.is_transmission() };
                lobes.is_non_specular().then_some(Self { point, surface: Some(surface) })
            }
            Event::Flown { point: Some(point), .. } | Event::Tracked { point: Some(point), .. } => {
                let (n, facing) = (Vec3::ZERO, Vec3::ZERO);
                Some(Self { point: GuidePoint { point, n, facing, transmits: false }, surface: None })
            }
            _ => None,
        }
    }

    /// The ray from it in a direction, and what it leaves.
    fn ray(&self, wi: Vec3) -> (Ray, OriginPrimitive) {
        match &self.surface {
            Some(surface) => (Ray::new(surface.origin(wi), wi.to_array()), surface.origin_primitive),
            None => (Ray::new(self.point.point.to_array(), wi.to_array()), OriginPrimitive::NONE),
        }
    }
}

/// The part of the light of an environment that arrives along each ray, as shadow rays find it in vacuum.
fn visibility(world: &World, light: u32, visited: &[Visited], queries: &[Query]) -> Vec<f32> {
    let chunks: Vec<&[Query]> = queries.chunks(TOGETHER).collect();
    let seen = parallel::collect(chunks.len(), |chunk| {
        let queries = chunks[chunk];
        let mode = SpectralMode::Rgb;
        let mut output = StepOutput {
            queues: Queues::default(),
            paths: Vec::<Path>::new(),
            background: Background::Environment,
            light_paths: None,
            probe: &mut (),
        };
        output.queues.start(queries.len(), std::iter::once(mode));
        for (slot, &(index, wi)) in (0..).zip(queries) {
            let (ray, origin_primitive) = visited[index as usize].ray(wi);
            output.queues.shadows.push(Shadow {
                ray,
                origin_primitive,
                contribution: mode.one(),
                slot,
                address: Path::ROOT,
                term: Term::Light(light),
                interior: InteriorStack::default(),
                last_scattering: Shadow::NO_SCATTERING,
                panes: u32::MAX,
            });
        }
        resolve_shadows(world, ShadowTransparency::Panes, &mut output);
        let arrived: Vec<f32> = output.queues.radiance.iter().map(|light| light.0[0]).collect();
        arrived
    });
    seen.into_iter().flatten().collect()
}
