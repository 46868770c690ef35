//! Lights that are no shapes.

use glam::{DMat4, DVec3};

use super::Writer;
use super::color::{plain_color, put_power};
use super::names::spoken;
use super::picture::For;
use super::placing::{put_matrix, same_bits};
use super::text::Fields;
use crate::error::Result;
use crate::light::{Edge, Falloff, Light, LightKind, MapRows, Power, Projected, Sky};
use crate::texture::TexelFilter;
use crate::toml::directional::{EDGES, PICTURE_FILTERS, QUANTITIES};
use crate::toml::light::FALLOFFS;
use crate::toml::sky::{LAYOUTS, up_from_pole};
use crate::toml::transform::about;
use crate::toml::word_of;

impl Writer<'_> {
    pub(super) fn light(&mut self, light: &Light) -> Result<Fields> {
        let mut fields = Fields::default();
        let Light { name, kind, power, .. } = light;
        fields.put("type", kind.word());
        if let Some(name) = name {
            fields.put("name", spoken("light", name));
        }
        match kind {
            LightKind::Ambient { color } => fields.put("color", plain_color(*color)),
            LightKind::Point { position, intensity, falloff } => {
                fields.put("position", *position);
                self.put_light(&mut fields, ["intensity", "power"], *intensity, power)?;
                put_falloff(&mut fields, *falloff);
            }
            LightKind::Distant { direction, intensity } => {
                fields.put("direction", *direction);
                self.put_light(&mut fields, ["intensity", "illuminance"], *intensity, power)?;
            }
            LightKind::Spot { position, direction, intensity, cone_angle, inner_angle, edge, falloff } => {
                fields.put("position", *position);
                fields.put("direction", *direction);
                self.put_light(&mut fields, ["intensity", "power"], *intensity, power)?;
                fields.put_unless("cone_angle", *cone_angle, 30.0);
                fields.put_unless("inner_angle", *inner_angle, 0.8 * cone_angle);
                if *edge != Edge::default() {
                    fields.put("edge", word_of(EDGES, edge));
                }
                put_falloff(&mut fields, *falloff);
            }
            LightKind::Projection { image, filter, quantity, intensity, cone, fov, world_from_light } => {
                put_matrix(&mut fields, "matrix", world_from_light);
                let picture = self.picture(*image, For::Light)?;
                fields.put("image", picture.file);
                fields.put_unless("intensity", *intensity, 1.0);
                fields.put_unless("fov", *fov, 45.0);
                if *filter != TexelFilter::Nearest {
                    fields.put("filter", word_of(PICTURE_FILTERS, filter));
                }
                if *quantity != Projected::default() {
                    fields.put("quantity", word_of(QUANTITIES, quantity));
                }
                if let Some([outer, inner]) = *cone {
                    fields.put("cone_angle", outer);
                    fields.put_unless("inner_angle", inner, outer);
                }
                put_power(&mut fields, "power", power);
            }
            LightKind::Goniometric { intensity, image, filter, world_from_light } => {
                let position = world_from_light.w_axis.truncate();
                let placed = DMat4::from_translation(position) * DMat4::IDENTITY * up_from_pole();
                match same_bits(world_from_light, &placed) {
                    true => fields.put("position", position),
                    false => put_matrix(&mut fields, "matrix", world_from_light),
                }
                let picture = self.picture(*image, For::Light)?;
                fields.put("image", picture.file);
                if *filter != TexelFilter::Nearest {
                    fields.put("filter", word_of(PICTURE_FILTERS, filter));
                }
                self.put_light(&mut fields, ["intensity", "power"], *intensity, power)?;
            }
            LightKind::Environment { sky, portal, illuminates } => {
                self.sky(&mut fields, sky, power)?;
                if let Some(corners) = portal {
                    fields.put("portal", *corners);
                }
                fields.put_unless("illuminates", *illuminates, true);
            }
        }
        Ok(fields)
    }

    fn sky(&mut self, fields: &mut Fields, sky: &Sky, power: &Power) -> Result<()> {
        match sky {
            Sky::Constant(color) => return self.put_light(fields, ["color", "illuminance"], *color, power),
            Sky::Gradient { zenith, horizon, nadir } => {
                fields.put("zenith", plain_color(*zenith));
                fields.put("horizon", plain_color(*horizon));
                if nadir != horizon {
                    fields.put("nadir", plain_color(*nadir));
                }
            }
            Sky::Image { image, scale, world_from_light, rows } => {
                let picture = self.picture(*image, For::Light)?;
                fields.put("image", picture.file);
                if *rows != MapRows::default() {
                    fields.put("layout", word_of(LAYOUTS, &Some(*rows)));
                }
                put_scale(fields, *scale);
                put_turn(fields, world_from_light, |turn| turn);
            }
            Sky::Octahedral { image, scale, world_from_light } => {
                let picture = self.picture(*image, For::Light)?;
                fields.put("image", picture.file);
                fields.put("layout", "octahedral");
                put_scale(fields, *scale);
                put_turn(fields, world_from_light, |turn| turn * up_from_pole());
            }
        }
        put_power(fields, "illuminance", power);
        Ok(())
    }
}

fn put_falloff(fields: &mut Fields, falloff: Falloff) {
    if falloff != Falloff::default() {
        fields.put("falloff", word_of(FALLOFFS, &falloff));
    }
}

fn put_scale(fields: &mut Fields, scale: [f32; 3]) {
    if scale != [1.0; 3] {
        fields.put("scale", plain_color(scale));
    }
}

/// The rotation of an environment: none, about y, or by a matrix. `placed` is what the reader makes of a rotation.
fn put_turn(fields: &mut Fields, matrix: &DMat4, placed: impl Fn(DMat4) -> DMat4) {
    if same_bits(matrix, &placed(DMat4::IDENTITY)) {
        return;
    }
    let turn = *matrix * placed(DMat4::IDENTITY).inverse();
    let degrees = libm::atan2(turn.z_axis.x, turn.z_axis.z).to_degrees();
    let around = [degrees, degrees + 360.0].map(|degrees| libm::round(degrees * 1e6) / 1e6);
    match around.into_iter().find(|degrees| same_bits(matrix, &placed(about(DVec3::Y, *degrees)))) {
        Some(degrees) => fields.put("rotate", degrees),
        None => put_matrix(fields, "matrix", matrix),
    }
}
