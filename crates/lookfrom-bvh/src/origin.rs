//! Origins of rays that leave a surface without hitting it again: Wächter, Binder (2019), with error bounds.
//!
//! Not offset by an epsilon, but just beyond the error of the point it starts from: after Wächter & Binder (2019),
//! "A Fast and Robust Method for Avoiding Self-Intersection", and the error bounds of Pharr, Jakob, Humphreys,
//! Physically Based Rendering. Points are computed in f64 here, so their errors are far below the spacing of f32.
//! It remains to round each coordinate to f32 *away* from the surface: a step of about one unit in the last place.
//!
//! Proof: a triangle, a sphere seen from outside, and any affine image of them lie on one side of the tangent plane
//! at the origin point. The ray's origin is on the other side and its direction leads away, so the whole ray is on
//! the other side. Inside a sphere, rounding moves each coordinate toward that of the centre (itself an f32), hence
//! inwards. Inside an instanced sphere this holds only as long as its radii of curvature are large compared with
//! the spacing of f32.

use crate::affine::{Affine, inverse_matrix};
use crate::vector::{cross, cross_magnitude, dot, round_toward, subtract, wide};

/// Unit of rounding of f64, 2⁻⁵³.
const UNIT: f64 = f64::EPSILON / 2.0;

/// Unit of rounding of f32, 2⁻²⁴.
const UNIT32: f64 = 5.960_464_477_539_063e-8;

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

    /// The same, and `(p1 − p0) × (p2 − p0)`, which is needed anyway; its length is twice the area.
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
        let [p0, p1, p2] = [p0, p1, p2].map(wide);
        let (u, v) = (f64::from(u), f64::from(v));
        let [e1, e2] = [subtract(p1, p0), subtract(p2, p0)];
        let position = [0, 1, 2].map(|i| p0[i] + u * e1[i] + v * e2[i]);

        // Error of a ray's hit relative to the plane: errors of n = e1 × e2, relative to its length.
        let n = cross(e1, e2);
        let reach = [0, 1, 2].map(|i| e1[i].abs() + e2[i].abs());
        let length = dot(n, n).sqrt();
        let decision = 8.0 * UNIT * dot(cross_magnitude(e1, e2), reach) / length;
        let decision = if decision.is_finite() { decision } else { 0.0 };
        let error = [0, 1, 2].map(|i| {
            let magnitude = p0[i].abs() + (u * e1[i]).abs() + (v * e2[i]).abs() + reach[i];
            8.0 * UNIT * magnitude + decision
        });
        (Self { position, error }, n)
    }

    /// The point of a sphere that is nearest to `hit`, which should be on the sphere up to its errors.
    ///
    /// ```
    /// use lookfrom_bvh::Point;
    /// let point = Point::on_sphere([0.0; 3], 2.0, [0.0, 0.0, 1.999_999_9]);
    /// assert_eq!(point.position, [0.0, 0.0, 2.0]);
    /// ```
    pub fn on_sphere(center: [f32; 3], radius: f32, hit: [f64; 3]) -> Self {
        let center = wide(center);
        let radius = f64::from(radius);
        let f = subtract(hit, center);
        let length = dot(f, f).sqrt();
        let stretch = if length > 0.0 { radius / length } else { 0.0 };
        let position = [0, 1, 2].map(|i| center[i] + stretch * f[i]);
        let error = [0, 1, 2].map(|i| 8.0 * UNIT * (center[i].abs() + 2.0 * radius));
        Self { position, error }
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
        let matrix = &world_from_object.matrix;
        let relative = world_from_object.vector(self.position);
        let position = [0, 1, 2].map(|i| relative[i] + world_from_object.translation[i]);
        let size = self.position.map(f64::abs);

        // The amplification by the inverse transformation: |M| |M⁻¹| |position − translation|, and M M⁻¹ − 1.
        let inverse = inverse_matrix(matrix).unwrap_or([[0.0; 3]; 3]);
        let way = relative.map(|x| x.abs() * (1.0 + 1e-6));
        let error = [0, 1, 2].map(|i| {
            let row = matrix[i];
            let mut error = 0.0;
            for j in 0..3 {
                let mut product = if i == j { -1.0 } else { 0.0 };
                let mut magnitude = 0.0;
                for k in 0..3 {
                    product += row[k] * inverse[k][j];
                    magnitude += (row[k] * inverse[k][j]).abs();
                }
                error += (product.abs() + 8.0 * UNIT * magnitude) * way[j];
                let object_rounding = UNIT32 * (1.0 + 1e-6) * size[j];
                error += row[j].abs() * (self.error[j] + 8.0 * UNIT * size[j] + object_rounding);
            }
            error + 4.0 * UNIT * (way[i] + world_from_object.translation[i].abs() + position[i].abs())
        });
        Self { position, error }
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
        let length = dot(normal, normal).sqrt();
        if !(length > 0.0 && length.is_finite()) {
            return self.position.map(|x| x as f32);
        }
        self.leave(normal.map(|x| x / length), direction)
    }

    /// The same for a normal of unit length, up to rounding.
    ///
    /// ```
    /// use lookfrom_bvh::Point;
    /// let point = Point { position: [0.25, 0.25, 1.0], error: [0.0; 3] };
    /// assert_eq!(point.leave([0.0, 0.0, 1.0], [0.5_f32, 0.0, -1.0])[2], 1.0_f32.next_down());
    /// ```
    #[inline]
    pub fn leave<D: Copy + Into<f64>>(&self, unit_normal: [f64; 3], direction: [D; 3]) -> [f32; 3] {
        let direction: [f64; 3] = direction.map(Into::into);
        let side = if dot(unit_normal, direction) < 0.0 { -1.0 } else { 1.0 };
        let normal = unit_normal.map(|x| x * side);

        // The step along the normal that covers the error in its direction, and the step's own rounding.
        let step = (0..3)
            .map(|i| normal[i].abs() * (self.error[i] + 4.0 * UNIT * self.position[i].abs()))
            .sum::<f64>()
            * (1.0 + 1e-6);
        [0, 1, 2].map(|i| {
            let moved = self.position[i] + step * normal[i];
            let rounded = round_toward(moved, normal[i] > 0.0);
            if normal[i] == 0.0 { moved as f32 } else { rounded }
        })
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
