//! Light-path expressions: a contribution as the chain of what its light did, from the camera to the light, and the
//! factors that made it large. After Heckbert (1990), with names of the scene in place of `E S D L`.

use std::fmt::{self, Display, Formatter};

use serde::Serialize;

use super::inspect_in_short;
use super::report::{Addition, Inspection, MetReport, RayReport};
use super::scatter::{FoundReport, LightSampleReport};
use super::segments::RayKind;
use crate::core::math::luminance;
use crate::render::{Renderer, SampleId};

/// Number of contributions in a summary.
pub(super) const LARGEST: usize = 3;

/// A contribution to a sample, as an expression.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Contribution {
    /// Number of the sample in its pixel.
    pub sample: u32,
    /// Its part of the value that the film received for this sample.
    pub value: [f32; 3],
    /// The ray whose hit made it.
    pub address: u64,
    /// Number of reflections, refractions and bounces before that hit.
    pub depth: u32,
    /// The light that it comes from: its name, `sky`, `ambient`, or the shape that emits it.
    pub light: String,
    /// From the camera to the light: `camera → glass (R) → window`. Letters: `R` specular reflection, `T` specular
    /// transmission, `D` diffuse, `G` glossy (with `T`, through the surface), `V` a medium, `S` Whitted's highlight.
    pub expression: String,
    /// Its factors, and the one that makes it large.
    pub why: String,
}

/// A number for a sort: the luminance of a colour; infinite where a channel is not finite.
pub(super) fn brightness(rgb: [f32; 3]) -> f32 {
    if rgb.iter().all(|c| c.is_finite()) { luminance(rgb) } else { f32::INFINITY }
}

/// The largest contributions of a sample, largest first.
pub(super) fn largest(inspection: &Inspection) -> Vec<Contribution> {
    let mut additions: Vec<&Addition> = inspection.additions.iter().collect();
    additions.sort_by(|a, b| brightness(b.value.rgb).total_cmp(&brightness(a.value.rgb)));
    additions.into_iter().take(LARGEST).filter_map(|addition| contribution(inspection, addition)).collect()
}

fn contribution(inspection: &Inspection, addition: &Addition) -> Option<Contribution> {
    let ray = inspection.ray(addition.address)?;
    let light = light_of(ray, addition);
    // Emission is where the way ends.
    let end = (!is_emission(addition)).then(|| letters_toward_light(ray, addition));
    let mut links = links(inspection, ray);
    match (end, &ray.met) {
        (Some(_), None) if ray.scattered_at().is_some() => links.push(MEDIUM.into()),
        (Some(letters), Some(met)) => links.push(link(met, &letters)),
        _ => {}
    }
    if light != "view" {
        links.push(light.clone());
    }
    let value = addition.value.rgb.map(|c| c * inspection.weight * inspection.sensor.scaled_by);
    Some(Contribution {
        sample: inspection.sample,
        value,
        address: ray.address,
        depth: ray.depth,
        light,
        expression: links.join(" → "),
        why: why(inspection, ray, addition),
    })
}

/// The expression of the largest contribution to a sample; `None` without light, and where the camera sees the light
/// itself, straight or by mirrors and sharp glass.
pub(crate) fn light_seen_by_bounces(renderer: &Renderer, id: SampleId) -> Option<String> {
    let inspection = inspect_in_short(renderer, id);
    let largest = inspection.contributions.first()?;
    let light = inspection
        .additions
        .iter()
        .filter(|addition| addition.address == largest.address)
        .max_by(|a, b| brightness(a.value.rgb).total_cmp(&brightness(b.value.rgb)))?;
    let mut ray = inspection.ray(largest.address)?;
    let mut is_seen = is_emission(light);
    while let Some(parent) = ray.parent.and_then(|parent| inspection.ray(parent)) {
        is_seen &= parent.bounce.as_ref().is_none_or(|bounce| matches!(bounce.letters, "R" | "T"))
            && parent.scattered_at().is_none();
        ray = parent;
    }
    (!is_seen).then(|| largest.expression.clone())
}

/// Whether it is the light of the surface itself, or of what is behind the scene.
fn is_emission(addition: &Addition) -> bool {
    let term = addition.term.as_str();
    matches!(term, "emission" | "medium" | "sky" | "open sky") || term.starts_with("found ")
}

/// The expression of a sample without light: its longest way, and nothing at its end.
pub(super) fn dark(inspection: &Inspection) -> String {
    let Some(last) = inspection.rays.iter().max_by_key(|ray| (ray.depth, ray.address)) else {
        return "nothing".into();
    };
    let mut links = links(inspection, last);
    links.extend(last.met.as_ref().map(|met| link(met, "")));
    links.push("nothing".into());
    links.join(" → ")
}

/// The chain from the camera up to a ray, without the ray's own hit.
fn links(inspection: &Inspection, ray: &RayReport) -> Vec<String> {
    let mut links = Vec::new();
    let mut ray = ray;
    while let Some(parent) = ray.parent.and_then(|parent| inspection.ray(parent)) {
        let letters = match (ray.kind, &parent.bounce) {
            (RayKind::StraightOn, _) => None,
            // The point where light leaves is the link.
            _ if parent.probe.is_some() => None,
            (_, Some(bounce)) => Some(bounce.letters),
            (RayKind::Reflected, None) => Some("R"),
            _ => Some("T"),
        };
        match (letters, &parent.met) {
            _ if parent.scattered_at().is_some() => links.push(MEDIUM.into()),
            (Some(letters), Some(met)) => links.push(link(met, letters)),
            _ => {}
        }
        ray = parent;
    }
    links.push("camera".into());
    links.reverse();
    links
}

/// A point of a medium in the chain.
const MEDIUM: &str = "medium (V)";

/// A surface in the chain: its shape.
fn link(met: &MetReport, letters: &str) -> String {
    let name = without_place(&met.shape);
    if letters.is_empty() { name.to_owned() } else { format!("{name} ({letters})") }
}

/// A label without the place in the file.
pub(super) fn without_place(name: &str) -> &str {
    match name.rsplit_once(" (") {
        Some((label, place)) if place.ends_with(')') && place.contains([':', '#', '.', '<']) => label,
        _ => name,
    }
}

/// The light of an addition.
fn light_of(ray: &RayReport, addition: &Addition) -> String {
    match addition.term.as_str() {
        "emission" => ray.met.as_ref().map_or_else(|| "emission".into(), |met| link(met, "")),
        term => {
            let light = term.strip_prefix("found ").or_else(|| term.strip_prefix("sampled ")).unwrap_or(term);
            without_place(light).to_owned()
        }
    }
}

/// The letters of the scattering of the light of a lamp that was sampled there.
fn letters_toward_light(ray: &RayReport, addition: &Addition) -> String {
    if let (Some(scattering), Some(sample)) =
        (&ray.scattering, ray.light_sample.as_ref().and_then(|light| light.sample.as_ref()))
    {
        let crosses = ray.met.as_ref().is_some_and(|met| {
            let cos: f64 = (0..3).map(|k| met.ng[k] * f64::from(sample.wi[k])).sum();
            (cos > 0.0) != met.front
        });
        return format!("{}{}", scattering.letters, if crosses { "T" } else { "" });
    }
    let light = ray.lights.iter().find(|light| light.light == addition.term);
    match light {
        Some(light) if most(&light.specular) > most(&light.diffuse) => "S".into(),
        Some(_) => "D".into(),
        None => String::new(),
    }
}

/// One factor of a contribution.
struct NamedFactor {
    name: &'static str,
    value: f32,
    is_divisor: bool,
}

impl NamedFactor {
    fn times(name: &'static str, value: f32) -> Self {
        Self { name, value, is_divisor: false }
    }

    /// The factor by which it multiplies the light.
    fn multiplier(&self) -> f32 {
        if self.is_divisor { 1.0 / self.value } else { self.value }
    }
}

/// The lanes in which a contribution has light that counts: after dispersion the other wavelengths do not.
fn lit_lanes(inspection: &Inspection, addition: &Addition) -> impl Fn(usize) -> bool {
    let counts = |lane: usize| inspection.wavelengths.as_ref().is_none_or(|light| light.pdf[lane] > 0.0);
    let value = addition.value.lanes.iter().enumerate();
    let lit: Vec<bool> = value.map(|(lane, value)| *value != 0.0 && counts(lane)).collect();
    let is_dark = !lit.contains(&true);
    move |lane| is_dark || lit[lane]
}

/// The factors of a contribution (the largest of the lanes that have light), and the one that makes it large.
fn why(inspection: &Inspection, ray: &RayReport, addition: &Addition) -> String {
    let is_lit = lit_lanes(inspection, addition);
    let most = |lanes: &[f32]| {
        let lit = lanes.iter().enumerate().filter(|(lane, _)| is_lit(*lane));
        lit.map(|(_, value)| *value).fold(0.0, f32::max)
    };
    // A medium shines along the whole way.
    let there = ray.throughput_there.as_ref().filter(|_| addition.term != "medium");
    let beta = most(there.unwrap_or(&ray.throughput));
    let mut factors = vec![NamedFactor::times("β", beta)];
    let sampled = ray.light_sample.as_ref().filter(|_| addition.term.starts_with("sampled "));
    let found = ray.found.iter().find(|found| addition.term == format!("found {}", found.light));
    let local = ray.lights.iter().find(|light| light.light == addition.term);
    if let Some(LightSampleReport { sample: Some(sample), .. }) = sampled {
        factors.extend([
            NamedFactor::times("f cos", most(&sample.f_cos)),
            NamedFactor::times("L", most(&sample.arrives.lanes)),
            NamedFactor::times("w", sample.weight),
            NamedFactor { name: "p", value: sample.pdf, is_divisor: true },
        ]);
    } else if let Some(FoundReport { radiance, weight, .. }) = found {
        factors.extend([NamedFactor::times("L", most(&radiance.lanes)), NamedFactor::times("w", *weight)]);
    } else if let Some(light) = local {
        let sum: Vec<f32> = light.diffuse.iter().zip(&light.specular).map(|(d, s)| d + s).collect();
        factors.extend([
            NamedFactor::times("(k_d N·L + k_s (N·H)^n)", most(&sum)),
            NamedFactor::times("I_j", most(&light.intensity.lanes)),
        ]);
    } else {
        factors.push(NamedFactor::times("L", most(&addition.value.lanes) / beta));
    }
    if inspection.camera.lens_system.is_some() {
        factors.push(NamedFactor::times("lens", inspection.weight));
    }
    if inspection.sensor.scaled_by != 1.0 {
        factors.push(NamedFactor::times("limit", inspection.sensor.scaled_by));
    }
    let product = factors.iter().enumerate().map(|(index, factor)| match (index, factor.is_divisor) {
        (0, _) => format!("{} {}", factor.name, three(factor.value)),
        (_, true) => format!(" / {} {}", factor.name, three(factor.value)),
        (_, false) => format!(" · {} {}", factor.name, three(factor.value)),
    });
    let product: String = product.collect();
    let largest = factors.iter().max_by(|a, b| a.multiplier().total_cmp(&b.multiplier()));
    let largest = largest.filter(|factor| factor.multiplier() > ONE_AS_SHOWN);
    let reason = match largest {
        Some(factor) => reason(inspection, ray, factor, found),
        None => "no factor is above 1".into(),
    };
    // A throughput that stands for many paths makes fireflies even where it is not large.
    match grown(inspection, ray) {
        Some(growth) if largest.is_none_or(|factor| factor.name != "β") && growth.times > MUCH => {
            format!("{product}: {reason}; β has grown {growth}")
        }
        _ => format!("{product}: {reason}"),
    }
}

/// Up to here a factor is shown as 1, which it may be but for rounding.
const ONE_AS_SHOWN: f32 = 1.005;

/// Growth of the throughput at one hit that is told beside the largest factor.
const MUCH: f32 = 4.0;

/// The meaning of a factor above 1.
fn reason(
    inspection: &Inspection,
    ray: &RayReport,
    factor: &NamedFactor,
    found: Option<&FoundReport>,
) -> String {
    match (factor.name, found) {
        ("p", _) => "small p, a direction that is rarely sampled".into(),
        ("β", _) => match grown(inspection, ray) {
            Some(growth) => format!("large β, grown {growth}"),
            None => "large β".into(),
        },
        ("L", Some(found)) if found.weight == 1.0 && found.light_pdf == 0.0 || ray.pdf.is_none() => {
            match ray.depth {
                0 => "large L, seen directly".into(),
                _ => "large L, and only a path of this kind finds it (w = 1)".into(),
            }
        }
        ("L", Some(found)) => {
            format!("large L, found by a bounce though light sampling would (q {})", three(found.light_pdf))
        }
        (name, _) => format!("large {name}"),
    }
}

/// The hit where the throughput has grown most, by its BSDF sample and Russian roulette.
struct Growth {
    times: f32,
    address: u64,
    pdf: f32,
    survival: f32,
}

impl Display for Growth {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { times, address, pdf, survival } = *self;
        write!(f, "{} times at the hit of ray {address} (pdf {}", three(times), three(pdf))?;
        match survival < 1.0 {
            true => write!(f, ", survival of Russian roulette {})", three(survival)),
            false => write!(f, ")"),
        }
    }
}

/// The place on the way to a ray where the throughput has grown most.
fn grown(inspection: &Inspection, ray: &RayReport) -> Option<Growth> {
    let mut most_grown: Option<Growth> = None;
    let mut next = ray.parent;
    while let Some(ray) = next.and_then(|address| inspection.ray(address)) {
        if let Some(bounce) = &ray.bounce {
            let times = most(&bounce.throughput_after) / (most(&bounce.throughput_before) * bounce.survival);
            if most_grown.as_ref().is_none_or(|most| times > most.times) {
                let (pdf, survival) = (bounce.pdf, bounce.survival);
                most_grown = Some(Growth { times, address: ray.address, pdf, survival });
            }
        }
        next = ray.parent;
    }
    most_grown
}

/// The largest lane.
fn most(lanes: &[f32]) -> f32 {
    lanes.iter().copied().fold(0.0, f32::max)
}

/// Three digits.
fn three(x: f32) -> String {
    match x.abs() {
        0.0 => "0".into(),
        size if !(1e-3..1e5).contains(&size) => format!("{x:.2e}"),
        size => {
            let digits = (2 - libm::log10f(size).floor() as i32).max(0) as usize;
            let fixed = format!("{x:.digits$}");
            match fixed.contains('.') {
                true => fixed.trim_end_matches('0').trim_end_matches('.').to_owned(),
                false => fixed,
            }
        }
    }
}
