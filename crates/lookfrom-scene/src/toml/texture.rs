//! `[textures]`: images and procedural patterns.

use glam::DVec3;

use super::Reader;
use super::color::plain_color;
use super::mapping::mapping;
use super::table::{Groups, Kinds, Table};
use super::value::{Value, unit};
use crate::chain;
use crate::error::{Error, Result};
use crate::material::{Color, Scalar};
use crate::scene::{ImageId, TextureId};
use crate::texture::{Channel, MipFilter, TexelFilter, Texture, TextureKind, Wrap};

/// The keys of textures, by type, in addition to `type` and those of `mapping`.
pub(super) const KEYS: Kinds = &[
    (
        "image",
        &[
            "file",
            "layer",
            "encoding",
            "channel",
            "wrap",
            "filter",
            "footprint",
            "anisotropy",
            "multiply",
            "invert",
        ],
    ),
    ("checker", &["even", "odd", "footprint"]),
    ("noise", &["low", "high", "octaves"]),
    ("marble", &["vein", "base", "octaves", "turbulence"]),
    ("dots", &["inside", "outside"]),
    ("bilinear", &["corners"]),
    ("fbm", &["octaves", "roughness", "footprint"]),
    ("wrinkled", &["octaves", "roughness", "footprint"]),
    ("windy", &["footprint"]),
    ("scale", &["color", "by"]),
    ("mix", &["low", "high", "amount"]),
    ("direction_mix", &["low", "high", "direction"]),
    ("sides", &["outside", "inside"]),
    ("vertex_color", &["tint"]),
    ("vertex_alpha", &[]),
    ("product", &["a", "b"]),
    ("threshold", &["value", "edge"]),
    ("quotient", &["a", "b"]),
    ("pbrt_marble", &["octaves", "roughness", "frequency", "variation", "footprint"]),
];

/// The keys of a picture with the name of its layer.
pub(super) const PICTURE: &[&str] = &["file", "layer"];

/// The words for encodings of an image, and whether they are linear.
pub(super) const ENCODINGS: &[(&str, bool)] = &[("srgb", false), ("linear", true)];
/// The key of an encoding by an exponent.
pub(super) const GAMMA: &[&str] = &["gamma"];
/// The words for wrap modes.
pub(super) const WRAPS: &[(&str, Wrap)] =
    &[("repeat", Wrap::Repeat), ("mirror", Wrap::Mirror), ("clamp", Wrap::Clamp), ("black", Wrap::Black)];
/// The words for channels of an image.
pub(super) const CHANNELS: &[(&str, Channel)] = &[
    ("rgb", Channel::Rgb),
    ("red", Channel::Red),
    ("green", Channel::Green),
    ("blue", Channel::Blue),
    ("alpha", Channel::Alpha),
];
/// The words for filters of images.
pub(super) const FILTERS: &[(&str, TexelFilter)] = &[
    ("bilinear", TexelFilter::Bilinear),
    ("nearest", TexelFilter::Nearest),
    ("mip_nearest", mip(MipFilter::Nearest)),
    ("mip_bilinear", mip(MipFilter::Bilinear)),
    ("trilinear", mip(MipFilter::Trilinear)),
    ("ewa", mip(MipFilter::Ewa { anisotropy: MipFilter::ANISOTROPY })),
];

const fn mip(filter: MipFilter) -> TexelFilter {
    TexelFilter::Mip { filter, footprint: TexelFilter::FOOTPRINT }
}

/// The keys of a type that others have, too: those of a mapping of its own.
pub(super) fn common(kind: &str) -> Groups {
    const WITHOUT: [&str; 9] = [
        "scale",
        "mix",
        "direction_mix",
        "sides",
        "vertex_color",
        "vertex_alpha",
        "product",
        "threshold",
        "quotient",
    ];
    if WITHOUT.contains(&kind) { &[] } else { &[super::mapping::KEYS] }
}

impl Reader<'_, '_> {
    /// Reads `[textures]`: all names first, so that each may use textures that are defined later.
    pub(super) fn read_textures(&mut self, value: Value<'_>) {
        self.knows_all_names &= value.is_table();
        let first = self.scene.textures.len();
        for entry in value.named("[textures]") {
            let name = entry.key();
            if name.starts_with('#') || name.is_empty() {
                entry.note(entry.error(format!("a texture cannot be named {name:?}")));
            }
            let id = TextureId(self.scene.textures.len() as u32);
            let at = entry.at();
            if let Some(before) = self.textures.insert(name.to_owned(), id) {
                entry.note(super::twice(entry, "texture", &self.scene.textures[before.index()].at));
            }
            // Reserved until it is read.
            let kind = TextureKind::VertexColor { tint: [1.0; 3] };
            self.scene.textures.push(Texture { name: name.to_owned(), at, kind });
        }
        for (index, entry) in value.named("[textures]").enumerate() {
            let table = entry.table(format!("[textures.{}]", entry.key()));
            if let Some(table) = entry.noting(table.map(Some), None) {
                self.scene.textures[first + index].kind = self.texture_kind(&table);
            }
        }
        for error in chain::check(&self.scene.textures, first..self.scene.textures.len()) {
            value.note(error);
        }
    }

    /// A texture; if it is invalid, a placeholder, and the error is recorded.
    pub(super) fn texture_kind(&mut self, table: &Table<'_>) -> TextureKind {
        self.typed(table).unwrap_or_else(|error| {
            table.note(error);
            TextureKind::VertexColor { tint: [1.0; 3] }
        })
    }

    fn typed(&mut self, table: &Table<'_>) -> Result<TextureKind> {
        let Some(word) = table.kind(KEYS, None, common) else { return Err(Error::untold()) };
        let octaves = |default: u32| table.or("octaves", default.into(), |value| value.integer(1, 16)) as u32;
        let roughness = || {
            table.or("roughness", TextureKind::ROUGHNESS, |value| {
                value.single_where("a number from 0 to 1", |share| (0.0..=1.0).contains(&share))
            })
        };
        Ok(match word {
            "image" => self.picture(table)?,
            "checker" => TextureKind::Checker {
                even: self.color_or(table, "even", 0.9),
                odd: self.color_or(table, "odd", 0.1),
                footprint: footprint(table),
                mapping: mapping(table, "uv")?,
            },
            "noise" => TextureKind::Noise {
                low: self.color_or(table, "low", 0.0),
                high: self.color_or(table, "high", 1.0),
                octaves: octaves(4),
                mapping: mapping(table, "world")?,
            },
            "marble" => TextureKind::Marble {
                vein: self.color_or(table, "vein", 0.1),
                base: self.color_or(table, "base", 0.9),
                octaves: octaves(6),
                turbulence: table.or("turbulence", 1.5, |value| {
                    value.single_where("a number of at least 0", |number| number >= 0.0)
                }),
                mapping: mapping(table, "world")?,
            },
            "dots" => TextureKind::Dots {
                inside: self.color_or(table, "inside", 0.9),
                outside: self.color_or(table, "outside", 0.1),
                mapping: mapping(table, "uv")?,
            },
            "bilinear" => {
                let corners = table.need("corners", "[0, 1, 1, 0]", [Color::BLACK; 4], |value| {
                    let mut corners = [Color::BLACK; 4];
                    let items = value.list_of::<4>("four colours, at (0, 0), (0, 1), (1, 0) and (1, 1)")?;
                    for (corner, item) in corners.iter_mut().zip(items) {
                        *corner = self.color(item)?;
                    }
                    Ok(corners)
                });
                TextureKind::Bilinear { corners, mapping: mapping(table, "uv")? }
            }
            "fbm" => TextureKind::Fbm {
                octaves: octaves(TextureKind::OCTAVES),
                roughness: roughness(),
                footprint: footprint(table),
                mapping: mapping(table, "world")?,
            },
            "wrinkled" => TextureKind::Wrinkled {
                octaves: octaves(TextureKind::OCTAVES),
                roughness: roughness(),
                footprint: footprint(table),
                mapping: mapping(table, "world")?,
            },
            "windy" => TextureKind::Windy { footprint: footprint(table), mapping: mapping(table, "world")? },
            "scale" => TextureKind::Scale {
                color: table
                    .need("color", "\"the name of a texture\"", Color::BLACK, |value| self.color(value)),
                by: table.need("by", "0.5", Scalar::Value(1.0), |value| {
                    self.scalar_where(value, "a number of at least 0", |by| by >= 0.0)
                }),
            },
            "mix" => TextureKind::Mix {
                low: self.color_or(table, "low", 0.0),
                high: self.color_or(table, "high", 1.0),
                amount: self.share_or(table, "amount", TextureKind::MIX_AMOUNT),
            },
            "direction_mix" => TextureKind::DirectionMix {
                low: self.color_or(table, "low", 0.0),
                high: self.color_or(table, "high", 1.0),
                direction: table.need("direction", "[0, 1, 0]", DVec3::Y, unit).as_vec3(),
            },
            "sides" => TextureKind::Sides {
                outside: self.color_or(table, "outside", 0.0),
                inside: self.color_or(table, "inside", 1.0),
            },
            "vertex_alpha" => TextureKind::VertexAlpha,
            "product" => {
                TextureKind::Product { a: self.color_or(table, "a", 1.0), b: self.color_or(table, "b", 1.0) }
            }
            "threshold" => TextureKind::Threshold {
                value: table.need("value", "\"the name of a texture\"", Scalar::Value(1.0), |value| {
                    self.scalar_where(value, "a number", |_| true)
                }),
                edge: table.or("edge", 0.5, Value::single),
            },
            "quotient" => {
                let mut number = |key| {
                    table.or(key, Scalar::Value(1.0), |value| self.scalar_where(value, "a number", |_| true))
                };
                TextureKind::Quotient { a: number("a"), b: number("b") }
            }
            "pbrt_marble" => TextureKind::PbrtMarble {
                octaves: octaves(TextureKind::OCTAVES),
                roughness: roughness(),
                scale: table.or("frequency", 1.0, Value::single),
                variation: table.or("variation", 0.2, Value::single),
                footprint: footprint(table),
                mapping: mapping(table, "world")?,
            },
            _ => TextureKind::VertexColor { tint: table.or("tint", [1.0; 3], plain_color) },
        })
    }

    fn picture(&mut self, table: &Table<'_>) -> Result<TextureKind> {
        let gamma = match table.find("encoding") {
            Some(value) if value.is_table() => Some(value.noting(gamma(value), 1.0)),
            _ => None,
        };
        let is_data = gamma.is_none() && table.or("encoding", false, |value| value.choice(ENCODINGS));
        let layer = table.maybe("layer", |value| value.text("the name of a layer of an OpenEXR picture"));
        Ok(TextureKind::Image {
            image: table.need("file", "\"picture.png\"", ImageId(0), |value| match gamma {
                Some(gamma) => self.image_by_gamma(value, layer, gamma),
                None => self.image_as(value, layer, is_data),
            }),
            mapping: mapping(table, "uv")?,
            wrap: table.or("wrap", [Wrap::default(); 2], wraps),
            filter: filter(table),
            channel: table.or("channel", Channel::Rgb, |value| value.choice(CHANNELS)),
            scale: table.or("multiply", 1.0, |value| {
                value.single_where("a number of at least 0", |number| number >= 0.0)
            }),
            invert: table.or("invert", false, Value::boolean),
        })
    }

    /// A texture for a scalar whose mean is the square of another's: both factors are its mean.
    pub(super) fn squared(&mut self, value: Value<'_>, id: TextureId) -> Scalar {
        let (color, by) = (Color::Texture(id), Scalar::Texture(id));
        Scalar::Texture(self.add_texture(value, TextureKind::Scale { color, by }))
    }
}

/// The exponent of `{ gamma = 2.2 }`.
fn gamma(value: Value<'_>) -> Result<f32> {
    let table = value.table("an encoding")?;
    table.allow(&[GAMMA]);
    let one = table.find("gamma").ok_or_else(|| value.wrong("\"srgb\", \"linear\" or { gamma = 2.2 }"))?;
    one.single_where("an exponent greater than 0", |gamma| gamma > 0.0)
}

/// One word for all edges, or one for the left and right, and one for the upper and lower ones.
fn wraps(value: Value<'_>) -> Result<[Wrap; 2]> {
    if !value.is_list() {
        return value.choice(WRAPS).map(|wrap| [wrap; 2]);
    }
    let [across, along] = value.list_of("a wrap mode, or two of them, [u, v]")?;
    Ok([across.choice(WRAPS)?, along.choice(WRAPS)?])
}

/// The width that a pattern is averaged over, in pixels.
fn footprint(table: &Table<'_>) -> f32 {
    table.or("footprint", 0.0, |value| value.single_where("a number of at least 0", |pixels| pixels >= 0.0))
}

/// The filter of an image, with its parameters; parameters that it does not have are told.
fn filter(table: &Table<'_>) -> TexelFilter {
    let mut filter = table.or("filter", TexelFilter::default(), |value| value.choice(FILTERS));
    let word = FILTERS.iter().find(|known| known.1 == filter).map_or("bilinear", |known| known.0);
    let misplaced = |key: &str, words: &str| {
        if let Some(value) = table.find(key) {
            let error = value.error(format!("`{key}` has no meaning with filter = {word:?}"));
            value.note(error.hint(format!("leave it out, or give filter = {words}")));
        }
    };
    let TexelFilter::Mip { filter: kind, footprint } = &mut filter else {
        misplaced("footprint", "\"trilinear\" or \"ewa\"");
        misplaced("anisotropy", "\"ewa\"");
        return filter;
    };
    *footprint = table.or("footprint", *footprint, |value| {
        value.single_where("a number greater than 0", |pixels| pixels > 0.0)
    });
    match kind {
        MipFilter::Ewa { anisotropy } => {
            *anisotropy = table.or("anisotropy", *anisotropy, |value| {
                let range = 1.0..=MipFilter::MOST_ANISOTROPY;
                value.single_where("a number from 1 to 64", |ratio| range.contains(&ratio))
            });
        }
        _ => misplaced("anisotropy", "\"ewa\""),
    }
    filter
}
