//! Files named by a scene: includes are read at once, models in parallel when all are known.

use std::path::{Path, PathBuf};

use super::Reader;
use super::directive::DIRECTIVES;
use super::lexer::{Lexer, Token};
use super::text::{Place, Text};
use crate::budget::Reserved;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;
use crate::model::PARSED;
use crate::packed;
use crate::parallel;
use crate::ply;
use crate::scene::{MeshId, Scene};
use crate::shape::{Geometry, Mesh};

/// The maximum number of includes: small files each of which includes the next one twice would take exponential time. A Menger sponge of
/// four levels, each including the next one twenty times, has 168,421, one of five levels 3,368,421.
const MOST_INCLUDED: u32 = 1 << 22;

/// A model file that shapes refer to.
pub(super) struct Model {
    /// The location of the first mention.
    place: Place,
    /// The placeholder that the file's mesh will replace.
    pub(super) mesh: MeshId,
}

impl Reader<'_, '_> {
    /// Reads the text of a scene file, the first or an included one.
    pub(super) fn text(&mut self, path: &Path, bytes: Reserved<Vec<u8>>) -> Result<()> {
        let whole = Location::file(path);
        if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
            return Err(Error::syntax(&whole, "the text is UTF-16").hint("save it as UTF-8"));
        }
        let head = &bytes[..bytes.len().min(1 << 12)];
        if head.contains(&0) {
            return Err(Error::syntax(&whole, "this is not text").hint("a scene of pbrt is a text file"));
        }
        self.open.push(path.to_owned());
        let text = Text::new(path, bytes);
        let mut lexer = Lexer::new(&text);
        loop {
            let start = lexer.here();
            match lexer.token()? {
                None => break,
                Some(Token::Word(word)) => self.directive(word, &lexer.place(start), &mut lexer)?,
                Some(_) => return Err(lexer.wrong(start, "a directive")),
            }
        }
        self.open.pop();
        Ok(())
    }

    pub(super) fn include(&mut self, name: &str, place: &Place) -> Result<()> {
        let mut path = self.resolve(name);
        if let Some(local) = self.resolve_locally(name)
            && local != path
            && matches!(packed::read(&path, self.context), Err(error) if error.kind == ErrorKind::Io)
        {
            path = local;
        }
        if self.open.contains(&path) {
            let chain: Vec<String> =
                self.open.iter().chain([&path]).map(|file| file.display().to_string()).collect();
            let error = place.invalid(format!("this file includes itself: {}", chain.join(" → ")));
            return Err(error.hint("take one of these Includes out"));
        }
        let limit = self.context.limits.import_depth;
        if self.open.len() as u64 > u64::from(limit) {
            let error =
                place.error(ErrorKind::Limit, format!("includes nest deeper than the limit of {limit}"));
            return Err(error.hint("include the files from fewer levels"));
        }
        self.included += 1;
        if self.included > MOST_INCLUDED {
            let message = format!("more files are included than the limit of {MOST_INCLUDED}");
            return Err(place
                .error(ErrorKind::Limit, message)
                .hint("each file counts as often as it is included: objects (`ObjectBegin`) and their instances take less"));
        }
        if packed::unpacked_name(&path).extension().is_none_or(|extension| extension != "pbrt")
            && !self.is_scene(&path)
        {
            let error = place.invalid(format!(
                "{} is not a part of a scene: it does not begin with a directive",
                path.display()
            ));
            return Err(error.hint("included files are scenes of pbrt"));
        }
        match packed::read(&path, self.context).and_then(|bytes| self.text(&path, bytes)) {
            // Only this file: missing files that it names have been noted already.
            Err(error) if error.kind == ErrorKind::Io => self.missing.add_text(&path, place.blame(error)),
            result => result.map_err(|error| place.blame(error)),
        }
    }

    /// Whether a file begins as a scene does, if it can be read: errors quote the scene's files, and no others.
    fn is_scene(&self, path: &Path) -> bool {
        let Ok(bytes) = packed::read(path, self.context) else { return true };
        let text = Text::new(path, bytes);
        let mut lexer = Lexer::new(&text);
        match lexer.token() {
            Ok(None) => true,
            Ok(Some(Token::Word(word))) => DIRECTIVES.iter().any(|known| known.as_bytes() == word),
            _ => false,
        }
    }

    /// The path of a file named in the scene, relative to the folder of the scene's main file.
    pub(super) fn resolve(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// A path relative to the folder of the current file.
    fn resolve_locally(&self, name: &str) -> Option<PathBuf> {
        Some(self.open.last()?.parent()?.join(name))
    }

    /// The mesh of a model file, which is read later.
    pub(super) fn model(&mut self, path: PathBuf, place: &Place) -> MeshId {
        let next = MeshId(self.scene.meshes.len() as u32);
        let model = self.models.entry(path).or_insert_with(|| Model { place: place.clone(), mesh: next });
        if model.mesh == next {
            self.scene.meshes.push(Mesh::default());
        }
        model.mesh
    }

    /// Reads all model files in parallel; meshes, warnings and errors come in the order of the files' names.
    pub(super) fn read_models(&mut self) -> Result<()> {
        let models: Vec<(PathBuf, Model)> = std::mem::take(&mut self.models).into_iter().collect();
        let (files, limits, budget) = (self.context.files, self.context.limits, &self.context.budget);
        let paths: Vec<&PathBuf> = models.iter().map(|(path, _)| path).collect();
        let read = |path: &PathBuf| {
            let mut context = LoadContext { limits, ..LoadContext::within(budget, files) };
            let mesh = mesh(path, &mut context);
            (mesh, context.warnings, context.kept)
        };
        let contents: Vec<_> = parallel::map(paths, read);
        for ((path, model), (mesh, warnings, kept)) in models.iter().zip(contents) {
            self.context.warnings.extend(warnings);
            self.context.kept.extend(kept);
            match mesh {
                Ok(mesh) => self.scene.meshes[model.mesh.index()] = mesh,
                Err(error) => self.missing.add(path, model.place.blame(error))?,
            }
        }
        Ok(())
    }
}

/// The mesh in a PLY file, compressed or not.
fn mesh(path: &Path, context: &mut LoadContext<'_>) -> Result<Mesh> {
    let bytes = packed::read(path, context)?;
    let at = Location::file(path);
    let parsing = bytes.len() as u64 * PARSED;
    let _parsing = context.budget.reserve(parsing, "the parsed model", &at)?;
    let mut alone = Scene::default();
    let parts = ply::geometry_from_bytes(&bytes, path, context, &mut alone)?;
    if parts.iter().any(|part| !matches!(part.geometry, Geometry::Mesh(_))) {
        context.warn(&at, "there are points but no faces: nothing is rendered");
    }
    let mut mesh = alone.meshes.into_iter().next().unwrap_or_default();
    // As pbrt has them: in single precision where they are.
    if let Some(part) = parts.first() {
        let origin = part.world_from_object.w_axis.truncate();
        mesh.positions.iter_mut().for_each(|point| *point = (point.as_dvec3() + origin).as_vec3());
    }
    // Vertex colours are used only by a material of the PLY file's own.
    mesh.colors = Vec::new();
    context.keep(mesh.bytes(), "the mesh", &at)?;
    Ok(mesh)
}
