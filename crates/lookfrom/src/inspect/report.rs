//! What an inspection says, as plain data: the JSON form is this, field by field.

use lookfrom_bvh::Hit;
use serde::Serialize;

use super::candidate::Candidate;

/// Everything that happened on the way of one sample.
#[derive(Clone, Debug, Serialize)]
pub struct Inspection {
    /// Column and row from the top left.
    pub pixel: [u32; 2],
    /// Number of the sample in its pixel.
    pub sample: u32,
    /// From the pixel to the world.
    pub camera: CameraSteps,
    /// The tree of rays, parents before children, by address.
    pub rays: Vec<RayReport>,
    /// The sum over the tree, added in the order of `additions`.
    pub radiance: [f32; 3],
    /// Every addition to the sample, in the order in which they were made.
    pub additions: Vec<Addition>,
    /// The filter's weight.
    pub weight: f32,
    /// What the film received: `radiance · weight`.
    pub film: [f32; 3],
    /// Whether the additions shown give, bit for bit, what the film received.
    pub adds_up: bool,
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

/// One ray of the tree.
#[derive(Clone, Debug, Serialize)]
pub struct RayReport {
    /// 1 is the camera's ray; the mirrored child of n is 2n, the refracted one 2n + 1.
    pub address: u64,
    /// `camera`, `mirrored` or `refracted`.
    pub kind: &'static str,
    /// How many mirrors and refractions lie behind.
    pub depth: u32,
    /// Where it starts.
    pub a: [f64; 3],
    /// Its direction, not necessarily of unit length.
    pub direction: [f32; 3],
    /// The share of the sample that light along it has.
    pub share: [f32; 3],
    /// Every primitive that was tested, in the order of the tests.
    pub candidates: Vec<Candidate>,
    /// What it met; `None` for the sky.
    pub met: Option<MetReport>,
    /// Each light that was asked.
    pub lights: Vec<LightReport>,
    /// Each way in which the tree grows here, or would have.
    pub branches: Vec<BranchReport>,
    /// What this ray's own hit added to the sample.
    pub added: [f32; 3],
    /// What it added with all of its descendants.
    pub subtree: [f32; 3],
    #[serde(skip)]
    pub(super) hit: Hit,
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
    /// Its coefficients here, where the integrator asks for them.
    pub coefficients: Option<CoefficientsReport>,
}

/// Whitted's coefficients at a point.
#[derive(Clone, Debug, Serialize)]
pub struct CoefficientsReport {
    /// `k_a`.
    pub ambient: [f32; 3],
    /// `k_d`.
    pub diffuse: [f32; 3],
    /// `k_s`.
    pub specular: [f32; 3],
    /// `n`.
    pub shininess: f32,
    /// `k_r`.
    pub mirror: [f32; 3],
    /// `k_t`.
    pub transmission: [f32; 3],
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
    pub intensity: [f32; 3],
    /// `k_d (N·L)`.
    pub diffuse: [f32; 3],
    /// `k_s (N·H)ⁿ`.
    pub specular: [f32; 3],
    /// Where the shadow ray starts and aims at (for an infinitely far light: a direction's length away).
    pub shadow_ray: Option<[[f64; 3]; 2]>,
    /// What stood in the way, the first first, each with the part that it let through.
    pub blockers: Vec<(String, [f32; 3])>,
    /// What was added to the sample.
    pub added: [f32; 3],
}

/// One way in which the tree grows.
#[derive(Clone, Debug, Serialize)]
pub struct BranchReport {
    /// Address of the child.
    pub address: u64,
    /// `mirrored` or `refracted`.
    pub kind: &'static str,
    /// The child's share of its parent.
    pub weight: [f32; 3],
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
    /// Why: `sky`, `emission`, `ambient`, `view`, or the light's name.
    pub term: String,
    /// How much.
    pub value: [f32; 3],
}

impl RayReport {
    pub(super) fn light_mut(&mut self, index: u32) -> Option<&mut LightReport> {
        self.lights.iter_mut().find(|report| report.index == index)
    }
}

impl LightReport {
    /// Whether nothing of the light came through.
    pub fn is_blocked(&self) -> bool {
        self.blockers.iter().any(|(_, passed)| *passed == [0.0; 3])
    }
}
