//! Piecewise-constant distributions, sampled in proportion to their weights.
//!
//! [`Discrete`] chooses an entry of a list, [`Piecewise2D`] a point of the unit square by the brightness of a picture
//! there, [`Windowed2D`] one of a part of it. All search running sums (inversion), which keeps near numbers near:
//! well-spread samples stay well spread.
//! What is chosen, and what it weighs, is left to lights.

mod window;

pub use window::{Window, Windowed2D};

use crate::core::sampler::ONE_MINUS_EPSILON;

/// A choice among the entries of a list, each with a probability proportional to its weight.
#[derive(Clone, Debug, PartialEq)]
pub struct Discrete {
    /// Sums of the weights before each entry, and of all.
    sums: Vec<f64>,
    guide: Vec<u32>,
}

impl Discrete {
    /// Weights that are negative or not finite count as zero. If none is positive, all entries are equally probable.
    ///
    /// # Panics
    /// If there are no weights.
    pub fn new(weights: &[f32]) -> Self {
        assert!(!weights.is_empty(), "nothing can be chosen from an empty list");
        let mut sums = Vec::with_capacity(weights.len() + 1);
        if push_sums(&mut sums, weights) == 0.0 {
            sums.clear();
            push_sums(&mut sums, &vec![1.0; weights.len()]);
        }
        let mut guide = Vec::new();
        push_guide(&mut guide, &sums);
        Self { sums, guide }
    }

    /// The entry for `u` in [0, 1), its probability (the one of [`Discrete::pdf`]), and a new number in [0, 1): where
    /// `u` lies in the entry's share, for further use. An entry of no weight is never chosen.
    #[inline]
    pub fn sample(&self, u: f32) -> (usize, f32, f32) {
        let (index, rest) = choose(&self.sums, &self.guide, u);
        (index, self.pdf(index), (rest as f32).min(ONE_MINUS_EPSILON))
    }

    /// The probability of an entry: 0 for one of no weight, or if there is none of that index.
    pub fn pdf(&self, index: usize) -> f32 {
        rounded(share(&self.sums, index))
    }
}

/// A density over the unit square that is constant in each cell of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Piecewise2D {
    width: usize,
    height: usize,
    /// Sums of the weights of whole rows.
    rows: Vec<f64>,
    row_guide: Vec<u32>,
    /// Of each row the sums of its weights: `width + 1` numbers.
    columns: Vec<f64>,
    /// Of each row the same number.
    column_guide: Vec<u32>,
}

impl Piecewise2D {
    /// `width` × `height` weights, row by row: the first cell is the one at (0, 0), the first coordinate runs along
    /// rows. Weights that are negative or not finite count as zero; if none is positive the density is uniform, as it
    /// is if there are no cells. Takes 9 to 10 bytes a cell.
    ///
    /// # Panics
    /// If there are not `width` × `height` weights.
    pub fn new(weights: &[f32], width: usize, height: usize) -> Self {
        assert_eq!(weights.len(), width * height, "weights of a grid of {width} × {height}");
        if !weights.iter().any(|&weight| usable(weight) > 0.0) {
            return Self::new(&[1.0], 1, 1);
        }
        let (mut rows, mut columns) = (vec![0.0], Vec::with_capacity((width + 1) * height));
        let mut column_guide = Vec::new();
        let mut sum = 0.0;
        for row in weights.chunks_exact(width) {
            sum += push_sums(&mut columns, row);
            push_guide(&mut column_guide, &columns[columns.len() - width - 1..]);
            rows.push(sum);
        }
        let mut row_guide = Vec::new();
        push_guide(&mut row_guide, &rows);
        Self { width, height, rows, row_guide, columns, column_guide }
    }

    /// A point for `u` in [0, 1)², and the density there, over the area of the unit square: the one of
    /// [`Piecewise2D::pdf`]. Each coordinate grows with its own. A cell of no weight is never chosen.
    pub fn sample(&self, u: [f32; 2]) -> ([f32; 2], f32) {
        let (row, v) = choose(&self.rows, &self.row_guide, u[1]);
        let stride = self.column_guide.len() / self.height;
        let guide = &self.column_guide[row * stride..(row + 1) * stride];
        let (column, u) = choose(self.row(row), guide, u[0]);
        let point = [place(column, u, self.width), place(row, v, self.height)];
        (point, self.density(column, row))
    }

    /// The density at a point, over the area of the unit square: its integral is 1. 0 outside of the square.
    pub fn pdf(&self, uv: [f32; 2]) -> f32 {
        if !uv.iter().all(|x| (0.0..=1.0).contains(x)) {
            return 0.0;
        }
        self.density(cell(uv[0], self.width), cell(uv[1], self.height))
    }

    fn density(&self, column: usize, row: usize) -> f32 {
        let probability = share(&self.rows, row) * share(self.row(row), column);
        rounded(probability * (self.width * self.height) as f64)
    }

    fn row(&self, row: usize) -> &[f64] {
        let stride = self.width + 1;
        &self.columns[row * stride..(row + 1) * stride]
    }
}

/// The weight, if it is one.
fn usable(weight: f32) -> f64 {
    if weight.is_finite() && weight > 0.0 { f64::from(weight) } else { 0.0 }
}

/// Appends 0 and the sums of the first 1, 2, … all weights; gives the last.
fn push_sums(sums: &mut Vec<f64>, weights: &[f32]) -> f64 {
    let mut sum = 0.0;
    sums.push(sum);
    for &weight in weights {
        sum += usable(weight);
        sums.push(sum);
    }
    sum
}

/// Appends where [`choose`] begins its search: for each of about a quarter as many equal parts of 0 … 1 as there are
/// entries the entry at the beginning of that part, and at last the one at the end of all.
///
/// (Chen & Asau 1974: with the guide, a search takes a step or two, whatever the number of entries.)
fn push_guide(guide: &mut Vec<u32>, sums: &[f64]) {
    let total = sums[sums.len() - 1];
    // A power of two: the ends of its parts are exact, so that no rounding leads past the goal.
    let parts = (sums.len() / 4).next_power_of_two().min(1 << 20);
    let mut entry = 0;
    for part in 0..parts {
        let goal = part as f64 / parts as f64 * total;
        while entry + 2 < sums.len() && sums[entry + 1] <= goal {
            entry += 1;
        }
        guide.push(entry as u32);
    }
    guide.push(sums[1..].partition_point(|&end| end < total) as u32);
}

/// The entry in whose share `u` lies, and where in it (0 … 1). `sums` must end in more than 0.
#[inline]
fn choose(sums: &[f64], guide: &[u32], u: f32) -> (usize, f64) {
    let u = u.clamp(0.0, ONE_MINUS_EPSILON);
    let goal = f64::from(u) * sums[sums.len() - 1];
    let part = (u * (guide.len() - 1) as f32) as usize;
    let [from, to] = [guide[part] as usize, guide[part + 1] as usize];
    // The first entry that ends beyond the goal has a width.
    let index = from + sums[from + 1..to + 1].partition_point(|&end| end <= goal);
    (index, (goal - sums[index]) / (sums[index + 1] - sums[index]))
}

/// The probability of an entry; 0 beyond the end, and where there is nothing to choose.
fn share(sums: &[f64], index: usize) -> f64 {
    let total = sums[sums.len() - 1];
    if index + 1 < sums.len() && total > 0.0 { (sums[index + 1] - sums[index]) / total } else { 0.0 }
}

/// As f32, where what is possible stays possible: a density that is divided by must not become 0.
fn rounded(probability: f64) -> f32 {
    if probability > 0.0 { (probability as f32).max(f32::MIN_POSITIVE) } else { 0.0 }
}

/// In which of `cells` equal parts of 0 … 1 a number lies.
fn cell(x: f32, cells: usize) -> usize {
    ((f64::from(x) * cells as f64) as usize).min(cells - 1)
}

/// The number in [0, 1) that lies at `rest` (0 … 1) of a part. It is in that part after rounding too.
fn place(index: usize, rest: f64, cells: usize) -> f32 {
    let x = ((index as f64 + rest) / cells as f64) as f32;
    let x = x.min(ONE_MINUS_EPSILON);
    match cell(x, cells).cmp(&index) {
        std::cmp::Ordering::Less => x.next_up(),
        std::cmp::Ordering::Equal => x,
        std::cmp::Ordering::Greater => x.next_down(),
    }
}

#[cfg(test)]
mod tests;
