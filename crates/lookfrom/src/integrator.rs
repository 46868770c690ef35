//! Integrators: from a path and its hit to light, shadow rays and further paths.
//!
//! An integrator turns one [`Path`] and its hit into contributions, shadow rays and further paths. Steps run in stages
//! over batches (see `render`): all paths of a batch are traced, then stepped, then their shadow rays are traced, and
//! the further paths are the next batch. Whitted's tree of rays thus grows breadth first, and the contributions to one
//! sample are added in one fixed order, whatever else is in the batch.

mod background;
mod event;
mod false_color;
mod light_paths;
mod occlusion;
mod path;
mod sample_streams;
mod scratch;
mod shadow;
mod spectral_modes;
mod wavefront;
mod whitted;

use glam::Vec3;
use lookfrom_bvh::{Hit, OriginPrimitive, Ray};
use lookfrom_scene::settings::Background;

use crate::aov::FirstSurfaces;
use crate::core::hash;
use crate::core::sampler::PixelSampler;
use crate::core::spectrum::Spectrum;
use crate::core::times::Times;
use crate::medium::Way;
use crate::shading::bsdf::lobes::Lobes;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::interior_stack::InteriorStack;
use crate::shading::texture::SpectralMode;
use crate::world::World;

pub use background::Alpha;
pub use event::{Bounce, Branch, Cut, Event, PhaseSample, Probe, Term};
pub use false_color::FalseColor;
use light_paths::LastScattering;
pub use light_paths::{LightPathState, LightPaths};
pub use occlusion::AmbientOcclusion;
pub use path::{Flight, LightSampling, PathTracer, PreviousVertex, SubsurfaceExit, SubsurfaceProbe};
pub use sample_streams::BatchStreams;
pub(crate) use scratch::Scratch;
use shadow::ShadowLight;
pub(crate) use shadow::resolve as resolve_shadows;
pub use shadow::{Shadow, ShadowTransparency, Shadows};
pub use spectral_modes::SpectralModes;
pub use whitted::{RayTree, Whitted};

/// A light transport algorithm. Implement it to plug one of your own into a [`Renderer`](crate::render::Renderer) or a
/// [`Session`](crate::session::Session::set_integrator): the renderer traces rays in batches, and calls [`Integrator::step`]
/// for each path and its hit.
///
/// A step is usually that of `examples/integrator.rs`: absorb on the way ([`StepOutput::absorbed`]), show the surroundings
/// where nothing was hit ([`StepOutput::add_surroundings`]), pass what is not there ([`Path::goes_through`],
/// [`Path::passed`]), leave the surface to AOVs ([`StepOutput::leave_first_surface`]), add light ([`StepOutput::add`],
/// [`StepOutput::cast_shadow`]), and push further paths to [`StepOutput::paths`].
pub trait Integrator: std::fmt::Debug + Send + Sync {
    /// True if the integrator computes light, to which the spectral mode and the sensor apply; false for false colours.
    const IS_LIGHT: bool = true;

    /// True if media scatter paths, and emit light, before what they hit.
    const FLIES: bool = false;

    /// The state that the integrator keeps of a path beside its throughput: weights, densities. `()` for none.
    type State: PathState;

    /// A name of one word.
    fn name(&self) -> &'static str;

    /// The surfaces that shadow rays pass.
    fn shadow_transparency(&self) -> ShadowTransparency {
        ShadowTransparency::AlphaTested
    }

    /// Adds to `output` the contributions, shadow rays and paths that follow from the `hit` of `path`.
    fn step<P: Probe>(
        &self,
        world: &World,
        stream: &SampleStream,
        path: &Path<Self::State>,
        hit: &Hit,
        output: &mut StepOutput<'_, P, Self::State>,
    );

    /// [`Integrator::step`] for all paths of a batch and their hits. The result for one path does not depend on the
    /// others; contributions to one sample are added in the order of its paths.
    fn step_all<P: Probe>(
        &self,
        world: &World,
        streams: &BatchStreams<'_>,
        paths: &[Path<Self::State>],
        hits: &[Hit],
        output: &mut StepOutput<'_, P, Self::State>,
    ) {
        for (path, hit) in paths.iter().zip(hits) {
            output.notice_hit(path, hit);
            self.step(world, &streams.of(path), path, hit, output);
        }
    }
}

/// An integrator's own state of a path.
pub trait PathState: Copy + Default + std::fmt::Debug + Send + Sync + 'static {
    /// The state as the inspector shows it.
    fn previous(&self) -> PreviousVertex {
        PreviousVertex::default()
    }
}

impl PathState for () {}

/// A ray, its throughput, and the state kept of the path so far.
#[derive(Clone, Copy, Debug)]
pub struct Path<S = ()> {
    /// In render space; not of unit length: from the camera, `t = 1` is the image plane.
    pub ray: Ray,
    /// The path throughput: the factor of light along this ray in the sample.
    pub beta: Spectrum,
    /// Index of the sample in the batch.
    pub slot: u32,
    /// Number of reflections, refractions and bounces so far.
    pub depth: u32,
    /// Number of the ray within its sample: 1 is the camera ray. In Whitted's tree the reflected child of n is 2n, the
    /// refracted one 2n + 1; along a path n is followed by n + 1.
    pub address: u64,
    /// The media that the ray is inside of.
    pub interior: InteriorStack,
    /// The primitive that the ray left.
    pub origin_primitive: OriginPrimitive,
    /// Whether any bounce so far was non-specular.
    pub blurred: bool,
    /// State in the automaton of the picture's light-path expressions.
    pub light_path: LightPathState,
    /// State of the integrator's own.
    pub state: S,
}

impl Path {
    /// The address of the root of the tree.
    pub const ROOT: u64 = 1;
}

impl<S: PathState> Path<S> {
    /// Whether the ray comes straight from the camera.
    pub fn is_root(&self) -> bool {
        self.address == Path::ROOT
    }

    /// The path as the inspector shows it.
    fn told(&self) -> Path<PreviousVertex> {
        let &Self { ray, beta, slot, depth, address, interior, origin_primitive, blurred, light_path, state } =
            self;
        let state = state.previous();
        Path { ray, beta, slot, depth, address, interior, origin_primitive, blurred, light_path, state }
    }

    /// Whether the path passes the surface as if it were not there: by the alpha test, decided by `u ∈ [0, 1)` where it
    /// is stochastic ([`SampleStream::presence`]), because it hit the back of a single-sided surface, or a hidden light, on its way from the camera, or,
    /// elsewhere, an open front of one.
    pub fn goes_through(&self, world: &World, surface: &SurfaceInteraction, u: f32) -> bool {
        let is_back = surface.single_sided && !surface.front && !self.blurred;
        let is_hidden = self.depth == 0 && world.is_hidden_light(surface);
        let is_open = world.is_open_front(surface) && self.blurred;
        let u = if is_open { u / World::COVERAGE_OF_OPEN_FRONTS } else { u };
        is_back || is_hidden || !world.passes_alpha_test(surface, u)
    }

    /// This path with its throughput attenuated by the medium that it is in, on the way to `hit` or, if it missed, to where that ends.
    #[inline]
    fn absorbed(&self, world: &World, hit: &Hit, mode: &SpectralMode) -> Self {
        if self.interior.is_empty() {
            return *self;
        }
        let transmittance = world.transmittance(self.interior, (&self.ray, self.length_to(world, hit)), mode);
        Self { beta: self.beta * transmittance, ..*self }
    }

    /// The way to `hit`.
    fn way_to(&self, world: &World, hit: &Hit) -> Way {
        Way::new(&self.ray, self.length_to(world, hit))
    }

    /// The length of the way to `hit`, see [`World::length`].
    fn length_to(&self, world: &World, hit: &Hit) -> f32 {
        world.length(self.interior, &self.ray, hit)
    }

    /// This path continued behind a surface that it passes ([`Path::goes_through`]), in the medium that it was in.
    pub fn passed(&self, surface: &SurfaceInteraction) -> Self {
        self.behind(surface.origin(Vec3::from_array(self.ray.direction)), surface.origin_primitive)
    }

    /// This path continued in its direction from an origin behind a primitive.
    #[inline]
    fn behind(&self, origin: [f32; 3], origin_primitive: OriginPrimitive) -> Self {
        let ray = Ray::new(origin, self.ray.direction);
        Self { ray, address: self.address + 1, origin_primitive, ..*self }
    }

    /// This path continued behind a surface that is only an interface between media, or an empty one: in the medium there.
    pub fn passed_interface(&self, world: &World, surface: &SurfaceInteraction) -> Self {
        let direction = Vec3::from_array(self.ray.direction);
        let interior = self.interior.leaving(&world.materials, surface, direction, true);
        Self { interior, ..self.passed(surface) }
    }
}

/// Random numbers for one ray: a pure function of pixel, sample, seed and the ray's address.
#[derive(Clone, Copy, Debug)]
pub struct SampleStream {
    /// The sampler of the pixel.
    pub sampler: PixelSampler,
    /// Index of the sample in the pixel.
    pub sample: u32,
    /// [`Path::address`].
    pub address: u64,
}

impl SampleStream {
    /// A number in `[0, 1)` for [`Path::goes_through`], in a dimension that integrators should use for nothing else.
    pub fn presence(&self, world: &World, surface: &SurfaceInteraction) -> f32 {
        if world.is_stochastic(surface) { self.two(u32::MAX)[0] } else { 0.0 }
    }

    /// Two numbers in `[0, 1)` of one dimension at this ray.
    pub fn two(&self, dimension: u32) -> [f32; 2] {
        self.sampler.two(self.sample, self.hashed(dimension))
    }

    /// [`Self::two`]; at a camera ray, points that are also well distributed together with those in the pixel. For decisions of
    /// which no two count in one term of the light, as the points on several lights, or that on a light and the direction
    /// of the bounce.
    pub fn two_with_pixel(&self, dimension: u32) -> [f32; 2] {
        match self.address {
            Path::ROOT => self.sampler.two_with_pixel(self.sample, self.hashed(dimension)),
            _ => self.two(dimension),
        }
    }

    fn hashed(&self, dimension: u32) -> u32 {
        hash::pair(self.address, u64::from(dimension)) as u32
    }
}

/// The samples of a batch under way.
#[derive(Debug, Default)]
pub struct Queues {
    /// Light gathered so far, by slot.
    pub radiance: Vec<Spectrum>,
    /// The spectral mode, by slot.
    pub modes: SpectralModes,
    /// The times of the samples while the shutter is open, by slot.
    pub(crate) times: Times,
    /// Alpha over the view's own background, by slot.
    pub alpha: Vec<Alpha>,
    /// Shadow rays.
    pub shadows: Shadows,
    /// The surfaces that camera rays met, as far as steps left them.
    pub first_surfaces: FirstSurfaces,
    /// Light by light-path expressions: for each slot as many layers as there are expressions.
    pub layers: Vec<Spectrum>,
    /// Last scattering events of shadow rays, by [`Shadow::last_scattering`]; none without light-path expressions.
    last_scatterings: Vec<LastScattering>,
    /// The hits of shadow rays, and whether they are blocked: memory that is reused.
    hits: Vec<Hit>,
    blocked: Vec<bool>,
    /// Memory of the integrator: likewise.
    scratch: Scratch,
}

impl Queues {
    /// Replaces all samples by `count` new ones: with a spectral mode for each, or one for all in RGB.
    pub fn start(&mut self, count: usize, modes: impl Iterator<Item = SpectralMode>) {
        self.radiance.clear();
        self.radiance.resize(count, Spectrum::BLACK);
        self.modes.start(modes);
        self.alpha.clear();
        self.alpha.resize(count, Alpha::Opaque);
        self.shadows.clear();
        self.layers.clear();
        self.first_surfaces.start(count);
        self.last_scatterings.clear();
    }

    #[cold]
    fn add_last_scattering(&mut self, last: LastScattering) -> u32 {
        self.last_scatterings.push(last);
        self.last_scatterings.len() as u32 - 1
    }

    /// The layers of a slot.
    fn layers_of(&mut self, slot: u32, light_paths: &LightPaths) -> &mut [Spectrum] {
        let first = slot as usize * light_paths.count();
        &mut self.layers[first..first + light_paths.count()]
    }
}

/// The output of a step, and the probe that listens.
#[derive(Debug)]
pub struct StepOutput<'a, P: Probe, S = ()> {
    /// The samples, to which steps add.
    pub queues: Queues,
    /// Paths to be traced next, after the shadow rays.
    pub paths: Vec<Path<S>>,
    /// The background that camera rays see where they hit nothing.
    pub background: Background,
    /// The light-path expressions of layers, if there are any.
    pub light_paths: Option<&'a LightPaths>,
    /// The listener.
    pub probe: &'a mut P,
}

impl<P: Probe, S: PathState> StepOutput<'_, P, S> {
    /// Tells the probe of a path and its hit.
    fn notice_hit(&mut self, path: &Path<S>, hit: &Hit) {
        self.probe.notice(|| Event::Hit { path: path.told(), hit: *hit });
    }

    /// The spectral mode of a path.
    pub fn mode(&self, path: &Path<S>) -> SpectralMode {
        self.queues.modes[path.slot as usize]
    }

    /// A path with its throughput attenuated by the medium that it is in, on the way to `hit` or, if it missed, to where that ends.
    #[inline]
    pub fn absorbed(&mut self, world: &World, path: &Path<S>, hit: &Hit) -> Path<S> {
        if path.interior.is_empty() && self.light_paths.is_none() {
            return *path;
        }
        let mode = self.mode(path);
        let absorbed = path.absorbed(world, hit, &mode);
        self.set_transmittance(world, path, absorbed.beta);
        let length = || path.length_to(world, hit);
        self.probe.notice_some(|| {
            world.medium(path.interior).is_some().then(|| Event::Absorbed {
                address: path.address,
                interior: path.interior,
                length: length(),
                transmittance: world.transmittance(path.interior, (&path.ray, length()), &mode),
                beta: absorbed.beta,
            })
        });
        absorbed
    }

    /// Sets the layers of transmittance of a path that comes straight from the camera, by its throughput at the end of a way; black where it
    /// does not arrive there.
    #[inline]
    fn set_transmittance(&mut self, world: &World, path: &Path<S>, passed: Spectrum) {
        if let Some(light_paths) = self.light_paths
            && path.depth == 0
        {
            let white = world.light_of([1.0; 3], &self.mode(path));
            light_paths.set_transmittance(white * passed, self.queues.layers_of(path.slot, light_paths));
        }
    }

    /// Sets the layers before the first step: light is none, and media let all pass.
    pub(crate) fn start_layers(&mut self, world: &World, paths: &[Path<S>]) {
        let Some(light_paths) = self.light_paths else { return };
        // Some lenses let no ray through from the edge of the film: there are fewer paths than samples.
        let samples = self.queues.radiance.len();
        self.queues.layers.resize(samples * light_paths.count(), Spectrum::BLACK);
        paths.iter().for_each(|path| self.set_transmittance(world, path, path.beta));
    }

    /// The time of a path while the shutter is open, from 0 to 1; 0 where nothing moves.
    #[inline]
    pub fn time(&self, path: &Path<S>) -> f32 {
        self.queues.times.of(path.slot as usize)
    }

    /// Adds light to a path's sample.
    #[inline]
    pub fn add(&mut self, path: &Path<S>, term: Term, value: Spectrum) {
        self.add_to(path.slot, path.address, term, value);
        if let Some(light_paths) = self.light_paths {
            light_paths.add(path.light_path, term, value, self.queues.layers_of(path.slot, light_paths));
        }
    }

    /// Adds the light of a shadow ray to its sample.
    #[inline]
    fn add_unoccluded(&mut self, light: &ShadowLight) {
        let &ShadowLight { slot, address, term, contribution, last_scattering, .. } = light;
        self.add_to(slot, address, term, contribution);
        if let Some(light_paths) = self.light_paths
            && let Some(last) = self.queues.last_scatterings.get(last_scattering as usize).copied()
        {
            let layers = self.queues.layers_of(slot, light_paths);
            light_paths.add_sampled(&last, term, contribution, layers);
        }
    }

    /// Leaves the surface that a path has met, and does not pass, to AOVs: where it is a camera ray, and nothing is seen
    /// through the surface. `albedo` is called where it may be known: the sum of what is reflected and transmitted, in linear
    /// Rec. 709; where it is not, it is that of the material.
    #[inline]
    pub fn leave_first_surface(
        &mut self,
        world: &World,
        path: &Path<S>,
        surface: &SurfaceInteraction,
        albedo: impl FnOnce() -> Option<[f32; 3]>,
    ) {
        let first_surfaces = &mut self.queues.first_surfaces;
        if first_surfaces.are_left_in(path.interior) && path.is_root() && world.opacity(surface) == 1.0 {
            first_surfaces.leave(world, path.slot, surface, albedo());
        }
    }

    /// The state of a path that a medium scatters.
    fn scattered_in_medium(&self, path: &Path<S>) -> LightPathState {
        match self.light_paths {
            None => path.light_path,
            Some(light_paths) => light_paths.scattered_in_medium(path.light_path),
        }
    }

    /// Notes that a medium scatters the light of a light, as [`Self::last_scattering`] does for surfaces.
    fn last_scattering_in_medium(&mut self, path: &Path<S>) -> u32 {
        let Some(light_paths) = self.light_paths else { return Shadow::NO_SCATTERING };
        let last = light_paths.last_scattering_in_medium(path.light_path, self.mode(path).one());
        self.queues.add_last_scattering(last)
    }

    /// The state of a path that a surface scatters by one lobe.
    #[inline(always)]
    fn scattered(
        &self,
        path: &Path<S>,
        [is_specular, is_diffuse, is_transmission]: [bool; 3],
    ) -> LightPathState {
        match self.light_paths {
            None => path.light_path,
            Some(light_paths) => {
                let lobe = Lobes::sampled(is_specular, is_diffuse, is_transmission);
                light_paths.scattered(path.light_path, lobe)
            }
        }
    }

    /// Notes how a surface scatters the light of a light, for the layers of light-path expressions: to which side, and with
    /// which share of diffuse lobes. Returns its number for the shadow ray.
    #[inline(always)]
    fn last_scattering(
        &mut self,
        path: &Path<S>,
        is_transmission: bool,
        diffuse: impl FnOnce() -> Spectrum,
    ) -> u32 {
        let Some(light_paths) = self.light_paths else { return Shadow::NO_SCATTERING };
        let last = light_paths.last_scattering(path.light_path, is_transmission, diffuse());
        self.queues.add_last_scattering(last)
    }

    #[inline]
    pub(crate) fn add_to(&mut self, slot: u32, address: u64, term: Term, value: Spectrum) {
        if !value.is_black() {
            self.queues.radiance[slot as usize] += value;
            self.probe.notice(|| Event::Add { address, term, value });
        }
    }
}
