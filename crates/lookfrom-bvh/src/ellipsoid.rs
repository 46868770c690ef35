//! The nearest point of an ellipsoid, the affine image of a sphere: Eberly (2013).
//!
//! Its axes come from Hestenes (1958), "Inversion of Matrices by Biorthogonalization and Related Results": columns
//! are rotated in pairs until they are orthogonal, which keeps short axes as exact as long ones. The point then
//! results from an equation in one unknown, by bisection: Eberly (2013), "Distance from a Point to an Ellipse, an
//! Ellipsoid, or a Hyperellipsoid".

use crate::nearest::Nearest;
use crate::vector::dot;

/// Maximum number of sweeps over all pairs of columns; a handful is enough.
const SWEEPS: usize = 32;

/// Number of bisections of an interval of f64 until nothing is between its ends, with a margin.
const HALVINGS: usize = 2200;

/// The point nearest to 0 on an ellipsoid: the image under a matrix (by rows) of the sphere around 0 with a radius,
/// translated to `center`.
pub(crate) fn nearest_on_ellipsoid(center: [f64; 3], matrix: &[[f64; 3]; 3], radius: f64) -> Nearest {
    // Scale to sizes about 1, so that squares are in range.
    let largest = matrix.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs())) * radius;
    let axes =
        orthogonal([0, 1, 2].map(|column| [0, 1, 2].map(|row| matrix[row][column] * radius / largest)));
    let lengths = axes.map(|axis| dot(axis, axis).sqrt());

    // Coordinates along the axes; the signs are restored at the end.
    let at = [0, 1, 2].map(|i| -dot(center, axes[i]) / (lengths[i] * largest));
    let nearest = nearest_in_octant(lengths, at.map(f64::abs));
    let mut offset = center;
    let mut square = 0.0;
    for i in 0..3 {
        let coordinate = nearest[i].copysign(at[i]);
        square += (coordinate - at[i]) * (coordinate - at[i]);
        for axis in 0..3 {
            offset[axis] += coordinate * largest * axes[i][axis] / lengths[i];
        }
    }
    Nearest { offset, distance: square.sqrt() * largest, u: 0.0, v: 0.0 }
}

/// Rotates vectors in pairs until they are orthogonal: the semi-axes of the ellipsoid that they span.
fn orthogonal(mut columns: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    for _ in 0..SWEEPS {
        let mut turned = false;
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let (p, q) = (columns[i], columns[j]);
            let (pp, qq, pq) = (dot(p, p), dot(q, q), dot(p, q));
            if pq.abs() <= f64::EPSILON * (pp * qq).sqrt() {
                continue;
            }
            turned = true;
            let half = (qq - pp) / (2.0 * pq);
            let tangent = 1.0_f64.copysign(half) / (half.abs() + (1.0 + half * half).sqrt());
            let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
            let sine = cosine * tangent;
            columns[i] = [0, 1, 2].map(|axis| cosine * p[axis] - sine * q[axis]);
            columns[j] = [0, 1, 2].map(|axis| sine * p[axis] + cosine * q[axis]);
        }
        if !turned {
            break;
        }
    }
    columns
}

/// The nearest point on the ellipsoid along the axes, for a point whose coordinates are not negative.
///
/// It is `xᵢ = eᵢ² yᵢ / (λ + eᵢ²)`, with λ above −e² of the shortest axis e, such that x is on the ellipsoid.
fn nearest_in_octant(lengths: [f64; 3], y: [f64; 3]) -> [f64; 3] {
    let shortest = (1..3).fold(0, |least, i| if lengths[i] < lengths[least] { i } else { least });
    let e = lengths[shortest];

    // In units of e²: λ = e² (s − 1). Then xᵢ = rᵢ yᵢ / (s + rᵢ − 1), with rᵢ the square of eᵢ / e, and
    // the sum of (eᵢ yᵢ / e² / (s + rᵢ − 1))² must be 1.
    let ratio = lengths.map(|length| (length / e) * (length / e));
    let excess = lengths.map(|length| ((length - e) / e) * ((length + e) / e));
    let z = [0, 1, 2].map(|i| lengths[i] / e * (y[i] / e));
    let sum = |s: f64| {
        (0..3).filter(|&i| z[i] > 0.0).fold(0.0, |sum, i| {
            let quotient = z[i] / (s + excess[i]);
            sum + quotient * quotient
        })
    };
    let (mut low, mut high) = (z[shortest], dot(z, z).sqrt());
    if z[shortest] == 0.0 && sum(0.0) <= 1.0 {
        // In the middle plane, near the centre: the missing part goes along the shortest axis.
        let mut x = [0, 1, 2].map(|i| if z[i] > 0.0 { ratio[i] * y[i] / excess[i] } else { 0.0 });
        let missing = (0..3).filter(|&i| i != shortest).fold(1.0, |missing, i| {
            let share = x[i] / lengths[i];
            missing - share * share
        });
        x[shortest] = e * missing.max(0.0).sqrt();
        return x;
    }
    for _ in 0..HALVINGS {
        let middle = low + 0.5 * (high - low);
        if middle <= low || middle >= high {
            break;
        }
        if sum(middle) > 1.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    [0, 1, 2].map(|i| if y[i] > 0.0 { ratio[i] * y[i] / (high + excess[i]) } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    #[test]
    fn spheres_of_any_size() {
        let mut random = Random::new(3);
        for _ in 0..2000 {
            let radius = f64::from(random.size(-8, 8));
            let scale = f64::from(random.size(-3, 3));
            let center = random.point_with_exponents(-8, 8).map(f64::from);
            let matrix =
                [[0.0, -scale, 0.0], [0.6 * scale, 0.0, 0.8 * scale], [-0.8 * scale, 0.0, 0.6 * scale]];
            let nearest = nearest_on_ellipsoid(center, &matrix, radius);
            let length = dot(center, center).sqrt();
            let expected = (length - radius * scale).abs();
            let size = length + radius * scale;
            assert!((nearest.distance - expected).abs() < 1e-13 * size, "{nearest:?} {expected}");
        }
    }

    #[test]
    fn no_point_of_an_ellipsoid_is_nearer() {
        let mut random = Random::new(4);
        for round in 0..3000 {
            let mut matrix = [[0; 3]; 3].map(|row| row.map(|_| f64::from(random.unit() - 0.5)));
            let stretch = [0; 3].map(|_| f64::from(random.size(-4, 4)));
            matrix.iter_mut().for_each(|row| (0..3).for_each(|i| row[i] *= stretch[i]));
            let center = match round % 3 {
                0 => [0.0; 3],
                1 => matrix.map(|row| 0.3 * row[0]),
                _ => random.point_with_exponents(-4, 4).map(f64::from),
            };
            let nearest = nearest_on_ellipsoid(center, &matrix, 1.0);
            let length = dot(nearest.offset, nearest.offset).sqrt();
            let largest = matrix.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
            let size = largest + dot(center, center).sqrt();
            assert!((length - nearest.distance).abs() <= 1e-12 * size, "{nearest:?}: {length}");
            for _ in 0..100 {
                let direction = random.direction().map(f64::from);
                let norm = dot(direction, direction).sqrt();
                let on = matrix.map(|row| dot(row, direction) / norm);
                let other = [0, 1, 2].map(|i| center[i] + on[i]);
                assert!(nearest.distance <= dot(other, other).sqrt() + 1e-12 * size, "{nearest:?} {other:?}");
            }
        }
    }
}
