//! Reader for glTF 2.0 files (Khronos, "glTF 2.0 Specification", 2021; ISO/IEC 12113:2022).
//!
//! `json` holds the structures of the JSON, `file` and `uri` find the bytes that belong to it, `accessor` turns bytes into
//! vectors. `node` places nodes in the world, `mesh` builds their geometry, `material` and `texture` their materials;
//! `camera` and `light` convert cameras and lights, `build` assembles the scene, and `contents` lists the items that
//! `choose` selects from. `animation` and `track` evaluate animations for the nodes of `pose` and for any other `properties`; `morph` and
//! `skin` deform meshes; `meshopt` and `draco` decompress. Errors name the file and the location in its JSON as a pointer (RFC 6901).

mod accessor;
mod animation;
mod build;
mod camera;
mod choose;
mod contents;
mod draco;
mod extension;
mod file;
mod json;
mod light;
mod material;
mod mesh;
mod meshopt;
mod morph;
mod node;
mod pose;
mod properties;
mod skin;
mod tangents;
mod texture;
mod track;
mod uri;

use std::path::Path;

use self::build::Model;
use self::file::Document;
use crate::budget::Reserved;
use crate::error::{Location, Result};
use crate::files::LoadContext;
use crate::load;
use crate::medium::Medium;
use crate::scene::Scene;
use crate::{studio, subdivision};

/// Reads a glTF file (`.gltf` or `.glb`) as a scene: path traced, with the Khronos PBR Neutral tone mapper, seen by the
/// file's camera where it has one. [`LoadContext::import`] selects the scene, camera, animation, variant and subdivision.
///
/// # Errors
/// `Io` and `Limit` if the file cannot be read, `Syntax` if it is not glTF, `Unsupported` if it is not version 2,
/// `Invalid` if its content is invalid.
pub fn read(path: &Path, context: &mut LoadContext<'_>) -> Result<Scene> {
    from_bytes(context.read(path)?, path, context)
}

/// As [`read`], of the content of a file; messages and relative file names use `path`.
pub(crate) fn from_bytes(
    content: Reserved<Vec<u8>>,
    path: &Path,
    context: &mut LoadContext<'_>,
) -> Result<Scene> {
    let (image, render) = studio::settings_for_models();
    let mut scene = Scene { image, render, ..Scene::default() };
    let model = document_model(content, path, context, &mut scene)?;
    model.into_scene(&mut scene);
    if scene.media.iter().any(Medium::scatters) {
        scene.render.depth = studio::DEPTH_IN_MEDIA;
    }
    Ok(scene)
}

/// The content of a glTF file as a part of another scene: its meshes, materials and images are added to the scene; the rest is
/// returned, at the places that the file gives it.
///
/// # Errors
/// As [`read`].
pub(crate) fn model(
    content: Reserved<Vec<u8>>,
    path: &Path,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Result<load::Model> {
    Ok(document_model(content, path, context, scene)?.into_parts())
}

fn document_model(
    content: Reserved<Vec<u8>>,
    path: &Path,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Result<Model> {
    let mut document = Document::open(content, path, context)?;
    extension::warn(&document, context);
    let animation = animation::chosen(&document, context)?;
    if let Some(animation) = animation {
        properties::animate(&mut document, animation, context)?;
    }
    let first = scene.meshes.len();
    let model = build::model(&document, animation, context, scene)?;
    if let levels @ 1.. = context.import.subdivision {
        let at = Location::file(path);
        subdivision::subdivide_meshes(&mut scene.meshes[first..], levels, &at, context)?;
    }
    Ok(model)
}
