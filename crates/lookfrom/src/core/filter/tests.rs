//! Tests that filter samples and weights reproduce the filter.

use lookfrom_scene::settings::Sampler as Kind;
use lookfrom_simd::{Kernel, Simd, dispatch, f32x8, level, prelude::*};

use super::*;
use crate::core::lanes::LANES;
use crate::core::sampler::Sampler;
use crate::core::statistics::chi_square_deviate;

fn all() -> [Settings; 13] {
    [
        Shape::Box.of_radius(0.5),
        Shape::Box.of_radius(1.25),
        Shape::Triangle.of_radius(1.0),
        Shape::Gaussian { sigma: 0.5 }.of_radius(1.5),
        Shape::Gaussian { sigma: 3.0 }.of_radius(2.0),
        Shape::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }.of_radius(2.0),
        Shape::Mitchell { b: 0.0, c: 0.75 }.of_radius(1.7),
        Shape::BlackmanHarris.of_radius(1.5),
        Shape::Sinc { tau: 3.0 }.of_radius(4.0),
        Shape::Sinc { tau: 1.5 }.of_radius(2.5),
        Settings { shape: Shape::Box, radius: [0.5, 2.0] },
        Settings { shape: Shape::Gaussian { sigma: 0.8 }, radius: [3.0, 1.0] },
        Settings { shape: Shape::Sinc { tau: 3.0 }, radius: [1.5, 4.0] },
    ]
}

/// Every offset along one axis of a fine uniform grid of u, with the signed weight of this axis.
fn along(filter: &Filter, axis: usize) -> impl Iterator<Item = (f64, f64)> {
    const N: u32 = 1 << 18;
    let ([_, _], centre) = filter.sample([0.5, 0.5]);
    let other = [filter.y(), &filter.x][axis].weight();
    // The centre is positive along both axes.
    assert!(centre > 0.0);
    (0..N).map(move |i| {
        let mut u = [0.5; 2];
        u[axis] = ((f64::from(i) + 0.5) / f64::from(N)) as f32;
        let (offset, weight) = filter.sample(u);
        (f64::from(offset[axis]), f64::from(weight) / other)
    })
}

#[test]
fn moments_are_those_of_the_filter() {
    for shape in all() {
        let filter = Filter::new(shape);
        for axis in 0..2 {
            let r = f64::from(filter.radius()[axis]);
            // Integrate f along the axis slowly, by the midpoint rule.
            const N: u32 = 40_000;
            let value = |x: f64| {
                let mut offset = [0.0; 2];
                offset[axis] = x as f32;
                f64::from(filter.evaluate(offset[0], offset[1]))
            };
            let place = |i: u32| ((f64::from(i) + 0.5) / f64::from(N) * 2.0 - 1.0) * r;
            let step = 2.0 * r / f64::from(N);
            let whole: f64 = (0..N).map(|i| value(place(i))).sum::<f64>() * step;
            for power in 0..=6 {
                let moment = |i: u32| value(place(i)) / whole * place(i).powi(power);
                let slow: f64 = (0..N).map(moment).sum::<f64>() * step;
                let (mut sum, mut count) = (0.0, 0.0);
                for (x, weight) in along(&filter, axis) {
                    sum += weight * x.powi(power);
                    count += 1.0;
                }
                let sampled = sum / count;
                let tolerance = 2e-4 * r.powi(power).max(1.0);
                assert!((sampled - slow).abs() < tolerance, "{shape:?} x^{power}: {sampled}, not {slow}");
            }
        }
    }
}

#[test]
fn weights_average_to_one() {
    for shape in all() {
        let filter = Filter::new(shape);
        const N: u32 = 1024;
        let at = |i: u32| (i as f32 + 0.5) / N as f32;
        let sum: f64 = (0..N * N).map(|i| f64::from(filter.sample([at(i % N), at(i / N)]).1)).sum();
        let mean = sum / f64::from(N * N);
        assert!((mean - 1.0).abs() < 3e-3, "{shape:?}: {mean}");
    }
}

#[test]
fn samples_follow_the_magnitude_of_the_filter() {
    const CELLS: usize = 24;
    const SAMPLES: u32 = 200_000;
    for shape in all() {
        let filter = Filter::new(shape);
        let [rx, ry] = filter.radius();
        let cell = |x: f32, r: f32| (((x / r + 1.0) * 0.5 * CELLS as f32) as usize).min(CELLS - 1);
        // Expected: ∫|f| over each cell.
        const FINE: usize = 480;
        let mut expected = vec![0.0; CELLS * CELLS];
        let place = |i: usize| (i as f32 + 0.5) / FINE as f32 * 2.0 - 1.0;
        for i in 0..FINE * FINE {
            let (x, y) = (place(i % FINE) * rx, place(i / FINE) * ry);
            expected[cell(y, ry) * CELLS + cell(x, rx)] += f64::from(filter.evaluate(x, y)).abs();
        }
        let total: f64 = expected.iter().sum();
        expected.iter_mut().for_each(|e| *e *= f64::from(SAMPLES) / total);
        // Count samples, whose weights must have the sign of f.
        let sampler = Sampler::new(Kind::Independent, 3);
        let mut observed = vec![0; CELLS * CELLS];
        let mut wrong_signs = 0;
        for i in 0..SAMPLES {
            let ([x, y], weight) = filter.sample(sampler.two([0, 0], i, 0));
            assert!(x.abs() <= rx && y.abs() <= ry);
            observed[cell(y, ry) * CELLS + cell(x, rx)] += 1;
            wrong_signs += u32::from(weight * filter.evaluate(x, y) < 0.0);
        }
        let deviate = chi_square_deviate(&observed, &expected);
        assert!(deviate < 4.5, "{shape:?}: {deviate}");
        // Signs may only be wrong within a table cell in which f crosses zero.
        assert!(wrong_signs < SAMPLES / 1000, "{shape:?}: {wrong_signs}");
    }
}

#[test]
fn tables_agree_with_bisection() {
    for shape in all() {
        let filter = Filter::new(shape);
        let Axis { curve, table: Some(table), .. } = filter.y() else { continue };
        // Slow reference: cumulative integral of |f| by the midpoint rule, and the first position that
        // reaches a fraction.
        const N: u32 = 100_000;
        let place = |i: u32| (f64::from(i) + 0.5) / f64::from(N);
        let mut running: Vec<f64> = Vec::new();
        let mut sum = 0.0;
        for i in 0..N {
            sum += curve.value(place(i)).abs();
            running.push(sum);
        }
        for i in 0..1000 {
            let share = i as f32 / 1000.0;
            let slow = running.partition_point(|&part| part < f64::from(share) * sum) as f64 / f64::from(N);
            let fast = table.invert(share).abs();
            assert!(
                (f64::from(fast) - slow).abs() <= 1.0 / CELLS as f64,
                "{shape:?} at {share}: {fast}, {slow}"
            );
        }
    }
}

#[test]
fn mitchell_has_negative_lobes_and_a_bell_has_none() {
    let weights = |shape| {
        let filter = Filter::new(shape);
        [0.01, 0.5].map(|u| filter.sample([u, 0.5]).1)
    };
    let [lobe, centre] = weights(Shape::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }.of_radius(2.0));
    assert!(lobe < -1.0 && centre > 1.0 && lobe == -centre, "{lobe} {centre}");
    assert_eq!(weights(Shape::BlackmanHarris.of_radius(1.5)), [1.0, 1.0]);
}

#[test]
fn known_values() {
    let mitchell = Filter::new(Shape::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }.of_radius(2.0));
    // 8/9 at the centre along each axis, 1/18 at a distance of 1; the integral along each axis is 1.
    assert!((mitchell.evaluate(0.0, 0.0) - 64.0 / 81.0).abs() < 1e-6);
    assert!((mitchell.evaluate(1.0, 0.0) - 8.0 / 162.0).abs() < 1e-6);
    assert_eq!(mitchell.evaluate(2.5, 0.0), 0.0);
    assert_eq!(Filter::new(Shape::Box.of_radius(0.5)).evaluate(0.3, -0.4), 1.0);
    let tent = Filter::new(Shape::Triangle.of_radius(2.0));
    assert_eq!(tent.sample([0.5, 0.125]), ([0.0, -1.0], 1.0));
    let wide = Filter::new(Settings { shape: Shape::Triangle, radius: [1.0, 2.0] });
    // The product of two tents: 1 − |x| along x, (1 − |y|/2) / 2 along y.
    assert!((wide.evaluate(0.25, -1.0) - 0.75 * 0.25).abs() < 1e-6);
    assert_eq!(wide.sample([0.125, 0.125]), ([-0.5, -1.0], 1.0));
    let pixel = Filter::new(Shape::Box.of_radius(0.5));
    assert_eq!(pixel.sample([0.0, 0.75]), ([-0.5 * ONE_MINUS_EPSILON, 0.25], 1.0));
}

#[test]
fn nonsense_gives_finite_samples() {
    let wild = [0.0, -1.0, 1e-45, 1e-20, 1e20, f32::MAX, f32::INFINITY, f32::NAN];
    for radius in wild {
        for a in wild {
            for b in [0.0, -3.0, 1e30, f32::NAN] {
                let shapes = [
                    Shape::Box,
                    Shape::Triangle,
                    Shape::BlackmanHarris,
                    Shape::Gaussian { sigma: a },
                    Shape::Mitchell { b: a, c: b },
                    Shape::Sinc { tau: a },
                ];
                for shape in shapes {
                    let filter = Filter::new(Settings { shape, radius: [radius, 1.0] });
                    for u in [0.0, 0.1, 0.5, ONE_MINUS_EPSILON] {
                        let ([x, y], weight) = filter.sample([u, 0.3]);
                        assert!(x.is_finite() && y.is_finite() && weight.is_finite(), "{shape:?} {u}");
                    }
                }
            }
        }
    }
}

#[test]
fn bits_are_pinned() {
    let bits = |shape| {
        let ([x, y], weight) = Filter::new(shape).sample([0.3, 0.9]);
        [x, y, weight].map(f32::to_bits)
    };
    assert_eq!(bits(Shape::BlackmanHarris.of_radius(1.5)), [0xbe65_e49e, 0x3f0a_674b, 0x3f80_0000]);
    assert_eq!(
        bits(Shape::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }.of_radius(2.0)),
        [0xbe80_b004, 0x3f1a_1f28, 0x3f92_8a09]
    );
    assert_eq!(bits(Shape::Gaussian { sigma: 0.5 }.of_radius(1.5)), [0xbe83_9e3c, 0x3f1f_9f5d, 0x3f80_0000]);
}

struct Eight<'a>(&'a Filter, [[f32; LANES]; 2]);

impl Kernel for Eight<'_> {
    type Output = [[f32; LANES]; 3];

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let ([x, y], weight) = self.0.sample(self.1.map(|u| f32x8::load_array(simd, u)));
        [x.into(), y.into(), weight.into()]
    }
}

#[test]
fn eight_at_once_are_eight_one_by_one() {
    let sampler = Sampler::new(Kind::Sobol, 5);
    for shape in all() {
        let filter = Filter::new(shape);
        for round in 0..2000 {
            let u: [[f32; 2]; LANES] = std::array::from_fn(|lane| sampler.two([lane as u32, 0], round, 0));
            let [x, y, weight] = dispatch(level(), Eight(&filter, [0, 1].map(|axis| u.map(|u| u[axis]))));
            for lane in 0..LANES {
                let bits = |([x, y], weight): ([f32; 2], f32)| [x, y, weight].map(f32::to_bits);
                assert_eq!(
                    bits(([x[lane], y[lane]], weight[lane])),
                    bits(filter.sample(u[lane])),
                    "{shape:?}"
                );
            }
        }
    }
}
