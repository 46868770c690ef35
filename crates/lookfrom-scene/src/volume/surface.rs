//! Surfaces of level sets: surface nets (Gibson 1998, "Constrained Elastic Surface Nets") without relaxation.
//!
//! The cube between eight neighbouring cells has one vertex if they have both signs: the mean of the points where its edges cross zero.
//! Around each such edge the four cubes that share it are joined by two triangles. So the mesh is closed, and touches the true surface
//! to second order in the width of a cell.

use std::collections::HashMap;

use glam::{IVec3, Vec3};

use super::Volume;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;
use crate::grid::Grid;
use crate::shape::Mesh;

/// Bytes of a face while the surface is made: two triangles, and a vertex with its normal and its place in the table.
const FACE: u64 = 24 + 24 + 64;

/// The corners of a cube, in the order of [`Grid::corners`].
const CORNERS: [Vec3; 8] = [
    Vec3::new(0.0, 0.0, 0.0),
    Vec3::new(1.0, 0.0, 0.0),
    Vec3::new(0.0, 1.0, 0.0),
    Vec3::new(1.0, 1.0, 0.0),
    Vec3::new(0.0, 0.0, 1.0),
    Vec3::new(1.0, 0.0, 1.0),
    Vec3::new(0.0, 1.0, 1.0),
    Vec3::new(1.0, 1.0, 1.0),
];

/// An edge of the grid between a cell inside and its neighbour, which is not inside: the surface is between them.
#[derive(Clone, Copy)]
struct Crossing {
    /// The cell with the lesser coordinate.
    first: IVec3,
    axis: usize,
    /// Whether that is the cell inside.
    leaves: bool,
}

/// Closed surfaces around all negative values of a volume, in its index space, with normals to the outside. What is beyond the bounds of
/// the volume is outside.
///
/// # Errors
/// `Limit` for too many triangles, or too little memory.
pub(crate) fn surface(volume: &Volume, context: &mut LoadContext<'_>, at: &Location) -> Result<Mesh> {
    let grid = &volume.grid;
    let mut faces = 0_u64;
    for_crossings(grid, |_| faces += 1);
    let most = context.limits.elements.min(u64::from(u32::MAX) / 4);
    if 2 * faces > most {
        let message = format!("a surface of {} triangles, expected at most {most}", 2 * faces);
        return Err(
            Error::new(ErrorKind::Limit, at, message).hint("resample the level set with larger cells")
        );
    }
    let _making = context.budget.reserve(faces * FACE, "the surface of the level set", at)?;

    let mut vertices = HashMap::new();
    let mut mesh = Mesh::default();
    for_crossings(grid, |Crossing { first, axis, leaves }| {
        let [b, c] = [1, 2].map(|turn| IVec3::from_array(unit((axis + turn) % 3)));
        // Counter-clockwise as seen from the side of the greater coordinate.
        let mut cubes = [first - b - c, first - c, first, first - b];
        if !leaves {
            cubes.reverse();
        }
        let [p, q, r, s] = cubes.map(|cube| {
            *vertices.entry(cube).or_insert_with(|| {
                let (offset, normal) = vertex(&grid.corners(cube.to_array()));
                mesh.positions.push((volume.first + cube).as_vec3() + offset);
                mesh.normals.push(normal);
                mesh.positions.len() as u32 - 1
            })
        });
        // Along the shorter diagonal.
        let apart = |a: u32, b: u32| mesh.positions[a as usize].distance_squared(mesh.positions[b as usize]);
        let is_first = apart(p, r) <= apart(q, s);
        mesh.triangles.extend(if is_first { [[p, q, r], [p, r, s]] } else { [[q, r, s], [q, s, p]] });
    });
    Ok(mesh)
}

/// The unit vector along an axis.
fn unit(axis: usize) -> [i32; 3] {
    std::array::from_fn(|k| i32::from(k == axis))
}

/// Tells all edges that cross the surface, in an order that depends on the grid alone.
fn for_crossings(grid: &Grid<f32>, mut of: impl FnMut(Crossing)) {
    grid.for_each_box(|[low, high], value| {
        if !(value < 0.0) {
            return;
        }
        let [low, high] = [low, high].map(|cell| IVec3::from_array(cell.map(|coordinate| coordinate as i32)));
        // Within a box of one value nothing changes: only the cells of its six sides have neighbours of others.
        for axis in 0..3 {
            let along = IVec3::from_array(unit(axis));
            for leaves in [false, true] {
                let (mut from, mut to) = (low, high);
                match leaves {
                    true => from[axis] = high[axis],
                    false => to[axis] = low[axis],
                }
                let step = if leaves { along } else { -along };
                // A file may fill millions of bricks at once.
                if low != high && grid.share_block([from, from + step].map(|cell| cell.to_array())) {
                    continue;
                }
                for z in from.z..=to.z {
                    for y in from.y..=to.y {
                        for x in from.x..=to.x {
                            let inside = IVec3::new(x, y, z);
                            let neighbor = inside + step;
                            if !(grid.value(neighbor.to_array()) < 0.0) {
                                of(Crossing { first: inside.min(neighbor), axis, leaves });
                            }
                        }
                    }
                }
            }
        }
    });
}

/// The vertex of a cube, from its first corner in widths of a cell, and the normal there, by the values of its corners.
fn vertex(values: &[f32; 8]) -> (Vec3, Vec3) {
    let (mut sum, mut count) = (Vec3::ZERO, 0.0);
    for axis in 0..3 {
        for from in (0..8).filter(|corner| corner >> axis & 1 == 0) {
            let to = from | 1 << axis;
            let [a, b] = [values[from], values[to]];
            if (a < 0.0) != (b < 0.0) {
                sum += CORNERS[from].lerp(CORNERS[to], a / (a - b));
                count += 1.0;
            }
        }
    }
    let offset = sum / count;

    // The gradient of the trilinear interpolation.
    let gradient = |axis: usize| -> f32 {
        (0..8)
            .filter(|corner| corner >> axis & 1 == 0)
            .map(|from| {
                let weight: f32 = (0..3)
                    .filter(|other| *other != axis)
                    .map(|other| if from >> other & 1 == 1 { offset[other] } else { 1.0 - offset[other] })
                    .product();
                weight * (values[from | 1 << axis] - values[from])
            })
            .sum()
    };
    (offset, Vec3::new(gradient(0), gradient(1), gradient(2)).normalize_or_zero())
}
