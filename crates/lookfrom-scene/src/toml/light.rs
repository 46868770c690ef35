//! `[[light]]`: lights, and lamps that are shapes.

use glam::DVec3;

use super::Reader;
use super::color::plain_color;
use super::form::tangents;
use super::place::about;
use super::value::{Table, Value};
use crate::error::Result;
use crate::light::{Amount, Falloff, Light, LightKind, Sky};
use crate::material::Color;
use crate::shape::{Emission, Geometry, Shape, Sphere};

/// The keys of lights, by type, besides `type` and `name`.
pub(super) const KEYS: &[(&str, &[&str])] = &[
    ("ambient", &["color"]),
    ("point", &["position", "intensity", "falloff"]),
    ("distant", &["direction", "from", "to", "intensity"]),
    ("spot", &["position", "target", "direction", "intensity", "cone_angle", "inner_angle", "falloff"]),
    (
        "rectangle",
        &["corner", "edge_u", "edge_v", "center", "target", "width", "height", "radiance", "two_sided"],
    ),
    ("disk", &["center", "normal", "target", "radius", "radiance", "two_sided"]),
    ("sphere", &["center", "radius", "radiance"]),
    ("environment", &["color", "zenith", "horizon", "nadir", "image", "scale", "rotate", "illuminates"]),
];
/// What every light may have.
pub(super) const COMMON: &[&str] = &["type", "name"];

impl Reader<'_, '_> {
    /// One `[[light]]`.
    pub(super) fn read_light(&mut self, table: &Table<'_>) -> Result<()> {
        let types: Vec<(&str, usize)> =
            KEYS.iter().enumerate().map(|(index, &(word, _))| (word, index)).collect();
        let (word, keys) = KEYS[table.need("type", "\"point\"")?.choice(&types)?];
        table.allow(&[COMMON, keys])?;
        let kind = match word {
            "ambient" => LightKind::Ambient { color: plain_color(table.need("color", "0.1")?)? },
            "point" => LightKind::Point {
                position: table.need("position", "[0, 5, 0]")?.vector()?,
                intensity: intensity(table)?,
                falloff: falloff(table)?,
            },
            "distant" => {
                LightKind::Distant { direction: distant_direction(table)?, intensity: intensity(table)? }
            }
            "spot" => spot(table)?,
            "environment" => LightKind::Environment {
                sky: self.sky(table)?,
                portal: None,
                illuminates: table.or("illuminates", true, Value::boolean)?,
            },
            _ => return self.read_lamp(word, table),
        };
        let name = name(table)?;
        self.scene.lights.push(Light { name, at: table.at(), kind, amount: Amount::AS_WRITTEN });
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
        let radiance = self.color(table.need("radiance", "10")?)?;
        let two_sided = table.or("two_sided", false, Value::boolean)?;
        let shape = Shape {
            name: name(table)?,
            emission: Some(Emission::new(radiance, two_sided)),
            ..Shape::new(table.at(), geometry, self.black_material())
        };
        self.scene.shapes.push(shape);
        Ok(())
    }

    fn sky(&mut self, table: &Table<'_>) -> Result<Sky> {
        let Some(value) = table.one_of(&["color", "zenith", "image"])? else {
            return Err(table
                .error("it has no colours")
                .hint("give `color`, or `zenith` and `horizon`, or `image`"));
        };
        let groups: [(&str, &[&str]); 3] = [
            ("color", &["color"]),
            ("zenith", &["zenith", "horizon", "nadir"]),
            ("image", &["image", "scale", "rotate"]),
        ];
        for (word, keys) in groups {
            if word == value.key() {
                table.allow(&[COMMON, &["illuminates"], keys])?;
            }
        }
        Ok(match value.key() {
            "color" => Sky::Constant(Color::Value(plain_color(value)?)),
            "zenith" => {
                let horizon = plain_color(table.need("horizon", "[1, 1, 1]")?)?;
                let nadir = table.or("nadir", horizon, plain_color)?;
                Sky::Gradient { zenith: plain_color(value)?, horizon, nadir }
            }
            _ => Sky::Image {
                image: self.image(value)?,
                scale: table.or("scale", [1.0; 3], plain_color)?,
                world_from_light: about(DVec3::Y, table.or("rotate", 0.0, Value::number)?),
            },
        })
    }
}

pub(super) fn name(table: &Table<'_>) -> Result<Option<String>> {
    table.or("name", None, |value| Ok(Some(value.text("a name in quotes")?.to_owned())))
}

fn intensity(table: &Table<'_>) -> Result<Color> {
    plain_color(table.need("intensity", "1")?).map(Color::Value)
}

fn falloff(table: &Table<'_>) -> Result<Falloff> {
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

fn spot(table: &Table<'_>) -> Result<LightKind> {
    let position = table.need("position", "[0, 5, 0]")?.vector()?;
    let direction = match table.one_of(&["target", "direction"])? {
        Some(value) if value.key() == "target" => towards(value, position)?,
        Some(value) => value.direction()?,
        None => {
            return Err(table.error("`target` or `direction` is missing").hint("add `target = [0, 0, 0]`"));
        }
    };
    let expected = "degrees, more than 0 and at most 180";
    let cone_angle = table.or("cone_angle", 30.0, |value| {
        value.number_where(expected, |angle| angle > 0.0 && angle <= 180.0)
    })?;
    let inner_angle = table.or("inner_angle", 0.8 * cone_angle, |value| {
        value.number_where("degrees from 0 to `cone_angle`", |angle| (0.0..=cone_angle).contains(&angle))
    })?;
    Ok(LightKind::Spot {
        position,
        direction,
        intensity: intensity(table)?,
        cone_angle,
        inner_angle,
        falloff: falloff(table)?,
    })
}

/// By a corner and two edges, or by its middle, where it faces, and its sides.
fn rectangle(table: &Table<'_>) -> Result<Geometry> {
    if let Some(value) = table.find("center") {
        let keys: &[&str] = &["center", "target", "width", "height", "radiance", "two_sided"];
        table.allow(&[COMMON, keys])?;
        let center = value.vector()?;
        let normal = towards(table.need("target", "[0, 0, 0]")?, center)?.normalize();
        let (u, v) = tangents(normal);
        let edge_u = u * table.need("width", "1")?.positive()?;
        let edge_v = v * table.need("height", "1")?.positive()?;
        return Ok(Geometry::Quad { corner: center - 0.5 * (edge_u + edge_v), edge_u, edge_v });
    }
    let keys: &[&str] = &["corner", "edge_u", "edge_v", "radiance", "two_sided"];
    table.allow(&[COMMON, keys])?;
    super::shape::quad(table)
}
