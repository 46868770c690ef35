//! Quadrics: ellipsoids, elliptic cylinders and disks, and parts of them; rectangles; and tori, which are of the fourth degree. They are
//! spheres, cylinders, disks and tori around the z axis of their object space, under any affine map.
//!
//! A ray is transformed to object space in f64 and intersected there. The intersection is refined onto the surface and
//! transformed back, with a bound of all errors on the way: [`Point::transformed`], and for surfaces that curve towards
//! a leaving ray also the effect of rounding its origin to f32, which moves it sideways.
//!
//! Conventions of u, v and their derivatives: Pharr, Jakob, Humphreys, Physically Based Rendering.

mod clip;
mod frame;
mod lanes;
mod many;
mod meeting;
mod torus;

use std::f64::consts::PI;

use glam::{DMat4, DVec3, Vec2, Vec3};
use lookfrom_bvh::{Affine, Capsule, Point, Ray};
use lookfrom_simd::Float;

pub use clip::Clip;
pub(crate) use frame::{QuadricFrames, gather_frames};
pub(crate) use lanes::points_on_quadrics;
pub use many::Quadrics;
use meeting::{Meetings, TestedRays};
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
    /// A rectangle in the plane z = 0, from the origin along x and y, with uv from one corner to the opposite one. It is always whole.
    Rectangle {
        /// Along x and y, positive.
        size: [f64; 2],
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
    /// Of a sphere: the polar angles of its heights from the +z axis, in radians.
    theta: [f64; 2],
    /// The cosine and the sine of `phi_max`.
    sweep_end: [f64; 2],
    /// Both.
    frame: QuadricFrames<f32>,
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
            QuadricKind::Disk { .. } | QuadricKind::Rectangle { .. } | QuadricKind::Torus(_) => kind,
        };
        let render_from_object = math::affine(matrix);
        let inverse = render_from_object.inverse()?;
        let object_from_render = Affine { translation: [0.0; 3], ..inverse };
        let phi_max = if phi_max >= 360.0 { 2.0 * PI } else { phi_max.max(0.0).to_radians() };
        let frame = QuadricFrames::new(&render_from_object, &object_from_render, reverse);
        let theta = match kind {
            QuadricKind::Sphere { radius, z } => z.map(|z| polar(z, radius)),
            _ => [0.0; 2],
        };
        let (sin, cos) = libm::sincos(phi_max);
        // Multiples of a right angle exactly.
        let sweep_end = [cos, sin].map(|x| if x.abs() < 1e-15 { 0.0 } else { x });
        Some(Self { kind, phi_max, reverse, render_from_object, object_from_render, theta, sweep_end, frame })
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
        let is_flat = matches!(self.kind, QuadricKind::Disk { .. } | QuadricKind::Rectangle { .. });
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
            QuadricKind::Rectangle { size: [x, y] } => x * y,
            QuadricKind::Torus(torus) => self.phi_max * torus.area_by_angle(),
        }
    }

    /// Area in render space.
    pub fn area(&self) -> f64 {
        let of_even_scale = self.even_area_scale().map(|scale| self.object_area() * scale);
        of_even_scale.unwrap_or_else(|| self.area_of_part(|_| true))
    }

    /// Area in render space of the part of which `keeps` is true in object space, by numerical integration.
    fn area_of_part(&self, keeps: impl Fn(DVec3) -> bool) -> f64 {
        // The mean of the factor by which the map changes area, over points uniform in object space.
        let cell = |i: u32| (i as f32 + 0.5) / CELLS as f32;
        let points = (0..CELLS * CELLS).map(|k| self.sample_in_object([cell(k % CELLS), cell(k / CELLS)]));
        let scales = points.map(|place| if keeps(place) { self.area_scale(place) } else { 0.0 });
        self.object_area() * (scales.sum::<f64>() / f64::from(CELLS * CELLS))
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
            QuadricKind::Rectangle { size: [x, y] } => DVec3::new(u0 * x, u1 * y, 0.0),
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
            // The corners are on a circle around the origin, or within.
            QuadricKind::Rectangle { size: [x, y] } => ((x * x + y * y).sqrt(), [0.0, 0.0]),
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
            QuadricKind::Rectangle { .. } => DVec3::new(p.x, p.y, 0.0),
            QuadricKind::Torus(torus) => torus.refined(p),
        }
    }

    /// The unit normal away from the axis (along +z for a disk), in object space, at a point of the surface.
    fn outward(&self, p: DVec3) -> DVec3 {
        match self.kind {
            QuadricKind::Sphere { .. } => p.normalize(),
            QuadricKind::Cylinder { .. } => DVec3::new(p.x, p.y, 0.0).normalize(),
            QuadricKind::Disk { .. } | QuadricKind::Rectangle { .. } => DVec3::Z,
            QuadricKind::Torus(torus) => torus.outward(p),
        }
    }

    /// The first intersection of a ray in render space with its part of the surface, of which `clip` may leave a part.
    fn first_meeting(&self, ray: &Ray, clip: Option<&Clip>) -> Option<f32> {
        let Ray { origin, direction, t_min, t_max } = *ray;
        let rays = TestedRays { origin: origin.into(), direction: direction.into(), t_min, t_max };
        let Meetings { t, exist, are_unclear } = self.first_meetings(clip, &rays);
        if are_unclear { self.unclear_meeting(ray, clip) } else { exist.then_some(t) }
    }

    /// The first intersection with a torus, between the extremes of its equation.
    fn unclear_meeting(&self, ray: &Ray, clip: Option<&Clip>) -> Option<f32> {
        let QuadricKind::Torus(torus) = self.kind else { return None };
        let [origin, direction] = [ray.origin, ray.direction].map(|v| Vec3::from_array(v).as_dvec3());
        let [origin, direction] = [self.point_in_object(origin), self.vector_in_object(direction)];
        let t = torus.first_accepted([origin, direction], ray.t_min.into(), |&t| {
            let rounded = t as f32;
            let is_in_range = rounded > ray.t_min && rounded < ray.t_max;
            is_in_range && clip.is_none_or(|clip| clip.keeps(0.0_f32, (origin + t * direction).into()))
        });
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
        let u = match self.kind {
            QuadricKind::Rectangle { size: [x, _] } => p.x / x,
            _ if self.phi_max > 0.0 => angle(p) / self.phi_max,
            _ => 0.0,
        };
        let v = match self.kind {
            QuadricKind::Sphere { radius, .. } => {
                let [from, to] = self.theta;
                (polar(p.z, radius) - from) / (to - from)
            }
            QuadricKind::Cylinder { z: [low, high], .. } => (p.z - low) / (high - low),
            QuadricKind::Disk { radius, inner_radius, .. } => {
                (radius - p.truncate().length()) / (radius - inner_radius)
            }
            QuadricKind::Rectangle { size: [_, y] } => p.y / y,
            QuadricKind::Torus(torus) => torus.angle(p) / (2.0 * PI),
        };
        Vec2::new(u as f32, v as f32).clamp(Vec2::ZERO, Vec2::ONE)
    }

    /// The derivatives of a point of the surface by its texture coordinates, in object space.
    fn derivatives(&self, p: DVec3) -> [DVec3; 2] {
        match self.kind {
            QuadricKind::Sphere { radius, .. } => {
                let [from, to] = self.theta;
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
            QuadricKind::Rectangle { size: [x, y] } => [x * DVec3::X, y * DVec3::Y],
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
            QuadricKind::Rectangle { .. } => {
                self.frame.place(p.into(), outward(), error(0.0, 0.0, 0.0), f64::INFINITY)
            }
            QuadricKind::Torus(torus) => {
                let own = torus.error();
                self.frame.place(p.into(), outward(), error(own, own, own), torus.radius_of_curvature(p))
            }
        }
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

#[cfg(test)]
mod tests;
