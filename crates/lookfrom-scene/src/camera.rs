//! The eye, in the words of the lecture notes: `lookfrom`, `lookat`, `up`, `θ`. Crate `lookfrom` turns it into matrices.

use glam::{DMat4, DVec3};

use crate::error::Location;
use crate::scene::MediumId;

/// The eye as it was written. Whether it can see is checked when it is turned into matrices.
#[derive(Clone, Debug)]
pub struct Camera {
    /// Where it was written.
    pub at: Location,
    /// Where it stands and looks.
    pub view: View,
    /// What a [`View::Matrix`] looks at, where the file says so.
    pub target: Option<Target>,
    /// How space is flattened.
    pub projection: Projection,
    /// A lens that blurs what is not in focus; `None` is a pinhole.
    pub lens: Option<Lens>,
    /// Which part of the image plane the picture shows; `None` is what the projection says, around the axis.
    pub window: Option<Window>,
    /// `d`, the distance of the image plane: > 0. Only the `t` that is shown to people depends on it.
    pub distance: f64,
    /// What fills the space that it stands in; `None` is a vacuum.
    pub medium: Option<MediumId>,
}

/// Where the eye stands and looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// As in the notes.
    Look {
        /// The eye.
        lookfrom: DVec3,
        /// What it looks at.
        lookat: DVec3,
        /// What is up for it; any length, any angle to the view but parallel.
        up: DVec3,
    },
    /// From another format: camera space has x to the *left*, y up, z forward, as the notes' `u v w`; any invertible
    /// affine matrix. One that mirrors makes a mirrored picture.
    Matrix(DMat4),
}

impl View {
    /// Where the eye is.
    pub fn lookfrom(&self) -> DVec3 {
        match self {
            Self::Look { lookfrom, .. } => *lookfrom,
            Self::Matrix(matrix) => matrix.w_axis.truncate(),
        }
    }
}

/// What an eye looks at. The picture does not depend on it; a camera that goes around goes around this.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// The point, in the world.
    pub lookat: DVec3,
    /// What is up, in the world; any length.
    pub up: DVec3,
}

impl Target {
    /// The same in the space that a matrix leads to.
    pub fn transformed(&self, matrix: &DMat4) -> Self {
        Self { lookat: matrix.transform_point3(self.lookat), up: matrix.transform_vector3(self.up) }
    }
}

/// How space is flattened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Rays fan out from the eye.
    Perspective {
        /// θ, the *vertical* field of view in degrees, in (0, 180).
        fov: f64,
    },
    /// Rays are parallel.
    Orthographic {
        /// The height of the picture in the world: > 0.
        height: f64,
    },
    /// All around in latitude and longitude: rows are angles from the up axis, the middle column is the direction of view,
    /// and columns further right look further to the right. Of surroundings that are a [`Sky::Image`], an eye that looks
    /// along −z of its space, with y up, sees that picture again.
    ///
    /// [`Sky::Image`]: crate::light::Sky::Image
    Equirectangular,
    /// The equirectangular mapping of pbrt's spherical camera: the first column looks to the right, one quarter on is the
    /// direction of view, and columns further right look further to the *left*.
    EquirectangularPbrt,
    /// All around, on a square of equal area folded from an octahedron (Clarberg 2008).
    Octahedral,
}

/// A part of the image plane, in units of half the height that the projection gives: x to the right, y up. Without one
/// the picture shows x ∈ [−nx/ny, nx/ny], y ∈ [−1, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// From left to right.
    pub x: [f64; 2],
    /// From bottom to top.
    pub y: [f64; 2],
}

/// A thin lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Radius of the aperture: ≥ 0.
    pub radius: f64,
    /// Distance, along the view axis, of the plane that is sharp: > 0.
    pub focus_distance: f64,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            at: Location::default(),
            view: View::Look { lookfrom: DVec3::new(0.0, 1.0, 5.0), lookat: DVec3::ZERO, up: DVec3::Y },
            target: None,
            projection: Projection::Perspective { fov: 45.0 },
            lens: None,
            window: None,
            distance: 1.0,
            medium: None,
        }
    }
}
