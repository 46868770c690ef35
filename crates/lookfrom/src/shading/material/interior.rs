//! Transitions of the interior stack at surfaces, and its medium.

use glam::Vec3;

use super::Material;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::interior_stack::{InteriorStack, MediumInterface};

impl InteriorStack {
    /// The current medium.
    pub fn medium(self, materials: &[Material]) -> Option<u32> {
        self.space().or_else(|| materials[self.material()? as usize].medium)
    }

    /// The stack of a ray that leaves a surface into `direction`, having arrived with this one: the stack that the
    /// surface declares for that side, or else, where the ray passes through (`crosses`), this one after entering
    /// or leaving the body of the surface's material.
    #[inline]
    pub fn leaving(
        self,
        materials: &[Material],
        surface: &SurfaceInteraction,
        direction: Vec3,
        crosses: bool,
    ) -> Self {
        if let Some(MediumInterface { inside, outside }) = surface.medium_interface {
            let is_outside = surface.is_outside(direction);
            return if is_outside { outside } else { inside };
        }
        match (crosses && materials[surface.material as usize].is_body(), surface.front) {
            (true, true) => self.entered(surface.material),
            (true, false) => self.left(surface.material),
            (false, _) => self,
        }
    }
}
