//! Emitters.
//!
//! Mitsuba's point lights have intensities in W/sr and its directional lights irradiances, ours Whitted's `I_j`: smaller by a factor of
//! π.

use std::f32::consts::FRAC_1_PI;

use glam::{DMat4, DVec3};

use super::Reader;
use super::plugin::{Plugin, Property, Value};
use crate::atmosphere::{ClearSky, PlaceAndTime};
use crate::error::{Error, ErrorKind, Result};
use crate::image::Image;
use crate::light::{Edge, Falloff, Light, LightKind, MapRows, Power, Projected, Sky};
use crate::material::{Color, Scalar};
use crate::model::surface::push_image;
use crate::scene::ImageId;
use crate::shape::Emission;
use crate::spectrum::observer;
use crate::texture::{Mapping, TexelFilter, TextureKind};

const KINDS: &[&str] =
    &["area", "constant", "directional", "envmap", "point", "projector", "sky", "spot", "sunsky"];

/// Properties that tell where the sun is.
const PLACE_AND_TIME: &[&str] =
    &["latitude", "longitude", "timezone", "year", "month", "day", "hour", "minute", "second"];

/// Luminance of a [`ClearSky`] over that of Mitsuba's units: of what has the spectral radiance 1 W/(m² sr nm), in 10 000 cd/m².
const OF_RADIANCE: f32 = 683.0 * observer::Y_INTEGRAL as f32 / 10_000.0;

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
                let falloff = Falloff::Quadratic;
                let kind = match plugin.find("texture") {
                    Some(texture) => {
                        let cone = [cutoff, inner];
                        return self.textured_spot(plugin, texture, (intensity, scale), cone, &to_world);
                    }
                    None => LightKind::Spot {
                        position,
                        direction: forward,
                        intensity,
                        cone_angle: cutoff,
                        inner_angle: inner,
                        edge: Edge::Linear,
                        falloff,
                    },
                };
                (kind, scale * FRAC_1_PI)
            }
            "projector" => return self.projector(plugin, &to_world),
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
                let sky = Sky::Image {
                    image,
                    scale: [scale as f32; 3],
                    world_from_light: turned,
                    rows: MapRows::ToPoles,
                };
                (LightKind::Environment { sky, portal: None, illuminates: true }, 1.0)
            }
            "sky" | "sunsky" => (self.sun_and_sky(plugin, &to_world)?, 1.0),
            "area" => {
                let error = Error::invalid(&plugin.at, "an area light is a part of a shape");
                return Err(error.hint("write <emitter type=\"area\"> in a <shape>"));
            }
            _ => return Err(plugin.unsupported(KINDS)),
        };
        self.push_light(plugin, kind, scale);
        Ok(())
    }

    /// A clear sky with the sun, with the zenith along +z.
    fn sun_and_sky(&mut self, plugin: &Plugin, to_world: &DMat4) -> Result<LightKind> {
        let message = "the sky is that of this program's model of the air, not that of Hosek and Wilkie";
        self.warn_once(&plugin.at, message);
        plugin.ignore(&["complex_sun", "sun_aperture"]);
        let toward_sun = match plugin.vector("sun_direction")? {
            Some(vector) => {
                plugin.ignore(PLACE_AND_TIME);
                to_world.inverse().transform_vector3(vector)
            }
            None => {
                let [elevation, azimuth] = place_and_time(plugin)?.sun();
                // x is south, y is west.
                let across = -libm::cos(elevation);
                DVec3::new(across * libm::cos(azimuth), across * libm::sin(azimuth), libm::sin(elevation))
            }
        };
        let Some(toward_sun) = toward_sun.try_normalize() else {
            return Err(plugin.refuse("sun_direction", "a vector other than 0"));
        };
        let turbidity =
            plugin.float_where("turbidity", 3.0, "a number from 1 to 10", |t| (1.0..=10.0).contains(&t))?;
        let albedo = match self.scalar(plugin, "albedo", 0.3)? {
            Scalar::Value(albedo) if (0.0..=1.0).contains(&albedo) => f64::from(albedo),
            _ => return Err(plugin.refuse("albedo", "a number from 0 to 1, the same at all wavelengths")),
        };
        let at_least_zero =
            |name: &str| plugin.float_where(name, 1.0, "a number of at least 0", |scale| scale >= 0.0);
        let (sky_scale, sun_scale) = (at_least_zero("sky_scale")?, at_least_zero("sun_scale")?);
        if sun_scale != 0.0 && sun_scale != sky_scale {
            self.context.warn(&plugin.at, "the sun has the `sky_scale`: `sun_scale` has no effect but at 0");
        }
        let sky = ClearSky {
            elevation: libm::asin(toward_sun.z.clamp(-1.0, 1.0)),
            azimuth: libm::atan2(toward_sun.x, toward_sun.y),
            turbidity,
            albedo,
            has_sun: plugin.kind != "sky" && sun_scale > 0.0,
        };
        let image = push_image(&mut self.scene, sky.octahedral("sunsky"));
        let scale = [sky_scale as f32 / OF_RADIANCE; 3];
        let sky = Sky::Octahedral { image, scale, world_from_light: *to_world };
        Ok(LightKind::Environment { sky, portal: None, illuminates: true })
    }

    fn push_light(&mut self, plugin: &Plugin, kind: LightKind, scale: f32) {
        let power = Power { scale, ..Power::AS_WRITTEN };
        self.scene.lights.push(Light { name: plugin.id.clone(), at: plugin.at.clone(), kind, power });
    }

    /// A spot light that projects a texture into the square around its cone.
    fn textured_spot(
        &mut self,
        plugin: &Plugin,
        texture: &Property,
        (intensity, scale): (Color, f32),
        cone: [f64; 2],
        to_world: &DMat4,
    ) -> Result<()> {
        if cone[0] >= 90.0 {
            return Err(plugin.refuse("cutoff_angle", "less than 90 for a spot with a texture"));
        }
        let Color::Value(rgb) = intensity else {
            let message = "a spot with a texture and a spectrum is not supported";
            let error = Error::new(ErrorKind::Unsupported, &plugin.at, message);
            return Err(error.hint("write its intensity as <rgb>"));
        };
        let projected = self.projected(texture, rgb)?;
        let (width, height) = self.size_of(projected.0);
        // Both sides are seen under the same angle; the picture's rows run toward +y, its columns toward +x.
        let shape = DVec3::new(height / width.max(height), -width / width.max(height), 1.0);
        let kind = LightKind::Projection {
            image: projected.0,
            filter: projected.1,
            quantity: Projected::Intensity,
            intensity: 1.0,
            cone: Some(cone),
            fov: (2.0 * cone[0]) as f32,
            world_from_light: *to_world * DMat4::from_scale(shape),
        };
        self.push_light(plugin, kind, scale * FRAC_1_PI);
        Ok(())
    }

    /// A projector: its texture tells the light on a plane at a distance of 1, divided by π.
    fn projector(&mut self, plugin: &Plugin, to_world: &DMat4) -> Result<()> {
        let scale = plugin.float_where("scale", 1.0, "a number of at least 0", |scale| scale >= 0.0)?;
        let (image, filter) = match plugin.find("irradiance") {
            Some(irradiance) => self.projected(irradiance, [1.0; 3])?,
            None => (self.picture(1, 1, vec![[1.0; 3]]), TexelFilter::Nearest),
        };
        let (width, height) = self.size_of(image);
        let vertical = super::sensor::field_of_view(plugin, width / height)?;
        let half = libm::tan((0.5 * vertical).to_radians()) * (width / height).min(1.0);
        let kind = LightKind::Projection {
            image,
            filter,
            quantity: Projected::Irradiance,
            intensity: 1.0,
            cone: None,
            fov: (2.0 * libm::atan(half)).to_degrees() as f32,
            // The picture's columns run toward −x.
            world_from_light: *to_world * DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0)),
        };
        self.push_light(plugin, kind, scale as f32);
        Ok(())
    }

    /// The picture of a texture of light, times a colour, and the interpolation between its texels.
    fn projected(&mut self, property: &Property, tint: [f32; 3]) -> Result<(ImageId, TexelFilter)> {
        let texture = property.plugin(&self.ids)?;
        let Some(texture) = texture.filter(|texture| texture.kind == "bitmap") else {
            let rgb = match self.color_of(property)? {
                Color::Value(rgb) => rgb,
                _ => return Err(property.wrong("an <rgb> or a texture of the type \"bitmap\" here")),
            };
            let texel = std::array::from_fn(|c| rgb[c] * tint[c]);
            return Ok((self.picture(1, 1, vec![texel]), TexelFilter::Nearest));
        };
        let TextureKind::Image { image, filter, mapping, .. } = self.bitmap(&texture)? else {
            return Err(property.wrong("a picture"));
        };
        if mapping != Mapping::UV {
            let message = "`to_uv` of a texture that is projected is not supported";
            return Err(Error::new(ErrorKind::Unsupported, &texture.at, message));
        }
        if tint == [1.0; 3] {
            return Ok((image, filter));
        }
        let picture = &self.scene.images[image.index()];
        let (width, height) = (picture.width, picture.height);
        let texels = picture.texels().map(|texel| std::array::from_fn(|c| texel[c] * tint[c])).collect();
        Ok((self.picture(width, height, texels), filter))
    }

    /// Adds a picture of the texels.
    fn picture(&mut self, width: u32, height: u32, texels: Vec<[f32; 3]>) -> ImageId {
        push_image(&mut self.scene, Image::from_linear("", width, height, texels))
    }

    /// Width and height of a picture.
    fn size_of(&self, image: ImageId) -> (f64, f64) {
        let image = &self.scene.images[image.index()];
        (image.width.into(), image.height.into())
    }

    /// The emission of a shape, as paths from the camera find it.
    pub(super) fn emission(&mut self, plugin: &Plugin) -> Result<Option<Emission>> {
        plugin.ignore(&["sampling_weight"]);
        match &*plugin.kind {
            "area" => {}
            "directionalarea" => {
                plugin.ignore(&["radiance"]);
                let message = "paths from the camera do not find the light of a directionalarea: it is dark, as with Mitsuba's path tracers";
                self.warn_once(&plugin.at, message);
                return Ok(None);
            }
            _ => return Err(plugin.unsupported(&["area", "directionalarea"])),
        }
        let texture = match plugin.find("radiance").map(|property| &property.value) {
            Some(Value::Plugin(_) | Value::Reference(_)) => plugin
                .find("radiance")
                .map_or(Ok(None), |property| property.plugin(&self.ids))?
                .filter(|radiance| radiance.class == "texture"),
            _ => None,
        };
        if let Some(texture) = texture {
            return Ok(Some(Emission::new(Color::Texture(self.texture(&texture)?), false)));
        }
        let (radiance, scale) = self.light_color(plugin, "radiance")?;
        let power = Power { scale, ..Power::AS_WRITTEN };
        Ok(Some(Emission { radiance, power, two_sided: false }))
    }
}

/// Place and time of a sky: by default Tokyo's on an afternoon of July.
fn place_and_time(plugin: &Plugin) -> Result<PlaceAndTime> {
    let number = |name, default, [least, most]: [f64; 2]| {
        let expected = format!("a number from {least} to {most}");
        plugin.float_where(name, default, &expected, |number| (least..=most).contains(&number))
    };
    let whole = |name, default, [least, most]: [i64; 2]| {
        plugin.integer(name, default, least, most).map(|number| number as i32)
    };
    Ok(PlaceAndTime {
        latitude: number("latitude", 35.6894, [-90.0, 90.0])?,
        longitude: number("longitude", 139.6917, [-180.0, 180.0])?,
        timezone: number("timezone", 9.0, [-14.0, 14.0])?,
        date: [whole("year", 2010, [0, 9999])?, whole("month", 7, [1, 12])?, whole("day", 10, [1, 31])?],
        hours: number("hour", 15.0, [0.0, 24.0])?
            + number("minute", 0.0, [0.0, 60.0])? / 60.0
            + number("second", 0.0, [0.0, 60.0])? / 3600.0,
    })
}
