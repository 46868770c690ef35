//! Rounds: the paths of a batch so divided that a step may take those of a round in any order.
//!
//! Light is added to a sample in the order of its paths, since sums of floating-point numbers depend on it.

use crate::integrator::Path;

/// The paths of a batch in rounds: a round has at most one path of each sample, and of two paths of a sample the earlier is
/// in the earlier round. Memory that is reused.
#[derive(Debug, Default)]
pub(in crate::integrator) struct Rounds {
    /// Indices of the paths, round by round.
    order: Vec<u32>,
    /// The ends of the rounds in `order`.
    ends: Vec<usize>,
    /// Number of paths so far of each slot.
    counts: Vec<u32>,
}

impl Rounds {
    /// Divides the paths of a batch.
    pub(in crate::integrator) fn divide(&mut self, paths: &[Path]) {
        let Self { order, ends, counts } = self;
        counts.clear();
        ends.clear();
        let round_of = |counts: &mut Vec<u32>, path: &Path| {
            let slot = path.slot as usize;
            if slot >= counts.len() {
                counts.resize(slot + 1, 0);
            }
            counts[slot] += 1;
            counts[slot] as usize - 1
        };
        // Count the paths of each round.
        for path in paths {
            let round = round_of(counts, path);
            if round == ends.len() {
                ends.push(0);
            }
            ends[round] += 1;
        }
        // Their places begin where those of the round before end.
        let mut next = 0;
        for end in ends.iter_mut() {
            next += std::mem::replace(end, next);
        }
        counts.fill(0);
        order.resize(paths.len(), 0);
        for (index, path) in (0..).zip(paths) {
            let place = &mut ends[round_of(counts, path)];
            order[*place] = index;
            *place += 1;
        }
    }

    /// Number of rounds.
    pub(in crate::integrator) fn count(&self) -> usize {
        self.ends.len()
    }

    /// Indices of the paths of a round.
    pub(in crate::integrator) fn paths(&self, round: usize) -> &[u32] {
        let first = round.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.order[first..self.ends[round]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::LightPathState;
    use crate::shading::interior_stack::InteriorStack;

    #[test]
    fn a_round_has_one_path_of_each_sample_in_their_order() {
        let path = |(address, slot): (u64, u32)| Path {
            ray: lookfrom_bvh::Ray::new([0.0; 3], [0.0, 0.0, 1.0]),
            beta: crate::core::spectrum::Spectrum::splat(1.0),
            slot,
            depth: 0,
            address,
            interior: InteriorStack::default(),
            origin_primitive: lookfrom_bvh::OriginPrimitive::NONE,
            blurred: false,
            state: (),
            light_path: LightPathState::default(),
        };
        let mut rounds = Rounds::default();
        for (slots, expected) in [
            (vec![], vec![]),
            (vec![2, 0, 1], vec![vec![0, 1, 2]]),
            (vec![3, 3, 1, 3, 0, 1], vec![vec![0, 2, 4], vec![1, 5], vec![3]]),
        ] {
            let paths: Vec<Path> = (1..).zip(slots).map(path).collect();
            rounds.divide(&paths);
            let found: Vec<_> = (0..rounds.count()).map(|round| rounds.paths(round).to_vec()).collect();
            assert_eq!(found, expected);
        }
    }
}
