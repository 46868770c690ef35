//! Hits on triangle meshes, shaded in lanes from the hit on: most of most pictures.

use glam::{DVec3, Vec2};
use lookfrom_bvh::{Hit, OriginPrimitive};
use lookfrom_simd::{Float, Kernel, Simd, dispatch, f32x8, level, mask64x8, prelude::*};

use super::Item;
use super::kernel::{LanePaths, ScatterKernel};
use super::surfaces::SurfaceColumns;
use crate::core::lanes::{LANES, bitmask, by_lane, gather};
use crate::core::points::{Placement, gather_placements};
use crate::core::vector::Vector;
use crate::integrator::path::PathTracer;
use crate::integrator::{Event, Path, Probe, SampleStream, StepOutput};
use crate::primitive::{Mesh, gather_triangles};
use crate::shading::bsdf::lanes::BsdfClass;
use crate::shading::material::{Material, MaterialRow, ShadingContext, frame_about};
use crate::shading::texture::TexturePoint;
use crate::world::World;

/// A batch of paths and what they have hit.
pub(in crate::integrator::path) struct HitBatch<'a, F> {
    pub(in crate::integrator::path) world: &'a World,
    pub(in crate::integrator::path) paths: &'a [Path],
    pub(in crate::integrator::path) hits: &'a [Hit],
    /// The random numbers of a path.
    pub(in crate::integrator::path) stream: F,
}

impl<'a, F: Fn(&Path) -> SampleStream> HitBatch<'a, F> {
    /// The class of a path that met a mesh whose material has BSDFs of a class, and is to go on from there, in no medium.
    #[inline]
    pub(in crate::integrator::path) fn mesh_class(
        &self,
        tracer: &PathTracer,
        index: usize,
    ) -> Option<BsdfClass> {
        let (path, hit) = (&self.paths[index], &self.hits[index]);
        if !hit.is_hit()
            || path.depth >= tracer.depth
            || !path.interior.is_empty()
            || path.previous.is_catcher
        {
            return None;
        }
        self.world.mesh_class(hit)
    }

    /// A path that has such a class.
    #[inline(always)]
    fn mesh_hit(&self, index: u32) -> Option<MeshHit<'a>> {
        let (path, hit) = (&self.paths[index as usize], &self.hits[index as usize]);
        let (mesh, material, placement) = self.world.mesh(hit)?;
        Some(MeshHit { path, hit, mesh, material, placement })
    }
}

/// A path that met a mesh.
#[derive(Clone, Copy)]
struct MeshHit<'a> {
    path: &'a Path,
    hit: &'a Hit,
    mesh: &'a Mesh,
    material: &'a Material,
    /// The placement of the instance that the mesh is in.
    placement: Option<&'a Placement<f32>>,
}

impl PathTracer {
    /// Scatters up to eight paths of a batch that met meshes of one class.
    pub(super) fn scatter_mesh_hits<B: MaterialRow, P: Probe>(
        &self,
        batch: &HitBatch<'_, impl Fn(&Path) -> SampleStream>,
        indices: &[u32],
        output: &mut StepOutput<'_, P>,
    ) {
        let Some(last) = indices.last() else { return };
        if P::LISTENS {
            self.notice_shading(batch, indices, output);
        }
        // Unused lanes repeat the last hit.
        let Some(last) = batch.mesh_hit(*last) else { return };
        let hits =
            by_lane!(lane => indices.get(lane).and_then(|index| batch.mesh_hit(*index)).unwrap_or(last));
        let MeshPoints { surfaces, uv } = MeshKernel(&hits).points();

        // Evaluate the materials.
        let world = batch.world;
        let mut rows = [None; LANES];
        for (lane, MeshHit { path, hit, mesh, material, .. }) in hits.iter().enumerate() {
            let point = TexturePoint {
                uv: Vec2::new(uv[0][lane], uv[1][lane]),
                world: world.origin + DVec3::from_array(surfaces.position(lane)),
                color: mesh.color(hit.primitive as usize, hit.u, hit.v),
                n: DVec3::from_array(surfaces.ng(lane)).as_vec3(),
                ..TexturePoint::NOWHERE
            };
            let mode = &mut output.queues.lanes[path.slot as usize];
            let mut row: Option<B> = material.row(&world.textures, &point, mode);
            if self.regularize && path.previous.blurred {
                row.iter_mut().for_each(B::regularize);
            }
            rows[lane] = row;
        }
        let Some(first) = &rows[0] else { return };
        let bsdfs = by_lane!(lane => rows[lane].as_ref().unwrap_or(first));

        let streams = by_lane!(lane => (batch.stream)(hits[lane].path));
        let paths = LanePaths {
            paths: by_lane!(lane => hits[lane].path),
            streams: by_lane!(lane => &streams[lane]),
            modes: by_lane!(lane => &output.queues.lanes[hits[lane].path.slot as usize]),
        };
        let scattered = ScatterKernel { world, surfaces: &surfaces, bsdfs: &bsdfs, paths }.scatter();
        let items = by_lane!(lane => Item {
            path: hits[lane].path,
            origin_primitive: OriginPrimitive::of(hits[lane].hit),
            surface: None,
            is_catcher: false,
        });
        self.go_on(world, &items, indices.len(), &scattered, output);
    }

    /// Tells the probe of the surfaces and their shading, as scalar code has them.
    #[cold]
    fn notice_shading<P: Probe>(
        &self,
        batch: &HitBatch<'_, impl Fn(&Path) -> SampleStream>,
        indices: &[u32],
        output: &mut StepOutput<'_, P>,
    ) {
        for index in indices {
            let (path, hit) = (&batch.paths[*index as usize], &batch.hits[*index as usize]);
            let surface = batch.world.surface(&path.ray, hit);
            let (mut mode, mut beta) = (output.queues.lanes[path.slot as usize], path.beta);
            let arrival =
                ShadingContext { lanes: &mut mode, throughput: &mut beta, interior: path.interior, u: 0.0 };
            let Some(mut shading) = batch.world.shading(&surface, arrival) else { continue };
            if self.regularize && path.previous.blurred {
                shading.bsdf.regularize();
            }
            output.probe.notice(|| Event::Shaded {
                address: path.address,
                surface: Box::new(surface),
                shading: Box::new(shading),
                beta: path.beta,
            });
        }
    }
}

/// The points of eight hits, in the frames of materials without bump mapping.
struct MeshPoints {
    surfaces: SurfaceColumns,
    uv: [[f32; LANES]; 2],
}

struct MeshKernel<'a>(&'a [MeshHit<'a>; LANES]);

impl MeshKernel<'_> {
    #[inline(never)]
    fn points(self) -> MeshPoints {
        dispatch(level(), self)
    }
}

impl Kernel for MeshKernel<'_> {
    type Output = MeshPoints;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> MeshPoints {
        let hits = self.0;
        let triangles = gather_triangles(
            simd,
            &by_lane!(lane => hits[lane].mesh),
            &by_lane!(lane => hits[lane].hit.primitive),
        );
        let u = f32x8::load_array(simd, by_lane!(lane => hits[lane].hit.u));
        let v = f32x8::load_array(simd, by_lane!(lane => hits[lane].hit.v));
        let mut at = triangles.points(u, v);
        if let Some(first) = hits.iter().find_map(|hit| hit.placement) {
            let are_placed = bitmask(&by_lane!(lane => hits[lane].placement.is_some()));
            let placements =
                gather_placements(simd, &by_lane!(lane => hits[lane].placement.unwrap_or(first)));
            at = at.placed(mask64x8::from_bitmask(simd, are_placed.into()), &placements);
        }
        let direction = gather(simd, &by_lane!(lane => hits[lane].path.ray.direction));
        let wo = Vector::narrow(-direction.widen().normalize());
        let [ng, ns]: [Vector<f32x8<S>>; 2] = [Vector::narrow(at.ng), Vector::narrow(at.ns)];
        let n = ns.negate_where(ns.dot(ng).lt(ns.x.like(0.0)));
        let (s, t) = frame_about(n, Vector::narrow(at.shading_dpdu));
        let surfaces = SurfaceColumns::new(at.points, at.ng, [s, t, n], wo);
        MeshPoints { surfaces, uv: [at.uv[0].into(), at.uv[1].into()] }
    }
}
