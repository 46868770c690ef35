//! Point lights that depend on direction: spot, projection and goniometric lights.

use std::f64::consts::PI;
use std::path::Path;

use glam::{DMat4, DVec3};

use super::Reader;
use super::light::{aim, amount, falloff, position, power, turned};
use super::sky::up_from_pole;
use super::table::Table;
use super::transform::invertible_rows;
use super::value::Value;
use crate::camera::up_across;
use crate::error::Result;
use crate::files::LoadContext;
use crate::ies;
use crate::light::{Edge, LightKind, Power, Projected};
use crate::scene::ImageId;
use crate::texture::TexelFilter;

/// The words for the edges of spot lights.
pub(super) const EDGES: &[(&str, Edge)] = &[("smooth", Edge::Smooth), ("linear", Edge::Linear)];
/// The words for the interpolation between texels of the pictures of lights.
pub(super) const PICTURE_FILTERS: &[(&str, TexelFilter)] =
    &[("nearest", TexelFilter::Nearest), ("bilinear", TexelFilter::Bilinear)];
/// The words for the quantities of projected images.
pub(super) const QUANTITIES: &[(&str, Projected)] =
    &[("intensity", Projected::Intensity), ("irradiance", Projected::Irradiance)];

impl Reader<'_, '_> {
    /// A spot light.
    pub(super) fn spot(&mut self, table: &Table<'_>) -> Result<(LightKind, Power)> {
        let position = position(table);
        let direction = aim(table, position);
        let expected = "degrees, more than 0 and at most 180";
        let (intensity, power) = self.intensity(table, "power");
        let falloff = falloff(table);
        let cone_angle = table.or("cone_angle", 30.0, |value| {
            value.number_where(expected, |angle| angle > 0.0 && angle <= 180.0)
        });
        table.sound(&["cone_angle"])?;
        let inner_angle = table.or("inner_angle", 0.8 * cone_angle, |value| {
            value.number_where("degrees from 0 to `cone_angle`", |angle| (0.0..=cone_angle).contains(&angle))
        });
        let edge = table.or("edge", Edge::default(), |value| value.choice(EDGES));
        Ok((
            LightKind::Spot { position, direction, intensity, cone_angle, inner_angle, edge, falloff },
            power,
        ))
    }

    /// A projection light.
    pub(super) fn projection(&mut self, table: &Table<'_>) -> Result<(LightKind, Power)> {
        if table.has("matrix") {
            return self.projection_by_matrix(table);
        }
        let position = position(table);
        let forward = aim(table, position).normalize();
        let up = table.maybe("up", Value::direction);
        let picture = self.projected(table)?;
        table.sound(&["position", "target", "direction", "up"])?;
        let up = match up {
            Some(up) => {
                let up = up.normalize();
                if up.cross(forward).length_squared() < 1e-20 {
                    return Err(table
                        .error_at("up", format!("up {up} is parallel to the direction of the light"))
                        .hint(format!("give another `up`, such as {}", up_across(forward))));
                }
                up
            }
            None if DVec3::Y.cross(forward).length_squared() < 1e-12 => -DVec3::Z,
            None => DVec3::Y,
        };
        let right = forward.cross(up).normalize();
        let world_from_light = DMat4::from_cols(
            right.extend(0.0),
            right.cross(forward).extend(0.0),
            forward.extend(0.0),
            position.extend(1.0),
        );
        Ok(picture.placed(world_from_light))
    }

    /// A projection light whose space a matrix places.
    fn projection_by_matrix(&mut self, table: &Table<'_>) -> Result<(LightKind, Power)> {
        for key in ["position", "target", "direction", "up"] {
            table.one_of(&["matrix", key]);
        }
        let world_from_light = table.or("matrix", DMat4::IDENTITY, invertible_rows);
        Ok(self.projected(table)?.placed(world_from_light))
    }

    /// The picture of a projection light, with its intensity.
    fn projected(&mut self, table: &Table<'_>) -> Result<Picture> {
        let expected = "degrees between 0 and 180, exclusive";
        Ok(Picture {
            filter: table.or("filter", TexelFilter::Nearest, |value| value.choice(PICTURE_FILTERS)),
            quantity: table.or("quantity", Projected::default(), |value| value.choice(QUANTITIES)),
            cone: projected_cone(table)?,
            fov: table.or("fov", 45.0, |value| value.single_where(expected, |fov| fov > 0.0 && fov < 180.0)),
            intensity: table.or("intensity", 1.0, |value| {
                value.single_where("a number of at least 0: the colours are in the picture", |number| {
                    number >= 0.0
                })
            }),
            power: power(table, "power", 1.0),
            image: table.need("image", "\"picture.png\"", ImageId(0), |value| self.image(value)),
        })
    }

    /// The octahedral map of a luminaire's photometric file, or of a picture, and the interpolation that is right for it.
    fn intensities(&mut self, value: Value<'_>) -> Result<(ImageId, TexelFilter)> {
        let Some(name) = value.as_text().filter(|name| ies::is_ies(name)) else {
            return Ok((self.octahedral_image(value)?, TexelFilter::Nearest));
        };
        let octahedral =
            |path: &Path, context: &mut LoadContext<'_>| Ok(ies::read(path, context)?.octahedral(name));
        Ok((self.image_by(value, None, true, octahedral)?, TexelFilter::Bilinear))
    }

    /// All light of a luminaire, in lumens, by its photometric file and the picture made of it.
    fn lumens(&mut self, table: &Table<'_>, picture: ImageId) -> Option<f32> {
        let value = table.find("image").filter(|value| value.as_text().is_some_and(ies::is_ies))?;
        let path = self.resolve(value, "the name of a picture").ok()?;
        let candela = ies::read(&path, self.context).ok()?.candela();
        let picture = self.scene.images.get(picture.index())?;
        let sum: f64 = picture.texels().map(|[intensity, ..]| f64::from(intensity)).sum();
        let lumens = (candela * 4.0 * PI * sum / picture.len() as f64) as f32;
        (lumens > 0.0 && lumens.is_finite()).then_some(lumens)
    }

    /// A goniometric light.
    pub(super) fn goniometric(&mut self, table: &Table<'_>) -> (LightKind, Power) {
        let world_from_light = match table.has("matrix") {
            true => {
                table.one_of(&["matrix", "position"]);
                table.one_of(&["matrix", "rotate"]);
                table.or("matrix", DMat4::IDENTITY, invertible_rows)
            }
            false => DMat4::from_translation(position(table)) * turned(table) * up_from_pole(),
        };
        let nothing = (ImageId(0), TexelFilter::Nearest);
        let (image, filter) =
            table.need("image", "\"picture.png\"", nothing, |value| self.intensities(value));
        let filter = table.or("filter", filter, |value| value.choice(PICTURE_FILTERS));
        // The file is read again, and its map summed, only where a power may ask for it.
        let lumens = table.has("power").then(|| self.lumens(table, image)).flatten();
        let total = |value: Value<'_>| match (value.as_text(), lumens) {
            (Some("file"), Some(lumens)) => Ok(lumens),
            (Some("file"), None) => Err(value
                .error("`image` tells no power")
                .hint("name a photometric file (.ies) with factors above 0, or give a number")),
            (Some(_), _) => Err(value.wrong("a number of at least 0, or \"file\"")),
            _ => amount(value),
        };
        let (intensity, power) = self.intensity_by(table, "power", total);
        (LightKind::Goniometric { intensity, image, filter, world_from_light }, power)
    }
}

/// A picture and its light, before it is placed.
struct Picture {
    image: ImageId,
    filter: TexelFilter,
    quantity: Projected,
    intensity: f32,
    cone: Option<[f64; 2]>,
    fov: f32,
    power: Power,
}

impl Picture {
    fn placed(self, world_from_light: DMat4) -> (LightKind, Power) {
        let Self { image, filter, quantity, intensity, cone, fov, power } = self;
        let kind = LightKind::Projection { image, filter, quantity, intensity, cone, fov, world_from_light };
        (kind, power)
    }
}

/// The half-angles of the cone of a projection light, if it has one.
fn projected_cone(table: &Table<'_>) -> Result<Option<[f64; 2]>> {
    let expected = "degrees, more than 0 and less than 90";
    let outer =
        table.maybe("cone_angle", |value| value.number_where(expected, |angle| angle > 0.0 && angle < 90.0));
    table.sound(&["cone_angle"])?;
    let Some(outer) = outer else {
        if let Some(inner) = table.find("inner_angle") {
            inner.note(inner.error("`inner_angle` needs a `cone_angle`"));
        }
        return Ok(None);
    };
    let inner = table.or("inner_angle", outer, |value| {
        value.number_where("degrees from 0 to `cone_angle`", |angle| (0.0..=outer).contains(&angle))
    });
    Ok(Some([outer, inner]))
}
