//! Camera parameters, with the names of the lecture notes: `lookfrom`, `lookat`, `up`, `θ`. Crate `lookfrom` makes matrices of them.

use glam::{DMat4, DVec3};

use crate::error::Location;
use crate::scene::MediumId;

/// A camera description. It is validated when its matrices are made.
#[derive(Clone, Debug)]
pub struct Camera {
    /// The location in the file.
    pub at: Location,
    /// Position and orientation.
    pub view: View,
    /// The target of a [`View::Matrix`], where the file has one.
    pub target: Option<Target>,
    /// The projection.
    pub projection: Projection,
    /// A lens that blurs what is not in focus; `None` is a pinhole.
    pub lens: Option<Lens>,
    /// The screen window; `None` is that of the projection, around the axis.
    pub window: Option<Window>,
    /// `d`, the distance of the image plane: > 0. Only the `t` that is shown to people depends on it.
    pub distance: f64,
    /// The medium around the camera; `None` is a vacuum.
    pub medium: Option<MediumId>,
}

/// Position and orientation of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// As in the notes.
    Look {
        /// The position of the camera.
        lookfrom: DVec3,
        /// The point at the centre of the view.
        lookat: DVec3,
        /// The up vector; any length, any angle to the view but parallel.
        up: DVec3,
    },
    /// From another format: camera space has x to the *left*, y up, z forward, as the notes' `u v w`; any invertible
    /// affine matrix. One that mirrors makes a mirrored picture.
    Matrix(DMat4),
}

impl View {
    /// The position of the camera.
    pub fn lookfrom(&self) -> DVec3 {
        match self {
            Self::Look { lookfrom, .. } => *lookfrom,
            Self::Matrix(matrix) => matrix.w_axis.truncate(),
        }
    }
}

/// The target of a camera. The picture does not depend on it; a turntable orbits around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// The point, in the world.
    pub lookat: DVec3,
    /// The up vector, in the world; any length.
    pub up: DVec3,
}

impl Target {
    /// The same in the space that a matrix leads to.
    pub fn transformed(&self, matrix: &DMat4) -> Self {
        Self { lookat: matrix.transform_point3(self.lookat), up: matrix.transform_vector3(self.up) }
    }
}

/// The projection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Perspective projection.
    Perspective {
        /// θ, the *vertical* field of view in degrees, in (0, 180).
        fov: f64,
    },
    /// Orthographic projection.
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
