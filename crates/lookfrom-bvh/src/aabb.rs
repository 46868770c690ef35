//! Axis-aligned boxes.
//!
//! The intersection of rays with boxes is in `node`.

/// An axis-aligned box, including its faces. Empty where a minimum is above a maximum.
///
/// ```
/// use lookfrom_bvh::Aabb;
/// let unit = Aabb { min: [0.0; 3], max: [1.0; 3] };
/// assert!(!unit.is_empty());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Minimum coordinates.
    pub min: [f32; 3],
    /// Maximum coordinates.
    pub max: [f32; 3],
}

/// Coordinates beyond this (2¹⁰⁰ ≈ 1.3·10³⁰) count as infinite: no sum of a few of them overflows.
pub(crate) const LARGEST_COORDINATE: f32 = 1.267_650_6e30;

impl Aabb {
    /// The empty box.
    ///
    /// ```
    /// assert!(lookfrom_bvh::Aabb::EMPTY.is_empty());
    /// ```
    pub const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    /// The smallest box around points.
    ///
    /// ```
    /// use lookfrom_bvh::Aabb;
    /// let bounds = Aabb::around(&[[0.0, 5.0, 1.0], [2.0, 3.0, 1.0]]);
    /// assert_eq!((bounds.min, bounds.max), ([0.0, 3.0, 1.0], [2.0, 5.0, 1.0]));
    /// ```
    pub fn around(points: &[[f32; 3]]) -> Self {
        let mut result = Self::EMPTY;
        for &point in points {
            result.extend(point);
        }
        result
    }

    /// True if it contains no point.
    ///
    /// ```
    /// use lookfrom_bvh::Aabb;
    /// assert!(Aabb::around(&[]).is_empty());
    /// assert!(!Aabb::around(&[[1.0; 3]]).is_empty(), "a box of one point");
    /// ```
    pub fn is_empty(&self) -> bool {
        !(0..3).all(|axis| self.min[axis] <= self.max[axis])
    }

    /// Grows to contain a point.
    ///
    /// ```
    /// use lookfrom_bvh::Aabb;
    /// let mut bounds = Aabb::EMPTY;
    /// bounds.extend([1.0; 3]);
    /// assert_eq!(bounds, Aabb::around(&[[1.0; 3]]));
    /// ```
    pub fn extend(&mut self, point: [f32; 3]) {
        self.unite(&Self { min: point, max: point });
    }

    /// Grows to contain another box.
    ///
    /// ```
    /// use lookfrom_bvh::Aabb;
    /// let mut bounds = Aabb::around(&[[0.0; 3]]);
    /// bounds.unite(&Aabb::around(&[[1.0; 3]]));
    /// assert_eq!(bounds.max, [1.0; 3]);
    /// ```
    #[inline]
    pub fn unite(&mut self, other: &Self) {
        for axis in 0..3 {
            // Written so that it compiles to one instruction, unlike f32::min (with its rule for NaN).
            self.min[axis] = if other.min[axis] < self.min[axis] { other.min[axis] } else { self.min[axis] };
            self.max[axis] = if other.max[axis] > self.max[axis] { other.max[axis] } else { self.max[axis] };
        }
    }

    /// True if another box lies within this one.
    ///
    /// ```
    /// use lookfrom_bvh::Aabb;
    /// let unit = Aabb { min: [0.0; 3], max: [1.0; 3] };
    /// assert!(unit.contains(&Aabb::around(&[[0.0; 3], [0.5; 3]])));
    /// ```
    pub fn contains(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.min[axis] <= other.min[axis] && other.max[axis] <= self.max[axis])
    }

    /// Half of the surface area, or 10³⁰ where it is larger, so that sums and quotients of areas are finite; 0 for
    /// an empty box.
    ///
    /// ```
    /// use lookfrom_bvh::Aabb;
    /// assert_eq!(Aabb { min: [0.0; 3], max: [1.0, 2.0, 3.0] }.half_area(), 11.0);
    /// ```
    #[inline]
    pub fn half_area(&self) -> f32 {
        let [x, y, z] = [0, 1, 2].map(|axis| (self.max[axis] - self.min[axis]).max(0.0));
        (x * y + y * z + z * x).min(1e30)
    }

    /// True if it is not empty and all its coordinates are within [`LARGEST_COORDINATE`].
    pub(crate) fn is_valid(&self) -> bool {
        (0..3).all(|axis| {
            -LARGEST_COORDINATE <= self.min[axis]
                && self.min[axis] <= self.max[axis]
                && self.max[axis] <= LARGEST_COORDINATE
        })
    }

    /// The box moved outwards by at least one unit in the last place of its largest coordinate.
    ///
    /// So no box in a tree is flat, a ray within a face of a primitive's box runs inside the tree's box, and the
    /// box contains everything that a test in double precision may take for a point of the primitive.
    pub(crate) fn padded(&self) -> Self {
        let mut largest = 0.0;
        for axis in 0..3 {
            for coordinate in [self.min[axis].abs(), self.max[axis].abs()] {
                largest = if coordinate > largest { coordinate } else { largest };
            }
        }
        let pad = (largest * f32::EPSILON).max(f32::MIN_POSITIVE);
        Self { min: self.min.map(|x| x - pad), max: self.max.map(|x| x + pad) }
    }

    /// Twice the centre.
    #[inline]
    pub(crate) fn twice_center(&self) -> [f32; 3] {
        [self.min[0] + self.max[0], self.min[1] + self.max[1], self.min[2] + self.max[2]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn padding_moves_every_face() {
        for exponent in -30..30 {
            let x = 1.37 * 2.0_f32.powi(exponent);
            let exact = Aabb { min: [-x, x, x], max: [-x, x, 2.0 * x] };
            let padded = exact.padded();
            for axis in 0..3 {
                assert!(padded.min[axis] < exact.min[axis] && exact.max[axis] < padded.max[axis]);
            }
        }
    }

    #[test]
    fn empty_boxes() {
        assert!(Aabb::EMPTY.is_empty() && !Aabb::EMPTY.is_valid());
        assert_eq!(Aabb::EMPTY.half_area(), 0.0);
        assert_eq!(Aabb { min: [-1e30; 3], max: [1e30; 3] }.half_area(), 1e30);
        assert!(!Aabb { min: [0.0; 3], max: [1.0, f32::NAN, 1.0] }.is_valid());
        assert!(!Aabb { min: [0.0; 3], max: [f32::INFINITY; 3] }.is_valid());
    }
}
