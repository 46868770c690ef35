//! Eight plain surfaces side by side, from their hits.

use lookfrom_bvh::Hit;
use lookfrom_simd::{Float, Real, Simd, f32x8, f64x8, mask64x8, prelude::*};

use super::plain::{PlainHit, PlainShape};
use crate::core::lanes::{LANES, by_lane, gather};
use crate::core::points::Points;
use crate::core::vector::Vector;

/// Eight surfaces, as [`World::surface`] has them.
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
        let mut spheres = 0;
        for (lane, plain) in eight.iter().enumerate() {
            spheres |= u64::from(matches!(plain.shape, PlainShape::Sphere(..))) << lane;
        }
        let (points, ng, ns) = match spheres {
            0 => on_triangles(simd, eight),
            0xff => on_spheres(simd, eight, direction),
            _ => {
                let (flat, round) = (on_triangles(simd, eight), on_spheres(simd, eight, direction));
                let is_sphere = mask64x8::from_bitmask(simd, spheres);
                let position = Vector::select(is_sphere, round.0.position, flat.0.position);
                let error = Vector::select(is_sphere, round.0.error, flat.0.error);
                let ng = Vector::select(is_sphere, round.1, flat.1);
                (Points { position, error }, ng, Vector::select(is_sphere, round.2, flat.2))
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

/// The points of lanes that hit triangles, as [`Mesh::point`](crate::primitive::Mesh::point) has them.
#[inline(always)]
fn on_triangles<S: Simd>(simd: S, eight: &[PlainHit<'_>; LANES]) -> Shapes<S> {
    let rows = by_lane!(lane => Corners::of(&eight[lane]));
    let corners = [
        gather(simd, &by_lane!(lane => rows[lane].positions[0])),
        gather(simd, &by_lane!(lane => rows[lane].positions[1])),
        gather(simd, &by_lane!(lane => rows[lane].positions[2])),
    ];
    let u = f32x8::load_array(simd, by_lane!(lane => eight[lane].hit.u));
    let v = f32x8::load_array(simd, by_lane!(lane => eight[lane].hit.v));
    let (points, across) = Points::on_triangles(corners, u, v);
    let flip = f64x8::load_array(simd, by_lane!(lane => rows[lane].flip));
    let ng = across.normalize() * flip;
    if rows.iter().all(|row| row.normal == [0.0; 3]) {
        return (points, ng, ng);
    }
    let mixed = gather(simd, &by_lane!(lane => rows[lane].normal)).widen();
    let (smooth, is_smooth) = mixed.try_normalize();
    // The mesh's normals, not the winding, decide which side is outside.
    let ng = ng.negate_where(is_smooth & smooth.dot(ng).lt(f64x8::splat(simd, 0.0)));
    (points, ng, Vector::select(is_smooth, smooth, ng))
}

/// A triangle's corners, its interpolated normal of any length (zero for none), and −1 if it is flipped.
#[derive(Clone, Copy)]
struct Corners {
    positions: [[f32; 3]; 3],
    normal: [f32; 3],
    flip: f64,
}

impl Corners {
    #[inline(always)]
    fn of(plain: &PlainHit<'_>) -> Self {
        let PlainShape::Triangle(mesh) = plain.shape else {
            return Self { positions: [[0.0; 3]; 3], normal: [0.0; 3], flip: 1.0 };
        };
        let Hit { primitive, u, v, .. } = *plain.hit;
        let normal = match mesh.normals.as_slice() {
            [] => [0.0; 3],
            normals => {
                let [a, b, c] = mesh.triangles[primitive as usize];
                let mixed =
                    (1.0 - u - v) * normals[a as usize] + u * normals[b as usize] + v * normals[c as usize];
                mixed.to_array()
            }
        };
        Self { positions: mesh.corners(primitive as usize), normal, flip: if mesh.flip { -1.0 } else { 1.0 } }
    }
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
