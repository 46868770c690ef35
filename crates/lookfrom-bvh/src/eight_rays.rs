//! Eight rays side by side, as shapes of the caller's meet them.

use crate::ray::Ray;

/// Eight rays, component by component: ray i has the numbers at i.
///
/// ```
/// use lookfrom_bvh::{EightRays, Ray};
/// let ray = Ray::new([1.0, 2.0, 3.0], [0.0, 0.0, -1.0]);
/// let rays = EightRays::from([ray; 8]);
/// assert_eq!((rays.origin[1], rays.ray(7)), ([2.0; 8], ray));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EightRays {
    /// x, y and z of [`Ray::origin`].
    pub origin: [[f32; 8]; 3],
    /// [`Ray::t_min`] of each.
    pub t_min: [f32; 8],
    /// x, y and z of [`Ray::direction`].
    pub direction: [[f32; 8]; 3],
    /// [`Ray::t_max`] of each.
    pub t_max: [f32; 8],
}

impl EightRays {
    /// One of them.
    ///
    /// # Panics
    /// From 8 on.
    #[inline]
    pub fn ray(&self, index: usize) -> Ray {
        let ([ox, oy, oz], [dx, dy, dz]) = (&self.origin, &self.direction);
        Ray {
            origin: [ox[index], oy[index], oz[index]],
            t_min: self.t_min[index],
            direction: [dx[index], dy[index], dz[index]],
            t_max: self.t_max[index],
        }
    }
}

impl From<[Ray; 8]> for EightRays {
    fn from(rays: [Ray; 8]) -> Self {
        let axes = [0, 1, 2];
        Self {
            origin: axes.map(|axis| rays.map(|ray| ray.origin[axis])),
            t_min: rays.map(|ray| ray.t_min),
            direction: axes.map(|axis| rays.map(|ray| ray.direction[axis])),
            t_max: rays.map(|ray| ray.t_max),
        }
    }
}
