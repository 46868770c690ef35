//! A principled surface seen from a direction: the light that each lobe sends there, and the choice between lobes.
//!
//! The surface is mirrored where it is seen from below, so that here `wo.z > 0` always and `wi.z < 0` is what passes.

use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

use super::albedo::{self, Split, schlick};
use super::sheen::{self, Sheen};
use super::{Film, Principled, towards};
use crate::bsdf::conductor::half_vector;
use crate::bsdf::dielectric::{radiance_scale, refraction_jacobian};
use crate::bsdf::diffuse::cosine_direction;
use crate::bsdf::microfacet::TrowbridgeReitz;
use crate::bsdf::{BsdfSample, Lobes, Mode, fresnel, is_grazing};
use crate::math;
use crate::spectrum::Spectrum;
use crate::warp;

/// What the coat, of index 1.5, mirrors straight on.
const COAT_F0: f32 = 0.04;
/// The cosine at which a film stands for its mean.
const MEAN_COSINE: f32 = 0.7;

/// A surface, unpacked, and what is known once `wo` is.
pub(super) struct View {
    wo: Vec3,
    is_inside: bool,
    surface: Surface,
    /// The mirror's albedo along `wo`.
    mirror: Split,
    /// What it leaves of light along `wo`.
    left: Spectrum,
    /// How many roads there are from the mirror's facets back to its facets.
    again: Spectrum,
    sheen: Option<Fibres>,
    coat: Option<Coat>,
}

/// What lies under coat and sheen.
struct Surface {
    base: Spectrum,
    f0: Spectrum,
    f0_greatest: f32,
    f90: f32,
    metal: f32,
    /// Of the whole surface: a matte body, and one that lets pass.
    matte: f32,
    glass: f32,
    /// Of the matte body.
    leaf: f32,
    leaf_color: Spectrum,
    roughness: TrowbridgeReitz,
    /// Of an isotropic mirror that sends back as much.
    alpha: f32,
    /// Inside over outside.
    eta: f32,
    is_solid: bool,
    film: Option<(f32, Film)>,
    /// What the film makes of the dielectric's mirror about everywhere.
    filmed: Spectrum,
    /// The mirror's mean albedo, and what it leaves of light from everywhere.
    mean: Split,
    mean_left: Spectrum,
}

struct Fibres {
    fibres: Sheen,
    color: Spectrum,
    greatest: f32,
    roughness: f32,
    /// What they take from light along `wo`.
    taken: f32,
}

struct Coat {
    amount: f32,
    roughness: TrowbridgeReitz,
    alpha: f32,
    /// Axes, the last of them the normal.
    frame: [Vec3; 3],
    /// In this frame.
    wo: Vec3,
    /// What it takes from light along `wo`.
    taken: f32,
}

/// Probabilities of the lobes.
pub(super) struct Choice {
    coat: f32,
    sheen: f32,
    /// Mirrored or let through by a facet.
    facet: f32,
    matte: f32,
    matte_through: f32,
}

/// What a facet mirrors and lets pass.
struct Facet {
    mirrored: Spectrum,
    passed: Spectrum,
}

/// The part that leaves a rough mirror after more than one bounce, by Fresnel's mean and the mean albedo of one bounce.
fn multiple(fresnel: f32, mean: f32) -> f32 {
    fresnel * fresnel * mean / (1.0 - fresnel * (1.0 - mean))
}

impl Surface {
    fn new(look: &Principled) -> Self {
        let p = look.parameters();
        let roughness = p.roughness;
        let alpha =
            if roughness.is_smooth() { 0.0 } else { (roughness.alpha_x * roughness.alpha_y).sqrt().min(1.0) };
        let body = 1.0 - p.metallic;
        let mut surface = Self {
            base: p.base_color,
            f0: p.f0,
            f0_greatest: p.f0_greatest,
            f90: p.f90,
            metal: p.metallic,
            matte: body * (1.0 - p.transmission),
            glass: body * p.transmission,
            leaf: p.diffuse_transmission,
            leaf_color: p.diffuse_transmission_color,
            roughness,
            alpha,
            eta: p.eta,
            is_solid: p.is_solid,
            film: (p.iridescence > 0.0).then_some((p.iridescence, p.film)),
            mean: if alpha == 0.0 { albedo::SMOOTH_MEAN } else { albedo::mirror_mean(alpha) },
            filmed: Spectrum::BLACK,
            mean_left: Spectrum::BLACK,
        };
        if let Some((_, film)) = &surface.film
            && surface.matte > 0.0
        {
            surface.filmed = film.fresnel(MEAN_COSINE, surface.f0);
        }
        if surface.matte > 0.0 {
            surface.mean_left = surface.left(MEAN_COSINE, surface.mean);
        }
        surface
    }

    /// With the film over it, what mirrors `f0` straight on.
    #[inline]
    fn under_film(&self, cos: f32, f0: Spectrum, plain: Spectrum) -> Spectrum {
        match &self.film {
            Some((amount, film)) => plain * (1.0 - amount) + film.fresnel(cos, f0) * *amount,
            None => plain,
        }
    }

    /// What the metal mirrors.
    #[inline]
    fn metal(&self, cos: f32) -> Spectrum {
        let s = schlick(cos);
        self.under_film(cos, self.base, self.base.map(|f0| f0 + (1.0 - f0) * s))
    }

    /// What mirrors over the matte body.
    #[inline]
    fn lacquer(&self, cos: f32) -> Spectrum {
        let s = schlick(cos);
        self.under_film(cos, self.f0, self.f0.map(|f0| f0 + (self.f90 - f0) * s))
    }

    /// What the lacquer's albedo leaves for the body below.
    fn left(&self, cos: f32, split: Split) -> Spectrum {
        let hidden = 1.0 - split.all();
        let mean = self.mean.all();
        let plain = {
            let again = multiple(self.f0_greatest + (self.f90 - self.f0_greatest) / 21.0, mean);
            1.0 - split.of(self.f0_greatest, self.f90) - again * hidden
        };
        let plain = plain.max(0.0);
        match &self.film {
            None => Spectrum([plain; 4]),
            Some((amount, film)) => {
                let here = if cos == MEAN_COSINE { self.filmed } else { film.fresnel(cos, self.f0) };
                let filmed = here.zip(self.filmed, |here, around| {
                    (1.0 - here * split.all() - multiple(around, mean) * hidden).max(0.0)
                });
                filmed * *amount + Spectrum([plain * (1.0 - amount); 4])
            }
        }
    }

    /// What the glass does at a cosine to a facet, on the side of `wo`.
    fn pane(&self, cos: f32, is_inside: bool) -> Facet {
        // Inside of a body, what counts is the angle outside.
        let cos = if is_inside && self.is_solid && self.bends() {
            let sin2 = self.eta * self.eta * (1.0 - cos * cos).max(0.0);
            if sin2 >= 1.0 {
                return Facet { mirrored: Spectrum([1.0; 4]), passed: Spectrum::BLACK };
            }
            (1.0 - sin2).sqrt()
        } else {
            cos
        };
        // Fresnel's curve from 0 to 1.
        let s = if self.eta == 0.0 {
            schlick(cos)
        } else {
            let straight = ((self.eta - 1.0) / (self.eta + 1.0)) * ((self.eta - 1.0) / (self.eta + 1.0));
            (fresnel::dielectric(cos, self.eta) - straight) / (1.0 - straight).max(1e-6)
        };
        let s = s.clamp(0.0, 1.0);
        let of = |f0: f32| f0 + (self.f90 - f0) * s;
        let (mirrored, passed) = (self.f0.map(of), 1.0 - of(self.f0_greatest));
        match &self.film {
            None => Facet { mirrored, passed: Spectrum([passed; 4]) },
            Some((amount, film)) => {
                let filmed = film.fresnel(cos, self.f0);
                Facet {
                    mirrored: mirrored * (1.0 - amount) + filmed * *amount,
                    passed: filmed.map(|f| passed * (1.0 - amount) + (1.0 - f) * amount),
                }
            }
        }
    }

    /// Whether the index of a body changes directions.
    #[inline]
    fn bends(&self) -> bool {
        self.eta != 1.0 && self.eta != 0.0
    }

    /// Whether what passes has one direction only.
    #[inline]
    fn passes_sharply(&self) -> bool {
        self.alpha == 0.0 || (self.is_solid && !self.bends())
    }

    /// What a facet does at a cosine, each part with its weight and tint.
    fn facet(&self, cos: f32, is_inside: bool) -> Facet {
        let mut mirrored = Spectrum::BLACK;
        if self.metal > 0.0 {
            mirrored += self.metal(cos) * self.metal;
        }
        if self.matte > 0.0 {
            mirrored += self.lacquer(cos) * self.matte;
        }
        let mut passed = Spectrum::BLACK;
        if self.glass > 0.0 {
            let pane = self.pane(cos, is_inside);
            mirrored += pane.mirrored * self.glass;
            passed = pane.passed * self.base * self.glass;
        }
        Facet { mirrored, passed }
    }
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

    /// What more than one bounce between facets sends back, over the light that they hide.
    fn again(&self) -> Spectrum {
        let surface = &self.surface;
        let mut sum = Spectrum::BLACK;
        if surface.alpha == 0.0 {
            return sum;
        }
        let mean = surface.mean.all();
        // Schlick's mean over the hemisphere is F0 + (F90 − F0) / 21; a film's is about what it is at 45°.
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

    /// What goes through a thin sheet after more than one bounce, likewise.
    fn again_through(&self) -> Spectrum {
        let surface = &self.surface;
        if surface.alpha == 0.0 || surface.glass == 0.0 || surface.is_solid {
            return Spectrum::BLACK;
        }
        surface.pane(MEAN_COSINE, false).passed * surface.base * surface.glass
    }

    /// π f of all that is sent to this side or through about evenly, where the other direction has this cosine.
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

    /// The albedo of the matte body on a side.
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

    /// What coat and sheen leave for the surface.
    fn below(&self, wi: Vec3) -> (f32, f32) {
        let coat = self.coat.as_ref().map_or(1.0, |coat| {
            let up = Vec3::new(wi.x, wi.y, wi.z.abs());
            let of_wi = || coat.taken(coat.local(up).z);
            // What passes meets the coat once, outside.
            1.0 - match (wi.z < 0.0, self.is_inside) {
                (false, _) => coat.taken.max(of_wi()),
                (true, false) => coat.taken,
                (true, true) => of_wi(),
            }
        });
        let sheen = self.sheen.as_ref().map_or(1.0, |sheen| 1.0 - sheen.taken.max(sheen.taken(wi.z.abs())));
        (coat, sheen)
    }

    /// The index beyond the surface over the one before it.
    fn relative_eta(&self) -> f32 {
        let surface = &self.surface;
        match (surface.is_solid && surface.bends(), self.is_inside) {
            (false, _) => 1.0,
            (true, true) => 1.0 / surface.eta,
            (true, false) => surface.eta,
        }
    }

    /// The facet that sends `wo` to `wi`, its cosine, and what turns its reflectance into `f`, and its density over the
    /// solid angle of `wi`. `None` where there is none.
    fn facet(&self, wi: Vec3, mode: Mode) -> Option<(f32, f32, f32)> {
        let surface = &self.surface;
        let (wo, roughness) = (self.wo, surface.roughness);
        let through = wi.z < 0.0;
        if surface.alpha == 0.0 || (through && (surface.glass == 0.0 || surface.passes_sharply())) {
            return None;
        }
        if !through || !surface.is_solid {
            // A thin sheet sends through what a mirror would send back.
            let wi = Vec3::new(wi.x, wi.y, wi.z.abs());
            let wm = half_vector(wo, wi)?;
            let f = roughness.d(wm) * roughness.g(wo, wi) / (4.0 * wo.z * wi.z);
            return Some((wo.dot(wm), f, 0.25 * roughness.visible_per_cosine(wo, wm)));
        }
        let eta = self.relative_eta();
        let wm = (wi * eta + wo).try_normalize()?;
        let wm = if wm.z < 0.0 { -wm } else { wm };
        let cos = wo.dot(wm);
        if cos <= 0.0 || wi.dot(wm) >= 0.0 {
            return None;
        }
        let jacobian = cos * refraction_jacobian(wo, wi, wm, eta);
        let f = roughness.d(wm) * roughness.g(wo, wi) / (wo.z * -wi.z) * jacobian;
        Some((cos, radiance_scale(f, eta, mode), roughness.visible_per_cosine(wo, wm) * jacobian))
    }

    /// As [`super::Bsdf::f`], for `wi` in the mirrored frame and not grazing.
    pub(super) fn f(&self, wi: Vec3, mode: Mode) -> Spectrum {
        let through = wi.z < 0.0;
        let (below_coat, below_sheen) = self.below(wi);
        let mut f = self.matte(wi.z.abs(), through) * FRAC_1_PI;
        if let Some((cos, value, _)) = self.facet(wi, mode) {
            let facet = self.surface.facet(cos, self.is_inside);
            f += if through { facet.passed } else { facet.mirrored } * value;
        }
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

    /// The probabilities of the lobes among the sides that are allowed; `None` where nothing is left.
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

    /// The probability that a facet mirrors, of what it may do.
    fn mirrors(&self, facet: &Facet, lobes: Lobes) -> Option<f32> {
        let [r, t] = lobes.allowed([facet.mirrored.max_lane(), facet.passed.max_lane()]);
        (r + t > 0.0).then(|| r / (r + t))
    }

    /// The probability that a facet at a cosine mirrors: by what it does, unless what passes knows no facets.
    fn mirrors_at(&self, cos: f32, lobes: Lobes) -> Option<f32> {
        let surface = &self.surface;
        if surface.glass == 0.0 {
            return lobes.is_reflection().then_some(1.0);
        }
        let cos = if surface.passes_sharply() { self.wo.z.min(1.0) } else { cos };
        self.mirrors(&surface.facet(cos, self.is_inside), lobes)
    }

    /// Density of all lobes that are spread.
    pub(super) fn pdf(&self, wi: Vec3, choice: &Choice, lobes: Lobes) -> f32 {
        let through = wi.z < 0.0;
        let even = if through { choice.matte_through } else { choice.matte };
        let mut pdf = even * warp::cosine_hemisphere_pdf(wi.z.abs());
        if choice.facet > 0.0
            && let Some((cos, _, density)) = self.facet(wi, Mode::Importance)
            && let Some(mirrors) = self.mirrors_at(cos, lobes)
        {
            pdf += choice.facet * if through { 1.0 - mirrors } else { mirrors } * density;
        }
        if !through {
            if let Some(coat) = &self.coat {
                pdf += choice.coat * coat.pdf(wi);
            }
            pdf += choice.sheen * sheen::PDF;
        }
        pdf
    }

    /// As [`super::Bsdf::sample`], in the mirrored frame.
    pub(super) fn sample(&self, uc: f32, u: [f32; 2], mode: Mode, lobes: Lobes) -> Option<BsdfSample> {
        let choice = self.choice(lobes)?;
        let (wo, surface) = (self.wo, &self.surface);
        // What is left of uc chooses on.
        let mut rest = uc;
        let mut chosen = |probability: f32| {
            let is_chosen = rest < probability;
            rest = if is_chosen { rest / probability } else { rest - probability };
            is_chosen
        };
        let (wi, side) = if chosen(choice.matte) {
            (cosine_direction(u, 1.0), Lobes::DIFFUSE)
        } else if chosen(choice.matte_through) {
            (cosine_direction(u, -1.0), Lobes::DIFFUSE)
        } else if chosen(choice.sheen) {
            (warp::uniform_cone(u, 1.0), Lobes::GLOSSY)
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
            let wm = if surface.alpha == 0.0 { Vec3::Z } else { surface.roughness.sample(wo, u) };
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
        let (f, pdf) = (self.f(wi, mode), self.pdf(wi, &choice, lobes));
        Some(BsdfSample { eta, ..BsdfSample::new(wi, f, pdf, lobe) })
    }

    /// Where a facet sends `wo`, if to the side that is meant.
    fn off_facet(&self, wm: Vec3, reflects: bool) -> Option<Vec3> {
        let (wo, surface) = (self.wo, &self.surface);
        let wi = if reflects {
            math::reflect(wo, wm)
        } else if surface.passes_sharply() && self.relative_eta() == 1.0 {
            -wo
        } else if surface.is_solid {
            math::refract(wo, wm, self.relative_eta())?
        } else {
            let mirrored = math::reflect(wo, wm);
            Vec3::new(mirrored.x, mirrored.y, -mirrored.z)
        };
        (!is_grazing(wi) && (wi.z > 0.0) == reflects).then_some(wi)
    }

    /// What a smooth surface sends to `wi`.
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

impl Fibres {
    fn new(look: &Principled, cos: f32) -> Option<Self> {
        if look.sheen_color.is_black() {
            return None;
        }
        let roughness = look.sheen_roughness.value();
        let mut fibres = Self {
            fibres: Sheen::new(roughness),
            color: look.sheen_color.lanes(),
            greatest: look.sheen_greatest.value(),
            roughness,
            taken: 0.0,
        };
        fibres.taken = fibres.taken(cos);
        Some(fibres)
    }

    fn albedo(&self, cos: f32) -> f32 {
        albedo::sheen(cos, self.roughness)
    }

    fn taken(&self, cos: f32) -> f32 {
        (self.greatest * self.albedo(cos)).min(1.0)
    }

    fn f(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.fibres.f(wo, wi)
    }
}

impl Coat {
    fn new(look: &Principled, wo: Vec3) -> Option<Self> {
        let amount = look.coat.value();
        if amount == 0.0 {
            return None;
        }
        let roughness = TrowbridgeReitz { alpha_x: look.coat_alpha, alpha_y: look.coat_alpha };
        let n = look.parameters().clearcoat_normal;
        let (s, t) = warp::orthonormal_basis(n);
        let alpha = if roughness.is_smooth() { 0.0 } else { look.coat_alpha.min(1.0) };
        let mut coat = Self { amount, roughness, alpha, frame: [s, t, n], wo, taken: 0.0 };
        coat.wo = coat.local(wo);
        coat.taken = coat.taken(coat.wo.z);
        Some(coat)
    }

    fn local(&self, w: Vec3) -> Vec3 {
        Vec3::from_array(self.frame.map(|axis| w.dot(axis)))
    }

    /// What it takes from light whose cosine to its normal is this: nothing, from behind.
    fn taken(&self, cos: f32) -> f32 {
        if cos > 0.0 { self.amount * albedo::mirror(cos.min(1.0), self.alpha).of(COAT_F0, 1.0) } else { 0.0 }
    }

    /// `wi` in its frame and the facet between, where both are above it.
    fn facet(&self, wi: Vec3) -> Option<(Vec3, Vec3)> {
        let wi = self.local(wi);
        if self.alpha == 0.0 || self.wo.z <= 0.0 || wi.z <= 0.0 || is_grazing(self.wo) || is_grazing(wi) {
            return None;
        }
        Some((wi, half_vector(self.wo, wi)?))
    }

    /// Per cosine to the normal of the surface below.
    fn f(&self, wi: Vec3) -> f32 {
        let Some((local, wm)) = self.facet(wi) else { return 0.0 };
        let fresnel = COAT_F0 + (1.0 - COAT_F0) * schlick(self.wo.dot(wm));
        let visible = self.roughness.d(wm) * self.roughness.g(self.wo, local);
        self.amount * fresnel * visible / (4.0 * self.wo.z * wi.z)
    }

    fn pdf(&self, wi: Vec3) -> f32 {
        self.facet(wi).map_or(0.0, |(_, wm)| 0.25 * self.roughness.visible_per_cosine(self.wo, wm))
    }

    /// A direction above it and above the surface.
    fn sample(&self, u: [f32; 2]) -> Option<Vec3> {
        if self.wo.z <= 0.0 || is_grazing(self.wo) {
            return None;
        }
        let wm = if self.alpha == 0.0 { Vec3::Z } else { self.roughness.sample(self.wo, u) };
        let local = math::reflect(self.wo, wm);
        let [s, t, n] = self.frame;
        let wi = (local.x * s + local.y * t + local.z * n).normalize();
        (local.z > 0.0 && wi.z > 0.0 && !is_grazing(wi)).then_some(wi)
    }
}
