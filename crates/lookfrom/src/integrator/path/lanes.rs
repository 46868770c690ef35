//! Path tracing eight paths at a time: paths wait until eight of them have met BSDFs of one class, and are then scattered
//! side by side.
//!
//! `kernel` computes in lanes (light samples, BSDF, densities, origins of rays); here its results become rays and events,
//! path by path. Which paths are together does not affect a result: lanes do not depend on one another.
//!
//! Binning by material: Laine, Karras & Aila 2013; Áfra et al. 2016 (local shading coherence on CPUs).

mod flat_diffuse;
mod kernel;
mod light_samples;

use glam::Vec3;
use lookfrom_bvh::{OriginPrimitive, Ray};

pub(super) use flat_diffuse::FlatDiffuseHit;
use kernel::{ScatterKernel, Scattered};

use super::{PathTracer, PreviousVertex, Vertex};
use crate::core::lanes::{LANES, by_lane};
use crate::core::math::power_heuristic;
use crate::integrator::shadow;
use crate::integrator::{Bounce, Event, Path, Probe, SampleStream, Shadow, StepOutput, Term};
use crate::light::Target;
use crate::shading::bsdf::conductor::Conductor;
use crate::shading::bsdf::dielectric::Dielectric;
use crate::shading::bsdf::diffuse::Diffuse;
use crate::shading::bsdf::lanes::RowBsdf;
use crate::shading::bsdf::layered::Layered;
use crate::shading::bsdf::{Bsdf, BsdfSample};
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::interior_stack::InteriorStack;
use crate::world::World;

/// Number of classes of BSDFs that are scattered in lanes.
const CLASSES: usize = 5;

/// The class of a BSDF, if it is scattered in lanes.
#[inline]
fn class(bsdf: &Bsdf) -> Option<usize> {
    match bsdf {
        Bsdf::Diffuse(_) => Some(0),
        Bsdf::Conductor(_) => Some(1),
        Bsdf::Dielectric(_) => Some(2),
        Bsdf::CoatedDiffuse(_) => Some(3),
        Bsdf::CoatedConductor(_) => Some(4),
        _ => None,
    }
}

/// Vertices of paths that wait for others of their class.
#[derive(Default)]
pub(super) struct Waiting([Vec<Vertex>; CLASSES]);

impl Waiting {
    /// Adds a vertex, and scatters the vertices of its class where they fill the lanes. Gives the vertex back where its BSDF
    /// has no class.
    #[inline]
    pub(super) fn push<P: Probe>(
        &mut self,
        tracer: &PathTracer,
        world: &World,
        vertex: Vertex,
        output: &mut StepOutput<'_, P>,
    ) -> Option<Vertex> {
        let Some(class) = class(&vertex.shading.bsdf) else { return Some(vertex) };
        let vertices = &mut self.0[class];
        if vertices.capacity() == 0 {
            vertices.reserve_exact(LANES);
        }
        vertices.push(vertex);
        if vertices.len() == LANES {
            tracer.scatter_class(world, class, vertices, output);
            vertices.clear();
        }
        None
    }

    /// Scatters the vertices that are left.
    pub(super) fn flush<P: Probe>(
        &mut self,
        tracer: &PathTracer,
        world: &World,
        output: &mut StepOutput<'_, P>,
    ) {
        for (class, vertices) in self.0.iter_mut().enumerate() {
            tracer.scatter_class(world, class, vertices, output);
            vertices.clear();
        }
    }
}

/// What is known of a path before its surface scatters it, in one lane.
#[derive(Clone, Copy)]
struct Item<'a> {
    path: &'a Path,
    stream: &'a SampleStream,
    origin_primitive: OriginPrimitive,
    /// The surface, where it may change what the path travels in.
    surface: Option<&'a SurfaceInteraction>,
    is_catcher: bool,
}

impl Item<'_> {
    /// The media around light that has left to `wi`, passing through the surface or not.
    fn interior(&self, world: &World, wi: Vec3, passes: bool) -> InteriorStack {
        match self.surface {
            Some(surface) => self.path.interior.leaving(&world.materials, surface, wi, passes),
            None => self.path.interior,
        }
    }
}

impl PathTracer {
    fn scatter_class<P: Probe>(
        &self,
        world: &World,
        class: usize,
        vertices: &[Vertex],
        output: &mut StepOutput<'_, P>,
    ) {
        match class {
            0 => self.scatter_vertices::<Diffuse, P>(world, vertices, output),
            1 => self.scatter_vertices::<Conductor, P>(world, vertices, output),
            2 => self.scatter_vertices::<Dielectric, P>(world, vertices, output),
            3 => self.scatter_vertices::<Layered<Diffuse>, P>(world, vertices, output),
            _ => self.scatter_vertices::<Layered<Conductor>, P>(world, vertices, output),
        }
    }

    /// Scatters up to eight paths by BSDFs of one class.
    fn scatter_vertices<B: RowBsdf, P: Probe>(
        &self,
        world: &World,
        vertices: &[Vertex],
        output: &mut StepOutput<'_, P>,
    ) {
        let Some(last) = vertices.last() else { return };
        let count = vertices.len();
        // Unused lanes repeat the last vertex.
        let vertices: [&Vertex; LANES] = by_lane!(lane => vertices.get(lane).unwrap_or(last));
        let Some(last_bsdf) = B::of(&last.shading.bsdf) else { return };
        let bsdfs = by_lane!(lane => B::of(&vertices[lane].shading.bsdf).unwrap_or(last_bsdf));
        let kernel = ScatterKernel { world, vertices: &vertices, bsdfs: &bsdfs, modes: &output.queues.lanes };
        let scattered = kernel.scatter();
        let items = by_lane!(lane => Item {
            path: &vertices[lane].path,
            stream: &vertices[lane].stream,
            origin_primitive: vertices[lane].surface.origin_primitive,
            surface: Some(&vertices[lane].surface),
            is_catcher: vertices[lane].is_catcher,
        });
        self.go_on(world, &items, count, &scattered, output);
    }

    /// The shadow rays and further paths of scattered paths.
    fn go_on<P: Probe>(
        &self,
        world: &World,
        items: &[Item<'_>; LANES],
        count: usize,
        scattered: &Scattered,
        output: &mut StepOutput<'_, P>,
    ) {
        for (lane, item) in items.iter().enumerate().take(count) {
            if scattered.has_density & 1 << lane != 0 {
                self.shadow_ray(world, item, lane, scattered, output);
            }
            self.next_path(world, item, lane, scattered, output);
        }
    }

    /// The shadow ray of a lane, to the point on its light.
    #[inline]
    fn shadow_ray<P: Probe>(
        &self,
        world: &World,
        item: &Item<'_>,
        lane: usize,
        scattered: &Scattered,
        output: &mut StepOutput<'_, P>,
    ) {
        let Path { beta, slot, address, .. } = *item.path;
        let (f, lights) = (scattered.light_f[lane], &scattered.lights);
        let Some(sample) = lights.samples[lane].as_ref().filter(|_| !f.is_black()) else {
            output.probe.notice_some(|| lights.failed(lane, address));
            return;
        };
        let light_pdf = sample.probability * sample.pdf;
        let bsdf_pdf = if sample.is_delta { 0.0 } else { scattered.light_bsdf_pdf[lane] };
        let weight = if sample.is_delta { 1.0 } else { power_heuristic(light_pdf, bsdf_pdf) };
        let contribution = beta * f * sample.li * (weight / light_pdf);
        output.probe.notice(|| Event::LightSampled {
            address,
            light: sample.light,
            probability: sample.probability,
            sample: lights.light_sample(lane, sample),
            f,
            bsdf_pdf,
            weight,
        });
        if contribution.is_black() {
            return;
        }
        let (origin, wi) = (scattered.shadow_origin[lane], lights.wi[lane]);
        let ray = match sample.target {
            Target::Infinity => Ray::new(origin, wi),
            Target::Point(position) => shadow::toward(origin, position.to_array()),
            Target::Surface(..) => Ray { t_max: 1.0, ..Ray::new(origin, scattered.shadow_end[lane]) },
        };
        // Through the surface of a body it travels in what is behind.
        let crosses = item.surface.is_some_and(|surface| surface.crosses(wi.into()));
        output.queues.shadows.push(Shadow {
            ray,
            origin_primitive: item.origin_primitive,
            contribution,
            slot,
            address,
            term: Term::Light(sample.light),
            interior: item.interior(world, wi.into(), crosses),
        });
        if item.is_catcher {
            self.expect_light(&world.lights[sample.light as usize], item.path, contribution, output);
        }
    }

    /// The path of a lane, into the direction that its BSDF has sampled.
    #[inline]
    fn next_path<P: Probe>(
        &self,
        world: &World,
        item: &Item<'_>,
        lane: usize,
        scattered: &Scattered,
        output: &mut StepOutput<'_, P>,
    ) {
        let Item { path, stream, origin_primitive, is_catcher, .. } = *item;
        let is = |mask: u32| mask & 1 << lane != 0;
        if !is(scattered.is_valid) {
            return;
        }
        let (wi, f, pdf) = (Vec3::from_array(scattered.wi[lane]), scattered.f[lane], scattered.pdf[lane]);
        let (is_specular, is_transmission) = (is(scattered.is_specular), is(scattered.is_transmission));
        let beta = path.beta * f * (scattered.cos[lane] / pdf);
        let eta = scattered.eta[lane];
        let eta_scale = path.previous.eta_scale * if is_transmission { eta * eta } else { 1.0 };

        // End paths that carry little, by chance.
        let depth = path.depth + 1;
        let (survival, survives) = self.roulette(stream, beta, eta_scale, depth);
        output.probe.notice(|| {
            let lobe = scattered.kind.lobe(is_specular, is_transmission);
            let pdf_is_proportional = scattered.kind.pdf_is_proportional;
            let sample = BsdfSample { wi, f, pdf, lobe, eta, pdf_is_proportional };
            let bounce = Bounce { wi, cos: scattered.cos[lane], sample, beta, survival, survives };
            Event::Bounced { address: path.address, bounce: Box::new(bounce) }
        });
        if !survives || beta.is_black() {
            return;
        }
        output.queues.paths.push(Path {
            ray: Ray::new(scattered.origin[lane], scattered.wi[lane]),
            beta: beta / survival,
            slot: path.slot,
            depth,
            address: path.address + 1,
            interior: item.interior(world, wi, is_transmission),
            previous: PreviousVertex {
                pdf: if is_specular { f32::INFINITY } else { scattered.mis_pdf[lane] },
                origin_primitive,
                point: scattered.point[lane].into(),
                n: scattered.n[lane].into(),
                eta_scale,
                blurred: path.previous.blurred || !is_specular,
                is_catcher,
            },
        });
    }
}
