//! A band of rows of the film in planes for the filter: each component of a pixel in a plane of its own, scaled so that
//! differences can be added, with a border as wide as the filter reaches. Beyond the film's area the border repeats the nearest
//! pixel.

use std::ops::Range;

use lookfrom_scene::settings::PixelBounds;
use lookfrom_scene::spectrum::space::xyz_of_rec709;

use super::filter::COLUMNS;
use super::{PATCH, RADIUS};
use crate::core::parallel;
use crate::film::{Aovs, DenoiserFeatures, Film, Picture};

/// The width of the border.
pub(super) const BORDER: usize = RADIUS + PATCH;

/// Added to an albedo before light is divided by it: specular reflection of dark surfaces is not proportional to their
/// albedo.
const MIRRORED: f32 = 0.1;

/// Standard deviations of features: a difference of this size makes a pixel's weight `exp(−½)`.
const NORMAL_DEVIATION: f32 = 0.15;
const ALBEDO_DEVIATION: f32 = 0.15;
/// Deviation of the distance from a pixel's tangent plane, in the distance between the positions of neighbouring
/// pixels.
const PLANE_DEVIATION: f32 = 4.0;

/// The normal in the border and of pixels without samples: far from any other.
const NOWHERE: f32 = 1e6;

/// Number of features that are compared directly: normal and albedo.
pub(super) const COMPARED: usize = 6;

/// Number of rows above and below those of the planes whose pixels decide about them: a variance is estimated from pixels up to
/// two rows away.
const AROUND: usize = 2;

/// A band of the picture with `N` channels: X, Y, Z, whose variances the film has, and alpha if N is 4.
pub(super) struct Planes<const N: usize> {
    /// The part of the picture: rows of what the film holds.
    pub(super) area: PixelBounds,
    /// Offset from one row to the next.
    pub(super) stride: usize,
    /// Light over albedo; alpha times the picture's mean light.
    pub(super) light: [Vec<f32>; N],
    /// The variance of `light`, in all channels together, smoothed.
    pub(super) variance: Vec<f32>,
    /// Normal and albedo over their deviations.
    pub(super) compared: [Vec<f32>; COMPARED],
    /// Weight of a difference in features.
    pub(super) trust: Vec<f32>,
    /// The position of the first hit.
    pub(super) place: [Vec<f32>; 3],
    /// The geometric normal divided by the deviation of distances along it.
    pub(super) plane: [Vec<f32>; 3],
    /// The divisors of red, green, blue and alpha: without a border.
    divisors: Vec<[f32; N]>,
}

/// The data of a pixel in the planes, except for the scale of its tangent plane.
struct Known<const N: usize> {
    light: [f32; N],
    divisor: [f32; N],
    variance: f32,
    aovs: Aovs,
    trust: f32,
    is_sampled: bool,
}

impl<const N: usize> Planes<N> {
    /// The planes of some rows of the film's area, counted from its first one.
    pub(super) fn new(film: &Film, picture: &Picture, rows: Range<usize>, alpha_divisor: f32) -> Self {
        let whole = film.area();
        let (width, height) = ((whole.x1 - whole.x0) as usize, (whole.y1 - whole.y0) as usize);
        let margin = BORDER + AROUND;
        let first = rows.start.saturating_sub(margin);
        let pixels: Vec<Known<N>> =
            parallel::collect(width * ((rows.end + margin).min(height) - first), |index| {
                let [x, y] = [index % width, first + index / width].map(|offset| offset as u32);
                known(film, picture, [whole.x0 + x, whole.y0 + y], alpha_divisor)
            });
        let known = Grid { pixels: &pixels, first, width, height, rows: rows.clone() };

        let spread = |of: &(dyn Fn(usize, usize) -> f32 + Sync)| known.bordered(of);
        let light = std::array::from_fn(|c| spread(&|x, y| known.at(x, y).light[c]));
        let variance = spread(&|x, y| known.smooth_variance(x, y));
        let mut compared: [Vec<f32>; COMPARED] = std::array::from_fn(|i| match i {
            0..3 => spread(&|x, y| known.at(x, y).normal()[i] / (2.0_f32.sqrt() * NORMAL_DEVIATION)),
            _ => spread(&|x, y| known.at(x, y).aovs.albedo[i - 3] / (2.0_f32.sqrt() * ALBEDO_DEVIATION)),
        });
        known.mark_border(&mut compared[0]);
        let trust = spread(&|x, y| known.at(x, y).trust);
        let place = std::array::from_fn(|i| spread(&|x, y| known.at(x, y).aovs.position[i]));
        let scales = spread(&|x, y| known.plane_scale(x, y));
        let mut plane: [Vec<f32>; 3] = std::array::from_fn(|i| spread(&|x, y| known.at(x, y).aovs.ng[i]));
        for plane in &mut plane {
            plane.iter_mut().zip(&scales).for_each(|(n, scale)| *n *= scale);
        }
        let divisors = rows.clone().flat_map(|y| (0..width).map(move |x| (x, y)));
        let divisors = divisors.map(|(x, y)| known.at(x, y).divisor).collect();
        let [y0, y1] = [rows.start, rows.end].map(|row| whole.y0 + row as u32);
        let area = PixelBounds { y0, y1, ..whole };
        Self { area, stride: stride(width), light, variance, compared, trust, place, plane, divisors }
    }

    /// Number of columns of the area.
    pub(super) fn width(&self) -> usize {
        (self.area.x1 - self.area.x0) as usize
    }

    /// Number of rows of the area.
    pub(super) fn height(&self) -> usize {
        (self.area.y1 - self.area.y0) as usize
    }

    /// The change of red, green, blue (and alpha) of a pixel of the area, by row-major index, for a change of the
    /// planes' light.
    pub(super) fn change(&self, index: usize, of_light: [f32; N]) -> [f32; N] {
        let divisors = &self.divisors[index];
        let rgb = rgb([of_light[0], of_light[1], of_light[2]]);
        std::array::from_fn(|c| rgb.get(c).unwrap_or(&of_light[c]) * divisors[c])
    }
}

/// The divisor by which alpha counts as much as the mean light of the picture.
pub(super) fn alpha_divisor(film: &Film) -> f32 {
    let mean = film.mean_luminance().abs() as f32;
    if mean > 0.0 { 1.0 / mean } else { 1.0 }
}

fn known<const N: usize>(film: &Film, picture: &Picture, [x, y]: [u32; 2], alpha_divisor: f32) -> Known<N> {
    let index = y as usize * picture.width as usize + x as usize;
    let samples = film.samples(x, y);
    let (aovs, trust) = match film.denoiser_features(x, y) {
        Some(features) => (features.aovs, trust(&features)),
        None => (Aovs { albedo: [1.0; 3], ..Aovs::default() }, 1.0),
    };
    let divisor: [f32; N] = std::array::from_fn(|c| match aovs.albedo.get(c) {
        Some(albedo) => albedo + MIRRORED,
        None => alpha_divisor,
    });
    let [r, g, b] = picture.pixels[index];
    let raw = xyz([r, g, b]);
    let over_albedo = xyz([r / divisor[0], g / divisor[1], b / divisor[2]]);
    let light = std::array::from_fn(|c| {
        over_albedo.get(c).copied().unwrap_or_else(|| picture.alpha[index] / divisor[c])
    });

    // The variances of X, Y and Z are those before the division, which scales each by a mean of the divisors.
    let rgb_divisors = [divisor[0], divisor[1], divisor[2]];
    let least = rgb_divisors.into_iter().fold(f32::INFINITY, f32::min);
    let greatest = rgb_divisors.into_iter().fold(0.0, f32::max);
    let of_xyz = film.variance(x, y);
    let variance = (0..N).fold(0.0, |sum, c| {
        let (of_one, factor) = match of_xyz.get(c) {
            Some(_) if !(raw[c] > 0.0) => (of_xyz[c], 1.0 / least),
            Some(_) => (of_xyz[c], (over_albedo[c] / raw[c]).clamp(1.0 / greatest, 1.0 / least)),
            None => (film.alpha_variance(x, y), 1.0 / divisor[c]),
        };
        sum + of_one * (factor * factor)
    });
    Known { light, divisor, variance: variance / samples.max(1) as f32, aovs, trust, is_sampled: samples > 0 }
}

/// Weight of a difference in features: less where a pixel covers several surfaces, by the variance of its mean normal.
fn trust(mean: &DenoiserFeatures) -> f32 {
    let square = mean.aovs.ns.into_iter().fold(0.0, |sum, n| sum + n * n);
    let variance = (mean.coverage - square).max(0.0) / mean.samples as f32;
    1.0 / (1.0 + variance / (NORMAL_DEVIATION * NORMAL_DEVIATION))
}

/// X, Y and Z of linear Rec. 709.
fn xyz(rgb: [f32; 3]) -> [f32; 3] {
    xyz_of_rec709(rgb.map(f64::from)).map(|value| value as f32)
}

/// Linear Rec. 709 of X, Y and Z.
pub(super) fn rgb([x, y, z]: [f32; 3]) -> [f32; 3] {
    [
        3.240_97 * x - 1.537_383_2 * y - 0.498_610_76 * z,
        -0.969_243_65 * x + 1.875_967_5 * y + 0.041_555_06 * z,
        0.055_630_08 * x - 0.203_976_96 * y + 1.056_971_5 * z,
    ]
}

impl<const N: usize> Known<N> {
    fn normal(&self) -> [f32; 3] {
        if self.is_sampled { self.aovs.ns } else { [-NOWHERE; 3] }
    }
}

/// Offset from one row of a plane to the next: whole blocks, and the border.
fn stride(width: usize) -> usize {
    width.next_multiple_of(COLUMNS) + 2 * BORDER
}

/// The pixels of a film's area, of which only rows of the planes and around them are known.
struct Grid<'a, const N: usize> {
    /// Row by row, from row `first` on.
    pixels: &'a [Known<N>],
    first: usize,
    /// Size of the area.
    width: usize,
    height: usize,
    /// The rows of the planes.
    rows: Range<usize>,
}

impl<const N: usize> Grid<'_, N> {
    fn at(&self, x: usize, y: usize) -> &Known<N> {
        &self.pixels[(y - self.first) * self.width + x]
    }

    /// A plane of the rows with a border: of the pixels there, or of the nearest ones.
    fn bordered(&self, of: &(dyn Fn(usize, usize) -> f32 + Sync)) -> Vec<f32> {
        let stride = stride(self.width);
        let mut plane = vec![0.0; stride * (self.rows.len() + 2 * BORDER)];
        if self.pixels.is_empty() {
            return plane;
        }
        parallel::for_chunks_mut(&mut plane, stride, |row, values| {
            let y = (self.rows.start + row).saturating_sub(BORDER).min(self.height - 1);
            for (x, value) in values[BORDER..BORDER + self.width].iter_mut().enumerate() {
                *value = of(x, y);
            }
            let (first, last) = (values[BORDER], values[BORDER + self.width - 1]);
            values[..BORDER].fill(first);
            values[BORDER + self.width..].fill(last);
        });
        plane
    }

    /// Makes what is beyond the area different from everything.
    fn mark_border(&self, plane: &mut [f32]) {
        for (row, values) in plane.chunks_mut(stride(self.width)).enumerate() {
            let y = self.rows.start + row;
            if y < BORDER || y >= BORDER + self.height {
                values.fill(NOWHERE);
            } else {
                values[..BORDER].fill(NOWHERE);
                values[BORDER + self.width..].fill(NOWHERE);
            }
        }
    }

    /// The mean variance of the 3 × 3 pixels around, which is more reliable than that of one.
    fn smooth_variance(&self, x: usize, y: usize) -> f32 {
        let (mut sum, mut count) = (0.0, 0.0);
        for row in y.saturating_sub(1)..(y + 2).min(self.height) {
            for column in x.saturating_sub(1)..(x + 2).min(self.width) {
                let variance = self.at(column, row).variance;
                if variance.is_finite() {
                    sum += variance;
                    count += 1.0;
                }
            }
        }
        if count > 0.0 { sum / count } else { self.scatter(x, y) }
    }

    /// An estimate of a pixel's variance where it has only one sample: the variance of the pixels around.
    fn scatter(&self, x: usize, y: usize) -> f32 {
        let mut sums = [0.0; N];
        let mut squares = 0.0;
        let mut count = 0.0;
        for row in y.saturating_sub(2)..(y + 3).min(self.height) {
            for column in x.saturating_sub(2)..(x + 3).min(self.width) {
                let other = self.at(column, row);
                if !other.is_sampled {
                    continue;
                }
                for (sum, light) in sums.iter_mut().zip(other.light) {
                    *sum += light;
                    squares += light * light;
                }
                count += 1.0;
            }
        }
        let square_of_mean =
            sums.into_iter().fold(0.0, |sum, of_channel| sum + of_channel * of_channel / count);
        if count > 1.0 { ((squares - square_of_mean) / (count - 1.0)).max(0.0) } else { 0.0 }
    }

    /// One over the deviation of distances from a pixel's tangent plane, in proportion to the distance of the nearest
    /// neighbour's position. 0 where there is no hit.
    fn plane_scale(&self, x: usize, y: usize) -> f32 {
        let own = self.at(x, y);
        if own.aovs.ng == [0.0; 3] {
            return 0.0;
        }
        let mut nearest = f32::INFINITY;
        let mut look = |x: usize, y: usize| {
            let other = self.at(x, y);
            if other.aovs.ng != [0.0; 3] {
                let square = (0..3).fold(0.0, |sum, i| {
                    let difference = own.aovs.position[i] - other.aovs.position[i];
                    sum + difference * difference
                });
                if square > 0.0 && square < nearest {
                    nearest = square;
                }
            }
        };
        if x > 0 {
            look(x - 1, y);
        }
        if x + 1 < self.width {
            look(x + 1, y);
        }
        if y > 0 {
            look(x, y - 1);
        }
        if y + 1 < self.height {
            look(x, y + 1);
        }
        1.0 / (2.0_f32.sqrt() * PLANE_DEVIATION * nearest.sqrt())
    }
}
