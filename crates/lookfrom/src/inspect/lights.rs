//! The lights of a scene and where they are.

use glam::DVec3;
use serde::Serialize;

use crate::light::Light;
use crate::world::World;

/// A light, by its index in reports.
#[derive(Clone, Debug, Serialize)]
pub struct LightPlace {
    /// Its name.
    pub name: String,
    /// `point`, `spot`, `distant`, `projection`, `goniometric`, `area` or `environment`.
    pub kind: &'static str,
    /// Its position in the world, if it is a point.
    pub position: Option<[f64; 3]>,
    /// Toward it, unit length, if it is infinitely far away in one direction.
    pub toward: Option<[f32; 3]>,
}

/// The lights of a world, in the order of their indices.
pub fn lights(world: &World) -> Vec<LightPlace> {
    let place = |light: &Light| -> (&'static str, Option<DVec3>, Option<[f32; 3]>) {
        match light {
            Light::Point { position, .. } => ("point", Some(*position), None),
            Light::Spot { position, .. } => ("spot", Some(*position), None),
            Light::Distant { toward, .. } => ("distant", None, Some(toward.to_array())),
            Light::Projection(light) => ("projection", Some(light.position), None),
            Light::Goniometric(light) => ("goniometric", Some(light.position), None),
            Light::Area(_) => ("area", None, None),
            Light::Environment(_) => ("environment", None, None),
        }
    };
    let named = world.lights.iter().zip(&world.names.lights);
    named
        .map(|(light, name)| {
            let (kind, position, toward) = place(light);
            let position = position.map(|position| (world.origin + position).to_array());
            LightPlace { name: name.clone(), kind, position, toward }
        })
        .collect()
}
