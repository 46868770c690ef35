//! Comparison of two images: error metrics, and z-tests against their measured variance.
//!
//! Means and errors; and if both images have variances (channels `Variance.R G B`: of *one* sample, as pbrt's `gbuffer`
//! film and ours write them), a z-test of each pixel and of each block of pixels: the difference relative to the standard
//! error that both images' noise gives it. The perceived difference is left to [`super::flip`].
//!
//! Variances are those of the sensor's channels: of X, Y and Z, or of a camera's own red, green and blue. They cannot be
//! converted without their covariances, so the colours are converted instead. Our files name the channels
//! (`variance.from_rgb`), pbrt's do not: they are assumed to be those of the other image.

use std::ops::Range;

use super::openexr::Channels;
use crate::error::{Error, Location, Result};
use crate::parallel;
use crate::spectrum::space::{Matrix, XYZ_FROM_RGB, apply};

/// Maximum difference of a pixel in standard errors; larger ones are not explained by noise.
pub const MOST_STANDARD_ERRORS: f64 = 3.5;

/// Side of a block in pixels.
pub const BLOCK: usize = 16;

/// Allowed difference besides noise, relative to the reference: for rounding, and without any variance for light that a
/// film does not include in it (pbrt's ignores samples that hit nothing).
const ROUNDING: f64 = 1e-3;
const WITHOUT_VARIANCE: f64 = 1e-2;

/// Added to the square of the reference in [`Comparison::relative_mse`], so that black is not a division by 0.
const DARK: f64 = 1e-2;

/// The attribute of an EXR that defines the channels of its variances: the matrix from linear Rec. 709 to them, nine
/// numbers in row-major order.
pub const CHANNELS_ATTRIBUTE: &str = "variance.from_rgb";

/// The text of [`CHANNELS_ATTRIBUTE`] for a matrix.
pub fn channels_text(channels_from_rgb: &Matrix) -> String {
    channels_from_rgb.as_flattened().iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}

/// The matrix of such a text; `None` unless it is nine finite numbers.
fn matrix(text: &str) -> Option<Matrix> {
    let numbers: Option<Vec<f64>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
    let &[a, b, c, d, e, f, g, h, i] = numbers?.as_slice() else { return None };
    let matrix = [[a, b, c], [d, e, f], [g, h, i]];
    matrix.iter().flatten().all(|number| number.is_finite()).then_some(matrix)
}

/// An image to compare: linear colours, and their variances if known.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampled {
    /// Width in pixels.
    pub width: usize,
    /// Linear Rec. 709, row by row; all finite.
    pub pixels: Vec<[f32; 3]>,
    /// The number of values that were not finite; they are 0 in `pixels`.
    pub not_finite: usize,
    /// The variances of the pixels (not of one sample) in three channels.
    pub variances: Option<Vec<[f64; 3]>>,
    /// The matrix from linear Rec. 709 to the channels of the variances; `None` if it is not known.
    pub channels_from_rgb: Option<Matrix>,
}

/// The result of a comparison of two images. Channels are red, green, blue.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The mean of the image and of the reference, by channel.
    pub means: [[f64; 3]; 2],
    /// The difference of the means relative to the reference's means.
    pub relative: [f64; 3],
    /// Root mean square error.
    pub rmse: f64,
    /// Relative mean squared error: squared differences relative to the reference's square plus 0.01.
    pub relative_mse: f64,
    /// The z-tests, if both images have variances in the same channels.
    pub noise: Option<NoiseTest>,
}

/// The z-tests, in the channels of the variances: X, Y and Z, or those of a camera.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseTest {
    /// Fraction of the pixels that differ by at most [`MOST_STANDARD_ERRORS`] in all three channels.
    pub pixels_within: f64,
    /// Fraction of the means that differ by at most as much, of blocks of [`BLOCK`] × [`BLOCK`] pixels.
    pub blocks_within: f64,
    /// The difference of the images' means in standard errors.
    pub mean: [f64; 3],
    /// Standard error of the difference of the means in the second channel (Y, green), relative to the reference's mean.
    pub relative_error_of_mean: f64,
}

impl Sampled {
    /// The colours and variances of a file. `samples` is the number of samples per pixel; if it is `None`, the file's own is
    /// used (`samples`, or pbrt's `samplesPerPixel`). Without either there are no variances.
    ///
    /// # Errors
    /// `Invalid` if the file has neither the channels R, G, B nor Y.
    pub fn new(file: &Channels, samples: Option<u64>) -> Result<Self> {
        let three = |names: [&str; 3]| {
            let [a, b, c] = names.map(|name| file.channel(name));
            Some(a?.iter().zip(b?).zip(c?).map(|((&a, &b), &c)| [a, b, c]).collect::<Vec<[f32; 3]>>())
        };
        let Some(mut pixels) = three(["R", "G", "B"]).or_else(|| three(["Y"; 3])) else {
            let names: Vec<&str> = file.channels.iter().map(|(name, _)| name.as_str()).collect();
            return Err(Error::invalid(
                &Location::default(),
                format!("has the channels {}; expected R, G and B, or Y", names.join(", ")),
            ));
        };
        let not_finite = make_finite(&mut pixels);
        let attribute =
            |name: &str| Some(file.attributes.iter().find(|(found, _)| found == name)?.1.as_str());
        let number = |name: &str| attribute(name)?.parse().ok();
        let samples = samples.or_else(|| number("samples")).or_else(|| number("samplesPerPixel"));
        let variances =
            three(["Variance.R", "Variance.G", "Variance.B"]).zip(samples).map(|(variances, n)| {
                let of_mean = |variance: f32| f64::from(variance.max(0.0)) / n.max(1) as f64;
                variances.into_iter().map(|one| one.map(of_mean)).collect()
            });
        let channels_from_rgb = attribute(CHANNELS_ATTRIBUTE).and_then(matrix);
        Ok(Self { width: file.width as usize, pixels, not_finite, variances, channels_from_rgb })
    }

    /// An image of `width` columns of linear Rec. 709, without variances.
    pub fn of_colors(width: u32, mut pixels: Vec<[f32; 3]>) -> Self {
        let not_finite = make_finite(&mut pixels);
        Self { width: width as usize, pixels, not_finite, variances: None, channels_from_rgb: None }
    }
}

/// Makes values 0 that are not finite, and counts them.
fn make_finite(pixels: &mut [[f32; 3]]) -> usize {
    let mut count = 0;
    for value in pixels.as_flattened_mut().iter_mut().filter(|value| !value.is_finite()) {
        *value = 0.0;
        count += 1;
    }
    count
}

/// Compares an image with a reference.
///
/// # Errors
/// `Invalid` if they differ in size or have no pixels.
pub fn compare(picture: &Sampled, reference: &Sampled) -> Result<Comparison> {
    let size = |of: &Sampled| (of.width, of.pixels.len() / of.width.max(1));
    if size(picture) != size(reference) || picture.pixels.is_empty() {
        let ((a, b), (c, d)) = (size(picture), size(reference));
        return Err(Error::invalid(
            &Location::default(),
            format!("the picture has {a} × {b} pixels, the reference {c} × {d}"),
        )
        .hint("render at the size of the reference, with the same crop"));
    }
    let sums = parallel::map(bands(picture), |band| {
        Sums::of(&picture.pixels[band.clone()], &reference.pixels[band])
    });
    let Sums { values, squares, relative_squares } = sums.into_iter().fold(Sums::default(), Sums::plus);
    let count = picture.pixels.len() as f64;
    let means = values.map(|values| values.map(|sum| sum / count));
    Ok(Comparison {
        means,
        relative: [0, 1, 2].map(|c| relative(means[0][c] - means[1][c], means[1][c])),
        rmse: (squares / (3.0 * count)).sqrt(),
        relative_mse: relative_squares / (3.0 * count),
        noise: channels_of_both(picture, reference)
            .and_then(|channels| noise_test(picture, reference, &channels)),
    })
}

/// The pixels of each row of blocks.
fn bands(image: &Sampled) -> Vec<Range<usize>> {
    let (size, all) = (BLOCK * image.width, image.pixels.len());
    (0..all).step_by(size).map(|first| first..(first + size).min(all)).collect()
}

/// Sums over the pixels of an image and of its reference.
#[derive(Clone, Copy, Default)]
struct Sums {
    /// Of each channel, of both.
    values: [[f64; 3]; 2],
    /// Of the squares of the differences.
    squares: f64,
    /// Of those relative to the reference.
    relative_squares: f64,
}

impl Sums {
    fn of(picture: &[[f32; 3]], reference: &[[f32; 3]]) -> Self {
        let mut sums = Self::default();
        for (picture, reference) in picture.iter().zip(reference) {
            for c in 0..3 {
                let (a, b) = (f64::from(picture[c]), f64::from(reference[c]));
                let square = (a - b) * (a - b);
                sums.values[0][c] += a;
                sums.values[1][c] += b;
                sums.squares += square;
                sums.relative_squares += square / (b * b + DARK);
            }
        }
        sums
    }

    fn plus(self, other: Self) -> Self {
        Self {
            values: [0, 1].map(|of| plus(self.values[of], other.values[of])),
            squares: self.squares + other.squares,
            relative_squares: self.relative_squares + other.relative_squares,
        }
    }
}

fn plus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] + b[i])
}

/// The channels in which the noise of two images can be compared, from linear Rec. 709: those of either image, or X, Y and
/// Z. `None` if theirs differ.
pub fn channels_of_both(picture: &Sampled, reference: &Sampled) -> Option<Matrix> {
    match (picture.channels_from_rgb, reference.channels_from_rgb) {
        (Some(a), Some(b)) if a != b => None,
        (Some(channels), _) | (None, Some(channels)) => Some(channels),
        (None, None) => Some(XYZ_FROM_RGB),
    }
}

/// `part / of`, but 0 for 0 / 0.
fn relative(part: f64, of: f64) -> f64 {
    if part == 0.0 { 0.0 } else { part / of.abs() }
}

/// The values of a pixel, of a block or of the whole image, in the channels of the variances.
#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    difference: [f64; 3],
    reference: [f64; 3],
    /// Variance of the difference.
    variance: [f64; 3],
}

impl Cell {
    /// The mean of `count` cells with independent noise, of which this is the sum.
    fn mean(self, count: usize) -> Self {
        let count = count.max(1) as f64;
        Self {
            difference: self.difference.map(|sum| sum / count),
            reference: self.reference.map(|sum| sum / count),
            variance: self.variance.map(|sum| sum / (count * count)),
        }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            difference: plus(self.difference, other.difference),
            reference: plus(self.reference, other.reference),
            variance: plus(self.variance, other.variance),
        }
    }

    fn standard_errors(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| relative(self.difference[i], self.variance[i].sqrt()))
    }

    fn is_within(&self) -> bool {
        (0..3).all(|i| {
            let rounding = if self.variance[i] > 0.0 { ROUNDING } else { WITHOUT_VARIANCE };
            let noise = MOST_STANDARD_ERRORS * self.variance[i].sqrt();
            self.difference[i].abs() <= noise + rounding * self.reference[i].abs() + 1e-9
        })
    }
}

/// The part of a row of blocks in a [`NoiseTest`].
#[derive(Clone, Copy, Default)]
struct BandOfBlocks {
    sum: Cell,
    pixels_within: usize,
    blocks_within: usize,
    blocks: usize,
}

impl BandOfBlocks {
    fn of(cells: &[Cell], width: usize) -> Self {
        let block = |x: usize| {
            let rows = || cells.chunks(width).map(|row| &row[x..(x + BLOCK).min(width)]);
            let sum = rows().flatten().copied().fold(Cell::default(), Cell::plus);
            sum.mean(rows().map(<[Cell]>::len).sum())
        };
        let blocks: Vec<Cell> = (0..width).step_by(BLOCK).map(block).collect();
        let within = |cells: &[Cell]| cells.iter().filter(|cell| cell.is_within()).count();
        Self {
            sum: cells.iter().copied().fold(Cell::default(), Cell::plus),
            pixels_within: within(cells),
            blocks_within: within(&blocks),
            blocks: blocks.len(),
        }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            sum: self.sum.plus(other.sum),
            pixels_within: self.pixels_within + other.pixels_within,
            blocks_within: self.blocks_within + other.blocks_within,
            blocks: self.blocks + other.blocks,
        }
    }
}

/// The z-tests in the given channels; `None` unless both images have variances.
fn noise_test(picture: &Sampled, reference: &Sampled, channels: &Matrix) -> Option<NoiseTest> {
    let (a, b) = (picture.variances.as_ref()?, reference.variances.as_ref()?);
    // A variance of 0 means that all samples were equal or not counted; then that of the other image is the best estimate.
    let variance = |a: f64, b: f64| match (a > 0.0, b > 0.0) {
        (false, true) => 2.0 * b,
        (true, false) => 2.0 * a,
        _ => a + b,
    };
    let cell = |pixel: usize| {
        let [picture, reference] =
            [picture, reference].map(|of| apply(channels, of.pixels[pixel].map(f64::from)));
        Cell {
            difference: [0, 1, 2].map(|i| picture[i] - reference[i]),
            reference,
            variance: [0, 1, 2].map(|i| variance(a[pixel][i], b[pixel][i])),
        }
    };
    let of_bands = parallel::map(bands(picture), |band| {
        BandOfBlocks::of(&band.map(cell).collect::<Vec<_>>(), picture.width)
    });
    let all = of_bands.into_iter().fold(BandOfBlocks::default(), BandOfBlocks::plus);
    let whole = all.sum.mean(picture.pixels.len());
    Some(NoiseTest {
        pixels_within: all.pixels_within as f64 / picture.pixels.len() as f64,
        blocks_within: all.blocks_within as f64 / all.blocks as f64,
        mean: whole.standard_errors(),
        relative_error_of_mean: relative(whole.variance[1].sqrt(), whole.reference[1]),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 100;
    const HEIGHT: usize = 50;

    /// Approximately normal, with mean 0 and variance 1: the sum of twelve numbers of a linear congruential generator.
    fn normal(state: &mut u64) -> f64 {
        let mut uniform = || {
            *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (*state >> 40) as f64 / (1 << 24) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }

    /// Grey of value `light` with noise of standard deviation `deviation`, which the file stores as the variance of one of
    /// 16 samples.
    fn noisy(light: f64, deviation: f64, seed: u64) -> Channels {
        let mut state = seed;
        let gray: Vec<f32> =
            (0..WIDTH * HEIGHT).map(|_| (light + deviation * normal(&mut state)) as f32).collect();
        // Grey g in Rec. 709 has X = 0.95 g and Z = 1.09 g.
        let variance = |scale: f64| vec![(deviation * deviation * scale * scale * 16.0) as f32; gray.len()];
        let [x, y, z] = apply(&XYZ_FROM_RGB, [1.0; 3]).map(variance);
        let names = ["R", "G", "B", "Variance.R", "Variance.G", "Variance.B"];
        let values = [gray.clone(), gray.clone(), gray, x, y, z];
        Channels {
            width: WIDTH as u32,
            height: HEIGHT as u32,
            channels: names.map(str::to_owned).into_iter().zip(values).collect(),
            attributes: vec![("samplesPerPixel".to_owned(), "16".to_owned())],
        }
    }

    fn compared(a: &Channels, b: &Channels) -> Comparison {
        compare(&Sampled::new(a, None).unwrap(), &Sampled::new(b, None).unwrap()).unwrap()
    }

    #[test]
    fn noise_is_explained_and_a_difference_is_not() {
        let reference = noisy(1.0, 0.1, 1);
        let same = compared(&noisy(1.0, 0.2, 2), &reference);
        let test = same.noise.unwrap();
        assert!(test.pixels_within > 0.998 && test.blocks_within > 0.98, "{test:?}");
        assert!(test.mean[1].abs() < 4.0 && same.relative[1].abs() < 0.02);
        let error = (0.05_f64 / (WIDTH * HEIGHT) as f64).sqrt();
        assert!((test.relative_error_of_mean / error - 1.0).abs() < 0.05);
        assert!((same.rmse - 0.05_f64.sqrt()).abs() < 0.01, "{}", same.rmse);
        // 5 % brighter: single pixels do not show it, blocks slightly, and the mean clearly.
        let brighter = compared(&noisy(1.05, 0.2, 2), &reference);
        let test = brighter.noise.unwrap();
        assert!(test.pixels_within > 0.99 && test.blocks_within < 0.95 && test.mean[1] > 10.0, "{test:?}");
        assert!((brighter.relative[0] - 0.05).abs() < 0.02);
        // Twice as much noise as the file states.
        let mut liar = noisy(1.0, 0.4, 3);
        liar.channels[4].1 = vec![0.2 * 0.2 * 16.0; WIDTH * HEIGHT];
        assert!(compared(&liar, &reference).noise.unwrap().pixels_within < 0.96);
    }

    #[test]
    fn numbers_by_hand() {
        let channels = |values: [f32; 2]| Channels {
            width: 2,
            height: 1,
            channels: vec![("Y".to_owned(), values.to_vec())],
            attributes: Vec::new(),
        };
        let comparison = compared(&channels([1.0, 3.0]), &channels([1.0, f32::NAN]));
        assert_eq!(comparison.means, [[2.0; 3], [0.5; 3]]);
        assert_eq!((comparison.relative, comparison.rmse), ([3.0; 3], 4.5_f64.sqrt()));
        assert_eq!((comparison.relative_mse, comparison.noise), (9.0 / DARK / 2.0, None));
        assert_eq!(Sampled::new(&channels([1.0, f32::INFINITY]), None).unwrap().not_finite, 3);
    }

    #[test]
    fn noise_is_compared_in_the_channels_it_is_of() {
        // Two channels of a sensor that are far from X and Y: noise that looks large in X, Y and Z is zero in them.
        let channels = [[1.0, -1.0, 0.0], [0.0, 1.0, -1.0], [0.0, 0.0, 1.0]];
        let known = |file: &Channels| {
            let mut file = file.clone();
            let variances = [1e-12, 1e-12, 0.1 * 0.1 * 16.0];
            for ((_, values), variance) in file.channels[3..].iter_mut().zip(variances) {
                values.fill(variance);
            }
            file
        };
        let says = |file: &Channels| {
            let attribute = (CHANNELS_ATTRIBUTE.to_owned(), channels_text(&channels));
            Channels {
                attributes: file.attributes.iter().cloned().chain([attribute]).collect(),
                ..file.clone()
            }
        };
        let [a, b] = [1, 2].map(|seed| known(&noisy(1.0, 0.1, seed)));
        // Grey noise does not appear in the first two channels. One image states them, or both do.
        for (a, b) in [(&says(&a), &b), (&a, &says(&b)), (&says(&a), &says(&b))] {
            let noise = compared(a, b).noise.expect("noise");
            assert!(noise.pixels_within > 0.998 && noise.mean[2].abs() < 4.0, "{noise:?}");
        }
        assert!(compared(&a, &b).noise.expect("noise").pixels_within < 0.5, "taken for X, Y and Z");
        // Images with different channels are not compared.
        let mut other = a.clone();
        other.attributes.push((CHANNELS_ATTRIBUTE.to_owned(), channels_text(&XYZ_FROM_RGB)));
        assert_eq!(compared(&other, &says(&b)).noise, None);
        // Anything but a matrix is ignored.
        for text in ["", "1 2 3", "1 0 0 0 1 0 0 0 inf", "1 0 0 0 1 0 0 0 one", "1 0 0 0 1 0 0 0 1 1"] {
            assert_eq!(matrix(text), None, "{text}");
        }
        assert_eq!(matrix(&channels_text(&XYZ_FROM_RGB)), Some(XYZ_FROM_RGB));
    }

    #[test]
    fn what_cannot_be_compared() {
        let mut narrow = noisy(1.0, 0.1, 1);
        narrow.width = WIDTH as u32 / 2;
        let [a, b] = [&noisy(1.0, 0.1, 1), &narrow].map(|file| Sampled::new(file, None).unwrap());
        assert!(compare(&a, &b).unwrap_err().message.contains("100 × 50"));
        narrow.channels.retain(|(name, _)| name != "G");
        assert!(Sampled::new(&narrow, None).unwrap_err().message.contains("Variance.R"));
        // Without a number of samples there is no noise test.
        narrow = noisy(1.0, 0.1, 1);
        narrow.attributes.clear();
        assert_eq!(Sampled::new(&narrow, None).unwrap().variances, None);
        assert!(Sampled::new(&narrow, Some(4)).unwrap().variances.is_some());
    }
}
