//! Textures, and colours and numbers that may be textures.
//!
//! Mitsuba's v runs down (row 0 of a picture is at v = 0), except that it turns that of OBJ files around; ours runs up. All shapes have
//! coordinates (u, 1 − v) here, and textures undo it.

use std::rc::Rc;

use glam::DMat4;

use super::Reader;
use super::plugin::{Plugin, Property, Value};
use super::xml::blame;
use crate::error::{ErrorKind, Result};
use crate::image::{self, By, Encoding, Reading};
use crate::material::{Color, Scalar};
use crate::model::surface::push_image;
use crate::scene::{CurveId, ImageId, TextureId};
use crate::spectrum::{self, Curve, observer, spectral_radiance};
use crate::texture::{Channel, Mapping, TexelFilter, Texture, TextureKind, Wrap};

const KINDS: &[&str] = &["bitmap", "checkerboard", "mesh_attribute"];

const SPECTRA: &[&str] = &["blackbody", "d65", "irregular", "rawconstant", "regular", "srgb", "uniform"];

impl Reader<'_, '_> {
    /// A colour of a surface, constant or textured.
    pub(super) fn color(&mut self, plugin: &Plugin, name: &str, default: f32) -> Result<Color> {
        match plugin.find(name) {
            Some(property) => self.color_of(property),
            None => Ok(Color::gray(default)),
        }
    }

    /// As [`color`](Self::color), from 0 to 1 where it is constant.
    pub(super) fn reflectance(&mut self, plugin: &Plugin, name: &str, default: f32) -> Result<Color> {
        let color = self.color(plugin, name, default)?;
        match color {
            Color::Value(rgb) if rgb.iter().any(|value| *value > 1.0) => {
                Err(plugin.refuse(name, "a reflectance from 0 to 1"))
            }
            color => Ok(color),
        }
    }

    pub(super) fn color_of(&mut self, property: &Property) -> Result<Color> {
        match &property.value {
            Value::Float(value) => Ok(Color::gray(*value as f32)),
            Value::Color(rgb) => Ok(Color::Value(*rgb)),
            Value::Curve(Curve::Constant(value)) => Ok(Color::gray(*value)),
            Value::Curve(curve) => Ok(Color::Curve(self.push_curve(curve.clone()))),
            _ => match property.plugin(&self.ids)? {
                Some(plugin) if SPECTRA.contains(&&*plugin.kind) => self.spectrum(&plugin),
                Some(plugin) if plugin.kind == "volume" => {
                    self.coefficient(&plugin, "volume", 1.0).map(Color::Value)
                }
                Some(plugin) => self.texture(&plugin).map(Color::Texture),
                None => Err(property.wrong("a colour or a texture")),
            },
        }
    }

    /// A number that may vary over the surface.
    pub(super) fn scalar(&mut self, plugin: &Plugin, name: &str, default: f64) -> Result<Scalar> {
        match plugin.find(name) {
            None => Ok(Scalar::Value(default as f32)),
            Some(property) => match &property.value {
                Value::Integer(value) => Ok(Scalar::Value(*value as f32)),
                _ => match self.number_of(property)? {
                    Color::Value([x, y, z]) if x == y && y == z => Ok(Scalar::Value(x)),
                    Color::Texture(id) => Ok(Scalar::Texture(id)),
                    Color::Value(_) | Color::Curve(_) => Err(property.wrong("a number or a texture")),
                },
            },
        }
    }

    /// As [`color_of`](Self::color_of), where a number is asked for: there Mitsuba exchanges the fields of a checkerboard.
    fn number_of(&mut self, property: &Property) -> Result<Color> {
        let color = self.color_of(property)?;
        let Color::Texture(id) = color else { return Ok(color) };
        let TextureKind::Checker { even, odd, footprint, mapping } = self.scene.textures[id.index()].kind
        else {
            return Ok(color);
        };
        if let Some(&exchanged) = self.exchanged.get(&id) {
            return Ok(Color::Texture(exchanged));
        }
        let kind = TextureKind::Checker { even: odd, odd: even, footprint, mapping };
        let texture = Texture { kind, ..self.scene.textures[id.index()].clone() };
        self.scene.textures.push(texture);
        let exchanged = TextureId(self.scene.textures.len() as u32 - 1);
        self.exchanged.insert(id, exchanged);
        Ok(Color::Texture(exchanged))
    }

    /// A spectrum that is a plugin of its own, the same everywhere.
    fn spectrum(&mut self, plugin: &Rc<Plugin>) -> Result<Color> {
        match self.tabulated(plugin)? {
            Some(curve) => Ok(Color::Curve(self.push_curve(curve))),
            None => self.constant(plugin),
        }
    }

    /// Spectra among the properties of a film, with these properties.
    pub(super) fn spectra<'p>(&mut self, film: &'p Plugin) -> Result<Vec<(&'p Property, Curve)>> {
        let mut spectra = Vec::new();
        for property in film.unused() {
            let curve = match (&property.value, property.plugin(&self.ids)?) {
                (Value::Curve(curve), _) => Some(curve.clone()),
                (_, Some(plugin)) if plugin.class == "spectrum" => match self.tabulated(&plugin)? {
                    Some(curve) => Some(curve),
                    None if plugin.kind == "d65" => spectrum::named("stdillum-D65"),
                    None => match self.constant(&plugin)? {
                        Color::Value([x, y, z]) if x == y && y == z => Some(Curve::Constant(x)),
                        _ => return Err(property.wrong("a response by wavelength, not a colour")),
                    },
                },
                _ => None,
            };
            if let Some(curve) = curve {
                film.find(&property.name);
                spectra.push((property, curve));
            }
        }
        Ok(spectra)
    }

    /// The curve of wavelengths and values; `None` for other spectra.
    fn tabulated(&mut self, plugin: &Plugin) -> Result<Option<Curve>> {
        let numbers = |name: &str| -> Result<Vec<f32>> {
            let Some(text) = plugin.string(name)? else {
                return Err(plugin.refuse(name, "numbers: <string>"));
            };
            let at = plugin.find(name).map_or(&plugin.at, |property| &property.at);
            Ok(super::value::floats(text, at)?.into_iter().map(|value| value as f32).collect())
        };
        let (wavelengths, values) = match &*plugin.kind {
            "irregular" => (numbers("wavelengths")?, numbers("values")?),
            "regular" => {
                let values = numbers("values")?;
                let (first, last) =
                    (plugin.float("wavelength_min", 360.0)?, plugin.float("wavelength_max", 830.0)?);
                let steps = values.len().saturating_sub(1).max(1) as f64;
                let step = (last - first) / steps;
                ((0..values.len()).map(|index| (first + step * index as f64) as f32).collect(), values)
            }
            "blackbody" => {
                let kelvin = plugin.positive("temperature", 5000.0)?;
                let scale =
                    plugin.float_where("scale", 1.0, "a number of at least 0", |scale| scale >= 0.0)?;
                let values = (0..=94)
                    .map(|step| (scale * spectral_radiance(360.0 + 5.0 * f64::from(step), kelvin)) as f32);
                ((0..=94).map(|step| 360.0 + 5.0 * step as f32).collect(), values.collect())
            }
            _ => return Ok(None),
        };
        let rises = wavelengths.windows(2).all(|pair| pair[0] < pair[1]);
        if values.is_empty() || wavelengths.len() != values.len() || !rises {
            return Err(plugin.refuse("values", "as many numbers as there are wavelengths, which rise"));
        }
        if values.iter().any(|value| *value < 0.0) {
            return Err(plugin.refuse("values", "numbers of at least 0"));
        }
        Ok(Some(Curve::Tabulated { wavelengths, values }))
    }

    /// A spectrum that is a colour.
    fn constant(&mut self, plugin: &Plugin) -> Result<Color> {
        let name = match &*plugin.kind {
            "srgb" | "d65" => "color",
            _ => "value",
        };
        let scale = if plugin.kind == "d65" { plugin.float("scale", 1.0)? as f32 } else { 1.0 };
        let color = match plugin.find(name) {
            None => [1.0; 3],
            Some(Property { value: Value::Color(rgb), .. }) => *rgb,
            Some(Property { value: Value::Curve(Curve::Constant(value)), .. }) => [*value; 3],
            Some(Property { value: Value::Float(value), .. }) => [*value as f32; 3],
            Some(Property { value: Value::Vector(vector), .. }) => vector.as_vec3().to_array(),
            Some(property) => return Err(property.wrong("a colour")),
        };
        let color = color.map(|value| value * scale);
        if color.iter().all(|value| *value >= 0.0 && value.is_finite()) {
            return Ok(Color::Value(color));
        }
        Err(plugin.refuse(name, "a colour without negative values"))
    }

    /// A spectrum of light that is a plugin of its own, or a texture of light.
    pub(super) fn light_spectrum(&mut self, plugin: &Rc<Plugin>) -> Result<(Color, f32)> {
        if !SPECTRA.contains(&&*plugin.kind) {
            return Err(plugin.unsupported(SPECTRA));
        }
        match self.tabulated(plugin)? {
            Some(curve) => Ok(self.light_curve(curve)),
            None => Ok((self.constant(plugin)?, 1.0)),
        }
    }

    /// Light of a spectrum, and its luminance, where that of a spectrum which is 1 everywhere is 1.
    pub(super) fn light_curve(&mut self, curve: Curve) -> (Color, f32) {
        let luminance = observer::xyz(&curve)[1] / observer::xyz(&Curve::Constant(1.0))[1];
        if luminance > 0.0 {
            (Color::Curve(self.push_curve(curve)), luminance as f32)
        } else {
            (Color::BLACK, 1.0)
        }
    }

    pub(super) fn push_curve(&mut self, curve: Curve) -> CurveId {
        self.scene.curves.push(curve);
        CurveId(self.scene.curves.len() as u32 - 1)
    }

    pub(super) fn push_texture(&mut self, plugin: &Plugin, kind: TextureKind) -> TextureId {
        let name = plugin.id.as_ref().unwrap_or(&plugin.kind).clone();
        self.scene.textures.push(Texture { name, at: plugin.at.clone(), kind });
        TextureId(self.scene.textures.len() as u32 - 1)
    }

    pub(super) fn texture(&mut self, plugin: &Rc<Plugin>) -> Result<TextureId> {
        let address = Rc::as_ptr(plugin);
        if let Some(&id) = self.textures.get(&address) {
            return Ok(id);
        }
        let kind = self.within(plugin, |reader| match &*plugin.kind {
            "bitmap" => reader.bitmap(plugin),
            "checkerboard" => {
                let matrix = plugin.transform("to_uv")?;
                Ok(TextureKind::Checker {
                    even: reader.color(plugin, "color0", 0.4)?,
                    odd: reader.color(plugin, "color1", 0.2)?,
                    footprint: 0.0,
                    mapping: reader.mapping(&matrix, 2.0, false),
                })
            }
            "mesh_attribute" => reader.attribute_texture(plugin),
            _ => Err(plugin.unsupported(KINDS)),
        })?;
        let id = self.push_texture(plugin, kind);
        self.textures.insert(address, id);
        Ok(id)
    }

    pub(super) fn bitmap(&mut self, plugin: &Plugin) -> Result<TextureKind> {
        let wraps = [("repeat", Wrap::Repeat), ("mirror", Wrap::Mirror), ("clamp", Wrap::Clamp)];
        let filters = [("bilinear", TexelFilter::Bilinear), ("nearest", TexelFilter::Nearest)];
        plugin.ignore(&["accel", "format"]);
        Ok(TextureKind::Image {
            image: self.image(plugin, plugin.boolean("raw", false)?)?,
            mapping: self.mapping(&plugin.transform("to_uv")?, 1.0, true),
            wrap: [plugin.choice("wrap_mode", Wrap::Repeat, &wraps)?; 2],
            filter: plugin.choice("filter_type", TexelFilter::Bilinear, &filters)?,
            channel: Channel::Rgb,
            scale: 1.0,
            invert: false,
        })
    }

    /// The picture that a plugin names.
    pub(super) fn image(&mut self, plugin: &Plugin, raw: bool) -> Result<ImageId> {
        let (path, at) = self.file(plugin)?;
        let key = (path, raw);
        if let Some(&id) = self.images.get(&key) {
            return Ok(id);
        }
        let encoding = if raw { Encoding::Linear } else { Encoding::Srgb };
        let reading = Reading { by: By::PbrtLight, ..Reading::new(encoding) };
        let image = image::read_as(&key.0, &reading, self.context).map_err(|error| match error.kind {
            ErrorKind::Io => blame(error, &at),
            _ => error,
        })?;
        let id = push_image(&mut self.scene, image);
        self.images.insert(key, id);
        Ok(id)
    }

    /// The mapping of a texture by the matrix `to_uv`, times a factor. The result's v runs up if it `is_picture`.
    fn mapping(&self, to_uv: &DMat4, factor: f64, is_picture: bool) -> Mapping {
        let m = to_uv.transpose().to_cols_array_2d();
        // Of (u, 1 − v); on disks, where our u is the angle and our v runs from the edge to the centre, of (1 − v, u).
        let row = |[u, v, _, offset]: [f64; 4]| match self.is_on_disk {
            true => [v, -u, u + offset].map(|value| value * factor),
            false => [u, -v, v + offset].map(|value| value * factor),
        };
        let (s, t) = (row(m[0]), row(m[1]));
        let t = if is_picture { [-t[0], -t[1], 1.0 - t[2]] } else { t };
        if s[1] == 0.0 && t[0] == 0.0 {
            let [scale, offset] = [[s[0], t[1]], [s[2], t[2]]].map(|pair| pair.map(|value| value as f32));
            return Mapping::Uv { scale, offset };
        }
        Mapping::Affine { set: 0, matrix: [s, t].map(|row| row.map(|value| value as f32)) }
    }
}
