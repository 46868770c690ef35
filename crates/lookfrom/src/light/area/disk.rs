//! Disk lights (ellipses, after shears), sampled by area, at any width.

use std::f64::consts::PI;

use glam::{DVec3, Vec2};
use lookfrom_simd::{Float, Real, Simd, f32x8, f64x8, prelude::*};

use super::{AreaSamples, LightPoint, NormalCone, toward_all};
use crate::core::lanes::{LANES, by_lane, gather_f64};
use crate::core::points::Points;
use crate::core::vector::Vector;
use crate::core::warp;
use crate::primitive::Disk;

type Wide<R> = <R as Real>::Double;

/// A disk that emits light.
#[derive(Clone, Copy, Debug)]
pub struct DiskLight {
    disk: Disk,
    sampled: DiskLights<f32>,
}

impl DiskLight {
    /// None for a disk without area.
    pub fn new(disk: Disk) -> Option<Self> {
        Some(Self { disk, sampled: DiskLights::new(&disk, DVec3::ZERO)? })
    }

    pub(super) fn area(&self) -> f64 {
        self.sampled.area
    }

    pub(super) fn bounds(&self) -> [DVec3; 2] {
        self.disk.bounds()
    }

    pub(super) fn normals(&self) -> NormalCone {
        NormalCone { axis: self.sampled.normal.into(), cos: 1.0 }
    }

    pub(super) fn sample(&self, from: DVec3, u: [f32; 2]) -> Option<LightPoint> {
        let (samples, [x, y]) = self.sampled.sample(from.into(), u);
        samples.light_point(|| 0.5 + 0.5 * Vec2::new(x, y))
    }

    /// The numbers for sampling in lanes.
    #[inline]
    pub(super) fn in_lanes(&self) -> &DiskLights<f32> {
        &self.sampled
    }
}

/// Disks: `center + x·axis_u + y·axis_v`, `x² + y² ≤ 1`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DiskLights<R: Real> {
    center: Vector<Wide<R>>,
    axes: [Vector<Wide<R>>; 2],
    /// Bounds of the rounding errors of the centre.
    error: Vector<Wide<R>>,
    /// Outward, of unit length.
    normal: Vector<Wide<R>>,
    pub(super) area: Wide<R>,
}

impl DiskLights<f32> {
    /// None for a disk without area. `error` bounds that of the disk's centre.
    pub(super) fn new(disk: &Disk, error: DVec3) -> Option<Self> {
        let normal = disk.normal();
        let area = PI * normal.length();
        (area > 0.0 && area.is_finite()).then(|| Self {
            center: disk.center.into(),
            axes: [disk.axis_u.into(), disk.axis_v.into()],
            error: error.into(),
            normal: normal.normalize().into(),
            area,
        })
    }
}

impl<R: Real> DiskLights<R> {
    /// Points uniform over the disks, as seen from `from`, and the same points as `(x, y)` of the disks; `u ∈ [0, 1)²`.
    #[inline(always)]
    pub(crate) fn sample(&self, from: Vector<Wide<R>>, u: [R; 2]) -> (AreaSamples<R>, [R; 2]) {
        let on_disk @ [x, y] = warp::concentric_disk(u);
        let [along_u, along_v] = [self.axes[0] * x.widen(), self.axes[1] * y.widen()];
        let position = self.center + along_u + along_v;
        // Five roundings, each of at most 2⁻⁵³ of the sum of sizes.
        let size = self.center.abs() + along_u.abs() + along_v.abs();
        let error = size * self.area.like(5.0 * 0.5 * f64::EPSILON) + self.error;
        let (wi, distance) = toward_all(from, position);
        let cosine = Float::abs(self.normal.dot(wi.widen()));
        let pdf = R::narrow(distance * distance / (self.area * cosine));
        (AreaSamples::new(Points { position, error }, self.normal, (wi, distance), pdf), on_disk)
    }
}

/// One disk in each lane.
#[inline(always)]
pub(crate) fn gather_disks<S: Simd>(simd: S, rows: &[&DiskLights<f32>; LANES]) -> DiskLights<f32x8<S>> {
    DiskLights {
        center: gather_f64(simd, &by_lane!(lane => rows[lane].center.into())),
        axes: [
            gather_f64(simd, &by_lane!(lane => rows[lane].axes[0].into())),
            gather_f64(simd, &by_lane!(lane => rows[lane].axes[1].into())),
        ],
        error: gather_f64(simd, &by_lane!(lane => rows[lane].error.into())),
        normal: gather_f64(simd, &by_lane!(lane => rows[lane].normal.into())),
        area: f64x8::load_array(simd, by_lane!(lane => rows[lane].area)),
    }
}
