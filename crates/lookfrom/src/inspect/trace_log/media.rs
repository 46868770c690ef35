//! Events of media: flights, collisions, and directions by phase functions.

use glam::Vec3;

use super::TraceLogBuilder;
use super::rays::in_world;
use crate::core::spectrum::Spectrum;
use crate::inspect::report::{
    CollisionReport, FlightReport, NullReport, PhaseLobeReport, PhaseReport, ProfileReport, TrackingReport,
};
use crate::integrator::{Flight, PhaseSample, Shadow};
use crate::medium::{Collision, Profile, Tracking};
use crate::shading::bsdf::phase::PhaseLobe;

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
            profile: tracking.profile.as_deref().map(|profile| self.profile(profile)),
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

    fn profile(&self, profile: &Profile) -> ProfileReport {
        let Profile { start, end, extinction, majorant } = profile;
        let mean = |of: &Spectrum| {
            let lanes = self.factor(*of);
            lanes.iter().sum::<f32>() / lanes.len() as f32
        };
        ProfileReport {
            start: *start,
            end: *end,
            extinction: extinction.iter().map(mean).collect(),
            majorant: majorant.clone(),
        }
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
        let PhaseSample { phase, is_draine, wi, pdf, survival, survives, .. } = *sample;
        self.at(address, |ray| {
            let ahead = Vec3::from_array(ray.direction).normalize();
            let lobe = |lobe: PhaseLobe, is_sampled| {
                let PhaseLobe { name, weight, g, alpha, value } = lobe;
                PhaseLobeReport { name, weight, g, alpha, value, is_sampled }
            };
            let (first, second) = phase.lobes((-ahead).into(), wi.into());
            let lobes = std::iter::once(lobe(first, !is_draine)).chain(second.map(|of| lobe(of, is_draine)));
            ray.phase = Some(PhaseReport {
                wi: wi.to_array(),
                cos: ahead.dot(wi),
                pdf,
                lobes: lobes.collect(),
                survival,
                survives,
                next_throughput: None,
            });
        });
    }
}
