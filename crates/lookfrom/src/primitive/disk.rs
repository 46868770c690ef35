//! Disks, possibly sheared to ellipses.

use glam::{DVec3, Vec2, Vec3};
use lookfrom_bvh::{Aabb, Point, Procedural, ProceduralHit, Ray};

use super::{MaterialBinding, SurfacePoint};

/// A disk, possibly sheared to an ellipse: `center + x·axis_u + y·axis_v`, `x² + y² ≤ 1`.
#[derive(Clone, Copy, Debug)]
pub struct Disk {
    /// Centre.
    pub center: DVec3,
    /// From the centre to the rim.
    pub axis_u: DVec3,
    /// From the centre to the rim.
    pub axis_v: DVec3,
    /// Whether the outside is the side of `axis_v × axis_u`, not of `axis_u × axis_v`.
    pub flip: bool,
}

/// Disks of many shapes.
#[derive(Clone, Debug, Default)]
pub struct Disks {
    /// The disks.
    pub disks: Vec<Disk>,
    /// The attributes of each.
    pub bindings: Vec<MaterialBinding>,
}

impl Disk {
    /// The point at `(x, y)` of the disk.
    pub fn at(&self, on_disk: Vec2) -> Point {
        let Vec2 { x, y } = on_disk;
        let (u, v) = (f64::from(x) * self.axis_u, f64::from(y) * self.axis_v);
        // five roundings, each of at most 2⁻⁵³ of the sum of sizes
        let error = (self.center.abs() + u.abs() + v.abs()) * (5.0 * 0.5 * f64::EPSILON);
        Point { position: (self.center + u + v).to_array(), error: error.to_array() }
    }

    /// The outward normal, not of unit length: the disk's area is π times its length.
    pub fn normal(&self) -> DVec3 {
        if self.flip { self.axis_v.cross(self.axis_u) } else { self.axis_u.cross(self.axis_v) }
    }

    /// The box around it.
    pub fn bounds(&self) -> [DVec3; 2] {
        let extent = (self.axis_u * self.axis_u + self.axis_v * self.axis_v).map(f64::sqrt);
        [self.center - extent, self.center + extent]
    }

    /// `(x, y)` of a point in the disk's plane.
    fn coordinates(&self, point: DVec3) -> [f64; 2] {
        let normal = self.axis_u.cross(self.axis_v);
        let q = point - self.center;
        let scale = 1.0 / normal.length_squared();
        [q.cross(self.axis_v).dot(normal) * scale, self.axis_u.cross(q).dot(normal) * scale]
    }
}

impl Disks {
    /// The point of a disk nearest to one that is on it up to errors.
    pub(crate) fn point(&self, index: usize, near: DVec3) -> SurfacePoint {
        let disk = &self.disks[index];
        let [x, y] = disk.coordinates(near);
        let on_disk = Vec2::new(x as f32, y as f32);
        let uv = 0.5 + 0.5 * on_disk;
        let derivatives = [2.0 * disk.axis_u, 2.0 * disk.axis_v];
        SurfacePoint::plain(
            disk.at(on_disk),
            disk.normal().normalize(),
            uv,
            derivatives,
            self.bindings[index],
        )
    }
}

impl Procedural for Disks {
    fn count(&self) -> u32 {
        self.disks.len() as u32
    }

    fn bounds(&self, primitive: u32) -> Aabb {
        let [min, max] = self.disks[primitive as usize].bounds();
        Aabb {
            min: min.to_array().map(|x| (x as f32).next_down()),
            max: max.to_array().map(|x| (x as f32).next_up()),
        }
    }

    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<ProceduralHit> {
        let disk = &self.disks[primitive as usize];
        let [origin, direction] = [ray.origin, ray.direction].map(|v| Vec3::from_array(v).as_dvec3());
        let normal = disk.normal();
        let t = normal.dot(disk.center - origin) / normal.dot(direction);
        if !(t > f64::from(ray.t_min) && t < f64::from(ray.t_max)) {
            return None;
        }
        let [x, y] = disk.coordinates(origin + t * direction);
        (x * x + y * y <= 1.0).then_some(ProceduralHit { t: t as f32, u: x as f32, v: y as f32 })
    }
}
