//! Reader for scenes of pbrt-v4 (Pharr, Jakob & Humphreys 2023), and of pbrt-v3. Errors have the location of the invalid value.
//!
//! `text` and `lexer` handle bytes and tokens, `params` the typed parameters, `directive` executes directives on the
//! `state`; the other files each handle a part of the vocabulary. Features of pbrt that this program does not render are
//! read, warned of once, and replaced by the nearest equivalent.

mod camera;
mod curve;
mod directive;
mod displacement;
mod file;
mod film;
mod hair;
mod integrator;
mod lexer;
mod light;
mod loop_subdivision;
mod material;
mod measured;
mod medium;
mod mesh;
mod missing;
mod params;
mod picture;
mod realistic;
mod shape;
mod spectra;
mod state;
mod subsurface;
mod text;
mod texture;
mod transform;
mod version3;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DMat4;

use self::displacement::Displaced;
use self::file::Model;
use self::missing::Missing;
use self::state::{Opened, Options, State};
use self::text::Place;
use self::version3::Version;
use crate::budget::Reserved;
use crate::chain;
use crate::error::{Error, Location, Result};
use crate::files::LoadContext;
use crate::material::{Color, Material, MaterialKind};
use crate::measured::Measured;
use crate::motion::Motion;
use crate::packed;
use crate::scene::{CurveId, ImageId, MaterialId, MediumId, ObjectId, Scene, TextureId, VertexNormals};
use crate::settings::ColorMode;

/// Reads a scene of pbrt-v4, or of pbrt-v3 by what is nearest, with all its includes. File names are relative to the folder of `path`, or else to the folder
/// of the file that contains them.
///
/// # Errors
/// With line and column: `Syntax` for malformed files, `Invalid` for invalid values (and for words of pbrt-v3 in scenes of pbrt-v4), `Limit`
/// for excessive sizes and nesting, and the errors of the files that are named. All missing files are reported at once, as
/// [`Error::more`].
pub fn read(path: &Path, context: &mut LoadContext<'_>) -> Result<Scene> {
    from_bytes(packed::read(path, context)?, path, context)
}

/// As [`read`], of the content of the main file.
pub(crate) fn from_bytes(
    bytes: Reserved<Vec<u8>>,
    path: &Path,
    context: &mut LoadContext<'_>,
) -> Result<Scene> {
    let mut scene = Scene { vertex_normals: VertexNormals::AsGiven, ..Scene::default() };
    scene.render.color = ColorMode::Spectral;
    let gray = MaterialKind::Diffuse { reflectance: Color::gray(0.5) };
    scene.materials.push(Material::new("default", Location::file(path), gray));
    let mut reader = Reader {
        context,
        scene,
        folder: path.parent().unwrap_or(Path::new("")).to_owned(),
        open: Vec::new(),
        included: 0,
        state: State::default(),
        stack: Vec::new(),
        coordinate_systems: BTreeMap::new(),
        transform_times: [0.0, 1.0],
        shutter: [0.0, 1.0],
        in_world: false,
        options: Options::default(),
        materials: BTreeMap::new(),
        textures: BTreeMap::new(),
        only_earlier: false,
        objects: BTreeMap::new(),
        object: None,
        instances: Vec::new(),
        moving: BTreeMap::new(),
        curves: BTreeMap::new(),
        images: BTreeMap::new(),
        models: BTreeMap::new(),
        displaced: Vec::new(),
        displacement_edge_scale: 1.0,
        warned: BTreeSet::new(),
        media: BTreeMap::new(),
        measured: BTreeMap::new(),
        without_media: None,
        missing: Missing::default(),
        film_diagonal: 35.0,
        version: Version::default(),
    };
    let result = reader.text(path, bytes).and_then(|()| reader.finish(path));
    if let Some(error) = reader.missing.and(result) {
        return Err(error);
    }
    let mut scene = reader.scene;
    scene.is_complete = true;
    Ok(scene)
}

/// The state of reading a scene.
struct Reader<'s, 'f> {
    context: &'s mut LoadContext<'f>,
    scene: Scene,
    /// The folder of the main file.
    folder: PathBuf,
    /// The open files: each is included by the previous one.
    open: Vec<PathBuf>,
    /// The number of included files.
    included: u32,
    /// The current graphics state.
    state: State,
    /// Open blocks.
    stack: Vec<Opened>,
    /// Named matrices at the start and the end of the transform times.
    coordinate_systems: BTreeMap<String, [DMat4; 2]>,
    /// The times of the two matrices.
    transform_times: [f64; 2],
    /// The times when the shutter opens and closes.
    shutter: [f32; 2],
    /// Whether `WorldBegin` has been read.
    in_world: bool,
    /// Settings before `WorldBegin`.
    options: Options,
    materials: BTreeMap<String, NamedMaterial>,
    /// By name and whether they are float textures.
    textures: BTreeMap<(bool, String), NamedTexture>,
    /// Whether textures may only be used after their definition (as inside other textures).
    only_earlier: bool,
    objects: BTreeMap<String, ObjectId>,
    /// The open object, to which shapes are added.
    object: Option<ObjectId>,
    /// Instances, whose objects are looked up at the end.
    instances: Vec<(String, Place, [DMat4; 2])>,
    /// Shapes that move in an object: each an object of its own, with its motion there.
    moving: BTreeMap<ObjectId, Vec<(ObjectId, Motion)>>,
    curves: BTreeMap<String, CurveId>,
    /// Images by path and conversion of their values.
    images: BTreeMap<(PathBuf, String), ImageId>,
    models: BTreeMap<PathBuf, Model>,
    /// Meshes to be displaced, whose models are read later.
    displaced: Vec<Displaced>,
    /// Factor of the edge lengths of displaced meshes, pbrt's `displacementedgescale`.
    displacement_edge_scale: f32,
    /// Warnings that have been given already.
    warned: BTreeSet<String>,
    /// Measured materials by path.
    measured: BTreeMap<PathBuf, Arc<Measured>>,
    /// Media by name.
    media: BTreeMap<String, NamedMedium>,
    /// An integrator that does not support media, until it has been warned of.
    without_media: Option<(String, Place)>,
    /// Missing files so far.
    missing: Missing,
    /// The diagonal of the film in millimetres.
    film_diagonal: f64,
    /// The version of pbrt that the scene is written for.
    version: Version,
}

/// A material that has been defined or referred to.
struct NamedMaterial {
    id: MaterialId,
    /// Location of the first mention.
    first: Place,
    is_made: bool,
}

/// A medium that has been defined or referred to.
struct NamedMedium {
    id: MediumId,
    /// Location of the first mention.
    first: Place,
    is_made: bool,
}

/// A texture that has been defined or referred to.
struct NamedTexture {
    /// The texture, or its value if it is constant.
    color: Color,
    /// Location of the first mention.
    first: Place,
    is_made: bool,
}

impl Reader<'_, '_> {
    /// The error for an unknown word, with the most similar known one.
    fn unknown<'a>(
        place: &Place,
        what: &str,
        word: &str,
        known: impl IntoIterator<Item = &'a str> + Clone,
    ) -> Error {
        let error = place.invalid(format!("{word:?} is not a known {what}"));
        match crate::suggest::nearest(word, known.clone()) {
            Some(meant) => error.hint(format!("did you mean {meant:?}?")),
            None => {
                let mut known: Vec<&str> = known.into_iter().take(20).collect();
                if known.is_empty() {
                    return error.hint("none is defined before this");
                }
                known.sort_unstable();
                error.hint(format!("there are: {}", known.join(", ")))
            }
        }
    }

    /// Steps that need the whole scene. Models are read even after errors, so that all missing files are found.
    fn finish(&mut self, path: &Path) -> Result<()> {
        let result = self.finish_without_models(path);
        self.read_models().and(result)?;
        self.scene.render.endless_media = !self.scene.media.is_empty();
        self.tessellate_displaced()
    }

    fn finish_without_models(&mut self, path: &Path) -> Result<()> {
        if let Some(opened) = self.stack.last() {
            let error = opened.place.syntax(format!("this {}Begin has no {}End", opened.word, opened.word));
            return Err(error.hint("the file may be cut off"));
        }
        if !self.in_world {
            let error = Error::syntax(&Location::file(path), "the scene ends before `WorldBegin`");
            return Err(error.hint("a scene is its camera and film, `WorldBegin`, and its shapes and lights"));
        }
        let made: Vec<&str> =
            self.materials.iter().filter(|(_, named)| named.is_made).map(|(name, _)| &**name).collect();
        if let Some((name, named)) = self.materials.iter().find(|(_, named)| !named.is_made) {
            return Err(Self::unknown(&named.first, "material", name, made));
        }
        if let Some((name, named)) = self.media.iter().find(|(_, named)| !named.is_made) {
            let made = self.media.iter().filter(|(_, named)| named.is_made).map(|(name, _)| &**name);
            return Err(Self::unknown(&named.first, "medium", name, made));
        }
        if let Some(((is_float, name), named)) = self.textures.iter().find(|(_, named)| !named.is_made) {
            let known = self.textures.iter().filter(|((float, _), named)| float == is_float && named.is_made);
            let what = if *is_float { "float texture" } else { "spectrum texture" };
            let error = Self::unknown(&named.first, what, name, known.map(|((_, name), _)| &**name));
            let other = self.textures.get(&(!is_float, name.clone())).is_some_and(|named| named.is_made);
            return Err(if other {
                error.hint(match is_float {
                    true => "there is a spectrum texture of that name, but numbers are needed here",
                    false => "there is a float texture of that name, but colours are needed here",
                })
            } else {
                error
            });
        }
        let textures = chain::check(&self.scene.textures, 0..self.scene.textures.len());
        let materials = chain::check(&self.scene.materials, 0..self.scene.materials.len());
        if let Some(error) = textures.into_iter().chain(materials).next() {
            return Err(error);
        }
        self.place_instances()?;
        curve::join(&mut self.scene.shapes);
        self.scene.objects.iter_mut().for_each(|object| curve::join(&mut object.shapes));
        Ok(())
    }
}

impl NamedTexture {
    fn id(&self) -> Option<TextureId> {
        match self.color {
            Color::Texture(id) => Some(id),
            Color::Value(_) | Color::Curve(_) => None,
        }
    }
}
