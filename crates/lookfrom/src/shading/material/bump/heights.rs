//! Heights of bump maps: compared at a point of a surface and at two next to it, for the normal of the displaced surface.
//!
//! Blinn 1978.

use glam::Vec3;
use lookfrom_simd::{Float, Real};

use super::{NormalLimit, Relief, normalized_or};
use crate::core::math::both;
use crate::core::vector::Vector;
use crate::shading::interaction::ShadingGeometry;
use crate::shading::texture::{PicturedFloat, TexturePoint};

/// An offset in u and v that is much smaller than texels.
const FINE_STEP: f32 = 0.000_02;
/// The smallest offset, in parts of u and v: differences of numbers of single precision need one.
const LEAST_STEP: f32 = 4e-6;

impl NormalLimit {
    /// Whether heights are compared at the footprint of pixels. Mitsuba differentiates pictures between their texels, whatever is seen of
    /// them.
    #[inline]
    pub(crate) fn sees_pixels(self) -> bool {
        !matches!(self, Self::Guarded(_))
    }

    /// Whether ∂p/∂u and ∂p/∂v are those of the smooth surface: the ∂p/∂v of pbrt's meshes is as long as ∂p/∂u.
    #[inline]
    pub(crate) fn takes_smooth_derivatives(self) -> bool {
        matches!(self, Self::Outward)
    }

    /// The offset in u and v without a footprint, by the usual one.
    #[inline]
    pub(crate) fn step(self, usual: f32) -> f32 {
        if self.sees_pixels() { usual } else { FINE_STEP }
    }
}

/// Two points next to one of a surface: the first further along u, the second along v. At any width.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Neighbours<R> {
    /// u of the first, v of the second.
    pub(crate) uv: [R; 2],
    /// The parts by which these are greater than at the point.
    pub(crate) steps: [R; 2],
}

impl<R: Real> Neighbours<R> {
    /// Of a point with u and v: half of a pixel's footprint away, or by a step where that is 0.
    #[inline(always)]
    pub(crate) fn new(uv: [R; 2], half: [R; 2], step: R) -> Self {
        let moved = both(
            [0, 1],
            #[inline(always)]
            |k: usize| {
                let wanted = R::select(half[k].gt(step.like(0.0)), half[k], step);
                uv[k] + Float::max(wanted, Float::abs(uv[k]) * LEAST_STEP)
            },
        );
        // As far as u or v moves in single precision.
        Self { uv: moved, steps: [moved[0] - uv[0], moved[1] - uv[1]] }
    }
}

/// The normal of the surface displaced along its shading normal, by ∂p/∂u and ∂p/∂v, the steps to [`Neighbours`], and the heights at the point
/// and there; of unit length.
#[inline(always)]
pub(crate) fn displaced_normal<R: Real>(
    n: Vector<R>,
    [along_u, along_v]: [Vector<R>; 2],
    steps: [R; 2],
    [here, further_along_u, further_along_v]: [R; 3],
) -> Vector<R> {
    // In the tangent plane of the shading normal, and up from there.
    let dpdu = along_u - n * n.dot(along_u) + n * ((further_along_u - here) / steps[0]);
    let dpdv = along_v - n * n.dot(along_v) + n * ((further_along_v - here) / steps[1]);
    let is_mirrored = along_u.cross(along_v).dot(n).lt(here.like(0.0));
    normalized_or(dpdu.cross(dpdv).negate_where(is_mirrored), n)
}

impl Neighbours<f32> {
    /// The first or the second for textures, by the point and its ∂p/∂u or ∂p/∂v.
    #[inline]
    pub(crate) fn texture_point(
        &self,
        axis: usize,
        at: &TexturePoint<'_>,
        along: Vec3,
    ) -> TexturePoint<'static> {
        let mut uv = at.uv;
        uv[axis] = self.uv[axis];
        let world = at.world + (self.steps[axis] * along).as_dvec3();
        TexturePoint { uv, world, ..at.alone() }
    }
}

/// The normal of the surface displaced along its shading normal by a bump map.
pub(super) fn displaced(
    (heights, limit): (&PicturedFloat, NormalLimit),
    relief: Relief<'_>,
    surface: &ShadingGeometry,
    at: &TexturePoint<'_>,
) -> Vector<f32> {
    let along = match limit.takes_smooth_derivatives() {
        true => [surface.dpdu, surface.dpdv],
        false => surface.derivatives,
    };
    let derivatives = along.map(Vector::from);
    let half = match relief.footprint.filter(|_| limit.sees_pixels()) {
        Some(pixels) => pixels.half(at.world.into(), surface.ng.into(), derivatives),
        None => [0.0; 2],
    };
    let neighbours = Neighbours::new(at.uv.into(), half, limit.step(relief.step));
    let height = |at: &TexturePoint<'_>| relief.textures.float(heights.texture, at);
    let further = |axis: usize| height(&neighbours.texture_point(axis, at, along[axis]));
    let heights = [height(at), further(0), further(1)];
    displaced_normal(surface.ns.into(), derivatives, neighbours.steps, heights)
}
