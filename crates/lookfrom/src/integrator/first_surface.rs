//! The surfaces that camera rays meet, as far as AOVs and the denoiser need them.
//!
//! A step that has one at hand leaves it; others are evaluated after the batch.

use glam::{DVec3, Vec2, Vec3};

use crate::shading::interaction::SurfaceInteraction;
use crate::shading::material;
use crate::world::World;

/// A surface, where a camera ray met it. In render space; normals are of unit length, on either side.
#[derive(Clone, Copy, Debug)]
pub struct FirstSurface {
    /// Position.
    pub position: DVec3,
    /// Geometric normal.
    pub ng: Vec3,
    /// Shading normal, with bump and normal maps.
    pub ns: Vec3,
    /// The direction to the camera, of unit length.
    pub wo: Vec3,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Linear Rec. 709: see [`material::albedo`].
    pub albedo: [f32; 3],
}

impl FirstSurface {
    /// That of a surface interaction.
    pub(crate) fn of(world: &World, surface: &SurfaceInteraction) -> Self {
        let point = world.texture_point(surface);
        let World { materials, textures, .. } = world;
        Self {
            position: DVec3::from_array(surface.point.position),
            ng: surface.ng.as_vec3(),
            ns: material::normal(materials, textures, surface, &point),
            wo: surface.wo,
            uv: surface.uv,
            albedo: material::albedo(materials, textures, &materials[surface.material as usize], &point),
        }
    }
}
