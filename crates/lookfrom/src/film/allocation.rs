//! Adaptive allocation of samples: how many each pixel gets, by the noise of a pilot.
//!
//! A picture's mean squared error is least where the numbers of samples are as the standard deviations of the pixels (Neyman
//! 1934). Here each pixel gets 2ᵏ times as many as in a *pilot*, half of all samples, where 8ᵏ is its variance over its
//! luminance to the power of ¾, in parts of a threshold. The luminance weights noise as it is seen: its square would serve the
//! relative error, 1 the error of a picture on a screen (Dammertz et al. 2009), 0 the squared error. The cube root is between
//! the square root and the constant: variances of few samples are themselves noisy, and stratified samples at edges have less
//! noise than their variance says.
//!
//! For a *limit of error* the numbers of samples are decided anew whenever all pixels have theirs, at most four times as many
//! as before, until the picture's error is below it. That error is the mean of the pixels' relative errors, and its sum is least
//! for numbers as the cube root of the variance over the square of the luminance.
//!
//! *Without bias*: what a pixel gets depends on its neighbours alone, whose samples are independent of its own. (The
//! threshold, one number for the whole picture, depends on all.) Powers of two keep the samples well distributed.

use std::ops::RangeInclusive;

use lookfrom_scene::settings::{Allocation, PixelBounds, RenderSettings};

use super::Film;
use super::noise::SHARE_OF_MEAN;
use super::weighted::WeightedPixel;
use crate::core::parallel;

/// The number of times that a pixel's samples may be doubled after the pilot.
const MOST_DOUBLINGS: u32 = 4;

/// The greatest number of samples of a pixel, in parts of the mean.
const MOST_TIMES_MEAN: u32 = 1 << (MOST_DOUBLINGS - 1);

/// The least mean number of samples that can be allocated: variances of fewer say nothing.
pub const LEAST_MEAN: u32 = 8;

/// Neighbours of a pixel are at most so many columns and rows away.
const REACH: usize = 2;

/// The number of samples of the pilot where `mean` are taken in the mean.
pub(crate) fn pilot(mean: u32) -> u32 {
    mean / 2
}

/// The numbers of samples that a pixel may have by these settings, without a limit of noise or time.
pub(crate) fn of_pixel(settings: &RenderSettings) -> RangeInclusive<u32> {
    let &RenderSettings { allocation, samples, .. } = settings;
    match allocation == Allocation::Adaptive && samples >= LEAST_MEAN {
        true => pilot(samples)..=samples.saturating_mul(MOST_TIMES_MEAN),
        false => samples..=samples,
    }
}

impl Film {
    /// The number of samples that each pixel of [`Film::area`] shall have, row by row, so that they are at most `mean` in the
    /// mean; by a film of the pilot. Where there is no noise, only those of the pilot.
    pub(crate) fn allocation(&self, mean: u32) -> Vec<u32> {
        let noise = self.noise_of_neighbours(|luminance| {
            let root = luminance.sqrt();
            root * root.sqrt()
        });
        let pilot = pilot(mean);
        // The number of pixels in each bucket, and then in all from it on.
        let mut from = vec![0_u64; MOST_BUCKETS];
        noise.iter().for_each(|noise| from[bucket(*noise)] += 1);
        (1..from.len()).rev().for_each(|bucket| from[bucket - 1] += from[bucket]);
        // The least threshold within the budget.
        let budget = u64::from(mean) * noise.len() as u64;
        let total = |threshold: usize| {
            let doubled = |k: u32| from.get(threshold + k as usize * EIGHT_TIMES).unwrap_or(&0) << k;
            u64::from(pilot) * (noise.len() as u64 + (0..MOST_DOUBLINGS).map(doubled).sum::<u64>())
        };
        let mut threshold = MOST_BUCKETS;
        while threshold > 1 && total(threshold - 1) <= budget {
            threshold -= 1;
        }
        noise.into_iter().map(|noise| goal(pilot, bucket(noise), threshold, MOST_DOUBLINGS)).collect()
    }

    /// The number of samples that each pixel of [`Film::area`] shall have, row by row, so that the
    /// [relative error](Film::relative_error) of the picture is expected to be `error`, where all have had those of a `pilot`.
    /// At most four times as many as a pixel has, and at most `most`. `None` where the error is less already, or no pixel can
    /// have more.
    pub(crate) fn allocation_for_error(&self, error: f64, pilot: u32, most: u32) -> Option<Vec<u32>> {
        let PixelBounds { x0, x1, y0, y1 } = self.area();
        let mean = self.mean_luminance();
        let mut pixels = Vec::new();
        for y in y0..y1 {
            self.row(y, x0, x1, |pixel| {
                let count = pixel.samples() as u32;
                pixels.push((count, pixel.relative_error(mean) * f64::from(count).sqrt()));
            });
        }
        let noise = self.noise_of_neighbours(|luminance| luminance * luminance);
        let goal_of = |index: usize, threshold: usize| {
            let count = pixels[index].0;
            goal(pilot, bucket(noise[index]), threshold, 31).min(count.saturating_mul(4)).min(most).max(count)
        };
        // Of one sample of each pixel, and so of as many as are decided.
        let expected = |goal_of: &dyn Fn(usize) -> u32| {
            let errors = pixels.iter().enumerate();
            let sum: f64 = errors.map(|(index, (_, of_one))| of_one / f64::from(goal_of(index)).sqrt()).sum();
            sum / pixels.len().max(1) as f64
        };
        if expected(&|index| pixels[index].0) <= error {
            return None;
        }
        // The greatest threshold that is low enough, or the least.
        let (mut low, mut high) = (1, MOST_BUCKETS);
        while high - low > 1 {
            let middle = usize::midpoint(low, high);
            let is_enough = expected(&|index| goal_of(index, middle)) <= error;
            *(if is_enough { &mut low } else { &mut high }) = middle;
        }
        let goals: Vec<u32> = (0..pixels.len()).map(|index| goal_of(index, low)).collect();
        goals.iter().zip(&pixels).any(|(goal, (count, _))| goal > count).then_some(goals)
    }

    /// For each pixel the mean variance of a sample's luminance among its neighbours, over a power of their mean luminance.
    fn noise_of_neighbours(&self, power: impl Fn(f64) -> f64 + Sync) -> Vec<f64> {
        let area = self.area();
        let (width, height) = ((area.x1 - area.x0) as usize, (area.y1 - area.y0) as usize);
        let own = parallel::collect(height, |row| {
            let mut of_row = Vec::with_capacity(width);
            self.row(area.y0 + row as u32, area.x0, area.x1, |pixel| {
                of_row.push(pixel.variance_and_luminance());
            });
            of_row
        });
        let floor = SHARE_OF_MEAN * self.mean_luminance().abs();
        let near = |at: usize, end: usize| at.saturating_sub(REACH)..(at + REACH + 1).min(end);
        let of_pixel = |x: usize, y: usize| {
            let ([mut variance, mut luminance], mut count) = ([0.0; 2], 0.0);
            for row in near(y, height) {
                for column in near(x, width).filter(|column| (*column, row) != (x, y)) {
                    let [of_variance, of_luminance] = own[row][column];
                    (variance, luminance) = (variance + of_variance, luminance + of_luminance);
                    count += 1.0;
                }
            }
            let [variance, luminance] = [variance / count, luminance / count + floor];
            if variance > 0.0 { variance / power(luminance) } else { 0.0 }
        };
        let rows = parallel::collect(height, |y| (0..width).map(|x| of_pixel(x, y)).collect::<Vec<_>>());
        rows.into_iter().flatten().collect()
    }
}

impl WeightedPixel {
    /// The variance of one sample's luminance, 0 where it is unknown, and the luminance, or 0 below that.
    fn variance_and_luminance(&self) -> [f64; 2] {
        let [_, variance, _] = self.variance();
        [if variance.is_finite() { variance } else { 0.0 }, self.luminance().max(0.0)]
    }
}

/// Noise is told apart in 256 steps for each factor of two: by the exponent of a positive number and the first 8 bits behind.
const STEPS: u32 = 8;

/// The number of buckets of all positive numbers.
const MOST_BUCKETS: usize = 1 << (11 + STEPS);

/// Noise of eight times as much is so many buckets further.
const EIGHT_TIMES: usize = 3 << STEPS;

/// The bucket of a number ≥ 0; 0 is in the first.
fn bucket(noise: f64) -> usize {
    (noise.to_bits() >> (52 - STEPS)) as usize
}

/// The number of samples of a pixel in a bucket: twice the pilot from a threshold on, four times for eight times the noise …
fn goal(pilot: u32, bucket: usize, threshold: usize, most_doublings: u32) -> u32 {
    let doublings = (bucket + EIGHT_TIMES).saturating_sub(threshold) / EIGHT_TIMES;
    let goal = u64::from(pilot) << doublings.min(most_doublings as usize);
    goal.min(u64::from(u32::MAX)) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::hash;
    use crate::film::FilmTile;

    const AREA: PixelBounds = PixelBounds { x0: 2, y0: 3, x1: 21, y1: 16 };

    /// A film of 16 samples a pixel, with noise that differs by orders of magnitude; of one pixel the samples are others.
    fn film(other: Option<[u32; 2]>) -> Film {
        let mut film = Film::new(30, 20, Some(AREA)).unwrap();
        for y in AREA.y0..AREA.y1 {
            for x in AREA.x0..AREA.x1 {
                for sample in 0..16 {
                    let bits = hash::pair(u64::from(y * 30 + x), u64::from(sample));
                    let number = (bits >> 40) as f32 / 16_777_216.0;
                    let light = 0.2 + number * 2.0_f32.powi(x as i32 - 12);
                    let light = if other == Some([x, y]) { 500.0 * number } else { light };
                    film.add(x, y, sample, [light, 0.5 * light, 0.1]);
                }
            }
        }
        film
    }

    #[test]
    fn the_threshold_is_the_least_within_the_budget() {
        let film = film(None);
        let noise = film.noise_of_neighbours(|luminance| luminance.sqrt() * luminance.sqrt().sqrt());
        for mean in [8, 11, 32, 100] {
            let of = |threshold: usize| {
                let mut goals = Vec::new();
                for noise in &noise {
                    let times = [1, 2, 4, 8, 16];
                    let met = (0..4).filter(|k| bucket(*noise) >= threshold + 3 * 256 * k).count();
                    goals.push(mean / 2 * times[met]);
                }
                goals
            };
            let is_enough = |goals: &[u32]| goals.iter().sum::<u32>() <= mean * 19 * 13;
            // Bisection: the first is too low, the last is enough.
            let (mut low, mut least) = (0, MOST_BUCKETS);
            while least - low > 1 {
                let middle = usize::midpoint(low, least);
                *(if is_enough(&of(middle)) { &mut least } else { &mut low }) = middle;
            }
            assert_eq!(film.allocation(mean), of(least));
        }
        assert_eq!([bucket(0.0), bucket(8.0) - bucket(1.0)], [0, EIGHT_TIMES]);
        assert!(bucket(f64::INFINITY) < MOST_BUCKETS && bucket(1.5) > bucket(1.49));
    }

    #[test]
    fn noisy_pixels_get_more_within_the_budget() {
        let goals = film(None).allocation(32);
        assert_eq!(goals.len(), 19 * 13);
        assert!(goals.iter().all(|goal| [16, 32, 64, 128, 256].contains(goal)));
        let total: u32 = goals.iter().sum();
        assert!(total <= 32 * 19 * 13 && total > 30 * 19 * 13, "{total}");
        let of_column = |x: usize| goals.iter().skip(x).step_by(19).sum::<u32>();
        assert!(of_column(0) == 13 * 16 && of_column(18) > 2 * of_column(12), "{goals:?}");
    }

    /// All that the own samples of a pixel change is the threshold, by its part in the mean luminance.
    #[test]
    fn a_pixel_does_not_decide_about_itself() {
        let [before, after] =
            [None, Some([10, 9])].map(|other| film(other).noise_of_neighbours(|luminance| luminance));
        for (index, (before, after)) in before.iter().zip(after).enumerate() {
            let [x, y] = [2 + index % 19, 3 + index / 19];
            let is_near = x.abs_diff(10) <= REACH && y.abs_diff(9) <= REACH && (x, y) != (10, 9);
            let ratio = after / before;
            assert!(if is_near { ratio > 10.0 } else { (ratio - 1.0).abs() < 0.1 }, "{x} {y}: {ratio}");
        }
    }

    #[test]
    fn what_has_no_noise_gets_the_pilot_alone() {
        let area = PixelBounds { x0: 0, y0: 0, x1: 1, y1: 1 };
        let mut alone = Film::new(1, 1, Some(area)).unwrap();
        (0..8).for_each(|sample| alone.add(0, 0, sample, [sample as f32; 3]));
        assert_eq!(alone.allocation(16), [8]);
        let mut even = Film::new(3, 2, None).unwrap();
        assert_eq!(even.allocation(20), [10; 6]);
        let mut tile = FilmTile::new(even.area()).unwrap();
        for sample in 0..10 {
            (0..6).for_each(|k| tile.add(k % 3, k / 3, sample, [0.5; 3]));
        }
        even.add_tile(&tile).unwrap();
        assert_eq!(even.allocation(20), [10; 6]);
    }
}
