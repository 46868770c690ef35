//! Pixel reconstruction filters with filter importance sampling.
//!
//! Step 3 in the computation of a pixel. Instead of weighting samples, positions are *sampled* with a density
//! proportional to the filter, so that a sample contributes to its own pixel only (filter importance sampling,
//! Ernst, Stamminger & Greiner 2006). Where a filter is negative, so is the weight. All filters here are separable:
//! products of a curve along x and one along y, which differ in their radius alone.
//!
//! Mitchell & Netravali 1988 (the cubic); Harris 1978 (the four-term window); Duchon 1979 (the sinc of Lanczos).

use lookfrom_scene::settings::{Filter as Settings, FilterShape as Shape};
use lookfrom_simd::{Float, Real};

use crate::core::sampler::ONE_MINUS_EPSILON;

/// Number of table cells from the centre to the radius.
const CELLS: usize = 1024;

/// Number of equal intervals of the cumulative sum that speed up the search for a cell.
const PARTS: usize = 1024;

/// A pixel filter, prepared for sampling.
///
/// Box and triangle are inverted exactly. The others are tabulated: along each axis 1024 cells from the centre to
/// the radius, each of constant density, with the integral over each cell exact up to rounding. So no sample lies
/// farther than radius/1024 pixels from the exact inverse.
#[derive(Clone, Debug)]
pub struct Filter {
    x: Axis,
    /// Along y, where it is not as along x.
    y: Option<Axis>,
    /// ∫|f| / ∫f over the plane: the magnitude of all weights.
    weight: f32,
}

/// A filter along one axis.
#[derive(Clone, Debug)]
struct Axis {
    curve: Curve,
    radius: f32,
    /// ∫f in pixels.
    integral: f64,
    table: Option<Table>,
}

/// The inverse of |f| along one axis, from the centre outward.
#[derive(Clone, Debug)]
struct Table {
    /// The fraction of ∫|f| before each cell, and 1 at the end.
    cumulative: Vec<f32>,
    /// For each of [`PARTS`] equal intervals of 0 … 1, the cell that contains its beginning: the start of the
    /// search.
    first: Vec<u16>,
    /// True if f is negative in the cell.
    negative: Vec<bool>,
    /// ∫|f| / ∫f.
    weight: f64,
}

/// A filter along one axis, over −1 … 1 for the radius on either side.
#[derive(Clone, Copy, Debug)]
enum Curve {
    Box,
    Triangle,
    /// exp(−steepness x²) less its value at 1.
    Gaussian {
        steepness: f64,
    },
    Mitchell {
        b: f64,
        c: f64,
    },
    BlackmanHarris,
    /// sin(πx) / (πx), x in pixels, under the same function of x / τ.
    Sinc {
        radius: f64,
        tau: f64,
    },
}

impl Filter {
    /// A radius that is not positive and finite is replaced by ½, a shape without a finite, positive integral (a
    /// Gaussian of zero width, extreme coefficients) by the box of the same radius.
    pub fn new(Settings { shape, radius: [x, y] }: Settings) -> Self {
        let along_x = Axis::new(shape, x);
        let along_y = (y != x).then(|| Axis::new(shape, y));
        let weight = along_x.weight() * along_y.as_ref().unwrap_or(&along_x).weight();
        Self { x: along_x, y: along_y, weight: weight as f32 }
    }

    fn y(&self) -> &Axis {
        self.y.as_ref().unwrap_or(&self.x)
    }

    /// The position of a sample, as an offset in pixels from the centre of the pixel, and the sample's weight.
    ///
    /// `u` is in [0, 1)²; each coordinate of the offset is monotonic in its coordinate of `u`. All weights have the
    /// same magnitude; they are negative where the filter is, and 1 on average.
    #[inline(always)]
    pub fn sample<R: Real>(&self, [u, v]: [R; 2]) -> ([R; 2], R) {
        let ([x, x_sign], [y, y_sign]) = (self.x.sample(u), self.y().sample(v));
        ([x, y], x_sign * y_sign * self.weight)
    }

    /// The value of the filter at an offset in pixels from the centre, per pixel²: its integral over the plane
    /// is 1.
    pub fn evaluate(&self, x: f32, y: f32) -> f32 {
        let integral = self.x.integral * self.y().integral;
        (self.x.value(x) * self.y().value(y) / integral) as f32
    }

    /// The largest distance of samples from the centre of the pixel along x and y, in pixels.
    pub fn radius(&self) -> [f32; 2] {
        [self.x.radius, self.y().radius]
    }
}

impl Axis {
    fn new(shape: Shape, radius: f32) -> Self {
        let given = f64::from(radius);
        let curve = match shape {
            Shape::Box => Curve::Box,
            Shape::Triangle => Curve::Triangle,
            Shape::Gaussian { sigma } => {
                Curve::Gaussian { steepness: square(given) / (2.0 * square(f64::from(sigma))) }
            }
            Shape::Mitchell { b, c } => Curve::Mitchell { b: f64::from(b), c: f64::from(c) },
            Shape::BlackmanHarris => Curve::BlackmanHarris,
            Shape::Sinc { tau } => Curve::Sinc { radius: given, tau: f64::from(tau) },
        };
        let radius = if radius.is_finite() && radius > 0.0 { radius } else { 0.5 };
        let (curve, integral, table) = match curve {
            Curve::Box => (curve, 2.0, None),
            Curve::Triangle => (curve, 1.0, None),
            _ => match Table::new(curve) {
                Some((table, integral)) => (curve, integral, Some(table)),
                None => (Curve::Box, 2.0, None),
            },
        };
        Self { curve, radius, integral: f64::from(radius) * integral, table }
    }

    /// ∫|f| / ∫f.
    fn weight(&self) -> f64 {
        self.table.as_ref().map_or(1.0, |table| table.weight)
    }

    /// The offset that a number in [0, 1) chooses, and the sign of the filter there.
    #[inline(always)]
    fn sample<R: Real>(&self, u: R) -> [R; 2] {
        // Choose a side, and the distance on it.
        let one = u.like(1.0);
        let outward = Float::min(Float::abs(u * 2.0 - one), u.like(ONE_MINUS_EPSILON));
        let side = R::select(u.lt(u.like(0.5)), u.like(-self.radius), u.like(self.radius));
        let (distance, sign) = match (&self.table, self.curve) {
            (Some(table), _) => {
                let signed = outward.map(|share| table.invert(share));
                (Float::abs(signed), one.copysign(signed))
            }
            (None, Curve::Triangle) => (one - Float::sqrt(one - outward), one),
            (None, _) => (outward, one),
        };
        [side * distance, sign]
    }

    /// The value of the curve at an offset in pixels.
    fn value(&self, x: f32) -> f64 {
        let x = (f64::from(x) / f64::from(self.radius)).abs();
        if x <= 1.0 { self.curve.value(x) } else { 0.0 }
    }
}

impl Table {
    /// The table of a curve, and ∫f over −1 … 1. `None` if it has no finite, positive integral.
    fn new(curve: Curve) -> Option<(Self, f64)> {
        // Integrate each cell by Simpson's rule on 8 pieces.
        let cells: Vec<f64> = (0..CELLS).map(|cell| integrate(curve, cell)).collect();
        let total: f64 = cells.iter().sum();
        let absolute: f64 = cells.iter().map(|cell| cell.abs()).sum();
        let weight = absolute / total;
        if !(total.is_finite() && absolute.is_finite() && total > 0.0 && (square(weight) as f32).is_finite())
        {
            return None;
        }
        // Accumulate the fractions; the end is 1, whatever the rounding.
        let mut sum = 0.0;
        let mut cumulative = vec![0.0];
        for cell in &cells {
            sum += cell.abs();
            cumulative.push((sum / absolute).min(1.0) as f32);
        }
        cumulative[CELLS] = 1.0;
        let negative = cells.iter().map(|&cell| cell < 0.0).collect();
        let first = |part: usize| {
            let share = part as f32 / PARTS as f32;
            cumulative[1..].partition_point(|&end| end <= share).min(CELLS - 1) as u16
        };
        let first = (0..PARTS).map(first).collect();
        Some((Self { cumulative, first, negative, weight }, 2.0 * total))
    }

    /// The distance (0 … 1) that encloses the fraction `share` of |f|, with the sign of f there. `share` is in
    /// [0, 1).
    fn invert(&self, share: f32) -> f32 {
        // Find the last cell that begins at or before it: one of positive width in the table.
        let mut cell = usize::from(self.first[(share * PARTS as f32) as usize]);
        // Two steps without a branch, which could not be predicted; further ones are rare. The last cell ends at 1.
        cell += usize::from(self.cumulative[cell + 1] <= share);
        cell += usize::from(self.cumulative[cell + 1] <= share);
        while self.cumulative[cell + 1] <= share {
            cell += 1;
        }
        let (start, end) = (self.cumulative[cell], self.cumulative[cell + 1]);
        let place = (cell as f32 + (share - start) / (end - start)) / CELLS as f32;
        if self.negative[cell] { -place } else { place }
    }
}

fn square(x: f64) -> f64 {
    x * x
}

/// ∫f over one cell of the table.
fn integrate(curve: Curve, cell: usize) -> f64 {
    const PIECES: usize = 8;
    let width = 1.0 / (CELLS * PIECES) as f64;
    let at =
        |half_pieces: usize| curve.value((cell * PIECES) as f64 * width + half_pieces as f64 * (0.5 * width));
    let pieces = (0..PIECES).map(|i| at(2 * i) + 4.0 * at(2 * i + 1) + at(2 * i + 2));
    pieces.sum::<f64>() * width / 6.0
}

impl Curve {
    /// The value at 0 ≤ x ≤ 1.
    fn value(self, x: f64) -> f64 {
        match self {
            Self::Box => 1.0,
            Self::Triangle => 1.0 - x,
            // exp(−s x²) − exp(−s), without the cancellation.
            Self::Gaussian { steepness } => {
                -libm::exp(-steepness * x * x) * libm::expm1(-steepness * (1.0 - x * x))
            }
            Self::Mitchell { b, c } => {
                // The cubic is defined for a radius of 2.
                let x = 2.0 * x;
                let sixfold = if x <= 1.0 {
                    ((12.0 - 9.0 * b - 6.0 * c) * x + (-18.0 + 12.0 * b + 6.0 * c)) * x * x + (6.0 - 2.0 * b)
                } else {
                    (((-b - 6.0 * c) * x + (6.0 * b + 30.0 * c)) * x + (-12.0 * b - 48.0 * c)) * x
                        + (8.0 * b + 24.0 * c)
                };
                sixfold / 6.0
            }
            Self::BlackmanHarris => {
                let angle = std::f64::consts::PI * x;
                0.35875
                    + 0.48829 * libm::cos(angle)
                    + 0.14128 * libm::cos(2.0 * angle)
                    + 0.01168 * libm::cos(3.0 * angle)
            }
            Self::Sinc { radius, tau } => sinc(radius * x) * sinc(radius * x / tau),
        }
    }
}

/// sin(πx) / (πx).
fn sinc(x: f64) -> f64 {
    let angle = std::f64::consts::PI * x;
    if angle.abs() < 1e-8 { 1.0 } else { libm::sin(angle) / angle }
}

#[cfg(test)]
mod tests;
