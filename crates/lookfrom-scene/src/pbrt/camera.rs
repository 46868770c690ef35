//! The `Camera` directive: position and projection.

use std::sync::Arc;

use glam::{DMat4, DVec3};

use super::Reader;
use super::params::{ParameterType, Parameters};
use super::state::Entity;
use crate::camera::{Camera, Lens, Projection, View, Window};
use crate::error::{Location, Result};
use crate::motion::Motion;

impl Reader<'_, '_> {
    /// Converts the camera, with its matrices from world to camera space at the start and the end, and the medium around it; without one, pbrt's
    /// default: at the origin, along +z.
    pub(super) fn camera(&mut self, camera: Option<&(Entity, [DMat4; 2])>, medium: &str) -> Result<()> {
        let aspect = f64::from(self.scene.image.width) / f64::from(self.scene.image.height);
        let Some((Entity { kind, parameters }, cameras_from_world)) = camera else {
            self.scene.camera = Some(Camera {
                at: Location { file: self.scene.materials[0].at.file.clone(), ..Location::default() },
                view: View::Matrix(DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0))),
                projection: Projection::Perspective { fov: 90.0 },
                window: window(None, aspect),
                ..Camera::default()
            });
            return Ok(());
        };
        let projection = match &**kind {
            "perspective" => Projection::Perspective { fov: field_of_view(parameters)? },
            "realistic" => self.realistic(parameters)?,
            "orthographic" => Projection::Orthographic { height: 2.0 },
            "spherical" => {
                let mappings = [("equalarea", false), ("equirectangular", true), ("equirect", true)];
                match parameters.choice("mapping", false, &mappings)? {
                    true => Projection::EquirectangularPbrt,
                    false => Projection::Octahedral,
                }
            }
            _ => {
                let known = ["perspective", "orthographic", "spherical", "realistic"];
                return Err(Self::unknown(&parameters.place, "camera", kind, known));
            }
        };
        let is_flat = matches!(projection, Projection::Perspective { .. } | Projection::Orthographic { .. });
        let frame = parameters.positive("frameaspectratio", aspect as f32)?;
        let aspect = if parameters.has("frameaspectratio") { f64::from(frame) } else { aspect };
        let given = parameters.floats("screenwindow", ParameterType::Float)?;
        let given = given.map(|numbers| {
            <[f32; 4]>::try_from(numbers)
                .ok()
                .filter(|[x0, x1, y0, y1]| x0 != x1 && y0 != y1)
                .ok_or_else(|| parameters.refuse("screenwindow", "4 numbers around an area: x0 x1 y0 y1"))
        });
        let window = window(given.transpose()?, aspect);
        let lens = lens(parameters)?;
        // Our camera space has x to the left.
        let flip = DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        let [start, end] = cameras_from_world.map(|camera_from_world| camera_from_world.inverse());
        let motion = Motion::between(&start, &end, self.shutter_fractions());
        let at_opening = motion.as_ref().map_or(start, Motion::at_opening);
        let motion = motion.map(|motion| Arc::new(motion.with(|map| *map * at_opening.inverse())));
        let world_from_camera = at_opening * flip;
        self.scene.camera = Some(Camera {
            at: parameters.place.location(),
            view: View::Matrix(world_from_camera),
            projection,
            lens: lens.filter(|_| is_flat),
            window: window.filter(|_| is_flat),
            medium: self.medium_around(medium, &parameters.place)?,
            motion,
            ..Camera::default()
        });
        Ok(())
    }
}

/// Field of view in degrees along the shorter side of the image.
fn field_of_view(parameters: &Parameters) -> Result<f64> {
    let ok = |degrees: f32| degrees > 0.0 && degrees < 180.0;
    parameters.float_where("fov", 90.0, "an angle between 0 and 180 degrees", ok).map(f64::from)
}

/// The screen window: as written, or ±1 along the shorter side. The unit is half of the projection's field of view, which
/// pbrt measures along the shorter side, and we along the height.
fn window(written: Option<[f32; 4]>, aspect: f64) -> Option<Window> {
    if let Some(numbers) = written {
        let [x0, x1, y0, y1] = numbers.map(f64::from);
        return Some(Window { x: [x0, x1], y: [y0, y1] });
    }
    if aspect > 1.0 {
        return Some(Window { x: [-aspect, aspect], y: [-1.0, 1.0] });
    }
    Some(Window { x: [-1.0, 1.0], y: [-1.0 / aspect, 1.0 / aspect] })
}

fn lens(parameters: &Parameters) -> Result<Option<Lens>> {
    let radius =
        parameters.float_where("lensradius", 0.0, "a number of at least 0", |radius| radius >= 0.0)?;
    let focus_distance = parameters.positive("focaldistance", 1e6)?;
    let lens = Lens { radius: radius.into(), focus_distance: focus_distance.into() };
    Ok((radius > 0.0).then_some(lens))
}
