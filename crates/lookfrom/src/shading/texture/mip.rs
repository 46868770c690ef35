//! Look-ups in MIP maps (Williams 1983), by the footprint of pixels: point, bilinear, trilinear and elliptical weighted averages.
//!
//! As pbrt-v4's `MIPMap::Filter` (Pharr, Jakob & Humphreys 2023, § 10.4.3), but in texels of the image, whose size need not be a power of
//! two nor a square, with steps that run down as its rows do, and with levels that are blended from the finest on. Elliptical weighted
//! averages are Heckbert's (1989, "Fundamentals of Texture Mapping and Image Warping").

use std::sync::LazyLock;

use glam::Vec2;
use lookfrom_scene::image::Image;
use lookfrom_scene::texture::{MipFilter, TexelFilter, Wrap};

use super::picture::{Footprint, wrapped};

/// An image with the coarser levels of its MIP map.
#[derive(Clone, Copy, Debug)]
pub(super) struct MipMap<'a> {
    pub(super) image: &'a Image,
    pub(super) coarser: &'a [Image],
}

/// The levels that a look-up blends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Levels {
    /// The finer one.
    pub(super) fine: usize,
    /// The weight of the next one: 0 to 1.
    pub(super) coarse: f32,
}

impl Levels {
    /// The finest level alone.
    pub(super) const FINEST: Self = Self { fine: 0, coarse: 0.0 };
}

impl<'a> MipMap<'a> {
    /// The image of a level; 0 is the finest.
    #[inline]
    pub(super) fn level(&self, level: usize) -> &'a Image {
        level.checked_sub(1).map_or(self.image, |coarser| &self.coarser[coarser.min(self.coarser.len() - 1)])
    }

    /// The colour and opacity at `(s, t)`, with `t` down, averaged over steps from one pixel to the next, of the same coordinates.
    pub(super) fn look_up(
        &self,
        st: [f32; 2],
        steps: [Vec2; 2],
        filter: MipFilter,
        wraps: [Wrap; 2],
    ) -> [f32; 4] {
        let size = Vec2::new(self.image.width as f32, self.image.height as f32);
        let steps = steps.map(|step| step * size);
        let bilinear = |level: usize| {
            Footprint::new(self.level(level), st, wraps, TexelFilter::Bilinear).blend(self.level(level))
        };
        match filter {
            MipFilter::Nearest => {
                let image = self.level(self.levels_of(steps).fine);
                Footprint::new(image, st, wraps, TexelFilter::Nearest).blend(image)
            }
            MipFilter::Bilinear => bilinear(self.levels_of(steps).fine),
            MipFilter::Trilinear => self.levels_of(steps).blend(bilinear),
            MipFilter::Ewa { anisotropy } => match Axes::new(steps, anisotropy) {
                Some(axes) => {
                    let levels = self.at(axes.shorter);
                    levels.blend(|level| self.ellipse(level, st, &axes, wraps))
                }
                None => bilinear(0),
            },
        }
    }

    /// The levels that are blended bilinearly, by steps as of [`MipMap::look_up`]; `None` for an ellipse that is not.
    #[inline]
    pub(super) fn levels(&self, steps: [Vec2; 2], filter: MipFilter) -> Option<Levels> {
        let size = Vec2::new(self.image.width as f32, self.image.height as f32);
        let steps = steps.map(|step| step * size);
        match filter {
            MipFilter::Nearest | MipFilter::Bilinear => Some(Levels { coarse: 0.0, ..self.levels_of(steps) }),
            MipFilter::Trilinear => Some(self.levels_of(steps)),
            MipFilter::Ewa { anisotropy } => Axes::new(steps, anisotropy).is_none().then_some(Levels::FINEST),
        }
    }

    /// The levels for steps in texels: those whose texels are as wide as twice the longest step.
    #[inline]
    fn levels_of(&self, [x, y]: [Vec2; 2]) -> Levels {
        self.at(2.0 * x.abs().max(y.abs()).max_element())
    }

    /// The levels whose texels are this wide, in texels of the image.
    #[inline]
    fn at(&self, width: f32) -> Levels {
        // The sharpest, without a logarithm, and for NaN.
        if !(width > 1.0) || self.coarser.is_empty() {
            return Levels::FINEST;
        }
        let (level, last) = (libm::log2f(width), self.coarser.len());
        if level >= last as f32 {
            return Levels { fine: last, coarse: 0.0 };
        }
        let fine = level as usize;
        Levels { fine, coarse: level - fine as f32 }
    }

    /// The average over an ellipse in a level.
    fn ellipse(&self, level: usize, [s, t]: [f32; 2], axes: &Axes, wraps: [Wrap; 2]) -> [f32; 4] {
        let image = self.level(level);
        let size = [image.width as f32, image.height as f32];
        // Along an axis with one texel all texels are the same.
        let scale = |level: u32, finest: u32| if level > 1 { level as f32 / finest as f32 } else { 0.0 };
        let scale = Vec2::new(scale(image.width, self.image.width), scale(image.height, self.image.height));
        let ([x, y], [long, short]) =
            ([s * size[0] - 0.5, t * size[1] - 0.5], axes.axes.map(|axis| axis * scale));
        // The ellipse a x² + b x y + c y² = 1 about (x, y), a texel wider than its axes.
        let a = long.y * long.y + short.y * short.y + 1.0;
        let b = -2.0 * (long.x * long.y + short.x * short.y);
        let c = long.x * long.x + short.x * short.x + 1.0;
        let norm = 1.0 / (a * c - 0.25 * b * b);
        let reach = a.sqrt();
        let [a, b, c] = [a, b, c].map(|k| k * norm);
        let range = |center: f32, reach: f32| {
            let bounded = |edge: f32| edge.clamp(-FARTHEST, FARTHEST);
            (bounded((center - reach).ceil()) as i32, bounded((center + reach).floor()) as i32)
        };
        let weights = &*WEIGHTS;
        let weight_at = |dx: f32, dy: f32| {
            let r2 = a * dx * dx + b * dx * dy + c * dy * dy;
            weights.get((r2.max(0.0) * STEPS as f32) as usize).copied().unwrap_or(0.0)
        };
        let (mut sum, mut sum_of_weights) = ([0.0; 4], 0.0);
        let rows = range(y, reach);
        for row in rows.0..=rows.1 {
            let dy = row as f32 - y;
            // The columns where a dx² + b dx dy + c dy² < 1.
            let root = (b * b * dy * dy - 4.0 * a * (c * dy * dy - 1.0)).max(0.0).sqrt();
            let columns = range(x - 0.5 * b * dy / a, 0.5 * root / a);
            let Some(first) =
                wrapped(row, image.height, wraps[1]).map(|row| row as usize * image.width as usize)
            else {
                sum_of_weights +=
                    (columns.0..=columns.1).map(|column| weight_at(column as f32 - x, dy)).sum::<f32>();
                continue;
            };
            for column in columns.0..=columns.1 {
                let weight = weight_at(column as f32 - x, dy);
                sum_of_weights += weight;
                if let Some(column) = wrapped(column, image.width, wraps[0]) {
                    let texel = image.rgba(first + column as usize);
                    sum = std::array::from_fn(|k| sum[k] + weight * texel[k]);
                }
            }
        }
        match sum_of_weights > 0.0 {
            true => sum.map(|sum| sum / sum_of_weights),
            // Coordinates so large that they have lost their fraction.
            false => Footprint::new(image, [s, t], wraps, TexelFilter::Bilinear).blend(image),
        }
    }
}

impl Levels {
    /// Values of the two levels, interpolated; the coarser is not asked for where it has no weight.
    #[inline]
    fn blend(self, value: impl Fn(usize) -> [f32; 4]) -> [f32; 4] {
        let fine = value(self.fine);
        match self.coarse > 0.0 {
            true => self.mixed(fine, value(self.fine + 1)),
            false => fine,
        }
    }

    /// Linear interpolation.
    #[inline]
    pub(super) fn mixed(self, fine: [f32; 4], coarse: [f32; 4]) -> [f32; 4] {
        std::array::from_fn(|k| fine[k] * (1.0 - self.coarse) + coarse[k] * self.coarse)
    }
}

/// An ellipse whose longer axis is shorter than this, in texels of the image, is as wide as bilinear interpolation is.
const SHORT: f32 = 0.5;

/// The axes of an ellipse, in texels of the image, the longer one first.
struct Axes {
    axes: [Vec2; 2],
    shorter: f32,
}

impl Axes {
    /// The shorter one is made longer where the other is more than `anisotropy` times as long; `None` where it has no length, and where
    /// both are short.
    fn new([x, y]: [Vec2; 2], anisotropy: f32) -> Option<Self> {
        let [long, short] = if x.length_squared() < y.length_squared() { [y, x] } else { [x, y] };
        let [longer, shorter] = [long, short].map(Vec2::length);
        if !(shorter > 0.0 && longer > SHORT && longer.is_finite()) {
            return None;
        }
        let stretch = (longer / (shorter * anisotropy)).max(1.0);
        Some(Self { axes: [long, short * stretch], shorter: shorter * stretch })
    }
}

/// Texels farther than this away have lost their fraction.
const FARTHEST: f32 = 1_073_741_824.0;

/// Number of steps of the weights' table.
const STEPS: usize = 128;

/// Weights of texels in an ellipse, by the square of their distance from its centre: a Gaussian that ends at 1.
static WEIGHTS: LazyLock<[f32; STEPS]> = LazyLock::new(|| {
    std::array::from_fn(|k| {
        let r2 = k as f32 / (STEPS - 1) as f32;
        libm::expf(-2.0 * r2) - libm::expf(-2.0)
    })
});

#[cfg(test)]
mod tests;
