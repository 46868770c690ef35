//! The values of Disney's lobes.

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;

use super::{Disney, Form, gtr1, separable, thin_facet};
use crate::core::math::schlick;
use crate::core::spectrum::Spectrum;
use crate::shading::bsdf::conductor::try_half_vector;
use crate::shading::bsdf::microfacet::TrowbridgeReitz;
use crate::shading::bsdf::{Mode, fresnel, is_grazing, same_side};

/// Reflectance at normal incidence.
fn normal_reflectance(eta: f32) -> f32 {
    let root = (eta - 1.0) / (eta + 1.0);
    root * root
}

impl Disney {
    /// Schlick's reflectance from `normal` at normal incidence.
    fn schlick_of(&self, normal: Spectrum, cos: f32) -> Spectrum {
        let relative = fresnel::relative_eta(cos, self.eta);
        // In the thinner medium the angle there counts.
        let angle = if relative > 1.0 {
            cos.abs()
        } else {
            (1.0 - (1.0 - cos * cos) / (relative * relative)).max(0.0).sqrt()
        };
        let weight = schlick(angle);
        normal.map(|r| r + (1.0 - r) * weight)
    }

    /// The reflectance of the specular layer for a cosine to a facet.
    fn specular(&self, cos: f32, is_inside: bool) -> Spectrum {
        let dielectric = fresnel::dielectric(cos, self.eta);
        let tinted = |share: f32| {
            let normal = self.tint * normal_reflectance(fresnel::relative_eta(cos, self.eta));
            if share > 0.0 { self.schlick_of(normal, cos) * share } else { Spectrum::BLACK }
        };
        match self.form {
            Form::Solid { .. } if is_inside => Spectrum::splat(self.shares()[0] * dielectric),
            Form::Solid { metallic, .. } => {
                let plain = (1.0 - metallic) * (1.0 - self.spec_tint) * dielectric;
                let metal =
                    if metallic > 0.0 { self.schlick_of(self.base, cos) * metallic } else { Spectrum::BLACK };
                Spectrum::splat(plain) + metal + tinted((1.0 - metallic) * self.spec_tint)
            }
            Form::Thin { .. } => {
                Spectrum::splat((1.0 - self.spec_tint) * dielectric) + tinted(self.spec_tint)
            }
        }
    }

    /// The diffuse lobe with its sheen, for directions on one side, from the front.
    fn diffuse(&self, wo: Vec3, wi: Vec3, wm: Vec3) -> Spectrum {
        let (fresnel_o, fresnel_i) = (schlick(wo.z.abs()), schlick(wi.z.abs()));
        let cos_d = wm.dot(wi);
        let retro = 2.0 * self.roughness * cos_d * cos_d;
        let lambertian = (1.0 - 0.5 * fresnel_o) * (1.0 - 0.5 * fresnel_i);
        let reflected = retro * (fresnel_i + fresnel_o + fresnel_i * fresnel_o * (retro - 1.0));
        let mut shape = lambertian + reflected;
        if self.flatness > 0.0 {
            // Hanrahan & Krueger's light below the surface, approximated (Burley 2012, § 5.3).
            let toward = |weight: f32| 1.0 + (0.5 * retro - 1.0) * weight;
            let below = toward(fresnel_o) * toward(fresnel_i);
            let flat = 1.25 * (below * (1.0 / (wo.z.abs() + wi.z.abs()) - 0.5) + 0.5);
            shape += (flat - shape) * self.flatness;
        }
        let (reflected, sheen) = match self.form {
            Form::Solid { metallic, .. } => (1.0, 1.0 - metallic),
            Form::Thin { diff_trans } => (1.0 - diff_trans, (1.0 - self.spec_trans) * (1.0 - diff_trans)),
        };
        let base = self.base * (FRAC_1_PI * self.shares()[1] * reflected * shape);
        let color = self.tint.map(|tint| 1.0 + (tint - 1.0) * self.sheen_tint);
        base + color * (self.sheen * sheen * schlick(cos_d.abs()))
    }

    /// The clear coat: `D` of Burley's GTR1, and `f`.
    fn clearcoat(&self, wo: Vec3, wi: Vec3, wm: Vec3) -> f32 {
        let Form::Solid { clearcoat, clearcoat_alpha, .. } = self.form else { return 0.0 };
        if clearcoat <= 0.0 {
            return 0.0;
        }
        let normal = Spectrum::splat(0.04);
        let coat = separable(TrowbridgeReitz::new(0.25, 0.25));
        0.25 * clearcoat
            * self.schlick_of(normal, wo.dot(wm)).0[0]
            * gtr1(clearcoat_alpha, wm.z)
            * coat.g(wo.into(), wi.into())
    }

    /// `f` of light that passes glass, with its half vector.
    fn transmitted(&self, wo: Vec3, wi: Vec3, wm: Vec3, mode: Mode) -> Spectrum {
        let eta = fresnel::relative_eta(wo.z, self.eta);
        let facets = self.facets(1.0);
        let (cos_o, cos_i) = (wo.dot(wm), wi.dot(wm));
        let sum = cos_o + eta * cos_i;
        let passes = 1.0 - fresnel::dielectric(cos_o, self.eta);
        let light = passes
            * facets.d(wm.into())
            * facets.g(wo.into(), wi.into())
            * eta
            * eta
            * (cos_o * cos_i / (sum * sum * wo.z * wi.z)).abs();
        let scale = if mode == Mode::Radiance { 1.0 / (eta * eta) } else { 1.0 };
        self.base.map(f32::sqrt) * (self.shares()[0] * light * scale)
    }

    /// `f`, and the part of it that is diffuse.
    pub(super) fn values(&self, wo: Vec3, wi: Vec3, mode: Mode) -> [Spectrum; 2] {
        let black = [Spectrum::BLACK; 2];
        if is_grazing::<f32>(wo) || is_grazing::<f32>(wi) {
            return black;
        }
        let is_inside = self.is_inside(wo);
        let (wo, wi) = self.facing(wo, wi);
        let [glass, _] = self.shares();
        if same_side(wo, wi) {
            let Some(wm) = try_half_vector(wo, wi) else { return black };
            let cos = if is_inside { -wo.dot(wm).abs() } else { wo.dot(wm).abs() };
            let facets = self.facets(1.0);
            let visible = facets.d(wm.into()) * facets.g(wo.into(), wi.into()) / (4.0 * (wo.z * wi.z).abs());
            let share = if matches!(self.form, Form::Thin { .. }) { glass } else { 1.0 };
            let specular = self.specular(cos, is_inside) * (share * visible);
            if is_inside {
                return [specular, Spectrum::BLACK];
            }
            let diffuse = self.diffuse(wo, wi, wm);
            let coat = Spectrum::splat(self.clearcoat(wo, wi, wm));
            return [specular + coat + diffuse, diffuse];
        }
        match self.form {
            Form::Solid { .. } if glass > 0.0 => match self.refracting_facet(wo, wi) {
                Some(wm) => [self.transmitted(wo, wi, wm, mode), Spectrum::BLACK],
                None => black,
            },
            Form::Solid { .. } => black,
            Form::Thin { diff_trans } => {
                let diffuse = self.base * (FRAC_1_PI * (1.0 - self.spec_trans) * diff_trans);
                let Some(wm) = thin_facet(wo, wi) else { return [diffuse; 2] };
                let facets = self.facets_of_thin_transmission();
                let passes = 1.0 - fresnel::dielectric(wo.dot(wm).abs(), self.eta);
                let visible =
                    facets.d(wm.into()) * facets.g(wo.into(), wi.into()) / (4.0 * (wo.z * wi.z).abs());
                [diffuse + self.base * (glass * passes * visible), diffuse]
            }
        }
    }
}
