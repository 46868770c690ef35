//! Light sources other than shapes. (Area lights are shapes with `Shape::emission`.)
//!
//! Intensities have the meaning of Whitted's `I_j`: a white diffuse surface that faces the light is seen with that
//! radiance (for a light with fall-off: from a distance of 1). In radiometric units a point light of intensity `I`
//! radiates `π I` W/sr, a distant light gives `π I` W/m².

use glam::{DMat4, DVec3};

use crate::error::Location;
use crate::material::Color;
use crate::scene::ImageId;

/// A light.
#[derive(Clone, Debug)]
pub struct Light {
    /// Its name, where one was given.
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
    /// The total before `scale`: the illuminance on a surface that faces it for distant lights
    /// and environments, else the power of all that is sent out, both in units whose white light of radiance 1 has
    /// luminance 1. `None` leaves the colour as bright as it is written.
    pub total: Option<f32>,
    /// Whether a curve's brightness counts; otherwise it is divided by its own luminance first, as colours are whose
    /// white has luminance 1.
    pub absolute: bool,
}

impl Power {
    /// As much as the colour says.
    pub const AS_WRITTEN: Self = Self { scale: 1.0, total: None, absolute: false };
}

impl Default for Power {
    fn default() -> Self {
        Self::AS_WRITTEN
    }
}

/// The lights there are.
#[derive(Clone, Debug, PartialEq)]
pub enum LightKind {
    /// Whitted's `I_a`: reaches everything from everywhere without a shadow.
    Ambient {
        /// `I_a`.
        color: [f32; 3],
    },
    /// From a point, the same to all sides.
    Point {
        /// The location.
        position: DVec3,
        /// `I_j` at a distance of 1.
        intensity: Color,
        /// The falloff with distance.
        falloff: Falloff,
    },
    /// From infinitely far.
    Distant {
        /// The direction *to* which the light travels; any length but zero.
        direction: DVec3,
        /// `I_j`.
        intensity: Color,
    },
    /// From a point into a cone.
    Spot {
        /// The location.
        position: DVec3,
        /// The direction of the axis; any length but zero.
        direction: DVec3,
        /// `I_j` on the axis at a distance of 1.
        intensity: Color,
        /// Half-angle beyond which it is dark, in degrees, in (0, 180].
        cone_angle: f64,
        /// Half-angle up to which it is full, in degrees, in [0, cone_angle]; a smooth step lies between.
        inner_angle: f64,
        /// The falloff with distance.
        falloff: Falloff,
    },
    /// From a point, a picture thrown into a rectangle.
    Projection {
        /// The picture.
        image: ImageId,
        /// `I_j` of a white texel, at a distance of 1.
        intensity: f32,
        /// Field of view along the picture's shorter side, in degrees, in (0, 180).
        fov: f32,
        /// The light's space: it looks along +z, y is up, x to the right of the picture. Any invertible matrix.
        world_from_light: DMat4,
    },
    /// From a point, more or less by direction.
    Goniometric {
        /// `I_j` at a distance of 1 where the picture is white.
        intensity: Color,
        /// By direction, in the octahedral equal-area square of [`Sky::Octahedral`]; only brightness counts.
        image: ImageId,
        /// The transform from the light's space to the world.
        world_from_light: DMat4,
    },
    /// From all around, infinitely far.
    Environment {
        /// Its colours.
        sky: Sky,
        /// The corners of the one opening through which it is seen (in the world), in order around it: against the clock
        /// for one who looks out. A rectangle (see [`is_rectangle`]).
        portal: Option<[DVec3; 4]>,
        /// Whether it lights surfaces; otherwise it is only seen, by camera, mirrored and refracted rays.
        illuminates: bool,
    },
}

/// Whether four points are the corners of a rectangle, one after the other.
pub fn is_rectangle([a, b, c, d]: &[DVec3; 4]) -> bool {
    let (u, v) = (b - a, d - a);
    let is_parallelogram = (a - b + c - d).length() <= 1e-3 * (u.length() + v.length());
    let is_right = u.dot(v).abs() <= 1e-3 * u.length() * v.length();
    is_parallelogram && is_right && u.cross(v).length_squared() > 0.0 && u.cross(v).is_finite()
}

/// The falloff of light with the distance r from its source.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Falloff {
    /// Not at all, as in Whitted 1980.
    None,
    /// By 1/r.
    Linear,
    /// By 1/r²: as nature does.
    #[default]
    Quadratic,
}

/// The colours of an environment.
#[derive(Clone, Debug, PartialEq)]
pub enum Sky {
    /// The same everywhere.
    Constant(Color),
    /// By the height y of the unit direction: from `nadir` (y = −1) over `horizon` (0) to `zenith` (1), linear in y.
    Gradient {
        /// Straight up.
        zenith: [f32; 3],
        /// All around.
        horizon: [f32; 3],
        /// Straight down.
        nadir: [f32; 3],
    },
    /// A picture in latitude and longitude: row 0 is +y of the light's space; u = ½ looks along −z of the light's
    /// space, and u grows to the right of one who looks there (towards +x).
    Image {
        /// The picture.
        image: ImageId,
        /// Multiplies it.
        scale: [f32; 3],
        /// The transform from the light's space to the world: a rotation.
        world_from_light: DMat4,
    },
    /// A square picture over the sphere of directions folded to an octahedron, of equal area (Clarberg 2008), as pbrt-v4
    /// has it: z of the light's space is the middle of the square.
    Octahedral {
        /// The picture; square.
        image: ImageId,
        /// Multiplies it.
        scale: [f32; 3],
        /// The transform from the light's space to the world: a rotation or reflection.
        world_from_light: DMat4,
    },
}
