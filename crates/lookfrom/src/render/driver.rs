//! The render driver: threads, passes, tiles, stop criteria, progress.
//!
//! The value of a sample does not depend on anything here: [`Renderer::render_tile`] computes it, and the film of a
//! number of samples is the same for any division of the work. *Numbers* of samples depend, apart from the clock, only
//! on the film at the ends of *rounds* (after 1, 2, 4 … 64 samples per pixel, then every 64): so adaptive pictures,
//! too, are the same for any number of threads. Whether a tile has enough samples is decided from the samples of its
//! picture, which favours pictures that look clean by chance (a bias towards dark of the order of the remaining noise);
//! it is kept small by a minimum of [`FEWEST_SAMPLES`], and because whole tiles are judged, not pixels.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use lookfrom_scene::Result;
use lookfrom_scene::settings::PixelBounds;

use super::{Batch, Rays, Renderer};
use crate::core::clock::Stopwatch;
use crate::core::parallel;
use crate::film::{Film, FilmTile, Picture};

/// Side of a tile in pixels. One sample of each pixel of a tile is a batch.
const TILE: u32 = 32;

/// Maximum number of samples per pixel between two evaluations of the stop criteria.
const LONGEST_ROUND: u32 = 64;

/// Minimum number of samples per pixel before a tile or picture may count as clean.
pub const FEWEST_SAMPLES: u32 = 16;

/// Stop criteria, besides the number of samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StopCriteria {
    /// Stop after the pass over the picture that reaches this time. At least one sample of each pixel is taken. Never
    /// reached on wasm32-unknown-unknown, which has no clock.
    pub time: Option<Duration>,
    /// Give no more samples to a tile whose [relative error](Film::relative_error) is at most this, and stop when no
    /// other tile is left.
    pub noise: Option<f64>,
}

/// The reason why a render ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum StopReason {
    /// Every pixel has all its samples.
    Samples,
    /// The time limit was reached.
    Time,
    /// Every tile was clean enough.
    Noise,
    /// It was cancelled.
    Cancelled,
}

impl StopReason {
    /// A word for summaries.
    pub fn word(self) -> &'static str {
        match self {
            Self::Samples => "samples",
            Self::Time => "time",
            Self::Noise => "noise",
            Self::Cancelled => "interrupt",
        }
    }
}

/// A tile that has received more samples.
#[derive(Clone, Debug)]
pub struct TileDone {
    /// Its pixels.
    pub area: PixelBounds,
    /// The new samples of each of them.
    pub samples: Range<u32>,
    /// Samples taken so far, of all pixels together.
    pub done: u64,
    /// Samples of all pixels together at the end; an estimate where a stop criterion may end the render.
    pub total: u64,
    /// Rays traced so far.
    pub rays: u64,
    /// The tile's picture so far, if [`Progress::wants_pixels`]: of the size of `area`, row by row from its top left,
    /// linear light.
    pub picture: Option<Picture>,
}

/// Receives the progress of a render, and may cancel it. Called from many threads; no lock is held during the call.
pub trait Progress: Sync {
    /// A tile has received more samples. Tiles may come in any order, those of one area in the order of their samples.
    fn tile(&self, _done: TileDone) {}

    /// Whether tiles should come with their pictures.
    fn wants_pixels(&self) -> bool {
        false
    }

    /// Whether to stop before the next tile.
    fn cancelled(&self) -> bool {
        false
    }

    /// Whether to pause before the next tile for [`Progress::checkpoint`].
    fn wants_checkpoint(&self) -> bool {
        false
    }

    /// The film so far. No thread works on it meanwhile; a parallel loop of rayon runs on the threads of the render.
    fn checkpoint(&self, _film: &Film) {}
}

/// Ignores all progress.
impl Progress for () {}

/// The result of a render.
#[derive(Debug)]
pub struct Rendered {
    /// The film.
    pub film: Film,
    /// Numbers of rays traced.
    pub rays: Rays,
    /// The reason why it ended.
    pub reason: StopReason,
    /// Maximum number of samples of a pixel, without a cancelled pass.
    pub samples: u32,
    /// Samples of all pixels together.
    pub samples_taken: u64,
    /// The [relative error](Film::relative_error) of the whole picture.
    pub error: f64,
}

impl Renderer {
    /// Renders the whole picture with all its samples on `threads` threads (`None` is one per processor). Without the
    /// feature `parallel` it renders on the caller's thread.
    ///
    /// The samples of a pixel are taken in passes of 1, 1, 2, 4 … over the whole picture, so that a render that is
    /// stopped leaves a whole picture behind. The film is the same for any number of threads.
    ///
    /// # Errors
    /// `Limit` if memory for the film or threads are not available.
    pub fn render(&self, threads: Option<usize>, progress: &dyn Progress) -> Result<Rendered> {
        self.render_until(&StopCriteria::default(), threads, progress)
    }

    /// As [`Renderer::render`], but ends early when a stop criterion is met.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn render_until(
        &self,
        stop: &StopCriteria,
        threads: Option<usize>,
        progress: &dyn Progress,
    ) -> Result<Rendered> {
        self.render_onto(Film::for_image(self.image())?, 0, stop, threads, progress)
    }

    /// Adds samples to a film of this picture that may have some already: those from number `first` to the number in the
    /// settings (exclusive) that its [ledger](Film::ledger) lacks. The film is the same as if it had not been
    /// interrupted. That holds for a limit of noise, too, if the film comes from a
    /// [checkpoint](Progress::checkpoint) or the end of a render with the same limit.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn render_onto(
        &self,
        film: Film,
        first: u32,
        stop: &StopCriteria,
        threads: Option<usize>,
        progress: &dyn Progress,
    ) -> Result<Rendered> {
        let tiles = tiles(film.area());
        let all: u64 = tiles.iter().map(area).sum();
        let end = self.settings.samples;
        let work = Work {
            renderer: self,
            progress,
            tiles,
            wanted: first..end,
            done: AtomicU64::new(film.ledger().total()),
            total: AtomicU64::new(all * u64::from(end.saturating_sub(first))),
            film: Mutex::new((film, Rays::default())),
            batches: Mutex::default(),
        };
        let (samples, reason) = parallel::on_threads(threads, || work.rounds(stop))??;
        let (film, rays) = work.film.into_inner().unwrap_or_else(PoisonError::into_inner);
        let error = film.relative_error(film.area(), film.mean_luminance());
        let samples_taken = film.ledger().total();
        Ok(Rendered { film, rays, reason, samples, samples_taken, error })
    }
}

/// A render in progress.
struct Work<'a> {
    renderer: &'a Renderer,
    progress: &'a dyn Progress,
    tiles: Vec<PixelBounds>,
    /// Numbers of the samples that each pixel shall have.
    wanted: Range<u32>,
    film: Mutex<(Film, Rays)>,
    /// The memory of batches that no thread is using.
    batches: Mutex<Vec<Batch>>,
    done: AtomicU64,
    total: AtomicU64,
}

impl Work<'_> {
    /// Takes samples until a criterion is met. Returns the number of samples per pixel of tiles that are not clean, and
    /// the reason why it ended.
    fn rounds(&self, stop: &StopCriteria) -> Result<(u32, StopReason)> {
        let started = Stopwatch::start();
        let Range { start: first, end } = self.wanted;
        let mut samples = 0;
        let mut taken_now = 0;
        for round in rounds(end).filter(|round| round.end > first) {
            let mut start = round.start.max(first);
            while start < round.end {
                let length = match stop.time {
                    Some(time) => affordable(taken_now, started.elapsed(), time),
                    None => u32::MAX,
                };
                let pass = start..round.end.min(start.saturating_add(length));
                match self.pass(pass.clone())? {
                    Pass::Cancelled => return Ok((samples, StopReason::Cancelled)),
                    Pass::Complete => {}
                    Pass::Done => taken_now += pass.end - pass.start,
                }
                (start, samples) = (pass.end, pass.end - first);
                if stop.time.is_some_and(|time| started.elapsed() >= time) && start < end {
                    return Ok((samples, StopReason::Time));
                }
            }
            if let Some(noise) = stop.noise
                && self.leave_clean(round.end, noise)
            {
                return Ok((samples, StopReason::Noise));
            }
        }
        Ok((samples, StopReason::Samples))
    }

    /// Adds the samples to every pixel that lacks them and is not clean.
    fn pass(&self, samples: Range<u32>) -> Result<Pass> {
        let missing = || -> Vec<(PixelBounds, Range<u32>)> {
            let guard = locked(&self.film);
            self.tiles.iter().flat_map(|tile| guard.0.ledger().missing(*tile, &samples)).collect()
        };
        let mut parts = missing();
        if parts.is_empty() {
            return Ok(Pass::Complete);
        }
        while !parts.is_empty() {
            let done = parallel::collect(parts.len(), |index| -> Result<bool> {
                // A part is done between two checkpoints in any case, so that the render comes to its end.
                if self.progress.cancelled() || index > 0 && self.progress.wants_checkpoint() {
                    return Ok(false);
                }
                let (area, samples) = &parts[index];
                self.part(area, samples).map(|()| true)
            });
            let done = done.into_iter().collect::<Result<Vec<bool>>>()?;
            if done.into_iter().all(|done| done) {
                break;
            }
            if self.progress.cancelled() {
                return Ok(Pass::Cancelled);
            }
            self.progress.checkpoint(&locked(&self.film).0);
            parts = missing();
        }
        Ok(Pass::Done)
    }

    /// Adds samples to the pixels of an area.
    fn part(&self, part: &PixelBounds, samples: &Range<u32>) -> Result<()> {
        let mut tile = FilmTile::for_image(*part, self.renderer.image())?;
        let mut batch = locked(&self.batches).pop().unwrap_or_default();
        let rays = self.renderer.render_tile_in(&mut batch, samples.clone(), &mut tile)?;
        locked(&self.batches).push(batch);
        let wants_pixels = self.progress.wants_pixels();
        let (rays, picture) = {
            let mut guard = locked(&self.film);
            guard.0.add_tile(&tile)?;
            guard.1 += rays;
            (guard.1.total(), wants_pixels.then(|| guard.0.picture_of(*part)))
        };
        let of_part = area(part) * u64::from(samples.end - samples.start);
        self.progress.tile(TileDone {
            area: *part,
            samples: samples.clone(),
            done: self.done.fetch_add(of_part, Ordering::Relaxed) + of_part,
            total: self.total.load(Ordering::Relaxed),
            rays,
            picture,
        });
        Ok(())
    }

    /// At the end of a round: marks the tiles that are clean enough, and estimates the number of samples that the
    /// others need. Returns whether all are clean.
    fn leave_clean(&self, samples: u32, noise: f64) -> bool {
        let mut guard = locked(&self.film);
        let film = &mut guard.0;
        // An interrupted render has decided already where samples of a later round are there.
        if samples >= FEWEST_SAMPLES && film.ledger().range().is_none_or(|range| range.end <= samples) {
            let mean = film.mean_luminance();
            let mut total = self.done.load(Ordering::Relaxed) as f64;
            let mut clean = Vec::new();
            for tile in &self.tiles {
                if film.ledger().is_clean(*tile) {
                    continue;
                }
                let error = film.relative_error(*tile, mean);
                // Errors fall with the square root of the number of samples.
                let ratio = error / noise;
                let needed = (f64::from(samples) * ratio * ratio).min(f64::from(self.wanted.end));
                total += area(tile) as f64 * (needed - f64::from(samples)).max(0.0);
                if error <= noise {
                    clean.push(*tile);
                }
            }
            clean.into_iter().for_each(|tile| film.ledger_mut().mark_clean(tile));
            self.total.store(total as u64, Ordering::Relaxed);
        }
        self.tiles.iter().all(|tile| film.ledger().is_clean(*tile))
    }
}

/// The end of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pass {
    /// It has added samples.
    Done,
    /// All samples were there already.
    Complete,
    /// The render was cancelled.
    Cancelled,
}

/// What a mutex guards, though a thread may have panicked while it held it.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Number of samples per pixel in the next pass, if `samples` took `elapsed`: enough to reach the time limit, not to
/// pass it by much.
fn affordable(samples: u32, elapsed: Duration, time: Duration) -> u32 {
    if samples == 0 {
        return 1;
    }
    let left = time.saturating_sub(elapsed).as_secs_f64();
    ((left * f64::from(samples) / elapsed.as_secs_f64().max(1e-9)) as u32).max(1)
}

/// The parts of an area that threads work on.
fn tiles(area: PixelBounds) -> Vec<PixelBounds> {
    let rows = (area.y0..area.y1).step_by(TILE as usize);
    rows.flat_map(|y0| {
        let columns = (area.x0..area.x1).step_by(TILE as usize);
        columns.map(move |x0| PixelBounds {
            x0,
            y0,
            x1: (x0 + TILE).min(area.x1),
            y1: (y0 + TILE).min(area.y1),
        })
    })
    .collect()
}

fn area(tile: &PixelBounds) -> u64 {
    u64::from(tile.x1 - tile.x0) * u64::from(tile.y1 - tile.y0)
}

/// 0..1, 1..2, 2..4, 4..8 … up to `samples`.
fn rounds(samples: u32) -> impl Iterator<Item = Range<u32>> {
    let mut start = 0;
    std::iter::from_fn(move || {
        let length = start.clamp(1, LONGEST_ROUND).min(samples - start);
        let round = start..start + length;
        start = round.end;
        (!round.is_empty()).then_some(round)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_are_aligned_and_whole() {
        for samples in [1, 2, 3, 64, 65, 100, 1000] {
            let rounds: Vec<_> = rounds(samples).collect();
            assert_eq!((rounds[0].start, rounds[rounds.len() - 1].end), (0, samples));
            assert!(rounds.windows(2).all(|pair| pair[0].end == pair[1].start));
            assert!(rounds.iter().all(|round| round.len() <= 64));
        }
    }

    #[test]
    fn the_time_that_is_left_is_used() {
        let ms = Duration::from_millis;
        assert_eq!(affordable(0, ms(0), ms(100)), 1);
        assert_eq!(affordable(4, ms(40), ms(100)), 6);
        assert_eq!(affordable(4, ms(140), ms(100)), 1);
        assert!(affordable(1, ms(0), ms(100)) > 1000);
    }
}
