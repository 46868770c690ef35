//! The SIMD level of kernels: the machine's best, or a lower one for tests and measurements.

use std::sync::OnceLock;

use fearless_simd::Level;

/// The machine's best level, or the lower one that the environment variable `LOOKFROM_SIMD` selects: `sse2`, `avx2`
/// or `avx512`. Results have the same bits at every level; the variable is for tests of this property, and for
/// measuring the effect of a level. A level that the machine does not support, or any other word, selects the best.
///
/// The variable is read once.
pub fn level() -> Level {
    static LEVEL: OnceLock<Level> = OnceLock::new();
    *LEVEL.get_or_init(|| named(&std::env::var("LOOKFROM_SIMD").unwrap_or_default(), Level::new()))
}

/// The word of `LOOKFROM_SIMD`, where it names no level of this machine and changes nothing.
pub fn unmet_level() -> Option<String> {
    let word = std::env::var("LOOKFROM_SIMD").unwrap_or_default();
    let is_met = word.is_empty() || is_level(&word, Level::new());
    (!is_met).then_some(word)
}

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
