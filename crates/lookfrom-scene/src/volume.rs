//! Grids of files as volumes, and what the readers of such files share: NanoVDB's and OpenVDB's, of which [`vdb`](crate::vdb) chooses.

pub(crate) mod blosc;
pub(crate) mod bytes;
pub(crate) mod cells;
pub(crate) mod nodes;
pub(crate) mod surface;
pub(crate) mod zip;

use std::sync::Arc;

use glam::{DMat3, DMat4, DVec3, IVec3, Vec3};

use self::bytes::Bytes;
use crate::error::{ErrorKind, Result};
use crate::grid::{Grid, Placed};

/// A grid of a file, in index space. Values are at whole index coordinates; outside of the box of the active ones they are zero here,
/// whatever the background is.
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

    /// Whether any value is negative.
    pub(crate) fn has_negatives(&self) -> bool {
        self.grid.stored().iter().any(|value| *value < 0.0)
    }

    /// The values as densities, in index space: what is negative is nothing.
    pub(crate) fn into_densities(self) -> Placed<f32> {
        let bounds = self.faces();
        let grid = if self.has_negatives() { self.grid.map(|value| value.max(0.0)) } else { self.grid };
        Placed { grid: Arc::new(grid), bounds }
    }
}

/// The class of a grid (OpenVDB's `GridClass`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GridClass {
    /// Densities, or anything else that fills space: of fog volumes, and of grids without a class.
    Fog,
    /// Distances to a surface, negative inside.
    LevelSet,
}

impl GridClass {
    /// By the name that a class has in files.
    pub(crate) fn of_name(name: &str) -> Option<Self> {
        match name {
            "unknown" | "fog volume" => Some(Self::Fog),
            "level set" => Some(Self::LevelSet),
            _ => None,
        }
    }

    /// # Errors
    /// `Unsupported` if another class has this name, which stands at a position.
    pub(crate) fn check(self, name: &str, bytes: Bytes<'_>, at: u64) -> Result<()> {
        if Self::of_name(name) == Some(self) {
            return Ok(());
        }
        let (expected, hint) = match self {
            Self::Fog => ("a fog volume", "densities are grids of the class \"fog volume\""),
            Self::LevelSet => ("a level set", "distances are grids of the class \"level set\""),
        };
        let message = format!("a grid of the class {name:?}, expected {expected}");
        Err(bytes.error(at, ErrorKind::Unsupported, message).hint(hint))
    }
}

/// # Errors
/// `Invalid` if the map from index space to the world, told at a position, has no inverse.
pub(crate) fn check_map(map: &DMat4, bytes: Bytes<'_>, at: u64) -> Result<()> {
    if map.is_finite() && map.inverse().is_finite() && DMat3::from_mat4(*map).determinant() != 0.0 {
        return Ok(());
    }
    let message = "the map from index space to the world has no inverse";
    Err(bytes.error(at, ErrorKind::Invalid, message))
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
