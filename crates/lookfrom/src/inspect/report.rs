//! The report of an inspection as plain data, which is also its JSON.

use serde::Serialize;

use super::candidate::Candidate;
use super::scatter::{AskedReport, BounceReport, FoundReport, ScatteringReport};

/// A factor that light is multiplied by, lane by lane: red, green and blue, or one for each of four wavelengths.
pub type Factor = Vec<f32>;

/// An amount of light.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Amount {
    /// Lane by lane: these numbers are what the renderer adds.
    pub lanes: Vec<f32>,
    /// The colour that the camera's sensor makes of it, linear Rec. 709.
    pub rgb: [f32; 3],
}

/// Everything that happened on the way of one sample.
#[derive(Clone, Debug, Serialize)]
pub struct Inspection {
    /// Column and row from the top left.
    pub pixel: [u32; 2],
    /// Number of the sample in its pixel.
    pub sample: u32,
    /// How light was computed, as `--integrator` names it.
    pub integrator: &'static str,
    /// What the four lanes are; `None` where light is red, green and blue.
    pub wavelengths: Option<WavelengthsReport>,
    /// From the pixel to the world.
    pub camera: CameraSteps,
    /// All rays, parents before children, by address.
    pub rays: Vec<RayReport>,
    /// The sum over all rays, added in the order of `additions`.
    pub radiance: Amount,
    /// Every addition to the sample, in the order in which they were made.
    pub additions: Vec<Addition>,
    /// The filter's weight.
    pub weight: f32,
    /// What the film received: `radiance · weight`, as the camera's sensor sees it.
    pub film: [f32; 3],
    /// Whether the additions shown give, bit for bit, what the film received.
    pub adds_up: bool,
}

/// The four wavelengths that a sample follows.
#[derive(Clone, Debug, Serialize)]
pub struct WavelengthsReport {
    /// In nm.
    pub lambda: [f32; 4],
    /// With which density each counts, per nm; 0 for those that no longer do.
    pub pdf: [f32; 4],
    /// Whether dispersion left only the first.
    pub dispersed: bool,
}

/// `P_world = T4 · R3 · S2 · T1 · P_k`, each factor and each product. Matrices are rows of columns.
#[derive(Clone, Debug, Serialize)]
pub struct CameraSteps {
    /// The eye.
    pub lookfrom: [f64; 3],
    /// To the viewer's left.
    pub u: [f64; 3],
    /// Up.
    pub v: [f64; 3],
    /// Forward.
    pub w: [f64; 3],
    /// The point of the image, `(x_k, y_k, 0, 1)`, `y_k` up.
    pub p_k: [f64; 4],
    /// Each matrix by name, the product of it with those before, and the point after it.
    pub steps: Vec<MatrixStep>,
    /// `P_world`: the point of the image plane in the world.
    pub p_world: [f64; 3],
    /// `a`: where the ray starts.
    pub a: [f64; 3],
    /// `b`: where it crosses the image plane; `P_world`, unless a lens moved `a` away.
    pub b: [f64; 3],
    /// `b − a`: its direction, not of unit length; `t = 1` is the image plane.
    pub direction: [f64; 3],
    /// Whether a lens moved `a` away from `lookfrom`.
    pub lens: bool,
}

/// One factor of the camera's product.
#[derive(Clone, Debug, Serialize)]
pub struct MatrixStep {
    /// `T1`, `S2`, `R3` or `T4`.
    pub name: &'static str,
    /// What it does.
    pub does: &'static str,
    /// The factor.
    pub matrix: [[f64; 4]; 4],
    /// The product of the factors so far.
    pub product: [[f64; 4]; 4],
    /// The point so far.
    pub point: [f64; 4],
}

/// One ray.
#[derive(Clone, Debug, Serialize)]
pub struct RayReport {
    /// 1 is the camera's ray; in Whitted's tree the mirrored child of n is 2n, the refracted one 2n + 1; along a path the
    /// next ray of n is n + 1.
    pub address: u64,
    /// Which ray it comes from.
    pub parent: Option<u64>,
    /// `camera`; in a tree `mirrored` or `refracted`; along a path `reflected`, `transmitted`, `scattered` (a random walk)
    /// or `straight on` (through a surface that is not there).
    pub kind: &'static str,
    /// How many times the path was mirrored, refracted or scattered before.
    pub depth: u32,
    /// Where it starts.
    pub a: [f64; 3],
    /// Its direction, not necessarily of unit length.
    pub direction: [f32; 3],
    /// β: the throughput, the factor of light along it in the sample.
    pub throughput: Factor,
    /// The density over solid angle with which its direction was chosen, as it is weighed against light sampling; `None`
    /// where it was the only one (from the camera and from mirrors) and in Whitted's tree.
    pub pdf: Option<f32>,
    /// Every primitive that was tested, in the order of the tests.
    pub candidates: Vec<Candidate>,
    /// What it met; `None` for the sky.
    pub met: Option<MetReport>,
    /// The throughput at what it met, after absorption on the way and dispersion there; where a path is scattered.
    pub throughput_there: Option<Factor>,
    /// In RGB mode: the one colour that goes on, at the weight of all, where they go different ways in what was met.
    pub only_color: Option<&'static str>,
    /// Lights that it found by itself, along a path.
    pub found: Vec<FoundReport>,
    /// What the surface does with light, along a path.
    pub scattering: Option<ScatteringReport>,
    /// Each light, in Whitted's model.
    pub lights: Vec<LightReport>,
    /// The one light that was sampled, along a path.
    pub asked: Option<AskedReport>,
    /// Whether anything is near, for ambient occlusion.
    pub openness: Option<ShadowReport>,
    /// How the path goes on, or would have.
    pub bounce: Option<BounceReport>,
    /// Each way in which the tree grows here, or would have.
    pub branches: Vec<BranchReport>,
    /// Why the path ends here, if it does.
    pub ends: Option<&'static str>,
    /// What this ray's own hit added to the sample.
    pub added: Amount,
    /// What it added with all rays that come from it.
    pub subtree: Amount,
}

/// What a ray met.
#[derive(Clone, Debug, Serialize)]
pub struct MetReport {
    /// The shape's name.
    pub shape: String,
    /// Triangle or sphere in its shape.
    pub primitive: u32,
    /// The instance, where it is in one.
    pub instance: Option<u32>,
    /// The kernel's `t`, in units of the direction.
    pub t: f32,
    /// The point.
    pub point: [f64; 3],
    /// How far the next ray is moved off the surface, to be safe from rounding: a bound a component.
    pub error: [f64; 3],
    /// Geometric normal to the outside.
    pub ng: [f64; 3],
    /// Shading normal on the side of the viewer.
    pub n: [f32; 3],
    /// Texture coordinates.
    pub uv: [f32; 2],
    /// Whether the outside was met.
    pub front: bool,
    /// The material's name.
    pub material: String,
    /// Its coefficients here, where the integrator evaluates them.
    pub coefficients: Option<CoefficientsReport>,
}

/// Whitted's coefficients at a point.
#[derive(Clone, Debug, Serialize)]
pub struct CoefficientsReport {
    /// `k_a`.
    pub ambient: Factor,
    /// `k_d`.
    pub diffuse: Factor,
    /// `k_s`.
    pub specular: Factor,
    /// `n`.
    pub shininess: f32,
    /// `k_r`.
    pub mirror: Factor,
    /// `k_t`.
    pub transmission: Factor,
    /// Inside over outside.
    pub ior: f32,
}

/// One light's answer.
#[derive(Clone, Debug, Serialize)]
pub struct LightReport {
    /// Its number.
    pub index: u32,
    /// Its name.
    pub light: String,
    /// Toward it, unit length; `None` when no light can come from there.
    pub wi: Option<[f32; 3]>,
    /// `I_j`: what arrives, as Whitted's formula has it.
    pub intensity: Amount,
    /// `k_d (N·L)`.
    pub diffuse: Factor,
    /// `k_s (N·H)ⁿ`.
    pub specular: Factor,
    /// The shadow ray; `None` where it would bring nothing.
    pub shadow: Option<ShadowReport>,
    /// What was added to the sample.
    pub added: Amount,
}

/// A shadow ray.
#[derive(Clone, Debug, Serialize)]
pub struct ShadowReport {
    /// Where it starts.
    pub from: [f64; 3],
    /// What it aims at (where it has no end: a direction's length away).
    pub to: [f64; 3],
    /// Whether it has no end.
    pub is_endless: bool,
    /// What stood in the way, the first first.
    pub blockers: Vec<Blocker>,
}

/// What a shadow ray met.
#[derive(Clone, Debug, Serialize)]
pub struct Blocker {
    /// The shape's name.
    pub shape: String,
    /// The part that it let through; with what was absorbed before it.
    pub passed: Factor,
}

/// One way in which the tree grows.
#[derive(Clone, Debug, Serialize)]
pub struct BranchReport {
    /// Address of the child.
    pub address: u64,
    /// `mirrored` or `refracted`.
    pub kind: &'static str,
    /// The child's weight relative to its parent.
    pub weight: Factor,
    /// The part that Fresnel's equations mirror.
    pub fresnel: Option<f32>,
    /// Whether all was reflected.
    pub total_reflection: bool,
    /// Why it was not followed, if so.
    pub cut: Option<&'static str>,
}

/// One addition to the sample.
#[derive(Clone, Debug, Serialize)]
pub struct Addition {
    /// The ray whose hit made it.
    pub address: u64,
    /// Why: `sky`, `emission`, `ambient`, `view`, `open sky`, or the light's name (`found` or `sampled` along a path).
    pub term: String,
    /// How much.
    pub value: Amount,
}

impl Inspection {
    /// Whether the rays are a path, and not a tree.
    pub fn is_path(&self) -> bool {
        matches!(self.integrator, "path" | "simple_path" | "random_walk" | "ambient_occlusion")
    }
}

impl ShadowReport {
    /// Whether nothing of the light came through.
    pub fn is_blocked(&self) -> bool {
        self.blockers.iter().any(|blocker| blocker.passed.iter().all(|lane| *lane == 0.0))
    }
}
