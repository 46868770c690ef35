//! Eight plain surfaces side by side, from their hits.

use lookfrom_simd::{Float, Real, Simd, f32x8, f64x8, mask64x8, prelude::*};

use super::plain::{PlainHit, PlainShape};
use crate::core::lanes::{LANES, bitmask, by_lane, gather};
use crate::core::points::Points;
use crate::core::vector::Vector;
use crate::primitive::{Mesh, gather_triangles};

/// Eight surfaces, as [`World::surface`](crate::world::World::surface) has them.
pub(super) struct Surfaces<S: Simd> {
    pub(super) points: Points<f32x8<S>>,
    pub(super) ng: Vector<f64x8<S>>,
    pub(super) ng_facing: Vector<f32x8<S>>,
    pub(super) ns_facing: Vector<f32x8<S>>,
    pub(super) wo: Vector<f32x8<S>>,
    pub(super) front: mask64x8<S>,
}

impl<S: Simd> Surfaces<S> {
    #[inline(always)]
    pub(super) fn of(simd: S, eight: &[PlainHit<'_>; LANES]) -> Self {
        let direction = gather(simd, &by_lane!(lane => eight[lane].path.ray.direction)).widen();
        let triangles = by_lane!(lane => match eight[lane].shape {
            PlainShape::Triangle(mesh) => Some((mesh, eight[lane].hit.primitive)),
            PlainShape::Sphere(..) => None,
        });
        let spheres = bitmask(&by_lane!(lane => triangles[lane].is_none()));
        let (points, ng, ns) = match triangles.iter().flatten().next() {
            None => on_spheres(simd, eight, direction),
            Some(any) => {
                let flat = on_triangles(simd, eight, &by_lane!(lane => triangles[lane].unwrap_or(*any)));
                if spheres == 0 {
                    flat
                } else {
                    blended(simd, spheres, on_spheres(simd, eight, direction), flat)
                }
            }
        };
        let wo = -direction.normalize();
        let front = ng.dot(wo).gt(f64x8::splat(simd, 0.0));
        let wo = Vector::<f32x8<S>>::narrow(wo);
        let ng_facing = Vector::narrow(ng.negate_where(!front));
        let ns_facing = Vector::<f32x8<S>>::narrow(ns.negate_where(!front));
        let is_facing = ns_facing.dot(wo).gt(f32x8::splat(simd, 0.0));
        let ns_facing = Vector::select(is_facing, ns_facing, ng_facing);
        Self { points, ng, ng_facing, ns_facing, wo, front }
    }
}

/// Points, geometric and shading normals.
type Shapes<S> = (Points<f32x8<S>>, Vector<f64x8<S>>, Vector<f64x8<S>>);

/// The first where a bit of the mask is set, the second elsewhere.
#[inline(always)]
fn blended<S: Simd>(simd: S, mask: u32, yes: Shapes<S>, no: Shapes<S>) -> Shapes<S> {
    let mask = mask64x8::from_bitmask(simd, mask.into());
    let position = Vector::select(mask, yes.0.position, no.0.position);
    let error = Vector::select(mask, yes.0.error, no.0.error);
    (Points { position, error }, Vector::select(mask, yes.1, no.1), Vector::select(mask, yes.2, no.2))
}

/// The points of hits on triangles of meshes.
#[inline(always)]
fn on_triangles<S: Simd>(
    simd: S,
    eight: &[PlainHit<'_>; LANES],
    triangles: &[(&Mesh, u32); LANES],
) -> Shapes<S> {
    let meshes = by_lane!(lane => triangles[lane].0);
    let indices = by_lane!(lane => triangles[lane].1);
    let u = f32x8::load_array(simd, by_lane!(lane => eight[lane].hit.u));
    let v = f32x8::load_array(simd, by_lane!(lane => eight[lane].hit.v));
    let at = gather_triangles(simd, &meshes, &indices, false).points(u, v);
    (at.points, at.ng, at.ns)
}

/// The points of lanes that hit spheres.
#[inline(always)]
fn on_spheres<S: Simd>(simd: S, eight: &[PlainHit<'_>; LANES], direction: Vector<f64x8<S>>) -> Shapes<S> {
    let rows = by_lane!(lane => match eight[lane].shape {
        PlainShape::Sphere(sphere, binding) => (sphere.center, sphere.radius, if binding.flip { -1.0 } else { 1.0 }),
        PlainShape::Triangle(_) => ([0.0; 3], 1.0, 1.0),
    });
    let origin = gather(simd, &by_lane!(lane => eight[lane].path.ray.origin)).widen();
    let t = f32x8::load_array(simd, by_lane!(lane => eight[lane].hit.t));
    let near = origin + direction * Real::widen(t);
    let center = gather(simd, &by_lane!(lane => rows[lane].0)).widen();
    let radius = Real::widen(f32x8::load_array(simd, by_lane!(lane => rows[lane].1)));
    let points = Points::<f32x8<S>>::on_spheres(center, radius, near);
    let flip = f64x8::load_array(simd, by_lane!(lane => rows[lane].2));
    let ng = (points.position - center).normalize() * flip;
    (points, ng, ng)
}
