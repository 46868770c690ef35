//! Queries for many points, and the points of many hits, on several threads, from and to arrays.

use std::ops::Range;

use lookfrom_bvh::{ClosestPointF64, NONE};
use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use super::arguments::Senseless;
use super::chunk::{CHUNK, WorldRay};
use super::hit_arrays::{Array, HitArrays, hit_arrays, hit_pieces, pieces, shares, with_slices};
use super::inside::{Boundary, BoundaryEdge};
use super::refine::FineHit;
use super::tree::Tree;
use crate::arrays::{Numbers, Rows, Vectors, numbers, zeros};
use crate::error::Error;
use crate::parallel::for_each;

/// Points and normals of hits, given as they were returned, with their rays.
#[derive(FromPyObject)]
pub(super) struct HitsArgument<'py>(
    Vectors<'py>,
    Vectors<'py>,
    [Numbers<'py>; 3],
    [PyReadonlyArray1<'py, i32>; 3],
);

pub(super) fn points_and_normals<'py>(
    py: Python<'py>,
    tree: &Tree,
    hits: &HitsArgument<'_>,
    threads: usize,
) -> PyResult<[Bound<'py, PyArray2<f64>>; 2]> {
    let HitsArgument(origins, directions, of_hits, ids) = hits;
    let (origins, directions) = (origins.rows()?, directions.rows()?);
    let count = origins.len();
    let [t, u, v] = of_hits.each_ref().map(|array| numbers(array, count));
    let (t, u, v) = (t?, u?, v?);
    let ids = ids.each_ref().map(|array| array.as_array());
    if directions.len() != count || ids.iter().any(|ids| ids.len() != count) {
        return Err(PyTypeError::new_err("arrays of hits have different lengths"));
    }
    let arrays: [Bound<'_, PyArray2<f64>>; 2] = [zeros(py, [count, 3])?, zeros(py, [count, 3])?];
    {
        let [mut points, mut normals] = arrays.each_ref().map(PyArrayMethods::readwrite);
        let rows =
            points.as_slice_mut()?.chunks_mut(3 * CHUNK).zip(normals.as_slice_mut()?.chunks_mut(3 * CHUNK));
        let shares = shares(count, CHUNK, rows);
        let unknown = Senseless::new();
        for_each(py, threads, shares.into_iter(), || {
            let (mut from, mut to, unknown) = (Vec::new(), Vec::new(), &unknown);
            move |(range, (points, normals)): (Range<usize>, (&mut [f64], &mut [f64]))| {
                origins.read(range.start, range.len(), &mut from);
                directions.read(range.start, range.len(), &mut to);
                for (place, number) in range.enumerate() {
                    let [primitive, geometry, instance] = ids.map(|ids| ids[number] as u32);
                    let hit =
                        FineHit { t: t[number], u: u[number], v: v[number], primitive, geometry, instance };
                    let ray = WorldRay { origin: from[place], direction: to[place] };
                    let is_known = primitive == NONE || tree.has(&hit);
                    unknown.add((!is_known).then_some(number));
                    let (point, normal) = match primitive == NONE || !is_known {
                        true => ([f64::NAN; 3], [f64::NAN; 3]),
                        false => tree.point_and_normal(&hit, &ray),
                    };
                    points[3 * place..3 * place + 3].copy_from_slice(&point);
                    normals[3 * place..3 * place + 3].copy_from_slice(&normal);
                }
            }
        })?;
        if let Some(number) = unknown.first() {
            return Err(Error::new_err(format!(
                "hit {number} is on a primitive that the tree does not have"
            )));
        }
    }
    Ok(arrays)
}

/// The rows of `points`, one by one: `work` gets the number in the chunk, the point and what the chunk fills. Points must be finite.
fn for_points<T: Send, M>(
    py: Python<'_>,
    points: Rows<'_>,
    threads: usize,
    pieces: impl Iterator<Item = T>,
    memory: impl Fn() -> M + Sync,
    work: impl Fn(usize, [f64; 3], &mut T, &mut M) + Sync,
) -> PyResult<()> {
    let senseless = Senseless::new();
    for_each(py, threads, shares(points.len(), CHUNK, pieces).into_iter(), || {
        let (mut rows, mut memory, senseless, work) = (Vec::new(), memory(), &senseless, &work);
        move |(range, mut out): (Range<usize>, T)| {
            points.read(range.start, range.len(), &mut rows);
            for (number, &point) in rows.iter().enumerate() {
                if point.iter().all(|x| x.is_finite()) {
                    work(number, point, &mut out, &mut memory);
                } else {
                    senseless.add(Some(range.start + number));
                }
            }
        }
    })?;
    match senseless.first() {
        None => Ok(()),
        Some(number) => {
            let mut one = Vec::new();
            points.read(number, 1, &mut one);
            Err(Error::new_err(format!("point {number} is {:?}, but all coordinates must be finite", one[0])))
        }
    }
}

/// Whether points are inside.
pub(super) fn contains<'py>(
    py: Python<'py>,
    tree: &Tree,
    points: &Vectors<'_>,
    threads: usize,
) -> PyResult<Array<'py, bool>> {
    let points = points.rows()?;
    let boundary = known_boundary(py, tree)?;
    let array: Array<'_, _> = zeros(py, [points.len()])?;
    let mut inside = array.readwrite();
    for_points(
        py,
        points,
        threads,
        pieces(inside.as_slice_mut()?, CHUNK),
        Vec::new,
        |number, point, out, hits| {
            out[number] = match boundary {
                None => tree.contains_by_parity(point, hits),
                Some(boundary) => tree.winding_number(point, boundary, hits).abs() > 0.5,
            };
        },
    )?;
    drop(inside);
    Ok(array)
}

/// Winding numbers around points.
pub(super) fn winding_numbers<'py>(
    py: Python<'py>,
    tree: &Tree,
    points: &Vectors<'_>,
    threads: usize,
) -> PyResult<Array<'py, f64>> {
    let points = points.rows()?;
    let boundary = known_boundary(py, tree)?.unwrap_or_default();
    let array: Array<'_, _> = zeros(py, [points.len()])?;
    let mut windings = array.readwrite();
    for_points(
        py,
        points,
        threads,
        pieces(windings.as_slice_mut()?, CHUNK),
        Vec::new,
        |number, point, out, hits| {
            out[number] = tree.winding_number(point, boundary, hits);
        },
    )?;
    drop(windings);
    Ok(array)
}

/// The boundary of open meshes; `None` for closed ones.
fn known_boundary<'a>(py: Python<'_>, tree: &'a Tree) -> PyResult<Option<&'a [BoundaryEdge]>> {
    match py.detach(|| tree.boundary()) {
        Boundary::Closed => Ok(None),
        Boundary::Open(edges) => Ok(Some(edges)),
        Boundary::OpenBesideOthers => Err(Error::new_err(
            "there is no inside: a mesh is not closed, and open meshes have one only where there are no spheres or instances; \
             close the mesh, or put it into a tree of its own",
        )),
    }
}

/// Distances (infinite where nothing is near enough), points, and the numbers of the hits.
pub(super) fn closest_points<'py>(
    py: Python<'py>,
    tree: &Tree,
    points: &Vectors<'_>,
    max_distance: f64,
    threads: usize,
) -> PyResult<(Bound<'py, PyArray2<f64>>, HitArrays<'py>)> {
    let points = points.rows()?;
    let positions: Bound<'_, PyArray2<f64>> = zeros(py, [points.len(), 3])?;
    let arrays = hit_arrays(py, tree, points.len())?;
    with_slices(&arrays, |out| {
        let mut positions = positions.readwrite();
        let rows = positions.as_slice_mut()?.chunks_mut(3 * CHUNK);
        for_points(
            py,
            points,
            threads,
            rows.zip(hit_pieces(out, CHUNK)),
            || (),
            |number, point, (rows, out), ()| {
                let (position, hit) = match tree.closest_point(point, max_distance) {
                    None => ([f64::NAN; 3], FineHit::MISS),
                    Some(found) => {
                        let ClosestPointF64 { position, distance, u, v, primitive, geometry, instance } =
                            found;
                        (position, FineHit { t: distance, u, v, primitive, geometry, instance })
                    }
                };
                rows[3 * number..3 * number + 3].copy_from_slice(&position);
                out.put(number, &hit);
            },
        )
    })?;
    Ok((positions, arrays))
}
