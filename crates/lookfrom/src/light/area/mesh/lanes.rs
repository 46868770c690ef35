//! Points of triangle lights as seen from eight points, side by side: as [`super::MeshLight`] samples them.

use glam::DVec3;
use lookfrom_simd::{Float, Real, Simd, f32x8, f64x8, mask32x8, prelude::*};

use super::spherical_triangle::SphericalTriangles;
use super::{Triangle, WORTH_DIRECTION};
use crate::core::lanes::{LANES, by_lane, gather, gather_f64};
use crate::core::points::Points;
use crate::core::vector::Vector;
use crate::core::warp;
use crate::light::area::{AreaSamples, toward_all};

/// Points of the triangle in each lane, which was chosen with a probability; `u ∈ [0, 1)²`. The triangles have one normal
/// each.
#[inline(always)]
pub(crate) fn sample_triangles<S: Simd>(
    simd: S,
    of: &[&Triangle; LANES],
    probability: f32x8<S>,
    u: [f32x8<S>; 2],
    from: Vector<f64x8<S>>,
) -> AreaSamples<f32x8<S>> {
    let corners = [
        gather(simd, &by_lane!(lane => of[lane].corners[0])),
        gather(simd, &by_lane!(lane => of[lane].corners[1])),
        gather(simd, &by_lane!(lane => of[lane].corners[2])),
    ];
    let normal = gather_f64(simd, &by_lane!(lane => of[lane].normal.unwrap_or(DVec3::Z).to_array()));
    let area = f64x8::load_array(simd, by_lane!(lane => of[lane].area));
    let [_, mut beta, mut gamma] = warp::uniform_triangle(u);

    // Large ones are sampled by direction.
    let seen = Seen::new(corners, normal, area, from);
    let (mut by_direction, mut direction_pdf) = (seen.is_large, probability);
    if by_direction.any_true() {
        let spherical = SphericalTriangles::new(seen.corners);
        let (solid_angle, is_usable) = spherical.solid_angle();
        by_direction &= probability.narrow_mask(is_usable);
        direction_pdf = Real::narrow(Real::widen(probability) / solid_angle);
        let [b, c] = spherical.sample(u);
        beta = Float::select(by_direction, b, beta);
        gamma = Float::select(by_direction, c, gamma);
    }

    let (points, _) = Points::on_triangles(corners, beta, gamma);
    let (wi, length) = toward_all(from, points.position);
    let cosine = Float::abs(normal.dot(wi.widen()));
    let density = Real::narrow(Real::widen(probability) / area * length * length / cosine);
    let pdf = Float::select(by_direction, direction_pdf, density);
    AreaSamples::new(points, normal, (wi, length), pdf)
}

/// Triangles as seen from points.
struct Seen<S: Simd> {
    /// From the points.
    corners: [Vector<f64x8<S>>; 3],
    /// The triangles large enough to be sampled by direction, as [`Triangle::worth_direction`] decides it.
    is_large: mask32x8<S>,
}

impl<S: Simd> Seen<S> {
    #[inline(always)]
    fn new(
        corners: [Vector<f32x8<S>>; 3],
        normal: Vector<f64x8<S>>,
        area: f64x8<S>,
        from: Vector<f64x8<S>>,
    ) -> Self {
        let [p0, p1, p2] = [corners[0].widen(), corners[1].widen(), corners[2].widen()];
        let (e1, e2, p0) = (p1 - p0, p2 - p0, p0 - from);
        let middle = p0 + (e1 + e2) * area.like(1.0 / 3.0);
        let distance2 = middle.dot(middle);
        let seems = area * Float::abs(normal.dot(middle)) / (distance2 * Float::sqrt(distance2));
        let is_large = Float::gt(seems, area.like(WORTH_DIRECTION)) | Float::lt(distance2, area);
        let is_large = corners[0].x.narrow_mask(is_large);
        Self { corners: [p0, p0 + e1, p0 + e2], is_large }
    }
}
