//! New arrays for hits, and the pieces of them that threads fill.

use std::iter;
use std::ops::Range;

use numpy::{PyArray1, PyArrayMethods, PyReadwriteArray1};
use pyo3::prelude::*;

use super::refine::FineHit;
use super::tree::Tree;
use crate::arrays::zeros;

pub(super) type Array<'py, T> = Bound<'py, PyArray1<T>>;

/// t, u, v, primitive, geometry, instance. The last two are `None` where they are 0, and none, for all hits.
pub(super) type HitArrays<'py> = (
    Array<'py, f64>,
    Array<'py, f64>,
    Array<'py, f64>,
    Array<'py, i32>,
    Option<Array<'py, i32>>,
    Option<Array<'py, i32>>,
);

/// The part of the arrays of hits that one chunk fills. Arrays that are not wanted are empty.
pub(super) struct HitsOut<'a> {
    numbers: [&'a mut [f64]; 3],
    ids: [&'a mut [i32]; 3],
}

impl HitsOut<'_> {
    #[inline]
    pub(super) fn put(&mut self, number: usize, hit: &FineHit) {
        for (out, x) in self.numbers.iter_mut().zip([hit.t, hit.u, hit.v]) {
            out[number] = x;
        }
        self.put_ids(number, [hit.primitive, hit.geometry, hit.instance]);
    }

    #[inline]
    fn put_ids(&mut self, number: usize, ids: [u32; 3]) {
        for (out, id) in self.ids.iter_mut().zip(ids) {
            if let Some(out) = out.get_mut(number) {
                // `NONE` becomes −1.
                *out = id as i32;
            }
        }
    }
}

/// New arrays for hits.
pub(super) fn hit_arrays<'py>(py: Python<'py>, tree: &Tree, count: usize) -> PyResult<HitArrays<'py>> {
    let (has_geometries, has_instances) = tree.kinds_of_ids();
    let numbers = || zeros(py, [count]);
    let ids = |is_wanted: bool| is_wanted.then(|| zeros(py, [count])).transpose();
    let primitive = zeros(py, [count])?;
    Ok((numbers()?, numbers()?, numbers()?, primitive, ids(has_geometries)?, ids(has_instances)?))
}

/// Calls a function with the content of arrays of hits.
pub(super) fn with_slices<R>(
    arrays: &HitArrays<'_>,
    run: impl FnOnce(HitsOut<'_>) -> PyResult<R>,
) -> PyResult<R> {
    let (t, u, v, primitive, geometry, instance) = arrays;
    let [mut t, mut u, mut v] = [t, u, v].map(PyArrayMethods::readwrite);
    let mut primitive = primitive.readwrite();
    let [mut geometry, mut instance] =
        [geometry, instance].map(|array| array.as_ref().map(PyArrayMethods::readwrite));
    let numbers = [t.as_slice_mut()?, u.as_slice_mut()?, v.as_slice_mut()?];
    run(HitsOut {
        numbers,
        ids: [primitive.as_slice_mut()?, some_or_empty(&mut geometry)?, some_or_empty(&mut instance)?],
    })
}

fn some_or_empty<'a>(array: &'a mut Option<PyReadwriteArray1<'_, i32>>) -> PyResult<&'a mut [i32]> {
    Ok(match array {
        Some(array) => array.as_slice_mut()?,
        None => &mut [],
    })
}

/// An array in chunks; empty ones, as many as are asked for, of an array that is empty.
pub(super) fn pieces<T>(array: &mut [T], size: usize) -> impl Iterator<Item = &mut [T]> {
    array.chunks_mut(size).chain(iter::repeat_with(Default::default))
}

pub(super) fn hit_pieces<'a>(out: HitsOut<'a>, size: usize) -> impl Iterator<Item = HitsOut<'a>> {
    let [t, u, v] = out.numbers.map(|array| pieces(array, size));
    let [primitive, geometry, instance] = out.ids.map(|array| pieces(array, size));
    t.zip(u).zip(v).zip(primitive).zip(geometry).zip(instance).map(
        |(((((t, u), v), primitive), geometry), instance)| HitsOut {
            numbers: [t, u, v],
            ids: [primitive, geometry, instance],
        },
    )
}

/// `count` rays or points in pieces, each with what it fills.
pub(super) fn shares<T>(
    count: usize,
    size: usize,
    pieces: impl Iterator<Item = T>,
) -> Vec<(Range<usize>, T)> {
    let ranges = (0..count).step_by(size).map(|first| first..(first + size).min(count));
    ranges.zip(pieces).collect()
}
