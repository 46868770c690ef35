//! The nearest point of a primitive, and that of a triangle.

use crate::vector::{cross, dot, subtract};

/// The nearest point of a primitive.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    /// Relative to the query point.
    pub(crate) offset: [f64; 3],
    pub(crate) distance: f64,
    pub(crate) u: f64,
    pub(crate) v: f64,
}

/// The triangle's point nearest to 0: the foot of the perpendicular where that is inside, else the best on the
/// edges.
///
/// Each candidate is a convex combination of corners, so it is on the triangle however thin that is.
pub(crate) fn nearest_on_triangle(&[a, b, c]: &[[f64; 3]; 3]) -> Nearest {
    let candidate = |u: f64, v: f64| {
        let w = 1.0 - u - v;
        let offset = [0, 1, 2].map(|axis| w * a[axis] + u * b[axis] + v * c[axis]);
        Nearest { offset, distance: dot(offset, offset).sqrt(), u, v }
    };

    // The edges, in the order of their corners.
    let along = |from: [f64; 3], to: [f64; 3]| {
        let edge = subtract(to, from);
        let length = dot(edge, edge);
        if length > 0.0 { (-dot(from, edge) / length).clamp(0.0, 1.0) } else { 0.0 }
    };
    let s = along(b, c);
    let mut best = candidate(along(a, b), 0.0);
    for other in [candidate(0.0, along(a, c)), candidate(1.0 - s, s)] {
        if other.distance < best.distance {
            best = other;
        }
    }

    // The foot of the perpendicular.
    let [e1, e2] = [subtract(b, a), subtract(c, a)];
    let n = cross(e1, e2);
    let area = dot(n, n);
    let u = dot(cross(e2, a), n) / area;
    let v = dot(cross(a, e1), n) / area;
    if u >= 0.0 && v >= 0.0 && u + v <= 1.0 {
        let foot = candidate(u, v);
        if foot.distance < best.distance {
            best = foot;
        }
    }
    best
}
