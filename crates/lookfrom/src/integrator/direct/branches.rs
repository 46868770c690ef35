//! The branches of Whitted's tree at eight plain surfaces side by side. The bits are those of
//! [`Coefficients::branches`](crate::shading::material::Coefficients::branches).

use lookfrom_bvh::Ray;
use lookfrom_simd::{Float, Real, Simd, f32x8, mask32x8, prelude::*};

use super::coefficients::CoefficientColumns;
use super::surfaces::Surfaces;
use crate::core::lanes::{LANES, scatter_rays, scatter_spectrum};
use crate::core::optics;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;

/// The reflected and the refracted rays of eight surfaces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Branches {
    pub(super) mirrored: Rays,
    pub(super) refracted: Rays,
}

/// The rays of one kind.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rays {
    /// Bit i for lane i: whether there is a ray at all.
    pub(super) exist: u32,
    /// The throughputs of the paths that go on.
    pub(super) beta: [Spectrum; LANES],
    pub(super) rays: [Ray; LANES],
}

impl Branches {
    pub(super) const NONE: Self = Self { mirrored: Rays::NONE, refracted: Rays::NONE };

    /// Replaces the branches by those of other surfaces.
    #[inline(always)]
    pub(super) fn set<S: Simd>(
        &mut self,
        simd: S,
        coefficients: &CoefficientColumns<S>,
        surfaces: &Surfaces<S>,
        beta: Spectrum<f32x8<S>>,
    ) {
        let (k_r, k_t) = (coefficients.mirror, coefficients.transmission);
        let (no_mirror, no_transmission) = (k_r.is_black(), k_t.is_black());
        let has_branches = !(no_mirror & no_transmission);
        (self.mirrored.exist, self.refracted.exist) = (0, 0);
        if !has_branches.any_true() {
            return;
        }
        let Surfaces { wo, ns_facing: n, .. } = *surfaces;
        let (one, black) = (f32x8::splat(simd, 1.0), Spectrum::splat(f32x8::splat(simd, 0.0)));
        let mut mirror = k_r;
        let is_fresnel = coefficients.is_fresnel;
        if !no_transmission.all_true() || is_fresnel.any_true() {
            let front = mask32x8::from_bitmask(simd, surfaces.front.to_bitmask());
            let eta = f32x8::select(front, coefficients.ior, one / coefficients.ior);
            let (bent, is_bent) = optics::refract(wo, n, eta);
            let total = !is_bent & !no_transmission;
            mirror = Spectrum::select(total, k_r + k_t, k_r);
            let mut transmission = Spectrum::select(total, black, k_t);
            if is_fresnel.any_true() {
                let part = optics::fresnel_dielectric(n.dot(wo), eta);
                let greater = k_r.zip(k_t, Float::max);
                mirror = Spectrum::select(is_fresnel, greater * part, mirror);
                transmission = Spectrum::select(is_fresnel, k_t * (one - part), transmission);
            }
            let refracted = same_side(bent.normalize(), surfaces.ng_facing, -one);
            let is_refracted = has_branches & is_bent & !transmission.is_black();
            self.refracted.set(simd, surfaces, is_refracted, refracted, beta * transmission);
        }
        let mirrored = same_side(optics::reflect(wo, n).normalize(), surfaces.ng_facing, one);
        self.mirrored.set(simd, surfaces, has_branches, mirrored, beta * mirror);
    }
}

impl Rays {
    const NONE: Self =
        Self { exist: 0, beta: [Spectrum::BLACK; LANES], rays: [Ray::new([0.0; 3], [0.0; 3]); LANES] };

    #[inline(always)]
    fn set<S: Simd>(
        &mut self,
        simd: S,
        surfaces: &Surfaces<S>,
        exist: mask32x8<S>,
        direction: Vector<f32x8<S>>,
        beta: Spectrum<f32x8<S>>,
    ) {
        self.exist = exist.to_bitmask() as u32;
        self.beta = scatter_spectrum(beta);
        let origin = surfaces.exits().toward(direction);
        self.rays = scatter_rays(simd, origin, direction, f32::INFINITY);
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
