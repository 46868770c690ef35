//! A reference to a primitive while the tree is built: its box, its kind and its number, in one vector.

use crate::aabb::Aabb;
use lookfrom_simd::{Simd, f32x8, prelude::*};

use super::primitives::Kind;

/// Eight lanes: minimum x, y, z, and the primitive's number (as bits); negated maximum x, y, z, and its kind.
///
/// With negated maxima, the box around two boxes is one minimum of vectors. The kind counts from 1, and numbers
/// below 2³⁰ are the bits of floats below 2, so that no lane is NaN and no difference of the two is denormal, which
/// would be slow.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct Reference([f32; 8]);

const KINDS: [Kind; 5] = [Kind::Triangle, Kind::Sphere, Kind::Procedural, Kind::Thin, Kind::Instance];

impl Reference {
    pub(super) fn new(bounds: &Aabb, number: u32, kind: Kind) -> Self {
        let ([x, y, z], [u, v, w]) = (bounds.min, bounds.max);
        Self([x, y, z, f32::from_bits(number), -u, -v, -w, 1.0 + f32::from(kind as u8)])
    }

    pub(super) fn bounds(&self) -> Aabb {
        let [x, y, z, _, u, v, w, _] = self.0;
        Aabb { min: [x, y, z], max: [-u, -v, -w] }
    }

    /// The primitive's number among all primitives.
    pub(super) fn number(&self) -> u32 {
        self.0[3].to_bits()
    }

    pub(super) fn kind(&self) -> Kind {
        KINDS[self.0[7] as usize - 1]
    }

    #[inline(always)]
    pub(super) fn lanes<S: Simd>(&self, simd: S) -> f32x8<S> {
        f32x8::load_array_ref(simd, &self.0)
    }
}

/// True if the references can form a leaf: few, and of one kind.
pub(super) fn fits_a_leaf(references: &[Reference]) -> bool {
    let fits = |kind: Kind| {
        references.len() <= kind.leaf_capacity()
            && references.iter().all(|reference| reference.kind() == kind)
    };
    references.len() <= Kind::MOST_IN_A_LEAF && fits(references[0].kind())
}

/// The boxes covered by some references.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Covered {
    pub(super) bounds: Aabb,
    /// Twice the box around the centres of their boxes.
    pub(super) centers: Aabb,
}

impl Covered {
    pub(super) fn by(references: &[Reference]) -> Self {
        let mut covered = Self { bounds: Aabb::EMPTY, centers: Aabb::EMPTY };
        for reference in references {
            let bounds = reference.bounds();
            covered.bounds.unite(&bounds);
            covered.centers.extend(bounds.twice_center());
        }
        covered
    }

    pub(super) fn unite(&mut self, other: &Self) {
        self.bounds.unite(&other.bounds);
        self.centers.unite(&other.centers);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_goes_in_comes_out() {
        for exponent in 0..30 {
            for kind in KINDS {
                let x = 2.0_f32.powi(exponent - 15);
                let bounds = Aabb { min: [-x, 0.5 * x, 0.0], max: [x, x, 1.5 * x] };
                let number = (1 << exponent) + (exponent as u32 & 5);
                let reference = Reference::new(&bounds, number, kind);
                assert_eq!(
                    (reference.bounds(), reference.number(), reference.kind()),
                    (bounds, number, kind)
                );
            }
        }
    }
}
