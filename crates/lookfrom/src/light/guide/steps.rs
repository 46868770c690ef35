//! Discrete distributions of few of many cells, in fixed point.

/// Units of probability: 2¹⁶, so that f32 holds every sum, and numbers of 24 bits choose cells with exactly their probabilities.
const UNITS: f32 = 65_536.0;

/// Cells with positive probabilities, in their order.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Steps {
    cells: Vec<u32>,
    /// The sums of the probabilities up to and with each cell; the last is 1.
    ends: Vec<f32>,
}

impl Steps {
    /// By the weight of each cell, in proportion up to 2⁻¹⁶, which is the least probability of a positive weight; `None` if there
    /// is none. Negative weights and those that are not finite count as zero. At most 2¹⁵ cells.
    pub(super) fn new(weights: impl Iterator<Item = f32>) -> Option<Self> {
        let usable = (0..).zip(weights).filter(|(_, weight)| *weight > 0.0 && weight.is_finite());
        let (cells, weights): (Vec<u32>, Vec<f64>) =
            usable.map(|(cell, weight)| (cell, f64::from(weight))).unzip();
        // Each has one unit; the others are shared out, and rounding moves ends and not the last one.
        let (total, free) = (weights.iter().sum::<f64>(), f64::from(UNITS) - cells.len() as f64);
        let mut sum = 0.0;
        let ends = (1..).zip(&weights).map(|(count, weight)| {
            sum += weight;
            let shared = if count == weights.len() { free } else { (sum / total * free).floor() };
            ((shared + count as f64) as f32) / UNITS
        });
        let ends: Vec<f32> = ends.collect();
        (!cells.is_empty()).then_some(Self { cells, ends })
    }

    /// The chosen step, its cell and the position in it (0 … 1), for `u` in [0, 1).
    #[inline]
    pub(super) fn choose(&self, u: f32) -> (usize, usize, f32) {
        let index = self.ends.partition_point(|end| *end <= u).min(self.ends.len() - 1);
        let begin = self.begin(index);
        let rest = (u - begin) / (self.ends[index] - begin);
        (index, self.cells[index] as usize, rest)
    }

    /// The step of a cell and its probability.
    #[inline]
    pub(super) fn find(&self, cell: usize) -> Option<(usize, f32)> {
        let index = self.cells.binary_search(&(cell as u32)).ok()?;
        Some((index, self.ends[index] - self.begin(index)))
    }

    #[inline]
    fn begin(&self, index: usize) -> f32 {
        if index == 0 { 0.0 } else { self.ends[index - 1] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_are_those_of_weights_and_of_choices() {
        let weights = [0.0, 3.0, 0.0, 1.0, 1e-20, f32::NAN, 4.0, -1.0];
        let steps = Steps::new(weights.into_iter()).unwrap();
        let probability = |cell| steps.find(cell).map(|(_, probability)| probability);
        assert_eq!([0, 2, 5, 7].map(probability), [None; 4]);
        for (cell, expected) in [(1, 0.375), (3, 0.125), (4, 1.0 / UNITS), (6, 0.5)] {
            assert!((probability(cell).unwrap() - expected).abs() < 4.0 / UNITS, "{cell}");
        }
        let mut counts = [0_u32; 8];
        for k in 0..1 << 20 {
            let (_, cell, rest) = steps.choose(k as f32 / (1 << 20) as f32);
            assert!((0.0..1.0).contains(&rest));
            counts[cell] += 1;
        }
        for (cell, count) in counts.into_iter().enumerate() {
            assert_eq!(count as f32 / (1 << 20) as f32, probability(cell).unwrap_or(0.0), "{cell}");
        }
    }

    #[test]
    fn no_weight_is_no_choice() {
        assert_eq!(Steps::new([0.0, -1.0].into_iter()), None);
    }
}
