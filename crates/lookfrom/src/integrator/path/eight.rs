//! SIMD version of [`PathTracer::step`](crate::integrator::Integrator::step) for eight hits on flat triangles of a
//! diffuse material of one colour, bit for bit the same: each operation is the same, in the same order, in eight lanes.
//! Light sampling, and what cannot be vectorised, is in `light_samples`.

mod light_samples;

use std::f32::consts::FRAC_1_PI;

use lookfrom_bvh::{Hit, NONE, OriginPrimitive, Point, Ray};
use lookfrom_simd::{Kernel, Simd, f32x8, f64x8, prelude::*, u32x8, u64x8};

use super::{PathTracer, PreviousVertex, dimension, power_heuristic};
use crate::core::eight::{LANES, Narrow, Points, Vectors, Wide, by_axis, by_lane, orthonormal_bases};
use crate::core::hash::GOLDEN;
use crate::core::sampler::eight::{PixelSamplers, mix};
use crate::core::spectrum::Spectrum;
use crate::core::warp;
use crate::integrator::shadow;
use crate::integrator::{Bounce, Event, Path, Probe, SampleStream, Shadow, StepOutput, Term};
use crate::light::Target;
use crate::primitive::Mesh;
use crate::shading::bsdf::BsdfSample;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::material::Shading;
use crate::shading::texture::{SpectralMode, TexturePoint};
use crate::world::World;
use light_samples::LightSamples;

/// A path that hit a flat triangle of a diffuse material of one colour.
#[derive(Clone, Copy)]
pub(super) struct FlatDiffuseHit<'a> {
    path: &'a Path,
    hit: &'a Hit,
    mesh: &'a Mesh,
    reflectance: Spectrum,
    stream: SampleStream,
}

impl<'a> FlatDiffuseHit<'a> {
    /// The path, if it hit such a surface and its depth allows it to go on from there.
    #[inline]
    pub(super) fn of(
        tracer: &PathTracer,
        world: &'a World,
        path: &'a Path,
        hit: &'a Hit,
        lanes: &SpectralMode,
        stream: impl FnOnce() -> SampleStream,
    ) -> Option<Self> {
        if !hit.is_hit()
            || hit.instance != NONE
            || path.depth >= tracer.depth
            || !path.interior.is_empty()
            || path.previous.is_catcher
        {
            return None;
        }
        let (mesh, reflectance) = world.flat_diffuse(hit.geometry)?;
        let reflectance = world.textures.albedo(reflectance, &TexturePoint::NOWHERE, lanes);
        (!reflectance.is_black()).then(|| Self { path, hit, mesh, reflectance, stream: stream() })
    }
}

/// The steps of up to eight paths.
pub(super) struct Steps<'a, 'b, 'c, P: Probe> {
    pub(super) tracer: &'a PathTracer,
    pub(super) world: &'a World,
    /// The hits; lanes from `count` on repeat the last one.
    pub(super) plain: &'a [FlatDiffuseHit<'a>; LANES],
    pub(super) count: usize,
    pub(super) output: &'b mut StepOutput<'c, P>,
}

impl<P: Probe> Kernel for Steps<'_, '_, '_, P> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { tracer, world, plain, count, output } = self;
        let surfaces = Surfaces::new(simd, plain);
        let stream = SampleStreams::new(simd, plain);

        for (lane, plain) in plain.iter().enumerate().take(count) {
            output.probe.notice(|| surfaces.shaded(lane, world, plain));
        }

        // Sample one light.
        let light_samples = LightSamples::new(simd, world, plain, &surfaces, &stream, &output.queues.lanes);
        let cos = light_samples.wi.dot(surfaces.n);
        let same_side = surfaces.same_side(simd, cos);
        let facing: [f32; LANES] = same_side.select(cos.abs(), f32x8::splat(simd, 0.0)).into();
        let origins = surfaces.points.leave(simd, surfaces.ng, light_samples.wi.widen());
        let ends = light_samples.ends(simd, &origins);
        for lane in 0..count {
            let FlatDiffuseHit { path, reflectance, .. } = &plain[lane];
            let cos = facing[lane];
            let f = *reflectance * FRAC_1_PI * cos;
            let Some(sample) = light_samples.samples[lane].as_ref().filter(|_| !f.is_black()) else {
                output.probe.notice_some(|| light_samples.in_vain(lane, path.address));
                continue;
            };
            let light_pdf = sample.probability * sample.pdf;
            let bsdf_pdf = warp::cosine_hemisphere_pdf(cos);
            let weight = if sample.is_delta { 1.0 } else { power_heuristic(light_pdf, bsdf_pdf) };
            let contribution = path.beta * f * sample.li * (weight / light_pdf);
            output.probe.notice(|| Event::LightSampled {
                address: path.address,
                light: sample.light,
                probability: sample.probability,
                sample: light_samples.light_sample(lane, sample),
                f,
                bsdf_pdf: if sample.is_delta { 0.0 } else { bsdf_pdf },
                weight,
            });
            if contribution.is_black() {
                continue;
            }
            let origin = origins.lane(lane);
            let ray = match sample.target {
                Target::Infinity => Ray::new(origin, light_samples.wi.lane(lane)),
                Target::Point(position) => shadow::toward(origin, position.to_array()),
                Target::Surface(..) => Ray { t_max: 1.0, ..Ray::new(origin, ends.lane(lane)) },
            };
            let Path { slot, address, interior, .. } = **path;
            output.queues.shadows.push(Shadow {
                ray,
                origin_primitive: OriginPrimitive::of(plain[lane].hit),
                contribution,
                slot,
                address,
                term: Term::Light(sample.light),
                interior,
            });
        }

        // Go on in one direction.
        let local = surfaces.cosine_directions(simd, stream.two(simd, dimension::DIRECTION));
        let pdf = local.0[2].abs().max(0.0) * FRAC_1_PI;
        let wi = surfaces.to_render(simd, local);
        let cos = wi.dot(surfaces.n).abs();
        let factor = cos / pdf;
        let origins = surfaces.points.leave(simd, surfaces.ng, wi.widen());
        let [pdf, factor, cos]: [[f32; LANES]; 3] = [pdf.into(), factor.into(), cos.into()];
        let (side, height): ([f32; LANES], [f32; LANES]) = (surfaces.wo_z.into(), local.0[2].into());
        let points = surfaces.points.position.narrow();
        for lane in 0..count {
            let FlatDiffuseHit { path, reflectance, stream, .. } = &plain[lane];
            let f = *reflectance * FRAC_1_PI;
            let is_grazing = |z: f32| !(z.abs() > 1e-12);
            let is_useful = pdf[lane] > 0.0 && f.0.into_iter().all(f32::is_finite);
            if is_grazing(side[lane]) || is_grazing(height[lane]) || !is_useful {
                continue;
            }
            let beta = path.beta * f * factor[lane];
            let eta_scale = path.previous.eta_scale;
            let depth = path.depth + 1;
            let (survival, survives) = tracer.roulette(stream, beta, eta_scale, depth);
            output.probe.notice(|| {
                let wi = wi.lane(lane).into();
                let sample = BsdfSample::diffuse(wi, f, pdf[lane]);
                let bounce = Bounce { wi, cos: cos[lane], sample, beta, survival, survives };
                Event::Bounced { address: path.address, bounce: Box::new(bounce) }
            });
            if !survives || beta.is_black() {
                continue;
            }
            output.queues.paths.push(Path {
                ray: Ray::new(origins.lane(lane), wi.lane(lane)),
                beta: beta / survival,
                slot: path.slot,
                depth,
                address: path.address + 1,
                interior: path.interior,
                previous: PreviousVertex {
                    pdf: pdf[lane],
                    origin_primitive: OriginPrimitive::of(plain[lane].hit),
                    point: points.lane(lane).into(),
                    n: surfaces.n.lane(lane).into(),
                    eta_scale,
                    blurred: true,
                    is_catcher: false,
                },
            });
        }
    }
}

/// SIMD version of [`World::surface`] and of the shading frame.
struct Surfaces<S: Simd> {
    points: Points<S>,
    ng: Vectors<Wide<S>>,
    /// In single precision.
    n: Vectors<Narrow<S>>,
    s: Vectors<Narrow<S>>,
    t: Vectors<Narrow<S>>,
    /// Cosine of the outgoing direction `wo`.
    wo_z: Narrow<S>,
}

impl<S: Simd> Surfaces<S> {
    #[inline(always)]
    fn new(simd: S, plain: &[FlatDiffuseHit<'_>; LANES]) -> Self {
        let corners = by_lane!(lane => plain[lane].mesh.corners(plain[lane].hit.primitive as usize));
        let corners = by_axis!(k => Vectors::<Narrow<S>>::of_rows(simd, &by_lane!(lane => corners[lane][k])));
        let u = f32x8::load_array(simd, by_lane!(lane => plain[lane].hit.u));
        let v = f32x8::load_array(simd, by_lane!(lane => plain[lane].hit.v));
        let (points, across) = Points::on_triangles(simd, corners, u, v);
        let flip = f64x8::load_array(simd, by_lane!(lane => if plain[lane].mesh.flip { -1.0 } else { 1.0 }));
        let ng = across.normalize(simd).scale(flip);
        let n = ng.narrow();
        let direction =
            Vectors::<Narrow<S>>::of_rows(simd, &by_lane!(lane => plain[lane].path.ray.direction));
        let minus = f64x8::splat(simd, -1.0);
        let wo = direction.widen().normalize(simd).scale(minus).narrow();
        let [s, t] = orthonormal_bases(simd, n);
        Self { points, ng, n, s, t, wo_z: wo.dot(n) }
    }

    /// The event of one lane, for a probe.
    fn shaded(&self, lane: usize, world: &World, plain: &FlatDiffuseHit<'_>) -> Event {
        let FlatDiffuseHit { path, hit, reflectance, .. } = plain;
        let [n, s, t] = [self.n, self.s, self.t].map(|axis| axis.lane(lane).into());
        let ng = by_axis!(i => self.ng.0[i][lane]).into();
        let point = Point {
            position: by_axis!(i => self.points.position.0[i][lane]),
            error: by_axis!(i => self.points.error.0[i][lane]),
        };
        let surface = SurfaceInteraction { point, ng, ns: n, ..world.surface(&path.ray, hit) };
        Event::Shaded {
            address: path.address,
            shading: Box::new(Shading::diffuse(*reflectance, [s, t, n], surface.ng)),
            surface: Box::new(surface),
            beta: path.beta,
        }
    }

    /// Whether `wi` of these cosines is on the same side as `wo`, and neither is grazing.
    #[inline(always)]
    fn same_side(&self, simd: S, wi_z: Narrow<S>) -> lookfrom_simd::mask32x8<S> {
        let least = f32x8::splat(simd, 1e-12);
        let product = self.wo_z * wi_z;
        product.simd_gt(f32x8::splat(simd, 0.0)) & self.wo_z.abs().simd_gt(least) & wi_z.abs().simd_gt(least)
    }

    /// SIMD version of `bsdf::diffuse::cosine_direction`.
    #[inline(always)]
    fn cosine_directions(&self, simd: S, u: [Narrow<S>; 2]) -> Vectors<Narrow<S>> {
        let [x, y] = warp::concentric_disks(simd, u);
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let least = f32x8::splat(simd, 1.0 / 16_777_216.0);
        let height = (one - (x * x + y * y)).max(least).sqrt();
        Vectors([x + zero, y + zero, height.copysign(self.wo_z)])
    }

    /// A vector from the shading frame to render space, of unit length.
    #[inline(always)]
    fn to_render(&self, simd: S, v: Vectors<Narrow<S>>) -> Vectors<Narrow<S>> {
        let [x, y, z] = v.0;
        self.s.scale(x).add(self.t.scale(y)).add(self.n.scale(z)).normalize(simd)
    }
}

/// SIMD version of [`SampleStream`].
struct SampleStreams<S: Simd> {
    samplers: PixelSamplers<S>,
    sample: u32x8<S>,
    /// The hashed address, before the dimension is mixed in.
    mixed: u64x8<S>,
}

impl<S: Simd> SampleStreams<S> {
    #[inline(always)]
    fn new(simd: S, plain: &[FlatDiffuseHit<'_>; LANES]) -> Self {
        let address = u64x8::load_array(simd, by_lane!(lane => plain[lane].stream.address));
        Self {
            samplers: PixelSamplers::new(simd, &by_lane!(lane => plain[lane].stream.sampler)),
            sample: u32x8::load_array(simd, by_lane!(lane => plain[lane].stream.sample)),
            mixed: mix(address + GOLDEN),
        }
    }

    #[inline(always)]
    fn two(&self, simd: S, dimension: u32) -> [Narrow<S>; 2] {
        let dimension = mix(self.mixed ^ u64::from(dimension)) & u64::from(u32::MAX);
        self.samplers.two(simd, self.sample, dimension)
    }
}
