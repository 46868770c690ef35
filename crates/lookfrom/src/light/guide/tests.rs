//! Guides of places whose visibility is known.

use std::f32::consts::PI;
use std::sync::Arc;

use glam::{Mat3, Vec3, Vec3Swizzles};
use lookfrom_scene::image::Image;
use lookfrom_scene::material::Color;
use lookfrom_scene::settings::ColorMode;

use super::gain::{Lit, Moments, gain};
use super::*;
use crate::core::distribution::Piecewise2D;
use crate::core::hash;
use crate::core::statistics::chi_square_deviate;
use crate::core::warp;
use crate::light::{EmissionSpectrum, Environment, MapLayout, Sky, SkyImage};
use crate::shading::texture::{SpectrumType, Textures};

fn number(k: u64, salt: u64) -> f32 {
    (hash::pair(k, salt) >> 40) as f32 / 16_777_216.0
}

fn textures() -> Textures {
    Textures::new(&[], Vec::new(), Vec::new(), ColorMode::Rgb)
}

/// A sky of one colour.
fn even_sky(textures: &Textures) -> Environment {
    let color = textures.spectrum_texture(Color::gray(1.0), SpectrumType::Illuminant);
    let sky = Sky::Constant(EmissionSpectrum { color, scale: 1.0 });
    Environment { sky, portal: None, illuminates: true, guide: None }
}

/// Points on a floor of 4 × 4 at y = 0.
fn floor() -> Vec<GuidePoint> {
    let at = |k| Vec3::new(4.0 * number(k, 1) - 2.0, 0.0, 4.0 * number(k, 2) - 2.0);
    let point = |k| GuidePoint { point: at(k), n: Vec3::Y, facing: Vec3::Y, transmits: false };
    (0..4000).map(point).collect()
}

/// Whether a ray leaves through a window of 1 × 1 in the wall at x = 3, from y = 1 on.
fn is_lit(point: Vec3, wi: Vec3) -> bool {
    let at = point + wi * ((3.0 - point.x) / wi.x);
    wi.x > 0.0 && (1.0..2.0).contains(&at.y) && (-0.5..0.5).contains(&at.z)
}

fn learn(points: &[GuidePoint], is_lit: impl Fn(Vec3, Vec3) -> bool) -> Option<Guide> {
    let textures = textures();
    learn_of(&even_sky(&textures), &textures, points, is_lit)
}

fn learn_of(
    environment: &Environment,
    textures: &Textures,
    points: &[GuidePoint],
    is_lit: impl Fn(Vec3, Vec3) -> bool,
) -> Option<Guide> {
    let visibility = |queries: &[Query]| {
        let lit = |(index, wi): &Query| is_lit(points[*index as usize].point, *wi);
        queries.iter().map(|query| f32::from(u8::from(lit(query)))).collect()
    };
    Guide::learn(environment, textures, points, &visibility, 3.0)
}

#[test]
fn most_directions_lead_through_the_window() {
    expect_light_through_the_window(&learn(&floor(), is_lit).expect("a window"));
}

#[test]
fn points_in_a_plane_are_parted_where_a_few_others_are_far_from_it() {
    let mut points = floor();
    for (k, point) in (0..).zip(&mut points).step_by(20) {
        point.point.y = 0.01 * k as f32;
    }
    expect_light_through_the_window(&learn(&points, is_lit).expect("a window"));
}

fn expect_light_through_the_window(guide: &Guide) {
    let (mut lit, mut unguided) = (0_u64, 0_u64);
    // The mean of the light, which is the part of the cosine's directions that are lit, and the second moment of one sample.
    let (mut mean, mut square) = (0.0, 0.0);
    const N: u64 = 20_000;
    for k in 0..N {
        let p = Vec3::new(4.0 * number(k, 3) - 2.0, 0.0, 4.0 * number(k, 4) - 2.0);
        let u = [number(k, 5), number(k, 6)];
        let histogram = guide.histogram(p, Vec3::Y).expect("light everywhere");
        let wi = histogram.sample(u);
        if is_lit(p, wi) {
            let value = f64::from(wi.y / (PI * histogram.pdf(wi)));
            (lit, mean, square) = (lit + 1, mean + value / N as f64, square + value * value / N as f64);
        }
        unguided += u64::from(is_lit(p, warp::cosine_hemisphere(u, Vec3::Y)));
    }
    assert!(unguided < 600, "{unguided}");
    assert!(lit > 25 * unguided && lit > N / 3, "{lit}, {unguided} without a guide");
    let expected = unguided as f64 / N as f64;
    assert!((mean / expected - 1.0).abs() < 0.2, "{mean} {expected}");
    let gain = (expected - mean * mean) / (square - mean * mean);
    assert!(gain > 20.0, "the variance of a sample by the cosine over that by the guide: {gain}");
    assert!(guide.histogram(Vec3::ZERO, -Vec3::Y).is_none(), "no point has such a normal");
}

#[test]
fn guides_are_learned_where_they_help() {
    assert!(learn(&floor(), |_, _| true).is_none(), "an open place");
    assert!(learn(&floor(), |_, _| false).is_none(), "a closed room");
    assert!(learn(&[], is_lit).is_none());
    let half_open = |p: Vec3, wi: Vec3| if p.x < 0.0 { true } else { is_lit(p, wi) };
    assert!(learn(&floor(), half_open).is_none(), "what is open lights the rest");
}

/// A window that lights all points with 1/50 of the sky, and some points with the sun, as samples without a guide find them.
#[test]
fn gains_are_small_where_the_sun_shines_in() {
    let (sky, count) = (PI, 1000);
    let of = |in_the_sun: usize, brightness: f32| {
        let window = Lit::with(count - in_the_sun, 1.0, sky / 50.0, sky, Moments::of([].into_iter(), 1));
        let sun = Lit::without(in_the_sun, Moments::of([brightness].into_iter(), 1));
        gain(&[window, sun], count)
    };
    // All that reaches a point, and all that reaches others, has 1/50 of the mean square.
    assert!((of(0, 0.0) / 50.0 - 1.0).abs() < 1e-5, "{}", of(0, 0.0));
    let gains = [0.0, 1.0, 3.0, 10.0, 100.0].map(|brightness| of(10, brightness * sky));
    assert!(gains.is_sorted_by(|brighter, darker| brighter > darker), "{gains:?}");
    assert!(gains[1] > 5.0 && gains[4] < 1.2, "{gains:?}");
}

/// Where a spot of the sun is on the floor, most samples are left to the map, which finds the sun: by the light of both.
#[test]
fn a_guide_leaves_the_sun_to_the_map() {
    let (width, height) = (64, 64);
    let sun = (48, 20);
    let texels = |sun_too: bool| -> Vec<[f32; 3]> {
        let is_sun = |index: usize| sun_too && (index % width, index / width) == sun;
        (0..width * height).map(|index| [if is_sun(index) { 2e4 } else { 1.0 }; 3]).collect()
    };
    let share = |sun_too: bool, in_the_sun: f32| {
        let texels = texels(sun_too);
        let weights: Vec<f32> = texels.iter().map(|texel| texel[0]).collect();
        let image = Image::from_linear("", width as u32, height as u32, texels);
        let textures = Textures::new(&[], vec![image], Vec::new(), ColorMode::Rgb);
        let choice = Arc::new(Piecewise2D::new(&weights, width, height));
        let sky = SkyImage {
            image: 0,
            scale: [1.0; 3],
            layout: MapLayout::Octahedral,
            world_from_light: Mat3::IDENTITY,
            complete: choice.clone(),
            compensated: choice,
            picture_v: [1.0, 0.0],
            mean: 1.0,
            sums: [1.0; 2],
        };
        let to_sun = Vec3::from(sky.direction([sun.0, sun.1].map(|i| (i as f32 + 0.5) / 64.0)).0);
        let environment =
            Environment { sky: Sky::Image(Box::new(sky)), portal: None, illuminates: true, guide: None };
        let points: Vec<GuidePoint> = floor()
            .into_iter()
            .map(|point| GuidePoint { n: Vec3::Z, facing: Vec3::Z, point: point.point.xzy(), ..point })
            .collect();
        // A window near the horizon, and the sun through a hole.
        let is_lit = |p: Vec3, wi: Vec3| {
            let is_in_spot = p.length() < in_the_sun && wi.dot(to_sun) > 0.99;
            is_in_spot || wi.x > 0.9
        };
        let guide = learn_of(&environment, &textures, &points, is_lit).expect("a window");
        guide.histogram(Vec3::ZERO, Vec3::Z).map(|histogram| histogram.share)
    };
    let [even, dark, lit] = [share(false, 0.15), share(true, 0.0), share(true, 0.15)];
    assert_eq!([even, dark], [Some(0.75); 2]);
    assert!(lit.is_none_or(|share| share < 0.3), "{lit:?}");
}

#[test]
fn densities_are_those_of_samples() {
    let guide = learn(&floor(), is_lit).expect("a window");
    let histogram = guide.histogram(Vec3::new(1.0, 0.0, 0.3), Vec3::Y).expect("light");
    // The integral over solid angle in cells of a fine grid, which do not cross those of the guide.
    const FINE: usize = SIDE * 4;
    let mut expected = vec![0.0; SIDE * SIDE];
    for index in 0..FINE * FINE {
        let place = [index % FINE, index / FINE].map(|i| (i as f32 + 0.5) / FINE as f32 * 2.0 - 1.0);
        let direction = Direction::of_square(place);
        let area = 4.0 / (FINE * FINE) as f64;
        let density = f64::from(histogram.pdf(direction.unit()));
        let cell = index / FINE / 4 * SIDE + index % FINE / 4;
        expected[cell] += density * area / f64::from(direction.length()).powi(3);
    }
    let sum: f64 = expected.iter().sum();
    assert!((sum - 1.0).abs() < 1e-4, "{sum}");
    const N: u64 = 200_000;
    let mut counts = vec![0; SIDE * SIDE];
    for k in 0..N {
        let wi = histogram.sample([number(k, 7), number(k, 8)]);
        assert!((wi.length() - 1.0).abs() < 1e-6);
        let square = Direction::of_unit(wi).square();
        let [column, row] = square.map(|x| (((x + 1.0) * 0.5 * SIDE as f32) as usize).min(SIDE - 1));
        counts[row * SIDE + column] += 1;
    }
    let (counts, expected): (Vec<u64>, Vec<f64>) = counts
        .into_iter()
        .zip(expected)
        .map(|(n, share)| (n, share * N as f64))
        .filter(|(_, e)| *e > 20.0)
        .unzip();
    assert!(counts.len() > 20);
    let deviate = chi_square_deviate(&counts, &expected);
    assert!(deviate < 4.5, "{deviate}");
}

#[test]
fn normals_have_classes() {
    for (n, class) in [
        (Vec3::X, 0),
        (-Vec3::X, 1),
        (Vec3::new(0.1, 0.9, -0.3), 2),
        (Vec3::new(0.1, -0.9, -0.3), 3),
        (Vec3::new(-0.5, 0.5, 0.6), 4),
        (-Vec3::Z, 5),
        (Vec3::ZERO, 6),
    ] {
        assert_eq!(class_of(n), class, "{n}");
    }
}
