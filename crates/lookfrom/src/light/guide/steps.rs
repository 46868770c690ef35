//! Discrete distributions over the cells of a row, in fixed point.

use super::SIDE;
use crate::core::distribution::usable;

/// Units of probability: 2¹⁵, so that numbers of 24 bits choose cells with exactly their probabilities.
const UNITS: f32 = 32_768.0;

/// The probabilities of the cells, of which some may be 0. In one line of the cache: tables of a guide are many, and are read at
/// random.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub(super) struct Steps {
    /// The sums of the probabilities before each cell, in units.
    begins: [u16; SIDE],
}

/// The largest probability of whole units that is not above another.
pub(super) fn whole_units(probability: f32) -> f32 {
    (probability * UNITS).floor() / UNITS
}

impl Steps {
    /// No cell: nothing may be chosen.
    pub(super) const NONE: Self = Self { begins: [0; SIDE] };

    /// By the weight of each cell, in proportion up to 2⁻¹⁵, which is the least probability of a positive weight; `None` if there
    /// is none. Negative weights and those that are not finite count as zero.
    pub(super) fn new(weights: [f32; SIDE]) -> Option<Self> {
        let weights = weights.map(usable);
        let last = weights.iter().rposition(|weight| *weight > 0.0)?;
        // Each has one unit, the others are shared out.
        let count = weights.iter().filter(|weight| **weight > 0.0).count();
        let (total, free) = (weights.iter().sum::<f64>(), f64::from(UNITS) - count as f64);
        let mut begins = [UNITS as u16; SIDE];
        let (mut sum, mut before) = (0.0, 0.0);
        for (begin, weight) in begins.iter_mut().zip(weights).take(last + 1) {
            *begin = ((sum / total * free).floor() + before) as u16;
            sum += weight;
            before += f64::from(u8::from(weight > 0.0));
        }
        Some(Self { begins })
    }

    /// The chosen cell, and the position in it (0 … 1), for `u` in [0, 1).
    #[inline]
    pub(super) fn choose(&self, u: f32) -> (usize, f32) {
        let at = u * UNITS;
        let unit = at as u16;
        let count: u16 = self.begins.iter().map(|begin| u16::from(*begin <= unit)).sum();
        // The first one begins at 0.
        let cell = usize::from(count) - 1;
        let [begin, end] = self.ends(cell);
        (cell, (at - begin) / (end - begin))
    }

    /// The probability of a cell.
    #[inline]
    pub(super) fn probability(&self, cell: usize) -> f32 {
        let [begin, end] = self.ends(cell);
        (end - begin) / UNITS
    }

    /// The cumulative probabilities before and after a cell, in units.
    #[inline]
    fn ends(&self, cell: usize) -> [f32; 2] {
        [f32::from(self.begins[cell]), self.begins.get(cell + 1).map_or(UNITS, |end| f32::from(*end))]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_are_those_of_weights_and_of_choices() {
        let mut weights = [0.0; SIDE];
        weights[..8].copy_from_slice(&[0.0, 3.0, 0.0, 1.0, 1e-20, f32::NAN, 4.0, -1.0]);
        for last in [0.0, 8.0] {
            weights[SIDE - 1] = last;
            let steps = Steps::new(weights).unwrap();
            let total = 8.0 + last;
            for cell in [0, 2, 5, 7, 8, SIDE - 2] {
                assert_eq!(steps.probability(cell), 0.0, "{cell}");
            }
            let expected = [(1, 3.0 / total), (3, 1.0 / total), (4, 1.0 / UNITS), (6, 4.0 / total)];
            for (cell, expected) in expected.into_iter().chain([(SIDE - 1, last / total)]) {
                assert!((steps.probability(cell) - expected).abs() < 4.0 / UNITS, "{cell}");
            }
            let mut counts = [0_u32; SIDE];
            for k in 0..1 << 20 {
                let (cell, rest) = steps.choose(k as f32 / (1 << 20) as f32);
                assert!((0.0..1.0).contains(&rest));
                counts[cell] += 1;
            }
            for (cell, count) in counts.into_iter().enumerate() {
                assert_eq!(count as f32 / (1 << 20) as f32, steps.probability(cell), "{cell}");
            }
        }
        let (cell, rest) = Steps::new([1.0; SIDE]).unwrap().choose(1.0 - 0.5_f32.powi(24));
        assert!(cell == SIDE - 1 && rest < 1.0, "{rest}");
    }

    #[test]
    fn no_weight_is_no_choice() {
        assert_eq!(Steps::new([0.0; SIDE]), None);
        assert_eq!(Steps::new([-1.0; SIDE]), None);
    }
}
