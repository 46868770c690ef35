//! The lights of a scene and where they are.

use glam::DVec3;
use serde::Serialize;

use crate::light::{EmitterBounds, Light};
use crate::world::World;

/// A light, by its index in reports.
#[derive(Clone, Debug, Serialize)]
pub struct LightPlace {
    /// Its name; of an area light, the name of its shape.
    pub name: String,
    /// `point`, `spot`, `distant`, `projection`, `goniometric`, `area` or `environment`.
    pub kind: &'static str,
    /// Its position in the world, if it has one; of an area light, the centre of its bounds.
    pub position: Option<[f64; 3]>,
    /// The bounds of an area light: minimum and maximum in the world.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// The area of an area light, of one side.
    pub area: Option<f64>,
    /// Toward it, unit length, if it is infinitely far away in one direction.
    pub toward: Option<[f32; 3]>,
}

/// The lights of a world, in the order of their indices.
pub fn lights(world: &World) -> impl Iterator<Item = LightPlace> {
    let place = |light: &Light| -> (&'static str, Option<DVec3>, Option<[f32; 3]>) {
        match light {
            Light::Point { position, .. } => ("point", Some(*position), None),
            Light::Spot { position, .. } => ("spot", Some(*position), None),
            Light::Distant { toward, .. } => ("distant", None, Some(toward.to_array())),
            Light::Projection(light) => ("projection", Some(light.position), None),
            Light::Goniometric(light) => ("goniometric", Some(light.position), None),
            Light::Area(light) => {
                let EmitterBounds { min, max, .. } = light.emitter_bounds();
                ("area", Some(min.midpoint(max)), None)
            }
            Light::Environment(_) => ("environment", None, None),
        }
    };
    let named = world.lights.iter().zip(&world.names.lights);
    named.map(move |(light, name)| {
        let (kind, position, toward) = place(light);
        let in_world = |point: DVec3| (world.origin + point).to_array();
        let (bounds, area) = match light {
            Light::Area(light) => {
                let EmitterBounds { min, max, .. } = light.emitter_bounds();
                (Some([min, max].map(in_world)), Some(light.area()))
            }
            _ => (None, None),
        };
        let position = position.map(in_world);
        LightPlace { name: name.clone(), kind, position, bounds, area, toward }
    })
}
