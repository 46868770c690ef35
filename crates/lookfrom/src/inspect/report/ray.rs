//! A ray and its hit as plain data.

use serde::Serialize;

use super::{
    Amount, BranchReport, Factor, FlightReport, LightReport, PhaseReport, ProbeReport, ShadowReport,
    TrackingReport,
};
use crate::inspect::candidate::{Candidate, TraversalReport};
use crate::inspect::scatter::{BounceReport, FoundReport, LightSampleReport, ScatteringReport};
use crate::inspect::segments::RayKind;

/// One ray.
#[derive(Clone, Debug, Serialize)]
pub struct RayReport {
    /// 1 is the camera ray; in Whitted's tree the reflected child of n is 2n, the refracted one 2n + 1; along a path n
    /// is followed by n + 1.
    pub address: u64,
    /// Address of the ray that it comes from.
    pub parent: Option<u64>,
    /// Its kind, which is not of shadow rays. Below a surface it is the line that found where the path leaves, and not a ray of light.
    pub kind: RayKind,
    /// Number of reflections, refractions and bounces before.
    pub depth: u32,
    /// Its origin.
    pub a: [f64; 3],
    /// The same as it is traced: relative to the render origin (`Inspection::render_origin`).
    pub origin: [f32; 3],
    /// Its direction, not necessarily of unit length.
    pub direction: [f32; 3],
    /// The step from the point that it leaves to its origin; `None` for camera rays.
    pub departure: Option<Departure>,
    /// β: the throughput, the factor of light along it in the sample.
    pub throughput: Factor,
    /// The solid angle density of its direction, for MIS weights; `None` for camera rays, after specular bounces and in
    /// Whitted's tree.
    pub pdf: Option<f32>,
    /// The cost of finding its hit.
    pub traversal: TraversalReport,
    /// Every primitive that was tested, in the order of the tests.
    pub candidates: Vec<Candidate>,
    /// Its hit; `None` for a miss, and where a medium scatters it before.
    pub met: Option<MetReport>,
    /// What a medium absorbs on the way to the hit.
    pub absorption: Option<AbsorptionReport>,
    /// Free flight in a homogeneous medium that scatters: to the hit, or to a point before it.
    pub flight: Option<FlightReport>,
    /// Collisions in a medium that varies: to the hit, or to a point before it.
    pub tracking: Option<TrackingReport>,
    /// The light that the medium emits on the way, as far as the hit; it is added.
    pub medium_emission: Option<Amount>,
    /// The continuation of the path where a medium scatters it, even if Russian roulette ends it.
    pub phase: Option<PhaseReport>,
    /// The product of η² over the refractions before, by which Russian roulette multiplies the throughput.
    pub eta_scale: f32,
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
    /// The search for the point where the path leaves, where it has entered a medium below the surface.
    pub probe: Option<ProbeReport>,
    /// The branches of the tree here, followed or not.
    pub branches: Vec<BranchReport>,
    /// The reason why the path ends here, if it does.
    pub ends: Option<&'static str>,
    /// The contribution of this ray's own hit to the sample.
    pub added: Amount,
    /// The contribution of this ray and of all rays that come from it.
    pub subtree: Amount,
}

/// The way from a point of a triangle to the smooth surface that its vertex normals describe (Hanika 2021):
/// `lift = Σ w_k max(0, −(p − P_k)·n_k) n_k`, with `p = Σ w_k P_k`.
#[derive(Clone, Debug, Serialize)]
pub struct LiftReport {
    /// P_k: the corners, relative to the render origin, or in the space of the object where there is one.
    pub corners: [[f32; 3]; 3],
    /// n_k: their normals, unit length, in the same space.
    pub normals: [[f32; 3]; 3],
    /// w_k: the weights of the corners at the point.
    pub weights: [f32; 3],
    /// In an instance the rows of the matrix that leads from the object to the world; the lift is multiplied by it.
    pub from_object: Option<[[f64; 3]; 3]>,
    /// The lift, in the world.
    pub lift: [f32; 3],
}

/// How the origin of a ray follows from the point that it leaves: `a = point + lift + step · ng`, rounded to f32, relative to the
/// render origin, away from the surface.
#[derive(Clone, Debug, Serialize)]
pub struct Departure {
    /// The lift, where the ray leaves to the outside of a smooth surface: to the side of its normal.
    pub lift: Option<[f32; 3]>,
    /// Along the outward normal, beyond the error bound: `±Σ |ng| (error + 2⁻⁵¹ |point|)`, the point relative to the render
    /// origin.
    pub step: f64,
}

/// Absorption by a medium (Beer's law): `T = exp(−σ · scale · length)`.
#[derive(Clone, Debug, Serialize)]
pub struct AbsorptionReport {
    /// The material of the body whose medium it is; `None` in a medium that fills space.
    pub material: Option<String>,
    /// σ: the absorption coefficient, per unit of length.
    pub sigma: Factor,
    /// A factor of it.
    pub scale: f32,
    /// Length of the way; infinite where nothing is hit.
    pub length: f32,
    /// T: the part of the light that is left.
    pub transmittance: Factor,
    /// The throughput after it.
    pub throughput: Factor,
}

impl RayReport {
    /// The point where a medium scatters it before it hits anything.
    pub fn scattered_at(&self) -> Option<[f64; 3]> {
        let in_flight = self.flight.as_ref().and_then(|flight| flight.scattered_at);
        in_flight.or_else(|| self.tracking.as_ref()?.scattered_at)
    }

    /// Where it ends, in the world; `None` for a miss.
    pub fn end(&self) -> Option<[f64; 3]> {
        self.scattered_at().or_else(|| Some(self.met.as_ref()?.point))
    }
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
    /// The way to the smooth surface that the triangle stands for, where rays start that leave to its outside.
    pub lift: Option<LiftReport>,
    /// Outward geometric normal.
    pub ng: [f64; 3],
    /// Shading normal on the side of the viewer.
    pub n: [f32; 3],
    /// Texture coordinates.
    pub uv: [f32; 2],
    /// The footprint of a pixel on the surface, where textures of its material are averaged over it.
    pub footprint: Option<FootprintReport>,
    /// Toward the viewer, unit length.
    pub wo: [f32; 3],
    /// The cosine of the angle between the shading normal and the direction to the viewer.
    pub cos_viewer: f32,
    /// Whether the outside was hit.
    pub front: bool,
    /// Alpha here, where the surface is not opaque everywhere: the ray passes with the probability of the rest.
    pub alpha: Option<f32>,
    /// The material's name.
    pub material: String,
    /// Its coefficients here, where the integrator evaluates them.
    pub coefficients: Option<CoefficientsReport>,
}

/// The part of a surface that the camera's narrowest pixel would see if the camera looked at it, in place of ray differentials: changes
/// from one pixel to the next, which each texture multiplies by a width of its own. A level of a MIP map has texels of twice the
/// largest change of a coordinate in texels, or with elliptical averages of the shorter axis (Pharr, Jakob & Humphreys 2023, §§ 10.1.3, 10.4.3).
#[derive(Clone, Debug, Serialize)]
pub struct FootprintReport {
    /// ∂p/∂x, in the world.
    pub dpdx: [f32; 3],
    /// ∂p/∂y, in the world.
    pub dpdy: [f32; 3],
    /// ∂(u, v)/∂x.
    pub duv_dx: [f32; 2],
    /// ∂(u, v)/∂y.
    pub duv_dy: [f32; 2],
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
