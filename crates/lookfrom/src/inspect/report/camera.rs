//! The camera of an inspection as plain data.

use serde::Serialize;

/// `P_world = T4 · R3 · S2 · T1 · P_k`, each factor and each product. Matrices are rows of columns.
#[derive(Clone, Debug, Serialize)]
pub struct CameraSteps {
    /// How the camera projects: `perspective`, `orthographic`, or all around.
    pub projection: &'static str,
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
    /// `M_vw = T4 · R3`: from view space to the world.
    pub world_from_view: [[f64; 4]; 4],
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
    /// For cameras that see all around, the way from the pixel to a direction in place of T1 and S2.
    pub mapping: Option<SphereMapping>,
}

/// The way from a pixel to a direction, for cameras that see all around.
#[derive(Clone, Debug, Serialize)]
pub struct SphereMapping {
    /// A description.
    pub does: &'static str,
    /// `P_k` over the size of the picture, v up.
    pub uv: [f64; 2],
    /// The formula of the direction in view space.
    pub formula: &'static str,
    /// Its numbers by name.
    pub numbers: Vec<(&'static str, f64)>,
    /// The direction in view space: along u, v, w.
    pub direction_in_view: [f64; 3],
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
