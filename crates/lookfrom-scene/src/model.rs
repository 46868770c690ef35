//! Model files: selection of the reader, and the parts that readers share.
//!
//! The reader is selected by the extension, or by the content if the extension is absent or wrong. Models in formats
//! without a camera and lights are shown by [`crate::studio`].

pub(crate) mod colors;
pub(crate) mod lines;
pub(crate) mod number;
pub(crate) mod place;
pub(crate) mod points;
pub(crate) mod polygon;
pub(crate) mod scan;
pub(crate) mod stand;
pub(crate) mod surface;
pub(crate) mod tally;
pub(crate) mod text;
pub(crate) mod weld;

use std::path::Path;

use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;
use crate::scene::Scene;
use crate::shape::{Mesh, Part};
use crate::{obj, packed, ply, stl, subdivision};

/// Bytes that a byte of a model becomes, at most, while the model is parsed.
pub(crate) const PARSED: u64 = 5;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Format {
    Obj,
    Ply,
    Stl,
}

/// Whether the name has the extension of a model format: `.obj`, `.ply` or `.stl` in upper or lower case, with or without
/// `.gz` for gzip compression.
pub fn is_model(path: &Path) -> bool {
    by_name(path).is_some()
}

/// Reads a model: its meshes, materials, textures and images are added to the scene; its parts are returned, and are not
/// placed in the world yet.
///
/// # Errors
/// `Unsupported` if neither name nor content is that of a model; otherwise the errors of the format's reader.
pub fn read(path: &Path, context: &mut LoadContext<'_>, scene: &mut Scene) -> Result<Vec<Part>> {
    read_with_up(path, context, scene).map(|(parts, _)| parts)
}

/// The same, and whether z is up by the custom of the format, not y.
pub(crate) fn read_with_up(
    path: &Path,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Result<(Vec<Part>, bool)> {
    let bytes = packed::read(path, context)?;
    let file = Location::file(path);
    if bytes.is_empty() {
        return Err(Error::syntax(&file, "the file is empty"));
    }
    let _parsing = context.budget.reserve(bytes.len() as u64 * PARSED, "the parsed model", &file)?;
    let before = scene.meshes.len();
    let format =
        by_content(&bytes).or(by_name(path)).or_else(|| looks_like_obj(&bytes).then_some(Format::Obj));
    let (parts, z_is_up) = match format {
        Some(Format::Obj) => (obj::from_bytes(&bytes, path, context, scene)?, false),
        Some(Format::Ply) => (ply::from_bytes(&bytes, path, context, scene)?, false),
        // Programs for construction and for printers put parts onto the plane of x and y.
        Some(Format::Stl) => (stl::from_bytes(&bytes, path, context, scene)?, true),
        None => {
            return Err(Error::new(
                ErrorKind::Unsupported,
                &file,
                "neither its name nor its content is that of a model",
            )
            .hint("models are OBJ, PLY or STL files"));
        }
    };
    // Polygons are subdivided by their reader.
    if let levels @ 1.. = context.import.subdivision
        && format != Some(Format::Obj)
    {
        subdivision::subdivide_meshes(&mut scene.meshes[before..], levels, &file, context)?;
    }
    let meshes = scene.meshes[before..].iter().map(Mesh::bytes).sum();
    context.keep(meshes, "the meshes of the model", &file)?;
    Ok((parts, z_is_up))
}

fn by_name(path: &Path) -> Option<Format> {
    let name = packed::unpacked_name(path);
    let ending = name.extension()?.to_str()?.to_ascii_lowercase();
    match ending.as_str() {
        "obj" => Some(Format::Obj),
        "ply" => Some(Format::Ply),
        "stl" => Some(Format::Stl),
        _ => None,
    }
}

/// A format that the first bytes identify with certainty.
fn by_content(bytes: &[u8]) -> Option<Format> {
    if matches!(bytes, [b'p', b'l', b'y', b'\n' | b'\r' | b' ', ..]) {
        Some(Format::Ply)
    } else if stl::is_binary_by_length(bytes) || stl::is_text(bytes) {
        Some(Format::Stl)
    } else {
        None
    }
}

/// Whether there is a vertex among the first lines.
fn looks_like_obj(bytes: &[u8]) -> bool {
    let text = text::utf8(&bytes[..bytes.len().min(1 << 16)]).into_owned();
    let mut scanner = scan::Scanner::joining_lines(&text);
    loop {
        if scanner.word() == b"v" && (0..3).all(|_| number::parse_f32(scanner.word()).is_some()) {
            return true;
        }
        if !scanner.next_line() {
            return false;
        }
    }
}
