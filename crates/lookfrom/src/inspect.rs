//! The inspector: every matrix, determinant, root, ray and density of one sample.
//!
//! It is the renderer itself with a probe: [`inspect`] traces the one sample as a tile would, and arranges the recorded
//! events ([`Renderer::trace_events`]). The contributions that it shows add up, bit for bit, to what the film received.
//! Points are shown in the world (not in render space).

mod camera;
mod candidate;
mod report;
mod scatter;
mod svg;
mod text;
mod trace_log;

use crate::integrator::Event;
use crate::render::{Renderer, SampleId};
use crate::shading::texture::SpectralMode;

use trace_log::TraceLogBuilder;

pub use candidate::{Candidate, Number, Test};
pub use report::{
    Addition, Amount, Blocker, BranchReport, CameraSteps, CoefficientsReport, Factor, Inspection,
    LightReport, MatrixStep, MetReport, RayReport, ShadowReport, WavelengthsReport,
};
pub use scatter::{BounceReport, FoundReport, LightSampleReport, SampledDirectionReport, ScatteringReport};
pub use svg::svg;

/// Traces one sample and reports all steps of its computation.
pub fn inspect(renderer: &Renderer, id: SampleId) -> Inspection {
    let mut events: Vec<Event> = Vec::new();
    let (traced, _) = renderer.trace_events(&[id], &mut events);
    let traced = traced[0];
    let wavelengths = match traced.lanes {
        SpectralMode::Rgb => None,
        SpectralMode::Spectral(wavelengths) => Some(WavelengthsReport {
            lambda: wavelengths.lambda,
            pdf: wavelengths.pdf,
            dispersed: wavelengths.secondary_terminated(),
        }),
    };

    let mut log = TraceLogBuilder::new(renderer, traced.lanes);
    events.iter().for_each(|event| log.record(event));
    let told = log.end();
    let film = renderer.rgb(told.sum * traced.weight, &traced.lanes);
    Inspection {
        pixel: id.pixel,
        sample: id.sample,
        integrator: renderer.integrator(),
        wavelengths,
        camera: camera::camera_steps(renderer, id),
        rays: told.rays,
        radiance: told.radiance,
        additions: told.additions,
        weight: traced.weight,
        film: traced.rgb,
        adds_up: film.map(f32::to_bits) == traced.rgb.map(f32::to_bits),
    }
}
