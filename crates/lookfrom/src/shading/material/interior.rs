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
        let of_surface = (surface.material, surface.medium_interface);
        self.beside(materials, of_surface, || surface.is_outside(direction), (crosses, surface.front))
    }

    /// [`InteriorStack::leaving`] by the material and the media that a surface declares, whether the ray leaves to its outside, whether it
    /// passes through, and whether it had met the outside.
    #[inline]
    pub(crate) fn beside(
        self,
        materials: &[Material],
        (material, interface): (u32, Option<MediumInterface>),
        is_outside: impl FnOnce() -> bool,
        (crosses, front): (bool, bool),
    ) -> Self {
        if let Some(MediumInterface { inside, outside }) = interface {
            return if is_outside() { outside } else { inside };
        }
        match (crosses && materials[material as usize].is_body(), front) {
            (true, true) => self.entered(material),
            (true, false) => self.left(material),
            (false, _) => self,
        }
    }
}
