//! Compiled textures: nodes of a graph whose leaves are constants, curves and images.

use glam::Vec3;
use lookfrom_scene::image::Image;
use lookfrom_scene::material::{Color, Scalar};
use lookfrom_scene::texture::{Channel, Mapping, TextureKind};

use super::input::{FloatTexture, Input};
use super::look_ups::Picture;

/// A texture with the parameters of its [`TextureKind`].
#[derive(Clone, Debug)]
pub(super) enum Node {
    Image {
        /// Index of the picture.
        picture: u32,
        channel: Channel,
        scale: f32,
        invert: bool,
    },
    Checker {
        even: Input,
        odd: Input,
        footprint: f32,
        mapping: Mapping,
    },
    Noise {
        low: Input,
        high: Input,
        octaves: u32,
        mapping: Mapping,
    },
    Marble {
        vein: Input,
        base: Input,
        octaves: u32,
        turbulence: f32,
        mapping: Mapping,
    },
    Scale {
        color: Input,
        by: FloatTexture,
    },
    Mix {
        low: Input,
        high: Input,
        amount: FloatTexture,
    },
    DirectionMix {
        low: Input,
        high: Input,
        direction: Vec3,
    },
    Sides {
        outside: Input,
        inside: Input,
    },
    Bilinear {
        corners: [Input; 4],
        mapping: Mapping,
    },
    Dots {
        inside: Input,
        outside: Input,
        mapping: Mapping,
    },
    Fbm {
        octaves: u32,
        roughness: f32,
        footprint: f32,
        mapping: Mapping,
    },
    Wrinkled {
        octaves: u32,
        roughness: f32,
        footprint: f32,
        mapping: Mapping,
    },
    Windy {
        footprint: f32,
        mapping: Mapping,
    },
    PbrtMarble {
        octaves: u32,
        roughness: f32,
        scale: f32,
        variation: f32,
        footprint: f32,
        mapping: Mapping,
    },
    VertexColor {
        tint: [f32; 3],
    },
    VertexAlpha,
    Product {
        a: Input,
        b: Input,
    },
    Threshold {
        value: FloatTexture,
        edge: f32,
    },
    Quotient {
        a: FloatTexture,
        b: FloatTexture,
    },
}

impl Node {
    /// Every texture of a scene, in the same order, and the pictures that they read, of `images`; `uplifts` where spectra
    /// will be evaluated.
    pub(super) fn compile_all(
        kinds: &[TextureKind],
        images: &[Image],
        uplifts: bool,
    ) -> (Vec<Self>, Vec<Picture>) {
        let mut pictures = Vec::new();
        let nodes = (0..kinds.len())
            .map(|index| match scaled_picture(kinds, index) {
                Some(picture) => Self::compile(&picture, images, &mut pictures, uplifts),
                None => Self::compile(&kinds[index], images, &mut pictures, uplifts),
            })
            .collect();
        (nodes, pictures)
    }

    fn compile(kind: &TextureKind, images: &[Image], pictures: &mut Vec<Picture>, uplifts: bool) -> Self {
        let input = |color: Color| Input::new(color, uplifts);
        match *kind {
            TextureKind::Image { image, mapping, wrap, filter, channel, scale, invert } => {
                let picture = Picture::new(image.index(), mapping, wrap, filter, images);
                // Textures of one picture follow one another.
                let known = pictures.iter().rposition(|known| *known == picture).unwrap_or_else(|| {
                    pictures.push(picture);
                    pictures.len() - 1
                });
                Self::Image { picture: known as u32, channel, scale, invert }
            }
            TextureKind::Checker { even, odd, footprint, mapping } => {
                Self::Checker { even: input(even), odd: input(odd), footprint, mapping }
            }
            TextureKind::Noise { low, high, octaves, mapping } => {
                Self::Noise { low: input(low), high: input(high), octaves, mapping }
            }
            TextureKind::Marble { vein, base, octaves, turbulence, mapping } => {
                Self::Marble { vein: input(vein), base: input(base), octaves, turbulence, mapping }
            }
            TextureKind::Scale { color, by } => Self::Scale { color: input(color), by: by.into() },
            TextureKind::Mix { low, high, amount } => {
                Self::Mix { low: input(low), high: input(high), amount: amount.into() }
            }
            TextureKind::DirectionMix { low, high, direction } => {
                Self::DirectionMix { low: input(low), high: input(high), direction }
            }
            TextureKind::Sides { outside, inside } => {
                Self::Sides { outside: input(outside), inside: input(inside) }
            }
            TextureKind::Bilinear { corners, mapping } => {
                Self::Bilinear { corners: corners.map(input), mapping }
            }
            TextureKind::Dots { inside, outside, mapping } => {
                Self::Dots { inside: input(inside), outside: input(outside), mapping }
            }
            TextureKind::Fbm { octaves, roughness, footprint, mapping } => {
                Self::Fbm { octaves, roughness, footprint, mapping }
            }
            TextureKind::Wrinkled { octaves, roughness, footprint, mapping } => {
                Self::Wrinkled { octaves, roughness, footprint, mapping }
            }
            TextureKind::Windy { footprint, mapping } => Self::Windy { footprint, mapping },
            TextureKind::PbrtMarble { octaves, roughness, scale, variation, footprint, mapping } => {
                Self::PbrtMarble { octaves, roughness, scale, variation, footprint, mapping }
            }
            TextureKind::VertexColor { tint } => Self::VertexColor { tint },
            TextureKind::VertexAlpha => Self::VertexAlpha,
            TextureKind::Product { a, b } => Self::Product { a: input(a), b: input(b) },
            TextureKind::Threshold { value, edge } => Self::Threshold { value: value.into(), edge },
            TextureKind::Quotient { a, b } => Self::Quotient { a: a.into(), b: b.into() },
        }
    }
}

/// Folds constant scales into an image texture, as pbrt-v4 does, where an albedo beyond 1 is clamped (and an image
/// inverted) after the scale. `None` for any other texture.
fn scaled_picture(kinds: &[TextureKind], index: usize) -> Option<TextureKind> {
    let mut factor = 1.0;
    let mut kind = &kinds[index];
    while let TextureKind::Scale { color: Color::Texture(id), by: Scalar::Value(by) } = kind {
        factor *= by;
        kind = &kinds[id.index()];
    }
    let mut picture = kind.clone();
    match &mut picture {
        TextureKind::Image { scale, .. } if factor != 1.0 => *scale *= factor,
        TextureKind::Image { .. } => {}
        _ => return None,
    }
    Some(picture)
}
