//! Quadric lights: spheres, cylinders, disks and their parts, and tori.
//!
//! A whole sphere is sampled by direction, in a file of its own, a whole disk as any disk. Parts are sampled by area in
//! object space, which the map to render space changes by a factor that depends on the point.

mod sphere;

use glam::{DVec3, Vec3};
pub(crate) use sphere::{SphereLights, gather_spheres};

use super::{DiskLights, LightPoint, NormalCone, seen};
use crate::primitive::{Disk, MaterialBinding, Quadric, QuadricKind};

/// A quadric that emits light.
#[derive(Clone, Debug)]
pub struct QuadricLight {
    quadric: Quadric,
    area: f64,
    whole: Option<Whole>,
}

/// The whole sphere or disk that a quadric is.
#[derive(Clone, Debug)]
enum Whole {
    Sphere(SphereLights<f32>),
    Disk(DiskLights<f32>),
}

impl QuadricLight {
    /// None for a quadric without area. `two_sided` where both sides emit light.
    pub fn new(quadric: Quadric, two_sided: bool) -> Option<Self> {
        let area = quadric.area();
        let whole = match quadric.kind {
            QuadricKind::Sphere { radius, .. } if quadric.is_whole_sphere() => {
                Some(Whole::Sphere(SphereLights {
                    frames: *quadric.frame(),
                    radius,
                    volume_scale: quadric.volume_scale(),
                    shines_inward: quadric.reverse || two_sided,
                }))
            }
            QuadricKind::Disk { height, radius, .. } if quadric.is_whole_disk() => {
                whole_disk(&quadric, height, radius).map(Whole::Disk)
            }
            _ => None,
        };
        (area > 0.0 && area.is_finite()).then_some(Self { quadric, area, whole })
    }

    pub(super) fn area(&self) -> f64 {
        self.area
    }

    pub(super) fn bounds(&self) -> [DVec3; 2] {
        self.quadric.bounds()
    }

    pub(super) fn normals(&self) -> NormalCone {
        match self.quadric.kind {
            QuadricKind::Disk { .. } | QuadricKind::Rectangle { .. } => {
                let at = self.quadric.point(self.quadric.sample_in_object([0.5; 2]), MaterialBinding::NONE);
                NormalCone { axis: at.ng, cos: 1.0 }
            }
            QuadricKind::Sphere { .. } | QuadricKind::Cylinder { .. } | QuadricKind::Torus(_) => {
                NormalCone::ALL
            }
        }
    }

    pub(super) fn sample(&self, from: DVec3, u: [f32; 2]) -> Option<LightPoint> {
        let uv = |on_quadric| self.quadric.uv(on_quadric);
        match &self.whole {
            Some(Whole::Sphere(sphere)) => {
                let (samples, in_object) = sphere.sample(from.into(), u);
                samples.light_point(|| uv(in_object.into()))
            }
            Some(Whole::Disk(disk)) => {
                let (samples, _) = disk.sample(from.into(), u);
                samples.light_point(|| uv(self.quadric.sample_in_object(u)))
            }
            None => {
                let on_quadric = self.quadric.sample_in_object(u);
                let at = self.quadric.point(on_quadric, MaterialBinding::NONE);
                let density = self.pdf_by_area(DVec3::from_array(at.point.position));
                seen(from, at.point, at.ng, at.uv, density)
            }
        }
    }

    /// The solid angle density where the quadric is sampled by direction.
    pub(super) fn pdf_by_direction(&self, from: DVec3, wi: Vec3) -> Option<f32> {
        Some(self.sphere()?.pdf(from.into(), wi.into()))
    }

    /// A whole sphere, which is sampled by direction; `None` for other quadrics.
    #[inline]
    pub(super) fn sphere(&self) -> Option<&SphereLights<f32>> {
        match &self.whole {
            Some(Whole::Sphere(sphere)) => Some(sphere),
            _ => None,
        }
    }

    /// A whole disk; `None` for other quadrics.
    #[inline]
    pub(super) fn disk(&self) -> Option<&DiskLights<f32>> {
        match &self.whole {
            Some(Whole::Disk(disk)) => Some(disk),
            _ => None,
        }
    }

    /// The radius and the distance of the centre of a whole sphere that is round in render space and seen from outside.
    pub(super) fn cone(&self, from: DVec3) -> Option<(f64, f64)> {
        let sphere = self.sphere()?;
        let radii = DVec3::AXES.map(|axis| self.quadric.vector_in_render(sphere.radius * axis).length());
        let center = self.quadric.point_in_render(DVec3::ZERO);
        let (radius, distance) = (radii[0], center.distance(from));
        let is_round = radii.iter().all(|other| (other - radius).abs() <= 1e-9 * radius);
        (is_round && distance > radius).then_some((radius, distance))
    }

    /// The area density, in render space, where the quadric is sampled by area.
    pub(super) fn pdf_by_area(&self, p: DVec3) -> f64 {
        1.0 / (self.quadric.object_area() * self.quadric.area_scale(self.quadric.point_in_object(p)))
    }
}

/// The disk that a quadric is, in render space.
fn whole_disk(quadric: &Quadric, height: f64, radius: f64) -> Option<DiskLights<f32>> {
    let center = quadric.point(DVec3::new(0.0, 0.0, height), MaterialBinding::NONE);
    let [axis_u, axis_v] = [DVec3::X, DVec3::Y].map(|axis| quadric.vector_in_render(radius * axis));
    let disk = Disk {
        center: DVec3::from_array(center.point.position),
        axis_u,
        axis_v,
        flip: axis_u.cross(axis_v).dot(center.ng) < 0.0,
    };
    DiskLights::new(&disk, DVec3::from_array(center.point.error))
}
