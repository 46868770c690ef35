//! Shapes of the caller's own that several tests use.

use lookfrom_bvh::{Aabb, Procedural, ProceduralHit, Ray};

/// Squares across the z axis, as shapes of the caller's own.
#[derive(Clone, Debug)]
pub(crate) struct Squares(pub(crate) Vec<([f32; 3], f32)>);

impl Procedural for Squares {
    fn count(&self) -> u32 {
        self.0.len() as u32
    }
    fn bounds(&self, primitive: u32) -> Aabb {
        let ([x, y, z], r) = self.0[primitive as usize];
        Aabb { min: [x - r, y - r, z], max: [x + r, y + r, z] }
    }
    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<ProceduralHit> {
        let (center, r) = self.0[primitive as usize];
        let t = (center[2] - ray.origin[2]) / ray.direction[2];
        let inside = (0..2).all(|i| (ray.origin[i] + t * ray.direction[i] - center[i]).abs() <= 0.999 * r);
        (inside && t > ray.t_min && t < ray.t_max).then_some(ProceduralHit { t, u: 0.5, v: 0.25 })
    }
}
