//! Masks of nodes: a bit for each value, z fastest.

use glam::IVec3;

/// The bits of a node of 2ⁿ values along a side.
#[derive(Clone, Copy)]
pub(super) struct NodeMask<'a>(pub(super) &'a [u8]);

impl NodeMask<'_> {
    pub(super) fn bytes(self) -> u64 {
        self.0.len() as u64
    }

    pub(super) fn has(self, index: usize) -> bool {
        self.0[index / 8] >> (index % 8) & 1 == 1
    }

    /// The least coordinates of bits that are set in a leaf, and the largest plus 1; `None` if there are none.
    pub(super) fn bounds_of_leaf(self) -> Option<[IVec3; 2]> {
        // Eight bytes for each x, a byte for each y, a bit for each z.
        let mut used = [0_u8; 3];
        for (index, &row) in self.0.iter().enumerate().filter(|(_, row)| **row != 0) {
            used[0] |= 1 << (index / 8);
            used[1] |= 1 << (index % 8);
            used[2] |= row;
        }
        let corner = |of: fn(u8) -> u32| IVec3::from_array(used.map(|bits| of(bits) as i32));
        let box_of = || [corner(u8::trailing_zeros), IVec3::splat(8) - corner(u8::leading_zeros)];
        (used[0] != 0).then(box_of)
    }
}
