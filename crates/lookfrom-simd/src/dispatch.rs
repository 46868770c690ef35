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
#[cfg(target_arch = "x86_64")]
pub fn dispatch<K: Kernel>(level: Level, kernel: K) -> K::Output {
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
    kernel.run(level.as_sse2().expect("x86-64 has SSE2"))
}

/// Runs a kernel with the instructions of a level: see [`Kernel`].
#[inline(always)]
#[cfg(not(target_arch = "x86_64"))]
pub fn dispatch<K: Kernel>(level: Level, kernel: K) -> K::Output {
    fearless_simd::dispatch!(level, simd => kernel.run(simd))
}

/// Runs a kernel with the instructions that all machines of the architecture have: for what is called too seldom to be compiled
/// for each level.
#[inline(always)]
pub fn run_at_baseline<K: Kernel>(kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    return kernel.run(Level::baseline().as_sse2().expect("x86-64 has SSE2"));
    #[cfg(not(target_arch = "x86_64"))]
    dispatch(Level::baseline(), kernel)
}

/// As [`dispatch`], for large kernels, which are compiled once for x86-64: for AVX2, also where there is AVX-512. Eight lanes in the
/// sixteen registers of SSE2 would be most of their code, for machines before 2013; with the registers of AVX-512 they are hardly
/// faster (docs/timings.md). `None` at SSE2; callers go one by one there.
#[inline(always)]
#[cfg(target_arch = "x86_64")]
pub fn dispatch_wide<K: Kernel>(level: Level, kernel: K) -> Option<K::Output> {
    let simd = level.as_avx2()?;
    Some(simd.vectorize(
        #[inline(always)]
        move || kernel.run(simd),
    ))
}

/// As [`dispatch`]: what is compiled less often for x86-64 has one level on other machines.
#[inline(always)]
#[cfg(not(target_arch = "x86_64"))]
pub fn dispatch_wide<K: Kernel>(level: Level, kernel: K) -> Option<K::Output> {
    Some(dispatch(level, kernel))
}

/// Whether [`dispatch_wide`] runs kernels at a level.
#[cfg(target_arch = "x86_64")]
pub fn is_wide(level: Level) -> bool {
    level.as_avx2().is_some()
}

/// Whether [`dispatch_wide`] runs kernels at a level.
#[cfg(not(target_arch = "x86_64"))]
pub fn is_wide(_: Level) -> bool {
    true
}
