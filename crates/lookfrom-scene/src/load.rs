//! Selection of the reader of a file, by its extension, or else by its first bytes.

use std::path::Path;

use crate::camera::Camera;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::{CameraChoice, LoadContext};
use crate::light::Light;
use crate::material::{Color, Material, MaterialKind};
use crate::scene::{MaterialId, Scene, SourceFormat};
use crate::shape::{Mesh, Part, Shape};
use crate::{duplicates, gltf, model, packed, pbrt, studio, subdivision, toml};

/// The reflectance of models whose file has no materials.
const CLAY: f32 = 0.8;

/// The path that stands for a pipe, from which a file comes without a name.
pub const PIPE: &str = "-";

/// Reads a scene in our own format (`.toml`), of pbrt-v4 (`.pbrt`), a glTF file (`.gltf`, `.glb`), or a model file, whose
/// parts are placed as in the file and have a diffuse grey material "default" if the file gives them none.
/// [`LoadContext::import`] selects the camera of a file. From a [`PIPE`] or another pipe, what no other reader knows is our own format.
///
/// # Errors
/// `Unsupported` if the format is not known, and the errors of the format's reader.
pub fn scene(path: &Path, context: &mut LoadContext<'_>) -> Result<Scene> {
    let mut scene = whole(path, context)?;
    // What a reader only warns of, such as a picture without which it goes on, may have been this.
    if let Some(refusal) = context.budget.take_refusal() {
        return Err(refusal);
    }
    if let Some(name) = context.variables.values.keys().next().filter(|_| scene.contents.variables.is_empty())
    {
        // Our own format knows better what is missing.
        let message = format!("--define {name}: this file has no variables");
        return Err(Error::new(ErrorKind::Request, &Location::default(), message)
            .hint("variables are for scenes in our own format (.toml)"));
    }
    if context.import.camera == CameraChoice::None {
        scene.camera = None;
    }
    duplicates::remove(&mut scene, &Location::file(path), context);
    Ok(scene)
}

fn whole(path: &Path, context: &mut LoadContext<'_>) -> Result<Scene> {
    if is_toml(path) {
        return toml::read(path, context);
    }
    if is_pbrt(path, context) {
        return pbrt::read(path, context);
    }
    if is_gltf(path, context) {
        let mut scene = Scene { source_format: SourceFormat::Gltf, ..gltf::read(path, context)? };
        subdivide(&mut scene.meshes, path, context)?;
        return Ok(scene);
    }
    let (image, render) = studio::settings_for_models();
    let mut scene = Scene { source_format: SourceFormat::Model, image, render, ..Scene::default() };
    let parts = match model(path, context, &mut scene) {
        Ok(model) => {
            let points = scene.meshes.iter().flat_map(|mesh| &mesh.positions);
            let is_odd = model.z_is_up && model::stand::stands_on_y(points);
            scene.z_is_up = model.z_is_up && !is_odd;
            if is_odd {
                let message = "y is up: with z up, as is the custom of this format, it would fall over; --up z shows it so";
                context.notice(&Location::file(path), message);
            }
            model.parts
        }
        Err(error) if error.kind == ErrorKind::Unsupported && is_stream(path, context) => {
            return toml::read(path, context);
        }
        Err(error) => return Err(error),
    };
    let default = MaterialId(scene.materials.len() as u32);
    let clay = MaterialKind::Diffuse { reflectance: Color::gray(CLAY) };
    scene.materials.push(Material::new("default", Location::default(), clay));
    scene.shapes = shapes(parts, &Location::file(path), default);
    Ok(scene)
}

/// Whether a file has the name of a scene or of a model, as [`scene`] reads them.
pub fn has_known_name(path: &Path) -> bool {
    is_toml(path)
        || extension(&packed::unpacked_name(path)) == "pbrt"
        || GLTF.contains(&&*extension(path))
        || model::is_model(path)
}

/// Whether a path is a pipe, whose name says nothing: `-`, or one of the system's without an extension.
fn is_stream(path: &Path, context: &LoadContext<'_>) -> bool {
    path == Path::new(PIPE) || (path.extension().is_none() && context.files.length(path).is_none())
}

/// Whether a file has the name of a scene in our own format.
pub fn is_toml(path: &Path) -> bool {
    extension(path) == "toml"
}

/// Whether a file is a scene of pbrt, by its name (`.pbrt`, `.pbrt.gz`), or by its content if the name is inconclusive.
fn is_pbrt(path: &Path, context: &LoadContext<'_>) -> bool {
    let is_other = model::is_model(path) || GLTF.contains(&&*extension(path));
    extension(&packed::unpacked_name(path)) == "pbrt"
        || (!is_other && packed::read(path, context).is_ok_and(|bytes| pbrt::is_pbrt(&bytes)))
}

/// The extensions of glTF files.
const GLTF: &[&str] = &["gltf", "glb"];

/// Whether a file is a glTF file, by its name, or by its content if the name is inconclusive.
pub(crate) fn is_gltf(path: &Path, context: &LoadContext<'_>) -> bool {
    GLTF.contains(&&*extension(path))
        || (!model::is_model(path) && context.read(path).is_ok_and(|bytes| gltf::is_gltf(&bytes)))
}

fn extension(path: &Path) -> String {
    path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).unwrap_or_default()
}

/// The parts of a merged file that are not added to the scene directly.
#[derive(Clone, Default)]
pub(crate) struct Model {
    pub(crate) parts: Vec<Part>,
    /// Whether z is up by the custom of the format, not y.
    pub(crate) z_is_up: bool,
    /// The selected camera of the file.
    pub(crate) camera: Option<Camera>,
    pub(crate) lights: Vec<Light>,
}

/// The parts of a model file; its materials are added to the scene.
pub(crate) fn model(path: &Path, context: &mut LoadContext<'_>, scene: &mut Scene) -> Result<Model> {
    let unsupported = |message: String| {
        Error::new(ErrorKind::Unsupported, &Location::file(path), message)
            .hint("scenes are .toml or .pbrt files, models .gltf, .glb, .obj, .ply or .stl")
    };
    if extension(&packed::unpacked_name(path)) == "pbrt" {
        return Err(unsupported("a scene of pbrt cannot be a part of another scene".to_owned()));
    }
    let first = scene.meshes.len();
    if is_gltf(path, context) {
        let model = gltf::model(path, context, scene)?;
        subdivide(&mut scene.meshes[first..], path, context)?;
        return Ok(model);
    }
    let (parts, z_is_up) = model::read_with_up(path, context, scene).map_err(|error| match error.kind {
        ErrorKind::Unsupported if !model::is_model(path) => unsupported(
            "the format is not known, neither by the name nor by the content of the file".to_owned(),
        ),
        _ => error,
    })?;
    Ok(Model { parts, z_is_up, ..Model::default() })
}

/// Subdivides meshes as [`LoadContext::import`] says.
fn subdivide(meshes: &mut [Mesh], path: &Path, context: &mut LoadContext<'_>) -> Result<()> {
    match context.import.subdivision {
        0 => Ok(()),
        levels => subdivision::subdivide_meshes(meshes, levels, &Location::file(path), context),
    }
}

/// Converts parts to shapes with the transforms of the file.
pub(crate) fn shapes(parts: Vec<Part>, at: &Location, default: MaterialId) -> Vec<Shape> {
    parts
        .into_iter()
        .map(|part| Shape {
            name: part.name,
            emission: part.emission,
            alpha: part.alpha,
            single_sided: part.single_sided,
            world_from_object: part.world_from_object,
            ..Shape::new(at.clone(), part.geometry, part.material.unwrap_or(default))
        })
        .collect()
}
