//! Punctual lights (`KHR_lights_punctual`).
//!
//! Units are photometric: candela, and lux for the sun. A radiance of 1 is a luminance of 1 cd/m², so no luminous efficacy
//! of 683 lm/W appears. Under an illuminance E a white diffuse surface has the luminance E/π; our intensities include this
//! 1/π. `range`, an aid for rasterisers, is ignored: light falls off with the square of the distance.

use glam::{DMat4, DVec3};

use super::file::Document;
use super::json;
use super::node::Tree;
use crate::error::Result;
use crate::files::LoadContext;
use crate::light::{Edge, Falloff, Light, LightKind, Power};
use crate::material::Color;

/// The punctual lights of the scene.
///
/// # Errors
/// If a node refers to a light that does not exist.
pub(super) fn lights(document: &Document, tree: &Tree, context: &mut LoadContext<'_>) -> Result<Vec<Light>> {
    let known = document.root.extensions.lights.as_ref().map_or(&[][..], |lights| &lights.lights);
    let mut lights = Vec::new();
    for &node in &tree.shown {
        let Some(used) = document.root.nodes[node].light() else { continue };
        let pointer = format!("/nodes/{node}/extensions/KHR_lights_punctual/light");
        let light = document.one_of(known, used.light, "light", &pointer)?;
        let at = document.at(&format!("/extensions/KHR_lights_punctual/lights/{}", used.light.0));
        match kind(light, &tree.world_from_node(node)) {
            Some(kind) => {
                let name = light.name.clone().or_else(|| document.root.nodes[node].name.clone());
                lights.push(Light { name, at, kind, power: Power::AS_WRITTEN });
            }
            None => {
                context.warn(&at, format!("a light {:?} with invalid values is left out", light.kind));
            }
        }
    }
    Ok(lights)
}

fn kind(light: &json::Light, world_from_node: &DMat4) -> Option<LightKind> {
    let strength = light.intensity.unwrap_or(1.0);
    let color = light.color.unwrap_or([1.0; 3]).map(|c| (c * strength / std::f64::consts::PI) as f32);
    if !color.iter().all(|&c| c >= 0.0 && c.is_finite()) {
        return None;
    }
    let intensity = Color::Value(color);
    let position = world_from_node.transform_point3(DVec3::ZERO);
    let direction = world_from_node.transform_vector3(DVec3::NEG_Z).try_normalize();
    let falloff = Falloff::Quadratic;
    if !position.is_finite() {
        return None;
    }
    match light.kind.as_str() {
        "directional" => Some(LightKind::Distant { direction: direction?, intensity }),
        "point" => Some(LightKind::Point { position, intensity, falloff }),
        "spot" => {
            let spot = light.spot.as_ref();
            let outer = spot.and_then(|spot| spot.outer_cone_angle).unwrap_or(std::f64::consts::FRAC_PI_4);
            let inner = spot.and_then(|spot| spot.inner_cone_angle).unwrap_or(0.0);
            let cone_angle = outer.to_degrees().clamp(0.0, 180.0);
            let inner_angle = inner.to_degrees().clamp(0.0, cone_angle);
            let direction = direction?;
            (cone_angle > 0.0).then_some(LightKind::Spot {
                position,
                direction,
                intensity,
                cone_angle,
                inner_angle,
                edge: Edge::Smooth,
                falloff,
            })
        }
        _ => None,
    }
}
