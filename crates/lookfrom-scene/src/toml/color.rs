//! Colours and textures: numbers, `"#rrggbb"`, names of textures, and tables of textures.

use std::collections::BTreeMap;

use glam::{DMat4, DVec3};

use super::Reader;
use super::place::scale_rotate_translate;
use super::value::{Table, Value};
use crate::error::{Error, ErrorKind, Result};
use crate::image::linear_from_srgb;
use crate::material::Color;
use crate::scene::TextureId;
use crate::texture::{Mapping, TexelFilter, Texture, TextureKind, Wrap};

/// The keys of textures, by type.
pub(super) const KEYS: &[(&str, &[&str])] = &[
    ("image", &["file", "scale", "offset", "wrap", "filter", "invert"]),
    ("checker", &["even", "odd"]),
    ("noise", &["low", "high", "octaves"]),
    ("marble", &["vein", "base", "octaves", "turbulence"]),
    ("vertex_color", &["tint"]),
];
/// The keys of patterns that say where they live.
pub(super) const MAPPING: &[&str] = &["space", "scale", "size", "rotate", "translate"];

/// How deep textures may use textures.
const DEEPEST: usize = 16;

/// A colour that is the same everywhere.
pub(super) fn plain_color(value: Value<'_>) -> Result<[f32; 3]> {
    let expected = "a colour: a number, [r, g, b] or \"#rrggbb\"";
    let primary = |value: Value<'_>| value.single_where("a number of at least 0", |number| number >= 0.0);
    if value.is_number() {
        return primary(value).map(|gray| [gray; 3]);
    }
    if let Some(text) = value.as_text() {
        return hex_color(text).ok_or_else(|| value.wrong(expected));
    }
    let [r, g, b] = value.list_of(expected)?;
    Ok([primary(r)?, primary(g)?, primary(b)?])
}

/// `#rgb` or `#rrggbb`, made linear.
fn hex_color(text: &str) -> Option<[f32; 3]> {
    let digits: Vec<f32> =
        text.strip_prefix('#')?.chars().map(|c| c.to_digit(16).map(|d| d as f32)).collect::<Option<_>>()?;
    let byte = match digits.len() {
        3 => |digits: &[f32], i: usize| 17.0 * digits[i],
        6 => |digits: &[f32], i: usize| 16.0 * digits[2 * i] + digits[2 * i + 1],
        _ => return None,
    };
    Some([0, 1, 2].map(|i| linear_from_srgb(byte(&digits, i) / 255.0)))
}

impl Reader<'_, '_> {
    /// A colour that may be a texture: by name, or written in its place.
    pub(super) fn color(&mut self, value: Value<'_>) -> Result<Color> {
        match value.as_text() {
            Some(name) if !name.starts_with('#') => self.texture_named(value, name).map(Color::Texture),
            _ if value.is_table() => {
                let kind = self.texture_kind(&value.table("a texture")?)?;
                let name = format!("{} at {}", value.key(), value.at());
                self.scene.textures.push(Texture { name, at: value.at(), kind });
                Ok(Color::Texture(TextureId(self.scene.textures.len() as u32 - 1)))
            }
            _ => plain_color(value).map(Color::Value),
        }
    }

    fn texture_named(&self, value: Value<'_>, name: &str) -> Result<TextureId> {
        super::named(&self.textures, "texture", value, name)
    }

    /// `[textures]`: all names first, so that each may use the others, wherever they are written.
    pub(super) fn read_textures(&mut self, value: Value<'_>) -> Result<()> {
        let first = self.scene.textures.len();
        for entry in value.table("[textures]")?.entries() {
            let name = entry.key();
            if name.starts_with('#') || name.is_empty() {
                return Err(entry.error(format!("a texture cannot be named {name:?}")));
            }
            let id = TextureId(self.scene.textures.len() as u32);
            let at = entry.at();
            if let Some(before) = self.textures.insert(name.to_owned(), id) {
                return Err(super::twice(entry, "texture", &self.scene.textures[before.index()].at));
            }
            // Its place is held until it can be read.
            let kind = TextureKind::VertexColor { tint: [1.0; 3] };
            self.scene.textures.push(Texture { name: name.to_owned(), at, kind });
        }
        for (index, entry) in value.table("[textures]")?.entries().enumerate() {
            let table = entry.table(format!("[textures.{}]", entry.key()))?;
            self.scene.textures[first + index].kind = self.texture_kind(&table)?;
        }
        let mut heights = BTreeMap::new();
        for index in first..self.scene.textures.len() {
            self.height(index, &mut Vec::new(), &mut heights)?;
        }
        Ok(())
    }

    /// How many textures deep this one is; an error where it uses itself.
    fn height(
        &self,
        index: usize,
        chain: &mut Vec<usize>,
        heights: &mut BTreeMap<usize, usize>,
    ) -> Result<usize> {
        if let Some(&height) = heights.get(&index) {
            return Ok(height);
        }
        let texture = &self.scene.textures[index];
        if let Some(start) = chain.iter().position(|&other| other == index) {
            let names = chain[start..].iter().chain([&index]).map(|&i| self.scene.textures[i].name.as_str());
            let chain = names.collect::<Vec<_>>().join(" → ");
            return Err(Error::invalid(
                &texture.at,
                format!("texture {:?} uses itself: {chain}", texture.name),
            )
            .hint("give one of them a plain colour"));
        }
        chain.push(index);
        let mut height = 1;
        for color in texture.kind.parts() {
            if let (Color::Texture(id), true) = (color, chain.len() <= DEEPEST) {
                height = height.max(1 + self.height(id.index(), chain, heights)?);
            }
        }
        if height > DEEPEST || chain.len() > DEEPEST {
            return Err(Error::new(
                ErrorKind::Limit,
                &texture.at,
                format!("texture {:?} stands in a chain of more than {DEEPEST} textures", texture.name),
            )
            .hint("use fewer textures in textures"));
        }
        chain.pop();
        heights.insert(index, height);
        Ok(height)
    }

    fn texture_kind(&mut self, table: &Table<'_>) -> Result<TextureKind> {
        let types: Vec<(&str, usize)> =
            KEYS.iter().enumerate().map(|(index, &(word, _))| (word, index)).collect();
        let (word, keys) = KEYS[table.need("type", "\"checker\"")?.choice(&types)?];
        match word {
            "checker" | "noise" | "marble" => table.allow(&[&["type"], keys, MAPPING])?,
            _ => table.allow(&[&["type"], keys])?,
        }
        let octaves =
            |default| table.or("octaves", default, |value| value.integer(1, 16)).map(|count| count as u32);
        Ok(match word {
            "image" => TextureKind::Image {
                image: self.image(table.need("file", "\"picture.png\"")?)?,
                mapping: Mapping::Uv {
                    scale: table.or("scale", [1.0; 2], pair)?,
                    offset: table.or("offset", [0.0; 2], |value| value.singles("two numbers, [u, v]"))?,
                },
                wrap: table.or("wrap", Wrap::default(), |value| {
                    value.choice(&[
                        ("repeat", Wrap::Repeat),
                        ("mirror", Wrap::Mirror),
                        ("clamp", Wrap::Clamp),
                        ("black", Wrap::Black),
                    ])
                })?,
                filter: table.or("filter", TexelFilter::default(), |value| {
                    value.choice(&[("bilinear", TexelFilter::Bilinear), ("nearest", TexelFilter::Nearest)])
                })?,
                scale: 1.0,
                invert: table.or("invert", false, Value::boolean)?,
            },
            "checker" => TextureKind::Checker {
                even: self.color_or(table, "even", 0.9)?,
                odd: self.color_or(table, "odd", 0.1)?,
                mapping: mapping(table, "uv")?,
            },
            "noise" => TextureKind::Noise {
                low: self.color_or(table, "low", 0.0)?,
                high: self.color_or(table, "high", 1.0)?,
                octaves: octaves(4)?,
                mapping: mapping(table, "world")?,
            },
            "marble" => TextureKind::Marble {
                vein: self.color_or(table, "vein", 0.1)?,
                base: self.color_or(table, "base", 0.9)?,
                octaves: octaves(6)?,
                turbulence: table.or("turbulence", 1.5, |value| {
                    value.single_where("a number of at least 0", |number| number >= 0.0)
                })?,
                mapping: mapping(table, "world")?,
            },
            _ => TextureKind::VertexColor { tint: table.or("tint", [1.0; 3], plain_color)? },
        })
    }

    /// A colour of a table, or a grey where it is not given.
    pub(super) fn color_or(&mut self, table: &Table<'_>, key: &str, gray: f32) -> Result<Color> {
        table.find(key).map_or(Ok(Color::gray(gray)), |value| self.color(value))
    }
}

/// One number for both directions, or one for each.
fn pair(value: Value<'_>) -> Result<[f32; 2]> {
    if value.is_number() { value.single().map(|both| [both; 2]) } else { value.singles("a number or [u, v]") }
}

/// Where a pattern lives.
fn mapping(table: &Table<'_>, default: &str) -> Result<Mapping> {
    let words = [("uv", "uv"), ("world", "world")];
    let space = table.or("space", default, |value| value.choice(&words))?;
    if space == "uv" {
        if let Some(key) = table.one_of(&["size", "rotate", "translate"])? {
            return Err(key
                .error(format!("`{}` needs space = \"world\"", key.key()))
                .hint("in space = \"uv\" a pattern has only `scale`, its repetitions"));
        }
        return Ok(Mapping::Uv { scale: table.or("scale", [1.0; 2], pair)?, offset: [0.0; 2] });
    }
    let size = table.or("size", 1.0, Value::positive)?;
    let world_from_texture = scale_rotate_translate(table)? * DMat4::from_scale(DVec3::splat(size));
    let texture_from_world = world_from_texture.inverse();
    if texture_from_world.is_finite() {
        Ok(Mapping::World { texture_from_world })
    } else {
        Err(table
            .error("the pattern is too small or too large to compute with")
            .hint("change `size` or `scale`"))
    }
}
