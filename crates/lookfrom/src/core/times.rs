//! The times of samples while the shutter is open.

/// Times from 0, the opening of the shutter, to 1, by slot or by ray; where nothing moves none, and then all are 0.
#[derive(Clone, Debug, Default)]
pub struct Times(Vec<f32>);

impl Times {
    /// Whether nothing moves.
    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Replaces all.
    pub(crate) fn replace(&mut self, times: impl Iterator<Item = f32>) {
        self.0.clear();
        self.0.extend(times);
    }

    /// Replaces all by the times of rays, by their slots in others.
    pub(crate) fn gather(&mut self, of: &Self, slots: impl Iterator<Item = u32>) {
        self.0.clear();
        if !of.is_empty() {
            self.0.extend(slots.map(|slot| of.0[slot as usize]));
        }
    }

    /// The time of a slot or a ray.
    #[inline]
    pub fn of(&self, index: usize) -> f32 {
        self.0.get(index).copied().unwrap_or(0.0)
    }

    /// As the kernel takes them.
    pub(crate) fn as_slice(&self) -> &[f32] {
        &self.0
    }
}
