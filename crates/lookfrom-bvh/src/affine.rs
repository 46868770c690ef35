//! Affine maps in double precision: the transformations of instances.

#[cfg(feature = "glam")]
mod of_glam;

use crate::vector::{cross, dot};

/// `x ↦ matrix · x + translation`. For an instance: world from object. Reflections, shears and any scale are
/// allowed. With the feature `glam` it is made from a `DAffine3`, whose matrix is by columns.
///
/// ```
/// use lookfrom_bvh::Affine;
/// let mirror = Affine { matrix: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 2.0]], translation: [5.0, 0.0, 0.0] };
/// assert_eq!(mirror.point([1.0, 2.0, 3.0]), [4.0, 2.0, 6.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine {
    /// The linear part, by rows.
    pub matrix: [[f64; 3]; 3],
    /// The image of the origin.
    pub translation: [f64; 3],
}

impl Affine {
    /// The identity.
    ///
    /// ```
    /// use lookfrom_bvh::Affine;
    /// let up = Affine { translation: [0.0, 0.0, 1.0], ..Affine::IDENTITY };
    /// assert_eq!(up.point([1.0; 3]), [1.0, 1.0, 2.0]);
    /// ```
    pub const IDENTITY: Self =
        Self { matrix: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] };

    /// The image of a point.
    ///
    /// ```
    /// use lookfrom_bvh::Affine;
    /// let up = Affine { translation: [0.0, 0.0, 1.0], ..Affine::IDENTITY };
    /// assert_eq!(up.point([0.0; 3]), [0.0, 0.0, 1.0]);
    /// ```
    #[inline]
    pub fn point(&self, p: [f64; 3]) -> [f64; 3] {
        let moved = self.vector(p);
        [moved[0] + self.translation[0], moved[1] + self.translation[1], moved[2] + self.translation[2]]
    }

    /// The image of a direction: without the translation.
    ///
    /// ```
    /// use lookfrom_bvh::Affine;
    /// let up = Affine { translation: [0.0, 0.0, 1.0], ..Affine::IDENTITY };
    /// assert_eq!(up.vector([0.0, 2.0, 0.0]), [0.0, 2.0, 0.0]);
    /// ```
    #[inline]
    pub fn vector(&self, v: [f64; 3]) -> [f64; 3] {
        self.matrix.map(|row| dot(row, v))
    }

    /// The image of a surface normal under the inverse of `self`: multiplication by the transposed matrix. With
    /// `self` = object from world, object normals become world normals (not of unit length).
    ///
    /// ```
    /// use lookfrom_bvh::Affine;
    /// let world_from_object = Affine { matrix: [[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], ..Affine::IDENTITY };
    /// let object_from_world = world_from_object.inverse().unwrap();
    /// assert_eq!(object_from_world.normal_back([1.0, 1.0, 0.0]), [0.5, 1.0, 0.0]);
    /// ```
    #[inline]
    pub fn normal_back(&self, n: [f64; 3]) -> [f64; 3] {
        let m = &self.matrix;
        [0, 1, 2].map(|i| m[0][i] * n[0] + m[1][i] * n[1] + m[2][i] * n[2])
    }

    /// The map on the way to another: every entry is linear, this map at `fraction` 0, the other at 1. An entry that both have
    /// is exactly that.
    ///
    /// ```
    /// use lookfrom_bvh::Affine;
    /// let up = Affine { translation: [0.0, 0.0, 4.0], ..Affine::IDENTITY };
    /// assert_eq!(Affine::IDENTITY.between(&up, 0.25).translation, [0.0, 0.0, 1.0]);
    /// ```
    pub fn between(&self, later: &Self, fraction: f64) -> Self {
        let entry = |a: f64, b: f64| if a == b { a } else { a * (1.0 - fraction) + b * fraction };
        let mix = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| entry(a[i], b[i]));
        Self {
            matrix: [0, 1, 2].map(|row| mix(self.matrix[row], later.matrix[row])),
            translation: mix(self.translation, later.translation),
        }
    }

    /// The inverse, where it exists within the range of numbers.
    ///
    /// ```
    /// use lookfrom_bvh::Affine;
    /// let up = Affine { translation: [0.0, 0.0, 1.0], ..Affine::IDENTITY };
    /// assert_eq!(up.inverse().unwrap().point([0.0, 0.0, 1.0]), [0.0; 3]);
    /// assert_eq!(Affine { matrix: [[0.0; 3]; 3], ..up }.inverse(), None);
    /// ```
    pub fn inverse(&self) -> Option<Self> {
        let matrix = inverse_matrix(&self.matrix)?;
        let back = Self { matrix, translation: [0.0; 3] }.vector(self.translation);
        let translation = back.map(|x| -x);
        translation.iter().all(|x| x.is_finite()).then_some(Self { matrix, translation })
    }
}

/// The inverse by cofactors. `None` where the determinant vanishes (within rounding) or numbers overflow.
pub(crate) fn inverse_matrix(m: &[[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
    // Scale the rows to lengths of about 1, so that neither the determinant nor its error bound depends on
    // units.
    let scale = m.map(|row| row.iter().fold(0.0_f64, |largest, x| largest.max(x.abs())));
    if !scale.iter().all(|&s| s.is_finite() && s > 0.0) {
        return None;
    }
    let rows = [0, 1, 2].map(|i| m[i].map(|x| x / scale[i]));
    let columns = [cross(rows[1], rows[2]), cross(rows[2], rows[0]), cross(rows[0], rows[1])];
    let determinant = dot(rows[0], columns[0]);
    if determinant.abs() < 1e-15 {
        return None;
    }
    let inverse = [0, 1, 2].map(|i| [0, 1, 2].map(|j| columns[j][i] / determinant / scale[j]));
    inverse.iter().flatten().all(|x| x.is_finite()).then_some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_of_shear_scale_mirror() {
        let map = Affine {
            matrix: [[-2e5, 1e3, 0.0], [0.0, 3e-4, 1e-4], [0.0, 0.0, 7.0]],
            translation: [1.0, -2.0, 3e6],
        };
        let back = map.inverse().unwrap();
        for p in [[1.0, 2.0, 3.0], [-1e4, 0.5, 1e-3]] {
            let q = back.point(map.point(p));
            for axis in 0..3 {
                assert!((q[axis] - p[axis]).abs() < 1e-9 * (1.0 + p[axis].abs()), "{q:?} instead of {p:?}");
            }
        }
    }

    #[test]
    fn singular_matrices_have_no_inverse() {
        for matrix in [
            [[0.0; 3]; 3],
            [[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [0.0, 0.0, 1.0]],
            [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]],
            [[f64::NAN, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            [[f64::INFINITY, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        ] {
            assert!(Affine { matrix, translation: [0.0; 3] }.inverse().is_none(), "{matrix:?}");
        }
    }
}
