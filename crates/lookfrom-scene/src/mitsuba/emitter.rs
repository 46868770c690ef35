//! Emitters.
//!
//! Mitsuba's point lights have intensities in W/sr and its directional lights irradiances, ours Whitted's `I_j`: smaller by a factor of
//! π.

use std::f32::consts::FRAC_1_PI;

use glam::{DMat4, DVec3};

use super::Reader;
use super::plugin::{Plugin, Value};
use crate::error::{Error, ErrorKind, Result};
use crate::light::{Falloff, Light, LightKind, Power, Sky};
use crate::material::Color;
use crate::shape::Emission;

const KINDS: &[&str] = &["area", "constant", "directional", "envmap", "point", "spot"];

impl Reader<'_, '_> {
    pub(super) fn emitter(&mut self, plugin: &Plugin) -> Result<()> {
        plugin.ignore(&["sampling_weight"]);
        let to_world = plugin.to_world()?;
        let position = to_world.w_axis.truncate();
        let forward = to_world.transform_vector3(DVec3::Z);
        let (kind, scale) = match &*plugin.kind {
            "point" => {
                let position = plugin.vector("position")?.unwrap_or(position);
                let (intensity, scale) = self.light_color(plugin, "intensity")?;
                (LightKind::Point { position, intensity, falloff: Falloff::Quadratic }, scale * FRAC_1_PI)
            }
            "spot" => {
                let (intensity, scale) = self.light_color(plugin, "intensity")?;
                let cutoff = plugin
                    .float_where("cutoff_angle", 20.0, "an angle in (0, 180]", |a| a > 0.0 && a <= 180.0)?;
                let inner = plugin.float_where(
                    "beam_width",
                    0.75 * cutoff,
                    "an angle from 0 to `cutoff_angle`",
                    |a| (0.0..=cutoff).contains(&a),
                )?;
                if plugin.find("texture").is_some() {
                    let message = "a spot with a texture is not supported";
                    let error = Error::new(ErrorKind::Unsupported, &plugin.at, message);
                    return Err(error.hint("take its <texture> out"));
                }
                let message = "between `beam_width` and `cutoff_angle` a spot fades by a smoothstep, in Mitsuba linearly";
                self.warn_once(&plugin.at, message);
                let kind = LightKind::Spot {
                    position,
                    direction: forward,
                    intensity,
                    cone_angle: cutoff,
                    inner_angle: inner,
                    falloff: Falloff::Quadratic,
                };
                (kind, scale * FRAC_1_PI)
            }
            "directional" => {
                let direction = plugin.vector("direction")?.unwrap_or(forward);
                if direction.try_normalize().is_none() {
                    return Err(plugin.refuse("direction", "a vector other than 0"));
                }
                let (intensity, scale) = self.light_color(plugin, "irradiance")?;
                (LightKind::Distant { direction, intensity }, scale * FRAC_1_PI)
            }
            "constant" => {
                let (radiance, scale) = self.light_color(plugin, "radiance")?;
                (
                    LightKind::Environment { sky: Sky::Constant(radiance), portal: None, illuminates: true },
                    scale,
                )
            }
            "envmap" => {
                let scale =
                    plugin.float_where("scale", 1.0, "a number of at least 0", |scale| scale >= 0.0)?;
                let image = self.image(plugin, false)?;
                // u = 0 is −z in Mitsuba, u = ½ here.
                let turned = to_world * DMat4::from_scale(DVec3::new(-1.0, 1.0, -1.0));
                let sky = Sky::Image { image, scale: [scale as f32; 3], world_from_light: turned };
                (LightKind::Environment { sky, portal: None, illuminates: true }, 1.0)
            }
            "area" => {
                let error = Error::invalid(&plugin.at, "an area light is a part of a shape");
                return Err(error.hint("write <emitter type=\"area\"> in a <shape>"));
            }
            _ => return Err(plugin.unsupported(KINDS)),
        };
        let power = Power { scale, ..Power::AS_WRITTEN };
        self.scene.lights.push(Light { name: plugin.id.clone(), at: plugin.at.clone(), kind, power });
        Ok(())
    }

    /// The emission of a shape.
    pub(super) fn emission(&mut self, plugin: &Plugin) -> Result<Emission> {
        if plugin.kind != "area" {
            return Err(plugin.unsupported(&["area"]));
        }
        plugin.ignore(&["sampling_weight"]);
        let texture = match plugin.find("radiance").map(|property| &property.value) {
            Some(Value::Plugin(_) | Value::Reference(_)) => plugin
                .find("radiance")
                .map_or(Ok(None), |property| property.plugin(&self.ids))?
                .filter(|radiance| radiance.class == "texture"),
            _ => None,
        };
        if let Some(texture) = texture {
            return Ok(Emission::new(Color::Texture(self.texture(&texture)?), false));
        }
        let (radiance, scale) = self.light_color(plugin, "radiance")?;
        let power = Power { scale, ..Power::AS_WRITTEN };
        Ok(Emission { radiance, power, two_sided: false })
    }
}
