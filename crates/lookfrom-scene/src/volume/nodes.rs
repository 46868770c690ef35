//! Nodes of VDB trees: tiles, which are cubes of one value, and leaves of 8³ values.

use glam::IVec3;

use super::bytes::Bytes;
use crate::error::{ErrorKind, Result};

/// Coordinates are below this, so that they and their halves are exact in `f32`.
const FARTHEST: i32 = 1 << 22;

/// A cube of one value.
pub(crate) struct Tile {
    /// Its least coordinates.
    pub(crate) first: IVec3,
    /// Number of cells along a side: whole bricks.
    pub(crate) side: i32,
    pub(crate) value: f32,
}

/// A tree without the values of its leaves.
#[derive(Default)]
pub(crate) struct Nodes {
    /// Value outside of leaves and tiles.
    pub(crate) background: f32,
    /// Tiles of other values than the background.
    pub(crate) tiles: Vec<Tile>,
    /// The least coordinates of leaves.
    pub(crate) leaves: Vec<IVec3>,
    /// The least coordinates of active values, and the largest plus 1; both zero if there are none.
    pub(crate) bounds: [IVec3; 2],
}

/// # Errors
/// `Limit` for coordinates, told at a position, that are too large.
pub(crate) fn check_near(corner: IVec3, bytes: Bytes<'_>, at: u64) -> Result<()> {
    if corner.cmplt(IVec3::splat(FARTHEST)).all() && corner.cmpgt(IVec3::splat(-FARTHEST)).all() {
        return Ok(());
    }
    let error = bytes.error(at, ErrorKind::Limit, "index coordinates beyond ±2²²");
    Err(error.hint("move the grid to the origin of index space, and its map the other way"))
}
