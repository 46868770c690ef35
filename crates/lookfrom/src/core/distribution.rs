//! Piecewise-constant distributions, sampled in proportion to their weights.
//!
//! [`Discrete`] samples an entry of a list, [`Piecewise2D`] a point of the unit square by the luminance of an image
//! there, [`Windowed2D`] a point within a window of it. All invert cumulative sums, which is monotonic:
//! well-distributed samples stay well distributed. Entries and weights are up to the lights.

mod piecewise;
mod window;

pub use piecewise::{Cell, Piecewise2D};
pub use window::{Window, Windowed2D};

use lookfrom_simd::{Float, Real, Simd, f32x8, f64x8, prelude::*};

use crate::core::lanes::{LANES, by_lane};
use crate::core::sampler::ONE_MINUS_EPSILON;

/// A discrete distribution: entries of a list with probabilities proportional to their weights.
#[derive(Clone, Debug, PartialEq)]
pub struct Discrete {
    /// Cumulative sums: of the weights before each entry, and of all.
    sums: Vec<f64>,
    guide: Vec<u32>,
    /// The probabilities of the entries.
    probabilities: Vec<f32>,
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
        let probabilities = (0..weights.len()).map(|index| rounded(share(&sums, index))).collect();
        Self { sums, guide, probabilities }
    }

    /// The entry for `u` in [0, 1), its probability (equal to [`Discrete::pdf`]), and a new number in [0, 1) for
    /// further use: the position of `u` within the entry's interval. An entry of weight 0 is never sampled.
    #[inline]
    pub fn sample(&self, u: f32) -> (usize, f32, f32) {
        let (index, rest) = choose(&self.sums, &self.guide, u);
        (index, self.pdf(index), (rest as f32).min(ONE_MINUS_EPSILON))
    }

    /// The entries that [`Discrete::sample`] chooses for eight numbers in [0, 1).
    #[inline(always)]
    pub(crate) fn entries<S: Simd>(&self, simd: S, u: f32x8<S>) -> [usize; LANES] {
        let [_, ends @ .., _] = &self.sums[..] else { return [0; LANES] };
        if ends.len() > MOST_COMPARED {
            let u: [f32; LANES] = u.into();
            return by_lane!(lane => choose(&self.sums, &self.guide, u[lane]).0);
        }
        // All intervals that end before the goal are before the entry.
        let goal = self.goals(u);
        let (one, zero) = (f64x8::splat(simd, 1.0), f64x8::splat(simd, 0.0));
        let mut entries = zero;
        for &end in ends {
            entries += goal.simd_ge(end).select(one, zero);
        }
        by_lane!(lane => entries[lane] as usize)
    }

    /// [`Discrete::sample`] for eight numbers in [0, 1).
    #[inline(always)]
    pub(crate) fn sample_lanes<S: Simd>(&self, simd: S, u: f32x8<S>) -> ([usize; LANES], f32x8<S>, f32x8<S>) {
        let entries = self.entries(simd, u);
        let probabilities = by_lane!(lane => self.pdf(entries[lane]));
        let starts = f64x8::load_array(simd, by_lane!(lane => self.sums[entries[lane]]));
        let ends = f64x8::load_array(simd, by_lane!(lane => self.sums[entries[lane] + 1]));
        let rest: f32x8<S> = Real::narrow((self.goals(u) - starts) / (ends - starts));
        (entries, f32x8::load_array(simd, probabilities), Float::min(rest, rest.like(ONE_MINUS_EPSILON)))
    }

    /// The numbers in proportion to the sum of all weights.
    #[inline(always)]
    fn goals<S: Simd>(&self, u: f32x8<S>) -> f64x8<S> {
        Real::widen(Float::clamp(u, 0.0, ONE_MINUS_EPSILON)) * self.sums[self.sums.len() - 1]
    }

    /// The weight of an entry, and the sum of all.
    ///
    /// # Panics
    /// If there is no such entry.
    pub fn weight(&self, index: usize) -> [f64; 2] {
        [self.sums[index + 1] - self.sums[index], self.sums[self.sums.len() - 1]]
    }

    /// The probability of an entry; 0 for one of weight 0 or an index out of range.
    pub fn pdf(&self, index: usize) -> f32 {
        self.probabilities.get(index).copied().unwrap_or(0.0)
    }
}

/// The length of lists that are compared with all of their sums at once.
const MOST_COMPARED: usize = 16;

/// The weight, or 0 if it is not a positive finite number.
pub(crate) fn usable(weight: f32) -> f64 {
    if weight.is_finite() && weight > 0.0 { f64::from(weight) } else { 0.0 }
}

/// Appends 0 and the cumulative sums of the weights; returns the last.
fn push_sums(sums: &mut Vec<f64>, weights: &[f32]) -> f64 {
    let mut sum = 0.0;
    sums.push(sum);
    for &weight in weights {
        sum += usable(weight);
        sums.push(sum);
    }
    sum
}

/// Appends a guide table for [`choose`]: 0 … 1 is divided into about a quarter as many equal intervals as there are
/// entries, and each interval stores the entry at its beginning; the last number is the entry at the end.
///
/// (Chen & Asau 1974: with the guide table, a search takes one or two steps, whatever the number of entries.)
fn push_guide(guide: &mut Vec<u32>, sums: &[f64]) {
    let total = sums[sums.len() - 1];
    // A power of two: the ends of the intervals are exact, so that no rounding skips the right entry.
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

/// The entry whose interval contains `u`, and the position in it (0 … 1). `sums` must end in more than 0.
#[inline]
fn choose(sums: &[f64], guide: &[u32], u: f32) -> (usize, f64) {
    let u = u.clamp(0.0, ONE_MINUS_EPSILON);
    let goal = f64::from(u) * sums[sums.len() - 1];
    let part = (u * (guide.len() - 1) as f32) as usize;
    let [from, to] = [guide[part] as usize, guide[part + 1] as usize];
    // The first entry that ends beyond the goal has positive width.
    let index = from + sums[from + 1..to + 1].partition_point(|&end| end <= goal);
    (index, (goal - sums[index]) / (sums[index + 1] - sums[index]))
}

/// The probability of an entry; 0 beyond the end, and if all weights are 0.
fn share(sums: &[f64], index: usize) -> f64 {
    let total = sums[sums.len() - 1];
    if index + 1 < sums.len() && total > 0.0 { (sums[index + 1] - sums[index]) / total } else { 0.0 }
}

/// Rounded to f32 such that a positive probability stays positive: a density that is divided by
/// must not become 0.
fn rounded(probability: f64) -> f32 {
    if probability > 0.0 { (probability as f32).max(f32::MIN_POSITIVE) } else { 0.0 }
}

/// The index of the cell, of `cells` equal ones in 0 … 1, that contains a number.
fn cell(x: f32, cells: usize) -> usize {
    ((f64::from(x) * cells as f64) as usize).min(cells - 1)
}

/// The number in [0, 1) at the position `rest` (0 … 1) of a cell. It is in that cell after rounding too.
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
