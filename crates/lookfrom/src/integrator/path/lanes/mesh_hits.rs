//! Hits on triangle meshes, shaded in lanes from the hit on: most of most pictures.

use glam::{DVec3, Vec2};
use lookfrom_bvh::{Hit, OriginPrimitive};
use lookfrom_simd::{Float, Kernel, LaneMask, Simd, dispatch, f32x8, level, mask64x8, prelude::*};

use super::bent_frames::BentFrames;
use super::kernel::{LanePaths, ScatterKernel};
use super::surfaces::SurfaceColumns;
use super::{Item, Memory};
use crate::core::lanes::{Columns, LANES, bitmask, by_lane, gather, row, store};
use crate::core::points::{StoredPlacement, gather_placements};
use crate::core::vector::Vector;
use crate::integrator::path::PathTracer;
use crate::integrator::{Event, FirstSurface, Integrator, Path, Probe, SampleStream, StepOutput};
use crate::primitive::{Mesh, VertexData, gather_triangles};
use crate::shading::bsdf::lanes::BsdfClass;
use crate::shading::material::{self, Material, MaterialRow, ShadingContext, frame_about};
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
    /// Whether a path travels in no medium and comes from no shadow catcher.
    #[inline]
    pub(in crate::integrator::path) fn is_plain(&self, index: usize) -> bool {
        let path = &self.paths[index];
        path.interior.is_empty() && !path.previous.is_catcher
    }

    /// The class of a path that met a mesh whose material has BSDFs of a class, and is to go on from there.
    #[inline]
    pub(in crate::integrator::path) fn mesh_class(
        &self,
        tracer: &PathTracer,
        index: usize,
    ) -> Option<BsdfClass> {
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
        self.mesh.binding.single_sided && !self.path.previous.blurred
    }

    /// The inputs of texture evaluation in a lane.
    #[inline]
    fn texture_point(
        &self,
        world: &World,
        surfaces: &SurfaceColumns,
        [u, v]: [f32; 2],
        lane: usize,
    ) -> TexturePoint<'_> {
        let Hit { primitive, u: b1, v: b2, .. } = *self.hit;
        let point = TexturePoint {
            uv: Vec2::new(u, v),
            world: world.origin + DVec3::from_array(surfaces.position(lane)),
            color: self.mesh.color(primitive as usize, b1, b2),
            n: DVec3::from_array(surfaces.ng(lane)).as_vec3(),
            ..TexturePoint::NOWHERE
        };
        if !self.mesh.has_vertex_data() {
            return point;
        }
        let VertexData { more_uvs, opacity } = self.mesh.vertex_data(primitive as usize, b1, b2);
        TexturePoint { more_uvs, opacity, ..point }
    }

    /// The surface in a lane, for AOVs.
    fn first_surface(
        &self,
        world: &World,
        (surfaces, bent): (&SurfaceColumns, &BentFrames),
        uv: &Columns<2>,
        point: &TexturePoint,
        lane: usize,
    ) -> FirstSurface {
        FirstSurface {
            position: DVec3::from_array(surfaces.position(lane)),
            ng: DVec3::from_array(surfaces.ng(lane)).as_vec3(),
            ns: if self.material.has_bumps() { surfaces.ns(lane) } else { row(&bent.ns, lane) }.into(),
            wo: surfaces.wo(lane).into(),
            uv: row(uv, lane).into(),
            albedo: material::albedo(&world.materials, &world.textures, self.material, point),
        }
    }
}

impl PathTracer {
    /// Scatters up to eight paths of a batch that met meshes of one class.
    pub(super) fn scatter_mesh_hits<B: MaterialRow, P: Probe>(
        &self,
        batch: &HitBatch<'_, impl Fn(&Path) -> SampleStream>,
        indices: &[u32],
        memory: &mut Memory,
        output: &mut StepOutput<'_, P>,
    ) {
        let Some(last) = indices.last() else { return };
        // Unused lanes repeat the last hit.
        let hits = by_lane!(lane => match batch.mesh_hit(*indices.get(lane).unwrap_or(last)) {
            Some(hit) => hit,
            None => return,
        });
        let Memory { points: mesh_points, scattered } = memory;
        let varies = hits.iter().any(|hit| hit.material.varies);
        let leaves_surfaces = !output.queues.first_surfaces.is_empty();
        MeshKernel { hits: &hits, varies, leaves_surfaces, points: mesh_points }.set_points();
        let MeshPoints { surfaces, uv, front, bent } = mesh_points;
        let front = *front;

        // Paths from the camera pass the back faces of single-sided meshes.
        let mut active = (1 << indices.len()) - 1;
        for (lane, index) in indices.iter().enumerate() {
            if hits[lane].passes_back_faces() && front & 1 << lane == 0 {
                let (path, hit) = (&batch.paths[*index as usize], &batch.hits[*index as usize]);
                self.step(batch.world, &(batch.stream)(path), path, hit, output);
                active &= !(1 << lane);
            } else if P::LISTENS {
                self.notice_shading(batch, *index, output);
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
                points[lane] = hit.texture_point(world, surfaces, row(uv, lane), lane);
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
                lanes: &mut output.queues.lanes[path.slot as usize],
                throughput: &mut throughput,
                interior: path.interior,
                u: 0.0,
            };
            let mut row: Option<B> = if material.bends_in_lanes() {
                bent.note(lane, material.local_normal(&world.textures, point));
                material.row(&world.textures, point, context)
            } else if material.bends_frames() {
                let geometry = bent.geometry(surfaces, lane, front & 1 << lane != 0);
                material.bent_row(&world.textures, &geometry, point, context).map(|(row, axes)| {
                    surfaces.set_frame(lane, axes);
                    row
                })
            } else {
                material.row(&world.textures, point, context)
            };
            if self.regularize && path.previous.blurred {
                row.iter_mut().for_each(B::regularize);
            }
            rows[lane] = row;
        }
        bent.bend(surfaces, front);
        if leaves_surfaces {
            for lane in LaneMask(active) {
                let hit = &hits[lane];
                if hit.path.address == Path::ROOT {
                    let point = varying.as_ref().map_or(&TexturePoint::NOWHERE, |points| &points[lane]);
                    output.queues.first_surfaces[hit.path.slot as usize] =
                        Some(hit.first_surface(world, (surfaces, bent), uv, point, lane));
                }
            }
        }
        let Some(first) = &rows[0] else { return };
        let bsdfs = by_lane!(lane => rows[lane].as_ref().unwrap_or(first));

        let streams = by_lane!(lane => (batch.stream)(hits[lane].path));
        let paths = LanePaths {
            paths: by_lane!(lane => hits[lane].path),
            streams: by_lane!(lane => &streams[lane]),
            modes: by_lane!(lane => &output.queues.lanes[hits[lane].path.slot as usize]),
        };
        ScatterKernel { world, surfaces, bsdfs: &bsdfs, paths, scattered }.scatter();
        let item = |lane: usize| Item {
            path: hits[lane].path,
            origin_primitive: OriginPrimitive::of(hits[lane].hit),
            surface: None,
            is_catcher: false,
        };
        self.go_on(world, item, active, scattered, output);
    }

    /// Tells the probe of a surface and its shading, as scalar code has them.
    #[cold]
    fn notice_shading<P: Probe>(
        &self,
        batch: &HitBatch<'_, impl Fn(&Path) -> SampleStream>,
        index: u32,
        output: &mut StepOutput<'_, P>,
    ) {
        let (path, hit) = (&batch.paths[index as usize], &batch.hits[index as usize]);
        let surface = batch.world.surface(&path.ray, hit);
        let (mut mode, mut beta) = (output.queues.lanes[path.slot as usize], path.beta);
        let arrival =
            ShadingContext { lanes: &mut mode, throughput: &mut beta, interior: path.interior, u: 0.0 };
        let Some(mut shading) = batch.world.shading(&surface, arrival) else { return };
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

/// The points of eight hits, in the frames of materials without bump mapping.
pub(super) struct MeshPoints {
    surfaces: SurfaceColumns,
    uv: Columns<2>,
    /// Bit i for lane i: whether the ray hit the outside.
    front: u32,
    /// Of materials that bend frames.
    bent: BentFrames,
}

impl MeshPoints {
    /// None yet.
    pub(super) const NONE: Self =
        Self { surfaces: SurfaceColumns::NONE, uv: [[0.0; LANES]; 2], front: 0, bent: BentFrames::NONE };
}

/// Finds the points of hits.
struct MeshKernel<'a> {
    hits: &'a [MeshHit<'a>; LANES],
    /// Whether any material varies.
    varies: bool,
    /// Whether AOVs may need the surfaces.
    leaves_surfaces: bool,
    points: &'a mut MeshPoints,
}

impl MeshKernel<'_> {
    #[inline(never)]
    fn set_points(self) {
        dispatch(level(), self);
    }
}

impl Kernel for MeshKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { hits, varies, leaves_surfaces, points } = self;
        let triangles = gather_triangles(
            simd,
            &by_lane!(lane => hits[lane].mesh),
            &by_lane!(lane => hits[lane].hit.primitive),
            varies || leaves_surfaces,
        );
        let u = f32x8::load_array(simd, by_lane!(lane => hits[lane].hit.u));
        let v = f32x8::load_array(simd, by_lane!(lane => hits[lane].hit.v));
        let mut at = triangles.points(u, v);
        if let Some(first) = hits.iter().find_map(|hit| hit.placement) {
            let are_placed = bitmask(&by_lane!(lane => hits[lane].placement.is_some()));
            let rows = by_lane!(lane => hits[lane].placement.unwrap_or(first).placement());
            let placements = gather_placements(simd, &by_lane!(lane => &rows[lane]));
            at = at.placed(mask64x8::from_bitmask(simd, are_placed.into()), &placements);
        }
        let direction = gather(simd, &by_lane!(lane => hits[lane].path.ray.direction));
        let wide_wo = -direction.widen().normalize();
        let wo = Vector::narrow(wide_wo);
        let [ng, ns]: [Vector<f32x8<S>>; 2] = [Vector::narrow(at.ng), Vector::narrow(at.ns)];
        let n = ns.negate_where(ns.dot(ng).lt(ns.x.like(0.0)));
        let dpdu = Vector::narrow(at.shading_dpdu);
        let (s, t) = frame_about(n, dpdu);
        points.surfaces.set(at.points, at.ng, [s, t, n], wo);
        points.uv = [at.uv[0].into(), at.uv[1].into()];
        points.front = at.ng.dot(wide_wo).gt(wide_wo.x.like(0.0)).to_bitmask() as u32;
        if leaves_surfaces || hits.iter().any(|hit| hit.material.bends_frames()) {
            let dpdv = Vector::narrow(at.shading_dpdv);
            (points.bent.ns, points.bent.dpdu) = (store(ns), store(dpdu));
            points.bent.dpdv = store(dpdv);
        }
    }
}
