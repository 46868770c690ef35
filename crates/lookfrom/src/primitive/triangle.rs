//! Points on triangles with vertex normals, texture coordinates and tangents, at any width.
//!
//! Derivatives by texture coordinates are those of the triangle's plane, as in Pharr, Jakob, Humphreys, Physically
//! Based Rendering; tangents replace `∂p/∂u` in shading.

use lookfrom_simd::{Float, Mask, Real, Simd, f32x8, f64x8, mask64x8, prelude::*};

use super::SurfacePoints;
use crate::core::points::Points;
use crate::core::vector::Vector;
use crate::core::warp;

/// The mask of comparisons in double precision.
type WideMask<R> = <<R as Real>::Double as Float>::Mask;

/// Determinants of texture coordinates below this count as degenerate.
const LEAST_DETERMINANT: f64 = 1e-9;

/// Cosine between the normals of a triangle and of its corners below which it is not lifted: that of 45°.
const LEAST_COS_OF_LIFT: f64 = 0.707;

/// Triangles with what their vertices have.
pub(crate) struct Triangles<R: Real> {
    pub(crate) positions: [Vector<R>; 3],
    /// −1 where the outside is the side from which they are clockwise, otherwise 1.
    pub(crate) orientation: R::Double,
    /// Unit shading normals, zero where unknown.
    pub(crate) normals: [Vector<R>; 3],
    pub(crate) uvs: [[R; 2]; 3],
    pub(crate) tangents: [Tangent<R>; 3],
    /// The lanes whose meshes have normals.
    pub(crate) have_normals: WideMask<R>,
    /// The lanes whose meshes have tangents.
    pub(crate) have_tangents: WideMask<R>,
    /// The lanes that need derivatives by texture coordinates; in others they are 0.
    pub(crate) want_derivatives: WideMask<R>,
    /// The lanes whose meshes stand for smooth surfaces ([`Mesh::is_lifted`](super::Mesh::is_lifted)).
    pub(crate) are_lifted: WideMask<R>,
}

impl Triangles<f32> {
    /// This triangle in each lane.
    #[inline(always)]
    pub(crate) fn splat<S: Simd>(&self, simd: S) -> Triangles<f32x8<S>> {
        let like = f32x8::splat(simd, 0.0);
        let mut triangles = Triangles {
            positions: [Vector::splat(like, [0.0; 3]); 3],
            orientation: f64x8::splat(simd, self.orientation),
            normals: [Vector::splat(like, [0.0; 3]); 3],
            uvs: [[like; 2]; 3],
            tangents: [Tangent { along: Vector::splat(like, [0.0; 3]), sign: like }; 3],
            have_normals: mask64x8::splat(simd, self.have_normals),
            have_tangents: mask64x8::splat(simd, self.have_tangents),
            want_derivatives: mask64x8::splat(simd, self.want_derivatives),
            are_lifted: mask64x8::splat(simd, self.are_lifted),
        };
        for corner in 0..3 {
            let ([u, v], Tangent { along, sign }) = (self.uvs[corner], self.tangents[corner]);
            triangles.positions[corner] = Vector::splat(like, self.positions[corner].into());
            triangles.normals[corner] = Vector::splat(like, self.normals[corner].into());
            triangles.uvs[corner] = [f32x8::splat(simd, u), f32x8::splat(simd, v)];
            triangles.tangents[corner] =
                Tangent { along: Vector::splat(like, along.into()), sign: f32x8::splat(simd, sign) };
        }
        triangles
    }
}

/// A tangent in the direction of u, and the sign of the bitangent.
#[derive(Clone, Copy)]
pub(crate) struct Tangent<R> {
    pub(crate) along: Vector<R>,
    pub(crate) sign: R,
}

impl<R: Real> Triangles<R> {
    /// The points with weight `u` of the second corners and `v` of the third.
    #[inline(always)]
    pub(crate) fn points(&self, u: R, v: R) -> SurfacePoints<R> {
        let (points, across) = Points::on_triangles(self.positions, u, v);
        let winding = across.normalize();
        let mut ng = winding * self.orientation;
        let weights = [u.like(1.0) - u - v, u, v];

        // The normals of the vertices, not the winding, decide which side is outside.
        let mut ns = ng;
        let mut is_smooth = self.have_normals;
        if is_smooth.any() {
            let (mixed, has_length) = mix(weights, self.normals).widen().try_normalize();
            is_smooth = is_smooth & has_length;
            ng = ng.negate_where(is_smooth & mixed.dot(ng).lt(ng.x.like(0.0)));
            ns = Vector::select(is_smooth, mixed, ng);
        }
        let [uv0, uv1, uv2] = self.uvs;
        let uv = [
            weights[0] * uv0[0] + weights[1] * uv1[0] + weights[2] * uv2[0],
            weights[0] * uv0[1] + weights[1] * uv1[1] + weights[2] * uv2[1],
        ];
        let zero = ng.x.like(0.0);
        let none = Vector { x: zero, y: zero, z: zero };
        let mut result = SurfacePoints {
            points,
            ng,
            ns,
            uv,
            dpdu: none,
            dpdv: none,
            shading_dpdu: none,
            shading_dpdv: none,
            lift: none,
        };
        let is_lifted = is_smooth & self.are_lifted;
        if is_lifted.any() {
            result.lift = Vector::select(is_lifted, self.lift(weights, ng), none);
        }
        if self.want_derivatives.any() {
            self.derive(&mut result, winding, weights, is_smooth);
        }
        result
    }

    /// The way from points to the smooth surface that the triangles stand for: with the weights of the corners, the ways up
    /// to their tangent planes (Hanika 2021, "Hacking the Shadow Terminator", eq. 4.1). Zero where the surface is hollow, and
    /// where a corner's normal leans so far from the triangle's that it was hardly meant to be a part of a smooth surface.
    #[inline(always)]
    fn lift(&self, [w0, w1, w2]: [R; 3], ng: Vector<R::Double>) -> Vector<R::Double> {
        let [p0, p1, p2] = self.positions;
        let zero = w0.like(0.0);
        let (e1, e2) = (p1 - p0, p2 - p0);
        let from_first = e1 * w1 + e2 * w2;
        let ways = [from_first, from_first - e1, from_first - e2];
        let mut is_gentle = ng.x.like(0.0).lt(ng.x.like(1.0));
        let mut lift = Vector { x: zero, y: zero, z: zero };
        let mut corner = 0;
        while corner < 3 {
            let n = self.normals[corner];
            let below = Float::min(ways[corner].dot(n), zero);
            lift = lift - n * (below * [w0, w1, w2][corner]);
            is_gentle = is_gentle & n.widen().dot(ng).gt(ng.x.like(LEAST_COS_OF_LIFT));
            corner += 1;
        }
        let lift = lift.widen();
        let none = Vector { x: ng.x.like(0.0), y: ng.x.like(0.0), z: ng.x.like(0.0) };
        Vector::select(is_gentle, lift, none)
    }

    /// Adds the derivatives.
    #[inline(always)]
    fn derive(
        &self,
        at: &mut SurfacePoints<R>,
        winding: Vector<R::Double>,
        weights: [R; 3],
        is_smooth: WideMask<R>,
    ) {
        let [dpdu, dpdv] = self.plane_derivatives(winding);
        let zero = dpdu.x.like(0.0);

        // Rotate the derivatives into the plane perpendicular to the interpolated normal.
        let (mut along, mut is_left) = (dpdu, is_smooth.like(true));
        let mut is_turned = is_smooth;
        if self.have_tangents.any() {
            let [a, b, c] = self.tangents;
            let tangent = mix(weights, [a.along, b.along, c.along]).widen();
            let sign = (weights[0] * a.sign + weights[1] * b.sign + weights[2] * c.sign).widen();
            let has_tangent = self.have_tangents & !is_zero(tangent);
            along = Vector::select(has_tangent, tangent, along);
            is_left = !has_tangent | sign.gt(zero) | Float::eq(sign, zero);
            is_turned = is_turned | has_tangent;
        }
        let (mut shading_dpdu, mut shading_dpdv) = (dpdu, dpdv);
        if is_turned.any() {
            let across = at.ns.cross(along);
            let is_across = across.length_squared().gt(zero);
            let (s, t) = warp::basis_about(Vector::<R>::narrow(at.ns));
            let turned_dpdu = Vector::select(is_across, across.cross(at.ns), s.widen());
            let turned_dpdv = Vector::select(is_across, across.negate_where(!is_left), t.widen());
            shading_dpdu = Vector::select(is_turned, turned_dpdu, shading_dpdu);
            shading_dpdv = Vector::select(is_turned, turned_dpdv, shading_dpdv);
        }
        let wanted = self.want_derivatives;
        at.dpdu = Vector::select(wanted, dpdu, at.dpdu);
        at.dpdv = Vector::select(wanted, dpdv, at.dpdv);
        at.shading_dpdu = Vector::select(wanted, shading_dpdu, at.shading_dpdu);
        at.shading_dpdv = Vector::select(wanted, shading_dpdv, at.shading_dpdv);
    }

    /// `∂p/∂u` and `∂p/∂v` in the triangles' planes; any two directions there where texture coordinates are degenerate.
    #[inline(always)]
    fn plane_derivatives(&self, winding: Vector<R::Double>) -> [Vector<R::Double>; 2] {
        let [p0, p1, p2] = [self.positions[0].widen(), self.positions[1].widen(), self.positions[2].widen()];
        let [uv0, uv1, uv2] = self.uvs;
        let [u2, v2] = [uv2[0].widen(), uv2[1].widen()];
        let along0 = [uv0[0].widen() - u2, uv0[1].widen() - v2];
        let along1 = [uv1[0].widen() - u2, uv1[1].widen() - v2];
        let (edge0, edge1) = (p0 - p2, p1 - p2);
        let determinant = along0[0] * along1[1] - along0[1] * along1[0];
        let dpdu = over(edge0 * along1[1] - edge1 * along0[1], determinant);
        let dpdv = over(edge1 * along0[0] - edge0 * along1[0], determinant);
        let is_small = Float::abs(determinant).lt(determinant.like(LEAST_DETERMINANT));
        let is_regular = !is_small & is_finite(dpdu) & is_finite(dpdv);
        if is_regular.all() {
            return [dpdu, dpdv];
        }
        let (s, t) = warp::basis_about(-Vector::<R>::narrow(winding));
        [Vector::select(is_regular, dpdu, s.widen()), Vector::select(is_regular, dpdv, t.widen())]
    }
}

#[inline(always)]
fn mix<R: Real>(weights: [R; 3], [a, b, c]: [Vector<R>; 3]) -> Vector<R> {
    a * weights[0] + b * weights[1] + c * weights[2]
}

#[inline(always)]
fn over<F: Float>(v: Vector<F>, divisor: F) -> Vector<F> {
    Vector { x: v.x / divisor, y: v.y / divisor, z: v.z / divisor }
}

#[inline(always)]
fn is_zero<F: Float<Scalar = f64>>(v: Vector<F>) -> F::Mask {
    let zero = v.x.like(0.0);
    Float::eq(v.x, zero) & Float::eq(v.y, zero) & Float::eq(v.z, zero)
}

#[inline(always)]
fn is_finite<F: Float>(v: Vector<F>) -> F::Mask {
    Float::is_finite(v.x) & Float::is_finite(v.y) & Float::is_finite(v.z)
}
