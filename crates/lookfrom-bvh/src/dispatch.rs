//! SIMD dispatch of the kernel: `lookfrom_simd`'s. Unit tests of small parts also use the scalar level, for which
//! the traversal is too large: it would be half of the tests' compile time.

#[cfg(test)]
use lookfrom_simd::{Kernel, Level};
pub(crate) use lookfrom_simd::{dispatch, run_at_baseline};

/// [`dispatch`], or the scalar level.
#[cfg(test)]
pub(crate) fn dispatch_or_scalar<K: Kernel>(level: Level, kernel: K) -> K::Output {
    if level.is_fallback() {
        return kernel.run(fearless_simd::Fallback::new());
    }
    dispatch(level, kernel)
}

/// All vector levels of this machine.
#[cfg(test)]
pub(crate) fn levels() -> Vec<Level> {
    let mut levels = vec![Level::baseline(), Level::new()];
    #[cfg(target_arch = "x86_64")]
    levels.extend(Level::new().as_avx2().map(Level::Avx2));
    levels
}

/// All vector levels and the scalar one, for [`dispatch_or_scalar`].
#[cfg(test)]
pub(crate) fn levels_and_scalar() -> Vec<Level> {
    [vec![Level::fallback()], levels()].concat()
}
