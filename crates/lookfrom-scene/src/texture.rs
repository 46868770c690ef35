//! Textures: images and procedural patterns, their mappings and sampling.

use glam::{DMat4, Vec3};

use crate::error::Location;
use crate::material::{Color, Scalar};
use crate::scene::ImageId;

/// A named texture.
#[derive(Clone, Debug)]
pub struct Texture {
    /// The name that materials use.
    pub name: String,
    /// The location in the file.
    pub at: Location,
    /// The kind of texture.
    pub kind: TextureKind,
}

/// The textures there are. A texture may use others, never (through any number of steps) itself: readers see to that.
#[derive(Clone, Debug, PartialEq)]
pub enum TextureKind {
    /// A picture; v runs up, so v = 0 is the bottom row.
    Image {
        /// The picture.
        image: ImageId,
        /// The mapping; its x and y are s and t of the picture.
        mapping: Mapping,
        /// The wrap modes beyond the left and right, and beyond the upper and lower edges.
        wrap: [Wrap; 2],
        /// Between the texels.
        filter: TexelFilter,
        /// The channels that are read.
        channel: Channel,
        /// Multiplies it.
        scale: f32,
        /// Whether the value is inverted to 1 − value (after `scale`).
        invert: bool,
    },
    /// Squares over uv, or cubes in space, of two colours.
    Checker {
        /// The value where the sum of the integer parts is even.
        even: Color,
        /// The value where it is odd.
        odd: Color,
        /// The mapping.
        mapping: Mapping,
    },
    /// Perlin noise of several octaves, between two colours.
    Noise {
        /// The value where the noise is least.
        low: Color,
        /// The value where it is greatest.
        high: Color,
        /// Number of octaves: 1 to 16.
        octaves: u32,
        /// The mapping.
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
        /// The displacement of the veins by turbulence.
        turbulence: f32,
        /// The mapping.
        mapping: Mapping,
    },
    /// A texture, more or less.
    Scale {
        /// The texture that is scaled.
        color: Color,
        /// By how much.
        by: Scalar,
    },
    /// Between two colours.
    Mix {
        /// At 0.
        low: Color,
        /// At 1.
        high: Color,
        /// The interpolation parameter, not clamped.
        amount: Scalar,
    },
    /// Between two colours, by how much the geometric normal looks along a direction of the world.
    DirectionMix {
        /// The value where the normal is perpendicular to the direction.
        low: Color,
        /// The value where the normal is parallel to the direction.
        high: Color,
        /// Of unit length.
        direction: Vec3,
    },
    /// Linear in u and v between four corners.
    Bilinear {
        /// At (0,0), (0,1), (1,0), (1,1).
        corners: [Color; 4],
        /// The mapping.
        mapping: Mapping,
    },
    /// Round dots in some cells of a grid over uv.
    Dots {
        /// In the dots.
        inside: Color,
        /// Around them.
        outside: Color,
        /// The mapping.
        mapping: Mapping,
    },
    /// pbrt's `fbm`: Perlin noise of several octaves, as a number around 0.
    Fbm {
        /// Number of octaves: 1 to 16.
        octaves: u32,
        /// The persistence: the ratio of amplitudes of successive octaves.
        roughness: f32,
        /// The mapping.
        mapping: Mapping,
    },
    /// pbrt's `wrinkled`: the same of absolute values.
    Wrinkled {
        /// Number of octaves: 1 to 16.
        octaves: u32,
        /// The persistence: the ratio of amplitudes of successive octaves.
        roughness: f32,
        /// The mapping.
        mapping: Mapping,
    },
    /// pbrt's `windy`: waves on water, by two noises.
    Windy {
        /// The mapping.
        mapping: Mapping,
    },
    /// pbrt's `marble`: its own palette of colours along noisy veins.
    PbrtMarble {
        /// Number of octaves: 1 to 16.
        octaves: u32,
        /// The persistence: the ratio of amplitudes of successive octaves.
        roughness: f32,
        /// Multiplies places before the noise.
        scale: f32,
        /// The displacement of the veins by noise.
        variation: f32,
        /// The mapping.
        mapping: Mapping,
    },
    /// The mesh's own colours, white where it has none.
    VertexColor {
        /// Multiplies them.
        tint: [f32; 3],
    },
    /// The mesh's own opacity, 1 where it has none.
    VertexAlpha,
    /// One times the other, channel by channel.
    Product {
        /// One.
        a: Color,
        /// The other.
        b: Color,
    },
    /// 1 where a number reaches an edge, else 0.
    Threshold {
        /// The number.
        value: Scalar,
        /// The edge.
        edge: f32,
    },
}

/// The channels of a picture that a texture reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Channel {
    /// The colour.
    #[default]
    Rgb,
    /// Its red, as a grey.
    Red,
    /// Its green.
    Green,
    /// Its blue.
    Blue,
    /// Its opacity, 1 where the picture has none.
    Alpha,
}

impl TextureKind {
    /// The colours that its places have, or lie between; none where they are only factors of others.
    pub fn colors(&self) -> Vec<Color> {
        match self {
            Self::Checker { even: a, odd: b, .. }
            | Self::Noise { low: a, high: b, .. }
            | Self::Marble { vein: a, base: b, .. }
            | Self::DirectionMix { low: a, high: b, .. }
            | Self::Mix { low: a, high: b, .. }
            | Self::Dots { inside: a, outside: b, .. } => vec![*a, *b],
            Self::Bilinear { corners, .. } => corners.to_vec(),
            _ => Vec::new(),
        }
    }

    /// The textures and colours that this texture uses; textures of numbers are given as colours.
    pub fn parts(&self) -> Vec<Color> {
        let scalar = |scalar: &Scalar| match *scalar {
            Scalar::Value(value) => Color::gray(value),
            Scalar::Texture(id) => Color::Texture(id),
        };
        match self {
            Self::Checker { even: a, odd: b, .. }
            | Self::Noise { low: a, high: b, .. }
            | Self::Marble { vein: a, base: b, .. }
            | Self::DirectionMix { low: a, high: b, .. }
            | Self::Product { a, b }
            | Self::Dots { inside: a, outside: b, .. } => vec![*a, *b],
            Self::Scale { color, by } => vec![*color, scalar(by)],
            Self::Mix { low, high, amount } => vec![*low, *high, scalar(amount)],
            Self::Bilinear { corners, .. } => corners.to_vec(),
            Self::Image { .. }
            | Self::Fbm { .. }
            | Self::Wrinkled { .. }
            | Self::Windy { .. }
            | Self::PbrtMarble { .. }
            | Self::VertexAlpha
            | Self::VertexColor { .. } => Vec::new(),
            Self::Threshold { value, .. } => vec![scalar(value)],
        }
    }
}

/// The mapping of a pattern: from a surface point to texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mapping {
    /// On the surface: uv times `scale` plus `offset`.
    Uv {
        /// Repetitions in u and v.
        scale: [f32; 2],
        /// Added afterwards.
        offset: [f32; 2],
    },
    /// On the surface: a set of texture coordinates (0 is the first), turned, scaled and moved.
    Affine {
        /// The set of texture coordinates; one that the mesh does not have is (0, 0) everywhere.
        set: u32,
        /// Rows: s and t are these, dotted with (u, v, 1).
        matrix: [[f32; 3]; 2],
    },
    /// By the direction from the origin of the texture's space: (θ/π, φ/2π), θ from +z, φ from +x toward +y.
    Spherical {
        /// From the world.
        texture_from_world: DMat4,
    },
    /// Around the z axis of the texture's space: (φ/2π, z), φ from −x by way of −y.
    Cylindrical {
        /// From the world.
        texture_from_world: DMat4,
    },
    /// Along two vectors of the texture's space.
    Planar {
        /// From the world.
        texture_from_world: DMat4,
        /// Dotted with the place, they give u and v …
        axes: [Vec3; 2],
        /// … after this is added.
        offset: [f32; 2],
    },
    /// In space: the pattern's coordinates are `texture_from_world` times the point in the world.
    World {
        /// To the pattern's space.
        texture_from_world: DMat4,
    },
}

impl Mapping {
    /// uv as they are.
    pub const UV: Self = Self::Uv { scale: [1.0; 2], offset: [0.0; 2] };
}

/// The wrap mode beyond the edges of a picture.
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

/// The interpolation between texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TexelFilter {
    /// A blend of the four around.
    #[default]
    Bilinear,
    /// The nearest one.
    Nearest,
}
