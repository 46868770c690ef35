//! SIMD dispatch of the kernel: `lookfrom_simd`'s, and in unit tests the scalar level as well.

use lookfrom_simd::{Kernel, Level};

/// [`lookfrom_simd::dispatch`].
#[inline(always)]
pub(crate) fn dispatch<K: Kernel>(level: Level, kernel: K) -> K::Output {
    #[cfg(test)]
    if level.is_fallback() {
        return kernel.run(fearless_simd::Fallback::new());
    }
    lookfrom_simd::dispatch(level, kernel)
}

/// Every level that this machine has.
#[cfg(test)]
pub(crate) fn levels() -> Vec<Level> {
    let mut levels = vec![Level::fallback(), Level::baseline(), Level::new()];
    #[cfg(target_arch = "x86_64")]
    levels.extend(Level::new().as_avx2().map(Level::Avx2));
    levels
}
