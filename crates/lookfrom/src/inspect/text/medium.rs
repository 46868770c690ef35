//! Media in the text report: absorption, flights, collisions, and scattering by phase functions.

use std::fmt::{self, Write};

use lookfrom_scene::plural::counted;

use super::hit::write_absorption;
use super::{RayReport, amount, full, lanes, vector, vector32};
use crate::inspect::report::{
    CollisionReport, FlightReport, NullReport, PhaseLobeReport, PhaseReport, TrackingReport,
};

/// Media along a ray.
pub(super) fn write_medium(f: &mut String, ray: &RayReport) -> fmt::Result {
    write_absorption(f, ray, "  ")?;
    if let Some(added) = &ray.medium_emission {
        writeln!(f, "    the medium shines along the way")?;
        writeln!(f, "      + β σ_a L (1 − T) / σ_t = {}", amount(added))?;
    }
    if let Some(flight) = &ray.flight {
        write_flight(f, flight)?;
    }
    let before = ray.absorption.as_ref().map_or(&ray.throughput, |absorption| &absorption.throughput);
    ray.tracking.as_ref().map_or(Ok(()), |tracking| write_tracking(f, tracking, before))
}

/// Collisions that are written; the others are in JSON.
const MOST_COLLISIONS: usize = 24;

/// The words for the effect of Russian roulette on a null collision's estimate, by the estimate without it.
fn by_roulette(estimate: &[f32], without: impl Fn(usize) -> f32) -> &'static str {
    let most = |lanes: &mut dyn Iterator<Item = f32>| lanes.fold(0.0, f32::max);
    let (found, without) = (most(&mut estimate.iter().copied()), most(&mut (0..estimate.len()).map(without)));
    match (found > 2.0 * without, found == 0.0 && without > 0.0) {
        (true, _) => ", four times as much by Russian roulette",
        (_, true) => ", ended by Russian roulette",
        _ => "",
    }
}

fn write_tracking<'a>(f: &mut String, tracking: &'a TrackingReport, mut before: &'a [f32]) -> fmt::Result {
    let (count, limit) = (tracking.collisions.len(), full(tracking.limit));
    writeln!(
        f,
        "    collides {} with a medium that varies, before what is at {limit}",
        counted(count, "time")
    )?;
    for collision in tracking.collisions.iter().take(MOST_COLLISIONS) {
        let CollisionReport { t, majorant, absorption, scattering, .. } = collision;
        let kept = 1.0 - collision.probability;
        let roulette = by_roulette(&collision.throughput, |lane| {
            before[lane] * (majorant - absorption[lane] - scattering[lane]) / (majorant * kept)
        });
        before = &collision.throughput;
        let (t, majorant, probability) = (full(*t), full(*majorant), full(collision.probability));
        writeln!(
            f,
            "      at t = {t}: majorant m = {majorant}   σ_a = {}   σ_s = {}",
            lanes(absorption),
            lanes(scattering)
        )?;
        if collision.emitted.iter().any(|lane| *lane != 0.0) {
            writeln!(f, "        + β σ_a L / m = {}", lanes(&collision.emitted))?;
        }
        let throughput = lanes(&collision.throughput);
        match collision.is_real {
            true => writeln!(
                f,
                "        real, with q = Σ P σ_t / m = {probability}: β σ_s / (m q) = {throughput}"
            )?,
            false => writeln!(
                f,
                "        null, with q = Σ P σ_t / m = {probability}: β (m − σ_t) / (m (1 − q)) = {throughput}{roulette}"
            )?,
        }
    }
    if count > MOST_COLLISIONS {
        writeln!(f, "      and {} more", count - MOST_COLLISIONS)?;
    }
    if let Some(point) = &tracking.scattered_at {
        writeln!(f, "      is scattered there: p = {}", vector(point))?;
    }
    Ok(())
}

/// The null collisions of a shadow ray.
pub(super) fn write_null_collisions(f: &mut String, collisions: &[NullReport], pad: &str) -> fmt::Result {
    for (index, collision) in collisions.iter().enumerate().take(MOST_COLLISIONS) {
        let NullReport { t, majorant, extinction, transmittance } = collision;
        // The estimate of each part of the way starts from 1.
        let before = collisions[..index].last().filter(|before| before.t <= *t);
        let roulette = by_roulette(transmittance, |lane| {
            before.map_or(1.0, |before| before.transmittance[lane]) * (majorant - extinction[lane]) / majorant
        });
        let (t, majorant) = (full(*t), full(*majorant));
        writeln!(
            f,
            "{pad}    shadow ray: collides at t = {t}: m = {majorant}   σ_t = {}   Π (m − σ_t) / m = {}{roulette}",
            lanes(extinction),
            lanes(transmittance)
        )?;
    }
    match collisions.len().saturating_sub(MOST_COLLISIONS) {
        0 => Ok(()),
        more => writeln!(f, "{pad}    shadow ray: and {more} more collisions"),
    }
}

fn write_flight(f: &mut String, flight: &FlightReport) -> fmt::Result {
    let FlightReport { extinction, scattering, choice, lane, limit, distance, .. } = flight;
    writeln!(f, "    flies in a medium: σ_t = {}   σ_s = {}", lanes(extinction), lanes(scattering))?;
    writeln!(f, "      by the extinction of lane {lane}, chosen with P = β / Σ β = {}", lanes(choice))?;
    let (distance, limit) = (full(*distance), full(*limit));
    let (transmittance, density) = (lanes(&flight.transmittance), full(flight.density));
    let throughput = lanes(&flight.throughput);
    match &flight.scattered_at {
        Some(point) => {
            writeln!(
                f,
                "      distance = −ln(1 − u) / σ_t = {distance}, before what is at {limit}: p = {}",
                vector(point)
            )?;
            writeln!(f, "      T = exp(−σ_t · distance) = {transmittance}   q = Σ P σ_t T = {density}")?;
            writeln!(f, "      β σ_s T / q = {throughput}")
        }
        None => {
            writeln!(f, "      distance = −ln(1 − u) / σ_t = {distance}, not before what is at {limit}")?;
            writeln!(f, "      T = exp(−σ_t · {limit}) = {transmittance}   Q = Σ P T = {density}")?;
            writeln!(f, "      β T / Q = {throughput}")
        }
    }
}

/// The direction in which a medium scatters a path.
pub(super) fn write_phase(f: &mut String, phase: &PhaseReport) -> fmt::Result {
    let PhaseReport { wi, cos, pdf, lobes, survival, survives, next_throughput } = phase;
    writeln!(f, "    goes on by the phase function: wi = {}   cos θ = {}", vector32(wi), full(*cos))?;
    // One lobe is the whole phase function.
    for lobe in lobes.iter().filter(|_| lobes.len() > 1) {
        let PhaseLobeReport { name, weight, g, alpha, value, is_sampled } = lobe;
        let [weight, g, alpha, value] = [weight, g, alpha, value].map(|number| full(*number));
        let sampled = if *is_sampled { ", which has sampled it" } else { "" };
        writeln!(f, "      lobe of {name}: {weight} · {value}, by g = {g}, α = {alpha}{sampled}")?;
    }
    writeln!(f, "      pdf = {}, which is the phase function itself: β stays", full(*pdf))?;
    if *survival >= 1.0 {
        return Ok(());
    }
    let survival = full(*survival);
    write!(f, "      Russian roulette: survives with probability {survival}: ")?;
    match (survives, next_throughput) {
        (true, Some(next)) => writeln!(f, "it does,\n      and β / {survival} = {}", lanes(next)),
        (true, None) => writeln!(f, "it does"),
        (false, _) => writeln!(f, "it does not"),
    }
}
