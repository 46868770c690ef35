//! Camera parameters, with the names of the lecture notes: `lookfrom`, `lookat`, `up`, `θ`. The crate `lookfrom` computes
//! matrices from them.

use std::sync::Arc;

use glam::{DMat3, DMat4, DVec3, DVec4};

use crate::error::Location;
use crate::lens::LensSystem;
use crate::motion::Motion;
use crate::scene::MediumId;

/// An up vector, along an axis, that is not parallel to a direction: y, or z for what looks up or down.
pub fn up_across(direction: DVec3) -> DVec3 {
    let is_upright = direction.y.abs() > 0.9 * direction.length();
    if is_upright { DVec3::Z } else { DVec3::Y }
}

/// A camera description. It is validated when its matrices are computed.
#[derive(Clone, Debug)]
pub struct Camera {
    /// The location in the file.
    pub at: Location,
    /// Position and orientation.
    pub view: View,
    /// The target of a [`View::Matrix`], if the file gives one.
    pub target: Option<Target>,
    /// The projection.
    pub projection: Projection,
    /// A thin lens, for depth of field; `None` is a pinhole, or a [`Projection::LensSystem`].
    pub lens: Option<Lens>,
    /// The screen window; `None` for that of the projection, centred on the axis.
    pub window: Option<Window>,
    /// `d`, the distance of the image plane: > 0. Only the `t` shown to users depends on it.
    pub distance: f64,
    /// Distances of the near and the far clipping plane along the view axis, 0 ≤ near < far: rays of the camera meet only what is between
    /// them. `None` for all before the camera, and for projections without an image plane.
    pub clip: Option<[f64; 2]>,
    /// The medium around the camera; `None` is a vacuum.
    pub medium: Option<MediumId>,
    /// The time that the shutter is open, in frames of an animation: 0 is an instant. [`ImportOptions::shutter`](crate::ImportOptions::shutter)
    /// replaces it.
    pub shutter: f64,
    /// Its motion, if it moves: in the world, from where it is when the shutter opens.
    pub motion: Option<Arc<Motion>>,
}

/// Position and orientation of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// As in the lecture notes.
    Look {
        /// The position of the camera.
        lookfrom: DVec3,
        /// The point at the centre of the view.
        lookat: DVec3,
        /// The up vector; of any length, not parallel to the view.
        up: DVec3,
    },
    /// As in other formats: camera space has x to the *left*, y up, z forward, as the notes' `u v w`; any invertible affine
    /// matrix. A reflection mirrors the image.
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

/// Position and orientation of a camera, as in [`View::Look`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// The position of the camera.
    pub lookfrom: DVec3,
    /// The point at the centre of the view.
    pub lookat: DVec3,
    /// The up vector; of any length, not parallel to the view.
    pub up: DVec3,
}

impl Camera {
    /// Position and orientation as points and a vector, whether the image is mirrored ([`Self::is_mirrored`]) or not; `None` for a
    /// matrix that shears or is degenerate. The `lookat` of a matrix is the point of its view axis that is nearest to `middle`, if that
    /// is in front of the camera.
    pub fn look(&self, middle: DVec3) -> Option<Look> {
        let shears = match self.view {
            View::Look { .. } => false,
            View::Matrix(matrix) => {
                let linear = DMat3::from_mat4(matrix);
                let scale = linear.z_axis.length();
                let products = linear.transpose() * linear * (1.0 / (scale * scale));
                !products.abs_diff_eq(DMat3::IDENTITY, 1e-6)
            }
        };
        self.nearest_look(middle).filter(|_| !shears)
    }

    /// [`Self::look`] also of a matrix that shears, without that. `None` for a degenerate one.
    pub fn nearest_look(&self, middle: DVec3) -> Option<Look> {
        let matrix = match self.view {
            View::Look { lookfrom, lookat, up } => return Some(Look { lookfrom, lookat, up }),
            View::Matrix(matrix) => matrix,
        };
        let [up, forward, lookfrom] = [matrix.y_axis, matrix.z_axis, matrix.w_axis].map(DVec4::truncate);
        let w = forward / forward.length();
        let lookat = lookfrom + distance_along(w, middle - lookfrom) * w;
        (w.is_finite() && up != DVec3::ZERO).then_some(Look { lookfrom, lookat, up })
    }

    /// Whether it mirrors the image, as those of many scenes of pbrt do.
    pub fn is_mirrored(&self) -> bool {
        matches!(self.view, View::Matrix(matrix) if matrix.determinant() < 0.0)
    }

    /// The distance of the plane of focus along the view axis, of a thin lens or a lens system.
    pub fn focus_distance(&self) -> Option<f64> {
        match &self.projection {
            Projection::LensSystem(system) => Some(system.focus_distance),
            _ => self.lens.map(|lens| lens.focus_distance),
        }
    }

    fn set_focus_distance(&mut self, distance: f64) {
        if let Projection::LensSystem(system) = &mut self.projection {
            Arc::make_mut(system).focus_distance = distance;
        }
        if let Some(lens) = &mut self.lens {
            lens.focus_distance = distance;
        }
    }

    /// Changes position and orientation. A lens that was focused on `lookat` ([`Camera::look`]) stays so, and a mirrored image
    /// mirrored.
    pub fn set_look(&mut self, look: Look, middle: DVec3) {
        let before = self.look(middle).map(|look| look.lookfrom.distance(look.lookat));
        if let (Some(focus_distance), Some(before)) = (self.focus_distance(), before)
            && (focus_distance - before).abs() <= 1e-9 * before
        {
            self.set_focus_distance(look.lookfrom.distance(look.lookat));
        }
        let Look { lookfrom, lookat, up } = look;
        self.view = match look.matrix().filter(|_| self.is_mirrored()) {
            Some(matrix) => View::Matrix(matrix * DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0))),
            None => View::Look { lookfrom, lookat, up },
        };
    }
}

impl Look {
    /// From the space of the camera, as in [`View::Matrix`], to the world; `None` where it has no direction.
    pub(crate) fn matrix(&self) -> Option<DMat4> {
        let w = (self.lookat - self.lookfrom).try_normalize()?;
        let u = self.up.cross(w).try_normalize()?;
        Some(DMat4::from_mat3_translation(DMat3::from_cols(u, w.cross(u), w), self.lookfrom))
    }
}

/// The distance of a place along a direction of unit length, or 1 if it is behind.
fn distance_along(w: DVec3, place: DVec3) -> f64 {
    let along = place.dot(w);
    if along > 0.0 && along.is_finite() { along } else { 1.0 }
}

/// The target of a camera. The image does not depend on it; a turntable orbits around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// The point, in world space.
    pub lookat: DVec3,
    /// The up vector, in world space; any length.
    pub up: DVec3,
}

impl Target {
    /// The target transformed by a matrix.
    pub fn transformed(&self, matrix: &DMat4) -> Self {
        Self { lookat: matrix.transform_point3(self.lookat), up: matrix.transform_vector3(self.up) }
    }
}

/// The projection.
#[derive(Clone, Debug, PartialEq)]
pub enum Projection {
    /// Perspective projection.
    Perspective {
        /// θ, the *vertical* field of view in degrees, in (0, 180).
        fov: f64,
    },
    /// Orthographic projection.
    Orthographic {
        /// The height of the image in world units: > 0.
        height: f64,
    },
    /// A full panorama in latitude and longitude: rows are angles from the up axis, the middle column is the direction of
    /// view, and columns further right look further to the right. With a [`Sky::Image`] as environment, a camera that looks
    /// along −z of its space, with y up, reproduces that image.
    ///
    /// [`Sky::Image`]: crate::light::Sky::Image
    Equirectangular,
    /// The equirectangular mapping of pbrt's spherical camera: the first column looks to the right, the column at a quarter
    /// of the width is the direction of view, and columns further right look further to the *left*.
    EquirectangularPbrt,
    /// A full panorama on a square, by the equal-area octahedral mapping (Clarberg 2008).
    Octahedral,
    /// Through a lens system onto a film, whose middle is at the position of the camera.
    LensSystem(Arc<LensSystem>),
    /// No picture, but a measurement: each pixel is the irradiance on a surface, in the mean over its area. Rays start anywhere on the
    /// outside of the surface, with directions in proportion to the cosine to its geometric normal, and their light counts π times: under a
    /// constant radiance of 1 the picture is π. Position, orientation, lens and window of the camera have no effect.
    Irradiance {
        /// The name of the shapes that the surface is made of. They are in no object.
        surface: String,
    },
}

impl Projection {
    /// Whether it makes a measurement on a surface of the scene, not a picture of it.
    pub fn is_measurement(&self) -> bool {
        matches!(self, Self::Irradiance { .. })
    }
}

/// A part of the image plane, in units of half the projection's height: x to the right, y up. Without one the image shows
/// x ∈ [−nx/ny, nx/ny], y ∈ [−1, 1].
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
    /// Distance of the plane of focus along the view axis: > 0.
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
            clip: None,
            medium: None,
            shutter: 0.0,
            motion: None,
        }
    }
}
