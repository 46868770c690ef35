//! The commonest surfaces, shaded in lanes from the hit on: flat triangles of a diffuse material of one colour.

use lookfrom_bvh::{Hit, NONE, OriginPrimitive};
use lookfrom_simd::{Kernel, Simd, dispatch, f32x8, f64x8, level, prelude::*};

use super::Item;
use super::kernel::{Scattered, Surfaces};
use crate::core::lanes::{LANES, by_lane, gather, gather_spectrum};
use crate::core::points::Points;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::core::warp;
use crate::integrator::path::PathTracer;
use crate::integrator::{Event, Path, Probe, SampleStream, StepOutput};
use crate::primitive::Mesh;
use crate::shading::bsdf::diffuse::Diffuse;
use crate::shading::material::Shading;
use crate::shading::texture::{SpectralMode, TexturePoint};
use crate::world::World;

/// A path that met such a surface.
#[derive(Clone, Copy)]
pub(in crate::integrator::path) struct FlatDiffuseHit<'a> {
    path: &'a Path,
    hit: &'a Hit,
    mesh: &'a Mesh,
    reflectance: Spectrum,
    stream: SampleStream,
}

impl<'a> FlatDiffuseHit<'a> {
    /// The path, if it met such a surface and is to go on from there.
    #[inline]
    pub(in crate::integrator::path) fn of(
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

impl PathTracer {
    /// Scatters up to eight paths that met flat diffuse surfaces.
    pub(in crate::integrator::path) fn scatter_flat<P: Probe>(
        &self,
        world: &World,
        flat: &[FlatDiffuseHit<'_>],
        output: &mut StepOutput<'_, P>,
    ) {
        let Some(last) = flat.last() else { return };
        for FlatDiffuseHit { path, hit, reflectance, .. } in flat {
            output.probe.notice(|| {
                let surface = world.surface(&path.ray, hit);
                let shading = Box::new(Shading::matte(&surface, *reflectance));
                Event::Shaded { address: path.address, surface: Box::new(surface), shading, beta: path.beta }
            });
        }
        // Unused lanes repeat the last hit.
        let eight = by_lane!(lane => *flat.get(lane).unwrap_or(last));
        let kernel = FlatKernel { world, flat: &eight, modes: &output.queues.lanes };
        let scattered = kernel.scatter();
        let items = by_lane!(lane => Item {
            path: eight[lane].path,
            stream: &eight[lane].stream,
            origin_primitive: OriginPrimitive::of(eight[lane].hit),
            surface: None,
            is_catcher: false,
        });
        self.go_on(world, &items, flat.len(), &scattered, output);
    }
}

struct FlatKernel<'a> {
    world: &'a World,
    flat: &'a [FlatDiffuseHit<'a>; LANES],
    /// By slot.
    modes: &'a [SpectralMode],
}

impl FlatKernel<'_> {
    #[inline(never)]
    fn scatter(self) -> Scattered {
        dispatch(level(), self)
    }
}

impl Kernel for FlatKernel<'_> {
    type Output = Scattered;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Scattered {
        let Self { world, flat, modes } = self;
        let surfaces = surfaces(simd, flat);
        let reflectance = gather_spectrum(simd, &by_lane!(lane => flat[lane].reflectance));
        let streams = by_lane!(lane => &flat[lane].stream);
        let modes = by_lane!(lane => &modes[flat[lane].path.slot as usize]);
        surfaces.scatter(simd, world, &Diffuse { reflectance }, &streams, &modes)
    }
}

/// As [`World::surface`] and the frame of a diffuse material have them.
#[inline(always)]
fn surfaces<S: Simd>(simd: S, flat: &[FlatDiffuseHit<'_>; LANES]) -> Surfaces<S> {
    let corners = by_lane!(lane => flat[lane].mesh.corners(flat[lane].hit.primitive as usize));
    let corners = [
        gather(simd, &by_lane!(lane => corners[lane][0])),
        gather(simd, &by_lane!(lane => corners[lane][1])),
        gather(simd, &by_lane!(lane => corners[lane][2])),
    ];
    let u = f32x8::load_array(simd, by_lane!(lane => flat[lane].hit.u));
    let v = f32x8::load_array(simd, by_lane!(lane => flat[lane].hit.v));
    let (points, across) = Points::<f32x8<S>>::on_triangles(corners, u, v);
    let flip = f64x8::load_array(simd, by_lane!(lane => if flat[lane].mesh.flip { -1.0 } else { 1.0 }));
    let ng = across.normalize() * flip;
    let n = Vector::narrow(ng);
    let direction = gather(simd, &by_lane!(lane => flat[lane].path.ray.direction));
    let wo = Vector::narrow(-direction.widen().normalize());
    let (s, t) = warp::basis_about(n);
    let wo = Vector { x: wo.dot(s), y: wo.dot(t), z: wo.dot(n) };
    Surfaces { points, ng, s, t, n, wo, cos_ng: wo.z }
}
