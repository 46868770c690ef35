//! Densities on the unit square, bilinear between the numbers of tables and linear between the tables of parameters, with their inverses: the
//! `Marginal2D` of Dupuy & Jakob 2018 (supplement), as in pbrt-v4.

use lookfrom_scene::measured::Table;

/// Below this relative difference two ends of a linear density count as equal.
const ALIKE: f32 = 1e-4;

/// Tables for each combination of `N` parameters.
#[derive(Debug)]
pub(super) struct Interpolant<const N: usize> {
    /// Columns and rows of each table.
    size: [usize; 2],
    parameters: [Vec<f32>; N],
    values: Vec<f32>,
    cumulative: Option<Cumulative>,
}

/// Sums of the trapezoids of each row up to each number, and of all rows up to each.
#[derive(Debug)]
struct Cumulative {
    within_rows: Vec<f32>,
    of_rows: Vec<f32>,
}

/// The most tables that are beside the values of parameters, of which there are three at most.
const CORNERS: usize = 8;

/// The tables beside the values of parameters, with their weights, which are not 0.
pub(super) struct Between<const N: usize> {
    tables: [(usize, f32); CORNERS],
    count: usize,
}

impl<const N: usize> Between<N> {
    /// The tables from one on; `steps` are for each parameter the number of tables to the next of its values, and the weight of that.
    #[inline]
    fn new(first: usize, steps: [(usize, f32); N]) -> Self {
        const { assert!(1 << N <= CORNERS) };
        let mut between = Self { tables: [(0, 0.0); CORNERS], count: 0 };
        for corner in 0..1_usize << N {
            let (mut table, mut weight) = (first, 1.0);
            for (k, &(step, above)) in steps.iter().enumerate() {
                let is_above = corner >> k & 1 == 1;
                table += if is_above { step } else { 0 };
                weight *= if is_above { above } else { 1.0 - above };
            }
            if weight != 0.0 {
                between.tables[between.count] = (table, weight);
                between.count += 1;
            }
        }
        between
    }

    /// The sum of the numbers that a place has in the tables, by their weights. `apart` is the distance of tables.
    #[inline]
    fn sum(&self, of: &[f32], place: usize, apart: usize) -> f32 {
        self.tables[..self.count].iter().map(|&(table, weight)| weight * of[table * apart + place]).sum()
    }
}

impl<const N: usize> Interpolant<N> {
    /// Values as they are in tables.
    pub(super) fn plain(table: &Table, parameters: [&[f32]; N]) -> Self {
        Self {
            size: table.size,
            parameters: parameters.map(<[f32]>::to_vec),
            values: table.values.clone(),
            cumulative: None,
        }
    }

    /// A density for each combination of parameters: each table is divided by its integral.
    pub(super) fn density(table: &Table, parameters: [&[f32]; N]) -> Self {
        let [columns, rows] = table.size;
        let mut values = table.values.clone();
        let (mut within_rows, mut of_rows) = (Vec::new(), Vec::new());
        for values in values.chunks_mut(columns * rows) {
            let (start, first) = (within_rows.len(), of_rows.len());
            for row in values.chunks(columns) {
                let mut sum = 0.0;
                within_rows.push(0.0);
                for pair in row.windows(2) {
                    sum += 0.5 * (f64::from(pair[0]) + f64::from(pair[1]));
                    within_rows.push(sum as f32);
                }
            }
            let mut sum = 0.0;
            of_rows.push(0.0);
            for row in 1..rows {
                let end = |row: usize| f64::from(within_rows[start + row * columns + columns - 1]);
                sum += 0.5 * (end(row - 1) + end(row));
                of_rows.push(sum as f32);
            }
            let factor = if sum > 0.0 { (1.0 / sum) as f32 } else { 0.0 };
            values.iter_mut().for_each(|value| *value *= factor);
            within_rows[start..].iter_mut().for_each(|value| *value *= factor);
            of_rows[first..].iter_mut().for_each(|value| *value *= factor);
        }
        let parameters = parameters.map(<[f32]>::to_vec);
        Self { size: table.size, parameters, values, cumulative: Some(Cumulative { within_rows, of_rows }) }
    }

    /// The tables beside parameters.
    pub(super) fn between(&self, parameters: [f32; N]) -> Between<N> {
        let (mut first, mut steps) = (0, [(0, 0.0); N]);
        let mut apart = 1;
        for k in (0..N).rev() {
            let (known, wanted) = (&self.parameters[k], parameters[k]);
            if known.len() > 1 {
                let index = known.partition_point(|&value| value <= wanted).clamp(1, known.len() - 1) - 1;
                let share = (wanted - known[index]) / (known[index + 1] - known[index]);
                first += apart * index;
                steps[k] = (apart, share.clamp(0.0, 1.0));
            }
            apart *= known.len();
        }
        Between::new(first, steps)
    }

    /// Number of numbers in a table.
    fn area(&self) -> usize {
        self.size[0] * self.size[1]
    }

    /// The cell of a place, and where in it the place is.
    fn cell(&self, place: [f32; 2]) -> ([usize; 2], [f32; 2]) {
        let [columns, rows] = self.size;
        let along = |x: f32, count: usize| {
            let scaled = x.clamp(0.0, 1.0) * (count - 1) as f32;
            let cell = (scaled as usize).min(count - 2);
            (cell, scaled - cell as f32)
        };
        let ((column, x), (row, y)) = (along(place[0], columns), along(place[1], rows));
        ([column, row], [x, y])
    }

    /// The means of the two rows of a cell, at its left and at its right side.
    fn sides(&self, between: &Between<N>, [column, row]: [usize; 2], y: f32) -> [f32; 2] {
        let place = column + row * self.size[0];
        let value = |step: usize| between.sum(&self.values, place + step, self.area());
        let (above, columns) = (1.0 - y, self.size[0]);
        [above * value(0) + y * value(columns), above * value(1) + y * value(columns + 1)]
    }

    /// The value at a place of the unit square: of [`Self::plain`] tables.
    pub(super) fn value(&self, place: [f32; 2], between: &Between<N>) -> f32 {
        let (cell, [x, y]) = self.cell(place);
        let [left, right] = self.sides(between, cell, y);
        (1.0 - x) * left + x * right
    }

    /// The density of a cell's numbers over the unit square.
    fn density_of(&self, number: f32) -> f32 {
        number * (self.size[0] - 1) as f32 * (self.size[1] - 1) as f32
    }

    /// The density at a place of the unit square.
    pub(super) fn pdf(&self, place: [f32; 2], between: &Between<N>) -> f32 {
        self.density_of(self.value(place, between))
    }

    /// The sum of a row up to a column, and of the next row, at y between them.
    fn within(&self, sums: &[f32], between: &Between<N>, [column, row]: [usize; 2], y: f32) -> f32 {
        let place = row * self.size[0] + column;
        let [first, next] = [place, place + self.size[0]].map(|place| between.sum(sums, place, self.area()));
        (1.0 - y) * first + y * next
    }

    /// A place of the unit square by two numbers in 0 … 1, and its density. `None` where there is nothing.
    pub(super) fn sample(&self, [u, v]: [f32; 2], between: &Between<N>) -> Option<([f32; 2], f32)> {
        let sums = self.cumulative.as_ref()?;
        let [columns, rows] = self.size;

        // Choose a row, and a place in it.
        let below = |row: usize| between.sum(&sums.of_rows, row, rows);
        let row = last(rows, |row| below(row) < v);
        let ends = [row, row + 1]
            .map(|row| between.sum(&sums.within_rows, row * columns + columns - 1, self.area()));
        let y = along(ends, v - below(row));

        // Choose a column, and a place in it.
        let u = u * ((1.0 - y) * ends[0] + y * ends[1]);
        let before = |column: usize| self.within(&sums.within_rows, between, [column, row], y);
        let column = last(columns, |column| before(column) < u);
        let sides = self.sides(between, [column, row], y);
        let x = along(sides, u - before(column));
        let pdf = self.density_of((1.0 - x) * sides[0] + x * sides[1]);
        let place = [(column as f32 + x) / (columns - 1) as f32, (row as f32 + y) / (rows - 1) as f32];
        (pdf > 0.0).then_some((place, pdf))
    }

    /// The numbers by which [`Self::sample`] chooses a place, and its density.
    pub(super) fn invert(&self, place: [f32; 2], between: &Between<N>) -> ([f32; 2], f32) {
        let Some(sums) = &self.cumulative else { return (place, 0.0) };
        let ([column, row], [x, y]) = self.cell(place);
        let [left, right] = self.sides(between, [column, row], y);
        let pdf = self.density_of((1.0 - x) * left + x * right);
        let columns = self.size[0];
        let ends = [row, row + 1]
            .map(|row| between.sum(&sums.within_rows, row * columns + columns - 1, self.area()));
        let of_row = (1.0 - y) * ends[0] + y * ends[1];
        let along =
            self.within(&sums.within_rows, between, [column, row], y) + x * (left + 0.5 * x * (right - left));
        let u = if of_row > 0.0 { along / of_row } else { 0.0 };
        let below = between.sum(&sums.of_rows, row, self.size[1]);
        let v = below + y * (ends[0] + 0.5 * y * (ends[1] - ends[0]));
        ([u, v], pdf)
    }
}

/// The last of `count` − 1 intervals that begins where this is true.
fn last(count: usize, begins: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (0, count - 1);
    while high - low > 1 {
        let middle = (low + high) / 2;
        if begins(middle) { low = middle } else { high = middle }
    }
    low
}

/// The place 0 … 1 below which a linear density with these ends has a sum.
fn along([start, end]: [f32; 2], sum: f32) -> f32 {
    let place = if (start - end).abs() < ALIKE * (start + end) {
        2.0 * sum / (start + end)
    } else {
        (start - (start * start - 2.0 * sum * (start - end)).max(0.0).sqrt()) / (start - end)
    };
    if place.is_finite() { place.clamp(0.0, 1.0) } else { 0.0 }
}
