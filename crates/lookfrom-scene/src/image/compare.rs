//! Comparison of two images: error metrics, and z-tests against their measured variance.
//!
//! Means and errors in numbers; and where both pictures know their variance (channels `Variance.R G B`: of *one* sample, as pbrt's
//! `gbuffer` film writes them and ours does), a z-test of each pixel and of each block of pixels: the difference in shares of
//! the standard error that both sides' noise gives it. How it looks is left to [`super::flip`].
//!
//! Variances are those of the channels of the sensor: of X, Y and Z, or of a camera's own red, green and blue. They cannot be
//! converted without their covariances, so colours are. Ours say what they are of (`variance.from_rgb`), pbrt's do not: they are
//! taken for the same as the other picture's.

use super::openexr::Channels;
use crate::error::{Error, Location, Result};
use crate::spectrum::space::{Matrix, XYZ_FROM_RGB, apply};

/// A pixel farther away than this many standard errors is not explained by noise.
pub const MOST_STANDARD_ERRORS: f64 = 3.5;

/// Pixels on the side of a block.
pub const BLOCK: usize = 16;

/// What is allowed besides noise, in shares of the light: rounding, and where neither side has a variance, what a film
/// does not count as such (pbrt's leaves out samples that meet nothing).
const ROUNDING: f64 = 1e-3;
const WITHOUT_VARIANCE: f64 = 1e-2;

/// Added to the square of the reference in [`Comparison::relative_mse`], so that black is no pole.
const DARK: f64 = 1e-2;

/// The attribute of an EXR that says which channels its variances are of: nine numbers, by rows, that give them from linear
/// Rec. 709.
pub const CHANNELS_ATTRIBUTE: &str = "variance.from_rgb";

/// The text of that attribute.
pub fn channels_text(channels_from_rgb: &Matrix) -> String {
    channels_from_rgb.as_flattened().iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}

/// The matrix of such a text; `None` for anything but nine finite numbers.
fn matrix(text: &str) -> Option<Matrix> {
    let numbers: Option<Vec<f64>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
    let &[a, b, c, d, e, f, g, h, i] = numbers?.as_slice() else { return None };
    let matrix = [[a, b, c], [d, e, f], [g, h, i]];
    matrix.iter().flatten().all(|number| number.is_finite()).then_some(matrix)
}

/// A picture to compare: linear colours, and what is known of their noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampled {
    /// Columns.
    pub width: usize,
    /// Linear Rec. 709, row by row; all finite.
    pub pixels: Vec<[f32; 3]>,
    /// The number of values that were not finite; they are 0 in `pixels`.
    pub not_finite: usize,
    /// The variances of the pixels (not of one sample) in three channels.
    pub variances: Option<Vec<[f64; 3]>>,
    /// The matrix from linear Rec. 709 to the channels of the variances; `None` where it is not known.
    pub channels_from_rgb: Option<Matrix>,
}

/// The result of a comparison of two pictures. Channels are red, green, blue.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The mean of the picture and of the reference, by channel.
    pub means: [[f64; 3]; 2],
    /// The difference of the means relative to the reference's means.
    pub relative: [f64; 3],
    /// Root of the mean squared difference.
    pub rmse: f64,
    /// Mean squared difference in shares of the reference's square plus 0.01.
    pub relative_mse: f64,
    /// The z-tests, where both pictures have variances in the same channels.
    pub noise: Option<NoiseTest>,
}

/// The z-tests, in the channels of the variances: X, Y and Z, or those of a camera.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseTest {
    /// The share of pixels of which all three differ by at most [`MOST_STANDARD_ERRORS`].
    pub pixels_within: f64,
    /// The same of the means of blocks of [`BLOCK`] × [`BLOCK`] pixels.
    pub blocks_within: f64,
    /// The difference of the pictures' means in standard errors.
    pub mean: [f64; 3],
    /// The standard error of the difference of the means in the second channel (Y, green), in shares of the reference's mean.
    pub relative_error_of_mean: f64,
}

impl Sampled {
    /// A picture from all that a file has; `samples` a pixel are what the file says where nobody does (`samples`, or pbrt's
    /// `samplesPerPixel`). Without either there are no variances.
    ///
    /// # Errors
    /// `Invalid` where there are no channels R, G, B, nor Y.
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
        let mut not_finite = 0;
        for value in pixels.iter_mut().flatten().filter(|value| !value.is_finite()) {
            *value = 0.0;
            not_finite += 1;
        }
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
}

/// Compares a picture with a reference.
///
/// # Errors
/// `Invalid` where they differ in size or have no pixels.
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
    let count = picture.pixels.len() as f64;
    let mean = |of: &Sampled, channel: usize| {
        of.pixels.iter().map(|rgb| f64::from(rgb[channel])).sum::<f64>() / count
    };
    let means = [picture, reference].map(|of| [0, 1, 2].map(|channel| mean(of, channel)));
    let pairs = || {
        let values = picture.pixels.as_flattened().iter().zip(reference.pixels.as_flattened());
        values.map(|(&a, &b)| (f64::from(a), f64::from(b)))
    };
    let squares = pairs().map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
    let relative_squares = pairs().map(|(a, b)| (a - b) * (a - b) / (b * b + DARK)).sum::<f64>();
    Ok(Comparison {
        means,
        relative: [0, 1, 2].map(|c| relative(means[0][c] - means[1][c], means[1][c])),
        rmse: (squares / (3.0 * count)).sqrt(),
        relative_mse: relative_squares / (3.0 * count),
        noise: channels_of_both(picture, reference).and_then(|channels| {
            let (a, b) = (picture.variances.as_ref()?, reference.variances.as_ref()?);
            let cells = cells((picture, a), (reference, b), &channels);
            Some(NoiseTest {
                pixels_within: within(&cells),
                blocks_within: within(&blocks(&cells, picture.width)),
                mean: whole(&cells).standard_errors(),
                relative_error_of_mean: {
                    let whole = whole(&cells);
                    relative(whole.variance[1].sqrt(), whole.reference[1])
                },
            })
        }),
    })
}

/// The channels in which two pictures' noise can be compared, from linear Rec. 709: those that either says, or X, Y and Z.
/// `None` where they say different ones.
pub fn channels_of_both(picture: &Sampled, reference: &Sampled) -> Option<Matrix> {
    match (picture.channels_from_rgb, reference.channels_from_rgb) {
        (Some(a), Some(b)) if a != b => None,
        (Some(channels), _) | (None, Some(channels)) => Some(channels),
        (None, None) => Some(XYZ_FROM_RGB),
    }
}

/// `part / of`, and 0 where nothing is no part of anything.
fn relative(part: f64, of: f64) -> f64 {
    if part == 0.0 { 0.0 } else { part / of.abs() }
}

/// A pixel, a block or the whole, in the channels of the variances.
#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    difference: [f64; 3],
    reference: [f64; 3],
    /// Of the difference.
    variance: [f64; 3],
}

impl Cell {
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

fn cells(
    (picture, a): (&Sampled, &[[f64; 3]]),
    (reference, b): (&Sampled, &[[f64; 3]]),
    channels: &Matrix,
) -> Vec<Cell> {
    // A side without variance saw the same all the time, or did not count what it saw: the other's noise is the guess.
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
    (0..picture.pixels.len()).map(cell).collect()
}

/// The mean of cells whose noise is independent.
fn mean<'a>(cells: impl Iterator<Item = &'a Cell>) -> Cell {
    let (mut sum, mut count) = (Cell::default(), 0.0_f64);
    for cell in cells {
        count += 1.0;
        for i in 0..3 {
            sum.difference[i] += cell.difference[i];
            sum.reference[i] += cell.reference[i];
            sum.variance[i] += cell.variance[i];
        }
    }
    let count = count.max(1.0);
    Cell {
        difference: sum.difference.map(|sum| sum / count),
        reference: sum.reference.map(|sum| sum / count),
        variance: sum.variance.map(|sum| sum / (count * count)),
    }
}

fn whole(cells: &[Cell]) -> Cell {
    mean(cells.iter())
}

fn blocks(cells: &[Cell], width: usize) -> Vec<Cell> {
    let bands = cells.chunks(BLOCK * width);
    bands
        .flat_map(|band| {
            (0..width)
                .step_by(BLOCK)
                .map(move |x| mean(band.chunks(width).flat_map(move |row| &row[x..(x + BLOCK).min(width)])))
        })
        .collect()
}

fn within(cells: &[Cell]) -> f64 {
    cells.iter().filter(|cell| cell.is_within()).count() as f64 / cells.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 100;
    const HEIGHT: usize = 50;

    /// About normal, with mean 0 and variance 1: twelve numbers of a linear congruence.
    fn normal(state: &mut u64) -> f64 {
        let mut uniform = || {
            *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (*state >> 40) as f64 / (1 << 24) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }

    /// Gray `light` with noise of `deviation`, which the file knows as that of one of 16 samples.
    fn noisy(light: f64, deviation: f64, seed: u64) -> Channels {
        let mut state = seed;
        let gray: Vec<f32> =
            (0..WIDTH * HEIGHT).map(|_| (light + deviation * normal(&mut state)) as f32).collect();
        // Of Rec. 709's gray g, X is 0.95 g and Z is 1.09 g.
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
        // Two hundredths brighter: no pixel tells, but blocks do a little, and the mean is certain.
        let brighter = compared(&noisy(1.05, 0.2, 2), &reference);
        let test = brighter.noise.unwrap();
        assert!(test.pixels_within > 0.99 && test.blocks_within < 0.95 && test.mean[1] > 10.0, "{test:?}");
        assert!((brighter.relative[0] - 0.05).abs() < 0.02);
        // Twice as much noise as the file says.
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
        // Two channels of a sensor that are far from X and Y: noise that looks large in X, Y and Z is none there.
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
        // Grey noise has none of the first two channels. One picture says so, or both do.
        for (a, b) in [(&says(&a), &b), (&a, &says(&b)), (&says(&a), &says(&b))] {
            let noise = compared(a, b).noise.expect("noise");
            assert!(noise.pixels_within > 0.998 && noise.mean[2].abs() < 4.0, "{noise:?}");
        }
        assert!(compared(&a, &b).noise.expect("noise").pixels_within < 0.5, "taken for X, Y and Z");
        // Who says different things is not compared.
        let mut other = a.clone();
        other.attributes.push((CHANNELS_ATTRIBUTE.to_owned(), channels_text(&XYZ_FROM_RGB)));
        assert_eq!(compared(&other, &says(&b)).noise, None);
        // What is no matrix says nothing.
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
        // Without a number of samples there is no noise to test with.
        narrow = noisy(1.0, 0.1, 1);
        narrow.attributes.clear();
        assert_eq!(Sampled::new(&narrow, None).unwrap().variances, None);
        assert!(Sampled::new(&narrow, Some(4)).unwrap().variances.is_some());
    }
}
