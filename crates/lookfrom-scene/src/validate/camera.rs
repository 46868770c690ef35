//! Validation of the camera's medium, and of the surface that it measures. The rest of the camera is validated when its matrices
//! are computed.

use super::Part;
use crate::camera::Projection;
use crate::error::{Error, Result};
use crate::scene::Scene;
use crate::shape::Geometry;
use crate::suggest::nearest;

/// The most names of shapes that are compared with one that no shape has.
const MOST_COMPARED: usize = 1000;

pub(super) fn check(scene: &Scene) -> Result<()> {
    let Some(camera) = &scene.camera else { return Ok(()) };
    Part::new(scene, &camera.at, "the camera").medium(camera.medium)?;
    check_surface(scene)
}

/// Checks that the surface of a camera that measures irradiance is there, and has an area that stays the same.
pub(crate) fn check_surface(scene: &Scene) -> Result<()> {
    let Some(camera) = &scene.camera else { return Ok(()) };
    let Projection::Irradiance { surface } = &camera.projection else { return Ok(()) };
    let unsuitable = |message: String, hint: &str| Err(Error::invalid(&camera.at, message).hint(hint));
    let mut shapes = scene.shapes_named(surface).peekable();
    if shapes.peek().is_none() {
        let is_in_object = |object: &crate::scene::Object| {
            object.shapes.iter().any(|shape| shape.name.as_ref() == Some(surface))
        };
        if scene.objects.iter().any(is_in_object) {
            return unsuitable(
                format!("the shape {surface:?} is in an object: its irradiance cannot be measured"),
                "name a shape that is placed in the world itself",
            );
        }
        let message = format!("there is no shape {surface:?} to measure the irradiance of");
        let names = || scene.shapes.iter().filter_map(|shape| shape.name.as_deref());
        return match nearest(surface, names().take(MOST_COMPARED)) {
            Some(meant) => unsuitable(message, &format!("did you mean {meant:?}?")),
            None => unsuitable(message, "give a shape this `name`"),
        };
    }
    for shape in shapes {
        match &shape.geometry {
            Geometry::Curves(_) => {
                let message =
                    format!("the shape {surface:?} has curves, whose irradiance cannot be measured");
                return unsuitable(message, "name a shape that has a surface: a mesh, a sphere, a disk, …");
            }
            Geometry::Mesh(id) if scene.meshes.get(id.index()).is_some_and(|mesh| !mesh.later.is_empty()) => {
                let message = format!("the shape {surface:?} changes its form while the shutter is open");
                return unsuitable(message, "measure it at an instant: without a `shutter`");
            }
            _ => {}
        }
    }
    Ok(())
}
