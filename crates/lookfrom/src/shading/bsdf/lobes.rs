//! Lobes of a BSDF as a bit set.

use std::ops::{BitOr, BitOrAssign};

/// A set of the sides on which light leaves (reflection, transmission) and of the ways it is spread (diffuse, glossy,
/// specular).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lobes(u8);

impl Lobes {
    /// Nothing.
    pub const NONE: Self = Self(0);
    /// To the side that the light came from.
    pub const REFLECTION: Self = Self(1);
    /// Through the surface.
    pub const TRANSMISSION: Self = Self(2);
    /// Into all directions about evenly.
    pub const DIFFUSE: Self = Self(4);
    /// Mostly about one direction.
    pub const GLOSSY: Self = Self(8);
    /// Into single directions, which only `sample` can find.
    pub const SPECULAR: Self = Self(16);
    /// Everything.
    pub const ALL: Self = Self(31);

    /// Whether the sets share anything.
    #[inline]
    pub const fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Whether all of `other` is in this set.
    #[inline]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Both sets together.
    #[inline]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// What both sets have.
    #[inline]
    pub const fn intersection(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// Whether there is a specular part.
    #[inline]
    pub const fn is_specular(self) -> bool {
        self.intersects(Self::SPECULAR)
    }

    /// Whether there is a part that `f` sees: diffuse or glossy.
    #[inline]
    pub const fn is_non_specular(self) -> bool {
        self.intersects(Self::DIFFUSE.union(Self::GLOSSY))
    }

    /// Whether light stays on its side.
    #[inline]
    pub const fn is_reflection(self) -> bool {
        self.intersects(Self::REFLECTION)
    }

    /// Whether light passes through.
    #[inline]
    pub const fn is_transmission(self) -> bool {
        self.intersects(Self::TRANSMISSION)
    }

    /// The part `probability` of these sides that the set allows, 0 for the others: `[reflection, transmission]`.
    #[inline]
    pub(super) fn allowed(self, [reflection, transmission]: [f32; 2]) -> [f32; 2] {
        [
            if self.is_reflection() { reflection } else { 0.0 },
            if self.is_transmission() { transmission } else { 0.0 },
        ]
    }
}

impl BitOr for Lobes {
    type Output = Self;
    #[inline]
    fn bitor(self, other: Self) -> Self {
        self.union(other)
    }
}

impl BitOrAssign for Lobes {
    #[inline]
    fn bitor_assign(&mut self, other: Self) {
        *self = *self | other;
    }
}
