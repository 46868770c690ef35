//! Light sources other than shapes. (Area lights are shapes with `Shape::emission`.)
//!
//! Intensities have the meaning of Whitted's `I_j`: a white diffuse surface that faces the light is seen with that
//! radiance (for a light with fall-off: from a distance of 1). In radiometric units a point light of intensity `I`
//! radiates `π I` W/sr, a distant light gives `π I` W/m².

use glam::{DMat4, DVec3};

use crate::error::Location;
use crate::image::Image;
use crate::material::Color;
use crate::scene::ImageId;
use crate::texture::TexelFilter;

/// A light source.
#[derive(Clone, Debug)]
pub struct Light {
    /// Its name, if it has one.
    pub name: Option<String>,
    /// The location in the file.
    pub at: Location,
    /// The kind of light.
    pub kind: LightKind,
    /// The power.
    pub power: Power,
}

/// The power of a light: a scale of its colour, or a total.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Power {
    /// Multiplies the colour.
    pub scale: f32,
    /// The total before `scale`: for distant lights and environments the illuminance on a surface that faces the light, else
    /// the total power emitted, both in units in which white light of radiance 1 has luminance 1. `None` leaves the colour
    /// as bright as it is written.
    pub total: Option<f32>,
    /// Whether the brightness of a spectrum counts; otherwise it is first divided by its own luminance, so that it has
    /// luminance 1, as RGB white has.
    pub absolute: bool,
}

impl Power {
    /// The brightness of the colour, unscaled.
    pub const AS_WRITTEN: Self = Self { scale: 1.0, total: None, absolute: false };
}

impl Default for Power {
    fn default() -> Self {
        Self::AS_WRITTEN
    }
}

/// The kinds of lights.
#[derive(Clone, Debug, PartialEq)]
pub enum LightKind {
    /// Whitted's `I_a`: reaches every surface from all directions, without shadows.
    Ambient {
        /// `I_a`.
        color: [f32; 3],
    },
    /// A point light, equal in all directions.
    Point {
        /// The location.
        position: DVec3,
        /// `I_j` at a distance of 1.
        intensity: Color,
        /// The falloff with distance.
        falloff: Falloff,
    },
    /// A light at infinity.
    Distant {
        /// The direction *to* which the light travels; any length but zero.
        direction: DVec3,
        /// `I_j`.
        intensity: Color,
    },
    /// A spot light: a point light within a cone.
    Spot {
        /// The location.
        position: DVec3,
        /// The direction of the axis; any length but zero.
        direction: DVec3,
        /// `I_j` on the axis at a distance of 1.
        intensity: Color,
        /// Half-angle of the cone beyond which it is dark, in degrees, in (0, 180].
        cone_angle: f64,
        /// Half-angle of the cone of full intensity, in degrees, in [0, cone_angle].
        inner_angle: f64,
        /// The fading between both angles.
        edge: Edge,
        /// The falloff with distance.
        falloff: Falloff,
    },
    /// A projection light: a point light that projects an image.
    Projection {
        /// The image.
        image: ImageId,
        /// The interpolation between its texels; without levels of a MIP map.
        filter: TexelFilter,
        /// Its quantity.
        quantity: Projected,
        /// The factor of the image: `I_j` of a white texel, at a distance of 1.
        intensity: f32,
        /// Half-angles in degrees of a cone around the axis, beyond which it is dark, and of one in which it has full intensity; it
        /// fades by [`Edge::Linear`] between them. `None` without a cone.
        cone: Option<[f64; 2]>,
        /// Field of view along the image's shorter side, in degrees, in (0, 180).
        fov: f32,
        /// From the light's space, which looks along +z with y up and x to the right of the image; any invertible matrix.
        world_from_light: DMat4,
    },
    /// A goniometric light: a point light whose intensity depends on direction.
    Goniometric {
        /// `I_j` at a distance of 1 where the image is white.
        intensity: Color,
        /// Intensity by direction, in the octahedral equal-area map of [`Sky::Octahedral`]; the mean of the channels counts.
        image: ImageId,
        /// The interpolation between its texels; without levels of a MIP map.
        filter: TexelFilter,
        /// The transform from the light's space to the world.
        world_from_light: DMat4,
    },
    /// An environment light: radiance from all directions, at infinity.
    Environment {
        /// Its colours.
        sky: Sky,
        /// The corners of the only opening through which it is visible, in world space, in counter-clockwise order for a
        /// viewer who looks out. A rectangle (see [`is_rectangle`]).
        portal: Option<[DVec3; 4]>,
        /// Whether it illuminates surfaces; otherwise it is visible only to camera, reflected and refracted rays.
        illuminates: bool,
    },
}

impl LightKind {
    /// The word for the kind, in scene files and for people.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Ambient { .. } => "ambient",
            Self::Point { .. } => "point",
            Self::Distant { .. } => "distant",
            Self::Spot { .. } => "spot",
            Self::Projection { .. } => "projection",
            Self::Goniometric { .. } => "goniometric",
            Self::Environment { .. } => "environment",
        }
    }

    /// Whether it is seen under a solid angle, so that paths can meet it by chance.
    pub fn has_size(&self) -> bool {
        matches!(self, Self::Environment { .. } | Self::Ambient { .. })
    }
}

/// Whether four points are the corners of a rectangle, in order around it.
pub fn is_rectangle([a, b, c, d]: &[DVec3; 4]) -> bool {
    let (u, v) = (b - a, d - a);
    let is_parallelogram = (a - b + c - d).length() <= 1e-3 * (u.length() + v.length());
    let is_right = u.dot(v).abs() <= 1e-3 * u.length() * v.length();
    is_parallelogram && is_right && u.cross(v).length_squared() > 0.0 && u.cross(v).is_finite()
}

/// The fading of a spot light toward the edge of its cone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Edge {
    /// A smoothstep of the cosine of the angle to the axis, as in pbrt.
    #[default]
    Smooth,
    /// Linear in the angle, as in Mitsuba.
    Linear,
}

/// The quantity that the image of a projection light tells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Projected {
    /// Intensity by direction, as in pbrt.
    #[default]
    Intensity,
    /// The light on a plane across the axis at a distance of 1, as in Mitsuba: the intensity is 1/cos³ times that on the axis.
    Irradiance,
}

/// The falloff of light with the distance r from its source.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Falloff {
    /// No falloff, as in Whitted 1980.
    None,
    /// By 1/r.
    Linear,
    /// By 1/r², which is physically correct.
    #[default]
    Quadratic,
}

/// The colours of an environment.
#[derive(Clone, Debug, PartialEq)]
pub enum Sky {
    /// Constant in all directions.
    Constant(Color),
    /// By the height y of the unit direction: from `nadir` (y = −1) over `horizon` (0) to `zenith` (1), linear in y.
    Gradient {
        /// The colour straight up.
        zenith: [f32; 3],
        /// The colour at the horizon.
        horizon: [f32; 3],
        /// The colour straight down.
        nadir: [f32; 3],
    },
    /// An equirectangular environment map: row 0 is +y of the light's space; u = ½ is −z of the light's space, and u grows
    /// to the right of a viewer who looks there (towards +x).
    Image {
        /// The environment map.
        image: ImageId,
        /// Multiplies the map.
        scale: [f32; 3],
        /// The transform from the light's space to the world: a rotation.
        world_from_light: DMat4,
        /// The latitudes of its rows.
        rows: MapRows,
    },
    /// A square environment map in the equal-area octahedral mapping (Clarberg 2008), as in pbrt-v4: z of the light's space
    /// is the centre of the square.
    Octahedral {
        /// The environment map; square.
        image: ImageId,
        /// Multiplies the map.
        scale: [f32; 3],
        /// The transform from the light's space to the world: a rotation or reflection.
        world_from_light: DMat4,
    },
}

/// Latitudes of the rows of an equirectangular environment map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MapRows {
    /// Each row is the middle of a band; the bands fill the sphere.
    #[default]
    Bands,
    /// The first and last row are the poles, as in Mitsuba.
    ToPoles,
}

/// The fault of a picture as a map in latitude and longitude, by its shape; `None` if it may be one.
pub fn panorama_fault(image: &Image) -> Option<String> {
    let (width, height) = (u64::from(image.width), u64::from(image.height));
    // Some rows or columns may be missing.
    if width.abs_diff(2 * height) <= 2 + height / 50 {
        return None;
    }
    let kind = match () {
        () if width == height => {
            "a square one is an octahedral map (in a scene `layout = \"octahedral\"`), or a mirror ball or an angular map"
        }
        () if width == 6 * height || height == 6 * width => {
            "this one may be a strip of the six sides of a cube"
        }
        () if 3 * width == 4 * height || 4 * width == 3 * height => {
            "this one may be a cross of the six sides of a cube"
        }
        () => "this one may be a part of a panorama",
    };
    Some(format!(
        "a map in latitude and longitude is twice as wide as high, but this one is {width}×{height}, and it is stretched; {kind}. \
         Mirror balls, angular maps and cubes are not read: convert them first"
    ))
}
