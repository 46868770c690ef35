//! The importance of a cluster of lights at a point, at any width (Conty Estevez & Kulla 2018).

use lookfrom_simd::{Float, Real, Simd, f32x8};

use crate::core::lanes::{LANES, by_lane, gather_four};
use crate::core::vector::Vector;

/// Light bounds in the form that importances are computed from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight<R = f32> {
    pub(super) center: Vector<R>,
    /// Radius of the sphere around the box.
    pub(super) radius: R,
    pub(super) axis: Vector<R>,
    pub(super) cos_normals: R,
    pub(super) sin_normals: R,
    pub(super) cos_emission: R,
    pub(super) power: R,
    /// 1 where both sides emit light, else 0.
    pub(super) two_sided: R,
}

impl Sight {
    /// One in each lane.
    #[inline(always)]
    pub(super) fn gather<S: Simd>(simd: S, rows: &[&Self; LANES]) -> Sight<f32x8<S>> {
        let [x, y, z, radius] = gather_four(
            simd,
            &by_lane!(lane => {
                let Self { center: Vector { x, y, z }, radius, .. } = *rows[lane];
                [x, y, z, radius]
            }),
        );
        let center = Vector { x, y, z };
        let [x, y, z, cos_normals] = gather_four(
            simd,
            &by_lane!(lane => {
                let Self { axis: Vector { x, y, z }, cos_normals, .. } = *rows[lane];
                [x, y, z, cos_normals]
            }),
        );
        let axis = Vector { x, y, z };
        let [sin_normals, cos_emission, power, two_sided] = gather_four(
            simd,
            &by_lane!(lane => {
                let Self { sin_normals, cos_emission, power, two_sided, .. } = *rows[lane];
                [sin_normals, cos_emission, power, two_sided]
            }),
        );
        Sight { center, radius, axis, cos_normals, sin_normals, cos_emission, power, two_sided }
    }
}

/// Bounds of lights as seen from a point: their importance, and what it follows from. Angles are cosine and sine.
#[derive(Clone, Copy)]
pub(super) struct Seen<R: Real = f32> {
    /// From the box's centre to the point.
    pub(super) to_p: Vector<R>,
    /// The square of its length.
    pub(super) length2: R,
    /// θ_w: between it and the axis of the normals, or, of two-sided lights, the nearer end of the axis.
    pub(super) to_axis: (R, R),
    /// θ_b: half the angle that the box subtends; π within its sphere.
    pub(super) of_box: (R, R),
    /// θ_i: between the direction to the centre and the surface's normal, on either side.
    pub(super) at_surface: (R, R),
    /// Cosine of θ': the least angle to a normal of the lights at which they may emit light toward the point.
    pub(super) cos_least: R,
    /// Cosine of θᵢ': the least angle to the surface's normal at which their light may arrive; 1 where there is none.
    pub(super) cos_incident: R,
    /// Whether angles count: neither at the centre nor so far away that squares leave the range of f32.
    pub(super) is_usual: R::Mask,
    /// An upper bound, up to the variation of distance within the bounds, of the light that arrives. Finite, and positive
    /// where any light may arrive.
    pub(super) importance: R,
}

impl<R: Real> Sight<R> {
    /// [`Seen::importance`] from `p` with normal `n`.
    #[inline(always)]
    pub(super) fn importance(&self, p: Vector<R>, n: Vector<R>) -> R {
        self.seen(p, n).importance
    }

    /// The bounds as seen from `p` with normal `n`.
    #[inline(always)]
    pub(super) fn seen(&self, p: Vector<R>, n: Vector<R>) -> Seen<R> {
        let (zero, one) = (p.x.like(0.0), p.x.like(1.0));
        let to_p = p - self.center;
        let length2 = to_p.length_squared();
        // Near and inside the box, the distance to its centre is meaningless.
        let by_distance = self.power / Float::max(length2, self.radius);
        let wi = to_p * (one / Float::sqrt(length2));

        // θ to the axis, less the spread of the normals, less the angle that the box subtends.
        let cos_axis = self.axis.dot(wi);
        let cos_axis = R::select(self.two_sided.gt(zero), Float::abs(cos_axis), cos_axis);
        let to_axis = (cos_axis, sin_of(cos_axis));
        let radius2 = self.radius * self.radius;
        let is_outside = length2.gt(radius2);
        let sin2 = radius2 / length2;
        let cos_box = R::select(is_outside, Float::sqrt(Float::max(one - sin2, zero)), -one);
        let sin_box = R::select(is_outside, Float::sqrt(sin2), zero);
        let of_box = (cos_box, sin_box);
        let to_normals = angle_less(to_axis, (self.cos_normals, self.sin_normals));
        let (cos_least, _) = angle_less(to_normals, of_box);
        // At the surface: the smallest angle between its normal and the box, on either side.
        let cos_surface = Float::abs(wi.dot(n));
        let at_surface = (cos_surface, sin_of(cos_surface));
        let (cos_incident, _) = angle_less(at_surface, of_box);
        let has_normal = n.length_squared().gt(zero);
        let cos_incident = R::select(has_normal, cos_incident, one);
        let directed =
            R::select(cos_least.gt(self.cos_emission), bounded(by_distance * cos_least * cos_incident), zero);
        let is_usual = !length2.lt(length2.like(1e-36)) & length2.lt(length2.like(1e36));
        let importance = R::select(is_usual, directed, bounded(by_distance));
        Seen { to_p, length2, to_axis, of_box, at_surface, cos_least, cos_incident, is_usual, importance }
    }
}

/// Within the range in which neither the sum nor the ratio of two importances leaves that of f32.
#[inline(always)]
fn bounded<R: Real>(importance: R) -> R {
    Float::clamp(importance, 1e-30, 1e30)
}

/// The probability of the first of two children, given their importances, and whether either can be chosen.
#[inline(always)]
pub(super) fn probability_of_first<R: Real>([first, second]: [R; 2]) -> (R, R::Mask) {
    /// Least probability of a child of positive importance: the other one may be hidden.
    const LEAST: f32 = 1.0 / 65536.0;
    let zero = first.like(0.0);
    let sum = first + second;
    let share = first / sum;
    let both = first.gt(zero) & second.gt(zero);
    (R::select(both, Float::clamp(share, LEAST, 1.0 - LEAST), share), sum.gt(zero))
}

/// The sine of an angle within 0 … π, by its cosine.
#[inline(always)]
pub(super) fn sin_of<R: Real>(cos: R) -> R {
    let one = cos.like(1.0);
    Float::sqrt(Float::max(one - cos * cos, cos.like(0.0)))
}

/// Cosine and sine of max(0, a − b), for angles given by cosine and sine.
#[inline(always)]
fn angle_less<R: Real>((cos_a, sin_a): (R, R), (cos_b, sin_b): (R, R)) -> (R, R) {
    let (zero, one) = (cos_a.like(0.0), cos_a.like(1.0));
    let is_within = cos_a.gt(cos_b);
    (
        R::select(is_within, one, cos_a * cos_b + sin_a * sin_b),
        R::select(is_within, zero, sin_a * cos_b - cos_a * sin_b),
    )
}
