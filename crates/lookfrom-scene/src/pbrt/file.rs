//! How do the files that a scene names get read: included ones at once, models side by side when all are known?

use std::io::Read;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::Reader;
use super::lexer::{Lexer, Token};
use super::text::{Place, Text};
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::{Limits, Sources};
use crate::ply;
use crate::scene::{MeshId, Scene};
use crate::shape::{Geometry, Mesh};

/// How many files may be included: small files that include one another twice would have no end.
const MOST_INCLUDED: u32 = 1 << 17;

/// Packed files of meshes are a tenth as long as unpacked; this much is suspicious.
const MOST_UNPACKED: u64 = 250;

/// A model file that shapes wait for.
pub(super) struct Model {
    /// Where it was named first.
    place: Place,
    /// Stands in for what the file will hold.
    pub(super) mesh: MeshId,
}

impl Reader<'_, '_> {
    /// Reads a scene file, the first or an included one.
    pub(super) fn file(&mut self, path: &Path) -> Result<()> {
        let bytes = bytes(path, self.sources)?;
        let whole = Location::file(path);
        if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
            return Err(Error::syntax(&whole, "the text is UTF-16").hint("save it as UTF-8"));
        }
        let head = &bytes[..bytes.len().min(1 << 12)];
        if head.contains(&0) {
            return Err(Error::syntax(&whole, "this is not a text").hint("a scene of pbrt is a text file"));
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
            && matches!(self.sources.files.read(&path, self.sources.limits.file_bytes), Err(error) if error.kind == ErrorKind::Io)
        {
            path = local;
        }
        if self.open.contains(&path) {
            let chain: Vec<String> =
                self.open.iter().chain([&path]).map(|file| file.display().to_string()).collect();
            let error = place.invalid(format!("this file includes itself: {}", chain.join(" → ")));
            return Err(error.hint("take one of these Includes out"));
        }
        let limit = self.sources.limits.import_depth;
        if self.open.len() as u64 > u64::from(limit) {
            let error =
                place.error(ErrorKind::Limit, format!("includes nest deeper than the limit of {limit}"));
            return Err(error.hint("include the files from fewer levels, or raise `Limits::import_depth`"));
        }
        self.included += 1;
        if self.included > MOST_INCLUDED {
            let message = format!("more files are included than the limit of {MOST_INCLUDED}");
            return Err(place
                .error(ErrorKind::Limit, message)
                .hint("files may include one another in circles"));
        }
        self.file(&path).map_err(|error| place.blame(error))
    }

    /// The path of a file that is named in the scene: relative to the folder of the scene's first file.
    pub(super) fn resolve(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// The same, relative to the folder of the file that is being read.
    fn resolve_locally(&self, name: &str) -> Option<PathBuf> {
        Some(self.open.last()?.parent()?.join(name))
    }

    /// The mesh that a model file will hold.
    pub(super) fn model(&mut self, path: PathBuf, place: &Place) -> MeshId {
        let next = MeshId(self.scene.meshes.len() as u32);
        let model = self.models.entry(path).or_insert_with(|| Model { place: place.clone(), mesh: next });
        if model.mesh == next {
            self.scene.meshes.push(Mesh::default());
        }
        model.mesh
    }

    /// Reads all model files, several at once; meshes and warnings come in the order of the files' names.
    pub(super) fn read_models(&mut self) -> Result<()> {
        let models: Vec<(PathBuf, Model)> = std::mem::take(&mut self.models).into_iter().collect();
        let (files, limits) = (self.sources.files, self.sources.limits);
        let paths: Vec<&PathBuf> = models.iter().map(|(path, _)| path).collect();
        let read = |path: &&PathBuf| {
            let mut sources = Sources { limits, ..Sources::new(files) };
            let mesh = mesh(path, &mut sources);
            (mesh, sources.warnings)
        };
        let contents: Vec<_> = paths.par_iter().map(read).collect();
        for ((_, model), (mesh, warnings)) in models.iter().zip(contents) {
            self.sources.warnings.extend(warnings);
            let mesh = mesh.map_err(|error| model.place.blame(error))?;
            self.scene.meshes[model.mesh.index()] = mesh;
        }
        Ok(())
    }
}

/// The mesh in a PLY file, packed or not.
fn mesh(path: &Path, sources: &mut Sources<'_>) -> Result<Mesh> {
    let bytes = bytes(path, sources)?;
    let mut alone = Scene::default();
    let parts = ply::from_bytes(&bytes, path, sources, &mut alone)?;
    if parts.iter().any(|part| !matches!(part.geometry, Geometry::Mesh(_))) {
        let at = Location::file(path);
        sources.warn(&at, "there are points but no faces: nothing of it is shown");
    }
    let mut mesh = alone.meshes.into_iter().next().unwrap_or_default();
    // A material of its own is what would use them.
    mesh.colors = Vec::new();
    Ok(mesh)
}

/// A file's content, unpacked where it is packed by gzip.
fn bytes(path: &Path, sources: &Sources<'_>) -> Result<Vec<u8>> {
    let bytes = sources.read(path)?;
    if bytes.starts_with(b"\x1f\x8b") { unpacked(&bytes, path, &sources.limits) } else { Ok(bytes) }
}

fn unpacked(packed: &[u8], path: &Path, limits: &Limits) -> Result<Vec<u8>> {
    let at = Location::file(path);
    let plausible = (packed.len() as u64).saturating_mul(MOST_UNPACKED).saturating_add(1 << 20);
    let limit = limits.file_bytes.min(plausible);
    let mut bytes = Vec::new();
    let mut reader = flate2::read::MultiGzDecoder::new(packed).take(limit + 1);
    reader.read_to_end(&mut bytes).map_err(|error| {
        Error::syntax(&at, format!("cannot be unpacked: {error}")).hint("check that the file is whole")
    })?;
    if bytes.len() as u64 > limit {
        let error = Error::new(
            ErrorKind::Limit,
            &at,
            format!("unpacked it is longer than the limit of {limit} bytes"),
        );
        return Err(error.hint("unpack it with gunzip and name the unpacked file"));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    fn packed(content: &[u8]) -> Vec<u8> {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        encoder.write_all(content).expect("memory");
        encoder.finish().expect("memory")
    }

    #[test]
    fn packed_files_are_unpacked() {
        let (path, limits) = (Path::new("a.gz"), Limits::default());
        let two = [packed(b"one "), packed(b"two")].concat();
        assert_eq!(unpacked(&two, path, &limits).expect("whole"), b"one two");
        assert_eq!(
            unpacked(&two[..two.len() - 3], path, &limits).map_err(|e| e.kind),
            Err(ErrorKind::Syntax)
        );
    }

    #[test]
    fn bombs_are_defused() {
        let bomb = packed(&vec![0; 100 << 20]);
        let error = unpacked(&bomb, Path::new("a.gz"), &Limits::default()).expect_err("too long");
        assert_eq!(error.kind, ErrorKind::Limit);
    }
}
