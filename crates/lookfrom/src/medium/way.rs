//! Ways: parts of rays in media.

use glam::Vec3;
use lookfrom_bvh::Ray;

use crate::core::hash;

/// A part of a ray in a medium.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way {
    /// In render space.
    pub(crate) origin: Vec3,
    /// The direction, of unit length.
    pub(crate) direction: Vec3,
    pub(crate) length: f32,
}

impl Way {
    /// The ray as far as a distance.
    pub(crate) fn new(ray: &Ray, length: f32) -> Self {
        let direction = Vec3::from_array(ray.direction).normalize();
        Self { origin: Vec3::from_array(ray.origin), direction, length }
    }

    /// A hash, from which random numbers along it may come.
    pub(crate) fn hash(&self) -> u64 {
        let bits = |a: f32, b: f32| u64::from(a.to_bits()) << 32 | u64::from(b.to_bits());
        let [o, d] = [self.origin, self.direction];
        hash::pair(hash::pair(bits(o.x, o.y), bits(o.z, d.x)), bits(d.y, d.z))
    }
    /// A number in [0, 1) of it, a multiple of 2⁻²⁴.
    pub(crate) fn number(&self) -> f32 {
        (hash::mix(self.hash()) >> 40) as f32 * (1.0 / 16_777_216.0)
    }
}
