//! Triangles as lights: one is chosen by area, then a direction uniformly over the solid angle in which it is seen.
//!
//! Arvo (1995), "Stratified Sampling of Spherical Triangles"; the solid angle by Van Oosterom & Strackee (1983). Where that
//! is very small or nearly a hemisphere, the point is chosen by area, which is as good there.

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};
use lookfrom_bvh::Point;

use super::{Cone, LightPoint, seen};
use crate::distribution::Discrete;
use crate::light::toward;
use crate::shape::Mesh;
use crate::warp;

/// Solid angles in which triangles are chosen from by direction.
const BY_DIRECTION: std::ops::RangeInclusive<f64> = 3e-4..=6.22;

/// Triangles that seem smaller than this are chosen from by area: less noise than the choice by direction saves is worth
/// its time from here on (distances and angles over the triangle differ little).
const WORTH_DIRECTION: f64 = 0.06;

/// A mesh that shines.
#[derive(Clone, Debug)]
pub struct MeshLight {
    mesh: Arc<Mesh>,
    /// By triangle: what choosing a point of it takes.
    triangles: Vec<Triangle>,
    /// Of a triangle, by area.
    choice: Discrete,
    area: f64,
}

/// A triangle, made ready for choosing points of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    /// In render space.
    pub(crate) corners: [[f32; 3]; 3],
    pub(crate) p0: DVec3,
    pub(crate) e1: DVec3,
    pub(crate) e2: DVec3,
    /// To the outside, of unit length; `None` where the mesh's normals make that differ over the triangle.
    pub(crate) normal: Option<DVec3>,
    pub(crate) area: f64,
}

impl MeshLight {
    /// The triangle that a number chooses, if it has one normal, its probability, and what is left of the number.
    #[inline]
    pub(super) fn triangle(&self, u0: f32) -> Option<(&Triangle, f32, f32)> {
        let (index, probability, u0) = self.choice.sample(u0);
        let triangle = &self.triangles[index];
        triangle.normal.is_some().then_some((triangle, probability, u0))
    }

    /// None for a mesh without area.
    pub fn new(mesh: Arc<Mesh>) -> Option<Self> {
        let triangles: Vec<Triangle> =
            (0..mesh.triangles.len()).map(|index| Triangle::new(&mesh, index)).collect();
        let area: f64 = triangles.iter().map(|triangle| triangle.area).filter(|area| area.is_finite()).sum();
        // In parts of the whole, which no unit of length makes vanish.
        let weights: Vec<f32> = triangles.iter().map(|triangle| (triangle.area / area) as f32).collect();
        let choice = || Discrete::new(&weights);
        (area > 0.0 && area.is_finite()).then(|| Self { choice: choice(), mesh, triangles, area })
    }

    pub(super) fn area(&self) -> f64 {
        self.area
    }

    pub(super) fn bounds(&self) -> [DVec3; 2] {
        let vertices = (0..self.mesh.triangles.len()).flat_map(|index| self.mesh.corners(index));
        vertices
            .map(|p| Vec3::from_array(p).as_dvec3())
            .fold([DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY)], |[min, max], p| {
                [min.min(p), max.max(p)]
            })
    }

    /// The cone of the normals, at all corners of all triangles that have an area.
    pub(super) fn normals(&self) -> Cone {
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)];
        let triangles = (0..self.mesh.triangles.len()).filter(|&index| self.choice.pdf(index) > 0.0);
        Cone::around(triangles.flat_map(|index| corners.map(|(u, v)| self.mesh.point(index, u, v).ng)))
    }

    pub(super) fn sample(&self, from: DVec3, [u0, u1]: [f32; 2]) -> Option<LightPoint> {
        let (index, probability, u0) = self.choice.sample(u0);
        let triangle = &self.triangles[index];
        if let Some(solid_angle) = triangle.worth_direction(from) {
            let corners = triangle.corners_from(from);
            let direction = sample_spherical_triangle(corners, solid_angle, [u0, u1].map(f64::from));
            let [beta, gamma] = barycentric(corners, direction);
            let (point, normal, uv) = self.point(index, beta as f32, gamma as f32);
            let (wi, _) = toward(from, DVec3::from_array(point.position))?;
            let pdf = (f64::from(probability) / solid_angle) as f32;
            return Some(LightPoint { point, normal, uv, wi, pdf });
        }
        let [_, beta, gamma] = warp::uniform_triangle([u0, u1]);
        let (point, normal, uv) = self.point(index, beta, gamma);
        seen(from, point, normal, uv, f64::from(probability) / triangle.area)
    }

    /// A point of a triangle, the normal to the outside and the texture coordinates.
    fn point(&self, index: usize, beta: f32, gamma: f32) -> (Point, DVec3, Vec2) {
        let Some(normal) = self.triangles[index].normal else {
            let at = self.mesh.point(index, beta, gamma);
            return (at.point, at.ng, at.uv);
        };
        let [p0, p1, p2] = self.mesh.corners(index);
        let uvs = self.mesh.corner_uvs(index);
        let uv = (1.0 - beta - gamma) * uvs[0] + beta * uvs[1] + gamma * uvs[2];
        (Point::on_triangle(p0, p1, p2, beta, gamma), normal, uv)
    }

    /// The density over solid angle where points of a triangle are chosen by direction.
    pub(super) fn pdf_by_direction(&self, from: DVec3, index: usize) -> Option<f32> {
        let solid_angle = self.triangles[index].worth_direction(from)?;
        Some((f64::from(self.choice.pdf(index)) / solid_angle) as f32)
    }

    /// The density over area where points of a triangle are chosen by area.
    pub(super) fn pdf_by_area(&self, index: usize) -> f64 {
        f64::from(self.choice.pdf(index)) / self.triangles[index].area
    }
}

impl Triangle {
    /// In place of one.
    pub(crate) const NONE: Self = Self {
        corners: [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        p0: DVec3::ZERO,
        e1: DVec3::X,
        e2: DVec3::Y,
        normal: Some(DVec3::Z),
        area: 0.5,
    };

    /// Triangles that seem smaller are surely chosen from by area.
    pub(crate) const WORTH_DIRECTION: f64 = WORTH_DIRECTION;

    fn new(mesh: &Mesh, index: usize) -> Self {
        let corners = mesh.corners(index);
        let [p0, p1, p2] = corners.map(|p| Vec3::from_array(p).as_dvec3());
        let (e1, e2) = (p1 - p0, p2 - p0);
        // The middle has the side of all three corners, where they agree.
        let normals = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(u, v)| mesh.point(index, u, v).ng);
        let agree = normals[1..].iter().all(|ng| ng.dot(normals[0]) > 0.0);
        Self { corners, p0, e1, e2, normal: agree.then_some(normals[0]), area: 0.5 * e1.cross(e2).length() }
    }

    /// As it is seen from a point.
    fn corners_from(&self, from: DVec3) -> [DVec3; 3] {
        let p0 = self.p0 - from;
        [p0, p0 + self.e1, p0 + self.e2]
    }

    /// The solid angle in which it is seen from a point, if its points are chosen by direction from there.
    fn worth_direction(&self, from: DVec3) -> Option<f64> {
        // Roughly, by the middle: area · cos / distance²; near triangles are told by their size. A triangle whose normal
        // is not known is seen as if it faced the point.
        let middle = self.p0 - from + (self.e1 + self.e2) * (1.0 / 3.0);
        let distance2 = middle.length_squared();
        let facing = self.normal.map_or(distance2.sqrt(), |normal| normal.dot(middle).abs());
        let seems = self.area * facing / (distance2 * distance2.sqrt());
        if !(seems > WORTH_DIRECTION || distance2 < self.area) {
            return None;
        }
        let solid_angle = solid_angle(self.corners_from(from));
        BY_DIRECTION.contains(&solid_angle).then_some(solid_angle)
    }
}

/// The solid angle in which a triangle is seen from the origin.
fn solid_angle([p0, p1, p2]: [DVec3; 3]) -> f64 {
    let [a, b, c] = [p0, p1, p2].map(DVec3::length);
    let volume = p0.dot(p1.cross(p2)).abs();
    let rest = a * b * c + p0.dot(p1) * c + p1.dot(p2) * a + p2.dot(p0) * b;
    2.0 * libm::atan2(volume, rest)
}

/// A direction of unit length, uniform over the solid angle in which a triangle is seen from the origin.
fn sample_spherical_triangle(corners: [DVec3; 3], solid_angle: f64, [u0, u1]: [f64; 2]) -> DVec3 {
    let [a, b, c] = corners.map(DVec3::normalize);
    // The angle at a, between the planes through the sides that meet there.
    let (to_b, to_c) = (a.cross(b), a.cross(c));
    let size = to_b.length() * to_c.length();
    let cos_alpha = to_b.dot(to_c) / size;
    let sin_alpha = a.dot(b.cross(c)).abs() / size;

    // The corner that makes a triangle of only part of the area, on the side from a to c.
    let (sin_part, cos_part) = libm::sincos(u0 * solid_angle);
    let sin = sin_part * cos_alpha - cos_part * sin_alpha;
    let cos = cos_part * cos_alpha + sin_part * sin_alpha;
    let x = cos - cos_alpha;
    let y = sin + sin_alpha * a.dot(b);
    let q = ((y * cos - x * sin) * cos_alpha - y) / ((y * sin + x * cos) * sin_alpha);
    let q = if q.is_nan() { 1.0 } else { q.clamp(-1.0, 1.0) };
    let corner = q * a + (1.0 - q * q).max(0.0).sqrt() * off(c, a);

    // A point between b and that corner.
    let z = 1.0 - u1 * (1.0 - corner.dot(b));
    (z * b + (1.0 - z * z).max(0.0).sqrt() * off(corner, b)).normalize()
}

/// The unit vector across `axis` (of unit length) in the plane with `v`.
fn off(v: DVec3, axis: DVec3) -> DVec3 {
    (v - v.dot(axis) * axis).normalize_or_zero()
}

/// β and γ of the triangle's point in a direction from the origin, kept within it.
fn barycentric([p0, p1, p2]: [DVec3; 3], direction: DVec3) -> [f64; 2] {
    let (e1, e2) = (p1 - p0, p2 - p0);
    let across = direction.cross(e2);
    let scale = 1.0 / e1.dot(across);
    let beta = -p0.dot(across) * scale;
    let gamma = direction.dot((-p0).cross(e1)) * scale;
    let beta = beta.clamp(0.0, 1.0);
    [beta, gamma.clamp(0.0, 1.0 - beta)]
}
