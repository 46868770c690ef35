//! Path tracing eight paths at a time: paths wait until eight of them have met BSDFs of one class, and are then scattered
//! side by side. Others are scattered alone, by the same code at width one.
//!
//! `kernel` computes the numbers (light samples, BSDF, densities, origins of rays); here its results become rays and events,
//! path by path. Which paths are together does not affect a result: lanes do not depend on one another.
//!
//! Binning by material: Laine, Karras & Aila 2013; Áfra et al. 2016 (local shading coherence on CPUs).

mod bent_frames;
mod class_hits;
mod class_points;
mod in_medium;
mod kernel;
mod medium;
mod skies;
mod vertices;

use glam::Vec3;
use lookfrom_bvh::{Hit, OriginPrimitive, Ray};
use lookfrom_simd::LaneMask;

use class_points::ClassPoints;
pub(super) use in_medium::MediumVertex;
use kernel::{ScatterKernel, Scattered, Task};
use medium::MediumKernel;
use vertices::VertexColumns;

use super::subsurface::exit_below;
use super::{Departure, HitBatch, Path, StepOutput};
use super::{LightSampling, PathTracer, PreviousVertex, Vertex};
use crate::core::lanes::{LANES, by_lane, row};
use crate::core::spectrum::Spectrum;
use crate::integrator::wavefront::{Behind, Bins, Boundary, Interfaces, LightSamples, Modes};
use crate::integrator::{Bounce, Event, Probe, SampleStream, Shadow};
use crate::shading::bsdf::conductor::Conductor;
use crate::shading::bsdf::dielectric::Dielectric;
use crate::shading::bsdf::diffuse::Diffuse;
use crate::shading::bsdf::hair::Hair;
use crate::shading::bsdf::lanes::RowBsdf;
use crate::shading::bsdf::layered::Layered;
use crate::shading::bsdf::lobes::Lobes;
use crate::shading::bsdf::measured::Measured;
use crate::shading::bsdf::open_pbr::OpenPbrSurface;
use crate::shading::bsdf::plastic::Plastic;
use crate::shading::bsdf::principled::Principled;
use crate::shading::bsdf::subsurface::Subsurface;
use crate::shading::bsdf::{Bsdf, BsdfClass, BsdfSample, Uniform, bsdf_classes};
use crate::world::{HitClass, World};

/// Paths that wait for others of their class: those that hit meshes and those that hit spheres by their class, and those that hit
/// nothing, in bins, and all others as vertices.
#[derive(Default)]
pub(super) struct Waiting {
    /// Whether they wait at all: otherwise each is scattered alone, at once.
    in_lanes: bool,
    bins: Bins,
    vertices: [Vec<Vertex>; BsdfClass::COUNT],
    in_media: Vec<MediumVertex>,
    interfaces: Interfaces,
    /// Paths at interfaces of media.
    at_interfaces: Vec<(Path, Hit)>,
    /// Media by their numbers, and the paths on their ways in them.
    in_flight: Vec<(u32, Vec<u32>)>,
    memory: Memory,
}

/// The bin of paths that hit nothing, after those of the classes.
const ESCAPED: usize = BsdfClass::COUNT;

/// The bin of the first class of paths that hit spheres.
const ON_SPHERES: usize = ESCAPED + 1;
const _: () = assert!(ON_SPHERES + BsdfClass::COUNT <= Bins::COUNT, "bins of other kinds");

/// The numbers of the eight paths that are scattered, in memory that the next eight reuse.
#[derive(Default)]
struct Memory {
    points: ClassPoints,
    scattered: Scattered,
}

/// Calls a generic method of a path tracer with the BSDF of a class.
macro_rules! with_class {
    ($class:expr, $tracer:ident.$method:ident $arguments:tt) => {
        bsdf_classes!(call_with_class($class, $tracer, $method, $arguments))
    };
}

macro_rules! call_with_class {
    (
        ($class:expr, $tracer:ident, $method:ident, $arguments:tt)
        lanes { $($(#[$doc:meta])* $lane:ident($type:ty),)* }
        one_by_one { $($rest:tt)* }
    ) => {
        match $class {
            $(BsdfClass::$lane => call!($tracer, $method, $type, $arguments),)*
        }
    };
}

macro_rules! call {
    ($tracer:ident, $method:ident, $type:ty, ($($argument:expr),*)) => {
        $tracer.$method::<$type, P>($($argument),*)
    };
}

impl Waiting {
    /// None yet; to be scattered in lanes or alone.
    pub(super) fn new(in_lanes: bool) -> Self {
        Self { in_lanes, ..Self::default() }
    }

    /// Adds a path that hit nothing, and ends the paths of its kind where they fill the lanes.
    #[inline]
    pub(super) fn push_escaped<P: Probe>(
        &mut self,
        tracer: &PathTracer,
        batch: &HitBatch<'_>,
        index: usize,
        output: &mut StepOutput<'_, P>,
    ) {
        self.bins.push(ESCAPED, index as u32, 0, |eight| tracer.escape_together(batch, eight, output));
    }

    /// Adds a hit, and scatters the hits of its class where they fill the lanes.
    #[inline]
    pub(super) fn push_hit<P: Probe>(
        &mut self,
        tracer: &PathTracer,
        batch: &HitBatch<'_>,
        (HitClass { bsdf, is_sphere }, index): (HitClass, usize),
        output: &mut StepOutput<'_, P>,
    ) {
        let memory = &mut self.memory;
        let first = if is_sphere { ON_SPHERES } else { 0 };
        self.bins.push(first + bsdf as usize, index as u32, 0, |eight| {
            with_class!(bsdf, tracer.scatter_hits(batch, eight, memory, output));
        });
    }

    /// Adds a vertex, and scatters the vertices of its class where they fill the lanes. A vertex whose BSDF has no class is
    /// scattered alone, as all are without lanes.
    #[inline(always)]
    pub(super) fn push_vertex<P: Probe>(
        &mut self,
        tracer: &PathTracer,
        world: &World,
        vertex: Vertex,
        output: &mut StepOutput<'_, P>,
    ) {
        let scattered = &mut self.memory.scattered;
        let Some(class) = BsdfClass::of(&vertex.shading.bsdf).filter(|_| self.in_lanes) else {
            tracer.scatter_vertex(world, &vertex, scattered, output);
            if let Bsdf::Subsurface(boundary) = &vertex.shading.bsdf {
                tracer.leave_below(world, (&vertex, boundary), scattered, output);
            }
            return;
        };
        let vertices = &mut self.vertices[class as usize];
        if fills_lanes(vertices, vertex) {
            with_class!(class, tracer.scatter_vertices(world, vertices, scattered, output));
            vertices.clear();
        }
    }

    /// Adds a path on its way in a medium.
    pub(super) fn push_in_flight(&mut self, medium: u32, index: usize) {
        let place = self.in_flight.iter().position(|(known, _)| *known == medium).unwrap_or_else(|| {
            self.in_flight.push((medium, Vec::new()));
            self.in_flight.len() - 1
        });
        self.in_flight[place].1.push(index as u32);
    }

    /// Takes a path that has arrived at an interface of media which it may cross beside others.
    #[inline(always)]
    pub(super) fn takes_at_interface(&mut self, world: &World, path: &Path, hit: &Hit) -> bool {
        let Some(kind) = Interfaces::kind(world, hit).filter(|_| self.in_lanes) else { return false };
        self.interfaces.push(kind, self.at_interfaces.len());
        self.at_interfaces.push((*path, *hit));
        true
    }

    /// Lets paths go on behind interfaces.
    fn cross_interfaces<P: Probe>(&mut self, world: &World, output: &mut StepOutput<'_, P>) {
        let at = std::mem::take(&mut self.at_interfaces);
        let behind = self.interfaces.cross(world, |place| {
            let (path, hit) = &at[place as usize];
            (&path.ray, hit, path.interior)
        });
        for Behind { place, origin, interior } in behind {
            let (path, hit) = &at[place as usize];
            output.paths.push(Path {
                ray: Ray::new(origin, path.ray.direction),
                address: path.address + 1,
                origin_primitive: OriginPrimitive::of(hit),
                interior,
                ..*path
            });
        }
    }

    /// Takes all paths on their ways in media.
    pub(super) fn take_in_flight(&mut self) -> Vec<(u32, Vec<u32>)> {
        std::mem::take(&mut self.in_flight)
    }

    /// Adds a vertex in a medium, and scatters those there where they fill the lanes.
    pub(super) fn push_in_medium<P: Probe>(
        &mut self,
        tracer: &PathTracer,
        world: &World,
        vertex: MediumVertex,
        output: &mut StepOutput<'_, P>,
    ) {
        if fills_lanes(&mut self.in_media, vertex) || !self.in_lanes {
            tracer.scatter_in_media(world, &self.in_media, &mut self.memory.scattered, output);
            self.in_media.clear();
        }
    }

    /// Scatters the paths that are left.
    pub(super) fn flush<P: Probe>(
        mut self,
        tracer: &PathTracer,
        batch: &HitBatch<'_>,
        output: &mut StepOutput<'_, P>,
    ) {
        self.cross_interfaces(batch.world, output);
        self.bins.flush(1 << ESCAPED, |eight| tracer.escape_together(batch, eight, output));
        tracer.scatter_in_media(batch.world, &self.in_media, &mut self.memory.scattered, output);
        for (class, vertices) in BsdfClass::ALL.iter().copied().zip(&self.vertices) {
            let memory = &mut self.memory;
            for first in [0, ON_SPHERES] {
                self.bins.flush(1 << (first + class as usize), |eight| {
                    with_class!(class, tracer.scatter_hits(batch, eight, memory, output));
                });
            }
            let (world, scattered) = (batch.world, &mut memory.scattered);
            with_class!(class, tracer.scatter_vertices(world, vertices, scattered, output));
        }
    }
}

/// Adds a path to those of its class; true where they fill the lanes.
#[inline]
fn fills_lanes<T>(waiting: &mut Vec<T>, path: T) -> bool {
    if waiting.capacity() == 0 {
        waiting.reserve_exact(LANES);
    }
    waiting.push(path);
    waiting.len() == LANES
}

impl Vertex {
    fn departure(&self) -> Departure<'_> {
        let Self { path, surface, .. } = self;
        let (origin_primitive, boundary) = (surface.origin_primitive, Boundary::Surface(surface));
        Departure { path, origin_primitive, boundary }
    }
}

impl PathTracer {
    /// Scatters up to eight paths by BSDFs of one class.
    fn scatter_vertices<B: RowBsdf, P: Probe>(
        &self,
        world: &World,
        vertices: &[Vertex],
        scattered: &mut Scattered,
        output: &mut StepOutput<'_, P>,
    ) {
        let Some(last) = vertices.last() else { return };
        let active = (1 << vertices.len()) - 1;
        // Unused lanes repeat the last vertex.
        let vertices: [&Vertex; LANES] = by_lane!(lane => vertices.get(lane).unwrap_or(last));
        let Some(last_bsdf) = B::of(&last.shading.bsdf) else { return };
        let bsdfs = by_lane!(lane => B::of(&vertices[lane].shading.bsdf).unwrap_or(last_bsdf));
        let surfaces = VertexColumns::of_vertices(&vertices);
        let task = &self.task(
            by_lane!(lane => &vertices[lane].path),
            by_lane!(lane => &vertices[lane].stream),
            output,
        );
        ScatterKernel { world, surfaces: &surfaces, bsdfs: &bsdfs, task, scattered }.scatter();
        let departure = |lane: usize| (vertices[lane].departure(), vertices[lane].is_catcher);
        self.go_on(world, departure, active, scattered, output);
    }

    /// Where one path has just been scattered at the boundary of a medium in which light diffuses, and has entered it: that is not
    /// traced, but scattered again where it leaves.
    #[inline(never)]
    fn leave_below<P: Probe>(
        &self,
        world: &World,
        (vertex, boundary): (&Vertex, &Subsurface),
        scattered: &mut Scattered,
        output: &mut StepOutput<'_, P>,
    ) {
        if scattered.is_transmission & scattered.goes_on & 1 != 0
            && let Some(entered) = output.paths.pop()
            && let Some(exit) = exit_below(world, (vertex, boundary), &entered, output)
        {
            self.scatter_vertex(world, &exit, scattered, output);
        }
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
            output,
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

    /// Scatters one path by any BSDF.
    fn scatter_vertex<P: Probe>(
        &self,
        world: &World,
        vertex: &Vertex,
        scattered: &mut Scattered,
        output: &mut StepOutput<'_, P>,
    ) {
        let surfaces = VertexColumns::of_vertices(&[vertex]);
        let task = self.task([&vertex.path; LANES], [&vertex.stream; LANES], output);
        let bsdf = &vertex.shading.bsdf;
        match self.light_sampling {
            LightSampling::None => {
                let uniform = Uniform { bsdf, axes: vertex.shading.axes() };
                task.scatter_one(world, &surfaces, &uniform, scattered);
            }
            _ => task.scatter_one(world, &surfaces, bsdf, scattered),
        }
        let departure = |_| (vertex.departure(), vertex.is_catcher);
        self.go_on(world, departure, 1, scattered, output);
    }

    #[inline(always)]
    fn task<'a, P: Probe>(
        &self,
        paths: [&'a Path; LANES],
        streams: [&'a SampleStream; LANES],
        output: &'a StepOutput<'_, P>,
    ) -> Task<'a> {
        Task {
            light_sampling: self.light_sampling,
            wants_shares: output.light_paths.is_some(),
            paths,
            streams,
            modes: Modes::of(&paths, &output.queues.modes, &output.queues.times),
        }
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
        let wi = Vec3::from_array(row(&lights.wi, lane));
        let crosses = departure.crosses(wi);
        let share = || Spectrum(row(&connections.diffuse, lane));
        let last_scattering = output.last_scattering(departure.path, crosses, share);
        let interior = departure.interior(world, wi, crosses);
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
            interior: departure.interior(world, wi, is_transmission),
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
