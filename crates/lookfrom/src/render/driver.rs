//! The render driver: threads, passes, tiles.
//!
//! The value of a sample does not depend on anything here: [`Renderer::render_tile`] computes it, and the film of a
//! number of samples is the same for any division of the work. *Numbers* of samples depend, apart from the clock, only
//! on the film when all pixels have the samples that were decided before: so adaptive pictures, too, are the same for any
//! number of threads. How many each pixel gets is [allocated](crate::film::allocation) without bias: once, for a number of
//! samples in the mean, or again and again, until the picture's error is below a limit.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use lookfrom_scene::settings::PixelBounds;
use lookfrom_scene::{Error, ErrorKind, Location, Result};

use super::parts::{TilePart, divided, parts, rows, tiles};
use super::progress::{Progress, Rendered, StopCriteria, StopReason, TileDone};
use super::{Batch, Rays, Renderer};
use crate::core::clock::Stopwatch;
use crate::core::parallel;
use crate::film::allocation;
use crate::film::{Film, FilmTile};

/// Maximum number of samples per pixel between two evaluations of the stop criteria.
const LONGEST_ROUND: u32 = 64;

/// Time of a pass that nobody would wait for: passes that are shorter are taken together, since each has its costs.
const MOMENT: Duration = Duration::from_millis(100);

/// Number of parts of a pass for each of several threads: those of small pictures are divided by their samples.
const PARTS: usize = 4;

/// Number of samples of each pixel of a part between two looks for a cancellation.
const MOST_TOGETHER: u32 = 8;

/// Times of one sample of each pixel of a part, in nanoseconds, from which on a cancellation is looked for after each
/// sample, and after each row.
const SLOW: u64 = 100_000_000;
const VERY_SLOW: u64 = 600_000_000;

/// Minimum number of samples per pixel before a picture may count as clean.
pub const FEWEST_SAMPLES: u32 = 16;

impl Renderer {
    /// Renders the whole picture with all its samples on `threads` threads, but at most [`MOST_THREADS`](super::MOST_THREADS)
    /// (`None` is one per processor). Without the feature `parallel` it renders on the caller's thread.
    ///
    /// The samples of a pixel are taken in passes of 1, 1, 2, 4 … over the whole picture, or of as many as take a moment, so that a
    /// render that is stopped leaves a whole picture behind. The film is the same for any number of threads.
    ///
    /// # Errors
    /// `Limit` if memory for the film or threads are not available.
    pub fn render(&self, threads: Option<usize>, progress: &dyn Progress) -> Result<Rendered> {
        self.render_until(&StopCriteria::default(), threads, progress)
    }

    /// As [`Renderer::render`], but ends early when a stop criterion is met.
    ///
    /// # Errors
    /// As [`Renderer::render`]; `Request` for a limit of noise that is negative or not a number, and together with adaptive
    /// allocation.
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
    /// As [`Renderer::render`]; `Request` for adaptive allocation together with a limit of noise, for either of a part of the
    /// samples, and for a limit of noise that is negative or not a number.
    pub fn render_onto(
        &self,
        film: Film,
        first: u32,
        stop: &StopCriteria,
        threads: Option<usize>,
        progress: &dyn Progress,
    ) -> Result<Rendered> {
        stop.check()?;
        let pilot = self.pilot();
        let refused = |message: &str| Err(Error::new(ErrorKind::Request, &Location::default(), message));
        if first != 0 && (pilot.is_some() || stop.noise.is_some()) {
            return refused(
                "adaptive sampling decides by a picture's first samples: it needs all from the first on",
            );
        } else if pilot.is_some() && stop.noise.is_some() {
            return refused(
                "adaptive allocation is of a number of samples; a limit of noise has no such number",
            );
        }
        let tiles = tiles(film.area());
        let all: u64 = tiles.iter().map(|tile| tile.pixels()).sum();
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
            cost: AtomicU64::new(0),
        };
        let (samples, reason) = parallel::on_threads(threads, || work.render(stop, pilot))??;
        let (film, rays) = work.film.into_inner().unwrap_or_else(PoisonError::into_inner);
        let error = film.relative_error(film.area(), film.mean_luminance());
        let samples_taken = film.ledger().total();
        Ok(Rendered { film, rays, reason, samples, samples_taken, error })
    }

    /// The number of samples per pixel after which the others are allocated; `None` where all pixels get the same.
    fn pilot(&self) -> Option<u32> {
        let of_pixel = allocation::of_pixel(&self.settings);
        (of_pixel.start() < of_pixel.end()).then_some(*of_pixel.start())
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
    /// Time of a sample in the last piece of work, in nanoseconds; 0 before the first.
    cost: AtomicU64,
}

impl Work<'_> {
    /// Takes samples until a criterion is met. Returns the greatest number of samples of a pixel, and the reason why it ended.
    fn render(&self, stop: &StopCriteria, pilot: Option<u32>) -> Result<(u32, StopReason)> {
        let mut clock = Clock { started: Stopwatch::start(), taken: 0 };
        let end = self.wanted.end;
        let Some(pilot) = pilot.or_else(|| stop.noise.map(|_| FEWEST_SAMPLES.min(end))) else {
            return self.rounds(0..end, stop, &mut clock);
        };
        let (mut samples, mut reason) = self.rounds(0..pilot, stop, &mut clock)?;
        // An interrupted render has decided already.
        let mut decided = self.goals();
        while reason == StopReason::Samples {
            let Some((total, most)) = decided.take().or_else(|| self.decide(stop.noise)) else {
                return Ok((samples, if self.is_clean(stop.noise) { StopReason::Noise } else { reason }));
            };
            self.total.store(total, Ordering::Relaxed);
            let further = self.rounds(pilot..most, stop, &mut clock)?;
            (samples, reason) = (samples.max(further.0), further.1);
            if stop.noise.is_none() {
                break;
            }
        }
        Ok((samples, reason))
    }

    /// Takes a range of samples in rounds, until a criterion is met.
    fn rounds(
        &self,
        wanted: Range<u32>,
        stop: &StopCriteria,
        clock: &mut Clock,
    ) -> Result<(u32, StopReason)> {
        let first = self.wanted.start;
        let (mut start, mut samples) = (wanted.start.max(first), 0);
        while start < wanted.end {
            let most = stop.time.map_or(u32::MAX, |time| clock.affordable(time));
            let length = (end_of_round(start) - start).max(clock.in_a_moment()).min(most);
            let pass = start..wanted.end.min(start.saturating_add(length));
            match self.pass(pass.clone())? {
                Pass::Cancelled => return Ok((samples, StopReason::Cancelled)),
                Pass::Complete => {}
                Pass::Done => {
                    clock.taken += pass.end - pass.start;
                    // One of a single part has had none meanwhile.
                    if pass.end < wanted.end && self.progress.wants_checkpoint() {
                        self.progress.checkpoint(&locked(&self.film).0);
                    }
                }
            }
            (start, samples) = (pass.end, pass.end - first);
            if stop.time.is_some_and(|time| clock.started.elapsed() >= time) && start < wanted.end {
                return Ok((samples, StopReason::Time));
            }
        }
        Ok((samples, StopReason::Samples))
    }

    /// Adds the samples to every pixel that lacks them.
    fn pass(&self, samples: Range<u32>) -> Result<Pass> {
        // Pictures of a tile come in the order of its samples.
        let threads = if self.progress.wants_pixels() { 1 } else { parallel::threads() };
        let missing = || -> Vec<TilePart> {
            let guard = locked(&self.film);
            let of_tile = |tile: &PixelBounds| parts(guard.0.ledger().missing(*tile, &samples));
            let parts = self.tiles.iter().flat_map(of_tile).collect();
            if threads > 1 { divided(parts, PARTS * threads) } else { parts }
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
                self.part(&parts[index])
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

    /// Adds the samples of a part, unless it is cancelled meanwhile; returns whether they are added.
    fn part(&self, TilePart { areas, samples }: &TilePart) -> Result<bool> {
        let Some(around) = areas.iter().copied().reduce(PixelBounds::union) else { return Ok(true) };
        let mut tile = FilmTile::for_image(around, self.renderer.image())?;
        let mut batch = locked(&self.batches).pop().unwrap_or_default();
        let rays = self.rays_of_part(&mut batch, areas, samples.clone(), &mut tile)?;
        locked(&self.batches).push(batch);
        let Some(rays) = rays else { return Ok(false) };
        let (rays, picture) = if self.progress.wants_pixels() {
            // Under one lock, so that no block is missing from the picture.
            let mut guard = locked(&self.film);
            guard.0.add_tile(&tile)?;
            guard.1 += rays;
            (guard.1.total(), Some(guard.0.picture_of(around)))
        } else {
            let mut detached = locked(&self.film).0.detach(&tile)?;
            detached.add(&tile);
            let mut guard = locked(&self.film);
            guard.0.attach(detached);
            guard.1 += rays;
            (guard.1.total(), None)
        };
        let of_part =
            areas.iter().map(|tile| tile.pixels()).sum::<u64>() * u64::from(samples.end - samples.start);
        self.progress.tile(TileDone {
            area: around,
            samples: samples.clone(),
            done: self.done.fetch_add(of_part, Ordering::Relaxed) + of_part,
            total: self.total.load(Ordering::Relaxed),
            rays,
            picture,
        });
        Ok(true)
    }

    /// Takes the samples of a part, in pieces that are short enough for a cancellation between them: rows of single samples
    /// while samples are slow, or nothing is known of their cost. `None` where it was cancelled.
    fn rays_of_part(
        &self,
        batch: &mut Batch,
        areas: &[PixelBounds],
        samples: Range<u32>,
        tile: &mut FilmTile,
    ) -> Result<Option<Rays>> {
        let pixels: u64 = areas.iter().map(|tile| tile.pixels()).sum();
        let mut rays = Rays::default();
        let mut piece = |areas: &[PixelBounds], samples: Range<u32>| -> Result<bool> {
            if self.progress.cancelled() {
                return Ok(false);
            }
            let count =
                areas.iter().map(|tile| tile.pixels()).sum::<u64>() * u64::from(samples.end - samples.start);
            let started = Stopwatch::start();
            rays += self.renderer.render_pixels(batch, areas, samples, tile)?;
            let cost = started.elapsed().as_nanos() as u64 / count.max(1);
            self.cost.store(cost.max(1), Ordering::Relaxed);
            Ok(true)
        };
        let mut next = samples.start;
        while next < samples.end {
            let cost = self.cost.load(Ordering::Relaxed);
            let of_all = cost.saturating_mul(pixels);
            let is_done = if cost == 0 || of_all > VERY_SLOW {
                let rows = areas.iter().flat_map(rows);
                let mut is_done = true;
                for row in rows {
                    is_done = is_done && piece(&[row], next..next + 1)?;
                }
                next += 1;
                is_done
            } else {
                let most = if of_all > SLOW { 1 } else { MOST_TOGETHER };
                let together = most.min(samples.end - next);
                next += together;
                piece(areas, next - together..next)?
            };
            if !is_done {
                return Ok(None);
            }
        }
        Ok(Some(rays))
    }

    /// The sum of the numbers of samples that pixels shall have, and the greatest of them, if they are decided.
    fn goals(&self) -> Option<(u64, u32)> {
        let guard = locked(&self.film);
        let ledger = guard.0.ledger();
        ledger.has_goals(guard.0.area()).then(|| ledger.goals())?
    }

    /// Whether the picture's error is below a limit.
    fn is_clean(&self, noise: Option<f64>) -> bool {
        let guard = locked(&self.film);
        let film = &guard.0;
        noise.is_some_and(|noise| film.relative_error(film.area(), film.mean_luminance()) <= noise)
    }

    /// Decides how many samples each pixel shall have: the settings' number in the mean, or such that the picture comes near to
    /// a limit of noise. Returns the sum of these numbers and the greatest, or `None` if the picture has enough samples.
    fn decide(&self, noise: Option<f64>) -> Option<(u64, u32)> {
        let mut guard = locked(&self.film);
        let film = &mut guard.0;
        let area = film.area();
        let most = self.renderer.settings.samples;
        let goals = match noise {
            Some(noise) => film.allocation_for_error(noise, FEWEST_SAMPLES.min(most), most),
            None => Some(film.allocation(most)),
        }?;
        film.ledger_mut().set_goals(|[x, y]| goals[area.index(x, y)]);
        film.ledger().goals()
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

/// The value that a mutex guards, though a thread may have panicked while it held it.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The time since the start of a render, and the samples taken in it.
struct Clock {
    started: Stopwatch,
    /// Samples per pixel.
    taken: u32,
}

impl Clock {
    /// Number of samples per pixel in the next pass.
    fn affordable(&self, time: Duration) -> u32 {
        affordable(self.taken, self.started.elapsed(), time)
    }

    /// Number of samples per pixel that take no longer than [`MOMENT`], or one; not more than those of the longest round.
    fn in_a_moment(&self) -> u32 {
        let elapsed = self.started.elapsed();
        affordable(self.taken, elapsed, elapsed + MOMENT).min(LONGEST_ROUND)
    }
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

/// The end of the round that a sample is in: 0..1, 1..2, 2..4, 4..8 …, and from [`LONGEST_ROUND`] on as many each.
fn end_of_round(sample: u32) -> u32 {
    match sample < LONGEST_ROUND {
        true => (sample + 1).next_power_of_two(),
        false => (sample / LONGEST_ROUND + 1).saturating_mul(LONGEST_ROUND),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_double_and_are_never_long() {
        assert_eq!([0, 1, 2, 3, 4, 31, 32, 63].map(end_of_round), [1, 2, 4, 4, 8, 32, 64, 64]);
        assert_eq!([64, 127, 128, u32::MAX - 1].map(end_of_round), [128, 128, 192, u32::MAX]);
    }

    #[test]
    fn quick_samples_are_taken_together() {
        let at_once = Clock { started: Stopwatch::start(), taken: 1 << 20 };
        assert_eq!(at_once.in_a_moment(), LONGEST_ROUND);
        assert_eq!(Clock { taken: 0, ..at_once }.in_a_moment(), 1);
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
