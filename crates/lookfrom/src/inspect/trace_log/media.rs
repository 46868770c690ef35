//! Events of media: flights, collisions, and directions by phase functions.

use glam::Vec3;

use super::TraceLogBuilder;
use super::rays::in_world;
use crate::inspect::report::{CollisionReport, FlightReport, NullReport, PhaseReport, TrackingReport};
use crate::integrator::{Flight, PhaseSample, Shadow};
use crate::medium::{Collision, Tracking};

impl TraceLogBuilder<'_> {
    /// The flight of a ray in a homogeneous medium, which may have scattered it before its hit.
    pub(super) fn flown(&mut self, address: u64, flight: &Flight, point: Option<Vec3>) {
        let report = FlightReport {
            extinction: self.factor(flight.extinction),
            scattering: self.factor(flight.scattering),
            choice: self.factor(flight.choice),
            lane: flight.lane,
            limit: flight.limit,
            distance: flight.distance,
            scattered_at: point.map(|point| in_world(self.world, point.to_array())),
            transmittance: self.factor(flight.transmittance),
            density: flight.density,
            throughput: self.factor(flight.after),
        };
        self.traveled(address, point);
        self.at(address, |ray| {
            ray.throughput_there = Some(report.throughput.clone());
            ray.flight = Some(report);
        });
    }

    /// The way of a ray in a medium that varies.
    pub(super) fn tracked(&mut self, address: u64, tracking: &Tracking, point: Option<Vec3>) {
        let report = TrackingReport {
            limit: tracking.limit,
            collisions: tracking.collisions.iter().map(|collision| self.collision(collision)).collect(),
            scattered_at: point.map(|point| in_world(self.world, point.to_array())),
            throughput: self.factor(tracking.after),
        };
        self.traveled(address, point);
        self.at(address, |ray| {
            ray.throughput_there = Some(report.throughput.clone());
            ray.tracking = Some(report);
        });
    }

    /// A ray that a medium scatters at a point meets nothing.
    fn traveled(&mut self, address: u64, scattered_at: Option<Vec3>) {
        let Some(point) = scattered_at else { return };
        self.in_media.insert(address, point);
        if let Some((_, surface)) = self.hits.get_mut(&address) {
            *surface = None;
        }
        self.at(address, |ray| ray.met = None);
    }

    fn collision(&self, collision: &Collision) -> CollisionReport {
        let Collision { t, majorant, coefficients, probability, is_real, emitted, beta } = *collision;
        CollisionReport {
            t,
            majorant,
            absorption: self.factor(coefficients.absorption),
            scattering: self.factor(coefficients.scattering),
            emitted: self.factor(emitted),
            probability,
            is_real,
            throughput: self.factor(beta),
        }
    }

    /// The collisions of a shadow ray with a medium that varies, as far as its hit.
    pub(super) fn null_collisions(&self, shadow: &Shadow, t: f32) -> Vec<NullReport> {
        let Some(medium) = self.world.medium(shadow.interior) else { return Vec::new() };
        let way = shadow.way(self.world, t);
        let of_mode = (&*self.world.textures, &self.mode);
        let Some(tracking) = medium.estimated_transmittance(&way, of_mode, true) else { return Vec::new() };
        let report = |&Collision { t, majorant, coefficients, beta, .. }: &Collision| NullReport {
            t,
            majorant,
            extinction: self.factor(coefficients.extinction()),
            transmittance: self.factor(beta),
        };
        tracking.collisions.iter().map(report).collect()
    }

    /// The direction in which a medium scatters a ray.
    pub(super) fn phase(&mut self, address: u64, sample: &PhaseSample) {
        let PhaseSample { wi, pdf, survival, survives, .. } = *sample;
        let report = PhaseReport { wi: wi.to_array(), pdf, survival, survives, next_throughput: None };
        self.at(address, |ray| ray.phase = Some(report));
    }
}
