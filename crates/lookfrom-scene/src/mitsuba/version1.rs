//! Properties of Mitsuba's versions before 2, in the words of later ones, as Mitsuba itself upgrades them.

use glam::{DMat4, DVec3};

use super::plugin::{Property, Value};
use crate::error::Location;

/// Renames the properties of a plugin, whose names are in snake case already.
pub(super) fn upgrade(class: &str, kind: &str, at: &Location, properties: &mut Vec<Property>) {
    match class {
        "bsdf" if kind == "diffuse" => {
            for property in properties.iter_mut().filter(|property| property.name == "diffuse_reflectance") {
                property.name = "reflectance".into();
            }
        }
        "texture" => {
            let mut take = |name: &str, default: f64| {
                let is_it = |property: &Property| match property.value {
                    Value::Float(number) if property.name == name => Some(number),
                    _ => None,
                };
                let number = properties.iter().find_map(is_it);
                properties.retain(|property| is_it(property).is_none());
                number.unwrap_or(default)
            };
            let offset = DVec3::new(take("uoffset", 0.0), take("voffset", 0.0), 0.0);
            let scale = DVec3::new(take("uscale", 1.0), take("vscale", 1.0), 1.0);
            if offset != DVec3::ZERO || scale != DVec3::ONE {
                let to_uv = DMat4::from_scale(scale) * DMat4::from_translation(offset);
                properties.push(Property::new("to_uv", at.clone(), Value::Transform(to_uv)));
            }
        }
        _ => {}
    }
}
