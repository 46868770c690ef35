//! Colours, numbers that may vary, spectra and powers.

use std::fmt::Write;
use std::sync::LazyLock;

use super::Writer;
use super::text::{Fields, Item};
use crate::error::Result;
use crate::image::{linear_from_srgb, srgb_from_linear};
use crate::light::Power;
use crate::material::{Color, NormalTexture, Scalar};
use crate::scene::{CurveId, TextureId};
use crate::spectrum::{self, Curve};

/// The most entries of a spectrum that are written into the document; longer ones are files.
const MOST_ENTRIES: usize = 16;

/// Longest list of three numbers that is not written as a colour of the web, if it can be.
const SHORT_LIST: usize = 20;

/// The use of a spectrum.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Of {
    /// A reflectance or a light, which ends where its table ends.
    Color,
    /// An index of refraction or a coefficient, which the reader extends.
    Optics,
}

/// The spectra that have names.
static NAMED: LazyLock<Vec<(&str, Curve)>> =
    LazyLock::new(|| spectrum::names().filter_map(|name| Some((name, spectrum::named(name)?))).collect());

impl Writer<'_> {
    pub(super) fn color(&mut self, color: Color, of: Of) -> Result<Item> {
        Ok(match color {
            Color::Value(rgb) => plain_color(rgb),
            Color::Texture(id) => self.texture_name(id).into(),
            Color::Curve(id) => self.curve(id, of).into(),
        })
    }

    /// A colour that is not the grey by default.
    pub(super) fn put_color(
        &mut self,
        fields: &mut Fields,
        key: &str,
        color: Color,
        gray: f32,
    ) -> Result<()> {
        if color != Color::gray(gray) {
            let item = self.color(color, Of::Color)?;
            fields.put(key, item);
        }
        Ok(())
    }

    pub(super) fn scalar(&self, scalar: Scalar) -> Item {
        match scalar {
            Scalar::Value(value) => value.into(),
            Scalar::Texture(id) => self.texture_name(id).into(),
        }
    }

    pub(super) fn put_scalar(&self, fields: &mut Fields, key: &str, scalar: Scalar, default: f32) {
        if scalar != Scalar::Value(default) {
            fields.put(key, self.scalar(scalar));
        }
    }

    pub(super) fn texture_name(&self, id: TextureId) -> &str {
        self.textures.of(id.index())
    }

    pub(super) fn normals(&self, map: NormalTexture) -> Item {
        let name = self.texture_name(map.texture);
        if map.scale == 1.0 {
            return name.into();
        }
        let mut fields = Fields::one("texture", name);
        fields.put("scale", map.scale);
        fields.into()
    }

    /// The table of a spectrum.
    pub(super) fn curve(&mut self, id: CurveId, of: Of) -> Fields {
        let curve = &self.scene.curves[id.index()];
        let mut fields = self.spectrum(curve);
        if of == Of::Optics && matches!(curve, Curve::Tabulated { .. }) && curve.clone().extended() != *curve
        {
            fields.put("ends", "zero");
        }
        fields
    }

    /// The table of a spectrum that is 0 beyond its ends.
    pub(super) fn spectrum(&mut self, curve: &Curve) -> Fields {
        match curve {
            Curve::Constant(value) => Fields::one("constant", *value),
            Curve::Blackbody { kelvin } => Fields::one("kelvin", *kelvin),
            Curve::Tabulated { .. } if illuminant(curve).is_some() => {
                Fields::one("illuminant", illuminant(curve).unwrap_or_default())
            }
            Curve::Tabulated { wavelengths, values } if values.len() <= MOST_ENTRIES => Fields::one(
                "curve",
                Item::list(wavelengths.iter().zip(values).map(|(nm, value)| [*nm, *value])),
            ),
            Curve::Tabulated { wavelengths, values } => {
                Fields::one("spd", self.spectrum_file(wavelengths, values))
            }
        }
    }

    /// The file of a spectrum: lines of a wavelength in nm and a value.
    fn spectrum_file(&mut self, wavelengths: &[f32], values: &[f32]) -> String {
        let mut text = String::new();
        for (nm, value) in wavelengths.iter().zip(values) {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{nm:?} {value:?}");
        }
        if let Some(file) = self.spectra.get(&text) {
            return file.clone();
        }
        let file = self.file("spectrum", "spd", text.clone().into_bytes());
        self.spectra.insert(text, file.clone());
        file
    }

    /// The name of a glass whose index of refraction a spectrum is.
    pub(super) fn glass(&self, id: CurveId) -> Option<&'static str> {
        known(&self.scene.curves[id.index()], |name| name.strip_prefix("glass-"))
    }

    /// The symbol of the metal whose η and k two spectra are.
    pub(super) fn metal_symbol(&self, eta: Color, k: Color) -> Option<&'static str> {
        let (Color::Curve(eta), Color::Curve(k)) = (eta, k) else { return None };
        let [eta, k] = [eta, k].map(|id| &self.scene.curves[id.index()]);
        let symbol = known(eta, |name| name.strip_prefix("metal-")?.strip_suffix("-eta"))?;
        let same = known(k, |name| name.strip_prefix("metal-")?.strip_suffix("-k"))?;
        (symbol == same).then_some(symbol)
    }

    /// The colour of a light and its power, whose key is that of a total.
    pub(super) fn put_light(
        &mut self,
        fields: &mut Fields,
        [key, total]: [&str; 2],
        color: Color,
        power: &Power,
    ) -> Result<()> {
        let Power { scale, total: amount, absolute } = *power;
        let mut item = self.color(color, Of::Color)?;
        let is_scaled = amount.is_none() && !absolute && scale != 1.0;
        match &mut item {
            Item::Table(table) if is_scaled => table.put("scale", scale),
            _ => {
                fields.put(key, item);
                put_power(fields, total, power);
                return Ok(());
            }
        }
        fields.put(key, item);
        Ok(())
    }
}

/// A power that the colour does not tell.
pub(super) fn put_power(fields: &mut Fields, key: &str, &Power { scale, total, absolute }: &Power) {
    if let (Some(total), true) = (total, scale == 1.0 && !absolute) {
        fields.put(key, total);
        return;
    }
    let mut table = Fields::default();
    if let Some(total) = total {
        table.put("total", total);
    }
    table.put_unless("scale", scale, 1.0);
    table.put_unless("absolute", absolute, false);
    if !table.is_empty() {
        fields.put(key, table);
    }
}

/// A grey, a colour of the web where that has the same bits and is shorter, or a list.
pub(super) fn plain_color(rgb: [f32; 3]) -> Item {
    if rgb[0].to_bits() == rgb[1].to_bits() && rgb[0].to_bits() == rgb[2].to_bits() {
        return rgb[0].into();
    }
    let bytes = rgb.map(|light| (255.0 * srgb_from_linear(light) + 0.5) as u8);
    let is_same = bytes.map(|byte| linear_from_srgb(f32::from(byte) / 255.0)) == rgb;
    let length: usize = rgb.iter().map(|light| light.to_string().len() + 2).sum();
    if is_same && length > SHORT_LIST {
        let [r, g, b] = bytes;
        return format!("#{r:02x}{g:02x}{b:02x}").into();
    }
    rgb.into()
}

/// The name of a standard illuminant, as documents have it.
fn illuminant(curve: &Curve) -> Option<&'static str> {
    // pbrt's D50 has no name here: the name is the CIE's.
    if spectrum::d50().as_ref() == Some(curve) {
        return Some("D50");
    }
    known(curve, |name| {
        name.strip_prefix("stdillum-").or(name.strip_prefix("illum-")).filter(|name| *name != "D50")
    })
}

/// The name of a spectrum: of several, the last, since makers' names of glasses follow pbrt's.
fn known(curve: &Curve, of: impl Fn(&'static str) -> Option<&'static str>) -> Option<&'static str> {
    NAMED.iter().rev().filter(|(_, named)| named == curve).find_map(|(name, _)| of(name))
}
