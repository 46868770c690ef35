//! Masks of lanes as bits, and the way through those that are set.

/// The numbers of the lanes that were chosen, from the least; bit i stands for lane i.
///
/// ```
/// use lookfrom_simd::LaneMask;
/// assert_eq!(LaneMask(0b101).collect::<Vec<_>>(), [0, 2]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LaneMask(pub u32);

impl Iterator for LaneMask {
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
        assert_eq!(LaneMask(0b1010_0110).collect::<Vec<_>>(), [1, 2, 5, 7]);
        assert_eq!(LaneMask(0).next(), None);
    }
}
