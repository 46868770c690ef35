//! Integrators: from a path and its hit to light, shadow rays and further paths.
//!
//! An integrator turns one [`Path`] and its hit into contributions, shadow rays and further paths. Steps run in stages
//! over batches (see `render`): all paths of a batch are traced, then stepped, then their shadow rays are traced, and the
//! further paths are the next batch. Whitted's tree of rays thus grows breadth first, and the contributions to one
//! sample are added in one fixed order, whatever else is in the batch.

mod background;
mod direct;
mod event;
mod first_hit;
mod occlusion;
mod path;
mod raycast;
mod shadow;
mod whitted;

use glam::Vec3;
use lookfrom_bvh::{Hit, OriginPrimitive, Ray};
use lookfrom_scene::settings::Background;

use crate::core::hash;
use crate::core::sampler::PixelSampler;
use crate::core::spectrum::Spectrum;
use crate::light::LightSampleContext;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::interior_stack::InteriorStack;
use crate::shading::texture::SpectralMode;
use crate::world::World;

pub use background::Alpha;
pub use event::{Bounce, Branch, Cut, Event, Probe, Term};
pub use first_hit::FirstHit;
pub use occlusion::AmbientOcclusion;
pub use path::{LightSampling, PathTracer, PreviousVertex};
pub use raycast::Raycast;
pub use shadow::Shadow;
pub use shadow::ShadowTransparency;
pub(crate) use shadow::resolve as resolve_shadows;
pub use whitted::Whitted;

/// How one ray's hit is turned into light. Implement it to plug a light transport algorithm of your own into a
/// [`Renderer`](crate::render::Renderer): the renderer traces rays in batches, and calls [`Integrator::step`] for each path and
/// what it hit.
pub trait Integrator: std::fmt::Debug + Send + Sync {
    /// Whether what it computes is light, which the spectral mode and the sensor apply to, and not false colours.
    const IS_LIGHT: bool = true;

    /// What it is called, in a word.
    fn name(&self) -> &'static str;

    /// What lets shadow rays pass.
    fn shadow_transparency(&self) -> ShadowTransparency {
        ShadowTransparency::AlphaTested
    }

    /// Adds to `output` what follows from `path` having met `hit`.
    fn step<P: Probe>(
        &self,
        world: &World,
        stream: &SampleStream,
        path: &Path,
        hit: &Hit,
        output: &mut StepOutput<'_, P>,
    );

    /// [`Integrator::step`] for all paths of a batch and their hits. What is done for one path does not depend on others;
    /// contributions to one sample come in the order of its paths.
    fn step_all<P: Probe>(
        &self,
        world: &World,
        stream: impl Fn(&Path) -> SampleStream,
        paths: &[Path],
        hits: &[Hit],
        output: &mut StepOutput<'_, P>,
    ) {
        for (path, hit) in paths.iter().zip(hits) {
            output.probe.notice(|| Event::Hit { path: *path, hit: *hit });
            self.step(world, &stream(path), path, hit, output);
        }
    }
}

/// A ray on its way, and all that is remembered of where it came from.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// In render space; not of unit length: from the camera, `t = 1` is the image plane.
    pub ray: Ray,
    /// The path throughput: the factor of light along this ray in the sample.
    pub beta: Spectrum,
    /// Which sample of the batch.
    pub slot: u32,
    /// How many mirrors, refractions and bounces lie behind.
    pub depth: u32,
    /// Its place among the rays of its sample: 1 is the camera's. In Whitted's tree the mirrored child of n is 2n, the
    /// refracted one 2n + 1; along a path the next ray of n is n + 1.
    pub address: u64,
    /// What it travels in.
    pub interior: InteriorStack,
    /// What it remembers of the surface that it left.
    pub previous: PreviousVertex,
}

impl Path {
    /// The address of the root of the tree.
    pub const ROOT: u64 = 1;

    /// Where it left from, as lights are sampled there.
    pub(crate) fn light_context(&self) -> LightSampleContext {
        LightSampleContext { point: self.previous.point.as_dvec3(), n: self.previous.n }
    }

    /// Whether it goes through a surface as if that were not there: by its alpha, where that is a matter of chance for
    /// `u ∈ [0, 1)`, or on its way from the camera because it met the back of what has only a front.
    fn goes_through(&self, world: &World, surface: &SurfaceInteraction, u: f32) -> bool {
        let is_back = surface.single_sided && !surface.front && !self.previous.blurred;
        is_back || !world.passes_alpha_test(surface, u)
    }

    /// The same path after what it is inside of took its part of the light, on the way to `hit` or, where nothing is met,
    /// to infinity.
    fn absorbed(&self, world: &World, hit: &Hit, lanes: &SpectralMode) -> Self {
        let length = match hit.is_hit() {
            true => Vec3::from_array(self.ray.direction).length() * hit.t,
            false => f32::INFINITY,
        };
        Self { beta: self.beta * world.transmittance(self.interior, length, lanes), ..*self }
    }

    /// The same path behind a surface that is not there.
    fn passed(&self, surface: &SurfaceInteraction) -> Self {
        let direction = Vec3::from_array(self.ray.direction);
        let ray = Ray::new(surface.origin(direction), self.ray.direction);
        let previous = PreviousVertex { origin_primitive: surface.origin_primitive, ..self.previous };
        Self { ray, address: self.address + 1, previous, ..*self }
    }
}

/// Random numbers for one ray: a pure function of pixel, sample, seed and the ray's place in its tree.
#[derive(Clone, Copy, Debug)]
pub struct SampleStream {
    /// Where they come from: the pixel's.
    pub sampler: PixelSampler,
    /// Which sample of the pixel.
    pub sample: u32,
    /// [`Path::address`].
    pub address: u64,
}

impl SampleStream {
    /// A number in `[0, 1)` for the alpha test, in a dimension that integrators do not use otherwise.
    fn presence(&self, world: &World, surface: &SurfaceInteraction) -> f32 {
        if world.is_stochastic(surface) { self.two(u32::MAX)[0] } else { 0.0 }
    }

    /// Two numbers in `[0, 1)` of one dimension at this ray.
    pub fn two(&self, dimension: u32) -> [f32; 2] {
        self.sampler.two(self.sample, hash::pair(self.address, u64::from(dimension)) as u32)
    }
}

/// The samples of a batch under way.
#[derive(Debug, Default)]
pub struct Queues {
    /// Light gathered so far, by slot.
    pub radiance: Vec<Spectrum>,
    /// What the lanes mean, by slot.
    pub lanes: Vec<SpectralMode>,
    /// What each sample hides of a background of the view's own, by slot.
    pub alpha: Vec<Alpha>,
    /// To be traced next.
    pub paths: Vec<Path>,
    /// To be traced before that.
    pub shadows: Vec<Shadow>,
    /// The rays of `shadows`, what they leave, and whether they are blocked: memory.
    rays: Vec<Ray>,
    origin_primitives: Vec<OriginPrimitive>,
    blocked: Vec<bool>,
}

impl Queues {
    /// Forgets all samples.
    pub fn clear(&mut self) {
        self.radiance.clear();
        self.lanes.clear();
        self.alpha.clear();
        self.paths.clear();
        self.shadows.clear();
    }

    /// One sample more, in the next slot.
    pub fn start(&mut self, lanes: SpectralMode) {
        self.radiance.push(Spectrum::BLACK);
        self.lanes.push(lanes);
        self.alpha.push(Alpha::Opaque);
    }
}

/// The output of a step, and the probe that listens.
#[derive(Debug)]
pub struct StepOutput<'a, P: Probe> {
    /// The samples that steps add to.
    pub queues: Queues,
    /// What the camera sees where nothing stands.
    pub background: Background,
    /// The listener.
    pub probe: &'a mut P,
}

impl<P: Probe> StepOutput<'_, P> {
    /// What the lanes of a path mean.
    fn lanes(&self, path: &Path) -> SpectralMode {
        self.queues.lanes[path.slot as usize]
    }

    /// Adds light to a path's sample.
    pub fn add(&mut self, path: &Path, term: Term, value: Spectrum) {
        self.add_to(path.slot, path.address, term, value);
    }

    pub(crate) fn add_to(&mut self, slot: u32, address: u64, term: Term, value: Spectrum) {
        if !value.is_black() {
            self.queues.radiance[slot as usize] += value;
            self.probe.notice(|| Event::Add { address, term, value });
        }
    }
}
