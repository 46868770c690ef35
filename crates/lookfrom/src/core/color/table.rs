//! A table of sigmoid coefficients over RGB (Jakob & Hanika 2019).
//!
//! pbrt-v4's table: coefficients over a lattice of the largest component and the ratios of the other two to it, 3 ×
//! 64³ (Jakob and Hanika 2019), with the same interpolation. Between the nodes, colours are off by some 5 · 10⁻⁴,
//! dark saturated ones by a few per cent: to agree with pbrt is to have the same errors. (Not where all components
//! are below 4 · 10⁻⁴: there its optimisation stops early.) Nodes are solved on first use, so that nothing is
//! computed at the start and nothing is stored on disk; a node's solution depends on its position only.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering};

use super::solve::{Measure, newton, solve};

/// Number of nodes along each axis.
const NODES: usize = 64;

/// The coefficients for greys that reflect at least 1 − 2 · 10⁻⁴ of the light, where pbrt-v4's optimisation stops.
const WHITE: [f32; 3] = [-4.053308, -15.649015, 35.114243];
/// The first plane with such greys.
const WHITE_PLANE: usize = 60;

/// The coefficients of a node as bits; the last is 0 until all three are stored.
type Node = [AtomicU32; 3];

/// The lattice with the nodes solved so far.
pub(super) struct Table {
    /// The largest component at each plane: denser toward both ends.
    levels: [f32; NODES],
    /// Indexed by the largest component, plane, and the ratios of the two components after it: the second in the
    /// outer dimension, the first in the inner one.
    nodes: Vec<Node>,
}

impl Table {
    /// The table shared by all threads.
    pub(super) fn shared() -> &'static Self {
        static TABLE: OnceLock<Table> = OnceLock::new();
        TABLE.get_or_init(Self::new)
    }

    /// A table without solutions yet.
    pub(super) fn new() -> Self {
        let smooth = |x: f64| x * x * (3.0 - 2.0 * x);
        let level = |k: usize| smooth(smooth(k as f64 / (NODES - 1) as f64)) as f32;
        let mut nodes = Vec::new();
        nodes.resize_with(3 * NODES * NODES * NODES, Node::default);
        Self { levels: std::array::from_fn(level), nodes }
    }

    /// The interpolated coefficients of a colour within [0, 1]³ that is not black.
    pub(super) fn coefficients(&self, rgb: [f32; 3]) -> [f32; 3] {
        let [r, g, b] = rgb;
        let greatest = if r > g && r > b {
            0
        } else if r <= g && g > b {
            1
        } else {
            2
        };
        let z = rgb[greatest];
        // The position of the colour between the nodes.
        let scale = (NODES - 1) as f32 / z;
        let cell = |ratio: f32| (ratio as usize).min(NODES - 2);
        let x = rgb[(greatest + 1) % 3] * scale;
        let y = rgb[(greatest + 2) % 3] * scale;
        let (i, j) = (cell(x), cell(y));
        let k = self.levels.partition_point(|&level| level < z).saturating_sub(1).min(NODES - 2);
        let (x, y) = (x - i as f32, y - j as f32);
        let z = (z - self.levels[k]) / (self.levels[k + 1] - self.levels[k]);
        // Trilinear interpolation between the cell's corners.
        let first = number(greatest, k, j, i);
        let mut mean = [0.0; 3];
        for (plane, z) in [1.0 - z, z].into_iter().enumerate() {
            for (row, y) in [1.0 - y, y].into_iter().enumerate() {
                for (column, x) in [1.0 - x, x].into_iter().enumerate() {
                    let node = self.node(first + (plane * NODES + row) * NODES + column);
                    let weight = x * y * z;
                    mean =
                        [mean[0] + weight * node[0], mean[1] + weight * node[1], mean[2] + weight * node[2]];
                }
            }
        }
        mean
    }

    /// The coefficients of a node by its index.
    #[inline(always)]
    fn node(&self, at: usize) -> [f32; 3] {
        let [a, b, c] = &self.nodes[at];
        // A thread that sees c also sees a and b: c is written last and read first.
        match c.load(Ordering::Acquire) {
            0 => self.solved(at),
            bits => {
                let [a, b] = [a.load(Ordering::Relaxed), b.load(Ordering::Relaxed)];
                [f32::from_bits(a), f32::from_bits(b), f32::from_bits(bits)]
            }
        }
    }

    /// Solves a node and keeps the solution.
    #[cold]
    fn solved(&self, at: usize) -> [f32; 3] {
        let [i, j, k] = [at, at / NODES, at / NODES / NODES].map(|quotient| quotient % NODES);
        let solution = self.solution(at / NODES / NODES / NODES, k, j, i);
        let [a, b, c] = &self.nodes[at];
        a.store(solution[0].to_bits(), Ordering::Relaxed);
        b.store(solution[1].to_bits(), Ordering::Relaxed);
        // A c of +0 would mark the node as unsolved; −0 is equivalent.
        let bits = solution[2].to_bits();
        c.store(if bits == 0 { (-0.0_f32).to_bits() } else { bits }, Ordering::Release);
        solution
    }

    /// The coefficients at a node, starting from its neighbour on a lattice eight times as coarse.
    fn solution(&self, greatest: usize, k: usize, j: usize, i: usize) -> [f32; 3] {
        if (j, i) == (NODES - 1, NODES - 1) && k >= WHITE_PLANE {
            return WHITE;
        }
        // The plane of black has no solution; colours darker than the next plane take that plane's.
        let k = k.max(1);
        let z = f64::from(self.levels[k]);
        let mut rgb = [z; 3];
        rgb[(greatest + 1) % 3] *= i as f64 / (NODES - 1) as f64;
        rgb[(greatest + 2) % 3] *= j as f64 / (NODES - 1) as f64;
        let measure = Measure::of_pbrt();
        let coarse = (k | 7, j | 7, i | 7);
        let found = if coarse == (k, j, i) {
            solve(measure, rgb)
        } else {
            // Dark spectra that are darker by a factor s have coefficients larger by a factor 1/√s.
            let darker = (f64::from(self.levels[coarse.0]) / z).sqrt();
            let guess = self
                .node(number(greatest, coarse.0, coarse.1, coarse.2))
                .map(|value| f64::from(value) * darker);
            newton(measure, rgb, guess).unwrap_or_else(|| solve(measure, rgb))
        };
        found.map(|coefficient| coefficient as f32)
    }
}

/// The index of a node.
fn number(greatest: usize, k: usize, j: usize, i: usize) -> usize {
    ((greatest * NODES + k) * NODES + j) * NODES + i
}
