//! Lens systems of cameras: a table of surfaces, the film behind it, and where it is focused. Kolb, Mitchell, Hanrahan (1995), "A
//! Realistic Camera Model for Computer Graphics". The crate `lookfrom` computes rays through them.

mod file;

use std::sync::Arc;

pub use file::{parse, read};

use crate::image::Image;

/// A lens system, as it is written. Lengths are millimetres where nothing else is said.
#[derive(Clone, Debug, PartialEq)]
pub struct LensSystem {
    /// The name of the lens file, for messages.
    pub name: String,
    /// From the front, which faces the scene, to the film; one refracts at least. The last thickness, to the film, is that of a scene at
    /// infinity or any other: focusing replaces it.
    pub surfaces: Vec<LensSurface>,
    /// Diameter of the aperture stop: > 0, at most that of the table; `None` for that of the table.
    pub stop_diameter: Option<f64>,
    /// The shape of the stop.
    pub shape: ApertureShape,
    /// Distance of the plane of focus from the film along the axis, in units of the world: > 0.
    pub focus_distance: f64,
    /// Diagonal of the film, which has the picture's aspect ratio: > 0.
    pub film_diagonal: f64,
    /// A millimetre in units of the world: > 0.
    pub millimetre: f64,
    /// The brightness of pictures, and what of an aperture's shape counts.
    pub convention: LensConvention,
}

impl LensSystem {
    /// The system in a world that grows by a factor, with it.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            focus_distance: self.focus_distance * factor,
            millimetre: self.millimetre * factor,
            ..self.clone()
        }
    }
}

/// A surface of a lens system: a spherical or flat one that refracts, or the aperture stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LensSurface {
    /// Radius of curvature, positive where the centre lies toward the film; infinite of a flat surface; 0 is the aperture stop, a plane.
    pub curvature_radius: f64,
    /// Distance to the next surface along the axis, of the last one to the film: ≥ 0.
    pub thickness: f64,
    /// Index of refraction between this surface and the next one, or the film: > 0; of the aperture stop that of the surface before it.
    pub index: f64,
    /// Diameter of the part that light passes: > 0.
    pub diameter: f64,
}

impl LensSurface {
    /// Whether it is the aperture stop.
    pub fn is_stop(&self) -> bool {
        self.curvature_radius == 0.0
    }
}

/// The diameter of the aperture stop of a table, in millimetres: the smallest one of several; `None` where there is none.
pub fn stop_diameter(surfaces: &[LensSurface]) -> Option<f64> {
    surfaces.iter().filter(|surface| surface.is_stop()).map(|stop| stop.diameter).reduce(f64::min)
}

/// The shape of an aperture stop. All but the circle have the light of the circle of its diameter.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum ApertureShape {
    /// Its circle.
    #[default]
    Circle,
    /// Darker toward the rim of the circle, as a Gaussian.
    Gaussian,
    /// A square of half the diameter.
    Square,
    /// A regular pentagon with a corner at the bottom, as in pbrt.
    Pentagon,
    /// A star of five points.
    Star,
    /// The mean of an image's colours, on the square around the circle, row 0 on top as seen from behind the camera.
    Image(Arc<Image>),
}

impl ApertureShape {
    /// The names of all but the images.
    pub const NAMED: [(&'static str, Self); 5] = [
        ("circle", Self::Circle),
        ("gaussian", Self::Gaussian),
        ("square", Self::Square),
        ("pentagon", Self::Pentagon),
        ("star", Self::Star),
    ];

    /// Its name; of an image that of its file.
    pub fn name(&self) -> &str {
        match self {
            Self::Image(image) => &image.name,
            named => Self::NAMED.iter().find(|(_, shape)| shape == named).map_or("", |(name, _)| name),
        }
    }
}

/// The brightness of pictures, and what of an aperture's shape counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LensConvention {
    /// The middle of the picture is as bright as that of a pinhole camera, whatever the aperture; all of its shape counts.
    AsPinhole,
    /// The irradiance of the film, in pbrt's units, and as much of the shape as lies in the exit pupil of film points on the horizontal
    /// axis, turned with the film point: what pbrt-v4 computes.
    Pbrt,
}
