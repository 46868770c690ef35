//! Windowed piecewise-constant distributions: sampling an image within a rectangle that differs for each query.
//!
//! A summed-area table (Crow 1984) gives the sum over any rectangle by four numbers; columns and then rows are
//! sampled by bisection (Bitterli, Novák & Jarosz 2015, for portals). The choice of windows is left to lights. All
//! sums are in f64: a window may be a small part of an image with a sun elsewhere in it.

use super::{rounded, usable};

/// A density that is constant in each cell of a grid over the unit square, within windows of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Windowed2D {
    width: usize,
    height: usize,
    /// Weights, row by row.
    weights: Vec<f32>,
    /// The summed-area table of (`width` + 1) × (`height` + 1) numbers: at column c and row r the sum of the
    /// weights left of c and above r.
    sums: Vec<f64>,
}

/// A rectangle in the unit square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Smallest coordinates.
    pub min: [f64; 2],
    /// Largest coordinates.
    pub max: [f64; 2],
}

impl Window {
    /// The whole square.
    pub const WHOLE: Self = Self { min: [0.0; 2], max: [1.0; 2] };

    /// True if a point lies inside or on the border.
    pub fn contains(&self, point: [f64; 2]) -> bool {
        (0..2).all(|axis| self.min[axis] <= point[axis] && point[axis] <= self.max[axis])
    }
}

impl Windowed2D {
    /// `width` × `height` weights, row by row, as for [`Piecewise2D`](super::Piecewise2D), except that nothing can
    /// be sampled if none is positive. Takes 12 bytes per cell.
    ///
    /// # Panics
    /// If there are not `width` × `height` weights, or none.
    pub fn new(mut weights: Vec<f32>, width: usize, height: usize) -> Self {
        assert_eq!(weights.len(), width * height, "weights of a grid of {width} × {height}");
        assert!(!weights.is_empty(), "nothing can be chosen from an empty grid");
        let mut sums = vec![0.0; width + 1];
        sums.reserve_exact((width + 1) * height);
        for row in weights.chunks_exact_mut(width) {
            let above = sums.len() - (width + 1);
            let mut sum = 0.0;
            sums.push(0.0);
            for (column, weight) in row.iter_mut().enumerate() {
                let used = usable(*weight);
                *weight = used as f32;
                sum += used;
                sums.push(sums[above + column + 1] + sum);
            }
        }
        Self { width, height, weights, sums }
    }

    /// A point of a window for `u` in [0, 1)², and its density over the area of the square (equal to
    /// [`Windowed2D::pdf`]). `None` if the window has no weight. Each coordinate is monotonic in its coordinate
    /// of `u`.
    pub fn sample(&self, window: &Window, u: [f32; 2]) -> Option<([f64; 2], f32)> {
        let total = self.total(window);
        let [x, y] = self.in_cells(window);
        let (column, x) = choose(|column| self.above(column, y), self.width, x, u[0])?;
        let of_column = |row| self.sum(column + 1, row) - self.sum(column, row);
        let (row, y) = choose(of_column, self.height, y, u[1])?;
        let pdf = self.density(column, row, total);
        (pdf > 0.0).then(|| ([place(column, x, self.width), place(row, y, self.height)], pdf))
    }

    /// The density at a point over the area of the square: 0 outside of the window, with an integral of 1 over it.
    pub fn pdf(&self, window: &Window, point: [f64; 2]) -> f32 {
        if !window.contains(point) {
            return 0.0;
        }
        self.density(cell(point[0], self.width), cell(point[1], self.height), self.total(window))
    }

    fn density(&self, column: usize, row: usize, total: f64) -> f32 {
        if total <= 0.0 {
            return 0.0;
        }
        let weight = f64::from(self.weights[row * self.width + column]);
        rounded(weight / total * (self.width * self.height) as f64)
    }

    /// Its columns and rows.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// The weight of a cell.
    ///
    /// # Panics
    /// If it is not in the grid.
    pub fn weight(&self, [column, row]: [usize; 2]) -> f64 {
        f64::from(self.weights[row * self.width + column])
    }

    /// The sum of the weights in a window; cells on its border count by the covered fraction.
    pub fn total(&self, window: &Window) -> f64 {
        let [[left, right], y] = self.in_cells(window);
        let until = |x| between(|column| self.above(column, y), self.width, x);
        until(right) - until(left)
    }

    /// Beginning and end of a window along both axes, in cells.
    fn in_cells(&self, window: &Window) -> [[f64; 2]; 2] {
        let size = [self.width, self.height];
        std::array::from_fn(|axis| {
            [window.min[axis], window.max[axis]].map(|x| x.clamp(0.0, 1.0) * size[axis] as f64)
        })
    }

    /// The sum of the weights left of a column between two heights.
    fn above(&self, column: usize, [top, bottom]: [f64; 2]) -> f64 {
        let until = |y| between(|row| self.sum(column, row), self.height, y);
        until(bottom) - until(top)
    }

    fn sum(&self, column: usize, row: usize) -> f64 {
        self.sums[row * (self.width + 1) + column]
    }
}

/// Cumulative sums interpolated linearly within a cell.
fn between(sums: impl Fn(usize) -> f64, cells: usize, x: f64) -> f64 {
    let cell = (x as usize).min(cells - 1);
    let (low, high) = (sums(cell), sums(cell + 1));
    low + (x - cell as f64) * (high - low)
}

/// The cell whose interval of the sums from `begin` to `end` contains the number `u`, and the position there, in
/// cells.
fn choose(sums: impl Fn(usize) -> f64, cells: usize, [begin, end]: [f64; 2], u: f32) -> Option<(usize, f64)> {
    let (low, high) = (between(&sums, cells, begin), between(&sums, cells, end));
    let goal = low + f64::from(u) * (high - low);
    // Find the first cell that ends beyond the goal.
    let mut first = (begin as usize).min(cells - 1);
    let mut last = (end.ceil() as usize).clamp(first + 1, cells) - 1;
    while first < last {
        let middle = first.midpoint(last);
        if sums(middle + 1) > goal {
            last = middle;
        } else {
            first = middle + 1;
        }
    }
    // Within a cell the sums are linear.
    let (left, right) = (begin.max(first as f64), end.min((first + 1) as f64));
    let (low, high) = (between(&sums, cells, left), between(&sums, cells, right));
    (high > low).then(|| (first, left + ((goal - low) / (high - low)).clamp(0.0, 1.0) * (right - left)))
}

fn cell(x: f64, cells: usize) -> usize {
    ((x * cells as f64) as usize).min(cells - 1)
}

/// The number in [0, 1] at a position counted in cells. It is in the cell `index` after rounding too.
fn place(index: usize, x: f64, cells: usize) -> f64 {
    let x = x / cells as f64;
    match cell(x, cells).cmp(&index) {
        std::cmp::Ordering::Less => x.next_up(),
        std::cmp::Ordering::Equal => x,
        std::cmp::Ordering::Greater => x.next_down(),
    }
}
