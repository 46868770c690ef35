//! Microfacets as text: D, G and F, and their product.

use std::fmt::{self, Write};

use super::{full, lanes, vector32};
use crate::inspect::MicrofacetReport;

/// Writes the factors of each boundary, and what they come to.
pub(super) fn write_microfacets(f: &mut String, microfacets: &[MicrofacetReport]) -> fmt::Result {
    microfacets.iter().try_for_each(|boundary| write_boundary(f, boundary))
}

fn write_boundary(f: &mut String, report: &MicrofacetReport) -> fmt::Result {
    let MicrofacetReport { boundary, alpha, cos_o, cos_i, cos_om, cos_im, eta, weight, .. } = report;
    let [cos_o, cos_i, cos_om, cos_im] = [cos_o, cos_i, cos_om, cos_im].map(|cos| full(*cos));
    let fresnel = lanes(&report.fresnel);
    let is_rest = report.part.iter().zip(&report.fresnel).all(|(part, fresnel)| *part == 1.0 - fresnel);
    let part = match (report.part == report.fresnel, is_rest) {
        (true, _) => "F",
        (_, true) => "(1 − F)",
        _ => "part",
    };
    let does = match (report.refracts, *boundary == "thin dielectric" && is_rest) {
        (true, _) => "refracts",
        (false, true) => "lets light through",
        (false, false) => "reflects",
    };
    let weighted = match (*weight == 1.0, &report.multiple_scattering) {
        (_, Some(_)) => "gain · ",
        (true, None) => "",
        (false, None) => "weight · ",
    };
    match (report.d, report.g) {
        (Some(d), Some(g)) => {
            let (d, g) = (full(d), full(g));
            writeln!(f, "      microfacets of the {boundary} (α {}), each {does}:", lanes(alpha))?;
            writeln!(
                f,
                "        ω_m = {}   D = {d}   G = {g}   F = {fresnel}",
                vector32(&report.half_vector)
            )?;
            if let [x, y] = report.alpha
                && x != y
            {
                writeln!(
                    f,
                    "        D = 1 / (π α_s α_t e²), e = (ω_m·s / α_s)² + (ω_m·t / α_t)² + (ω_m·n)²"
                )?;
            }
            writeln!(
                f,
                "        ω_o·n = {cos_o}   ω_i·n = {cos_i}   ω_o·ω_m = {cos_om}   ω_i·ω_m = {cos_im}"
            )?;
        }
        _ => writeln!(f, "      the {boundary} is smooth and {does}: F = {fresnel}   ω_i·n = {cos_i}")?,
    }
    let mut more = Vec::new();
    if part == "part" {
        more.push(format!("part = what goes this way, tinted = {}", lanes(&report.part)));
    }
    if *eta != 1.0 {
        more.push(format!("η = {}", full(*eta)));
    }
    if *weight != 1.0 {
        more.push(format!("weight = {}", full(*weight)));
    }
    if !more.is_empty() {
        writeln!(f, "        {}", more.join("   "))?;
    }
    if let Some(more) = &report.multiple_scattering {
        let (albedo, mean) = (full(more.albedo), full(more.mean_albedo));
        let (fresnel, gain) = (lanes(&more.mean_fresnel), lanes(&more.gain));
        writeln!(
            f,
            "        light between facets: E(ω_o) = {albedo}   mean Ē = {mean}   mean F̄ = {fresnel}"
        )?;
        writeln!(f, "        gain = 1 + F̄ Ē / (1 − F̄ (1 − Ē)) · (1 − E) / E = {gain}")?;
    }
    let formula = match (report.d.is_some(), report.refracts) {
        (true, false) => format!("{weighted}{part} · D G / (4 |ω_o·n| |ω_i·n|)"),
        (true, true) => format!(
            "{weighted}{part} · D G |ω_o·ω_m| |ω_i·ω_m| / (|ω_o·n| |ω_i·n| (ω_i·ω_m + ω_o·ω_m / η)² η²)"
        ),
        (false, false) => format!("{weighted}{part} / |ω_i·n|"),
        (false, true) => format!("{weighted}{part} / (|ω_i·n| η²)"),
    };
    writeln!(f, "        {formula} = {}", lanes(&report.value))
}
