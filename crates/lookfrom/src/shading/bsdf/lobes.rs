//! Lobes of a BSDF as a bit set.

use std::ops::{BitOr, BitOrAssign};

use lookfrom_simd::Real;

/// A set of sides to which light is scattered (reflection, transmission) and of kinds of scattering (diffuse,
/// glossy, specular).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lobes(u8);

impl Lobes {
    /// The empty set.
    pub const NONE: Self = Self(0);
    /// To the side of the incident light.
    pub const REFLECTION: Self = Self(1);
    /// Through the surface.
    pub const TRANSMISSION: Self = Self(2);
    /// About uniform in all directions.
    pub const DIFFUSE: Self = Self(4);
    /// Concentrated about one direction.
    pub const GLOSSY: Self = Self(8);
    /// In discrete directions, which only `sample` can find.
    pub const SPECULAR: Self = Self(16);
    /// All lobes.
    pub const ALL: Self = Self(31);

    /// The one lobe of a sample.
    #[inline]
    pub(crate) fn sampled(is_specular: bool, is_diffuse: bool, is_transmission: bool) -> Self {
        let side = if is_transmission { Self::TRANSMISSION } else { Self::REFLECTION };
        side | match (is_specular, is_diffuse) {
            (true, _) => Self::SPECULAR,
            (false, true) => Self::DIFFUSE,
            (false, false) => Self::GLOSSY,
        }
    }

    /// True if the sets intersect.
    #[inline]
    pub const fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// True if all of `other` is in this set.
    #[inline]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// The union of both sets.
    #[inline]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The intersection of both sets.
    #[inline]
    pub const fn intersection(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// True if it contains specular lobes.
    #[inline]
    pub const fn is_specular(self) -> bool {
        self.intersects(Self::SPECULAR)
    }

    /// True if it contains lobes that `f` evaluates: diffuse or glossy ones.
    #[inline]
    pub const fn is_non_specular(self) -> bool {
        self.intersects(Self::DIFFUSE.union(Self::GLOSSY))
    }

    /// True if it contains reflection.
    #[inline]
    pub const fn is_reflection(self) -> bool {
        self.intersects(Self::REFLECTION)
    }

    /// True if it contains transmission.
    #[inline]
    pub const fn is_transmission(self) -> bool {
        self.intersects(Self::TRANSMISSION)
    }

    /// The probabilities `[reflection, transmission]`, with 0 for sides that the set does not allow.
    #[inline(always)]
    pub(super) fn allowed<R: Real>(self, [reflection, transmission]: [R; 2]) -> [R; 2] {
        let zero = reflection.like(0.0);
        [
            if self.is_reflection() { reflection } else { zero },
            if self.is_transmission() { transmission } else { zero },
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
