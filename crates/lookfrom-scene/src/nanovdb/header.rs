//! Headers of grids: version, type, class, and where the grid is.

use glam::{DMat3, DMat4, DVec3};

use super::leaf::Kind;
use crate::error::{ErrorKind, Result};
use crate::volume::bytes::Bytes;
use crate::volume::{GridClass, check_map};

/// Bytes of the header; the tree follows.
pub(super) const HEADER: u64 = 672;

const CLASS: u64 = 632;
const TYPE: u64 = 636;
/// The matrix of the map in rows, and its translation.
const MATRIX: u64 = 384;
const TRANSLATION: u64 = 528;

const MAGICS: [&[u8]; 2] = [b"NanoVDB0", b"NanoVDB1"];

/// The version that is read: it changes with the layout of bytes.
const MAJOR: u32 = 32;

/// Names of types of values, by their numbers.
const TYPES: &[&str] = &[
    "unknown", "float", "double", "int16", "int32", "int64", "Vec3f", "Vec3d", "mask", "half", "uint32",
    "bool", "RGBA8", "Fp4", "Fp8", "Fp16", "FpN", "Vec4f", "Vec4d", "index",
];

/// Names of classes, by their numbers.
const CLASSES: &[&str] = &[
    "unknown",
    "level set",
    "fog volume",
    "staggered",
    "point index",
    "point data",
    "topology",
    "voxel volume",
    "index",
    "tensor",
];

/// Content of a grid's header.
pub(super) struct Header {
    /// The type of its leaves.
    pub(super) kind: Kind,
    /// It has an inverse.
    pub(super) world_from_index: DMat4,
}

impl Header {
    /// # Errors
    /// `Syntax` for what is no header, `Unsupported` for other versions, types and classes, `Invalid` for a map without an inverse.
    pub(super) fn new(bytes: Bytes<'_>, expected: GridClass) -> Result<Self> {
        bytes.slice(0, HEADER, "the header of a grid")?;
        if !MAGICS.contains(&bytes.slice(0, 8, "a number")?) {
            let message = "expected a grid, which begins with `NanoVDB0` or `NanoVDB1`";
            return Err(bytes.error(0, ErrorKind::Syntax, message));
        }
        check_version(bytes, 16)?;
        let unsupported = |at, message: String| bytes.error(at, ErrorKind::Unsupported, message);
        let [class, kind] = [bytes.u32(CLASS)?, bytes.u32(TYPE)?];
        expected.check(&class_name(class), bytes, CLASS)?;
        let kind = Kind::of(kind).ok_or_else(|| {
            let name = TYPES.get(kind as usize).map_or_else(|| kind.to_string(), |name| format!("{name:?}"));
            let message = format!("a grid of the type {name}, expected float, Fp4, Fp8, Fp16 or FpN");
            unsupported(TYPE, message).hint("convert it to a grid of the type float")
        })?;
        Ok(Self { kind, world_from_index: map(bytes)? })
    }
}

/// The name of a class.
pub(super) fn class_name(class: u32) -> String {
    CLASSES.get(class as usize).map_or_else(|| class.to_string(), ToString::to_string)
}

/// The affine map from index space to the world.
fn map(bytes: Bytes<'_>) -> Result<DMat4> {
    let vector = |at| Ok(DVec3::new(bytes.f64(at)?, bytes.f64(at + 8)?, bytes.f64(at + 16)?));
    let rows = [vector(MATRIX)?, vector(MATRIX + 24)?, vector(MATRIX + 48)?];
    let linear = DMat3::from_cols(rows[0], rows[1], rows[2]).transpose();
    let map = DMat4::from_mat3_translation(linear, vector(TRANSLATION)?);
    check_map(&map, bytes, MATRIX)?;
    Ok(map)
}

/// # Errors
/// `Unsupported` if the version at a position is another one.
pub(super) fn check_version(bytes: Bytes<'_>, at: u64) -> Result<()> {
    let version = bytes.u32(at)?;
    let (major, minor, patch) = (version >> 21, version >> 10 & 0x7ff, version & 0x3ff);
    if major == MAJOR {
        return Ok(());
    }
    let message = format!("version {major}.{minor}.{patch} of NanoVDB, expected {MAJOR}");
    let error = bytes.error(at, ErrorKind::Unsupported, message);
    Err(error.hint("write the file again by another version of NanoVDB"))
}
