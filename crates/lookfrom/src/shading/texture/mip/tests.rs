use super::*;
use crate::core::hash;

/// A number in 0 … 1.
fn number(seed: u64, index: u64) -> f32 {
    (hash::pair(seed, index) >> 40) as f32 / 16_777_216.0
}

/// A number of any sign and exponent.
fn wild(seed: u64, index: u64) -> f32 {
    let exponent = (hash::pair(seed, index) % 81) as f32 - 40.0;
    libm::exp2f(exponent) * (2.0 * number(seed, index) - 1.0)
}

fn image(width: u32, height: u32) -> Image {
    let texels = (0..u64::from(width * height)).map(|k| [number(k, 0), number(k, 1), number(k, 2)]);
    let alpha = (0..u64::from(width * height)).map(|k| number(k, 3)).collect();
    Image::from_linear_and_alpha("", width, height, texels.collect(), alpha)
}

const EWA: MipFilter = MipFilter::Ewa { anisotropy: 8.0 };
const FILTERS: [MipFilter; 4] = [MipFilter::Nearest, MipFilter::Bilinear, MipFilter::Trilinear, EWA];

fn around(value: [f32; 4], expected: [f32; 4], tolerance: f32) -> bool {
    value.iter().zip(expected).all(|(value, expected)| (value - expected).abs() <= tolerance)
}

fn mean(image: &Image, columns: std::ops::Range<u32>, rows: std::ops::Range<u32>) -> [f32; 4] {
    let count = (columns.len() * rows.len()) as f32;
    let mut sum = [0.0; 4];
    for (column, row) in rows.flat_map(|row| columns.clone().map(move |column| (column, row))) {
        let index = (row * image.width + column) as usize;
        let [r, g, b] = image.texel(index);
        sum.iter_mut().zip([r, g, b, image.alpha(index)]).for_each(|(sum, value)| *sum += value / count);
    }
    sum
}

#[test]
fn trilinear_look_ups_at_texels_are_means_of_areas() {
    let image = image(64, 32);
    let coarser = image.coarser_levels();
    let map = MipMap { image: &image, coarser: &coarser };
    for level in 1..=5_u32 {
        let side = 1 << level;
        // So that twice the longest step is a texel of the level.
        let step = 0.5 * side as f32 / 64.0;
        let steps = [Vec2::new(step, 0.0), Vec2::new(0.0, 0.1 * step)];
        for (column, row) in (0..64 / side).flat_map(|x| (0..32 / side).map(move |y| (x, y))) {
            let st = [(column as f32 + 0.5) * side as f32 / 64.0, (row as f32 + 0.5) * side as f32 / 32.0];
            let of = |k: u32| k * side..(k + 1) * side;
            let expected = mean(&image, of(column), of(row));
            for filter in [MipFilter::Nearest, MipFilter::Bilinear, MipFilter::Trilinear] {
                let found = map.look_up(st, steps, filter, [Wrap::Repeat; 2]);
                assert!(around(found, expected, 1e-5), "{found:?} {expected:?}, {filter:?} at {st:?}");
            }
        }
    }
}

#[test]
fn trilinear_look_ups_go_from_level_to_level_without_a_jump() {
    let image = image(37, 50);
    let coarser = image.coarser_levels();
    let map = MipMap { image: &image, coarser: &coarser };
    let look_up = |width: f32| {
        let steps = [Vec2::ZERO, Vec2::new(0.0, 0.5 * width / 50.0)];
        map.look_up([0.3, 0.7], steps, MipFilter::Trilinear, [Wrap::Clamp; 2])
    };
    let mut before = look_up(0.0);
    assert_eq!(
        before,
        Footprint::new(&image, [0.3, 0.7], [Wrap::Clamp; 2], TexelFilter::Bilinear).blend(&image)
    );
    for k in 0..2000 {
        let next = look_up(libm::exp2f(k as f32 / 250.0 - 1.0));
        assert!(around(next, before, 0.01), "{next:?} after {before:?} at {k}");
        before = next;
    }
    let all = mean(&image, 0..37, 0..50);
    assert!(around(before, all, 1e-5), "{before:?} {all:?}");
}

/// The average of texels under an ellipse by its covariance, with all copies of the image around.
fn slow_average(image: &Image, [s, t]: [f32; 2], [long, short]: [Vec2; 2]) -> [f32; 4] {
    let [long, short] = [long, short].map(Vec2::as_dvec2);
    // The covariance of both axes and of a texel, and its inverse.
    let xx = long.x * long.x + short.x * short.x + 1.0;
    let xy = long.x * long.y + short.x * short.y;
    let yy = long.y * long.y + short.y * short.y + 1.0;
    let determinant = xx * yy - xy * xy;
    let (width, height) = (image.width as i32, image.height as i32);
    let center = [f64::from(s) * f64::from(width), f64::from(t) * f64::from(height)];
    let (mut sum, mut weights) = ([0.0_f64; 4], 0.0);
    for (column, row) in
        (-2 * height..3 * height).flat_map(|row| (-2 * width..3 * width).map(move |x| (x, row)))
    {
        let [x, y] = [f64::from(column) + 0.5 - center[0], f64::from(row) + 0.5 - center[1]];
        let squared = (x * (yy * x - xy * y) + y * (xx * y - xy * x)) / determinant;
        if squared < 1.0 {
            let weight = libm::exp(-2.0 * squared) - libm::exp(-2.0);
            let index = (row.rem_euclid(height) * width + column.rem_euclid(width)) as usize;
            let [r, g, b] = image.texel(index);
            for (sum, value) in sum.iter_mut().zip([r, g, b, image.alpha(index)]) {
                *sum += weight * f64::from(value);
            }
            weights += weight;
        }
    }
    sum.map(|sum| (sum / weights) as f32)
}

#[test]
fn ellipses_are_weighted_averages() {
    let image = image(40, 30);
    let coarser = image.coarser_levels();
    let map = MipMap { image: &image, coarser: &coarser };
    let size = Vec2::new(40.0, 30.0);
    for seed in 0..300 {
        let st = [number(seed, 10), number(seed, 11)];
        // In the finest level: the shorter axis is shorter than a texel.
        let angle = 2.0 * std::f32::consts::PI * number(seed, 12);
        let long = Vec2::new(libm::cosf(angle), libm::sinf(angle)) * (0.6 + 7.0 * number(seed, 13));
        let short = long.perp().normalize() * (0.12 * long.length() + 0.001).max(number(seed, 14)).min(1.0);
        let anisotropy = long.length() / short.length();
        assert!(anisotropy <= 8.4);
        let filter = MipFilter::Ewa { anisotropy: 9.0 };
        let found = map.look_up(st, [short / size, long / size], filter, [Wrap::Repeat; 2]);
        let expected = slow_average(&image, st, [long, short]);
        assert!(around(found, expected, 0.01), "{found:?} {expected:?} along {long} and {short}");
    }
}

#[test]
fn longer_ellipses_are_widened() {
    let image = image(64, 64);
    let coarser = image.coarser_levels();
    let map = MipMap { image: &image, coarser: &coarser };
    let [long, thin, wide] = [Vec2::X * 16.0, Vec2::Y * 0.5, Vec2::Y * 4.0].map(|axis| axis / 64.0);
    let filter = MipFilter::Ewa { anisotropy: 4.0 };
    let look_up = |short: Vec2| map.look_up([0.4, 0.6], [long, short], filter, [Wrap::Repeat; 2]);
    assert_eq!(look_up(thin), look_up(wide));
    // Nowhere as long as it is wide: by the longest axis alone.
    assert!(around(look_up(Vec2::ZERO), look_up(Vec2::ZERO), 0.0));
}

#[test]
fn all_together_they_are_the_mean_of_the_image() {
    for (width, height) in [(32, 32), (24, 10), (7, 33)] {
        let image = image(width, height);
        let coarser = image.coarser_levels();
        let map = MipMap { image: &image, coarser: &coarser };
        let expected = mean(&image, 0..width, 0..height);
        for (filter, steps) in FILTERS.into_iter().flat_map(|filter| {
            [[0.04, 0.01, -0.02, 0.05], [0.2, 0.1, 0.0, 0.1], [3.0, 0.0, 0.0, 2.0]]
                .map(|steps| (filter, steps))
        }) {
            let steps = [Vec2::new(steps[0], steps[1]), Vec2::new(steps[2], steps[3])];
            let mut sum = [0.0; 4];
            const SIDE: u32 = 96;
            for (x, y) in (0..SIDE).flat_map(|x| (0..SIDE).map(move |y| (x, y))) {
                let st = [x, y].map(|k| (k as f32 + 0.5) / SIDE as f32);
                let value = map.look_up(st, steps, filter, [Wrap::Repeat; 2]);
                sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += value / (SIDE * SIDE) as f32);
            }
            assert!(
                around(sum, expected, 0.004),
                "{sum:?} {expected:?}, {filter:?} {steps:?}, {width}×{height}"
            );
        }
    }
}

#[test]
fn whatever_the_size_and_the_steps_values_are_those_of_texels() {
    let sizes = [(1, 1), (1, 50), (300, 1), (2, 3), (17, 13), (256, 2)];
    for (seed, (width, height)) in (0..).zip(sizes) {
        let image = image(width, height);
        let coarser = image.coarser_levels();
        let map = MipMap { image: &image, coarser: &coarser };
        for round in 0..2000 {
            let of = |index: u64| wild(1000 * seed + round, index);
            let steps = match round % 8 {
                0 => [Vec2::ZERO, Vec2::splat(of(0))],
                1 => [Vec2::NAN, Vec2::X],
                2 => [Vec2::INFINITY, Vec2::splat(f32::MAX)],
                _ => [Vec2::new(of(0), of(1)), Vec2::new(of(2), of(3))],
            };
            let st = if round % 3 == 0 { [of(4), of(5)] } else { [number(round, 6), number(round, 7)] };
            for filter in
                FILTERS.into_iter().chain([MipFilter::Ewa { anisotropy: MipFilter::MOST_ANISOTROPY }])
            {
                for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp, Wrap::Black] {
                    let value = map.look_up(st, steps, filter, [wrap; 2]);
                    let is_within = value.iter().all(|value| (-1e-5..1.00001).contains(value));
                    assert!(is_within, "{value:?} at {st:?}, {steps:?} {filter:?}, {width}×{height}");
                }
            }
        }
    }
}
