//! Writer for our own scene format: a scene as a readable document, with files beside it for what is long.
//!
//! A document gives the same picture, bit by bit: every number is read back to its bits, and shapes and lights stay in their order. What a
//! person would not write is left out: defaults, and what nothing uses. `reach` finds what is used, `names` gives each a name of its own,
//! `text` writes, and a file for each part of the vocabulary says how. Each of them names every field, so that a new one
//! cannot be forgotten.

mod camera;
mod check;
mod color;
mod layered;
mod light;
mod material;
mod medium;
mod mesh;
mod names;
mod picture;
mod placing;
mod reach;
mod roughness;
mod settings;
mod shape;
mod solid;
mod text;
mod texture;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use self::names::{FileNames, Names, spoken};
use self::picture::{For, Picture};
use self::placing::{put_motion, put_transform};
use self::reach::Reached;
use self::settings::is_dark;
use self::text::{Fields, Text};
use super::shape::{ANY, KEYS};
use crate::budget::Budget;
use crate::digest::digest;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::{Files, Limits, LoadContext};
use crate::scene::{ImageId, Instance, MeshId, Scene};
use crate::shape::{Geometry, Shape};
use crate::texture::Texture;

/// A document and the files beside it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Written {
    /// The text of the document.
    pub text: String,
    /// The other files: their names relative to the document's folder, with `/` between their parts, and their contents.
    pub files: Vec<(String, Vec<u8>)>,
}

/// The files that a scene was read from: pictures and tables in them are copied.
pub struct Sources<'a> {
    /// Access to them.
    pub files: &'a dyn Files,
    /// Their paths.
    pub paths: Vec<PathBuf>,
    /// The memory for what is read again.
    pub budget: Budget,
}

impl Sources<'_> {
    fn context(&self) -> LoadContext<'_> {
        LoadContext::within(&self.budget, self.files)
    }

    fn read(&self, path: &Path) -> Option<Vec<u8>> {
        self.files.read(path, Limits::default().file_bytes).ok()
    }

    /// The path and content of the file with this name: a path, or the end of one.
    fn file_of(&self, name: &str) -> Option<(String, Vec<u8>)> {
        let last = Path::new(name).file_name()?;
        let is_whole = |path: &&PathBuf| path.as_os_str() == name;
        let path = self.paths.iter().find(is_whole);
        let path = path.or_else(|| self.paths.iter().find(|path| path.file_name() == Some(last)))?;
        Some((path.display().to_string(), self.read(path)?))
    }

    /// The path and content of the file with this digest.
    fn file_with(&self, sha256: &str) -> Option<(String, Vec<u8>)> {
        self.paths.iter().find_map(|path| {
            let bytes = self.read(path)?;
            (digest(&bytes) == sha256).then(|| (path.display().to_string(), bytes))
        })
    }
}

/// Writes a scene as a document in our own format. `folder` is the name of the folder beside it for its other files.
///
/// # Errors
/// `Invalid` for a scene that is not valid ([`Scene::validate`]); `Unsupported` for what the format has no words for: grids of more than 2²⁸
/// cells, curves of several profiles in one shape, a measured material whose file is gone, a medium with both a temperature and an emission.
pub fn write(scene: &Scene, folder: &str, sources: &Sources<'_>) -> Result<Written> {
    scene.validate()?;
    let mut writer = Writer::new(scene, folder, sources);
    let text = writer.document()?;
    Ok(Written { text, files: writer.files })
}

/// Writes `[camera]`, `[image]` and `[render]` of a view alone, of which everything else is in another document: what an empty scene has of
/// it. A camera's medium has no name here, and must be none; the table of a lens is a file beside the text, as in [`write()`].
///
/// # Errors
/// As [`write()`].
pub fn write_view(view: &Scene, folder: &str, sources: &Sources<'_>) -> Result<Written> {
    let mut writer = Writer::new(view, folder, sources);
    let mut text = Text::default();
    let render = writer.render();
    writer.view(&mut text, &render)?;
    Ok(Written { text: text.0, files: writer.files })
}

/// The state of a document that is written.
struct Writer<'a> {
    scene: &'a Scene,
    folder: &'a str,
    sources: &'a Sources<'a>,
    materials: Names,
    textures: Names,
    media: Names,
    objects: Names,
    /// By mesh, whether several shapes have it.
    shared: Vec<bool>,
    file_names: FileNames,
    files: Vec<(String, Vec<u8>)>,
    pictures: BTreeMap<(ImageId, For), Picture>,
    /// Files of pictures, by the paths of those that they are copies of.
    copies: BTreeMap<String, String>,
    meshes: BTreeMap<MeshId, String>,
    spectra: BTreeMap<String, String>,
    /// By digest.
    measured: BTreeMap<String, String>,
}

impl<'a> Writer<'a> {
    fn new(scene: &'a Scene, folder: &'a str, sources: &'a Sources<'a>) -> Self {
        let reached = Reached::of(scene);
        let textures: Vec<String> = scene.textures.iter().map(name_of).collect();
        Self {
            scene,
            folder,
            sources,
            materials: Names::new(
                "material",
                scene.materials.iter().map(|part| &*part.name),
                &reached.materials,
            ),
            textures: Names::new("texture", textures.iter().map(|name| &**name), &reached.textures),
            media: Names::new("medium", scene.media.iter().map(|part| &*part.name), &reached.media),
            objects: Names::new("object", scene.objects.iter().map(|part| &*part.name), &reached.objects),
            shared: shared_meshes(scene),
            file_names: FileNames::default(),
            files: Vec::new(),
            pictures: BTreeMap::new(),
            copies: BTreeMap::new(),
            meshes: BTreeMap::new(),
            spectra: BTreeMap::new(),
            measured: BTreeMap::new(),
        }
    }

    fn document(&mut self) -> Result<String> {
        let scene: &'a Scene = self.scene;
        let mut text = Text::default();
        let mut render = self.render();
        render.put_unless("add_light", !is_dark(scene), true);
        self.view(&mut text, &render)?;
        for index in self.media.in_order() {
            let fields = self.medium(&scene.media[index])?;
            text.table(&["media", self.media.of(index)], &fields);
        }
        for index in self.textures.in_order() {
            let fields = self.texture(&scene.textures[index].kind)?;
            text.table(&["textures", self.textures.of(index)], &fields);
        }
        for index in self.materials.in_order() {
            let fields = self.material(&scene.materials[index])?;
            text.table(&["materials", self.materials.of(index)], &fields);
        }
        for index in self.objects.in_order() {
            let shapes = self.shapes(&scene.objects[index].shapes)?;
            for (kind, fields) in &shapes {
                text.array(&["objects", self.objects.of(index), kind], fields);
            }
        }
        for (kind, fields) in self.shapes(&scene.shapes)? {
            text.array(&[kind], &fields);
        }
        for instance in &scene.instances {
            if !scene.objects[instance.object.index()].shapes.is_empty() {
                text.array(&["instance"], &self.instance(instance));
            }
        }
        for light in &scene.lights {
            text.array(&["light"], &self.light(light)?);
        }
        Ok(text.0)
    }

    /// The tables of a view.
    fn view(&mut self, text: &mut Text, render: &Fields) -> Result<()> {
        if let Some(camera) = &self.scene.camera {
            text.table(&["camera"], &self.camera(camera)?);
        }
        text.table(&["image"], &self.image());
        text.table(&["render"], render);
        Ok(())
    }

    /// The tables of shapes: each in the array of its kind, if their order is that in which these are read, else in one array of all.
    fn shapes(&mut self, shapes: &[Shape]) -> Result<Vec<(&'static str, Fields)>> {
        let mut tables =
            shapes.chunk_by(solid::is_continued).map(|run| self.shape(run)).collect::<Result<Vec<_>>>()?;
        let place = |kind: &str| KEYS.iter().position(|(known, _)| *known == kind);
        if !tables.is_sorted_by_key(|(kind, _)| place(kind)) {
            for (kind, fields) in &mut tables {
                fields.0.insert(0, ("type".to_owned(), (*kind).into()));
                *kind = ANY;
            }
        }
        Ok(tables)
    }

    fn instance(&self, instance: &Instance) -> Fields {
        let Instance { name, at: _, object, world_from_object, material, motion } = instance;
        let mut fields = Fields::one("object", self.objects.of(object.index()));
        if let Some(name) = name {
            fields.put("name", spoken("instance", name));
        }
        if let Some(material) = material {
            fields.put("material", self.materials.of(material.index()));
        }
        put_transform(&mut fields, world_from_object);
        put_motion(&mut fields, motion.as_deref());
        fields
    }

    /// Adds a file, and returns its name in the document.
    fn file(&mut self, name: &str, ending: &str, bytes: Vec<u8>) -> String {
        let name = format!("{}/{}", self.folder, self.file_names.new_name(name, ending));
        self.files.push((name.clone(), bytes));
        name
    }
}

/// The name of a texture: its own, but for names that are places in files, which are others now.
fn name_of(texture: &Texture) -> String {
    let Texture { name, at, kind: _ } = texture;
    match name.split('/').collect::<Vec<_>>()[..] {
        // A JSON pointer to a texture of a material of glTF.
        ["", "materials", material, .., last] if **name == *at.pointer => {
            format!("material {material} {}", last.strip_suffix("Texture").unwrap_or(last))
        }
        // A texture within a table is named by its key and its place.
        _ => name.replace(&format!(" at {at}"), ""),
    }
}

/// By mesh, whether several shapes have it.
fn shared_meshes(scene: &Scene) -> Vec<bool> {
    let mut counts = vec![0_u32; scene.meshes.len()];
    let in_objects = scene.objects.iter().flat_map(|object| &object.shapes);
    for shape in scene.shapes.iter().chain(in_objects) {
        if let Geometry::Mesh(mesh) = shape.geometry {
            counts[mesh.index()] += 1;
        }
    }
    counts.into_iter().map(|count| count > 1).collect()
}

/// The error that a part of a scene cannot be written.
fn cannot(what: impl Into<String>) -> Error {
    let message = format!("there are no words in this format for {}", what.into());
    Error::new(ErrorKind::Unsupported, &Location::default(), message)
}
