//! Directions on an octahedron, unfolded to a square: only sums, products and roots (Cigolle et al. 2014).

use glam::Vec3;

/// A direction as a point of the octahedron |x| + |y| + |z| = 1.
///
/// An area of the square −1 … 1, of which the octahedron's faces are projections along z, has 1 / `length`³ of its
/// size as solid angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Direction(Vec3);

impl Direction {
    /// At a point of the square.
    #[inline]
    pub(super) fn of_square([x, y]: [f32; 2]) -> Self {
        let z = 1.0 - x.abs() - y.abs();
        let fold = (-z).max(0.0);
        Self(Vec3::new(x - fold.copysign(x), y - fold.copysign(y), z))
    }

    /// The direction of a vector of unit length.
    #[inline]
    pub(super) fn of_unit(direction: Vec3) -> Self {
        let size = direction.abs();
        Self(direction / (size.x + size.y + size.z))
    }

    /// Its point of the square.
    #[inline]
    pub(super) fn square(self) -> [f32; 2] {
        let Vec3 { x, y, z } = self.0;
        match z < 0.0 {
            true => [(1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y)],
            false => [x, y],
        }
    }

    /// Distance of its point of the octahedron from the middle: 1/√3 … 1.
    #[inline]
    pub(super) fn length(self) -> f32 {
        self.0.length()
    }

    /// Its vector of unit length.
    #[inline]
    pub(super) fn unit(self) -> Vec3 {
        self.0 / self.0.length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_and_directions_are_inverse() {
        for k in 0..10_000_u16 {
            let square = [k % 100, k / 100].map(|i| (f32::from(i) + 0.5) / 50.0 - 1.0);
            let direction = Direction::of_square(square);
            let unit = direction.unit();
            assert!((unit.length() - 1.0).abs() < 1e-6);
            let back = Direction::of_unit(unit);
            assert!((0..2).all(|i| (back.square()[i] - square[i]).abs() < 1e-5), "{square:?} {back:?}");
            assert!((back.length() - direction.length()).abs() < 1e-6);
        }
    }

    #[test]
    fn solid_angles_make_a_sphere() {
        const SIDE: u32 = 500;
        let place = |i: u32| (i as f32 + 0.5) / SIDE as f32 * 2.0 - 1.0;
        let sum: f64 = (0..SIDE * SIDE)
            .map(|k| Direction::of_square([place(k % SIDE), place(k / SIDE)]).length())
            .map(|length| f64::from(length * length * length).recip())
            .sum();
        let sphere = sum * 4.0 / f64::from(SIDE * SIDE);
        assert!((sphere / (4.0 * std::f64::consts::PI) - 1.0).abs() < 1e-4, "{sphere}");
    }
}
