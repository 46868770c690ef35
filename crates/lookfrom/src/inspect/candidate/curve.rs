//! Curves: the distance of the ray from the point B(u) of the centre line, against half the width there.

use glam::{DVec3, Vec3};
use lookfrom_bvh::Procedural;

use super::{TestNumbers, TestRay};
use crate::primitive::Curves;

/// Names of a ray in the space of a curve.
const IN_CURVE: [&str; 2] = ["a in the curve", "d in the curve"];

/// Adds the inputs of the test of a curve's segment, and if it is hit, the numbers there.
pub(super) fn test(curves: &Curves, primitive: u32, ray: &TestRay, numbers: &mut TestNumbers) {
    let (strand, range) = curves.segment(primitive);
    let (origin, direction) = curves.ray_in_object(ray.origin, ray.direction);
    let in_curve = TestRay { origin, direction, ..*ray };
    in_curve.add_to(numbers, IN_CURVE);
    let points = strand.points.map(Vec3::as_dvec3);
    for (name, point) in ["P0", "P1", "P2", "P3"].into_iter().zip(points) {
        numbers.input(name, point.to_array());
    }
    numbers.input("width from, to", strand.width.map(f64::from));
    numbers.input("u from, to", range);
    let Some(hit) = curves.intersect(primitive, &ray.single) else { return };
    numbers.input("u", [f64::from(hit.u)]);

    let u = f64::from(hit.u);
    let center = bezier(points, u);
    let from_origin = center - origin;
    let t = from_origin.dot(direction) / direction.length_squared();
    let distance = (from_origin - t * direction).length();
    let (origin32, direction32) = (origin.as_vec3(), direction.as_vec3());
    let from_origin32 = center.as_vec3() - origin32;
    let t32 = from_origin32.dot(direction32) / direction32.length_squared();
    let distance32 = (from_origin32 - t32 * direction32).length();
    let half = 0.5 * curves.visible_width(primitive, u, direction.normalize());
    numbers.number("B(u)_x", center.x as f32, center.x);
    numbers.number("B(u)_y", center.y as f32, center.y);
    numbers.number("B(u)_z", center.z as f32, center.z);
    numbers.number("t", t32, t);
    numbers.number("|B − a − t d|", distance32, distance);
    numbers.number("half the width", half as f32, half);
}

/// The point of a cubic Bézier curve, by de Casteljau's algorithm.
fn bezier(points: [DVec3; 4], u: f64) -> DVec3 {
    let [p0, p1, p2, p3] = points;
    let [a, b, c] = [p0.lerp(p1, u), p1.lerp(p2, u), p2.lerp(p3, u)];
    a.lerp(b, u).lerp(b.lerp(c, u), u)
}
