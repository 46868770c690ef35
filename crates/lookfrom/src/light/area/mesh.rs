//! Triangle mesh lights: a triangle is chosen by area (and by the mean of its emission texture), then a direction
//! uniformly over its solid angle; where that is small or nearly a hemisphere, a point by area, which is as good there.
//! Triangles without emission are not sampled: only a path that hits one finds its light.

mod lanes;
mod spherical_triangle;

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};
pub(crate) use lanes::sample_triangles;
use lookfrom_bvh::Point;
use lookfrom_simd::{Simd, f32x8};
use spherical_triangle::SphericalTriangles;

use super::{AreaDensity, LightPoint, NormalCone, seen};
use crate::core::distribution::Discrete;
use crate::core::lanes::{LANES, by_lane};
use crate::core::parallel;
use crate::core::vector::Vector;
use crate::core::warp;
use crate::light::toward;
use crate::primitive::{Mesh, SurfacePoint};
use crate::shading::texture::TexturePoint;

/// Triangles of a smaller approximate solid angle are sampled by area: distances and angles vary little over them, and
/// sampling by direction would cost more time than the noise that it saves.
const WORTH_DIRECTION: f64 = 0.06;

/// Approximate number of points of a mesh at which its emission texture is evaluated, and the range of their number on
/// each triangle.
const PLACES: usize = 1 << 20;
const PLACES_OF_TRIANGLE: std::ops::RangeInclusive<usize> = 8..=4096;

/// A mesh that emits light.
#[derive(Clone, Debug)]
pub struct MeshLight {
    mesh: Arc<Mesh>,
    /// Indices of the triangles that are sampled, in ascending order; `None` is all.
    asked: Option<Vec<u32>>,
    /// The triangles that are sampled.
    triangles: Vec<Triangle>,
    /// Their distribution, by area and brightness.
    choice: Discrete,
    area: f64,
    /// Whether each triangle has one normal.
    is_flat: bool,
    /// For a textured emitter, the mean of its brightness over the area.
    brightness: Option<f32>,
}

/// A triangle, prepared for sampling points of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    /// In render space.
    pub(crate) corners: [[f32; 3]; 3],
    pub(crate) p0: DVec3,
    pub(crate) e1: DVec3,
    pub(crate) e2: DVec3,
    /// Index in the mesh.
    pub(crate) index: u32,
    /// Outward normal, of unit length; `None` where the mesh's normals flip it within the triangle.
    pub(crate) normal: Option<DVec3>,
    pub(crate) area: f64,
}

impl MeshLight {
    /// The triangle that `u0` chooses, its probability, and the remapped `u0`; only for triangles of one normal.
    #[inline]
    pub(super) fn triangle(&self, u0: f32) -> Option<(&Triangle, f32, f32)> {
        let (index, probability, u0) = self.choice.sample(u0);
        let triangle = &self.triangles[index];
        triangle.normal.is_some().then_some((triangle, probability, u0))
    }

    /// [`MeshLight::triangle`] for eight numbers.
    #[inline(always)]
    pub(super) fn triangles<S: Simd>(
        &self,
        simd: S,
        u0: f32x8<S>,
    ) -> Option<([&Triangle; LANES], f32x8<S>, f32x8<S>)> {
        if !self.is_flat {
            return None;
        }
        let (indices, probability, u0) = self.choice.sample_lanes(simd, u0);
        Some((by_lane!(lane => &self.triangles[indices[lane]]), probability, u0))
    }

    /// A mesh of uniform emission. None for one without area.
    pub fn new(mesh: Arc<Mesh>) -> Option<Self> {
        let area = area(&mesh)?;
        let triangles = triangles(&mesh, mesh.triangles.len(), |index| index);
        // Relative to the whole area, so that no unit of length makes them underflow.
        let weights: Vec<f32> = triangles.iter().map(|triangle| (triangle.area / area) as f32).collect();
        let (choice, is_flat) = (Discrete::new(&weights), is_flat(&triangles));
        Some(Self { choice, asked: None, mesh, triangles, area, is_flat, brightness: None })
    }

    /// A mesh with textured emission, whose brightness at a point is `emission_spectrum`; `origin` is that of render space in the world.
    /// None for one without area.
    pub fn patterned(
        mesh: Arc<Mesh>,
        origin: DVec3,
        emission_spectrum: &(dyn Fn(&TexturePoint) -> f32 + Sync),
    ) -> Option<Self> {
        let area = area(&mesh)?;
        let count = mesh.triangles.len();
        let places = (PLACES / count).clamp(*PLACES_OF_TRIANGLE.start(), *PLACES_OF_TRIANGLE.end());
        let places: Vec<Vec2> = (0..places).map(|k| spread(k, places)).collect();
        let power = |index: usize| {
            let own = mesh.area(index);
            let sum: f64 = places
                .iter()
                .map(|place| brightness((&mesh, origin), index, *place, emission_spectrum))
                .sum();
            if own.is_finite() { own / area * sum / places.len() as f64 } else { 0.0 }
        };
        let powers: Vec<f64> = parallel::collect(count, power);
        let mean: f64 = powers.iter().sum();
        let asked: Vec<u32> = (0..count as u32).filter(|&index| powers[index as usize] > 0.0).collect();
        let weights: Vec<f32> = asked.iter().map(|&index| (powers[index as usize] / mean) as f32).collect();
        let triangles = triangles(&mesh, asked.len(), |rank| asked[rank] as usize);
        // Without triangles the distribution is never used: `sample` returns before.
        let choice = Discrete::new(if weights.is_empty() { &[1.0] } else { &weights });
        let asked = (asked.len() < count).then_some(asked);
        let is_flat = is_flat(&triangles);
        Some(Self { choice, asked, mesh, triangles, area, is_flat, brightness: Some(mean as f32) })
    }

    /// Whether any triangle was found to emit light.
    pub(super) fn is_sampled(&self) -> bool {
        !self.triangles.is_empty()
    }

    /// For a textured emitter, the mean of its brightness over the area.
    pub(super) fn brightness(&self) -> Option<f32> {
        self.brightness
    }

    pub(super) fn area(&self) -> f64 {
        self.area
    }

    /// Bounds of the triangles that are sampled.
    pub(super) fn bounds(&self) -> [DVec3; 2] {
        let vertices = self.triangles.iter().flat_map(|triangle| self.mesh.corners(triangle.index as usize));
        vertices
            .map(|p| Vec3::from_array(p).as_dvec3())
            .fold([DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY)], |[min, max], p| {
                [min.min(p), max.max(p)]
            })
    }

    /// The cone of the normals, at all corners of all triangles that have an area.
    pub(super) fn normals(&self) -> NormalCone {
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)];
        let triangles = (0..self.triangles.len()).filter(|&rank| self.choice.pdf(rank) > 0.0);
        let triangles = triangles.map(|rank| self.triangles[rank].index as usize);
        NormalCone::around(triangles.flat_map(|index| corners.map(|(u, v)| self.mesh.point(index, u, v).ng)))
    }

    /// The index of a triangle of the mesh among those that are sampled.
    fn rank(&self, index: usize) -> Option<usize> {
        match &self.asked {
            None => Some(index),
            Some(asked) => asked.binary_search(&(index as u32)).ok(),
        }
    }

    /// The texture point of a point of a triangle, completed by its vertex data.
    pub(super) fn with_vertices<'a>(
        &self,
        at: TexturePoint<'a>,
        index: u32,
        place: Vec2,
    ) -> TexturePoint<'a> {
        self.mesh.completed(at, index as usize, place.x, place.y)
    }

    /// The shading normal at a point of a triangle.
    pub(super) fn shading_normal(&self, index: u32, place: Vec2) -> DVec3 {
        self.mesh.point(index as usize, place.x, place.y).ns
    }

    pub(super) fn sample(&self, from: DVec3, [u0, u1]: [f32; 2]) -> Option<LightPoint> {
        let (rank, probability, u0) = self.choice.sample(u0);
        let triangle = self.triangles.get(rank)?;
        if let Some((spherical, solid_angle)) = triangle.worth_direction(from) {
            let place = Vec2::from_array(spherical.sample([u0, u1]));
            let (point, normal, uv) = self.point(triangle, place);
            let (wi, _) = toward(from, DVec3::from_array(point.position))?;
            let pdf = (f64::from(probability) / solid_angle) as f32;
            return Some(LightPoint {
                point,
                normal,
                uv,
                primitive: triangle.index,
                on_primitive: place,
                wi,
                pdf,
            });
        }
        let [_, beta, gamma] = warp::uniform_triangle([u0, u1]);
        let place = Vec2::new(beta, gamma);
        let (point, normal, uv) = self.point(triangle, place);
        let seen = seen(from, point, normal, uv, f64::from(probability) / triangle.area)?;
        Some(LightPoint { primitive: triangle.index, on_primitive: place, ..seen })
    }

    /// A point of a triangle, the outward normal and the texture coordinates.
    fn point(&self, triangle: &Triangle, Vec2 { x: beta, y: gamma }: Vec2) -> (Point, DVec3, Vec2) {
        let index = triangle.index as usize;
        let Some(normal) = triangle.normal else {
            let at = self.mesh.point(index, beta, gamma);
            return (at.point, at.ng, at.uv);
        };
        let [p0, p1, p2] = self.mesh.corners(index);
        let uvs = self.mesh.corner_uvs(index);
        let uv = (1.0 - beta - gamma) * uvs[0] + beta * uvs[1] + gamma * uvs[2];
        (Point::on_triangle(p0, p1, p2, beta, gamma), normal, uv)
    }

    /// The solid angle density where a triangle is sampled by direction; `None` where it is sampled by area.
    pub(super) fn pdf_by_direction(&self, from: DVec3, index: usize) -> Option<f32> {
        let rank = self.rank(index)?;
        let (_, solid_angle) = self.triangles[rank].worth_direction(from)?;
        Some((f64::from(self.choice.pdf(rank)) / solid_angle) as f32)
    }

    /// The operands of the density at a point of the mesh: those of the triangle that it is nearest to the plane of, and within.
    pub(super) fn density(&self, from: DVec3, point: DVec3) -> AreaDensity {
        let off = |triangle: &Triangle| {
            let (to, n) = (point - triangle.p0, triangle.e1.cross(triangle.e2));
            let size = n.length_squared();
            let (beta, gamma) = (to.cross(triangle.e2).dot(n) / size, triangle.e1.cross(to).dot(n) / size);
            let outside =
                [beta, gamma, 1.0 - beta - gamma].map(|weight| (-weight).max(0.0)).iter().sum::<f64>();
            to.dot(n).abs() / size.sqrt() + outside * size.sqrt().sqrt()
        };
        let by_distance = |a: &(usize, f64), b: &(usize, f64)| a.1.total_cmp(&b.1);
        let nearest = self.triangles.iter().map(off).enumerate().min_by(by_distance);
        let (rank, _) = nearest.unwrap_or_default();
        let triangle = &self.triangles[rank];
        let probability = f64::from(self.choice.pdf(rank));
        let corners = [triangle.p0, triangle.p0 + triangle.e1, triangle.p0 + triangle.e2];
        match triangle.worth_direction(from) {
            Some((_, solid_angle)) => AreaDensity::SolidAngle { solid_angle, probability, corners },
            None => AreaDensity::Area { area: triangle.area, probability, corners: Some(corners) },
        }
    }

    /// The area density where a triangle is sampled by area; 0 where it is not sampled.
    pub(super) fn pdf_by_area(&self, index: usize) -> f64 {
        self.rank(index).map_or(0.0, |rank| f64::from(self.choice.pdf(rank)) / self.triangles[rank].area)
    }
}

/// The area of a mesh; `None` where there is none.
fn area(mesh: &Mesh) -> Option<f64> {
    let areas = (0..mesh.triangles.len()).map(|index| mesh.area(index));
    let area: f64 = areas.filter(|area| area.is_finite()).sum();
    (area > 0.0 && area.is_finite()).then_some(area)
}

fn triangles(mesh: &Mesh, count: usize, index: impl Fn(usize) -> usize + Sync + Send) -> Vec<Triangle> {
    parallel::collect(count, |rank| Triangle::new(mesh, index(rank)))
}

fn is_flat(triangles: &[Triangle]) -> bool {
    triangles.iter().all(|triangle| triangle.normal.is_some())
}

/// Point number `k` of `count` well-distributed points of a triangle (Hammersley's points).
fn spread(k: usize, count: usize) -> Vec2 {
    let u = (k as f32 + 0.5) / count as f32;
    let v = ((k as u32).reverse_bits() >> 8) as f32 * (1.0 / 16_777_216.0) + 0.5 / count as f32;
    let [_, beta, gamma] = warp::uniform_triangle([u, v]);
    Vec2::new(beta, gamma)
}

/// The brightness of an emission texture at a point of a triangle.
fn brightness(
    (mesh, origin): (&Mesh, DVec3),
    index: usize,
    place: Vec2,
    emission_spectrum: &(dyn Fn(&TexturePoint) -> f32 + Sync),
) -> f64 {
    let uvs = mesh.corner_uvs(index);
    let uv = (1.0 - place.x - place.y) * uvs[0] + place.x * uvs[1] + place.y * uvs[2];
    let SurfacePoint { point, ng, .. } = mesh.point(index, place.x, place.y);
    let world = origin + DVec3::from_array(point.position);
    let at = TexturePoint { uv, world, n: ng.as_vec3(), ..TexturePoint::NOWHERE };
    let at = mesh.completed(at, index, place.x, place.y);
    f64::from(emission_spectrum(&at).max(0.0))
}

impl Triangle {
    fn new(mesh: &Mesh, index: usize) -> Self {
        let corners = mesh.corners(index);
        let [p0, p1, p2] = corners.map(|p| Vec3::from_array(p).as_dvec3());
        let (e1, e2) = (p1 - p0, p2 - p0);
        // Where the sides of all three corners agree, so does the whole triangle.
        let normals = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(u, v)| mesh.point(index, u, v).ng);
        let agree = normals[1..].iter().all(|ng| ng.dot(normals[0]) > 0.0);
        let normal = agree.then_some(normals[0]);
        Self { corners, p0, e1, e2, index: index as u32, normal, area: mesh.area(index) }
    }

    /// The triangle as seen from a point and its solid angle, if it is sampled by direction from there.
    fn worth_direction(&self, from: DVec3) -> Option<(SphericalTriangles<f32>, f64)> {
        // Approximate solid angle, by the centroid: area · cos / distance²; near triangles are recognised by distance²
        // < area. A triangle without a single normal is treated as if it faced the point.
        let middle = self.p0 - from + (self.e1 + self.e2) * (1.0 / 3.0);
        let distance2 = middle.length_squared();
        let facing = self.normal.map_or(distance2.sqrt(), |normal| normal.dot(middle).abs());
        let seems = self.area * facing / (distance2 * distance2.sqrt());
        if !(seems > WORTH_DIRECTION || distance2 < self.area) {
            return None;
        }
        let p0 = self.p0 - from;
        let corners = [p0, p0 + self.e1, p0 + self.e2].map(|p| Vector::new(p.x, p.y, p.z));
        let triangle = SphericalTriangles::<f32>::new(corners);
        let (solid_angle, is_usable) = triangle.solid_angle();
        is_usable.then_some((triangle, solid_angle))
    }
}
