//! Coverage of a camera ray: by media, and surfaces that it passes by an alpha between 0 and 1, each by its part.

use glam::Vec3;
use lookfrom_bvh::{Hit, Ray};

use super::RayHit;
use crate::medium::{self, Way};
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::interior_stack::InteriorStack;
use crate::world::World;

/// Number of surfaces of fractional alpha that are looked through.
const MOST_LAYERS: usize = 16;

/// The part of a pixel, left behind surfaces that cover nearly all of it, below which nothing is looked at.
const LEAST_PART: f32 = 1.0 / 256.0;

/// A thing that covers a part of a camera ray.
pub(crate) enum Cover<'a> {
    /// A surface, with its hit.
    Surface { surface: &'a SurfaceInteraction, hit: &'a Hit, opacity: f32 },
    /// A medium, along a way.
    Medium { cover: &'a medium::Cover, way: &'a Way },
}

impl World {
    /// Calls `each` with what covers a camera ray at a time, from the camera on, and the part of the ray that it covers. Media count
    /// if the bodies and the medium are given that the camera is in. Returns the part that nothing covers.
    pub(crate) fn covers(
        &self,
        mut interior: Option<InteriorStack>,
        RayHit { mut ray, mut hit }: RayHit,
        time: f32,
        mut each: impl FnMut(f32, Cover<'_>),
    ) -> f32 {
        let mut left = 1.0;
        for _ in 0..MOST_LAYERS {
            if let Some((way, cover)) = interior.and_then(|interior| self.cover(interior, &ray, &hit)) {
                each(left * cover.part, Cover::Medium { cover: &cover, way: &way });
                left *= 1.0 - cover.part;
            }
            if !hit.is_hit() || left < LEAST_PART {
                break;
            }
            let surface = self.surface_at(&ray, &hit, time);
            let opacity = self.opacity(&surface);
            if opacity > 0.0 {
                each(left * opacity, Cover::Surface { surface: &surface, hit: &hit, opacity });
            }
            left *= 1.0 - opacity;
            if left < LEAST_PART {
                break;
            }
            if self.is_interface(&surface) {
                let direction = Vec3::from(ray.direction);
                interior = interior.map(|of| of.leaving(&self.materials, &surface, direction, true));
            }
            ray = Ray::new(surface.origin(Vec3::from(ray.direction)), ray.direction);
            hit = self.bvh.query().origin(surface.origin_primitive).time(time).closest_hit(&ray);
        }
        left
    }
}
