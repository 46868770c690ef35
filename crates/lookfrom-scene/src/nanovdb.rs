//! Reader for NanoVDB files (Museth 2021, "NanoVDB: A GPU-Friendly and Portable VDB Data Structure For Real-Time Rendering And
//! Simulation").
//!
//! Files of segments with grids of version 32 of the format, of `float` or quantised (`Fp4`, `Fp8`, `Fp16`, `FpN`), that are fog volumes or of no
//! class. Offsets are those of `PNanoVDB.h`. Values are at whole index coordinates; outside of the box of the active ones they are zero here,
//! whatever the background is. Checksums and statistics are not read.

mod cells;
mod directory;
mod header;
mod leaf;
mod tree;

use std::path::Path;

use glam::{DMat4, DVec3, IVec3, Vec3};

use self::directory::Entry;
use self::header::Header;
use self::tree::Tree;
use crate::error::{Error, Location, Result};
use crate::files::LoadContext;
use crate::grid::Grid;
use crate::suggest;
use crate::volume::bytes::Bytes;

/// A grid of a file, in index space.
#[derive(Clone, Debug)]
pub struct Volume {
    /// The values: at the centres of cells.
    pub grid: Grid<f32>,
    /// Index coordinates of the centre of the grid's first cell.
    pub first: IVec3,
    /// From index space to the world of the file; it has an inverse.
    pub world_from_index: DMat4,
    /// The index box: the least coordinates of active values, and the largest plus 1.
    pub bounds: [IVec3; 2],
}

impl Volume {
    /// The outer faces of the grid's cells, in index space.
    pub fn faces(&self) -> [Vec3; 2] {
        let size = IVec3::from_array(self.grid.size().map(|cells| cells as i32));
        [self.first, self.first + size].map(|corner| corner.as_vec3() - 0.5)
    }
}

/// Reads the first grid with this name.
///
/// # Errors
/// `Io`; `Syntax` for what is no such file; `Invalid` if it has no such grid, or values that are not finite; `Unsupported` for grids of
/// other versions, types, classes and compressions; `Limit` for too many cells, or too little memory.
pub fn read(path: &Path, name: &str, context: &mut LoadContext<'_>) -> Result<Volume> {
    let bytes = context.read(path)?;
    let at = Location::file(path);
    let file = NanoVdb::new(&bytes, &at)?;
    match file.volume(name, context)? {
        Some(volume) => Ok(volume),
        None => Err(file.without(name)),
    }
}

/// The content of a file.
pub struct NanoVdb<'a> {
    at: &'a Location,
    entries: Vec<Entry<'a>>,
}

impl<'a> NanoVdb<'a> {
    /// The content of a file, of which the directory is read; `at` is for messages.
    ///
    /// # Errors
    /// As [`read`].
    pub fn new(bytes: &'a [u8], at: &'a Location) -> Result<Self> {
        let entries = directory::entries(Bytes::new(bytes, at, ""))?;
        Ok(Self { at, entries })
    }

    /// The first grid with this name, if there is one.
    ///
    /// # Errors
    /// As [`read`].
    pub fn volume(&self, name: &str, context: &mut LoadContext<'_>) -> Result<Option<Volume>> {
        let Some(entry) = self.entries.iter().find(|entry| entry.name == name) else { return Ok(None) };
        let unpacked = entry.unpacked(self.at, &context.budget)?;
        let bytes = Bytes::new(&unpacked, self.at, " of the grid");
        let header = Header::new(bytes)?;
        let tree = Tree::new(bytes, header.kind)?;
        let (grid, first) = cells::grid(&tree, context, self.at)?;
        Ok(Some(Volume { grid, first, world_from_index: header.world_from_index, bounds: tree.bounds }))
    }

    /// The error that there is no grid with this name.
    pub fn without(&self, name: &str) -> Error {
        let names = || self.entries.iter().map(|entry| &*entry.name);
        let found: Vec<String> = names().map(|name| format!("{name:?}")).collect();
        let message = format!("no grid is called {name:?}; found {}", found.join(", "));
        let error = Error::invalid(self.at, message);
        match suggest::nearest(name, names()) {
            Some(near) => error.hint(format!("did you mean {near:?}?")),
            None => error.hint("name one of these grids"),
        }
    }
}

/// A map that moves the corners of a grid by less than this part of a cell from where scale and offset place them turns nothing.
const LEAST_TURN: f64 = 1.0 / 1024.0;

/// From the index space of a grid to that of another; `None` if that is more than a scale, which mirrors nothing, and an offset.
/// They are told by their maps to the world; `bounds` is the box of the other one, in its own space.
pub(crate) fn placement(
    world_from_index: &DMat4,
    world_from_other: &DMat4,
    bounds: [Vec3; 2],
) -> Option<impl Fn(Vec3) -> Vec3 + use<>> {
    let map = if world_from_index == world_from_other {
        DMat4::IDENTITY
    } else {
        world_from_index.inverse() * *world_from_other
    };
    let scale = DVec3::new(map.x_axis.x, map.y_axis.y, map.z_axis.z);
    let offset = map.w_axis.truncate();
    let straight = |corner: Vec3| {
        let corner = corner.as_dvec3();
        (map.transform_point3(corner) - (corner * scale + offset)).abs().max_element() < LEAST_TURN
    };
    let [low, high] = bounds;
    let corners =
        (0..8).map(|bits| IVec3::new(bits & 1, bits >> 1 & 1, bits >> 2).as_vec3() * (high - low) + low);
    let is_straight = scale.cmpgt(DVec3::ZERO).all() && corners.into_iter().all(straight);
    is_straight.then_some(move |point: Vec3| (point.as_dvec3() * scale + offset).as_vec3())
}
