//! The output of a step in the order of its paths, in whatever order these are taken.
//!
//! Light is added to a sample in the order of its paths, since sums of floating-point numbers depend on it.

use crate::integrator::{Path, PathState, Probe, Shadows, StepOutput};

/// The lengths of the lists of a step's output: light, shadow rays, further paths.
pub(in crate::integrator) type Lengths = [usize; 3];

/// What each path has added to the output. Memory that is reused.
#[derive(Debug)]
pub(in crate::integrator) struct InOrder<S = ()> {
    /// The lengths of the lists before and after each path.
    runs: Vec<[Lengths; 2]>,
    /// The lists in the order of the paths.
    shadows: Shadows,
    paths: Vec<Path<S>>,
    /// Slots that occurred, 64 in each number.
    slots: Vec<u64>,
}

impl<S> Default for InOrder<S> {
    fn default() -> Self {
        Self { runs: Vec::new(), shadows: Shadows::default(), paths: Vec::new(), slots: Vec::new() }
    }
}

impl<S: PathState> InOrder<S> {
    /// Whether any two paths belong to one sample, so that their order matters.
    pub(in crate::integrator) fn is_needed(&mut self, paths: &[Path<S>]) -> bool {
        self.slots.clear();
        paths.iter().any(|path| {
            let (number, bit) = (path.slot as usize / 64, 1 << (path.slot % 64));
            if number >= self.slots.len() {
                self.slots.resize(number + 1, 0);
            }
            let is_known = self.slots[number] & bit != 0;
            self.slots[number] |= bit;
            is_known
        })
    }

    /// Prepares for a number of paths, and keeps light from being added before [`InOrder::finish`].
    pub(in crate::integrator) fn begin<P: Probe>(&mut self, count: usize, output: &mut StepOutput<'_, P, S>) {
        self.runs.clear();
        self.runs.resize(count, [[0; 3]; 2]);
        output.deferred.get_or_insert_default();
    }

    /// Notes what a path has added since the lists had the lengths `before`.
    #[inline]
    pub(in crate::integrator) fn note(&mut self, path: u32, before: Lengths, after: Lengths) {
        self.runs[path as usize] = [before, after];
    }

    /// Adds the light, and puts shadow rays and paths in order.
    pub(in crate::integrator) fn finish<P: Probe>(&mut self, output: &mut StepOutput<'_, P, S>) {
        let light = output.deferred.take().unwrap_or_default();
        for [[lights, shadows, paths], [lights_end, shadows_end, paths_end]] in &self.runs {
            light[*lights..*lights_end].iter().for_each(|light| output.add_light(light));
            self.shadows.extend_from(&output.queues.shadows, *shadows..*shadows_end);
            self.paths.extend_from_slice(&output.paths[*paths..*paths_end]);
        }
        std::mem::swap(&mut self.shadows, &mut output.queues.shadows);
        std::mem::swap(&mut self.paths, &mut output.paths);
        self.shadows.clear();
        self.paths.clear();
    }
}

impl<P: Probe, S> StepOutput<'_, P, S> {
    /// The lengths of the lists.
    #[inline]
    pub(in crate::integrator) fn lengths(&self) -> Lengths {
        [self.deferred.as_ref().map_or(0, Vec::len), self.queues.shadows.len(), self.paths.len()]
    }
}
