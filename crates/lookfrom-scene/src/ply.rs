//! Reader and writer for PLY files: meshes and point clouds.
//!
//! `header` parses the header, `body` (with `values`) the elements, `build` makes the mesh, `edges` wires;
//! [`write`](fn@write) writes a mesh, which `exact` reads.
//! The format: Turk 1994, "The PLY Polygon File Format"; property names as they are in common use.

mod body;
mod build;
mod edges;
mod exact;
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

/// Reads the content of a PLY file, ASCII or binary: a mesh, or wires along its edges if there are no faces, or a point cloud if there
/// are no edges either. Integer colours, and floating-point ones from 0 to 255, are sRGB-encoded, other floating-point ones linear; an image named by a comment
/// `TextureFile` is used. Of several images each face has that of its `texnumber`, and there is a mesh for each.
/// Messages and relative file names use `path`.
///
/// # Errors
/// `Io`, `Limit`, `Syntax` and `Invalid`; at line and column, or at a byte in binary formats. After an error the scene may
/// contain parts of the file.
pub fn from_bytes(
    bytes: &[u8],
    path: &Path,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Result<Vec<Part>> {
    let header = header::parse(bytes, &Location::file(path), context)?;
    with_header(bytes, &header, path, context, scene)
}

/// As [`from_bytes`], without the images that the file names: its faces are one mesh.
pub(crate) fn geometry_from_bytes(
    bytes: &[u8],
    path: &Path,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Result<Vec<Part>> {
    let mut header = header::parse(bytes, &Location::file(path), context)?;
    header.textures.clear();
    with_header(bytes, &header, path, context, scene)
}

fn with_header(
    bytes: &[u8],
    header: &header::Header,
    path: &Path,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Result<Vec<Part>> {
    let file = Location::file(path);
    if let Some(is_of_solid) = header.own {
        return exact::read(&bytes[header.length..], header, is_of_solid, &file, context, scene);
    }
    let mut content = body::read(&bytes[header.length..], header, &file, &context.limits)?;
    content.settle_colors(&file, context);
    placed(content, header, path, context, scene)
}

/// Reads a file as [`geometry_from_bytes`], with an attribute of vertices or faces, linear, for the colours; `None` if the file does not have it.
pub(crate) fn read_with_attribute(
    path: &Path,
    (element, name): (&str, &str),
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Result<Option<Vec<Part>>> {
    let bytes = packed::read(path, context)?;
    let file = Location::file(path);
    let mut header = header::parse(&bytes, &file, context)?;
    header.textures.clear();
    if !header.take_colors_from(element, name) {
        return Ok(None);
    }
    let content = body::read(&bytes[header.length..], &header, &file, &context.limits)?;
    placed(content, &header, path, context, scene).map(Some)
}

fn placed(
    content: body::Content,
    header: &header::Header,
    path: &Path,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Result<Vec<Part>> {
    let file = Location::file(path);
    let (place, first) = (content.place, scene.meshes.len());
    let (mut parts, flat) = build::parts(content, header, path, context, scene)?;
    place.put(&mut parts, &scene.meshes[first..], flat, &file, context);
    Ok(parts)
}
