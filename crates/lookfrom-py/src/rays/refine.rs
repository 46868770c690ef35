//! Refined hits of rays and primitives, in f64, given the kernel's.
//!
//! The kernel has decided that the ray hits, for positions rounded to f32. Here Cramer's rule (Möller & Trumbore 1997) gives t
//! and the weights on the positions as they were given. Where these say that the ray passes beside the triangle, by less than
//! the rounding, the hit is at the triangle's nearest edge; where the ray runs nearly along the triangle's plane, it is where
//! the kernel has found it.
//!
//! All is computed in units of the frame, by exact scaling, so no size is too large or too small.

use lookfrom_bvh::{Hit, NONE};

use super::chunk::{Relation, WorldRay};
use super::frame::{Frame, cross, dot, largest, subtract, times, to_unit};
use super::geometry::Primitive;
use super::tree::Tree;

/// A hit in f64.
#[derive(Clone, Copy, Debug)]
pub(super) struct FineHit {
    pub(super) t: f64,
    pub(super) u: f64,
    pub(super) v: f64,
    pub(super) primitive: u32,
    pub(super) geometry: u32,
    pub(super) instance: u32,
}

impl FineHit {
    pub(super) const MISS: Self =
        Self { t: f64::INFINITY, u: 0.0, v: 0.0, primitive: NONE, geometry: NONE, instance: NONE };

    /// The order of hits at equal t: the kernel's.
    pub(super) fn rank(&self) -> (u32, u32, u32) {
        (self.instance.wrapping_add(1), self.geometry, self.primitive)
    }
}

/// Least sine of the angle between a ray and a plane, relative to the triangle's own, for Cramer's rule: 2⁻³⁰.
const GRAZING: f64 = 9.313_225_746_154_785e-10;

/// Largest distance of a hit beside the ray, in units of the frame and relative to the distance along it: 2⁻¹⁷.
const BESIDE: f64 = 7.629_394_531_25e-6;

/// A hit of the kernel with its numbers in f64.
#[inline]
pub(super) fn refine(tree: &Tree, ray: &WorldRay, relation: &Relation, hit: &Hit) -> FineHit {
    let (place, instance) = tree.place(hit.instance);
    let primitive = place.primitive(hit.geometry, hit.primitive);
    let ray = match instance {
        None => *ray,
        Some(instance) => {
            let map = &instance.object_from_world;
            let from_origin = subtract(ray.origin, instance.world_from_object.translation);
            WorldRay { origin: map.vector(from_origin), direction: map.vector(ray.direction) }
        }
    };
    let [t, u, v] = match primitive {
        Primitive::Triangle(corners) => {
            on_triangle(&place.frame, &ray, &corners, [hit.u, hit.v].map(f64::from))
        }
        Primitive::Sphere { center, radius } => {
            [on_sphere(&place.frame, &ray, center, radius, relation.t(hit.t)), 0.0, 0.0]
        }
    };
    let &Hit { primitive, geometry, instance, .. } = hit;
    FineHit { t, u, v, primitive, geometry, instance }
}

/// t, and the weights of the second and third corner.
#[inline]
fn on_triangle(frame: &Frame, ray: &WorldRay, corners: &[[f64; 3]; 3], kernels: [f64; 2]) -> [f64; 3] {
    let shrink = to_unit(largest(ray.direction));
    let d = times(ray.direction, shrink);
    let [a, b, c] = corners.map(|p| times(p, frame.scale));
    let (e1, e2) = (subtract(b, a), subtract(c, a));
    let f = subtract(a, times(ray.origin, frame.scale));
    let n = cross(e1, e2);
    let r = cross(f, d);
    let determinant = dot(n, d);
    let inverse = 1.0 / determinant;
    let (t, u, v) = (dot(n, f) * inverse, dot(e2, r) * inverse, -dot(e1, r) * inverse);
    let per_unit = shrink / frame.scale;

    let is_clear = determinant * determinant > GRAZING * GRAZING * dot(n, n) * dot(d, d);
    if is_clear && u >= 0.0 && v >= 0.0 && u + v <= 1.0 {
        return [t * per_unit, u, v];
    }
    let [t, u, v] = beside_triangle(f, d, [e1, e2], is_clear.then_some([u, v]), kernels);
    [t * per_unit, u, v]
}

/// t and weights of a ray that passes beside a triangle, or along it, by as little as the rounding: with directions relative to the
/// ray's origin, and Cramer's weights where they are clear.
#[cold]
fn beside_triangle(
    f: [f64; 3],
    d: [f64; 3],
    [e1, e2]: [[f64; 3]; 2],
    weights: Option<[f64; 2]>,
    kernels: [f64; 2],
) -> [f64; 3] {
    let at = |[u, v]: [f64; 2]| {
        let offset = [0, 1, 2].map(|axis| f[axis] + u * e1[axis] + v * e2[axis]);
        let t = dot(offset, d) / dot(d, d);
        let beside = subtract(offset, times(d, t));
        (t, dot(beside, beside).sqrt())
    };
    // The nearest point of the triangle, if it is near enough.
    if let Some(weights) = weights {
        let [u, v] = clamp_weights(weights);
        let (t, beside) = at([u, v]);
        if beside <= BESIDE * (1.0 + largest(f)) {
            return [t, u, v];
        }
    }
    let [u, v] = clamp_weights(kernels);
    [at([u, v]).0, u, v]
}

/// Weights of a point of the triangle: not negative, and with a sum of at most 1.
fn clamp_weights(weights: [f64; 2]) -> [f64; 2] {
    let [u, v] = weights.map(|x| x.max(0.0));
    let sum = u + v;
    if sum <= 1.0 { [u, v] } else { [u / sum, 1.0 - u / sum] }
}

/// The one of the two t that is nearer to the kernel's. A ray that passes beside the sphere, by less than the rounding, hits it
/// where it is nearest: Haines, Günther, Akenine-Möller (2019), "Precision Improvements for Ray/Sphere Intersection".
fn on_sphere(frame: &Frame, ray: &WorldRay, center: [f64; 3], radius: f64, kernels: f64) -> f64 {
    let shrink = to_unit(largest(ray.direction));
    let d = times(ray.direction, shrink);
    let f = subtract(times(center, frame.scale), times(ray.origin, frame.scale));
    let radius = radius * frame.scale;
    let per_unit = shrink / frame.scale;
    let (a, b) = (dot(d, d), dot(f, d));
    let beside = subtract(f, times(d, b / a));
    let discriminant = radius * radius - dot(beside, beside);
    if !(discriminant > 0.0) {
        return b / a * per_unit;
    }
    let q = b + (a * discriminant).sqrt().copysign(b);
    let roots = [(dot(f, f) - radius * radius) / q, q / a].map(|t| t * per_unit);
    let [first, second] = roots.map(|t| (t - kernels).abs());
    if second < first { roots[1] } else { roots[0] }
}
