//! Is a film the same whatever the order, and are its sums the true ones?

use super::*;
use crate::hash::mix;
use proptest::prelude::*;

const SIZE: u32 = 4;

/// Any f32 whatever, by its exponent: among them zeros, denormals, infinities and NaNs.
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

/// The same, for numbers whose exact value is wanted: whole multiples of 2⁻⁶⁴ from the bits of an f32, by shifting.
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

proptest! {
    #[test]
    fn the_order_does_not_matter(samples in prop::collection::vec(any_sample(), 0..60), seed: u64) {
        let mut other = samples.clone();
        // Shuffle, as Fisher and Yates do.
        for i in (1..other.len()).rev() {
            other.swap(i, mix(seed.wrapping_add(i as u64)) as usize % (i + 1));
        }
        prop_assert_eq!(film_of(&samples), film_of(&other));
    }

    #[test]
    fn the_split_does_not_matter(samples in prop::collection::vec(any_sample(), 0..60), seed: u64) {
        let whole = film_of(&samples);
        // Deal the samples to five films, and merge them backward.
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
                let mut tile = FilmTile::new(Crop { x0, y0, x1, y1 }).unwrap();
                for &(x, y, sample, rgb) in &samples {
                    if (x0..x1).contains(&x) && (y0..y1).contains(&y) {
                        tile.add(x, y, sample, rgb);
                    }
                }
                tiled.add_tile(&tile);
            }
        }
        prop_assert_eq!(tiled, whole);
    }

    #[test]
    fn sums_are_the_true_ones(lights in prop::collection::vec(any_light(), 1..60)) {
        let mut film = Film::new(1, 1, None).unwrap();
        let (mut sum, mut count) = (0_i128, 0_u64);
        for (i, &light) in lights.iter().enumerate() {
            film.add(0, 0, i as u32, [light, 0.0, -light]);
            if light.is_finite() {
                sum += slow_fixed_point(light);
                count += 1;
            }
        }
        prop_assert_eq!(film.tile.pixels[0], Pixel { sums: [sum, 0, -sum], samples: count });
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
    assert_eq!(film.first_dropped(), Some(Address { y: 2, x: 1, sample: 4 }));
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
    let crop = Crop { x0: 2, y0: 1, x1: 100, y1: 3 };
    let mut film = Film::new(4, 4, Some(crop)).unwrap();
    assert_eq!(film.area(), Crop { x0: 2, y0: 1, x1: 4, y1: 3 });
    film.add(3, 2, 0, [1.0, 2.0, 3.0]);
    let picture = film.picture();
    assert_eq!((picture.width, picture.height, picture.pixels.len()), (4, 4, 16));
    for (i, &pixel) in picture.pixels.iter().enumerate() {
        assert_eq!(pixel, if i == 2 * 4 + 3 { [1.0, 2.0, 3.0] } else { [0.0; 3] });
    }
    assert_eq!((film.mean(0, 0), film.mean(9, 9)), ([0.0; 3], [0.0; 3]));
    // A crop beside the picture, or one that ends before it begins, holds nothing.
    for (x0, y0, x1, y1) in [(7, 0, 9, 4), (0, 7, 4, 9), (3, 0, 1, 4), (4, 4, 4, 4)] {
        let mut film = Film::new(4, 4, Some(Crop { x0, y0, x1, y1 })).unwrap();
        film.add_tile(&FilmTile::new(Crop { x0, y0, x1, y1 }).unwrap());
        film.merge(&Film::new(4, 4, None).unwrap()).unwrap();
        assert_eq!(film.picture().pixels, [[0.0; 3]; 16]);
    }
}

#[test]
fn parts_of_tiles_outside_of_a_crop_are_left_out() {
    let mut tile = FilmTile::new(Crop { x0: 0, y0: 0, x1: 4, y1: 4 }).unwrap();
    for i in 0..16 {
        tile.add(i % 4, i / 4, 0, [i as f32; 3]);
    }
    let mut film = Film::new(8, 8, Some(Crop { x0: 2, y0: 3, x1: 8, y1: 8 })).unwrap();
    film.add_tile(&tile);
    assert_eq!([film.mean(2, 3), film.mean(3, 3), film.mean(4, 4)], [[14.0; 3], [15.0; 3], [0.0; 3]]);
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
    FilmTile::new(Crop { x0: 4, y0: 4, x1: 8, y1: 8 }).unwrap().add(3, 5, 0, [0.0; 3]);
}

#[test]
fn a_pixel_takes_64_bytes() {
    assert_eq!(size_of::<Pixel>(), 64);
}

/// Not a check but a measurement: `cargo test --release -p lookfrom film -- --ignored --nocapture`.
#[test]
#[ignore = "measures time"]
fn time_of_add() {
    const N: u32 = 20_000_000;
    let mut tile = FilmTile::new(Crop { x0: 0, y0: 0, x1: 16, y1: 16 }).unwrap();
    let start = std::time::Instant::now();
    for i in 0..N {
        tile.add(i & 15, i >> 4 & 15, i, [i as f32 * 1e-5, 0.5, -1e-7]);
    }
    let nanoseconds = start.elapsed().as_secs_f64() * 1e9 / f64::from(N);
    println!("{nanoseconds:.2} ns ({:?})", tile.pixels[7].mean());
}
