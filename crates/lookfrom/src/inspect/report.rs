//! The report of an inspection as plain data, which is also serialised to JSON.

mod camera;
mod light;
mod medium;
mod probe;
mod ray;

use serde::Serialize;

use super::expression::Contribution;
use super::segments::RaySegment;

pub use camera::{CameraSteps, LensSurfaceReport, LensSystemReport, MatrixStep, SphereMapping};
pub use light::{Blocker, BranchReport, LightReport, ShadowReport};
pub use medium::{
    CollisionReport, FlightReport, NullReport, PhaseLobeReport, PhaseReport, ProfileReport, TrackingReport,
};
pub use probe::{ExitReport, ProbeReport, ProbeSegmentReport};
pub use ray::{
    AbsorptionReport, CoefficientsReport, Departure, FootprintReport, LiftReport, MetReport, RayReport,
};

/// A factor of light, per lane: red, green and blue, or one for each of four wavelengths.
pub type Factor = Vec<f32>;

/// An amount of light.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Amount {
    /// Per lane: the numbers that the renderer adds.
    pub lanes: Vec<f32>,
    /// Its colour as the camera's sensor measures it, linear Rec. 709; `max_component` limits only the whole sample.
    pub rgb: [f32; 3],
}

/// All steps in the computation of one sample.
#[derive(Clone, Debug, Serialize)]
pub struct Inspection {
    /// Column and row from the top left.
    pub pixel: [u32; 2],
    /// Number of the sample in its pixel.
    pub sample: u32,
    /// The integrator, as `--integrator` names it.
    pub integrator: &'static str,
    /// The colour of this sample alone as in an 8-bit picture: exposure, tone map, sRGB.
    pub color8: [u8; 3],
    /// The largest contributions, largest first.
    pub contributions: Vec<Contribution>,
    /// The time while the shutter is open, from 0 to 1, of what moves; `None` where nothing does.
    pub time: Option<f32>,
    /// The wavelengths of the four lanes; `None` where light is red, green and blue.
    pub wavelengths: Option<WavelengthsReport>,
    /// The steps from the pixel to the world.
    pub camera: CameraSteps,
    /// The origin of render space in the world, where the camera's eye was when the scene was compiled: rays are traced
    /// in f32 relative to it.
    pub render_origin: [f64; 3],
    /// All rays, parents before children, by address.
    pub rays: Vec<RayReport>,
    /// The rays and shadow rays as lines of a drawing, each ray before its shadow rays.
    pub segments: Vec<RaySegment>,
    /// The sum over all rays, added in the order of `additions`.
    pub radiance: Amount,
    /// Every addition to the sample, in the order in which they were made.
    pub additions: Vec<Addition>,
    /// The filter's weight, times that of a ray through a lens system.
    pub weight: f32,
    /// The filter's weight alone.
    #[serde(skip)]
    pub(crate) filter_weight: f32,
    /// What the sensor does to it.
    pub sensor: SensorReport,
    /// How a picture is developed from the film.
    pub development: DevelopmentReport,
    /// Alpha, before the filter's weight.
    pub alpha: f32,
    /// The value that the film received: `radiance · weight`, as the camera's sensor measures it.
    pub film: [f32; 3],
    /// Whether the sum of the additions equals, bit for bit, the value that the film received.
    pub adds_up: bool,
}

/// The four wavelengths of a sample.
#[derive(Clone, Debug, Serialize)]
pub struct WavelengthsReport {
    /// Wavelengths in nm.
    pub lambda: [f32; 4],
    /// Their densities, per nm; 0 for those that were terminated.
    pub pdf: [f32; 4],
    /// Whether dispersion terminated all but the first.
    pub dispersed: bool,
}

/// What the camera's sensor does to the light of a sample.
#[derive(Clone, Debug, Serialize)]
pub struct SensorReport {
    /// The camera whose responses are used; `None` for the standard observer.
    pub camera: Option<&'static str>,
    /// Multiplies all light.
    pub imaging_ratio: f32,
    /// The colour temperature, in kelvin, of light that appears white.
    pub white_balance: Option<f32>,
    /// The matrix, by rows, that a colour of RGB mode is multiplied by: the responses, the imaging ratio and the white balance
    /// together; `None` where it changes nothing, and in spectral mode.
    pub matrix: Option<[[f32; 3]; 3]>,
    /// The maximum of a sample's channels; infinite for no limit.
    pub max_component: f32,
    /// The factor by which this sample was scaled down to it; 1 for no change.
    pub scaled_by: f32,
}

/// How a picture is developed from the film.
#[derive(Clone, Debug, Serialize)]
pub struct DevelopmentReport {
    /// In stops.
    pub exposure: f32,
    /// The tone map, as `--tonemap` names it.
    pub tonemap: &'static str,
    /// Whether the picture is denoised, which `color8` is not.
    pub denoise: bool,
}

/// One addition to the sample.
#[derive(Clone, Debug, Serialize)]
pub struct Addition {
    /// The ray whose hit made it.
    pub address: u64,
    /// The reason: `sky`, `emission`, `medium` (its emission), `ambient`, `view`, `open sky`, or the light's name (`found` or `sampled` along a
    /// path).
    pub term: String,
    /// The light that was added.
    pub value: Amount,
}

impl Inspection {
    /// A ray by its address.
    pub fn ray(&self, address: u64) -> Option<&RayReport> {
        let index = self.rays.binary_search_by_key(&address, |ray| ray.address).ok()?;
        self.rays.get(index)
    }

    /// Whether the rays are a path, not a tree.
    pub fn is_path(&self) -> bool {
        matches!(self.integrator, "path" | "simple_path" | "random_walk" | "ambient_occlusion")
    }
}
