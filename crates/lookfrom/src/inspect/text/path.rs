//! The text report of a path: one ray after the other, each number with its formula.

use std::fmt::{self, Write};

use lookfrom_scene::plural::counted;

use super::candidates::{write_candidates, write_traced};
use super::hit::{write_departure, write_derivations, write_met, write_shadow};
use super::medium::{write_medium, write_phase};
use super::microfacets::write_microfacets;
use super::probe::write_probe;
use super::{Excerpt, RayReport, TextPart};
use super::{amount, full, lanes, vector, vector32};
use crate::inspect::scatter::{
    BounceReport, FoundReport, FoundSampling, LightSampleReport, ScatteringReport,
};

/// Number of candidates that are shown besides the hit of a ray.
const OTHERS_ALONG_PATH: usize = 0;

/// The reason why a direction has no density for MIS.
const ONLY_CHOICE: &str =
    "the only one possible (from the camera, or after specular reflection or transmission)";

impl Excerpt<'_> {
    pub(super) fn write_path(&self, f: &mut String) -> fmt::Result {
        writeln!(f, "The path, ray by ray")?;
        if self.has(TextPart::Lights) && !self.is_of_rays() {
            self.write_introduction(f)?;
        }
        for ray in self.inspection.rays.iter().filter(|ray| self.shows(ray)) {
            writeln!(f)?;
            self.write_ray_of_path(f, ray)?;
        }
        Ok(())
    }

    /// Writes the meaning of the letters that this integrator uses.
    fn write_introduction(&self, f: &mut String) -> fmt::Result {
        if self.inspection.integrator == "ambient_occlusion" {
            return writeln!(
                f,
                "  One shadow ray from the first surface: is anything near? Lines with + are added to the pixel."
            );
        }
        writeln!(
            f,
            "  Each ray goes on in one sampled direction; the light that it finds is divided by the density (pdf, per"
        )?;
        writeln!(
            f,
            "  steradian) of that direction, so that the mean over many samples converges to the true value."
        )?;
        writeln!(
            f,
            "    β    the path's throughput: light found here is multiplied by it on its way into the pixel"
        )?;
        writeln!(f, "    f    the BSDF of the surface; cos: of the angle to its normal n")?;
        writeln!(f, "    L    incident radiance from a direction")?;
        match self.inspection.integrator {
            "path" => {
                writeln!(
                    f,
                    "    w    MIS weight: light is found by two techniques, light sampling and BSDF sampling, whose weights add"
                )?;
                writeln!(
                    f,
                    "         up to 1: w = p² / (p² + q²) (the power heuristic), with the density p of the technique that found"
                )?;
                writeln!(f, "         the light, and q of the other one")?;
            }
            "simple_path" => {
                writeln!(
                    f,
                    "    w    light that can be sampled counts only where it is sampled (w = 1), not where a path hits it"
                )?;
                writeln!(
                    f,
                    "         (w = 0); light that cannot be sampled counts where a path hits it (w = 1)"
                )?;
            }
            _ => writeln!(f, "    w    no lights are sampled: all light is found by paths, w = 1")?,
        }
        writeln!(f, "  Lines with + are added to the pixel.")
    }

    fn write_ray_of_path(&self, f: &mut String, ray: &RayReport) -> fmt::Result {
        let pad = "  ";
        writeln!(
            f,
            "{pad}ray {} ({}{}): β = {}",
            ray.address,
            ray.kind,
            after(ray.depth),
            lanes(&ray.throughput)
        )?;
        if self.has(TextPart::Tests) {
            writeln!(f, "{pad}  a = {}   direction = {}", vector(&ray.a), vector32(&ray.direction))?;
            write_departure(f, ray.departure.as_ref(), &format!("{pad}  "))?;
            write_traced(f, ray, pad)?;
            write_candidates(f, ray, OTHERS_ALONG_PATH, pad)?;
        }
        match &ray.met {
            None if ray.scattered_at().is_some() => {
                writeln!(f, "{pad}  a medium scatters it before it meets anything")?;
            }
            None => writeln!(f, "{pad}  meets nothing: the sky")?,
            Some(met) => write_met(f, met, pad)?,
        }
        if !self.has(TextPart::Lights) {
            return Ok(());
        }
        write_medium(f, ray)?;
        if let (Some(color), Some(there)) = (ray.only_color, &ray.throughput_there) {
            let why = format!("dispersion: {color} goes on alone, with the weight of all colours");
            writeln!(f, "{pad}  {why}: β = {}", lanes(there))?;
        }
        for found in &ray.found {
            self.write_found(f, ray, found)?;
        }
        if let Some(scattering) = &ray.scattering {
            write_scattering(f, scattering)?;
        }
        if let Some(report) = &ray.light_sample {
            self.write_light_sample(f, report, ray.scattered_at().is_some())?;
        }
        if let Some(openness) = &ray.openness {
            writeln!(f, "{pad}  is anything near?")?;
            write_shadow(f, Some(openness), "nothing is near", pad)?;
            writeln!(f, "{pad}    + {}", amount(&ray.added))?;
        }
        if let Some(bounce) = &ray.bounce {
            self.write_bounce(f, bounce)?;
        }
        if let Some(probe) = &ray.probe {
            write_probe(f, probe)?;
        }
        if let Some(phase) = &ray.phase {
            write_phase(f, phase)?;
        }
        let goes_on = ray.ends.is_none();
        if goes_on && ray.bounce.is_none() && ray.phase.is_none() {
            writeln!(
                f,
                "{pad}  the ray passes this surface (an interface, or cut out by its alpha) and goes straight on"
            )?;
        }
        if let Some(why) = ray.ends {
            writeln!(f, "{pad}  the path ends: {why}")?;
        }
        match goes_on {
            true => {
                writeln!(f, "{pad}  ray {} and all after it contribute {}", ray.address, amount(&ray.subtree))
            }
            false => writeln!(f, "{pad}  ray {} contributes {}", ray.address, amount(&ray.subtree)),
        }
    }

    fn write_found(&self, f: &mut String, ray: &RayReport, found: &FoundReport) -> fmt::Result {
        writeln!(f, "    finds the light {}: L = {}", found.light, amount(&found.radiance))?;
        write_derivations(f, found.emission.as_slice(), "      ")?;
        let (w, q) = (full(found.weight), full(found.light_pdf));
        match (ray.pdf, self.inspection.integrator) {
            (None, _) => {
                writeln!(f, "      direction: {ONLY_CHOICE}, light sampling cannot find it: w = {w}")?;
            }
            (Some(p), "path") => {
                writeln!(f, "      p = {}: pdf of this direction {}", full(p), self.sampling_before(ray))?;
                writeln!(f, "      q = {q}: pdf of this direction in light sampling there")?;
                write_found_sampling(f, found.sampling.as_ref())?;
                writeln!(f, "      w = p² / (p² + q²) = {w}")?;
            }
            (Some(_), "simple_path") if found.light_pdf > 0.0 => {
                writeln!(f, "      light sampling finds it too (pdf {q}), and has counted it: w = {w}")?;
            }
            (Some(_), "simple_path") => writeln!(f, "      light sampling cannot find it: w = {w}")?,
            _ => writeln!(f, "      no lights are sampled: w = {w}")?,
        }
        writeln!(f, "      + β L w = {}", amount(&found.added))
    }

    /// Source of a ray's direction: a phase function, or a BSDF.
    fn sampling_before(&self, ray: &RayReport) -> &'static str {
        let parent_of = |ray: &RayReport| self.inspection.ray(ray.parent?);
        let before = std::iter::successors(parent_of(ray), |ray| parent_of(ray));
        let mut scattered = before.skip_while(|ray| ray.bounce.is_none() && ray.phase.is_none());
        match scattered.next().is_some_and(|ray| ray.phase.is_some()) {
            true => "by the phase function of the medium before",
            false => "in BSDF sampling at the surface before",
        }
    }

    fn write_light_sample(
        &self,
        f: &mut String,
        report: &LightSampleReport,
        is_in_medium: bool,
    ) -> fmt::Result {
        writeln!(
            f,
            "    samples one light: {}, chosen with probability {}",
            report.light,
            full(report.probability)
        )?;
        write_derivations(f, &report.choice, "      ")?;
        let Some(sample) = &report.sample else {
            return writeln!(
                f,
                "      it does not illuminate this point ({})",
                if is_in_medium { "it faces away" } else { "it is behind the surface, or faces away" }
            );
        };
        writeln!(
            f,
            "      toward it: wi = {}   unoccluded: L = {}",
            vector32(&sample.wi),
            amount(&sample.arrives)
        )?;
        if sample.f_cos.iter().all(|lane| *lane == 0.0) {
            return writeln!(f, "      f cos = 0: the surface scatters none of it along this path");
        }
        match is_in_medium {
            true => writeln!(f, "      f cos = {}: the phase function", lanes(&sample.f_cos))?,
            false => writeln!(f, "      f cos = {}", lanes(&sample.f_cos))?,
        }
        write_microfacets(f, &sample.microfacets)?;
        if let Some(point) = sample.point {
            writeln!(f, "      from the point {}", vector(&point))?;
        }
        write_derivations(f, &sample.derivations, "      ")?;
        let (p, pdf, probability) = (full(sample.pdf), full(sample.light_pdf), full(report.probability));
        match sample.is_delta {
            true => writeln!(f, "      p = {p}: the probability of choosing it; it has only this direction")?,
            false => {
                writeln!(
                    f,
                    "      p = probability × pdf of this direction to it = {probability} × {pdf} = {p}"
                )?;
            }
        }
        match sample.bsdf_pdf {
            Some(q) => {
                let sampling = if is_in_medium { "by the phase function" } else { "in BSDF sampling" };
                writeln!(f, "      q = {}: pdf of this direction {sampling}", full(q))?;
                writeln!(f, "      w = p² / (p² + q²) = {}", full(sample.weight))?;
            }
            None => {
                let why = match self.inspection.integrator {
                    "path" => "a delta light: no path hits it",
                    _ => "light that can be sampled counts only here",
                };
                writeln!(f, "      w = {} ({why})", full(sample.weight))?;
            }
        }
        write_shadow(f, report.shadow.as_ref(), "reaches the light", "  ")?;
        writeln!(f, "      + β f cos L w / p = {}", amount(&report.added))
    }

    fn write_bounce(&self, f: &mut String, bounce: &BounceReport) -> fmt::Result {
        match self.inspection.integrator {
            "random_walk" => writeln!(
                f,
                "    goes on in a direction sampled uniformly over the sphere: wi = {}",
                vector32(&bounce.wi)
            )?,
            _ => writeln!(f, "    goes on by {}: wi = {}", bounce.lobe, vector32(&bounce.wi))?,
        }
        writeln!(
            f,
            "      f = {}   cos = {}   pdf = {}",
            lanes(&bounce.f),
            full(bounce.cos),
            full(bounce.pdf)
        )?;
        write_microfacets(f, &bounce.microfacets)?;
        if bounce.lobe.starts_with("specular") {
            writeln!(
                f,
                "      (specular: pdf is the probability of this lobe; f and pdf are factors of the same delta function)"
            )?;
        }
        if bounce.pdf_is_proportional {
            writeln!(
                f,
                "      (f and pdf are estimated by a random walk between the layers: only their ratio is meaningful)"
            )?;
        }
        if bounce.eta != 1.0 {
            writeln!(
                f,
                "      η = {}: relative index of refraction, beyond the surface over before it; f contains 1/η², which is\n           regained on leaving",
                full(bounce.eta)
            )?;
        }
        writeln!(f, "      β f cos / pdf = {}", lanes(&bounce.throughput_after))?;
        match (bounce.survival < 1.0, bounce.survives) {
            (false, _) => Ok(()),
            (true, survives) => {
                let survival = full(bounce.survival);
                write!(
                    f,
                    "      Russian roulette: survives with probability {survival} (twice the largest lane of β × the η² so far {}): ",
                    full(bounce.eta_scale)
                )?;
                match (survives, &bounce.next_throughput) {
                    (true, Some(next)) => {
                        writeln!(f, "it does,\n      and β / {survival} = {}", lanes(next))
                    }
                    (true, None) => writeln!(f, "it does"),
                    (false, _) => writeln!(f, "it does not"),
                }
            }
        }
    }
}

/// The density with which light sampling at the surface before finds a light.
fn write_found_sampling(f: &mut String, sampling: Option<&FoundSampling>) -> fmt::Result {
    let Some(FoundSampling { probability, choice, density, derivations }) = sampling else { return Ok(()) };
    let (probability, density) = (full(*probability), full(*density));
    writeln!(f, "        = P × pdf = {probability} × {density}: its choice there, and the direction")?;
    write_derivations(f, choice, "        ")?;
    write_derivations(f, derivations, "        ")
}

fn write_scattering(f: &mut String, scattering: &ScatteringReport) -> fmt::Result {
    writeln!(f, "    {}: {}", scattering.kind, scattering.does)?;
    let numbers = scattering.numbers.iter().map(|(name, values)| match values.as_slice() {
        [value] => format!("{name} {}", full(*value)),
        _ => format!("{name} {}", lanes(values)),
    });
    writeln!(f, "      {}", numbers.collect::<Vec<_>>().join("   "))?;
    writeln!(f, "      lobes: {}   n = {}", scattering.lobes, vector32(&scattering.n))?;
    let is_uneven = |(name, values): &(&str, Vec<f32>)| {
        name.ends_with("alpha") && values[0] != *values.last().unwrap_or(&0.0)
    };
    if scattering.numbers.iter().any(is_uneven) {
        let [s, t] = scattering.tangents.map(|tangent| vector32(&tangent));
        writeln!(f, "      alpha is along s = {s} and t = {t}")?;
    }
    Ok(())
}

fn after(bounces: u32) -> String {
    match bounces {
        0 => String::new(),
        _ => format!(", after {}", counted(bounces, "bounce")),
    }
}
