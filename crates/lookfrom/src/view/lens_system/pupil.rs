//! Bounds of the exit pupil: the part of the plane through the rear vertex that light to a point of the film passes.
//!
//! They depend on the distance from the axis, in 64 intervals, for film points on the x axis; others turn them. Pharr, Jakob,
//! Humphreys (2023), 5.4.5, take the extent of a million random points in each interval. Here grids are refined at the ends of the
//! intervals: one over the rear surface, one over what passed, and one over each side of that, with a margin of its cells.

use lookfrom_scene::lens::LensConvention;
use lookfrom_simd::{Kernel, Real, Simd, dispatch, f32x8, f64x8, level, prelude::*};

use super::LensSystem;
use crate::core::lanes::{LANES, by_lane};

/// Number of intervals of the distance from the axis.
pub(super) const INTERVALS: usize = 64;

/// Half the side of the square that is searched, in radii of the rear surface: rays to a curved surface cross the plane outside of it.
const SEARCHED: f64 = 1.5;

/// Cells along each side of a grid: of the first ones, of finer ones where nothing passes those, and along and across the sides.
const GRID: usize = 32;
const FINE_GRID: usize = 256;
const FINEST_GRID: usize = 1024;
const ALONG: usize = 64;
const ACROSS: usize = 16;
/// The factor by which grids are finer for a stop that is no circle, and may have narrow points.
const DETAIL: usize = 4;
/// Cells by which bounds may be wrong: the points of a circle's pupil, where two arcs meet, are blunt, those of a star are not.
const MARGIN: f64 = 1.0;
const MARGIN_OF_SHAPES: f64 = 2.0;

/// The margin of pbrt's bounds, in diagonals of its searched square.
const PBRT_MARGIN: f64 = 2.0 / 1024.0;

/// Left, right, bottom and top.
type Rectangle = [f64; 4];

/// Bounds by interval, with the area 0 where no light passes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct ExitPupil(Vec<[f32; 4]>);

impl ExitPupil {
    /// The bounds of a system.
    pub(super) fn of(system: &LensSystem, convention: LensConvention) -> Self {
        // Film points all around the axis see a shape turned: without the bias of pbrt's convention the circle around it counts.
        let around = (convention == LensConvention::AsPinhole && system.aperture.is_some())
            .then(|| LensSystem { aperture: None, ..system.clone() });
        let system = around.as_ref().unwrap_or(system);
        let step = system.film_radius / INTERVALS as f64;
        let mut ends: Vec<Option<Rectangle>> = Vec::with_capacity(INTERVALS + 1);
        for end in 0..=INTERVALS {
            let nearer = ends.last().copied();
            ends.push(dispatch(level(), Search { system, distance: end as f64 * step, nearer }));
        }
        let margin = match convention {
            LensConvention::Pbrt => {
                PBRT_MARGIN * 2.0 * SEARCHED * std::f64::consts::SQRT_2 * system.rear_radius
            }
            LensConvention::AsPinhole => 0.0,
        };
        let of_both = |ends: &[Option<Rectangle>]| {
            let both = ends.iter().flatten().copied().reduce(union);
            both.map_or([0.0; 4], |both| grown(both, [margin; 2]).map(|side| side as f32))
        };
        Self(ends.windows(2).map(of_both).collect())
    }

    /// The bounds of an interval; beyond the film's corners those of the last one.
    #[inline(always)]
    pub(super) fn bounds(&self, interval: usize) -> [f32; 4] {
        self.0.get(interval).or(self.0.last()).copied().unwrap_or_default()
    }
}

/// The irradiance of the film's middle for a radiance of 1, in steradians: ∫ cos⁴ θ dA / z² over the pupil.
pub(super) fn irradiance(system: &LensSystem) -> f64 {
    let [left, right, bottom, top] = system.pupil.bounds(0).map(f64::from);
    let cell = [(right - left) / FINE_GRID as f64, (top - bottom) / FINE_GRID as f64];
    let mut sum = 0.0;
    for row in 0..FINE_GRID {
        for column in 0..FINE_GRID {
            let on_rear = [left + (column as f64 + 0.5) * cell[0], bottom + (row as f64 + 0.5) * cell[1]];
            let (ray, cosine) = system.toward([0.0; 2], on_rear);
            let ray = system.crossed(ray);
            if ray.passes {
                let cosine_squared: f64 = cosine * cosine;
                sum += cosine_squared * cosine_squared * f64::from(system.transmittance::<f32>(ray.on_stop));
            }
        }
    }
    sum * cell[0] * cell[1] / (system.rear * system.rear)
}

/// The bounds of the exit pupil for the film point at a distance from the axis; `None` if no light passes.
struct Search<'a> {
    system: &'a LensSystem,
    distance: f64,
    /// The bounds for the film point before this one, which is nearer to the axis; `None` for the first one.
    nearer: Option<Option<Rectangle>>,
}

impl Kernel for Search<'_> {
    type Output = Option<Rectangle>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Option<Rectangle> {
        let side = SEARCHED * self.system.rear_radius;
        let whole = [-side, side, -side, side];
        let (detail, margin) = match self.system.aperture {
            Some(_) => (DETAIL, MARGIN_OF_SHAPES),
            None => (1, MARGIN),
        };
        let (grid, along) = (GRID * detail, ALONG * detail);
        let mut coarse = self.passed(simd, whole, [grid; 2], margin);
        if coarse.is_none() {
            coarse = match self.nearer {
                None => self.passed(simd, whole, [FINE_GRID; 2], margin),
                // The pupil moves little from one film point to the next.
                Some(Some(nearer)) => {
                    let size = [nearer[1] - nearer[0], nearer[3] - nearer[2]];
                    self.passed(simd, grown(nearer, size), [FINE_GRID; 2], margin)
                }
                Some(None) => None,
            };
        }
        if coarse.is_none() && self.nearer.is_none() {
            coarse = self.passed(simd, whole, [FINEST_GRID; 2], margin);
        }
        let coarse = coarse?;
        let found = self.passed(simd, coarse, [grid; 2], margin).unwrap_or(coarse);
        // Each side lies within the margins of that grid.
        let [left, right, bottom, top] = found;
        let deep = 2.0 * margin / grid as f64;
        let cell = [deep * (coarse[1] - coarse[0]), deep * (coarse[3] - coarse[2])];
        let sides = [
            ([left, left + cell[0], bottom, top], [ACROSS, along]),
            ([right - cell[0], right, bottom, top], [ACROSS, along]),
            ([left, right, bottom, bottom + cell[1]], [along, ACROSS]),
            ([left, right, top - cell[1], top], [along, ACROSS]),
        ];
        let mut finest: Option<Rectangle> = None;
        for (side, cells) in sides {
            if let Some(passed) = self.passed(simd, side, cells, 1.0) {
                finest = Some(finest.map_or(passed, |finest| union(finest, passed)));
            }
        }
        // Between the places along a side there may be a point.
        let room = 0.5 * margin * margin / along as f64 * (right - left).max(top - bottom);
        finest = finest.map(|finest| grown(finest, [room; 2]));
        finest.or(Some(found))
    }
}

impl Search<'_> {
    /// The bounds of the middles of a grid's cells that light passes, and a margin in cells around them; `None` if it passes none.
    #[inline(always)]
    fn passed<S: Simd>(
        &self,
        simd: S,
        [left, right, bottom, top]: Rectangle,
        cells: [usize; 2],
        margin: f64,
    ) -> Option<Rectangle> {
        let cell = [(right - left) / cells[0] as f64, (top - bottom) / cells[1] as f64];
        let mut bounds: Option<Rectangle> = None;
        let splat = |x: f64| f64x8::splat(simd, x);
        for row in 0..cells[1] {
            let y = bottom + (row as f64 + 0.5) * cell[1];
            for first in (0..cells[0]).step_by(LANES) {
                let columns = by_lane!(lane => left + ((first + lane) as f64 + 0.5) * cell[0]);
                let x = f64x8::load_array(simd, columns);
                let (ray, _) = self.system.toward([splat(self.distance), splat(0.0)], [x, splat(y)]);
                let ray = self.system.crossed(ray);
                let transmittance = self.system.transmittance::<f32x8<S>>(ray.on_stop);
                let passes = f32x8::splat(simd, 0.0).narrow_mask(ray.passes) & transmittance.simd_gt(0.0);
                let passes = passes.to_bitmask();
                for (lane, &x) in columns.iter().enumerate() {
                    if passes >> lane & 1 != 0 {
                        bounds = Some(bounds.map_or([x, x, y, y], |bounds| union(bounds, [x, x, y, y])));
                    }
                }
            }
        }
        bounds.map(|bounds| grown(bounds, cell.map(|size| size * margin)))
    }
}

fn union(a: Rectangle, b: Rectangle) -> Rectangle {
    [a[0].min(b[0]), a[1].max(b[1]), a[2].min(b[2]), a[3].max(b[3])]
}

fn grown([left, right, bottom, top]: Rectangle, [x, y]: [f64; 2]) -> Rectangle {
    [left - x, right + x, bottom - y, top + y]
}
