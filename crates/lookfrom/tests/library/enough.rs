//! Does a render end when it shall, and is the picture then what its number of samples says?

use std::sync::Mutex;
use std::time::{Duration, Instant};

use crate::support::{Compiled, own_scene};
use lookfrom::render::{FEWEST_SAMPLES, Progress, StopCriteria, StopReason, TileDone};
use lookfrom_scene::Scene;
use lookfrom_scene::settings::Allocation;

fn small(samples: u32) -> Scene {
    let mut scene = own_scene("soft-shadows.toml");
    (scene.image.width, scene.image.height) = (72, 50);
    scene.image.crop = None;
    scene.render.samples = samples;
    scene
}

#[test]
fn what_is_rendered_until_a_time_is_the_picture_of_that_many_samples() {
    let compiled = Compiled::new(small(1 << 24));
    let enough = StopCriteria { time: Some(Duration::from_millis(300)), noise: None };
    let started = Instant::now();
    let rendered = compiled.renderer().render_until(&enough, Some(2), &()).expect("a render");
    assert!(started.elapsed() < Duration::from_secs(20));
    assert_eq!(rendered.reason, StopReason::Time);
    assert!(rendered.samples >= 1);
    assert_eq!(rendered.samples_taken, u64::from(rendered.samples) * 72 * 50);
    let whole = Compiled::new(small(rendered.samples)).render(1);
    assert_eq!(whole.reason, StopReason::Samples);
    assert!(whole.film == rendered.film);
}

#[test]
fn no_time_at_all_is_one_sample() {
    let compiled = Compiled::new(small(100));
    let enough = StopCriteria { time: Some(Duration::ZERO), noise: Some(1e-9) };
    let rendered = compiled.renderer().render_until(&enough, None, &()).expect("a render");
    assert_eq!((rendered.reason, rendered.samples), (StopReason::Time, 1));
}

#[test]
fn a_limit_of_noise_is_reached_and_threads_do_not_matter() {
    let compiled = Compiled::new(small(256));
    let until = |noise, threads| {
        let enough = StopCriteria { time: None, noise: Some(noise) };
        compiled.renderer().render_until(&enough, Some(threads), &()).expect("a render")
    };
    let limit = Compiled::new(small(FEWEST_SAMPLES)).render(2).error / 3.0;
    let one = until(limit, 1);
    assert!(one.film == until(limit, 3).film);
    let counts: Vec<u64> =
        (0..50).flat_map(|y| (0..72).map(move |x| (x, y))).map(|(x, y)| one.film.samples(x, y)).collect();
    let (least, most) = (*counts.iter().min().unwrap(), *counts.iter().max().unwrap());
    assert!(least >= u64::from(FEWEST_SAMPLES) && most > least, "{least} … {most}");
    assert_eq!((one.reason, u64::from(one.samples)), (StopReason::Noise, most));
    assert_eq!(one.samples_taken, counts.iter().sum::<u64>());
    assert!(one.error <= limit && one.error > 0.8 * limit, "{} {limit}", one.error);
    // It is the mean over more than those of the first rounds, and near to what all samples say.
    let whole = compiled.film();
    let difference = one.film.mean_luminance() / whole.mean_luminance() - 1.0;
    assert!(difference.abs() < 0.003, "{difference}");
    // Nothing is ever so clean.
    let never = until(0.0, 2);
    assert!(never.reason == StopReason::Samples || never.reason == StopReason::Noise);
    assert!(never.error <= one.error);
}

fn allocated(samples: u32, seed: u64) -> Compiled {
    let mut scene = small(samples);
    (scene.render.allocation, scene.render.seed) = (Allocation::Adaptive, seed);
    Compiled::new(scene)
}

#[test]
fn allocated_samples_are_the_given_number_in_the_mean_for_any_number_of_threads() {
    let one = allocated(32, 0).render(1);
    assert!(one.film == allocated(32, 0).render(3).film);
    let counts: Vec<u64> =
        (0..50).flat_map(|y| (0..72).map(move |x| (x, y))).map(|(x, y)| one.film.samples(x, y)).collect();
    let (least, most) = (*counts.iter().min().unwrap(), *counts.iter().max().unwrap());
    assert!(least == 16 && [64, 128, 256].contains(&most), "{least} … {most}");
    assert_eq!((one.reason, u64::from(one.samples)), (StopReason::Samples, most));
    let total = counts.iter().sum::<u64>();
    assert_eq!(one.samples_taken, total);
    assert!(total <= 32 * 72 * 50 && total > 30 * 72 * 50, "{total}");
    // The samples of a pixel are those of an even picture.
    let even = Compiled::new(small(most as u32)).film();
    for (x, y) in (0..50).flat_map(|y| (0..72).map(move |x| (x, y))) {
        assert!(one.film.samples(x, y) < most || one.film.mean(x, y) == even.mean(x, y));
    }
}

#[test]
fn allocated_samples_have_less_noise_and_no_bias() {
    let truth = Compiled::new(small(2048)).film();
    let pixels = || (0..50).flat_map(|y| (0..72).map(move |x| (x, y)));
    let mut errors = [0.0, 0.0];
    let mut means = Vec::new();
    for seed in 1..=24 {
        let mut even = small(16);
        even.render.seed = seed;
        let films = [Compiled::new(even).film(), allocated(16, seed).film()];
        for (error, film) in errors.iter_mut().zip(&films) {
            let square = |(x, y)| f64::from(film.mean(x, y)[1] - truth.mean(x, y)[1]).powi(2);
            *error += pixels().map(square).sum::<f64>();
        }
        means.push(films[1].mean_luminance() / truth.mean_luminance() - 1.0);
    }
    assert!(errors[1] < 0.7 * errors[0], "{errors:?}");
    let n = means.len() as f64;
    let mean = means.iter().sum::<f64>() / n;
    let deviation = (means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt();
    assert!(mean.abs() < 4.0 * deviation + 1e-5 && deviation < 1e-3, "{mean} {deviation}");
}

#[test]
fn a_limit_of_noise_leaves_no_bias() {
    let truth = Compiled::new(small(2048)).film().mean_luminance();
    let noise = Compiled::new(small(FEWEST_SAMPLES)).render(2).error / 2.0;
    let until_clean = |seed: u64| {
        let mut scene = small(1 << 16);
        scene.render.seed = seed;
        let limit = StopCriteria { time: None, noise: Some(noise) };
        let rendered = Compiled::new(scene).renderer().render_until(&limit, None, &()).expect("a render");
        assert_eq!(rendered.reason, StopReason::Noise);
        rendered.film.mean_luminance() / truth - 1.0
    };
    let means: Vec<f64> = (1..=24).map(until_clean).collect();
    let n = means.len() as f64;
    let mean = means.iter().sum::<f64>() / n;
    let deviation = (means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt();
    assert!(mean.abs() < 4.0 * deviation + 1e-5 && deviation < 1e-3, "{mean} {deviation}");
}

#[test]
fn what_cannot_be_allocated_is_refused() {
    let enough = StopCriteria { time: None, noise: Some(0.1) };
    assert!(allocated(32, 0).renderer().render_until(&enough, None, &()).is_err());
    // Too few to know anything.
    let few = allocated(7, 0).render(1);
    assert!(few.film == Compiled::new(small(7)).film() && few.samples == 7);
}

/// Breaks off after a number of tiles, and remembers how many samples there were after each.
struct Watcher {
    after: usize,
    seen: Mutex<Vec<u64>>,
}

impl Progress for Watcher {
    fn tile(&self, tile: TileDone) {
        assert!(tile.done <= tile.total && tile.rays > 0);
        let picture = tile.picture.expect("pixels were asked for");
        assert_eq!(
            [picture.width, picture.height],
            [tile.area.x1 - tile.area.x0, tile.area.y1 - tile.area.y0]
        );
        assert!(picture.pixels.iter().flatten().any(|&c| c > 0.0));
        self.seen.lock().expect("a lock").push(tile.done);
    }

    fn wants_pixels(&self) -> bool {
        true
    }

    fn cancelled(&self) -> bool {
        self.seen.lock().expect("a lock").len() >= self.after
    }
}

#[test]
fn who_watches_sees_the_film_grow_and_may_stop_it() {
    let compiled = Compiled::new(small(64));
    let watcher = Watcher { after: 9, seen: Mutex::default() };
    let rendered = compiled.renderer().render(Some(1), &watcher).expect("a render");
    let seen = watcher.seen.into_inner().expect("a lock");
    assert_eq!(seen.len(), 9);
    assert!(seen.windows(2).all(|pair| pair[0] < pair[1]));
    assert_eq!((rendered.reason, rendered.samples), (StopReason::Cancelled, 1));
    // The six tiles of the first sample, then three with as many more as a moment is enough for.
    assert_eq!((seen[5], seen[8]), (72 * 50, rendered.samples_taken));
}

/// A render asks for a cancellation often enough, before anything is known of the cost of samples: after each row of the
/// first tile, not only after the tile, and what was taken of a tile does not count then.
#[test]
fn a_cancellation_is_noticed_within_the_first_tile() {
    struct Cancelling {
        rows: u32,
        asked: std::sync::atomic::AtomicU32,
        tiles: std::sync::atomic::AtomicU32,
    }
    impl Progress for Cancelling {
        fn cancelled(&self) -> bool {
            // Once before the part, then before each of its pieces.
            self.asked.fetch_add(1, std::sync::atomic::Ordering::Relaxed) > self.rows
        }
        fn tile(&self, _: TileDone) {
            self.tiles.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        }
    }
    for rows in [0, 3, 20] {
        let progress = Cancelling { rows, asked: 0.into(), tiles: 0.into() };
        let rendered = Compiled::new(small(64)).renderer().render(Some(1), &progress).expect("a render");
        assert_eq!(rendered.reason, StopReason::Cancelled);
        assert_eq!(progress.tiles.into_inner(), 0, "no tile was finished after {rows} rows");
        assert_eq!(rendered.samples_taken, 0);
    }
}
