//! Which vector instructions are there, and how is code compiled for them?
//!
//! The only file that names the dependency, `fearless_simd`. Code that is generic over [`Simd`] is compiled once a level and
//! chosen when a ray (or a batch) starts, by [`at_level`]. Everything between there and the vectors must be
//! `#[inline(always)]`: a function that is called, not inlined, is compiled for the lowest level.
//!
//! Vectors only ever *exclude*, with room for errors, so hits have the same bits at every level. This module is public for the
//! crate `lookfrom`, whose lane-wise shading has the bits of its plain twin, and for nobody else.

pub use fearless_simd::{
    Level, Simd, f32x4, f32x8, f64x8, i32x8, mask32x8, mask64x8, prelude, u32x4, u32x8, u64x8,
};

/// What is to be done at a level that is known only when the program runs.
pub trait Work {
    /// What comes of it.
    type Output;

    /// Does it. Implementations are `#[inline(always)]`.
    fn run<S: Simd>(self, simd: S) -> Self::Output;
}

/// Does the work with the instructions of a level.
///
/// AVX-512 has twice the registers, which is what it is used for: vectors stay 256 bits long. SSE4.2 is left aside, since it lacks
/// what matters as SSE2 does.
#[inline(always)]
pub fn at_level<W: Work>(level: Level, work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    {
        if let Some(simd) = level.as_avx512() {
            return simd.vectorize(
                #[inline(always)]
                move || work.run(simd),
            );
        }
        if let Some(simd) = level.as_avx2() {
            return simd.vectorize(
                #[inline(always)]
                move || work.run(simd),
            );
        }
        if let Some(simd) = level.as_sse2() {
            return work.run(simd);
        }
        #[cfg(test)]
        return work.run(fearless_simd::Fallback::new());
        #[cfg(not(test))]
        unreachable!("x86-64 has SSE2")
    }
    #[cfg(not(target_arch = "x86_64"))]
    fearless_simd::dispatch!(level, simd => work.run(simd))
}

/// The numbers of the lanes that were chosen, from the least; bit i stands for lane i.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chosen(pub u32);

impl Iterator for Chosen {
    type Item = usize;
    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let lane = (self.0 != 0).then(|| self.0.trailing_zeros() as usize);
        self.0 &= self.0.wrapping_sub(1);
        lane
    }
}

/// Every level that this machine has.
#[cfg(test)]
pub(crate) fn levels() -> Vec<Level> {
    let mut levels = vec![Level::fallback(), Level::baseline(), Level::new()];
    #[cfg(target_arch = "x86_64")]
    levels.extend(Level::new().as_avx2().map(Level::Avx2));
    levels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chosen_lanes_come_in_order() {
        assert_eq!(Chosen(0b1010_0110).collect::<Vec<_>>(), [1, 2, 5, 7]);
        assert_eq!(Chosen(0).next(), None);
    }
}
