//! Masks of lanes as bits, and the way through those that are set.

/// The numbers of the lanes that were chosen, from the least; bit i stands for lane i.
///
/// ```
/// use lookfrom_simd::Chosen;
/// assert_eq!(Chosen(0b101).collect::<Vec<_>>(), [0, 2]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chosen(pub u32);

impl Iterator for Chosen {
    type Item = usize;
    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let lane = (self.0 != 0).then(|| self.0.trailing_zeros() as usize);
        self.0 &= self.0.wrapping_sub(1);
        lane
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chosen_lanes_come_in_order() {
        assert_eq!(Chosen(0b1010_0110).collect::<Vec<_>>(), [1, 2, 5, 7]);
        assert_eq!(Chosen(0).next(), None);
    }
}
