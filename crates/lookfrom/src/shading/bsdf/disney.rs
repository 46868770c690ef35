//! Disney's principled surface, solid or thin, as Mitsuba 3's `principled` and `principledthin` have it.
//!
//! A solid one is a Lambertian base that darkens or brightens toward grazing angles, with sheen, under a specular layer of microfacets that
//! is a dielectric or, by `metallic`, a metal in the base colour; the base may be glass instead (`spec_trans`), and there may be a clear
//! coat of its own over it. A thin one is a sheet without inside: a blend of a diffuse sheet and of microfacets that reflect and let light
//! through, undeviated in the mean.
//!
//! Burley 2012, "Physically-Based Shading at Disney"; Burley 2015, "Extending the Disney BRDF to a BSDF with Integrated Subsurface
//! Scattering".

#[cfg(test)]
pub(super) mod tests;
mod values;

use glam::Vec3;
use lookfrom_simd::{Float, Mask, Real, Simd, f32x8, prelude::*};

use super::diffuse::cosine_direction;
use super::lanes::{LaneBsdf, RowBsdf};
use super::microfacet::TrowbridgeReitz;
use super::{Description, DirectionSample, Lobes, ScatteringFunction, across, fresnel, is_grazing};
use crate::core::elementary;
use crate::core::lanes::{LANES, by_lane, gather_spectrum};
use crate::core::optics;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;

/// Disney's surface at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disney<R: Real = f32> {
    /// The base colour, 0 … 1.
    pub base: Spectrum<R>,
    /// The base colour over its luminance; white for black.
    pub tint: Spectrum<R>,
    /// Roughness, 0 … 1.
    pub roughness: R,
    /// Divides the microfacets' α along x and multiplies it along y; 1 without a grain.
    pub aspect: R,
    /// Index of refraction inside over that outside.
    pub eta: R,
    /// Share of the base colour in the colour of the specular layer.
    pub spec_tint: R,
    /// Share of glass.
    pub spec_trans: R,
    /// Strength of sheen …
    pub sheen: R,
    /// … and the share of the base colour in it.
    pub sheen_tint: R,
    /// Share of a base in which light scatters below the surface.
    pub flatness: R,
    /// Whether it is a thin sheet, not a solid body.
    pub is_thin: R::Mask,
    /// Share of metal; 0 of sheets.
    pub metallic: R,
    /// Strength of the clear coat; 0 of sheets.
    pub clearcoat: R,
    /// α of the coat's microfacets.
    pub clearcoat_alpha: R,
    /// Share of diffuse light that passes, 0 … 1; 0 of solid bodies.
    pub diff_trans: R,
}

/// Disney's surface seen from an outgoing direction.
#[derive(Clone, Copy, Debug)]
pub struct SeenDisney<R: Real> {
    /// In front, or inside of glass.
    wo: Vector<R>,
    /// Whether directions are turned to the front: what is no glass has no inside, both its sides are alike.
    is_turned: R::Mask,
    /// Whether light comes from inside of glass.
    is_inside: R::Mask,
    /// The share of glass in all …
    glass: R,
    /// … and that of the diffuse base.
    matte: R,
    /// The facets of the specular layer.
    facets: TrowbridgeReitz<R>,
}

/// Probabilities of the lobes: reflecting and refracting microfacets, the clear coat, the diffuse lobe on both sides.
#[derive(Clone, Copy, Debug)]
struct Choice<R: Real> {
    reflection: R,
    transmission: R,
    clearcoat: R,
    diffuse: R,
    diffuse_transmission: R,
    /// Whether there is any lobe.
    exists: R::Mask,
}

impl Disney {
    /// As all indices of refraction; 1 would refract nothing, which Mitsuba excludes as well.
    pub fn valid_eta(eta: f32) -> f32 {
        let eta = fresnel::valid_eta(eta);
        if eta == 1.0 { 1.001 } else { eta }
    }
}

impl<R: Real> Disney<R> {
    /// The facets of the specular layer, or of light that passes a thin sheet, with a factor of the roughness.
    #[inline(always)]
    fn facets(&self, factor: R) -> TrowbridgeReitz<R> {
        let roughness = factor * self.roughness;
        let alpha = roughness * roughness;
        TrowbridgeReitz {
            alpha_x: Float::clamp(alpha / self.aspect, 1e-3, 1e4),
            alpha_y: Float::clamp(alpha * self.aspect, 1e-3, 1e4),
        }
    }

    /// The facets through which light passes a thin sheet (Burley 2015, figure 15).
    #[inline(always)]
    fn facets_of_thin_transmission(&self) -> TrowbridgeReitz<R> {
        self.facets(self.eta * 0.65 - 0.35)
    }

    #[inline(always)]
    fn seen_from(&self, wo: Vector<R>) -> SeenDisney<R> {
        let (zero, one) = (wo.z.like(0.0), wo.z.like(1.0));
        let body = one - self.metallic;
        let glass = body * self.spec_trans;
        let is_below = wo.z.lt(zero);
        let is_inside = is_below & !self.is_thin & glass.gt(zero);
        let is_turned = is_below & !is_inside;
        SeenDisney {
            wo: wo.negate_where(is_turned),
            is_turned,
            is_inside,
            glass,
            matte: body * (one - self.spec_trans),
            facets: self.facets(one),
        }
    }

    /// The probabilities of the lobes, for a facet with the reflectance `fresnel`. The sum of their weights
    /// does not depend on it, as those of other lobes must not: their directions have other facets.
    #[inline(always)]
    fn choice(&self, seen: &SeenDisney<R>, fresnel: R) -> Choice<R> {
        let (zero, one) = (fresnel.like(0.0), fresnel.like(1.0));
        let passes = R::select(seen.is_inside, one, seen.glass);
        let refracted = passes * (one - fresnel);
        let half = seen.glass * 0.5;
        let matte = R::select(seen.is_inside, zero, seen.matte);
        let clearcoat = R::select(seen.is_inside, zero, self.clearcoat * 0.25);
        let reflection = R::select(self.is_thin, half, one - refracted);
        let transmission = R::select(self.is_thin, half, refracted);
        let (diffuse, diffuse_transmission) = (matte * (one - self.diff_trans), matte * self.diff_trans);
        let sum = reflection + transmission + clearcoat + diffuse + diffuse_transmission;
        Choice {
            reflection: reflection / sum,
            transmission: transmission / sum,
            clearcoat: clearcoat / sum,
            diffuse: diffuse / sum,
            diffuse_transmission: diffuse_transmission / sum,
            exists: sum.gt(zero),
        }
    }

    /// As [`super::Bsdf::sample`].
    #[inline(always)]
    fn sampled(&self, seen: &SeenDisney<R>, uc: R, u: [R; 2]) -> DirectionSample<R> {
        let (wo, one) = (seen.wo, uc.like(1.0));
        let wm = seen.facets.sample(wo, u);
        let cos = wo.dot(wm);
        let choice = self.choice(seen, fresnel::dielectric(cos, self.eta));

        // Choose a lobe.
        let diffuse = choice.diffuse + choice.diffuse_transmission;
        let coated = diffuse + choice.clearcoat;
        let is_diffuse = uc.lt(diffuse);
        let is_passing = is_diffuse & !uc.lt(choice.diffuse);
        let is_coat = !is_diffuse & uc.lt(coated);
        let is_refracted = !is_diffuse & !is_coat & uc.lt(coated + choice.transmission);
        let is_transmission = is_passing | is_refracted;

        // A direction by it.
        let reflected = optics::reflect(wo, wm);
        let diffuse = cosine_direction(u, wo.z);
        let diffuse = Vector::select(is_passing, across(diffuse), diffuse);
        let mut wi = Vector::select(is_diffuse, diffuse, reflected);
        if is_coat.any() {
            let wm = sample_gtr1(self.clearcoat_alpha, u);
            wi = Vector::select(is_coat, optics::reflect(wo, wm), wi);
        }
        let (mut eta, mut exists) = (one, choice.exists & !is_grazing(wo));
        let is_body = is_refracted & !self.is_thin;
        if is_body.any() {
            let relative = fresnel::relative_eta(cos, self.eta);
            let facing = wm.negate_where(cos.lt(one.like(0.0)));
            let (refracted, is_refraction) = optics::refract(wo, facing, relative);
            wi = Vector::select(is_body, refracted, wi);
            eta = R::select(is_body, relative, one);
            exists = exists & (is_refraction | !is_body);
        }
        let is_sheet = is_refracted & self.is_thin;
        if is_sheet.any() {
            let wm = self.facets_of_thin_transmission().sample(wo, u);
            let passed = across(optics::reflect(wo, wm));
            wi = Vector::select(is_sheet, passed, wi);
            // The facet must face away from where the light comes from.
            exists = exists & (passed.dot(wm).lt(one.like(0.0)) | !is_sheet);
        }
        let is_same_side = (wo.z * wi.z).gt(one.like(0.0));
        exists = exists & is_transmission.choose(!is_same_side, is_same_side);

        let wi = wi.negate_where(seen.is_turned);
        let scattered = self.scattered(seen, wi);
        DirectionSample {
            wi,
            f: scattered.f,
            pdf: scattered.pdf,
            eta,
            is_specular: exists.like(false),
            is_diffuse,
            is_transmission,
            is_valid: exists,
        }
    }
}

/// A normal with the density D cos of Burley's distribution GTR1.
#[inline(always)]
fn sample_gtr1<R: Real>(alpha: R, [u, v]: [R; 2]) -> Vector<R> {
    let one = alpha.like(1.0);
    let squared = alpha * alpha;
    let cos2 = (one - elementary::exp(elementary::ln(squared) * (one - v))) / (one - squared);
    let (sin_phi, cos_phi) = elementary::sin_cos_of_turns(u);
    let sin = Float::sqrt(Float::clamp(one - cos2, 0.0, 1.0));
    Vector { x: cos_phi * sin, y: sin_phi * sin, z: Float::sqrt(Float::clamp(cos2, 0.0, 1.0)) }
}

impl<R: Real> LaneBsdf<R> for Disney<R> {
    type Prepared = SeenDisney<R>;

    #[inline(always)]
    fn prepare(&self, wo: Vector<R>) -> SeenDisney<R> {
        self.seen_from(wo)
    }

    #[inline(always)]
    fn f(&self, seen: &SeenDisney<R>, wi: Vector<R>) -> Spectrum<R> {
        self.scattered(seen, wi).f
    }

    #[inline(always)]
    fn pdf(&self, seen: &SeenDisney<R>, wi: Vector<R>) -> R {
        self.scattered(seen, wi).pdf
    }

    #[inline(always)]
    fn f_and_pdf(&self, seen: &SeenDisney<R>, wi: Vector<R>) -> (Spectrum<R>, R) {
        let scattered = self.scattered(seen, wi);
        (scattered.f, scattered.pdf)
    }

    #[inline(always)]
    fn sample(&self, seen: &SeenDisney<R>, uc: R, u: [R; 2]) -> DirectionSample<R> {
        self.sampled(seen, uc, u)
    }

    #[inline(always)]
    fn has_density(&self) -> R::Mask {
        self.is_thin.like(true)
    }

    #[inline(always)]
    fn diffuse_share(&self, seen: &SeenDisney<R>, wi: Vector<R>, f: Spectrum<R>) -> Spectrum<R> {
        self.scattered(seen, wi).diffuse.share_of(f)
    }
}

impl ScatteringFunction for Disney {
    fn lobes(&self) -> Lobes {
        let seen = self.seen_from(Vec3::Z.into());
        let passes = seen.glass > 0.0 || self.diff_trans > 0.0;
        let sides = if passes { Lobes::REFLECTION | Lobes::TRANSMISSION } else { Lobes::REFLECTION };
        sides | Lobes::DIFFUSE | Lobes::GLOSSY
    }

    fn regularize(&mut self) {
        if self.roughness < 0.55 {
            self.roughness = (self.roughness * 1.42).clamp(0.32, 0.55);
        }
    }

    fn description(&self) -> Description {
        let mut numbers = vec![
            ("base colour", self.base.into()),
            ("roughness", self.roughness.into()),
            ("alpha", self.facets(1.0).into()),
            ("eta", self.eta.into()),
            ("spec_tint", self.spec_tint.into()),
            ("spec_trans", self.spec_trans.into()),
            ("sheen", self.sheen.into()),
            ("sheen_tint", self.sheen_tint.into()),
            ("flatness", self.flatness.into()),
        ];
        match self.is_thin {
            false => numbers.extend([
                ("metallic", self.metallic.into()),
                ("clearcoat", self.clearcoat.into()),
                ("clearcoat alpha", self.clearcoat_alpha.into()),
            ]),
            true => numbers.push(("diff_trans", self.diff_trans.into())),
        }
        Description {
            kind: "disney",
            does: match self.is_thin {
                false => "Disney's principled surface: diffuse, metal or glass under a specular layer",
                true => "Disney's thin sheet: diffuse light and microfacets on both sides",
            },
            numbers,
        }
    }
}

impl RowBsdf for Disney {
    type Lanes<S: Simd> = Disney<f32x8<S>>;

    #[inline(always)]
    fn gather<S: Simd>(simd: S, rows: &[&Self; LANES]) -> Self::Lanes<S> {
        let of = |numbers: [f32; LANES]| f32x8::load_array(simd, numbers);
        let is_thin = of(by_lane!(lane => if rows[lane].is_thin { 1.0 } else { 0.0 }));
        Disney {
            base: gather_spectrum(simd, &by_lane!(lane => rows[lane].base)),
            tint: gather_spectrum(simd, &by_lane!(lane => rows[lane].tint)),
            roughness: of(by_lane!(lane => rows[lane].roughness)),
            aspect: of(by_lane!(lane => rows[lane].aspect)),
            eta: of(by_lane!(lane => rows[lane].eta)),
            spec_tint: of(by_lane!(lane => rows[lane].spec_tint)),
            spec_trans: of(by_lane!(lane => rows[lane].spec_trans)),
            sheen: of(by_lane!(lane => rows[lane].sheen)),
            sheen_tint: of(by_lane!(lane => rows[lane].sheen_tint)),
            flatness: of(by_lane!(lane => rows[lane].flatness)),
            is_thin: is_thin.gt(f32x8::splat(simd, 0.0)),
            metallic: of(by_lane!(lane => rows[lane].metallic)),
            clearcoat: of(by_lane!(lane => rows[lane].clearcoat)),
            clearcoat_alpha: of(by_lane!(lane => rows[lane].clearcoat_alpha)),
            diff_trans: of(by_lane!(lane => rows[lane].diff_trans)),
        }
    }
}
