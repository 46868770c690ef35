//! Model files in formats without a camera and lights, and the parts that their readers share. [`crate::studio`] shows them.

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
use crate::format::Format;
use crate::scene::Scene;
use crate::shape::{Mesh, Part};
use crate::source::Source;
use crate::{hair, level_set, obj, ply, stl, subdivision};

/// Bytes that a byte of a model becomes, at most, while the model is parsed.
pub(crate) const PARSED: u64 = 5;

/// Reads a model: its meshes, materials, textures and images are added to the scene; its parts are returned, and are not
/// placed in the world yet.
///
/// # Errors
/// `Unsupported` if neither name nor content is that of a model; otherwise the errors of the format's reader.
pub fn read(path: &Path, context: &mut LoadContext<'_>, scene: &mut Scene) -> Result<Vec<Part>> {
    of_source(&Source::open(path, context)?, true, context, scene)
}

/// As [`read`], without materials and images.
pub(crate) fn read_geometry(
    path: &Path,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Result<Vec<Part>> {
    of_source(&Source::open(path, context)?, false, context, scene)
}

/// As [`read`], of a file that has been read; or without materials and images.
pub(crate) fn of_source(
    source: &Source<'_>,
    has_materials: bool,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Result<Vec<Part>> {
    let Source { path, bytes, format } = source;
    let file = Location::file(path);
    let read = match (format, has_materials) {
        (Some(Format::Obj), true) => obj::from_bytes,
        (Some(Format::Obj), false) => obj::geometry_from_bytes,
        (Some(Format::Ply), true) => ply::from_bytes,
        (Some(Format::Ply), false) => ply::geometry_from_bytes,
        (Some(Format::Stl), _) => stl::from_bytes,
        (Some(Format::Hair), _) => hair::from_bytes,
        (Some(Format::Vdb), _) => level_set::from_bytes,
        _ => {
            let message = "neither its name nor its content is that of a model";
            return Err(Error::new(ErrorKind::Unsupported, &file, message)
                .hint("models are OBJ, PLY, STL or HAIR files, and level sets of VDB files"));
        }
    };
    let _parsing = context.budget.reserve(bytes.len() as u64 * PARSED, "the parsed model", &file)?;
    let before = scene.meshes.len();
    let parts = read(bytes, path, context, scene)?;
    // Polygons are subdivided by their reader.
    if let levels @ 1.. = context.import.subdivision
        && *format != Some(Format::Obj)
    {
        subdivision::subdivide_meshes(&mut scene.meshes[before..], levels, &file, context)?;
    }
    let meshes: u64 = scene.meshes[before..].iter().map(Mesh::bytes).sum();
    let pieces: u64 = parts.iter().map(|part| part.pieces.bytes()).sum();
    context.keep(meshes + pieces, "the meshes of the model", &file)?;
    Ok(parts)
}
