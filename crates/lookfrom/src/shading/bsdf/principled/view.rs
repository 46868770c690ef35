//! A principled BSDF for one outgoing direction: its lobes and their probabilities.
//!
//! A surface seen from below is mirrored, so that here `wo.z > 0` always and `wi.z < 0` is transmission.

use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

use super::albedo::{self, Split};
use super::layers::{Coat, Fibres};
use super::sheen;
use super::surface::{Facet, MEAN_COSINE, Surface, multiple};
use super::{Principled, towards};
use crate::core::math;
use crate::core::spectrum::Spectrum;
use crate::core::warp;
use crate::shading::bsdf::conductor::try_half_vector;
use crate::shading::bsdf::dielectric::{radiance_scale, refraction_jacobian};
use crate::shading::bsdf::diffuse::cosine_direction;
use crate::shading::bsdf::{BsdfSample, Lobes, Mode, is_grazing};

/// A surface, unpacked, with the terms that depend on `wo` alone.
pub(super) struct View {
    wo: Vec3,
    is_inside: bool,
    surface: Surface,
    /// The specular albedo along `wo`.
    mirror: Split,
    /// The fraction of light along `wo` that the specular layer leaves for the body below.
    left: Spectrum,
    /// Reflected multiple scattering between facets, over the energy that they mask.
    again: Spectrum,
    sheen: Option<Fibres>,
    coat: Option<Coat>,
}

/// A facet that scatters `wo` to some direction.
#[derive(Clone, Copy)]
struct Facing {
    /// Its normal.
    wm: Vec3,
    /// The cosine of `wo` to it.
    cos: f32,
    /// Density of that direction over solid angle when facets are sampled by visible normals.
    density: f32,
}

/// All facets that scatter `wo` to a direction. A rough body has two: the second one sends light to the wrong side,
/// which then leaves mirrored at the surface.
type Facings = [Option<Facing>; 2];

/// The direction mirrored at the surface.
fn across(w: Vec3) -> Vec3 {
    Vec3::new(w.x, w.y, -w.z)
}

/// Probabilities of the lobes.
pub(super) struct Choice {
    coat: f32,
    sheen: f32,
    /// Reflection or transmission by a facet.
    facet: f32,
    matte: f32,
    matte_through: f32,
}

impl View {
    pub(super) fn new(look: &Principled, from: Vec3) -> Self {
        let wo = towards(from, from);
        let surface = Surface::new(look);
        let cos = wo.z.min(1.0);
        let mirror = albedo::mirror(cos, surface.alpha);
        let left = if surface.matte > 0.0 { surface.left(cos, mirror) } else { Spectrum::BLACK };
        let mut view = Self {
            wo,
            is_inside: from.z < 0.0,
            mirror,
            left,
            again: Spectrum::BLACK,
            sheen: Fibres::new(look, cos),
            coat: Coat::new(look, wo),
            surface,
        };
        view.again = view.again();
        view
    }

    /// Reflected multiple scattering between facets, over the energy that they mask.
    fn again(&self) -> Spectrum {
        let surface = &self.surface;
        let mut sum = Spectrum::BLACK;
        if surface.alpha == 0.0 {
            return sum;
        }
        let mean = surface.mean.all();
        // Schlick's mean over the hemisphere is F0 + (F90 − F0) / 21; a film's is about its value at 45°.
        let of = |f0: Spectrum, f90: f32| {
            let plain = f0.map(|f0| f0 + (f90 - f0) / 21.0);
            surface.under_film(MEAN_COSINE, f0, plain).map(|fresnel| multiple(fresnel, mean))
        };
        if surface.metal > 0.0 {
            sum += of(surface.base, 1.0) * surface.metal;
        }
        if surface.matte > 0.0 {
            sum += of(surface.f0, surface.f90) * surface.matte;
        }
        if surface.glass > 0.0 && !surface.is_solid {
            sum += surface.pane(MEAN_COSINE, false).mirrored * surface.glass;
        }
        sum
    }

    /// Multiple scattering through a thin sheet, likewise.
    fn again_through(&self) -> Spectrum {
        let surface = &self.surface;
        if surface.alpha == 0.0 || surface.glass == 0.0 || surface.is_solid {
            return Spectrum::BLACK;
        }
        surface.pane(MEAN_COSINE, false).passed * surface.base * surface.glass
    }

    /// π f of the nearly uniform lobes on a side, where the other direction has this cosine.
    fn matte(&self, cos: f32, through: bool) -> Spectrum {
        let surface = &self.surface;
        let mirror = albedo::mirror(cos, surface.alpha);
        let mut sum = Spectrum::BLACK;
        let hidden = 1.0 - surface.mean.all();
        if hidden > 0.0 {
            let both = (1.0 - self.mirror.all()) * (1.0 - mirror.all()) / hidden;
            sum += if through { self.again_through() } else { self.again } * both;
        }
        if surface.matte > 0.0 {
            let left = surface.left(cos, mirror) * self.left;
            let left = left.zip(surface.mean_left, |left, mean| if mean > 0.0 { left / mean } else { 0.0 });
            sum += left * self.body(through);
        }
        sum
    }

    /// The albedo of the diffuse body on a side.
    fn body(&self, through: bool) -> Spectrum {
        let surface = &self.surface;
        match through {
            false => surface.base * (surface.matte * (1.0 - surface.leaf)),
            true => surface.leaf_color * (surface.matte * surface.leaf),
        }
    }

    /// The albedo of [`Self::matte`].
    fn matte_albedo(&self, through: bool) -> Spectrum {
        let again = if through { self.again_through() } else { self.again };
        again * (1.0 - self.mirror.all()) + self.left * self.body(through)
    }

    /// The fractions that coat and sheen leave for the surface.
    fn below(&self, wi: Vec3) -> (f32, f32) {
        let coat = self.coat.as_ref().map_or(1.0, |coat| {
            let up = Vec3::new(wi.x, wi.y, wi.z.abs());
            let of_wi = || coat.taken(coat.local(up).z);
            // Transmitted light passes the coat once, outside.
            1.0 - match (wi.z < 0.0, self.is_inside) {
                (false, _) => coat.taken.max(of_wi()),
                (true, false) => coat.taken,
                (true, true) => of_wi(),
            }
        });
        let sheen = self.sheen.as_ref().map_or(1.0, |sheen| 1.0 - sheen.taken.max(sheen.taken(wi.z.abs())));
        (coat, sheen)
    }

    /// The index beyond the surface over the one on the side of `wo`.
    fn relative_eta(&self) -> f32 {
        let surface = &self.surface;
        match (surface.is_solid && surface.bends(), self.is_inside) {
            (false, _) => 1.0,
            (true, true) => 1.0 / surface.eta,
            (true, false) => surface.eta,
        }
    }

    /// The facet that reflects `wo` to `wi`, or refracts it there (`through`). `None` where there is none.
    fn facet(&self, wi: Vec3, through: bool) -> Option<Facing> {
        let surface = &self.surface;
        let (wo, roughness) = (self.wo, surface.roughness);
        if surface.alpha == 0.0 || (through && (surface.glass == 0.0 || surface.passes_sharply())) {
            return None;
        }
        if !through || !surface.is_solid {
            // A thin sheet transmits what a reflector would reflect, to the other side.
            let wi = if through { across(wi) } else { wi };
            let wm = try_half_vector(wo, wi)?;
            let density = 0.25 * roughness.visible_per_cosine(wo.into(), wm.into());
            let cos = wo.dot(wm);
            return (cos > 0.0).then_some(Facing { wm, cos, density });
        }
        let eta = self.relative_eta();
        let wm = (wi * eta + wo).try_normalize()?;
        let wm = if wm.z < 0.0 { -wm } else { wm };
        let cos = wo.dot(wm);
        if cos <= 0.0 || wi.dot(wm) >= 0.0 {
            return None;
        }
        let jacobian = cos * refraction_jacobian(wo.into(), wi.into(), wm.into(), eta);
        Some(Facing { wm, cos, density: roughness.visible_per_cosine(wo.into(), wm.into()) * jacobian })
    }

    fn facets(&self, wi: Vec3) -> Facings {
        let through = wi.z < 0.0;
        let back = self.surface.is_rough_body().then(|| self.facet(across(wi), through)).flatten();
        [self.facet(wi, through), back]
    }

    /// As [`crate::shading::bsdf::Bsdf::f`], for `wi` in the mirrored frame and not grazing.
    pub(super) fn f(&self, wi: Vec3, mode: Mode) -> Spectrum {
        self.f_by(wi, mode, &self.facets(wi))
    }

    /// [`Self::f`] and, where it is not black, [`Self::pdf`]: both use the same facets.
    pub(super) fn f_and_pdf(
        &self,
        wi: Vec3,
        mode: Mode,
        choice: Option<&Choice>,
        lobes: Lobes,
    ) -> (Spectrum, f32) {
        let facets = self.facets(wi);
        let f = self.f_by(wi, mode, &facets);
        let pdf = match choice {
            Some(choice) if !f.is_black() => self.pdf_by(wi, choice, lobes, &facets),
            _ => 0.0,
        };
        (f, pdf)
    }

    fn f_by(&self, wi: Vec3, mode: Mode, facets: &Facings) -> Spectrum {
        let through = wi.z < 0.0;
        let (below_coat, below_sheen) = self.below(wi);
        let mut f = self.matte(wi.z.abs(), through) * FRAC_1_PI;
        f += self.facets_f(wi, mode, facets);
        f = f * below_sheen;
        if let Some(sheen) = &self.sheen
            && !through
        {
            f += sheen.color * sheen.f(self.wo, wi);
        }
        f = f * below_coat;
        if let Some(coat) = &self.coat
            && !through
        {
            f += Spectrum([coat.f(wi); 4]);
        }
        f
    }

    /// Reflection and transmission by facets.
    fn facets_f(&self, wi: Vec3, mode: Mode, facets: &Facings) -> Spectrum {
        let surface = &self.surface;
        let through = wi.z < 0.0;
        let is_rough_body = surface.is_rough_body();
        let mut sum = Spectrum::BLACK;
        if !(is_rough_body && through)
            && let [Some(Facing { wm, cos, .. }), _] = *facets
        {
            // With masking-shadowing by other facets.
            let (wo, wi) = (self.wo, Vec3::new(wi.x, wi.y, wi.z.abs()));
            let value = surface.roughness.d(wm.into()) * surface.roughness.g(wo.into(), wi.into())
                / (4.0 * wo.z * wi.z);
            sum += match (is_rough_body, through) {
                (true, _) => surface.opaque(cos),
                (false, true) => surface.facet(cos, self.is_inside).passed,
                (false, false) => surface.facet(cos, self.is_inside).mirrored,
            } * value;
        }
        if is_rough_body {
            // Without shadowing: all of the light leaves.
            let eta = if through { self.relative_eta() } else { 1.0 };
            for Facing { cos, density, .. } in facets.iter().flatten() {
                let pane = surface.pane(*cos, self.is_inside);
                let part = if through { pane.passed * surface.base } else { pane.mirrored };
                sum += part * (surface.glass * radiance_scale(density / wi.z.abs(), eta, mode));
            }
        }
        sum
    }

    /// The probabilities of the lobes among the sides that are allowed; `None` where none is left.
    pub(super) fn choice(&self, lobes: Lobes) -> Option<Choice> {
        let surface = &self.surface;
        let coat = self.coat.as_ref().map_or(0.0, |coat| coat.taken);
        let sheen = self.sheen.as_ref().map_or(0.0, |sheen| sheen.taken);
        let below = (1.0 - coat) * (1.0 - sheen);
        let facet = surface.facet(self.wo.z.min(1.0), self.is_inside);
        let all = self.mirror.all() * below;
        let [mirrored, passed] =
            lobes.allowed([facet.mirrored.max_lane() * all, facet.passed.max_lane() * all]);
        let [matte, matte_through] = lobes.allowed([
            self.matte_albedo(false).max_lane() * below,
            if surface.leaf > 0.0 || surface.glass > 0.0 {
                self.matte_albedo(true).max_lane() * below
            } else {
                0.0
            },
        ]);
        let sheen_color = self.sheen.as_ref().map_or(0.0, |sheen| sheen.color.max_lane());
        let of_sheen = self.sheen.as_ref().map_or(0.0, |fibres| fibres.albedo(self.wo.z) * sheen_color);
        let [coat, sheen] = [coat, of_sheen * (1.0 - coat)].map(|part| lobes.allowed([part, 0.0])[0]);
        let facet = mirrored + passed;
        let sum = coat + sheen + facet + matte + matte_through;
        (sum > 0.0).then(|| Choice {
            coat: coat / sum,
            sheen: sheen / sum,
            facet: facet / sum,
            matte: matte / sum,
            matte_through: matte_through / sum,
        })
    }

    /// The probability that a facet reflects rather than transmits.
    fn mirrors(&self, facet: &Facet, lobes: Lobes) -> Option<f32> {
        let [r, t] = lobes.allowed([facet.mirrored.max_lane(), facet.passed.max_lane()]);
        (r + t > 0.0).then(|| r / (r + t))
    }

    /// The probability that a facet at a cosine reflects: by its reflectance there, unless transmission is
    /// specular.
    fn mirrors_at(&self, cos: f32, lobes: Lobes) -> Option<f32> {
        let surface = &self.surface;
        if surface.glass == 0.0 {
            return lobes.is_reflection().then_some(1.0);
        }
        let cos = if surface.passes_sharply() { self.wo.z.min(1.0) } else { cos };
        self.mirrors(&surface.facet(cos, self.is_inside), lobes)
    }

    /// Density of all non-specular lobes.
    pub(super) fn pdf(&self, wi: Vec3, choice: &Choice, lobes: Lobes) -> f32 {
        self.pdf_by(wi, choice, lobes, &self.facets(wi))
    }

    fn pdf_by(&self, wi: Vec3, choice: &Choice, lobes: Lobes, facets: &Facings) -> f32 {
        let through = wi.z < 0.0;
        let even = if through { choice.matte_through } else { choice.matte };
        let mut pdf = even * warp::cosine_hemisphere_pdf(wi.z.abs());
        if choice.facet > 0.0 {
            for Facing { cos, density, .. } in facets.iter().flatten() {
                if let Some(mirrors) = self.mirrors_at(*cos, lobes) {
                    pdf += choice.facet * if through { 1.0 - mirrors } else { mirrors } * density;
                }
            }
        }
        if !through {
            if let Some(coat) = &self.coat {
                pdf += choice.coat * coat.pdf(wi);
            }
            pdf += choice.sheen * sheen::PDF;
        }
        pdf
    }

    /// As [`crate::shading::bsdf::Bsdf::sample`], in the mirrored frame.
    pub(super) fn sample(
        &self,
        uc: f32,
        u: [f32; 2],
        mode: Mode,
        choice: &Choice,
        lobes: Lobes,
    ) -> Option<BsdfSample> {
        let (wo, surface) = (self.wo, &self.surface);
        // The remainder of `uc` is reused for the next choice.
        let mut rest = uc;
        let mut chosen = |probability: f32| {
            let is_chosen = rest < probability;
            rest = if is_chosen { rest / probability } else { rest - probability };
            is_chosen
        };
        let (wi, side) = if chosen(choice.matte) {
            (cosine_direction(u, 1.0).into(), Lobes::DIFFUSE)
        } else if chosen(choice.matte_through) {
            (cosine_direction(u, -1.0).into(), Lobes::DIFFUSE)
        } else if chosen(choice.sheen) {
            (warp::uniform_cone(u, 1.0).into(), Lobes::GLOSSY)
        } else if chosen(choice.coat) {
            let coat = self.coat.as_ref()?;
            let wi = coat.sample(u)?;
            if coat.alpha == 0.0 {
                let f = Spectrum([coat.taken / wi.z; 4]);
                return Some(BsdfSample::new(wi, f, choice.coat, Lobes::REFLECTION | Lobes::SPECULAR));
            }
            (wi, Lobes::GLOSSY)
        } else {
            if choice.facet == 0.0 {
                return None;
            }
            let wm =
                if surface.alpha == 0.0 { Vec3::Z } else { surface.roughness.sample(wo.into(), u).into() };
            let mirrors = self.mirrors_at(wo.dot(wm), lobes)?;
            let reflects = rest < choice.facet * mirrors;
            let wi = self.off_facet(wm, reflects)?;
            let is_sharp = if reflects { surface.alpha == 0.0 } else { surface.passes_sharply() };
            if is_sharp {
                return self.sharp(wi, choice.facet * if reflects { mirrors } else { 1.0 - mirrors }, mode);
            }
            (wi, Lobes::GLOSSY)
        };
        if is_grazing(wi) {
            return None;
        }
        let eta = if wi.z < 0.0 && side == Lobes::GLOSSY { self.relative_eta() } else { 1.0 };
        let lobe = side | if wi.z < 0.0 { Lobes::TRANSMISSION } else { Lobes::REFLECTION };
        let (f, pdf) = self.f_and_pdf(wi, mode, Some(choice), lobes);
        Some(BsdfSample { eta, ..BsdfSample::new(wi, f, pdf, lobe) })
    }

    /// The direction into which a facet scatters `wo`, if it is on the intended side.
    fn off_facet(&self, wm: Vec3, reflects: bool) -> Option<Vec3> {
        let (wo, surface) = (self.wo, &self.surface);
        let wi = if reflects {
            math::reflect(wo, wm)
        } else if surface.passes_sharply() && self.relative_eta() == 1.0 {
            -wo
        } else if surface.is_solid {
            math::refract(wo, wm, self.relative_eta())?
        } else {
            across(math::reflect(wo, wm))
        };
        let is_on_side = (wi.z > 0.0) == reflects;
        let wi = if !is_on_side && surface.is_rough_body() { across(wi) } else { wi };
        (!is_grazing(wi) && (wi.z > 0.0) == reflects).then_some(wi)
    }

    /// Specular reflection or transmission to `wi`.
    fn sharp(&self, wi: Vec3, probability: f32, mode: Mode) -> Option<BsdfSample> {
        let facet = self.surface.facet(self.wo.z.min(1.0), self.is_inside);
        let (coat, sheen) = self.below(wi);
        let (part, eta, side) = match wi.z < 0.0 {
            false => (facet.mirrored, 1.0, Lobes::REFLECTION),
            true => (facet.passed, self.relative_eta(), Lobes::TRANSMISSION),
        };
        let f = part * radiance_scale(coat * sheen / wi.z.abs(), eta, mode);
        Some(BsdfSample { eta, ..BsdfSample::new(wi, f, probability, side | Lobes::SPECULAR) })
    }
}
