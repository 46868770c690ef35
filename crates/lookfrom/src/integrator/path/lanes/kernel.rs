//! Scattering of eight paths side by side: one light sampled, one direction sampled by the BSDF, and the origins of the
//! rays. Numbers only; the parent module makes rays and events of them.

use lookfrom_simd::{Float, Kernel, Mask, Real, Simd, f32x8, mask32x8, prelude::*, u32x8};

use super::light_samples::LightSamples;
use super::surfaces::{SurfaceColumns, Surfaces};
use crate::core::lanes::{
    Columns, LANES, by_lane, gather_spectrum, load, load_spectrum, shade_together, store, store_spectrum,
};
use crate::core::math::power_heuristic;
use crate::core::points::Exits;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::integrator::path::{SAFE_BOUNCES, SURVIVAL, dimension};
use crate::integrator::sample_streams::SampleStreams;
use crate::integrator::{Path, SampleStream};
use crate::shading::bsdf::lanes::{Kind, LaneBsdf, RowBsdf};
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// The samples of eight paths. Masks have bit i for lane i.
pub(super) struct Scattered {
    pub(super) kind: Kind,
    /// Lanes whose BSDF has a density, for which a light was sampled.
    pub(super) has_density: u32,
    pub(super) lights: LightSamples,
    pub(super) connections: Connections,
    /// Lanes whose BSDF has sampled a direction.
    pub(super) is_valid: u32,
    pub(super) is_specular: u32,
    pub(super) is_diffuse: u32,
    pub(super) is_transmission: u32,
    /// That direction, in render space, of unit length.
    pub(super) wi: Columns<3>,
    pub(super) f: Columns<4>,
    pub(super) pdf: [f32; LANES],
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
    /// Lanes whose path goes on.
    pub(super) goes_on: u32,
    /// The points and the shading normals, in single precision.
    pub(super) point: Columns<3>,
    pub(super) n: Columns<3>,
}

impl Scattered {
    /// Of no path.
    pub(super) const NONE: Self = Self {
        kind: Kind { pdf_is_proportional: false, needs_lobe: false, needs_agreement: false },
        has_density: 0,
        lights: LightSamples::NONE,
        connections: Connections::NONE,
        is_valid: 0,
        is_specular: 0,
        is_diffuse: 0,
        is_transmission: 0,
        wi: [[0.0; LANES]; 3],
        f: [[0.0; LANES]; 4],
        pdf: [0.0; LANES],
        mis_pdf: [0.0; LANES],
        eta: [0.0; LANES],
        cos: [0.0; LANES],
        origin: [[0.0; LANES]; 3],
        beta: [[0.0; LANES]; 4],
        next_beta: [[0.0; LANES]; 4],
        eta_scale: [0.0; LANES],
        survival: [0.0; LANES],
        survives: 0,
        goes_on: 0,
        point: [[0.0; LANES]; 3],
        n: [[0.0; LANES]; 3],
    };
}

/// What light sampling finds in eight lanes, if nothing is in between.
pub(super) struct Connections {
    /// The BSDF for the direction to the light, times the cosine.
    pub(super) f: Columns<4>,
    /// The density with which the BSDF samples that direction: 0 for light from a single direction.
    pub(super) bsdf_pdf: [f32; LANES],
    /// Weights of multiple importance sampling.
    pub(super) weight: [f32; LANES],
    pub(super) contribution: Columns<4>,
    /// Lanes that have a light sample for which the BSDF is not black.
    pub(super) is_sampled: u32,
    /// Lanes whose contribution is not black.
    pub(super) is_lit: u32,
    pub(super) origin: Columns<3>,
    /// From there to the light, where that is a surface.
    pub(super) end: Columns<3>,
}

impl Connections {
    /// Of no lane.
    const NONE: Self = Self {
        f: [[0.0; LANES]; 4],
        bsdf_pdf: [0.0; LANES],
        weight: [0.0; LANES],
        contribution: [[0.0; LANES]; 4],
        is_sampled: 0,
        is_lit: 0,
        origin: [[0.0; LANES]; 3],
        end: [[0.0; LANES]; 3],
    };
}

impl<S: Simd> Surfaces<S> {
    /// The light samples of the surfaces, weighted.
    #[inline(always)]
    fn connect<B: LaneBsdf<f32x8<S>>>(
        &self,
        simd: S,
        (bsdf, view): (&B, &B::View),
        beta: Spectrum<f32x8<S>>,
        (lights, exits): (&LightSamples, &Exits<'_, f32x8<S>>),
        connections: &mut Connections,
    ) {
        let wi = load(simd, &lights.wi);
        let local = self.local(wi);
        let zero = f32x8::splat(simd, 0.0);
        let (mut f, bsdf_pdf) = bsdf.f_and_pdf(view, local);
        if B::KIND.needs_agreement {
            f = Spectrum::select(self.agrees(wi), f, Spectrum::splat(zero));
        }
        let f = f * Float::abs(local.z);
        let is_delta = mask32x8::from_bitmask(simd, lights.is_delta.into());
        let bsdf_pdf = Float::select(is_delta, zero, bsdf_pdf);
        let light_pdf = f32x8::load_array(simd, lights.probability) * f32x8::load_array(simd, lights.pdf);
        let weight = Float::select(is_delta, zero.like(1.0), power_heuristic(light_pdf, bsdf_pdf));
        let contribution = beta * f * load_spectrum(simd, &lights.li) * (weight / light_pdf);
        let is_sampled = lights.is_valid & !f.is_black().to_bitmask() as u32;
        let origin = exits.toward(wi);
        connections.f = store_spectrum(f);
        connections.bsdf_pdf = bsdf_pdf.into();
        connections.weight = weight.into();
        connections.contribution = store_spectrum(contribution);
        connections.is_sampled = is_sampled;
        connections.is_lit = is_sampled & !contribution.is_black().to_bitmask() as u32;
        connections.origin = store(origin);
        connections.end = lights.ends(simd, origin);
    }

    /// True where the geometric and the shading normal agree whether `wo` and `wi`, in render space, are on one side.
    #[inline(always)]
    fn agrees(&self, wi: Vector<f32x8<S>>) -> mask32x8<S> {
        let zero = self.cos_ng.like(0.0);
        let is_beside = (self.wo.z * wi.dot(self.n)).gt(zero);
        let mut is_outside = (self.cos_ng * wi.dot(Vector::narrow(self.ng))).gt(zero);
        if let Some(lift) = &self.lift {
            is_outside |= zero.narrow_mask(lift.is_above(wi));
        }
        is_outside.choose(is_beside, !is_beside)
    }

    /// Samples lights and directions at the surfaces.
    #[inline(always)]
    fn scatter<B: LaneBsdf<f32x8<S>>>(
        &self,
        simd: S,
        world: &World,
        bsdf: &B,
        paths: &LanePaths<'_>,
        scattered: &mut Scattered,
    ) {
        let streams = SampleStreams::new(simd, &paths.streams);
        let zero = f32x8::splat(simd, 0.0);
        let view = bsdf.view(self.wo);
        let beta = gather_spectrum(simd, &by_lane!(lane => paths.paths[lane].beta));

        let exits = self.points.exits(self.ng).lifted(self.lift.as_ref());

        // Sample one light.
        let has_density = bsdf.has_density();
        scattered.kind = B::KIND;
        scattered.has_density = has_density.to_bitmask() as u32;
        if scattered.has_density != 0 {
            let Scattered { lights, connections, .. } = scattered;
            lights.sample(simd, world, self, &streams, &paths.modes, scattered.has_density);
            self.connect(simd, (bsdf, &view), beta, (lights, &exits), connections);
        }

        // Go on in one direction.
        let [which_lobe, _] = match B::KIND.needs_lobe {
            true => streams.two(dimension::LOBE),
            false => [zero; 2],
        };
        let mut sample =
            bsdf.sample(&view, which_lobe, streams.two_with_pixel(dimension::DIRECTION)).if_useful();
        let wi = self.render(sample.wi);
        if B::KIND.needs_agreement {
            sample.is_valid &= self.agrees(wi);
        }
        let mis_pdf = match B::KIND.pdf_is_proportional {
            true => bsdf.pdf(&view, self.local(wi)),
            false => sample.pdf,
        };
        let cos = Float::abs(wi.dot(self.n));
        let beta = beta * sample.f * (cos / sample.pdf);
        let eta_scale = f32x8::load_array(simd, by_lane!(lane => paths.paths[lane].previous.eta_scale))
            * Float::select(sample.is_transmission, sample.eta * sample.eta, zero.like(1.0));

        // End paths of small throughput by Russian roulette.
        let mut survival = beta.max_lane() * eta_scale * SURVIVAL;
        let depth = u32x8::load_array(simd, by_lane!(lane => paths.paths[lane].depth));
        let is_safe = survival.simd_ge(1.0) | depth.simd_lt(SAFE_BOUNCES);
        let mut survives = is_safe;
        survival = Float::select(is_safe, zero.like(1.0), survival);
        if !(is_safe | !sample.is_valid).all() {
            let [u, _] = streams.two(dimension::ROULETTE);
            survives = is_safe | u.simd_lt(survival);
        }
        let goes_on = sample.is_valid & survives & !beta.is_black();
        scattered.is_valid = sample.is_valid.to_bitmask() as u32;
        scattered.is_specular = sample.is_specular.to_bitmask() as u32;
        scattered.is_diffuse = sample.is_diffuse.to_bitmask() as u32;
        scattered.is_transmission = sample.is_transmission.to_bitmask() as u32;
        scattered.wi = store(wi);
        scattered.f = store_spectrum(sample.f);
        scattered.pdf = sample.pdf.into();
        scattered.mis_pdf = Float::select(sample.is_specular, zero.like(f32::INFINITY), mis_pdf).into();
        scattered.eta = sample.eta.into();
        scattered.cos = cos.into();
        scattered.origin = store(exits.toward(wi));
        scattered.beta = store_spectrum(beta);
        scattered.next_beta = store_spectrum(beta / survival);
        scattered.eta_scale = eta_scale.into();
        scattered.survival = survival.into();
        scattered.survives = survives.to_bitmask() as u32;
        scattered.goes_on = goes_on.to_bitmask() as u32;
        scattered.point = store(Vector::narrow(self.points.position));
        scattered.n = store(self.n);
    }
}

/// What the path tracer knows of eight paths.
pub(super) struct LanePaths<'a> {
    pub(super) paths: [&'a Path; LANES],
    pub(super) streams: [&'a SampleStream; LANES],
    pub(super) modes: [&'a SpectralMode; LANES],
}

/// Scatters eight paths at surfaces whose BSDFs are of one class.
pub(super) struct ScatterKernel<'a, B> {
    pub(super) world: &'a World,
    pub(super) surfaces: &'a SurfaceColumns,
    pub(super) bsdfs: &'a [&'a B; LANES],
    pub(super) paths: LanePaths<'a>,
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
        let Self { world, surfaces, bsdfs, paths, scattered } = self;
        let bsdf = B::gather(simd, bsdfs);
        surfaces.load(simd).scatter(simd, world, &bsdf, &paths, scattered);
    }
}
