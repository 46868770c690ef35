//! Guides: the directions in which an environment is visible from the places of a scene, learned before the picture.
//!
//! A kd-tree over points that paths visit, one for each of six main directions of their normals and one for media (spatial
//! trees of directional histograms: Müller, Gross & Novák 2017, here of next-event estimation as in Vorba et al. 2019). Each leaf
//! has a histogram over directions, of the radiance of the environment that is visible from there, times the cosine. A guide
//! never decides what light there is: directions are sampled by a mixture with another density, and what has density 0
//! is left to BSDF sampling. `learn` makes guides, `gain` estimates what they are
//! worth, `steps` are their histograms, `octahedron` is the square of directions.

mod gain;
mod learn;
mod octahedron;
mod steps;

#[cfg(test)]
mod tests;

use glam::Vec3;

use octahedron::Direction;
use steps::Steps;

pub(crate) use learn::{GuidePoint, Query};

/// Cells along each side of the square of directions.
const SIDE: usize = 32;

/// Classes of normals: six main directions, and none.
const CLASSES: usize = 7;

/// Histograms of the directions in which an environment is visible, by place and normal.
#[derive(Clone, Debug, Default)]
pub struct Guide {
    /// The roots of the trees, by class of the normal; `None` where there are too few points.
    roots: [Option<u32>; CLASSES],
    nodes: Vec<Node>,
    histograms: Vec<Histogram>,
}

/// A node of a tree, in eight bytes, so that a tree stays in the cache.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// Points with a smaller coordinate are in the first child, which follows; others in the second.
    at: f32,
    /// Four times the index of the second child, plus the axis; of a leaf four times the number of its histogram, from 1 on, plus
    /// [`Node::LEAF`].
    link: u32,
}

impl Node {
    const LEAF: u32 = 3;

    fn split(axis: usize, at: f32, second: u32) -> Self {
        Self { at, link: second << 2 | axis as u32 }
    }

    /// A leaf with the histogram of an index; `None` where a guide would not help.
    fn leaf(histogram: Option<u32>) -> Self {
        Self { at: 0.0, link: histogram.map_or(0, |index| index + 1) << 2 | Self::LEAF }
    }
}

/// A density over the square of directions: columns, and the rows of each.
#[derive(Clone, Debug)]
pub(crate) struct Histogram {
    columns: Steps,
    rows: [Steps; SIDE],
    /// The part of the samples that it chooses: a multiple of 2⁻¹⁵, as probabilities of cells are.
    pub(super) share: f32,
}

/// A cell of the square, and the probabilities that its density is made of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GuideCell {
    /// Column and row.
    pub(crate) place: [usize; 2],
    /// The probability of the column, and that of the row within it.
    pub(crate) probabilities: [f32; 2],
    /// Length of the direction's point of the octahedron.
    pub(crate) length: f32,
}

impl Guide {
    /// The histogram at a point with a unit normal, or zero in a medium.
    #[inline]
    pub(super) fn histogram(&self, p: Vec3, n: Vec3) -> Option<&Histogram> {
        let mut index = self.roots[class_of(n)]?;
        let p = [p.x, p.y, p.z, 0.0];
        loop {
            let Node { at, link } = self.nodes[index as usize];
            let (axis, number) = (link & Node::LEAF, link >> 2);
            if axis == Node::LEAF {
                return self.histograms.get((number as usize).wrapping_sub(1));
            }
            index = if p[axis as usize] < at { index + 1 } else { number };
        }
    }
}

impl Histogram {
    /// By the weights of cells, row by row, and the part of the samples that it chooses; `None` if no weight is positive.
    fn new(weights: &[f32], share: f32) -> Option<Self> {
        let mut rows = [Steps::NONE; SIDE];
        let columns = std::array::from_fn(|column| {
            let of_column = std::array::from_fn(|row| weights[row * SIDE + column]);
            rows[column] = Steps::new(of_column).unwrap_or(Steps::NONE);
            of_column.iter().sum()
        });
        Some(Self { columns: Steps::new(columns)?, rows, share: steps::whole_units(share) })
    }

    /// A unit direction for `u` in [0, 1)².
    #[inline]
    pub(super) fn sample(&self, u: [f32; 2]) -> Vec3 {
        self.direction(self.column(u[0]), u[1])
    }

    /// The column of the square that a number chooses, and the position in it (0 … 1).
    #[inline]
    pub(super) fn column(&self, u: f32) -> (usize, f32) {
        self.columns.choose(u)
    }

    /// The unit direction in a column that a number chooses.
    #[inline]
    pub(super) fn direction(&self, (column, s): (usize, f32), u: f32) -> Vec3 {
        let (row, t) = self.rows[column].choose(u);
        let square =
            [(column, s), (row, t)].map(|(cell, rest)| (cell as f32 + rest) / SIDE as f32 * 2.0 - 1.0);
        Direction::of_square(square).unit()
    }

    /// The density of a unit direction over solid angle.
    #[inline]
    pub(super) fn pdf(&self, wi: Vec3) -> f32 {
        self.cell(wi).map_or(0.0, GuideCell::pdf)
    }

    /// The cell of a direction; `None` where it has no probability.
    #[inline]
    pub(super) fn cell(&self, wi: Vec3) -> Option<GuideCell> {
        let direction = Direction::of_unit(wi);
        let place = direction.square().map(|x| (((x + 1.0) * (0.5 * SIDE as f32)) as usize).min(SIDE - 1));
        let [column, row] = place;
        let probabilities = [self.columns.probability(column), self.rows[column].probability(row)];
        let is_sampled = probabilities.iter().all(|probability| *probability > 0.0);
        is_sampled.then(|| GuideCell { place, probabilities, length: direction.length() })
    }
}

impl GuideCell {
    /// Cells per area of the square, which is 2 wide.
    const PER_AREA: f32 = 0.25 * (SIDE * SIDE) as f32;

    /// The density there over solid angle.
    #[inline]
    fn pdf(self) -> f32 {
        let [column, row] = self.probabilities;
        column * row * Self::PER_AREA * (self.length * self.length * self.length)
    }
}

/// The class of a normal.
#[inline]
fn class_of(n: Vec3) -> usize {
    if n == Vec3::ZERO {
        return CLASSES - 1;
    }
    let size = n.abs();
    let axis = if size.x >= size.y && size.x >= size.z { 0 } else { 1 + usize::from(size.z > size.y) };
    2 * axis + usize::from(n[axis] < 0.0)
}
