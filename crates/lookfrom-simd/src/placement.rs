//! Affine maps at any width: points of objects in the world, with bounds of their errors.

use crate::points::Points;
use crate::real::{Float, Real};
use crate::rounding::{UNIT, UNIT32};
use crate::vector::Vector;

/// Affine maps, with what bounds of errors need.
#[derive(Clone, Copy, Debug)]
pub struct Placement<R: Real> {
    /// The linear part, by rows.
    pub matrix: [Vector<R::Double>; 3],
    /// The image of the origin.
    pub translation: Vector<R::Double>,
    /// The inverse of the linear part, by rows.
    pub inverse: [Vector<R::Double>; 3],
    /// The [`amplification`] of errors.
    pub amplification: [Vector<R::Double>; 3],
}

/// The amplification of errors by the linear part of a map and its inverse, by rows: |M M⁻¹ − 1| and a bound of the
/// rounding in it.
pub fn amplification(matrix: &[[f64; 3]; 3], inverse: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|i| {
        [0, 1, 2].map(|j| {
            let mut product = if i == j { -1.0 } else { 0.0 };
            let mut magnitude = 0.0;
            for k in 0..3 {
                product += matrix[i][k] * inverse[k][j];
                magnitude += (matrix[i][k] * inverse[k][j]).abs();
            }
            product.abs() + 8.0 * UNIT * magnitude
        })
    })
}

impl<R: Real> Placement<R> {
    /// The images of directions.
    #[inline(always)]
    pub fn vector(&self, v: Vector<R::Double>) -> Vector<R::Double> {
        let [x, y, z] = self.matrix;
        Vector { x: x.dot(v), y: y.dot(v), z: z.dot(v) }
    }

    /// The directions whose images these are.
    #[inline(always)]
    pub fn vector_back(&self, v: Vector<R::Double>) -> Vector<R::Double> {
        let [x, y, z] = self.inverse;
        Vector { x: x.dot(v), y: y.dot(v), z: z.dot(v) }
    }

    /// The images of surface normals; not of unit length.
    #[inline(always)]
    pub fn normal(&self, n: Vector<R::Double>) -> Vector<R::Double> {
        let [x, y, z] = self.inverse;
        x * n.x + y * n.y + z * n.z
    }
}

impl<R: Real> Points<R> {
    /// The points under affine maps, for hits in instances.
    ///
    /// The bound grows by the rounding errors here and by those of the ray on its transformation to the object's
    /// space, including its rounding to f32 there (for procedural shapes).
    #[inline(always)]
    pub fn placed(&self, placement: &Placement<R>) -> Self {
        let Placement { matrix: [a, b, c], translation, amplification: [d, e, f], .. } = *placement;
        let relative = placement.vector(self.position);
        let position = relative + translation;
        let size = self.position.abs();
        let way = relative.abs() * size.x.like(1.0 + 1e-6);
        // Per coordinate of the object: the error there, with the rounding of the ray's origin to f32.
        let unit = way.x.like(UNIT32 * (1.0 + 1e-6));
        let own = [
            self.error.x + size.x * (8.0 * UNIT) + unit * size.x,
            self.error.y + size.y * (8.0 * UNIT) + unit * size.y,
            self.error.z + size.z * (8.0 * UNIT) + unit * size.z,
        ];
        let ends = way + translation.abs() + position.abs();
        let error = Vector {
            x: carried(d, way, a, own) + ends.x * (4.0 * UNIT),
            y: carried(e, way, b, own) + ends.y * (4.0 * UNIT),
            z: carried(f, way, c, own) + ends.z * (4.0 * UNIT),
        };
        Self { position, error }
    }
}

/// One coordinate of the error that a map carries over: of rows of its amplification and of its matrix.
#[inline(always)]
fn carried<D: Float>(amplification: Vector<D>, way: Vector<D>, row: Vector<D>, own: [D; 3]) -> D {
    let row = row.abs();
    let x = amplification.x * way.x + row.x * own[0];
    let y = x + amplification.y * way.y + row.y * own[1];
    y + amplification.z * way.z + row.z * own[2]
}
