//! Run-time dispatch: a generic kernel is compiled for the instructions of each level, and the level is chosen at
//! run time.

use fearless_simd::{Level, Simd};

/// A computation at a level that is known only at run time.
///
/// ```
/// use lookfrom_simd::{Kernel, Level, Simd, dispatch, f32x8, prelude::*};
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
    /// Its result.
    type Output;

    /// Runs it. Implementations are `#[inline(always)]`.
    fn run<S: Simd>(self, simd: S) -> Self::Output;
}

/// Runs a kernel with the instructions of a level: see [`Kernel`].
///
/// AVX-512 is used for its doubled number of registers; vectors stay 256 bits long, except where a kernel asks for more
/// (packets of rays against triangles). SSE4.2 is not used, since it has no advantage over SSE2 here. On x86-64 there is
/// no scalar level.
#[inline(always)]
pub fn dispatch<K: Kernel>(level: Level, kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    {
        if let Some(simd) = level.as_avx512() {
            return simd.vectorize(
                #[inline(always)]
                move || kernel.run(simd),
            );
        }
        if let Some(simd) = level.as_avx2() {
            return simd.vectorize(
                #[inline(always)]
                move || kernel.run(simd),
            );
        }
        if let Some(simd) = level.as_sse2() {
            return kernel.run(simd);
        }
        unreachable!("x86-64 has SSE2")
    }
    #[cfg(not(target_arch = "x86_64"))]
    fearless_simd::dispatch!(level, simd => kernel.run(simd))
}

/// Whether [`dispatch_wide`] runs kernels at a level.
#[inline]
pub fn is_wide(level: Level) -> bool {
    #[cfg(target_arch = "x86_64")]
    return level.as_avx2().is_some();
    #[cfg(not(target_arch = "x86_64"))]
    return {
        let _ = level;
        true
    };
}

/// As [`dispatch`], for large kernels, which are not compiled for SSE2: eight lanes in its sixteen registers of four would
/// be most of their code, for machines before 2013. `None` at that level; callers go one by one there.
#[inline(always)]
pub fn dispatch_wide<K: Kernel>(level: Level, kernel: K) -> Option<K::Output> {
    #[cfg(target_arch = "x86_64")]
    {
        if let Some(simd) = level.as_avx512() {
            return Some(simd.vectorize(
                #[inline(always)]
                move || kernel.run(simd),
            ));
        }
        if let Some(simd) = level.as_avx2() {
            return Some(simd.vectorize(
                #[inline(always)]
                move || kernel.run(simd),
            ));
        }
        None
    }
    #[cfg(not(target_arch = "x86_64"))]
    Some(dispatch(level, kernel))
}
