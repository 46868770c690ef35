//! The step of path tracing at any width: one light sampled, one direction sampled by the BSDF, Russian roulette, and the
//! origins of the rays. Numbers only; the parent module makes rays and events of them.

use lookfrom_simd::{Float, Kernel, Mask as _, Real, Simd};

use super::vertices::{VertexColumns, Vertices};
use crate::core::lanes::width::{Lanes, Mask, One, Width};
use crate::core::lanes::{Columns, LANES, load, load_spectrum, shade_together, store, store_spectrum};
use crate::core::math::power_heuristic;
use crate::core::points::Exits;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::integrator::SampleStream;
use crate::integrator::path::Path;
use crate::integrator::path::{LightSampling, SAFE_BOUNCES, SURVIVAL, dimension};
use crate::integrator::sample_streams::SampleStreams;
use crate::integrator::wavefront::{LightSamples, Modes, Receivers};
use crate::light::IncompletePdf;
use crate::shading::bsdf::lanes::{LaneBsdf, RowBsdf};
use crate::world::World;

/// The samples of eight paths. Masks have bit i for lane i.
#[derive(Default)]
pub(super) struct Scattered {
    /// Lanes whose BSDF has a density, for which a light was sampled.
    pub(super) has_density: u32,
    pub(super) lights: LightSamples,
    pub(super) connections: Connections,
    /// Lanes whose BSDF has sampled a direction.
    pub(super) is_valid: u32,
    pub(super) is_specular: u32,
    pub(super) is_diffuse: u32,
    pub(super) is_transmission: u32,
    /// Lanes whose direction is to the outside of the surface.
    pub(super) is_outside: u32,
    /// That direction, in render space, of unit length.
    pub(super) wi: Columns<3>,
    pub(super) f: Columns<4>,
    pub(super) pdf: [f32; LANES],
    /// Whether that is only proportional to the density.
    pub(super) pdf_is_proportional: bool,
    /// The density to compare with that of light sampling.
    pub(super) mis_pdf: [f32; LANES],
    pub(super) eta: [f32; LANES],
    pub(super) cos: [f32; LANES],
    pub(super) origin: Columns<3>,
    /// The throughputs, before Russian roulette.
    pub(super) beta: Columns<4>,
    /// The throughputs of the paths that go on.
    pub(super) next_beta: Columns<4>,
    /// Products of η².
    pub(super) eta_scale: [f32; LANES],
    /// Probabilities of surviving Russian roulette, and the lanes that survive it.
    pub(super) survival: [f32; LANES],
    pub(super) survives: u32,
    /// Lanes in media whose direction is of Draine's lobe.
    pub(super) is_draine: u32,
    /// Lanes whose path goes on.
    pub(super) goes_on: u32,
    /// The points and the shading normals, in single precision.
    pub(super) point: Columns<3>,
    pub(super) n: Columns<3>,
}

/// Light samples of eight lanes, weighted, as if nothing were in between.
#[derive(Default)]
pub(super) struct Connections {
    /// The BSDF for the direction to the light, times the cosine.
    pub(super) f: Columns<4>,
    /// The share of diffuse lobes in it, where layers need it.
    pub(super) diffuse: Columns<4>,
    /// The density with which the BSDF samples that direction: 0 for light from a single direction.
    pub(super) bsdf_pdf: [f32; LANES],
    /// Weights of multiple importance sampling.
    pub(super) weight: [f32; LANES],
    pub(super) contribution: Columns<4>,
    /// Lanes that have a light sample for which the BSDF is not black.
    pub(super) is_sampled: u32,
    /// Lanes whose contribution is not black.
    pub(super) is_lit: u32,
    /// Lanes whose light comes from the outside of the surface.
    pub(super) is_outside: u32,
    /// The origins of the shadow rays, and their directions and ends.
    pub(super) origin: Columns<3>,
    pub(super) way: Columns<3>,
    pub(super) t_max: [f32; LANES],
}

/// Paths at surfaces whose BSDFs are of one class.
struct Step<'a, W: Width, B> {
    width: W,
    surfaces: &'a Vertices<W::Real>,
    bsdf: &'a B,
    /// Path throughputs.
    beta: Spectrum<W::Real>,
    streams: &'a SampleStreams<W::Real>,
    task: &'a Task<'a>,
}

impl<W: Width, B: LaneBsdf<W::Real>> Step<'_, W, B> {
    /// Samples lights, by `sample_lights` with two random numbers in the lanes of a mask, and directions at the surfaces.
    #[inline(always)]
    fn scatter(
        &self,
        sample_lights: impl FnOnce(&mut LightSamples, &Receivers<'_, W::Real>, [W::Real; 2], u32),
        scattered: &mut Scattered,
    ) {
        let Self { width, surfaces, bsdf, beta, streams, task } = *self;
        let (paths, traits) = (task.paths, bsdf.traits());
        let (zero, one) = (width.splat(0.0), width.splat(1.0));
        let prepared = bsdf.prepare(surfaces.wo);
        let exits = surfaces.exits();

        // Sample one light.
        scattered.has_density = match task.light_sampling {
            LightSampling::None => 0,
            _ => width.bits(bsdf.has_density()),
        };
        if scattered.has_density != 0 {
            let at = Receivers {
                points: surfaces.points.position,
                n: surfaces.n,
                modes: &task.modes,
                incomplete_pdf: IncompletePdf::Allowed,
            };
            let u = streams.two_with_pixel(dimension::LIGHT);
            sample_lights(&mut scattered.lights, &at, u, scattered.has_density);
            self.connect(&prepared, &exits, &scattered.lights, &mut scattered.connections);
        }

        // Go on in one direction.
        let [which_lobe, _] = match traits.needs_lobe {
            true => streams.two(dimension::LOBE),
            false => [zero; 2],
        };
        let mut sample =
            bsdf.sample(&prepared, which_lobe, streams.two_with_pixel(dimension::DIRECTION)).if_useful();
        let wi = surfaces.render(sample.wi);
        sample.f = surfaces.guarded(sample.f, wi);
        if traits.needs_agreement {
            sample.is_valid = sample.is_valid & surfaces.agrees(wi);
        }
        let mis_pdf = match traits.pdf_is_proportional {
            true => bsdf.pdf(&prepared, surfaces.local(wi)),
            false => sample.pdf,
        };
        let cos = Float::abs(wi.dot(surfaces.n));
        let beta = beta * sample.f * (cos / sample.pdf);
        let eta_scale = width.f32s(
            #[inline(always)]
            |lane| paths[lane].state.eta_scale,
        ) * Float::select(sample.is_transmission, sample.eta * sample.eta, one);

        let (survival, survives) = task.survive(width, beta.max_lane() * eta_scale, sample.is_valid, streams);
        let goes_on = sample.is_valid & survives & !beta.is_black();
        scattered.is_valid = width.bits(sample.is_valid);
        scattered.is_specular = width.bits(sample.is_specular);
        scattered.is_diffuse = width.bits(sample.is_diffuse);
        scattered.is_transmission = width.bits(sample.is_transmission);
        scattered.is_outside = width.bits(zero.narrow_mask(exits.are_outside(wi)));
        scattered.wi = store(wi);
        scattered.f = store_spectrum(sample.f);
        scattered.pdf = sample.pdf.column();
        scattered.pdf_is_proportional = traits.pdf_is_proportional;
        scattered.mis_pdf = Float::select(sample.is_specular, zero.like(f32::INFINITY), mis_pdf).column();
        scattered.eta = sample.eta.column();
        scattered.cos = cos.column();
        scattered.origin = store(exits.toward(wi));
        scattered.beta = store_spectrum(beta);
        scattered.next_beta = store_spectrum(beta / survival);
        scattered.eta_scale = eta_scale.column();
        scattered.survival = survival.column();
        scattered.survives = width.bits(survives);
        scattered.goes_on = width.bits(goes_on);
        scattered.point = store(Vector::<W::Real>::narrow(surfaces.points.position));
        scattered.n = store(surfaces.n);
    }

    /// Weights light samples.
    #[inline(always)]
    fn connect(
        &self,
        prepared: &B::Prepared,
        exits: &Exits<'_, W::Real>,
        lights: &LightSamples,
        connections: &mut Connections,
    ) {
        let Self { width, surfaces, bsdf, beta, task, .. } = *self;
        let zero = width.splat(0.0);
        let wi = load(width, &lights.wi);
        let local = surfaces.local(wi);
        let (mut f, bsdf_pdf) = bsdf.f_and_pdf(prepared, local);
        if task.wants_shares {
            connections.diffuse = store_spectrum(bsdf.diffuse_share(prepared, local, f));
        }
        if bsdf.traits().needs_agreement {
            f = Spectrum::select(surfaces.agrees(wi), f, Spectrum::splat(zero));
        }
        let f = surfaces.guarded(f, wi) * Float::abs(local.z);
        connections.is_outside = width.bits(zero.narrow_mask(exits.are_outside(wi)));
        connections.weigh(width, task.light_sampling, lights, beta, (f, bsdf_pdf), exits.toward(wi));
    }
}

impl Connections {
    /// Weights light samples, for which the BSDF times the cosine, or the phase function, has the value f and a density.
    #[inline(always)]
    pub(super) fn weigh<W: Width>(
        &mut self,
        width: W,
        light_sampling: LightSampling,
        lights: &LightSamples,
        beta: Spectrum<W::Real>,
        (f, pdf): (Spectrum<W::Real>, W::Real),
        origin: Vector<W::Real>,
    ) {
        let zero = width.splat(0.0);
        // Sampling of directions cannot find all lights.
        let is_alone = width.mask(match light_sampling {
            LightSampling::MultipleImportance => lights.is_delta,
            _ => u32::MAX,
        });
        let pdf = Float::select(is_alone, zero, pdf);
        let light_pdf = width.load_f32(&lights.probability) * width.load_f32(&lights.pdf);
        let weight = Float::select(is_alone, zero.like(1.0), power_heuristic(light_pdf, pdf));
        let contribution = beta * f * load_spectrum(width, &lights.li) * (weight / light_pdf);
        self.f = store_spectrum(f);
        self.bsdf_pdf = pdf.column();
        self.weight = weight.column();
        self.contribution = store_spectrum(contribution);
        self.is_sampled = lights.is_valid & !width.bits(f.is_black());
        self.is_lit = self.is_sampled & !width.bits(contribution.is_black());
        self.origin = store(origin);
        let (way, t_max) = lights.ways(width, origin);
        (self.way, self.t_max) = (store(way), t_max.column());
    }
}

/// Paths, and how they are to be scattered.
pub(super) struct Task<'a> {
    pub(super) light_sampling: LightSampling,
    /// Whether layers of light-path expressions need the shares of diffuse lobes.
    pub(super) wants_shares: bool,
    pub(super) paths: [&'a Path; LANES],
    pub(super) streams: [&'a SampleStream; LANES],
    pub(super) modes: Modes<'a>,
}

impl Task<'_> {
    /// The lanes in which Russian roulette ends no path.
    #[inline(always)]
    fn are_safe<W: Width>(&self, width: W) -> Mask<W> {
        if self.light_sampling != LightSampling::MultipleImportance {
            return width.mask(u32::MAX);
        }
        let depth = width.u32s(
            #[inline(always)]
            |lane| self.paths[lane].depth,
        );
        W::Real::from_integer(depth).lt(width.splat(SAFE_BOUNCES as f32))
    }

    /// Ends paths of small throughput by Russian roulette: the probabilities of survival, and the lanes that survive. `throughput` is
    /// the largest lane times the product of η²; only lanes of a mask ask for random numbers.
    #[inline(always)]
    pub(super) fn survive<W: Width>(
        &self,
        width: W,
        throughput: W::Real,
        mask: Mask<W>,
        streams: &SampleStreams<W::Real>,
    ) -> (W::Real, Mask<W>) {
        let one = width.splat(1.0);
        let survival = throughput * SURVIVAL;
        let is_great = survival.gt(one) | Float::eq(survival, one);
        let is_safe = is_great | self.are_safe(width);
        let mut survives = is_safe;
        let survival = Float::select(is_safe, one, survival);
        if !(is_safe | !mask).all() {
            let [u, _] = streams.two(dimension::ROULETTE);
            survives = is_safe | u.lt(survival);
        }
        (survival, survives)
    }

    /// The throughputs of the paths.
    #[inline(always)]
    pub(super) fn beta<W: Width>(&self, width: W) -> Spectrum<W::Real> {
        width.spectra_of(
            #[inline(always)]
            |lane| self.paths[lane].beta,
        )
    }

    /// Scatters the path in the first lane, whatever its BSDF.
    #[inline(never)]
    pub(super) fn scatter_one<B: LaneBsdf<f32>>(
        &self,
        world: &World,
        surfaces: &VertexColumns,
        bsdf: &B,
        scattered: &mut Scattered,
    ) {
        let (width, surfaces) = (One, &surfaces.load(One));
        let streams = &SampleStreams::new(width, &self.streams);
        let step = Step { width, surfaces, bsdf, beta: self.beta(width), streams, task: self };
        let sample_lights = |lights: &mut LightSamples, at: &Receivers<'_, f32>, [which, v]: [f32; 2], _| {
            let u = [lights.choose_one(world, at, which), v];
            lights.sample_one(world, at, u);
        };
        step.scatter(sample_lights, scattered);
    }
}

/// Scatters eight paths at surfaces whose BSDFs are of one class.
pub(super) struct ScatterKernel<'a, B> {
    pub(super) world: &'a World,
    pub(super) surfaces: &'a VertexColumns,
    pub(super) bsdfs: &'a [&'a B; LANES],
    pub(super) task: &'a Task<'a>,
    /// Memory for the samples.
    pub(super) scattered: &'a mut Scattered,
}

impl<B: RowBsdf> ScatterKernel<'_, B> {
    /// Runs at the machine's level. Not inlined, so that a class is compiled once, whatever the probe.
    #[inline(never)]
    pub(super) fn scatter(self) {
        shade_together(self);
    }
}

impl<B: RowBsdf> Kernel for ScatterKernel<'_, B> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { world, surfaces, bsdfs, task, scattered } = self;
        let bsdf = &B::gather(simd, bsdfs);
        let surfaces = &surfaces.load(simd);
        let streams = &SampleStreams::new(simd, &task.streams);
        let step = Step { width: simd, surfaces, bsdf, beta: task.beta(simd), streams, task };
        step.scatter(
            #[inline(always)]
            |lights, at, [which, v], mask| {
                let u = [lights.choose(simd, world, at, which, mask), v];
                lights.sample(simd, world, at, u, mask);
            },
            scattered,
        );
    }
}
