//! Wall-clock time, where the platform has a clock.
//!
//! `std::time::Instant` panics on wasm32-unknown-unknown. There the clock is the one that the program around gives
//! (`use_clock`); until then durations are zero, and a time limit never ends a render.

#[cfg(all(target_family = "wasm", target_os = "unknown"))]
use std::sync::OnceLock;
use std::time::Duration;
#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
use std::time::Instant;

/// The time since any moment that stays the same.
#[cfg(all(target_family = "wasm", target_os = "unknown"))]
static CLOCK: OnceLock<fn() -> Duration> = OnceLock::new();

/// Sets the clock of this process, once: `now` returns the time since any moment that stays the same.
#[cfg(all(target_family = "wasm", target_os = "unknown"))]
pub fn use_clock(now: fn() -> Duration) {
    // The first stays.
    let _ = CLOCK.set(now);
}

/// A running stopwatch.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch {
    #[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
    started: Instant,
    #[cfg(all(target_family = "wasm", target_os = "unknown"))]
    started: Duration,
}

impl Stopwatch {
    /// Starts a stopwatch.
    pub fn start() -> Self {
        Self {
            #[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
            started: Instant::now(),
            #[cfg(all(target_family = "wasm", target_os = "unknown"))]
            started: now(),
        }
    }

    /// The time since the start; zero where there is no clock.
    pub fn elapsed(self) -> Duration {
        #[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
        return self.started.elapsed();
        #[cfg(all(target_family = "wasm", target_os = "unknown"))]
        now().saturating_sub(self.started)
    }
}

#[cfg(all(target_family = "wasm", target_os = "unknown"))]
fn now() -> Duration {
    CLOCK.get().map_or(Duration::ZERO, |now| now())
}
