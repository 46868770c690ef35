//! Lights that are not shapes. (A shape shines by `Shape::emission`.)
//!
//! Intensities have the meaning of Whitted's `I_j`: a white diffuse surface that faces the light is seen with that
//! radiance (for a light with fall-off: from a distance of 1). In radiometric units a point light of intensity `I`
//! radiates `π I` W/sr, a distant light gives `π I` W/m².

use glam::{DMat4, DVec3};

use crate::error::Location;
use crate::scene::ImageId;

/// A light.
#[derive(Clone, Debug)]
pub struct Light {
    /// Its name, where one was given.
    pub name: Option<String>,
    /// Where it was written.
    pub at: Location,
    /// What kind of light.
    pub kind: LightKind,
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
        /// Where.
        position: DVec3,
        /// `I_j` at a distance of 1.
        intensity: [f32; 3],
        /// How it fades.
        falloff: Falloff,
    },
    /// From infinitely far.
    Distant {
        /// Where the light goes *to*; any length but zero.
        direction: DVec3,
        /// `I_j`.
        intensity: [f32; 3],
    },
    /// From a point into a cone.
    Spot {
        /// Where.
        position: DVec3,
        /// Where the axis goes to; any length but zero.
        direction: DVec3,
        /// `I_j` on the axis at a distance of 1.
        intensity: [f32; 3],
        /// Half-angle beyond which it is dark, in degrees, in (0, 180].
        cone_angle: f64,
        /// Half-angle up to which it is full, in degrees, in [0, cone_angle]; a smooth step lies between.
        inner_angle: f64,
        /// How it fades.
        falloff: Falloff,
    },
    /// From all around, infinitely far.
    Environment {
        /// Its colours.
        sky: Sky,
        /// Whether it lights surfaces; otherwise it is only seen, by camera, mirrored and refracted rays.
        illuminates: bool,
    },
}

/// How light fades with the distance r from its source.
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
    Constant([f32; 3]),
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
        /// How the light's space is turned in the world: a rotation.
        world_from_light: DMat4,
    },
}
