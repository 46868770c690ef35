//! Triangles as lights: one is chosen by area, then a direction uniformly over the solid angle in which it is seen.
//!
//! Arvo (1995), "Stratified Sampling of Spherical Triangles"; the solid angle by Van Oosterom & Strackee (1983). Where that
//! is very small or nearly a hemisphere, the point is chosen by area, which is as good there.

use std::sync::Arc;

use glam::{DVec3, Vec3};

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
    /// Of a triangle, by area.
    choice: Discrete,
    area: f64,
}

impl MeshLight {
    /// None for a mesh without area.
    pub fn new(mesh: Arc<Mesh>) -> Option<Self> {
        let areas: Vec<f64> = (0..mesh.triangles.len()).map(|index| mesh.area(index)).collect();
        let area: f64 = areas.iter().filter(|area| area.is_finite()).sum();
        // In parts of the whole, which no unit of length makes vanish.
        let weights: Vec<f32> = areas.iter().map(|own| (own / area) as f32).collect();
        (area > 0.0 && area.is_finite()).then(|| Self { mesh, choice: Discrete::new(&weights), area })
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
        let corners = self.corners_from(from, index);
        if let Some(solid_angle) = worth_direction(corners) {
            let direction = sample_spherical_triangle(corners, solid_angle, [u0, u1].map(f64::from));
            let [beta, gamma] = barycentric(corners, direction);
            let at = self.mesh.point(index, beta as f32, gamma as f32);
            let (wi, _) = toward(from, DVec3::from_array(at.point.position))?;
            let pdf = (f64::from(probability) / solid_angle) as f32;
            return Some(LightPoint { point: at.point, normal: at.ng, uv: at.uv, wi, pdf });
        }
        let [_, beta, gamma] = warp::uniform_triangle([u0, u1]);
        let at = self.mesh.point(index, beta, gamma);
        seen(from, at.point, at.ng, at.uv, self.pdf_by_area(index))
    }

    /// The density over solid angle where points of a triangle are chosen by direction.
    pub(super) fn pdf_by_direction(&self, from: DVec3, index: usize) -> Option<f32> {
        let solid_angle = worth_direction(self.corners_from(from, index))?;
        Some((f64::from(self.choice.pdf(index)) / solid_angle) as f32)
    }

    /// The density over area where points of a triangle are chosen by area.
    pub(super) fn pdf_by_area(&self, index: usize) -> f64 {
        f64::from(self.choice.pdf(index)) / self.mesh.area(index)
    }

    /// A triangle as it is seen from a point.
    fn corners_from(&self, from: DVec3, index: usize) -> [DVec3; 3] {
        self.mesh.corners(index).map(|p| Vec3::from_array(p).as_dvec3() - from)
    }
}

/// The solid angle in which a triangle is seen from the origin, if its points are chosen by direction from there.
fn worth_direction(corners @ [p0, p1, p2]: [DVec3; 3]) -> Option<f64> {
    // Roughly, by the middle: area · cos / distance²; far too small rather than too large for near triangles, so those
    // are told by their size.
    let area_vector = 0.5 * (p1 - p0).cross(p2 - p0);
    let middle = (p0 + p1 + p2) * (1.0 / 3.0);
    let distance2 = middle.length_squared();
    let seems = area_vector.dot(middle).abs() / (distance2 * distance2.sqrt());
    let is_near = distance2 * distance2 < area_vector.length_squared();
    if !(seems > WORTH_DIRECTION || is_near) {
        return None;
    }
    let solid_angle = solid_angle(corners);
    BY_DIRECTION.contains(&solid_angle).then_some(solid_angle)
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
