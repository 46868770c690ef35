//! The filter's inner loop: for every offset between two pixels, a whole block of pixels at once, so that it is
//! vectorised. A slow reference implementation, which goes pixel by pixel, is in the tests.

use lookfrom_scene::settings::PixelBounds;
use lookfrom_simd::{Kernel, Simd, dispatch, level};

use super::planes::{BORDER, Planes};
use super::{PATCH, RADIUS};
use crate::core::parallel;
use crate::film::Picture;

/// Difference of patches, in standard deviations of their difference and squared, at which the weight is `exp(−1)`.
const TOLERANCE: f32 = 0.42;

/// Added to the denominator, so that 0 over 0 is not NaN.
const LEAST_VARIANCE: f32 = 1e-12;

/// Size of a block of pixels that are filtered together: columns and rows. Its memory fits the L1 cache.
pub(super) const COLUMNS: usize = 64;
pub(super) const ROWS: usize = 16;

/// Length of a row of a block with the patches' margins.
const WIDE: usize = COLUMNS + 2 * PATCH;
/// Number of rows of a block with the patches' margins.
const HIGH: usize = ROWS + 2 * PATCH;

/// The filter's changes of the pixels of a band.
pub(super) struct Changes<const N: usize> {
    /// The part of the picture.
    area: PixelBounds,
    /// Blocks of [`ROWS`] × [`COLUMNS`] pixels, row by row; `None` where there is no noise.
    blocks: Vec<Option<BlockChanges<N>>>,
}

/// The changes of red, green, blue (and alpha) of a block, row by row; those behind its last column and row are any.
type BlockChanges<const N: usize> = Vec<[f32; N]>;

impl<const N: usize> Planes<N> {
    /// The filter's changes of the band.
    pub(super) fn changes(&self) -> Changes<N> {
        let (width, height) = (self.width(), self.height());
        let columns = width.div_ceil(COLUMNS);
        let level = level();
        let blocks = parallel::collect(columns * height.div_ceil(ROWS), |index| {
            let (left, top) = (index % columns * COLUMNS, index / columns * ROWS);
            let block = Block { planes: self, left, top, rows: ROWS.min(height - top) };
            if !block.is_noisy() {
                return None;
            }
            let mut changes = vec![[0.0; N]; COLUMNS * ROWS];
            dispatch(level, Filter { block, changes: &mut changes });
            for y in 0..block.rows {
                for x in 0..COLUMNS.min(width - left) {
                    let change = &mut changes[y * COLUMNS + x];
                    *change = self.change((top + y) * width + left + x, *change);
                }
            }
            Some(changes)
        });
        Changes { area: self.area, blocks }
    }
}

impl<const N: usize> Changes<N> {
    /// Adds them to the picture's pixels.
    pub(super) fn apply(self, picture: &mut Picture) {
        let PixelBounds { x0, y0, x1, y1 } = self.area;
        let [width, height] = [x1 - x0, y1 - y0].map(|side| side as usize);
        let columns = width.div_ceil(COLUMNS);
        for (index, changes) in self.blocks.into_iter().enumerate() {
            let Some(changes) = changes else { continue };
            let (left, top) = (index % columns * COLUMNS, index / columns * ROWS);
            for y in 0..ROWS.min(height - top) {
                for x in 0..COLUMNS.min(width - left) {
                    let change = changes[y * COLUMNS + x];
                    let place = (y0 as usize + top + y) * picture.width as usize + x0 as usize + left + x;
                    for (light, change) in picture.pixels[place].iter_mut().zip(change) {
                        *light += change;
                    }
                    if N == 4 {
                        picture.alpha[place] += change[N - 1];
                    }
                }
            }
        }
    }
}

/// A block of pixels of the planes.
#[derive(Clone, Copy)]
struct Block<'a, const N: usize> {
    planes: &'a Planes<N>,
    /// The first column and row, in the band.
    left: usize,
    top: usize,
    /// Number of rows, at most [`ROWS`]; there are always [`COLUMNS`] columns, of which the last may lie in the border.
    rows: usize,
}

impl<const N: usize> Block<'_, N> {
    /// The index in the planes of the pixel at this row and column of the block with its margins.
    fn start(&self, row: usize, column: usize) -> usize {
        (self.top + row + BORDER - PATCH) * self.planes.stride + self.left + column + BORDER - PATCH
    }

    /// Whether any pixel has noise: without it, nothing is changed.
    fn is_noisy(&self) -> bool {
        (0..self.rows).any(|row| {
            let start = self.start(row + PATCH, PATCH);
            self.planes.variance[start..start + COLUMNS].iter().any(|&variance| variance > 0.0)
        })
    }
}

/// The filter for one block.
struct Filter<'a, const N: usize> {
    block: Block<'a, N>,
    /// The changes of the block.
    changes: &'a mut [[f32; N]],
}

/// `LENGTH` numbers of a plane.
#[inline(always)]
fn row<const LENGTH: usize>(plane: &[f32], start: usize) -> &[f32; LENGTH] {
    // The planes have a border as wide as the filter reaches.
    plane[start..start + LENGTH].first_chunk().expect("a slice of this length")
}

impl<const N: usize> Kernel for Filter<'_, N> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Self { block, changes } = self;
        let Planes { stride, light, variance, compared, trust, place, plane, .. } = block.planes;
        let mut distances = [[0.0_f32; WIDE]; HIGH];
        let mut sums_of_rows = [[0.0_f32; COLUMNS]; HIGH];
        let mut weights = [[1.0_f32; COLUMNS]; ROWS];
        let mut sums = [[[0.0_f32; COLUMNS]; N]; ROWS];

        for offset in offsets(*stride) {
            // The distance of the light of the two pixels, less the part that noise explains.
            for y in 0..block.rows + 2 * PATCH {
                let here = block.start(y, 0);
                let there = here.wrapping_add_signed(offset);
                let (p, q) = (lights(light, here), lights(light, there));
                let (p_variance, q_variance) = (row::<WIDE>(variance, here), row::<WIDE>(variance, there));
                let distances = &mut distances[y];
                for x in 0..WIDE {
                    let mut square = 0.0;
                    for c in 0..N {
                        let difference = q[c][x] - p[c][x];
                        square += difference * difference;
                    }
                    distances[x] = distance(square, p_variance[x], q_variance[x]);
                }
            }
            // The mean over the patches: along rows, then along columns.
            for y in 0..block.rows + 2 * PATCH {
                // The loop over shifts must be the outer one: otherwise the compiler does not vectorise.
                let sums = &mut sums_of_rows[y];
                *sums = *row::<COLUMNS>(&distances[y], 0);
                for next in 1..=2 * PATCH {
                    let shifted = row::<COLUMNS>(&distances[y], next);
                    for x in 0..COLUMNS {
                        sums[x] += shifted[x];
                    }
                }
            }
            for y in 0..block.rows {
                let here = block.start(y + PATCH, PATCH);
                let there = here.wrapping_add_signed(offset);
                let mut of_light = sums_of_rows[y];
                for next in 1..=2 * PATCH {
                    for x in 0..COLUMNS {
                        of_light[x] += sums_of_rows[y + next][x];
                    }
                }
                // The features.
                let mut of_features = [0.0_f32; COLUMNS];
                for feature in compared {
                    let (p, q) = (row::<COLUMNS>(feature, here), row::<COLUMNS>(feature, there));
                    for x in 0..COLUMNS {
                        let difference = q[x] - p[x];
                        of_features[x] += difference * difference;
                    }
                }
                let mut off_plane = [0.0_f32; COLUMNS];
                for axis in 0..3 {
                    let (p, q) = (row::<COLUMNS>(&place[axis], here), row::<COLUMNS>(&place[axis], there));
                    let n = row::<COLUMNS>(&plane[axis], here);
                    for x in 0..COLUMNS {
                        off_plane[x] += (q[x] - p[x]) * n[x];
                    }
                }
                // The weight, and the weighted differences.
                let mut weight = [0.0_f32; COLUMNS];
                let trust = row::<COLUMNS>(trust, here);
                for x in 0..COLUMNS {
                    let of_features = (of_features[x] + off_plane[x] * off_plane[x]) * trust[x];
                    weight[x] = falloff(of_light[x], of_features);
                    weights[y][x] += weight[x];
                }
                for c in 0..N {
                    let (p, q) = (row::<COLUMNS>(&light[c], here), row::<COLUMNS>(&light[c], there));
                    let sums = &mut sums[y][c];
                    for x in 0..COLUMNS {
                        sums[x] += weight[x] * (q[x] - p[x]);
                    }
                }
            }
        }

        for y in 0..block.rows {
            for x in 0..COLUMNS {
                for c in 0..N {
                    changes[y * COLUMNS + x][c] = sums[y][c][x] / weights[y][x];
                }
            }
        }
    }
}

/// Offsets in the planes from a pixel to each of its neighbours, row by row.
fn offsets(stride: usize) -> impl Iterator<Item = isize> {
    let reach = -(RADIUS as isize)..=RADIUS as isize;
    let all = reach.clone().flat_map(move |y| reach.clone().map(move |x| y * stride as isize + x));
    all.filter(|&offset| offset != 0)
}

/// A row of all channels with the patches' margins.
#[inline(always)]
fn lights<const N: usize>(light: &[Vec<f32>; N], start: usize) -> [&[f32; WIDE]; N] {
    std::array::from_fn(|c| row(&light[c], start))
}

/// The distance of two pixels whose light differs by this (squared, all channels together): its expectation is 0 where
/// only noise differs.
#[inline(always)]
pub(super) fn distance(square: f32, p_variance: f32, q_variance: f32) -> f32 {
    let less = if p_variance < q_variance { p_variance } else { q_variance };
    (square - (p_variance + less)) / (LEAST_VARIANCE + TOLERANCE * (p_variance + q_variance))
}

/// The weight of a neighbour: about `exp(−x)` of the sum of its distances; `of_light` is the sum over the patches.
#[inline(always)]
pub(super) fn falloff(of_light: f32, of_features: f32) -> f32 {
    const SHARE: f32 = 1.0 / ((2 * PATCH + 1) * (2 * PATCH + 1)) as f32;
    let mean = of_light * SHARE;
    let x = of_features + if mean > 0.0 { mean } else { 0.0 };
    let rest = 1.0 - 0.125 * x;
    let rest = if rest > 0.0 { rest } else { 0.0 };
    let square = rest * rest;
    let fourth = square * square;
    fourth * fourth
}
