//! Reader and writer for PLY files: meshes and point clouds.
//!
//! `header` reads what the file says of itself, `body` (by way of `values`) what it holds, `build` makes the mesh,
//! [`write`](fn@write) writes one. The format: Turk 1994, "The PLY Polygon File Format"; names of properties as programs have
//! come to write them.

mod body;
mod build;
mod header;
mod values;
mod write;

use std::path::Path;

pub use self::write::write;
use crate::error::{Location, Result};
use crate::files::LoadContext;
use crate::packed;
use crate::scene::Scene;
use crate::shape::Part;

/// Reads a PLY file, ASCII or binary: one mesh, or a cloud of points where there are no faces. Colours that are whole
/// numbers are sRGB-encoded, others linear; a picture that a comment `TextureFile` names is used.
///
/// # Errors
/// `Io`, `Limit`, `Syntax` and `Invalid`; at line and column, or at a byte in what is binary. After an error the scene
/// may hold pieces of the file.
pub fn read(path: &Path, context: &mut LoadContext<'_>, scene: &mut Scene) -> Result<Vec<Part>> {
    from_bytes(&packed::read(path, context)?, path, context, scene)
}

/// The same for the content of a file; `path` is where it came from, for messages and for the files it names.
///
/// # Errors
/// As [`read`].
pub fn from_bytes(
    bytes: &[u8],
    path: &Path,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Result<Vec<Part>> {
    let file = Location::file(path);
    let header = header::parse(bytes, &file, context)?;
    let content = body::read(&bytes[header.length..], &header, &file, &context.limits)?;
    build::parts(content, &header, path, context, scene)
}
