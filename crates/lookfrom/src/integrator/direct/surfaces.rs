//! Eight plain surfaces side by side, from their hits.

use lookfrom_simd::{Float, Real, Simd, f32x8, f64x8, mask64x8, prelude::*};

use super::plain::{PlainHit, PlainShape};
use crate::core::lanes::{LANES, by_lane, gather};
use crate::core::points::Points;
use crate::core::vector::Vector;
use crate::primitive::{Mesh, TrianglePoints, Triangles, gather_triangles};

/// Eight surfaces, as [`World::surface`](crate::world::World::surface) has them.
pub(super) struct Surfaces<S: Simd> {
    pub(super) points: Points<f32x8<S>>,
    pub(super) ng: Vector<f64x8<S>>,
    pub(super) ng_facing: Vector<f32x8<S>>,
    pub(super) ns_facing: Vector<f32x8<S>>,
    pub(super) wo: Vector<f32x8<S>>,
    pub(super) front: mask64x8<S>,
    /// Texture coordinates on triangles.
    pub(super) uv: Option<[f32x8<S>; 2]>,
}

/// Points, geometric and shading normals, and texture coordinates where they are known.
type Shapes<S> = (Points<f32x8<S>>, Vector<f64x8<S>>, Vector<f64x8<S>>, Option<[f32x8<S>; 2]>);

impl<S: Simd> Surfaces<S> {
    /// The surfaces of hits on one kind of shape.
    #[inline(always)]
    pub(super) fn of(simd: S, eight: &[PlainHit<'_>; LANES]) -> Self {
        let direction = gather(simd, &by_lane!(lane => eight[lane].path.ray.direction)).widen();
        let (points, ng, ns, uv) = match eight[0].shape {
            PlainShape::Triangle(mesh) => on_triangles(simd, eight, mesh),
            PlainShape::Sphere(..) => on_spheres(simd, eight, direction),
        };
        let wo = -direction.normalize();
        let front = ng.dot(wo).gt(f64x8::splat(simd, 0.0));
        let wo = Vector::<f32x8<S>>::narrow(wo);
        let ng_facing = Vector::narrow(ng.negate_where(!front));
        let ns_facing = Vector::<f32x8<S>>::narrow(ns.negate_where(!front));
        let is_facing = ns_facing.dot(wo).gt(f32x8::splat(simd, 0.0));
        let ns_facing = Vector::select(is_facing, ns_facing, ng_facing);
        Self { points, ng, ng_facing, ns_facing, wo, front, uv }
    }
}

/// The points of hits on triangles of meshes.
#[inline(always)]
fn on_triangles<S: Simd>(simd: S, eight: &[PlainHit<'_>; LANES], first: &Mesh) -> Shapes<S> {
    let u = f32x8::load_array(simd, by_lane!(lane => eight[lane].hit.u));
    let v = f32x8::load_array(simd, by_lane!(lane => eight[lane].hit.v));
    let indices = by_lane!(lane => eight[lane].hit.primitive);
    let (mut is_one, mut lane) = (true, 0);
    while lane < LANES {
        is_one &= indices[lane] == indices[0] && eight[lane].hit.geometry == eight[0].hit.geometry;
        lane += 1;
    }
    if is_one {
        return at(&first.triangle(indices[0] as usize).splat(simd), u, v);
    }
    let meshes = by_lane!(lane => match eight[lane].shape {
        PlainShape::Triangle(mesh) => mesh,
        PlainShape::Sphere(..) => first,
    });
    at(&gather_triangles(simd, &meshes, &indices, true), u, v)
}

/// The points on triangles.
#[inline(always)]
fn at<S: Simd>(triangles: &Triangles<f32x8<S>>, u: f32x8<S>, v: f32x8<S>) -> Shapes<S> {
    let TrianglePoints { points, ng, ns, uv, .. } = triangles.points(u, v);
    (points, ng, ns, Some(uv))
}

/// The points of hits on spheres.
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
    (points, ng, ng, None)
}
