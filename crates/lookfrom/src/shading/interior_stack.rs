//! Interior stacks: the nested dielectrics and the medium that a ray is inside of.
//!
//! Bodies may be nested or overlap (a drink that reaches a little into its glass): the one that was entered last counts, and
//! leaving takes a body away wherever it lies. Where it did not lie on top, nothing is to be seen of its surface.
//!
//! A surface may also name the media on its two sides itself, as pbrt's `MediumInterface` does: then those count, whatever
//! the ray was inside of before.

use lookfrom_scene::scene::MediumId;

/// A stack of at most four entries, the last entered first: bodies, told apart by their materials, or space that is filled
/// with a medium. Of five, the one that was entered first is forgotten.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InteriorStack([u32; 4]);

/// What fills the space on the two sides of a surface that says so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MediumInterface {
    /// Behind the outside normal.
    pub inside: InteriorStack,
    /// Before it.
    pub outside: InteriorStack,
}

/// Set in the entry of space that is filled with a medium without being a body: its other bits are the medium's index. A
/// body's entry is its material's index plus one, and 0 is none.
const SPACE: u32 = 1 << 31;

impl InteriorStack {
    /// More materials or media than this cannot be told apart.
    pub const MOST: usize = SPACE as usize - 1;

    /// In no body, in space that is filled with a medium; `None` is a vacuum.
    pub fn in_space(medium: Option<MediumId>) -> Self {
        Self([medium.map_or(0, |medium| SPACE | medium.0), 0, 0, 0])
    }

    /// Whether it is in a vacuum.
    #[inline]
    pub fn is_empty(self) -> bool {
        self.0[0] == 0
    }

    /// After entering a body of a material.
    pub fn entered(self, material: u32) -> Self {
        let [first, second, third, _] = self.0;
        Self([material + 1, first, second, third])
    }

    /// After leaving the body of a material that was entered last; nothing changes outside of all of them.
    pub fn left(self, material: u32) -> Self {
        let Some(place) = self.place(material) else { return self };
        let mut entries = self.0;
        entries.copy_within(place + 1.., place);
        entries[3] = 0;
        Self(entries)
    }

    /// How many entries lie over the last body of a material.
    fn place(self, material: u32) -> Option<usize> {
        self.0.iter().position(|entry| *entry == material + 1)
    }

    /// Whether it is inside of a body of a material, but of another one that was entered later.
    pub fn hides(self, material: u32) -> bool {
        self.place(material).is_some_and(|place| place > 0)
    }

    /// The material of the body that counts; `None` in space.
    pub fn material(self) -> Option<u32> {
        let top = self.0[0];
        (top != 0 && top & SPACE == 0).then(|| top - 1)
    }

    /// The medium that fills space here, where no body does.
    pub fn space(self) -> Option<u32> {
        let top = self.0[0];
        (top & SPACE != 0).then_some(top ^ SPACE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_one_entered_counts() {
        let outside = InteriorStack::default();
        let (glass, water, ice) = (3, 40_000, 2_000_000_000);
        let all = outside.entered(glass).entered(water).entered(ice);
        assert_eq!(all.material(), Some(ice));
        assert!(all.hides(glass) && all.hides(water) && !all.hides(ice) && !all.hides(8));
        // Nested as it should be, out of turn, and not at all.
        assert_eq!(all.left(ice).left(water), outside.entered(glass));
        assert_eq!(all.left(ice).material(), Some(water));
        assert_eq!(all.left(water), outside.entered(glass).entered(ice));
        assert_eq!(all.left(glass).left(ice), outside.entered(water));
        assert_eq!(all.left(9), all);
        assert_eq!(outside.left(glass), outside);
        assert!(outside.is_empty() && !all.is_empty() && all.left(glass).left(ice).left(water).is_empty());
        // A body in another of the same material.
        assert_eq!(outside.entered(glass).entered(glass).left(glass).material(), Some(glass));
        // Of five, the first is forgotten.
        let five = all.entered(1).entered(2);
        assert_eq!(five.left(2).left(1).left(ice).left(water), outside);
        assert_eq!(five.left(glass), five);
    }

    #[test]
    fn bodies_stand_in_filled_space() {
        let fog = InteriorStack::in_space(Some(MediumId(70_000)));
        assert_eq!((fog.space(), fog.material(), fog.is_empty()), (Some(70_000), None, false));
        let glass = fog.entered(5);
        assert_eq!((glass.space(), glass.material()), (None, Some(5)));
        assert_eq!(glass.left(5), fog);
        assert_eq!(fog.left(70_000), fog);
        assert_eq!(InteriorStack::in_space(None), InteriorStack::default());
    }
}
