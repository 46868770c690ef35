//! Paths that wait until eight of them have met BSDFs of one class, in bins.

use lookfrom_bvh::{Hit, OriginPrimitive};
use lookfrom_simd::LaneMask;

use super::undecided::Decided;
use super::{MediumVertex, Memory, Path, StepOutput};
use crate::core::lanes::LANES;
use crate::integrator::Probe;
use crate::integrator::path::{HitBatch, PathTracer, Vertex};
use crate::integrator::wavefront::{Behind, Bins, Interfaces};
use crate::shading::bsdf::BsdfClass;
use crate::world::{HitClass, ShapeClass, World};

/// Paths that wait for others of their class: those that hit surfaces whose materials have a class, by the kind of shape, and those that
/// hit nothing, in bins, and all others as vertices.
#[derive(Default)]
pub(in crate::integrator::path) struct Waiting {
    /// Whether they wait at all: otherwise each is scattered alone, at once.
    in_lanes: bool,
    bins: Bins,
    vertices: [Vec<Vertex>; BsdfClass::COUNT],
    in_media: Vec<MediumVertex>,
    interfaces: Interfaces,
    /// Indices in the batch of hits about which chance has still to decide, by the kind of shape.
    undecided: [Vec<u32>; ShapeClass::ALL.len()],
    /// Paths at interfaces of media.
    at_interfaces: Vec<(Path, Hit)>,
    /// Paths that have come through a medium to shapes whose BSDFs have a class, and what they have hit.
    arrived: Arrived,
    /// Media by their numbers, and the paths on their ways in them.
    in_flight: Vec<(u32, Vec<u32>)>,
    memory: Memory,
}

/// Paths, what they have hit, and the classes of that.
#[derive(Default)]
struct Arrived {
    paths: Vec<Path>,
    hits: Vec<Hit>,
    classes: Vec<HitClass>,
}

/// The bin of paths that hit nothing.
const ESCAPED: usize = 0;

/// The bin of paths that hit a kind of shape of a class.
const fn bin(shape: ShapeClass, class: BsdfClass) -> usize {
    1 + shape as usize * BsdfClass::COUNT + class as usize
}

const _: () = assert!(ShapeClass::ALL.len() * BsdfClass::COUNT < Bins::COUNT, "bins of other kinds");

impl Waiting {
    /// None yet; to be scattered in lanes or alone.
    pub(in crate::integrator::path) fn new(in_lanes: bool) -> Self {
        Self { in_lanes, ..Self::default() }
    }

    /// Adds a path that hit nothing, and ends the paths of its kind where they fill the lanes.
    #[inline]
    pub(in crate::integrator::path) fn push_escaped<P: Probe>(
        &mut self,
        tracer: &PathTracer,
        batch: &HitBatch<'_>,
        index: usize,
        output: &mut StepOutput<'_, P>,
    ) {
        self.bins.push(ESCAPED, index as u32, 0, |eight| tracer.escape_together(batch, eight, output));
    }

    /// Adds a hit: it waits for others of its class, once chance has decided about it.
    #[inline(always)]
    pub(in crate::integrator::path) fn push_hit<P: Probe>(
        &mut self,
        tracer: &PathTracer,
        batch: &HitBatch<'_>,
        (class, index): (HitClass, usize),
        output: &mut StepOutput<'_, P>,
    ) {
        match class {
            HitClass { bsdf: Some(bsdf), alpha: None, material, shape } => {
                self.push_decided(tracer, batch, (shape, bsdf), (index as u32, material), output);
            }
            _ => self.push_undecided(tracer, batch, (class, index), output),
        }
    }

    /// Adds a hit about which chance decides: at once, or where such hits fill the lanes.
    #[inline(never)]
    fn push_undecided<P: Probe>(
        &mut self,
        tracer: &PathTracer,
        batch: &HitBatch<'_>,
        (class, index): (HitClass, usize),
        output: &mut StepOutput<'_, P>,
    ) {
        let HitClass { shape, .. } = class;
        if let Some(material) = PathTracer::decided_at_once(batch, class, index) {
            self.push_material(tracer, batch, (material, shape, index as u32), output);
        } else if fills_lanes(&mut self.undecided[shape as usize], index as u32) {
            self.decide(tracer, batch, shape, output);
        }
    }

    /// Decides about hits, and adds those whose surfaces are there.
    fn decide<P: Probe>(
        &mut self,
        tracer: &PathTracer,
        batch: &HitBatch<'_>,
        shape: ShapeClass,
        output: &mut StepOutput<'_, P>,
    ) {
        let mut hits = std::mem::take(&mut self.undecided[shape as usize]);
        if !hits.is_empty() {
            let Decided { there, materials } =
                tracer.decide(batch, (shape, &hits), &mut self.memory.points, output);
            for lane in LaneMask(there) {
                self.push_material(tracer, batch, (materials[lane], shape, hits[lane]), output);
            }
            hits.clear();
        }
        self.undecided[shape as usize] = hits;
    }

    /// Adds a hit on a surface that is there, of a material that is not mixed.
    #[inline(never)]
    fn push_material<P: Probe>(
        &mut self,
        tracer: &PathTracer,
        batch: &HitBatch<'_>,
        (material, shape, index): (u32, ShapeClass, u32),
        output: &mut StepOutput<'_, P>,
    ) {
        if let Some(bsdf) = batch.world.materials[material as usize].class() {
            self.push_decided(tracer, batch, (shape, bsdf), (index, material), output);
        }
    }

    /// Adds a hit on a surface that is there, of a material that is not mixed, and scatters the hits of its class where they fill the lanes.
    #[inline(always)]
    fn push_decided<P: Probe>(
        &mut self,
        tracer: &PathTracer,
        batch: &HitBatch<'_>,
        (shape, bsdf): (ShapeClass, BsdfClass),
        (index, material): (u32, u32),
        output: &mut StepOutput<'_, P>,
    ) {
        let memory = &mut self.memory;
        self.bins.push(bin(shape, bsdf), index, material, |eight| {
            tracer.scatter_hits((shape, bsdf), batch, eight, memory, output);
        });
    }

    /// Adds a vertex, and scatters the vertices of its class where they fill the lanes. A vertex whose BSDF has no class is
    /// scattered alone, as all are without lanes.
    #[inline(always)]
    pub(in crate::integrator::path) fn push_vertex<P: Probe>(
        &mut self,
        tracer: &PathTracer,
        world: &World,
        vertex: Vertex,
        output: &mut StepOutput<'_, P>,
    ) {
        let scattered = &mut self.memory.scattered;
        let exits = if let Some(class) = BsdfClass::of(&vertex.shading.bsdf).filter(|_| self.in_lanes) {
            let vertices = &mut self.vertices[class as usize];
            if !fills_lanes(vertices, vertex) {
                return;
            }
            let exits = tracer.scatter_vertices(class, world, vertices, scattered, output);
            vertices.clear();
            exits
        } else {
            tracer.scatter_vertex(world, &vertex, scattered, output)
        };
        self.push_exits(tracer, world, exits, output);
    }

    /// Adds the vertices where paths leave media in which light diffuses.
    #[inline(never)]
    fn push_exits<P: Probe>(
        &mut self,
        tracer: &PathTracer,
        world: &World,
        exits: Vec<Vertex>,
        output: &mut StepOutput<'_, P>,
    ) {
        for exit in exits {
            self.push_vertex(tracer, world, exit, output);
        }
    }

    /// Adds a path on its way in a medium.
    pub(in crate::integrator::path) fn push_in_flight(&mut self, medium: u32, index: usize) {
        let place = self.in_flight.iter().position(|(known, _)| *known == medium).unwrap_or_else(|| {
            self.in_flight.push((medium, Vec::new()));
            self.in_flight.len() - 1
        });
        self.in_flight[place].1.push(index as u32);
    }

    /// Takes a path that has arrived at an interface of media which it may cross beside others.
    #[inline(always)]
    pub(in crate::integrator::path) fn takes_at_interface(
        &mut self,
        world: &World,
        path: &Path,
        hit: &Hit,
    ) -> bool {
        let Some(kind) = Interfaces::kind(world, hit).filter(|_| self.in_lanes) else { return false };
        self.interfaces.push(kind, self.at_interfaces.len());
        self.at_interfaces.push((*path, *hit));
        true
    }

    /// Takes a path that has come through a medium to a shape whose BSDFs have a class.
    #[inline]
    pub(in crate::integrator::path) fn takes_arrived(
        &mut self,
        tracer: &PathTracer,
        world: &World,
        path: &Path,
        hit: &Hit,
    ) -> bool {
        // Without media those that have a class have not come here.
        if !self.in_lanes || world.media.is_empty() {
            return false;
        }
        let Some(class) = tracer.hit_class(world, path, hit) else { return false };
        self.arrived.paths.push(*path);
        self.arrived.hits.push(*hit);
        self.arrived.classes.push(class);
        true
    }

    /// Scatters the paths that have come through media.
    fn scatter_arrived<P: Probe>(
        &mut self,
        tracer: &PathTracer,
        batch: &HitBatch<'_>,
        output: &mut StepOutput<'_, P>,
    ) {
        let Arrived { paths, hits, classes } = &std::mem::take(&mut self.arrived);
        let batch = HitBatch { paths, hits, ..*batch };
        for (index, &class) in classes.iter().enumerate() {
            self.push_hit(tracer, &batch, (class, index), output);
        }
        self.flush_hits(tracer, &batch, output);
    }

    /// Decides about the hits that are left, and scatters them.
    fn flush_hits<P: Probe>(
        &mut self,
        tracer: &PathTracer,
        batch: &HitBatch<'_>,
        output: &mut StepOutput<'_, P>,
    ) {
        for shape in ShapeClass::ALL {
            self.decide(tracer, batch, shape, output);
        }
        let Self { bins, memory, .. } = self;
        for &class in BsdfClass::ALL {
            for shape in ShapeClass::ALL {
                bins.flush(1 << bin(shape, class), |eight| {
                    tracer.scatter_hits((shape, class), batch, eight, memory, output);
                });
            }
        }
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
            output.paths.push(Path { interior, ..path.behind(origin, OriginPrimitive::of(hit)) });
        }
    }

    /// Takes all paths on their ways in media.
    pub(in crate::integrator::path) fn take_in_flight(&mut self) -> Vec<(u32, Vec<u32>)> {
        std::mem::take(&mut self.in_flight)
    }

    /// Adds a vertex in a medium, and scatters those there where they fill the lanes.
    pub(in crate::integrator::path) fn push_in_medium<P: Probe>(
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
    pub(in crate::integrator::path) fn flush<P: Probe>(
        mut self,
        tracer: &PathTracer,
        batch: &HitBatch<'_>,
        output: &mut StepOutput<'_, P>,
    ) {
        self.cross_interfaces(batch.world, output);
        self.bins.flush(1 << ESCAPED, |eight| tracer.escape_together(batch, eight, output));
        tracer.scatter_in_media(batch.world, &self.in_media, &mut self.memory.scattered, output);
        self.flush_hits(tracer, batch, output);
        if !self.arrived.paths.is_empty() {
            self.scatter_arrived(tracer, batch, output);
        }
        // Exits are of the last class.
        for &class in BsdfClass::ALL {
            let vertices = std::mem::take(&mut self.vertices[class as usize]);
            let scattered = &mut self.memory.scattered;
            let exits = tracer.scatter_vertices(class, batch.world, &vertices, scattered, output);
            self.push_exits(tracer, batch.world, exits, output);
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
