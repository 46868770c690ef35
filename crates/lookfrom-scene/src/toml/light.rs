//! `[[light]]`: lights, and lamps that are shapes.

use glam::{DMat4, DVec3};

use super::Reader;
use super::form::tangents;
use super::place::{about, rotate};
use super::table::{Kinds, Table};
use super::value::Value;
use crate::error::Result;
use crate::light::{Amount, Falloff, Light, LightKind};
use crate::material::Color;
use crate::shape::{Emission, Geometry, Shape, Sphere};

/// The keys of lights, by type, besides [`COMMON`].
pub(super) const KEYS: Kinds = &[
    ("ambient", &["color"]),
    ("point", &["position", "intensity", "power", "falloff"]),
    ("distant", &["direction", "from", "to", "intensity", "illuminance"]),
    (
        "spot",
        &["position", "target", "direction", "intensity", "power", "cone_angle", "inner_angle", "falloff"],
    ),
    ("projection", &["position", "target", "direction", "up", "image", "intensity", "power", "fov"]),
    ("goniometric", &["position", "image", "intensity", "power", "rotate"]),
    (
        "rectangle",
        &[
            "corner",
            "edge_u",
            "edge_v",
            "center",
            "target",
            "width",
            "height",
            "radiance",
            "power",
            "two_sided",
        ],
    ),
    ("disk", &["center", "normal", "target", "radius", "radiance", "power", "two_sided"]),
    ("sphere", &["center", "radius", "radiance", "power"]),
    (
        "environment",
        &[
            "color",
            "zenith",
            "horizon",
            "nadir",
            "image",
            "layout",
            "scale",
            "rotate",
            "illuminance",
            "portal",
            "illuminates",
        ],
    ),
];
/// What every light may have.
pub(super) const COMMON: &[&str] = &["type", "name"];

impl Reader<'_, '_> {
    /// One `[[light]]`.
    pub(super) fn read_light(&mut self, table: &Table<'_>) -> Result<()> {
        let word = table.kind(KEYS, None, |_| COMMON)?;
        let (kind, amount) = match word {
            "ambient" => {
                let color = self.light_rgb(table.need("color", "0.1")?)?;
                (LightKind::Ambient { color }, Amount::AS_WRITTEN)
            }
            "point" => {
                let position = table.need("position", "[0, 5, 0]")?.vector()?;
                let (intensity, amount) = self.intensity(table, "power")?;
                (LightKind::Point { position, intensity, falloff: falloff(table)? }, amount)
            }
            "distant" => {
                let direction = distant_direction(table)?;
                let (intensity, amount) = self.intensity(table, "illuminance")?;
                (LightKind::Distant { direction, intensity }, amount)
            }
            "spot" => self.spot(table)?,
            "projection" => self.projection(table)?,
            "goniometric" => self.goniometric(table)?,
            "environment" => self.environment(table)?,
            _ => return self.read_lamp(word, table),
        };
        let name = name(table)?;
        self.scene.lights.push(Light { name, at: table.at(), kind, amount });
        Ok(())
    }

    /// A light that is a shape.
    fn read_lamp(&mut self, word: &str, table: &Table<'_>) -> Result<()> {
        let geometry = match word {
            "rectangle" => rectangle(table)?,
            "disk" => {
                let center = table.need("center", "[0, 5, 0]")?.vector()?;
                let normal = match table.one_of(&["normal", "target"])? {
                    Some(value) if value.key() == "target" => towards(value, center)?,
                    Some(value) => value.direction()?,
                    None => {
                        return Err(table
                            .error("`normal` or `target` is missing")
                            .hint("add `target = [0, 0, 0]`"));
                    }
                };
                Geometry::Disk { center, normal, radius: table.need("radius", "1")?.positive()? }
            }
            _ => Geometry::Sphere(Sphere {
                center: table.need("center", "[0, 5, 0]")?.vector()?,
                radius: table.need("radius", "1")?.positive()?,
            }),
        };
        let (radiance, scale) = match table.find("radiance") {
            None if table.has("power") => (Color::gray(1.0), 1.0),
            _ => self.light_color(table.need("radiance", "10")?, true)?,
        };
        let amount = amount(table, "power", scale)?;
        let two_sided = table.or("two_sided", false, Value::boolean)?;
        let shape = Shape {
            name: name(table)?,
            emission: Some(Emission { radiance, amount, two_sided }),
            ..Shape::new(table.at(), geometry, self.black_material())
        };
        self.scene.shapes.push(shape);
        Ok(())
    }

    /// `intensity` and how much of it; `total` is the key that may say so instead.
    pub(super) fn intensity(&mut self, table: &Table<'_>, total: &str) -> Result<(Color, Amount)> {
        let (color, scale) = match table.find("intensity") {
            None if table.has(total) => (Color::gray(1.0), 1.0),
            _ => self.light_color(table.need("intensity", "1")?, false)?,
        };
        Ok((color, amount(table, total, scale)?))
    }
}

/// How much light: as the key `total` says, or else as the colour, times `scale`, says.
pub(super) fn amount(table: &Table<'_>, total: &str, scale: f32) -> Result<Amount> {
    let total = table.or(total, None, |value| {
        value.single_where("a number of at least 0", |total| total >= 0.0).map(Some)
    })?;
    // What it comes to is then known, whatever the colour's brightness.
    let scale = if total.is_some() { 1.0 } else { scale };
    Ok(Amount { scale, total, absolute: false })
}

/// `rotate`: degrees about y, or as for shapes.
pub(super) fn turned(table: &Table<'_>) -> Result<DMat4> {
    table.or("rotate", DMat4::IDENTITY, |value| {
        if value.is_number() { Ok(about(DVec3::Y, value.number()?)) } else { rotate(value) }
    })
}

pub(super) fn name(table: &Table<'_>) -> Result<Option<String>> {
    table.or("name", None, |value| Ok(Some(value.text("a name in quotes")?.to_owned())))
}

pub(super) fn falloff(table: &Table<'_>) -> Result<Falloff> {
    let words = [("none", Falloff::None), ("linear", Falloff::Linear), ("quadratic", Falloff::Quadratic)];
    table.or("falloff", Falloff::default(), |value| value.choice(&words))
}

/// The way from a point to the point that a value names.
fn towards(target: Value<'_>, from: DVec3) -> Result<DVec3> {
    let direction = target.vector()? - from;
    if direction.length_squared() > 0.0 && direction.length_squared().is_finite() {
        return Ok(direction);
    }
    Err(target
        .error(format!("`{}` is where the light is, or too far", target.key()))
        .hint("give another point"))
}

fn distant_direction(table: &Table<'_>) -> Result<DVec3> {
    match (table.one_of(&["direction", "from"])?, table.one_of(&["direction", "to"])?) {
        (Some(value), None) if value.key() == "direction" => value.direction(),
        (Some(value), Some(_)) if value.key() == "direction" => value.direction(),
        (Some(from), Some(to)) => towards(to, from.vector()?),
        (Some(from), None) => Ok(-from.direction()?),
        (None, _) => Err(table
            .error("`direction` or `from` is missing")
            .hint("add `direction = [0, -1, 0]`, where the light goes to")),
    }
}

/// Where a light at `position` shines to.
pub(super) fn aim(table: &Table<'_>, position: DVec3) -> Result<DVec3> {
    match table.one_of(&["target", "direction"])? {
        Some(value) if value.key() == "target" => towards(value, position),
        Some(value) => value.direction(),
        None => Err(table.error("`target` or `direction` is missing").hint("add `target = [0, 0, 0]`")),
    }
}

/// By a corner and two edges, or by its middle, where it faces, and its sides.
fn rectangle(table: &Table<'_>) -> Result<Geometry> {
    if let Some(value) = table.find("center") {
        let keys: &[&str] = &["center", "target", "width", "height", "radiance", "power", "two_sided"];
        table.allow(&[COMMON, keys])?;
        let center = value.vector()?;
        let normal = towards(table.need("target", "[0, 0, 0]")?, center)?.normalize();
        let (u, v) = tangents(normal);
        let edge_u = u * table.need("width", "1")?.positive()?;
        let edge_v = v * table.need("height", "1")?.positive()?;
        return Ok(Geometry::Quad { corner: center - 0.5 * (edge_u + edge_v), edge_u, edge_v });
    }
    let keys: &[&str] = &["corner", "edge_u", "edge_v", "radiance", "power", "two_sided"];
    table.allow(&[COMMON, keys])?;
    super::shape::quad(table)
}
