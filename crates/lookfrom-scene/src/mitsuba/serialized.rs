//! Mitsuba's `.serialized` files: meshes, each compressed by zlib, and their places at the end (versions 3 and 4).

use std::io::Read;
use std::path::Path;

use glam::{Vec2, Vec3};

use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;
use crate::shape::Mesh;

const MAGIC: u16 = 0x041c;

/// Flags of a mesh.
mod flag {
    pub(super) const NORMALS: u32 = 0x1;
    pub(super) const UVS: u32 = 0x2;
    pub(super) const COLORS: u32 = 0x8;
    pub(super) const FLAT_FACES: u32 = 0x10;
    pub(super) const DOUBLE: u32 = 0x2000;
}

/// Maximum compression ratio of a mesh: meshes compress to about a tenth, so a larger ratio is suspicious.
const MOST_UNPACKED: u64 = 250;

/// A mesh of a file, with its v upside down.
///
/// # Errors
/// `Io`; `Syntax` for bytes that are no such file or damaged, `Invalid` for an index of no mesh and indices of no vertex, `Unsupported` for
/// other versions, `Limit` for too many elements.
pub(super) fn read(path: &Path, index: u32, context: &mut LoadContext<'_>) -> Result<Mesh> {
    let bytes = context.read(path)?;
    let at = Location::file(path);
    let damaged = || Error::syntax(&at, "no serialized mesh, or a damaged one");
    let half = |place: usize| Some(u16::from_le_bytes(bytes.get(place..place + 2)?.try_into().ok()?));
    if half(0) != Some(MAGIC) {
        return Err(damaged());
    }
    let version = half(2).ok_or_else(damaged)?;
    if !matches!(version, 3 | 4) {
        let message = format!("a serialized mesh of version {version}; versions 3 and 4 are supported");
        return Err(Error::new(ErrorKind::Unsupported, &at, message));
    }

    // The places of meshes are before their number, at the end.
    let number = |place: usize, size: usize| -> Option<u64> {
        let bytes = bytes.get(place..place.checked_add(size)?)?;
        Some(bytes.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte)))
    };
    let end = bytes.len().saturating_sub(4);
    let count = number(end, 4).ok_or_else(damaged)?;
    if u64::from(index) >= count {
        let message = format!("there is no mesh {index}: the file has {count}, counted from 0");
        return Err(Error::invalid(&at, message).hint("give another `shape_index`"));
    }
    let size = if version == 4 { 8 } else { 4 };
    let table =
        count.checked_mul(size).and_then(|length| (end as u64).checked_sub(length)).ok_or_else(damaged)?;
    let place = number((table + u64::from(index) * size) as usize, size as usize).ok_or_else(damaged)?;
    let packed =
        usize::try_from(place).ok().and_then(|place| bytes.get(place.checked_add(4)?..table as usize));
    let packed = packed.ok_or_else(damaged)?;

    let most = (packed.len() as u64).saturating_mul(MOST_UNPACKED);
    let mut stream = Stream { from: flate2::read::ZlibDecoder::new(packed).take(most), at: &at };
    let flags = stream.whole(4)? as u32;
    if version == 4 {
        while stream.whole(1)? != 0 {}
    }
    let (vertices, triangles) = (stream.whole(8)?, stream.whole(8)?);
    if vertices.max(triangles) > context.limits.elements.min(u64::from(u32::MAX)) {
        let message = format!("{vertices} vertices and {triangles} triangles are more than the limit");
        return Err(Error::new(ErrorKind::Limit, &at, message));
    }
    let (vertices, triangles) = (vertices as usize, triangles as usize);
    let is_double = flags & flag::DOUBLE != 0;
    let mut mesh = Mesh { name: at.file.to_string(), ..Mesh::default() };
    let room = (vertices as u64 * 44 + triangles as u64 * 12).min(most);
    context.keep(room, "a serialized mesh", &at)?;
    for _ in 0..vertices {
        mesh.positions.push(Vec3::from(stream.numbers(is_double)?));
    }
    if let Some(position) = mesh.positions.iter().find(|position| !position.is_finite()) {
        return Err(Error::invalid(&at, format!("a vertex at {position}")));
    }
    if flags & flag::NORMALS != 0 {
        for _ in 0..vertices {
            let normal = Vec3::from(stream.numbers(is_double)?);
            mesh.normals.push(if normal.is_finite() { normal } else { Vec3::ZERO });
        }
    }
    if flags & flag::UVS != 0 {
        for _ in 0..vertices {
            let uv = Vec2::from(stream.numbers(is_double)?);
            mesh.uvs.push(if uv.is_finite() { uv } else { Vec2::ZERO });
        }
    }
    if flags & flag::COLORS != 0 {
        for _ in 0..vertices {
            let color: [f32; 3] = stream.numbers(is_double)?;
            mesh.colors.push(color.map(|channel| if channel.is_finite() { channel.max(0.0) } else { 1.0 }));
        }
    }
    if flags & flag::FLAT_FACES != 0 {
        mesh.normals.clear();
    }
    for _ in 0..triangles {
        let corners = [stream.whole(4)?, stream.whole(4)?, stream.whole(4)?];
        if let Some(corner) = corners.iter().find(|corner| **corner >= vertices as u64) {
            let message = format!("a triangle with the vertex {corner}, of {vertices} vertices");
            return Err(Error::invalid(&at, message));
        }
        mesh.triangles.push(corners.map(|corner| corner as u32));
    }
    Ok(mesh)
}

/// The unpacked numbers of a mesh.
struct Stream<'a, R> {
    from: R,
    at: &'a Location,
}

impl<R: Read> Stream<'_, R> {
    /// A whole number of some bytes.
    fn whole(&mut self, size: usize) -> Result<u64> {
        let mut bytes = [0; 8];
        self.from.read_exact(&mut bytes[..size]).map_err(|_| {
            Error::syntax(self.at, "the mesh is cut off or damaged").hint("write the file again")
        })?;
        Ok(u64::from_le_bytes(bytes))
    }

    fn numbers<const N: usize>(&mut self, is_double: bool) -> Result<[f32; N]> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = match is_double {
                true => f64::from_bits(self.whole(8)?) as f32,
                false => f32::from_bits(self.whole(4)? as u32),
            };
        }
        Ok(numbers)
    }
}
