//! The tree of rays as text, indented.

use std::fmt::{self, Write};

use super::candidates::{write_candidates, write_traced};
use super::hit::{write_absorption, write_departure, write_derivations, write_met, write_shadow};
use super::{Excerpt, TextPart, amount, full, lanes, vector, vector32};
use crate::inspect::{BranchReport, LightReport, RayKind, RayReport};

/// Number of candidates that are shown besides the hit of a ray of the tree; the JSON has all.
const OTHERS_IN_TREE: usize = 5;

/// Rays deeper in the tree are not indented further.
const DEEPEST_INDENT: usize = 18;

impl Excerpt<'_> {
    pub(super) fn write_ray(&self, f: &mut String, ray: &RayReport, indent: usize) -> fmt::Result {
        // Deep trees would run out of columns.
        let pad = &"  ".repeat((indent + 1).min(DEEPEST_INDENT));
        let is_shown = self.shows(ray);
        if is_shown {
            self.write_hit(f, ray, pad)?;
        }
        let straight_on = self
            .inspection
            .rays
            .iter()
            .find(|child| child.parent == Some(ray.address) && child.kind == RayKind::StraightOn);
        if let Some(child) = straight_on {
            if is_shown {
                writeln!(
                    f,
                    "{pad}  the ray passes this surface (cut out by its alpha) and goes straight on"
                )?;
            }
            return self.write_ray(f, child, indent);
        }
        for branch in &ray.branches {
            if is_shown && self.has(TextPart::Lights) {
                write_branch(f, branch, pad)?;
            }
            if let Some(child) = self.inspection.rays.iter().find(|child| child.address == branch.address) {
                self.write_ray(f, child, indent + 1)?;
            }
        }
        if is_shown && !ray.branches.is_empty() {
            writeln!(f, "{pad}  all below ray {}: {}", ray.address, amount(&ray.subtree))?;
        }
        Ok(())
    }

    /// Writes a ray, its hit, and the light there.
    fn write_hit(&self, f: &mut String, ray: &RayReport, pad: &str) -> fmt::Result {
        writeln!(f, "{pad}{} ray {}: throughput {}", ray.kind, ray.address, lanes(&ray.throughput))?;
        if self.has(TextPart::Tests) {
            writeln!(f, "{pad}  a = {}   direction = {}", vector(&ray.a), vector32(&ray.direction))?;
            write_departure(f, ray.departure.as_ref(), &format!("{pad}  "))?;
            write_traced(f, ray, pad)?;
            write_candidates(f, ray, OTHERS_IN_TREE, pad)?;
        }
        match &ray.met {
            None => writeln!(f, "{pad}  meets nothing: the sky")?,
            Some(met) => write_met(f, met, pad)?,
        }
        if self.has(TextPart::Lights) {
            write_absorption(f, ray, pad)?;
            ray.lights.iter().try_for_each(|light| write_light(f, light, pad))?;
            let additions = &self.inspection.additions;
            for addition in additions.iter().filter(|addition| addition.address == ray.address) {
                writeln!(f, "{pad}  + {}   {}", amount(&addition.value), addition.term)?;
            }
        }
        Ok(())
    }
}

fn write_branch(f: &mut String, branch: &BranchReport, pad: &str) -> fmt::Result {
    writeln!(f, "{pad}  {} branch, weight {}", branch.kind, lanes(&branch.weight))?;
    write!(f, "{pad}    toward {}, cos θ {}", vector32(&branch.direction), full(branch.cos))?;
    if let Some(eta) = branch.eta {
        write!(f, ", η {}", full(eta))?;
    }
    if let Some(fresnel) = branch.fresnel {
        write!(f, ", Fresnel reflectance {fresnel}")?;
    }
    if branch.total_reflection {
        write!(f, ", total internal reflection")?;
    }
    if let Some(cut) = branch.cut {
        write!(f, "; not followed: {cut}")?;
    }
    writeln!(f)
}

fn write_light(f: &mut String, light: &LightReport, pad: &str) -> fmt::Result {
    let Some(wi) = light.wi else {
        return writeln!(f, "{pad}  light {}: does not illuminate this point", light.light);
    };
    writeln!(f, "{pad}  light {}: L = {}", light.light, vector32(&wi))?;
    if let Some(point) = light.point {
        writeln!(f, "{pad}    from the point {}", vector(&point))?;
    }
    match light.pdf {
        Some(pdf) if pdf != 1.0 => writeln!(
            f,
            "{pad}    I_j = radiance / (π pdf) = {} / (π {}) = {}",
            amount(&light.arrives),
            full(pdf),
            amount(&light.intensity)
        )?,
        _ => writeln!(
            f,
            "{pad}    I_j = L / π = {} / π = {}",
            amount(&light.arrives),
            amount(&light.intensity)
        )?,
    }
    write_derivations(f, &light.derivations, &format!("{pad}      "))?;
    if let (Some(n_dot_l), Some(h), Some(n_dot_h)) = (light.n_dot_l, light.h, light.n_dot_h) {
        let (n_dot_l, h, n_dot_h) = (full(n_dot_l), vector32(&h), full(n_dot_h));
        writeln!(f, "{pad}    N·L = {n_dot_l}   H = {h}   N·H = {n_dot_h}")?;
    }
    let (diffuse, specular) = (lanes(&light.diffuse), lanes(&light.specular));
    writeln!(f, "{pad}    k_d (N·L) = {diffuse}   k_s (N·H)^n = {specular}")?;
    write_shadow(f, light.shadow.as_ref(), "reaches the light", pad)
}
