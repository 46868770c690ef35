//! Path tracing (Kajiya 1986): at each surface one light is sampled (next-event estimation), and the path goes on in
//! one direction, sampled by the BSDF. The two strategies are combined by multiple importance sampling (Veach & Guibas
//! 1995, the power heuristic), and paths of small throughput are ended by Russian roulette (Arvo & Kirk 1990). The
//! order of steps is pbrt-v4's, so that the same scene converges to the same picture.
//!
//! In media that scatter, vertices are points of space as well: `travel` brings a path to one of them or to what it has hit, and
//! `lanes::in_medium` scatters it there.

mod catcher;
mod flight;
mod lanes;
mod subsurface;
mod travel;

use glam::Vec3;
use lookfrom_bvh::Hit;

pub use flight::Flight;
use lanes::Waiting;
pub use subsurface::{SubsurfaceExit, SubsurfaceProbe};
use travel::{Traveled, medium_on_way};

use crate::core::lanes::{LANES, are_shaded_together};
use crate::core::math::power_heuristic;
use crate::core::spectrum::Spectrum;
use crate::integrator::{
    self, BatchStreams, Event, Integrator, PathState, Probe, SampleStream, ShadowTransparency, Term,
    wavefront,
};
use crate::light::LightSampleContext;
use crate::shading::bsdf::Bsdf;
use crate::shading::bsdf::lobes::Lobes;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::material::{Shading, ShadingContext};
use crate::world::World;

/// Dimensions of the random numbers at a surface.
mod dimension {
    /// The alpha test; the choice between two mixed materials, and of the colour that remains after dispersion.
    pub(super) const PRESENCE: u32 = 0;
    /// Choice of the lobe.
    pub(super) const LOBE: u32 = 1;
    /// Choice of the light, and the point on it.
    pub(super) const LIGHT: u32 = 2;
    /// Direction of the BSDF sample.
    pub(super) const DIRECTION: u32 = 3;
    /// Russian roulette.
    pub(super) const ROULETTE: u32 = 4;
    /// Seed of the walks of layered BSDFs.
    pub(super) const WALK: u32 = 5;
    /// The free flight before: the lane and the distance.
    pub(super) const FLIGHT: u32 = 6;
    /// The axis and the lane of a line that probes for the point where light leaves a surface below which it was scattered.
    pub(super) const PROBE_AXIS: u32 = 7;
    /// The radius and the angle of that line.
    pub(super) const PROBE: u32 = 8;
    /// The choice among the points where it meets the surface; their alpha tests.
    pub(super) const EXIT: u32 = 9;
}

/// Number of bounces before Russian roulette begins: the light that the first bounces find is most of the picture, and
/// their noise most of the noise. (pbrt-v4 begins after the first; the light is the same.)
const SAFE_BOUNCES: u32 = 2;

/// Survival probability over throughput: paths that still carry half of their light always go on. Both numbers are
/// those of the least product of error and rays over nine scenes (docs/benchmarks/shading.md).
const SURVIVAL: f32 = 2.0;

/// Strategy for finding light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LightSampling {
    /// Lights and BSDFs are sampled, combined by multiple importance sampling.
    MultipleImportance,
    /// Lights are sampled, and emission that a path hits counts only where sampling cannot find it: pbrt's
    /// `simplepath`.
    NextEventEstimation,
    /// No lights are sampled; directions are uniform over the sphere: pbrt's `randomwalk`.
    None,
}

/// Path tracing.
#[derive(Clone, Copy, Debug)]
pub struct PathTracer {
    /// Maximum number of bounces of a path.
    pub depth: u32,
    /// Whether sharp lobes are roughened after the first non-specular bounce (path regularisation).
    pub regularize: bool,
    /// Whether passing straight through a thin dielectric counts as a bounce.
    pub thin_passages_count: bool,
    /// The strategy for finding light.
    pub light_sampling: LightSampling,
}

/// The vertex that a path left, as path tracing weights what it finds from there.
#[derive(Clone, Copy, Debug)]
pub struct PreviousVertex {
    /// Solid angle density of the sampled direction; infinite after a specular bounce, or from the camera.
    pub pdf: f32,
    /// Its position, in render space.
    pub point: Vec3,
    /// Shading normal there; zero where it is a point of a medium.
    pub n: Vec3,
    /// Product of η² over the refractions so far: Russian roulette must not end paths whose radiance is only compressed
    /// into a smaller solid angle.
    pub eta_scale: f32,
    /// Whether the surface was a shadow catcher, seen by the camera.
    pub is_catcher: bool,
}

impl Default for PreviousVertex {
    fn default() -> Self {
        Self { pdf: f32::INFINITY, point: Vec3::ZERO, n: Vec3::Z, eta_scale: 1.0, is_catcher: false }
    }
}

impl PreviousVertex {
    /// The light sample context there, at a time of the shutter.
    pub fn light_context(&self, time: f32) -> LightSampleContext {
        LightSampleContext { point: self.point.as_dvec3(), n: self.n, time }
    }
}

impl PathState for PreviousVertex {
    fn previous(&self) -> PreviousVertex {
        *self
    }
}

type Path = integrator::Path<PreviousVertex>;
type StepOutput<'a, P> = integrator::StepOutput<'a, P, PreviousVertex>;
type HitBatch<'a> = wavefront::HitBatch<'a, PreviousVertex>;
type Departure<'a> = wavefront::Departure<'a, PreviousVertex>;

impl Integrator for PathTracer {
    const FLIES: bool = true;

    type State = PreviousVertex;

    fn name(&self) -> &'static str {
        match self.light_sampling {
            LightSampling::MultipleImportance => "path",
            LightSampling::NextEventEstimation => "simple_path",
            LightSampling::None => "random_walk",
        }
    }

    fn shadow_transparency(&self) -> ShadowTransparency {
        ShadowTransparency::Panes
    }

    fn step_all<P: Probe>(
        &self,
        world: &World,
        streams: &BatchStreams<'_>,
        paths: &[Path],
        hits: &[Hit],
        output: &mut StepOutput<'_, P>,
    ) {
        let in_lanes = self.light_sampling != LightSampling::None && are_shaded_together();
        let mut waiting = Waiting::new(in_lanes);
        let batch = HitBatch { world, paths, hits, streams };
        for (index, (path, hit)) in paths.iter().zip(hits).enumerate() {
            output.notice_hit(path, hit);
            let in_vacuum = in_lanes && batch.is_in_vacuum(index);
            if in_vacuum && !hit.is_hit() {
                waiting.push_escaped(self, &batch, index, output);
            } else if in_vacuum && let Some(class) = self.hit_class(world, path, hit) {
                waiting.push_hit(self, &batch, (class, index), output);
            } else if !in_vacuum && let Some((medium, _)) = medium_on_way(world, path, hit) {
                waiting.push_in_flight(medium, index);
            } else {
                self.arrive(world, &streams.of(path), (path, hit), &mut waiting, output);
            }
        }
        self.travel_all(&batch, &mut waiting, output);
        waiting.flush(self, &batch, output);
    }

    fn step<P: Probe>(
        &self,
        world: &World,
        stream: &SampleStream,
        path: &Path,
        hit: &Hit,
        output: &mut StepOutput<'_, P>,
    ) {
        self.arrive(world, stream, (path, hit), &mut Waiting::new(false), output);
    }
}

/// A path at a surface that is to scatter it.
struct Vertex {
    path: Path,
    surface: SurfaceInteraction,
    shading: Shading,
    stream: SampleStream,
    is_catcher: bool,
}

impl PathTracer {
    /// Brings a path to what it has hit, adds the emission there, and finds the BSDF: a vertex that waits to be scattered,
    /// unless the path ends, or goes on through a surface that is not there.
    fn arrive<P: Probe>(
        &self,
        world: &World,
        stream: &SampleStream,
        (path, hit): (&Path, &Hit),
        waiting: &mut Waiting,
        output: &mut StepOutput<'_, P>,
    ) {
        if !self.is_counted(world, (path, hit), output) {
            let traveled = self.travel(world, stream, (path, hit), output);
            self.go_on_from(world, stream, hit, traveled, waiting, output);
        }
    }

    /// As [`PathTracer::arrive`], of all paths that are in media that scatter, emit or vary.
    #[inline(never)]
    fn travel_all<P: Probe>(
        &self,
        batch: &HitBatch<'_>,
        waiting: &mut Waiting,
        output: &mut StepOutput<'_, P>,
    ) {
        let HitBatch { world, paths, hits, streams } = *batch;
        for (medium, mut indices) in waiting.take_in_flight() {
            indices.retain(|&index| {
                !self.is_counted(world, (&paths[index as usize], &hits[index as usize]), output)
            });
            let medium = &world.media[medium as usize];
            self.travel_together(batch, (medium, &indices), output, |index, traveled, output| {
                let (path, hit) = (&paths[index], &hits[index]);
                self.go_on_from(world, &streams.of(path), hit, traveled, waiting, output);
            });
        }
    }

    /// Whether all light that a path from a shadow catcher finds has been counted.
    fn is_counted<P: Probe>(
        &self,
        world: &World,
        (path, hit): (&Path, &Hit),
        output: &mut StepOutput<'_, P>,
    ) -> bool {
        if path.state.is_catcher {
            if !hit.is_hit() && self.finds_what_it_expects(path) {
                return true;
            }
            self.expect_sky(world, path, output);
        }
        false
    }

    /// Goes on from the end of a path's way.
    fn go_on_from<P: Probe>(
        &self,
        world: &World,
        stream: &SampleStream,
        hit: &Hit,
        traveled: Traveled,
        waiting: &mut Waiting,
        output: &mut StepOutput<'_, P>,
    ) {
        let mut path = match traveled {
            Traveled::Arrived(path) => path,
            Traveled::Scattered(vertex) => {
                if self.is_scattered_in_medium(&vertex) {
                    waiting.push_in_medium(self, world, vertex, output);
                }
                return;
            }
        };
        path.state.is_catcher = false;

        // A path that leaves the scene sees the sky.
        if !hit.is_hit() {
            return self.escape(world, (&[&path; LANES], 1), output);
        }
        if waiting.takes_at_interface(world, &path, hit) || waiting.takes_arrived(self, world, &path, hit) {
            return;
        }
        let surface = world.surface_at(&path.ray, hit, output.time(&path));

        // Pass surfaces that fail the alpha test.
        let [presence, u] = match world.is_stochastic(&surface) {
            true => stream.two(dimension::PRESENCE),
            false => [0.0; 2],
        };
        if path.goes_through(world, &surface, presence) {
            output.paths.push(path.passed(&surface));
            return;
        }

        // A shadow catcher shows what is behind it, less the light that is blocked.
        let is_catcher = path.depth == 0 && world.is_catcher(&surface);
        if is_catcher {
            self.show_behind(world, &mut path, output);
        }

        // Add the surface's emission.
        self.add_emission(world, &path, &surface, output);
        if let Some(radiance) = world.unlit(&surface, &output.mode(&path)) {
            output.add(&path, Term::Emission, path.beta * radiance);
        }

        // Evaluate the material; dispersion leaves one wavelength, or one colour.
        let mode = &mut output.queues.modes[path.slot as usize];
        let seed = if world.takes_seed(&surface) { stream.two(dimension::WALK)[0] } else { 0.0 };
        let arrival = ShadingContext { mode, throughput: &mut path.beta, interior: path.interior, u, seed };
        let Some(mut shading) = world.shading(&surface, arrival) else {
            output.paths.push(path.passed_interface(world, &surface));
            return;
        };
        if self.regularize && path.blurred {
            shading.bsdf.regularize();
        }
        output.leave_first_surface(world, &path, &surface, || None);
        output.probe.notice(|| Event::Shaded {
            address: path.address,
            surface: Box::new(surface),
            shading: Box::new(shading),
            beta: path.beta,
        });
        // Most lamps reflect nothing.
        let may_pass = !self.thin_passages_count && matches!(shading.bsdf, Bsdf::ThinDielectric(_));
        let goes_on = path.depth < self.depth || may_pass && path.depth == self.depth;
        let is_black = shading.bsdf.lobes() == Lobes::NONE || shading.is_black_toward(surface.wo);
        if goes_on && !is_black {
            let vertex = Vertex { path, surface, shading, stream: *stream, is_catcher };
            waiting.push_vertex(self, world, vertex, output);
        }
    }

    fn add_emission<P: Probe>(
        &self,
        world: &World,
        path: &Path,
        surface: &SurfaceInteraction,
        output: &mut StepOutput<'_, P>,
    ) {
        let Some(light) = surface.light else { return };
        let radiance = world.emitted(surface, &output.mode(path));
        if radiance.is_black() {
            return;
        }
        let time = output.time(path);
        let pdf = || world.light_pdf(light, &path.state.light_context(time), -surface.wo, Some(surface));
        self.add_found(path, light, radiance, pdf, output);
    }

    /// Adds emission that a path hit; `light_pdf` is the density of its direction in light sampling.
    fn add_found<P: Probe>(
        &self,
        path: &Path,
        light: u32,
        radiance: Spectrum,
        light_pdf: impl Fn() -> f32,
        output: &mut StepOutput<'_, P>,
    ) {
        let weight = self.weight_of_found(path, &light_pdf);
        let address = path.address;
        output.probe.notice(|| Event::Found {
            address,
            light,
            radiance,
            light_pdf: light_pdf(),
            weight,
            beta: path.beta,
        });
        output.add(path, Term::Found { light, weight }, path.beta * radiance * weight);
    }

    /// The weight of emission that a path hit; `light_pdf` is the density of its direction in light sampling.
    fn weight_of_found(&self, path: &Path, light_pdf: impl FnOnce() -> f32) -> f32 {
        match self.light_sampling {
            _ if path.state.pdf.is_infinite() => 1.0,
            LightSampling::MultipleImportance => power_heuristic(path.state.pdf, light_pdf()),
            // Light sampling has counted it already.
            LightSampling::NextEventEstimation if light_pdf() > 0.0 => 0.0,
            LightSampling::NextEventEstimation | LightSampling::None => 1.0,
        }
    }
}
