//! The camera of an inspection as plain data.

use serde::Serialize;

/// `P_world = T4 · R3 · S2 · T1 · P_k`, each factor and each product. A camera that moves has one more factor, `M`; its position and axes
/// are those when the shutter opened. Matrices are rows of columns.
#[derive(Clone, Debug, Serialize)]
pub struct CameraSteps {
    /// How the camera projects: `perspective`, `orthographic`, all around, `lens system`, or `irradiance`.
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
    /// `b − a`: its direction, not of unit length; `t = 1` is the image plane. Of a lens system of unit length.
    pub direction: [f64; 3],
    /// Whether a lens moved `a` away from `lookfrom`.
    pub lens: bool,
    /// For cameras that see all around, the way from the pixel to a direction in place of T1 and S2.
    pub mapping: Option<SphereMapping>,
    /// The way of the ray through a lens system, if the camera has one.
    pub lens_system: Option<LensSystemReport>,
}

/// The way of a ray from the film through a lens system. Points and directions are in lens space: x to the viewer's right, y up, z along
/// the axis to the scene, the film in z = 0, in units of the world.
#[derive(Clone, Debug, Serialize)]
pub struct LensSystemReport {
    /// The lens file.
    pub name: String,
    /// Effective focal length.
    pub focal_length: f64,
    /// The working f-number: that of a thin lens which would light the middle of the film as much.
    pub f_number: f64,
    /// Distance of the plane of focus from the film.
    pub focus_distance: f64,
    /// The point of the film.
    pub film: [f64; 3],
    /// The direction from there to the rear surface, of unit length.
    pub direction: [f64; 3],
    /// Each surface, from the film to the front.
    pub surfaces: Vec<LensSurfaceReport>,
    /// Whether the ray passes all of them.
    pub passes: bool,
    /// The factor of its light: cos⁴ of its angle to the axis at the film, times the area of the pupil's bounds, over the square of the rear
    /// surface's distance, times the exposure; 0 if it is blocked.
    pub weight: f32,
}

/// A surface of a lens system, and the ray there.
#[derive(Clone, Debug, Serialize)]
pub struct LensSurfaceReport {
    /// z of its vertex.
    pub vertex: f64,
    /// Radius of curvature, positive where the centre lies toward the film; null for planes and the aperture stop.
    pub curvature_radius: Option<f64>,
    /// Radius of the part that light passes.
    pub aperture_radius: f64,
    /// Index of refraction on the scene's side over that on the film's side; null for the aperture stop.
    pub index_ratio: Option<f64>,
    /// The point where the ray meets it; null if it does not.
    pub point: Option<[f64; 3]>,
    /// The direction behind it, of unit length; null where there is none.
    pub direction: Option<[f64; 3]>,
    /// Whether the ray passes.
    pub passes: bool,
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
    /// `T1`, `S2`, `R3` or `T4`; `M`, the way of a camera that moves since the shutter opened.
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
