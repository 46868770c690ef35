//! Bounds of a medium's density by the cells of a coarse grid, and the way of a ray through them.
//!
//! Cells are walked by their next faces along each axis (Amanatides & Woo 1987).

use glam::{UVec3, Vec3};

use super::grid::PlacedGrid;

/// Largest densities in the cells of a grid over the box that a medium is in.
#[derive(Clone, Debug)]
pub(super) struct Majorants {
    bounds: [Vec3; 2],
    size: [u32; 3],
    /// By cells, x fastest.
    values: Vec<f32>,
}

/// A part of a ray in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Segment {
    /// Distance of its end.
    pub(super) end: f32,
    /// The bound of the density on it.
    pub(super) most: f32,
}

/// Most cells along an axis.
const MOST_CELLS: u32 = 32;

impl Majorants {
    /// Bounds by height, from cells that are as wide as the box.
    pub(super) fn of_layers(bounds: [Vec3; 2], layers: u32, most: impl Fn(f32, f32) -> f32) -> Self {
        let height = |layer: u32| bounds[0].y + (bounds[1].y - bounds[0].y) * (layer as f32 / layers as f32);
        let values = (0..layers).map(|layer| most(height(layer), height(layer + 1))).collect();
        Self { bounds, size: [1, layers, 1], values }
    }

    /// The bounds of the values of a grid, which must not be negative, by their measure.
    pub(super) fn of_grid<T: Copy + Default + PartialEq>(
        bounds: [Vec3; 2],
        placed: &PlacedGrid<T>,
        measure: impl Fn(T) -> f32,
    ) -> Self {
        // Finer cells have fewer values beside their own.
        let size = placed.grid.size().map(|cells| (2 * cells).min(MOST_CELLS));
        let mut majorants = Self { bounds, size, values: vec![0.0; size.iter().product::<u32>() as usize] };
        // Each value reaches to the centres beside its own, and a little farther by rounding.
        const REACH: f32 = 1.0 + 1.0 / 256.0;
        let reached = |axis: usize| -> Vec<[u32; 2]> {
            let cell = |at: f32| majorants.cell(axis, placed.of_cell(axis, at));
            let centres = 0..placed.grid.size()[axis];
            centres.map(|centre| [cell(centre as f32 - REACH), cell(centre as f32 + REACH)]).collect()
        };
        let reached = [reached(0), reached(1), reached(2)];
        placed.grid.for_each(|at, value| {
            let measure = measure(value);
            let [x, y, z] = [0, 1, 2].map(|axis| reached[axis][at[axis] as usize]);
            for z in z[0]..=z[1] {
                for y in y[0]..=y[1] {
                    for x in x[0]..=x[1] {
                        let bound = &mut majorants.values[index(size, UVec3::new(x, y, z))];
                        *bound = bound.max(measure);
                    }
                }
            }
        });
        majorants
    }

    /// The sums of these bounds and others, of the same cells.
    pub(super) fn plus(mut self, others: &Self) -> Self {
        self.values.iter_mut().zip(&others.values).for_each(|(bound, other)| *bound += other);
        self
    }

    /// Multiplies all bounds.
    #[cfg(test)]
    pub(super) fn multiply(&mut self, factor: f32) {
        self.values.iter_mut().for_each(|bound| *bound *= factor);
    }

    /// These bounds plus 1.
    pub(super) fn plus_one(mut self) -> Self {
        self.values.iter_mut().for_each(|bound| *bound += 1.0);
        self
    }

    /// The cell at a coordinate along an axis.
    fn cell(&self, axis: usize, at: f32) -> u32 {
        let [low, high] = self.bounds.map(|corner| corner[axis]);
        let place = (at - low) / (high - low) * self.size[axis] as f32;
        (place as u32).min(self.size[axis] - 1)
    }

    /// The way of a ray through the box, up to a distance; `None` where it does not meet it. The direction need not be of unit length.
    pub(super) fn walk(&self, origin: Vec3, direction: Vec3, limit: f32) -> Option<Walk<'_>> {
        // Clip the ray by the box.
        let (mut start, mut end) = (0.0_f32, limit);
        for axis in 0..3 {
            let [a, b] = self.bounds.map(|corner| (corner[axis] - origin[axis]) / direction[axis]);
            if direction[axis] == 0.0 {
                let is_beside = origin[axis] < self.bounds[0][axis] || origin[axis] > self.bounds[1][axis];
                end = if is_beside { f32::NEG_INFINITY } else { end };
            } else {
                (start, end) = (start.max(a.min(b)), end.min(a.max(b)));
            }
        }
        if !(start < end) {
            return None;
        }
        // Find its first cell, and where it leaves that along each axis.
        let at = origin + direction * start;
        let width = (self.bounds[1] - self.bounds[0]) / UVec3::from_array(self.size).as_vec3();
        let mut walk = Walk {
            majorants: self,
            start,
            t: start,
            end,
            cell: UVec3::ZERO,
            next: Vec3::INFINITY,
            step: Vec3::ZERO,
            is_down: [false; 3],
        };
        for axis in 0..3 {
            let cell = self.cell(axis, at[axis]);
            walk.cell[axis] = cell;
            walk.is_down[axis] = direction[axis] < 0.0;
            if direction[axis] != 0.0 {
                let face =
                    self.bounds[0][axis] + width[axis] * (cell + u32::from(!walk.is_down[axis])) as f32;
                walk.next[axis] = (face - origin[axis]) / direction[axis];
                walk.step[axis] = width[axis] / direction[axis].abs();
            }
        }
        Some(walk)
    }
}

fn index(size: [u32; 3], cell: UVec3) -> usize {
    (cell.x + size[0] * (cell.y + size[1] * cell.z)) as usize
}

/// The way of a ray through the cells: an iterator over its segments, in order.
#[derive(Clone, Debug)]
pub(super) struct Walk<'a> {
    majorants: &'a Majorants,
    /// Distance at which the ray enters the box.
    pub(super) start: f32,
    t: f32,
    end: f32,
    cell: UVec3,
    /// Distances at which the ray leaves its cell along each axis.
    next: Vec3,
    /// The distance between faces along each axis.
    step: Vec3,
    is_down: [bool; 3],
}

impl Iterator for Walk<'_> {
    type Item = Segment;

    #[inline]
    fn next(&mut self) -> Option<Segment> {
        if self.t >= self.end {
            return None;
        }
        let most = self.majorants.values[index(self.majorants.size, self.cell)];
        let axis = self.next.min_position();
        self.t = self.next[axis].clamp(self.t, self.end);
        let mut segment = Segment { end: self.t, most };
        // Step into the next cell. Behind the last one the ray has left the box, up to rounding.
        self.next[axis] += self.step[axis];
        let cell = &mut self.cell[axis];
        let next = if self.is_down[axis] { cell.wrapping_sub(1) } else { *cell + 1 };
        if next < self.majorants.size[axis] {
            *cell = next;
        } else {
            (self.t, segment.end) = (self.end, self.end);
        }
        Some(segment)
    }
}
