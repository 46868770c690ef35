//! `[[light]]` of type "sun_and_sky": a clear sky and the sun in it.

use std::f64::consts::FRAC_PI_2;

use super::Reader;
use super::light::power;
use super::sky::{portal, up_from_pole};
use super::table::Table;
use super::value::Value;
use crate::atmosphere::ClearSky;
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
        table.sound(&["from", "elevation", "azimuth", "turbidity", "albedo", "scale", "sun"])?;
        let picture = ClearSky { elevation, azimuth, turbidity, albedo, has_sun }.octahedral("sun_and_sky");
        let image = ImageId(self.scene.images.len() as u32);
        self.scene.images.push(picture);
        let sky = Sky::Octahedral { image, scale: [scale; 3], world_from_light: up_from_pole() };
        Ok((LightKind::Environment { sky, portal, illuminates }, power))
    }
}

/// Elevation and azimuth of the sun in radians: as angles in degrees, or by the direction from which it shines.
fn sun(table: &Table<'_>) -> [f64; 2] {
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
