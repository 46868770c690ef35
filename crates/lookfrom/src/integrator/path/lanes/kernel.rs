//! Scattering of eight paths side by side: one light sampled, one direction sampled by the BSDF, and the origins of the
//! rays. Numbers only; the parent module makes rays and events of them.

use lookfrom_simd::{
    Float, Kernel, Mask, Simd, dispatch, f32x8, f64x8, level, mask32x8, prelude::*, u32x8, u64x8,
};

use super::light_samples::LightSamples;
use crate::core::hash;
use crate::core::lanes::{LANES, by_lane, gather, gather_f64, scatter, scatter_spectrum};
use crate::core::points::Points;
use crate::core::sampler::lanes::PixelSamplers;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::integrator::SampleStream;
use crate::integrator::path::{Vertex, dimension};
use crate::shading::bsdf::lanes::{Kind, LaneBsdf, RowBsdf};
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// The samples of eight paths. Masks have bit i for lane i.
pub(super) struct Scattered {
    pub(super) kind: Kind,
    /// Lanes whose BSDF has a density, for which a light was sampled.
    pub(super) has_density: u32,
    pub(super) lights: LightSamples,
    /// The BSDF for the direction to the light, times the cosine.
    pub(super) light_f: [Spectrum; LANES],
    /// The density with which the BSDF samples that direction.
    pub(super) light_bsdf_pdf: [f32; LANES],
    pub(super) shadow_origin: [[f32; 3]; LANES],
    /// From there to the light, where that is a surface.
    pub(super) shadow_end: [[f32; 3]; LANES],
    /// Lanes whose BSDF has sampled a direction.
    pub(super) is_valid: u32,
    pub(super) is_specular: u32,
    pub(super) is_transmission: u32,
    /// That direction, in render space, of unit length.
    pub(super) wi: [[f32; 3]; LANES],
    pub(super) f: [Spectrum; LANES],
    pub(super) pdf: [f32; LANES],
    /// The density to compare with that of light sampling.
    pub(super) mis_pdf: [f32; LANES],
    pub(super) eta: [f32; LANES],
    pub(super) cos: [f32; LANES],
    pub(super) origin: [[f32; 3]; LANES],
    /// The points and the shading normals, in single precision.
    pub(super) point: [[f32; 3]; LANES],
    pub(super) n: [[f32; 3]; LANES],
}

/// Eight surfaces and the frames that they are shaded in.
pub(super) struct Surfaces<S: Simd> {
    pub(super) points: Points<f32x8<S>>,
    /// Geometric normals, of unit length.
    pub(super) ng: Vector<f64x8<S>>,
    pub(super) s: Vector<f32x8<S>>,
    pub(super) t: Vector<f32x8<S>>,
    /// Shading normals.
    pub(super) n: Vector<f32x8<S>>,
    /// In the frame.
    pub(super) wo: Vector<f32x8<S>>,
    /// The cosines of `wo` to the geometric normals.
    pub(super) cos_ng: f32x8<S>,
}

impl<S: Simd> Surfaces<S> {
    #[inline(always)]
    fn of_vertices(simd: S, vertices: &[&Vertex; LANES]) -> Self {
        let axis = by_lane!(lane => vertices[lane].shading.axes());
        let [s, t, n] = [
            gather(simd, &by_lane!(lane => axis[lane][0])),
            gather(simd, &by_lane!(lane => axis[lane][1])),
            gather(simd, &by_lane!(lane => axis[lane][2])),
        ];
        let wo = gather(simd, &by_lane!(lane => vertices[lane].surface.wo.to_array()));
        let position = gather_f64(simd, &by_lane!(lane => vertices[lane].surface.point.position));
        let error = gather_f64(simd, &by_lane!(lane => vertices[lane].surface.point.error));
        let ng = gather_f64(simd, &by_lane!(lane => vertices[lane].surface.ng.to_array()));
        let cos_ng = wo.dot(Vector::narrow(ng));
        let wo = Vector { x: wo.dot(s), y: wo.dot(t), z: wo.dot(n) };
        Self { points: Points { position, error }, ng, s, t, n, wo, cos_ng }
    }

    /// From render space to the frames.
    #[inline(always)]
    fn local(&self, w: Vector<f32x8<S>>) -> Vector<f32x8<S>> {
        Vector { x: w.dot(self.s), y: w.dot(self.t), z: w.dot(self.n) }
    }

    /// From the frames to render space, of unit length.
    #[inline(always)]
    fn render(&self, w: Vector<f32x8<S>>) -> Vector<f32x8<S>> {
        (self.s * w.x + self.t * w.y + self.n * w.z).normalize()
    }

    /// True where the geometric and the shading normal agree whether `wo` and `wi`, in render space, are on one side.
    #[inline(always)]
    fn agrees(&self, wi: Vector<f32x8<S>>) -> mask32x8<S> {
        let zero = self.cos_ng.like(0.0);
        let is_beside = (self.wo.z * wi.dot(self.n)).gt(zero);
        (self.cos_ng * wi.dot(Vector::narrow(self.ng))).gt(zero).choose(is_beside, !is_beside)
    }

    /// Samples lights and directions at the surfaces.
    #[inline(always)]
    pub(super) fn scatter<B: LaneBsdf<f32x8<S>>>(
        &self,
        simd: S,
        world: &World,
        bsdf: &B,
        streams: &[&SampleStream; LANES],
        modes: &[&SpectralMode; LANES],
    ) -> Scattered {
        let streams = SampleStreams::new(simd, streams);
        let zero = f32x8::splat(simd, 0.0);
        let view = bsdf.view(self.wo);

        // Sample one light.
        let has_density = bsdf.has_density();
        let (mut lights, mut light_f, mut light_bsdf_pdf) =
            (LightSamples::NONE, [Spectrum::BLACK; LANES], [0.0; LANES]);
        let (mut shadow_origin, mut shadow_end) = ([[0.0; 3]; LANES], [[0.0; 3]; LANES]);
        if has_density.any() {
            lights = LightSamples::new(simd, world, self, &streams, modes, has_density.to_bitmask() as u32);
            let wi = gather(simd, &lights.wi);
            let local = self.local(wi);
            let (mut f, pdf) = bsdf.f_and_pdf(&view, local);
            if B::KIND.needs_agreement {
                f = Spectrum::select(self.agrees(wi), f, Spectrum::splat(zero));
            }
            light_bsdf_pdf = pdf.into();
            light_f = scatter_spectrum(f * Float::abs(local.z));
            let origin = self.points.leave(self.ng, wi);
            shadow_end = lights.ends(simd, origin);
            shadow_origin = scatter(origin);
        }

        // Go on in one direction.
        let [_, which_lobe] = match B::KIND.needs_lobe {
            true => streams.two(dimension::CHOICE),
            false => [zero; 2],
        };
        let mut sample = bsdf.sample(&view, which_lobe, streams.two(dimension::DIRECTION)).if_useful();
        let wi = self.render(sample.wi);
        if B::KIND.needs_agreement {
            sample.is_valid &= self.agrees(wi);
        }
        let mis_pdf = match B::KIND.pdf_is_proportional {
            true => bsdf.pdf(&view, self.local(wi)),
            false => sample.pdf,
        };
        Scattered {
            kind: B::KIND,
            has_density: has_density.to_bitmask() as u32,
            lights,
            light_f,
            light_bsdf_pdf,
            shadow_origin,
            shadow_end,
            is_valid: sample.is_valid.to_bitmask() as u32,
            is_specular: sample.is_specular.to_bitmask() as u32,
            is_transmission: sample.is_transmission.to_bitmask() as u32,
            wi: scatter(wi),
            f: scatter_spectrum(sample.f),
            pdf: sample.pdf.into(),
            mis_pdf: mis_pdf.into(),
            eta: sample.eta.into(),
            cos: Float::abs(wi.dot(self.n)).into(),
            origin: scatter(self.points.leave(self.ng, wi)),
            point: scatter(Vector::narrow(self.points.position)),
            n: scatter(self.n),
        }
    }
}

/// Scatters eight paths at surfaces whose BSDFs are of one class.
pub(super) struct ScatterKernel<'a, B> {
    pub(super) world: &'a World,
    pub(super) vertices: &'a [&'a Vertex; LANES],
    pub(super) bsdfs: &'a [&'a B; LANES],
    /// By slot.
    pub(super) modes: &'a [SpectralMode],
}

impl<B: RowBsdf> ScatterKernel<'_, B> {
    /// Runs at the machine's level. Not inlined, so that a class is compiled once, whatever the probe.
    #[inline(never)]
    pub(super) fn scatter(self) -> Scattered {
        dispatch(level(), self)
    }
}

impl<B: RowBsdf> Kernel for ScatterKernel<'_, B> {
    type Output = Scattered;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Scattered {
        let Self { world, vertices, bsdfs, modes } = self;
        let surfaces = Surfaces::of_vertices(simd, vertices);
        let bsdf = B::gather(simd, bsdfs);
        let streams = by_lane!(lane => &vertices[lane].stream);
        let modes = by_lane!(lane => &modes[vertices[lane].path.slot as usize]);
        surfaces.scatter(simd, world, &bsdf, &streams, &modes)
    }
}

/// [`SampleStream`] in lanes.
pub(super) struct SampleStreams<S: Simd> {
    samplers: PixelSamplers<S>,
    sample: u32x8<S>,
    /// Of the address, before the dimension.
    mixed: u64x8<S>,
}

impl<S: Simd> SampleStreams<S> {
    #[inline(always)]
    fn new(simd: S, streams: &[&SampleStream; LANES]) -> Self {
        let address = u64x8::load_array(simd, by_lane!(lane => streams[lane].address));
        Self {
            samplers: PixelSamplers::new(simd, &by_lane!(lane => streams[lane].sampler)),
            sample: u32x8::load_array(simd, by_lane!(lane => streams[lane].sample)),
            mixed: hash::mix(address + hash::GOLDEN),
        }
    }

    /// As [`SampleStream::two`].
    #[inline(always)]
    pub(super) fn two(&self, dimension: u32) -> [f32x8<S>; 2] {
        let dimension = hash::mix(self.mixed ^ u64::from(dimension)) & u64::from(u32::MAX);
        self.samplers.two(self.sample, dimension)
    }
}
