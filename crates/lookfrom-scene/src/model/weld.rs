//! Vertex deduplication: equal tuples get one id.
//!
//! An open-addressing hash table from tuples to ids in the order of first appearance. Its hash is seeded randomly, so
//! that no file can be constructed to make it slow; ids do not depend on the seed.

use std::hash::{BuildHasher, RandomState};

const EMPTY: u32 = u32::MAX;

/// Tuples with ids 0, 1, 2 … in the order of first appearance.
pub(crate) struct Weld<const N: usize> {
    keys: Vec<[u32; N]>,
    /// Ids in a hash table whose size is a power of two, at most half full.
    slots: Vec<u32>,
    secret: [u64; 2],
}

impl<const N: usize> Weld<N> {
    /// An empty set.
    pub(crate) fn new() -> Self {
        let state = RandomState::new();
        Self { keys: Vec::new(), slots: vec![EMPTY; 16], secret: [state.hash_one(0), state.hash_one(1)] }
    }

    /// All tuples; a tuple's id is its index.
    pub(crate) fn keys(&self) -> &[[u32; N]] {
        &self.keys
    }

    /// The id of a tuple, a new one if the tuple is new. There may be fewer than 2³² − 1 tuples.
    pub(crate) fn id(&mut self, key: [u32; N]) -> u32 {
        let mask = self.slots.len() - 1;
        let mut slot = self.hash(&key) & mask;
        loop {
            match self.slots[slot] {
                EMPTY => break,
                id if self.keys[id as usize] == key => return id,
                _ => slot = (slot + 1) & mask,
            }
        }
        let id = self.keys.len() as u32;
        self.slots[slot] = id;
        self.keys.push(key);
        if 2 * self.keys.len() > self.slots.len() {
            self.grow();
        }
        id
    }

    fn grow(&mut self) {
        let mask = 4 * self.slots.len() - 1;
        let mut slots = vec![EMPTY; mask + 1];
        for (id, key) in self.keys.iter().enumerate() {
            let mut slot = self.hash(key) & mask;
            while slots[slot] != EMPTY {
                slot = (slot + 1) & mask;
            }
            slots[slot] = id as u32;
        }
        self.slots = slots;
    }

    fn hash(&self, key: &[u32; N]) -> usize {
        let fold = |a: u64, b: u64| {
            let product = u128::from(a) * u128::from(b);
            product as u64 ^ (product >> 64) as u64
        };
        let mixed = key.iter().fold(self.secret[0], |hash, &part| {
            fold(hash ^ u64::from(part), 0x9e37_79b9_7f4a_7c15 ^ (self.secret[1] << 1))
        });
        mixed as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn agrees_with_a_list(keys in prop::collection::vec([0_u32..5, 0_u32..5, 0_u32..2], 0..300)) {
            let mut weld = Weld::new();
            let mut list: Vec<[u32; 3]> = Vec::new();
            for key in keys {
                let slow = list.iter().position(|&other| other == key).unwrap_or_else(|| {
                    list.push(key);
                    list.len() - 1
                });
                prop_assert_eq!(weld.id(key) as usize, slow);
            }
            prop_assert_eq!(weld.keys(), &list[..]);
        }
    }
}
