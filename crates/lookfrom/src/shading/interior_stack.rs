//! Interior stacks: the nested dielectrics and the medium that a ray is inside of.
//!
//! Bodies may be nested or overlap (a drink that reaches a little into its glass). The body that was entered last
//! is the active one; leaving a body removes it wherever it is in the stack. The surface of a body below the top of
//! the stack is invisible.
//!
//! A surface may also declare the media on its two sides, as pbrt's `MediumInterface` does: these then replace the
//! stack, whatever it held before.

use lookfrom_scene::scene::MediumId;

/// A stack of at most four entries, the last entered first: bodies, identified by their materials, or space filled
/// with a medium. A fifth entry drops the oldest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InteriorStack([u32; 4]);

/// The interior stacks on the two sides of a surface that declares its media.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MediumInterface {
    /// On the side opposite to the outside normal.
    pub inside: InteriorStack,
    /// On the side of the outside normal.
    pub outside: InteriorStack,
}

/// Flag of an entry for space that is filled with a medium without being a body: the other bits are the medium's
/// index. A body's entry is its material's index plus one; 0 is an empty entry.
const SPACE: u32 = 1 << 31;

impl InteriorStack {
    /// Maximum number of materials or media that entries can distinguish.
    pub const MOST: usize = SPACE as usize - 1;

    /// In no body, in space filled with a medium; `None` is a vacuum.
    pub fn in_space(medium: Option<MediumId>) -> Self {
        Self([medium.map_or(0, |medium| SPACE | medium.0), 0, 0, 0])
    }

    /// True in a vacuum.
    #[inline]
    pub fn is_empty(self) -> bool {
        self.0[0] == 0
    }

    /// The stack after entering a body of a material.
    pub fn entered(self, material: u32) -> Self {
        let [first, second, third, _] = self.0;
        Self([material + 1, first, second, third])
    }

    /// The stack after leaving the body of a material that was entered last; unchanged if it is inside of
    /// no such body.
    pub fn left(self, material: u32) -> Self {
        let Some(place) = self.place(material) else { return self };
        let mut entries = self.0;
        entries.copy_within(place + 1.., place);
        entries[3] = 0;
        Self(entries)
    }

    /// Number of entries above the last entered body of a material.
    fn place(self, material: u32) -> Option<usize> {
        self.0.iter().position(|entry| *entry == material + 1)
    }

    /// True if it is inside of a body of this material, but has since entered another one.
    pub fn hides(self, material: u32) -> bool {
        self.place(material).is_some_and(|place| place > 0)
    }

    /// The material of the active body; `None` in space.
    pub fn material(self) -> Option<u32> {
        let top = self.0[0];
        (top != 0 && top & SPACE == 0).then(|| top - 1)
    }

    /// The medium that fills the space here, where no body is active.
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
        // Left in the order of nesting, in another order, and without having been entered.
        assert_eq!(all.left(ice).left(water), outside.entered(glass));
        assert_eq!(all.left(ice).material(), Some(water));
        assert_eq!(all.left(water), outside.entered(glass).entered(ice));
        assert_eq!(all.left(glass).left(ice), outside.entered(water));
        assert_eq!(all.left(9), all);
        assert_eq!(outside.left(glass), outside);
        assert!(outside.is_empty() && !all.is_empty() && all.left(glass).left(ice).left(water).is_empty());
        // A body within another one of the same material.
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
