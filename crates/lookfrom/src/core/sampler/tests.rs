//! Tests of samplers: nets, independence, reproducibility.

use super::*;
use crate::core::statistics::chi_square_deviate;

fn sobol(seed: u64) -> Sampler {
    Sampler::new(Kind::Sobol, seed)
}

fn both_kinds() -> [Sampler; 2] {
    [sobol(7), Sampler::new(Kind::Independent, 7)]
}

/// The second Sobol' dimension by its direction numbers v₁ = ½, vₖ₊₁ = vₖ ⊕ vₖ/2, one for each set bit.
fn textbook_second(index: u32) -> u32 {
    let (mut direction, mut sum) = (1_u32 << 31, 0);
    for bit in 0..32 {
        if index >> bit & 1 == 1 {
            sum ^= direction;
        }
        direction ^= direction >> 1;
    }
    sum
}

#[test]
fn second_coordinate_is_that_of_the_textbook() {
    for trial in 0..20_000_u64 {
        // Random exponents: indices of every length.
        let index = (mix(trial) as u32) >> (trial % 32);
        assert_eq!(pascal(index).reverse_bits(), textbook_second(index), "index {index}");
    }
}

/// The definition of Owen's scrambling: in each half, quarter, eighth … of [0, 1) the two halves are swapped or
/// not, depending on `swap` of that interval (its depth, and its index among the intervals of that depth).
fn owen(bits: u32, swap: &dyn Fn(u32, u32) -> bool) -> u32 {
    let mut scrambled = 0;
    for depth in 0..32 {
        let interval = if depth == 0 { 0 } else { bits >> (32 - depth) };
        let bit = bits >> (31 - depth) & 1;
        scrambled = scrambled << 1 | (bit ^ u32::from(swap(depth, interval)));
    }
    scrambled
}

fn hashed(bits: u32, seed: u32) -> u32 {
    scramble_from_the_low_end(bits.reverse_bits(), seed).reverse_bits()
}

/// True if the hash swaps the halves of an interval, evaluated at the smallest number in it.
fn hash_swaps(depth: u32, interval: u32, seed: u32) -> bool {
    let least = if depth == 0 { 0 } else { interval << (32 - depth) };
    (hashed(least, seed) ^ least) >> (31 - depth) & 1 == 1
}

#[test]
fn the_hash_is_an_owen_scrambling() {
    for trial in 0..5_000_u64 {
        let (bits, seed) = (mix(trial) as u32, (mix(trial) >> 32) as u32);
        let bits = bits >> (trial % 32);
        let slow = owen(bits, &|depth, interval| hash_swaps(depth, interval, seed));
        assert_eq!(hashed(bits, seed), slow, "bits {bits:#x}, seed {seed:#x}");
    }
}

#[test]
fn nodes_of_the_scrambling_swap_independently() {
    // The 63 uppermost nodes of the tree, over many seeds: each swaps half the time, each pair agrees half the time.
    const SEEDS: u64 = 8192;
    let nodes: Vec<(u32, u32)> = (0..6).flat_map(|depth| (0..1 << depth).map(move |i| (depth, i))).collect();
    let mut swaps = vec![0_u32; nodes.len()];
    let mut agree = vec![0_u32; nodes.len() * nodes.len()];
    for trial in 0..SEEDS {
        let seed = mix(trial) as u32;
        let swap: Vec<bool> = nodes.iter().map(|&(depth, i)| hash_swaps(depth, i, seed)).collect();
        for a in 0..nodes.len() {
            swaps[a] += u32::from(swap[a]);
            for b in 0..a {
                agree[a * nodes.len() + b] += u32::from(swap[a] == swap[b]);
            }
        }
    }
    let share = |count: u32| f64::from(count) / SEEDS as f64;
    for a in 0..nodes.len() {
        assert!((share(swaps[a]) - 0.5).abs() < 0.03, "node {:?} swaps {}", nodes[a], share(swaps[a]));
        for b in 0..a {
            let agree = share(agree[a * nodes.len() + b]);
            assert!((agree - 0.5).abs() < 0.03, "nodes {:?} and {:?} agree {agree}", nodes[a], nodes[b]);
        }
    }
}

/// Mean square error of 64 points for a smooth integrand, over many scramblings.
fn variance(points: impl Fn(u32) -> Vec<[f64; 2]>) -> f64 {
    const SCRAMBLINGS: u32 = 3000;
    let integrand = |[x, y]: [f64; 2]| (x + 0.5 * y).exp() * (1.0 - x * y);
    let truth = {
        let n = 400;
        let cell = |i: i32| (f64::from(i) + 0.5) / f64::from(n);
        (0..n * n).map(|i| integrand([cell(i % n), cell(i / n)])).sum::<f64>() / f64::from(n * n)
    };
    let squares = (0..SCRAMBLINGS).map(|seed| {
        let points = points(seed);
        let mean = points.iter().map(|&p| integrand(p)).sum::<f64>() / points.len() as f64;
        (mean - truth).powi(2)
    });
    squares.sum::<f64>() / f64::from(SCRAMBLINGS)
}

#[test]
fn errors_are_those_of_true_owen_scrambling() {
    let unit = |bits: u32| f64::from(bits) / 4_294_967_296.0;
    let slow = variance(|seed| {
        let swap = |axis: u64| {
            move |depth: u32, interval: u32| {
                let node = u64::from(interval) | 1 << depth | axis << 40;
                mix(mix(u64::from(seed).wrapping_add(GOLDEN)) ^ node) & 1 == 1
            }
        };
        let point =
            |i: u32| [unit(owen(i.reverse_bits(), &swap(1))), unit(owen(textbook_second(i), &swap(2)))];
        (0..64).map(point).collect()
    });
    let sampler = sobol(1);
    let fast = variance(|seed| (0..64).map(|i| sampler.two([seed, 3], i, 9).map(f64::from)).collect());
    let random = Sampler::new(Kind::Independent, 1);
    let independent = variance(|seed| (0..64).map(|i| random.two([seed, 3], i, 9).map(f64::from)).collect());
    assert!((fast / slow - 1.0).abs() < 0.15, "hashed {fast:e}, true {slow:e}");
    assert!(independent > 50.0 * fast, "independent {independent:e}, Sobol' {fast:e}");
}

/// True if each of the 2ᵐ boxes of each shape contains one point.
fn is_net(points: &[[f32; 2]]) -> bool {
    let m = points.len().ilog2();
    (0..=m).all(|a| {
        let mut seen = vec![false; points.len()];
        for [x, y] in points {
            let column = (x * (1_u32 << a) as f32) as usize;
            let row = (y * (1_u32 << (m - a)) as f32) as usize;
            seen[row << a | column] = true;
        }
        seen.into_iter().all(|hit| hit)
    })
}

#[test]
fn every_aligned_run_is_a_net() {
    for trial in 0..40_u32 {
        let pixel = [trial * 31, 7_u32.wrapping_pow(trial)];
        let sampler = sobol(u64::from(trial % 3));
        for m in 0..=8 {
            for run in [0, 1, 5, (1_u64 << (32 - m)) - 1] {
                let first = run << m;
                let points: Vec<_> =
                    (0..1_u64 << m).map(|i| sampler.two(pixel, (first + i) as u32, trial)).collect();
                assert!(is_net(&points), "pixel {pixel:?}, 2^{m} samples from {first}");
            }
        }
    }
    let random = Sampler::new(Kind::Independent, 0);
    assert!(!is_net(&(0..64).map(|i| random.two([0, 0], i, 0)).collect::<Vec<_>>()));
}

/// C(j, i) αʲ⁻ⁱ for each pair of digits, by the definition of GF(4): what `third` has to compute.
fn textbook_third(index: u32) -> u32 {
    let times = |a: u32, b: u32| -> u32 {
        let product = (if b & 1 != 0 { a } else { 0 }) ^ (if b & 2 != 0 { a << 1 } else { 0 });
        if product & 4 != 0 { product ^ 0b111 } else { product }
    };
    let power = |exponent: u32| (0..exponent).fold(1, |power, _| times(power, 0b10));
    let digit = |j: u32| index >> (2 * j) & 3;
    let row = |i: u32| {
        let odd = |j: &u32| i & !j == 0;
        (i..16).filter(odd).fold(0, |sum, j| sum ^ times(power((j - i) % 3), digit(j)))
    };
    (0..16).fold(0, |bits, i| bits | row(i) << (2 * i))
}

#[test]
fn third_coordinate_is_that_of_the_textbook() {
    for trial in 0..20_000_u64 {
        let index = (mix(trial) as u32) >> (trial % 32);
        assert_eq!(third(index), textbook_third(index), "index {index}");
    }
}

#[test]
fn first_decisions_and_the_point_in_the_pixel_are_a_net_together() {
    /// All ways to divide m among four.
    fn shapes(m: u32) -> impl Iterator<Item = [u32; 4]> {
        (0..(m + 1).pow(3)).filter_map(move |k| {
            let [a, b, c] = [k % (m + 1), k / (m + 1) % (m + 1), k / (m + 1).pow(2)];
            Some([a, b, c, m.checked_sub(a + b + c)?])
        })
    }
    for trial in 0..20_u32 {
        let pixel = sobol(u64::from(trial % 3)).of_pixel([trial * 31, 7_u32.wrapping_pow(trial)]);
        for (m, run) in [(1, 9), (2, 0), (2, 77), (3, 0), (3, 5), (4, 1)] {
            let samples = || (0..4_u32.pow(m)).map(|i| (run << (2 * m)) + i);
            let together = |sample| {
                let ([x, y], [z, w]) = (pixel.two(sample, PIXEL), pixel.two_with_pixel(sample, 1000 + trial));
                [x, y, z, w]
            };
            for sides in shapes(m) {
                let boxes: std::collections::HashSet<[u32; 4]> = samples()
                    .map(|sample| {
                        let point = together(sample);
                        [0, 1, 2, 3].map(|axis| (point[axis] * 4_f32.powi(sides[axis] as i32)) as u32)
                    })
                    .collect();
                assert_eq!(boxes.len(), 4_usize.pow(m), "{sides:?}, pixel {trial}, run {run}");
            }
            let alone: Vec<_> = samples().map(|sample| pixel.two_with_pixel(sample, 1000 + trial)).collect();
            assert!(is_net(&alone), "pixel {trial}, 4^{m} samples, run {run}");
        }
    }
}

#[test]
fn first_decisions_are_independent_of_each_other() {
    const N: u32 = 1 << 15;
    for s in both_kinds() {
        pairs_look_uniform(
            "a decision with the pixel and another one, over pixels",
            (0..N).map(|i| {
                let pixel = s.of_pixel([i % 256, i / 256]);
                [pixel.two_with_pixel(3, 5)[0], pixel.two_with_pixel(3, 6)[0]]
            }),
        );
        pairs_look_uniform(
            "a decision with the pixel and the pixel's own, over pixels",
            (0..N).map(|i| {
                let pixel = s.of_pixel([i % 256, i / 256]);
                [pixel.two(3, PIXEL)[1], pixel.two_with_pixel(3, 6)[0]]
            }),
        );
    }
}

#[test]
fn one_is_the_first_of_two() {
    for sampler in both_kinds() {
        for i in 0..1000 {
            let (pixel, dimension) = ([i * 7, i], mix(u64::from(i)) as u32);
            assert_eq!(sampler.one(pixel, i, dimension), sampler.two(pixel, i, dimension)[0]);
        }
    }
}

#[test]
fn numbers_are_below_one_and_reach_both_ends() {
    assert_eq!(unit::<f32>(u32::MAX), ONE_MINUS_EPSILON);
    assert_eq!(unit::<f32>(0), 0.0);
    assert!(unit::<f32>(0xff) == 0.0 && unit::<f32>(0x100) > 0.0);
}

/// Chi-square of pairs over 16 × 16 cells.
fn pairs_look_uniform(what: &str, pairs: impl Iterator<Item = [f32; 2]>) {
    let mut counts = vec![0_u64; 256];
    let mut total = 0_u32;
    for [a, b] in pairs {
        assert!((0.0..1.0).contains(&a) && (0.0..1.0).contains(&b));
        counts[(a * 16.0) as usize * 16 + (b * 16.0) as usize] += 1;
        total += 1;
    }
    let deviate = chi_square_deviate(&counts, &vec![f64::from(total) / 256.0; 256]);
    assert!(deviate < 4.5, "{what}: {deviate} standard deviations");
}

#[test]
fn different_addresses_are_uncorrelated() {
    const N: u32 = 1 << 15;
    for s in both_kinds() {
        let pixel = |i: u32| [i % 256, i / 256];
        pairs_look_uniform(
            "one pixel and its right neighbour",
            (0..N).map(|i| {
                let [x, y] = pixel(i);
                [s.one([x, y], 0, 0), s.one([x + 1, y], 0, 0)]
            }),
        );
        pairs_look_uniform(
            "one pixel and its lower neighbour",
            (0..N).map(|i| {
                let [x, y] = pixel(i);
                [s.two([x, y], 3, 1)[1], s.two([x, y + 1], 3, 1)[1]]
            }),
        );
        pairs_look_uniform(
            "a pixel and its mirror image",
            (0..N).map(|i| {
                let [x, y] = pixel(i);
                [s.one([x, y + 1000], 0, 0), s.one([y + 1000, x], 0, 0)]
            }),
        );
        pairs_look_uniform(
            "two dimensions, over pixels",
            (0..N).map(|i| [s.one(pixel(i), 0, 0), s.one(pixel(i), 0, 1)]),
        );
        pairs_look_uniform(
            "two dimensions, over dimensions",
            (0..N).map(|i| [s.one([1, 2], 5, i), s.one([1, 2], 5, i + 1)]),
        );
        pairs_look_uniform(
            "two dimensions, over samples",
            (0..N).map(|i| [s.one([1, 2], i, 1), s.one([1, 2], i, 2)]),
        );
        pairs_look_uniform("x and y, over pixels", (0..N).map(|i| s.two(pixel(i), 1, 4)));
    }
    // Two samples of one Sobol' pattern are deliberately not independent.
    let random = Sampler::new(Kind::Independent, 7);
    pairs_look_uniform("two samples", (0..N).map(|i| [random.one([0, 0], 0, i), random.one([0, 0], 9, i)]));
    pairs_look_uniform(
        "successive samples",
        (0..N).map(|i| [random.one([0, 0], i, 0), random.one([0, 0], i + 1, 0)]),
    );
    for kind in [Kind::Sobol, Kind::Independent] {
        pairs_look_uniform(
            "two seeds",
            (0..N).map(|i| {
                let [a, b] = [0, 1].map(|add| Sampler::new(kind, u64::from(i) + add));
                [a.one([0, 0], 0, 0), b.one([0, 0], 0, 0)]
            }),
        );
    }
}

#[test]
fn bits_are_pinned() {
    let bits = |s: &Sampler, pixel, sample, dimension| s.two(pixel, sample, dimension).map(f32::to_bits);
    let [sobol, independent] = both_kinds();
    let addresses = [([0, 0], 0, 0), ([1, 2], 3, 4), ([u32::MAX, 5], 1 << 31, u32::MAX)];
    assert_eq!(
        addresses.map(|(p, s, d)| bits(&sobol, p, s, d)),
        [[0x3e92_bb50, 0x3dac_2230], [0x3d1a_3410, 0x3e16_8bcc], [0x3f75_e646, 0x3e07_55c0]]
    );
    assert_eq!(
        addresses.map(|(p, s, d)| bits(&independent, p, s, d)),
        [[0x3ed4_3434, 0x3f34_513d], [0x3f65_9337, 0x3f53_6ead], [0x3e4c_9000, 0x3dcc_1ca8]]
    );
}
