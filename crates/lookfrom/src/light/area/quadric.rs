//! Quadric lights: spheres, cylinders, disks and their parts.
//!
//! A whole sphere is sampled over the cone that it subtends, or, from inside, over all directions: in its object space,
//! where it is round. A linear map `A` changes solid angle by `|det A| / |A ω|³` (ω of unit length), so ellipsoids are
//! no harder. Parts are sampled by area in object space, which the map changes by a factor that depends on the point.

use std::f64::consts::PI;

use glam::{DVec3, Vec2, Vec3};

use super::{Cone, LightPoint, seen};
use crate::core::warp;
use crate::light::toward;
use crate::primitive::{MaterialBinding, Quadric, QuadricKind};

/// Relative tolerance within which a point counts as inside: for points on the sphere itself, lit by its inner side.
const ON_SPHERE: f64 = 1e-6;

/// Sampled points nearer than this part of the radius to the reference point are that point itself.
const NEAREST: f64 = 1e-5;

/// Number of cells along u and v in the numerical integration of the area of a non-uniformly scaled quadric.
const CELLS: u32 = 64;

/// An empty binding: a light's point needs none.
const NO_LOOK: MaterialBinding = MaterialBinding {
    material: 0,
    light: None,
    shape: 0,
    alpha: None,
    medium_interface: None,
    vertex_data: None,
    single_sided: false,
};

/// A quadric that emits light.
#[derive(Clone, Debug)]
pub struct QuadricLight {
    quadric: Quadric,
    area: f64,
}

impl QuadricLight {
    /// None for a quadric without area.
    pub fn new(quadric: Quadric) -> Option<Self> {
        // The mean of the factor by which the map changes area, over points uniform in object space.
        let mean = || {
            let cell = |i: u32| (i as f32 + 0.5) / CELLS as f32;
            let place = |k: u32| quadric.sample_in_object([cell(k % CELLS), cell(k / CELLS)]);
            (0..CELLS * CELLS).map(|k| quadric.area_scale(place(k))).sum::<f64>() / f64::from(CELLS * CELLS)
        };
        let area = quadric.object_area() * quadric.even_area_scale().unwrap_or_else(mean);
        (area > 0.0 && area.is_finite()).then_some(Self { quadric, area })
    }

    pub(super) fn area(&self) -> f64 {
        self.area
    }

    pub(super) fn bounds(&self) -> [DVec3; 2] {
        self.quadric.bounds()
    }

    pub(super) fn normals(&self) -> Cone {
        match self.quadric.kind {
            QuadricKind::Disk { .. } => {
                let at = self.quadric.point(self.quadric.sample_in_object([0.5; 2]), NO_LOOK);
                Cone { axis: at.ng, cos: 1.0 }
            }
            QuadricKind::Sphere { .. } | QuadricKind::Cylinder { .. } => Cone::ALL,
        }
    }

    pub(super) fn sample(&self, from: DVec3, u: [f32; 2], two_sided: bool) -> Option<LightPoint> {
        let Some(view) = self.view(from, two_sided) else {
            let on_quadric = self.quadric.sample_in_object(u);
            let at = self.quadric.point(on_quadric, NO_LOOK);
            let density = self.pdf_by_area(DVec3::from_array(at.point.position));
            return seen(from, at.point, at.ng, at.uv, density);
        };

        // A direction in object space.
        let View { from: eye, distance, radius, one_minus_cos } = view;
        let inside = one_minus_cos.is_none();
        let local = Vec3::from(warp::uniform_cone(u, one_minus_cos.unwrap_or(2.0) as f32)).as_dvec3();
        let axis = if distance > 0.0 { -eye / distance } else { DVec3::Z };
        let (s, t) = axis.any_orthonormal_pair();
        let direction = (local.x * s + local.y * t + local.z * axis).normalize();

        // Its intersection with the sphere; a direction that misses by rounding touches it.
        let along = -eye.dot(direction);
        let nearest = (eye + along * direction).length();
        let half_chord = ((radius - nearest) * (radius + nearest)).max(0.0).sqrt();
        let depth = if inside { along + half_chord } else { along - half_chord };
        if inside && depth <= NEAREST * radius {
            return None;
        }
        let at = self.quadric.point(eye + depth * direction, NO_LOOK);
        let (wi, _) = toward(from, DVec3::from_array(at.point.position))?;
        let pdf = self.density(&view, wi);
        Some(LightPoint {
            point: at.point,
            normal: at.ng,
            uv: at.uv,
            primitive: 0,
            on_primitive: Vec2::ZERO,
            wi,
            pdf,
        })
    }

    /// The solid angle density where the quadric is sampled by direction.
    pub(super) fn pdf_by_direction(&self, from: DVec3, wi: Vec3, two_sided: bool) -> Option<f32> {
        self.view(from, two_sided).map(|view| self.density(&view, wi))
    }

    /// The area density, in render space, where the quadric is sampled by area.
    pub(super) fn pdf_by_area(&self, p: DVec3) -> f64 {
        1.0 / (self.quadric.object_area() * self.quadric.area_scale(self.quadric.point_in_object(p)))
    }

    /// A whole sphere as seen from a point; `None` if it is not sampled by direction from there.
    fn view(&self, from: DVec3, two_sided: bool) -> Option<View> {
        let QuadricKind::Sphere { radius, .. } = self.quadric.kind else { return None };
        if !self.quadric.is_whole_sphere() {
            return None;
        }
        let from = self.quadric.point_in_object(from);
        let distance = from.length();
        let shines_inward = two_sided || self.quadric.reverse;
        let border = if shines_inward { radius * (1.0 + ON_SPHERE) } else { radius };
        let one_minus_cos = (distance > border).then(|| {
            let sin = radius / distance;
            // without cancellation for far spheres
            sin * sin / (1.0 + ((1.0 - sin) * (1.0 + sin)).sqrt())
        });
        Some(View { from, distance, radius, one_minus_cos })
    }

    fn density(&self, view: &View, wi: Vec3) -> f32 {
        let own = 1.0 / (2.0 * PI * view.one_minus_cos.unwrap_or(2.0));
        let stretch = self.quadric.vector_in_object(wi.as_dvec3().normalize()).length();
        (own / (self.quadric.volume_scale() * stretch * stretch * stretch)) as f32
    }
}

/// A whole sphere as seen from a point, in object space.
#[derive(Clone, Copy, Debug)]
struct View {
    from: DVec3,
    /// Distance from its centre.
    distance: f64,
    radius: f64,
    /// 1 − cosine of the angle between its centre and its rim; None from inside.
    one_minus_cos: Option<f64>,
}
