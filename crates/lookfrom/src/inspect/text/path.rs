//! The text report of a path: one ray after the other, each number with its formula.

use std::fmt::{self, Formatter};

use super::{Inspection, RayReport};
use super::{amount, full, lanes, vector, vector32, write_candidates, write_met, write_shadow};
use crate::inspect::scatter::{AskedReport, BounceReport, FoundReport, ScatteringReport};

/// How many candidates are shown beside what a ray met: the path is the matter here.
const OTHERS_ALONG_PATH: usize = 0;

/// Why a direction has no density to weigh.
const ONLY_CHOICE: &str = "it was the only choice (from the camera, or in a mirror or smooth glass)";

impl Inspection {
    pub(super) fn write_path(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "The path, ray by ray")?;
        self.write_introduction(f)?;
        for ray in &self.rays {
            writeln!(f)?;
            self.write_ray_of_path(f, ray)?;
        }
        Ok(())
    }

    /// What the letters mean, as far as this integrator has them.
    fn write_introduction(&self, f: &mut Formatter<'_>) -> fmt::Result {
        if self.integrator == "ambient_occlusion" {
            return writeln!(
                f,
                "  One shadow ray from the first surface: is anything near? Lines with + are added to the pixel."
            );
        }
        writeln!(
            f,
            "  Each ray goes on in one direction, chosen by chance; what it finds is divided by the density (pdf, per"
        )?;
        writeln!(f, "  steradian) of that choice, so that the mean over many samples is right.")?;
        writeln!(
            f,
            "    β    the path's throughput: what light found here is multiplied by on its way into the pixel"
        )?;
        writeln!(f, "    f    the scattering function of the surface; cos: of the angle to its normal n")?;
        writeln!(f, "    L    light that arrives from a direction")?;
        match self.integrator {
            "path" => {
                writeln!(
                    f,
                    "    w    light can be found in two ways, by sampling a light and by the path's own direction; each gets a"
                )?;
                writeln!(
                    f,
                    "         weight, the two of them 1 together: w = p² / (p² + q²), with the density p of the way that found"
                )?;
                writeln!(f, "         it, and q that the other way would have had (the power heuristic)")?;
            }
            "simple_path" => {
                writeln!(
                    f,
                    "    w    light that can be sampled counts only where it is sampled (w = 1), not where the path meets it"
                )?;
                writeln!(f, "         (w = 0), unless no light could be sampled there")?;
            }
            _ => writeln!(f, "    w    no lights are sampled: all light is found by chance, w = 1")?,
        }
        writeln!(f, "  Lines with + are what is added to the pixel.")
    }

    fn write_ray_of_path(&self, f: &mut Formatter<'_>, ray: &RayReport) -> fmt::Result {
        let pad = "  ";
        writeln!(
            f,
            "{pad}ray {} ({}{}): β = {}",
            ray.address,
            ray.kind,
            after(ray.depth),
            lanes(&ray.throughput)
        )?;
        writeln!(f, "{pad}  a = {}   direction = {}", vector(&ray.a), vector32(&ray.direction))?;
        write_candidates(f, ray, OTHERS_ALONG_PATH, pad)?;
        match &ray.met {
            None => writeln!(f, "{pad}  meets nothing: the sky")?,
            Some(met) => write_met(f, met, pad)?,
        }
        if let Some(share) = ray.throughput_there.as_ref().filter(|share| **share != ray.throughput) {
            let why = match ray.only_color {
                Some(color) => {
                    format!("colours go different ways here: {color} goes on alone, for all of them")
                }
                None => "of the light on this way a part is absorbed".into(),
            };
            writeln!(f, "{pad}  {why}: β = {}", lanes(share))?;
        }
        for found in &ray.found {
            self.write_found(f, ray, found)?;
        }
        if let Some(scattering) = &ray.scattering {
            write_scattering(f, scattering)?;
        }
        if let Some(asked) = &ray.asked {
            self.write_asked(f, asked)?;
        }
        if let Some(openness) = &ray.openness {
            writeln!(f, "{pad}  is anything near?")?;
            write_shadow(f, Some(openness), "nothing is near", pad)?;
            writeln!(f, "{pad}    + {}", amount(&ray.added))?;
        }
        if let Some(bounce) = &ray.bounce {
            self.write_bounce(f, bounce)?;
        }
        let goes_on = ray.ends.is_none();
        if goes_on && ray.bounce.is_none() {
            writeln!(
                f,
                "{pad}  this surface is not there (an interface, or cut out by its alpha): the ray goes straight on"
            )?;
        }
        if let Some(why) = ray.ends {
            writeln!(f, "{pad}  the path ends: {why}")?;
        }
        match goes_on {
            true => writeln!(f, "{pad}  ray {} and all after it bring {}", ray.address, amount(&ray.subtree)),
            false => writeln!(f, "{pad}  ray {} brings {}", ray.address, amount(&ray.subtree)),
        }
    }

    fn write_found(&self, f: &mut Formatter<'_>, ray: &RayReport, found: &FoundReport) -> fmt::Result {
        writeln!(f, "    finds the light {}: L = {}", found.light, amount(&found.radiance))?;
        let (w, q) = (full(found.weight), full(found.light_pdf));
        match (ray.pdf, self.integrator) {
            (None, _) => writeln!(
                f,
                "      direction: {ONLY_CHOICE}, light sampling could not have found it: w = {w}"
            )?,
            (Some(p), "path") => {
                writeln!(f, "      p = {}: pdf with which the surface before chose this direction", full(p))?;
                writeln!(f, "      q = {q}: pdf with which light sampling would have chosen it")?;
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

    fn write_asked(&self, f: &mut Formatter<'_>, asked: &AskedReport) -> fmt::Result {
        writeln!(
            f,
            "    samples one light: {}, chosen with probability {}",
            asked.light,
            full(asked.probability)
        )?;
        let Some(answer) = &asked.answer else {
            return writeln!(
                f,
                "      no light can come from there (it is behind the surface, or faces away)"
            );
        };
        writeln!(
            f,
            "      toward it: wi = {}   arriving if nothing is in the way: L = {}",
            vector32(&answer.wi),
            amount(&answer.arrives)
        )?;
        if answer.f_cos.iter().all(|lane| *lane == 0.0) {
            return writeln!(f, "      f cos = 0: the surface sends nothing of it this way");
        }
        writeln!(f, "      f cos = {}", lanes(&answer.f_cos))?;
        let (p, pdf) = (full(answer.pdf), full(answer.light_pdf));
        match answer.bsdf_pdf {
            Some(q) => {
                writeln!(
                    f,
                    "      p = probability × pdf of this direction to it = {} × {pdf} = {p}",
                    full(asked.probability)
                )?;
                writeln!(
                    f,
                    "      q = {}: pdf with which the surface itself would have chosen this direction",
                    full(q)
                )?;
                writeln!(f, "      w = p² / (p² + q²) = {}", full(answer.weight))?;
            }
            None => {
                writeln!(
                    f,
                    "      p = probability × pdf of this direction to it = {} × {pdf} = {p}",
                    full(asked.probability)
                )?;
                let why = match self.integrator {
                    "path" => "a light without size: no path meets it",
                    _ => "light that can be sampled counts only here",
                };
                writeln!(f, "      w = {} ({why})", full(answer.weight))?;
            }
        }
        write_shadow(f, asked.shadow.as_ref(), "reaches the light", "  ")?;
        writeln!(f, "      + β f cos L w / p = {}", amount(&asked.added))
    }

    fn write_bounce(&self, f: &mut Formatter<'_>, bounce: &BounceReport) -> fmt::Result {
        match self.integrator {
            "random_walk" => writeln!(
                f,
                "    goes on in any direction, whatever the surface: wi = {}",
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
        if bounce.lobe.starts_with("specular") {
            writeln!(
                f,
                "      (one direction only: pdf is the probability of this lobe, and f is over that one direction)"
            )?;
        }
        if bounce.pdf_is_proportional {
            writeln!(
                f,
                "      (f and pdf are estimated by a random walk between the layers: only their ratio means something)"
            )?;
        }
        if bounce.eta != 1.0 {
            writeln!(
                f,
                "      η = {}: index beyond the surface over the one before it; f has 1/η² in it, which light regains\n           on leaving",
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
                    "      Russian roulette: goes on with probability {survival} (greatest lane of β, × η² inside glass): "
                )?;
                match (survives, &bounce.next_throughput) {
                    (true, Some(share)) => {
                        writeln!(f, "it does,\n      and β / {survival} = {}", lanes(share))
                    }
                    (true, None) => writeln!(f, "it does"),
                    (false, _) => writeln!(f, "it does not"),
                }
            }
        }
    }
}

fn write_scattering(f: &mut Formatter<'_>, scattering: &ScatteringReport) -> fmt::Result {
    writeln!(f, "    {}: {}", scattering.kind, scattering.does)?;
    let numbers = scattering.numbers.iter().map(|(name, values)| match values.as_slice() {
        [value] => format!("{name} {}", full(*value)),
        _ => format!("{name} {}", lanes(values)),
    });
    writeln!(f, "      {}", numbers.collect::<Vec<_>>().join("   "))?;
    writeln!(f, "      lobes: {}   n = {}", scattering.lobes, vector32(&scattering.n))
}

fn after(bounces: u32) -> String {
    match bounces {
        0 => String::new(),
        1 => ", after 1 bounce".into(),
        _ => format!(", after {bounces} bounces"),
    }
}
