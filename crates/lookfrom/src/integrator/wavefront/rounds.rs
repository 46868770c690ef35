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
    /// The round of each path.
    rounds: Vec<u32>,
    /// Number of paths so far of each slot; zeros between batches.
    counts: Vec<u32>,
}

impl Rounds {
    /// Divides the paths of a batch with a number of slots.
    pub(in crate::integrator) fn divide<S>(&mut self, paths: &[Path<S>], slots: usize) {
        let Self { order, ends, rounds, counts } = self;
        if counts.len() < slots {
            counts.resize(slots, 0);
        }
        // Count the paths of each round.
        ends.clear();
        rounds.clear();
        for path in paths {
            let count = &mut counts[path.slot as usize];
            let round = *count as usize;
            if round == ends.len() {
                ends.push(0);
            }
            ends[round] += 1;
            rounds.push(*count);
            *count += 1;
        }
        paths.iter().for_each(|path| counts[path.slot as usize] = 0);
        // Their places begin where those of the round before end.
        let mut next = 0;
        for end in ends.iter_mut() {
            next += std::mem::replace(end, next);
        }
        order.resize(paths.len(), 0);
        for (index, round) in (0..).zip(&*rounds) {
            let place = &mut ends[*round as usize];
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
            rounds.divide(&paths, 4);
            let found: Vec<_> = (0..rounds.count()).map(|round| rounds.paths(round).to_vec()).collect();
            assert_eq!(found, expected);
        }
    }
}
