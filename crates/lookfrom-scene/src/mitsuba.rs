//! Reader for scenes of Mitsuba 3 (Jakob et al. 2022) in XML. Errors have the location of the invalid value.
//!
//! `xml` makes a tree of `plugin`s of the files (`value` and `transform` their values); the other files each handle a class of plugins. A
//! plugin without a counterpart here is an error; one that is replaced by something similar, and a property without effect, a warning.
//! Colours are those of Mitsuba's variants with the colour mode `rgb`.

mod attribute;
mod bsdf;
mod curve;
mod emitter;
mod medium;
mod phase;
mod plugin;
mod sdf;
mod sensor;
mod serialized;
mod shape;
mod texture;
mod transform;
mod value;
mod version1;
mod volume;
mod xml;

use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use self::attribute::{Attribute, Slots};
use self::bsdf::Surface;
use self::plugin::{Ids, Plugin, Value};
use crate::chain;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;
use crate::material::{BackFace, Color, Material, MaterialKind};
use crate::scene::{ImageId, MaterialId, MediumId, MeshId, ObjectId, Scene, TextureId, VertexNormals};
use crate::validate;

/// Reads a scene of Mitsuba with all its includes. Files are looked up in the folder of the scene and those of its `path` elements. The
/// [variables](crate::Variables) are its parameters.
///
/// # Errors
/// With line and column: `Syntax` for malformed files, `Invalid` for invalid values, `Unsupported` for plugins without a counterpart,
/// `Limit` for excessive sizes and nesting, `Request` for values of parameters that it does not have, and the errors of the files that
/// are named.
pub fn read(path: &Path, context: &mut LoadContext<'_>) -> Result<Scene> {
    let bytes = context.read(path)?;
    from_bytes(&bytes, path, context)
}

/// As [`read`], of the content of the main file.
pub(crate) fn from_bytes(bytes: &[u8], path: &Path, context: &mut LoadContext<'_>) -> Result<Scene> {
    let mut reading = xml::Reading::new(path, context);
    let root = reading.scene(bytes, path)?;
    let variables = reading.variables();
    let (ids, folders) = (std::mem::take(&mut reading.ids), std::mem::take(&mut reading.folders));
    let mut scene = Scene { vertex_normals: VertexNormals::AsGiven, is_complete: true, ..Scene::default() };
    scene.contents.variables = variables;
    for (name, reflectance) in [("default", 0.5), ("black", 0.0)] {
        let kind = MaterialKind::Diffuse { reflectance: Color::gray(reflectance) };
        let material = Material::new(name, Location::file(path), kind);
        scene.materials.push(Material { back_face: BackFace::Black, ..material });
    }
    let mut reader = Reader {
        context,
        scene,
        ids,
        folders,
        open: Vec::new(),
        surfaces: HashMap::new(),
        is_two_sided: false,
        textures: HashMap::new(),
        exchanged: HashMap::new(),
        images: HashMap::new(),
        media: HashMap::new(),
        slots: Vec::new(),
        is_on_disk: false,
        meshes: HashMap::new(),
        own_normals: BTreeSet::new(),
        groups: HashMap::new(),
        warned: BTreeSet::new(),
    };
    reader.root(&root)?;
    root.warn_unused(reader.context);
    reader.scene.render.endless_media = !reader.scene.media.is_empty();
    Ok(reader.scene)
}

/// The state of reading a scene.
struct Reader<'s, 'f> {
    context: &'s mut LoadContext<'f>,
    scene: Scene,
    ids: Ids,
    /// Folders in which files are looked up.
    folders: Vec<PathBuf>,
    /// The plugins that are being read, each a part of the one before it.
    open: Vec<*const Plugin>,
    /// Surfaces by their plugin, and whether they are within a `twosided`.
    surfaces: HashMap<(*const Plugin, bool), Surface>,
    is_two_sided: bool,
    textures: HashMap<*const Plugin, TextureId>,
    /// Checkerboards with exchanged fields, by those that have them as they are written.
    exchanged: HashMap<TextureId, TextureId>,
    /// Images by path and whether their values are raw.
    images: HashMap<(PathBuf, bool), ImageId>,
    media: HashMap<*const Plugin, MediumId>,
    /// Slots of the attributes of the mesh whose surface is read.
    slots: Slots,
    /// Whether the shape whose surface is read is a disk, along whose radius Mitsuba's u runs.
    is_on_disk: bool,
    meshes: HashMap<shape::MeshKey, (shape::PlacedMeshes, Slots)>,
    /// Meshes with the normals of their files.
    own_normals: BTreeSet<MeshId>,
    groups: HashMap<*const Plugin, ObjectId>,
    /// Warnings that have been given already.
    warned: BTreeSet<String>,
}

/// Maximum depth of plugins that are parts of others.
const DEEPEST: usize = 64;

impl Reader<'_, '_> {
    /// The material of shapes without a BSDF.
    const DEFAULT: MaterialId = MaterialId(0);
    /// The material of emitting shapes without a BSDF.
    const BLACK: MaterialId = MaterialId(1);

    fn root(&mut self, root: &Plugin) -> Result<()> {
        let integrator = root.part("integrator", &self.ids)?;
        self.integrator(integrator.as_deref())?;
        for (_, emitter) in root.parts("emitter", &self.ids)? {
            self.emitter(&emitter)?;
        }
        let mut of_shapes = Vec::new();
        for (_, shape) in root.parts("shape", &self.ids)? {
            let first = self.scene.shapes.len();
            self.shape(&shape)?;
            let own = first..self.scene.shapes.len();
            let sensors = shape.parts("sensor", &self.ids)?;
            of_shapes.extend(sensors.into_iter().map(|(_, sensor)| (sensor, own.clone())));
        }
        for (_, sensor) in root.parts("sensor", &self.ids)? {
            self.first_sensor(&sensor, None)?;
        }
        for (sensor, shapes) in of_shapes {
            self.first_sensor(&sensor, Some(shapes))?;
        }
        validate::check_surface(&self.scene)?;
        // They are for references.
        for class in
            ["bsdf", "texture", "medium", "phase", "volume", "spectrum", "film", "sampler", "rfilter"]
        {
            root.parts(class, &self.ids)?;
        }
        let textures = chain::check(&self.scene.textures, 0..self.scene.textures.len());
        let materials = chain::check(&self.scene.materials, 0..self.scene.materials.len());
        textures.into_iter().chain(materials).next().map_or(Ok(()), Err)
    }

    /// Reads a part of a plugin.
    ///
    /// # Errors
    /// `Invalid` if it is a part of itself, `Limit` if it is too deep.
    fn within<T>(&mut self, plugin: &Rc<Plugin>, read: impl FnOnce(&mut Self) -> Result<T>) -> Result<T> {
        let address = Rc::as_ptr(plugin);
        if self.open.contains(&address) {
            return Err(Error::invalid(&plugin.at, format!("the {} is a part of itself", plugin.title())));
        }
        if self.open.len() >= DEEPEST {
            return Err(Error::new(ErrorKind::Limit, &plugin.at, format!("nested more than {DEEPEST} deep")));
        }
        self.open.push(address);
        let result = read(self);
        self.open.pop();
        result
    }

    /// Warns once.
    fn warn_once(&mut self, at: &Location, message: impl Into<String>) {
        let message = message.into();
        if self.warned.insert(message.clone()) {
            self.context.warn(at, message);
        }
    }

    /// A file that a plugin names.
    fn file(&self, plugin: &Plugin) -> Result<(PathBuf, Location)> {
        let Some(name) = plugin.string("filename")?.filter(|name| !name.is_empty()) else {
            let error = Error::invalid(&plugin.at, format!("the {} has no `filename`", plugin.title()));
            return Err(error.hint("write <string name=\"filename\" value=\"…\"/>"));
        };
        let at = plugin.find("filename").map_or(&plugin.at, |property| &property.at);
        Ok((xml::resolve(name, &self.folders, self.context), at.clone()))
    }

    /// A constant colour of light, with a factor for its brightness: spectra are told relative to their luminance here.
    fn light_color(&mut self, plugin: &Plugin, name: &str) -> Result<(Color, f32)> {
        let Some(property) = plugin.find(name) else { return Ok((Color::gray(1.0), 1.0)) };
        match &property.value {
            Value::Color(rgb) => Ok((Color::Value(*rgb), 1.0)),
            Value::Float(value) if *value >= 0.0 => Ok((Color::gray(*value as f32), 1.0)),
            Value::Curve(curve) => Ok(self.light_curve(curve.clone())),
            _ => match property.plugin(&self.ids)? {
                Some(spectrum) => self.light_spectrum(&spectrum),
                None => Err(property.wrong("a colour: <rgb> or <spectrum>")),
            },
        }
    }
}
