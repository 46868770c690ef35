//! Values of leaf nodes: numbers, or quantised (`v = code · quantum + minimum`).

use crate::grid::BLOCK;

/// Bytes before the values.
const BASE: usize = 96;

const FLAGS: usize = 15;
const MINIMUM: usize = 80;
const QUANTUM: usize = 84;

/// The type of a grid's leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Numbers.
    Float,
    /// Codes of 2ⁿ bits each.
    Codes(u32),
    /// Codes of 2ⁿ bits each, with an n of each leaf's own, in its flags.
    Mixed,
}

impl Kind {
    /// By the number of the type of a grid.
    pub(super) fn of(number: u32) -> Option<Self> {
        match number {
            1 => Some(Self::Float),
            13..=15 => Some(Self::Codes(number - 11)),
            16 => Some(Self::Mixed),
            _ => None,
        }
    }

    /// Bytes of the shortest leaf.
    pub(super) fn least_bytes(self) -> u64 {
        self.bytes(0)
    }

    /// Bytes of a leaf, of which the first bytes are given; `None` for codes of a size that is not known.
    pub(super) fn bytes_of(self, leaf: &[u8]) -> Option<u64> {
        let log = u32::from(leaf[FLAGS] >> 5);
        (self != Self::Mixed || log <= 4).then(|| self.bytes(log))
    }

    fn bytes(self, log: u32) -> u64 {
        let bits = match self {
            Self::Float => 32,
            Self::Codes(log) => 1 << log,
            Self::Mixed => 1 << log,
        };
        (BASE + (BLOCK * bits) / 8) as u64
    }

    /// The values of a whole leaf, z fastest.
    pub(super) fn values(self, leaf: &[u8]) -> [f32; BLOCK] {
        let (head, body) = leaf.split_at(BASE);
        let log = match self {
            Self::Float => {
                let (numbers, _) = body.as_chunks();
                return std::array::from_fn(|index| f32::from_le_bytes(numbers[index]));
            }
            Self::Codes(log) => log,
            Self::Mixed => u32::from(head[FLAGS] >> 5),
        };
        let number = |at: usize| f32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]);
        let [minimum, quantum] = [number(MINIMUM), number(QUANTUM)];
        let code = |index: usize| match log {
            4 => u16::from_le_bytes([body[2 * index], body[2 * index + 1]]),
            _ => {
                let bit = index << log;
                u16::from(body[bit / 8] >> (bit % 8)) & ((1 << (1 << log)) - 1)
            }
        };
        std::array::from_fn(|index| f32::from(code(index)) * quantum + minimum)
    }
}
