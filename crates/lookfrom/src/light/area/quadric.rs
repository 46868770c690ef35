//! Quadric lights: spheres, cylinders, disks and their parts.
//!
//! A whole sphere is sampled by direction, in a file of its own. Parts are sampled by area in object space, which the map
//! to render space changes by a factor that depends on the point.

mod sphere;

use glam::{DVec3, Vec2, Vec3};
use lookfrom_bvh::Point;
pub(crate) use sphere::{SphereLights, gather_spheres};

use super::{AreaSamples, Cone, LightPoint, seen};
use crate::primitive::{MaterialBinding, Quadric, QuadricKind};

/// Number of cells along u and v in the numerical integration of the area of a non-uniformly scaled quadric.
const CELLS: u32 = 64;

/// A quadric that emits light.
#[derive(Clone, Debug)]
pub struct QuadricLight {
    quadric: Quadric,
    area: f64,
    /// The whole sphere that it is, if it is one.
    sphere: Option<SphereLights<f32>>,
}

impl QuadricLight {
    /// None for a quadric without area. `two_sided` where both sides emit light.
    pub fn new(quadric: Quadric, two_sided: bool) -> Option<Self> {
        // The mean of the factor by which the map changes area, over points uniform in object space.
        let mean = || {
            let cell = |i: u32| (i as f32 + 0.5) / CELLS as f32;
            let place = |k: u32| quadric.sample_in_object([cell(k % CELLS), cell(k / CELLS)]);
            (0..CELLS * CELLS).map(|k| quadric.area_scale(place(k))).sum::<f64>() / f64::from(CELLS * CELLS)
        };
        let area = quadric.object_area() * quadric.even_area_scale().unwrap_or_else(mean);
        let sphere = match quadric.kind {
            QuadricKind::Sphere { radius, .. } if quadric.is_whole_sphere() => Some(SphereLights {
                frames: *quadric.frame(),
                radius,
                volume_scale: quadric.volume_scale(),
                shines_inward: quadric.reverse || two_sided,
            }),
            _ => None,
        };
        (area > 0.0 && area.is_finite()).then_some(Self { quadric, area, sphere })
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
                let at = self.quadric.point(self.quadric.sample_in_object([0.5; 2]), MaterialBinding::NONE);
                Cone { axis: at.ng, cos: 1.0 }
            }
            QuadricKind::Sphere { .. } | QuadricKind::Cylinder { .. } => Cone::ALL,
        }
    }

    pub(super) fn sample(&self, from: DVec3, u: [f32; 2]) -> Option<LightPoint> {
        let Some(sphere) = &self.sphere else {
            let on_quadric = self.quadric.sample_in_object(u);
            let at = self.quadric.point(on_quadric, MaterialBinding::NONE);
            let density = self.pdf_by_area(DVec3::from_array(at.point.position));
            return seen(from, at.point, at.ng, at.uv, density);
        };
        let (AreaSamples { points, normal, wi, pdf, is_valid }, in_object) = sphere.sample(from.into(), u);
        is_valid.then(|| LightPoint {
            point: Point { position: points.position.into(), error: points.error.into() },
            normal: normal.into(),
            uv: self.quadric.coordinates(in_object.into()).0,
            primitive: 0,
            on_primitive: Vec2::ZERO,
            wi: wi.into(),
            pdf,
        })
    }

    /// The solid angle density where the quadric is sampled by direction.
    pub(super) fn pdf_by_direction(&self, from: DVec3, wi: Vec3) -> Option<f32> {
        Some(self.sphere.as_ref()?.pdf(from.into(), wi.into()))
    }

    /// A whole sphere, which is sampled by direction; `None` for other quadrics.
    #[inline]
    pub(super) fn sphere(&self) -> Option<&SphereLights<f32>> {
        self.sphere.as_ref()
    }

    /// The area density, in render space, where the quadric is sampled by area.
    pub(super) fn pdf_by_area(&self, p: DVec3) -> f64 {
        1.0 / (self.quadric.object_area() * self.quadric.area_scale(self.quadric.point_in_object(p)))
    }
}
