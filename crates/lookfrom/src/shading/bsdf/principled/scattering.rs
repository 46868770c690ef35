//! Sampling of a principled BSDF for one outgoing direction: the probabilities of its lobes, and the density.

use lookfrom_simd::{Float, Mask, Real};

use super::choice::Choice;
use super::facing::{Facing, Facings};
use super::prepared::{PreparedSurface, is_below};
use super::surface::Facet;
use super::{Gltf, Model, Principled};
use crate::core::optics;
use crate::core::sampler::ONE_MINUS_EPSILON;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::core::warp;
use crate::shading::bsdf::diffuse::cosine_direction;
use crate::shading::bsdf::{DirectionSample, across, is_grazing};

/// A principled BSDF for an outgoing direction ω_o. Other directions are those of [`crate::shading::bsdf::Bsdf`].
///
/// Methods that are needed twice, or are long, are not inlined: compilers would take minutes.
#[derive(Debug)]
pub struct LocalScattering<R: Real = f32, M = Gltf> {
    prepared: PreparedSurface<R, M>,
    choice: Choice<R>,
    /// False for a grazing ω_o.
    is_usable: R::Mask,
}

impl<R: Real, M: Model<R>> LocalScattering<R, M> {
    #[inline(never)]
    pub(in crate::shading::bsdf) fn new(look: &Principled<R, M>, wo: Vector<R>) -> Self {
        wo.z.at_level(
            #[inline(always)]
            || {
                let prepared = PreparedSurface::new(look, wo);
                Self { choice: Choice::new(&prepared), prepared, is_usable: !is_grazing(wo) }
            },
        )
    }

    /// The direction in the frame where `wo` is above, or from there.
    #[inline(always)]
    fn towards(&self, w: Vector<R>) -> Vector<R> {
        Vector::select(self.prepared.is_inside, across(w), w)
    }

    /// As [`crate::shading::bsdf::Bsdf::f`].
    #[inline(never)]
    pub(in crate::shading::bsdf) fn f(&self, wi: Vector<R>) -> Spectrum<R> {
        wi.z.at_level(
            #[inline(always)]
            || {
                let is_usable = self.is_usable & !is_grazing(wi);
                let wi = self.towards(wi);
                let f = self.f_by(wi, &self.prepared.facets(wi));
                Spectrum::select(is_usable, f, Spectrum::splat(wi.z.like(0.0)))
            },
        )
    }

    /// As [`crate::shading::bsdf::Bsdf::pdf`].
    #[inline(never)]
    pub(in crate::shading::bsdf) fn pdf(&self, wi: Vector<R>) -> R {
        wi.z.at_level(
            #[inline(always)]
            || {
                let is_usable = self.is_usable & !is_grazing(wi);
                let wi = self.towards(wi);
                R::select(is_usable, self.pdf_by(wi, &self.prepared.facets(wi)), wi.z.like(0.0))
            },
        )
    }

    /// Both, by the same facets; the density is 0 where the value is black.
    #[inline(always)]
    pub(in crate::shading::bsdf) fn f_and_pdf(&self, wi: Vector<R>) -> (Spectrum<R>, R) {
        let is_usable = self.is_usable & !is_grazing(wi);
        let (f, pdf) = self.both(self.towards(wi));
        let zero = wi.z.like(0.0);
        (Spectrum::select(is_usable, f, Spectrum::splat(zero)), R::select(is_usable, pdf, zero))
    }

    /// Value and density in the mirrored frame, for directions that are not grazing.
    #[inline(never)]
    fn both(&self, wi: Vector<R>) -> (Spectrum<R>, R) {
        wi.z.at_level(
            #[inline(always)]
            || {
                let facets = self.prepared.facets(wi);
                let f = self.f_by(wi, &facets);
                let (zero, is_black) = (wi.z.like(0.0), f.is_black());
                if is_black.all() {
                    return (f, zero);
                }
                (f, R::select(is_black, zero, self.pdf_by(wi, &facets)))
            },
        )
    }

    /// The part of [`Self::f`] that the diffuse body and sheen have.
    #[inline(never)]
    pub(in crate::shading::bsdf) fn diffuse_f(&self, wi: Vector<R>) -> Spectrum<R> {
        wi.z.at_level(
            #[inline(always)]
            || {
                let is_usable = self.is_usable & !is_grazing(wi);
                let f = self.prepared.diffuse_f(self.towards(wi));
                Spectrum::select(is_usable, f, Spectrum::splat(wi.z.like(0.0)))
            },
        )
    }

    #[inline(never)]
    fn f_by(&self, wi: Vector<R>, facets: &Facings<R>) -> Spectrum<R> {
        wi.z.at_level(
            #[inline(always)]
            || self.prepared.f_by(wi, facets),
        )
    }

    /// Density of all non-specular lobes.
    #[inline(never)]
    fn pdf_by(&self, wi: Vector<R>, facets: &Facings<R>) -> R {
        wi.z.at_level(
            #[inline(always)]
            || {
                let (zero, through, choice) = (wi.z.like(0.0), is_below(wi), &self.choice);
                let even = R::select(through, choice.matte_through, choice.matte);
                let mut pdf = even * warp::cosine_hemisphere_pdf(Float::abs(wi.z));
                self.add_facet(&mut pdf, through, &facets.0);
                if let Some(back) = &facets.1 {
                    self.add_facet(&mut pdf, through, back);
                }
                if let Some(coat) = &self.prepared.coat {
                    pdf = pdf + R::select(through, zero, choice.coat * coat.pdf(wi));
                }
                let pdf = match &self.prepared.sheen {
                    Some(fibres) => pdf + R::select(through, zero, choice.sheen * fibres.pdf(wi)),
                    None => pdf,
                };
                R::select(choice.exists, pdf, zero)
            },
        )
    }

    /// Adds the density of the light that a facet reflects or passes on.
    #[inline(always)]
    fn add_facet(&self, pdf: &mut R, through: R::Mask, facing: &Facing<R>) {
        let (zero, one) = (pdf.like(0.0), pdf.like(1.0));
        let is_seen = facing.exists & self.choice.facet.gt(zero);
        if !is_seen.any() {
            return;
        }
        let (mirrors, is_allowed) = self.mirrors_at(facing.cos);
        let part = self.choice.facet * R::select(through, one - mirrors, mirrors) * facing.density;
        *pdf = *pdf + R::select(is_seen & is_allowed, part, zero);
    }

    /// The probability that a facet at a cosine reflects rather than transmits, and whether it may do either: by its
    /// reflectance there, unless transmission is specular.
    #[inline(always)]
    fn mirrors_at(&self, cos: R) -> (R, R::Mask) {
        let PreparedSurface { surface, wo, is_inside, .. } = &self.prepared;
        let (zero, one) = (cos.like(0.0), cos.like(1.0));
        let has_glass = surface.has_glass();
        let always = has_glass.like(true);
        if !has_glass.any() {
            return (one, always);
        }
        let cos = R::select(surface.passes_sharply(), Float::min(wo.z, one), cos);
        let Facet { mirrored, passed } = surface.facet(cos, *is_inside);
        let (r, t) = (self.prepared.weigh(mirrored), self.prepared.weigh(passed));
        let mirrors = R::select(has_glass, r / (r + t), one);
        (mirrors, has_glass.choose((r + t).gt(zero), always))
    }

    /// As [`crate::shading::bsdf::Bsdf::sample`].
    #[inline(always)]
    pub(in crate::shading::bsdf) fn sample(&self, uc: R, u: [R; 2]) -> DirectionSample<R> {
        let choice = &self.choice;
        let (zero, one) = (uc.like(0.0), uc.like(1.0));
        // The lobe is chosen by the first of the two numbers of the direction, which is then stretched over the lobe's part:
        // each lobe's directions stay as even as all of them.
        let [position, other] = u;
        let is_matte = position.lt(choice.matte);
        let rest = position - choice.matte;
        let is_matte_through = !is_matte & rest.lt(choice.matte_through);
        let is_diffuse = is_matte | is_matte_through;
        let mut part = R::select(is_matte, position / choice.matte, rest / choice.matte_through);
        let rest = rest - choice.matte_through;
        let is_sheen = !is_diffuse & rest.lt(choice.sheen);
        part = R::select(is_sheen, rest / choice.sheen, part);
        let rest = rest - choice.sheen;
        let is_coat = !is_diffuse & !is_sheen & rest.lt(choice.coat);
        part = R::select(is_coat, rest / choice.coat, part);
        let rest = rest - choice.coat;
        let is_facet = !is_diffuse & !is_sheen & !is_coat;
        part = R::select(is_facet, rest / choice.facet, part);
        let u = [Float::min(Float::max(part, zero), one.like(ONE_MINUS_EPSILON)), other];

        let no = is_matte.like(false);
        let mut sample = DirectionSample {
            wi: cosine_direction(u, R::select(is_matte_through, -one, one)),
            f: Spectrum::splat(zero),
            pdf: zero,
            eta: one,
            is_specular: no,
            // What is scattered between facets is no body's.
            is_diffuse: (is_diffuse & self.prepared.surface.has_matte()) | is_sheen,
            is_transmission: no,
            is_valid: choice.exists & self.is_usable,
        };
        if let Some(fibres) = self.prepared.sheen.as_ref().filter(|_| is_sheen.any()) {
            sample.wi = Vector::select(is_sheen, fibres.sample(u), sample.wi);
        }
        if is_coat.any() {
            self.sample_coat(&mut sample, u, is_coat);
        }
        if is_facet.any() {
            self.sample_facet(&mut sample, u, uc, is_facet);
        }
        sample.is_valid = sample.is_valid & !is_grazing(sample.wi);
        sample.is_transmission = is_below(sample.wi);
        let is_spread = sample.is_valid & !sample.is_specular;
        if is_spread.any() {
            let (f, pdf) = self.both(sample.wi);
            let eta = R::select(is_facet & sample.is_transmission, self.prepared.relative_eta(), one);
            sample.f = Spectrum::select(sample.is_specular, sample.f, f);
            sample.pdf = R::select(sample.is_specular, sample.pdf, pdf);
            sample.eta = R::select(sample.is_specular, sample.eta, eta);
        }
        sample.wi = self.towards(sample.wi);
        sample
    }

    #[inline(always)]
    fn sample_coat(&self, sample: &mut DirectionSample<R>, u: [R; 2], is_coat: R::Mask) {
        // There is a coat where its probability is not 0.
        let Some(coat) = &self.prepared.coat else { return };
        let (wi, is_above) = coat.sample(u);
        let is_sharp = is_coat & coat.is_sharp();
        sample.wi = Vector::select(is_coat, wi, sample.wi);
        let taken = match (self.prepared.surface.model.open_pbr(), &self.prepared.sheen) {
            (Some(_), Some(fuzz)) => coat.taken * (wi.z.like(1.0) - fuzz.taken),
            _ => coat.taken,
        };
        sample.f = Spectrum::select(is_sharp, Spectrum::splat(taken / wi.z), sample.f);
        sample.pdf = R::select(is_sharp, self.choice.coat, sample.pdf);
        sample.is_specular = is_sharp;
        sample.is_valid = sample.is_valid & (!is_coat | is_above);
    }

    #[inline(always)]
    fn sample_facet(&self, sample: &mut DirectionSample<R>, u: [R; 2], uc: R, is_facet: R::Mask) {
        let PreparedSurface { surface, wo, .. } = &self.prepared;
        let (zero, one) = (uc.like(0.0), uc.like(1.0));
        let probability = self.choice.facet;
        let is_smooth = surface.is_smooth();
        let up = Vector { x: zero, y: zero, z: one };
        let wm = match is_smooth.all() {
            true => up,
            false => Vector::select(is_smooth, up, surface.roughness.sample(*wo, u)),
        };
        let (mirrors, is_allowed) = self.mirrors_at(wo.dot(wm));
        let reflects = uc.lt(mirrors);
        let (wi, is_on_side) = self.off_facet(wm, reflects);
        let is_valid = is_on_side & is_allowed & probability.gt(zero);
        sample.wi = Vector::select(is_facet, wi, sample.wi);
        sample.is_valid = sample.is_valid & (!is_facet | is_valid);
        let is_sharp = is_facet & reflects.choose(is_smooth, surface.passes_sharply());
        if is_sharp.any() {
            let (f, eta) = self.sharp(wi);
            let pdf = probability * R::select(reflects, mirrors, one - mirrors);
            sample.f = Spectrum::select(is_sharp, f, sample.f);
            sample.pdf = R::select(is_sharp, pdf, sample.pdf);
            sample.eta = R::select(is_sharp, eta, sample.eta);
            sample.is_specular = sample.is_specular | is_sharp;
        }
    }

    /// The direction into which a facet scatters `wo`, and whether it is on the intended side.
    #[inline(always)]
    fn off_facet(&self, wm: Vector<R>, reflects: R::Mask) -> (Vector<R>, R::Mask) {
        let (wo, surface) = (self.prepared.wo, &self.prepared.surface);
        let zero = wo.z.like(0.0);
        let mirrored = optics::reflect(wo, wm);
        let (mut wi, mut exists) = (mirrored, reflects.like(true));
        if !reflects.all() {
            let eta = self.prepared.relative_eta();
            let (refracted, is_refracted) = optics::refract(wo, wm, eta);
            let is_straight = surface.passes_sharply() & Float::eq(eta, eta.like(1.0));
            let passed = Vector::select(surface.is_solid, refracted, across(mirrored));
            wi = Vector::select(reflects, mirrored, Vector::select(is_straight, -wo, passed));
            exists = reflects | is_straight | !surface.is_solid | is_refracted;
        }
        let is_above = wi.z.gt(zero);
        let is_on_side = reflects.choose(is_above, !is_above);
        let wi = Vector::select(!is_on_side & surface.is_rough_body(), across(wi), wi);
        let is_above = wi.z.gt(zero);
        (wi, exists & !is_grazing(wi) & reflects.choose(is_above, !is_above))
    }

    /// The value of specular reflection or transmission to `wi`, and the relative index.
    #[inline(always)]
    fn sharp(&self, wi: Vector<R>) -> (Spectrum<R>, R) {
        let PreparedSurface { surface, wo, is_inside, .. } = &self.prepared;
        let one = wi.z.like(1.0);
        let through = is_below(wi);
        let facet = surface.facet(Float::min(wo.z, one), *is_inside);
        let part = Spectrum::select(through, facet.passed, facet.mirrored);
        let eta = R::select(through, self.prepared.relative_eta(), one);
        if surface.model.open_pbr().is_some() {
            let scale = one / Float::abs(wi.z) / (eta * eta);
            return (part * self.prepared.below_all(wi) * scale, eta);
        }
        let (coat, sheen) = self.prepared.below(wi);
        (part * (coat * sheen / Float::abs(wi.z) / (eta * eta)), eta)
    }
}

impl<M> LocalScattering<f32, M> {
    /// The part that depends on ω_o alone.
    pub(super) fn prepared(&self) -> &PreparedSurface<f32, M> {
        &self.prepared
    }
}
