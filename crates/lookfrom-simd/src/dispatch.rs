//! Run-time dispatch: generic code, compiled for the instructions of each level, and the level chosen when work starts.

use fearless_simd::{Level, Simd};

/// What is to be done at a level that is known only when the program runs.
///
/// ```
/// use lookfrom_simd::{Level, Simd, Kernel, dispatch, f32x8, prelude::*};
/// struct Twice([f32; 8]);
/// impl Kernel for Twice {
///     type Output = [f32; 8];
///     #[inline(always)]
///     fn run<S: Simd>(self, simd: S) -> [f32; 8] {
///         let x = f32x8::load_array(simd, self.0);
///         (x + x).into()
///     }
/// }
/// assert_eq!(dispatch(Level::new(), Twice([1.5; 8])), [3.0; 8]);
/// ```
pub trait Kernel {
    /// What comes of it.
    type Output;

    /// Does it. Implementations are `#[inline(always)]`.
    fn run<S: Simd>(self, simd: S) -> Self::Output;
}

/// Does the work with the instructions of a level: see [`Kernel`].
///
/// AVX-512 has twice the registers, which is what it is used for: vectors stay 256 bits long. SSE4.2 is left aside, since it lacks
/// what matters as SSE2 does. On x86-64 there is no scalar level.
#[inline(always)]
pub fn dispatch<W: Kernel>(level: Level, work: W) -> W::Output {
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
        unreachable!("x86-64 has SSE2")
    }
    #[cfg(not(target_arch = "x86_64"))]
    fearless_simd::dispatch!(level, simd => work.run(simd))
}
