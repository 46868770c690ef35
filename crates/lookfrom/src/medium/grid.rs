//! Values of grids between the centres of their cells.

use std::ops::{Add, Mul};
use std::sync::Arc;

use glam::Vec3;
use lookfrom_scene::grid::{Grid, Placed};
use lookfrom_simd::{Float, Real};

use crate::core::color::{Sigmoid, Unbounded};
use crate::core::lanes::width::Width;
use crate::core::lanes::{Columns, store};
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
    pub(super) fn numbers_at<W: Width>(&self, width: W, points: Vector<W::Real>) -> W::Real {
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
        lambda: &Spectrum<W::Real>,
    ) -> Spectrum<W::Real> {
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
                |lane| {
                    let Unbounded { scale, sigmoid: Sigmoid([a, b, c]) } = values[places[lane][corner]];
                    Spectrum([a, b, c, scale])
                },
            );
            spectra += Sigmoid([a, b, c]).at(&lambda.0) * (scale * weight);
        }
        spectra
    }
}

/// The cell of a lane.
#[inline(always)]
fn cell(columns: &Columns<3>, lane: usize) -> [i32; 3] {
    let [x, y, z] = columns;
    [x[lane] as i32, y[lane] as i32, z[lane] as i32]
}

impl<R: Real> Between<R> {
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

/// The value between two, at t from 0 to 1.
#[inline(always)]
fn mix<R: Real, V: Add<Output = V> + Mul<R, Output = V>>(a: V, b: V, t: R) -> V {
    a * (-t + 1.0) + b * t
}
