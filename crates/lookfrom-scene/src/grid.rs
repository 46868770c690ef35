//! Grids of values in space: densities, temperatures, colours of media.

use std::sync::Arc;

use glam::Vec3;

/// Values at the centres of the cells of a grid, in bricks of 8³ cells. Outside of the grid, and in bricks that were never
/// written, they are zero; such bricks take no memory. Bricks that were filled with one value take the memory of one.
#[derive(Clone, Debug)]
pub struct Grid<T> {
    size: [u32; 3],
    /// Number of bricks along x, y and z.
    count: [u32; 3],
    /// By bricks, x fastest: the number of their block of values, or [`EMPTY`].
    bricks: Vec<u32>,
    /// Blocks of [`BRICK`]³ values, x fastest; the first is of zeros.
    values: Vec<T>,
}

/// A grid in the box that it fills.
#[derive(Clone, Debug)]
pub struct Placed<T> {
    /// The values.
    pub grid: Arc<Grid<T>>,
    /// The corners of the box, in medium space.
    pub bounds: [Vec3; 2],
}

/// Number of cells along a side of a brick.
pub const BRICK: u32 = 8;

/// Number of values of a brick.
pub const BLOCK: usize = (BRICK * BRICK * BRICK) as usize;

/// The block of all bricks without values.
const EMPTY: u32 = 0;

/// Largest number of cells along an axis: coordinates of cells are exact in `f32`.
const MOST_CELLS: u32 = 1 << 20;

/// Largest number of bricks: their table takes 1 GiB.
const MOST_BRICKS: u64 = 1 << 28;

impl<T: Copy + Default + PartialEq> Grid<T> {
    /// A grid of zeros; `None` if it is empty, has more than 2²⁰ cells along an axis, or more than 2²⁸ bricks.
    pub fn new(size: [u32; 3]) -> Option<Self> {
        let count = size.map(|cells| cells.div_ceil(BRICK));
        let bricks = count.iter().try_fold(1_u64, |product, &bricks| product.checked_mul(bricks.into()))?;
        if size.iter().any(|&cells| cells == 0 || cells > MOST_CELLS) || bricks > MOST_BRICKS {
            return None;
        }
        Some(Self { size, count, bricks: vec![EMPTY; bricks as usize], values: vec![T::default(); BLOCK] })
    }

    /// A grid of all its values, x fastest. `None` as in [`Grid::new`], or if there are more or fewer of them.
    pub fn from_values(size: [u32; 3], values: &[T]) -> Option<Self> {
        let mut grid = Self::new(size)?;
        let [width, height, depth] = size.map(|cells| cells as usize);
        if width.checked_mul(height)?.checked_mul(depth)? != values.len() {
            return None;
        }
        let rows = values.chunks_exact(width).zip((0..depth).flat_map(|z| (0..height).map(move |y| (y, z))));
        for (row, (y, z)) in rows {
            for (x, &value) in row.iter().enumerate().filter(|(_, value)| **value != T::default()) {
                grid.set([x as u32, y as u32, z as u32], value);
            }
        }
        Some(grid)
    }

    /// Writes the value of a cell, in a brick that was not filled; nothing happens outside of the grid.
    fn set(&mut self, cell: [u32; 3], value: T) {
        if (0..3).any(|axis| cell[axis] >= self.size[axis]) {
            return;
        }
        let brick = brick(self.count, cell);
        if self.bricks[brick] == EMPTY {
            self.bricks[brick] = self.push(&[T::default(); BLOCK]);
        }
        let place = self.place(cell);
        self.values[place] = value;
    }

    /// Writes the values of a brick, x fastest, in a grid of whole bricks; nothing happens outside of the grid.
    pub fn set_brick(&mut self, brick: [u32; 3], values: &[T; BLOCK]) {
        if (0..3).any(|axis| brick[axis] >= self.size[axis] / BRICK) {
            return;
        }
        let is_empty = values.iter().all(|value| *value == T::default());
        self.bricks[index(self.count, brick)] = if is_empty { EMPTY } else { self.push(values) };
    }

    /// Writes one value to the bricks from `first` on and below `end`, in a grid of whole bricks; nothing happens outside of the grid.
    pub fn fill(&mut self, first: [u32; 3], end: [u32; 3], value: T) {
        let end: [u32; 3] = std::array::from_fn(|axis| end[axis].min(self.size[axis] / BRICK));
        if (0..3).any(|axis| first[axis] >= end[axis]) {
            return;
        }
        let block = if value == T::default() { EMPTY } else { self.push(&[value; BLOCK]) };
        for z in first[2]..end[2] {
            for y in first[1]..end[1] {
                let row = index(self.count, [first[0], y, z]);
                self.bricks[row..row + (end[0] - first[0]) as usize].fill(block);
            }
        }
    }

    /// The number of a new block.
    fn push(&mut self, values: &[T; BLOCK]) -> u32 {
        let block = (self.values.len() / BLOCK) as u32;
        self.values.extend_from_slice(values);
        block
    }

    /// The value of a cell: zero outside of the grid.
    #[inline]
    pub fn value(&self, cell: [i32; 3]) -> T {
        // Negative coordinates are large ones.
        let cell = cell.map(|coordinate| coordinate as u32);
        if (0..3).any(|axis| cell[axis] >= self.size[axis]) {
            return T::default();
        }
        self.values[self.place(cell)]
    }

    /// Whether two cells are in bricks that were filled with one value together, or in the same brick; `false` outside of the grid.
    pub(crate) fn share_block(&self, cells: [[i32; 3]; 2]) -> bool {
        let cells = cells.map(|cell| cell.map(|coordinate| coordinate as u32));
        let is_inside = |cell: &[u32; 3]| (0..3).all(|axis| cell[axis] < self.size[axis]);
        let [a, b] = cells.map(|cell| is_inside(&cell).then(|| self.bricks[brick(self.count, cell)]));
        a.is_some() && a == b
    }

    /// The values of eight neighbouring cells, x fastest, of which the first has the least coordinates.
    #[inline(always)]
    pub fn corners(&self, first: [i32; 3]) -> [T; 8] {
        let [a, b, c, d, e, f, g, h] = self.places_of_corners(first);
        let of = &*self.values;
        [of[a], of[b], of[c], of[d], of[e], of[f], of[g], of[h]]
    }

    /// The places of [`Grid::corners`] in [`Grid::values`].
    #[inline(always)]
    pub fn places_of_corners(&self, first: [i32; 3]) -> [usize; 8] {
        // Negative coordinates are large ones.
        let [x, y, z] = [first[0] as u32, first[1] as u32, first[2] as u32];
        let [width, height, depth] = self.size;
        let is_within = |at: u32, cells: u32| at < cells && at % BRICK != BRICK - 1;
        if !(is_within(x, width) && is_within(y, height) && is_within(z, depth)) {
            return self.places_beyond_brick(first);
        }
        let first = self.place([x, y, z]);
        let (y, z) = (BRICK as usize, (BRICK * BRICK) as usize);
        let (top, back) = (first + y, first + z);
        let rest = back + y;
        [first, first + 1, top, top + 1, back, back + 1, rest, rest + 1]
    }

    /// [`Grid::places_of_corners`] of any cells: those outside of the grid are zeros.
    #[inline(never)]
    fn places_beyond_brick(&self, [x, y, z]: [i32; 3]) -> [usize; 8] {
        std::array::from_fn(|corner| {
            let step = |bit: usize| (corner >> bit & 1) as i32;
            let cell = [x.wrapping_add(step(0)), y.wrapping_add(step(1)), z.wrapping_add(step(2))];
            let cell = cell.map(|coordinate| coordinate as u32);
            let is_outside = (0..3).any(|axis| cell[axis] >= self.size[axis]);
            if is_outside { 0 } else { self.place(cell) }
        })
    }

    /// The place of a cell of the grid among the values.
    #[inline(always)]
    fn place(&self, cell: [u32; 3]) -> usize {
        self.bricks[brick(self.count, cell)] as usize * BLOCK + place(cell)
    }

    /// All values, with [`BLOCK`] zeros before those that are stored.
    #[inline(always)]
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// Calls a function with all cells that are stored, and their values; those that are left out are zero.
    pub fn for_each(&self, mut of: impl FnMut([u32; 3], T)) {
        self.for_each_box(|[first, last], value| {
            for z in first[2]..=last[2] {
                for y in first[1]..=last[1] {
                    (first[0]..=last[0]).for_each(|x| of([x, y, z], value));
                }
            }
        });
    }

    /// As [`Grid::for_each`], with the first and the last cell of boxes of one value: whole bricks, of which a file may fill millions at
    /// once, or single cells.
    pub fn for_each_box(&self, mut of: impl FnMut([[u32; 3]; 2], T)) {
        let blocks = self.values.as_chunks::<BLOCK>().0;
        let is_even = |block: &[T; BLOCK]| block.iter().all(|value| *value == block[0]);
        let even: Vec<bool> = blocks.iter().map(is_even).collect();
        let [width, height, _] = self.count.map(|bricks| bricks as usize);
        for (index, &block) in self.bricks.iter().enumerate().filter(|(_, block)| **block != EMPTY) {
            let first = [index % width, index / width % height, index / width / height]
                .map(|brick| brick as u32 * BRICK);
            let is_within = |cell: [u32; 3]| (0..3).all(|axis| cell[axis] < self.size[axis]);
            let (last, values) = (first.map(|first| first + BRICK - 1), &blocks[block as usize]);
            if even[block as usize] && is_within(last) {
                of([first, last], values[0]);
                continue;
            }
            for (place, &value) in (0..).zip(values) {
                let offset = [place % BRICK, place / BRICK % BRICK, place / BRICK / BRICK];
                let cell = std::array::from_fn(|axis| first[axis] + offset[axis]);
                if is_within(cell) {
                    of([cell; 2], value);
                }
            }
        }
    }

    /// Number of cells along x, y and z.
    pub fn size(&self) -> [u32; 3] {
        self.size
    }

    /// All values that are stored, in no order: those that are missing are zero.
    pub fn stored(&self) -> &[T] {
        &self.values[BLOCK..]
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.bricks) + size_of_val(&*self.values)
    }

    /// A grid of the images of its values; that of zero must be zero.
    pub fn map<U>(&self, of: impl Fn(T) -> U) -> Grid<U> {
        let values = self.values.iter().map(|value| of(*value)).collect();
        Grid { size: self.size, count: self.count, bricks: self.bricks.clone(), values }
    }
}

/// The index of the brick of a cell.
#[inline(always)]
fn brick(count: [u32; 3], cell: [u32; 3]) -> usize {
    index(count, cell.map(|coordinate| coordinate / BRICK))
}

/// The index of a brick by its coordinates.
#[inline(always)]
fn index(count: [u32; 3], brick: [u32; 3]) -> usize {
    let [x, y, z] = brick.map(|coordinate| coordinate as usize);
    x + count[0] as usize * (y + count[1] as usize * z)
}

/// The place of a cell in its block.
#[inline(always)]
fn place(cell: [u32; 3]) -> usize {
    let [x, y, z] = cell.map(|coordinate| coordinate % BRICK);
    (x + BRICK * (y + BRICK * z)) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_where_they_were_written() {
        let size = [19, 8, 13];
        let count = size.iter().product::<u32>() as usize;
        let values: Vec<f32> = (0..count).map(|index| (index as f32 * 0.37).sin()).collect();
        let grid = Grid::from_values(size, &values).unwrap();
        let at = |[x, y, z]: [i32; 3]| {
            let inside = [x, y, z].iter().zip(size).all(|(&at, cells)| (0..cells as i32).contains(&at));
            if inside { values[(x + 19 * (y + 8 * z)) as usize] } else { 0.0 }
        };
        for z in -2..15 {
            for y in -2..10 {
                for x in -2..21 {
                    assert_eq!(grid.value([x, y, z]), at([x, y, z]));
                    let corners = grid.corners([x, y, z]);
                    for (corner, value) in corners.into_iter().enumerate() {
                        let step = |bit: usize| (corner >> bit & 1) as i32;
                        assert_eq!(value, at([x + step(0), y + step(1), z + step(2)]));
                    }
                }
            }
        }
    }

    #[test]
    fn whole_bricks_are_written_and_filled() {
        let mut grid = Grid::<f32>::new([24, 16, 16]).unwrap();
        grid.fill([0, 0, 1], [9, 1, 9], 0.5);
        grid.fill([2, 0, 1], [3, 1, 2], 0.0);
        grid.set_brick([1, 0, 1], &std::array::from_fn(|index| index as f32));
        grid.set_brick([3, 0, 0], &[9.0; BLOCK]);
        grid.set_brick([1, 1, 1], &[0.0; BLOCK]);
        let expected = |[x, y, z]: [i32; 3]| match [x / 8, y / 8, z / 8] {
            [0, 0, 1] => 0.5,
            [1, 0, 1] => (x % 8 + 8 * (y % 8) + 64 * (z % 8)) as f32,
            _ => 0.0,
        };
        let mut sum = 0.0;
        for cell in (0..24 * 16 * 16).map(|index| [index % 24, index / 24 % 16, index / 24 / 16]) {
            assert_eq!(grid.value(cell), expected(cell), "{cell:?}");
            sum += expected(cell);
        }
        grid.for_each(|_, value| sum -= value);
        assert_eq!(sum, 0.0);
        // The brick that was filled, and neither emptied nor written over, is one box.
        let (mut boxes, mut cells) = (Vec::new(), 0);
        grid.for_each_box(|[first, last], value| match first == last {
            true => cells += 1,
            false => boxes.push((first, last, value)),
        });
        assert_eq!(boxes, [([0, 0, 8], [7, 7, 15], 0.5)]);
        assert_eq!(cells, BLOCK);
        assert_eq!(grid.stored().len(), 2 * BLOCK);
    }

    #[test]
    fn what_is_empty_takes_no_memory_and_what_is_too_large_is_refused() {
        let mut sparse = Grid::<f32>::new([800, 800, 800]).unwrap();
        sparse.set([500, 3, 799], 2.0);
        assert_eq!(sparse.value([500, 3, 799]), 2.0);
        assert!(sparse.bytes() < 5_000_000, "{}", sparse.bytes());
        assert!(Grid::<f32>::new([0, 1, 1]).is_none());
        assert!(Grid::<f32>::new([u32::MAX, 1, 1]).is_none());
        assert!(Grid::<f32>::new([1 << 20, 1 << 20, 1 << 20]).is_none());
        assert!(Grid::from_values([2, 2, 2], &[1.0; 7]).is_none());
        assert!(Grid::from_values([1 << 16, 1 << 16, 1], &[1.0]).is_none());
    }
}
