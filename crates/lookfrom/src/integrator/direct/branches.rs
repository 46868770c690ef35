//! The branches of Whitted's tree at eight plain surfaces side by side. The bits are those of
//! [`Coefficients::branches`](crate::shading::material::Coefficients::branches).

use lookfrom_simd::{Float, Real, Simd, f32x8, mask32x8, prelude::*};

use super::surfaces::Surfaces;
use crate::core::lanes::{LANES, by_lane, gather_spectrum, scatter, scatter_spectrum};
use crate::core::optics;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::shading::material::Coefficients;

/// The reflected and the refracted rays of eight surfaces.
pub(super) struct Branches {
    pub(super) mirrored: Rays,
    pub(super) refracted: Rays,
}

/// The rays of one kind.
pub(super) struct Rays {
    /// Bit i for lane i: whether there is a ray at all.
    pub(super) exist: u32,
    /// The throughput of the path that goes on.
    pub(super) beta: [Spectrum; LANES],
    pub(super) origin: [[f32; 3]; LANES],
    pub(super) direction: [[f32; 3]; LANES],
}

impl Branches {
    /// The branches where any of the surfaces has some.
    #[inline(always)]
    pub(super) fn of<S: Simd>(
        simd: S,
        coefficients: &[Coefficients; LANES],
        surfaces: &Surfaces<S>,
        beta: Spectrum<f32x8<S>>,
    ) -> Option<Self> {
        if coefficients.iter().all(|k| k.mirror.is_black() && k.transmission.is_black()) {
            return None;
        }
        let k_r = gather_spectrum(simd, &by_lane!(lane => coefficients[lane].mirror));
        let k_t = gather_spectrum(simd, &by_lane!(lane => coefficients[lane].transmission));
        let (no_mirror, no_transmission) = (k_r.is_black(), k_t.is_black());
        let has_branches = !(no_mirror & no_transmission);
        let Surfaces { wo, ns_facing: n, front, .. } = *surfaces;
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let ior = f32x8::load_array(simd, by_lane!(lane => coefficients[lane].ior));
        let front = mask32x8::from_bitmask(simd, front.to_bitmask());
        let eta = f32x8::select(front, ior, one / ior);
        let (bent, is_bent) = optics::refract(wo, n, eta);
        let part = optics::fresnel_dielectric(n.dot(wo), eta);
        let greater = Spectrum([
            Float::max(k_r.0[0], k_t.0[0]),
            Float::max(k_r.0[1], k_t.0[1]),
            Float::max(k_r.0[2], k_t.0[2]),
            Float::max(k_r.0[3], k_t.0[3]),
        ]);
        let black = Spectrum::splat(zero);
        let is_fresnel =
            f32x8::load_array(simd, by_lane!(lane => if coefficients[lane].fresnel { 1.0 } else { 0.0 }))
                .gt(zero);
        let total = !is_bent & !no_transmission;
        let mirror = Spectrum::select(is_fresnel, greater * part, Spectrum::select(total, k_r + k_t, k_r));
        let transmission =
            Spectrum::select(is_fresnel, k_t * (one - part), Spectrum::select(total, black, k_t));
        let mirrored = same_side(optics::reflect(wo, n).normalize(), surfaces.ng_facing, one);
        let refracted = same_side(bent.normalize(), surfaces.ng_facing, -one);
        let is_refracted = has_branches & is_bent & !transmission.is_black();
        Some(Self {
            mirrored: Rays::of(surfaces, has_branches, mirrored, beta * mirror),
            refracted: Rays::of(surfaces, is_refracted, refracted, beta * transmission),
        })
    }
}

impl Rays {
    #[inline(always)]
    fn of<S: Simd>(
        surfaces: &Surfaces<S>,
        exist: mask32x8<S>,
        direction: Vector<f32x8<S>>,
        beta: Spectrum<f32x8<S>>,
    ) -> Self {
        Self {
            exist: exist.to_bitmask() as u32,
            beta: scatter_spectrum(beta),
            origin: scatter(surfaces.points.leave(surfaces.ng, direction)),
            direction: scatter(direction),
        }
    }
}

/// The direction, reflected at the tangent plane if it points to the wrong side of it: an interpolated normal can send
/// a reflected ray into the surface or a refracted one out of it. `side` is 1 for the side of `ng`, −1 for the other.
#[inline(always)]
pub(in crate::integrator) fn same_side<R: Real>(direction: Vector<R>, ng: Vector<R>, side: R) -> Vector<R> {
    let cos = direction.dot(ng);
    let (on_side, zero) = (cos * side, side.like(0.0));
    Vector::select(on_side.gt(zero) | Float::eq(on_side, zero), direction, direction - ng * (cos * 2.0))
}
