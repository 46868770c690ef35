//! Tests of the denoiser against its slow reference, and of its properties.

use lookfrom_scene::settings::{Background, ImageSettings, PixelBounds};
use proptest::prelude::*;

use super::filter::{distance, falloff};
use super::*;
use crate::core::hash;
use crate::film::{Aovs, FilmTile};

/// Pseudorandom numbers in `[0, 1)` from a counter.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 += 1;
        (hash::pair(self.0, 77) >> 40) as f32 / 16_777_216.0
    }
}

fn image(width: u32, height: u32) -> ImageSettings {
    ImageSettings { width, height, denoise: true, ..ImageSettings::default() }
}

/// A film whose samples and features are given by a function of pixel and sample.
fn film(
    image: &ImageSettings,
    samples: u32,
    mut of: impl FnMut(u32, u32, u32) -> ([f32; 3], f32, Option<Aovs>),
) -> Film {
    let mut film = Film::for_image(image).unwrap();
    let mut tile = FilmTile::for_image(film.area(), image).unwrap();
    let PixelBounds { x0, y0, x1, y1 } = film.area();
    for (y, x) in (y0..y1).flat_map(|y| (x0..x1).map(move |x| (y, x))) {
        for sample in 0..samples {
            let (rgb, alpha, aovs) = of(x, y, sample);
            tile.add_weighted(x, y, sample, rgb, alpha, 1.0);
            tile.add_first_hit(x, y, sample, aovs.as_ref());
        }
    }
    film.add_tile(&tile).unwrap();
    film
}

/// A wall of a colour that faces the camera.
fn wall(x: u32, y: u32, albedo: [f32; 3]) -> Option<Aovs> {
    let n = [0.0, 0.0, -1.0];
    let position = [0.01 * x as f32, -0.01 * y as f32, 3.0];
    Some(Aovs { albedo, ns: n, ng: n, position, uv: [0.0; 2] })
}

fn means(picture: &Picture) -> [f64; 3] {
    [0, 1, 2]
        .map(|c| picture.pixels.iter().map(|p| f64::from(p[c])).sum::<f64>() / picture.pixels.len() as f64)
}

/// The mean square error of a picture's green channel.
fn error(picture: &Picture, of: impl Fn(usize, usize) -> f32) -> f64 {
    let width = picture.width as usize;
    let square =
        |(index, pixel): (usize, &[f32; 3])| f64::from(pixel[1] - of(index % width, index / width)).powi(2);
    picture.pixels.iter().enumerate().map(square).sum::<f64>() / picture.pixels.len() as f64
}

/// The filter's change of a pixel of the planes, by the formula, one neighbour after the other.
fn change<const N: usize>(planes: &Planes<N>, x: usize, y: usize) -> [f32; N] {
    let at = |x: i64, y: i64| {
        (y + planes::BORDER as i64) as usize * planes.stride + (x + planes::BORDER as i64) as usize
    };
    let (x, y, reach, patch) = (x as i64, y as i64, RADIUS as i64, PATCH as i64);
    let mut sums = [0.0; N];
    let mut weights = 1.0;
    for (dy, dx) in (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dy, dx))) {
        if (dx, dy) == (0, 0) {
            continue;
        }
        // Rows of the patches first.
        let mut of_light = 0.0;
        for py in -patch..=patch {
            let mut of_row = 0.0;
            for px in -patch..=patch {
                let (p, q) = (at(x + px, y + py), at(x + px + dx, y + py + dy));
                let square = planes.light.iter().fold(0.0, |sum, light| {
                    let difference = light[q] - light[p];
                    sum + difference * difference
                });
                let of_pixel = distance(square, planes.variance[p], planes.variance[q]);
                of_row = if px == -patch { of_pixel } else { of_row + of_pixel };
            }
            of_light = if py == -patch { of_row } else { of_light + of_row };
        }
        let (p, q) = (at(x, y), at(x + dx, y + dy));
        let of_features = planes.compared.iter().fold(0.0, |sum, feature| {
            let difference = feature[q] - feature[p];
            sum + difference * difference
        });
        let off_plane =
            (0..3).fold(0.0, |sum, i| sum + (planes.place[i][q] - planes.place[i][p]) * planes.plane[i][p]);
        let weight = falloff(of_light, (of_features + off_plane * off_plane) * planes.trust[p]);
        weights += weight;
        for (sum, light) in sums.iter_mut().zip(&planes.light) {
            *sum += weight * (light[q] - light[p]);
        }
    }
    sums.map(|sum| sum / weights)
}

/// A film of noise over many orders of magnitude, with hits in some pixels.
fn random(image: &ImageSettings, samples: u32, seed: u64) -> Film {
    let mut numbers = Numbers(seed << 32);
    film(image, samples, |x, y, _| {
        let scale = libm::exp2f(40.0 * numbers.next() - 20.0);
        let rgb = [0; 3].map(|_| scale * numbers.next());
        let alpha = numbers.next();
        let mut aovs = wall(x, y, [0; 3].map(|_| numbers.next())).unwrap();
        aovs.ns = [0; 3].map(|_| numbers.next() - 0.5);
        aovs.position[2] += libm::exp2f(20.0 * numbers.next() - 18.0);
        (rgb, alpha, (numbers.next() < 0.7).then_some(aovs))
    })
}

#[test]
fn the_filter_is_its_slow_twin_bit_for_bit() {
    for (seed, (width, height), background) in [
        (1, (70, 19), Background::Environment),
        (2, (9, 35), Background::Transparent),
        (3, (1, 1), Background::Environment),
    ] {
        let image = ImageSettings { background, ..image(width, height) };
        let film = random(&image, 3, seed);
        let picture = film.picture();
        let clean = denoised(&film, &picture);
        if picture.alpha.is_empty() {
            check_against_twin(&whole_planes::<3>(&film, &picture), &picture, &clean);
        } else {
            check_against_twin(&whole_planes::<4>(&film, &picture), &picture, &clean);
        }
    }
}

/// The planes of all rows.
fn whole_planes<const N: usize>(film: &Film, picture: &Picture) -> Planes<N> {
    let area = film.area();
    Planes::new(film, picture, 0..(area.y1 - area.y0) as usize, planes::alpha_divisor(film))
}

#[test]
fn bands_are_the_whole_bit_for_bit() {
    const ROWS: usize = filter::ROWS;
    let crop = Some(PixelBounds { x0: 5, y0: 7, x1: 60, y1: 90 });
    for (seed, samples, crop, background) in [
        (1, 3, None, Background::Environment),
        (2, 2, crop, Background::Transparent),
        // Variances are estimated from the pixels around.
        (3, 1, crop, Background::Environment),
    ] {
        let film = random(&ImageSettings { background, crop, ..image(70, 101) }, samples, seed);
        let bits = |rows: usize| {
            let mut picture = film.picture();
            denoise_in_bands(&film, &mut picture, rows);
            let bits: Vec<u32> =
                picture.pixels.iter().flatten().chain(&picture.alpha).map(|x| x.to_bits()).collect();
            bits
        };
        let whole = bits(8 * ROWS);
        assert_ne!(whole, film.picture().pixels.iter().flatten().map(|x| x.to_bits()).collect::<Vec<_>>());
        for rows in [ROWS, 2 * ROWS, 3 * ROWS] {
            assert!(bits(rows) == whole, "bands of {rows} rows, {samples} samples");
        }
    }
}

fn check_against_twin<const N: usize>(planes: &Planes<N>, noisy: &Picture, clean: &Picture) {
    let width = noisy.width as usize;
    for index in 0..noisy.pixels.len() {
        let change = planes.change(index, change(planes, index % width, index / width));
        let expected: [f32; 3] = std::array::from_fn(|c| noisy.pixels[index][c] + change[c]);
        assert_eq!(clean.pixels[index], expected, "pixel {index}");
        if N == 4 {
            assert_eq!(clean.alpha[index], noisy.alpha[index] + change[N - 1]);
        }
    }
}

#[test]
fn a_constant_picture_stays_exactly_what_it_is() {
    for samples in [1, 2, 8] {
        let film = film(&image(40, 30), samples, |x, y, _| ([0.1, 0.7, 3.3], 1.0, wall(x, y, [0.3; 3])));
        let picture = film.picture();
        assert_eq!(denoised(&film, &picture), picture);
    }
}

#[test]
fn noise_on_a_wall_falls_by_a_factor_and_its_mean_stays() {
    let mut numbers = Numbers(5);
    let film = film(&image(96, 80), 8, |x, y, _| ([2.0 * numbers.next(); 3], 1.0, wall(x, y, [0.5; 3])));
    let picture = film.picture();
    let clean = denoised(&film, &picture);
    let [before, after] = [error(&picture, |_, _| 1.0), error(&clean, |_, _| 1.0)];
    assert!(after < before / 20.0, "{before} → {after}");
    let [is, was] = [means(&clean)[1], means(&picture)[1]];
    assert!((is / was - 1.0).abs() < 0.001, "{was} → {is}");
}

#[test]
fn textures_and_edges_stay_and_lose_their_noise() {
    // A checkerboard of single pixels, and a shadow's edge that no feature shows.
    let albedo = |x: u32, y: u32| if (x + y).is_multiple_of(2) { 0.8 } else { 0.2 };
    let lit = |x: u32| if x < 40 { 1.0 } else { 0.25 };
    let truth = |x: usize, y: usize| albedo(x as u32, y as u32) * lit(x as u32);
    let mut numbers = Numbers(6);
    let film = film(&image(80, 64), 8, |x, y, _| {
        let light = albedo(x, y) * lit(x) * 2.0 * numbers.next();
        ([light; 3], 1.0, wall(x, y, [albedo(x, y); 3]))
    });
    let picture = film.picture();
    let clean = denoised(&film, &picture);
    let [before, after] = [error(&picture, truth), error(&clean, truth)];
    assert!(after < before / 8.0, "{before} → {after}");
    // Contrast of the squares, and of the edge.
    let at = |x: usize, y: usize| f64::from(clean.pixels[y * 80 + x][1]);
    let column = |x: usize, even: usize| (0..32).map(|k| at(x, 2 * k + even)).sum::<f64>() / 32.0;
    let contrast = column(20, 0) / column(20, 1);
    assert!((contrast - 4.0).abs() < 0.3, "{contrast}");
    let [bright, dark] = [column(39, 1), column(40, 0)];
    assert!(bright > 0.7 && dark < 0.27, "{bright} {dark}");
}

#[test]
fn a_firefly_is_spread_and_its_light_not_doubled() {
    let mut numbers = Numbers(7);
    let film = film(&image(41, 41), 8, |x, y, sample| {
        let light = if (x, y, sample) == (20, 20, 3) { 400.0 } else { 0.8 + 0.4 * numbers.next() };
        ([light; 3], 1.0, wall(x, y, [0.5; 3]))
    });
    let picture = film.picture();
    let clean = denoised(&film, &picture);
    assert!(picture.pixels[20 * 41 + 20][1] > 50.0);
    let brightest = clean.pixels.iter().fold(0.0, |most: f32, pixel| most.max(pixel[1]));
    assert!(brightest < 5.0, "{brightest}");
    assert!(means(&clean)[1] <= means(&picture)[1] * 1.001 && means(&clean)[1] > 0.99);
}

#[test]
fn the_noise_of_alpha_goes_and_its_edges_stay() {
    let settings = ImageSettings { background: Background::Transparent, ..image(64, 48) };
    let mut numbers = Numbers(8);
    // An object, its noisy shadow, and background.
    let film = film(&settings, 8, |x, y, _| match x {
        0..20 => ([0.5; 3], 1.0, wall(x, y, [0.5; 3])),
        20..50 => ([0.0; 3], numbers.next(), wall(x, 500 + y, [1.0; 3])),
        _ => ([0.0; 3], 0.0, None),
    });
    let picture = film.picture();
    let clean = denoised(&film, &picture);
    let square = |picture: &Picture| {
        let shadow = |(index, alpha): (usize, &f32)| match index % 64 {
            20..50 => f64::from(alpha - 0.5).powi(2),
            _ => 0.0,
        };
        picture.alpha.iter().enumerate().map(shadow).sum::<f64>()
    };
    assert!(square(&clean) < square(&picture) / 10.0, "{} → {}", square(&picture), square(&clean));
    for index in (0..picture.alpha.len()).filter(|index| !(20..50).contains(&(index % 64))) {
        assert_eq!((clean.alpha[index], clean.pixels[index]), (picture.alpha[index], picture.pixels[index]));
    }
}

#[test]
fn pixels_without_samples_and_outside_stay_black() {
    let crop = Some(PixelBounds { x0: 3, y0: 2, x1: 30, y1: 20 });
    let settings = ImageSettings { crop, ..image(33, 23) };
    let mut film = random(
        &ImageSettings { crop: Some(PixelBounds { x0: 3, y0: 2, x1: 20, y1: 11 }), ..image(33, 23) },
        2,
        9,
    );
    let rest = Film::for_image(&settings).unwrap();
    let mut whole = rest.clone();
    whole.merge(&film).unwrap();
    film = whole;
    let clean = denoised(&film, &film.picture());
    for (index, pixel) in clean.pixels.iter().enumerate() {
        let is_sampled = film.samples(index as u32 % 33, index as u32 / 33) > 0;
        assert!(is_sampled || *pixel == [0.0; 3], "{index}: {pixel:?}");
    }
    let empty = denoised(&rest, &rest.picture());
    assert!(empty.pixels.iter().all(|pixel| *pixel == [0.0; 3]));
}

#[test]
fn without_features_light_alone_tells() {
    let mut numbers = Numbers(10);
    let mut film = Film::new(64, 48, None).unwrap();
    for (x, y, sample) in (0..64).flat_map(|x| (0..48).flat_map(move |y| (0..8).map(move |s| (x, y, s)))) {
        film.add(x, y, sample, [2.0 * numbers.next(); 3]);
    }
    let picture = film.picture();
    let [before, after] = [error(&picture, |_, _| 1.0), error(&denoised(&film, &picture), |_, _| 1.0)];
    assert!(after < before / 20.0, "{before} → {after}");
}

proptest! {
    #[test]
    fn nothing_becomes_nan(
        (width, height, samples, seed) in (1u32..20, 1u32..20, 0u32..4, 0u64..1 << 20),
        transparent in any::<bool>(),
    ) {
        let background = if transparent { Background::Transparent } else { Background::Environment };
        let film = random(&ImageSettings { background, ..image(width, height) }, samples, seed);
        let picture = film.picture();
        let clean = denoised(&film, &picture);
        prop_assert!(clean.pixels.iter().flatten().chain(&clean.alpha).all(|value| value.is_finite()));
        prop_assert_eq!(clean.alpha.len(), picture.alpha.len());
    }
}
