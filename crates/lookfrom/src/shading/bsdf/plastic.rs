//! Plastic: a diffuse base under a dielectric surface, with the light between them in closed form.
//!
//! The surface reflects light by its microfacets. What gets through it is scattered by the base and reflected back to it from below
//! any number of times, which is a geometric series: `T(ω_i) T(ω_o) / η² · ρ / (π (1 − r ρ))`, with `r` instead of `r ρ` where the
//! base colours light only once. Nothing is left to chance, and the density is exact. Both sides scatter alike, as of coats.
//!
//! This is `plastic` and `roughplastic` of Mitsuba 3 (Jakob et al. 2022). A lobe is chosen by the light in it.

mod interface;

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;
use lookfrom_simd::{Float, Mask, Real, Simd, f32x8, prelude::*};

use super::conductor::half_vector;
use super::diffuse::cosine_direction;
use super::lanes::{LaneBsdf, RowBsdf, gather_microfacets};
use super::microfacet::Microfacets;
use super::{
    Description, DirectionSample, Lobes, MicrofacetFactors, ScatteringFunction, fresnel, is_grazing,
    same_side,
};
use crate::core::lanes::{LANES, by_lane, gather_spectrum};
use crate::core::optics;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::core::warp;
use interface::COSINES;
pub use interface::Interface;

/// A diffuse base under a dielectric surface; `T` has as many interfaces as there are lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plastic<R = f32, T = [&'static Interface; 1]> {
    /// ρ, the albedo of the base.
    pub(crate) reflectance: Spectrum<R>,
    /// Multiplies what the surface reflects.
    pub(crate) specular: Spectrum<R>,
    /// Index of refraction, inside over outside.
    pub(crate) eta: R,
    /// The facets of the surface.
    pub(crate) microfacets: Microfacets<R>,
    /// 1 if light is coloured each time it comes to the base, else 0.
    pub(crate) nonlinear: R,
    /// 1 if what gets through is in a table; of a smooth surface it is known.
    tabulated: R,
    /// r, the fraction of light from the base that comes back to it.
    internal_reflectance: R,
    /// The mean fraction of light from all around that gets through.
    mean_transmission: R,
    interfaces: T,
}

impl Plastic {
    /// By the albedo of the base, the colour of the surface, which are clamped to 0 … 1, and the surface.
    pub fn new(
        reflectance: Spectrum,
        specular: Spectrum,
        is_nonlinear: bool,
        interface: &'static Interface,
    ) -> Self {
        let [reflectance, specular] =
            [reflectance, specular].map(|color| color.map(|lane| lane.clamp(0.0, 1.0)));
        Self {
            reflectance,
            specular,
            eta: interface.eta(),
            microfacets: interface.microfacets(),
            nonlinear: f32::from(is_nonlinear),
            tabulated: f32::from(!interface.microfacets().is_smooth()),
            internal_reflectance: interface.internal_reflectance,
            mean_transmission: interface.mean_transmission,
            interfaces: [interface],
        }
    }
}

/// Plastic seen from an outgoing direction.
#[derive(Clone, Copy, Debug)]
pub struct SeenPlastic<R: Real> {
    /// Mirrored to above, where it is below.
    wo: Vector<R>,
    is_below: R::Mask,
    /// The light from below, but for the transmission of the incident direction.
    base: Spectrum<R>,
    /// The probability of reflection by the surface.
    specular_probability: R,
}

impl<R: Real, T: AsRef<[&'static Interface]>> Plastic<R, T> {
    /// The fraction of light along a direction that gets through the surface, by its cosine.
    #[inline(always)]
    fn transmission(&self, cos: R) -> R {
        let [_, through] = self.fractions::<false>(cos);
        through
    }

    /// The fractions of light along a direction that the surface reflects, if that is wanted, and that get through it.
    #[inline(always)]
    fn fractions<const BOTH: bool>(&self, cos: R) -> [R; 2] {
        let (zero, one) = (cos.like(0.0), cos.like(1.0));
        let is_tabulated = self.tabulated.gt(zero);
        let fresnel = if is_tabulated.all() { zero } else { fresnel::dielectric(cos, self.eta) };
        let smooth = [fresnel, one - fresnel];
        if !is_tabulated.any() {
            return smooth;
        }
        let place = Float::clamp(cos, 0.0, 1.0) * (COSINES - 1) as f32;
        let first = Float::floor(Float::min(place, cos.like((COSINES - 2) as f32)));
        let through = R::select(is_tabulated, self.tabulated_fraction(1, first, place), smooth[1]);
        match BOTH {
            true => [R::select(is_tabulated, self.tabulated_fraction(0, first, place), smooth[0]), through],
            false => [zero, through],
        }
    }

    /// A fraction of the tables of one side, at a place between the nodes of an index and the next.
    #[inline(always)]
    fn tabulated_fraction(&self, side: usize, first: R, place: R) -> R {
        let [low, high] = R::by_lane(
            [first],
            #[inline(always)]
            |lane, [first]| {
                let (table, first) = (&self.interfaces.as_ref()[lane].sides[side], first as usize);
                [table[first], table[first + 1]]
            },
        );
        low + (high - low) * (place - first)
    }

    /// The light from below over what gets through the surface both ways: `ρ / (π η² (1 − r ρ))`.
    #[inline(always)]
    fn below(&self) -> Spectrum<R> {
        let (one, zero) = (self.eta.like(1.0), self.eta.like(0.0));
        let is_nonlinear = self.nonlinear.gt(zero);
        let entering = one / (self.eta * self.eta) * FRAC_1_PI;
        self.reflectance.map(
            #[inline(always)]
            |rho| {
                let again = self.internal_reflectance * R::select(is_nonlinear, rho, one);
                rho * entering / Float::max(one - again, one.like(1e-6))
            },
        )
    }

    #[inline(always)]
    fn seen_from(&self, wo: Vector<R>) -> SeenPlastic<R> {
        let zero = wo.z.like(0.0);
        let is_below = wo.z.lt(zero);
        let wo = wo.negate_where(is_below);
        let [reflected, through] = self.fractions::<true>(wo.z);
        let base = self.below() * through;
        // The albedos of both lobes: by the brightest lane.
        let reflected = reflected * self.specular.max_lane();
        let scattered = base.max_lane() * self.mean_transmission * std::f32::consts::PI;
        let sum = reflected + scattered;
        let specular_probability = R::select(sum.gt(zero), reflected / sum, zero);
        SeenPlastic { wo, is_below, base, specular_probability }
    }

    /// `f` of the rough surface in each lane of a white spectrum, and its density; 0 where it is smooth.
    #[inline(always)]
    fn off_the_surface(&self, wo: Vector<R>, wi: Vector<R>) -> [R; 2] {
        let zero = wo.z.like(0.0);
        let (wm, exists) = half_vector(wo, wi);
        let is_lit = exists & same_side(wo, wi) & !self.microfacets.is_smooth();
        if !is_lit.any() {
            return [zero; 2];
        }
        let fresnel = fresnel::dielectric(wo.dot(wm), self.eta);
        let d = self.microfacets.d(wm);
        let [g, g1] = self.microfacets.g_and_g1(wo, wi);
        let per_cosine = d * 0.25 / wo.z;
        let f = fresnel * per_cosine * g / wi.z;
        [R::select(is_lit, f, zero), R::select(is_lit, per_cosine * g1, zero)]
    }

    /// The BSDF and the density. Not inlined, since it is needed several times.
    #[inline(never)]
    fn scattered(&self, seen: &SeenPlastic<R>, wi: Vector<R>) -> (Spectrum<R>, R) {
        wi.z.at_level(
            #[inline(always)]
            || {
                let (zero, one) = (wi.z.like(0.0), wi.z.like(1.0));
                let wi = wi.negate_where(seen.is_below);
                let is_lit = same_side(seen.wo, wi);
                let [reflected, density] = self.off_the_surface(seen.wo, wi);
                let f = seen.base * self.transmission(wi.z) + self.specular * reflected;
                let diffuse = warp::cosine_hemisphere_pdf(wi.z);
                let chosen = seen.specular_probability;
                let pdf = chosen * density + (one - chosen) * diffuse;
                (Spectrum::select(is_lit, f, Spectrum::splat(zero)), R::select(is_lit, pdf, zero))
            },
        )
    }

    #[inline(always)]
    fn sampled(&self, seen: &SeenPlastic<R>, uc: R, u: [R; 2]) -> DirectionSample<R> {
        let one = uc.like(1.0);
        let wo = seen.wo;
        let chosen = seen.specular_probability;
        let (is_reflected, is_smooth) = (uc.lt(chosen), self.microfacets.is_smooth());
        let mut wi = cosine_direction(u, one);
        if is_reflected.any() {
            let mirrored = Vector { x: -wo.x, y: -wo.y, z: wo.z };
            let by_facet = match is_smooth.all() {
                true => mirrored,
                false => {
                    let wm = self.microfacets.sample(wo, u);
                    Vector::select(is_smooth, mirrored, optics::reflect(wo, wm))
                }
            };
            wi = Vector::select(is_reflected, by_facet, wi);
        }
        let (f, pdf) = self.scattered(seen, wi.negate_where(seen.is_below));
        let is_specular = is_reflected & is_smooth;
        let mirror = self.specular * (fresnel::dielectric(wo.z, self.eta) / wo.z);
        DirectionSample {
            wi: wi.negate_where(seen.is_below),
            f: Spectrum::select(is_specular, mirror, f),
            pdf: R::select(is_specular, chosen, pdf),
            eta: one,
            is_specular,
            is_diffuse: !is_reflected,
            is_transmission: is_smooth.like(false),
            is_valid: wi.z.gt(one.like(0.0)) & !is_grazing(wo) & !is_grazing(wi),
        }
    }
}

impl<R: Real, T: AsRef<[&'static Interface]>> LaneBsdf<R> for Plastic<R, T> {
    type Prepared = SeenPlastic<R>;

    #[inline(always)]
    fn prepare(&self, wo: Vector<R>) -> SeenPlastic<R> {
        self.seen_from(wo)
    }

    #[inline(always)]
    fn f(&self, seen: &SeenPlastic<R>, wi: Vector<R>) -> Spectrum<R> {
        self.scattered(seen, wi).0
    }

    #[inline(always)]
    fn pdf(&self, seen: &SeenPlastic<R>, wi: Vector<R>) -> R {
        self.scattered(seen, wi).1
    }

    #[inline(always)]
    fn f_and_pdf(&self, seen: &SeenPlastic<R>, wi: Vector<R>) -> (Spectrum<R>, R) {
        self.scattered(seen, wi)
    }

    #[inline(always)]
    fn sample(&self, seen: &SeenPlastic<R>, uc: R, u: [R; 2]) -> DirectionSample<R> {
        self.sampled(seen, uc, u)
    }

    #[inline(always)]
    fn has_density(&self) -> R::Mask {
        !self.microfacets.is_smooth() | !self.reflectance.is_black()
    }

    #[inline(always)]
    fn diffuse_share(&self, seen: &SeenPlastic<R>, wi: Vector<R>, f: Spectrum<R>) -> Spectrum<R> {
        let wi = wi.negate_where(seen.is_below);
        (seen.base * self.transmission(wi.z)).share_of(f)
    }
}

impl ScatteringFunction for Plastic {
    fn lobes(&self) -> Lobes {
        let mut lobes = Lobes::REFLECTION;
        if !self.reflectance.is_black() {
            lobes |= Lobes::DIFFUSE;
        }
        if !self.specular.is_black() {
            lobes |= if self.microfacets.is_smooth() { Lobes::SPECULAR } else { Lobes::GLOSSY };
        }
        lobes
    }

    fn regularize(&mut self) {
        self.microfacets.regularize();
    }

    fn factors(&self, wo: Vec3, wi: Vec3, is_specular: bool) -> Vec<MicrofacetFactors> {
        self.factors(wo, wi, is_specular).into_iter().collect()
    }

    fn description(&self) -> Description {
        Description {
            kind: "plastic",
            does: "diffuse under a dielectric surface, with the light between them in closed form",
            numbers: vec![
                ("reflectance", self.reflectance.into()),
                ("specular", self.specular.into()),
                ("eta", self.eta.into()),
                ("alpha", self.microfacets.into()),
                ("reflectance inside", self.internal_reflectance.into()),
            ],
        }
    }
}

impl RowBsdf for Plastic {
    type Lanes<S: Simd> = Plastic<f32x8<S>, [&'static Interface; LANES]>;

    #[inline(always)]
    fn gather<S: Simd>(simd: S, rows: &[&Self; LANES]) -> Self::Lanes<S> {
        let of = |numbers: [f32; LANES]| f32x8::load_array(simd, numbers);
        Plastic {
            reflectance: gather_spectrum(simd, &by_lane!(lane => rows[lane].reflectance)),
            specular: gather_spectrum(simd, &by_lane!(lane => rows[lane].specular)),
            eta: of(by_lane!(lane => rows[lane].eta)),
            microfacets: gather_microfacets(simd, &by_lane!(lane => rows[lane].microfacets)),
            nonlinear: of(by_lane!(lane => rows[lane].nonlinear)),
            tabulated: of(by_lane!(lane => rows[lane].tabulated)),
            internal_reflectance: of(by_lane!(lane => rows[lane].internal_reflectance)),
            mean_transmission: of(by_lane!(lane => rows[lane].mean_transmission)),
            interfaces: by_lane!(lane => rows[lane].interfaces[0]),
        }
    }
}

#[cfg(test)]
mod tests;
