//! `[[mesh]]` with a `file`: import options and placement of a model file.

use std::sync::Arc;

use glam::{DMat4, DVec4};

use super::shape::{COMMON, OPERAND};
use super::table::Table;
use super::value::Value;
use super::{Reader, transform};
use crate::camera::{Camera, Projection, View};
use crate::error::Result;
use crate::files::{CameraChoice, ImportOptions};
use crate::format::Format;
use crate::light::{Light, LightKind};
use crate::shape::{Geometry, Part};
use crate::subdivision::MOST_LEVELS;

/// The keys that select the contents of a glTF file.
pub(super) const CHOICE: &[&str] = &["scene", "animation", "at", "variant", "camera", "lights"];

impl Reader<'_, '_> {
    /// The parts of the model file of a `[[mesh]]` placed by `world_from_model`. Its camera and lights are added to the
    /// scene if they are requested.
    pub(super) fn model_parts(
        &mut self,
        table: &Table<'_>,
        file: Value<'_>,
        world_from_model: &DMat4,
    ) -> Result<Vec<Part>> {
        table.one_of(&["file", "positions"]);
        if let Some(triangles) = table.find("triangles").filter(|_| !table.has("positions")) {
            triangles.note(triangles.error("`triangles` needs `positions`, not `file`"));
        }
        table.allow(&[
            &["file", "positions", "triangles", "subdivision", "displacement", "pieces"],
            CHOICE,
            COMMON,
            OPERAND,
            transform::KEYS,
        ]);
        let refuse_choice = || match CHOICE.iter().find_map(|key| table.find(key)) {
            Some(key) => Err(key.error(format!("`{}` is only for glTF files", key.key()))),
            None => Ok(()),
        };
        // Where the name tells no format, the content will.
        let path = self.resolve(file, "the name of a model file")?;
        if Format::of_name(&path).is_some_and(|format| format != Format::Gltf) {
            refuse_choice()?;
        }
        let (choice, has_camera) = self.choice(table);
        let stray = ["lights", "camera"].into_iter().find_map(|key| table.find(key));
        if let Some(key) = stray.filter(|_| self.in_object) {
            return Err(key
                .error(format!("an object cannot have `{}`", key.key()))
                .hint("give it to a [[mesh]] outside of objects"));
        }
        let model = self.model(file, &choice)?;
        if !model.is_gltf {
            refuse_choice()?;
        }
        if table.or("lights", false, Value::boolean) {
            self.scene
                .lights
                .extend(model.lights.into_iter().map(|light| moved_light(light, world_from_model)));
        }
        if has_camera && self.scene.camera.is_none() {
            self.scene.camera = model.camera.and_then(|camera| moved_camera(camera, world_from_model));
        }
        let mut parts = model.parts;
        if let Some(displacement) = self.displacement(table) {
            for part in &mut parts {
                if let Geometry::Mesh(mesh) = &mut part.geometry {
                    *mesh = self.displaced(table, *mesh, displacement)?;
                }
            }
        }
        Ok(parts)
    }

    /// Levels of subdivision of a mesh.
    pub(super) fn subdivision(&self, table: &Table<'_>) -> u32 {
        let levels = |value: Value<'_>| Ok(value.integer(0, MOST_LEVELS.into())? as u32);
        table.or("subdivision", self.context.import.subdivision, levels)
    }

    /// The import options of the file, and whether its camera is requested.
    fn choice(&self, table: &Table<'_>) -> (ImportOptions, bool) {
        let name = |key: &str, otherwise: &Option<String>| {
            table.or(key, otherwise.clone(), |value| Ok(Some(value.text("a name")?.to_owned())))
        };
        let asked = &self.context.import;
        let mut choice = ImportOptions {
            animation: name("animation", &asked.animation),
            at: table.or("at", asked.at, |value| value.number().map(Some)),
            shutter: None,
            variant: name("variant", &asked.variant),
            scene: name("scene", &asked.scene),
            camera: CameraChoice::First,
            subdivision: self.subdivision(table),
            instanced_lights: asked.instanced_lights,
        };
        let has_camera = table.or("camera", false, |value| match value.as_text() {
            Some(name) => {
                choice.camera = CameraChoice::Named(name.to_owned());
                Ok(true)
            }
            None => value.boolean().map_err(|_| value.wrong("true, false or the name of a camera")),
        });
        (choice, has_camera)
    }
}

/// A light of a model, transformed with it; its power stays the same.
fn moved_light(light: Light, matrix: &DMat4) -> Light {
    let mut moved = light;
    match &mut moved.kind {
        LightKind::Point { position, .. } => *position = matrix.transform_point3(*position),
        LightKind::Distant { direction, .. } => *direction = matrix.transform_vector3(*direction),
        LightKind::Spot { position, direction, .. } => {
            *position = matrix.transform_point3(*position);
            *direction = matrix.transform_vector3(*direction);
        }
        _ => {}
    }
    moved
}

/// A camera of a model, transformed with it; the height of an orthographic view is scaled. `None` if the transform is
/// degenerate.
fn moved_camera(camera: Camera, matrix: &DMat4) -> Option<Camera> {
    let View::Matrix(world_from_camera) = camera.view else { return Some(camera) };
    let moved = *matrix * world_from_camera;
    let axis = |column: DVec4| column.truncate().try_normalize().map(|axis| axis.extend(0.0));
    let view = DMat4::from_cols(axis(moved.x_axis)?, axis(moved.y_axis)?, axis(moved.z_axis)?, moved.w_axis);
    let growth = moved.y_axis.truncate().length();
    let projection = match camera.projection {
        Projection::Orthographic { height } => Projection::Orthographic { height: height * growth },
        Projection::LensSystem(system) => Projection::LensSystem(Arc::new(system.scaled(growth))),
        other => other,
    };
    Some(Camera { view: View::Matrix(view), projection, ..camera })
}
