//! Path tracing eight paths at a time: paths wait until eight of them have met BSDFs of one class, and are then scattered
//! side by side. Others are scattered alone, by the same code at width one.
//!
//! `kernel` computes the numbers (light samples, BSDF, densities, origins of rays); here its results become rays and events,
//! path by path. Which paths are together does not affect a result: lanes do not depend on one another.
//!
//! Binning by material: Laine, Karras & Aila 2013; Áfra et al. 2016 (local shading coherence on CPUs).

mod bent_frames;
mod by_class;
mod class_hits;
mod class_points;
mod in_medium;
mod kernel;
mod medium;
mod skies;
mod undecided;
mod vertices;
mod waiting;

use glam::Vec3;
use lookfrom_bvh::Ray;
use lookfrom_simd::LaneMask;

use class_points::ClassPoints;
pub(super) use in_medium::MediumVertex;
use kernel::{Scattered, Task};
use medium::MediumKernel;
use vertices::VertexColumns;
pub(super) use waiting::Waiting;

use super::subsurface::exit_below;
use super::{Departure, Path, StepOutput};
use super::{LightSampling, PathTracer, PreviousVertex, Vertex};
use crate::core::lanes::{LANES, by_lane, row};
use crate::core::spectrum::Spectrum;
use crate::integrator::wavefront::{Boundary, LightSamples, Modes};
use crate::integrator::{Bounce, Event, Probe, Queues, SampleStream, Shadow};
use crate::shading::bsdf::lobes::Lobes;
use crate::shading::bsdf::{Bsdf, BsdfClass, BsdfSample, Uniform};
use crate::world::World;

/// The numbers of the eight paths that are scattered, in memory that the next eight reuse.
#[derive(Default)]
struct Memory {
    points: ClassPoints,
    scattered: Scattered,
}

impl Vertex {
    fn departure(&self) -> Departure<'_> {
        let Self { path, surface, .. } = self;
        let (origin_primitive, boundary) = (surface.origin_primitive, Boundary::Surface(surface));
        Departure { path, origin_primitive, boundary }
    }
}

impl PathTracer {
    /// Scatters up to eight paths by BSDFs of one class. Returns the vertices of [`exits_below`].
    fn scatter_vertices<P: Probe>(
        &self,
        class: BsdfClass,
        world: &World,
        vertices: &[Vertex],
        scattered: &mut Scattered,
        output: &mut StepOutput<'_, P>,
    ) -> Vec<Vertex> {
        let Some(last) = vertices.last() else { return Vec::new() };
        let active = (1 << vertices.len()) - 1;
        // Unused lanes repeat the last vertex.
        let vertices: [&Vertex; LANES] = by_lane!(lane => vertices.get(lane).unwrap_or(last));
        let task = &self.task(
            by_lane!(lane => &vertices[lane].path),
            by_lane!(lane => &vertices[lane].stream),
            &output.queues,
            output.light_paths.is_some(),
        );
        by_class::scatter_vertices(class, world, &vertices, task, scattered);
        let departure = |lane: usize| (vertices[lane].departure(), vertices[lane].is_catcher);
        let before = output.paths.len();
        self.go_on(world, departure, active, scattered, output);
        exits_below(world, (&vertices, scattered), before, output)
    }

    /// Scatters up to eight paths in media.
    fn scatter_in_media<P: Probe>(
        &self,
        world: &World,
        vertices: &[MediumVertex],
        scattered: &mut Scattered,
        output: &mut StepOutput<'_, P>,
    ) {
        let Some(last) = vertices.last() else { return };
        let active = (1 << vertices.len()) - 1;
        // Unused lanes repeat the last vertex.
        let vertices: &[&MediumVertex; LANES] = &by_lane!(lane => vertices.get(lane).unwrap_or(last));
        let task = &self.task(
            by_lane!(lane => &vertices[lane].path),
            by_lane!(lane => &vertices[lane].stream),
            &output.queues,
            output.light_paths.is_some(),
        );
        let kernel = MediumKernel { world, vertices, active, task, scattered };
        match active {
            1 => kernel.scatter_one(),
            _ => kernel.scatter(),
        }
        for lane in LaneMask(active) {
            self.leave_medium_vertex(vertices[lane], lane, scattered, output);
        }
    }

    /// Scatters one path by any BSDF. Returns the vertices of [`exits_below`]: at most one.
    fn scatter_vertex<P: Probe>(
        &self,
        world: &World,
        vertex: &Vertex,
        scattered: &mut Scattered,
        output: &mut StepOutput<'_, P>,
    ) -> Vec<Vertex> {
        let surfaces = VertexColumns::of_vertices(&[vertex]);
        let wants_shares = output.light_paths.is_some();
        let task = self.task([&vertex.path; LANES], [&vertex.stream; LANES], &output.queues, wants_shares);
        let bsdf = &vertex.shading.bsdf;
        match self.light_sampling {
            LightSampling::None => {
                let uniform = Uniform { bsdf, axes: vertex.shading.axes() };
                task.scatter_one(world, &surfaces, &uniform, scattered);
            }
            _ => task.scatter_one(world, &surfaces, bsdf, scattered),
        }
        let departure = |_| (vertex.departure(), vertex.is_catcher);
        let before = output.paths.len();
        self.go_on(world, departure, 1, scattered, output);
        exits_below(world, (&[vertex], scattered), before, output)
    }

    #[inline(always)]
    fn task<'a>(
        &self,
        paths: [&'a Path; LANES],
        streams: [&'a SampleStream; LANES],
        queues: &'a Queues,
        wants_shares: bool,
    ) -> Task<'a> {
        let modes = Modes::of(&paths, &queues.modes, &queues.times);
        Task { light_sampling: self.light_sampling, wants_shares, paths, streams, modes }
    }

    /// The shadow rays and further paths of scattered paths, in the lanes of a mask. `departure` also tells whether the surface
    /// is a shadow catcher that the camera sees.
    fn go_on<'a, P: Probe>(
        &self,
        world: &World,
        departure: impl Fn(usize) -> (Departure<'a>, bool),
        active: u32,
        scattered: &Scattered,
        output: &mut StepOutput<'_, P>,
    ) {
        for lane in LaneMask(active) {
            let departure = departure(lane);
            if scattered.has_density & 1 << lane != 0 {
                self.shadow_ray(world, departure, lane, scattered, output);
            }
            self.next_path(world, departure, lane, scattered, output);
        }
    }

    /// The number of panes that the shadow ray of a lane may pass: as many as the path itself might. Where panes are surfaces as others,
    /// there is none before a light that paths cannot find, as in pbrt.
    fn panes_before_light(&self, path: &Path, lights: &LightSamples, lane: usize) -> u32 {
        match self.thin_passages_count {
            true if lights.is_delta & 1 << lane != 0 => 0,
            true => (self.depth - 1).saturating_sub(path.depth),
            false => u32::MAX,
        }
    }

    /// The shadow ray of a lane, to the point on its light.
    #[inline]
    fn shadow_ray<P: Probe>(
        &self,
        world: &World,
        (departure, is_catcher): (Departure<'_>, bool),
        lane: usize,
        scattered: &Scattered,
        output: &mut StepOutput<'_, P>,
    ) {
        let connection = self.connection(departure.path.address, lane, scattered, output);
        let Some((light, ray, contribution)) = connection else { return };
        let (connections, lights) = (&scattered.connections, &scattered.lights);
        // Through the surface of a body it travels in what is behind.
        let is_outside = connections.is_outside & 1 << lane != 0;
        let crosses = departure.crosses(is_outside);
        let share = || Spectrum(row(&connections.diffuse, lane));
        let last_scattering = output.last_scattering(departure.path, crosses, share);
        let interior = departure.interior(world, is_outside, crosses);
        let shadow = departure.shadow(ray, (light, contribution), interior, last_scattering);
        let panes = self.panes_before_light(departure.path, lights, lane);
        output.queues.shadows.push(Shadow { panes, ..shadow });
        if is_catcher {
            self.expect_light(&world.lights[light as usize], departure.path, contribution, output);
        }
    }

    /// The light that a lane has sampled, the ray to it, and what it contributes if that is not blocked; `None` if that is nothing.
    #[inline(always)]
    fn connection<P: Probe>(
        &self,
        address: u64,
        lane: usize,
        scattered: &Scattered,
        output: &mut StepOutput<'_, P>,
    ) -> Option<(u32, Ray, Spectrum)> {
        let (connections, lights) = (&scattered.connections, &scattered.lights);
        let is = |mask: u32| mask & 1 << lane != 0;
        let Some((light, probability)) = lights.light(lane).filter(|_| is(connections.is_sampled)) else {
            output.probe.notice_some(|| lights.failed(lane, address));
            return None;
        };
        output.probe.notice(|| Event::LightSampled {
            address,
            light,
            probability,
            sample: lights.light_sample(lane),
            f: Spectrum(row(&connections.f, lane)),
            bsdf_pdf: connections.bsdf_pdf[lane],
            weight: connections.weight[lane],
        });
        let ray = Ray::new(row(&connections.origin, lane), row(&connections.way, lane))
            .with_t_max(connections.t_max[lane]);
        is(connections.is_lit).then(|| (light, ray, Spectrum(row(&connections.contribution, lane))))
    }

    /// The path of a lane, into the direction that its BSDF has sampled.
    #[inline]
    fn next_path<P: Probe>(
        &self,
        world: &World,
        (departure, is_catcher): (Departure<'_>, bool),
        lane: usize,
        scattered: &Scattered,
        output: &mut StepOutput<'_, P>,
    ) {
        let Departure { path, origin_primitive, .. } = departure;
        let is = |mask: u32| mask & 1 << lane != 0;
        let (is_specular, is_transmission) = (is(scattered.is_specular), is(scattered.is_transmission));
        let wi = Vec3::from_array(row(&scattered.wi, lane));
        let lobe = [is_specular, is(scattered.is_diffuse), is_transmission];
        if P::LISTENS && is(scattered.is_valid) {
            let sample = BsdfSample {
                wi,
                f: Spectrum(row(&scattered.f, lane)),
                pdf: scattered.pdf[lane],
                lobe: Lobes::sampled(lobe[0], lobe[1], lobe[2]),
                eta: scattered.eta[lane],
                pdf_is_proportional: scattered.pdf_is_proportional,
            };
            let bounce = Bounce {
                wi,
                cos: scattered.cos[lane],
                sample,
                beta: Spectrum(row(&scattered.beta, lane)),
                survival: scattered.survival[lane],
                survives: is(scattered.survives),
            };
            output.probe.notice(|| Event::Bounced { address: path.address, bounce: Box::new(bounce) });
        }
        if !is(scattered.goes_on) {
            return;
        }
        // Nothing but a thin dielectric transmits specularly without a change of the index of refraction.
        let is_straight = is_specular && is_transmission && scattered.eta[lane] == 1.0;
        let depth = path.depth + u32::from(self.thin_passages_count || !is_straight);
        if !self.thin_passages_count && depth > self.depth {
            return;
        }
        let light_path = output.scattered(path, lobe);
        output.paths.push(Path {
            ray: Ray::new(row(&scattered.origin, lane), wi.to_array()),
            beta: Spectrum(row(&scattered.next_beta, lane)),
            slot: path.slot,
            depth,
            address: path.address + 1,
            interior: departure.interior(world, is(scattered.is_outside), is_transmission),
            origin_primitive,
            blurred: path.blurred || !is_specular,
            state: match is_straight && departure.is_at_pane(world) {
                true => PreviousVertex { is_catcher, ..path.state },
                false => PreviousVertex {
                    pdf: scattered.mis_pdf[lane],
                    point: row(&scattered.point, lane).into(),
                    n: row(&scattered.n, lane).into(),
                    eta_scale: scattered.eta_scale[lane],
                    is_catcher,
                },
            },
            light_path,
        });
    }
}

/// The vertices where paths leave media in which light diffuses: of the paths that have just been scattered, all but the first `before`, those
/// that have entered such a medium are not traced, but scattered again there.
fn exits_below<P: Probe>(
    world: &World,
    (vertices, scattered): (&[&Vertex], &Scattered),
    before: usize,
    output: &mut StepOutput<'_, P>,
) -> Vec<Vertex> {
    let mut exits = Vec::new();
    if !vertices.iter().any(|vertex| matches!(vertex.shading.bsdf, Bsdf::Subsurface(_))) {
        return exits;
    }
    for path in output.paths.split_off(before) {
        let lane = vertices.iter().position(|vertex| vertex.path.slot == path.slot);
        let vertex =
            lane.filter(|lane| scattered.is_transmission & 1 << lane != 0).map(|lane| vertices[lane]);
        if let Some(vertex) = vertex
            && let Bsdf::Subsurface(boundary) = &vertex.shading.bsdf
        {
            exits.extend(exit_below(world, (vertex, boundary), &path, output));
        } else {
            output.paths.push(path);
        }
    }
    exits
}
