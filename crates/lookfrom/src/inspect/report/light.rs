//! Lights, shadow rays and branches in Whitted's model as plain data.

use serde::Serialize;

use super::{Amount, Departure, Factor, NullReport};
use crate::inspect::candidate::TraversalReport;
use crate::inspect::segments::RayKind;
use crate::light::derivation::Derivation;

/// One light in Whitted's model.
#[derive(Clone, Debug, Serialize)]
pub struct LightReport {
    /// Index of the light.
    pub index: u32,
    /// Its name.
    pub light: String,
    /// Toward it, unit length; `None` when the light does not illuminate this point.
    pub wi: Option<[f32; 3]>,
    /// `N·L`; `None` when the light does not illuminate this point.
    pub n_dot_l: Option<f32>,
    /// H: halfway between the directions to the light and to the viewer, unit length.
    pub h: Option<[f32; 3]>,
    /// `N·H`.
    pub n_dot_h: Option<f32>,
    /// L: incident radiance (for a point light: intensity after fall-off).
    pub arrives: Amount,
    /// The density, per steradian, of the direction; 1 where there is only one. `I_j = L / (π pdf)`.
    pub pdf: Option<f32>,
    /// The point on the light, in the world; `None` for a light infinitely far away.
    pub point: Option<[f64; 3]>,
    /// The formulas of `arrives` and `pdf`, as far as there are any.
    pub derivations: Vec<Derivation>,
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
    /// The step from the point that is lit to its origin.
    pub departure: Option<Departure>,
    /// Its target (if it has no end: one length of its direction away).
    pub to: [f64; 3],
    /// Whether it has no end.
    pub is_endless: bool,
    /// The surfaces that it hit, in order.
    pub blockers: Vec<Blocker>,
    /// The cost of finding them, of all its parts.
    pub traversal: TraversalReport,
    /// The collisions with media that vary, by which their transmittance is estimated: of all its parts, each from 1 on.
    pub collisions: Vec<NullReport>,
    /// Transmittance of the medium on the rest of the way to the light; `None` if it is blocked before.
    pub rest: Option<Factor>,
}

/// A surface that a shadow ray hit.
#[derive(Clone, Debug, Serialize)]
pub struct Blocker {
    /// The shape's name.
    pub shape: String,
    /// Its distance, in units of the ray from where it came last: from the surface, or from the blocker before.
    pub t: f32,
    /// The point, in the world.
    pub point: [f64; 3],
    /// Transmittance of the surface and of the medium before it.
    pub passed: Factor,
}

/// One branch of the tree.
#[derive(Clone, Debug, Serialize)]
pub struct BranchReport {
    /// Address of the child.
    pub address: u64,
    /// Reflected or refracted.
    pub kind: RayKind,
    /// Its direction by the shading normal, unit length, whether it was followed or not. (The ray itself is reflected at the
    /// tangent plane where this points to the wrong side.)
    pub direction: [f32; 3],
    /// The absolute cosine of the direction and the shading normal.
    pub cos: f32,
    /// The index of refraction there over here, of Snell's law: `sin θ = η sin θ'`.
    pub eta: Option<f32>,
    /// The child's weight relative to its parent.
    pub weight: Factor,
    /// Fresnel reflectance.
    pub fresnel: Option<f32>,
    /// Whether there is total internal reflection.
    pub total_reflection: bool,
    /// The reason why it was not followed, if it was not.
    pub cut: Option<&'static str>,
}

impl ShadowReport {
    /// The surface that blocks the light completely, if there is one.
    pub fn blocker(&self) -> Option<&Blocker> {
        self.blockers.iter().find(|blocker| blocker.passed.iter().all(|lane| *lane == 0.0))
    }
}
