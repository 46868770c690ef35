//! Media in the text report: absorption, flights, and scattering by phase functions.

use std::fmt::{self, Write};

use super::hit::write_absorption;
use super::{RayReport, amount, full, lanes, vector, vector32};
use crate::inspect::report::{FlightReport, PhaseReport};

/// Media along a ray.
pub(super) fn write_medium(f: &mut String, ray: &RayReport) -> fmt::Result {
    write_absorption(f, ray, "  ")?;
    if let Some(added) = &ray.medium_emission {
        writeln!(f, "    the medium shines along the way")?;
        writeln!(f, "      + β σ_a L (1 − T) / σ_t = {}", amount(added))?;
    }
    ray.flight.as_ref().map_or(Ok(()), |flight| write_flight(f, flight))
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
    let PhaseReport { wi, pdf, survival, survives, next_throughput } = phase;
    writeln!(f, "    goes on by the phase function: wi = {}", vector32(wi))?;
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
