//! Our own scene format: what `docs/guide/scene-format.md` describes becomes a [`Scene`], or an error that points at
//! the line that is wrong.
//!
//! This file reads files and joins what they import. Beside it: `value` (a TOML value and its place), and a decoder
//! for each part of the vocabulary.

mod color;
mod form;
mod light;
mod material;
mod place;
mod shape;

mod value;
mod view;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

use ::toml::de::DeTable;

use self::value::{Document, Table, Value};
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::Sources;
use crate::scene::{ImageId, MaterialId, ObjectId, Scene, TextureId};
use crate::shape::{Emission, Part};
use crate::suggest::nearest;
use crate::{image, load};

pub(crate) use self::material::default_material;

/// The keys of a file besides the kinds of shapes.
const TOP: &[&str] =
    &["import", "camera", "image", "render", "materials", "textures", "objects", "instance", "light"];

/// Reads a scene in our own format, with all that it imports.
///
/// # Errors
/// With the line and column of the first thing that is wrong: `Syntax` where the text is no TOML, `Invalid` where a
/// key, a type, a number or a name is not what it can be, `Limit` where something is too large or nests too deep, and
/// whatever goes wrong in the files that it names.
pub fn read(path: &Path, sources: &mut Sources<'_>) -> Result<Scene> {
    let mut reader = Reader {
        sources,
        scene: Scene::default(),
        scene_file: Location::file(path),
        materials: BTreeMap::new(),
        textures: BTreeMap::new(),
        objects: BTreeMap::new(),
        images: BTreeMap::new(),
        models: BTreeMap::new(),
        glows: BTreeMap::new(),
        unwritten_default: None,
        black: None,
        open: Vec::new(),
        done: BTreeSet::new(),
        flake_spheres: 0,
        has_image: false,
        has_render: false,
    };
    reader.file(path)?;
    Ok(reader.scene)
}

/// Every table of the format and the keys that it may have: for documentation, editors and tests.
pub fn vocabulary() -> Vec<(String, Vec<&'static str>)> {
    let kinds: Vec<&'static str> = shape::KEYS.iter().map(|&(kind, _)| kind).collect();
    let mut tables = vec![
        ("a scene".to_owned(), [TOP, &kinds].concat()),
        ("[camera]".to_owned(), view::CAMERA.to_vec()),
        ("[image]".to_owned(), view::IMAGE.to_vec()),
        ("filter".to_owned(), view::FILTER.to_vec()),
        ("[render]".to_owned(), view::RENDER.to_vec()),
        ("[materials.NAME]".to_owned(), material::KEYS.to_vec()),
        ("[objects.NAME]".to_owned(), kinds),
        ("[[instance]]".to_owned(), [shape::INSTANCE, place::KEYS].concat()),
        ("transform".to_owned(), place::STEPS.to_vec()),
        ("rotate".to_owned(), place::ROTATION.to_vec()),
    ];
    for &(kind, keys) in shape::KEYS {
        tables.push((format!("[[{kind}]]"), [keys, shape::COMMON, place::KEYS].concat()));
    }
    for &(kind, keys) in color::KEYS {
        tables.push((format!("[textures.NAME] {kind}"), [&["type"], keys, color::MAPPING].concat()));
    }
    for &(kind, keys) in light::KEYS {
        tables.push((format!("[[light]] {kind}"), [light::COMMON, keys].concat()));
    }
    tables
}

/// A scene on its way from files, and the names that were given so far.
struct Reader<'s, 'f> {
    sources: &'s mut Sources<'f>,
    scene: Scene,
    /// The file that was asked for.
    scene_file: Location,
    materials: BTreeMap<String, MaterialId>,
    textures: BTreeMap<String, TextureId>,
    objects: BTreeMap<String, ObjectId>,
    images: BTreeMap<PathBuf, ImageId>,
    models: BTreeMap<PathBuf, Vec<Part>>,
    /// The light of the materials that shine.
    glows: BTreeMap<MaterialId, Emission>,
    /// The material "default", where it was needed but no file has written it (yet).
    unwritten_default: Option<MaterialId>,
    black: Option<MaterialId>,
    /// The files that are being read: each is imported by the one before.
    open: Vec<PathBuf>,
    /// The files that have been read.
    done: BTreeSet<PathBuf>,
    /// Spheres of all sphereflakes so far.
    flake_spheres: u64,
    has_image: bool,
    has_render: bool,
}

impl Reader<'_, '_> {
    fn file(&mut self, path: &Path) -> Result<()> {
        let whole = Location::file(path);
        let bytes = self.sources.read(path)?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let valid = error.utf8_error().valid_up_to();
            let line = error.as_bytes()[..valid].iter().filter(|&&byte| byte == b'\n').count() + 1;
            Error::syntax(&whole.at(u32::try_from(line).unwrap_or(0), 0), "the text is not UTF-8")
                .hint("save it as UTF-8; a model or picture has to be named by its own extension")
        })?;
        let document = Document::new(whole, text);
        let root = DeTable::parse(document.text()).map_err(|error| {
            let at = document.location(error.span().map_or(0, |span| span.start));
            Error::syntax(&at, error.message().replace('\n', "; "))
                .hint("the text is no TOML here; docs/guide/scene-format.md shows how scenes are written")
        })?;
        let top = Table::root(&document, root.get_ref());
        let kinds: Vec<&'static str> = shape::KEYS.iter().map(|&(kind, _)| kind).collect();
        top.allow(&[TOP, &kinds])?;

        self.open.push(path.to_owned());
        if let Some(value) = top.find("import") {
            self.imports(value)?;
        }
        self.settings(&top)?;
        if let Some(value) = top.find("textures") {
            self.read_textures(value)?;
        }
        if let Some(value) = top.find("materials") {
            self.read_materials(value)?;
        }
        if let Some(value) = top.find("objects") {
            self.read_objects(value)?;
        }
        let shapes = self.shapes(&top)?;
        self.scene.shapes.extend(shapes);
        if let Some(value) = top.find("instance") {
            value.tables()?.try_for_each(|table| self.read_instance(&table?))?;
        }
        if let Some(value) = top.find("light") {
            value.tables()?.try_for_each(|table| self.read_light(&table?))?;
        }
        self.open.pop();
        self.done.insert(tidy(path));
        Ok(())
    }

    /// The camera, picture and computation of this file, or else of the first import that has one.
    fn settings(&mut self, top: &Table<'_>) -> Result<()> {
        if let Some(value) = top.find("camera") {
            self.scene.camera = Some(view::camera(&value.table("[camera]")?)?);
        }
        if let Some(value) = top.find("image") {
            self.scene.image = view::image(&value.table("[image]")?)?;
            self.has_image = true;
        }
        if let Some(value) = top.find("render") {
            self.scene.render = view::render(&value.table("[render]")?)?;
            self.has_render = true;
        }
        Ok(())
    }

    /// One file or a list of them.
    fn imports(&mut self, value: Value<'_>) -> Result<()> {
        if !value.is_list() {
            return self.import(value);
        }
        value.list("the name of a file, or a list of names")?.try_for_each(|item| self.import(item))
    }

    fn import(&mut self, value: Value<'_>) -> Result<()> {
        let path = self.resolve(value, "the name of a file, or a list of names")?;
        let chain = |files: &[PathBuf]| {
            files.iter().chain([&path]).map(|file| file.display().to_string()).collect::<Vec<_>>().join(" → ")
        };
        if let Some(start) = self.open.iter().position(|file| tidy(file) == tidy(&path)) {
            return Err(value
                .error(format!("this file imports itself: {}", chain(&self.open[start..])))
                .hint("take one of these imports out"));
        }
        if self.open.len() as u64 > u64::from(self.sources.limits.import_depth) {
            let message = format!(
                "imports nest deeper than the limit of {}: {}",
                self.sources.limits.import_depth,
                chain(&self.open)
            );
            return Err(Error { kind: ErrorKind::Limit, ..value.error(message) }
                .hint("import the files from fewer levels, or raise `Limits::import_depth`"));
        }
        // A file that several others import joins the scene once.
        if self.done.contains(&tidy(&path)) {
            return Ok(());
        }
        if load::is_toml(&path) {
            return self.import_scene(&path).map_err(|error| value.blame(error));
        }
        let first = self.scene.materials.len();
        let shapes = self.model(value)?;
        for (index, material) in self.scene.materials.iter().enumerate().skip(first) {
            self.materials.entry(material.name.clone()).or_insert(MaterialId(index as u32));
        }
        let material = self.default_material();
        self.scene.shapes.extend(load::shapes(shapes, &value.at(), material));
        self.done.insert(tidy(&path));
        Ok(())
    }

    /// An imported scene's camera and settings count where none was there before.
    fn import_scene(&mut self, path: &Path) -> Result<()> {
        let camera = self.scene.camera.take();
        let image = self.has_image.then(|| self.scene.image.clone());
        let render = self.has_render.then(|| self.scene.render.clone());
        self.file(path)?;
        self.scene.camera = camera.or(self.scene.camera.take());
        self.scene.image = image.unwrap_or_else(|| self.scene.image.clone());
        self.scene.render = render.unwrap_or_else(|| self.scene.render.clone());
        Ok(())
    }

    /// A picture; each file is read once.
    fn image(&mut self, value: Value<'_>) -> Result<ImageId> {
        let path = self.resolve(value, "the name of a picture")?;
        if let Some(&id) = self.images.get(&path) {
            return Ok(id);
        }
        let image = image::read(&path, self.sources).map_err(|error| value.blame(error))?;
        let id = ImageId(self.scene.images.len() as u32);
        self.scene.images.push(image);
        self.images.insert(path, id);
        Ok(id)
    }

    /// What stands in a model file; each file is read once.
    fn model(&mut self, value: Value<'_>) -> Result<Vec<Part>> {
        let path = self.resolve(value, "the name of a model file")?;
        if let Some(parts) = self.models.get(&path) {
            return Ok(parts.clone());
        }
        let parts = load::parts(&path, self.sources, &mut self.scene).map_err(|error| value.blame(error))?;
        self.models.insert(path, parts.clone());
        Ok(parts)
    }

    /// The path of a file that is named relative to the one being read.
    fn resolve(&self, value: Value<'_>, expected: &str) -> Result<PathBuf> {
        let name = value.text(expected)?;
        if name.contains('\0') {
            return Err(value.wrong(expected));
        }
        let folder = self.open.last().and_then(|file| file.parent()).unwrap_or(Path::new(""));
        Ok(folder.join(name))
    }
}

/// A path without `.` and without `x/..`, so that the same file has one name (where no links are followed).
fn tidy(path: &Path) -> PathBuf {
    let mut tidied = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir if matches!(tidied.components().next_back(), Some(Component::Normal(_))) => {
                tidied.pop();
            }
            other => tidied.push(other),
        }
    }
    tidied
}

/// What a name stands for, or the error that it stands for nothing.
fn named<Id: Copy>(known: &BTreeMap<String, Id>, what: &str, value: Value<'_>, name: &str) -> Result<Id> {
    known.get(name).copied().ok_or_else(|| {
        let error = value.error(format!("there is no {what} {name:?}"));
        let names = || known.keys().map(String::as_str);
        let example = match what {
            "object" => format!("[[objects.{name}.sphere]]"),
            _ => format!("[{what}s.{name}]"),
        };
        match nearest(name, names()) {
            Some(meant) => error.hint(format!("did you mean {meant:?}?")),
            None if known.is_empty() => error.hint(format!("there is none at all: write it as {example}")),
            None => {
                let mut some: Vec<&str> = names().take(12).collect();
                if known.len() > some.len() {
                    some.push("…");
                }
                error.hint(format!("there are: {}", some.join(", ")))
            }
        }
    })
}

/// The error that a name is given to two things.
fn twice(entry: Value<'_>, what: &str, before: &Location) -> Error {
    entry
        .error(format!("{what} {:?} is already there, at {before}", entry.key()))
        .hint("give one of them another name")
}
