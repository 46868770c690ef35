//! Automatic framing and lighting of scenes and models without a camera or lights. Everything is proportional to the bounds,
//! so that models of any size give the same image: a three-quarter view from slightly above. Models are placed in a studio,
//! built by `surroundings`; scenes without light get a large soft key light from the upper left of the camera, and a fill
//! light from all directions.

mod framing;
mod lamps;
mod subject;
mod surroundings;
mod turntable;
mod viewpoint;

use framing::Framing;
use glam::DVec3;

use crate::camera::{Camera, View};
use crate::error::Location;
use crate::light::{Falloff, Light, LightKind, Power, Sky};
use crate::material::{Color, Whitted};
use crate::model::surface::push_material;
use crate::scene::{Bounds, Instance, Scene, SourceFormat};
use crate::settings::{ImageSettings, Integrator, RenderSettings, Tonemap};
use crate::shape::{Emission, Geometry, Shape};

pub use lamps::has_lamps;
pub use surroundings::{add_floor, surround, turn_environments};
pub use turntable::Turntable;
pub use viewpoint::{Viewpoint, up_of_camera};

/// Vertical field of view in degrees, and the tangent of its half: 2 − √3.
const FOV: f64 = 30.0;
const TAN_HALF_FOV: f64 = 0.267_949_192_431_122_7;
/// The fraction of the image that the bounds may fill.
const FILL: f64 = 0.88;
/// Direction from the model to the camera, as components to the right, up and towards the viewer: 23° above the horizon.
/// With this field of view the horizon is outside the image: the floor fills it.
const TO_CAMERA: [f64; 3] = [0.5, 0.42, 0.85];
/// Direction from the model to the key light, as components to the camera's right, up, and horizontally backwards.
const TO_KEY: [f64; 3] = [-0.62, 0.85, 0.5];
/// Distance of the key light in radii of the bounds, and half its side length relative to that, for soft shadows.
const KEY_DISTANCE: f64 = 6.0;
const KEY_HALF_SIZE: f64 = 0.16;
/// The radiance of a white surface that faces the key light; with the fill it stays below 1.
const KEY: f64 = 0.62;
const FILL_ZENITH: [f32; 3] = [0.40, 0.43, 0.48];
const FILL_HORIZON: [f32; 3] = [0.30, 0.31, 0.33];
const FILL_NADIR: [f32; 3] = [0.17, 0.165, 0.16];
/// Lighting inside a closed room: ambient light, and a point light at the camera.
const ROOM: f32 = 0.3;
const LAMP: f32 = 0.55;
/// Default samples per pixel for images of models without denoising.
pub const MODEL_SAMPLES: u32 = 64;
/// Default path depth for images of models with media that scatter: light leaves wax and milk after hundreds of bounces.
pub(crate) const DEPTH_IN_MEDIA: u32 = 200;
/// Default samples per pixel for thumbnails.
const THUMBNAIL_SAMPLES: u32 = 8;
/// Maximum number of pixels of a thumbnail.
const THUMBNAIL_PIXELS: u64 = 256 * 256;

/// Adds a camera that shows the scene from a viewpoint, if there is none. It frames `bounds`, or without them what is in the
/// scene. `up` as in [`add_lights_and_camera`].
pub fn frame(scene: &mut Scene, up: Option<DVec3>, viewpoint: &Viewpoint, bounds: Option<Bounds>) {
    let stage = StudioFrame::of(scene, up);
    match bounds {
        None => stage.add_camera(scene, viewpoint),
        Some(_) if scene.camera.is_some() => {}
        Some(bounds) => {
            scene.camera = Some(framing_from(bounds, aspect(scene), stage.basis, viewpoint));
        }
    }
}

/// Adds what the scene lacks: a camera that frames its bounds, if there is none, and light, if there are neither lights
/// nor emissive shapes. `up` is the direction (of any length) that is up; without it, the camera's, or else y.
pub fn add_lights_and_camera(scene: &mut Scene, up: Option<DVec3>) {
    let stage = StudioFrame::of(scene, up);
    stage.add_camera(scene, &Viewpoint::THREE_QUARTER);
    stage.add_light(scene);
}

/// Adds what a model lacks: a camera that frames its bounds, if there is none, and a studio around it, if there are neither
/// lights nor lamps ([`has_lamps`]); where the camera is inside, a point light at the camera as well. `up` as in [`add_lights_and_camera`].
pub fn add_studio_and_camera(scene: &mut Scene, up: Option<DVec3>) {
    let stage = StudioFrame::of(scene, up);
    stage.add_camera(scene, &Viewpoint::THREE_QUARTER);
    if scene.lights.is_empty() && !has_lamps(scene) {
        stage.add_studio(scene);
        if let Some(position) = stage.eye_inside(scene) {
            add_lamp(scene, position);
        }
    }
}

/// Whether any shape emits light.
fn shines(scene: &Scene) -> bool {
    let in_objects = scene.objects.iter().flat_map(|object| &object.shapes);
    scene.shapes.iter().chain(in_objects).any(|shape| shape.emission.is_some())
}

/// Default settings for images of models: path tracing, and the Khronos PBR Neutral tone mapper.
pub fn settings_for_models() -> (ImageSettings, RenderSettings) {
    let image = ImageSettings { tonemap: Tonemap::PbrNeutral, ..ImageSettings::default() };
    let samples = samples_for_models(&image);
    let (integrator, default) = (Integrator::Path, RenderSettings::default());
    let render = RenderSettings { integrator, samples, open_fronts: true, ..default };
    (image, render)
}

/// Default samples per pixel for images of models.
pub fn samples_for_models(image: &ImageSettings) -> u32 {
    let pixels = u64::from(image.width) * u64::from(image.height);
    if image.denoise {
        return denoised_samples(pixels);
    }
    if pixels <= THUMBNAIL_PIXELS { THUMBNAIL_SAMPLES } else { MODEL_SAMPLES }
}

/// Samples per pixel with denoising: middle pictures are there within about a second; small ones need more, since fewer leave stair
/// steps at silhouettes.
fn denoised_samples(pixels: u64) -> u32 {
    let is_middle = pixels > 320 * 320 && pixels <= 512 * 512;
    if is_middle { 11 } else { 16 }
}

/// A camera that shows the box from the right, above and front, as large as it fits into an image of this aspect ratio
/// (width / height). An empty box is replaced by a unit box around the origin. `up` may have any length.
pub fn framing(bounds: Bounds, aspect: f64, up: DVec3) -> Camera {
    framing_from(bounds, aspect, basis(up), &Viewpoint::THREE_QUARTER)
}

/// A camera that frames bounds from any viewpoint; `basis` is right, up and towards the viewer.
fn framing_from(bounds: Bounds, aspect: f64, basis: [DVec3; 3], viewpoint: &Viewpoint) -> Camera {
    let bounds = sane(bounds);
    let mut framing = Framing::new(bounds.center(), basis, aspect, viewpoint);
    corners(bounds).into_iter().for_each(|corner| framing.include(corner));
    framing.camera()
}

/// The names of lights that are added to scenes without any.
const FILL_LIGHT: &str = "fill";
const ROOM_LIGHT: &str = "room";
const LAMP_LIGHT: &str = "lamp";

/// Whether a light was added to a scene that lacked light, and is not its own.
pub fn is_added(light: &Light) -> bool {
    light.at == Location::default()
        && [FILL_LIGHT, ROOM_LIGHT, LAMP_LIGHT].map(Some).contains(&light.name.as_deref())
}

fn add(scene: &mut Scene, name: &str, kind: LightKind) {
    scene.lights.push(Light {
        name: Some(name.to_owned()),
        at: Location::default(),
        kind,
        power: Power::AS_WRITTEN,
    });
}

fn add_lamp(scene: &mut Scene, position: DVec3) {
    let intensity = Color::gray(LAMP);
    add(scene, LAMP_LIGHT, LightKind::Point { position, intensity, falloff: Falloff::None });
}

/// The bounds to frame, and unit vectors to the right, up and towards the camera.
struct StudioFrame {
    bounds: Bounds,
    basis: [DVec3; 3],
}

impl StudioFrame {
    fn of(scene: &Scene, up: Option<DVec3>) -> Self {
        let of_camera = || {
            Some(match scene.camera.as_ref()?.view {
                View::Look { up, .. } => up,
                View::Matrix(matrix) => matrix.y_axis.truncate(),
            })
        };
        Self { bounds: sane(scene.bounds()), basis: basis(up.or_else(of_camera).unwrap_or(DVec3::Y)) }
    }

    fn add_camera(&self, scene: &mut Scene, viewpoint: &Viewpoint) {
        if scene.camera.is_none() {
            let mut framing = Framing::new(self.bounds.center(), self.basis, aspect(scene), viewpoint);
            let of_model = scene.source_format != SourceFormat::Scene;
            let subject = of_model.then(|| subject::on_ground(scene, self.bounds, self.basis[1])).flatten();
            if let Some(subject) = subject {
                corners(subject).into_iter().for_each(|corner| framing.include(corner));
            } else if self.bounds == scene.bounds() {
                visit(scene, &mut |point| framing.include(point));
            } else {
                corners(self.bounds).into_iter().for_each(|corner| framing.include(corner));
            }
            scene.camera = Some(framing.camera());
        }
    }

    fn add_light(&self, scene: &mut Scene) {
        let is_backdrop =
            |light: &Light| matches!(light.kind, LightKind::Environment { illuminates: false, .. });
        if scene.is_complete || shines(scene) || !scene.lights.iter().all(is_backdrop) {
            return;
        }
        let fill = if scene.lights.is_empty() {
            let sky = Sky::Gradient { zenith: FILL_ZENITH, horizon: FILL_HORIZON, nadir: FILL_NADIR };
            LightKind::Environment { sky, portal: None, illuminates: true }
        } else {
            LightKind::Ambient { color: FILL_HORIZON }
        };
        add(scene, FILL_LIGHT, fill);
        match self.eye_inside(scene) {
            Some(eye) => {
                add(scene, ROOM_LIGHT, LightKind::Ambient { color: [ROOM; 3] });
                add_lamp(scene, eye);
            }
            None => {
                let key = self.key_light(scene);
                scene.shapes.push(key);
            }
        }
    }

    /// The position of the camera if it is inside the bounds, as in a closed room that light from outside may not reach.
    fn eye_inside(&self, scene: &Scene) -> Option<DVec3> {
        let eye = match scene.camera.as_ref()?.view {
            View::Look { lookfrom, .. } => lookfrom,
            View::Matrix(matrix) => matrix.w_axis.truncate(),
        };
        let Bounds { min, max } = self.bounds;
        (eye.cmpgt(min).all() && eye.cmplt(max).all()).then_some(eye)
    }

    /// A square light that faces the centre of the bounds from the upper left of the camera.
    fn key_light(&self, scene: &mut Scene) -> Shape {
        let up = self.basis[1];
        let center = self.bounds.center();
        let to_camera = match scene.camera.as_ref().map(|camera| camera.view) {
            Some(View::Look { lookfrom, lookat, .. }) => lookfrom - lookat,
            Some(View::Matrix(matrix)) => -matrix.z_axis.truncate(),
            None => self.basis[2],
        };
        // Right and back of the camera in the horizontal plane; arbitrary for a camera that looks straight down.
        let level = to_camera - to_camera.dot(up) * up;
        let back = if level.length() > 1e-6 * to_camera.length() { level.normalize() } else { self.basis[2] };
        let right = up.cross(back);
        let direction = (TO_KEY[0] * right + TO_KEY[1] * up + TO_KEY[2] * back).normalize();
        let distance = KEY_DISTANCE * self.bounds.radius();
        let half_size = KEY_HALF_SIZE * distance;
        let edge_u = 2.0 * half_size * up.cross(direction).normalize();
        let edge_v = 2.0 * half_size * edge_u.cross(direction).normalize();
        let corner = center + distance * direction - 0.5 * (edge_u + edge_v);
        // The radiance that gives a white surface in the centre, facing the light, the brightness KEY: a small square light
        // of solid angle Ω gives L Ω / π.
        let solid_angle = 4.0 * KEY_HALF_SIZE * KEY_HALF_SIZE;
        let radiance = (KEY * std::f64::consts::PI / solid_angle) as f32;
        let black = Whitted { diffuse: Color::BLACK, ..Whitted::default() };
        let material = push_material(scene, "key light", &Location::default(), black);
        Shape {
            name: Some("key light".to_owned()),
            emission: Some(Emission::new(Color::gray(radiance), false)),
            ..Shape::new(Location::default(), Geometry::Quad { corner, edge_u, edge_v }, material)
        }
    }
}

/// The aspect ratio of the scene's image.
fn aspect(scene: &Scene) -> f64 {
    f64::from(scene.image.width) / f64::from(scene.image.height)
}

/// Visits points that bound the world: vertices of meshes, corners of the bounding boxes of other shapes.
fn visit(scene: &Scene, see: &mut dyn FnMut(DVec3)) {
    for shape in &scene.shapes {
        visit_shape(scene, shape, see);
    }
    let objects = bounds_of_objects(scene);
    for instance in &scene.instances {
        visit_instance(instance, objects[instance.object.index()], see);
    }
}

fn visit_shape(scene: &Scene, shape: &Shape, see: &mut dyn FnMut(DVec3)) {
    if let Geometry::Mesh(id) = &shape.geometry {
        let mesh = &scene.meshes[id.index()];
        let vertices = mesh.triangles.iter().flatten();
        vertices
            .map(|&vertex| mesh.positions[vertex as usize].as_dvec3())
            .for_each(|vertex| see(shape.world_from_object.transform_point3(vertex)));
    } else {
        corners(shape.bounds(&scene.meshes)).into_iter().for_each(see);
    }
}

/// The bounding box of each object, in its own space: there may be many instances of it.
fn bounds_of_objects(scene: &Scene) -> Vec<Bounds> {
    scene.objects.iter().map(|object| bounds_of(scene, &object.shapes)).collect()
}

/// Visits the corners of an object's bounds, transformed by an instance.
fn visit_instance(instance: &Instance, of_object: Bounds, see: &mut dyn FnMut(DVec3)) {
    if !of_object.is_empty() {
        corners(of_object)
            .into_iter()
            .for_each(|corner| see(instance.world_from_object.transform_point3(corner)));
    }
}

/// The bounding box of shapes, in the space that contains them.
fn bounds_of<'a>(scene: &Scene, shapes: impl IntoIterator<Item = &'a Shape>) -> Bounds {
    shapes.into_iter().map(|shape| shape.bounds(&scene.meshes)).fold(Bounds::EMPTY, Bounds::union)
}

/// The eight corners of a box.
fn corners(Bounds { min, max }: Bounds) -> [DVec3; 8] {
    std::array::from_fn(|corner| {
        let is_max = |bit: usize| corner >> bit & 1 == 1;
        DVec3::new(
            if is_max(0) { max.x } else { min.x },
            if is_max(1) { max.y } else { min.y },
            if is_max(2) { max.z } else { min.z },
        )
    })
}

/// Non-empty bounds: an empty box is replaced by a unit box around the origin, a point by a box around it.
fn sane(bounds: Bounds) -> Bounds {
    if bounds.is_empty() || !bounds.min.is_finite() || !bounds.max.is_finite() {
        return Bounds { min: DVec3::splat(-0.5), max: DVec3::splat(0.5) };
    }
    let size = bounds.min.abs().max(bounds.max.abs()).max_element();
    // Bounds smaller than the precision of their coordinates cannot be framed.
    if bounds.radius() > 1e-7 * size {
        return bounds;
    }
    let half = DVec3::splat(if size > 0.0 { 1e-3 * size } else { 0.5 });
    Bounds { min: bounds.center() - half, max: bounds.center() + half }
}

/// Unit vectors to the right, up and towards the viewer. The viewer of models with y up is at +z, with z up at −y, as in
/// modelling programs.
fn basis(up: DVec3) -> [DVec3; 3] {
    let up = up.try_normalize().unwrap_or(DVec3::Y);
    let hint = if up.x.abs() > 0.9 { DVec3::Y } else { DVec3::X };
    let back = hint.cross(up).normalize();
    [up.cross(back), up, back]
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat4;
    use proptest::prelude::*;

    /// The projection of a point: x and y in [−1, 1], and depth.
    fn project(camera: &Camera, aspect: f64, p: DVec3) -> [f64; 3] {
        let View::Look { lookfrom, lookat, up } = camera.view else { panic!("not a lookat") };
        let w = (lookat - lookfrom).normalize();
        let u = up.cross(w).normalize();
        let v = w.cross(u);
        let to = p - lookfrom;
        let depth = to.dot(w);
        [-to.dot(u) / (depth * TAN_HALF_FOV * aspect), to.dot(v) / (depth * TAN_HALF_FOV), depth]
    }

    proptest! {
        #[test]
        fn the_box_fills_the_picture(
            size in prop::array::uniform3(-3..3_i32), center in prop::array::uniform3(-4.0..4.0),
            scale in -30..30, flat in 0..4_usize, aspect in 0.2..5.0, up in 0..6_usize,
        ) {
            let scale = 2_f64.powi(scale);
            let mut half = scale * DVec3::from_array(size.map(|exponent| 2_f64.powi(exponent)));
            if flat < 3 { half[flat] = 0.0; }
            let center = scale * DVec3::from_array(center);
            let bounds = Bounds { min: center - half, max: center + half };
            let up = [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::Y, 3.0 * DVec3::Z, DVec3::new(1.0, 2.0, -1.0)][up];
            let camera = framing(bounds, aspect, up);
            let (mut least, mut most) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
            for corner in corners(bounds) {
                let [x, y, depth] = project(&camera, aspect, corner);
                prop_assert!(depth > 0.0);
                for (axis, value) in [x, y].into_iter().enumerate() {
                    prop_assert!(value.abs() <= FILL + 1e-6, "{value}");
                    least[axis] = least[axis].min(value);
                    most[axis] = most[axis].max(value);
                }
            }
            // The image is filled from edge to edge in one of the two directions.
            prop_assert!((0..2).any(|axis| (most[axis] - FILL).abs() < 1e-6 && (least[axis] + FILL).abs() < 1e-6));
        }
    }

    #[test]
    fn nothing_and_points_are_shown_too() {
        for bounds in [Bounds::EMPTY, Bounds::EMPTY.with(DVec3::ZERO), Bounds::EMPTY.with(DVec3::splat(1e9))]
        {
            let View::Look { lookfrom, lookat, .. } = framing(bounds, 1.0, DVec3::Y).view else { panic!() };
            assert!(lookfrom.is_finite() && lookat.is_finite() && lookfrom != lookat);
        }
    }

    #[test]
    fn a_mesh_is_framed_by_its_vertices() {
        // A double pyramid: the corners of its bounding box are far from it.
        let mut positions = vec![];
        for axis in [glam::Vec3::X, glam::Vec3::Y, glam::Vec3::Z] {
            positions.extend([axis, -axis]);
        }
        let triangles = vec![[0, 2, 4], [1, 3, 5]];
        let mut scene = Scene::default();
        scene.meshes.push(crate::shape::Mesh { positions, triangles, ..Default::default() });
        let mesh = Geometry::Mesh(crate::scene::MeshId(0));
        scene.shapes.push(Shape {
            world_from_object: DMat4::from_scale(DVec3::splat(1e6)),
            ..Shape::new(Location::default(), mesh, crate::scene::MaterialId(0))
        });
        StudioFrame::of(&scene, None).add_camera(&mut scene, &Viewpoint::THREE_QUARTER);
        let camera = scene.camera.as_ref().unwrap();
        let most = scene.meshes[0].positions.iter().fold(0.0_f64, |most, position| {
            let [x, y, _] = project(camera, 4.0 / 3.0, 1e6 * position.as_dvec3());
            most.max(x.abs()).max(y.abs())
        });
        assert!((most - FILL).abs() < 1e-6, "{most}");
    }

    #[test]
    fn what_is_there_stays() {
        let mut scene = Scene::default();
        let light = LightKind::Ambient { color: [1.0; 3] };
        scene.lights.push(Light {
            name: None,
            at: Location::default(),
            kind: light,
            power: Power::AS_WRITTEN,
        });
        let camera = Camera { distance: 7.0, ..Camera::default() };
        scene.camera = Some(camera);
        add_lights_and_camera(&mut scene, None);
        assert_eq!((scene.lights.len(), scene.shapes.len()), (1, 0));
        assert_eq!(scene.camera.unwrap().distance, 7.0);
    }

    #[test]
    fn the_key_light_shines_on_the_model_from_the_upper_left_of_the_camera() {
        let mut scene = Scene::default();
        add_lights_and_camera(&mut scene, None);
        let key = &scene.shapes[0];
        let Geometry::Quad { corner, edge_u, edge_v } = key.geometry else { panic!("not a quad") };
        let middle = corner + 0.5 * (edge_u + edge_v);
        assert!(edge_u.cross(edge_v).dot(-middle) > 0.0, "it must face the model");
        let [x, y, _] = project(scene.camera.as_ref().unwrap(), 4.0 / 3.0, middle);
        let View::Look { lookfrom, lookat, .. } = scene.camera.as_ref().unwrap().view else { panic!() };
        let right = (lookat - lookfrom).cross(DVec3::Y);
        assert!(middle.dot(right) < 0.0 && middle.y > 0.0);
        assert!(x.abs() > 1.0 || y.abs() > 1.0, "it must not be in the picture");
    }

    #[test]
    fn a_room_is_lit_from_inside() {
        let room = || {
            let geometry = Geometry::Sphere(crate::shape::Sphere { center: DVec3::ZERO, radius: 3.0 });
            let mut scene = Scene::default();
            let material = push_material(&mut scene, "walls", &Location::default(), Whitted::default());
            scene.shapes.push(Shape::new(Location::default(), geometry, material));
            scene
        };
        let lights_with_eye_at = |z: f64| {
            let view = View::Look { lookfrom: DVec3::new(0.0, 0.0, z), lookat: DVec3::ONE, up: DVec3::Y };
            let mut scene = Scene { camera: Some(Camera { view, ..Camera::default() }), ..room() };
            add_lights_and_camera(&mut scene, None);
            (scene.lights.len(), scene.shapes.len())
        };
        // inside: the fill, ambient light and a point light; outside: the fill and a key light that is a shape
        assert_eq!(lights_with_eye_at(2.0), (3, 1));
        assert_eq!(lights_with_eye_at(9.0), (1, 2));
    }
}
