//! Arrays of numpy as the crate reads them: three numbers a row, in either precision, with any strides and without a copy.

use numpy::ndarray::Dimension;
use numpy::ndarray::{ArrayView1, ArrayView2};
use numpy::{Element, PyArray, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::{PyMemoryError, PyTypeError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

/// Points or directions as Python passes them: shape (n, 3), float32 or float64.
#[derive(FromPyObject)]
pub(crate) enum Vectors<'py> {
    #[pyo3(transparent)]
    Double(PyReadonlyArray2<'py, f64>),
    #[pyo3(transparent)]
    Single(PyReadonlyArray2<'py, f32>),
}

/// Rows of numbers, seen without the GIL.
#[derive(Clone, Copy)]
pub(crate) enum Rows<'a> {
    Double(ArrayView2<'a, f64>),
    Single(ArrayView2<'a, f32>),
}

impl Vectors<'_> {
    /// The rows of an array with three columns.
    pub(crate) fn rows(&self) -> PyResult<Rows<'_>> {
        let rows = match self {
            Self::Double(array) => Rows::Double(array.as_array()),
            Self::Single(array) => Rows::Single(array.as_array()),
        };
        let columns = match rows {
            Rows::Double(view) => view.ncols(),
            Rows::Single(view) => view.ncols(),
        };
        match columns {
            3 => Ok(rows),
            _ => Err(PyTypeError::new_err(format!("an array has {columns} columns instead of 3"))),
        }
    }
}

impl Rows<'_> {
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Double(view) => view.nrows(),
            Self::Single(view) => view.nrows(),
        }
    }

    #[inline]
    pub(crate) fn row(&self, number: usize) -> [f64; 3] {
        match self {
            Self::Double(view) => [0, 1, 2].map(|axis| view[[number, axis]]),
            Self::Single(view) => [0, 1, 2].map(|axis| f64::from(view[[number, axis]])),
        }
    }

    /// Replaces the content of `out` by the rows at some places after `first`.
    pub(crate) fn pick(&self, first: usize, places: &[u32], out: &mut Vec<[f64; 3]>) {
        out.clear();
        match self {
            Self::Double(view) => pick(view, first, places, |x| x, out),
            Self::Single(view) => pick(view, first, places, f64::from, out),
        }
    }

    /// Replaces the content of `out` by `count` rows from `first` on.
    pub(crate) fn read(&self, first: usize, count: usize, out: &mut Vec<[f64; 3]>) {
        out.clear();
        match self {
            Self::Double(view) => read(view, first, count, |x| x, out),
            Self::Single(view) => read(view, first, count, f64::from, out),
        }
    }

    /// All rows.
    ///
    /// # Errors
    /// Too many for the memory.
    pub(crate) fn to_vec(self) -> PyResult<Vec<[f64; 3]>> {
        let mut all = Vec::new();
        all.try_reserve_exact(self.len()).map_err(|error| PyMemoryError::new_err(error.to_string()))?;
        self.read(0, self.len(), &mut all);
        Ok(all)
    }
}

fn pick<T: Copy>(
    view: &ArrayView2<'_, T>,
    first: usize,
    places: &[u32],
    widen: impl Fn(T) -> f64,
    out: &mut Vec<[f64; 3]>,
) {
    let numbers = places.iter().map(|&place| first + place as usize);
    if let Some(flat) = view.as_slice() {
        let (rows, _) = flat.as_chunks::<3>();
        out.extend(numbers.map(|number| rows[number].map(&widen)));
    } else {
        out.extend(numbers.map(|number| [0, 1, 2].map(|axis| widen(view[[number, axis]]))));
    }
}

fn read<T: Copy>(
    view: &ArrayView2<'_, T>,
    first: usize,
    count: usize,
    widen: impl Fn(T) -> f64,
    out: &mut Vec<[f64; 3]>,
) {
    if let Some(flat) = view.as_slice() {
        let (rows, _) = flat[3 * first..3 * (first + count)].as_chunks::<3>();
        out.extend(rows.iter().map(|row| row.map(&widen)));
    } else {
        out.extend((first..first + count).map(|row| [0, 1, 2].map(|axis| widen(view[[row, axis]]))));
    }
}

/// One number a ray, often the same for all: a broadcast array.
pub(crate) type Numbers<'py> = PyReadonlyArray1<'py, f64>;

/// Fails unless there are as many numbers as rays.
pub(crate) fn numbers<'a>(array: &'a Numbers<'_>, rays: usize) -> PyResult<ArrayView1<'a, f64>> {
    let view = array.as_array();
    if view.len() == rays {
        Ok(view)
    } else {
        Err(PyTypeError::new_err(format!("{} numbers for {rays} rays", view.len())))
    }
}

/// A new array of zeros.
///
/// # Errors
/// Too many for the memory.
pub(crate) fn zeros<'py, T: Element, D: Dimension, const N: usize>(
    py: Python<'py>,
    shape: [usize; N],
) -> PyResult<Bound<'py, PyArray<T, D>>> {
    let shape = PyTuple::new(py, shape)?;
    let made = py
        .import(intern!(py, "numpy"))?
        .call_method1(intern!(py, "zeros"), (shape, numpy::dtype::<T>(py)))?;
    Ok(made.cast_into()?)
}
