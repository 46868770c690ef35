//! Bounds of a medium's density by the cells of a coarse grid, and the way of a ray through them.
//!
//! Cells are walked by their next faces along each axis (Amanatides & Woo 1987).

use glam::{UVec3, Vec3};
use lookfrom_simd::{Float, Mask as _, Real};

use super::Coefficients;
use super::grid::PlacedGrid;
use crate::core::lanes::width::{Lanes, Width};
use crate::core::lanes::{Columns, load, set_row, store};
use crate::core::vector::Vector;

/// Largest densities in the cells of a grid over the box that a medium is in.
#[derive(Clone, Debug)]
pub(super) struct Majorants {
    bounds: [Vec3; 2],
    size: [u32; 3],
    /// By cells, x fastest.
    values: Vec<f32>,
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
        placed.grid.for_each_box(|[first, last], value| {
            let measure = measure(value);
            let [x, y, z] = [0, 1, 2]
                .map(|axis| [reached[axis][first[axis] as usize][0], reached[axis][last[axis] as usize][1]]);
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

    /// The distance at which a ray enters the box, and its way through the cells from there, up to a distance; `None` where it does not
    /// meet the box. The direction need not be of unit length.
    pub(super) fn walk(&self, origin: Vec3, direction: Vec3, limit: f32) -> Option<(f32, Walk<f32>)> {
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
        let [mut cells, mut next, mut step] = [[0.0; 3], [f32::INFINITY; 3], [0.0; 3]];
        for axis in 0..3 {
            let cell = self.cell(axis, at[axis]);
            cells[axis] = cell as f32;
            if direction[axis] != 0.0 {
                let is_up = direction[axis] > 0.0;
                let face = self.bounds[0][axis] + width[axis] * (cell + u32::from(is_up)) as f32;
                next[axis] = (face - origin[axis]) / direction[axis];
                step[axis] = width[axis] / direction[axis].abs();
            }
        }
        let [cell, next, step] = [cells, next, step].map(|[x, y, z]| Vector { x, y, z });
        Some((start, Walk { end: start, last: end, cell, next, step }))
    }
}

fn index(size: [u32; 3], cell: UVec3) -> usize {
    (cell.x + size[0] * (cell.y + size[1] * cell.z)) as usize
}

/// Rays on their way through the cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Walk<R> {
    /// The distance up to which a ray has come: the beginning of its cell.
    pub(super) end: R,
    /// The distance at which it leaves the box, or ends.
    pub(super) last: R,
    /// The coordinates of its cell.
    cell: Vector<R>,
    /// Distances at which it leaves its cell along each axis.
    next: Vector<R>,
    /// The distance between faces along each axis.
    step: Vector<R>,
}

impl<R: Real> Walk<R> {
    /// Goes to the ends of the cells, in the lanes of a mask, along directions. Returns the bounds of the density up to there.
    #[inline(always)]
    pub(super) fn advance(&mut self, majorants: &Majorants, direction: Vector<R>, lanes: R::Mask) -> R {
        let Vector { x, y, z } = self.cell;
        let [width, height, depth] = majorants.size;
        let [width, height, depth] = [width as f32, height as f32, depth as f32];
        let place = ((z * height + y) * width + x).to_integer();
        let most = R::lookup(
            place,
            #[inline(always)]
            |place| majorants.values[place],
        );
        // Find the nearest face.
        let next = self.next;
        let on_x = !next.y.lt(next.x) & !next.z.lt(next.x);
        let on_y = !on_x & !next.z.lt(next.y);
        let on_z = !on_x & !on_y;
        let face = R::select(on_x, next.x, R::select(on_y, next.y, next.z));
        let end = Float::min(Float::max(face, self.end), self.last);
        // Step into the next cell. Behind the last one the ray has left the box, up to rounding.
        let Vector { x, y, z } = &mut self.cell;
        let out_x = step([x, &mut self.next.x], (self.step.x, direction.x, width), lanes & on_x);
        let out_y = step([y, &mut self.next.y], (self.step.y, direction.y, height), lanes & on_y);
        let out_z = step([z, &mut self.next.z], (self.step.z, direction.z, depth), lanes & on_z);
        let are_out = out_x | out_y | out_z;
        self.end = R::select(lanes, R::select(are_out, self.last, end), self.end);
        most
    }
}

/// Rays on their way from one optical depth by majorants to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Approach<R> {
    pub(super) walk: Walk<R>,
    /// The distance up to which a ray has come.
    pub(super) t: R,
    /// The majorant up to the end of the cell.
    pub(super) majorant: R,
    /// The optical depth that is left.
    pub(super) left: R,
}

impl<R: Real> Approach<R> {
    /// Brings rays in the lanes of a mask along directions to the points where nothing is left. The majorants are the bounds of the density
    /// times `most`. Returns the rays that get there before they leave the box.
    #[inline(always)]
    pub(super) fn arrive(
        &mut self,
        majorants: &Majorants,
        (direction, most): (Vector<R>, R),
        lanes: R::Mask,
    ) -> R::Mask {
        let mut are_within = lanes;
        loop {
            let depth = self.majorant * (self.walk.end - self.t);
            let go_beyond = are_within & !self.left.lt(depth);
            if !go_beyond.any() {
                break;
            }
            self.left = R::select(go_beyond, self.left - depth, self.left);
            self.t = R::select(go_beyond, self.walk.end, self.t);
            let are_at_end = go_beyond & !self.t.lt(self.walk.last);
            are_within = are_within & !are_at_end;
            let go_beyond = go_beyond & !are_at_end;
            let bound = self.walk.advance(majorants, direction, go_beyond) * most;
            let majorant = Float::min(bound, bound.like(Coefficients::MOST));
            self.majorant = R::select(go_beyond, majorant, self.majorant);
        }
        let t = Float::min(self.t + self.left / self.majorant, self.walk.end);
        self.t = R::select(are_within, t, self.t);
        are_within
    }
}

/// Steps into the next of so many cells along an axis, in the lanes of a mask. Returns those that have left the last one, and stay there.
#[inline(always)]
fn step<R: Real>(
    [cell, next]: [&mut R; 2],
    (step, direction, cells): (R, R, f32),
    lanes: R::Mask,
) -> R::Mask {
    *next = R::select(lanes, *next + step, *next);
    let beside = *cell + step.like(1.0).copysign(direction);
    let is_out = beside.lt(step.like(0.0)) | !beside.lt(step.like(cells));
    *cell = R::select(lanes & !is_out, beside, *cell);
    lanes & is_out
}

/// [`Walk`] by lane.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StoredWalk {
    ends: Columns<2>,
    cell: Columns<3>,
    next: Columns<3>,
    step: Columns<3>,
}

impl StoredWalk {
    /// Replaces that of a lane.
    pub(super) fn set(&mut self, lane: usize, walk: &Walk<f32>) {
        set_row(&mut self.ends, lane, [walk.end, walk.last]);
        set_row(&mut self.cell, lane, walk.cell.into());
        set_row(&mut self.next, lane, walk.next.into());
        set_row(&mut self.step, lane, walk.step.into());
    }

    #[inline(always)]
    pub(super) fn load<W: Width>(&self, width: W) -> Walk<W::Real> {
        Walk {
            end: width.load_f32(&self.ends[0]),
            last: width.load_f32(&self.ends[1]),
            cell: load(width, &self.cell),
            next: load(width, &self.next),
            step: load(width, &self.step),
        }
    }

    /// Keeps what has changed on the way.
    #[inline(always)]
    pub(super) fn store<R: Lanes>(&mut self, walk: &Walk<R>) {
        self.ends[0] = walk.end.column();
        self.cell = store(walk.cell);
        self.next = store(walk.next);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use lookfrom_scene::grid::{BLOCK, Grid, Placed};

    use super::*;

    /// Against the values of all cells, one by one.
    #[test]
    fn bricks_of_one_value_are_bounded_as_their_cells() {
        let size = [400, 40, 24];
        let mut grid = Grid::new(size).expect("a grid");
        grid.fill([3, 1, 0], [40, 4, 2], 0.5);
        grid.set_brick([5, 2, 1], &std::array::from_fn::<f32, BLOCK, _>(|index| (index % 7) as f32));
        let bounds = [Vec3::ZERO, Vec3::from_array(size.map(|cells| cells as f32))];
        let placed = PlacedGrid::new(&Placed { grid: Arc::new(grid), bounds });
        let found = Majorants::of_grid(bounds, &placed, |value| 2.0 * value);
        let mut expected = vec![0.0_f32; found.values.len()];
        placed.grid.for_each(|cell, value| {
            let reached = |axis: usize| {
                let centre = cell[axis] as f32 + 0.5;
                [-257.0 / 256.0, 257.0 / 256.0].map(|reach| found.cell(axis, centre + reach))
            };
            let [[x0, x1], [y0, y1], [z0, z1]] = [reached(0), reached(1), reached(2)];
            for (x, y, z) in
                (x0..=x1).flat_map(|x| (y0..=y1).flat_map(move |y| (z0..=z1).map(move |z| (x, y, z))))
            {
                let bound = &mut expected[index(found.size, UVec3::new(x, y, z))];
                *bound = bound.max(2.0 * value);
            }
        });
        assert_eq!(found.values, expected);
    }
}
