//! Who renders which tile when: threads, passes over the picture, progress and stopping.
//!
//! Nothing here decides what a sample brings; that is [`Frame::render_tile`], and the film is the same for any division of
//! the work.

use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use lookfrom_scene::settings::Crop;
use lookfrom_scene::{Error, ErrorKind, Location, Result};
use rayon::prelude::*;

use super::{Frame, Rays};
use crate::film::{Film, FilmTile};

/// Pixels on the side of a tile. One sample of each pixel of a tile is a batch.
const TILE: u32 = 32;

/// The greatest number of samples of a pixel between two looks at the clock and the picture.
const LONGEST_PASS: u32 = 64;

/// Told how far a render is, and asked whether it shall stop. Called from many threads.
pub trait Progress: Sync {
    /// `done` of `total` samples are taken, with `rays` rays so far.
    fn advance(&self, done: u64, total: u64, rays: u64);

    /// Whether to stop before the next tile.
    fn cancelled(&self) -> bool {
        false
    }
}

/// Nobody is told anything.
impl Progress for () {
    fn advance(&self, _: u64, _: u64, _: u64) {}
}

/// What came of a render.
#[derive(Debug)]
pub struct Rendered {
    /// The light.
    pub film: Film,
    /// How many rays it took.
    pub rays: Rays,
    /// Whether it was stopped before the end.
    pub cancelled: bool,
}

impl Frame<'_> {
    /// Renders the whole picture on `threads` threads (all that there are for `None`).
    ///
    /// The samples of a pixel are taken in passes of 1, 1, 2, 4 … over the whole picture, so that a render that is stopped
    /// leaves a whole picture behind. The film is the same for any number of threads.
    ///
    /// # Errors
    /// `Limit` when there is no memory for the film or there are no threads to be had.
    pub fn render(&self, threads: Option<usize>, progress: &dyn Progress) -> Result<Rendered> {
        let film = Film::new(self.image.width, self.image.height, self.image.crop)?;
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
        let pool =
            pool.map_err(|error| Error::new(ErrorKind::Limit, &Location::default(), error.to_string()))?;
        let tiles = tiles(film.area());
        let pixels: u64 = tiles.iter().map(area).sum();
        let total = pixels * u64::from(self.render.samples);
        let film = Mutex::new((film, Rays::default()));
        let done = AtomicU64::new(0);

        pool.install(|| {
            for pass in passes(self.render.samples) {
                tiles.par_iter().try_for_each(|tile_area| -> Result<()> {
                    if progress.cancelled() {
                        return Ok(());
                    }
                    let mut tile = FilmTile::new(*tile_area)?;
                    let rays = self.render_tile(pass.clone(), &mut tile);
                    let rays_so_far = {
                        let mut guard = film.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                        guard.0.add_tile(&tile);
                        guard.1 += rays;
                        guard.1.total()
                    };
                    let of_tile = area(tile_area) * u64::from(pass.end - pass.start);
                    progress.advance(
                        done.fetch_add(of_tile, Ordering::Relaxed) + of_tile,
                        total,
                        rays_so_far,
                    );
                    Ok(())
                })?;
            }
            Ok(())
        })?;
        let (film, rays) = film.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        Ok(Rendered { film, rays, cancelled: done.into_inner() < total })
    }
}

/// The parts of an area that threads work on.
fn tiles(area: Crop) -> Vec<Crop> {
    let rows = (area.y0..area.y1).step_by(TILE as usize);
    rows.flat_map(|y0| {
        let columns = (area.x0..area.x1).step_by(TILE as usize);
        columns.map(move |x0| Crop { x0, y0, x1: (x0 + TILE).min(area.x1), y1: (y0 + TILE).min(area.y1) })
    })
    .collect()
}

fn area(tile: &Crop) -> u64 {
    u64::from(tile.x1 - tile.x0) * u64::from(tile.y1 - tile.y0)
}

/// 0..1, 1..2, 2..4, 4..8 … up to `samples`.
fn passes(samples: u32) -> impl Iterator<Item = Range<u32>> {
    let mut start = 0;
    std::iter::from_fn(move || {
        let length = start.clamp(1, LONGEST_PASS).min(samples - start);
        let pass = start..start + length;
        start = pass.end;
        (!pass.is_empty()).then_some(pass)
    })
}
