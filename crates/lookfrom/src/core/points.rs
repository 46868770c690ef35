//! Points on surfaces with bounds of their errors, and the placements of instances.

use lookfrom_bvh::Affine;
pub(crate) use lookfrom_simd::{Exits, Lift, Placement, Points};
use lookfrom_simd::{Simd, f32x8};

use crate::core::lanes::{LANES, by_lane, gather_f64};
use crate::core::vector::Vector;

/// The placement of one map, with the inverse of its linear part.
pub(crate) fn placement(affine: &Affine, inverse: &[[f64; 3]; 3]) -> Placement<f32> {
    StoredPlacement { affine, inverse, amplification: &amplification(affine) }.placement()
}

/// The amplification of errors by a map, by rows: see [`Placement::amplification`].
pub(crate) fn amplification(affine: &Affine) -> [[f64; 3]; 3] {
    let inverse = affine.inverse().map_or([[0.0; 3]; 3], |inverse| inverse.matrix);
    lookfrom_simd::amplification(&affine.matrix, &inverse)
}

/// The parts of a placement where they are: of instances the kernel has the map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StoredPlacement<'a> {
    /// The map.
    pub(crate) affine: &'a Affine,
    /// The inverse of its linear part, by rows.
    pub(crate) inverse: &'a [[f64; 3]; 3],
    /// Its [`amplification`].
    pub(crate) amplification: &'a [[f64; 3]; 3],
}

impl StoredPlacement<'_> {
    /// The placement.
    #[inline]
    pub(crate) fn placement(&self) -> Placement<f32> {
        Placement {
            matrix: self.affine.matrix.map(Vector::from),
            translation: self.affine.translation.into(),
            inverse: self.inverse.map(Vector::from),
            amplification: self.amplification.map(Vector::from),
        }
    }
}

/// One map in each lane.
#[inline(always)]
pub(crate) fn gather_placements<S: Simd>(simd: S, rows: &[&Placement<f32>; LANES]) -> Placement<f32x8<S>> {
    macro_rules! gathered {
        ($field:ident, $row:literal) => {
            gather_f64(simd, &by_lane!(lane => <[f64; 3]>::from(rows[lane].$field[$row])))
        };
        ($field:ident) => {
            [gathered!($field, 0), gathered!($field, 1), gathered!($field, 2)]
        };
    }
    let translation = gather_f64(simd, &by_lane!(lane => <[f64; 3]>::from(rows[lane].translation)));
    let (matrix, inverse) = (gathered!(matrix), gathered!(inverse));
    Placement { matrix, translation, inverse, amplification: gathered!(amplification) }
}
