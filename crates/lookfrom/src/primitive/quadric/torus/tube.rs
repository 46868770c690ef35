//! Points on the tubes of tori, at any width.

use lookfrom_simd::Float;

use crate::core::vector::Vector;

/// The tubes around circles in the plane z = 0 of object space.
pub(in crate::primitive::quadric) struct Tubes<F> {
    /// Of the circles in the middle of the tubes.
    pub(in crate::primitive::quadric) radius: F,
    /// Of the tubes.
    pub(in crate::primitive::quadric) tube: F,
}

/// Points in the half planes that they span with the axis, relative to the middle of the tube.
pub(super) struct Section<F> {
    /// The directions away from the axis: x and y.
    pub(super) away: [F; 2],
    /// Distances from the axis.
    pub(super) ring: F,
    /// Along `away`, and along the axis.
    pub(super) offset: [F; 2],
}

impl<F: Float<Scalar = f64>> Tubes<F> {
    #[inline(always)]
    pub(super) fn section(&self, p: Vector<F>) -> Section<F> {
        let (zero, one) = (p.x.like(0.0), p.x.like(1.0));
        let ring = (p.x * p.x + p.y * p.y).sqrt();
        let is_beside = ring.gt(zero);
        let away = [F::select(is_beside, p.x / ring, one), F::select(is_beside, p.y / ring, zero)];
        Section { away, ring, offset: [ring - self.radius, p.z] }
    }

    /// The points of the surfaces nearest to ones that are on them up to errors.
    #[inline(always)]
    pub(in crate::primitive::quadric) fn refined(&self, p: Vector<F>) -> Vector<F> {
        let [x, y] = self.section(p).away;
        Vector::new(x * self.radius, y * self.radius, p.x.like(0.0)) + self.outward(p) * self.tube
    }

    /// The unit normals at points of the surfaces.
    #[inline(always)]
    pub(in crate::primitive::quadric) fn outward(&self, p: Vector<F>) -> Vector<F> {
        let Section { away: [x, y], offset: [across, along], .. } = self.section(p);
        let (normal, exists) = Vector::new(x * across, y * across, along).try_normalize();
        Vector::select(exists, normal, Vector::new(x, y, p.x.like(0.0)))
    }

    /// The smaller radii of curvature at points of the surfaces; where a tube meets itself on the axis, one that is small.
    #[inline(always)]
    pub(in crate::primitive::quadric) fn radius_of_curvature(&self, p: Vector<F>) -> F {
        let Section { ring, offset: [across, _], .. } = self.section(p);
        let around_axis = ring * self.tube / across.abs();
        Float::min(self.tube, Float::max(around_axis, self.tube * self.tube.like(1e-6)))
    }
}
