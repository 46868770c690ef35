//! Hits on triangle meshes, shaded in lanes from the hit on: most of most pictures.

use glam::DVec3;
use lookfrom_bvh::{Hit, OriginPrimitive};
use lookfrom_simd::{Float, Kernel, LaneMask, Simd, f32x8, prelude::*};

use super::Memory;
use super::bent_frames::BentFrames;
use super::kernel::ScatterKernel;
use super::vertices::VertexColumns;
use crate::core::lanes::{Columns, LANES, bitmask, by_lane, gather, row, set_row, shade_together, store};
use crate::core::points::{Lift, StoredPlacement};
use crate::core::vector::Vector;
use crate::integrator::path::{Departure, HitBatch, Path, StepOutput};
use crate::integrator::path::{PathTracer, dimension};
use crate::integrator::wavefront::{Boundary, Eight};
use crate::integrator::{Event, Integrator, Probe, SampleStream};
use crate::primitive::{Mesh, points_on_meshes};
use crate::shading::bsdf::BsdfClass;
use crate::shading::material::{self, Material, MaterialRow, Shading, ShadingContext, frame_about};
use crate::shading::texture::TexturePoint;

impl<'a> HitBatch<'a> {
    /// Whether a path travels in no medium and comes from no shadow catcher.
    #[inline]
    pub(in crate::integrator) fn is_in_vacuum(&self, index: usize) -> bool {
        let path = &self.paths[index];
        path.interior.is_empty() && !path.state.is_catcher
    }

    /// The class of a path that met a mesh whose material has BSDFs of a class, and is to go on from there.
    #[inline]
    pub(in crate::integrator) fn mesh_class(&self, tracer: &PathTracer, index: usize) -> Option<BsdfClass> {
        match self.paths[index].depth < tracer.depth {
            true => self.world.mesh_class(&self.hits[index]),
            false => None,
        }
    }

    /// A plain path that has such a class.
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
    placement: Option<StoredPlacement<'a>>,
}

impl MeshHit<'_> {
    /// Whether the path passes the surface where it hit the back of it.
    #[inline]
    fn passes_back_faces(&self) -> bool {
        self.mesh.binding.single_sided && !self.path.blurred
    }
}

impl PathTracer {
    /// Scatters up to eight paths of a batch that met meshes of one class.
    pub(super) fn scatter_mesh_hits<B: MaterialRow, P: Probe>(
        &self,
        batch: &HitBatch<'_>,
        eight: &Eight<'_>,
        memory: &mut Memory,
        output: &mut StepOutput<'_, P>,
    ) {
        let indices = eight.paths;
        // Unused lanes repeat the last hit.
        let hits = by_lane!(lane => match batch.mesh_hit(indices[lane.min(indices.len() - 1)]) {
            Some(hit) => hit,
            None => return,
        });
        let Memory { points: mesh_points, scattered } = memory;
        let varies = hits.iter().any(|hit| hit.material.varies);
        // Camera rays' surfaces, which AOVs need.
        let are_first = match output.queues.first_surfaces.are_wanted() {
            true => bitmask(&by_lane!(lane => hits[lane].path.is_root())),
            false => 0,
        };
        MeshKernel { hits: &hits, varies, are_first: are_first != 0, points: mesh_points }.set_points();
        let MeshPoints { surfaces, uv, front, smooth, bent } = mesh_points;
        let (front, smooth) = (*front, *smooth);

        // Paths from the camera pass the back faces of single-sided meshes.
        let mut active = (1 << indices.len()) - 1;
        for (lane, index) in indices.iter().enumerate() {
            if hits[lane].passes_back_faces() && front & 1 << lane == 0 {
                let (path, hit) = (&batch.paths[*index as usize], &batch.hits[*index as usize]);
                self.step(batch.world, &batch.streams.of(path), path, hit, output);
                active &= !(1 << lane);
            }
        }
        if active == 0 {
            return;
        }

        // Evaluate the materials. Most are the same everywhere.
        let world = batch.world;
        let pictures = by_lane!(lane => &hits[lane].material.pictures);
        let mut varying = None;
        let look_ups;
        if varies {
            let points = varying.insert([TexturePoint::NOWHERE; LANES]);
            for (lane, hit) in hits.iter().enumerate().filter(|(_, hit)| hit.material.varies) {
                let at = (surfaces.position(lane), DVec3::from_array(surfaces.ng(lane)).as_vec3());
                points[lane] = world.texture_point_on_mesh(hit.mesh, hit.hit, at, row(uv, lane));
            }
            look_ups = world.textures.look_up_lanes(&pictures, points);
            if let Some(look_ups) = &look_ups {
                for (lane, point) in points.iter_mut().enumerate() {
                    point.looked_up = Some(look_ups.of(pictures[lane], lane));
                }
            }
        }
        let mut rows = [None; LANES];
        for (lane, hit) in hits.iter().enumerate() {
            let MeshHit { path, material, .. } = hit;
            let point = varying.as_ref().map_or(&TexturePoint::NOWHERE, |points| &points[lane]);
            let mut throughput = path.beta;
            let context = ShadingContext {
                mode: &mut output.queues.modes[path.slot as usize],
                throughput: &mut throughput,
                interior: path.interior,
                u: 0.0,
                seed: seed_of_walks::<B>(&batch.streams.of(path)),
            };
            let mut row: Option<B> = if material.bends_in_lanes() {
                if smooth & 1 << lane != 0 || material.has_bumps() {
                    bent.note(lane, material.local_normal(&world.textures, point));
                }
                material.row(&world.textures, point, context)
            } else if material.bends_frames() {
                let geometry = bent.geometry(surfaces, lane, front & 1 << lane != 0);
                material.bent_row(world.relief(), &geometry, point, context).map(|(row, axes)| {
                    surfaces.set_frame(lane, axes);
                    row
                })
            } else {
                material.row(&world.textures, point, context)
            };
            if self.regularize && path.blurred {
                row.iter_mut().for_each(B::regularize);
            }
            rows[lane] = row;
        }
        bent.bend(surfaces, front);
        for lane in LaneMask(active).filter(|_| P::LISTENS) {
            let (MeshHit { path, hit, .. }, Some(row)) = (&hits[lane], rows[lane]) else { continue };
            let surface = world.surface(&path.ray, hit);
            output.probe.notice(|| Event::Shaded {
                address: path.address,
                shading: Box::new(Shading::in_frame(&surface, surfaces.axes(lane), row.bsdf())),
                surface: Box::new(surface),
                beta: path.beta,
            });
        }
        if active & are_first != 0 {
            let eight = output.queues.first_surfaces.block();
            surfaces.leave(eight);
            (eight.lanes, eight.ns, eight.uv) = (active & are_first, bent.ns, *uv);
            for lane in LaneMask(eight.lanes) {
                let hit = &hits[lane];
                let point = varying.as_ref().map_or(&TexturePoint::NOWHERE, |points| &points[lane]);
                let albedo = material::albedo(&world.materials, &world.textures, hit.material, point);
                set_row(&mut eight.albedo, lane, albedo);
                if hit.material.has_bumps() {
                    set_row(&mut eight.ns, lane, surfaces.ns(lane));
                }
                eight.slots[lane] = hit.path.slot;
            }
            output.queues.first_surfaces.leave_block();
        }
        let Some(first) = &rows[0] else { return };
        let bsdfs = by_lane!(lane => rows[lane].as_ref().unwrap_or(first));

        let streams = by_lane!(lane => batch.streams.of(hits[lane].path));
        let task = &self.task(by_lane!(lane => hits[lane].path), by_lane!(lane => &streams[lane]), output);
        ScatterKernel { world, surfaces, bsdfs: &bsdfs, task, scattered }.scatter();
        let departure = |lane: usize| {
            let MeshHit { path, hit, .. } = hits[lane];
            let origin_primitive = OriginPrimitive::of(hit);
            (Departure { path, origin_primitive, boundary: Boundary::None }, false)
        };
        self.go_on(world, departure, active, scattered, output);
    }
}

/// [`ShadingContext::seed`], where BSDFs of a class take one.
#[inline]
fn seed_of_walks<B: MaterialRow>(stream: &SampleStream) -> f32 {
    if B::TAKES_SEED { stream.two(dimension::WALK)[0] } else { 0.0 }
}

/// The points of eight hits, in the frames of materials without bump mapping.
#[derive(Default)]
pub(super) struct MeshPoints {
    surfaces: VertexColumns,
    uv: Columns<2>,
    /// Bit i for lane i: whether the ray hit the outside.
    front: u32,
    /// Whether the shading normal is another than the geometric one.
    smooth: u32,
    /// The frames of materials that bend them.
    bent: BentFrames,
}

/// Finds the points of hits.
struct MeshKernel<'a> {
    hits: &'a [MeshHit<'a>; LANES],
    /// Whether any material varies.
    varies: bool,
    /// Whether AOVs need the surfaces.
    are_first: bool,
    points: &'a mut MeshPoints,
}

impl MeshKernel<'_> {
    #[inline(never)]
    fn set_points(self) {
        shade_together(self);
    }
}

impl Kernel for MeshKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { hits, varies, are_first, points } = self;
        let at = points_on_meshes(
            simd,
            &by_lane!(lane => hits[lane].mesh),
            &by_lane!(lane => hits[lane].hit),
            &by_lane!(lane => hits[lane].placement),
            varies || are_first,
        );
        let direction = gather(simd, &by_lane!(lane => hits[lane].path.ray.direction));
        let wide_wo = -direction.widen().normalize();
        let wo = Vector::narrow(wide_wo);
        let [ng, ns]: [Vector<f32x8<S>>; 2] = [Vector::narrow(at.ng), Vector::narrow(at.ns)];
        let n = ns.negate_where(ns.dot(ng).lt(ns.x.like(0.0)));
        let dpdu = Vector::narrow(at.shading_dpdu);
        let (s, t) = frame_about(n, dpdu);
        let is_flat = Float::eq(ns.x, ng.x) & Float::eq(ns.y, ng.y) & Float::eq(ns.z, ng.z);
        points.smooth = !is_flat.to_bitmask() as u32;
        let is_front = at.ng.dot(wide_wo).gt(wide_wo.x.like(0.0));
        points.front = is_front.to_bitmask() as u32;
        let lift = Vector::<f32x8<S>>::narrow(at.lift);
        points.surfaces.set(at.points, at.ng, [s, t, n], wo);
        points.surfaces.set_lifts(Lift { way: lift, ns }, points.front);
        points.uv = [at.uv[0].into(), at.uv[1].into()];
        if are_first || hits.iter().any(|hit| hit.material.bends_frames()) {
            let dpdv: Vector<f32x8<S>> = Vector::narrow(at.shading_dpdv);
            (points.bent.ns, points.bent.dpdu) = (store(ns), store(dpdu));
            points.bent.dpdv = store(dpdv);
        }
    }
}
