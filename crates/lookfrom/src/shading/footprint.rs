//! The footprint of pixels on surfaces: how far texture coordinates change from one pixel to the next.
//!
//! An approximation without ray differentials: wherever a path meets a surface, and after any number of bounces, the footprint is
//! the one that the camera's narrowest pixel would have there, if the camera looked at the point, for pixels of many
//! samples. pbrt-v4's `Camera::Approximate_dp_dxy` (Pharr, Jakob & Humphreys 2023, § 10.1.3), at its limit of 64 samples, so
//! that a picture does not depend on how many are taken.

use glam::{DMat3, DVec3, Vec2, Vec3};

use crate::shading::interaction::ShadingGeometry;
use crate::shading::texture::TexturePoint;

/// The distance of samples within a pixel.
const SPACING: f64 = 0.125;

/// The pixels of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelFootprint {
    /// The camera's position in the world.
    pub eye: DVec3,
    /// From the camera's space to the world.
    pub world_from_camera: DMat3,
    /// Its inverse.
    pub camera_from_world: DMat3,
    /// Changes of the origins of rays, from one pixel to the next in x and in y, in a space whose z axis is along the
    /// ray.
    pub origins: [DVec3; 2],
    /// Changes of their directions of unit length.
    pub directions: [DVec3; 2],
}

impl PixelFootprint {
    /// Half of what u and v change by from sample to sample at a point, both at least 0; `None` where that is not defined.
    pub(super) fn half(&self, at: &TexturePoint<'_>, surface: &ShadingGeometry) -> Option<Vec2> {
        let [x, y] = self.on_surface(at.world, surface.ng.as_dvec3())?;
        // Least squares: the change of u and v that moves the point so far along the surface.
        let [dpdu, dpdv] = [surface.dpdu, surface.dpdv].map(Vec3::as_dvec3);
        let [uu, uv, vv] = [dpdu.dot(dpdu), dpdu.dot(dpdv), dpdv.dot(dpdv)];
        let determinant = uu * vv - uv * uv;
        let [by_x, by_y] = [x, y].map(|step| {
            let [along_u, along_v] = [dpdu.dot(step), dpdv.dot(step)];
            [vv * along_u - uv * along_v, uu * along_v - uv * along_u].map(|d| (d / determinant).abs())
        });
        let [u, v] = [0, 1].map(|k| (0.5 * (by_x[k] + by_y[k])) as f32);
        (u.is_finite() && v.is_finite()).then_some(Vec2::new(u, v))
    }

    /// ∂p/∂x and ∂p/∂y of a point of a surface times the spacing of samples, in the world; `None` at the camera itself.
    fn on_surface(&self, world: DVec3, ng: DVec3) -> Option<[DVec3; 2]> {
        let point = self.camera_from_world * (world - self.eye);
        let distance = point.length();
        // The camera's space turned so that its z axis goes through the point.
        let [x, y, z] = axes_toward(point.try_normalize()?);
        let n = self.world_from_camera.transpose() * ng;
        let n = DVec3::new(n.dot(x), n.dot(y), n.dot(z));
        let moved = |k: usize| {
            let direction = DVec3::Z + self.directions[k];
            let t = (n.z * distance - n.dot(self.origins[k])) / n.dot(direction);
            let step = self.origins[k] + direction * t - DVec3::new(0.0, 0.0, distance);
            self.world_from_camera * (x * step.x + y * step.y + z * step.z) * SPACING
        };
        Some([moved(0), moved(1)])
    }
}

/// The axes of a space turned by the shortest way so that its z axis is a direction.
fn axes_toward(z: DVec3) -> [DVec3; 3] {
    // Rodrigues' formula about z₀ × z; half a turn about x, where they are opposite.
    let opposite = 1.0 + z.z;
    if opposite < 1e-12 {
        return [DVec3::X, -DVec3::Y, -DVec3::Z];
    }
    let (xx, xy, yy) = (z.x * z.x / opposite, z.x * z.y / opposite, z.y * z.y / opposite);
    [DVec3::new(1.0 - xx, -xy, -z.x), DVec3::new(-xy, 1.0 - yy, -z.y), z]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A camera at the origin whose pixels are this wide at distance 1.
    fn camera(pixel: f64) -> PixelFootprint {
        PixelFootprint {
            eye: DVec3::ZERO,
            world_from_camera: DMat3::IDENTITY,
            camera_from_world: DMat3::IDENTITY,
            origins: [DVec3::ZERO; 2],
            directions: [DVec3::X * pixel, DVec3::Y * pixel],
        }
    }

    fn wall(ng: Vec3) -> ShadingGeometry {
        let dpdu = Vec3::Y.cross(ng).normalize();
        ShadingGeometry { ng, ns: ng, dpdu: 2.0 * dpdu, dpdv: 4.0 * ng.cross(dpdu), wo: ng, front: true }
    }

    #[test]
    fn axes_are_a_rotation() {
        for z in [DVec3::Z, DVec3::X, DVec3::new(0.3, -0.5, -0.7).normalize(), -DVec3::Z] {
            let [x, y, to] = axes_toward(z);
            assert!((x.cross(y) - to).length() < 1e-14 && (to - z).length() < 1e-14, "{z}");
            assert!((x.length() - 1.0).abs() < 1e-14 && x.dot(z).abs() < 1e-14, "{z}");
        }
    }

    #[test]
    fn it_grows_with_the_distance_and_the_slant() {
        let at = |world: DVec3| TexturePoint { world, ..TexturePoint::NOWHERE };
        // Facing the camera: half an eighth of a pixel, over the length of u and v.
        for distance in [1.0, 100.0] {
            let half = camera(1e-3).half(&at(DVec3::Z * distance), &wall(Vec3::NEG_Z)).unwrap();
            let expected = 0.5 * 0.125 * 1e-3 * distance as f32;
            assert!((half - expected / Vec2::new(2.0, 4.0)).length() < 1e-3 * expected, "{half}");
        }
        // Slanted about the y axis by 60°: twice as long along u.
        let slanted = wall(Vec3::new(0.75_f32.sqrt(), 0.0, -0.5));
        let half = camera(1e-4).half(&at(DVec3::Z), &slanted).unwrap();
        let expected = 0.5 * 0.125 * 1e-4;
        assert!((half.x / (2.0 * expected / 2.0) - 1.0).abs() < 1e-3, "{half}");
        assert!((half.y / (expected / 4.0) - 1.0).abs() < 1e-3, "{half}");
        // In any direction alike.
        let toward = DVec3::new(-2.0, 1.0, -2.0);
        let facing = wall(-toward.normalize().as_vec3());
        let half = camera(1e-3).half(&at(toward), &facing).unwrap();
        assert!((half.x * 2.0 - half.y * 4.0).abs() < 0.3 * half.x, "{half}");
        // None in the camera itself, or where u and v are not independent.
        assert_eq!(camera(1e-3).half(&at(DVec3::ZERO), &slanted), None);
        let flat = ShadingGeometry { dpdv: slanted.dpdu, ..slanted };
        assert_eq!(camera(1e-3).half(&at(DVec3::Z), &flat), None);
    }
}
