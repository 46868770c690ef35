//! Reader for glTF 2.0 files (Khronos, "glTF 2.0 Specification", 2021; ISO/IEC 12113:2022).
//!
//! `json` says what stands in the file, `file` and `uri` which bytes belong to it, `accessor` how bytes become vectors.
//! `node` places things, `mesh` gives them form, `material` and `texture` a look; `camera` and `light` do what their
//! names say, `build` joins everything, and `contents` lists what there is to `choose` from. `pose` and `track` say how nodes stand at a moment, `morph` and `skin` how
//! meshes follow; `meshopt` and `draco` unpack what is compressed. Errors name the file and the place in its JSON as a pointer (RFC 6901).

mod accessor;
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
mod skin;
mod tangents;
mod texture;
mod track;
mod uri;

use std::path::Path;

use self::build::Model;
use self::file::Document;
use crate::error::Result;
use crate::files::LoadContext;
use crate::load;
use crate::scene::Scene;
use crate::studio;

/// Reads a glTF file (`.gltf` or `.glb`) as a scene: path traced, developed by Khronos' tone map, seen by the file's
/// camera where it has one. [`LoadContext::import`] says which scene, camera, animation and variant are meant.
///
/// # Errors
/// `Io` and `Limit` where it cannot be read, `Syntax` where it is no glTF, `Unsupported` where it is not of version 2,
/// `Invalid` where what it says cannot be.
pub fn read(path: &Path, context: &mut LoadContext<'_>) -> Result<Scene> {
    let content = context.read(path)?;
    let (image, render) = studio::settings_for_models();
    let mut scene = Scene { image, render, ..Scene::default() };
    let model = document_model(content, path, context, &mut scene)?;
    model.into_scene(&mut scene);
    Ok(scene)
}

/// Reads a glTF file as a part of another scene: its meshes, materials and pictures join the scene, the rest is given
/// back and stands where the file has it.
///
/// # Errors
/// As [`read`].
pub(crate) fn model(path: &Path, context: &mut LoadContext<'_>, scene: &mut Scene) -> Result<load::Model> {
    let content = context.read(path)?;
    Ok(document_model(content, path, context, scene)?.into_parts())
}

/// Whether a file's content is that of a glTF file: the mark of a GLB container, or JSON that speaks of an asset.
pub fn is_gltf(content: &[u8]) -> bool {
    let text = content.strip_prefix("\u{feff}".as_bytes()).unwrap_or(content).trim_ascii_start();
    // The asset may stand behind much else: then the name of the file has to say what it is.
    let beginning = &text[..text.len().min(1 << 16)];
    content.starts_with(file::MAGIC)
        || (text.starts_with(b"{") && beginning.windows(7).any(|word| word == b"\"asset\""))
}

fn document_model(
    content: Vec<u8>,
    path: &Path,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Result<Model> {
    let document = Document::open(content, path, context)?;
    extension::warn(&document, context);
    build::model(&document, context, scene)
}
