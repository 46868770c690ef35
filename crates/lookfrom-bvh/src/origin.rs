//! Points of surfaces that rays leave without hitting them again: one at a time, by arrays. The formulas, for any width, and
//! their proof are those of [`Points`].

use crate::affine::{Affine, inverse_matrix};
use lookfrom_simd::{Placement, Points, Vector, amplification};

/// A point on a surface with its error bound.
///
/// ```
/// use lookfrom_bvh::Point;
/// let point = Point { position: [0.1, 0.2, 0.3], error: [1e-9; 3] };
/// let origin = point.origin([0.0, 0.0, 1.0], [0.0_f32, 0.0, 1.0]);
/// assert!(f64::from(origin[2]) > 0.3 + 1e-9);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// The position.
    pub position: [f64; 3],
    /// The maximum distance of the surface, as rays see it, from the position: for each coordinate, not negative.
    /// It includes all errors except that of rounding the origin to f32, which [`Self::origin`] takes into account.
    pub error: [f64; 3],
}

impl Point {
    /// The point on a triangle at a hit: `p0 + u (p1 − p0) + v (p2 − p0)`.
    ///
    /// An error of `u` or `v` moves it within the plane, so the bound does not include them.
    ///
    /// ```
    /// use lookfrom_bvh::Point;
    /// let point = Point::on_triangle([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 0.25, 0.5);
    /// assert_eq!(point.position, [0.25, 0.5, 0.0]);
    /// ```
    pub fn on_triangle(p0: [f32; 3], p1: [f32; 3], p2: [f32; 3], u: f32, v: f32) -> Self {
        Self::on_triangle_with_normal(p0, p1, p2, u, v).0
    }

    /// [`Self::on_triangle`], and `(p1 − p0) × (p2 − p0)`, which is needed anyway; its length is twice the area.
    ///
    /// ```
    /// use lookfrom_bvh::Point;
    /// let corners = ([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    /// let (point, normal) = Point::on_triangle_with_normal(corners.0, corners.1, corners.2, 0.25, 0.5);
    /// assert_eq!((point.position, normal), ([0.25, 0.5, 0.0], [0.0, 0.0, 1.0]));
    /// ```
    #[inline]
    pub fn on_triangle_with_normal(
        p0: [f32; 3],
        p1: [f32; 3],
        p2: [f32; 3],
        u: f32,
        v: f32,
    ) -> (Self, [f64; 3]) {
        let (points, normal) = Points::<f32>::on_triangles([p0, p1, p2].map(Vector::from), u, v);
        (points.into(), normal.into())
    }

    /// The point of a sphere that is nearest to `hit`, which should be on the sphere up to its errors.
    ///
    /// ```
    /// use lookfrom_bvh::Point;
    /// let point = Point::on_sphere([0.0; 3], 2.0, [0.0, 0.0, 1.999_999_9]);
    /// assert_eq!(point.position, [0.0, 0.0, 2.0]);
    /// ```
    pub fn on_sphere(center: [f32; 3], radius: f32, hit: [f64; 3]) -> Self {
        let center = Vector::from(center).widen();
        Points::<f32>::on_spheres(center, f64::from(radius), hit.into()).into()
    }

    /// The point under an affine map, for a hit in an instance: `world_from_object` is the instance's.
    ///
    /// The bound grows by the rounding errors here and by those of the ray on its transformation to the object's
    /// space, including its rounding to f32 there (for procedural shapes).
    ///
    /// ```
    /// use lookfrom_bvh::{Affine, Point};
    /// let up = Affine { translation: [0.0, 0.0, 5.0], ..Affine::IDENTITY };
    /// let point = Point::on_triangle([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 0.25, 0.5).transformed(&up);
    /// assert_eq!(point.position, [0.25, 0.5, 5.0]);
    /// ```
    pub fn transformed(&self, world_from_object: &Affine) -> Self {
        let Affine { matrix, translation } = world_from_object;
        let inverse = inverse_matrix(matrix).unwrap_or([[0.0; 3]; 3]);
        let amplification = amplification(matrix, &inverse).map(Vector::from);
        let (matrix, inverse) = (matrix.map(Vector::from), inverse.map(Vector::from));
        let translation = Vector::from(*translation);
        self.points().placed(&Placement { matrix, translation, inverse, amplification }).into()
    }

    /// The origin of a ray that leaves the point in a direction.
    ///
    /// `normal` is the surface's geometric normal, of any length but zero and with either sign; the ray starts on
    /// the side to which `direction` (of any length) points. The origin is beyond the error and rounded away from
    /// the surface, no more.
    ///
    /// ```
    /// use lookfrom_bvh::Point;
    /// let point = Point::on_triangle([0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0], 0.25, 0.25);
    /// let below = point.origin([0.0, 0.0, 1.0], [0.5_f32, 0.0, -1.0]);
    /// assert_eq!(below, [0.25, 0.25, 1.0_f32.next_down()]);
    /// ```
    pub fn origin<D: Copy + Into<f64>>(&self, normal: [f64; 3], direction: [D; 3]) -> [f32; 3] {
        let length = Vector::from(normal).length();
        if !(length > 0.0 && length.is_finite()) {
            return self.position.map(|x| x as f32);
        }
        self.leave(normal.map(|x| x / length), direction)
    }

    /// [`Self::origin`] for a normal of unit length, up to rounding.
    ///
    /// ```
    /// use lookfrom_bvh::Point;
    /// let point = Point { position: [0.25, 0.25, 1.0], error: [0.0; 3] };
    /// assert_eq!(point.leave([0.0, 0.0, 1.0], [0.5_f32, 0.0, -1.0])[2], 1.0_f32.next_down());
    /// ```
    #[inline]
    pub fn leave<D: Copy + Into<f64>>(&self, unit_normal: [f64; 3], direction: [D; 3]) -> [f32; 3] {
        let direction: [f64; 3] = direction.map(Into::into);
        self.points().exits(unit_normal.into()).toward_wide(direction.into()).into()
    }

    fn points(&self) -> Points<f32> {
        Points { position: self.position.into(), error: self.error.into() }
    }
}

impl From<Points<f32>> for Point {
    fn from(Points { position, error }: Points<f32>) -> Self {
        Self { position: position.into(), error: error.into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_step_off_a_plane() {
        let point = Point::on_triangle([0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0], 0.25, 0.25);
        let up = point.origin([0.0, 0.0, 1.0], [0.3_f32, 0.0, 1.0]);
        assert_eq!(up, [0.25, 0.25, 1.0_f32.next_up()]);
        let down = point.origin([0.0, 0.0, 1.0], [0.3_f64, 0.0, -1.0]);
        assert_eq!(down, [0.25, 0.25, 1.0_f32.next_down()]);
    }

    #[test]
    fn a_normal_of_no_length_moves_nothing() {
        let point = Point { position: [1.0, 2.0, 3.0], error: [1.0; 3] };
        assert_eq!(point.origin([0.0; 3], [1.0_f32, 0.0, 0.0]), [1.0, 2.0, 3.0]);
    }
}
