//! Textures: images and procedural patterns, their mappings and sampling.

mod filter;

use glam::{DMat4, Vec3};

use crate::error::Location;
use crate::material::{Color, Scalar};
use crate::scene::{ImageId, TextureId};

pub use self::filter::{MipFilter, TexelFilter};

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

/// The kinds of textures. A texture may use others, but never itself, directly or indirectly: readers ensure that.
#[derive(Clone, Debug, PartialEq)]
pub enum TextureKind {
    /// An image; v runs up, so v = 0 is the bottom row.
    Image {
        /// The image.
        image: ImageId,
        /// The mapping; its x and y are s and t of the image.
        mapping: Mapping,
        /// The wrap modes beyond the left and right, and beyond the upper and lower edges.
        wrap: [Wrap; 2],
        /// The interpolation between texels.
        filter: TexelFilter,
        /// The channels that are read.
        channel: Channel,
        /// Multiplies the value.
        scale: f32,
        /// Whether the value is inverted to 1 − value (after `scale`).
        invert: bool,
    },
    /// A checkerboard of squares over uv, or of cubes in space.
    Checker {
        /// The value where the sum of the integer parts is even.
        even: Color,
        /// The value where it is odd.
        odd: Color,
        /// The width that is averaged, in pixels; 0 for none.
        footprint: f32,
        /// The mapping.
        mapping: Mapping,
    },
    /// Perlin noise of several octaves, between two colours.
    Noise {
        /// The value where the noise is minimal.
        low: Color,
        /// The value where it is maximal.
        high: Color,
        /// Number of octaves: 1 to 16.
        octaves: u32,
        /// The mapping.
        mapping: Mapping,
    },
    /// Marble veins: a sine along x, displaced by turbulence (Perlin 1985), between two colours.
    Marble {
        /// The value in the veins.
        vein: Color,
        /// The value between the veins.
        base: Color,
        /// Number of octaves: 1 to 16.
        octaves: u32,
        /// The displacement of the veins by turbulence.
        turbulence: f32,
        /// The mapping.
        mapping: Mapping,
    },
    /// A texture multiplied by a factor.
    Scale {
        /// The texture that is scaled.
        color: Color,
        /// The factor.
        by: Scalar,
    },
    /// Interpolation between two colours.
    Mix {
        /// The value at 0.
        low: Color,
        /// The value at 1.
        high: Color,
        /// The interpolation parameter, not clamped.
        amount: Scalar,
    },
    /// Interpolation between two colours, by the angle between the geometric normal and a direction in world space.
    DirectionMix {
        /// The value where the normal is perpendicular to the direction.
        low: Color,
        /// The value where the normal is parallel to the direction.
        high: Color,
        /// The direction, of unit length.
        direction: Vec3,
    },
    /// Another colour for each side of a surface.
    Sides {
        /// The value where it is seen from the outside, the side of its geometric normal.
        outside: Color,
        /// The value where it is seen from the inside.
        inside: Color,
    },
    /// Bilinear interpolation in u and v between four corners.
    Bilinear {
        /// The values at (0,0), (0,1), (1,0), (1,1).
        corners: [Color; 4],
        /// The mapping.
        mapping: Mapping,
    },
    /// Round dots in some cells of a grid over uv.
    Dots {
        /// The value in the dots.
        inside: Color,
        /// The value around them.
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
        /// The width of the detail that is left out, in pixels: octaves that are finer; 0 for none.
        footprint: f32,
        /// The mapping.
        mapping: Mapping,
    },
    /// pbrt's `wrinkled`: the same with absolute values of the noise.
    Wrinkled {
        /// Number of octaves: 1 to 16.
        octaves: u32,
        /// The persistence: the ratio of amplitudes of successive octaves.
        roughness: f32,
        /// As of `Fbm`.
        footprint: f32,
        /// The mapping.
        mapping: Mapping,
    },
    /// pbrt's `windy`: water waves from two noises.
    Windy {
        /// As of `Fbm`.
        footprint: f32,
        /// The mapping.
        mapping: Mapping,
    },
    /// pbrt's `marble`: a fixed palette of colours along noisy veins.
    PbrtMarble {
        /// Number of octaves: 1 to 16.
        octaves: u32,
        /// The persistence: the ratio of amplitudes of successive octaves.
        roughness: f32,
        /// Multiplies positions before the noise.
        scale: f32,
        /// The displacement of the veins by noise.
        variation: f32,
        /// As of `Fbm`.
        footprint: f32,
        /// The mapping.
        mapping: Mapping,
    },
    /// The mesh's vertex colours, white if it has none.
    VertexColor {
        /// Multiplies them.
        tint: [f32; 3],
    },
    /// The mesh's vertex opacities, 1 if it has none.
    VertexAlpha,
    /// The product of two textures, channel by channel.
    Product {
        /// The first factor.
        a: Color,
        /// The second factor.
        b: Color,
    },
    /// 1 where a number is at least the threshold, else 0.
    Threshold {
        /// The number.
        value: Scalar,
        /// The threshold.
        edge: f32,
    },
    /// One number divided by another; 0 where that is 0.
    Quotient {
        /// The dividend.
        a: Scalar,
        /// The divisor.
        b: Scalar,
    },
}

/// The channels of an image that a texture reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Channel {
    /// The colour.
    #[default]
    Rgb,
    /// Red, as a grey.
    Red,
    /// Green, as a grey.
    Green,
    /// Blue, as a grey.
    Blue,
    /// Opacity as a grey, 1 if the image has none.
    Alpha,
}

impl TextureKind {
    /// Octaves of pbrt's noises where a file does not set them.
    pub const OCTAVES: u32 = 8;
    /// Persistence of pbrt's noises where a file does not set it.
    pub const ROUGHNESS: f32 = 0.5;
    /// Interpolation parameter of a mix where a file does not set it.
    pub const MIX_AMOUNT: f32 = 0.5;

    /// The product of two numbers.
    pub fn product(a: Scalar, b: Scalar) -> Self {
        Self::Product { a: a.into(), b: b.into() }
    }

    /// The colours between which the texture's values lie; empty for textures that only combine others.
    pub fn colors(&self) -> Vec<Color> {
        match self {
            Self::Checker { even: a, odd: b, .. }
            | Self::Noise { low: a, high: b, .. }
            | Self::Marble { vein: a, base: b, .. }
            | Self::DirectionMix { low: a, high: b, .. }
            | Self::Mix { low: a, high: b, .. }
            | Self::Sides { outside: a, inside: b }
            | Self::Dots { inside: a, outside: b, .. } => vec![*a, *b],
            Self::Bilinear { corners, .. } => corners.to_vec(),
            _ => Vec::new(),
        }
    }

    /// Whether the texture itself, not the ones that it uses, depends on the footprint of pixels.
    pub fn has_footprint(&self) -> bool {
        match self {
            Self::Image { filter, .. } => filter.takes_levels(),
            Self::Checker { footprint, .. }
            | Self::Fbm { footprint, .. }
            | Self::Wrinkled { footprint, .. }
            | Self::Windy { footprint, .. }
            | Self::PbrtMarble { footprint, .. } => *footprint > 0.0,
            _ => false,
        }
    }

    /// By texture: whether it depends on the footprint of pixels, itself or by what it uses. The graph has no circles.
    pub fn need_footprints(kinds: &[Self]) -> Vec<bool> {
        let mut known: Vec<bool> = kinds.iter().map(Self::has_footprint).collect();
        let mut has_changed = known.contains(&true);
        while has_changed {
            has_changed = false;
            for (index, kind) in kinds.iter().enumerate().filter(|(_, kind)| !kind.has_footprint()) {
                let uses_one =
                    |part: &Color| matches!(part, Color::Texture(TextureId(id)) if known[*id as usize]);
                if !known[index] && kind.parts().iter().any(uses_one) {
                    (known[index], has_changed) = (true, true);
                }
            }
        }
        known
    }

    /// The textures and colours that this texture uses; float textures are given as colours.
    pub fn parts(&self) -> Vec<Color> {
        let scalar = |scalar: &Scalar| Color::from(*scalar);
        match self {
            Self::Checker { even: a, odd: b, .. }
            | Self::Noise { low: a, high: b, .. }
            | Self::Marble { vein: a, base: b, .. }
            | Self::DirectionMix { low: a, high: b, .. }
            | Self::Product { a, b }
            | Self::Sides { outside: a, inside: b }
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
            Self::Quotient { a, b } => vec![scalar(a), scalar(b)],
        }
    }
}

/// The mapping of a pattern: from a surface point to texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mapping {
    /// Surface coordinates: uv times `scale` plus `offset`.
    Uv {
        /// Repetitions in u and v.
        scale: [f32; 2],
        /// Added afterwards.
        offset: [f32; 2],
    },
    /// An affine map of a set of texture coordinates (0 is the first).
    Affine {
        /// The set of texture coordinates; (0, 0) everywhere if the mesh does not have it.
        set: u32,
        /// Rows: s and t are their dot products with (u, v, 1).
        matrix: [[f32; 3]; 2],
    },
    /// By the direction from the origin of texture space: (θ/π, φ/2π), θ from +z, φ from +x toward +y.
    Spherical {
        /// The transform from world to texture space.
        texture_from_world: DMat4,
    },
    /// Around the z axis of texture space: (φ/2π, z), φ from −x via −y.
    Cylindrical {
        /// The transform from world to texture space.
        texture_from_world: DMat4,
    },
    /// Planar projection along two vectors of texture space.
    Planar {
        /// The transform from world to texture space.
        texture_from_world: DMat4,
        /// Vectors whose dot products with the position are u and v …
        axes: [Vec3; 2],
        /// … after this is added.
        offset: [f32; 2],
    },
    /// 3D coordinates: `texture_from_world` times the position in world space.
    World {
        /// The transform from world to texture space.
        texture_from_world: DMat4,
    },
}

impl Mapping {
    /// uv unchanged.
    pub const UV: Self = Self::Uv { scale: [1.0; 2], offset: [0.0; 2] };
}

/// The wrap mode beyond the edges of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The image is repeated.
    #[default]
    Repeat,
    /// The image is repeated, every other copy mirrored.
    Mirror,
    /// The edge texels are repeated.
    Clamp,
    /// Black.
    Black,
}
