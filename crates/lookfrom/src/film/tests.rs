//! Tests of the film: order independence and exact sums.

use super::*;
use crate::core::hash::mix;
use lookfrom_scene::settings::{Background, FilterShape, Layers};
use proptest::prelude::*;

const SIZE: u32 = 4;

/// Any f32, by its exponent: among them zeros, denormals, infinities and NaNs.
fn any_light() -> impl Strategy<Value = f32> {
    (0_u32..256, 0_u32..1 << 23, any::<bool>()).prop_map(|(exponent, fraction, negative)| {
        f32::from_bits(u32::from(negative) << 31 | exponent << 23 | fraction)
    })
}

type Sample = (u32, u32, u32, [f32; 3]);

fn any_sample() -> impl Strategy<Value = Sample> {
    (0..SIZE, 0..SIZE, any::<u32>(), prop::array::uniform3(any_light()))
}

fn film_of<'a>(samples: impl IntoIterator<Item = &'a Sample>) -> Film {
    let mut film = Film::new(SIZE, SIZE, None).unwrap();
    for &(x, y, sample, rgb) in samples {
        film.add(x, y, sample, rgb);
    }
    film
}

/// The exact reference: whole multiples of 2⁻⁶⁴ from the bits of an f32, by shifting.
fn slow_fixed_point(light: f32) -> i128 {
    let bits = light.to_bits();
    let exponent = (bits >> 23 & 0xff) as i32;
    let fraction = i128::from(bits & 0x7f_ffff);
    // light = ±mantissa · 2^power
    let (mantissa, power) =
        if exponent == 0 { (fraction, -149) } else { (fraction | 1 << 23, exponent - 150) };
    let shift = power + 64;
    let magnitude = if exponent >= 127 + 40 {
        1 << 104
    } else if shift >= 0 {
        mantissa << shift
    } else if shift > -64 {
        mantissa >> -shift
    } else {
        0
    };
    if light.is_sign_negative() { -magnitude } else { magnitude }
}

/// The square, rounded to f64, in multiples of 2⁻⁴⁸, from its bits.
fn slow_square(value: f64) -> u128 {
    let bits = (value * value).to_bits();
    let mantissa = u128::from(bits & ((1 << 52) - 1) | 1 << 52);
    match (bits >> 52) as i32 - 1075 + 48 {
        76.. => u128::MAX,
        shift @ 0.. => mantissa << shift,
        shift @ -127..0 => mantissa >> -shift,
        _ => 0,
    }
}

proptest! {
    #[test]
    fn variance_is_the_textbook_one(
        exponent in -20..20_i32,
        samples in prop::collection::vec((-1.0..1.0_f64, 0.0..1.0_f64, -60..0_i32), 2..40),
    ) {
        // One scale per pixel, and numbers of any size below it.
        let scale = 2_f64.powi(exponent);
        let mut film = Film::new(1, 1, None).unwrap();
        let lights: Vec<[f32; 3]> = samples
            .iter()
            .map(|&(a, b, small)| [a * scale, (1.0 + b) * scale, b * scale * 2_f64.powi(small)].map(|x| x as f32))
            .collect();
        for (i, &rgb) in lights.iter().enumerate() {
            film.add(0, 0, i as u32, rgb);
        }
        let n = lights.len() as f64;
        for channel in 0..3 {
            let values = || lights.iter().map(|rgb| xyz(rgb.map(f64::from))[channel]);
            let mean = values().sum::<f64>() / n;
            let expected = values().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0);
            let found = f64::from(film.variance(0, 0)[channel]);
            // The truncation of the squares, and the cancellation in the difference of two rounded numbers.
            let allowed = 1e-6 * expected + 2_f64.powi(-46) + 1e-13 * scale * scale;
            prop_assert!((found - expected).abs() <= allowed, "{channel}: {found} {expected}");
        }
    }

    #[test]
    fn the_order_does_not_matter(samples in prop::collection::vec(any_sample(), 0..60), seed: u64) {
        let mut other = samples.clone();
        // Fisher–Yates shuffle.
        for i in (1..other.len()).rev() {
            other.swap(i, mix(seed.wrapping_add(i as u64)) as usize % (i + 1));
        }
        prop_assert_eq!(film_of(&samples), film_of(&other));
    }

    #[test]
    fn the_split_does_not_matter(samples in prop::collection::vec(any_sample(), 0..60), seed: u64) {
        let whole = film_of(&samples);
        // Distribute the samples over five films, and merge them in reverse order.
        let dealt = |hand: u64| samples.iter().enumerate()
            .filter(move |&(i, _)| mix(seed.wrapping_add(i as u64)) % 5 == hand).map(|(_, sample)| sample);
        let mut merged = Film::new(SIZE, SIZE, None).unwrap();
        for hand in (0..5).rev() {
            merged.merge(&film_of(dealt(hand))).unwrap();
        }
        prop_assert_eq!(&merged, &whole);
        // Cut the film into tiles at a random point.
        let (cx, cy) = (seed as u32 % (SIZE + 1), (seed >> 32) as u32 % (SIZE + 1));
        let mut tiled = Film::new(SIZE, SIZE, None).unwrap();
        for (x0, x1) in [(cx, SIZE), (0, cx)] {
            for (y0, y1) in [(0, cy), (cy, SIZE)] {
                let mut tile = FilmTile::new(PixelBounds { x0, y0, x1, y1 }).unwrap();
                for &(x, y, sample, rgb) in &samples {
                    if (x0..x1).contains(&x) && (y0..y1).contains(&y) {
                        tile.add(x, y, sample, rgb);
                    }
                }
                tiled.add_tile(&tile).unwrap();
            }
        }
        prop_assert_eq!(tiled, whole);
    }

    /// Threads that have detached the same blocks at the same time add to each other's sums.
    #[test]
    fn blocks_may_be_detached_by_many(samples in prop::collection::vec(any_sample(), 0..60), seed: u64) {
        let tiles: Vec<FilmTile> = (0..4).map(|hand| {
            let mut tile = FilmTile::new(PixelBounds { x0: 0, y0: 0, x1: SIZE, y1: SIZE }).unwrap();
            for (i, &(x, y, sample, rgb)) in samples.iter().enumerate() {
                if mix(seed.wrapping_add(i as u64)) % 4 == hand {
                    tile.add(x, y, sample, rgb);
                }
            }
            tile
        }).collect();
        let mut film = Film::new(SIZE, SIZE, None).unwrap();
        film.add_tile(&tiles[0]).unwrap();
        let mut detached: Vec<_> = tiles[1..].iter().map(|tile| film.detach(tile).unwrap()).collect();
        detached.iter_mut().zip(&tiles[1..]).for_each(|(blocks, tile)| blocks.add(tile));
        detached.into_iter().rev().for_each(|blocks| film.attach(blocks));
        prop_assert_eq!(film, film_of(&samples));
    }

    #[test]
    fn sums_are_the_true_ones(lights in prop::collection::vec(any_light(), 1..60)) {
        let mut film = Film::new(1, 1, None).unwrap();
        let (mut sum, mut squares, mut count) = (0_i128, [0_u128; 3], 0_u64);
        for (i, &light) in lights.iter().enumerate() {
            film.add(0, 0, i as u32, [light, 0.0, -light]);
            if light.is_finite() {
                sum += slow_fixed_point(light);
                let light = f64::from(light.clamp(-BRIGHTEST, BRIGHTEST));
                squares = std::array::from_fn(|i| {
                    squares[i].saturating_add(slow_square(xyz([light, 0.0, -light])[i]))
                });
                count += 1;
            }
        }
        let expected = Pixel { sums: [sum, 0, -sum], squares, samples: count };
        prop_assert_eq!(film.pixel(0, 0).unwrap().pixel, expected);
        prop_assert_eq!(film.dropped() + count, lights.len() as u64);
        if count > 0 {
            prop_assert_eq!(film.mean(0, 0)[0], (sum as f64 / 2_f64.powi(64) / count as f64) as f32);
        }
    }

    #[test]
    fn what_an_f32_can_say_above_the_limit_is_kept_exactly(light in any_light()) {
        prop_assume!(light.abs() >= 2_f32.powi(-40) && light.abs() <= BRIGHTEST);
        let mut film = Film::new(1, 1, None).unwrap();
        film.add(0, 0, 0, [light, light, light]);
        prop_assert_eq!(film.mean(0, 0), [light; 3]);
    }
}

#[test]
fn the_first_dropped_sample_is_the_least_not_the_earliest() {
    let mut film = Film::new(4, 4, None).unwrap();
    film.add(3, 2, 9, [f32::NAN, 0.0, 0.0]);
    film.add(1, 2, 5, [0.0, f32::NEG_INFINITY, 0.0]);
    film.add(1, 2, 4, [0.0, 0.0, f32::INFINITY]);
    film.add(0, 3, 0, [f32::NAN; 3]);
    film.add(0, 0, 0, [1.0; 3]);
    assert_eq!(film.dropped(), 4);
    assert_eq!(film.first_dropped(), Some(SampleId { pixel: [1, 2], sample: 4 }));
    assert_eq!((film.samples(1, 2), film.samples(0, 0)), (0, 1));
}

#[test]
fn light_is_cut_at_the_ends() {
    let mut film = Film::new(1, 1, None).unwrap();
    film.add(0, 0, 0, [f32::MAX, f32::MIN, f32::MIN_POSITIVE]);
    assert_eq!(film.mean(0, 0), [BRIGHTEST, -BRIGHTEST, 0.0]);
}

#[test]
fn many_bright_samples_fit() {
    let mut film = Film::new(1, 1, None).unwrap();
    film.add(0, 0, 0, [BRIGHTEST, 1.0, 0.0]);
    // Double it 22 times: 2²² samples.
    for _ in 0..22 {
        film.merge(&film.clone()).unwrap();
    }
    assert_eq!(film.mean(0, 0), [BRIGHTEST, 1.0, 0.0]);
    assert_eq!(film.samples(0, 0), 1 << 22);
}

#[test]
fn a_crop_holds_its_part_of_the_whole_picture() {
    let crop = PixelBounds { x0: 2, y0: 1, x1: 100, y1: 3 };
    let mut film = Film::new(4, 4, Some(crop)).unwrap();
    assert_eq!(film.area(), PixelBounds { x0: 2, y0: 1, x1: 4, y1: 3 });
    film.add(3, 2, 0, [1.0, 2.0, 3.0]);
    let picture = film.picture();
    assert_eq!((picture.width, picture.height, picture.pixels.len()), (4, 4, 16));
    for (i, &pixel) in picture.pixels.iter().enumerate() {
        assert_eq!(pixel, if i == 2 * 4 + 3 { [1.0, 2.0, 3.0] } else { [0.0; 3] });
    }
    assert_eq!((film.mean(0, 0), film.mean(9, 9)), ([0.0; 3], [0.0; 3]));
    // A crop outside of the picture, or one that ends before it begins, is empty.
    for (x0, y0, x1, y1) in [(7, 0, 9, 4), (0, 7, 4, 9), (3, 0, 1, 4), (4, 4, 4, 4)] {
        let mut film = Film::new(4, 4, Some(PixelBounds { x0, y0, x1, y1 })).unwrap();
        film.add_tile(&FilmTile::new(PixelBounds { x0, y0, x1: x0, y1: y0 }).unwrap()).unwrap();
        assert!(film.merge(&Film::new(4, 4, None).unwrap()).is_err());
        assert_eq!(film.picture().pixels, [[0.0; 3]; 16]);
    }
}

#[test]
fn nothing_is_left_out_in_silence() {
    let area = PixelBounds { x0: 0, y0: 0, x1: 4, y1: 4 };
    let mut tile = FilmTile::new(area).unwrap();
    (0..16).for_each(|i| tile.add(i % 4, i / 4, 0, [i as f32; 3]));
    tile.record(0..1).unwrap();
    assert!(tile.record(0..1).is_err());
    // Pixels outside of a crop.
    let mut film = Film::new(8, 8, Some(PixelBounds { x0: 2, y0: 3, x1: 8, y1: 8 })).unwrap();
    let before = film.clone();
    assert!(film.add_tile(&tile).is_err() && film == before);
    // The same samples twice, and others.
    let mut film = Film::new(8, 8, None).unwrap();
    film.add_tile(&tile).unwrap();
    let before = film.clone();
    let error = film.add_tile(&tile).unwrap_err();
    assert!(error.message.contains("samples 0..1 of pixel 0 0") && film == before, "{error}");
    let mut later = FilmTile::new(area).unwrap();
    later.record(1..2).unwrap();
    film.add_tile(&later).unwrap();
    // Other kinds of sums.
    let image = ImageSettings {
        width: 8,
        height: 8,
        background: Background::Transparent,
        ..ImageSettings::default()
    };
    let other = Film::for_image(&image).unwrap();
    let error = film.merge(&other).unwrap_err();
    assert!(error.message.contains("a film of light and alpha cannot be added to one of light"), "{error}");
}

#[test]
fn what_cannot_be_is_an_error() {
    assert_eq!(Film::new(u32::MAX, u32::MAX, None).unwrap_err().kind, ErrorKind::Limit);
    let other = Film::new(2, 3, None).unwrap();
    let error = Film::new(3, 2, None).unwrap().merge(&other).unwrap_err();
    assert!(error.message.contains("2 × 3") && error.message.contains("3 × 2"), "{error}");
}

#[test]
#[should_panic(expected = "outside")]
fn a_pixel_outside_of_the_tile_is_a_mistake_of_the_caller() {
    FilmTile::new(PixelBounds { x0: 4, y0: 4, x1: 8, y1: 8 }).unwrap().add(3, 5, 0, [0.0; 3]);
}

#[test]
fn pixels_take_as_many_bytes_as_documented() {
    assert_eq!([size_of::<Pixel>(), size_of::<AovSums>(), size_of::<LayerSums>()], [112, 96, 208]);
}

#[test]
fn the_variance_of_little_and_of_much() {
    let mut film = Film::new(2, 1, None).unwrap();
    assert_eq!(film.variance(0, 0), [f32::INFINITY; 3]);
    film.add(0, 0, 0, [3.0; 3]);
    assert_eq!(film.variance(0, 0), [f32::INFINITY; 3]);
    assert_eq!(film.variance(9, 9), [f32::INFINITY; 3]);
    for sample in 1..1000 {
        film.add(0, 0, sample, [3.0; 3]);
    }
    assert!(film.variance(0, 0).iter().all(|&variance| variance < 1e-12), "{:?}", film.variance(0, 0));
    // Saturated squares stay saturated.
    for sample in 0..100 {
        film.add(1, 0, sample, [BRIGHTEST, 1.0, -BRIGHTEST]);
    }
    assert_eq!(film.pixel(1, 0).unwrap().pixel.squares, [u128::MAX; 3]);
    assert!(film.variance(1, 0).iter().all(|variance| variance.is_finite()));
}

#[test]
fn noise_is_relative_to_the_light_and_to_the_mean() {
    let mut film = Film::new(2, 1, None).unwrap();
    let area = film.area();
    assert_eq!(film.relative_error(area, 1.0), f64::INFINITY);
    // Grey light of 1 ± 1 in one pixel, nothing in the other: the mean of the picture is a half.
    for sample in 0..64 {
        film.add(0, 0, sample, if sample % 2 == 0 { [2.0; 3] } else { [0.0; 3] });
        film.add(1, 0, sample, [0.0; 3]);
    }
    assert!((film.mean_luminance() - 0.5).abs() < 1e-6);
    let error = (64.0_f64 / 63.0 / 64.0).sqrt() / 1.05;
    assert!((film.relative_error(area, film.mean_luminance()) - error / 2.0).abs() < 1e-6);
    let right = PixelBounds { x0: 1, y0: 0, x1: 5, y1: 9 };
    assert_eq!(film.relative_error(right, film.mean_luminance()), 0.0);
}

#[test]
fn layers_are_means_whatever_the_order() {
    let whole = PixelBounds { x0: 0, y0: 0, x1: 2, y1: 1 };
    let of = |k: f32| Aovs {
        albedo: [0.5, k * 0.25, 0.0],
        ng: [0.0, 0.0, -1.0],
        ns: [0.6, 0.0, -0.8],
        position: [k * 1e3, -k, 7.0],
        uv: [k * 1e-3, 0.5],
    };
    let mut films = [film_with_layers(), film_with_layers()];
    for (film, order) in films.iter_mut().zip([[0, 1, 2], [2, 0, 1]]) {
        for k in order {
            let mut tile = FilmTile::for_image(whole, &with_layers()).unwrap();
            tile.add(0, 0, k, [1.0; 3]);
            tile.add_first_hit(0, 0, k, Some(&of(k as f32)));
            film.add_tile(&tile).unwrap();
        }
        // One more sample, whose position is NaN: it counts as a miss.
        let mut tile = FilmTile::for_image(whole, &with_layers()).unwrap();
        tile.add_first_hit(0, 0, 3, Some(&Aovs { position: [f32::NAN; 3], ..of(1.0) }));
        film.add_tile(&tile).unwrap();
    }
    assert!(films[0] == films[1]);
    let mean = films[0].aovs(0, 0).unwrap();
    assert_eq!(mean.albedo, [0.375, 0.1875, 0.0]);
    assert_eq!((mean.position, mean.ng, mean.uv), ([1e3, -1.0, 7.0], [0.0, 0.0, -1.0], [1e-3, 0.5]));
    assert_eq!((films[0].aovs(1, 0), films[0].aovs(9, 9)), (None, None));
    // A mean of normals is normalised, and 0 where they cancel.
    let mut tile = FilmTile::for_image(whole, &with_layers()).unwrap();
    tile.add_first_hit(0, 0, 0, Some(&Aovs { ns: [1.0, 0.0, 0.0], ..of(0.0) }));
    let other = Aovs { ng: [0.0, 0.0, 1.0], ns: [0.0, 1.0, 0.0], ..of(0.0) };
    tile.add_first_hit(0, 0, 1, Some(&other));
    let mut film = film_with_layers();
    film.add_tile(&tile).unwrap();
    let mean = film.aovs(0, 0).unwrap();
    let diagonal = std::f32::consts::FRAC_1_SQRT_2;
    assert_eq!((mean.ng, mean.ns), ([0.0; 3], [diagonal, diagonal, 0.0]));
    // Without memory for them nothing happens.
    let mut plain = FilmTile::new(whole).unwrap();
    plain.add_first_hit(0, 0, 0, Some(&of(1.0)));
    assert!(!plain.has_layers() && plain == FilmTile::new(whole).unwrap());
}

fn with_layers() -> ImageSettings {
    ImageSettings { width: 2, height: 1, layers: Layers::Geometry, ..ImageSettings::default() }
}

fn film_with_layers() -> Film {
    Film::for_image(&with_layers()).unwrap()
}

#[test]
fn fireflies_are_spread_and_the_sum_is_kept() {
    let mut film = Film::new(9, 9, None).unwrap();
    for (x, y) in (0..81).map(|i| (i % 9, i / 9)) {
        for sample in 0..16 {
            let grain = 1.0 + 0.1 * (mix(u64::from((y * 9 + x) * 16 + sample)) % 1000) as f32 * 1e-3;
            // A light that is always visible, and one sample that hit it by chance.
            let lamp = if (x, y) == (7, 7) { 100.0 } else { 0.0 };
            let chance = if (x, y, sample) == (2, 3, 5) { 4000.0 } else { 0.0 };
            film.add(x, y, sample, [grain + lamp + chance, grain + lamp, grain + lamp + 0.5 * chance]);
        }
    }
    let (before, after) = (film.picture(), film.picture_without_fireflies());
    let at = |picture: &Picture, x: usize, y: usize| picture.pixels[y * 9 + x];
    assert!(at(&before, 2, 3)[0] > 250.0 && at(&after, 2, 3)[0] < 16.0);
    assert_eq!(at(&before, 7, 7), at(&after, 7, 7));
    assert_eq!(at(&before, 2, 6), at(&after, 2, 6), "too far away");
    assert!(at(&after, 0, 1)[0] > 10.0, "gets its share");
    for channel in 0..3 {
        let sum = |picture: &Picture| picture.pixels.iter().map(|rgb| f64::from(rgb[channel])).sum::<f64>();
        assert!((sum(&before) - sum(&after)).abs() < 1e-4 * sum(&before));
    }
}

/// A picture of an edge, of a lattice of small lamps and of noise that is not carried by single samples has no fireflies,
/// however many samples there are: it is the same with and without the filter.
#[test]
fn edges_and_lamps_are_no_fireflies() {
    const SIZE: u32 = 24;
    for samples in [2, 4, 8, 16, 64] {
        let mut film = Film::new(SIZE, SIZE, None).unwrap();
        for (x, y, sample) in
            (0..SIZE * SIZE).flat_map(|i| (0..samples).map(move |sample| (i % SIZE, i / SIZE, sample)))
        {
            let bits = mix(u64::from((y * SIZE + x) * samples + sample) + 1);
            let [s, t] = [bits & 0xffff, bits >> 16 & 0xffff].map(|bits| bits as f32 / 65536.0);
            // A point in the pixel and its surroundings, as pixel filters choose it.
            let [px, py] = [x as f32 + 3.0 * s - 1.0, y as f32 + 3.0 * t - 1.0];
            let edge = if px + 0.6 * py > 19.3 { 1.0 } else { 0.02 };
            let grain = edge * (0.5 + (bits >> 32 & 0xffff) as f32 / 65536.0);
            film.add(x, y, sample, [grain; 3]);
        }
        assert_eq!(film.fireflies(), [], "{samples} samples");
        assert_eq!(film.picture(), film.picture_without_fireflies());
    }
    // Lamps half as large as a pixel.
    let mut film = Film::new(SIZE, SIZE, None).unwrap();
    for (x, y, sample) in
        (0..SIZE * SIZE).flat_map(|i| (0..16).map(move |sample| (i % SIZE, i / SIZE, sample)))
    {
        let hits = x % 6 == 3 && y % 6 == 3 && sample % 2 == 0;
        film.add(x, y, sample, if hits { [300.0; 3] } else { [0.1; 3] });
    }
    assert_eq!(film.fireflies(), []);
}

/// Fireflies of a noisy film, in rows of blocks, are those of the definition, pixel by pixel: also beside the borders of
/// blocks and of the film.
#[test]
fn fireflies_are_those_of_the_definition() {
    const SIZE: [u32; 2] = [37, 70];
    let area = PixelBounds { x0: 1, y0: 5, x1: 36, y1: 69 };
    let mut film = Film::new(SIZE[0], SIZE[1], Some(area)).unwrap();
    for [x, y] in (area.y0..area.y1).flat_map(|y| (area.x0..area.x1).map(move |x| [x, y])) {
        // One sample here and there, whose error is infinite.
        let samples = if mix(u64::from(y * 37 + x)).is_multiple_of(9) { 1 } else { 8 };
        for sample in 0..samples {
            let bits = mix(u64::from(y * 37 + x) << 8 | u64::from(sample));
            let light = if bits.is_multiple_of(200) { 1e3 } else { (bits >> 40) as f32 / 16_777_216.0 };
            film.add(x, y, sample, [light; 3]);
        }
    }
    let known = |x: u32, y: u32| {
        let pixel = film.pixel(x, y)?;
        Some([pixel.luminance(), pixel.standard_error()])
    };
    let others = |x: u32, y: u32, radius: i32| -> Vec<[f64; 2]> {
        let offsets = (-radius..=radius).flat_map(|dy| (-radius..=radius).map(move |dx| [dx, dy]));
        let places = offsets
            .filter(|offset| *offset != [0, 0])
            .filter_map(|[dx, dy]| Some([x.checked_add_signed(dx)?, y.checked_add_signed(dy)?]));
        places.filter_map(|[x, y]| known(x, y)).collect()
    };
    let median = |mut numbers: Vec<f64>| {
        numbers.sort_by(f64::total_cmp);
        numbers[(numbers.len() - 1) / 2]
    };
    let is_firefly = |&[x, y]: &[u32; 2]| {
        let Some([light, error]) = known(x, y) else { return false };
        let near = others(x, y, 1);
        let [lights, errors] = [0, 1].map(|index| near.iter().map(|known| known[index]).collect());
        light > 0.0
            && error > 0.7 * light
            && near.iter().all(|[other, _]| *other < 0.25 * light)
            && !others(x, y, 2).iter().any(|[other, error]| *error <= 0.7 * other && *other >= 0.5 * light)
            && light - median(lights) > 3.0 * median(errors)
    };
    let places = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| [x, y]));
    let expected: Vec<_> = places.filter(is_firefly).collect();
    let mut found: Vec<_> = film.fireflies().iter().map(|firefly| firefly.pixel).collect();
    found.sort_by_key(|&[x, y]| [y, x]);
    assert_eq!(found, expected);
    let rows = [[5, 6], [30, 33], [62, 65], [67, 68]];
    assert!(
        rows.iter().all(|[first, last]| expected.iter().any(|[_, y]| (first..=last).contains(&y))),
        "{expected:?}"
    );
}

#[test]
fn channels_have_their_variance() {
    use lookfrom_scene::settings::Sensor;
    let sensor = Sensor { white_balance: Some(5000.0), ..Sensor::default() };
    let image =
        ImageSettings { width: 2, height: 1, layers: Layers::Geometry, sensor, ..ImageSettings::default() };
    let samples = [[1.0, 2.0, -3.0], [3.0, 2.5, 0.0], [2.0, 0.0, 0.5], [f32::NAN, 1.0, 1.0]];
    let film_of = |samples: &[[f32; 3]]| {
        let mut film = Film::for_image(&image).unwrap();
        let mut tile = FilmTile::for_image(film.area(), &image).unwrap();
        assert!(tile.has_channels());
        samples.iter().for_each(|&channels| tile.add_channels(0, 0, channels));
        film.add_tile(&tile).unwrap();
        film
    };
    let mut film = film_of(&samples[2..]);
    film.merge(&film_of(&samples[..2])).unwrap();
    assert_eq!(film, film_of(&samples));
    // By hand: 1, 3, 2 and 2, 2.5, 0 and -3, 0, 0.5.
    for (found, expected) in film.channel_variance(0, 0).unwrap().into_iter().zip([1.0, 1.75, 3.583_333_3]) {
        assert!((found - expected).abs() < 1e-6, "{found} ≠ {expected}");
    }
    assert_eq!(film.channel_variance(1, 0), Some([f32::INFINITY; 3]));
    // X, Y and Z have their variance already, and without AOVs it is not needed.
    for (layers, sensor) in [(Layers::Geometry, Sensor::default()), (Layers::None, sensor)] {
        let image = ImageSettings { layers, sensor, ..ImageSettings::default() };
        assert_eq!(Film::for_image(&image).unwrap().channel_variance(0, 0), None);
    }
}

/// A film of one pixel, with alpha, for a filter with negative lobes: of samples with light and weights.
fn film_of_weights(samples: impl IntoIterator<Item = ([f32; 3], f32)>) -> Film {
    let image = ImageSettings {
        width: 1,
        height: 1,
        filter: FilterShape::Sinc { tau: 3.0 }.of_radius(4.0),
        background: Background::Transparent,
        ..ImageSettings::default()
    };
    let mut film = Film::for_image(&image).unwrap();
    let mut tile = film.tile(film.area()).unwrap();
    for (sample, (light, weight)) in (0..).zip(samples) {
        tile.add_weighted(0, 0, sample, light.map(|light| light * weight), 0.5, weight);
    }
    film.add_tile(&tile).unwrap();
    film
}

#[test]
fn light_that_is_the_same_all_over_a_filter_has_no_noise() {
    let light = [0.5, 0.25, 3.0];
    for signs in [&[1.0][..], &[-1.0], &[1.0, -1.0], &[1.0, 1.0, -1.0, 1.0, 1.0], &[-1.0, -1.0, -1.0]] {
        let film = film_of_weights(signs.iter().map(|sign| (light, 1.75 * sign)));
        assert_eq!((film.mean(0, 0), film.alpha(0, 0)), (light, Some(0.5)), "{signs:?}");
        assert_eq!((film.picture().pixels[0], film.picture().alpha[0]), (light, 0.5));
        assert!(signs.len() < 2 || film.variance(0, 0)[1] < 1e-6);
    }
}

/// The mean of the estimates over all signs of the weights, by their probabilities, is that of the light.
#[test]
fn estimates_by_weights_are_right_in_the_mean() {
    let light: [f32; 4] = [0.25, 7.0, 0.0, 1.5];
    // Positive with the probability 3/4, so that the mean of the weights is 1.
    let (mut expected, mut of_variance) = (0.0, 0.0);
    for signs in 0..1_u32 << light.len() {
        let is_negative = |k: usize| signs >> k & 1 != 0;
        let weight = |k: usize| if is_negative(k) { -2.0 } else { 2.0 };
        let probability: f64 = (0..light.len()).map(|k| if is_negative(k) { 0.25 } else { 0.75 }).product();
        let film = film_of_weights(light.iter().enumerate().map(|(k, light)| ([*light; 3], weight(k))));
        expected += probability * f64::from(film.mean(0, 0)[1]);
        of_variance += probability * f64::from(film.variance(0, 0)[1]);
    }
    assert!((expected - 8.75 / 4.0).abs() < 1e-6, "{expected}");
    // That of w (L − m) is c² times that of the light, less what the mean of w (L − m) has: half of the light here, or more.
    assert!((0.5..4.0).contains(&(of_variance / 10.6)), "{of_variance}");
}
