//! Queries for many rays, by chunks on several threads, from and to arrays.

use std::iter;

use numpy::PyArrayMethods;
use pyo3::prelude::*;

use super::arguments::{RaysArgument, Senseless};
use super::cast::Caster;
use super::chunk::CHUNK;
use super::hit_arrays::{Array, HitArrays, hit_arrays, hit_pieces, pieces, shares, with_slices};
use super::order::Shares;
use super::refine::FineHit;
use super::tree::Tree;
use crate::arrays::zeros;
use crate::parallel::for_each;

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
