//! Tests of discrete and piecewise-constant distributions.

use super::*;
use crate::core::hash::mix;
use crate::core::sampler::Sampler;
use crate::core::statistics::chi_square_deviate;
use lookfrom_simd::{Kernel, dispatch, level};
use proptest::prelude::*;

fn random(i: u32) -> [f32; 2] {
    Sampler::new(lookfrom_scene::settings::Sampler::Independent, 11).two([0, 0], i, 0)
}

/// Weights of any exponent, some zero, some invalid.
fn any_weight() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => (1_u32..255, 0_u32..1 << 23).prop_map(|(exponent, fraction)| f32::from_bits(exponent << 23 | fraction)),
        1 => Just(0.0),
        1 => prop_oneof![Just(-1.0), Just(f32::NAN), Just(f32::INFINITY), Just(1e-45)],
    ]
}

#[test]
fn entries_are_chosen_as_often_as_they_weigh() {
    let weights = [3.0, 0.0, 1.0, 0.25, 0.0, 10.0, 2.0, 0.0];
    let discrete = Discrete::new(&weights);
    const N: u32 = 100_000;
    let mut counts = [0; 8];
    for i in 0..N {
        counts[discrete.sample(random(i)[0]).0] += 1;
    }
    let expected = weights.map(|weight| f64::from(weight) / 16.25 * f64::from(N));
    assert!(chi_square_deviate(&counts, &expected) < 4.5, "{counts:?}");
    assert_eq!(discrete.pdf(5), 10.0 / 16.25);
    assert_eq!(discrete.pdf(8), 0.0);
}

/// The entries for eight numbers, and the samples.
struct Eight<'a> {
    discrete: &'a Discrete,
    numbers: [f32; LANES],
}

impl Kernel for Eight<'_> {
    type Output = ([usize; LANES], [(usize, f32, f32); LANES]);

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let u = f32x8::load_array(simd, self.numbers);
        let (entries, probability, rest) = self.discrete.sample_lanes(simd, u);
        let samples = by_lane!(lane => (entries[lane], probability[lane], rest[lane]));
        (self.discrete.entries(simd, u), samples)
    }
}

proptest! {
    #[test]
    fn choosing_agrees_with_walking_along(weights in prop_oneof![prop::collection::vec(any_weight(), 1..20), prop::collection::vec(any_weight(), 1..300)], u in 0.0_f32..1.0) {
        let discrete = Discrete::new(&weights);
        let (index, probability, rest) = discrete.sample(u);
        // Slow reference: linear search until the sum passes the goal.
        let mut usable: Vec<f64> = weights.iter()
            .map(|&w| if w > 0.0 && w < f32::INFINITY { f64::from(w) } else { 0.0 }).collect();
        if usable.iter().all(|&w| w == 0.0) {
            usable.fill(1.0);
        }
        let total: f64 = usable.iter().sum();
        let (mut walked, mut sum) = (0, 0.0);
        while sum + usable[walked] <= f64::from(u) * total {
            sum += usable[walked];
            walked += 1;
        }
        prop_assert_eq!(index, walked);
        prop_assert!(usable[index] > 0.0 && probability > 0.0 && (0.0..1.0).contains(&rest));
        prop_assert_eq!(probability, discrete.pdf(index));
        let numbers = std::array::from_fn(|lane| (u + 0.125 * lane as f32).fract());
        let (entries, samples) = dispatch(level(), Eight { discrete: &discrete, numbers });
        prop_assert_eq!(samples, numbers.map(|u| discrete.sample(u)));
        prop_assert_eq!(entries, samples.map(|(entry, ..)| entry));
        // The new number determines the old one.
        let back = (sum + f64::from(rest) * usable[index]) / total;
        prop_assert!((back - f64::from(u)).abs() < 1e-6, "{} {}", back, u);
    }

    #[test]
    fn probabilities_sum_to_one(weights in prop::collection::vec(any_weight(), 1..40)) {
        let discrete = Discrete::new(&weights);
        let sum: f64 = (0..weights.len()).map(|i| f64::from(discrete.pdf(i))).sum();
        prop_assert!((sum - 1.0).abs() < 1e-5);
    }

    #[test]
    fn points_lie_where_they_have_density(
        width in 1_usize..9, height in 1_usize..9,
        weights in prop::collection::vec(any_weight(), 64),
        u in prop::array::uniform2(0.0_f32..1.0),
    ) {
        let grid = Piecewise2D::new(&weights[..width * height], width, height);
        for u in [u, [0.0, 0.0], [ONE_MINUS_EPSILON; 2], [u[0], 0.0], [ONE_MINUS_EPSILON, u[1]]] {
            let (point, pdf) = grid.sample(u);
            prop_assert!(point.iter().all(|x| (0.0..1.0).contains(x)), "{:?}", point);
            prop_assert!(pdf > 0.0, "{:?} of {:?}", u, grid);
            prop_assert_eq!(pdf, grid.pdf(point));
        }
    }
}

#[test]
fn a_number_on_an_edge_stays_in_its_cell() {
    for cells in (1..4000).chain([4096, 8192, 16_384, 100_003]) {
        for trial in 0..8 {
            let index = mix(trial * 7919 + cells as u64) as usize % cells;
            for rest in [0.0, 1e-12, 0.5, 1.0 - 1e-12, 1.0] {
                assert_eq!(cell(place(index, rest, cells), cells), index, "{rest} of {index} of {cells}");
            }
        }
    }
}

#[test]
fn points_are_as_dense_as_they_say() {
    // An image with a sun, a dark row and a dark column.
    let (width, height) = (6, 5);
    let weights: Vec<f32> = (0..width * height)
        .map(|i| match (i % width, i / width) {
            (_, 2) | (4, _) => 0.0,
            (1, 3) => 40.0,
            (x, y) => (x + 2 * y + 1) as f32,
        })
        .collect();
    let grid = Piecewise2D::new(&weights, width, height);
    // Count in cells that do not align with those of the grid.
    const N: u32 = 200_000;
    const SIDE: usize = 12;
    let (fine_x, fine_y) = (SIDE, 10);
    let mut counts = vec![0; fine_x * fine_y];
    for i in 0..N {
        let ([x, y], _) = grid.sample(random(i));
        counts[cell(y, fine_y) * fine_x + cell(x, fine_x)] += 1;
    }
    let middle = |i: usize, n: usize| (i as f32 + 0.5) / n as f32;
    let density = |i| grid.pdf([middle(i % fine_x, fine_x), middle(i / fine_x, fine_y)]);
    let expected: Vec<f64> =
        (0..counts.len()).map(|i| f64::from(density(i)) * f64::from(N) / counts.len() as f64).collect();
    assert!((expected.iter().sum::<f64>() / f64::from(N) - 1.0).abs() < 1e-5);
    assert!(chi_square_deviate(&counts, &expected) < 4.5);
}

#[test]
fn nothing_bright_is_uniform() {
    for grid in [
        Piecewise2D::new(&[0.0; 6], 3, 2),
        Piecewise2D::new(&[-1.0, f32::NAN], 2, 1),
        Piecewise2D::new(&[], 0, 0),
    ] {
        assert_eq!(grid.sample([0.25, 0.75]), ([0.25, 0.75], 1.0));
        assert_eq!(grid.pdf([1.0, 0.0]), 1.0);
        assert_eq!([grid.pdf([1.5, 0.0]), grid.pdf([0.5, f32::NAN])], [0.0; 2]);
    }
    assert_eq!(Discrete::new(&[0.0; 4]).sample(0.6), (2, 0.25, (0.6_f32 - 0.5) * 4.0));
}

/// A window of the square; some are nearly empty.
fn any_window() -> impl Strategy<Value = Window> {
    let side = || (0.0_f64..1.0, -30.0_f64..0.0).prop_map(|(a, size)| (a, (a + size.exp2()).min(1.0)));
    (side(), side()).prop_map(|(x, y)| Window { min: [x.0, y.0], max: [x.1, y.1] })
}

proptest! {
    #[test]
    fn points_of_windows_lie_where_they_have_density(
        width in 1_usize..9, height in 1_usize..9,
        weights in prop::collection::vec(prop_oneof![3 => 0.0_f32..10.0, 1 => Just(0.0)], 64),
        window in any_window(),
        u in prop::array::uniform2(0.0_f32..1.0),
    ) {
        let grid = Windowed2D::new(weights[..width * height].to_vec(), width, height);
        for window in [window, Window::WHOLE] {
            // Slow reference: intersect every cell with the window.
            let mut sum = 0.0;
            for (index, weight) in weights[..width * height].iter().enumerate() {
                let overlap = |axis: usize, cell: usize, cells: usize| {
                    let (low, high) = (cell as f64 / cells as f64, (cell + 1) as f64 / cells as f64);
                    (high.min(window.max[axis]) - low.max(window.min[axis])).max(0.0)
                };
                let (column, row) = (index % width, index / width);
                sum += f64::from(*weight) * overlap(0, column, width) * overlap(1, row, height);
            }
            let sure = sum > 1e-6 * window.min.iter().zip(window.max).map(|(a, b)| b - a).product::<f64>();
            let sample = grid.sample(&window, u);
            prop_assert!(sample.is_some() || !sure, "{:?} of {:?}", window, grid);
            if let (Some((point, pdf)), true) = (sample, sure) {
                let inside = (0..2).all(|i| {
                    window.min[i] - 1e-15 <= point[i] && point[i] <= window.max[i] + 1e-15
                });
                prop_assert!(inside, "{:?} of {:?}", point, window);
                if window.contains(point) {
                    prop_assert_eq!(pdf, grid.pdf(&window, point));
                }
                let [x, y] = [cell(point[0] as f32, width), cell(point[1] as f32, height)];
                let twin = f64::from(weights[y * width + x]) / sum;
                let on_border = (0..2).any(|i| {
                    let place = point[i] * [width, height][i] as f64;
                    (place - place.round()).abs() < 1e-5
                });
                prop_assert!(on_border || (f64::from(pdf) / twin - 1.0).abs() < 1e-3, "{} {}", pdf, twin);
            }
        }
    }
}

#[test]
fn points_of_windows_are_as_dense_as_they_say() {
    let (width, height) = (6, 5);
    let weights: Vec<f32> = (0..30).map(|i| if i == 19 { 40.0 } else { (i * 7 % 11) as f32 }).collect();
    let grid = Windowed2D::new(weights, width, height);
    let window = Window { min: [0.13, 0.27], max: [0.71, 0.98] };
    const N: u32 = 200_000;
    const SIDE: usize = 60; // the grid's cells and the counting cells share borders
    let mut counts = vec![0; SIDE * SIDE];
    let of = |x: f64, axis: usize| {
        let share = (x - window.min[axis]) / (window.max[axis] - window.min[axis]);
        ((share * SIDE as f64) as usize).min(SIDE - 1)
    };
    for i in 0..N {
        let ([x, y], _) = grid.sample(&window, random(i)).expect("something is bright");
        counts[of(y, 1) * SIDE + of(x, 0)] += 1;
    }
    let area = (window.max[0] - window.min[0]) * (window.max[1] - window.min[1]);
    let expected: Vec<f64> = (0..SIDE * SIDE)
        .map(|index| {
            // The mean over a counting cell, by many points in it.
            let fine = 16;
            let at = |cell: usize, k: usize, axis: usize| {
                let share = (cell as f64 + (k as f64 + 0.5) / f64::from(fine)) / SIDE as f64;
                window.min[axis] + share * (window.max[axis] - window.min[axis])
            };
            let sum: f64 = (0..(fine * fine) as usize)
                .map(|k| {
                    let place =
                        [at(index % SIDE, k % fine as usize, 0), at(index / SIDE, k / fine as usize, 1)];
                    f64::from(grid.pdf(&window, place))
                })
                .sum();
            sum / f64::from(fine * fine) * area / (SIDE * SIDE) as f64 * f64::from(N)
        })
        .collect();
    assert!((expected.iter().sum::<f64>() / f64::from(N) - 1.0).abs() < 1e-3);
    assert!(chi_square_deviate(&counts, &expected) < 4.5);
}

#[test]
fn nothing_is_chosen_in_dark_windows() {
    let grid = Windowed2D::new(vec![1e6, 0.0, f32::NAN, -3.0], 2, 2);
    let dark = Window { min: [0.5, 0.0], max: [1.0, 1.0] };
    assert_eq!(grid.sample(&dark, [0.3, 0.6]), None);
    assert_eq!(grid.pdf(&dark, [0.75, 0.25]), 0.0);
    assert_eq!(grid.pdf(&Window::WHOLE, [0.25, 0.25]), 4.0);
    let none = Window { min: [0.25; 2], max: [0.25; 2] };
    assert_eq!(grid.sample(&none, [0.3, 0.6]), None);
    assert_eq!(Windowed2D::new(vec![0.0], 1, 1).sample(&Window::WHOLE, [0.5; 2]), None);
}
