//! Single-sided surfaces that face inward: rooms without a front wall, domes, models that were turned inside out.
//!
//! Rays from the camera pass the backs of single-sided surfaces, so they see the far inner sides. Light has to get there, too,
//! as in programs that draw only the fronts of triangles: else these models are black. So half of it passes each wall from
//! behind, and half of what comes from inside is stopped there: a white room in even light is as bright as the light.

use std::sync::Arc;

use glam::Vec3;
use lookfrom_bvh::Ray;

use super::World;
use crate::core::warp;
use crate::primitive::Primitives;
use crate::shading::interaction::SurfaceInteraction;

/// The square root of the number of directions from which the scene is seen.
const AROUND: u32 = 12;

/// The fraction of backs among what is seen from which on a scene faces inward.
const MOSTLY: f32 = 0.65;

impl World {
    /// The fraction of light that an open front stops.
    pub(crate) const COVERAGE_OF_OPEN_FRONTS: f32 = 0.5;

    /// Whether rays of light, which do not come straight from the camera, pass a surface in part: they came to the front of a
    /// single-sided one in a scene that mostly faces inward.
    pub(crate) fn is_open_front(&self, surface: &SurfaceInteraction) -> bool {
        self.has_open_fronts && surface.single_sided && surface.front
    }

    /// Whether any surface is single-sided.
    pub(crate) fn has_single_sides(&self) -> bool {
        let objects = self.objects.iter().flatten();
        self.primitives.iter().chain(objects).any(|primitives| match primitives {
            Primitives::Mesh(mesh) => mesh.binding.single_sided,
            _ => false,
        })
    }

    /// Whether most of what is seen of the scene from outside are the backs of single-sided surfaces.
    pub(super) fn faces_inward(&self) -> bool {
        if !self.has_single_sides() {
            return false;
        }
        let bounds = self.bvh.bounds();
        let [min, max] = [bounds.min, bounds.max].map(Vec3::from);
        let (center, half) = ((min + max) * 0.5, (max - min) * 0.5);
        let [mut backs, mut seen] = [0.0, 0.0];
        for cell in 0..AROUND * AROUND {
            // Not through the centre: many scenes have nothing there, and symmetric ones an edge.
            let place = |cell: u32, offset: f32| (cell as f32 + offset) / AROUND as f32;
            let toward = |offset| {
                warp::octahedral_direction([place(cell % AROUND, offset), place(cell / AROUND, 1.0 - offset)])
            };
            let from = center + toward(0.37) * (2.0 * self.radius);
            let to = center + 0.6 * half * toward(0.71).any_orthonormal_vector();
            let ray = Ray::new(from.to_array(), (to - from).to_array());
            let hit = self.bvh.closest_hit(&ray);
            if hit.is_hit() {
                let surface = self.surface(&ray, &hit);
                seen += 1.0;
                backs += f32::from(u8::from(surface.single_sided && !surface.front));
            }
        }
        backs > MOSTLY * seen
    }

    /// Whether rays may pass any surface as if it were not there.
    pub(crate) fn has_gaps(&self) -> bool {
        self.has_holes || self.has_open_fronts
    }

    /// This world, in which all surfaces are seen from both sides.
    pub(crate) fn with_both_sides(&self) -> Self {
        let mut world = self.clone();
        let objects = Arc::make_mut(&mut world.objects).iter_mut().flatten();
        for primitives in Arc::make_mut(&mut world.primitives).iter_mut().chain(objects) {
            if let Primitives::Mesh(mesh) = primitives
                && mesh.binding.single_sided
            {
                Arc::make_mut(mesh).binding.single_sided = false;
            }
        }
        world.has_open_fronts = false;
        world.classify();
        world
    }
}
