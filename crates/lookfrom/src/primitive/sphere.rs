//! Whole spheres, which the kernel intersects itself.

use glam::{DVec3, Mat3, Vec2, Vec3};
use lookfrom_bvh::Point;

use super::quadric::sphere_derivatives;
use super::{MaterialBinding, SurfacePoint};
use crate::shading::texture;

/// Spheres of many shapes.
#[derive(Clone, Debug, Default)]
pub struct Spheres {
    /// In the kernel's form.
    pub spheres: Vec<lookfrom_bvh::Sphere>,
    /// For each sphere, an index into `bindings`.
    pub binding_of: Vec<u32>,
    /// The attributes of spheres, and their orientations.
    pub bindings: Vec<SphereBinding>,
}

/// Attributes shared by the spheres of one shape.
#[derive(Clone, Copy, Debug)]
pub struct SphereBinding {
    /// Its attributes.
    pub binding: MaterialBinding,
    /// The rotation (or reflection) to the shape's own axes, where its poles are on y.
    pub object_from_sphere: Mat3,
    /// Whether the outside is the side of the centre.
    pub flip: bool,
}

impl SphereBinding {
    /// The texture coordinates where a sphere has a normal to the outside.
    #[inline]
    pub(crate) fn uv(&self, ng: Vec3) -> Vec2 {
        let from_center = if self.flip { -ng } else { ng };
        texture::sphere_uv(self.object_from_sphere * from_center)
    }
}

impl Spheres {
    /// The point of a sphere nearest to one that is on it up to errors.
    pub(crate) fn point(&self, index: usize, near: DVec3) -> SurfacePoint {
        let sphere = self.spheres[index];
        let SphereBinding { binding, object_from_sphere, flip } =
            self.bindings[self.binding_of[index] as usize];
        let center = Vec3::from_array(sphere.center).as_dvec3();
        let point = Point::on_sphere(sphere.center, sphere.radius, near.to_array());
        let outward = (DVec3::from_array(point.position) - center).normalize();
        let own = object_from_sphere * outward.as_vec3();
        let uv = texture::sphere_uv(own);

        // The derivatives have their poles on z.
        let on_z =
            f64::from(sphere.radius) * DVec3::new(f64::from(own.x), f64::from(-own.z), f64::from(own.y));
        let full = [-std::f64::consts::PI, 2.0 * std::f64::consts::PI];
        let [dpdu, dpdv] = sphere_derivatives(on_z, f64::from(sphere.radius), full)
            .map(|d| object_from_sphere.as_dmat3().transpose() * DVec3::new(d.x, d.z, -d.y));
        let ng = if flip { -outward } else { outward };
        SurfacePoint::plain(point, ng, uv, [dpdu, dpdv], binding)
    }
}
