//! A scene while the shutter is open: read at several times, and joined to one whose parts move.
//!
//! Shapes, instances and the camera move by their maps, meshes by their vertices. All else is as when the shutter opens.

use std::path::Path;
use std::sync::Arc;

use glam::{DMat3, DMat4, DQuat, DVec3};

use crate::camera::{Camera, Look, View};
use crate::error::{Location, Result};
use crate::files::{ImportOptions, LoadContext};
use crate::light::Light;
use crate::motion::Motion;
use crate::scene::{Instance, Object, ObjectId, Scene};
use crate::shape::{Geometry, MeshPose, Shape};
use crate::solid::Solid;

/// Parts of a frame between two times at which a scene is read.
const PARTS_OF_A_FRAME: f64 = 2.0;

/// The most parts of the time that the shutter is open.
const MOST_PARTS: usize = 16;

/// Lets a scene move for a number of frames from its time on, by reading it again at later times with `read`.
///
/// # Errors
/// Errors of `read`, and `Limit` where the meshes that move need more memory than there is.
pub(crate) fn open(
    scene: &mut Scene,
    frames: f64,
    path: &Path,
    context: &mut LoadContext<'_>,
    read: impl Fn(&mut LoadContext<'_>) -> Result<Scene>,
) -> Result<()> {
    let parts = ((frames * PARTS_OF_A_FRAME).ceil() as usize).clamp(2, MOST_PARTS).next_power_of_two();
    let start = context.import.at.unwrap_or(0.0);
    let read_at = |at: f64| {
        read(&mut LoadContext {
            files: context.files,
            limits: context.limits,
            budget: context.budget.clone(),
            kept: Vec::new(),
            warnings: Vec::new(),
            import: ImportOptions { at: Some(at), ..context.import.clone() },
            variables: context.variables.clone(),
        })
    };
    if context.import.at.is_none() {
        // Without a time the models of a scene are at rest, from which they would jump to their animations.
        *scene = read_at(start)?;
    }
    let first = Pose::of(scene);
    let mut changing_light = None;
    let later = (1..=parts).map(|part| {
        let open = frames / context.variables.fps * part as f64 / parts as f64;
        let now = read_at(start + open)?;
        let changed =
            |(before, now): &(&Light, &Light)| (&before.kind, before.power) != (&now.kind, now.power);
        let light = scene.lights.iter().zip(&now.lights).find(changed).map(|(light, _)| light.at.clone());
        changing_light = changing_light.take().or(light);
        Ok(Pose::with_meshes(now))
    });
    let mut later: Vec<Pose> = later.collect::<Result<_>>()?;
    if let Some(at) = changing_light {
        context.warn(&at, "not blurred: a light that is no shape stays as it is when the shutter opens");
    }
    if later.iter().any(|pose| !pose.is_of(scene)) {
        let message =
            "not blurred: while the shutter is open the number of its shapes or vertices changes, or a solid";
        context.warn(&Location::file(path), message);
        return Ok(());
    }
    let room = move_meshes(scene, &mut later);
    context.keep(room, "what moves", &Location::file(path))?;
    let poses: Vec<Pose> = std::iter::once(first).chain(later).collect();
    move_instances(scene, &poses);
    move_shapes(scene, &poses);
    if let Some(camera) = &mut scene.camera {
        let maps: Option<Vec<DMat4>> = poses.iter().map(|pose| pose.camera).collect();
        if let Some(motion) = maps.and_then(|maps| Motion::through(&maps)) {
            let back = motion.at_opening().inverse();
            camera.motion = Some(Arc::new(motion.with(|map| *map * back)));
        }
    }
    Ok(())
}

/// The moving parts of a scene, at one time.
struct Pose {
    /// The camera's frame in the world.
    camera: Option<DMat4>,
    /// Maps of shapes outside of objects, and their geometry where that is no mesh.
    shapes: Vec<(DMat4, Option<Geometry>)>,
    instances: Vec<DMat4>,
    /// The meshes of a scene that is read again; none of the first, which has its own.
    meshes: Vec<MeshPose>,
}

impl Pose {
    fn with_meshes(mut scene: Scene) -> Self {
        let meshes = std::mem::take(&mut scene.meshes).into_iter();
        let meshes = meshes.map(|mesh| MeshPose { positions: mesh.positions, normals: mesh.normals });
        Self { meshes: meshes.collect(), ..Self::of(&scene) }
    }

    fn of(scene: &Scene) -> Self {
        let shape = |shape: &Shape| {
            let is_compared = matches!(
                shape.geometry,
                Geometry::Sphere(_)
                    | Geometry::Disk { .. }
                    | Geometry::Quad { .. }
                    | Geometry::SolidSurface { .. }
            );
            (shape.world_from_object, is_compared.then(|| shape.geometry.clone()))
        };
        Self {
            camera: scene.camera.as_ref().and_then(frame_of_camera),
            shapes: scene.shapes.iter().map(shape).collect(),
            instances: scene.instances.iter().map(|instance| instance.world_from_object).collect(),
            meshes: Vec::new(),
        }
    }

    /// Whether there are as many parts as in a scene, and the same solids.
    fn is_of(&self, scene: &Scene) -> bool {
        let vertices = self.meshes.iter().map(|mesh| (mesh.positions.len(), mesh.normals.len()));
        let solids = scene.shapes.iter().map(|shape| solid_of(Some(&shape.geometry)));
        self.shapes.len() == scene.shapes.len()
            && self.shapes.iter().map(|(_, geometry)| solid_of(geometry.as_ref())).eq(solids)
            && self.instances.len() == scene.instances.len()
            && vertices.eq(scene.meshes.iter().map(|mesh| (mesh.positions.len(), mesh.normals.len())))
    }

    /// The map of a shape from its space in `first` to the world at this time.
    fn map_of_shape(&self, index: usize, first: &Self) -> DMat4 {
        let (map, geometry) = &self.shapes[index];
        let frames = [geometry, &first.shapes[index].1].map(|of| of.as_ref().and_then(frame_of_geometry));
        match frames {
            [Some(now), Some(before)] if now != before => *map * now * before.inverse(),
            _ => *map,
        }
    }
}

/// The solid of which a geometry is a surface.
fn solid_of(geometry: Option<&Geometry>) -> Option<&Solid> {
    match geometry {
        Some(Geometry::SolidSurface { solid, .. }) => Some(solid),
        _ => None,
    }
}

/// A frame that moves with a sphere, a disk or a quad.
fn frame_of_geometry(geometry: &Geometry) -> Option<DMat4> {
    let frame = match geometry {
        Geometry::Sphere(sphere) => {
            DMat4::from_translation(sphere.center) * DMat4::from_scale(DVec3::splat(sphere.radius))
        }
        Geometry::Disk { center, normal, radius } => {
            let turn = DQuat::from_rotation_arc(DVec3::Z, normal.normalize());
            let linear = DMat3::from_quat(turn) * *radius;
            DMat4::from_mat3_translation(linear, *center)
        }
        Geometry::Quad { corner, edge_u, edge_v } => {
            let linear = DMat3::from_cols(*edge_u, *edge_v, edge_u.cross(*edge_v).normalize());
            DMat4::from_mat3_translation(linear, *corner)
        }
        _ => return None,
    };
    (frame.is_finite() && frame.determinant() != 0.0).then_some(frame)
}

/// The frame of a camera in the world: [`View::Matrix`], or orthonormal.
fn frame_of_camera(camera: &Camera) -> Option<DMat4> {
    let frame = match camera.view {
        View::Matrix(matrix) => matrix,
        View::Look { lookfrom, lookat, up } => Look { lookfrom, lookat, up }.matrix()?,
    };
    (frame.is_finite() && frame.determinant() != 0.0).then_some(frame)
}

/// Gives meshes whose vertices move their later poses. Returns the bytes of these.
fn move_meshes(scene: &mut Scene, later: &mut [Pose]) -> u64 {
    let mut bytes = 0;
    for (index, mesh) in scene.meshes.iter_mut().enumerate() {
        if later.iter().any(|pose| pose.meshes[index].positions != mesh.positions) {
            mesh.later = later.iter_mut().map(|pose| std::mem::take(&mut pose.meshes[index])).collect();
            bytes += mesh.later.iter().map(MeshPose::bytes).sum::<u64>();
        }
    }
    bytes
}

fn move_instances(scene: &mut Scene, poses: &[Pose]) {
    for (index, instance) in scene.instances.iter_mut().enumerate() {
        let maps: Vec<DMat4> = poses.iter().map(|pose| pose.instances[index]).collect();
        // What does not change between the times has the motion that it is given.
        instance.motion = Motion::through(&maps).map(Arc::new).or(instance.motion.take());
    }
}

/// Makes objects with an instance of shapes that move.
fn move_shapes(scene: &mut Scene, poses: &[Pose]) {
    let mut standing = Vec::new();
    for (index, shape) in std::mem::take(&mut scene.shapes).into_iter().enumerate() {
        let maps: Vec<DMat4> = poses.iter().map(|pose| pose.map_of_shape(index, &poses[0])).collect();
        let motion = Motion::through(&maps).map(Arc::new);
        let deforms =
            matches!(shape.geometry, Geometry::Mesh(id) if !scene.meshes[id.index()].later.is_empty());
        if motion.is_none() && !deforms {
            standing.push(shape);
            continue;
        }
        let object = ObjectId(scene.objects.len() as u32);
        let (at, world_from_object) = (shape.at.clone(), shape.world_from_object);
        let shape = Shape { world_from_object: DMat4::IDENTITY, ..shape };
        let name = shape.name.clone().unwrap_or_else(|| format!("moving shape {}", object.0 + 1));
        scene.objects.push(Object { name, at: at.clone(), shapes: vec![shape] });
        scene.instances.push(Instance { motion, ..Instance::new(at, object, world_from_object) });
    }
    scene.shapes = standing;
}
