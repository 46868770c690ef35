//! The `LightSource` and `AreaLightSource` directives.
//!
//! pbrt's point lights have intensities in W/sr and its distant lights irradiances, ours Whitted's `I_j`: smaller by a
//! factor of π. A `power` or `illuminance` has the same unit in both, but pbrt multiplies it by the luminance of an rgb
//! colour.

use std::f32::consts::PI;

use glam::{DMat4, DVec3, DVec4, Vec3};

use super::params::{ParameterType, Parameters};
use super::spectra::brightness;
use super::text::Place;
use super::{Reader, transform};
use crate::error::Result;
use crate::light::{Edge, Falloff, Light, LightKind, MapRows, Power, Projected, Sky, is_rectangle};
use crate::material::Color;
use crate::scene::ImageId;
use crate::shape::Emission;
use crate::texture::TexelFilter;

const KINDS: &[&str] = &["distant", "goniometric", "infinite", "point", "projection", "spot"];

/// From the space of a map in latitude and longitude, with y up, to that of a light of pbrt-v3, which has z up, and longitudes from x to y.
const OLD_FROM_PANORAMA: DMat4 = DMat4::from_cols(DVec4::NEG_Y, DVec4::Z, DVec4::X, DVec4::W);

/// The default colour of lights: the scene's white.
const WHITE: Color = Color::Value([1.0; 3]);

impl Reader<'_, '_> {
    pub(super) fn light(&mut self, kind: &str, p: &Parameters) -> Result<()> {
        let matrix = self.state.matrix;
        if !transform::is_invertible(&matrix) {
            return Err(p
                .place
                .invalid("the current transform is singular: a light needs an invertible one"));
        }
        let (kind, power) = match kind {
            "point" => {
                let intensity = self.light_color(p, "I")?.unwrap_or(WHITE);
                let position =
                    matrix.transform_point3(p.vector("from", ParameterType::Point3, DVec3::ZERO)?);
                let kind = LightKind::Point { position, intensity, falloff: Falloff::Quadratic };
                (kind, power(p, "power", intensity, PI)?)
            }
            "spot" => {
                let intensity = self.light_color(p, "I")?.unwrap_or(WHITE);
                let (position, direction) = from_to(p, &matrix)?;
                let cone =
                    p.float_where("coneangle", 30.0, "an angle in (0, 180]", |a| a > 0.0 && a <= 180.0)?;
                let delta = p.float_where("conedeltaangle", 5.0, "an angle of at least 0", |a| a >= 0.0)?;
                let kind = LightKind::Spot {
                    position,
                    direction,
                    intensity,
                    cone_angle: cone.into(),
                    inner_angle: (cone - delta).max(0.0).into(),
                    edge: Edge::Smooth,
                    falloff: Falloff::Quadratic,
                };
                (kind, power(p, "power", intensity, PI)?)
            }
            "distant" => {
                let intensity = self.light_color(p, "L")?.unwrap_or(WHITE);
                let (_, direction) = from_to(p, &matrix)?;
                (LightKind::Distant { direction, intensity }, power(p, "illuminance", intensity, PI)?)
            }
            "projection" => {
                let image = self.light_picture(p, false)?;
                let fov =
                    p.float_where("fov", 90.0, "an angle between 0 and 180", |a| a > 0.0 && a < 180.0)?;
                let kind = LightKind::Projection {
                    image,
                    filter: TexelFilter::Nearest,
                    quantity: Projected::Intensity,
                    intensity: 1.0,
                    cone: None,
                    fov,
                    world_from_light: matrix,
                };
                (kind, power(p, "power", WHITE, PI)?)
            }
            "goniometric" => {
                let intensity = self.light_color(p, "I")?.unwrap_or(WHITE);
                let image = self.light_picture(p, true)?;
                // The centre of the image is the light's y axis, but the z axis of an octahedral map.
                let swapped = DMat4::from_cols(DVec4::X, DVec4::Z, DVec4::Y, DVec4::W);
                let kind = LightKind::Goniometric {
                    intensity,
                    image,
                    filter: TexelFilter::Nearest,
                    world_from_light: matrix * swapped,
                };
                (kind, power(p, "power", intensity, PI)?)
            }
            "infinite" => self.infinite(p, matrix)?,
            _ => return Err(Self::unknown(&p.place, "light", kind, KINDS.iter().copied())),
        };
        self.scene.lights.push(Light { name: None, at: p.place.location(), kind, power });
        Ok(())
    }

    fn infinite(&mut self, p: &Parameters, world_from_light: DMat4) -> Result<(LightKind, Power)> {
        let written = self.light_color(p, "L")?;
        // Portals are given in world space, whatever the transform.
        let portal = p.vectors("portal", ParameterType::Point3)?;
        let portal = match portal[..] {
            [] => None,
            [a, b, c, d] => Some([a, b, c, d].map(Vec3::as_dvec3))
                .filter(is_rectangle)
                .ok_or_else(|| p.refuse("portal", "the corners of a rectangle, in order"))
                .map(Some)?,
            _ => return Err(p.refuse("portal", &format!("4 corners, found {}", portal.len()))),
        };
        let (sky, color) = match (p.file_name()?, written) {
            (Some(_), color) if self.is_old() => {
                let image = self.light_picture(p, false)?;
                let scale = match color {
                    Some(Color::Value(rgb)) => rgb,
                    _ => [1.0; 3],
                };
                let rows = MapRows::Bands;
                let world_from_light = world_from_light * OLD_FROM_PANORAMA;
                (Sky::Image { image, scale, world_from_light, rows }, WHITE)
            }
            (Some(_), Some(_)) => {
                let error = p.refuse("L", "it without \"filename\"");
                return Err(error.hint("take one of the two out; \"float scale\" makes a picture brighter"));
            }
            (Some(_), None) => {
                let image = self.light_picture(p, true)?;
                (Sky::Octahedral { image, scale: [1.0; 3], world_from_light }, WHITE)
            }
            (None, color) => {
                let color = color.unwrap_or(WHITE);
                (Sky::Constant(color), color)
            }
        };
        let mut power = power(p, "illuminance", color, 1.0)?;
        if let (Some(total), Sky::Octahedral { .. }) = (&mut power.total, &sky) {
            // pbrt-v4 weights texels as if the image covered only a hemisphere, so its images give twice as much.
            *total *= 2.0;
        }
        Ok((LightKind::Environment { sky, portal, illuminates: true }, power))
    }

    /// The image of a light: environment maps have to be square.
    fn light_picture(&mut self, p: &Parameters, is_square: bool) -> Result<ImageId> {
        let parameter = p.find("filename", &[ParameterType::String])?;
        let Some(name) = p.file_name()? else {
            return Err(p
                .place
                .invalid(format!("{} has no \"string filename\"", p.title))
                .hint("name a picture"));
        };
        let place: &Place = parameter.map_or(&p.place, |parameter| &parameter.place);
        let id = self.emitted_picture(name, place)?;
        let image = &self.scene.images[id.index()];
        if is_square && image.width != image.height {
            let message = format!(
                "the picture is {} × {}, but an environment map must be square (equal-area)",
                image.width, image.height
            );
            return Err(place.invalid(message).hint(
                "pbrt's own program converts one in latitude and longitude: \
                 imgtool makeequiarea old.exr --outfile new.exr",
            ));
        }
        Ok(id)
    }

    pub(super) fn area_light(&mut self, kind: &str, p: &Parameters) -> Result<Emission> {
        if kind != "diffuse" {
            return Err(Self::unknown(&p.place, "area light", kind, ["diffuse"]));
        }
        let color = self.light_color(p, "L")?;
        let file = p.find("filename", &[ParameterType::String])?;
        let radiance = match (p.file_name()?, color) {
            (Some(_), Some(_)) => {
                let error = p.refuse("L", "it without \"filename\"");
                return Err(error.hint("take one of the two out; \"float scale\" makes a picture brighter"));
            }
            (Some(name), None) => self.shown_picture(name, file.map_or(&p.place, |file| &file.place))?,
            (None, color) => color.unwrap_or(WHITE),
        };
        Ok(Emission {
            radiance,
            power: power(p, "power", radiance, 1.0)?,
            two_sided: p.boolean("twosided", false)?,
        })
    }
}

/// The power of a light; `unit` is the number of pbrt's units per unit of ours if no total is given.
fn power(p: &Parameters, total: &'static str, color: Color, unit: f32) -> Result<Power> {
    let scale = p.float_where("scale", 1.0, "a number of at least 0", |scale| scale >= 0.0)?;
    let total = p.float_or_none(total)?.filter(|&total| total > 0.0);
    Ok(match total {
        // A black light stays black.
        Some(total) if brightness(color) > 0.0 => {
            Power { scale: scale * brightness(color), total: Some(total), absolute: false }
        }
        _ => Power { scale: scale / unit, total: None, absolute: false },
    })
}

/// The position and direction of a light in world space.
fn from_to(p: &Parameters, matrix: &DMat4) -> Result<(DVec3, DVec3)> {
    let from = p.vector("from", ParameterType::Point3, DVec3::ZERO)?;
    let to = p.vector("to", ParameterType::Point3, DVec3::Z)?;
    let direction = matrix.transform_vector3(to - from);
    if direction.try_normalize().is_none() {
        return Err(p.refuse("to", "another point than \"from\""));
    }
    Ok((matrix.transform_point3(from), direction))
}
