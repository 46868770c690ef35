//! The step of path tracing at points of media, at any width: that at surfaces, with the phase function in the place of BSDF and
//! cosine. It is its own density, so that the throughput stays.

use lookfrom_simd::{Kernel, Simd};

use super::in_medium::MediumVertex;
use super::kernel::{Scattered, Task};
use crate::core::lanes::width::{Lanes, One, Width};
use crate::core::lanes::{LANES, load, shade_together, store, store_spectrum};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::integrator::path::{LightSampling, dimension};
use crate::integrator::sample_streams::SampleStreams;
use crate::integrator::wavefront::{LightSamples, Receivers};
use crate::light::IncompletePdf;
use crate::shading::bsdf::phase::Phases;
use crate::world::World;

/// Paths at points of media.
struct Step<'a, W> {
    width: W,
    vertices: &'a [&'a MediumVertex; LANES],
    task: &'a Task<'a>,
}

impl<W: Width> Step<'_, W> {
    /// Samples lights, by `sample_lights` with two random numbers in the lanes of a mask, and directions.
    #[inline(always)]
    fn scatter(
        &self,
        active: u32,
        sample_lights: impl FnOnce(&mut LightSamples, &Receivers<'_, W::Real>, [W::Real; 2], u32),
        scattered: &mut Scattered,
    ) {
        let Self { width, vertices, task } = *self;
        let streams = &SampleStreams::new(width, &task.streams);
        let point = vectors(
            width,
            #[inline(always)]
            |lane| vertices[lane].point.to_array(),
        );
        let direction = vectors(
            width,
            #[inline(always)]
            |lane| vertices[lane].path.ray.direction,
        );
        let wo = -direction.normalize();
        let phase = Phases::by_lane(
            width,
            #[inline(always)]
            |lane| vertices[lane].phase,
        );
        let beta = task.beta(width);

        // Sample one light.
        scattered.has_density = if task.light_sampling == LightSampling::None { 0 } else { active };
        if scattered.has_density != 0 {
            let at = Receivers {
                points: point.widen(),
                n: Vector::splat(point.x, [0.0; 3]),
                modes: &task.modes,
                incomplete_pdf: IncompletePdf::Allowed,
            };
            sample_lights(&mut scattered.lights, &at, streams.two_with_pixel(dimension::LIGHT), active);
            let lights = &scattered.lights;
            let p = phase.p(wo, load(width, &lights.wi));
            let f = Spectrum([p; 4]);
            scattered.connections.weigh(width, task.light_sampling, lights, beta, (f, p), point);
        }

        // Go on in one direction, unless Russian roulette ends the path.
        let u = streams.two_with_pixel(dimension::DIRECTION);
        let wi = phase.sample(wo, u);
        scattered.is_draine = width.bits(phase.choose_draine(u[0]));
        let eta_scale = width.f32s(
            #[inline(always)]
            |lane| vertices[lane].path.state.eta_scale,
        );
        let all = width.mask(active);
        let (survival, survives) = task.survive(width, beta.max_lane() * eta_scale, all, streams);
        scattered.wi = store(wi);
        scattered.pdf = phase.p(wo, wi).column();
        scattered.beta = store_spectrum(beta);
        scattered.next_beta = store_spectrum(beta / survival);
        scattered.survival = survival.column();
        scattered.survives = width.bits(survives);
    }
}

/// Vectors by lane.
#[inline(always)]
fn vectors<W: Width>(width: W, of: impl Fn(usize) -> [f32; 3]) -> Vector<W::Real> {
    let [x, y, z] = [0, 1, 2].map(
        #[inline(always)]
        |axis| {
            width.f32s(
                #[inline(always)]
                |lane| of(lane)[axis],
            )
        },
    );
    Vector { x, y, z }
}

/// Scatters paths in media, in the lanes of a mask.
pub(super) struct MediumKernel<'a> {
    pub(super) world: &'a World,
    pub(super) vertices: &'a [&'a MediumVertex; LANES],
    pub(super) active: u32,
    pub(super) task: &'a Task<'a>,
    /// Memory for the samples.
    pub(super) scattered: &'a mut Scattered,
}

impl MediumKernel<'_> {
    /// Runs at the machine's level.
    #[inline(never)]
    pub(super) fn scatter(self) {
        shade_together(self);
    }

    /// Scatters the path in the first lane.
    #[inline(never)]
    pub(super) fn scatter_one(self) {
        let Self { world, vertices, task, scattered, .. } = self;
        let step = Step { width: One, vertices, task };
        let sample_lights = |lights: &mut LightSamples, at: &Receivers<'_, f32>, [which, v]: [f32; 2], _| {
            let u = [lights.choose_one(world, at, which), v];
            lights.sample_one(world, at, u);
        };
        step.scatter(1, sample_lights, scattered);
    }
}

impl Kernel for MediumKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { world, vertices, active, task, scattered } = self;
        Step { width: simd, vertices, task }.scatter(
            active,
            #[inline(always)]
            |lights, at, [which, v], mask| {
                let u = [lights.choose(simd, world, at, which, mask), v];
                lights.sample(simd, world, at, u, mask);
            },
            scattered,
        );
    }
}
