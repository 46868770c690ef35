//! Curves: the distance of the ray from the point B(u) of the centre line, against half the width there.

use glam::{DVec3, Vec3};
use lookfrom_bvh::Procedural;

use super::{TestNumbers, TestRay};
use crate::primitive::Curves;

/// Names of a ray in the space of a curve.
const IN_CURVE: [&str; 2] = ["a in the curve", "d in the curve"];

/// Names of the way to the space of a curve.
const TO_CURVE: [&str; 4] = ["curve at", "to the curve, row 1", "to the curve, row 2", "to the curve, row 3"];

/// The points of a missed segment that are compared to find the one nearest to the ray.
const POINTS: u32 = 256;

/// Adds the inputs of the test of a curve's segment, and the numbers where it is hit, or is nearest to the ray; returns the
/// reason why it is missed, if it is.
pub(super) fn test(
    curves: &Curves,
    primitive: u32,
    ray: &TestRay,
    numbers: &mut TestNumbers,
) -> Option<String> {
    let (strand, range) = curves.segment(primitive);
    let (rows, at) = curves.object_space();
    numbers.space(TO_CURVE, rows, at);
    let (origin, direction) = curves.ray_in_object(ray.origin, ray.direction);
    let in_curve = TestRay { origin, direction, ..*ray };
    in_curve.add_to(numbers, IN_CURVE);
    let points = strand.points.map(Vec3::as_dvec3);
    for (name, point) in ["P0", "P1", "P2", "P3"].into_iter().zip(points) {
        numbers.input(name, point.to_array());
    }
    let [from, to] = strand.width.map(f64::from);
    numbers.input("width from, to", [from, to]);
    numbers.input("u from, to", range);
    let hit = curves.intersect(primitive, &ray.single);
    let u = hit.map_or_else(|| nearest(points, range, &in_curve), |hit| f64::from(hit.u));
    numbers.input("u", [u]);
    let ribbon = curves.ribbon(primitive, u);
    if let Some(([first, last], _)) = ribbon {
        numbers.input("N at u = 0", first.to_array());
        numbers.input("N at u = 1", last.to_array());
    }

    let center = bezier(points, u);
    let (t, distance) = pass(center, &in_curve);
    let from_origin32 = center.as_vec3() - origin.as_vec3();
    let direction32 = direction.as_vec3();
    let t32 = from_origin32.dot(direction32) / direction32.length_squared();
    let distance32 = (from_origin32 - t32 * direction32).length();
    let width = from + (to - from) * u;
    let half = 0.5 * curves.visible_width(primitive, u, direction.normalize());
    numbers.number("B(u)_x", center.x as f32, center.x);
    numbers.number("B(u)_y", center.y as f32, center.y);
    numbers.number("B(u)_z", center.z as f32, center.z);
    numbers.number("t", t32, t);
    numbers.number("|B − a − t d|", distance32, distance);
    numbers.number("width at u", width as f32, width);
    if let Some((_, n)) = ribbon {
        numbers.number("N(u)_x", n.x as f32, n.x);
        numbers.number("N(u)_y", n.y as f32, n.y);
        numbers.number("N(u)_z", n.z as f32, n.z);
        let cosine = n.dot(direction.normalize()).abs();
        numbers.number("|N(u)·d| / |d|", cosine as f32, cosine);
    }
    numbers.number("half the width", half as f32, half);
    let far = (distance > half).then_some("|B − a − t d| is more than half the width");
    let is_at_end = range.contains(&u);
    let beyond = if is_at_end { "the ray passes beyond its end" } else { "the ray grazes its edge" };
    Some(far.or_else(|| in_curve.range(t)).unwrap_or(beyond).to_owned())
}

/// t of the point of the ray that is nearest to a point, and their distance.
fn pass(center: DVec3, ray: &TestRay) -> (f64, f64) {
    let from_origin = center - ray.origin;
    let t = from_origin.dot(ray.direction) / ray.direction.length_squared();
    (t, (from_origin - t * ray.direction).length())
}

/// u of the point of a segment's centre line that is nearest to the ray, of [`POINTS`] evenly along it.
fn nearest(points: [DVec3; 4], [from, to]: [f64; 2], ray: &TestRay) -> f64 {
    let place = |k: u32| from + (to - from) * f64::from(k) / f64::from(POINTS);
    let distance = |u: &f64| pass(bezier(points, *u), ray).1;
    (0..=POINTS).map(place).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(from)
}

/// The point of a cubic Bézier curve, by de Casteljau's algorithm.
fn bezier(points: [DVec3; 4], u: f64) -> DVec3 {
    let [p0, p1, p2, p3] = points;
    let [a, b, c] = [p0.lerp(p1, u), p1.lerp(p2, u), p2.lerp(p3, u)];
    a.lerp(b, u).lerp(b.lerp(c, u), u)
}
