//! Paths that wait for others of their kind, so that eight that are shaded side by side take the same way.

use crate::core::lanes::LANES;

/// Paths that wait, by kind: memory that is reused.
#[derive(Debug, Default)]
pub(in crate::integrator) struct Bins {
    bins: Vec<Bin>,
    /// Bit i for bin i: whether it has had paths.
    used: u64,
}

/// Paths of one kind.
#[derive(Clone, Copy, Debug, Default)]
struct Bin {
    paths: [u32; LANES],
    materials: [u32; LANES],
    count: usize,
}

/// Up to eight paths that are shaded side by side.
#[derive(Clone, Copy)]
pub(in crate::integrator) struct Eight<'a> {
    /// Their indices in the batch.
    pub(in crate::integrator) paths: &'a [u32],
    /// Indices into the world's materials, where these were given.
    pub(in crate::integrator) materials: &'a [u32],
}

impl Bin {
    #[inline(always)]
    fn push(&mut self, path: u32, material: u32) {
        let lane = self.count % LANES;
        (self.paths[lane], self.materials[lane]) = (path, material);
        self.count += 1;
    }

    /// Calls `shade` for all, if there are any, and removes them.
    #[inline(always)]
    fn empty(&mut self, shade: impl FnOnce(&Eight<'_>)) {
        if self.count > 0 {
            shade(&Eight { paths: &self.paths[..self.count], materials: &self.materials[..self.count] });
            self.count = 0;
        }
    }
}

impl Bins {
    /// Number of bins: kinds share them where there are more.
    pub(in crate::integrator) const COUNT: usize = 63;

    /// All bins with a number that is divisible by 3.
    pub(in crate::integrator) const EACH_THIRD: u64 = 0x1249_2492_4924_9249;

    /// Adds a path of a kind, and calls `shade` for eight where they fill the lanes.
    #[inline(always)]
    pub(in crate::integrator) fn push(
        &mut self,
        kind: usize,
        path: u32,
        material: u32,
        shade: impl FnOnce(&Eight<'_>),
    ) {
        if self.bins.is_empty() {
            self.bins.resize(Self::COUNT, Bin::default());
        }
        let number = kind % Self::COUNT;
        let bin = &mut self.bins[number];
        bin.push(path, material);
        self.used |= 1 << number;
        if bin.count == LANES {
            bin.empty(shade);
        }
    }

    /// Calls `shade` for the paths that are left in the bins of a mask, up to eight at a time, of whatever kind.
    pub(in crate::integrator) fn flush(&mut self, mask: u64, mut shade: impl FnMut(&Eight<'_>)) {
        let mut rest = Bin::default();
        let mut used = self.used & mask;
        self.used &= !mask;
        while used != 0 {
            let bin = &mut self.bins[used.trailing_zeros() as usize];
            used &= used - 1;
            for lane in 0..bin.count {
                rest.push(bin.paths[lane], bin.materials[lane]);
                if rest.count == LANES {
                    rest.empty(&mut shade);
                }
            }
            bin.count = 0;
        }
        rest.empty(shade);
    }
}
