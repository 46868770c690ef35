//! The report of an inspection as plain data, which is also serialised to JSON.

use serde::Serialize;

use super::candidate::Candidate;
use super::expression::Contribution;
use super::scatter::{BounceReport, FoundReport, LightSampleReport, ScatteringReport};

/// A factor of light, per lane: red, green and blue, or one for each of four wavelengths.
pub type Factor = Vec<f32>;

/// An amount of light.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Amount {
    /// Per lane: the numbers that the renderer adds.
    pub lanes: Vec<f32>,
    /// Its colour as the camera's sensor measures it, linear Rec. 709.
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
    /// The wavelengths of the four lanes; `None` where light is red, green and blue.
    pub wavelengths: Option<WavelengthsReport>,
    /// The steps from the pixel to the world.
    pub camera: CameraSteps,
    /// All rays, parents before children, by address.
    pub rays: Vec<RayReport>,
    /// The sum over all rays, added in the order of `additions`.
    pub radiance: Amount,
    /// Every addition to the sample, in the order in which they were made.
    pub additions: Vec<Addition>,
    /// The filter's weight.
    pub weight: f32,
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

/// `P_world = T4 · R3 · S2 · T1 · P_k`, each factor and each product. Matrices are rows of columns.
#[derive(Clone, Debug, Serialize)]
pub struct CameraSteps {
    /// The camera's position.
    pub lookfrom: [f64; 3],
    /// To the viewer's left.
    pub u: [f64; 3],
    /// Up.
    pub v: [f64; 3],
    /// Forward.
    pub w: [f64; 3],
    /// The point of the image, `(x_k, y_k, 0, 1)`, `y_k` up.
    pub p_k: [f64; 4],
    /// Each matrix by name, its product with those before, and the point after it.
    pub steps: Vec<MatrixStep>,
    /// `P_world`: the point of the image plane in the world.
    pub p_world: [f64; 3],
    /// `a`: the origin of the ray.
    pub a: [f64; 3],
    /// `b`: its intersection with the image plane; `P_world`, unless a lens moved `a` away.
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
    /// A description.
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
    /// 1 is the camera ray; in Whitted's tree the reflected child of n is 2n, the refracted one 2n + 1; along a path n
    /// is followed by n + 1.
    pub address: u64,
    /// Address of the ray that it comes from.
    pub parent: Option<u64>,
    /// `camera`; in a tree `reflected` or `refracted`; along a path `reflected`, `transmitted`, `scattered` (a random
    /// walk) or `straight on` (past a surface that it passes by alpha or as an interface).
    pub kind: &'static str,
    /// Number of reflections, refractions and bounces before.
    pub depth: u32,
    /// Its origin.
    pub a: [f64; 3],
    /// Its direction, not necessarily of unit length.
    pub direction: [f32; 3],
    /// β: the throughput, the factor of light along it in the sample.
    pub throughput: Factor,
    /// The solid angle density of its direction, for MIS weights; `None` for camera rays, after specular bounces and in
    /// Whitted's tree.
    pub pdf: Option<f32>,
    /// Every primitive that was tested, in the order of the tests.
    pub candidates: Vec<Candidate>,
    /// Its hit; `None` for a miss.
    pub met: Option<MetReport>,
    /// The throughput at the hit, after absorption on the way and dispersion there, along a path.
    pub throughput_there: Option<Factor>,
    /// In RGB mode: the one colour that goes on, with the weight of all three, after dispersion at the hit.
    pub only_color: Option<&'static str>,
    /// Lights that it hit, along a path.
    pub found: Vec<FoundReport>,
    /// The BSDF at the hit, along a path.
    pub scattering: Option<ScatteringReport>,
    /// Each light, in Whitted's model.
    pub lights: Vec<LightReport>,
    /// The light that was sampled at the hit, along a path.
    pub light_sample: Option<LightSampleReport>,
    /// The shadow ray of ambient occlusion.
    pub openness: Option<ShadowReport>,
    /// The continuation of the path, even if Russian roulette ends it.
    pub bounce: Option<BounceReport>,
    /// The branches of the tree here, followed or not.
    pub branches: Vec<BranchReport>,
    /// The reason why the path ends here, if it does.
    pub ends: Option<&'static str>,
    /// The contribution of this ray's own hit to the sample.
    pub added: Amount,
    /// The contribution of this ray and of all rays that come from it.
    pub subtree: Amount,
}

/// The hit of a ray.
#[derive(Clone, Debug, Serialize)]
pub struct MetReport {
    /// The shape's name.
    pub shape: String,
    /// Index of the primitive.
    pub primitive: u32,
    /// The instance, if it is in one.
    pub instance: Option<u32>,
    /// The kernel's `t`, in units of the direction.
    pub t: f32,
    /// The point.
    pub point: [f64; 3],
    /// Error bound of the point, per component, by which the next ray's origin is moved off the surface.
    pub error: [f64; 3],
    /// Outward geometric normal.
    pub ng: [f64; 3],
    /// Shading normal on the side of the viewer.
    pub n: [f32; 3],
    /// Texture coordinates.
    pub uv: [f32; 2],
    /// Whether the outside was hit.
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

/// One light in Whitted's model.
#[derive(Clone, Debug, Serialize)]
pub struct LightReport {
    /// Index of the light.
    pub index: u32,
    /// Its name.
    pub light: String,
    /// Toward it, unit length; `None` when the light does not illuminate this point.
    pub wi: Option<[f32; 3]>,
    /// `I_j` of Whitted's formula: the unoccluded light.
    pub intensity: Amount,
    /// `k_d (N·L)`.
    pub diffuse: Factor,
    /// `k_s (N·H)ⁿ`.
    pub specular: Factor,
    /// The shadow ray; `None` where its contribution would be 0.
    pub shadow: Option<ShadowReport>,
    /// The contribution to the sample.
    pub added: Amount,
}

/// A shadow ray.
#[derive(Clone, Debug, Serialize)]
pub struct ShadowReport {
    /// Its origin.
    pub from: [f64; 3],
    /// Its target (if it has no end: one length of its direction away).
    pub to: [f64; 3],
    /// Whether it has no end.
    pub is_endless: bool,
    /// The surfaces that it hit, in order.
    pub blockers: Vec<Blocker>,
}

/// A surface that a shadow ray hit.
#[derive(Clone, Debug, Serialize)]
pub struct Blocker {
    /// The shape's name.
    pub shape: String,
    /// Transmittance of the surface and of the medium before it.
    pub passed: Factor,
}

/// One branch of the tree.
#[derive(Clone, Debug, Serialize)]
pub struct BranchReport {
    /// Address of the child.
    pub address: u64,
    /// `reflected` or `refracted`.
    pub kind: &'static str,
    /// The child's weight relative to its parent.
    pub weight: Factor,
    /// Fresnel reflectance.
    pub fresnel: Option<f32>,
    /// Whether there is total internal reflection.
    pub total_reflection: bool,
    /// The reason why it was not followed, if it was not.
    pub cut: Option<&'static str>,
}

/// One addition to the sample.
#[derive(Clone, Debug, Serialize)]
pub struct Addition {
    /// The ray whose hit made it.
    pub address: u64,
    /// The reason: `sky`, `emission`, `ambient`, `view`, `open sky`, or the light's name (`found` or `sampled` along a
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

impl ShadowReport {
    /// Whether the light is completely blocked.
    pub fn is_blocked(&self) -> bool {
        self.blockers.iter().any(|blocker| blocker.passed.iter().all(|lane| *lane == 0.0))
    }
}
