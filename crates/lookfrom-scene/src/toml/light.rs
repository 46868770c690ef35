//! `[[light]]`: light sources, and area lights with a shape of their own.

use glam::{DMat4, DVec3};

use super::Reader;
use super::table::{Kinds, Table};
use super::transform::{about, rotate};
use super::value::Value;
use crate::composite::tangents;
use crate::error::{Error, Result};
use crate::light::{Falloff, Light, LightKind, Power};
use crate::material::Color;
use crate::shape::{Emission, Geometry, Shape, Sphere};

/// The keys of lights, by type, in addition to [`COMMON`].
pub(super) const KEYS: Kinds = &[
    ("ambient", &["color"]),
    ("point", &["position", "intensity", "power", "falloff"]),
    ("distant", &["direction", "from", "to", "intensity", "illuminance"]),
    (
        "spot",
        &[
            "position",
            "target",
            "direction",
            "intensity",
            "power",
            "cone_angle",
            "inner_angle",
            "edge",
            "falloff",
        ],
    ),
    (
        "projection",
        &[
            "position",
            "target",
            "direction",
            "up",
            "image",
            "filter",
            "quantity",
            "intensity",
            "power",
            "fov",
            "cone_angle",
            "inner_angle",
            "matrix",
        ],
    ),
    ("goniometric", &["position", "image", "filter", "intensity", "power", "rotate", "matrix"]),
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
            "matrix",
            "illuminance",
            "portal",
            "illuminates",
        ],
    ),
    (
        "sun_and_sky",
        &[
            "elevation",
            "azimuth",
            "from",
            "place",
            "date",
            "hour",
            "timezone",
            "turbidity",
            "albedo",
            "sun",
            "scale",
            "illuminance",
            "portal",
            "illuminates",
        ],
    ),
];
/// The words for the falloff with distance.
pub(super) const FALLOFFS: &[(&str, Falloff)] =
    &[("none", Falloff::None), ("linear", Falloff::Linear), ("quadratic", Falloff::Quadratic)];
/// Keys of all lights.
pub(super) const COMMON: &[&str] = &["type", "name"];

impl Reader<'_, '_> {
    /// Reads one `[[light]]`.
    pub(super) fn read_light(&mut self, table: &Table<'_>) {
        let Some(word) = table.kind(KEYS, None, |_| &[COMMON]) else { return };
        if let Err(error) = self.light(word, table) {
            table.note(error);
        }
    }

    fn light(&mut self, word: &str, table: &Table<'_>) -> Result<()> {
        let name = name(table);
        let (kind, power) = match word {
            "ambient" => {
                let color = table.need("color", "0.1", [1.0; 3], |value| self.light_rgb(value));
                (LightKind::Ambient { color }, Power::AS_WRITTEN)
            }
            "point" => {
                let (intensity, power) = self.intensity(table, "power");
                (LightKind::Point { position: position(table), intensity, falloff: falloff(table) }, power)
            }
            "distant" => {
                let (intensity, power) = self.intensity(table, "illuminance");
                let direction = distant_direction(table)?;
                (LightKind::Distant { direction, intensity }, power)
            }
            "spot" => self.spot(table)?,
            "projection" => self.projection(table)?,
            "goniometric" => self.goniometric(table),
            "environment" => self.environment(table)?,
            "sun_and_sky" => self.sun_and_sky(table)?,
            _ => return self.read_lamp(word, table, name),
        };
        self.scene.lights.push(Light { name, at: table.at(), kind, power });
        Ok(())
    }

    /// Reads a light that is a shape.
    fn read_lamp(&mut self, word: &str, table: &Table<'_>, name: Option<String>) -> Result<()> {
        let (radiance, scale) = match table.find("radiance") {
            None if table.has("power") || table.means(&["power"]) => (Color::gray(1.0), 1.0),
            _ => table.need("radiance", "10", (Color::BLACK, 1.0), |value| self.light_color(value, true)),
        };
        let power = power(table, "power", scale);
        let two_sided = table.or("two_sided", false, Value::boolean);
        let center = || table.need("center", "[0, 5, 0]", DVec3::ZERO, Value::vector);
        let radius = || table.need("radius", "1", 1.0, Value::positive);
        let geometry = match word {
            "rectangle" => rectangle(table)?,
            "disk" => {
                let (center, radius) = (center(), radius());
                let normal = facing(table, ["target", "normal"], center, "add `target = [0, 0, 0]`");
                Geometry::Disk { center, normal, radius }
            }
            _ => Geometry::Sphere(Sphere { center: center(), radius: radius() }),
        };
        let shape = Shape {
            name,
            emission: Some(Emission { radiance, power, two_sided }),
            ..Shape::new(table.at(), geometry, self.black_material())
        };
        self.scene.shapes.push(shape);
        Ok(())
    }

    /// `intensity` and its power; `total` is the key of the total power.
    pub(super) fn intensity(&mut self, table: &Table<'_>, total: &str) -> (Color, Power) {
        self.intensity_by(table, total, amount)
    }

    /// [`Reader::intensity`], with a total that is read by a function.
    pub(super) fn intensity_by(
        &mut self,
        table: &Table<'_>,
        total: &str,
        amount: impl Fn(Value<'_>) -> Result<f32>,
    ) -> (Color, Power) {
        let (color, scale) = match table.find("intensity") {
            None if table.has(total) || table.means(&[total]) => (Color::gray(1.0), 1.0),
            _ => table.need("intensity", "1", (Color::BLACK, 1.0), |value| self.light_color(value, false)),
        };
        (color, power_by(table, total, scale, amount))
    }
}

/// The keys of a power that is a table.
pub(super) const POWER: &[&str] = &["total", "scale", "absolute"];

/// The power: the total in the key `total`, or else that of the colour, times `scale`; or a table of all that there is.
pub(super) fn power(table: &Table<'_>, total: &str, scale: f32) -> Power {
    power_by(table, total, scale, amount)
}

/// [`power`], with a total that is read by a function.
fn power_by(table: &Table<'_>, total: &str, scale: f32, amount: impl Fn(Value<'_>) -> Result<f32>) -> Power {
    if let Some(value) = table.find(total).filter(|value| value.is_table()) {
        let power = value.table(format!("`{total}`")).map(|table| written_power(&table, amount));
        return value.noting(power, Power::AS_WRITTEN);
    }
    let total = table.or(total, None, |value| amount(value).map(Some));
    // The total replaces the brightness of the colour, so `scale` has no effect.
    let scale = if total.is_some() { 1.0 } else { scale };
    Power { scale, total, absolute: false }
}

/// A total, a factor of it or of the colour, and whether the brightness of a spectrum counts.
fn written_power(table: &Table<'_>, total: impl Fn(Value<'_>) -> Result<f32>) -> Power {
    table.allow(&[POWER]);
    Power {
        scale: table.or("scale", 1.0, amount),
        total: table.maybe("total", total),
        absolute: table.or("absolute", false, Value::boolean),
    }
}

/// An amount of light, or a factor of it.
pub(super) fn amount(value: Value<'_>) -> Result<f32> {
    value.single_where("a number of at least 0", |number| number >= 0.0)
}

/// `rotate`: degrees about y, or a rotation as of shapes.
pub(super) fn turned(table: &Table<'_>) -> DMat4 {
    table.or("rotate", DMat4::IDENTITY, |value| {
        if value.is_number() { Ok(about(DVec3::Y, value.number()?)) } else { rotate(value) }
    })
}

pub(super) fn name(table: &Table<'_>) -> Option<String> {
    table.maybe("name", |value| value.text("a name in quotes").map(str::to_owned))
}

pub(super) fn falloff(table: &Table<'_>) -> Falloff {
    table.or("falloff", Falloff::default(), |value| value.choice(FALLOFFS))
}

/// The vector from a point to a target point.
fn towards(target: Value<'_>, from: DVec3) -> Result<DVec3> {
    let direction = target.vector()? - from;
    if direction.length_squared() > 0.0 && direction.length_squared().is_finite() {
        return Ok(direction);
    }
    Err(target
        .error(format!("`{}` is at the position of the light, or too far away", target.key()))
        .hint("give another point"))
}

fn distant_direction(table: &Table<'_>) -> Result<DVec3> {
    table.one_of(&["direction", "from"]);
    table.one_of(&["direction", "to"]);
    let direction = table.maybe("direction", Value::direction);
    let from = table.maybe("from", Value::vector);
    table.sound(&["direction", "from", "to"])?;
    if !table.has("direction") && !table.has("from") {
        let error = table.error("`direction` or `from` is missing");
        let error = error.hint("add `direction = [0, -1, 0]`, the direction in which the light travels");
        table.lacks(&["direction", "from"], error);
        return Err(Error::untold());
    }
    match (direction, from, table.find("to")) {
        (Some(direction), ..) => Ok(direction),
        (None, Some(from), Some(to)) => towards(to, from),
        _ => Ok(-table.or("from", DVec3::Y, Value::direction)),
    }
}

/// The position of a light.
pub(super) fn position(table: &Table<'_>) -> DVec3 {
    table.need("position", "[0, 5, 0]", DVec3::ZERO, Value::vector)
}

/// The direction of a light at `position`.
pub(super) fn aim(table: &Table<'_>, position: DVec3) -> DVec3 {
    facing(table, ["target", "direction"], position, "add `target = [0, 0, 0]`")
}

/// The direction from a point to a target point, or a given direction.
fn facing(table: &Table<'_>, [target, direction]: [&str; 2], from: DVec3, remedy: &str) -> DVec3 {
    let is_placed = table.sound(&["position", "center"]).is_ok();
    if let Some(value) = table.one_of(&[target, direction]) {
        return table.or(value.key(), -DVec3::Y, |value| match value.key() == target {
            true if is_placed => towards(value, from),
            true => value.vector().map(|_| -DVec3::Y),
            false => value.direction(),
        });
    }
    let error = table.error(format!("`{target}` or `{direction}` is missing")).hint(remedy);
    table.lacks(&[target, direction], error);
    -DVec3::Y
}

/// A rectangle given by a corner and two edges, or by centre, target, width and height.
fn rectangle(table: &Table<'_>) -> Result<Geometry> {
    if table.has("center") {
        let keys: &[&str] = &["center", "target", "width", "height", "radiance", "power", "two_sided"];
        table.allow(&[COMMON, keys]);
        let center = table.or("center", DVec3::ZERO, Value::vector);
        let width = table.or("width", 1.0, Value::positive);
        let height = table.or("height", 1.0, Value::positive);
        let target = table.need("target", "[0, 0, 0]", None, |value| value.vector().map(|_| Some(value)));
        table.sound(&["center", "target"])?;
        let Some(target) = target else { return Err(Error::untold()) };
        let (u, v) = tangents(towards(target, center)?.normalize());
        let (edge_u, edge_v) = (u * width, v * height);
        return Ok(Geometry::Quad { corner: center - 0.5 * (edge_u + edge_v), edge_u, edge_v });
    }
    let keys: &[&str] = &["corner", "edge_u", "edge_v", "radiance", "power", "two_sided"];
    table.allow(&[COMMON, keys]);
    super::shape::quad(table)
}
