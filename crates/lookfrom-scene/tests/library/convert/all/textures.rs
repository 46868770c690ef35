//! Scenes with each texture and mapping.

use glam::{DMat4, DVec3, DVec4, Vec3};
use lookfrom_scene::Scene;
use lookfrom_scene::material::{Color, MaterialKind, Scalar};
use lookfrom_scene::scene::{ImageId, TextureId};
use lookfrom_scene::texture::{Channel, Mapping, MipFilter, TexelFilter, Texture, TextureKind, Wrap};

use super::{COLOR, TEXTURE, each, here, shear, unit};

/// Puts a texture as the reflectance of the sphere.
fn put_texture(scene: &mut Scene, kind: TextureKind) {
    scene.textures.push(Texture { name: "made".to_owned(), at: here(), kind });
    scene.materials[0].kind = MaterialKind::Diffuse { reflectance: Color::Texture(TextureId(1)) };
}

fn image(image: u32, filter: TexelFilter, channel: Channel) -> TextureKind {
    TextureKind::Image {
        image: ImageId(image),
        mapping: Mapping::Uv { scale: [2.0, 3.0], offset: [0.5, -0.25] },
        wrap: [Wrap::Clamp, Wrap::Mirror],
        filter,
        channel,
        scale: 0.5,
        invert: true,
    }
}

pub(super) fn textures() -> Vec<(String, Scene)> {
    let (low, high) = (Color::Value([0.1, 0.9, 0.3]), COLOR);
    let mapping = Mapping::World { texture_from_world: DMat4::from_scale(DVec3::splat(4.0)) };
    let mip = |filter| TexelFilter::Mip { filter, footprint: 0.5 };
    let variants = vec![
        image(0, TexelFilter::Bilinear, Channel::Rgb),
        image(1, TexelFilter::Nearest, Channel::Red),
        image(2, mip(MipFilter::Nearest), Channel::Green),
        image(3, mip(MipFilter::Bilinear), Channel::Blue),
        image(1, mip(MipFilter::Trilinear), Channel::Alpha),
        image(0, mip(MipFilter::Ewa { anisotropy: 16.0 }), Channel::Rgb),
        TextureKind::Image {
            image: ImageId(0),
            mapping: Mapping::UV,
            wrap: [Wrap::Black; 2],
            filter: TexelFilter::Bilinear,
            channel: Channel::Rgb,
            scale: 1.0,
            invert: false,
        },
        TextureKind::Checker { even: low, odd: high, footprint: 0.5, mapping: Mapping::UV },
        TextureKind::Noise { low, high, octaves: 7, mapping },
        TextureKind::Marble { vein: low, base: high, octaves: 5, turbulence: 0.5, mapping },
        TextureKind::Scale { color: high, by: TEXTURE },
        TextureKind::Mix { low, high, amount: Scalar::Value(0.25) },
        TextureKind::DirectionMix { low, high, direction: unit() },
        TextureKind::Bilinear { corners: [low, high, Color::BLACK, Color::gray(0.5)], mapping: Mapping::UV },
        TextureKind::Dots { inside: low, outside: high, mapping: Mapping::UV },
        TextureKind::Fbm { octaves: 3, roughness: 0.25, footprint: 0.5, mapping },
        TextureKind::Wrinkled { octaves: 3, roughness: 0.25, footprint: 0.5, mapping },
        TextureKind::Windy { footprint: 0.5, mapping },
        TextureKind::PbrtMarble {
            octaves: 3,
            roughness: 0.25,
            scale: 2.0,
            variation: 0.5,
            footprint: 0.5,
            mapping,
        },
        TextureKind::VertexColor { tint: [0.5, 0.25, 1.0] },
        TextureKind::VertexAlpha,
        TextureKind::Product { a: low, b: high },
        TextureKind::Threshold { value: TEXTURE, edge: 0.25 },
        TextureKind::Sides { outside: low, inside: high },
        TextureKind::Quotient { a: TEXTURE, b: Scalar::Value(0.5) },
    ];
    let index = |kind: &TextureKind| match kind {
        TextureKind::Image { .. } => 0,
        TextureKind::Checker { .. } => 1,
        TextureKind::Noise { .. } => 2,
        TextureKind::Marble { .. } => 3,
        TextureKind::Scale { .. } => 4,
        TextureKind::Mix { .. } => 5,
        TextureKind::DirectionMix { .. } => 6,
        TextureKind::Bilinear { .. } => 7,
        TextureKind::Dots { .. } => 8,
        TextureKind::Fbm { .. } => 9,
        TextureKind::Wrinkled { .. } => 10,
        TextureKind::Windy { .. } => 11,
        TextureKind::PbrtMarble { .. } => 12,
        TextureKind::VertexColor { .. } => 13,
        TextureKind::VertexAlpha => 14,
        TextureKind::Product { .. } => 15,
        TextureKind::Threshold { .. } => 16,
        TextureKind::Sides { .. } => 17,
        TextureKind::Quotient { .. } => 18,
    };
    each("texture", variants, index, put_texture)
}

pub(super) fn mappings() -> Vec<(String, Scene)> {
    let texture_from_world = shear();
    let turned = DMat4::from_cols(DVec4::X, DVec4::Z, -DVec4::Y, DVec4::W);
    let variants = vec![
        Mapping::UV,
        Mapping::Affine { set: 2, matrix: [[1.0, 0.5, 0.25], [-0.5, 1.0, 0.1]] },
        Mapping::Spherical { texture_from_world },
        Mapping::Spherical { texture_from_world: turned * DMat4::IDENTITY },
        Mapping::Cylindrical { texture_from_world },
        Mapping::Planar { texture_from_world, axes: [unit(), Vec3::Z], offset: [0.25, 0.5] },
        Mapping::World { texture_from_world },
        Mapping::World { texture_from_world: DMat4::IDENTITY },
    ];
    let index = |mapping: &Mapping| match mapping {
        Mapping::Uv { .. } => 0,
        Mapping::Affine { .. } => 1,
        Mapping::Spherical { .. } => 2,
        Mapping::Cylindrical { .. } => 3,
        Mapping::Planar { .. } => 4,
        Mapping::World { .. } => 5,
    };
    each("mapping", variants, index, |scene, mapping| {
        let (even, odd) = (Color::gray(0.25), Color::gray(0.5));
        put_texture(scene, TextureKind::Checker { even, odd, footprint: 0.0, mapping });
    })
}
