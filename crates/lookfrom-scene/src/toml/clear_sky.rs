//! `[[light]]` of type "sun_and_sky": a clear sky and the sun in it.

use std::f64::consts::FRAC_PI_2;

use super::Reader;
use super::light::power;
use super::sky::{portal, up_from_pole};
use super::table::Table;
use super::value::Value;
use crate::atmosphere::{ClearSky, PlaceAndTime, is_date};
use crate::error::Result;
use crate::light::{LightKind, Power, Sky};
use crate::scene::ImageId;

impl Reader<'_, '_> {
    pub(super) fn sun_and_sky(&mut self, table: &Table<'_>) -> Result<(LightKind, Power)> {
        let [elevation, azimuth] = sun(table);
        let turbidity = table.or("turbidity", 2.5, |value| {
            value.number_where("a number from 1, pure air, to 10, haze", |number| {
                (1.0..=10.0).contains(&number)
            })
        });
        let albedo = table.or("albedo", 0.2, |value| {
            value.number_where("a number from 0 to 1", |number| (0.0..=1.0).contains(&number))
        });
        let scale = table
            .or("scale", 1.0, |value| value.single_where("a number of at least 0", |number| number >= 0.0));
        let has_sun = table.or("sun", true, Value::boolean);
        let portal = table.maybe("portal", portal);
        let illuminates = table.or("illuminates", true, Value::boolean);
        let power = power(table, "illuminance", 1.0);
        table.sound(&["from", "elevation", "azimuth", "place", "turbidity", "albedo", "scale", "sun"])?;
        table.sound(&TIME)?;
        let picture = ClearSky { elevation, azimuth, turbidity, albedo, has_sun }.octahedral("sun_and_sky");
        let image = ImageId(self.scene.images.len() as u32);
        self.scene.images.push(picture);
        let sky = Sky::Octahedral { image, scale: [scale; 3], world_from_light: up_from_pole() };
        Ok((LightKind::Environment { sky, portal, illuminates }, power))
    }
}

/// The keys that tell the time at a `place`.
const TIME: [&str; 3] = ["date", "hour", "timezone"];

/// Elevation and azimuth of the sun in radians: as angles in degrees, by the direction from which it shines, or by place and time.
fn sun(table: &Table<'_>) -> [f64; 2] {
    if table.has("place") {
        for key in ["from", "elevation", "azimuth"] {
            table.one_of(&["place", key]);
        }
        return place_and_time(table).sun();
    }
    if let Some(value) = TIME.iter().find_map(|key| table.find(key)) {
        let message = format!("`{}` has no effect without a `place`", value.key());
        value.note(value.error(message).hint("add `place = [48.1, 11.6]`, its latitude and longitude"));
    }
    if table.has("from") {
        table.one_of(&["from", "elevation"]);
        table.one_of(&["from", "azimuth"]);
        return table.or("from", [FRAC_PI_2, 0.0], |value| {
            let from = value.direction()?.normalize();
            Ok([libm::asin(from.y.clamp(-1.0, 1.0)), libm::atan2(from.x, -from.z)])
        });
    }
    let elevation = table.or("elevation", 45.0, |value| {
        value.number_where("degrees from -90 to 90", |angle| (-90.0..=90.0).contains(&angle))
    });
    let azimuth = table.or("azimuth", 135.0, Value::number);
    [elevation, azimuth].map(f64::to_radians)
}

/// A `place` and the time there.
fn place_and_time(table: &Table<'_>) -> PlaceAndTime {
    let [latitude, longitude] = table.or("place", [0.0; 2], |value| {
        let expected =
            "a latitude from -90 to 90 and a longitude from -180 to 180, in degrees north and east";
        let place @ [latitude, longitude] = value.numbers(expected)?;
        let is_on_earth = latitude.abs() <= 90.0 && longitude.abs() <= 180.0;
        if is_on_earth { Ok(place) } else { Err(value.wrong(expected)) }
    });
    let date = table.need("date", "[2026, 6, 21]", [2000, 1, 1], |value| {
        let expected = "a year from 1900 to 2100, a month and a day of it";
        let numbers: [f64; 3] = value.numbers(expected)?;
        let date = numbers.map(|number| number as i32);
        let is_whole = date.map(f64::from) == numbers;
        if is_whole && is_date(date) { Ok(date) } else { Err(value.wrong(expected)) }
    });
    let within = |value: Value<'_>, expected: &str, [least, most]: [f64; 2]| {
        value.number_where(expected, |number| (least..=most).contains(&number))
    };
    PlaceAndTime {
        latitude,
        longitude,
        timezone: table.or("timezone", 0.0, |value| {
            within(value, "hours ahead of universal time, from -14 to 14", [-14.0, 14.0])
        }),
        date,
        hours: table
            .need("hour", "12", 12.0, |value| within(value, "an hour of the day, from 0 to 24", [0.0, 24.0])),
    }
}
