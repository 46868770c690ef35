//! Reader and [writer](mod@write) for our own scene format (`docs/guide/scene-format.md`). Errors have the location of the invalid value.
//!
//! This file reads files and merges what they import. Beside it: `document`, `table` and `value` (the parsed text with
//! locations, and recorded errors), `variables` and `scope` (variables, which are replaced by their values before anything is decoded; with
//! `expression`, `evaluate`, `function`, `quantity` and `keyframes`), `syntax` (recovery from errors of TOML), `synonyms` (terms of other programs), and a
//! decoder for each part of the vocabulary.

mod camera;
mod clear_sky;
mod color;
mod color_names;
mod curve;
mod directional;
mod disney;
mod dispersion;
mod document;
mod elements;
mod evaluate;
mod expression;
mod function;
mod hair;
mod heightfield;
mod import;
mod keyframes;
mod light;
mod mapping;
mod material;
mod medium;
mod mesh;
mod model;
mod object;
mod open_pbr;
mod physical;
mod pieces;
mod principled;
mod quadric;
mod quantity;
mod revolution;
mod scope;
mod settings;
mod shape;
mod sky;
mod solid;
mod spectrum;
mod subsurface;
mod synonyms;
mod syntax;
mod table;
mod text;
mod texture;
mod transform;
mod value;
mod variables;
mod vocabulary;
mod volume;
pub mod write;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use ::toml::de::DeTable;

use self::document::Document;
use self::import::tidy;
use self::material::DEFAULT;
use self::syntax::Readable;
use self::table::{SCENE, Table};
use self::value::Value;
use self::variables::Variables;
use self::vocabulary::TOP;
use crate::camera::Camera;
use crate::error::{Error, Location, Result};
use crate::files::{ImportOptions, LoadContext};
use crate::image::{self, Encoding, Reading};
use crate::load;
use crate::load::Model;
use crate::material::{MaterialKind, Scalar};
use crate::scene::{
    CurveId, ImageId, MaterialId, MediumId, MeshId, ObjectId, Scene, TextureId, VertexNormals,
};
use crate::settings::{Integrator, SpectralFilm};
use crate::shape::Emission;
use crate::suggest::nearest;
use crate::validate;

pub use self::vocabulary::vocabulary;

/// Reads a scene in our own format, with all its imports.
///
/// # Errors
/// With line and column, and all errors that one run can find: `Syntax` for malformed TOML, `Invalid` for an unknown or
/// invalid key, type, number or name, `Limit` for excessive sizes and nesting, and the errors of the files that it names.
pub fn read(path: &Path, context: &mut LoadContext<'_>) -> Result<Scene> {
    let bytes = context.read(path)?;
    from_bytes(&bytes, path, context)
}

/// As [`read`], of the content of the main file.
pub(crate) fn from_bytes(bytes: &[u8], path: &Path, context: &mut LoadContext<'_>) -> Result<Scene> {
    let given = variables::given(context);
    let mut reader = Reader {
        variables: Variables::new(&given, context),
        time: context.import.at,
        context,
        scene: Scene::default(),
        scene_file: Location::file(path),
        materials: BTreeMap::new(),
        textures: BTreeMap::new(),
        media: BTreeMap::new(),
        filled: BTreeMap::new(),
        objects: BTreeMap::new(),
        images: BTreeMap::new(),
        curves: BTreeMap::new(),
        models: Vec::new(),
        in_object: false,
        glows: BTreeMap::new(),
        opacities: BTreeMap::new(),
        unwritten_default: None,
        black: None,
        displaced: Vec::new(),
        open: Vec::new(),
        done: BTreeSet::new(),
        flake_spheres: 0,
        segments: revolution::SEGMENTS,
        has_image: false,
        has_render: false,
        names_integrator: false,
        knows_all_names: true,
        errors: Vec::new(),
    };
    reader.scene_text(path, bytes)?;
    reader.errors.extend(reader.variables.errors(reader.knows_all_names));
    if let Some(error) = Error::all(reader.errors) {
        return Err(error);
    }
    // Only path tracing renders physically based materials and media completely.
    let mut scene = reader.scene;
    scene.contents.duration = reader.variables.duration();
    scene.contents.variables = reader.variables.into_all();
    validate::check_surface(&scene)?;
    let is_physical = |kind: &MaterialKind| !matches!(kind, MaterialKind::Whitted(_));
    if !reader.names_integrator
        && (!scene.media.is_empty() || scene.materials.iter().any(|material| is_physical(&material.kind)))
    {
        scene.render.integrator = Integrator::Path;
    }
    Ok(scene)
}

/// The maximum number of names that are compared with an unknown one.
const MOST_COMPARED: usize = 1000;

/// The state of a load: the scene so far, and the names defined so far.
struct Reader<'s, 'f> {
    context: &'s mut LoadContext<'f>,
    scene: Scene,
    /// The main file.
    scene_file: Location,
    variables: Variables<'s>,
    /// The time of all animations in seconds, if one is asked for.
    time: Option<f64>,
    materials: BTreeMap<String, MaterialId>,
    textures: BTreeMap<String, TextureId>,
    media: BTreeMap<String, MediumId>,
    /// Materials of bodies that are filled with a medium, by their own.
    filled: BTreeMap<(Option<MaterialId>, MediumId), MaterialId>,
    objects: BTreeMap<String, ObjectId>,
    /// By file, and whether it contains data rather than colours.
    images: BTreeMap<(PathBuf, Option<String>, bool), ImageId>,
    /// By description.
    curves: BTreeMap<String, CurveId>,
    /// By file and import options.
    models: Vec<((PathBuf, ImportOptions), Model)>,
    /// Emission of materials that have any.
    glows: BTreeMap<MaterialId, Emission>,
    /// Opacity of materials that have any.
    opacities: BTreeMap<MaterialId, Scalar>,
    /// The material "default", if it has been used but is not defined in a file (yet).
    unwritten_default: Option<MaterialId>,
    black: Option<MaterialId>,
    /// Meshes that are those of files but for their displacement.
    displaced: Vec<((MeshId, Scalar), MeshId)>,
    /// The open files: each is imported by the previous one.
    open: Vec<PathBuf>,
    /// The files that have been read.
    done: BTreeSet<PathBuf>,
    /// Whether the current shapes belong to an object.
    in_object: bool,
    /// Number of spheres of all sphereflakes so far.
    flake_spheres: u64,
    /// Straight pieces of a circle, where a shape does not say how many.
    segments: u64,
    has_image: bool,
    has_render: bool,
    /// Whether the effective `[render]` names an integrator.
    names_integrator: bool,
    /// Whether all definitions of names could be read. Otherwise an unknown name may be one that could not.
    knows_all_names: bool,
    /// Errors of all files so far.
    errors: Vec<Error>,
}

impl Reader<'_, '_> {
    /// Reads the text of a file; errors in its tables are recorded.
    fn scene_text(&mut self, path: &Path, bytes: &[u8]) -> Result<()> {
        let whole = Location::file(path);
        let memory = bytes.len() as u64 + document::memory(bytes);
        let _parsing = self.context.budget.reserve(memory, "the parsed scene", &whole)?;
        let text = str::from_utf8(bytes).map(str::to_owned).map_err(|error| {
            let valid = error.valid_up_to();
            let line = bytes[..valid].iter().filter(|&&byte| byte == b'\n').count() + 1;
            Error::syntax(&whole.at(u32::try_from(line).unwrap_or(0), 0), "the text is not UTF-8")
                .hint("save it as UTF-8; a model or picture has to be named by its own extension")
        })?;
        let document = Document::new(whole.clone(), text);
        let (root, wrong) = DeTable::parse_recoverable(document.text());
        if wrong.is_empty() {
            self.document(path, &document, root.into_inner(), Vec::new());
            return Ok(());
        }
        let Readable { text, errors, has_all_names } = syntax::readable(&document);
        self.knows_all_names &= has_all_names;
        let document = Document::new(whole, text);
        let (root, _) = DeTable::parse_recoverable(document.text());
        self.document(path, &document, root.into_inner(), errors);
        Ok(())
    }

    /// Reads a parsed file; `errors` are its syntax errors.
    fn document(&mut self, path: &Path, document: &Document, root: DeTable<'_>, errors: Vec<Error>) {
        self.open.push(path.to_owned());
        let replacements = self.variables.open(document, &root, self.knows_all_names);
        let mut root = root;
        scope::replace(&mut root, &replacements);
        self.tables(&Table::new(document, 0, SCENE.to_owned(), &root));
        self.variables.close();
        self.open.pop();
        self.done.insert(tidy(path));
        self.errors.extend(document.errors(errors));
    }

    fn tables(&mut self, top: &Table<'_>) {
        top.allow(&[TOP, &shape::kinds()]);
        self.knows_all_names &= !top.means(&["import", "materials", "media", "textures", "objects"]);
        if let Some(value) = top.find("import") {
            self.imports(value);
        }
        if let Some(value) = top.find("textures") {
            self.read_textures(value);
        }
        if let Some(value) = top.find("media") {
            self.read_media(value);
        }
        self.settings(top);
        if let Some(value) = top.find("materials") {
            self.read_materials(value);
        }
        if let Some(value) = top.find("objects") {
            self.read_objects(value);
        }
        let shapes = self.shapes(top);
        self.scene.shapes.extend(shapes);
        if let Some(value) = top.find("instance") {
            value.tables().for_each(|table| self.read_instance(&table));
        }
        if let Some(value) = top.find("light") {
            value.tables().for_each(|table| self.read_light(&table));
        }
    }

    /// The camera, image and render settings of this file; without them, those of the first import that has any apply.
    fn settings(&mut self, top: &Table<'_>) {
        if let Some(table) = top.maybe("camera", |value| value.table("[camera]")) {
            let camera = self.camera(&table).map_err(|error| table.note(error));
            let medium = table.maybe("medium", |value| self.medium_named(value));
            self.scene.camera = camera.ok().map(|camera| Camera { medium, ..camera });
        }
        if let Some(table) = top.maybe("image", |value| value.table("[image]")) {
            self.scene.image = settings::image(&table);
            let film = self.scene.image.spectral_film.clone().unwrap_or(SpectralFilm::NONE);
            if let Some(film) = table.maybe("bands", |value| self.with_bands(film, value)) {
                self.scene.image.spectral_film = Some(film);
            }
            self.has_image = true;
        }
        if let Some(table) = top.maybe("render", |value| value.table("[render]")) {
            self.scene.render = settings::render(&table);
            self.scene.vertex_normals = table.or("vertex_normals", VertexNormals::default(), |value| {
                value.choice(settings::VERTEX_NORMALS)
            });
            self.scene.is_complete = !table.or("add_light", true, Value::boolean);
            self.has_render = true;
            self.names_integrator = table.has("integrator");
        }
    }

    /// An image; each file is read once.
    fn image(&mut self, value: Value<'_>) -> Result<ImageId> {
        self.image_as(value, None, false)
    }

    /// An image of colours, or of data: then 8- and 16-bit values are linear. `layer` is a part or layer of an OpenEXR file.
    fn image_as(&mut self, value: Value<'_>, layer: Option<&str>, is_data: bool) -> Result<ImageId> {
        let encoding = if is_data { Encoding::Linear } else { Encoding::Srgb };
        if !value.is_table() {
            return self.image_by(value, layer, is_data, |path, context| {
                image::read_as(path, &Reading { layer, ..Reading::new(encoding) }, context)
            });
        }
        let table = value.table("a picture")?;
        table.allow(&[texture::PICTURE]);
        let layer = table.maybe("layer", |value| value.text("the name of a layer").map(str::to_owned));
        let file = table.find("file").filter(|file| !file.is_table());
        let file =
            file.ok_or_else(|| value.wrong("a picture, such as { file = \"sky.exr\", layer = \"beauty\" }"))?;
        self.image_as(file, layer.as_deref(), is_data)
    }

    /// An image whose 8- and 16-bit values are encoded by an exponent.
    fn image_by_gamma(&mut self, value: Value<'_>, layer: Option<&str>, gamma: f32) -> Result<ImageId> {
        let curve = |value: f32| libm::powf(value, gamma);
        let reading = Reading { layer, ..Reading::new(Encoding::Curve(&curve)) };
        let key = format!("{} gamma {gamma}", layer.unwrap_or_default());
        self.image_by(value, Some(&key), false, |path, context| image::read_as(path, &reading, context))
    }

    /// The image that a file becomes, which is read once.
    fn image_by(
        &mut self,
        value: Value<'_>,
        layer: Option<&str>,
        is_data: bool,
        read: impl FnOnce(&Path, &mut LoadContext<'_>) -> Result<image::Image>,
    ) -> Result<ImageId> {
        let path = self.resolve(value, "the name of a picture")?;
        let key = (path, layer.map(str::to_owned), is_data);
        if let Some(&id) = self.images.get(&key) {
            return Ok(id);
        }
        let image = read(&key.0, self.context).map_err(|error| value.blame(error))?;
        let id = ImageId(self.scene.images.len() as u32);
        self.scene.images.push(image);
        self.images.insert(key, id);
        Ok(id)
    }

    /// The content of a model file; each file is read once per set of import options.
    fn model(&mut self, value: Value<'_>, choice: &ImportOptions) -> Result<Model> {
        let path = self.resolve(value, "the name of a model file")?;
        if let Some((_, model)) = self.models.iter().find(|(key, _)| (&key.0, &key.1) == (&path, choice)) {
            return Ok(model.clone());
        }
        let before = std::mem::replace(&mut self.context.import, choice.clone());
        let told = self.context.warnings.len();
        let model = load::model(&path, self.context, &mut self.scene);
        self.context.import = before;
        if choice.animation.is_none() && choice.at == self.time {
            // The time is that of the scene, in which not everything moves.
            let of_model = self.context.warnings.split_off(told);
            self.context
                .warnings
                .extend(of_model.into_iter().filter(|warning| warning.message != ImportOptions::AT_REST));
        }
        let model = model.map_err(|error| value.blame(error))?;
        self.models.push(((path, choice.clone()), model.clone()));
        Ok(model)
    }

    /// The path of a file whose name is relative to the current file.
    fn resolve(&self, value: Value<'_>, expected: &str) -> Result<PathBuf> {
        let name = value.text(expected)?;
        if name.contains('\0') {
            return Err(value.wrong(expected));
        }
        let folder = self.open.last().and_then(|file| file.parent()).unwrap_or(Path::new(""));
        Ok(folder.join(name))
    }

    /// The item with this name, or the error that the name is unknown.
    fn named<Id: Copy>(
        &self,
        known: &BTreeMap<String, Id>,
        what: &str,
        value: Value<'_>,
        name: &str,
    ) -> Result<Id> {
        known.get(name).copied().ok_or_else(|| {
            if !self.knows_all_names {
                return Error::untold();
            }
            let error = value.error(format!("there is no {what} {name:?}"));
            // The implicit default material is not a name of the file's.
            let is_ours =
                |name: &str| what == "material" && self.unwritten_default.is_some() && name == DEFAULT;
            let names = || known.keys().map(String::as_str).filter(|name| !is_ours(name));
            let count = names().count();
            let example = match what {
                "object" => format!("[[objects.{name}.sphere]]"),
                "medium" => format!("[media.{name}]"),
                _ => format!("[{what}s.{name}]"),
            };
            match nearest(name, names().take(MOST_COMPARED)) {
                Some(meant) => error.hint(format!("did you mean {meant:?}?")),
                None if count == 0 => error.hint(format!("none is defined: write it as {example}")),
                None => {
                    let mut some: Vec<&str> = names().take(12).collect();
                    if count > some.len() {
                        some.push("…");
                    }
                    error.hint(format!("there are: {}", some.join(", ")))
                }
            }
        })
    }
}

/// The word for a value, of those that have one.
fn word_of<T: PartialEq>(words: &[(&'static str, T)], value: &T) -> &'static str {
    words.iter().find(|(_, of_word)| of_word == value).map_or("?", |(word, _)| word)
}

/// The error that a name is defined twice.
fn twice(entry: Value<'_>, what: &str, before: &Location) -> Error {
    entry
        .error(format!("{what} {:?} is already defined, at {before}", entry.key()))
        .hint("give one of them another name")
}
