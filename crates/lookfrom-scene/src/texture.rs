//! Colour over surfaces: pictures and patterns.

use glam::DMat4;

use crate::error::Location;
use crate::material::Color;
use crate::scene::ImageId;

/// A named texture.
#[derive(Clone, Debug)]
pub struct Texture {
    /// The name that materials use.
    pub name: String,
    /// Where it was written.
    pub at: Location,
    /// What kind of texture.
    pub kind: TextureKind,
}

/// The textures there are. A texture may use others, never (through any number of steps) itself: readers see to that.
#[derive(Clone, Debug, PartialEq)]
pub enum TextureKind {
    /// A picture over uv; v runs up, so v = 0 is the bottom row.
    Image {
        /// The picture.
        image: ImageId,
        /// uv is multiplied by this, then `offset` is added.
        scale: [f32; 2],
        /// Added to uv.
        offset: [f32; 2],
        /// What lies beyond the edges.
        wrap: Wrap,
        /// Between the texels.
        filter: TexelFilter,
        /// Whether 1 − value is meant.
        invert: bool,
    },
    /// Squares over uv, or cubes in space, of two colours.
    Checker {
        /// Where the sum of the whole parts is even.
        even: Color,
        /// Where it is odd.
        odd: Color,
        /// Where the pattern lives.
        mapping: Mapping,
    },
    /// Perlin noise of several octaves, between two colours.
    Noise {
        /// Where the noise is least.
        low: Color,
        /// Where it is greatest.
        high: Color,
        /// Number of octaves: 1 to 16.
        octaves: u32,
        /// Where the pattern lives.
        mapping: Mapping,
    },
    /// Veins: a sine along x, moved by turbulence (Perlin 1985), between two colours.
    Marble {
        /// In the veins.
        vein: Color,
        /// Between the veins.
        base: Color,
        /// Number of octaves: 1 to 16.
        octaves: u32,
        /// How far the turbulence moves the veins.
        turbulence: f32,
        /// Where the pattern lives.
        mapping: Mapping,
    },
    /// The mesh's own colours, white where it has none.
    VertexColor {
        /// Multiplies them.
        tint: [f32; 3],
    },
}

/// Where a pattern lives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mapping {
    /// On the surface: uv times `scale`.
    Uv {
        /// Repetitions in u and v.
        scale: [f32; 2],
    },
    /// In space: the pattern's coordinates are `texture_from_world` times the point in the world.
    World {
        /// To the pattern's space.
        texture_from_world: DMat4,
    },
}

/// What lies beyond the edges of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The picture again.
    #[default]
    Repeat,
    /// The picture mirrored.
    Mirror,
    /// The last texel.
    Clamp,
    /// Black.
    Black,
}

/// What is between the texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TexelFilter {
    /// A blend of the four around.
    #[default]
    Bilinear,
    /// The nearest one.
    Nearest,
}
