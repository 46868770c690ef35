//! The scene from an observer's camera, for the view in 3D: first hits by the kernel, lit from the camera, with depths and
//! the matrix by which a page draws rays over it.

use glam::{DMat4, DVec3, DVec4};
use lookfrom::film::{Aovs, Film};
use lookfrom::render::StopCriteria;
use lookfrom::session::Session;
use lookfrom::view::View;
use lookfrom::view::camera::Camera;
use lookfrom_scene::Result;
use lookfrom_scene::camera::{Camera as Written, Projection};
use lookfrom_scene::image::{Pixels, encode_png_to_show, srgb_from_linear};
use lookfrom_scene::settings::{FilterShape, ImageSettings, Integrator, Layers, RenderSettings};

use crate::heat::byte;
use crate::message::{CameraRequest, Header};
use crate::view::check_size;

/// The field of view of an observer that names none.
const FOV: f64 = 45.0;

/// The part of the light that does not depend on the angle.
const AMBIENT: f32 = 0.25;

/// The frame of the answer.
///
/// # Errors
/// `Request` for a size out of range, `Invalid` for a degenerate camera.
pub(crate) fn frame(session: &Session, id: u64, request: &CameraRequest, size: [u32; 2]) -> Result<Vec<u8>> {
    check_size(size)?;
    let [width, height] = size;
    let fov = request.fov.unwrap_or(FOV);
    let written = Written { projection: Projection::Perspective { fov }, ..Written::default() };
    let written = request.applied(&written, DVec3::ZERO)?;
    let image = ImageSettings {
        width,
        height,
        filter: FilterShape::Box.of_radius(0.5),
        layers: Layers::Geometry,
        ..ImageSettings::default()
    };
    // Not by the session, which may read the scene again for a camera far away: this is a drawing, not a measurement.
    let renderer = session.renderer().with_view(View::new(&written, image.clone())?)?;
    let renderer = renderer.with_settings(RenderSettings {
        integrator: Integrator::Depth,
        samples: 1,
        ..session.settings().clone()
    })?;
    let film = renderer.render_onto(Film::for_image(&image)?, 0, &StopCriteria::default(), None, &())?.film;
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let (colors, depths): (Vec<[u8; 4]>, Vec<[u8; 4]>) = places
        .map(|(x, y)| match film.aovs(x, y) {
            Some(aovs) => (headlight(&aovs), aovs.position[2].to_le_bytes()),
            None => ([0; 4], f32::INFINITY.to_le_bytes()),
        })
        .unzip();
    let png = encode_png_to_show([width, height], Pixels::Rgba8(colors.as_flattened()))?;
    let depths = depths.as_flattened();
    let matrix = screen_from_world(renderer.view().camera());
    let header = Header::Space {
        id,
        width,
        height,
        screen_from_world: matrix.transpose().to_cols_array(),
        sizes: [png.len(), depths.len()],
    };
    Ok(header.frame(&[&png, depths]))
}

/// The colour of a first hit under a light at the camera.
fn headlight(aovs: &Aovs) -> [u8; 4] {
    let [n, p] = [aovs.ns, aovs.position].map(glam::Vec3::from);
    let cosine = n.dot(p.normalize_or_zero()).abs();
    let light = AMBIENT + (1.0 - AMBIENT) * cosine;
    let [r, g, b] = aovs.albedo.map(|c| byte(srgb_from_linear(c.clamp(0.0, 1.0) * light)));
    [r, g, b, 255]
}

/// [`screen_from_world`] of a session's camera, row by row; `None` where rays do not leave a point into a frustum.
pub(crate) fn of_points(session: &Session) -> Option<[f64; 16]> {
    let camera = session.renderer().view().camera();
    matches!(camera.projection, Projection::Perspective { .. })
        .then(|| screen_from_world(camera).transpose().to_cols_array())
}

/// From the world to pixels, x to the right and y down from the top left, divided by w; w is the depth.
fn screen_from_world(camera: &Camera) -> DMat4 {
    let d = camera.distance;
    let onto_image_plane = DMat4::from_cols(
        DVec4::new(d, 0.0, 0.0, 0.0),
        DVec4::new(0.0, d, 0.0, 0.0),
        DVec4::new(0.0, 0.0, d, 1.0),
        DVec4::ZERO,
    );
    let down = DMat4::from_translation(DVec3::new(0.0, f64::from(camera.size[1]), 0.0))
        * DMat4::from_scale(DVec3::new(1.0, -1.0, 1.0));
    down * (camera.s2 * camera.t1).inverse() * onto_image_plane * camera.world_from_view().inverse()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_a_ray_are_at_its_pixel() {
        let camera =
            Camera::new(&Written { distance: 2.5, ..Written::default() }, 320, 200).expect("a camera");
        let matrix = screen_from_world(&camera);
        for [column, row] in [[0.5, 0.5], [160.0, 100.0], [311.25, 20.75]] {
            let ray = camera.ray([column, 200.0 - row], [0.5; 2]);
            for t in [0.5, 1.0, 7.0] {
                let p = matrix * (camera.lookfrom() + ray.a_from_eye + t * ray.direction).extend(1.0);
                assert!((p.x / p.w - column).abs() < 1e-9 && (p.y / p.w - row).abs() < 1e-9, "{p}");
                assert!((p.w - 2.5 * t).abs() < 1e-9, "the depth: {}", p.w);
            }
        }
    }
}
