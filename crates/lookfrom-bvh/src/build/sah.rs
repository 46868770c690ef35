//! Top-down construction of a binary tree by the surface area heuristic (SAH).
//!
//! Where `split` finds no split, or the tree has become too deep, references are halved by their number. So the
//! depth stays below [`HEURISTIC_DEPTH`] + 32 + a few, and the time below that times the number of primitives,
//! whatever the input. The tree is the same for any number of threads and any SIMD level.

use crate::aabb::Aabb;
use crate::dispatch::dispatch;
use lookfrom_simd::Level;

use super::Quality;
use super::reference::{Covered, Reference, fits_a_leaf};
use super::split::{MAX_BINS, Split};
use crate::parallel::{self, join};

/// Number of levels split by the heuristic; below, by the median.
const HEURISTIC_DEPTH: u32 = 64;

/// A node of the binary tree. Its left child follows it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Binary {
    pub(super) bounds: Aabb,
    /// Offset of the right child; 0 for a leaf.
    pub(super) right: u32,
    /// The range of references in it.
    pub(super) first: u32,
    pub(super) count: u32,
}

/// Sorts the references and returns the tree over them, root first. Empty where there are none.
pub(super) fn build(references: &mut [Reference], quality: Quality, level: Level) -> Vec<Binary> {
    let mut tree = Vec::new();
    if !references.is_empty() {
        let bins = match quality {
            Quality::Fast => 8,
            Quality::Balanced => 16,
            Quality::Best => MAX_BINS,
        };
        let mut covered = Covered::by(&[]);
        parallel::chunks(references, Covered::by).iter().for_each(|chunk| covered.unite(chunk));
        let task = Task { bins, to_the_end: quality == Quality::Best, level };
        tree.reserve(task.room(references.len()));
        task.split(references, &covered, 0, 0, &mut tree);
    }
    tree
}

struct Task {
    bins: usize,
    /// True to continue splitting where everything fits into a leaf: better trees for half again the time.
    to_the_end: bool,
    level: Level,
}

impl Task {
    /// An estimate of the number of nodes over so many references, or slightly more.
    fn room(&self, references: usize) -> usize {
        if self.to_the_end { 2 * references } else { references }
    }

    /// Appends the tree over some references.
    fn split(
        &self,
        references: &mut [Reference],
        covered: &Covered,
        first: u32,
        depth: u32,
        tree: &mut Vec<Binary>,
    ) {
        let here = tree.len();
        let count = references.len();
        tree.push(Binary { bounds: covered.bounds, right: 0, first, count: count as u32 });
        if count == 1 || (!self.to_the_end && fits_a_leaf(references)) {
            return;
        }

        let split = (depth < HEURISTIC_DEPTH)
            .then(|| {
                let bins = self.bins.min(count.max(4));
                dispatch(self.level, Split { references: &mut *references, centers: &covered.centers, bins })
            })
            .flatten();
        let (middle, [left_covered, right_covered]) =
            split.unwrap_or_else(|| halve(references, &covered.centers));

        let (left, right) = references.split_at_mut(middle);
        let second = first + middle as u32;
        if count < parallel::GRAIN {
            self.split(left, &left_covered, first, depth + 1, tree);
            tree[here].right = (tree.len() - here) as u32;
            self.split(right, &right_covered, second, depth + 1, tree);
            return;
        }
        let (length, mut right) = join(
            || {
                self.split(left, &left_covered, first, depth + 1, tree);
                tree.len() - here
            },
            || {
                let mut tree = Vec::with_capacity(self.room(right.len()));
                self.split(right, &right_covered, second, depth + 1, &mut tree);
                tree
            },
        );
        tree[here].right = length as u32;
        tree.append(&mut right);
    }
}

/// Halves by number along the axis with the largest extent of the centroids.
fn halve(references: &mut [Reference], centers: &Aabb) -> (usize, [Covered; 2]) {
    let extent = |axis: usize| centers.max[axis] - centers.min[axis];
    let axis = (1..3).fold(0, |widest, axis| if extent(axis) > extent(widest) { axis } else { widest });
    let middle = references.len() / 2;
    if extent(axis) > 0.0 {
        let center = |reference: &Reference| reference.bounds().twice_center()[axis];
        references.select_nth_unstable_by(middle, |a, b| center(a).total_cmp(&center(b)));
    }
    (middle, [Covered::by(&references[..middle]), Covered::by(&references[middle..])])
}
