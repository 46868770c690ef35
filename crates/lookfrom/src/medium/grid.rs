//! Values of grids between the centres of their cells.

use std::ops::{Add, Mul};
use std::sync::Arc;

use glam::Vec3;
use lookfrom_scene::grid::{Grid, Placed};

use crate::core::color::{Sigmoid, Unbounded};
use crate::core::spectrum::Spectrum;

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
struct Between {
    /// Coordinates of the centre with the least ones.
    first: [i32; 3],
    /// Coordinates of the point from there, in [0, 1].
    fraction: Vec3,
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
    #[inline]
    fn between(&self, point: Vec3) -> Between {
        let cells = point * self.scale + self.offset;
        let first = cells.floor();
        Between { first: first.to_array().map(|coordinate| coordinate as i32), fraction: cells - first }
    }

    /// The value at a point of medium space: trilinear between centres, zero outside of the grid.
    #[inline]
    pub(super) fn at<V: Copy + Add<Output = V> + Mul<f32, Output = V>>(
        &self,
        point: Vec3,
        value: impl Fn(T) -> V,
    ) -> V {
        let between = self.between(point);
        between.interpolate(self.grid.corners(between.first).map(value))
    }
}

impl PlacedGrid<Unbounded> {
    /// The spectrum at a point of medium space, at wavelengths in nm: between those at the eight centres, which are evaluated side by side.
    pub(super) fn spectrum_at(&self, point: Vec3, lambda: &[f32; 4]) -> Spectrum {
        let between = self.between(point);
        let corners = self.grid.corners(between.first);
        let weights = between.weights();
        let scale: [f32; 8] = std::array::from_fn(|corner| weights[corner] * corners[corner].scale);
        let coefficients: [[f32; 8]; 3] =
            std::array::from_fn(|k| std::array::from_fn(|corner| corners[corner].sigmoid.0[k]));
        Spectrum(lambda.map(|nm| {
            let values = Sigmoid::values(&coefficients, nm);
            let terms: [f32; 8] = std::array::from_fn(|corner| values[corner] * scale[corner]);
            let four: [f32; 4] = std::array::from_fn(|k| terms[k] + terms[k + 4]);
            (four[0] + four[2]) + (four[1] + four[3])
        }))
    }
}

impl Between {
    /// The weights of the eight centres, x fastest.
    fn weights(&self) -> [f32; 8] {
        let Vec3 { x, y, z } = self.fraction;
        std::array::from_fn(|corner| {
            let part = |t: f32, bit: usize| if corner >> bit & 1 == 1 { t } else { 1.0 - t };
            part(x, 0) * part(y, 1) * part(z, 2)
        })
    }

    /// Interpolates between the values at the eight centres, x fastest.
    #[inline]
    fn interpolate<V: Copy + Add<Output = V> + Mul<f32, Output = V>>(&self, values: [V; 8]) -> V {
        let mix = |a: V, b: V, t: f32| a * (1.0 - t) + b * t;
        let Vec3 { x, y, z } = self.fraction;
        let edge = |index: usize| mix(values[index], values[index + 1], x);
        mix(mix(edge(0), edge(2), y), mix(edge(4), edge(6), y), z)
    }
}
