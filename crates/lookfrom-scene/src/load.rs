//! Selection of the reader of a file by its format.

mod smoke;

use std::path::Path;

use crate::camera::Camera;
use crate::contents::Moment;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::{CameraChoice, ImportOptions, LoadContext};
use crate::format::Format;
pub use crate::format::known_files;
#[cfg(feature = "gltf")]
use crate::gltf;
use crate::light::Light;
use crate::material::{Color, Material, MaterialKind};
#[cfg(feature = "mitsuba")]
use crate::mitsuba;
#[cfg(feature = "pbrt")]
use crate::pbrt;
use crate::remedy::Remedy;
use crate::scene::{MaterialId, Scene, SourceFormat};
use crate::shape::{Part, Shape};
use crate::source::Source;
use crate::warning::Warning;
use crate::{duplicates, level_set, model, shutter, studio, toml};

/// The reflectance of models whose file has no materials.
const CLAY: f32 = 0.8;

/// The path that stands for a pipe, from which a file comes without a name.
pub const PIPE: &str = "-";

/// Reads a scene in our own format (`.toml`), of pbrt-v4 (`.pbrt`) or Mitsuba 3 (`.xml`), a glTF file (`.gltf`, `.glb`), or a model file, whose
/// parts are placed as in the file and have a diffuse grey material "default" if the file gives them none. A file of volumes (`.vdb`, `.nvdb`) is
/// white smoke of its densities, or the surfaces of its level sets.
/// [`LoadContext::import`] selects the camera of a file. From a [`PIPE`] or another pipe, what no other reader knows is our own format.
///
/// # Errors
/// `Unsupported` if the format is not known, and the errors of the format's reader.
pub fn scene(path: &Path, context: &mut LoadContext<'_>) -> Result<Scene> {
    let mut scene = whole(path, context)?;
    let frames = context.import.shutter.or(scene.camera.as_ref().map(|camera| camera.shutter));
    let shutter = frames.filter(|frames| *frames > 0.0).unwrap_or(0.0);
    if is_animated(&scene, context) {
        if shutter > 0.0 {
            shutter::open(&mut scene, shutter, path, context, |context| whole(path, context))?;
        }
        let (time, fps) = (context.import.at.unwrap_or(0.0), context.variables.fps);
        scene.contents.moment = Some(Moment { time, fps, shutter });
    } else if shutter > 0.0 && !scene.contents.animations.is_empty() {
        let message = "not blurred: without a time or the name of an animation it is at rest";
        context.warn(&Location::file(path), message);
    }
    // What a reader only warns of, such as a picture without which it goes on, may have been this.
    if let Some(refusal) = context.budget.take_refusal() {
        return Err(refusal);
    }
    if let Some(name) = context.variables.values.keys().next().filter(|_| scene.contents.variables.is_empty())
    {
        // Our own format knows better what is missing.
        let message = format!("this file has no variables, and so no `{name}`");
        return Err(Error::new(ErrorKind::Request, &Location::default(), message)
            .hint("variables are for scenes in our own format (.toml) and of Mitsuba (.xml)"));
    }
    if context.import.camera == CameraChoice::None {
        scene.camera = None;
    }
    duplicates::remove(&mut scene, &Location::file(path), context);
    Ok(scene)
}

/// Whether a scene depends on the time.
fn is_animated(scene: &Scene, context: &LoadContext<'_>) -> bool {
    let ImportOptions { animation, at, .. } = &context.import;
    at.is_some()
        || scene.contents.duration.is_some()
        || !scene.contents.animations.is_empty() && animation.is_some()
}

fn whole(path: &Path, context: &mut LoadContext<'_>) -> Result<Scene> {
    let source = Source::open(path, context)?;
    match source.format {
        Some(Format::Toml) => toml::from_bytes(&source.bytes, path, context),
        #[cfg(feature = "pbrt")]
        Some(Format::Pbrt) => pbrt::from_bytes(source.bytes, path, context),
        #[cfg(not(feature = "pbrt"))]
        Some(Format::Pbrt) => Err(left_out(path, "scenes of pbrt", "pbrt")),
        #[cfg(feature = "mitsuba")]
        Some(Format::Mitsuba) => mitsuba::from_bytes(&source.bytes, path, context),
        #[cfg(not(feature = "mitsuba"))]
        Some(Format::Mitsuba) => Err(left_out(path, "scenes of Mitsuba", "mitsuba")),
        #[cfg(feature = "gltf")]
        Some(Format::Gltf) => {
            let scene = gltf::from_bytes(source.bytes, path, context)?;
            Ok(Scene { source_format: SourceFormat::Gltf, ..scene })
        }
        #[cfg(not(feature = "gltf"))]
        Some(Format::Gltf) => Err(left_out(path, "glTF", "gltf")),
        Some(Format::Obj | Format::Ply | Format::Stl | Format::Hair) => scene_of_model(&source, context),
        Some(Format::Vdb) if level_set::is_model(&source.bytes, path)? => scene_of_model(&source, context),
        Some(Format::Vdb) => smoke::scene(&source, context),
        None if is_stream(path, context) => toml::from_bytes(&source.bytes, path, context),
        None => Err(unknown_format(path)),
    }
}

/// The scene of a model without a camera and lights, which the studio completes.
fn scene_of_model(source: &Source<'_>, context: &mut LoadContext<'_>) -> Result<Scene> {
    let file = Location::file(source.path);
    let (image, render) = studio::settings_for_models();
    let mut scene = Scene { source_format: SourceFormat::Model, image, render, ..Scene::default() };
    let parts = model::of_source(source, true, context, &mut scene)?;
    let points = scene.meshes.iter().flat_map(|mesh| &mesh.positions);
    // Programs for construction and for printers put parts onto the plane of x and y, and heads of hair look along it.
    let is_custom = matches!(source.format, Some(Format::Stl | Format::Hair));
    let is_odd = is_custom && model::stand::stands_on_y(points);
    scene.z_is_up = is_custom && !is_odd;
    if is_odd {
        let message = "y is up: with z up, as is the custom of this format, it would fall over";
        context.warnings.push(Warning::notice(&file, message).remedy(Remedy::Up("z")));
    }
    let default = MaterialId(scene.materials.len() as u32);
    let clay = MaterialKind::Diffuse { reflectance: Color::gray(CLAY) };
    scene.materials.push(Material::new("default", Location::default(), clay));
    scene.shapes = shapes(parts, &file, default);
    Ok(scene)
}

/// Whether a file has the name of a scene or of a model, as [`scene`] reads them.
pub fn has_known_name(path: &Path) -> bool {
    Format::of_name(path).is_some()
}

/// Whether a path is a pipe, whose name says nothing: `-`, one of the system's without an extension, or what a shell has put in the place
/// of one.
fn is_stream(path: &Path, context: &LoadContext<'_>) -> bool {
    let is_descriptor =
        || ["/dev/stdin", "/dev/fd", "/proc/self/fd"].iter().any(|known| path.starts_with(known));
    path == Path::new(PIPE)
        || is_descriptor()
        || (path.extension().is_none() && context.files.length(path).is_none())
}

/// Whether a file has the name of a scene in our own format.
pub fn is_toml(path: &Path) -> bool {
    Format::of_name(path) == Some(Format::Toml)
}

/// The parts of a merged file that are not added to the scene directly.
#[derive(Clone, Default)]
pub(crate) struct Model {
    pub(crate) parts: Vec<Part>,
    /// Whether the file is a glTF file.
    pub(crate) is_gltf: bool,
    /// The selected camera of the file.
    pub(crate) camera: Option<Camera>,
    pub(crate) lights: Vec<Light>,
}

/// The parts of a model file; its materials are added to the scene.
pub(crate) fn model(path: &Path, context: &mut LoadContext<'_>, scene: &mut Scene) -> Result<Model> {
    let of_scene =
        |program: &str| unsupported(path, &format!("a scene of {program} cannot be a part of another scene"));
    match Format::of_name(path) {
        Some(Format::Pbrt) => return Err(of_scene("pbrt")),
        Some(Format::Mitsuba) => return Err(of_scene("Mitsuba")),
        _ => {}
    }
    let source = Source::open(path, context)?;
    match source.format {
        #[cfg(feature = "gltf")]
        Some(Format::Gltf) => gltf::model(source.bytes, path, context, scene),
        #[cfg(not(feature = "gltf"))]
        Some(Format::Gltf) => Err(left_out(path, "glTF", "gltf")),
        Some(Format::Obj | Format::Ply | Format::Stl | Format::Hair | Format::Vdb) => {
            Ok(Model { parts: model::of_source(&source, true, context, scene)?, ..Model::default() })
        }
        Some(Format::Pbrt) => Err(of_scene("pbrt")),
        Some(Format::Mitsuba) => Err(of_scene("Mitsuba")),
        Some(Format::Toml) | None => Err(unknown_format(path)),
    }
}

/// Formats that other programs can convert: extensions, and how.
const CONVERTIBLE: [(&[&str], &str); 4] = [
    (&["3mf", "amf"], "save it as .stl or .obj in the slicer"),
    (
        &["step", "stp", "iges", "igs", "brep", "sldprt", "f3d", "ipt", "3dm"],
        "export triangles as .stl or .obj from the CAD program, such as FreeCAD",
    ),
    (
        &["scad"],
        "`openscad -o part.stl part.scad` makes triangles of it; our own solids have the same operations",
    ),
    (
        &[
            "dae", "fbx", "blend", "usd", "usda", "usdc", "usdz", "abc", "3ds", "x3d", "wrl", "off", "skp",
            "lwo", "c4d", "max", "ma", "mb",
        ],
        "export it as .glb from the program that wrote it, or from Blender",
    ),
];

fn unknown_format(path: &Path) -> Error {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match CONVERTIBLE.iter().find(|(extensions, _)| extensions.contains(&extension.as_str())) {
        Some((_, how)) => {
            let message = format!("there is no reader for .{extension} files");
            let error = Error::new(ErrorKind::Unsupported, &Location::file(path), message);
            error.hint(format!("{how}; {}", readable()))
        }
        None => {
            unsupported(path, "the format is not known, neither by the name nor by the content of the file")
        }
    }
}

fn unsupported(path: &Path, message: &str) -> Error {
    Error::new(ErrorKind::Unsupported, &Location::file(path), message).hint(readable())
}

/// What can be read, in words.
fn readable() -> String {
    let known = known_files().map(|(content, extensions)| format!("{content}s ({extensions})"));
    format!("what can be read: {}", known.join(", "))
}

/// The refusal of a format whose reader was not compiled.
#[cfg(not(all(feature = "gltf", feature = "mitsuba", feature = "pbrt")))]
fn left_out(path: &Path, format: &str, feature: &str) -> Error {
    let message = format!("this build has no reader for {format}");
    Error::new(ErrorKind::Unsupported, &Location::file(path), message)
        .hint(format!("build with the feature `{feature}`"))
}

/// Converts parts to shapes with the transforms of the file.
pub(crate) fn shapes(parts: Vec<Part>, at: &Location, default: MaterialId) -> Vec<Shape> {
    parts
        .into_iter()
        .map(|part| Shape {
            name: part.name,
            pieces: part.pieces,
            emission: part.emission,
            alpha: part.alpha,
            single_sided: part.single_sided,
            world_from_object: part.world_from_object,
            ..Shape::new(at.clone(), part.geometry, part.material.unwrap_or(default))
        })
        .collect()
}
