//! Reports on scattering: BSDFs, light samples and BSDF samples with their weights.
//!
//! Densities are over solid angle, per steradian. β is the path throughput; p is the density of the technique that
//! found a light, q that of the other one.

use serde::Serialize;

use super::microfacets::MicrofacetReport;
use super::report::{Amount, Factor, ShadowReport};
use crate::core::spectrum::Spectrum;
use crate::light::derivation::Derivation;
use crate::shading::bsdf::lobes::Lobes;
use crate::shading::bsdf::{Description, Parameter};
use crate::shading::material::Shading;

/// A BSDF at a point.
#[derive(Clone, Debug, Serialize)]
pub struct ScatteringReport {
    /// The kind of BSDF.
    pub kind: &'static str,
    /// A description.
    pub does: &'static str,
    /// Its parameters by name: one number, one per axis, or one per lane.
    pub numbers: Vec<(&'static str, Vec<f32>)>,
    /// Its lobes, in words.
    pub lobes: String,
    /// Its lobes that light sampling can use, in letters: `D` diffuse, `G` glossy, `DG` both.
    pub letters: &'static str,
    /// The outward shading normal, with normal and bump maps.
    pub n: [f32; 3],
    /// The tangents along which the roughness has its two values, unit length; of a BSDF that is the same in all directions
    /// around n, any two.
    pub tangents: [[f32; 3]; 2],
}

/// A light that a path hit: `β L w` is added.
#[derive(Clone, Debug, Serialize)]
pub struct FoundReport {
    /// Index of the light.
    pub index: u32,
    /// Its name.
    pub light: String,
    /// L: the radiance toward the ray's origin.
    pub radiance: Amount,
    /// The formula of L, of an area light.
    pub emission: Option<Derivation>,
    /// q: the density of the direction in light sampling, the choice of the light included; 0 if light sampling cannot
    /// find it. (p is the ray's `pdf`.)
    pub light_pdf: f32,
    /// The factors of `light_pdf`: the probability of the light at the surface before, and the density of the direction; `None` where the direction was the only one possible, or light sampling cannot find the light.
    pub sampling: Option<FoundSampling>,
    /// w: the MIS weight, `p² / (p² + q²)` where both techniques can find the light.
    pub weight: f32,
    /// The contribution to the sample.
    pub added: Amount,
}

/// The density of light sampling for a light that a path hit.
#[derive(Clone, Debug, Serialize)]
pub struct FoundSampling {
    /// The probability of choosing the light at the surface before.
    pub probability: f32,
    /// The formula of that probability, and those of its operands.
    pub choice: Vec<Derivation>,
    /// The density of the direction for this light.
    pub density: f32,
    /// The formulas of that density and, of environments, of the radiance, as far as there are any.
    pub derivations: Vec<Derivation>,
}

/// The light that was sampled at a surface (next-event estimation): `β f cos L w / p` is added, if it is unoccluded.
#[derive(Clone, Debug, Serialize)]
pub struct LightSampleReport {
    /// Index of the light.
    pub index: u32,
    /// Its name.
    pub light: String,
    /// The probability of choosing it among all lights.
    pub probability: f32,
    /// The formula of that probability, and those of its operands.
    pub choice: Vec<Derivation>,
    /// The sampled direction; `None` when the light does not illuminate this point.
    pub sample: Option<SampledDirectionReport>,
    /// The shadow ray; `None` where its contribution would be 0.
    pub shadow: Option<ShadowReport>,
    /// The contribution to the sample.
    pub added: Amount,
}

/// A direction to a light that was sampled.
#[derive(Clone, Debug, Serialize)]
pub struct SampledDirectionReport {
    /// Toward the light, unit length.
    pub wi: [f32; 3],
    /// The density of the direction for this light; 1 where there is only one.
    pub light_pdf: f32,
    /// p: the density with the choice of the light, `probability · light_pdf`.
    pub pdf: f32,
    /// The point on the light, in the world; `None` for a light infinitely far away.
    pub point: Option<[f64; 3]>,
    /// The formulas of `arrives` and `light_pdf`, as far as there are any.
    pub derivations: Vec<Derivation>,
    /// Whether the light has only one direction here (a point, a distant light): then p is a probability, not a density.
    pub is_delta: bool,
    /// L: the unoccluded incident radiance.
    pub arrives: Amount,
    /// The BSDF times the cosine; black where it does not scatter this light.
    pub f_cos: Factor,
    /// The factors D, G and F of the boundaries of the BSDF that have microfacets. Diffuse lobes, sheen, and walks
    /// between layers are the rest of the BSDF.
    pub microfacets: Vec<MicrofacetReport>,
    /// q: the density of the direction in BSDF sampling; `None` for a delta light, and where light is not weighted by
    /// MIS.
    pub bsdf_pdf: Option<f32>,
    /// w: the MIS weight, `p² / (p² + q²)` where both techniques can find the light.
    pub weight: f32,
}

/// The continuation of a path: β becomes `β f cos / pdf`, divided by the survival probability of Russian roulette.
#[derive(Clone, Debug, Serialize)]
pub struct BounceReport {
    /// The sampled lobe, in words.
    pub lobe: String,
    /// The same in letters: `R`, `T` (specular), `D` diffuse, `G` glossy, `DT`, `GT` through the surface.
    pub letters: &'static str,
    /// The direction, unit length.
    pub wi: [f32; 3],
    /// The BSDF (for specular lobes the factor of the same delta function as in `pdf`).
    pub f: Factor,
    /// The factors of `f`, as those of a light sample.
    pub microfacets: Vec<MicrofacetReport>,
    /// Absolute cosine of the direction and the shading normal.
    pub cos: f32,
    /// The density of the direction; for specular lobes a probability.
    pub pdf: f32,
    /// Whether `f` and `pdf` are estimates of which only the ratio is meaningful.
    pub pdf_is_proportional: bool,
    /// Relative index of refraction, beyond the surface over before it, where light was refracted; else 1.
    pub eta: f32,
    /// The product of η² over all refractions so far, this one included: roulette multiplies the throughput by it.
    pub eta_scale: f32,
    /// β before.
    pub throughput_before: Factor,
    /// `β f cos / pdf`.
    pub throughput_after: Factor,
    /// The survival probability of Russian roulette.
    pub survival: f32,
    /// Whether the path goes on.
    pub survives: bool,
    /// β of the next ray: `throughput_after / survival`; `None` where there is none.
    pub next_throughput: Option<Factor>,
}

/// The report on a BSDF; `factor` keeps the lanes that are in use.
pub(super) fn scattering(shading: &Shading, factor: impl Fn(Spectrum) -> Factor) -> ScatteringReport {
    let Description { kind, does, numbers } = shading.bsdf.description();
    let number = |(name, parameter)| match parameter {
        Parameter::Numbers(numbers) => (name, numbers),
        Parameter::Spectrum(spectrum) => (name, factor(spectrum)),
    };
    let numbers = numbers.into_iter().map(number).collect();
    let lobes = shading.bsdf.lobes();
    let letters = match [Lobes::DIFFUSE, Lobes::GLOSSY].map(|lobe| lobes.intersects(lobe)) {
        [true, true] => "DG",
        [true, false] => "D",
        [false, true] => "G",
        [false, false] => "",
    };
    let [s, t, n] = shading.axes();
    ScatteringReport { kind, does, numbers, lobes: words(lobes), letters, n, tangents: [s, t] }
}

/// The one lobe of a sample in letters.
pub(super) fn letters(lobe: Lobes) -> &'static str {
    match (lobe.is_specular(), lobe.intersects(Lobes::DIFFUSE), lobe.is_transmission()) {
        (true, _, false) => "R",
        (true, _, true) => "T",
        (false, true, false) => "D",
        (false, true, true) => "DT",
        (false, false, false) => "G",
        (false, false, true) => "GT",
    }
}

/// A set of lobes in words.
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
        true => "none: it absorbs all light".into(),
        false => format!("{spread} {side}"),
    }
}
