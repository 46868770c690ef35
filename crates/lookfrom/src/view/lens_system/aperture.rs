//! Shapes of an aperture stop as images: the part of the light that passes each place, with the light of a circle in all.

use std::sync::Arc;

use lookfrom_scene::lens::ApertureShape;
use lookfrom_scene::{Error, Location, Result};

/// Texels along each side of the shapes that have a name.
const SIDE: usize = 256;

/// Transmittances on the square around the stop's circle.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ApertureImage {
    width: usize,
    height: usize,
    /// Row 0 on top.
    texels: Arc<[f32]>,
}

impl ApertureImage {
    /// The image of a shape; `None` for a circle, which needs none.
    ///
    /// # Errors
    /// `Invalid` for an image without light.
    pub(super) fn new(shape: &ApertureShape, at: &Location) -> Result<Option<Self>> {
        let (width, height, texels): (usize, usize, Vec<f32>) = match shape {
            ApertureShape::Circle => return Ok(None),
            ApertureShape::Gaussian => {
                rasterized(|[x, y]| (libm::exp(-(x * x + y * y)) - libm::exp(-1.0)).max(0.0) as f32)
            }
            ApertureShape::Square => rasterized(|[x, y]| f32::from(x.abs() < 0.5 && y.abs() < 0.5)),
            ApertureShape::Pentagon => rasterized(inside(&corners(5, |_| 0.8, 0.25))),
            ApertureShape::Star => {
                let inner = cos_of_turns(0.2) / cos_of_turns(0.1);
                rasterized(inside(&corners(10, |corner| if corner % 2 == 1 { 1.0 } else { inner }, 0.0)))
            }
            ApertureShape::Image(image) => {
                let mean = |index| (image.texel(index).iter().sum::<f32>() / 3.0).max(0.0);
                (image.width as usize, image.height as usize, (0..image.len()).map(mean).collect())
            }
        };
        let sum: f64 = texels.iter().map(|&texel| f64::from(texel)).sum();
        let scale = std::f64::consts::FRAC_PI_4 * texels.len() as f64 / sum;
        if !(scale > 0.0 && scale.is_finite()) {
            let message = format!("the aperture {:?} lets no light through", shape.name());
            return Err(Error::invalid(at, message).hint("it is bright where light passes"));
        }
        let texels = texels.into_iter().map(|texel| (f64::from(texel) * scale) as f32).collect();
        Ok(Some(Self { width, height, texels }))
    }

    /// The transmittance at a point of a stop of this radius: bilinear, and 0 outside of the square.
    pub(super) fn at(&self, [x, y]: [f32; 2], radius: f64) -> f32 {
        let along = |coordinate: f32, count: usize| {
            let place = (0.5 + 0.5 * f64::from(coordinate) / radius) * count as f64 - 0.5;
            // Beyond one texel around the square all is 0; NaN is, too.
            let place = if place.abs() < count as f64 + 1.0 { place } else { -2.0 };
            (place.floor() as i64, (place - place.floor()) as f32)
        };
        let ((column, u), (row, v)) = (along(x, self.width), along(-y, self.height));
        let texel = |column: i64, row: i64| {
            let [column, row] =
                [usize::try_from(column), usize::try_from(row)].map(|place| place.unwrap_or(usize::MAX));
            let is_inside = column < self.width && row < self.height;
            if is_inside { self.texels[row * self.width + column] } else { 0.0 }
        };
        let upper = (1.0 - u) * texel(column, row) + u * texel(column + 1, row);
        let lower = (1.0 - u) * texel(column, row + 1) + u * texel(column + 1, row + 1);
        (1.0 - v) * upper + v * lower
    }

    /// The distance from the middle beyond which nothing passes, in radii of the stop.
    pub(super) fn reach(&self) -> f64 {
        let mut reach = 0.0_f64;
        for (index, &texel) in self.texels.iter().enumerate() {
            if texel > 0.0 {
                // Bilinear interpolation spreads a texel by its own size.
                let side = |place: usize, count: usize| {
                    let middle = 2.0 * (place as f64 + 0.5) / count as f64 - 1.0;
                    middle.abs() + 2.0 / count as f64
                };
                let [x, y] = [side(index % self.width, self.width), side(index / self.width, self.height)];
                reach = reach.max((x * x + y * y).sqrt());
            }
        }
        reach
    }
}

/// A shape on the square [−1, 1]², y *down*.
fn rasterized(shape: impl Fn([f64; 2]) -> f32) -> (usize, usize, Vec<f32>) {
    let middle = |place: usize| 2.0 * (place as f64 + 0.5) / SIDE as f64 - 1.0;
    let texel = |index: usize| shape([middle(index % SIDE), middle(index / SIDE)]);
    (SIDE, SIDE, (0..SIDE * SIDE).map(texel).collect())
}

/// Corners of a polygon around the middle, the first at an angle from x toward y, in turns.
fn corners(count: u32, radius: impl Fn(u32) -> f64, first: f64) -> Vec<[f64; 2]> {
    let corner = |number: u32| {
        let turns = first + f64::from(number) / f64::from(count);
        [radius(number) * cos_of_turns(turns), radius(number) * cos_of_turns(turns - 0.25)]
    };
    (0..count).map(corner).collect()
}

fn cos_of_turns(turns: f64) -> f64 {
    libm::cos(std::f64::consts::TAU * turns)
}

/// Whether a point is inside of a polygon: a line from it crosses an odd number of sides.
fn inside(corners: &[[f64; 2]]) -> impl Fn([f64; 2]) -> f32 {
    move |[x, y]| {
        let sides = corners.iter().zip(corners.iter().cycle().skip(1));
        let is_crossed = |&([x0, y0], [x1, y1]): &(&[f64; 2], &[f64; 2])| {
            (*y0 <= y) != (*y1 <= y) && x < x0 + (y - y0) / (y1 - y0) * (x1 - x0)
        };
        f32::from(sides.filter(is_crossed).count() % 2 == 1)
    }
}
