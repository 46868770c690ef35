//! Colours and numbers, possibly textured: numbers, `[r, g, b]`, `"#rrggbb"`, names, curves, names of textures, inline
//! textures.

use super::table::Table;
use super::value::Value;
use super::{Reader, color_names};
use crate::error::Result;
use crate::image::linear_from_srgb;
use crate::material::{Color, NormalTexture, Scalar};
use crate::scene::TextureId;
use crate::spectrum::{Curve, observer, space};
use crate::texture::Texture;

/// The keys of a texture of normals with a scale.
pub(super) const NORMALS: &[&str] = &["texture", "scale"];

/// Minimum luminance of a light's spectrum, which is divided by.
const DARKEST: f64 = 1e-30;

/// A constant RGB colour.
pub(super) fn plain_color(value: Value<'_>) -> Result<[f32; 3]> {
    let expected = "a colour: a number, [r, g, b], \"#rrggbb\" or a name such as \"tomato\"";
    if value.is_number() {
        return primary(value).map(|gray| [gray; 3]);
    }
    if let Some(text) = value.as_text() {
        return text_color(text).ok_or_else(|| value.wrong(expected));
    }
    let [r, g, b] = value.list_of(expected)?;
    Ok([primary(r)?, primary(g)?, primary(b)?])
}

fn primary(value: Value<'_>) -> Result<f32> {
    value.single_where("a number of at least 0", |number| number >= 0.0)
}

/// `#rgb`, `#rrggbb` or a name, converted to linear.
fn text_color(text: &str) -> Option<[f32; 3]> {
    let digits = text.strip_prefix('#').or_else(|| color_names::digits(text))?;
    let digits: Vec<f32> = digits.chars().map(|c| c.to_digit(16).map(|d| d as f32)).collect::<Option<_>>()?;
    let byte = match digits.len() {
        3 => |digits: &[f32], i: usize| 17.0 * digits[i],
        6 => |digits: &[f32], i: usize| 16.0 * digits[2 * i] + digits[2 * i + 1],
        _ => return None,
    };
    Some([0, 1, 2].map(|i| linear_from_srgb(byte(&digits, i) / 255.0)))
}

/// Whether a text can only be the name of a texture.
fn is_texture_name(text: &str) -> bool {
    !text.starts_with('#') && color_names::digits(text).is_none()
}

impl Reader<'_, '_> {
    /// A colour that may be a spectrum, or a texture by name or inline.
    pub(super) fn color(&mut self, value: Value<'_>) -> Result<Color> {
        if value.is_table() {
            let table = value.table("a texture")?;
            if !table.has("type") {
                return self.curve(value, &[]).map(Color::Curve);
            }
            let kind = self.texture_kind(&table);
            return Ok(Color::Texture(self.add_texture(value, kind)));
        }
        match value.as_text() {
            // A texture of the scene may have the name of a colour.
            Some(name) if self.textures.contains_key(name) || is_texture_name(name) => {
                self.texture_named(value, name).map(Color::Texture)
            }
            _ => plain_color(value).map(Color::Value),
        }
    }

    /// The colour of a key, or a grey if it is absent.
    pub(super) fn color_or(&mut self, table: &Table<'_>, key: &str, gray: f32) -> Color {
        table.or(key, Color::gray(gray), |value| self.color(value))
    }

    /// A number that may be a texture, by name or inline; a number must satisfy `ok`, which `expected` describes.
    pub(super) fn scalar_where(
        &mut self,
        value: Value<'_>,
        expected: &str,
        ok: impl Fn(f32) -> bool,
    ) -> Result<Scalar> {
        if !value.is_table() && value.as_text().is_none_or(|text| text.starts_with('#')) {
            return value.single_where(&format!("{expected}, or a texture"), ok).map(Scalar::Value);
        }
        match self.color(value)? {
            Color::Texture(id) => Ok(Scalar::Texture(id)),
            _ => Err(value.wrong(&format!("{expected}, or a texture"))),
        }
    }

    /// A number in [0, 1] that may be a texture, or a default if it is absent.
    pub(super) fn share_or(&mut self, table: &Table<'_>, key: &str, default: f32) -> Scalar {
        table.or(key, Scalar::Value(default), |value| {
            self.scalar_where(value, "a number from 0 to 1", |share| (0.0..=1.0).contains(&share))
        })
    }

    /// The colour of a light and its scale. A spectrum only determines the chromaticity: it is as bright as a grey of its
    /// `scale`. Only lights that are shapes may have `textures`.
    pub(super) fn light_color(&mut self, value: Value<'_>, textures: bool) -> Result<(Color, f32)> {
        if value.is_table() && !value.table("a colour")?.has("type") {
            let table = value.table("a colour")?;
            let curve = self.curve(value, &["scale"])?;
            if luminance(&self.scene.curves[curve.index()]) < DARKEST {
                return Err(value
                    .error(format!("`{}` emits no visible light", value.key()))
                    .hint("give it values above 0 at whole nanometres between 400 and 700"));
            }
            return Ok((Color::Curve(curve), table.or("scale", 1.0, primary)));
        }
        let is_texture = value.is_table() || value.as_text().is_some_and(is_texture_name);
        if is_texture && !textures {
            let expected = "a colour: a number, [r, g, b], \"#rrggbb\", or a curve such as { kelvin = 5600 }";
            return Err(value.wrong(expected));
        }
        Ok((self.color(value)?, 1.0))
    }

    /// The colour of a light that is always RGB; a spectrum is converted.
    pub(super) fn light_rgb(&mut self, value: Value<'_>) -> Result<[f32; 3]> {
        match self.light_color(value, false)? {
            (Color::Curve(id), scale) => Ok(rgb(&self.scene.curves[id.index()]).map(|c| c * scale)),
            (Color::Value(rgb), _) => Ok(rgb),
            (Color::Texture(_), _) => Err(value.wrong("a colour")),
        }
    }

    /// A texture of normals: by name or inline, or a table of it and a `scale` of what it tilts.
    pub(super) fn normals(&mut self, value: Value<'_>) -> Result<NormalTexture> {
        let table = if value.is_table() { Some(value.table("normals")?) } else { None };
        let (of, scale) = match &table {
            Some(table) if table.has("texture") => {
                table.allow(&[NORMALS]);
                (table.find("texture").unwrap_or(value), table.or("scale", 1.0, Value::single))
            }
            _ => (value, 1.0),
        };
        match self.color(of)? {
            Color::Texture(texture) => Ok(NormalTexture { texture, scale }),
            _ => Err(value.wrong("a texture of normals")),
        }
    }

    /// Adds an inline texture.
    pub(super) fn add_texture(&mut self, value: Value<'_>, kind: crate::texture::TextureKind) -> TextureId {
        let name = format!("{} at {}", value.key(), value.at());
        self.scene.textures.push(Texture { name, at: value.at(), kind });
        TextureId(self.scene.textures.len() as u32 - 1)
    }

    fn texture_named(&self, value: Value<'_>, name: &str) -> Result<TextureId> {
        self.named(&self.textures, "texture", value, name)
    }
}

fn luminance(curve: &Curve) -> f64 {
    observer::xyz(curve)[1]
}

/// Linear Rec. 709 of a light's spectrum, with luminance 1; negative components are clamped to 0.
fn rgb(light: &Curve) -> [f32; 3] {
    let xyz = observer::xyz(light);
    let Some(xyz_from_rgb) = space::xyz_from("srgb") else { return [0.0; 3] };
    space::apply(&space::inverse(&xyz_from_rgb), xyz).map(|c| (c / xyz[1]).max(0.0) as f32)
}
