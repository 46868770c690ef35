//! Quadrics: ellipsoids, elliptic cylinders and disks, and parts of them; and tori, which are of the fourth degree. They are spheres,
//! cylinders, disks and tori around the z axis of their object space, under any affine map.
//!
//! A ray is transformed to object space in f64 and intersected there. The intersection is refined onto the surface and
//! transformed back, with a bound of all errors on the way: [`Point::transformed`], and for surfaces that curve towards
//! a leaving ray also the effect of rounding its origin to f32, which moves it sideways.
//!
//! Conventions of u, v and their derivatives: Pharr, Jakob, Humphreys, Physically Based Rendering. The intersection
//! after Haines et al. (2019), "Precision Improvements for Ray/Sphere Intersection".

mod frame;
mod torus;

use std::f64::consts::PI;

use glam::{DMat4, DVec3, Vec2, Vec3};
use lookfrom_bvh::{Aabb, Affine, Capsule, Point, Procedural, ProceduralHit, Ray};
use lookfrom_simd::Float;

pub(crate) use frame::{QuadricFrames, gather_frames};
pub use torus::Torus;

use super::{MaterialBinding, SurfacePoint, capsule};
use crate::core::math;
use crate::core::points::Points;
use crate::core::vector::Vector;
use crate::core::warp;

/// Unit of rounding of f64, 2⁻⁵³.
const UNIT: f64 = 0.5 * f64::EPSILON;

/// A cylinder is thin where the area of its box is more than this many times that of the capsule around it.
const THIN: f64 = 2.0;

/// Number of cells along u and v in the numerical integration of the area of a non-uniformly scaled quadric.
const CELLS: u32 = 64;

/// The shape of a quadric in object space.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum QuadricKind {
    /// A sphere around the origin, between two heights.
    Sphere {
        /// Positive.
        radius: f64,
        /// In ascending order, within ± the radius.
        z: [f64; 2],
    },
    /// A disk perpendicular to the z axis.
    Disk {
        /// At this z.
        height: f64,
        /// Positive.
        radius: f64,
        /// Radius of the hole: not negative, below the radius.
        inner_radius: f64,
    },
    /// A cylinder around the z axis, between two heights.
    Cylinder {
        /// Positive.
        radius: f64,
        /// In ascending order.
        z: [f64; 2],
    },
    /// A torus around the z axis.
    Torus(Torus),
}

/// A quadric with its transform.
#[derive(Clone, Copy, Debug)]
pub struct Quadric {
    /// Its shape in object space.
    pub kind: QuadricKind,
    /// Swept from +x toward +y: radians in (0, 2π].
    pub phi_max: f64,
    /// Whether outside and inside are exchanged.
    pub reverse: bool,
    render_from_object: Affine,
    /// Inverse of the linear part.
    object_from_render: Affine,
    /// Both.
    frame: QuadricFrames<f32>,
}

/// Quadrics of many shapes: long and thin ones, or others.
#[derive(Clone, Debug, Default)]
pub struct Quadrics {
    /// The quadrics.
    pub quadrics: Vec<Quadric>,
    /// The attributes of each.
    pub bindings: Vec<MaterialBinding>,
}

impl Quadric {
    /// Places a quadric by a transform; `phi_max` in degrees. Heights may come in any order; those of a sphere are
    /// clamped to ± its radius. None where `matrix` has no inverse.
    pub fn new(kind: QuadricKind, phi_max: f64, matrix: &DMat4, reverse: bool) -> Option<Self> {
        let ascending = |[a, b]: [f64; 2]| if a <= b { [a, b] } else { [b, a] };
        let kind = match kind {
            QuadricKind::Sphere { radius, z } => {
                QuadricKind::Sphere { radius, z: ascending(z).map(|z| z.max(-radius).min(radius)) }
            }
            QuadricKind::Cylinder { radius, z } => QuadricKind::Cylinder { radius, z: ascending(z) },
            QuadricKind::Disk { .. } | QuadricKind::Torus(_) => kind,
        };
        let render_from_object = math::affine(matrix);
        let inverse = render_from_object.inverse()?;
        let object_from_render = Affine { translation: [0.0; 3], ..inverse };
        let phi_max = if phi_max >= 360.0 { 2.0 * PI } else { phi_max.max(0.0).to_radians() };
        let frame = QuadricFrames::new(&render_from_object, &object_from_render, reverse);
        Some(Self { kind, phi_max, reverse, render_from_object, object_from_render, frame })
    }

    /// Whether it is a whole sphere (an ellipsoid, after its transform).
    pub fn is_whole_sphere(&self) -> bool {
        matches!(self.kind, QuadricKind::Sphere { radius, z } if z == [-radius, radius])
            && self.is_whole_turn()
    }

    /// Whether it is a disk (an ellipse, after its transform) without a hole.
    pub fn is_whole_disk(&self) -> bool {
        matches!(self.kind, QuadricKind::Disk { inner_radius: 0.0, .. }) && self.is_whole_turn()
    }

    fn is_whole_turn(&self) -> bool {
        self.phi_max >= 2.0 * PI
    }

    /// The transforms between object space and render space.
    pub(crate) fn frame(&self) -> &QuadricFrames<f32> {
        &self.frame
    }

    /// The way to object space: the rows of the matrix, and the place of the object's origin in render space.
    pub fn object_space(&self) -> ([[f64; 3]; 3], DVec3) {
        (super::rows(&self.object_from_render), DVec3::from_array(self.render_from_object.translation))
    }

    /// A point of render space, in object space.
    pub fn point_in_object(&self, p: DVec3) -> DVec3 {
        self.vector_in_object(p - DVec3::from_array(self.render_from_object.translation))
    }

    /// A point of object space, in render space.
    pub fn point_in_render(&self, p: DVec3) -> DVec3 {
        self.vector_in_render(p) + DVec3::from_array(self.render_from_object.translation)
    }

    /// A direction of render space, in object space.
    pub fn vector_in_object(&self, v: DVec3) -> DVec3 {
        DVec3::from_array(self.object_from_render.vector(v.to_array()))
    }

    /// A direction of object space, in render space.
    pub fn vector_in_render(&self, v: DVec3) -> DVec3 {
        DVec3::from_array(self.render_from_object.vector(v.to_array()))
    }

    /// Ratio of a volume in render space to that in object space.
    pub fn volume_scale(&self) -> f64 {
        let [x, y, z] = self.render_from_object.matrix.map(DVec3::from_array);
        x.cross(y).dot(z).abs()
    }

    /// Ratio of the area element in render space to that in object space, at a point of the surface in object space.
    pub fn area_scale(&self, on_surface: DVec3) -> f64 {
        let normal = self.object_from_render.normal_back(self.outward(on_surface).to_array());
        self.volume_scale() * DVec3::from_array(normal).length()
    }

    /// [`Self::area_scale`] where it is the same everywhere.
    pub fn even_area_scale(&self) -> Option<f64> {
        let [x, y, z] = self.render_from_object.matrix.map(DVec3::from_array);
        let square = x.length_squared();
        let even = [y.length_squared() - square, z.length_squared() - square, x.dot(y), y.dot(z), z.dot(x)];
        let is_flat = matches!(self.kind, QuadricKind::Disk { .. });
        (is_flat || even.iter().all(|off| off.abs() <= 1e-9 * square)).then(|| self.area_scale(DVec3::X))
    }

    /// Area in object space.
    pub fn object_area(&self) -> f64 {
        match self.kind {
            QuadricKind::Sphere { radius, z: [low, high] }
            | QuadricKind::Cylinder { radius, z: [low, high] } => self.phi_max * radius * (high - low),
            QuadricKind::Disk { radius, inner_radius, .. } => {
                0.5 * self.phi_max * (radius - inner_radius) * (radius + inner_radius)
            }
            QuadricKind::Torus(torus) => self.phi_max * torus.area_by_angle(),
        }
    }

    /// Area in render space.
    pub fn area(&self) -> f64 {
        // The mean of the factor by which the map changes area, over points uniform in object space.
        let mean = || {
            let cell = |i: u32| (i as f32 + 0.5) / CELLS as f32;
            let place = |k: u32| self.sample_in_object([cell(k % CELLS), cell(k / CELLS)]);
            (0..CELLS * CELLS).map(|k| self.area_scale(place(k))).sum::<f64>() / f64::from(CELLS * CELLS)
        };
        self.object_area() * self.even_area_scale().unwrap_or_else(mean)
    }

    /// A point of the surface, in object space, uniform over the area there; `u` in [0, 1)².
    pub fn sample_in_object(&self, u: [f32; 2]) -> DVec3 {
        let [u0, u1] = u.map(f64::from);
        let (sin, cos) = libm::sincos(u1 * self.phi_max);
        match self.kind {
            QuadricKind::Sphere { radius, z: [low, high] } => {
                let z = low + u0 * (high - low);
                let ring = ((radius - z) * (radius + z)).max(0.0).sqrt();
                DVec3::new(ring * cos, ring * sin, z)
            }
            QuadricKind::Cylinder { radius, z: [low, high] } => {
                DVec3::new(radius * cos, radius * sin, low + u0 * (high - low))
            }
            QuadricKind::Disk { height, radius, .. } if self.is_whole_disk() => {
                let disk = Vec2::from_array(warp::concentric_disk(u)).as_dvec2() * radius;
                DVec3::new(disk.x, disk.y, height)
            }
            QuadricKind::Disk { height, radius, inner_radius } => {
                let inner = inner_radius * inner_radius;
                let ring = (inner + u0 * (radius * radius - inner)).sqrt();
                DVec3::new(ring * cos, ring * sin, height)
            }
            QuadricKind::Torus(torus) => {
                let [ring, z] = torus.sample(u0);
                DVec3::new(ring * cos, ring * sin, z)
            }
        }
    }

    /// The bounding box, in render space.
    pub fn bounds(&self) -> [DVec3; 2] {
        let (radius, [low, high]) = match self.kind {
            QuadricKind::Sphere { radius, z } | QuadricKind::Cylinder { radius, z } => (radius, z),
            QuadricKind::Disk { height, radius, .. } => (radius, [height, height]),
            QuadricKind::Torus(Torus { radius, .. }) => (radius, [0.0, 0.0]),
        };
        let rows = self.render_from_object.matrix.map(DVec3::from_array);
        let translation = DVec3::from_array(self.render_from_object.translation);
        // The extent is that of a circle perpendicular to the z axis, and of the two heights along it.
        let circle = DVec3::from_array(rows.map(|row| radius * row.truncate().length()));
        let along = DVec3::from_array(rows.map(|row| row.z));
        let ends = [translation + low * along, translation + high * along];
        let mut min = ends[0].min(ends[1]) - circle;
        let mut max = ends[0].max(ends[1]) + circle;
        if matches!(self.kind, QuadricKind::Sphere { .. }) {
            let whole = DVec3::from_array(rows.map(|row| radius * row.length()));
            (min, max) = (min.max(translation - whole), max.min(translation + whole));
        }
        if let QuadricKind::Torus(Torus { tube, .. }) = self.kind {
            // Balls around the points of the circle.
            let ball = DVec3::from_array(rows.map(|row| tube * row.length()));
            (min, max) = (min - ball, max + ball);
        }
        let error = 32.0 * UNIT * (min.abs().max(max.abs()) + translation.abs());
        [min - error, max + error]
    }

    /// The capsule around a long and thin cylinder that leaves most of its box empty, in render space.
    pub(crate) fn capsule(&self) -> Option<Capsule> {
        let QuadricKind::Cylinder { radius, z } = self.kind else { return None };
        let mut across = self.render_from_object;
        across.matrix.iter_mut().for_each(|row| row[2] = 0.0);
        let radius = radius * capsule::stretch(&across);
        let ends = z.map(|z| self.point_in_render(DVec3::new(0.0, 0.0, z)));

        // Rays meet convex bodies as often as these have area.
        let [min, max] = self.bounds();
        let size = max - min;
        let area_of_box = 2.0 * size.dot(DVec3::new(size.y, size.z, size.x));
        let area = 2.0 * PI * radius * (ends[0].distance(ends[1]) + 2.0 * radius);
        (area_of_box > THIN * area).then(|| capsule::around(ends, radius))
    }

    /// The point of the surface nearest to one that is on it up to errors, in object space.
    fn refined(&self, p: DVec3) -> DVec3 {
        match self.kind {
            QuadricKind::Sphere { radius, .. } => p * (radius / p.length()),
            QuadricKind::Cylinder { radius, .. } => {
                let stretch = radius / p.truncate().length();
                DVec3::new(stretch * p.x, stretch * p.y, p.z)
            }
            QuadricKind::Disk { height, .. } => DVec3::new(p.x, p.y, height),
            QuadricKind::Torus(torus) => torus.refined(p),
        }
    }

    /// The unit normal away from the axis (along +z for a disk), in object space, at a point of the surface.
    fn outward(&self, p: DVec3) -> DVec3 {
        match self.kind {
            QuadricKind::Sphere { .. } => p.normalize(),
            QuadricKind::Cylinder { .. } => DVec3::new(p.x, p.y, 0.0).normalize(),
            QuadricKind::Disk { .. } => DVec3::Z,
            QuadricKind::Torus(torus) => torus.outward(p),
        }
    }

    /// Whether a point of the whole surface is in the quadric's part of it.
    fn contains(&self, p: DVec3) -> bool {
        let there = match self.kind {
            QuadricKind::Sphere { radius, z: [low, high] } => {
                // A whole sphere has no edge for rounding to fall beyond.
                (low <= -radius || p.z >= low) && (high >= radius || p.z <= high)
            }
            QuadricKind::Cylinder { z: [low, high], .. } => (low..=high).contains(&p.z),
            QuadricKind::Disk { radius, inner_radius, .. } => {
                let square = p.truncate().length_squared();
                square <= radius * radius && square >= inner_radius * inner_radius
            }
            QuadricKind::Torus(_) => true,
        };
        there && (self.is_whole_turn() || angle(p) <= self.phi_max)
    }

    /// The first intersection in object space of a ray with its part of the surface.
    fn first_meeting(&self, ray: &Ray, origin: DVec3, direction: DVec3) -> Option<f32> {
        let is_in_range = |&t: &f64| {
            let rounded = t as f32;
            rounded > ray.t_min && rounded < ray.t_max
        };
        let is_part = |t: f64| self.contains(self.refined(origin + t * direction));
        let across = DVec3::new(1.0, 1.0, 0.0);
        let first =
            |meetings: Option<[f64; 2]>| meetings?.into_iter().find(|t| is_in_range(t) && is_part(*t));
        let t = match self.kind {
            QuadricKind::Sphere { radius, .. } => first(roots(origin, direction, radius)),
            QuadricKind::Cylinder { radius, .. } => first(roots(origin * across, direction * across, radius)),
            QuadricKind::Disk { height, .. } => first(Some([(height - origin.z) / direction.z, f64::NAN])),
            QuadricKind::Torus(torus) => {
                torus.first_meeting([origin, direction], ray.t_min.into(), is_in_range)
            }
        };
        t.map(|t| t as f32)
    }

    /// The point of the surface that is `on_surface` in object space.
    pub fn point(&self, on_surface: DVec3, binding: MaterialBinding) -> SurfacePoint {
        self.point_of(on_surface, binding, true)
    }

    /// As [`Self::point`]. Texture coordinates are 0 where they are not wanted.
    fn point_of(&self, on_surface: DVec3, binding: MaterialBinding, wants_uv: bool) -> SurfacePoint {
        let p = self.refined(on_surface);
        let uv = if wants_uv { self.uv(p) } else { Vec2::ZERO };
        let derivatives = self.derivatives(p).map(|d| self.vector_in_render(d));
        let (points, ng) = self.place(p);
        let point = Point { position: points.position.into(), error: points.error.into() };
        SurfacePoint::plain(point, ng.into(), uv, derivatives, binding)
    }

    /// The texture coordinates of a point of the surface, in object space.
    pub(crate) fn uv(&self, p: DVec3) -> Vec2 {
        let u = if self.phi_max > 0.0 { angle(p) / self.phi_max } else { 0.0 };
        let v = match self.kind {
            QuadricKind::Sphere { radius, z } => {
                let [from, to] = z.map(|z| polar(z, radius));
                (polar(p.z, radius) - from) / (to - from)
            }
            QuadricKind::Cylinder { z: [low, high], .. } => (p.z - low) / (high - low),
            QuadricKind::Disk { radius, inner_radius, .. } => {
                (radius - p.truncate().length()) / (radius - inner_radius)
            }
            QuadricKind::Torus(torus) => torus.angle(p) / (2.0 * PI),
        };
        Vec2::new(u as f32, v as f32).clamp(Vec2::ZERO, Vec2::ONE)
    }

    /// The derivatives of a point of the surface by its texture coordinates, in object space.
    fn derivatives(&self, p: DVec3) -> [DVec3; 2] {
        match self.kind {
            QuadricKind::Sphere { radius, z } => {
                let [from, to] = z.map(|z| polar(z, radius));
                sphere_derivatives(p.into(), radius, [to - from, self.phi_max]).map(DVec3::from)
            }
            QuadricKind::Cylinder { z: [low, high], .. } => {
                [turning(p, self.phi_max), DVec3::new(0.0, 0.0, high - low)]
            }
            QuadricKind::Disk { radius, inner_radius, .. } => {
                let ring = p.truncate().length();
                let (x, y) = if ring > 0.0 { (p.x / ring, p.y / ring) } else { (1.0, 0.0) };
                // At the very centre, take the derivative of a point close by.
                let turned = ring.max(1e-5 * radius) * DVec3::new(x, y, 0.0);
                let dpdv = (inner_radius - radius) * DVec3::new(x, y, 0.0);
                [turning(turned, self.phi_max), dpdv]
            }
            QuadricKind::Torus(torus) => [turning(p, self.phi_max), torus.along_tube(p)],
        }
    }

    /// The point of render space and the outward unit normal there, by the point of the surface in object space.
    fn place(&self, p: DVec3) -> (Points<f32>, Vector<f64>) {
        let error = |x: f64, y: f64, z: f64| Vector::new(x, y, z);
        let outward = || self.outward(p).into();
        match self.kind {
            QuadricKind::Sphere { radius, .. } => self.frame.place_on_spheres(p.into(), radius),
            QuadricKind::Cylinder { radius, .. } => {
                let own = 16.0 * UNIT * radius;
                self.frame.place(p.into(), outward(), error(own, own, 0.0), radius)
            }
            QuadricKind::Disk { height, .. } => {
                let own = 4.0 * UNIT * height.abs();
                self.frame.place(p.into(), outward(), error(0.0, 0.0, own), f64::INFINITY)
            }
            QuadricKind::Torus(torus) => {
                let own = 32.0 * UNIT * torus.size();
                self.frame.place(p.into(), outward(), error(own, own, own), torus.radius_of_curvature(p))
            }
        }
    }
}

impl Quadrics {
    /// The point of a quadric nearest to one that is on it up to errors. Texture coordinates are 0 where they are not wanted.
    pub(super) fn point(&self, index: usize, near: DVec3, wants_uv: bool) -> SurfacePoint {
        let quadric = &self.quadrics[index];
        quadric.point_of(quadric.point_in_object(near), self.bindings[index], wants_uv)
    }
}

impl Procedural for Quadrics {
    fn count(&self) -> u32 {
        self.quadrics.len() as u32
    }

    fn bounds(&self, primitive: u32) -> Aabb {
        let [min, max] = self.quadrics[primitive as usize].bounds();
        Aabb {
            min: min.to_array().map(|x| (x as f32).next_down()),
            max: max.to_array().map(|x| (x as f32).next_up()),
        }
    }

    fn capsule(&self, primitive: u32) -> Option<Capsule> {
        self.quadrics[primitive as usize].capsule()
    }

    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<ProceduralHit> {
        let quadric = &self.quadrics[primitive as usize];
        let [origin, direction] = [ray.origin, ray.direction].map(|v| Vec3::from_array(v).as_dvec3());
        let (origin, direction) = (quadric.point_in_object(origin), quadric.vector_in_object(direction));
        quadric.first_meeting(ray, origin, direction).map(|t| ProceduralHit { t, u: 0.0, v: 0.0 })
    }
}

/// Derivatives of a sphere's point by u and v; poles on z. The array holds the ranges of the polar angle, from the
/// lowest point to the highest (hence negative), and of φ. At a pole they are those of a point very close to it.
#[inline(always)]
pub(super) fn sphere_derivatives<F: Float<Scalar = f64>>(
    p: Vector<F>,
    radius: F,
    [theta, phi]: [f64; 2],
) -> [Vector<F>; 2] {
    let (zero, theta, phi) = (radius.like(0.0), radius.like(theta), radius.like(phi));
    let is_pole = p.x.eq(zero) & p.y.eq(zero);
    let x = F::select(is_pole, radius * radius.like(1e-5), p.x);
    let y = F::select(is_pole, zero, p.y);
    let ring = (x * x + y * y).sqrt();
    let (cos, sin) = (x / ring, y / ring);
    let by_theta = Vector { x: p.z * cos, y: p.z * sin, z: -ring };
    [Vector { x: -y * phi, y: x * phi, z: zero * phi }, by_theta * theta]
}

/// The derivative by u, where u is φ / `phi_max`.
fn turning(p: DVec3, phi_max: f64) -> DVec3 {
    phi_max * DVec3::new(-p.y, p.x, 0.0)
}

/// The polar angle from the +z axis, in radians.
fn polar(z: f64, radius: f64) -> f64 {
    libm::acos((z / radius).clamp(-1.0, 1.0))
}

/// The angle φ around the z axis from +x toward +y: [0, 2π).
fn angle(p: DVec3) -> f64 {
    let angle = libm::atan2(p.y, p.x);
    if angle < 0.0 { angle + 2.0 * PI } else { angle }
}

/// The intersections of a line with the sphere around the origin, the smaller t first; `f` is a point of the line.
fn roots(f: DVec3, d: DVec3, radius: f64) -> Option<[f64; 2]> {
    let a = d.length_squared();
    let b = f.dot(d);
    // The discriminant from the line's point nearest to the centre: no cancellation for small or far spheres.
    let nearest = (f - (b / a) * d).length();
    let discriminant = a * ((radius - nearest) * (radius + nearest));
    if !(discriminant >= 0.0) {
        return None;
    }
    // Both roots without cancellation.
    let length = f.length();
    let c = (length - radius) * (length + radius);
    let q = -(b + discriminant.sqrt().copysign(b));
    let [t1, t2] = if q == 0.0 { [0.0; 2] } else { [q / a, c / q] };
    Some(if t1 <= t2 { [t1, t2] } else { [t2, t1] })
}

#[cfg(test)]
mod tests;
