//! Level sets of OpenVDB's and NanoVDB's files as models: a part for each, with the surface where the distance is zero.

use std::path::Path;

use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;
use crate::scene::{MeshId, Scene};
use crate::shape::{Geometry, Part};
use crate::vdb::VdbFile;
use crate::volume::GridClass;
use crate::volume::surface::surface;

/// Whether a file of volumes is a model: it has level sets, and no densities by their usual name.
///
/// # Errors
/// As [`vdb::read`](crate::vdb::read).
pub(crate) fn is_model(bytes: &[u8], path: &Path) -> Result<bool> {
    let at = Location::file(path);
    let file = VdbFile::new(bytes, &at)?;
    Ok(!file.names().contains(&VdbFile::DENSITY) && !file.names_of(GridClass::LevelSet).is_empty())
}

/// The level sets of a file; `path` is for messages.
///
/// # Errors
/// `Unsupported` if there are none; `Limit` for too many triangles; otherwise as [`vdb::read`](crate::vdb::read).
pub(crate) fn from_bytes(
    bytes: &[u8],
    path: &Path,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Result<Vec<Part>> {
    let at = Location::file(path);
    let file = VdbFile::new(bytes, &at)?;
    let names = file.names_of(GridClass::LevelSet);
    if names.is_empty() {
        let error = Error::new(ErrorKind::Unsupported, &at, "a volume is no model");
        return Err(error.hint("name it as the `file` of the `density` of a medium, in [media.NAME]"));
    }
    let mut parts = Vec::new();
    for name in names {
        let volume = file.volume(name, GridClass::LevelSet, context)?.ok_or_else(|| file.without(name))?;
        let mut mesh = surface(&volume, context, &at)?;
        if mesh.triangles.is_empty() {
            context.warn(&at, format!("the level set {name:?} is nowhere negative: it has no surface"));
            continue;
        }
        mesh.name = at.file.to_string();
        let geometry = Geometry::Mesh(MeshId(scene.meshes.len() as u32));
        let part = Part::new(Some(name.to_owned()), geometry);
        parts.push(Part { world_from_object: volume.world_from_index, ..part });
        scene.meshes.push(mesh);
    }
    Ok(parts)
}
