//! `[[light]]` of type "environment": infinite area lights.

use glam::{DMat4, DVec3, DVec4};

use super::Reader;
use super::light::{COMMON, power, turned};
use super::table::Table;
use super::transform::invertible_rows;
use super::value::Value;
use crate::error::{Error, Result};
use crate::light::{LightKind, MapRows, Power, Sky, is_rectangle, panorama_fault};
use crate::scene::ImageId;

/// The keys besides those of the colours.
const ALWAYS: &[&str] = &["illuminance", "portal", "illuminates"];

/// The words for the layouts of environment maps; `None` for the octahedral one.
pub(super) const LAYOUTS: &[(&str, Option<MapRows>)] = &[
    ("latitude_longitude", Some(MapRows::Bands)),
    ("latitude_longitude_to_poles", Some(MapRows::ToPoles)),
    ("octahedral", None),
];

impl Reader<'_, '_> {
    pub(super) fn environment(&mut self, table: &Table<'_>) -> Result<(LightKind, Power)> {
        let portal = table.maybe("portal", portal);
        let illuminates = table.or("illuminates", true, Value::boolean);
        let (sky, scale) = self.sky(table)?;
        let kind = LightKind::Environment { sky, portal, illuminates };
        Ok((kind, power(table, "illuminance", scale)))
    }

    fn sky(&mut self, table: &Table<'_>) -> Result<(Sky, f32)> {
        let Some(value) = table.one_of(&["color", "zenith", "image"]) else {
            let error = table.error("it has no colours");
            let error = error.hint("give `color`, or `zenith` and `horizon`, or `image`");
            table.lacks(&["color", "zenith", "image"], error);
            return Err(Error::untold());
        };
        table.sound(&["color", "zenith", "image"])?;
        let groups: [(&str, &[&str]); 3] = [
            ("color", &["color"]),
            ("zenith", &["zenith", "horizon", "nadir"]),
            ("image", &["image", "layout", "scale", "rotate", "matrix"]),
        ];
        for (word, keys) in groups {
            if word == value.key() {
                table.allow(&[COMMON, ALWAYS, keys]);
            }
        }
        Ok(match value.key() {
            "color" => {
                let (color, scale) = self.light_color(value, false)?;
                (Sky::Constant(color), scale)
            }
            "zenith" => {
                let horizon = table.need("horizon", "[1, 1, 1]", [1.0; 3], |value| self.light_rgb(value));
                let nadir = table.or("nadir", horizon, |value| self.light_rgb(value));
                (Sky::Gradient { zenith: self.light_rgb(value)?, horizon, nadir }, 1.0)
            }
            _ => (self.sky_picture(table, value)?, 1.0),
        })
    }

    fn sky_picture(&mut self, table: &Table<'_>, value: Value<'_>) -> Result<Sky> {
        let rows = table.or("layout", Some(MapRows::Bands), |value| value.choice(LAYOUTS));
        let scale = table.or("scale", [1.0; 3], |value| self.light_rgb(value));
        table.one_of(&["rotate", "matrix"]);
        let (turn, matrix) = (turned(table), table.maybe("matrix", invertible_rows));
        let image = if rows.is_none() { self.octahedral_image(value)? } else { self.image(value)? };
        if let Some(rows) = rows {
            if let Some(fault) = panorama_fault(&self.scene.images[image.index()]) {
                self.context.warn(&value.at(), fault);
            }
            return Ok(Sky::Image { image, scale, world_from_light: matrix.unwrap_or(turn), rows });
        }
        let world_from_light = matrix.unwrap_or_else(|| turn * up_from_pole());
        Ok(Sky::Octahedral { image, scale, world_from_light })
    }

    /// A square octahedral map of all directions.
    pub(super) fn octahedral_image(&mut self, value: Value<'_>) -> Result<ImageId> {
        let id = self.image(value)?;
        let (width, height) = (self.scene.images[id.index()].width, self.scene.images[id.index()].height);
        if width == height {
            return Ok(id);
        }
        Err(value
            .error(format!("an octahedral picture must be square, but this one is {width}×{height}"))
            .hint("a picture in latitude and longitude needs an environment without `layout`"))
    }
}

/// The rotation from the octahedral map's space, whose centre is +z, to our space with y up.
pub(super) fn up_from_pole() -> DMat4 {
    DMat4::from_cols(DVec4::X, -DVec4::Z, DVec4::Y, DVec4::W)
}

/// The corners of a rectangle, in order around it.
pub(super) fn portal(value: Value<'_>) -> Result<[DVec3; 4]> {
    let mut corners = [DVec3::ZERO; 4];
    for (corner, item) in
        corners.iter_mut().zip(value.list_of::<4>("four points, the corners of an opening")?)
    {
        *corner = item.vector()?;
    }
    if is_rectangle(&corners) {
        return Ok(corners);
    }
    Err(value
        .error("the corners of `portal` do not form a rectangle")
        .hint("give the four corners of the opening in order around it"))
}
