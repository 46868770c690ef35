//! LDR-ꟻLIP: the difference of two images as perceived by an observer who alternates between them.
//!
//! Colours are blurred by the contrast sensitivity of the eye at the distance of the screen, and compared in a perceptually
//! uniform space; edges and points are detected in both images, and the colour difference is amplified where these
//! features differ. 0 is equal, 1 is the maximum difference.
//!
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström & Fairchild 2020, "FLIP: A Difference Evaluator for Alternating
//! Images"; the contrast sensitivities are those of Johnson & Fairchild 2003, the distance is HyAB (Abasi et al. 2020),
//! chroma is reduced in the dark by the Hunt effect.

use std::ops::Range;

use crate::parallel;

/// Pixels per degree of visual angle: a screen of 3840 pixels over 0.7 m, seen from 0.7 m.
pub const PIXELS_PER_DEGREE: f64 = 0.7 * 3840.0 / 0.7 * std::f64::consts::PI / 180.0;

/// Exponents of the colour difference and of the feature difference.
const COLOR_EXPONENT: f64 = 0.7;
const FEATURE_EXPONENT: f64 = 0.5;

/// Colour differences up to this fraction of the maximum are mapped to [0, `NEAR_ERROR`].
const NEAR: f64 = 0.4;
const NEAR_ERROR: f64 = 0.95;

/// The width of an edge in degrees.
const EDGE_WIDTH: f64 = 0.082;

/// Contrast sensitivity functions for luminance, red–green and blue–yellow: sums of a·√(π/b)·exp(−π²x²/b), x in degrees.
const SENSITIVITIES: [[(f64, f64); 2]; 3] =
    [[(1.0, 0.0047), (0.0, 1e-5)], [(1.0, 0.0053), (0.0, 1e-5)], [(34.1, 0.04), (13.5, 0.025)]];

/// The largest `b` of [`SENSITIVITIES`], which determines the filter's radius.
const WIDEST: f64 = 0.04;

type Color = [f64; 3];

/// Columns and rows of a tile, at least: the pixels around it are computed as well, for neither tile alone.
const TILE: usize = 256;

/// The error of each pixel, in [0, 1], between two images of `width` columns of linear colours, which are multiplied by
/// `scale` and clamped to [0, 1]. At a border the last pixels are repeated. The images are compared in tiles, in parallel: a
/// pixel takes 200 bytes.
///
/// # Panics
/// If the images are not whole rows or differ in size.
pub fn flip(images: [&[[f32; 3]]; 2], width: usize, scale: f32, pixels_per_degree: f64) -> Vec<f32> {
    let [picture, reference] = images;
    assert!(width > 0 && picture.len() == reference.len() && picture.len().is_multiple_of(width));
    let height = picture.len() / width;
    let margin = filter_radius(pixels_per_degree).max(edge_radius(pixels_per_degree)).unsigned_abs() as usize;
    let side = TILE.max(margin.saturating_mul(2));
    let tile = |from: usize, most: usize| from..from.saturating_add(side).min(most);
    let around = |tile: &Range<usize>, most: usize| {
        tile.start.saturating_sub(margin)..tile.end.saturating_add(margin).min(most)
    };
    let of_row = |y: usize| (0..width).step_by(side).map(move |x| (tile(x, width), tile(y, height)));
    let tiles = parallel::map((0..height).step_by(side).flat_map(of_row).collect(), |(columns, rows)| {
        let (wider, higher) = (around(&columns, width), around(&rows, height));
        let parts = images.map(|image| {
            let row = |y: usize| &image[y * width..][wider.clone()];
            higher.clone().flat_map(row).copied().collect::<Vec<_>>()
        });
        let errors = flip_whole([&parts[0], &parts[1]], wider.len(), scale, pixels_per_degree);
        let first = (rows.start - higher.start) * wider.len() + columns.start - wider.start;
        let inner = errors[first..].chunks(wider.len()).take(rows.len()).map(|row| &row[..columns.len()]);
        let inner: Vec<f32> = inner.flatten().copied().collect();
        (columns, rows, inner)
    });
    let mut all = vec![0.0; picture.len()];
    for (columns, rows, errors) in tiles {
        for (y, errors) in rows.zip(errors.chunks(columns.len())) {
            all[y * width..][columns.clone()].copy_from_slice(errors);
        }
    }
    all
}

/// The perceived differences of images that are compared as a whole.
fn flip_whole(images: [&[[f32; 3]]; 2], width: usize, scale: f32, pixels_per_degree: f64) -> Vec<f32> {
    let opponents = images.map(|rgb| {
        let color = |rgb: &[f32; 3]| opponent(rgb.map(|c| f64::from(c * scale).clamp(0.0, 1.0)));
        rgb.iter().map(color).collect::<Vec<Color>>()
    });

    // The colour difference after spatial filtering.
    let [a, b] = opponents.each_ref().map(|colors| perceived(colors, width, pixels_per_degree));
    let most = difference(perceive([0.0, 1.0, 0.0]), perceive([0.0, 0.0, 1.0]));

    // Edge and point features of the luminance.
    let [features_a, features_b] = opponents.each_ref().map(|colors| {
        let light: Vec<f64> = colors.iter().map(|color| (color[0] + 16.0) / 116.0).collect();
        features(&light, width, pixels_per_degree)
    });

    let of_pixel = |i: usize| {
        let color = spread(difference(a[i], b[i]), most);
        let [edge, point] = [0, 1].map(|kind| (features_a[i][kind] - features_b[i][kind]).abs());
        let feature = libm::pow(edge.max(point) * std::f64::consts::FRAC_1_SQRT_2, FEATURE_EXPONENT);
        libm::pow(color, 1.0 - feature.min(1.0)) as f32
    };
    (0..a.len()).map(of_pixel).collect()
}

/// Maps a colour difference to [0, 1]: small differences take up most of the range.
fn spread(difference: f64, most: f64) -> f64 {
    let near = NEAR * most;
    if difference < near {
        difference * NEAR_ERROR / near
    } else {
        NEAR_ERROR + (difference - near) / (most - near) * (1.0 - NEAR_ERROR)
    }
}

/// HyAB distance between two colours of [`perceive`], to the power of `COLOR_EXPONENT`.
fn difference(a: Color, b: Color) -> f64 {
    let [l, x, y] = [0, 1, 2].map(|i| a[i] - b[i]);
    libm::pow(l.abs() + (x * x + y * y).sqrt(), COLOR_EXPONENT)
}

/// L*a*b* of a linear colour, with a* and b* scaled down in the dark (Hunt effect).
fn perceive(rgb: Color) -> Color {
    let bend = |t: f64| {
        let delta = 6.0 / 29.0;
        if t > delta * delta * delta { libm::cbrt(t) } else { t / (3.0 * delta * delta) + 4.0 / 29.0 }
    };
    let [x, y, z] = relative_xyz(rgb).map(bend);
    let light = 116.0 * y - 16.0;
    [light, 5.0 * (x - y) * light, 2.0 * (y - z) * light]
}

/// The matrix from linear Rec. 709 to X, Y, Z.
const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [0.412_390_799_265_959_5, 0.357_584_339_383_878, 0.180_480_788_401_834_3],
    [0.212_639_005_871_510_36, 0.715_168_678_767_756, 0.072_192_315_360_733_71],
    [0.019_330_818_715_591_85, 0.119_194_779_794_625_99, 0.950_532_152_249_661],
];

/// Its inverse.
const RGB_FROM_XYZ: [[f64; 3]; 3] = [
    [3.240_969_941_904_522_6, -1.537_383_177_570_094, -0.498_610_760_293_003_4],
    [-0.969_243_636_280_879_6, 1.875_967_501_507_720_2, 0.041_555_057_407_175_59],
    [0.055_630_079_696_993_66, -0.203_976_958_888_976_52, 1.056_971_514_242_878_6],
];

fn multiply(matrix: &[[f64; 3]; 3], v: Color) -> Color {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// X, Y, Z relative to white.
fn relative_xyz(rgb: Color) -> Color {
    let (xyz, white) = (multiply(&XYZ_FROM_RGB, rgb), multiply(&XYZ_FROM_RGB, [1.0; 3]));
    [0, 1, 2].map(|i| xyz[i] / white[i])
}

/// Opponent space Y, Cx, Cz: luminance, red–green and blue–yellow, linear.
fn opponent(rgb: Color) -> Color {
    let [x, y, z] = relative_xyz(rgb);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// The linear colour of Y, Cx, Cz.
fn rgb_from_opponent([y, cx, cz]: Color) -> Color {
    let y = (y + 16.0) / 116.0;
    let relative = [y + cx / 500.0, y, y - cz / 200.0];
    let white = multiply(&XYZ_FROM_RGB, [1.0; 3]);
    multiply(&RGB_FROM_XYZ, [0, 1, 2].map(|i| relative[i] * white[i]))
}

/// Radius in pixels of the filters by the contrast sensitivity functions.
fn filter_radius(pixels_per_degree: f64) -> i32 {
    let deviations = (WIDEST / (2.0 * std::f64::consts::PI * std::f64::consts::PI)).sqrt();
    (3.0 * deviations * pixels_per_degree).ceil() as i32
}

/// Standard deviation in pixels of the filters for edges and points, and their radius.
fn edge_deviation(pixels_per_degree: f64) -> f64 {
    0.5 * EDGE_WIDTH * pixels_per_degree
}

fn edge_radius(pixels_per_degree: f64) -> i32 {
    (3.0 * edge_deviation(pixels_per_degree)).ceil() as i32
}

/// The colours after filtering with the contrast sensitivity functions, for [`difference`].
fn perceived(colors: &[Color], width: usize, pixels_per_degree: f64) -> Vec<Color> {
    let radius = filter_radius(pixels_per_degree);
    let channels: [Vec<f64>; 3] = std::array::from_fn(|channel| {
        let values: Vec<f64> = colors.iter().map(|color| color[channel]).collect();
        // A sum of Gaussians: each is separable into a blur along rows and one along columns.
        let mut total = 0.0;
        let mut blurred = vec![0.0; values.len()];
        for (a, b) in SENSITIVITIES[channel] {
            if a == 0.0 {
                continue;
            }
            let pi = std::f64::consts::PI;
            let weight = |x: i32| {
                let degrees = f64::from(x) / pixels_per_degree;
                libm::exp(-pi * pi * degrees * degrees / b)
            };
            let line: Vec<f64> = (-radius..=radius).map(weight).collect();
            let sum: f64 = line.iter().sum();
            let scale = a * (pi / b).sqrt();
            total += scale * sum * sum;
            let once = along_columns(&along_rows(&values, width, &line), width, &line);
            blurred.iter_mut().zip(once).for_each(|(sum, value)| *sum += scale * value);
        }
        blurred.iter_mut().for_each(|value| *value /= total);
        blurred
    });
    (0..colors.len())
        .map(|i| {
            let rgb = rgb_from_opponent([channels[0][i], channels[1][i], channels[2][i]]);
            perceive(rgb.map(|c| c.clamp(0.0, 1.0)))
        })
        .collect()
}

/// Edge and point feature strengths at each pixel.
fn features(light: &[f64], width: usize, pixels_per_degree: f64) -> Vec<[f64; 2]> {
    // A Gaussian as wide as an edge and its first two derivatives; positive and negative weights are each normalised.
    let (deviation, radius) = (edge_deviation(pixels_per_degree), edge_radius(pixels_per_degree));
    let gauss = |x: i32| libm::exp(-f64::from(x * x) / (2.0 * deviation * deviation));
    let bell: Vec<f64> = (-radius..=radius).map(gauss).collect();
    let bell_sum: f64 = bell.iter().sum();
    let bell: Vec<f64> = bell.into_iter().map(|weight| weight / bell_sum).collect();
    let line = |shape: &dyn Fn(f64) -> f64| {
        let weights: Vec<f64> = (-radius..=radius).map(|x| shape(f64::from(x)) * gauss(x)).collect();
        let above: f64 = weights.iter().filter(|weight| **weight > 0.0).sum();
        let below: f64 = -weights.iter().filter(|weight| **weight < 0.0).sum::<f64>();
        weights.into_iter().map(|w| if w > 0.0 { w / above } else { w / below }).collect::<Vec<f64>>()
    };
    let kinds = [line(&|x| -x), line(&|x| x * x / (deviation * deviation) - 1.0)];
    let [edges, points] = kinds.map(|line| {
        let across = along_columns(&along_rows(light, width, &line), width, &bell);
        let down = along_columns(&along_rows(light, width, &bell), width, &line);
        across.iter().zip(down).map(|(x, y)| (x * x + y * y).sqrt()).collect::<Vec<f64>>()
    });
    edges.into_iter().zip(points).map(|(edge, point)| [edge, point]).collect()
}

/// Convolution along rows.
fn along_rows(values: &[f64], width: usize, line: &[f64]) -> Vec<f64> {
    let radius = line.len() / 2;
    let mut sums = vec![0.0; values.len()];
    let mut longer = vec![0.0; width + 2 * radius];
    for (sums, row) in sums.chunks_exact_mut(width).zip(values.chunks_exact(width)) {
        longer[..radius].fill(row[0]);
        longer[radius..radius + width].copy_from_slice(row);
        longer[radius + width..].fill(row[width - 1]);
        for (&weight, shifted) in line.iter().zip(longer.windows(width)) {
            add(sums, weight, shifted);
        }
    }
    sums
}

/// Convolution along columns.
fn along_columns(values: &[f64], width: usize, line: &[f64]) -> Vec<f64> {
    let (radius, height) = (line.len() / 2, values.len() / width);
    let mut sums = vec![0.0; values.len()];
    for (y, sums) in sums.chunks_exact_mut(width).enumerate() {
        for (k, &weight) in line.iter().enumerate() {
            let row = (y + k).saturating_sub(radius).min(height - 1);
            add(sums, weight, &values[row * width..][..width]);
        }
    }
    sums
}

/// Adds `weight` times the values.
fn add(sums: &mut [f64], weight: f64, values: &[f64]) {
    sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
}

#[cfg(test)]
mod tests {
    use super::super::linear_from_srgb;
    use super::*;

    const WIDTH: usize = 24;
    const HEIGHT: usize = 16;

    /// A generated pattern for which the authors' own program (flip-evaluator 1.7) gave the results below.
    fn pattern(seed: usize) -> Vec<[f32; 3]> {
        let value = |x: usize, y: usize, c: usize| {
            let number = (x * 7 + y * 13 + c * 29 + seed * ((x * 5 + y * 3 + c) % 11)) % 64;
            linear_from_srgb(number as f32 / 63.0)
        };
        (0..WIDTH * HEIGHT).map(|i| [0, 1, 2].map(|c| value(i % WIDTH, i / WIDTH, c))).collect()
    }

    fn mean(map: &[f32]) -> f32 {
        map.iter().sum::<f32>() / map.len() as f32
    }

    fn of(picture: &[[f32; 3]], reference: &[[f32; 3]]) -> Vec<f32> {
        flip([picture, reference], WIDTH, 1.0, PIXELS_PER_DEGREE)
    }

    fn flat(encoded: [f32; 3]) -> Vec<[f32; 3]> {
        vec![encoded.map(linear_from_srgb); WIDTH * HEIGHT]
    }

    #[test]
    fn what_the_authors_program_says_of_a_pattern() {
        let (a, b) = (pattern(0), pattern(1));
        let map = of(&b, &a);
        assert!((mean(&map) - 0.351_717_56).abs() < 2e-4, "{}", mean(&map));
        assert!((map[0] - 0.299_412_9).abs() < 1e-3 && (map[7 * WIDTH + 9] - 0.385_014_6).abs() < 1e-3);
        let (least, most) = map.iter().fold((1.0_f32, 0.0_f32), |(a, b), &x| (a.min(x), b.max(x)));
        assert!((least - 0.085_741_59).abs() < 1e-3 && (most - 0.969_730_14).abs() < 1e-3, "{least} {most}");
        assert_eq!(of(&b, &a), of(&a, &b), "whichever is the reference");
        assert!(of(&a, &a).iter().all(|&error| error == 0.0));
    }

    #[test]
    fn tiles_are_those_of_the_whole() {
        let value = |i: u32, seed: u32| {
            (i.wrapping_mul(2_654_435_761).wrapping_add(seed) >> 8) as f32 / (1 << 23) as f32
        };
        for [width, height] in [[3, 1], [3, 256], [3, 257], [700, 3], [511, 260], [256, 512]] {
            let noise = |seed| {
                let color = |pixel: u32| [0, 1, 2].map(|c| value(3 * pixel + c, seed));
                (0..width * height).map(color).collect::<Vec<[f32; 3]>>()
            };
            let (a, b) = (noise(1), noise(1 << 29));
            let whole = flip_whole([&a, &b], width as usize, 0.5, PIXELS_PER_DEGREE);
            assert!(whole.iter().any(|&error| error > 0.1));
            assert_eq!(flip([&a, &b], width as usize, 0.5, PIXELS_PER_DEGREE), whole, "{width} × {height}");
        }
    }

    #[test]
    fn what_the_authors_program_says_of_plain_pictures() {
        for (a, b, error) in [
            ([0.0; 3], [1.0; 3], 0.967_386_5),
            ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0], 1.0),
            ([0.5; 3], [0.6; 3], 0.285_063),
        ] {
            for found in of(&flat(a), &flat(b)) {
                assert!((found - error).abs() < 2e-4, "{a:?} {b:?}: {found} {error}");
            }
        }
    }

    #[test]
    fn what_the_authors_program_says_of_a_dot() {
        let gray = flat([0.5; 3]);
        let mut dotted = gray.clone();
        dotted[8 * WIDTH + 12] = [1.0; 3];
        let map = of(&dotted, &gray);
        assert!((mean(&map) - 0.011_255_37).abs() < 1e-4, "{}", mean(&map));
        assert!((map[7 * WIDTH + 9] - 0.022_949_25).abs() < 1e-3);
        assert!((map.iter().fold(0.0_f32, |a, &b| a.max(b)) - 0.380_197_73).abs() < 1e-3);
        assert!(map[0] < 1e-6);
    }

    #[test]
    fn what_is_beyond_the_screen_is_cut() {
        assert!(of(&flat([1.0; 3]), &vec![[7.0; 3]; WIDTH * HEIGHT]).iter().all(|&error| error < 1e-6));
    }
}
