//! Bilinear patch lights: sampled by area.
//!
//! u and v are sampled with the bilinear interpolant of the area element at the patch's four corners (Pharr, Jakob,
//! Humphreys, Physically Based Rendering); the area density accounts for its deviation from the true area element.

use std::sync::Arc;

use glam::{DVec3, Vec2};

use lookfrom_bvh::{Procedural, Ray};

use super::{AreaDensity, LightPoint, NormalCone, seen};
use crate::core::distribution::Discrete;
use crate::primitive::Patches;

/// Bilinear patches that emit light.
#[derive(Clone, Debug)]
pub struct PatchLight {
    patches: Arc<Patches>,
    /// Distribution of the patches, by area.
    choice: Discrete,
    area: f64,
}

impl PatchLight {
    /// None for patches without area.
    pub fn new(patches: Arc<Patches>) -> Option<Self> {
        let areas: Vec<f64> = (0..patches.patches.len()).map(|index| patches.area(index)).collect();
        let area: f64 = areas.iter().filter(|area| area.is_finite()).sum();
        let weights: Vec<f32> = areas.iter().map(|own| (own / area) as f32).collect();
        (area > 0.0 && area.is_finite()).then(|| Self { patches, choice: Discrete::new(&weights), area })
    }

    pub(super) fn area(&self) -> f64 {
        self.area
    }

    pub(super) fn bounds(&self) -> [DVec3; 2] {
        let corners = (0..self.patches.patches.len()).flat_map(|index| self.patches.corners(index));
        corners.fold([DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY)], |[min, max], p| {
            [min.min(p), max.max(p)]
        })
    }

    /// The cone of the normals: those of each patch lie between those at its corners.
    pub(super) fn normals(&self) -> NormalCone {
        let patches = (0..self.patches.patches.len()).filter(|&index| self.choice.pdf(index) > 0.0);
        NormalCone::around(patches.flat_map(|index| {
            [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(u, v)| self.patches.normal(index, u, v))
        }))
    }

    pub(super) fn sample(&self, from: DVec3, [u0, u1]: [f32; 2]) -> Option<LightPoint> {
        let (index, _, u0) = self.choice.sample(u0);
        let [w00, w10, w01, w11] = self.stretches(index);
        let v = sample_linear(f64::from(u1), w00 + w10, w01 + w11);
        let u = sample_linear(f64::from(u0), w00 + v * (w01 - w00), w10 + v * (w11 - w10));
        let place = Vec2::new(u as f32, v as f32);
        let at = self.patches.point(index, place.x, place.y);
        seen(from, at.point, at.ng, at.uv, self.pdf_by_area((index, place)))
    }

    /// The area density at (u, v) of a patch.
    pub(super) fn pdf_by_area(&self, (index, place): (usize, Vec2)) -> f64 {
        let (u, v) = (f64::from(place.x), f64::from(place.y));
        let [w00, w10, w01, w11] = self.stretches(index);
        let low = w00 + u * (w10 - w00);
        let high = w01 + u * (w11 - w01);
        let density = 4.0 * (low + v * (high - low)) / (w00 + w10 + w01 + w11);
        f64::from(self.choice.pdf(index)) * density / self.patches.area_vector(index, u, v).length()
    }

    /// The operands of the density at a point of the patches, seen from another: those of the nearest patch on the way there.
    pub(super) fn density(&self, from: DVec3, point: DVec3) -> AreaDensity {
        let (origin, direction) = (from.as_vec3().to_array(), (point - from).as_vec3().to_array());
        // A ray may meet a patch twice.
        let ray = Ray { t_min: 0.999, ..Ray::new(origin, direction).with_t_max(1.001) };
        let hits = (0..self.patches.patches.len()).filter_map(|index| {
            let hit = self.patches.intersect(index as u32, &ray)?;
            Some((index, hit))
        });
        let off = |t: f32| (t - 1.0).abs();
        let nearest = hits.min_by(|(_, a), (_, b)| off(a.t).total_cmp(&off(b.t)));
        let (index, [u, v]) = nearest.map_or((0, [0.5; 2]), |(index, hit)| (index, [hit.u, hit.v]));
        let place = [u, v].map(f64::from);
        AreaDensity::Patch {
            probability: f64::from(self.choice.pdf(index)),
            place,
            corners: self.stretches(index),
            here: self.patches.area_vector(index, place[0], place[1]).length(),
        }
    }

    /// The area element `|∂p/∂u × ∂p/∂v|` at the corners.
    fn stretches(&self, index: usize) -> [f64; 4] {
        [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)]
            .map(|(u, v)| self.patches.area_vector(index, u, v).length())
    }
}

/// A number in [0, 1] whose density is linear, in proportion to `a` at 0 and `b` at 1.
fn sample_linear(u: f64, a: f64, b: f64) -> f64 {
    if u == 0.0 && a == 0.0 {
        return 0.0;
    }
    let x = u * (a + b) / (a + (a * a + u * (b * b - a * a)).max(0.0).sqrt());
    if x.is_finite() { x.min(1.0) } else { u }
}
