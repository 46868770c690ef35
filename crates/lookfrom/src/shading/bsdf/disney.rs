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

use std::f32::consts::{FRAC_1_PI, PI};

use glam::Vec3;
use lookfrom_scene::material as written;
use lookfrom_scene::material::Masking;

use super::conductor::try_half_vector;
use super::diffuse::cosine_direction;
use super::microfacet::{Microfacets, TrowbridgeReitz};
use super::{BsdfSample, Description, Lobes, Mode, ScatteringFunction, fresnel, is_grazing, same_side};
use crate::core::elementary;
use crate::core::optics;
use crate::core::spectrum::Spectrum;

/// Disney's surface at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disney {
    /// The base colour, 0 … 1.
    pub base: Spectrum,
    /// The base colour over its luminance; white for black.
    pub tint: Spectrum,
    /// Roughness, 0 … 1.
    pub roughness: f32,
    /// Divides the microfacets' α along x and multiplies it along y; 1 without a grain.
    pub aspect: f32,
    /// Index of refraction inside over that outside.
    pub eta: f32,
    /// Share of the base colour in the colour of the specular layer.
    pub spec_tint: f32,
    /// Share of glass.
    pub spec_trans: f32,
    /// Strength of sheen …
    pub sheen: f32,
    /// … and the share of the base colour in it.
    pub sheen_tint: f32,
    /// Share of a base in which light scatters below the surface.
    pub flatness: f32,
    /// A solid body or a thin sheet, with its own parameters.
    pub form: Form,
}

/// A solid body or a thin sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// A solid body.
    Solid {
        /// Share of metal.
        metallic: f32,
        /// Strength of the clear coat.
        clearcoat: f32,
        /// α of its microfacets.
        clearcoat_alpha: f32,
    },
    /// A thin sheet.
    Thin {
        /// Share of diffuse light that passes, 0 … 1.
        diff_trans: f32,
    },
}

/// Probabilities of the lobes: reflecting and refracting microfacets, the clear coat, the diffuse lobe on both sides.
#[derive(Clone, Copy, Debug)]
struct Choice {
    reflection: f32,
    transmission: f32,
    clearcoat: f32,
    diffuse: f32,
    diffuse_transmission: f32,
}

impl Choice {
    /// In proportion to weights, of the sides that are asked for; `None` if there is none.
    fn of(self, lobes: Lobes) -> Option<Self> {
        let [reflection, transmission] = lobes.allowed([self.reflection, self.transmission]);
        let [diffuse, diffuse_transmission] = lobes.allowed([self.diffuse, self.diffuse_transmission]);
        let [clearcoat, _] = lobes.allowed([self.clearcoat, 0.0]);
        let sum = reflection + transmission + clearcoat + diffuse + diffuse_transmission;
        (sum > 0.0).then(|| Self {
            reflection: reflection / sum,
            transmission: transmission / sum,
            clearcoat: clearcoat / sum,
            diffuse: diffuse / sum,
            diffuse_transmission: diffuse_transmission / sum,
        })
    }
}

/// Microfacets whose masking and shadowing are independent, as Mitsuba has them.
fn separable(alpha: TrowbridgeReitz) -> Microfacets {
    Microfacets::new(alpha, written::Microfacets { masking: Masking::Separable, ..Default::default() })
}

impl Disney {
    /// As all indices of refraction; 1 would refract nothing, which Mitsuba excludes as well.
    pub fn valid_eta(eta: f32) -> f32 {
        let eta = fresnel::valid_eta(eta);
        if eta == 1.0 { 1.001 } else { eta }
    }

    /// The facets of the specular layer, or of light that passes a thin sheet, with a factor of the roughness.
    fn facets(&self, factor: f32) -> Microfacets {
        let roughness = factor * self.roughness;
        let alpha = roughness * roughness;
        let [x, y] = [alpha / self.aspect, alpha * self.aspect].map(|alpha| alpha.max(1e-3));
        separable(TrowbridgeReitz::new(x, y))
    }

    /// The facets through which light passes a thin sheet (Burley 2015, figure 15).
    fn facets_of_thin_transmission(&self) -> Microfacets {
        self.facets(0.65 * self.eta - 0.35)
    }

    /// Share of glass in all, and of the diffuse base.
    fn shares(&self) -> [f32; 2] {
        match self.form {
            Form::Solid { metallic, .. } => {
                [(1.0 - metallic) * self.spec_trans, (1.0 - metallic) * (1.0 - self.spec_trans)]
            }
            Form::Thin { .. } => [self.spec_trans, 1.0 - self.spec_trans],
        }
    }

    /// Whether light comes from inside of glass. What is no glass has no inside: both its sides are alike.
    fn is_inside(&self, wo: Vec3) -> bool {
        wo.z < 0.0 && matches!(self.form, Form::Solid { .. }) && self.shares()[0] > 0.0
    }

    /// The directions as seen from the front, but inside of glass.
    fn facing(&self, wo: Vec3, wi: Vec3) -> (Vec3, Vec3) {
        if wo.z < 0.0 && !self.is_inside(wo) { (-wo, -wi) } else { (wo, wi) }
    }

    /// The probabilities of the lobes for a facet with the reflectance `fresnel`. The sum of their weights does not depend on it, as those
    /// of other lobes must not: their directions have other facets.
    fn choice(&self, is_inside: bool, fresnel: f32, lobes: Lobes) -> Option<Choice> {
        let [glass, matte] = self.shares();
        let none = Choice {
            reflection: 0.0,
            transmission: 0.0,
            clearcoat: 0.0,
            diffuse: 0.0,
            diffuse_transmission: 0.0,
        };
        let solid = |passes: f32| match (lobes.is_reflection(), lobes.is_transmission()) {
            (true, true) => [1.0 - passes * (1.0 - fresnel), passes * (1.0 - fresnel)],
            (true, false) => [1.0, 0.0],
            (false, _) => [0.0, passes],
        };
        let choice = match self.form {
            Form::Solid { .. } if is_inside => {
                let [reflection, transmission] = solid(1.0);
                Choice { reflection, transmission, ..none }
            }
            Form::Solid { clearcoat, .. } => {
                let [reflection, transmission] = solid(glass);
                Choice { reflection, transmission, clearcoat: 0.25 * clearcoat, diffuse: matte, ..none }
            }
            Form::Thin { diff_trans } => Choice {
                reflection: 0.5 * glass,
                transmission: 0.5 * glass,
                diffuse: matte * (1.0 - diff_trans),
                diffuse_transmission: matte * diff_trans,
                ..none
            },
        };
        choice.of(lobes)
    }

    /// The half vector of refraction, with z ≥ 0, if its facet faces both directions.
    fn refracting_facet(&self, wo: Vec3, wi: Vec3) -> Option<Vec3> {
        let eta = fresnel::relative_eta(wo.z, self.eta);
        let wm = (wo + wi * eta).try_normalize()?;
        let wm = if wm.z < 0.0 { -wm } else { wm };
        (wo.dot(wm) * wo.z > 0.0 && wi.dot(wm) * wi.z > 0.0).then_some(wm)
    }

    /// Density of what is sampled over solid angle, and the choice of lobes.
    fn density(&self, wo: Vec3, wi: Vec3, lobes: Lobes) -> f32 {
        let is_inside = self.is_inside(wo);
        let cosine = wi.z.abs() * FRAC_1_PI;
        if same_side(wo, wi) {
            let Some(wm) = try_half_vector(wo, wi) else { return 0.0 };
            let fresnel = fresnel::dielectric(wo.dot(wm), self.eta);
            let Some(choice) = self.choice(is_inside, fresnel, lobes) else { return 0.0 };
            let mut pdf = choice.diffuse * cosine;
            if choice.reflection > 0.0 {
                pdf += choice.reflection * 0.25 * self.facets(1.0).visible_per_cosine(wo.into(), wm.into());
            }
            if let Form::Solid { clearcoat_alpha, .. } = self.form
                && choice.clearcoat > 0.0
            {
                pdf += choice.clearcoat * gtr1(clearcoat_alpha, wm.z) * wm.z / (4.0 * wo.dot(wm).abs());
            }
            return pdf;
        }
        match self.form {
            Form::Solid { .. } => {
                let Some(wm) = self.refracting_facet(wo, wi) else { return 0.0 };
                let fresnel = fresnel::dielectric(wo.dot(wm), self.eta);
                let Some(choice) = self.choice(is_inside, fresnel, lobes) else { return 0.0 };
                let eta = fresnel::relative_eta(wo.z, self.eta);
                let sum = wo.dot(wm) + eta * wi.dot(wm);
                let jacobian = (wo.dot(wm) * wi.dot(wm)).abs() * eta * eta / (sum * sum);
                choice.transmission * self.facets(1.0).visible_per_cosine(wo.into(), wm.into()) * jacobian
            }
            Form::Thin { .. } => {
                let Some(choice) = self.choice(is_inside, 0.0, lobes) else { return 0.0 };
                let mut pdf = choice.diffuse_transmission * cosine;
                if let Some(wm) = thin_facet(wo, wi)
                    && choice.transmission > 0.0
                {
                    let facets = self.facets_of_thin_transmission();
                    pdf += choice.transmission * 0.25 * facets.visible_per_cosine(wo.into(), wm.into());
                }
                pdf
            }
        }
    }
}

/// The direction on the other side of the surface.
fn mirrored(w: Vec3) -> Vec3 {
    Vec3::new(w.x, w.y, -w.z)
}

/// The facet that lets light from `wi` pass a thin sheet to `wo`, if `wi` is behind it.
fn thin_facet(wo: Vec3, wi: Vec3) -> Option<Vec3> {
    try_half_vector(wo, mirrored(wi)).filter(|wm| wi.dot(*wm) < 0.0)
}

/// `D` of Burley's distribution GTR1 with the roughness α for the cosine of a facet's normal.
fn gtr1(alpha: f32, cos: f32) -> f32 {
    let squared = alpha * alpha;
    (squared - 1.0) / (PI * elementary::ln(squared) * (1.0 + (squared - 1.0) * cos * cos))
}

/// A normal with the density D cos of GTR1.
fn sample_gtr1(alpha: f32, u: [f32; 2]) -> Vec3 {
    let squared = alpha * alpha;
    let cos2 = (1.0 - elementary::exp(elementary::ln(squared) * (1.0 - u[1]))) / (1.0 - squared);
    let (sin_phi, cos_phi) = elementary::sin_cos_of_turns(u[0]);
    let sin = (1.0 - cos2).clamp(0.0, 1.0).sqrt();
    Vec3::new(cos_phi * sin, sin_phi * sin, cos2.clamp(0.0, 1.0).sqrt())
}

impl ScatteringFunction for Disney {
    fn f(&self, wo: Vec3, wi: Vec3, mode: Mode) -> Spectrum {
        self.values(wo, wi, mode)[0]
    }

    fn pdf(&self, wo: Vec3, wi: Vec3, _: Mode, lobes: Lobes) -> f32 {
        if is_grazing::<f32>(wo) || is_grazing::<f32>(wi) {
            return 0.0;
        }
        let (wo, wi) = self.facing(wo, wi);
        self.density(wo, wi, lobes)
    }

    fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2], mode: Mode, lobes: Lobes) -> Option<BsdfSample> {
        let is_inside = self.is_inside(wo);
        let turns = wo.z < 0.0 && !is_inside;
        let wo_front = if turns { -wo } else { wo };
        let wm = Vec3::from(self.facets(1.0).sample(wo_front.into(), u));
        let fresnel = fresnel::dielectric(wo_front.dot(wm), self.eta);
        let choice = self.choice(is_inside, fresnel, lobes)?;

        // Choose a lobe, and a direction by it.
        let mut eta = 1.0;
        let mut rest = uc;
        let mut takes = |probability: f32| {
            let is_it = rest < probability;
            rest -= probability;
            is_it
        };
        let (wi, lobe) = if takes(choice.diffuse) {
            (Vec3::from(cosine_direction(u, wo_front.z)), Lobes::REFLECTION | Lobes::DIFFUSE)
        } else if takes(choice.diffuse_transmission) {
            (mirrored(cosine_direction(u, wo_front.z).into()), Lobes::TRANSMISSION | Lobes::DIFFUSE)
        } else if takes(choice.clearcoat) {
            let Form::Solid { clearcoat_alpha, .. } = self.form else { return None };
            let wm = sample_gtr1(clearcoat_alpha, u);
            (optics::reflect(wo_front.into(), wm.into()).into(), Lobes::REFLECTION | Lobes::GLOSSY)
        } else if takes(choice.transmission) {
            let wi = match self.form {
                Form::Solid { .. } => {
                    let cos = wo_front.dot(wm);
                    eta = fresnel::relative_eta(cos, self.eta);
                    let facing = if cos < 0.0 { -wm } else { wm };
                    let (wi, exists) = optics::refract(wo_front.into(), facing.into(), eta);
                    if !exists {
                        return None;
                    }
                    Vec3::from(wi)
                }
                Form::Thin { .. } => {
                    let wm = self.facets_of_thin_transmission().sample(wo_front.into(), u);
                    let wi = mirrored(optics::reflect(wo_front.into(), wm).into());
                    thin_facet(wo_front, wi)?;
                    wi
                }
            };
            (wi, Lobes::TRANSMISSION | Lobes::GLOSSY)
        } else {
            (optics::reflect(wo_front.into(), wm.into()).into(), Lobes::REFLECTION | Lobes::GLOSSY)
        };
        if same_side(wo_front, wi) != lobe.is_reflection() {
            return None;
        }
        let pdf = self.density(wo_front, wi, lobes);
        let wi = if turns { -wi } else { wi };
        Some(BsdfSample { eta, ..BsdfSample::new(wi, self.f(wo, wi, mode), pdf, lobe) })
    }

    fn lobes(&self) -> Lobes {
        let passes = match self.form {
            Form::Solid { .. } => self.shares()[0] > 0.0,
            Form::Thin { diff_trans } => self.spec_trans > 0.0 || diff_trans > 0.0,
        };
        let sides = if passes { Lobes::REFLECTION | Lobes::TRANSMISSION } else { Lobes::REFLECTION };
        sides | Lobes::DIFFUSE | Lobes::GLOSSY
    }

    fn regularize(&mut self) {
        if self.roughness < 0.55 {
            self.roughness = (self.roughness * 1.42).clamp(0.32, 0.55);
        }
    }

    fn diffuse_share(&self, wo: Vec3, wi: Vec3, f: Spectrum) -> Spectrum {
        let [_, diffuse] = self.values(wo, wi, Mode::Radiance);
        Spectrum(std::array::from_fn(|lane| {
            if f.0[lane] > 0.0 { (diffuse.0[lane] / f.0[lane]).clamp(0.0, 1.0) } else { 0.0 }
        }))
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
        match self.form {
            Form::Solid { metallic, clearcoat, clearcoat_alpha } => numbers.extend([
                ("metallic", metallic.into()),
                ("clearcoat", clearcoat.into()),
                ("clearcoat alpha", clearcoat_alpha.into()),
            ]),
            Form::Thin { diff_trans } => numbers.push(("diff_trans", diff_trans.into())),
        }
        Description {
            kind: "disney",
            does: match self.form {
                Form::Solid { .. } => {
                    "Disney's principled surface: diffuse, metal or glass under a specular layer"
                }
                Form::Thin { .. } => "Disney's thin sheet: diffuse light and microfacets on both sides",
            },
            numbers,
        }
    }
}
