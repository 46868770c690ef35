//! A session's camera for Python.

use lookfrom::glam::{DMat3, DMat4, DVec3};
use lookfrom::scene::camera::Projection;
use lookfrom::view::camera::Camera;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The camera as a dictionary.
///
/// A lens system is "perspective": the pinhole that sees its plane of focus as large.
///
/// projection: "perspective", "orthographic", "equirectangular", "octahedral" or "irradiance".
/// lookfrom, and the axes right, up and forward, in the world.
/// pixel: rows of the matrix from (x, y, 1), in pixels from the top left, to the point of the image plane, at distance 1 in the
/// coordinates right, down, forward.
pub(super) fn described<'py>(py: Python<'py>, camera: &Camera) -> PyResult<Bound<'py, PyDict>> {
    let axes = DMat3::from_mat4(camera.world_from_view());
    let [left, up, forward] = [axes.x_axis, axes.y_axis, axes.z_axis].map(|axis: DVec3| axis.to_array());
    // From pixels with y up to view space, whose x is to the viewer's left.
    let plane: DMat4 = camera.s2 * camera.t1;
    let height = f64::from(camera.size[1]);
    let scale = match camera.projection {
        Projection::Perspective { .. } | Projection::LensSystem(_) => 1.0 / camera.distance,
        _ => 1.0,
    };
    let [sx, sy] = [plane.x_axis.x * scale, plane.y_axis.y * scale];
    let [ox, oy] = [plane.w_axis.x * scale, plane.w_axis.y * scale];
    let dict = PyDict::new(py);
    dict.set_item(
        "projection",
        match camera.projection {
            Projection::Perspective { .. } | Projection::LensSystem(_) => "perspective",
            Projection::Orthographic { .. } => "orthographic",
            Projection::Octahedral => "octahedral",
            Projection::Irradiance { .. } => "irradiance",
            _ => "equirectangular",
        },
    )?;
    dict.set_item("lookfrom", camera.lookfrom().to_array())?;
    dict.set_item("right", left.map(|x| -x))?;
    dict.set_item("up", up)?;
    dict.set_item("forward", forward)?;
    dict.set_item("pixel", [[-sx, 0.0, -ox], [0.0, sy, -(sy * height + oy)], [0.0, 0.0, 1.0]])?;
    dict.set_item("lens_radius", camera.lens.map(|lens| lens.radius))?;
    dict.set_item("focus_distance", camera.lens.map(|lens| lens.focus_distance))?;
    Ok(dict)
}
