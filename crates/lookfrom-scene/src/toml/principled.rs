//! The material "principled": the parameters of glTF's metallic-roughness model and its extensions.

use super::Reader;
use super::color::plain_color;
use super::table::Table;
use super::value::Value;
use crate::error::Result;
use crate::material::{Anisotropy, Color, Principled};

/// The keys of the type.
pub(super) const KEYS: &[&str] = &[
    "base_color",
    "metallic",
    "roughness",
    "anisotropy",
    "anisotropy_rotation",
    "anisotropy_map",
    "ior",
    "dispersion",
    "specular",
    "specular_color",
    "transmission",
    "solid",
    "absorption",
    "diffuse_transmission",
    "diffuse_transmission_color",
    "clearcoat",
    "clearcoat_roughness",
    "clearcoat_normal_map",
    "sheen_color",
    "sheen_roughness",
    "iridescence",
    "iridescence_ior",
    "iridescence_thickness",
];

/// The key of an angle that is not in degrees.
pub(super) const ANGLE: &[&str] = &["radians"];

impl Reader<'_, '_> {
    pub(super) fn principled(&mut self, table: &Table<'_>) -> Principled {
        let usual = Principled::default();
        let number = |key, default, expected, ok: fn(f32) -> bool| {
            table.or(key, default, |value| value.single_where(expected, ok))
        };
        let share = |key| number(key, 0.0, "a number from 0 to 1", |share| (0.0..=1.0).contains(&share));
        let strength = share("anisotropy");
        let rotation = table.or("anisotropy_rotation", 0.0, angle);
        let ior = number("ior", usual.ior, "a number of at least 1, or 0 for infinity", |ior| {
            ior >= 1.0 || ior == 0.0
        });
        let iridescence_ior =
            number("iridescence_ior", usual.iridescence_ior, "a number of at least 1", |ior| ior >= 1.0);
        let dispersion =
            number("dispersion", usual.dispersion, "a number of at least 0", |dispersion| dispersion >= 0.0);
        let thickness = table.or("iridescence_thickness", usual.iridescence_thickness, |value| {
            self.scalar_where(value, "a thickness in nm", |nm| nm >= 0.0)
        });
        let clearcoat_normal = table.maybe("clearcoat_normal_map", |value| self.normals(value));
        let along = table.maybe("anisotropy_map", |value| match self.color(value)? {
            Color::Texture(texture) => Ok(texture),
            _ => Err(value.wrong("a texture of directions")),
        });
        let is_solid = table.or("solid", usual.is_solid, Value::boolean);
        let absorption = table.or("absorption", usual.absorption, plain_color);
        if absorption != [0.0; 3] && !is_solid {
            self.ineffective(table, "absorption", "`solid = true`: a thin sheet has no inside");
        }
        // glTF's default is a rough white metal; without a word about it ours is grey plastic.
        Principled {
            base_color: self.color_or(table, "base_color", 0.8),
            metallic: self.share_or(table, "metallic", 0.0),
            roughness: self.share_or(table, "roughness", 0.5),
            anisotropy: (strength > 0.0).then_some(Anisotropy { strength, rotation, texture: along }),
            ior,
            dispersion,
            specular: self.share_or(table, "specular", 1.0),
            specular_color: self.color_or(table, "specular_color", 1.0),
            transmission: self.share_or(table, "transmission", 0.0),
            is_solid,
            absorption,
            diffuse_transmission: self.share_or(table, "diffuse_transmission", 0.0),
            diffuse_transmission_color: self.color_or(table, "diffuse_transmission_color", 1.0),
            clearcoat: self.share_or(table, "clearcoat", 0.0),
            clearcoat_roughness: self.share_or(table, "clearcoat_roughness", 0.0),
            clearcoat_normal,
            sheen_color: self.color_or(table, "sheen_color", 0.0),
            sheen_roughness: self.share_or(table, "sheen_roughness", 0.5),
            iridescence: self.share_or(table, "iridescence", 0.0),
            iridescence_ior,
            iridescence_thickness: thickness,
        }
    }
}

/// An angle in degrees, or a table of `radians`; in radians.
fn angle(value: Value<'_>) -> Result<f32> {
    if !value.is_table() {
        return value.single_where("an angle in degrees", |_| true).map(f32::to_radians);
    }
    let table = value.table("an angle")?;
    table.allow(&[ANGLE]);
    table.find("radians").ok_or_else(|| value.wrong("degrees, or { radians = 1.5 }"))?.single()
}
