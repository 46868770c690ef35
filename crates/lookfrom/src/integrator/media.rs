//! What a ray is inside of, and what that takes of its light.

use lookfrom_scene::material::MaterialKind;
use lookfrom_scene::medium::Sides;

use crate::material::Material;
use crate::spectrum::Spectrum;
use crate::surface::Surface;
use crate::texture::{Lanes, TexturePoint, Usage};
use crate::world::World;

/// What a ray is inside of, the innermost last: at most four bodies, whose media are among the first 65,534.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Media(u64);

/// A body of which nothing is absorbed.
const CLEAR: u64 = 0xffff;

impl Media {
    /// After entering a body that is filled with a medium, or with none.
    pub fn entered(self, medium: Option<u32>) -> Self {
        let medium = medium.map_or(CLEAR, |medium| u64::from(medium) + 1);
        Self(self.0 << 16 | medium.min(CLEAR))
    }

    /// After leaving the innermost.
    pub fn left(self) -> Self {
        Self(self.0 >> 16)
    }

    /// The innermost medium.
    pub fn innermost(self) -> Option<u32> {
        let innermost = self.0 & 0xffff;
        (innermost != 0 && innermost != CLEAR).then(|| innermost as u32 - 1)
    }

    /// After going through a surface: to what it says is on its other side, or else in or out of the body that its
    /// material is.
    pub fn crossed(self, world: &World, surface: &Surface) -> Self {
        if let Some(Sides { inside, outside }) = surface.sides {
            let beyond = if surface.front { inside } else { outside };
            return beyond.map_or(Self::default(), |medium| Self::default().entered(Some(medium.0)));
        }
        let Material { kind, medium, .. } = &world.materials[surface.material as usize];
        let is_body = match kind {
            MaterialKind::Whitted(_) => true,
            MaterialKind::Principled(look) => look.is_solid,
            _ => false,
        };
        match (is_body, surface.front) {
            (true, true) => self.entered(*medium),
            (true, false) => self.left(),
            (false, _) => self,
        }
    }

    /// What is left of light after `distance` (Beer's law).
    pub fn transmittance(self, world: &World, distance: f32, lanes: &Lanes) -> Spectrum {
        let Some(medium) = self.innermost().and_then(|index| world.media.get(index as usize)) else {
            return lanes.one();
        };
        let sigma =
            world.textures.spectrum(medium.absorption, Usage::Unbounded, &TexturePoint::NOWHERE, lanes);
        let length = medium.scale * distance;
        lanes.one() * sigma.map(|sigma| libm::expf(-sigma * length))
    }
}
