//! Masks of lanes as bits, and iteration over the lanes that are set.

/// A mask of lanes, bit i for lane i. As an iterator it yields the indices of the lanes that are set, in ascending
/// order.
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
    fn lanes_come_in_order() {
        assert_eq!(LaneMask(0b1010_0110).collect::<Vec<_>>(), [1, 2, 5, 7]);
        assert_eq!(LaneMask(0).next(), None);
    }
}
