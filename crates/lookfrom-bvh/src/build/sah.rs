//! Splits primitives in two, again and again, where rays are expected to find the least work.
//!
//! The surface area heuristic over bins of centroids: Wald (2007), "On fast Construction of SAH-based Bounding Volume
//! Hierarchies". Where it finds nothing to separate, or has gone too deep, halves are taken by number, so that depth stays
//! below [`HEURISTIC_DEPTH`] + 32 + a few, and the time below that times the number of primitives, whatever the input.
//! The tree is the same for any number of threads.

use crate::aabb::Aabb;

use super::{Item, Quality};

/// Levels on which the heuristic decides; below, the median does.
const HEURISTIC_DEPTH: u32 = 64;

/// Ranges shorter than this are one thread's work.
#[cfg(feature = "parallel")]
const PARALLEL_LENGTH: usize = 4096;

/// Bins per axis at most.
const MAX_BINS: usize = 32;

/// A primitive while it is sorted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reference {
    pub(super) bounds: Aabb,
    pub(super) item: u32,
}

/// A node of the binary tree. Its left child follows it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Binary {
    pub(super) bounds: Aabb,
    /// How much farther the right child is; 0 for a leaf.
    pub(super) right: u32,
    /// The references in it.
    pub(super) first: u32,
    pub(super) count: u32,
}

/// Sorts the references and returns the tree over them, its root first. Empty where there are none.
pub(super) fn build(references: &mut [Reference], items: &[Item], quality: Quality) -> Vec<Binary> {
    let mut tree = Vec::new();
    if !references.is_empty() {
        let bins = match quality {
            Quality::Fast => 8,
            Quality::Balanced => 16,
            Quality::Best => MAX_BINS,
        };
        split(references, 0, 0, &Task { items, bins, to_the_end: quality == Quality::Best }, &mut tree);
    }
    tree
}

struct Task<'a> {
    items: &'a [Item],
    bins: usize,
    /// Whether to go on where everything fits into a leaf: better trees for half again the time.
    to_the_end: bool,
}

/// Appends the tree over some references.
fn split(references: &mut [Reference], first: u32, depth: u32, task: &Task<'_>, tree: &mut Vec<Binary>) {
    let mut bounds = Aabb::EMPTY;
    let mut centers = Aabb::EMPTY;
    for reference in &*references {
        bounds.unite(&reference.bounds);
        centers.extend(reference.bounds.twice_center());
    }
    let here = tree.len();
    tree.push(Binary { bounds, right: 0, first, count: references.len() as u32 });
    if references.len() == 1 || (!task.to_the_end && fits_a_leaf(references, task.items)) {
        return;
    }

    let heuristic = (depth < HEURISTIC_DEPTH)
        .then(|| best_split(references, &centers, task.bins.min(references.len().max(4))))
        .flatten();
    let middle = match heuristic {
        Some(split) => partition(references, |reference| split.is_left(reference)),
        None => median(references, &centers),
    };

    let (left, right) = references.split_at_mut(middle);
    let second = first + middle as u32;
    #[cfg(feature = "parallel")]
    if left.len() + right.len() >= PARALLEL_LENGTH {
        let subtree = |references: &mut [Reference], first| {
            let mut tree = Vec::new();
            split(references, first, depth + 1, task, &mut tree);
            tree
        };
        let (mut left, mut right) = rayon::join(|| subtree(left, first), || subtree(right, second));
        tree[here].right = 1 + left.len() as u32;
        tree.append(&mut left);
        tree.append(&mut right);
        return;
    }
    split(left, first, depth + 1, task, tree);
    tree[here].right = (tree.len() - here) as u32;
    split(right, second, depth + 1, task, tree);
}

/// A leaf holds few items, of one kind.
pub(super) fn fits_a_leaf(references: &[Reference], items: &[Item]) -> bool {
    let kind = |reference: &Reference| items[reference.item as usize].kind;
    let first = kind(&references[0]);
    references.len() <= first.leaf_capacity() && references.iter().all(|reference| kind(reference) == first)
}

/// Where to cut: before bin `bin` on an axis.
struct Split {
    axis: usize,
    bin: usize,
    binning: Binning,
}

impl Split {
    fn is_left(&self, reference: &Reference) -> bool {
        self.binning.bin(reference, self.axis) < self.bin
    }
}

/// Which bin a centroid falls into.
#[derive(Clone, Copy)]
struct Binning {
    origin: [f32; 3],
    scale: [f32; 3],
    last: usize,
}

impl Binning {
    fn new(centers: &Aabb, bins: usize) -> Self {
        let scale = [0, 1, 2].map(|axis| {
            let scale = bins as f32 / (centers.max[axis] - centers.min[axis]);
            if scale.is_finite() { scale } else { 0.0 }
        });
        Self { origin: centers.min, scale, last: bins - 1 }
    }

    #[inline(always)]
    fn bin(&self, reference: &Reference, axis: usize) -> usize {
        let center = reference.bounds.min[axis] + reference.bounds.max[axis];
        (((center - self.origin[axis]) * self.scale[axis]) as usize).min(self.last)
    }
}

/// The cheapest cut between bins. None where no cut separates anything.
fn best_split(references: &[Reference], centers: &Aabb, bins: usize) -> Option<Split> {
    let binning = Binning::new(centers, bins);

    // Fill the bins of all three axes.
    let mut boxes = [[Aabb::EMPTY; MAX_BINS]; 3];
    let mut counts = [[0_u32; MAX_BINS]; 3];
    for reference in references {
        for axis in 0..3 {
            let bin = binning.bin(reference, axis);
            boxes[axis][bin].unite(&reference.bounds);
            counts[axis][bin] += 1;
        }
    }

    let mut best: Option<(f32, usize, usize)> = None;
    for axis in 0..3 {
        if binning.scale[axis] == 0.0 {
            continue;
        }
        // Sweep from the right: what would lie right of each cut.
        let mut right = [0.0_f32; MAX_BINS];
        let (mut bounds, mut count) = (Aabb::EMPTY, 0);
        for bin in (1..bins).rev() {
            bounds.unite(&boxes[axis][bin]);
            count += counts[axis][bin];
            right[bin] = bounds.half_area() * blocks(count);
        }
        // Sweep from the left and compare.
        let (mut bounds, mut count) = (Aabb::EMPTY, 0);
        for bin in 1..bins {
            bounds.unite(&boxes[axis][bin - 1]);
            count += counts[axis][bin - 1];
            if count == 0 || count as usize == references.len() {
                continue;
            }
            let cost = bounds.half_area() * blocks(count) + right[bin];
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, bin));
            }
        }
    }
    best.map(|(_, axis, bin)| Split { axis, bin, binning })
}

/// What primitives cost: they are tested in fours.
fn blocks(count: u32) -> f32 {
    count.div_ceil(8) as f32
}

/// Moves what is left to the front and returns how many those are.
fn partition(references: &mut [Reference], is_left: impl Fn(&Reference) -> bool) -> usize {
    let (mut front, mut back) = (0, references.len());
    while front < back {
        if is_left(&references[front]) {
            front += 1;
        } else {
            back -= 1;
            references.swap(front, back);
        }
    }
    front
}

/// Halves by number along the axis on which centroids lie widest.
fn median(references: &mut [Reference], centers: &Aabb) -> usize {
    let extent = |axis: usize| centers.max[axis] - centers.min[axis];
    let axis = (1..3).fold(0, |widest, axis| if extent(axis) > extent(widest) { axis } else { widest });
    let middle = references.len() / 2;
    if extent(axis) > 0.0 {
        references.select_nth_unstable_by(middle, |a, b| {
            a.bounds.twice_center()[axis].total_cmp(&b.bounds.twice_center()[axis])
        });
    }
    middle
}
