//! Probing: the other point of a BSSRDF, where a random line near the first one meets the surface.
//!
//! The line is along one axis of the shading frame, at a distance that the profile of one lane samples. The density of a point is that of
//! all axes and lanes together, as in one-sample multiple importance sampling (King et al. 2013, BSSRDF Importance Sampling; the axes'
//! probabilities are pbrt-v4's). Lanes are chosen by the light that is to leave: then the sum of the lanes is hardly noisier than one.

use glam::{DVec3, Vec3};

use super::MediumBelow;
use super::table::{Profile, ProfileTable};
use crate::core::elementary::sin_cos_of_turns;
use crate::core::math::chosen;
use crate::core::spectrum::Spectrum;

/// Probabilities of the axes: the tangents and the normal.
const AXES: [f32; 3] = [0.25, 0.25, 0.5];

/// A point of a surface, whose surroundings are to be probed.
pub(crate) struct Prober<'a> {
    /// In render space.
    origin: DVec3,
    /// The axes of the shading frame.
    axes: [Vec3; 3],
    profiles: [Profile<'a>; 4],
    /// The probability of each lane.
    pub(crate) choice: Spectrum,
}

/// A line that may meet the surface.
#[derive(Clone, Copy, Debug)]
pub struct ProbeSegment {
    /// Its axis: 0 and 1 are tangents, 2 is the normal.
    pub axis: u32,
    /// The lane whose profile sampled its distance.
    pub lane: u32,
    /// That distance.
    pub radius: f32,
    /// In render space.
    pub start: Vec3,
    /// The direction, of unit length.
    pub direction: Vec3,
    /// As far as the sphere within which points are looked for.
    pub length: f32,
}

impl<'a> Prober<'a> {
    /// At a point with its shading frame, for a throughput. `None` where no light would leave.
    pub(crate) fn new(
        table: &'a ProfileTable,
        medium: &MediumBelow,
        (origin, axes): (DVec3, [Vec3; 3]),
        beta: Spectrum,
    ) -> Option<Self> {
        let profiles = medium.profiles(table);
        let leaves = beta * Spectrum([0, 1, 2, 3].map(|lane| profiles[lane].effective_albedo));
        let sum: f32 = leaves.0.iter().sum();
        (sum > 0.0 && sum.is_finite()).then(|| Self { origin, axes, profiles, choice: leaves / sum })
    }

    /// A line by four numbers in [0, 1): for axis and lane, radius and angle. `None` where it is outside of the sphere.
    pub(crate) fn segment(
        &self,
        [which_axis, which_lane]: [f32; 2],
        [u, v]: [f32; 2],
    ) -> Option<ProbeSegment> {
        let (axis, lane) = (chosen(&AXES, which_axis), chosen(&self.choice.0, which_lane));
        let profile = &self.profiles[lane];
        let (radius, reach) = (profile.sample(u), profile.reach());
        let half = ((reach - radius) * (reach + radius)).sqrt();
        if !(half > 0.0 && half.is_finite()) {
            return None;
        }
        let [s, t, direction] = [1, 2, 0].map(|k| self.axes[(axis + k) % 3]);
        let (sin, cos) = sin_cos_of_turns(v);
        let center = self.origin + (radius * (s * cos + t * sin)).as_dvec3();
        let start = (center - (half * direction).as_dvec3()).as_vec3();
        Some(ProbeSegment {
            axis: axis as u32,
            lane: lane as u32,
            radius,
            start,
            direction,
            length: 2.0 * half,
        })
    }

    /// S_p: the part of the light that has entered which leaves at a point, per area.
    pub(crate) fn sp(&self, point: DVec3) -> Spectrum {
        let distance = (point - self.origin).as_vec3().length();
        Spectrum(std::array::from_fn(|lane| self.profiles[lane].value(distance)))
    }

    /// The density, per area, of a point of a surface with a geometric normal, where each line meets the surface once.
    pub(crate) fn pdf(&self, point: DVec3, n: Vec3) -> f32 {
        let way = (point - self.origin).as_vec3();
        let of_axis = |axis: usize| {
            let along = self.axes[axis];
            let distance = (way - way.dot(along) * along).length();
            let of_lanes = (0..4).map(|lane| match self.choice.0[lane] {
                0.0 => 0.0,
                probability => probability * self.profiles[lane].pdf(distance),
            });
            AXES[axis] * n.dot(along).abs() * of_lanes.sum::<f32>()
        };
        (0..3).map(of_axis).sum()
    }
}
