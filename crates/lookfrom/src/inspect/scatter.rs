//! Reports on scattering: BSDFs, light samples and BSDF samples with their weights.
//!
//! Densities are over solid angle, per steradian. β is the path throughput, p and q are the two densities with which the two
//! ways find a light.

use serde::Serialize;

use super::report::{Amount, Factor, ShadowReport};
use crate::core::spectrum::Spectrum;
use crate::shading::bsdf::Bsdf;
use crate::shading::bsdf::conductor::Conductor;
use crate::shading::bsdf::lobes::Lobes;
use crate::shading::bsdf::microfacet::TrowbridgeReitz;
use crate::shading::material::Shading;

/// A scattering function at a point.
#[derive(Clone, Debug, Serialize)]
pub struct ScatteringReport {
    /// Which one.
    pub kind: &'static str,
    /// What it does, in words.
    pub does: &'static str,
    /// Its numbers by name: one, one an axis, or one a lane.
    pub numbers: Vec<(&'static str, Vec<f32>)>,
    /// The kinds of scattering that it has, in words.
    pub lobes: String,
    /// The shading normal to the outside, as normal and bump maps bend it.
    pub n: [f32; 3],
}

/// A light that a path's own direction found: `β L w` is added.
#[derive(Clone, Debug, Serialize)]
pub struct FoundReport {
    /// Its number.
    pub index: u32,
    /// Its name.
    pub light: String,
    /// L: what it sends this way.
    pub radiance: Amount,
    /// q: the density with which light sampling would have chosen the direction, the choice of the light included; 0 where
    /// it could not. (p is the ray's `pdf`.)
    pub light_pdf: f32,
    /// w: the MIS weight of this way of finding the light, `p² / (p² + q²)` where both can.
    pub weight: f32,
    /// What was added to the sample.
    pub added: Amount,
}

/// The one light that was sampled at a surface: `β f cos L w / p` is added, if the shadow ray reaches it.
#[derive(Clone, Debug, Serialize)]
pub struct AskedReport {
    /// Its number.
    pub index: u32,
    /// Its name.
    pub light: String,
    /// The probability of having chosen it among all lights.
    pub probability: f32,
    /// What it answered; `None` when no light can come from there.
    pub answer: Option<AnswerReport>,
    /// The shadow ray; `None` where it would bring nothing.
    pub shadow: Option<ShadowReport>,
    /// What was added to the sample.
    pub added: Amount,
}

/// A light's answer.
#[derive(Clone, Debug, Serialize)]
pub struct AnswerReport {
    /// Toward it, unit length.
    pub wi: [f32; 3],
    /// The density with which the light chose that direction; 1 where there is only one.
    pub light_pdf: f32,
    /// p: the density of the whole choice, `probability · light_pdf`.
    pub pdf: f32,
    /// L: what arrives if nothing is in the way.
    pub arrives: Amount,
    /// The scattering function times the cosine; black where the material sends nothing on.
    pub f_cos: Factor,
    /// q: the density with which the material would have chosen the direction; `None` where nothing else can find the
    /// light, or nothing else is weighed against.
    pub bsdf_pdf: Option<f32>,
    /// w: the MIS weight of this way of finding the light, `p² / (p² + q²)` where both can.
    pub weight: f32,
}

/// How a path goes on: β becomes `β f cos / pdf`, over the roulette's probability.
#[derive(Clone, Debug, Serialize)]
pub struct BounceReport {
    /// What kind of scattering was chosen, in words.
    pub lobe: String,
    /// The direction, unit length.
    pub wi: [f32; 3],
    /// The scattering function (for mirrors and smooth glass with the factor of the delta function that `pdf` has, too).
    pub f: Factor,
    /// The cosine of the direction to the shading normal, without its sign.
    pub cos: f32,
    /// The density of the choice; for mirrors and smooth glass a probability.
    pub pdf: f32,
    /// Whether `f` and `pdf` are estimates of which only the ratio means anything.
    pub pdf_is_proportional: bool,
    /// The index of refraction beyond the surface over the one before it, where light was bent; else 1.
    pub eta: f32,
    /// β before.
    pub throughput_before: Factor,
    /// `β f cos / pdf`.
    pub throughput_after: Factor,
    /// Russian roulette's probability of going on.
    pub survival: f32,
    /// Whether it goes on.
    pub survives: bool,
    /// β of the next ray: `throughput_after / survival`; `None` where there is none.
    pub next_throughput: Option<Factor>,
}

/// A scattering function in words and numbers; `factor` keeps the lanes that mean something.
pub(super) fn scattering(shading: &Shading, factor: impl Fn(Spectrum) -> Factor) -> ScatteringReport {
    let alpha = |roughness: TrowbridgeReitz| ("alpha", vec![roughness.alpha_x, roughness.alpha_y]);
    let metal =
        |bsdf: &Conductor| vec![("eta", factor(bsdf.eta)), ("k", factor(bsdf.k)), alpha(bsdf.roughness)];
    let coat = |eta: f32, roughness: TrowbridgeReitz, thickness: f32, albedo: Spectrum| {
        vec![
            ("coat eta", vec![eta]),
            ("coat alpha", vec![roughness.alpha_x, roughness.alpha_y]),
            ("coat thickness", vec![thickness]),
            ("coat albedo", factor(albedo)),
        ]
    };
    let (kind, does, numbers) = match &shading.bsdf {
        Bsdf::Diffuse(bsdf) => (
            "diffuse",
            "matte: equally bright from all sides, f = reflectance / π",
            vec![("reflectance", factor(bsdf.reflectance))],
        ),
        Bsdf::DiffuseTransmission(bsdf) => (
            "diffuse transmission",
            "matte on both sides, like paper: f = reflectance / π or transmittance / π",
            vec![("reflectance", factor(bsdf.reflectance)), ("transmittance", factor(bsdf.transmittance))],
        ),
        Bsdf::Conductor(bsdf) if bsdf.roughness.is_smooth() => {
            ("conductor", "smooth metal: a mirror, tinted by Fresnel's equations", metal(bsdf))
        }
        Bsdf::Conductor(bsdf) => {
            ("conductor", "rough metal: many small mirrors, their slopes spread by alpha", metal(bsdf))
        }
        Bsdf::Dielectric(bsdf) => (
            "dielectric",
            match bsdf.roughness.is_smooth() {
                true => "smooth glass: mirrors and refracts; Fresnel's equations say how much of each",
                false => {
                    "rough glass: many small facets that mirror and refract, their slopes spread by alpha"
                }
            },
            vec![("eta", vec![bsdf.eta]), alpha(bsdf.roughness)],
        ),
        Bsdf::ThinDielectric(bsdf) => (
            "thin dielectric",
            "a thin pane: mirrors, or lets light straight through",
            vec![("eta", vec![bsdf.eta])],
        ),
        Bsdf::CoatedDiffuse(bsdf) => (
            "coated diffuse",
            "matte under a clear coat: light walks at random between the two",
            [
                coat(bsdf.coat.eta, bsdf.coat.roughness, bsdf.thickness, bsdf.albedo),
                vec![("reflectance", factor(bsdf.base.reflectance))],
            ]
            .concat(),
        ),
        Bsdf::CoatedConductor(bsdf) => (
            "coated conductor",
            "metal under a clear coat: light walks at random between the two",
            [coat(bsdf.coat.eta, bsdf.coat.roughness, bsdf.thickness, bsdf.albedo), metal(&bsdf.base)]
                .concat(),
        ),
        Bsdf::Whitted(bsdf) => (
            "whitted",
            "the coefficients of Whitted's formula as shares of light",
            vec![
                ("k_d", factor(bsdf.diffuse)),
                ("k_s", factor(bsdf.specular)),
                ("n", vec![bsdf.shininess]),
                ("k_r", factor(bsdf.mirror)),
                ("k_t", factor(bsdf.transmission)),
                ("ior", vec![bsdf.ior]),
            ],
        ),
        Bsdf::Principled(bsdf) => {
            let p = bsdf.parameters();
            (
                "principled",
                "glTF's layers: metal, glass and a matte body by parts, under fibres and a clear coat",
                vec![
                    ("base color", factor(p.base_color)),
                    ("metallic", vec![p.metallic]),
                    alpha(p.roughness),
                    ("eta", vec![p.eta]),
                    ("f0", factor(p.f0)),
                    ("specular", vec![p.f90]),
                    ("transmission", vec![p.transmission]),
                    ("diffuse transmission", vec![p.diffuse_transmission]),
                    ("clearcoat", vec![p.clearcoat]),
                    ("clearcoat alpha", vec![p.clearcoat_roughness.alpha_x]),
                    ("sheen color", factor(p.sheen_color)),
                    ("sheen roughness", vec![p.sheen_roughness]),
                    ("iridescence", vec![p.iridescence]),
                ],
            )
        }
    };
    let lobes = words(shading.bsdf.lobes());
    ScatteringReport { kind, does, numbers, lobes, n: shading.n().to_array() }
}

/// A set of kinds of scattering in words.
pub(super) fn words(lobes: Lobes) -> String {
    let named = |names: &[(Lobes, &'static str)], and: &str| {
        let names: Vec<&str> =
            names.iter().filter(|(lobe, _)| lobes.intersects(*lobe)).map(|(_, name)| *name).collect();
        names.join(and)
    };
    let spread =
        named(&[(Lobes::DIFFUSE, "diffuse"), (Lobes::GLOSSY, "glossy"), (Lobes::SPECULAR, "specular")], ", ");
    let side = named(&[(Lobes::REFLECTION, "reflection"), (Lobes::TRANSMISSION, "transmission")], " and ");
    match side.is_empty() {
        true => "nothing: it swallows all light".into(),
        false => format!("{spread} {side}"),
    }
}
