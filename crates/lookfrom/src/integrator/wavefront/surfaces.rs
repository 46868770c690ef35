//! Bare surfaces: one, or eight side by side, from their hits.

use lookfrom_bvh::Point;
use lookfrom_simd::{Float, Mask, Real, Simd, f32x8, f64x8, prelude::*};

use super::bare_hits::{self, BareHits};
use crate::aov::FirstSurfaceColumns;
use crate::core::lanes::{LANES, by_lane, gather_rays, store, store_f64};
use crate::core::points::{Exits, Lift, Points};
use crate::core::vector::Vector;
use crate::primitive::{
    SurfacePoint, SurfacePoints, points_on_meshes, points_on_quadrics, points_on_spheres,
};
use crate::shading::interaction::SurfaceInteraction;
use crate::world::{ShapeClass, World};

/// Surfaces with the directions that shading needs, as [`World::surface`] has them.
pub(in crate::integrator) struct Surfaces<R: Real> {
    pub(in crate::integrator) points: Points<R>,
    pub(in crate::integrator) ng: Vector<R::Double>,
    pub(in crate::integrator) ng_facing: Vector<R>,
    ns: Vector<R>,
    pub(in crate::integrator) ns_facing: Vector<R>,
    pub(in crate::integrator) wo: Vector<R>,
    pub(in crate::integrator) front: R::Mask,
    /// Texture coordinates, where they are known.
    pub(in crate::integrator) uv: Option<[R; 2]>,
    /// The smooth surfaces that meshes stand for.
    pub(in crate::integrator) lift: Option<Lift<R>>,
}

/// Points, geometric and shading normals, texture coordinates where they are known, and the ways to smooth surfaces where
/// there are any.
type Shapes<S> =
    (Points<f32x8<S>>, Vector<f64x8<S>>, Vector<f64x8<S>>, Option<[f32x8<S>; 2]>, Option<Vector<f64x8<S>>>);

impl Surfaces<f32> {
    /// One surface.
    pub(in crate::integrator) fn of_one(surface: &SurfaceInteraction) -> Self {
        let Point { position, error } = surface.point;
        Self {
            points: Points { position: position.into(), error: error.into() },
            ng: surface.ng.into(),
            ng_facing: surface.ng_facing().into(),
            ns: surface.ns.into(),
            ns_facing: surface.ns_facing().into(),
            wo: surface.wo.into(),
            front: surface.front,
            uv: Some(surface.uv.into()),
            lift: surface.lift(),
        }
    }
}

impl<S: Simd> Surfaces<f32x8<S>> {
    /// The surfaces of eight hits; without texture coordinates where they are not wanted.
    #[inline(always)]
    pub(in crate::integrator) fn of_eight(
        simd: S,
        world: &World,
        bare: &BareHits<'_>,
        wants_uvs: bool,
    ) -> Self {
        let [origin, direction] = gather_rays(simd, &bare.rays).map(Vector::widen);
        let (points, ng, ns, uv, way) = match bare.shape {
            ShapeClass::Mesh => on_triangles(simd, world, bare, wants_uvs),
            ShapeClass::Sphere => on_spheres(simd, world, bare, [origin, direction], wants_uvs),
            ShapeClass::Other => on_others(simd, world, bare, [origin, direction], wants_uvs),
        };
        let wo = -direction.normalize();
        let front = ng.dot(wo).gt(f64x8::splat(simd, 0.0));
        let ns = Vector::<f32x8<S>>::narrow(ns);
        let lift = match way {
            Some(way) => {
                let none = Vector::splat(way.x, [0.0; 3]);
                Some(Lift { way: Vector::narrow(Vector::select(front, way, none)), ns })
            }
            None => None,
        };
        let ng_facing = Vector::narrow(ng.negate_where(!front));
        let (wo, front) = (Vector::<f32x8<S>>::narrow(wo), ns.x.narrow_mask(front));
        let ns_facing = ns.negate_where(!front);
        let is_facing = ns_facing.dot(wo).gt(f32x8::splat(simd, 0.0));
        let ns_facing = Vector::select(is_facing, ns_facing, ng_facing);
        Self { points, ng, ng_facing, ns, ns_facing, wo, front, uv, lift }
    }

    /// Leaves them to AOVs, but for the albedo.
    #[inline(always)]
    pub(in crate::integrator) fn leave(&self, first: &mut FirstSurfaceColumns) {
        first.position = store_f64(self.points.position);
        first.ng = store(Vector::<f32x8<S>>::narrow(self.ng));
        (first.ns, first.wo) = (store(self.ns), store(self.wo));
        if let Some([u, v]) = self.uv {
            first.uv = [u.into(), v.into()];
        }
    }
}

impl<R: Real> Surfaces<R> {
    /// The ways out of the surfaces.
    #[inline(always)]
    pub(in crate::integrator) fn exits(&self) -> Exits<'_, R> {
        self.points.exits(self.ng).lifted(self.lift.as_ref())
    }

    /// Whether directions lead through the surfaces: the smooth ones, where meshes stand for those.
    #[inline(always)]
    pub(in crate::integrator) fn cross(&self, wi: Vector<R>) -> R::Mask {
        let cos = self.ng.dot(wi.widen());
        let mut is_outside = cos.gt(cos.like(0.0));
        if let Some(lift) = &self.lift {
            is_outside = is_outside | lift.is_above(wi);
        }
        let is_outside = wi.x.narrow_mask(is_outside);
        is_outside.choose(!self.front, self.front)
    }
}

/// The points of hits on triangles of meshes.
#[inline(always)]
fn on_triangles<S: Simd>(simd: S, world: &World, bare: &BareHits<'_>, wants_uvs: bool) -> Shapes<S> {
    let hits = &bare.hits;
    let Some(first) = bare_hits::mesh(world, hits[0]) else { return nowhere(simd) };
    let meshes = by_lane!(lane => bare_hits::mesh(world, hits[lane]).unwrap_or(first));
    let at = points_on_meshes(simd, &meshes, hits, &[None; LANES], wants_uvs);
    (at.points, at.ng, at.ns, Some(at.uv), meshes.iter().any(|mesh| mesh.is_lifted).then_some(at.lift))
}

/// No points, of no hits.
#[inline(always)]
fn nowhere<S: Simd>(simd: S) -> Shapes<S> {
    let none = Vector::splat(f64x8::splat(simd, 0.0), [0.0; 3]);
    (Points { position: none, error: none }, none, none, None, None)
}

/// The points of hits on spheres.
#[inline(always)]
fn on_spheres<S: Simd>(
    simd: S,
    world: &World,
    bare: &BareHits<'_>,
    [origin, direction]: [Vector<f64x8<S>>; 2],
    wants_uvs: bool,
) -> Shapes<S> {
    let hits = &bare.hits;
    let Some(first) = world.sphere(hits[0]) else { return nowhere(simd) };
    let spheres = match bare.are_on_one() {
        true => [first; LANES],
        false => by_lane!(lane => world.sphere(hits[lane]).unwrap_or(first)),
    };
    let t = f32x8::load_array(simd, by_lane!(lane => hits[lane].t));
    let at = points_on_spheres(simd, &spheres, origin + direction * Real::widen(t), [wants_uvs, false]);
    (at.points, at.ng, at.ns, wants_uvs.then_some(at.uv), None)
}

/// The points of hits on other shapes: on quadrics without texture coordinates in lanes, else one by one.
#[inline(always)]
fn on_others<S: Simd>(
    simd: S,
    world: &World,
    bare: &BareHits<'_>,
    [origin, direction]: [Vector<f64x8<S>>; 2],
    wants_uvs: bool,
) -> Shapes<S> {
    let hits = &bare.hits;
    if let Some(first) = world.quadric(hits[0]).filter(|_| !wants_uvs) {
        let quadrics = by_lane!(lane => world.quadric(hits[lane]));
        if quadrics.iter().all(Option::is_some) {
            let quadrics = by_lane!(lane => quadrics[lane].unwrap_or(first));
            let t = f32x8::load_array(simd, by_lane!(lane => hits[lane].t));
            let (points, ng) = points_on_quadrics(simd, &quadrics, origin + direction * Real::widen(t));
            return (points, ng, ng, None, None);
        }
    }
    let points = by_lane!(lane => point_of(world, bare, lane, wants_uvs));
    let at = SurfacePoints::gather(simd, &by_lane!(lane => &points[lane]));
    (at.points, at.ng, at.ns, wants_uvs.then_some(at.uv), None)
}

#[inline(never)]
fn point_of(world: &World, bare: &BareHits<'_>, lane: usize, wants_uv: bool) -> SurfacePoint {
    // What moves is in instances.
    world.surface_point(bare.rays[lane], bare.hits[lane], 0.0, wants_uv)
}
