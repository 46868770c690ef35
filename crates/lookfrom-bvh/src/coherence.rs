//! Coherence of packets: the tests that a packet takes, compared with the rays that gain from them.
//!
//! Where one or two rays of a group meet a block of triangles together, as with triangles smaller than the distance
//! between rays, single rays are faster, since they test eight triangles at once. A packet that finds this is given up,
//! and after it fewer are tried.
//!
//! The unit of cost is the test of eight rays from a common origin and one triangle (see `common_origin`).

use crate::ray8::GROUPS;

/// Cost per ray with which a packet is about as fast as single rays.
const WORTHWHILE: f32 = 10.0;

/// Cost of a block, or another leaf, for a group of any rays.
const GROUP: u32 = 25;

/// Cost of a block for rays from a common origin before any triangle is tested: as seen by the packet, and by its groups.
const SEEN: u32 = 4;
const ENTERED: u32 = 6;

/// Cost after which a packet is judged, and again after four times as much.
const FIRST_JUDGEMENT: u32 = 160;

/// Largest number of packets that are left out before another one is tried.
const MOST_SKIPPED: u32 = 15;

/// Counts of the packets of a batch.
#[derive(Default)]
pub(crate) struct Coherence {
    cost: u32,
    rays: u32,
    judgement: u32,
    to_skip: u32,
    skipped: u32,
}

impl Coherence {
    /// Starts a packet. Returns false where it is better left out.
    #[inline(always)]
    pub(crate) fn start(&mut self) -> bool {
        if self.skipped < self.to_skip {
            self.skipped += 1;
            return false;
        }
        *self = Self { judgement: FIRST_JUDGEMENT, to_skip: self.to_skip, ..Self::default() };
        true
    }

    /// Counts the groups that meet a block, given the rays of each that do; a block that no ray meets counts as one.
    #[inline(always)]
    pub(crate) fn count(&mut self, meeting: &[u32; GROUPS]) {
        let mut groups = 0;
        for rays in meeting {
            groups += u32::from(*rays != 0);
            self.rays += rays.count_ones();
        }
        self.cost += GROUP * groups.max(1);
    }

    /// Counts a block for rays from a common origin: whether the packet enters it, the tests of eight rays and a
    /// triangle, and the rays that may hit one.
    #[inline(always)]
    pub(crate) fn count_common(&mut self, is_entered: bool, tests: u32, rays: u32) {
        self.cost += SEEN + ENTERED * u32::from(is_entered) + tests;
        self.rays += rays;
    }

    /// Whether the packet pays, as far as it has come.
    #[inline(always)]
    pub(crate) fn pays(&mut self) -> bool {
        if self.cost < self.judgement {
            return true;
        }
        self.judgement *= 4;
        self.rays as f32 * WORTHWHILE >= self.cost as f32
    }

    /// Ends a packet.
    #[inline(always)]
    pub(crate) fn end(&mut self, has_paid: bool) {
        self.to_skip = if has_paid { self.to_skip / 2 } else { (2 * self.to_skip + 1).min(MOST_SKIPPED) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packets_are_left_out_after_some_that_did_not_pay() {
        let mut coherence = Coherence::default();
        let mut tried = 0;
        for _ in 0..100 {
            if coherence.start() {
                tried += 1;
                while coherence.pays() {
                    coherence.count(&[1, 0, 2, 0, 0, 0, 0, 0x80]);
                }
                coherence.end(false);
            }
        }
        assert_eq!(tried, 9);
        // Then they pay again, and soon all are tried.
        let tried = (0..100)
            .filter(|_| {
                let starts = coherence.start();
                if starts {
                    (0..100).for_each(|_| coherence.count(&[0xff, 7, 0, 0, 0, 0, 0, 0]));
                    assert!(coherence.pays());
                    coherence.end(true);
                }
                starts
            })
            .count();
        assert!(tried > 65, "{tried}");
    }
}
