//! Transitions of the interior stack at surfaces, and its medium.

use glam::Vec3;

use super::Material;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::interior_stack::{InteriorStack, MediumInterface};

impl InteriorStack {
    /// The medium that is there.
    pub fn medium(self, materials: &[Material]) -> Option<u32> {
        self.space().or_else(|| materials[self.material()? as usize].medium)
    }

    /// What a ray is inside of that leaves a surface into `direction`, having arrived in this: what the surface says is on
    /// that side, or else, where the ray goes through (`crosses`), in or out of the body that the surface's material is.
    #[inline]
    pub fn leaving(
        self,
        materials: &[Material],
        surface: &SurfaceInteraction,
        direction: Vec3,
        crosses: bool,
    ) -> Self {
        if let Some(MediumInterface { inside, outside }) = surface.medium_interface {
            let is_outside = surface.ng.dot(direction.as_dvec3()) > 0.0;
            return if is_outside { outside } else { inside };
        }
        match (crosses && materials[surface.material as usize].is_body(), surface.front) {
            (true, true) => self.entered(surface.material),
            (true, false) => self.left(surface.material),
            (false, _) => self,
        }
    }
}
