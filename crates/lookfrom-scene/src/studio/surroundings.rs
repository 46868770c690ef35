//! Environments for models without lights: a procedural photographer's studio, or an environment map; and a shadow-catcher
//! floor.
//!
//! The studio is a backdrop that darkens downwards, with softboxes: a large key light at the upper left of the camera, one
//! overhead, and two vertical strips, at the right and behind at the left, that give reflective surfaces bright edges. Two
//! black flags beside the part of the backdrop that the camera sees, and a dark floor below it, give them dark edges: else
//! mirrors would vanish in front of what they reflect. It is an environment light at infinity, so models of any size look
//! the same in it.

use std::sync::OnceLock;

use glam::{DMat4, DVec3};

use super::{StudioFrame, sane};
use crate::error::Location;
use crate::image::Image;
use crate::light::{LightKind, MapRows, Sky};
use crate::material::{Material, MaterialKind};
use crate::model::surface::push_image;
use crate::scene::{Bounds, MaterialId, Scene};
use crate::shape::{Geometry, Shape};

/// Resolution of the studio's environment map.
const WIDTH: u32 = 512;
const HEIGHT: u32 = 256;

/// Radiance of the backdrop by the height of the direction, from −1 to 1, linearly interpolated.
const BACKDROP: [(f64, [f64; 3]); 7] = [
    (-1.0, [0.11, 0.11, 0.114]),
    (-0.8, [0.16, 0.162, 0.167]),
    (-0.62, [0.335, 0.34, 0.349]),
    (-0.55, [0.36, 0.365, 0.375]),
    (-0.1, [0.66, 0.665, 0.675]),
    (0.3, [0.30, 0.305, 0.315]),
    (1.0, [0.18, 0.185, 0.195]),
];

/// A rectangle in front of the backdrop: a softbox, which is a light, or a flag, which is dark.
struct Panel {
    /// Direction from the model, as components to the right, up and towards the camera; any length.
    toward: [f64; 3],
    /// Half its width and height at a distance of 1.
    half: [f64; 2],
    /// Radiance at its centre.
    radiance: [f64; 3],
    /// The fraction of its half size over which its edge fades out.
    fade: f64,
}

/// Vertical, at equal angles to both sides of the direction in which the camera looks, outside the image.
const FLAGS: [Panel; 2] = [
    Panel { toward: [0.70, -0.1, -0.71], half: [0.2, 0.55], radiance: [0.08, 0.081, 0.084], fade: 0.7 },
    Panel { toward: [-0.964, -0.1, 0.267], half: [0.2, 0.55], radiance: [0.08, 0.081, 0.084], fade: 0.7 },
];

const SOFT_BOXES: [Panel; 4] = [
    Panel { toward: [-0.62, 0.85, 0.6], half: [0.62, 0.62], radiance: [2.15, 2.1, 2.03], fade: 0.12 },
    Panel { toward: [0.1, 1.0, -0.35], half: [0.6, 0.4], radiance: [1.1, 1.1, 1.1], fade: 0.12 },
    Panel { toward: [0.95, 0.5, 0.1], half: [0.16, 0.42], radiance: [1.5, 1.55, 1.63], fade: 0.12 },
    Panel { toward: [-0.75, 0.68, -0.75], half: [0.14, 0.42], radiance: [1.9, 1.95, 2.05], fade: 0.12 },
];

/// Radius of the floor in radii of the bounds, so that it extends beyond the upper edge of the image.
const FLOOR_RADIUS: f64 = 60.0;

impl StudioFrame {
    /// Adds the studio, oriented towards the viewer whom models face.
    pub(super) fn add_studio(&self, scene: &mut Scene) {
        let image = push_image(scene, studio());
        let sky = Sky::Image {
            image,
            scale: [1.0; 3],
            world_from_light: self.world_from_light(),
            rows: MapRows::Bands,
        };
        super::add(scene, "studio", LightKind::Environment { sky, portal: None, illuminates: true });
    }

    /// The rotation from an environment map with +y up whose centre is in front of the viewer.
    fn world_from_light(&self) -> DMat4 {
        let [right, up, back] = self.basis.map(|axis| axis.extend(0.0));
        DMat4::from_cols(right, up, back, DMat4::IDENTITY.w_axis)
    }
}

/// Replaces all environment lights by an equirectangular environment map with +y up. `up` as in [`super::add_lights_and_camera`].
pub fn surround(scene: &mut Scene, picture: Image, up: Option<DVec3>) {
    scene.lights.retain(|light| !matches!(light.kind, LightKind::Environment { .. }));
    let world_from_light = StudioFrame::of(scene, up).world_from_light();
    let image = push_image(scene, picture);
    let sky = Sky::Image { image, scale: [1.0; 3], world_from_light, rows: MapRows::Bands };
    super::add(scene, "environment", LightKind::Environment { sky, portal: None, illuminates: true });
}

/// Rotates environment maps around the up vector, by degrees counter-clockwise as seen from above. `up` as in
/// [`super::add_lights_and_camera`].
pub fn turn_environments(scene: &mut Scene, up: Option<DVec3>, degrees: f64) {
    let turn = rotation(StudioFrame::of(scene, up).basis[1], degrees);
    for light in &mut scene.lights {
        if let LightKind::Environment { sky, .. } = &mut light.kind
            && let Sky::Image { world_from_light, .. } | Sky::Octahedral { world_from_light, .. } = sky
        {
            *world_from_light = turn * *world_from_light;
        }
    }
}

/// The rotation around an axis of unit length by degrees.
pub(super) fn rotation(axis: DVec3, degrees: f64) -> DMat4 {
    let (sin, cos) = libm::sincos(degrees.to_radians());
    let column = |v: DVec3| (cos * v + sin * axis.cross(v) + (1.0 - cos) * axis.dot(v) * axis).extend(0.0);
    DMat4::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z), DMat4::IDENTITY.w_axis)
}

/// Adds a large shadow-catcher floor under everything ([`MaterialKind::ShadowCatcher`]), or under `bounds`. `up` as
/// in [`super::add_lights_and_camera`].
pub fn add_floor(scene: &mut Scene, up: Option<DVec3>, bounds: Option<Bounds>) {
    let StudioFrame { bounds: of_scene, basis: [_, up, _] } = StudioFrame::of(scene, up);
    let bounds = bounds.map_or(of_scene, sane);
    // The bounds include instances: take the lowest corner of the box along `up`.
    let Bounds { min, max } = bounds;
    let lowest = DVec3::select(up.cmpge(DVec3::ZERO), min, max).dot(up);
    // Slightly below it, so that flat undersides do not coincide with the floor.
    let radius = bounds.radius();
    let gap = 1e-3 * radius + 1e-6 * min.abs().max(max.abs()).max_element();
    let center = bounds.center();
    let center = center + (lowest - gap - center.dot(up)) * up;
    let material = MaterialId(scene.materials.len() as u32);
    let kind = MaterialKind::ShadowCatcher { normal: up.as_vec3() };
    scene.materials.push(Material::new("floor", Location::default(), kind));
    let geometry = Geometry::Disk { center, normal: up, radius: FLOOR_RADIUS * radius };
    scene.shapes.push(Shape {
        name: Some("floor".to_owned()),
        ..Shape::new(Location::default(), geometry, material)
    });
}

/// The studio's equirectangular environment map: the camera is at +z. It is painted once, for all models of a call.
fn studio() -> Image {
    static STUDIO: OnceLock<Image> = OnceLock::new();
    STUDIO.get_or_init(painted_studio).clone()
}

fn painted_studio() -> Image {
    let turns = |parts: f64| libm::sincos(std::f64::consts::PI * parts);
    let columns: Vec<(f64, f64)> =
        (0..WIDTH).map(|x| turns(2.0 * ((f64::from(x) + 0.5) / f64::from(WIDTH) - 0.5))).collect();
    let panels: Vec<(&Panel, [DVec3; 3])> = FLAGS
        .iter()
        .chain(&SOFT_BOXES)
        .map(|panel| (panel, basis_facing(DVec3::from_array(panel.toward))))
        .collect();
    let mut texels = Vec::with_capacity((WIDTH * HEIGHT) as usize);
    for y in 0..HEIGHT {
        let (sin_theta, cos_theta) = turns((f64::from(y) + 0.5) / f64::from(HEIGHT));
        for (sin_phi, cos_phi) in &columns {
            let direction = DVec3::new(sin_phi * sin_theta, cos_theta, -cos_phi * sin_theta);
            texels.push(radiance(direction, &panels).map(|c| c as f32));
        }
    }
    Image::from_linear("studio", WIDTH, HEIGHT, texels)
}

/// The studio's radiance from a unit direction.
fn radiance(direction: DVec3, panels: &[(&Panel, [DVec3; 3])]) -> [f64; 3] {
    // The backdrop.
    let above = BACKDROP[1..].iter().position(|(y, _)| direction.y <= *y).unwrap_or(BACKDROP.len() - 2);
    let [(y0, low), (y1, high)] = [BACKDROP[above], BACKDROP[above + 1]];
    let t = ((direction.y - y0) / (y1 - y0)).clamp(0.0, 1.0);
    let mut sum: [f64; 3] = std::array::from_fn(|c| low[c] + t * (high[c] - low[c]));

    // The panels in front of it.
    for (Panel { half, radiance, fade, .. }, [right, up, toward]) in panels {
        let depth = direction.dot(*toward);
        if depth <= 0.0 {
            continue;
        }
        let inside = |axis: DVec3, half: f64| {
            let from_edge = (1.0 - (direction.dot(axis) / (depth * half)).abs()) / fade;
            let t = (0.5 + 0.5 * from_edge).clamp(0.0, 1.0);
            t * t * (3.0 - 2.0 * t)
        };
        let share = inside(*right, half[0]) * inside(*up, half[1]);
        sum = std::array::from_fn(|c| sum[c] + share * (radiance[c] - sum[c]));
    }
    sum
}

/// Right, up and the direction itself, as unit vectors, for a rectangle that faces the origin from direction `toward`.
fn basis_facing(toward: DVec3) -> [DVec3; 3] {
    let toward = toward.normalize();
    let hint = if toward.y > 0.95 { DVec3::Z } else { DVec3::Y };
    let right = hint.cross(toward).normalize();
    [right, toward.cross(right), toward]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_studio_is_bright_enough_for_a_white_model_and_no_brighter() {
        let image = studio();
        // The radiosity of a white diffuse surface with this normal.
        let seen = |normal: DVec3| {
            let normal = normal.normalize();
            let mut sum = [0.0; 3];
            for (index, texel) in (0..).zip(image.texels()) {
                let (x, y) = (index % WIDTH, index / WIDTH);
                let (u, v) =
                    ((f64::from(x) + 0.5) / f64::from(WIDTH), (f64::from(y) + 0.5) / f64::from(HEIGHT));
                let ((sin_phi, cos_phi), (sin, cos)) =
                    (((u - 0.5) * std::f64::consts::TAU).sin_cos(), (v * std::f64::consts::PI).sin_cos());
                let direction = DVec3::new(sin_phi * sin, cos, -cos_phi * sin);
                let area =
                    2.0 * std::f64::consts::PI * std::f64::consts::PI * sin / f64::from(WIDTH * HEIGHT);
                let weight = direction.dot(normal).max(0.0) * area / std::f64::consts::PI;
                sum = std::array::from_fn(|c| sum[c] + weight * f64::from(texel[c]));
            }
            sum
        };
        let [up, key, front, right, below] =
            [DVec3::Y, DVec3::from_array(SOFT_BOXES[0].toward), DVec3::Z, DVec3::X, -DVec3::Y].map(seen);
        println!("up {up:?} key {key:?} front {front:?} right {right:?} below {below:?}");
        assert!((0.9..1.3).contains(&up[1]) && key[1] < 1.5, "{up:?} {key:?}");
        // No side is unlit, and none is tinted.
        for side in [up, key, front, right, below] {
            assert!(side[1] > 0.25 && (side[0] / side[2] - 1.0).abs() < 0.06, "{side:?}");
        }
        assert!(key[1] > 1.3 * right[1], "it must have a bright side");
    }

    #[test]
    fn mirrors_have_dark_edges_before_the_backdrop() {
        let image = studio();
        let [.., to_camera] = super::super::basis(DVec3::Y);
        assert_eq!(to_camera, DVec3::Z);
        let camera = -DVec3::from_array(super::super::TO_CAMERA).normalize();
        let across = camera.cross(DVec3::Y).normalize();
        let luminance = |direction: DVec3| {
            let u = libm::atan2(direction.x, -direction.z) / std::f64::consts::TAU + 0.5;
            let v = libm::acos(direction.y) / std::f64::consts::PI;
            let [x, y] = [u * f64::from(WIDTH), v * f64::from(HEIGHT)].map(|at| at as usize);
            image.texel(y.min(HEIGHT as usize - 1) * WIDTH as usize + x.min(WIDTH as usize - 1))[1]
        };
        let behind = luminance(camera);
        // What a mirror ball reflects inside its edges at the left, at the right and below: 75° aside from the camera's
        // direction, at the height of the flags, and the floor.
        for side in [across, -across] {
            let reflected = (0.26 * camera + 0.97 * side) * DVec3::new(1.0, 0.0, 1.0) - 0.1 * DVec3::Y;
            assert!(luminance(reflected.normalize()) < 0.3 * behind, "{reflected}");
        }
        assert!(luminance(DVec3::new(0.0, -0.95, -0.31)) < 0.4 * behind);
        // And the image shows neither.
        for x in [-0.45, 0.0, 0.45] {
            for y in [-0.26, 0.0, 0.26] {
                let direction = (camera + x * across + y * across.cross(camera)).normalize();
                assert!(luminance(direction) > 0.3, "{x} {y}");
            }
        }
    }

    #[test]
    fn environments_turn_around_what_is_up() {
        let mut scene = Scene::default();
        StudioFrame::of(&scene, Some(DVec3::Z)).add_studio(&mut scene);
        let middle = |scene: &Scene| match &scene.lights[0].kind {
            LightKind::Environment { sky: Sky::Image { world_from_light, .. }, .. } => {
                [-DVec3::Z, DVec3::Y].map(|v| world_from_light.transform_vector3(v))
            }
            other => panic!("{other:?}"),
        };
        let [ahead, up] = middle(&scene);
        assert!(ahead.distance(DVec3::Y) < 1e-12 && up.distance(DVec3::Z) < 1e-12, "{ahead} {up}");
        turn_environments(&mut scene, Some(DVec3::Z), 90.0);
        let [ahead, up] = middle(&scene);
        assert!(ahead.distance(-DVec3::X) < 1e-12 && up.distance(DVec3::Z) < 1e-12, "{ahead} {up}");
    }

    #[test]
    fn the_floor_lies_below_for_any_up() {
        for up in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(-1.0, 1.0, 2.0)] {
            let mut scene = Scene::default();
            add_floor(&mut scene, Some(up), None);
            let floor = scene.shapes.last().unwrap();
            let Geometry::Disk { center, normal, .. } = floor.geometry else { panic!("not a disk") };
            for corner in super::super::corners(sane(Bounds::EMPTY)) {
                assert!((corner - center).dot(normal) > 0.0);
            }
            let [_, vertical, _] = super::super::basis(up);
            assert!(vertical.distance(normal) < 1e-12);
        }
    }
}
