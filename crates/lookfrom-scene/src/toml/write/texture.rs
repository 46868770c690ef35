//! Textures and their mappings.

use glam::{DMat4, DVec3, Vec3};

use super::Writer;
use super::color::{Of, plain_color};
use super::picture::For;
use super::placing::{put_matrix, same_bits};
use super::text::{Fields, Item};
use crate::error::Result;
use crate::material::Color;
use crate::scene::ImageId;
use crate::texture::{Channel, Mapping, MipFilter, TexelFilter, TextureKind, Wrap};
use crate::toml::mapping::pole_on_z;
use crate::toml::texture::{CHANNELS, FILTERS, WRAPS};
use crate::toml::word_of;

impl Writer<'_> {
    pub(super) fn texture(&mut self, kind: &TextureKind) -> Result<Fields> {
        let mut fields = Fields::default();
        match kind {
            TextureKind::Image { image, mapping, wrap, filter, channel, scale, invert } => {
                fields.put("type", "image");
                self.image_texture(&mut fields, *image, *channel)?;
                put_wrap(&mut fields, *wrap);
                put_filter(&mut fields, *filter);
                fields.put_unless("multiply", *scale, 1.0);
                fields.put_unless("invert", *invert, false);
                put_mapping(&mut fields, mapping, "uv");
            }
            TextureKind::Checker { even, odd, footprint, mapping } => {
                self.two(&mut fields, "checker", [("even", *even, 0.9), ("odd", *odd, 0.1)])?;
                fields.put_unless("footprint", *footprint, 0.0);
                put_mapping(&mut fields, mapping, "uv");
            }
            TextureKind::Noise { low, high, octaves, mapping } => {
                self.two(&mut fields, "noise", [("low", *low, 0.0), ("high", *high, 1.0)])?;
                fields.put_unless("octaves", *octaves, 4);
                put_mapping(&mut fields, mapping, "world");
            }
            TextureKind::Marble { vein, base, octaves, turbulence, mapping } => {
                self.two(&mut fields, "marble", [("vein", *vein, 0.1), ("base", *base, 0.9)])?;
                fields.put_unless("octaves", *octaves, 6);
                fields.put_unless("turbulence", *turbulence, 1.5);
                put_mapping(&mut fields, mapping, "world");
            }
            TextureKind::Scale { color, by } => {
                fields.put("type", "scale");
                let color = self.color(*color, Of::Color)?;
                fields.put("color", color);
                fields.put("by", self.scalar(*by));
            }
            TextureKind::Mix { low, high, amount } => {
                self.two(&mut fields, "mix", [("low", *low, 0.0), ("high", *high, 1.0)])?;
                self.put_scalar(&mut fields, "amount", *amount, TextureKind::MIX_AMOUNT);
            }
            TextureKind::DirectionMix { low, high, direction } => {
                self.two(&mut fields, "direction_mix", [("low", *low, 0.0), ("high", *high, 1.0)])?;
                fields.put("direction", direction.to_array().map(Item::exact));
            }
            TextureKind::Sides { outside, inside } => {
                self.two(&mut fields, "sides", [("outside", *outside, 0.0), ("inside", *inside, 1.0)])?;
            }
            TextureKind::Bilinear { corners, mapping } => {
                fields.put("type", "bilinear");
                let corners = corners
                    .iter()
                    .map(|corner| self.color(*corner, Of::Color))
                    .collect::<Result<Vec<_>>>()?;
                fields.put("corners", Item::List(corners));
                put_mapping(&mut fields, mapping, "uv");
            }
            TextureKind::Dots { inside, outside, mapping } => {
                self.two(&mut fields, "dots", [("inside", *inside, 0.9), ("outside", *outside, 0.1)])?;
                put_mapping(&mut fields, mapping, "uv");
            }
            TextureKind::Fbm { octaves, roughness, footprint, mapping } => {
                put_noise(&mut fields, "fbm", *octaves, *roughness, *footprint);
                put_mapping(&mut fields, mapping, "world");
            }
            TextureKind::Wrinkled { octaves, roughness, footprint, mapping } => {
                put_noise(&mut fields, "wrinkled", *octaves, *roughness, *footprint);
                put_mapping(&mut fields, mapping, "world");
            }
            TextureKind::Windy { footprint, mapping } => {
                fields.put("type", "windy");
                fields.put_unless("footprint", *footprint, 0.0);
                put_mapping(&mut fields, mapping, "world");
            }
            TextureKind::PbrtMarble { octaves, roughness, scale, variation, footprint, mapping } => {
                put_noise(&mut fields, "pbrt_marble", *octaves, *roughness, *footprint);
                fields.put_unless("frequency", *scale, 1.0);
                fields.put_unless("variation", *variation, 0.2);
                put_mapping(&mut fields, mapping, "world");
            }
            TextureKind::VertexColor { tint } => {
                fields.put("type", "vertex_color");
                if *tint != [1.0; 3] {
                    fields.put("tint", plain_color(*tint));
                }
            }
            TextureKind::VertexAlpha => fields.put("type", "vertex_alpha"),
            TextureKind::Product { a, b } => {
                self.two(&mut fields, "product", [("a", *a, 1.0), ("b", *b, 1.0)])?;
            }
            TextureKind::Threshold { value, edge } => {
                fields.put("type", "threshold");
                fields.put("value", self.scalar(*value));
                fields.put_unless("edge", *edge, 0.5);
            }
            TextureKind::Quotient { a, b } => {
                fields.put("type", "quotient");
                fields.put("a", self.scalar(*a));
                fields.put("b", self.scalar(*b));
            }
        }
        Ok(fields)
    }

    /// The type of a texture, and its two colours with their greys by default.
    fn two(&mut self, fields: &mut Fields, kind: &str, colors: [(&str, Color, f32); 2]) -> Result<()> {
        fields.put("type", kind);
        colors.into_iter().try_for_each(|(key, color, gray)| self.put_color(fields, key, color, gray))
    }

    fn image_texture(&mut self, fields: &mut Fields, image: ImageId, channel: Channel) -> Result<()> {
        let purpose = if channel == Channel::Alpha { For::Opacity } else { For::Texture };
        let picture = self.picture(image, purpose)?;
        fields.put("file", picture.file);
        if let Some(encoding) = picture.encoding {
            fields.put("encoding", encoding);
        }
        let channel = picture.channel.unwrap_or(channel);
        if channel != Channel::Rgb {
            fields.put("channel", word_of(CHANNELS, &channel));
        }
        Ok(())
    }
}

fn put_noise(fields: &mut Fields, kind: &str, octaves: u32, roughness: f32, footprint: f32) {
    fields.put("type", kind);
    fields.put_unless("octaves", octaves, TextureKind::OCTAVES);
    fields.put_unless("roughness", roughness, TextureKind::ROUGHNESS);
    fields.put_unless("footprint", footprint, 0.0);
}

fn put_wrap(fields: &mut Fields, wrap: [Wrap; 2]) {
    match wrap.map(|wrap| word_of(WRAPS, &wrap)) {
        _ if wrap == [Wrap::Repeat; 2] => {}
        [u, v] if u == v => fields.put("wrap", u),
        both => fields.put("wrap", both),
    }
}

fn put_filter(fields: &mut Fields, filter: TexelFilter) {
    let TexelFilter::Mip { filter: kind, footprint } = filter else {
        if filter != TexelFilter::Bilinear {
            fields.put("filter", word_of(FILTERS, &filter));
        }
        return;
    };
    let usual = match kind {
        MipFilter::Ewa { .. } => MipFilter::Ewa { anisotropy: MipFilter::ANISOTROPY },
        other => other,
    };
    let usual = TexelFilter::Mip { filter: usual, footprint: TexelFilter::FOOTPRINT };
    fields.put("filter", word_of(FILTERS, &usual));
    fields.put_unless("footprint", footprint, TexelFilter::FOOTPRINT);
    if let MipFilter::Ewa { anisotropy } = kind {
        fields.put_unless("anisotropy", anisotropy, MipFilter::ANISOTROPY);
    }
}

/// A mapping; `default` is the space of those that name none.
fn put_mapping(fields: &mut Fields, mapping: &Mapping, default: &str) {
    let space = |fields: &mut Fields, space: &str| {
        if space != default {
            fields.put("space", space);
        }
    };
    match mapping {
        Mapping::Uv { scale, offset } => {
            space(fields, "uv");
            match scale {
                [u, v] if u == v => fields.put_unless("scale", *u, 1.0),
                both => fields.put("scale", *both),
            }
            fields.put_unless("offset", *offset, [0.0; 2]);
        }
        Mapping::Affine { set, matrix } => {
            space(fields, "uv");
            fields.put("uv_set", *set);
            fields.put("uv_matrix", *matrix);
        }
        Mapping::World { texture_from_world } => {
            space(fields, "world");
            put_pattern(fields, texture_from_world, DMat4::IDENTITY);
        }
        Mapping::Spherical { texture_from_world } => {
            space(fields, "spherical");
            put_pattern(fields, texture_from_world, pole_on_z());
        }
        Mapping::Cylindrical { texture_from_world } => {
            space(fields, "cylindrical");
            put_pattern(fields, texture_from_world, pole_on_z());
        }
        Mapping::Planar { texture_from_world, axes: [u, v], offset } => {
            space(fields, "planar");
            put_pattern(fields, texture_from_world, DMat4::IDENTITY);
            fields.put_unless("axis_u", *u, Vec3::X);
            fields.put_unless("axis_v", *v, Vec3::Y);
            fields.put_unless("offset", *offset, [0.0; 2]);
        }
    }
}

/// The place of a pattern: by its size, where that gives the same bits, or else by its matrix. `turn` comes after what the document says.
fn put_pattern(fields: &mut Fields, texture_from_world: &DMat4, turn: DMat4) {
    let is_turned = turn != DMat4::IDENTITY;
    let of_size = |size: f64| {
        // As the reader computes it.
        let pattern = (DMat4::IDENTITY * DMat4::from_scale(DVec3::splat(size))).inverse();
        if is_turned { turn * pattern } else { pattern }
    };
    let length = texture_from_world.x_axis.truncate().length();
    let sizes = [1.0, 1.0 / length, (1.0 / length).next_up(), (1.0 / length).next_down()];
    match sizes.into_iter().find(|size| size.is_finite() && same_bits(&of_size(*size), texture_from_world)) {
        Some(size) => fields.put_unless("size", size, 1.0),
        None => put_matrix(fields, "texture_from_world", texture_from_world),
    }
}
