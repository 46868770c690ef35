//! What a ray is inside of: bodies, the one that it entered last on top.
//!
//! Bodies may be nested or overlap (a drink that reaches a little into its glass): the one that was entered last counts, and
//! leaving takes a body away wherever it lies. Where it did not lie on top, nothing is to be seen of its surface.

use lookfrom_scene::medium::Sides;

use super::Material;
use crate::surface::Surface;

/// What a ray is inside of: at most four bodies, told apart by their materials, of which the first 32,766 are known.
///
/// Sixteen bits for each, the last entered lowest: 0 is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Media(u64);

/// The entry of all materials that are not known, which absorb nothing and do not bend light.
const UNKNOWN: u64 = 0x7fff;

/// Set in the entry of space that is filled with a medium without being a body.
const SPACE: u64 = 0x8000;

fn body(material: u32) -> u64 {
    (u64::from(material) + 1).min(UNKNOWN)
}

impl Media {
    /// In space that is filled with a medium, and in no body.
    fn in_space(medium: u32) -> Self {
        Self(SPACE | u64::from(medium).min(UNKNOWN))
    }

    /// After entering a body of a material.
    pub fn entered(self, material: u32) -> Self {
        Self(self.0 << 16 | body(material))
    }

    /// After leaving the body of a material that was entered last; nothing changes outside of all of them.
    pub fn left(self, material: u32) -> Self {
        let Some(place) = self.place(material) else { return self };
        let above = self.0 & ((1 << place) - 1);
        let below = self.0.checked_shr(place + 16).unwrap_or(0) << place;
        Self(below | above)
    }

    /// By how many bits the last body of a material is shifted.
    fn place(self, material: u32) -> Option<u32> {
        (0..64).step_by(16).find(|shift| self.0 >> shift & 0xffff == body(material))
    }

    /// Whether it is inside of a body of a material, but of another one that was entered later.
    pub fn hides(self, material: u32) -> bool {
        self.place(material).is_some_and(|place| place > 0)
    }

    /// The material of the body that counts.
    pub fn material(self) -> Option<u32> {
        let top = self.0 & 0xffff;
        (top != 0 && top < UNKNOWN).then(|| top as u32 - 1)
    }

    /// The medium that is there.
    pub fn medium(self, materials: &[Material]) -> Option<u32> {
        let top = self.0 & 0xffff;
        if top & SPACE != 0 && top != SPACE | UNKNOWN {
            return Some((top ^ SPACE) as u32);
        }
        self.material().and_then(|material| materials[material as usize].medium)
    }

    /// After going through a surface: to what it says is on its other side, or else in or out of the body that its
    /// material is.
    pub fn crossed(self, materials: &[Material], surface: &Surface) -> Self {
        if let Some(Sides { inside, outside }) = surface.sides {
            let beyond = if surface.front { inside } else { outside };
            return beyond.map_or(Self::default(), |medium| Self::in_space(medium.0));
        }
        match (materials[surface.material as usize].is_body(), surface.front) {
            (true, true) => self.entered(surface.material),
            (true, false) => self.left(surface.material),
            (false, _) => self,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_one_entered_counts() {
        let outside = Media::default();
        let (glass, water, ice) = (3, 40_000, 7);
        let all = outside.entered(glass).entered(water).entered(ice);
        assert_eq!(all.material(), Some(ice));
        assert!(all.hides(glass) && all.hides(water) && !all.hides(ice) && !all.hides(8));
        // Nested as it should be, out of turn, and not at all.
        assert_eq!(all.left(ice).left(water), outside.entered(glass));
        assert_eq!(all.left(water), outside.entered(glass).entered(ice));
        assert_eq!(all.left(glass).left(ice), outside.entered(water));
        assert_eq!(all.left(9), all);
        assert_eq!(outside.left(glass), outside);
        // A body in another of the same material.
        assert_eq!(outside.entered(glass).entered(glass).left(glass).material(), Some(glass));
        // Of five, the first is forgotten.
        let five = all.entered(1).entered(2);
        assert_eq!(five.left(2).left(1).left(ice).left(water), outside);
        assert_eq!(five.left(glass), five);
        // What is not known counts without being known.
        assert_eq!(outside.entered(glass).entered(water).material(), None);
    }
}
