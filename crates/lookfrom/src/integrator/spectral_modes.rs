//! The spectral modes of the samples of a batch.

use std::ops::{Index, IndexMut};

use crate::shading::texture::SpectralMode;

/// Spectral modes, by slot. Of samples in RGB, which all have the same, there is one.
#[derive(Debug, Default)]
pub struct SpectralModes(Vec<SpectralMode>);

impl SpectralModes {
    /// Replaces all by those of other samples.
    pub(super) fn start(&mut self, modes: impl Iterator<Item = SpectralMode>) {
        self.0.clear();
        self.0.extend(modes);
    }

    /// The mode that all samples have, if there is only one.
    pub(super) fn of_all(&self) -> Option<&SpectralMode> {
        self.0.first().filter(|_| self.0.len() == 1)
    }

    #[inline(always)]
    fn place(&self, slot: usize) -> usize {
        slot.min(self.0.len() - 1)
    }
}

impl Index<usize> for SpectralModes {
    type Output = SpectralMode;

    #[inline(always)]
    fn index(&self, slot: usize) -> &SpectralMode {
        &self.0[self.place(slot)]
    }
}

impl IndexMut<usize> for SpectralModes {
    #[inline(always)]
    fn index_mut(&mut self, slot: usize) -> &mut SpectralMode {
        let place = self.place(slot);
        &mut self.0[place]
    }
}
