//! A hit as text: the point, the material, what was absorbed on the way; and shadow rays.

use std::fmt::{self, Write};

use super::candidates::work;
use super::medium::write_null_collisions;
use super::{exact, full, full64, lanes, vector, vector32};
use crate::inspect::{
    AbsorptionReport, Departure, FootprintReport, LiftReport, MetReport, RayReport, ShadowReport,
};
use crate::light::derivation::Derivation;

pub(super) fn write_met(f: &mut String, met: &MetReport, pad: &str) -> fmt::Result {
    let side = if met.front { "outside" } else { "inside" };
    let instance = met.instance.map_or(String::new(), |instance| format!(" in instance {instance}"));
    writeln!(f, "{pad}  meets {} at t = {} from {side}{instance}", met.shape, met.t)?;
    writeln!(f, "{pad}    point = {}", vector(&met.point))?;
    writeln!(f, "{pad}      off the surface by at most {}, per component", vector(&met.error))?;
    write_lift(f, met.lift.as_ref(), &format!("{pad}    "))?;
    writeln!(f, "{pad}    ng = {}   n = {}", vector(&met.ng), vector32(&met.n))?;
    writeln!(f, "{pad}    uv = {}   cos θ to the viewer = {}", vector32(&met.uv), full(met.cos_viewer))?;
    if let Some(FootprintReport { dpdx, dpdy, duv_dx, duv_dy }) = &met.footprint {
        let [of_p, of_uv] = [[dpdx, dpdy].map(|p| vector32(p)), [duv_dx, duv_dy].map(|uv| vector32(uv))];
        writeln!(f, "{pad}    a pixel sees ∂p/∂x = {}   ∂p/∂y = {}", of_p[0], of_p[1])?;
        writeln!(
            f,
            "{pad}      ∂(u, v)/∂x = {}   ∂(u, v)/∂y = {}: textures are averaged over that",
            of_uv[0], of_uv[1]
        )?;
    }
    if let Some(alpha) = met.alpha {
        writeln!(f, "{pad}    alpha = {}: the surface is there with this probability", full(alpha))?;
    }
    write!(f, "{pad}    material {}", met.material)?;
    if let Some(k) = &met.coefficients {
        write!(
            f,
            "\n{pad}      k_a {} k_d {} k_s {} n {}\n{pad}     ",
            lanes(&k.ambient),
            lanes(&k.diffuse),
            lanes(&k.specular),
            k.shininess
        )?;
        write!(f, " k_r {} k_t {} ior {}", lanes(&k.mirror), lanes(&k.transmission), k.ior)?;
    }
    writeln!(f)
}

/// The absorption by a medium on the way.
pub(super) fn write_absorption(f: &mut String, ray: &RayReport, pad: &str) -> fmt::Result {
    let Some(absorption) = &ray.absorption else { return Ok(()) };
    let AbsorptionReport { material, sigma, scale, length, transmittance, throughput } = absorption;
    let medium = material.as_deref().unwrap_or("the medium that fills space");
    writeln!(f, "{pad}  absorbed by {medium}: T = exp(−σ · length) = {}", lanes(transmittance))?;
    let scale = if *scale == 1.0 { String::new() } else { format!(" · {}", full(*scale)) };
    writeln!(f, "{pad}    σ = {}{scale}   length = {}", lanes(sigma), full(*length))?;
    writeln!(f, "{pad}    throughput there = {}", lanes(throughput))
}

/// Writes where a ray starts that leaves a smooth surface from above the triangle that stands for it.
pub(super) fn write_departure(f: &mut String, departure: Option<&Departure>, pad: &str) -> fmt::Result {
    let Some(Departure { lift: Some(_), step }) = departure else { return Ok(()) };
    writeln!(f, "{pad}starts at point + lift + s ng, rounded outward to f32: s = {}", full64(*step))
}

/// Writes the way to the smooth surface that a triangle stands for.
fn write_lift(f: &mut String, lift: Option<&LiftReport>, pad: &str) -> fmt::Result {
    let Some(LiftReport { corners, normals, weights, from_object, lift }) = lift else { return Ok(()) };
    let row = |row: &[f32; 3]| exact(&row.map(f64::from));
    writeln!(
        f,
        "{pad}lift = {}: rays to the outside of the smooth surface start at point + lift",
        row(lift)
    )?;
    let matrix = if from_object.is_some() { "M " } else { "" };
    writeln!(f, "{pad}  lift = {matrix}Σ w_k max(0, −(p − P_k)·n_k) n_k, p = Σ w_k P_k")?;
    let named = |letter: &str, k: usize, of: &[f32; 3]| format!("{letter}{k} = {}", row(of));
    let all = [("P", corners), ("n", normals)];
    for (letter, rows) in all {
        let rows: Vec<String> = rows.iter().enumerate().map(|(k, of)| named(letter, k, of)).collect();
        writeln!(f, "{pad}  {}", rows.join("   "))?;
    }
    writeln!(f, "{pad}  w = {}", row(weights))?;
    for (number, of) in from_object.iter().flatten().enumerate() {
        writeln!(f, "{pad}  M, row {} = {}", number + 1, exact(of))?;
    }
    Ok(())
}

/// Writes formulas with their operands; one formula with several rows of operands is written once.
pub(super) fn write_derivations(f: &mut String, derivations: &[Derivation], pad: &str) -> fmt::Result {
    let mut before = "";
    for Derivation { formula, numbers } in derivations {
        if formula != before {
            writeln!(f, "{pad}{formula}")?;
        }
        let numbers: Vec<String> =
            numbers.iter().map(|(name, of)| format!("{name} = {}", operand(of))).collect();
        writeln!(f, "{pad}  {}", numbers.join("   "))?;
        before = formula;
    }
    Ok(())
}

/// Numbers with enough digits to read them back: in single precision where all of them are.
fn operand(numbers: &[f64]) -> String {
    let is_single = numbers.iter().all(|x| f64::from(*x as f32) == *x);
    let digits = |x: &f64| match *x as f32 {
        _ if !is_single => full64(*x),
        single if single != 0.0 && !(1e-5..1e15).contains(&single.abs()) => format!("{single:e}"),
        single => format!("{single}"),
    };
    match numbers {
        [number] => digits(number),
        numbers => format!("({})", numbers.iter().map(digits).collect::<Vec<_>>().join(", ")),
    }
}

/// Writes the result of a shadow ray; `end` describes one that is unoccluded.
pub(super) fn write_shadow(
    f: &mut String,
    shadow: Option<&ShadowReport>,
    end: &str,
    pad: &str,
) -> fmt::Result {
    let Some(shadow) = shadow else {
        return writeln!(f, "{pad}    no shadow ray: its contribution would be 0");
    };
    writeln!(f, "{pad}    shadow ray: {}", work(&shadow.traversal, ""))?;
    write_departure(f, shadow.departure.as_ref(), &format!("{pad}    shadow ray: "))?;
    for blocker in &shadow.blockers {
        let (name, t, passed) = (&blocker.shape, full(blocker.t), &blocker.passed);
        match passed.iter().all(|lane| *lane == 0.0) {
            true => writeln!(f, "{pad}    shadow ray: blocked by {name} at t = {t}")?,
            false => {
                writeln!(
                    f,
                    "{pad}    shadow ray: through {name} at t = {t}, transmittance {}",
                    lanes(passed)
                )?;
            }
        }
    }
    write_null_collisions(f, &shadow.collisions, pad)?;
    match &shadow.rest {
        Some(rest) if rest.iter().any(|lane| *lane != 1.0) => {
            writeln!(f, "{pad}    shadow ray: {end}, after absorption on the rest of the way {}", lanes(rest))
        }
        Some(_) => writeln!(f, "{pad}    shadow ray: {end}"),
        None => Ok(()),
    }
}
