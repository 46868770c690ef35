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
                projection: along_height(Projection::Perspective { fov: 90.0 }, aspect),
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
        let frame = parameters.has("frameaspectratio").then_some(f64::from(frame));
        let given = parameters.floats("screenwindow", ParameterType::Float)?;
        let given = given.map(|numbers| {
            <[f32; 4]>::try_from(numbers)
                .ok()
                .filter(|[x0, x1, y0, y1]| x0 != x1 && y0 != y1)
                .ok_or_else(|| parameters.refuse("screenwindow", "4 numbers around an area: x0 x1 y0 y1"))
        });
        let window = given.transpose()?.map(window).or(frame.map(frame_window));
        let projection = if window.is_none() { along_height(projection, aspect) } else { projection };
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

/// A projection whose field of view is that of the shorter side, as pbrt's, with that of the height of a picture instead, as ours. No
/// window has to say so: a picture that is asked for in another shape then shows more at its sides, as pbrt's does, and is not stretched.
fn along_height(projection: Projection, aspect: f64) -> Projection {
    let longer = (1.0 / aspect).max(1.0);
    match projection {
        Projection::Perspective { fov } if longer > 1.0 => {
            let half = libm::tan((0.5 * fov).to_radians());
            Projection::Perspective { fov: 2.0 * libm::atan(longer * half).to_degrees() }
        }
        Projection::Orthographic { height } => Projection::Orthographic { height: height * longer },
        other => other,
    }
}

/// The screen window as written: in units of half the projection's field of view.
fn window(numbers: [f32; 4]) -> Window {
    let [x0, x1, y0, y1] = numbers.map(f64::from);
    Window { x: [x0, x1], y: [y0, y1] }
}

/// The screen window of a frame of an aspect ratio that need not be the picture's: ±1 along the shorter side.
fn frame_window(aspect: f64) -> Window {
    let [x, y] = [aspect.max(1.0), (1.0 / aspect).max(1.0)];
    Window { x: [-x, x], y: [-y, y] }
}

fn lens(parameters: &Parameters) -> Result<Option<Lens>> {
    let radius =
        parameters.float_where("lensradius", 0.0, "a number of at least 0", |radius| radius >= 0.0)?;
    let focus_distance = parameters.positive("focaldistance", 1e6)?;
    let lens = Lens { radius: radius.into(), focus_distance: focus_distance.into() };
    Ok((radius > 0.0).then_some(lens))
}
