//! The points of hits on shapes of one kind, side by side.

use lookfrom_simd::{Float, Kernel, Real, Simd, f32x8, prelude::*};

use super::bent_frames::BentFrames;
use super::class_hits::{ClassHit, ClassHits, Shapes};
use super::vertices::VertexColumns;
use crate::core::lanes::{Columns, LANES, by_lane, gather, row, shade_together, store};
use crate::core::points::Lift;
use crate::core::vector::Vector;
use crate::primitive::{Primitives, SurfacePoint, SurfacePoints, points_on_meshes, points_on_spheres};
use crate::shading::footprint::{Changes, SurfaceFootprint};
use crate::shading::material::frame_about;
use crate::world::World;

/// The points of eight hits, in the frames of materials without bump mapping.
#[derive(Default)]
pub(super) struct ClassPoints {
    pub(super) surfaces: VertexColumns,
    pub(super) uv: Columns<2>,
    /// Bit i for lane i: whether the ray hit the outside.
    pub(super) front: u32,
    /// Whether the shading normal is another than the geometric one.
    pub(super) smooth: u32,
    /// The frames of materials that bend them.
    pub(super) bent: BentFrames,
    /// The footprints of pixels, where materials depend on them.
    pub(super) footprints: Footprints,
    /// The points of shapes that are neither meshes nor spheres, one by one.
    others: Vec<SurfacePoint>,
}

impl ClassPoints {
    /// Finds the points of shapes that were hit at some times.
    #[inline(never)]
    fn find_others(
        &mut self,
        world: &World,
        class_hits: &ClassHits<'_>,
        others: &[(&Primitives, f32); LANES],
    ) {
        self.others.clear();
        for (lane, ClassHit { path, hit, .. }) in class_hits.hits.iter().enumerate() {
            let point = match lane > 0 && std::ptr::eq(*hit, class_hits.hits[lane - 1].hit) {
                true => self.others[lane - 1],
                false => world.surface_point(&path.ray, hit, others[lane].1, class_hits.wants_uvs()),
            };
            self.others.push(point);
        }
    }
}

/// [`SurfaceFootprint`]s.
#[derive(Default)]
pub(super) struct Footprints {
    uv: [Columns<2>; 2],
    p: [Columns<3>; 2],
}

impl Footprints {
    fn set<S: Simd>(&mut self, Changes { uv: [x, y], p }: Changes<f32x8<S>>) {
        self.uv = [[x[0].into(), x[1].into()], [y[0].into(), y[1].into()]];
        self.p = [store(p[0]), store(p[1])];
    }

    /// That in a lane.
    pub(super) fn of(&self, lane: usize) -> SurfaceFootprint {
        let uv = [row(&self.uv[0], lane).into(), row(&self.uv[1], lane).into()];
        SurfaceFootprint { uv, p: [row(&self.p[0], lane).into(), row(&self.p[1], lane).into()] }
    }
}

/// Finds the points of hits.
pub(super) struct PointsKernel<'a> {
    pub(super) world: &'a World,
    pub(super) class_hits: &'a ClassHits<'a>,
    pub(super) points: &'a mut ClassPoints,
}

impl PointsKernel<'_> {
    #[inline(never)]
    pub(super) fn set_points(self) {
        if let Shapes::Others(others) = &self.class_hits.shapes {
            self.points.find_others(self.world, self.class_hits, others);
        }
        shade_together(self);
    }
}

impl Kernel for PointsKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { world, class_hits, points } = self;
        let ClassHits { hits, shapes, pixels, .. } = class_hits;
        let (are_first, wants_uvs) = (class_hits.are_first != 0, class_hits.wants_uvs());
        let direction = gather(simd, &by_lane!(lane => hits[lane].path.ray.direction)).widen();
        let at = match shapes {
            Shapes::Meshes(shapes) => {
                let (meshes, placements) =
                    (by_lane!(lane => shapes[lane].0), by_lane!(lane => shapes[lane].1));
                points_on_meshes(simd, &meshes, &by_lane!(lane => hits[lane].hit), &placements, wants_uvs)
            }
            Shapes::Spheres(spheres) => {
                let origin = gather(simd, &by_lane!(lane => hits[lane].path.ray.origin)).widen();
                let t = f32x8::load_array(simd, by_lane!(lane => hits[lane].hit.t));
                points_on_spheres(simd, spheres, origin + direction * Real::widen(t), [wants_uvs, true])
            }
            Shapes::Others(_) => SurfacePoints::gather(simd, &by_lane!(lane => &points.others[lane])),
        };
        let wide_wo = -direction.normalize();
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
        if hits.iter().any(|hit| hit.material.heights().is_some()) {
            let [dpdu, dpdv]: [Vector<f32x8<S>>; 2] = [Vector::narrow(at.dpdu), Vector::narrow(at.dpdv)];
            points.bent.derivatives = [store(dpdu), store(dpdv)];
        }
        if let Some(pixels) = pixels {
            let like = at.ng.x;
            let position = Vector::splat(like, world.origin.to_array()) + at.points.position;
            let derivatives = [Vector::narrow(at.dpdu), Vector::narrow(at.dpdv)];
            points.footprints.set(pixels.changes::<f32x8<S>>(position, at.ng, derivatives));
        }
    }
}
