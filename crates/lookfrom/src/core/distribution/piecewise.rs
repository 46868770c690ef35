//! Piecewise-constant distributions over the unit square, in fixed point.
//!
//! Cumulative sums are integers: the density that a cell has is exactly the one that it is sampled with, a search compares
//! integers, and a cell takes five bytes, since such tables are as large as environment maps and are read at random.

use super::{cell, place, usable};
use crate::core::lanes::{LANES, by_lane};

/// A density over the unit square that is constant in each cell of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Piecewise2D {
    width: usize,
    height: usize,
    /// Rows, by the sums of their weights.
    rows: Vec<u32>,
    row_guide: Vec<u32>,
    /// The cells of each row by their weights: `width + 1` numbers per row.
    columns: Vec<u32>,
    /// Guide tables of all rows, of equal length.
    column_guide: Vec<u32>,
    /// The density in a cell of each row per unit of its probability within the row.
    per_unit: Vec<f32>,
}

/// The probabilities of a cell, of which its density follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// The probability of its row.
    pub row: f64,
    /// The probability of the cell, within its row.
    pub column: f64,
}

/// The probability 1 in fixed point.
const ONE: u32 = 1 << 31;

impl Piecewise2D {
    /// `width` × `height` weights, row by row: the first cell is the one at (0, 0), the first coordinate runs along
    /// rows. Weights that are negative or not finite count as zero; if none is positive or there are no cells, the
    /// density is uniform. The probability of a cell in its row, and that of a row, is at least 2⁻³¹ where a weight is
    /// positive. Takes 5 bytes per cell.
    ///
    /// # Panics
    /// If there are not `width` × `height` weights, or 2³¹ in a row or column.
    pub fn new(weights: &[f32], width: usize, height: usize) -> Self {
        assert_eq!(weights.len(), width * height, "weights of a grid of {width} × {height}");
        if !weights.iter().any(|&weight| usable(weight) > 0.0) {
            return Self::new(&[1.0], 1, 1);
        }
        assert!(width.max(height) < ONE as usize, "a grid of {width} × {height}");
        let mut columns = Vec::with_capacity((width + 1) * height);
        let mut column_guide = Vec::new();
        let mut sums = Vec::with_capacity(height);
        for row in weights.chunks_exact(width) {
            sums.push(row.iter().map(|&weight| usable(weight)).sum());
            push_sums(&mut columns, row.iter().map(|&weight| usable(weight)));
            push_guide(&mut column_guide, &columns[columns.len() - width - 1..]);
        }
        let (mut rows, mut row_guide) = (Vec::with_capacity(height + 1), Vec::new());
        push_sums(&mut rows, sums.into_iter());
        push_guide(&mut row_guide, &rows);
        let unit = (width * height) as f64 / (f64::from(ONE) * f64::from(ONE));
        let per_unit = rows.windows(2).map(|ends| (f64::from(ends[1] - ends[0]) * unit) as f32).collect();
        Self { width, height, rows, row_guide, columns, column_guide, per_unit }
    }

    /// A point for `u` in [0, 1)², and its density over the area of the unit square (equal to
    /// [`Piecewise2D::pdf`]). Each coordinate is monotonic in its coordinate of `u`. A cell of weight
    /// 0 is never sampled.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> ([f32; 2], f32) {
        let (row, v, _) = choose(&self.rows, &self.row_guide, u[1]);
        let (column, u, share) = choose(self.row(row), self.guide_of(row), u[0]);
        (self.point([column, row], [u, v]), share as f32 * self.per_unit[row])
    }

    /// [`Piecewise2D::sample`] in each lane. The tables of large maps are not in the caches, so each of them is read for all lanes
    /// before the next one: the waits overlap.
    #[inline(always)]
    pub(crate) fn sample_lanes(&self, [u, v]: [[f32; LANES]; 2]) -> ([[f32; 2]; LANES], [f32; LANES]) {
        let rows = by_lane!(lane => choose(&self.rows, &self.row_guide, v[lane]));
        let ranges = by_lane!(lane => range(self.guide_of(rows[lane].0), goal(u[lane])));
        let columns = by_lane!(lane => entry(self.row(rows[lane].0), ranges[lane], goal(u[lane])));
        let points = by_lane!(lane =>
            self.point([columns[lane].0, rows[lane].0], [columns[lane].1, rows[lane].1]));
        (points, by_lane!(lane => columns[lane].2 as f32 * self.per_unit[rows[lane].0]))
    }

    /// The point at a position (0 … 1) in a cell.
    #[inline]
    fn point(&self, [column, row]: [usize; 2], [u, v]: [f64; 2]) -> [f32; 2] {
        [place(column, u, self.width), place(row, v, self.height)]
    }

    /// The density at a point, over the area of the unit square: its integral is 1. 0 outside of the square.
    #[inline]
    pub fn pdf(&self, uv: [f32; 2]) -> f32 {
        self.cell_at(uv).map_or(0.0, |cell| self.density(cell))
    }

    /// [`Piecewise2D::pdf`] in the lanes of a mask, 0 in others. All cells are found before the tables are read, as in
    /// [`Piecewise2D::sample_lanes`].
    #[inline(always)]
    pub(crate) fn pdf_lanes(&self, uv: &[[f32; 2]; LANES], mask: u32) -> [f32; LANES] {
        let cells = by_lane!(lane => self.cell_at(uv[lane]).filter(|_| mask & 1 << lane != 0));
        by_lane!(lane => cells[lane].map_or(0.0, |cell| self.density(cell)))
    }

    /// Column and row of the cell at a point, if it is in the square.
    #[inline(always)]
    fn cell_at(&self, [u, v]: [f32; 2]) -> Option<[usize; 2]> {
        let is_within = (0.0..=1.0).contains(&u) & (0.0..=1.0).contains(&v);
        is_within.then(|| [cell(u, self.width), cell(v, self.height)])
    }

    #[inline(always)]
    fn density(&self, [column, row]: [usize; 2]) -> f32 {
        let ends = &self.row(row)[column..column + 2];
        (ends[1] - ends[0]) as f32 * self.per_unit[row]
    }

    /// Its columns and rows.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// The probabilities of a cell.
    ///
    /// # Panics
    /// If it is not in the grid.
    pub fn cell(&self, [column, row]: [usize; 2]) -> Cell {
        let share = |sums: &[u32], index: usize| f64::from(sums[index + 1] - sums[index]) / f64::from(ONE);
        Cell { row: share(&self.rows, row), column: share(self.row(row), column) }
    }

    #[inline]
    fn guide_of(&self, row: usize) -> &[u32] {
        let stride = self.column_guide.len() / self.height;
        &self.column_guide[row * stride..(row + 1) * stride]
    }

    #[inline]
    fn row(&self, row: usize) -> &[u32] {
        let stride = self.width + 1;
        &self.columns[row * stride..(row + 1) * stride]
    }
}

/// Appends 0 and the cumulative probabilities of weights, which are finite and not negative; 0 throughout where none is
/// positive.
fn push_sums(sums: &mut Vec<u32>, weights: impl Iterator<Item = f64> + Clone) {
    let total: f64 = weights.clone().sum();
    let positive = weights.clone().filter(|&weight| weight > 0.0).count();
    // Each positive weight gets one unit, and all share the rest: none vanishes by rounding.
    let scale = if total > 0.0 { (ONE as usize - positive) as f64 / total } else { 0.0 };
    let (mut sum, mut before, mut left) = (0.0, 0_u32, positive);
    sums.push(0);
    for weight in weights {
        sum += weight;
        if weight > 0.0 {
            before += 1;
            left -= 1;
        }
        let is_last = left == 0 && positive > 0;
        sums.push(if is_last { ONE } else { (sum * scale) as u32 + before });
    }
}

/// Appends a guide table for [`choose`]: 0 … 1 is divided into about a quarter as many equal intervals as there are
/// entries, and each interval stores the entry at its beginning; the last number is the entry at the end.
///
/// (Chen & Asau 1974: with the guide table, a search takes one or two steps, whatever the number of entries.)
fn push_guide(guide: &mut Vec<u32>, sums: &[u32]) {
    let parts = (sums.len() / 4).next_power_of_two().min(1 << 20) as u32;
    let mut entry = 0;
    for part in 0..parts {
        let goal = part * (ONE / parts);
        while entry + 2 < sums.len() && sums[entry + 1] <= goal {
            entry += 1;
        }
        guide.push(entry as u32);
    }
    guide.push(sums[1..].partition_point(|&end| end < ONE).min(sums.len() - 2) as u32);
}

/// The entry whose interval contains `u`, the position in it (0 … 1), and its probability. `sums` must end in 1.
#[inline]
fn choose(sums: &[u32], guide: &[u32], u: f32) -> (usize, f64, u32) {
    entry(sums, range(guide, goal(u)), goal(u))
}

/// A number of 0 … 1 in fixed point, below 1.
#[inline]
fn goal(u: f32) -> u32 {
    ((u.max(0.0) * ONE as f32) as u32).min(ONE - 1)
}

/// The first and the last entry that may contain a goal, by the guide table.
#[inline]
fn range(guide: &[u32], goal: u32) -> [usize; 2] {
    // In 64 bits, since the product is too large for the indices of 32-bit machines.
    let part = (u64::from(goal) * (guide.len() as u64 - 1) / u64::from(ONE)) as usize;
    [guide[part] as usize, guide[part + 1] as usize]
}

/// The entry of a range that contains a goal, the position in it (0 … 1), and its probability.
#[inline]
fn entry(sums: &[u32], [from, to]: [usize; 2], goal: u32) -> (usize, f64, u32) {
    // The first entry that ends beyond the goal has positive width.
    let index = from + sums[from + 1..to + 1].partition_point(|&end| end <= goal);
    let share = sums[index + 1] - sums[index];
    (index, f64::from(goal - sums[index]) / f64::from(share), share)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::hash;

    #[test]
    fn densities_are_those_of_the_weights() {
        for round in 0..300 {
            let (width, height) = (1 + round as usize % 37, 1 + round as usize % 11);
            let weights: Vec<f32> = (0..(width * height) as u64)
                .map(|k| (hash::pair(round, k) >> 40) as f32 / 65_536.0 - 30.0)
                .collect();
            let sum: f64 = weights.iter().map(|&weight| usable(weight)).sum();
            let grid = Piecewise2D::new(&weights, width, height);
            for (index, &weight) in weights.iter().enumerate().filter(|_| sum > 0.0) {
                let uv = [(index % width) as f32 + 0.5, (index / width) as f32 + 0.5];
                let density = f64::from(grid.pdf([uv[0] / width as f32, uv[1] / height as f32]));
                let expected = usable(weight) / sum * (width * height) as f64;
                assert!((density - expected).abs() <= 1e-5 * expected + 1e-7, "{density} for {expected}");
                assert_eq!(density > 0.0, weight > 0.0);
            }
        }
    }

    #[test]
    fn choosing_agrees_with_walking_along() {
        for round in 0..2000 {
            let count = 1 + hash::pair(round, 0) as usize % 300;
            let weights = (1..=count as u64).map(|k| match hash::pair(round, k) % 4 {
                0 => 0.0,
                exponent => libm::exp2(10.0 * exponent as f64),
            });
            let (mut sums, mut guide) = (Vec::new(), Vec::new());
            push_sums(&mut sums, weights.clone());
            push_guide(&mut guide, &sums);
            if weights.clone().sum::<f64>() == 0.0 {
                assert!(sums.iter().all(|&sum| sum == 0));
                continue;
            }
            assert_eq!(sums.last(), Some(&ONE));
            for trial in 0..20 {
                let u = (hash::pair(round, 1000 + trial) >> 40) as f32 / 16_777_216.0;
                let (index, rest, share) = choose(&sums, &guide, u);
                let walked = (0..count).find(|&k| f64::from(sums[k + 1]) > f64::from(u) * f64::from(ONE));
                assert_eq!(Some(index), walked);
                let back = (f64::from(sums[index]) + rest * f64::from(share)) / f64::from(ONE);
                assert!(weights.clone().nth(index) > Some(0.0) && (back - f64::from(u)).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn all_lanes_are_each_on_its_own() {
        for round in 0..200 {
            let (width, height) = (1 + round as usize % 61, 1 + round as usize % 23);
            let weights: Vec<f32> = (0..(width * height) as u64)
                .map(|k| libm::exp2f((hash::pair(round, k) % 60) as f32 - 30.0))
                .collect();
            let grid = Piecewise2D::new(&weights, width, height);
            let number = |axis: u64, lane: usize| {
                (hash::pair(1000 * round + lane as u64, axis) >> 40) as f32 / 16_777_216.0
            };
            let u = [0, 1].map(|axis| std::array::from_fn(|lane| number(axis, lane)));
            let (points, densities) = grid.sample_lanes(u);
            for lane in 0..LANES {
                assert_eq!((points[lane], densities[lane]), grid.sample([u[0][lane], u[1][lane]]));
            }
            let places = by_lane!(lane => [2.0 * u[0][lane] - 0.25, u[1][lane]]);
            let densities = grid.pdf_lanes(&places, 0xf5);
            for (lane, place) in places.into_iter().enumerate() {
                assert_eq!(densities[lane], if 0xf5 & 1 << lane != 0 { grid.pdf(place) } else { 0.0 });
            }
        }
    }
}
