//! Values of grids between the centres of their cells.

use std::ops::{Add, Mul};
use std::sync::Arc;

use glam::Vec3;
use lookfrom_scene::grid::{Grid, Placed};
use lookfrom_simd::{Bits, Float, Real};

use crate::core::color::{Sigmoid, Unbounded};
use crate::core::hash;
use crate::core::lanes::width::{Bits64, Width};
use crate::core::lanes::{Columns, LANES, store};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;

/// A grid, and where its cells are in medium space.
#[derive(Clone, Debug)]
pub(super) struct PlacedGrid<T> {
    pub(super) grid: Arc<Grid<T>>,
    /// Coordinates of cells, whose centres are whole, are those in medium space times a scale plus an offset.
    scale: Vec3,
    offset: Vec3,
}

/// Filter of a grid's values between the centres of its cells.
#[derive(Clone, Copy, Debug)]
pub(super) enum Lookup<W: Width> {
    /// Trilinear between eight centres.
    Interpolated,
    /// That of one of the eight, chosen by these random bits with its trilinear weight, for estimates that are linear in it: they have the
    /// same mean (stochastic filtering, Hofmann & Evans 2021).
    OneCell(Bits64<W>),
}

/// Salt of the random bits that choose cells.
const CHOICE: u64 = 0x6365_6c6c;

/// Salt of a second, independent choice.
const ANOTHER: u64 = 0x7365_636f_6e64;

impl<W: Width> Lookup<W> {
    /// A look-up at the same place, by a choice that does not depend on this one.
    #[inline(always)]
    pub(super) fn another(self) -> Self {
        match self {
            Self::Interpolated => self,
            Self::OneCell(bits) => Self::OneCell(bits ^ bits.like(ANOTHER)),
        }
    }
}

/// A point between eight centres of cells.
#[derive(Clone, Copy, Debug)]
struct Between<R> {
    /// Coordinates of the centre with the least ones, which are whole.
    first: Vector<R>,
    /// Coordinates of the point from there, in [0, 1].
    fraction: Vector<R>,
}

impl<T: Copy + Default + PartialEq> PlacedGrid<T> {
    pub(super) fn new(placed: &Placed<T>) -> Self {
        let [low, high] = placed.bounds;
        // A box without a width has no inside.
        let width = (high - low).max(Vec3::splat(f32::MIN_POSITIVE));
        let scale = Vec3::from_array(placed.grid.size().map(|cells| cells as f32)) / width;
        Self { grid: placed.grid.clone(), scale, offset: -low * scale - 0.5 }
    }

    /// The grid of other values; zero must become zero.
    pub(super) fn map<U>(&self, of: impl Fn(T) -> U) -> PlacedGrid<U> {
        PlacedGrid { grid: Arc::new(self.grid.map(of)), scale: self.scale, offset: self.offset }
    }

    /// Coordinates in medium space along an axis, from those of cells.
    pub(super) fn of_cell(&self, axis: usize, cell: f32) -> f32 {
        (cell - self.offset[axis]) / self.scale[axis]
    }

    /// The centres around a point of medium space.
    #[inline(always)]
    fn between<R: Real>(&self, point: Vector<R>) -> Between<R> {
        let like = |v: Vec3| Vector::splat(point.x, v.to_array());
        let cells = point.times(like(self.scale)) + like(self.offset);
        let first = Vector { x: cells.x.floor(), y: cells.y.floor(), z: cells.z.floor() };
        Between { first, fraction: cells - first }
    }

    /// The values of cells that random bits choose, as [`Lookup::OneCell`].
    #[inline(always)]
    pub(super) fn chosen<W: Width>(&self, width: W, points: Vector<W::Real>, bits: Bits64<W>) -> [T; LANES] {
        let cells = store(self.between(points).one(bits));
        width.by_lane(
            #[inline(always)]
            |lane| self.grid.value(cell(&cells, lane)),
        )
    }

    /// The value at a point of medium space: trilinear between centres, zero outside of the grid.
    #[inline]
    pub(super) fn at<V: Copy + Add<Output = V> + Mul<f32, Output = V>>(
        &self,
        point: Vec3,
        value: impl Fn(T) -> V,
    ) -> V {
        let between = self.between(Vector::from(point.to_array()));
        let first: [f32; 3] = between.first.into();
        between.interpolate(self.grid.corners(first.map(|coordinate| coordinate as i32)).map(value))
    }
}

impl PlacedGrid<f32> {
    /// The values at points of medium space.
    #[inline(always)]
    pub(super) fn numbers_at<W: Width>(
        &self,
        width: W,
        points: Vector<W::Real>,
        lookup: Lookup<W>,
    ) -> W::Real {
        if let Lookup::OneCell(bits) = lookup {
            return width.load_f32(&self.chosen(width, points, bits));
        }
        let between = self.between(points);
        let first = store(between.first);
        let corners = width.by_lane(
            #[inline(always)]
            |lane| self.grid.corners(cell(&first, lane)),
        );
        between.interpolate(width.eights(&corners))
    }
}

impl PlacedGrid<Unbounded> {
    /// The spectra at points of medium space, at wavelengths in nm.
    #[inline(always)]
    pub(super) fn spectra_at<W: Width>(
        &self,
        width: W,
        points: Vector<W::Real>,
        lookup: Lookup<W>,
        lambda: &Spectrum<W::Real>,
    ) -> Spectrum<W::Real> {
        if let Lookup::OneCell(bits) = lookup {
            let values = self.chosen(width, points, bits);
            let Spectrum([a, b, c, scale]) = width.spectra_of(
                #[inline(always)]
                |lane| coefficients(values[lane]),
            );
            return Sigmoid([a, b, c]).at(&lambda.0) * scale;
        }
        let between = self.between(points);
        let first = store(between.first);
        let places = width.by_lane(
            #[inline(always)]
            |lane| self.grid.places_of_corners(cell(&first, lane)),
        );
        let values = self.grid.values();
        let mut spectra = Spectrum::splat(points.x.like(0.0));
        for (corner, weight) in between.weights().into_iter().enumerate() {
            let Spectrum([a, b, c, scale]) = width.spectra_of(
                #[inline(always)]
                |lane| coefficients(values[places[lane][corner]]),
            );
            spectra += Sigmoid([a, b, c]).at(&lambda.0) * (scale * weight);
        }
        spectra
    }
}

/// The coefficients of a spectrum, and its scale.
#[inline(always)]
fn coefficients(Unbounded { scale, sigmoid: Sigmoid([a, b, c]) }: Unbounded) -> Spectrum {
    Spectrum([a, b, c, scale])
}

/// The cell of a lane.
#[inline(always)]
fn cell(columns: &Columns<3>, lane: usize) -> [i32; 3] {
    let [x, y, z] = columns;
    [x[lane] as i32, y[lane] as i32, z[lane] as i32]
}

impl<R: Real> Between<R> {
    /// The centre that random bits choose with its weight.
    #[inline(always)]
    fn one(&self, bits: R::Bits64) -> Vector<R> {
        let bits = hash::mix(bits ^ bits.like(CHOICE));
        let Self { first, fraction } = *self;
        Vector {
            x: one_of_two(first.x, fraction.x, bits),
            y: one_of_two(first.y, fraction.y, bits >> 21),
            z: one_of_two(first.z, fraction.z, bits >> 42),
        }
    }

    /// The weights of the eight centres, x fastest.
    #[inline(always)]
    fn weights(&self) -> [R; 8] {
        let Vector { x, y, z } = self.fraction;
        let [x, y, z] = [[-x + 1.0, x], [-y + 1.0, y], [-z + 1.0, z]];
        let [a, b, c, d] = [x[0] * y[0], x[1] * y[0], x[0] * y[1], x[1] * y[1]];
        [a * z[0], b * z[0], c * z[0], d * z[0], a * z[1], b * z[1], c * z[1], d * z[1]]
    }

    /// Interpolates between the values at the eight centres, x fastest.
    #[inline(always)]
    fn interpolate<V: Copy + Add<Output = V> + Mul<R, Output = V>>(
        &self,
        [a, b, c, d, e, f, g, h]: [V; 8],
    ) -> V {
        let Vector { x, y, z } = self.fraction;
        let low = mix(mix(a, b, x), mix(c, d, x), y);
        let high = mix(mix(e, f, x), mix(g, h, x), y);
        mix(low, high, z)
    }
}

/// A coordinate or the next one, by the lower 21 of some random bits.
#[inline(always)]
fn one_of_two<R: Real>(first: R, fraction: R, bits: R::Bits64) -> R {
    let u = R::from_integer(R::low_half(bits & bits.like(0x1f_ffff))) * (1.0 / 2_097_152.0);
    R::select(u.lt(fraction), first + 1.0, first)
}

/// The value between two, at t from 0 to 1.
#[inline(always)]
fn mix<R: Real, V: Add<Output = V> + Mul<R, Output = V>>(a: V, b: V, t: R) -> V {
    a * (-t + 1.0) + b * t
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::lanes::width::One;

    #[test]
    fn cells_are_chosen_by_their_trilinear_weights() {
        let number = |place: u64| (hash::mix(place + 1) >> 40) as f32 / 16_777_216.0;
        let values: Vec<f32> = (0..60).map(number).collect();
        let grid = Arc::new(Grid::from_values([3, 4, 5], &values).expect("a grid"));
        let placed = PlacedGrid::new(&Placed { grid, bounds: [Vec3::ZERO, Vec3::new(3.0, 4.0, 5.0)] });
        for place in 0..20 {
            let point = Vec3::from_array([60, 61, 62].map(|axis| 3.0 * number(3 * place + axis)));
            let expected = placed.numbers_at(One, point.into(), Lookup::Interpolated);
            const COUNT: u64 = 40_000;
            let chosen = |bits: u64| f64::from(placed.numbers_at(One, point.into(), Lookup::OneCell(bits)));
            let sum: f64 = (0..COUNT).map(|k| chosen(hash::mix(k))).sum();
            // Five standard errors of values whose spread is at most a half.
            assert!((sum / COUNT as f64 - f64::from(expected)).abs() < 0.0125, "{point}: {expected}");
        }
    }
}
