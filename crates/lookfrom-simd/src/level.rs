//! The SIMD level of a process's kernels: the machine's best, or a lower one for tests and measurements.

use std::fmt;
use std::sync::OnceLock;

use fearless_simd::Level;

static LEVEL: OnceLock<Level> = OnceLock::new();

/// The level of all kernels of this process: the machine's best, unless a lower one was [chosen](choose_level) before.
pub fn level() -> Level {
    *LEVEL.get_or_init(Level::new)
}

/// Chooses the level of all kernels of this process by its name: `sse2`, `avx2` or `avx512`. Results have the same bits at every
/// level; this is for tests of that, and to measure what a level brings. Programs call it before anything else.
///
/// # Errors
/// `Err` where the name is none of a level that this machine has, or kernels have run already; then nothing changes.
pub fn choose_level(name: &str) -> Result<(), UnmetLevel> {
    let best = Level::new();
    let is_met = is_level(name, best) && LEVEL.set(named(name, best)).is_ok();
    if is_met { Ok(()) } else { Err(UnmetLevel) }
}

/// A level that could not be chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnmetLevel;

impl fmt::Display for UnmetLevel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("no SIMD level of this machine, or its kernels have run already")
    }
}

impl std::error::Error for UnmetLevel {}

/// Whether a machine whose best level is `best` has the level of a name.
#[cfg(target_arch = "x86_64")]
fn is_level(name: &str, best: Level) -> bool {
    match name {
        "sse2" => best.as_sse2().is_some(),
        "avx2" => best.as_avx2().is_some(),
        "avx512" => best.as_avx512().is_some(),
        _ => false,
    }
}

/// Other architectures have only one level.
#[cfg(not(target_arch = "x86_64"))]
fn is_level(_: &str, _: Level) -> bool {
    false
}

/// The level of a name if it is at most `best`, otherwise `best`.
#[cfg(target_arch = "x86_64")]
fn named(name: &str, best: Level) -> Level {
    let lower = match name {
        "sse2" => best.as_sse2().map(Level::Sse2),
        "avx2" => best.as_avx2().map(Level::Avx2),
        _ => None,
    };
    lower.unwrap_or(best)
}

/// Other architectures have only one level.
#[cfg(not(target_arch = "x86_64"))]
fn named(_: &str, best: Level) -> Level {
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_words_are_the_best_level() {
        let best = Level::new();
        for word in ["", "avx512", "altivec"] {
            assert_eq!(format!("{:?}", named(word, best)), format!("{best:?}"));
            assert!(word == "avx512" || !is_level(word, best));
        }
    }

    #[test]
    #[cfg(target_arch = "x86_64")]
    fn lower_levels_are_lower() {
        assert!(named("sse2", Level::new()).as_avx2().is_none());
        assert!(named("avx2", Level::new()).as_avx512().is_none());
    }
}
