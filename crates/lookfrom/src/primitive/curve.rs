//! Curves: flat curves that face the ray, cylinders, and ribbons.
//!
//! In a frame whose z axis is the ray, a curve is split until it is nearly straight; where the straight piece passes
//! the origin closer than half its width, the ray hits it: Nakamaru & Ohno (2002), "Ray Tracing for Curves Primitive",
//! with the conventions of Pharr, Jakob, Humphreys, Physically Based Rendering: u along, v across, the depth is that of
//! the curve's centre line, and a ray that leaves starts a whole width away.

use std::sync::Arc;

use glam::{DVec2, DVec3, Vec2, Vec3};
use lookfrom_bvh::{Aabb, Affine, Capsule, Point, Procedural, ProceduralHit, Ray};
use lookfrom_scene::shape::{Profile, Strand};

use super::{MaterialBinding, SurfacePoint, capsule};

/// Number of pieces into which each strand is split for the BVH, for tighter boxes.
pub const SEGMENTS: u32 = 8;

/// A piece is split until its distance from a straight line is less than this part of its width.
const FLATNESS: f64 = 0.05;

/// Maximum number of splits, each in two.
const MOST_SPLITS: u32 = 10;

/// Curves of one shape, with their transform.
#[derive(Clone, Debug)]
pub struct Curves {
    /// Shared with the scene.
    strands: Arc<[Strand]>,
    render_from_object: Affine,
    /// Inverse of the linear part.
    object_from_render: Affine,
    /// An upper bound of the factor by which `render_from_object` lengthens vectors.
    stretch: f64,
    reverse: bool,
    /// Its attributes.
    pub binding: MaterialBinding,
}

/// Four control points of a cubic Bézier curve.
type Controls = [DVec3; 4];

impl Curves {
    /// Places strands by a transform. None where it has no inverse.
    pub fn new(
        strands: Arc<[Strand]>,
        render_from_object: Affine,
        reverse: bool,
        binding: MaterialBinding,
    ) -> Option<Self> {
        let inverse = render_from_object.inverse()?;
        let object_from_render = Affine { translation: [0.0; 3], ..inverse };
        let stretch = capsule::stretch(&render_from_object);
        Some(Self { strands, render_from_object, object_from_render, stretch, reverse, binding })
    }

    /// The strand of a primitive, and its range of u.
    pub(crate) fn segment(&self, primitive: u32) -> (&Strand, [f64; 2]) {
        let number = f64::from(primitive % SEGMENTS);
        let from = number / f64::from(SEGMENTS);
        let to = (number + 1.0) / f64::from(SEGMENTS);
        (&self.strands[(primitive / SEGMENTS) as usize], [from, to])
    }

    /// Number of primitives.
    pub(crate) fn count(&self) -> usize {
        self.strands.len() * SEGMENTS as usize
    }

    /// The ends of the centre line of a primitive, in render space.
    pub(crate) fn ends(&self, primitive: usize) -> [DVec3; 2] {
        let (strand, range) = self.segment(primitive as u32);
        range.map(|u| {
            let (point, _) = evaluate(&controls(strand), u);
            DVec3::from_array(self.render_from_object.point(point.to_array()))
        })
    }

    /// A ray's origin and direction in the space of the strands; its t stays the same.
    pub(crate) fn ray_in_object(&self, origin: DVec3, direction: DVec3) -> (DVec3, DVec3) {
        let translation = DVec3::from_array(self.render_from_object.translation);
        (self.vector_in_object(origin - translation), self.vector_in_object(direction))
    }

    /// The way to object space: the rows of the matrix, and the place of the object's origin in render space.
    pub(crate) fn object_space(&self) -> ([[f64; 3]; 3], DVec3) {
        (super::rows(&self.object_from_render), DVec3::from_array(self.render_from_object.translation))
    }

    /// The normals at the ends of a primitive's strand, and at u along it, if it is a ribbon; those at the ends as written.
    pub(crate) fn ribbon(&self, primitive: u32, u: f64) -> Option<([DVec3; 2], DVec3)> {
        match self.segment(primitive).0.profile {
            Profile::Ribbon(normals) => Some((normals.map(Vec3::as_dvec3), ribbon_normal(normals, u))),
            Profile::Flat | Profile::Cylinder | Profile::PbrtCylinder => None,
        }
    }

    /// The apparent width of a primitive's strand at u along it, seen along a unit direction of its space.
    pub(crate) fn visible_width(&self, primitive: u32, u: f64, direction: DVec3) -> f64 {
        visible_width(self.segment(primitive).0, u, direction)
    }

    fn vector_in_object(&self, v: DVec3) -> DVec3 {
        DVec3::from_array(self.object_from_render.vector(v.to_array()))
    }

    fn vector_in_render(&self, v: DVec3) -> DVec3 {
        DVec3::from_array(self.render_from_object.vector(v.to_array()))
    }

    /// The point at u along and v across a strand that a ray hit near a point.
    pub(crate) fn point(
        &self,
        index: usize,
        [u, v]: [f32; 2],
        near: DVec3,
        direction: DVec3,
    ) -> SurfacePoint {
        let (strand, _) = self.segment(index as u32);
        let along = f64::from(u);
        let direction = self.vector_in_object(direction).normalize();
        let (_, dpdu) = evaluate(&controls(strand), along);
        let dpdu = if dpdu == DVec3::ZERO { direction.any_orthonormal_vector() } else { dpdu };
        let width = visible_width(strand, along, direction);

        // Across: in the ribbon's plane, or perpendicular to the ray.
        let across = match strand.profile {
            Profile::Ribbon(normals) => ribbon_normal(normals, along).cross(dpdu),
            Profile::Flat | Profile::Cylinder | Profile::PbrtCylinder => direction.cross(dpdu),
        };
        let mut dpdv = across.normalize_or(dpdu.any_orthonormal_vector()) * width;
        // That of a cylinder turns around it: along the half that the ray sees, or, in pbrt, along the far one, in proportion to v.
        let turned = match strand.profile {
            Profile::Cylinder => {
                let sin = 2.0 * f64::from(v) - 1.0;
                Some((sin, (1.0 - sin * sin).max(0.0).sqrt()))
            }
            Profile::PbrtCylinder => Some(libm::sincos((0.5 - f64::from(v)) * std::f64::consts::PI)),
            Profile::Flat | Profile::Ribbon(_) => None,
        };
        if let Some((sin, cos)) = turned {
            dpdv = cos * dpdv + sin * dpdu.normalize().cross(dpdv);
        }
        let normal = self.object_from_render.normal_back(dpdu.cross(dpdv).to_array());
        let is_turned = self.reverse != (strand.profile == Profile::Cylinder);
        let ng = DVec3::from_array(normal).normalize_or(DVec3::Z) * if is_turned { -1.0 } else { 1.0 };

        // The error bound is a whole width, scaled to render space.
        let rows = self.render_from_object.matrix.map(|row| DVec3::from_array(row).length());
        let error = near.abs() * f64::from(f32::EPSILON) + width * DVec3::from_array(rows);
        let point = Point { position: near.to_array(), error: error.to_array() };
        let derivatives = [dpdu, dpdv].map(|d| self.vector_in_render(d));
        SurfacePoint::plain(point, ng, Vec2::new(u, v), derivatives, self.binding)
    }
}

impl Procedural for Curves {
    fn count(&self) -> u32 {
        self.strands.len() as u32 * SEGMENTS
    }

    fn bounds(&self, primitive: u32) -> Aabb {
        let (strand, [from, to]) = self.segment(primitive);
        let piece = part(&controls(strand), [from, to]);
        let half = 0.5 * width_at(strand, from).max(width_at(strand, to));
        let rows = self.render_from_object.matrix.map(|row| half * DVec3::from_array(row).length());
        let ends = piece.map(|p| DVec3::from_array(self.render_from_object.point(p.to_array())));
        let min = ends.iter().fold(ends[0], |min, p| min.min(*p)) - DVec3::from_array(rows);
        let max = ends.iter().fold(ends[0], |max, p| max.max(*p)) + DVec3::from_array(rows);
        Aabb {
            min: min.to_array().map(|x| (x as f32).next_down()),
            max: max.to_array().map(|x| (x as f32).next_up()),
        }
    }

    fn capsule(&self, primitive: u32) -> Option<Capsule> {
        let (strand, range) = self.segment(primitive);
        let ends = self.ends(primitive as usize);
        Some(capsule::around(ends, self.stretch * distance_from_chord(strand, range)))
    }

    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<ProceduralHit> {
        let (strand, range) = self.segment(primitive);
        let [origin, direction] = [ray.origin, ray.direction].map(|v| Vec3::from_array(v).as_dvec3());
        nearest(strand, range, self.ray_in_object(origin, direction), ray)
    }
}

/// The nearest hit of a ray and a range of a strand; its origin and direction in the strand's space.
fn nearest(
    strand: &Strand,
    range: [f64; 2],
    (origin, direction): (DVec3, DVec3),
    ray: &Ray,
) -> Option<ProceduralHit> {
    let length = direction.length();

    // A frame along the ray: the curve is seen from the origin, depths are lengths of the direction times t.
    let z = direction / length;
    let (x, y) = z.any_orthonormal_pair();
    let piece =
        part(&controls(strand), range).map(|p| p - origin).map(|p| DVec3::new(p.dot(x), p.dot(y), p.dot(z)));
    let widest = width_at(strand, 0.0).max(width_at(strand, 1.0));
    let mut search = Search {
        strand,
        direction: z,
        nearest: [f64::from(ray.t_min) * length, f64::from(ray.t_max) * length],
        found: None,
    };
    search.split(&piece, range, splits(&piece, widest));
    let (depth, u, v) = search.found?;
    let t = (depth / length) as f32;
    (t > ray.t_min && t < ray.t_max).then_some(ProceduralHit { t, u: u as f32, v: v as f32 })
}

/// The search for the nearest intersection of a ray and a strand.
struct Search<'a> {
    strand: &'a Strand,
    /// The direction, of unit length, in the strand's space.
    direction: DVec3,
    /// The range of depths that count.
    nearest: [f64; 2],
    /// Depth, u, v.
    found: Option<(f64, f64, f64)>,
}

impl Search<'_> {
    /// Intersects a piece, in the ray's frame, with the given range of u.
    fn split(&mut self, piece: &Controls, [from, to]: [f64; 2], splits: u32) {
        // Does the ray pass the piece's box?
        let half = 0.5 * width_at(self.strand, from).max(width_at(self.strand, to));
        let min = piece.iter().fold(piece[0], |min, p| min.min(*p)) - half;
        let max = piece.iter().fold(piece[0], |max, p| max.max(*p)) + half;
        let passes = min.x <= 0.0
            && max.x >= 0.0
            && min.y <= 0.0
            && max.y >= 0.0
            && min.z <= self.nearest[1]
            && max.z >= self.nearest[0];
        if !passes {
            return;
        }
        if splits == 0 {
            self.meet(piece, [from, to]);
            return;
        }
        let middle = 0.5 * (from + to);
        let [first, second] = halves(piece);
        self.split(&first, [from, middle], splits - 1);
        self.split(&second, [middle, to], splits - 1);
    }

    /// Intersects a piece that is nearly straight.
    fn meet(&mut self, piece: &Controls, [from, to]: [f64; 2]) {
        // The ray must pass between the planes across the piece's ends.
        let [p0, p1, p2, p3] = piece.map(DVec3::truncate);
        if (p1 - p0).dot(-p0) < 0.0 || (p2 - p3).dot(-p3) < 0.0 {
            return;
        }
        // The point on the straight line between the ends that is nearest to the ray.
        let chord = p3 - p0;
        let square = chord.length_squared();
        if square == 0.0 {
            return;
        }
        let share = (-p0.dot(chord) / square).clamp(0.0, 1.0);
        let u = from + share * (to - from);
        let width = visible_width(self.strand, u, self.direction);

        // The curve itself there: is it close enough, at a depth in range?
        let (p, along) = evaluate(piece, share);
        let distance = p.truncate().length();
        if !(distance <= 0.5 * width && p.z > self.nearest[0] && p.z < self.nearest[1]) {
            return;
        }
        let (p2, along): (DVec2, DVec2) = (p.truncate(), along.truncate());
        let side = if p2.perp_dot(along) > 0.0 { 1.0 } else { -1.0 };
        self.nearest[1] = p.z;
        self.found = Some((p.z, u, (0.5 + side * distance / width).clamp(0.0, 1.0)));
    }
}

fn controls(strand: &Strand) -> Controls {
    strand.points.map(Vec3::as_dvec3)
}

fn width_at(strand: &Strand, u: f64) -> f64 {
    let [first, last] = strand.width.map(f64::from);
    (1.0 - u) * first + u * last
}

/// The apparent width of a strand along a unit direction: ribbons may be seen edge on.
fn visible_width(strand: &Strand, u: f64, direction: DVec3) -> f64 {
    let width = width_at(strand, u);
    match strand.profile {
        Profile::Ribbon(normals) => width * ribbon_normal(normals, u).dot(direction).abs(),
        Profile::Flat | Profile::Cylinder | Profile::PbrtCylinder => width,
    }
}

/// The normal of a ribbon, spherically interpolated between those at its ends.
fn ribbon_normal([first, last]: [Vec3; 2], u: f64) -> DVec3 {
    let [first, last] = [first, last].map(|n| n.as_dvec3().normalize_or(DVec3::Z));
    let angle = 2.0 * libm::asin((0.5 * (last - first).length()).min(1.0));
    let sin = libm::sin(angle);
    if sin == 0.0 {
        return first;
    }
    (libm::sin((1.0 - u) * angle) * first + libm::sin(u * angle) * last) / sin
}

/// The greatest distance of a hit on a range of a strand from the straight line between the range's ends.
fn distance_from_chord(strand: &Strand, [from, to]: [f64; 2]) -> f64 {
    // A curve's distance from its chord is at most an eighth of the greatest second derivative, 6 times that of the control points.
    let c = controls(strand);
    let bend = (c[0] - 2.0 * c[1] + c[2]).length_squared().max((c[1] - 2.0 * c[2] + c[3]).length_squared());
    let off = 0.75 * bend.sqrt() * (to - from) * (to - from);
    0.5 * width_at(strand, from).max(width_at(strand, to)) + off
}

/// The number of halvings after which a piece is nearly straight.
fn splits(piece: &Controls, width: f64) -> u32 {
    let bend = |k: usize| (piece[k] - 2.0 * piece[k + 1] + piece[k + 2]).abs().max_element();
    // Each halving divides the distance from the straight line, at most √2 · 6/8 · bend, by four.
    let mut off = std::f64::consts::SQRT_2 * 0.75 * bend(0).max(bend(1));
    let mut splits = 0;
    while off > FLATNESS * width && splits < MOST_SPLITS {
        off *= 0.25;
        splits += 1;
    }
    splits
}

/// The point and its derivative.
fn evaluate(c: &Controls, u: f64) -> (DVec3, DVec3) {
    let a = [c[0].lerp(c[1], u), c[1].lerp(c[2], u), c[2].lerp(c[3], u)];
    let b = [a[0].lerp(a[1], u), a[1].lerp(a[2], u)];
    let derivative = 3.0 * (b[1] - b[0]);
    // Where two control points coincide, the chord still has a direction.
    let derivative = if derivative == DVec3::ZERO { c[3] - c[0] } else { derivative };
    (b[0].lerp(b[1], u), derivative)
}

/// The two halves of a curve.
fn halves(c: &Controls) -> [Controls; 2] {
    let middle = |a: DVec3, b: DVec3| 0.5 * (a + b);
    let a = [middle(c[0], c[1]), middle(c[1], c[2]), middle(c[2], c[3])];
    let b = [middle(a[0], a[1]), middle(a[1], a[2])];
    let center = middle(b[0], b[1]);
    [[c[0], a[0], b[0], center], [center, b[1], a[2], c[3]]]
}

/// The piece of a curve between two parameters, by its blossom.
fn part(c: &Controls, [from, to]: [f64; 2]) -> Controls {
    let blossom = |u: [f64; 3]| {
        let a = [c[0].lerp(c[1], u[0]), c[1].lerp(c[2], u[0]), c[2].lerp(c[3], u[0])];
        let b = [a[0].lerp(a[1], u[1]), a[1].lerp(a[2], u[1])];
        b[0].lerp(b[1], u[2])
    };
    [blossom([from; 3]), blossom([from, from, to]), blossom([from, to, to]), blossom([to; 3])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::hash;

    /// A number in −1 … 1.
    fn number(seed: u64) -> f32 {
        (hash::mix(seed) >> 40) as f32 / 8_388_608.0 - 1.0
    }

    fn vector(seed: u64) -> Vec3 {
        Vec3::new(number(3 * seed), number(3 * seed + 1), number(3 * seed + 2))
    }

    /// Hits are in the capsules: curves and rays of random sizes, straight and bent, rays aimed at them, maps that turn, shear and mirror.
    #[test]
    fn hits_are_in_capsules() {
        let mut hits = 0;
        for index in 0..60_000_u64 {
            let seed = index * 40;
            let size = 2_f32.powi((hash::mix(seed + 7) % 41) as i32 - 20);
            let bend = 2_f32.powi(-((hash::mix(seed + 8) % 30) as i32));
            let place = vector(seed + 1) * 2_f32.powi((hash::mix(seed + 9) % 21) as i32 - 10);
            let way = vector(seed + 2);
            let points = [0.0, 0.33, 0.67, 1.0]
                .map(|u: f32| size * (place + way * u + bend * vector(seed + 3 + (u * 3.0).round() as u64)));
            let width = [0.2, 0.05].map(|width| width * size * (1.01 + number(seed + 10)));
            let strand = Strand { points, width, profile: Profile::Flat };
            let map = Affine {
                matrix: [20, 21, 22].map(|row| vector(seed + row).as_dvec3().to_array()),
                translation: (size * vector(seed + 23)).as_dvec3().to_array(),
            };
            let Some(curves) = Curves::new(Arc::new([strand]), map, false, MaterialBinding::NONE) else {
                continue;
            };

            let primitive = index as u32 % SEGMENTS;
            let [from, to] = curves.ends(primitive as usize).map(DVec3::as_vec3);
            let off = 2_f32.powi(-((hash::mix(seed + 11) % 20) as i32)) * size * vector(seed + 12);
            let direction = 2_f32.powi((hash::mix(seed + 13) % 21) as i32 - 10) * vector(seed + 14);
            let ray = Ray::new((from.midpoint(to) + off - direction).to_array(), direction.to_array());
            let Some(hit) = curves.intersect(primitive, &ray) else { continue };
            hits += 1;

            let around = curves.capsule(primitive).unwrap();
            let distance = capsule::distance_to_hit(&around, &ray, hit.t);
            assert!(
                distance <= f64::from(around.radius),
                "{index}: {curves:?} {ray:?} {hit:?}: {distance} of {around:?}"
            );
        }
        assert!(hits > 8_000, "{hits} hits");
    }
}
