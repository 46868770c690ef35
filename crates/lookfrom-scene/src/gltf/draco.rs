//! Meshes compressed by Draco (`KHR_draco_mesh_compression`).
//!
//! The crate `draco-core` decodes the stream, within limits; `accessor` looks up here which accessor refers to which part
//! of it. Without the feature `draco` such meshes are read only where the file contains an uncompressed fallback.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use super::json::{Root, Whole};
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::Limits;

/// A decoded mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Decoded {
    /// Three per triangle, each below `vertices`.
    pub(crate) indices: Vec<u32>,
    /// The number of vertices.
    pub(crate) vertices: usize,
    /// By the ids that the extension's JSON gives them.
    pub(crate) attributes: BTreeMap<u64, Attribute>,
}

impl Decoded {
    /// Bytes of its arrays.
    pub(crate) fn bytes(&self) -> u64 {
        let numbers = self.attributes.values().map(|attribute| size_of_val(&*attribute.numbers));
        (size_of_val(&*self.indices) + numbers.sum::<usize>()) as u64
    }
}

/// The values of a vertex attribute.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Attribute {
    /// The number of components per vertex.
    pub(crate) width: usize,
    /// Values as `f64`, integers not normalised.
    pub(crate) numbers: Vec<f32>,
    /// The divisor of normalised integers; `None` for floating-point components.
    pub(crate) one: Option<f32>,
}

/// The part of a compressed mesh that an accessor refers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// The corners of triangles.
    Indices,
    /// The attribute with this id.
    Attribute(u64),
}

/// The accessors of a file that refer to compressed meshes.
#[derive(Debug)]
pub(crate) struct Compressed {
    /// By accessor: the buffer view of the stream, and the part of it.
    roles: BTreeMap<usize, (Whole, Role)>,
    /// By buffer view, filled at the first request.
    decoded: Vec<OnceLock<Result<Decoded>>>,
}

impl Compressed {
    /// The accessors of all primitives.
    pub(crate) fn new(root: &Root) -> Self {
        let decoded = root.buffer_views.iter().map(|_| OnceLock::new()).collect();
        let mut compressed = Self { roles: BTreeMap::new(), decoded };
        for primitive in root.meshes.iter().flat_map(|mesh| &mesh.primitives) {
            let Some(draco) = &primitive.extensions.draco else { continue };
            let view = draco.buffer_view;
            if let Some(accessor) = primitive.indices {
                compressed.roles.insert(accessor.index(), (view, Role::Indices));
            }
            for (name, id) in &draco.attributes {
                if let Some(accessor) = primitive.attributes.get(name) {
                    compressed.roles.insert(accessor.index(), (view, Role::Attribute(id.0)));
                }
            }
        }
        compressed
    }

    /// The buffer view and the part of its stream that an accessor refers to; `None` for uncompressed data.
    pub(crate) fn role(&self, accessor: Whole) -> Option<(Whole, Role)> {
        self.roles.get(&accessor.index()).copied()
    }

    /// The decoded mesh of a buffer view.
    ///
    /// # Errors
    /// The errors of `decode`.
    ///
    /// # Panics
    /// If the file has no such view.
    pub(crate) fn get_or_decode(
        &self,
        view: Whole,
        decode: impl FnOnce() -> Result<Decoded>,
    ) -> Result<&Decoded> {
        self.decoded[view.index()].get_or_init(decode).as_ref().map_err(Clone::clone)
    }
}

/// Decodes a stream.
///
/// # Errors
/// `Syntax` if it is not a complete Draco stream, `Limit` for more vertices or triangles than [`Limits::elements`] or more
/// than 2 GiB of values, `Unsupported` without the feature `draco`.
#[cfg(feature = "draco")]
pub(crate) fn decode(bytes: &[u8], at: &Location, limits: &Limits) -> Result<Decoded> {
    use draco_core::{DataType, DecodeLimits, DecoderBuffer, ErrorKind as Kind, Mesh, MeshDecoder};

    let most = DecodeLimits::default();
    let most = most.with_max_points(limits.elements.min(most.max_points));
    let most = most.with_max_faces(limits.elements.min(most.max_faces));
    let mut mesh = Mesh::new();
    let mut stream = DecoderBuffer::new(bytes).with_limits(most);
    MeshDecoder::new().decode(&mut stream, &mut mesh).map_err(|error| match error.kind() {
        Kind::LimitExceeded => Error::new(ErrorKind::Limit, at, format!("the mesh is too large: {error}"))
            .hint("split the model into several files"),
        _ => Error::syntax(at, format!("the Draco stream cannot be decoded: {error}"))
            .hint("the file is damaged or was written wrongly: export it again, or without compression"),
    })?;

    let vertices = mesh.num_points();
    let indices: Vec<u32> = mesh.faces().iter().flatten().map(|corner| corner.0).collect();
    if let Some(beyond) = indices.iter().find(|&&index| index as usize >= vertices) {
        let found = format!("the Draco stream uses vertex {beyond}, but has only {vertices}");
        return Err(Error::syntax(at, found));
    }
    let mut attributes = BTreeMap::new();
    for index in 0..mesh.num_attributes() {
        let attribute = mesh.attribute(index);
        let one = match attribute.data_type() {
            DataType::Int8 => Some(127.0),
            DataType::Uint8 => Some(255.0),
            DataType::Int16 => Some(32767.0),
            DataType::Uint16 => Some(65535.0),
            _ => None,
        };
        let width = usize::from(attribute.num_components());
        let numbers = attribute.read_f32s(vertices, width);
        attributes.insert(u64::from(attribute.unique_id()), Attribute { width, numbers, one });
    }
    Ok(Decoded { indices, vertices, attributes })
}

/// Without the feature nothing can be decoded.
#[cfg(not(feature = "draco"))]
pub(crate) fn decode(_: &[u8], at: &Location, _: &Limits) -> Result<Decoded> {
    Err(Error::new(ErrorKind::Unsupported, at, "compressed by Draco, which this build cannot read")
        .hint("build with the feature `draco`, or export the model without compression"))
}

#[cfg(all(test, feature = "draco"))]
mod tests;
