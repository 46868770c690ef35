//! Validation of lights.

use glam::DVec3;

use super::Part;
use crate::error::Result;
use crate::light::{LightKind, Sky, is_rectangle};
use crate::scene::{ImageId, Scene};

pub(super) fn check(scene: &Scene) -> Result<()> {
    for (index, light) in scene.lights.iter().enumerate() {
        let part = Part::new(scene, &light.at, "light").numbered(index, light.name.as_deref());
        part.power(&light.power)?;
        check_kind(&part, &light.kind)?;
    }
    Ok(())
}

fn check_kind(part: &Part<'_>, kind: &LightKind) -> Result<()> {
    match kind {
        LightKind::Ambient { color } => part.finite("color", &color.map(f64::from)),
        LightKind::Point { position, intensity, .. } => {
            part.finite("position", &position.to_array())?;
            part.color("intensity", *intensity)
        }
        LightKind::Distant { direction, intensity } => {
            check_direction(part, *direction)?;
            part.color("intensity", *intensity)
        }
        LightKind::Spot { position, direction, intensity, cone_angle, inner_angle, .. } => {
            part.finite("position", &position.to_array())?;
            check_direction(part, *direction)?;
            part.color("intensity", *intensity)?;
            let (cone, inner) = (*cone_angle, *inner_angle);
            part.number("cone_angle", cone, "degrees above 0 and up to 180", cone > 0.0 && cone <= 180.0)?;
            part.number("inner_angle", inner, "degrees from 0 to cone_angle", (0.0..=cone).contains(&inner))
        }
        LightKind::Projection { image, intensity, fov, world_from_light, cone, .. } => {
            if let Some([outer, inner]) = *cone {
                part.number(
                    "cone_angle",
                    outer,
                    "degrees above 0 and below 90",
                    outer > 0.0 && outer < 90.0,
                )?;
                let is_within = (0.0..=outer).contains(&inner);
                part.number("inner_angle", inner, "degrees from 0 to cone_angle", is_within)?;
            }
            part.image(*image)?;
            part.finite("intensity", &[f64::from(*intensity)])?;
            part.number("fov", f64::from(*fov), "degrees between 0 and 180", *fov > 0.0 && *fov < 180.0)?;
            part.matrix("world_from_light", world_from_light)
        }
        LightKind::Goniometric { intensity, image, world_from_light, .. } => {
            part.color("intensity", *intensity)?;
            check_octahedral(part, *image)?;
            part.matrix("world_from_light", world_from_light)
        }
        LightKind::Environment { sky, portal, .. } => {
            check_sky(part, sky)?;
            match portal {
                Some(corners) if !is_rectangle(corners) => {
                    Err(part
                        .fault("the corners of its portal are not those of a rectangle, in order around it"))
                }
                _ => Ok(()),
            }
        }
    }
}

fn check_direction(part: &Part<'_>, direction: DVec3) -> Result<()> {
    let has_direction = direction.try_normalize().is_some();
    part.number("length of direction", direction.length(), "a finite one, more than 0", has_direction)
}

fn check_octahedral(part: &Part<'_>, image: ImageId) -> Result<()> {
    part.image(image)?;
    let picture = &part.scene.images[image.index()];
    let (width, height) = (picture.width as usize, picture.height as usize);
    part.as_many("rows of its octahedral map", height, "columns", width)
}

fn check_sky(part: &Part<'_>, sky: &Sky) -> Result<()> {
    match sky {
        Sky::Constant(color) => part.color("color", *color),
        Sky::Gradient { zenith, horizon, nadir } => {
            [zenith, horizon, nadir].into_iter().try_for_each(|rgb| part.finite("color", &rgb.map(f64::from)))
        }
        Sky::Image { image, scale, world_from_light, .. }
        | Sky::Octahedral { image, scale, world_from_light } => {
            match sky {
                Sky::Octahedral { .. } => check_octahedral(part, *image)?,
                _ => part.image(*image)?,
            }
            part.finite("scale", &scale.map(f64::from))?;
            part.matrix("world_from_light", world_from_light)
        }
    }
}
