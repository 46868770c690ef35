//! The search for the point where light leaves a medium below a surface, as plain data.

use serde::Serialize;

use super::Factor;

/// Subsurface scattering: the path has entered a medium in which light diffuses, and leaves it where a random line meets the same
/// material. The next ray of the report is that line.
#[derive(Clone, Debug, Serialize)]
pub struct ProbeReport {
    /// β of the path that has entered.
    pub throughput_before: Factor,
    /// P: the probability of each lane, by its part of the light that leaves.
    pub choice: Factor,
    /// The line; `None` where it would be outside of the sphere in which points are looked for.
    pub segment: Option<ProbeSegmentReport>,
    /// Number of its intersections with the material.
    pub count: u32,
    /// One of these points, chosen by the light that leaves there; `None` where the path ends.
    pub exit: Option<ExitReport>,
}

/// A line that is searched.
#[derive(Clone, Debug, Serialize)]
pub struct ProbeSegmentReport {
    /// The axis of the shading frame along which it is: `first tangent`, `second tangent` or `normal`.
    pub axis: &'static str,
    /// The index of the lane whose profile sampled its distance.
    pub lane: u32,
    /// Its distance from the point where the path has entered.
    pub radius: f32,
    /// Its start, in the world.
    pub from: [f64; 3],
    /// Its direction, unit length.
    pub direction: [f32; 3],
    /// Its length.
    pub length: f32,
}

/// A point where light leaves.
#[derive(Clone, Debug, Serialize)]
pub struct ExitReport {
    /// The point, in the world.
    pub point: [f64; 3],
    /// S_p: the part of the light that has entered which leaves there, per area.
    pub sp: Factor,
    /// q: the density of the point, per area, over all axes and lanes, without the choice among several points.
    pub pdf: f32,
    /// Q: the probability of its choice among the points where the line meets the material.
    pub probability: f32,
    /// The throughput there: `β S_p / (q Q)`.
    pub throughput: Factor,
}
