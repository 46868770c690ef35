//! Subsurface scattering in the text report: the search for the point where light leaves.

use std::fmt::{self, Write};

use lookfrom_scene::plural::counted;

use super::{full, lanes, vector, vector32};
use crate::inspect::report::ProbeReport;

/// The search, and the throughput at the point that was found.
pub(super) fn write_probe(f: &mut String, probe: &ProbeReport) -> fmt::Result {
    let ProbeReport { choice, segment, count, exit, .. } = probe;
    writeln!(f, "    diffuses below the surface; where does it leave?")?;
    let Some(segment) = segment else {
        return writeln!(f, "      farther away than points are looked for");
    };
    let (lane, radius) = (segment.lane, full(segment.radius));
    writeln!(f, "      r = {radius} by the profile of lane {lane}, chosen with P = {}", lanes(choice))?;
    writeln!(
        f,
        "      along the {}: {} from {} along {}, which meets the material {}",
        segment.axis,
        full(segment.length),
        vector(&segment.from),
        vector32(&segment.direction),
        counted(*count, "time"),
    )?;
    let Some(exit) = exit else { return Ok(()) };
    writeln!(f, "      leaves at p = {}", vector(&exit.point))?;
    writeln!(
        f,
        "      S_p = {}   q = {}: density of p over all axes and lanes",
        lanes(&exit.sp),
        full(exit.pdf)
    )?;
    let probability = full(exit.probability);
    writeln!(
        f,
        "      β S_p / (q Q) = {}, with Q = {probability}: by the light that leaves at each",
        lanes(&exit.throughput)
    )
}
