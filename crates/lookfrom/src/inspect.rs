//! The inspector: every matrix, determinant, root, ray and density of one sample.
//!
//! It is the renderer itself with a probe: [`inspect`] traces the one sample as a tile would, and arranges the recorded
//! events ([`Renderer::trace_events`]). The contributions that it shows add up, bit for bit, to what the film received.
//! Points are shown in the world (not in render space).

mod camera;
mod candidate;
mod expression;
mod pixel;
mod report;
mod scatter;
mod svg;
mod text;
mod trace_log;

use lookfrom_bvh::Hit;

use crate::integrator::{Event, Path};
use crate::render::{Renderer, SampleId};
use crate::shading::texture::SpectralMode;

use trace_log::TraceLogBuilder;

pub use candidate::{Candidate, Number, Test};
pub use expression::Contribution;
pub use pixel::{PixelInspection, SampleSummary, inspect_pixel};
pub use report::{
    Addition, Amount, Blocker, BranchReport, CameraSteps, CoefficientsReport, Factor, Inspection,
    LightReport, MatrixStep, MetReport, RayReport, ShadowReport, WavelengthsReport,
};
pub use scatter::{BounceReport, FoundReport, LightSampleReport, SampledDirectionReport, ScatteringReport};
pub use svg::svg;

/// Traces one sample and reports all steps of its computation.
pub fn inspect(renderer: &Renderer, id: SampleId) -> Inspection {
    let candidates = |path: &Path, hit: &Hit| candidate::candidates(renderer.world(), &path.ray, hit);
    trace(renderer, id, candidates)
}

/// The same without the tests of primitives, which take most of the time.
fn inspect_without_tests(renderer: &Renderer, id: SampleId) -> Inspection {
    trace(renderer, id, |_, _| Vec::new())
}

fn trace(
    renderer: &Renderer,
    id: SampleId,
    candidates: impl Fn(&Path, &Hit) -> Vec<Candidate>,
) -> Inspection {
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
    for event in &events {
        let tests = match event {
            Event::Hit { path, hit } => candidates(path, hit),
            _ => Vec::new(),
        };
        log.record(event, tests);
    }
    let told = log.end();
    let film = renderer.rgb(told.sum * traced.weight, &traced.lanes);
    let mut inspection = Inspection {
        pixel: id.pixel,
        sample: id.sample,
        integrator: renderer.integrator(),
        color8: [0; 3],
        contributions: Vec::new(),
        wavelengths,
        camera: camera::camera_steps(renderer, id),
        rays: told.rays,
        radiance: told.radiance,
        additions: told.additions,
        weight: traced.weight,
        alpha: traced.alpha,
        film: traced.rgb,
        adds_up: film.map(f32::to_bits) == traced.rgb.map(f32::to_bits),
    };
    inspection.color8 = pixel::color8(&renderer.view().image, &inspection);
    inspection.contributions = expression::largest(&inspection);
    inspection
}
