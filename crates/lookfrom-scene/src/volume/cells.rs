//! Grids of the values of trees.

use glam::IVec3;

use super::nodes::Nodes;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;
use crate::grid::{BLOCK, BRICK, Grid};

/// The values of a tree in its bounds, and the index coordinates of the first cell. Its memory is counted as that of the scene.
/// `values` are asked for leaf by leaf, by their index, in order: the values of each with z fastest.
///
/// # Errors
/// Errors of `values`; `Invalid` for values that are not finite; `Limit` for too many cells, or too little memory.
pub(crate) fn grid(
    tree: &Nodes,
    mut values: impl FnMut(usize) -> Result<[f32; BLOCK]>,
    context: &mut LoadContext<'_>,
    at: &Location,
) -> Result<(Grid<f32>, IVec3)> {
    let [low, end] = extent(tree);
    let size = (end - low).to_array().map(|bricks| bricks as u32);
    let table = size.iter().map(|&bricks| u64::from(bricks)).product::<u64>() * size_of::<u32>() as u64;
    let blocks = (tree.leaves.len() + tree.tiles.len() + 1) * BLOCK * size_of::<f32>();
    context.keep(table.saturating_add(blocks as u64), "the grid", at)?;
    let mut grid = Grid::new(size.map(|bricks| bricks * BRICK)).ok_or_else(|| {
        let [x, y, z] = size;
        let message = format!(
            "a grid of {x}·{y}·{z} bricks of 8³ cells, expected at most 2¹⁷ along an axis and 2²⁸ of them"
        );
        Error::new(ErrorKind::Limit, at, message).hint("divide the grid, or make it coarser")
    })?;
    let check = |value: f32, first: IVec3| {
        let message =
            || format!("the value {value} at the index {first} or near it, expected a finite number");
        if value.is_finite() { Ok(()) } else { Err(Error::invalid(at, message())) }
    };
    let of_grid = |at: IVec3| (at - low).clamp(IVec3::ZERO, end - low).to_array().map(|at| at as u32);
    check(tree.background, low)?;
    grid.fill([0; 3], size, tree.background);
    for tile in &tree.tiles {
        check(tile.value, tile.first)?;
        grid.fill(of_grid(bricks(tile.first)), of_grid(bricks(tile.first + tile.side)), tile.value);
    }
    for (leaf, &first) in tree.leaves.iter().enumerate() {
        let (values, brick) = (values(leaf)?, bricks(first));
        if brick.cmpge(low).all() && brick.cmplt(end).all() {
            values.iter().try_for_each(|&value| check(value, first))?;
            grid.set_brick(of_grid(brick), &by_x(&values));
        }
    }
    Ok((grid, low * BRICK as i32))
}

/// The first brick and the one behind the last along each axis: of all other values than zero in the bounds, and at least one.
fn extent(tree: &Nodes) -> [IVec3; 2] {
    let [low, high] = tree.bounds.map(bricks);
    if tree.background != 0.0 {
        return [low, high + 1];
    }
    let tiles = tree.tiles.iter().map(|tile| [bricks(tile.first), bricks(tile.first + tile.side)]);
    let leaves = tree.leaves.iter().map(|&first| [bricks(first), bricks(first) + 1]);
    let all = tiles.chain(leaves).reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]).unwrap_or([low; 2]);
    let first = low.max(all[0]).min(high);
    [first, (high + 1).min(all[1]).max(first + 1)]
}

/// The brick of a cell.
fn bricks(cell: IVec3) -> IVec3 {
    cell.map(|coordinate| coordinate.div_euclid(BRICK as i32))
}

/// Values of a brick with x fastest, of those with z fastest.
fn by_x(values: &[f32; BLOCK]) -> [f32; BLOCK] {
    std::array::from_fn(|index| {
        let [x, y, z] = [index % 8, index / 8 % 8, index / 64];
        values[64 * x + 8 * y + z]
    })
}
