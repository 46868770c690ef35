//! Coherence of packets: the number of rays of a group that meet a block of triangles together.
//!
//! Where it is one or two, as with triangles smaller than the distance between rays, single rays are faster, since they
//! test eight triangles at once. A packet that finds this is given up, and after it fewer are tried.

use crate::ray8::GROUPS;

/// Rays per group with which a packet is about as fast as single rays.
const WORTHWHILE: f32 = 2.5;

/// Groups that have met a block before a packet is judged, and again after four times as many.
const FIRST_JUDGEMENT: u32 = 24;

/// Largest number of packets that are left out before another one is tried.
const MOST_SKIPPED: u32 = 15;

/// Counts of the packets of a batch.
#[derive(Default)]
pub(crate) struct Coherence {
    groups: u32,
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
        self.groups += groups.max(1);
    }

    /// Whether the packet pays, as far as it has come.
    #[inline(always)]
    pub(crate) fn pays(&mut self) -> bool {
        if self.groups < self.judgement {
            return true;
        }
        self.judgement *= 4;
        self.rays as f32 >= WORTHWHILE * self.groups as f32
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
