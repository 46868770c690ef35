//! The inspector: every matrix, determinant, root, ray and density of one sample.
//!
//! It is the renderer itself with a probe: [`inspect`] traces the one sample as a tile would, and arranges the recorded
//! events ([`Renderer::trace_events`]). The contributions that it shows add up, bit for bit, to what the film received.
//! Points are shown in the world (not in render space).

mod camera;
mod candidate;
mod expression;
mod lens_system;
mod lights;
mod microfacets;
mod pixel;
mod report;
mod scatter;
mod segments;
mod svg;
mod text;
mod trace_log;

use lookfrom_scene::settings::ImageSettings;
use lookfrom_scene::spectrum::CameraSensor;

use crate::core::spectrum::Spectrum;

use crate::integrator::Event;
use crate::render::{Renderer, SampleId};
use crate::shading::texture::SpectralMode;

use trace_log::TraceLogBuilder;

pub use candidate::{Candidate, Number, Test, TestNumbers, TraversalReport};
pub use expression::Contribution;
pub(crate) use expression::light_seen_by_bounces;
pub use lights::{LightPlace, lights};
pub use microfacets::{MicrofacetReport, MultipleScatteringReport};
pub use pixel::{PixelInspection, SampleSummary, inspect_pixel};
pub use report::{
    AbsorptionReport, Addition, Amount, Blocker, BranchReport, CameraSteps, CoefficientsReport,
    CollisionReport, Departure, DevelopmentReport, ExitReport, Factor, FlightReport, FootprintReport,
    Inspection, LensSurfaceReport, LensSystemReport, LiftReport, LightReport, MatrixStep, MetReport,
    NullReport, PhaseLobeReport, PhaseReport, ProbeReport, ProbeSegmentReport, ProfileReport, RayReport,
    SensorReport, ShadowReport, SphereMapping, TrackingReport, WavelengthsReport,
};
pub use scatter::{
    BounceReport, FoundReport, FoundSampling, LightSampleReport, SampledDirectionReport, ScatteringReport,
};
pub use segments::{RayKind, RaySegment};
pub use svg::{SvgView, svg};
pub use text::{Excerpt, Selection, TextPart};

pub use crate::light::derivation::Derivation;

/// Traces one sample and reports all steps of its computation.
pub fn inspect(renderer: &Renderer, id: SampleId) -> Inspection {
    let mut inspection = trace(renderer, id, true);
    inspection.segments = segments::segments(&inspection);
    inspection
}

/// An inspection without segments to draw, the tests of primitives, and the formulas of lights, which take most of the time.
fn inspect_in_short(renderer: &Renderer, id: SampleId) -> Inspection {
    trace(renderer, id, false)
}

fn trace(renderer: &Renderer, id: SampleId, is_whole: bool) -> Inspection {
    let mut events: Vec<Event> = Vec::new();
    let (traced, _) = renderer.trace_events(&[id], &mut events);
    let traced = traced[0];
    let wavelengths = match traced.mode {
        SpectralMode::Rgb => None,
        SpectralMode::Spectral(wavelengths) => Some(WavelengthsReport {
            lambda: wavelengths.lambda,
            pdf: wavelengths.pdf,
            dispersed: wavelengths.secondary_terminated(),
        }),
    };

    let mut log = TraceLogBuilder::new(renderer, (traced.mode, renderer.time(id)), is_whole);
    events.iter().for_each(|event| log.record(event));
    let told = log.end();
    let film = renderer.rgb(told.sum * traced.weight, &traced.mode);
    let mut inspection = Inspection {
        pixel: id.pixel,
        sample: id.sample,
        integrator: renderer.integrator(),
        color8: [0; 3],
        contributions: Vec::new(),
        time: renderer.moves().then(|| renderer.time(id)),
        wavelengths,
        camera: camera::camera_steps(renderer, id),
        render_origin: renderer.world().origin().to_array(),
        rays: told.rays,
        segments: Vec::new(),
        radiance: told.radiance,
        additions: told.additions,
        weight: traced.weight,
        filter_weight: traced.filter_weight,
        sensor: sensor(renderer, told.sum * traced.weight, &traced.mode),
        development: development(&renderer.view().image),
        alpha: traced.alpha,
        film: traced.rgb,
        adds_up: film.map(f32::to_bits) == traced.rgb.map(f32::to_bits),
    };
    inspection.color8 = pixel::color8(&renderer.view().image, &inspection);
    inspection.contributions = expression::largest(&inspection);
    inspection
}

fn sensor(renderer: &Renderer, light: Spectrum, mode: &SpectralMode) -> SensorReport {
    let settings = &renderer.view().image.sensor;
    // The one factor of all channels, by the brightest.
    let brightest = |rgb: [f32; 3]| rgb.into_iter().max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0);
    let [measured, limited] = [renderer.measured(light, mode), renderer.rgb(light, mode)].map(brightest);
    let changes =
        settings.camera.is_some() || settings.imaging_ratio != 1.0 || settings.white_balance.is_some();
    SensorReport {
        camera: settings.camera.map(CameraSensor::name),
        imaging_ratio: settings.imaging_ratio,
        white_balance: settings.white_balance,
        matrix: (changes && matches!(mode, SpectralMode::Rgb)).then(|| *renderer.sensor().balanced_matrix()),
        max_component: settings.max_component,
        scaled_by: if measured == limited { 1.0 } else { limited / measured },
    }
}

fn development(image: &ImageSettings) -> DevelopmentReport {
    DevelopmentReport { exposure: image.exposure, tonemap: image.tonemap.word(), denoise: image.denoise }
}
