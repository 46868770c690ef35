//! Queries for many rays or points, by chunks on several threads, from and to arrays.

use std::iter;
use std::ops::Range;

use lookfrom_bvh::NONE;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadwriteArray1};
use pyo3::prelude::*;

use super::arguments::{RaysArgument, Senseless};
use super::cast::Caster;
use super::chunk::CHUNK;
use super::inside::Boundary;
use super::order::Shares;
use super::refine::FineHit;
use super::tree::Tree;
use crate::arrays::{Numbers, Rows, Vectors, numbers, zeros};
use crate::error::Error;
use crate::parallel::for_each;

type Array<'py, T> = Bound<'py, PyArray1<T>>;

/// t, u, v, primitive, geometry, instance. The last two are `None` where they are 0, and none, for all hits.
type HitArrays<'py> = (
    Array<'py, f64>,
    Array<'py, f64>,
    Array<'py, f64>,
    Array<'py, i32>,
    Option<Array<'py, i32>>,
    Option<Array<'py, i32>>,
);

/// The part of the arrays of hits that one chunk fills. Arrays that are not wanted are empty.
struct HitsOut<'a> {
    numbers: [&'a mut [f64]; 3],
    ids: [&'a mut [i32]; 3],
}

impl HitsOut<'_> {
    #[inline]
    fn put(&mut self, number: usize, hit: &FineHit) {
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
fn hit_arrays<'py>(py: Python<'py>, tree: &Tree, count: usize) -> PyResult<HitArrays<'py>> {
    let (has_geometries, has_instances) = tree.kinds_of_ids();
    let numbers = || zeros(py, [count]);
    let ids = |is_wanted: bool| is_wanted.then(|| zeros(py, [count])).transpose();
    let primitive = zeros(py, [count])?;
    Ok((numbers()?, numbers()?, numbers()?, primitive, ids(has_geometries)?, ids(has_instances)?))
}

/// Calls a function with the content of arrays of hits.
fn with_slices<R>(arrays: &HitArrays<'_>, run: impl FnOnce(HitsOut<'_>) -> PyResult<R>) -> PyResult<R> {
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
fn pieces<T>(array: &mut [T], size: usize) -> impl Iterator<Item = &mut [T]> {
    array.chunks_mut(size).chain(iter::repeat_with(Default::default))
}

fn hit_pieces<'a>(out: HitsOut<'a>, size: usize) -> impl Iterator<Item = HitsOut<'a>> {
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
fn shares<T>(count: usize, size: usize, pieces: impl Iterator<Item = T>) -> Vec<(Range<usize>, T)> {
    let ranges = (0..count).step_by(size).map(|first| first..(first + size).min(count));
    ranges.zip(pieces).collect()
}

/// Casts rays: `work` does a chunk of them, which is prepared, and fills some of the piece of their share.
fn cast<T: Send>(
    py: Python<'_>,
    tree: &Tree,
    argument: &RaysArgument<'_>,
    shares: Shares,
    pieces: impl Iterator<Item = T>,
    work: impl Fn(&mut Caster<'_>, &mut T) + Sync,
) -> PyResult<()> {
    let (rays, selection, senseless) = (argument.rays()?, argument.selection()?, Senseless::new());
    let pieces = self::shares(rays.directions.len(), shares.size, pieces);
    for_each(py, argument.8, pieces.into_iter(), || {
        let (mut caster, mut places) = (Caster::new(tree, selection), Vec::new());
        let (senseless, work) = (&senseless, &work);
        move |(range, mut out)| {
            shares.order(&range, &mut places);
            for places in places.chunks(CHUNK) {
                senseless.add(caster.chunk.prepare(tree, &rays, range.start, places));
                work(&mut caster, &mut out);
            }
        }
    })?;
    argument.check(&senseless)
}

pub(super) fn closest_hits<'py>(
    py: Python<'py>,
    tree: &Tree,
    rays: &RaysArgument<'_>,
) -> PyResult<HitArrays<'py>> {
    let arrays = hit_arrays(py, tree, rays.rays()?.directions.len())?;
    let shares = Shares::of(&rays.rays()?);
    with_slices(&arrays, |out| {
        cast(py, tree, rays, shares, hit_pieces(out, shares.size), |caster, out| {
            caster.closest_hits(|number, hit| out.put(number, &hit));
        })
    })?;
    Ok(arrays)
}

/// The primitives of the closest hits.
pub(super) fn closest_primitives<'py>(
    py: Python<'py>,
    tree: &Tree,
    rays: &RaysArgument<'_>,
) -> PyResult<Array<'py, i32>> {
    let array: Array<'_, _> = zeros(py, [rays.rays()?.directions.len()])?;
    let shares = Shares::of(&rays.rays()?);
    cast(py, tree, rays, shares, pieces(array.readwrite().as_slice_mut()?, shares.size), |caster, out| {
        caster.closest_ids(|number, [primitive, ..]| out[number] = primitive as i32);
    })?;
    Ok(array)
}

pub(super) fn occluded<'py>(
    py: Python<'py>,
    tree: &Tree,
    rays: &RaysArgument<'_>,
) -> PyResult<Array<'py, bool>> {
    let array: Array<'_, _> = zeros(py, [rays.rays()?.directions.len()])?;
    let shares = Shares::of(&rays.rays()?);
    cast(py, tree, rays, shares, pieces(array.readwrite().as_slice_mut()?, shares.size), |caster, out| {
        caster.occluded(|number, is_occluded| out[number] = is_occluded);
    })?;
    Ok(array)
}

pub(super) fn count_hits<'py>(
    py: Python<'py>,
    tree: &Tree,
    rays: &RaysArgument<'_>,
    crossings: bool,
) -> PyResult<Array<'py, i64>> {
    let array: Array<'_, _> = zeros(py, [rays.rays()?.directions.len()])?;
    cast(
        py,
        tree,
        rays,
        Shares::IN_ORDER,
        pieces(array.readwrite().as_slice_mut()?, CHUNK),
        |caster, out| {
            caster.count_hits(crossings, |number, count| out[number] = count as i64);
        },
    )?;
    Ok(array)
}

/// All hits: where those of each ray start and the last end, and the hits.
pub(super) fn all_hits<'py>(
    py: Python<'py>,
    tree: &Tree,
    rays: &RaysArgument<'_>,
    crossings: bool,
) -> PyResult<(Array<'py, i64>, HitArrays<'py>)> {
    let count = rays.rays()?.directions.len();
    let offsets: Array<'_, _> = zeros(py, [count + 1])?;
    let mut found: Vec<Vec<FineHit>> = iter::repeat_with(Vec::new).take(count.div_ceil(CHUNK)).collect();
    {
        let mut offsets = offsets.readwrite();
        let ends = &mut offsets.as_slice_mut()?[1..];
        cast(
            py,
            tree,
            rays,
            Shares::IN_ORDER,
            pieces(ends, CHUNK).zip(&mut found),
            |caster, (ends, found)| {
                caster.all_hits(crossings, |number, hits| {
                    found.extend_from_slice(hits);
                    ends[number] = hits.len() as i64;
                });
            },
        )?;
        let mut sum = 0;
        ends.iter_mut().for_each(|end| {
            sum += *end;
            *end = sum;
        });
    }
    let arrays = hit_arrays(py, tree, found.iter().map(Vec::len).sum())?;
    with_slices(&arrays, |mut out| {
        let hits = found.iter().flatten().enumerate();
        hits.for_each(|(number, hit)| out.put(number, hit));
        Ok(())
    })?;
    Ok((offsets, arrays))
}

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
        return Err(pyo3::exceptions::PyTypeError::new_err("arrays of hits have different lengths"));
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
                    let ray = super::refine::WorldRay { origin: from[place], direction: to[place] };
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
fn known_boundary<'a>(py: Python<'_>, tree: &'a Tree) -> PyResult<Option<&'a [super::inside::BoundaryEdge]>> {
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
                        let lookfrom_bvh::ClosestPointF64 {
                            position,
                            distance,
                            u,
                            v,
                            primitive,
                            geometry,
                            instance,
                        } = found;
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
