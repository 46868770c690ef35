//! Batches of rays: divided among threads, then traced in packets where they are coherent,
//! otherwise one by one, or several in turn where the tree is large.

use std::marker::PhantomData;
use std::ops::Range;
use std::sync::Mutex;

use crate::coherence::Coherence;
use crate::collector::{AnyHit, BatchQuery, ClosestHit};
use crate::dispatch::dispatch;
use crate::interleaved::{self, trace_interleaved};
use crate::moving::go_on_through_moving;
use crate::origin_primitive::OriginPrimitive;
use crate::packet::trace_packet;
use crate::parallel;
use crate::ray::{Hit, Ray};
use crate::ray8::RAYS;
use crate::settings::{Settings, VisibilityKind};
use crate::stack::{Stack, with_stack};
use crate::traverse::trace;
use crate::visibility::{Everything, ExceptOrigin, Masked, Visibility};
use lookfrom_simd::{Kernel, Simd};

/// Number of rays (or points) in one task of a thread.
const BATCH: usize = 4096;

/// The closest hit of each ray.
pub(crate) fn closest_hits(settings: &Settings<'_>, rays: &[Ray], hits: &mut [Hit]) {
    trace_all::<ClosestHit>(settings, rays, hits);
}

/// True for each ray that has a hit.
pub(crate) fn occluded_many(settings: &Settings<'_>, rays: &[Ray], occluded: &mut [bool]) {
    trace_all::<AnyHit>(settings, rays, occluded);
}

fn trace_all<C: BatchQuery>(settings: &Settings<'_>, rays: &[Ray], results: &mut [C::Result]) {
    for_batches(rays, results, |first, rays, results| {
        let settings = settings.from(first);
        match settings.visibility_kind() {
            VisibilityKind::Everything => Batch::<C, Everything>::trace(settings, rays, results),
            VisibilityKind::ExceptOrigin => Batch::<C, ExceptOrigin>::trace(settings, rays, results),
            VisibilityKind::Masked => Batch::<C, Masked<'_>>::trace(settings, rays, results),
        }
    });
}

/// The results for rays, in their order; as many as fit into `results`.
struct Batch<'a, 'b, C: BatchQuery, V> {
    settings: Settings<'a>,
    rays: &'b [Ray],
    results: &'b mut [C::Result],
    visibility: PhantomData<V>,
}

impl<'a, 'b, C: BatchQuery, V: Visibility<'a>> Batch<'a, 'b, C, V> {
    fn trace(settings: Settings<'a>, rays: &'b [Ray], results: &'b mut [C::Result]) {
        dispatch(settings.bvh.level, Self { settings, rays, results, visibility: PhantomData });
    }
}

impl<'a, C: BatchQuery, V: Visibility<'a>> Kernel for Batch<'a, '_, C, V> {
    type Output = ();
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { settings, rays, results, .. } = self;
        with_stack(
            #[inline(always)]
            |stack| {
                let count = rays.len().min(results.len());
                let mut coherence = Coherence::default();
                // The rays from here on that no packet has traced.
                let mut first_left = 0;
                for first in (0..count).step_by(RAYS) {
                    let last = (first + RAYS).min(count);
                    let of_packet = settings.from(first);
                    let (rays_of, results_of) = (&rays[first..last], &mut results[first..last]);
                    let hits = C::hits_of(results_of);
                    let found = if is_about_everything::<V>(&of_packet) {
                        trace_packet::<S, C, Everything>(
                            simd,
                            &of_packet,
                            rays_of,
                            hits,
                            &mut coherence,
                            stack,
                        )
                    } else {
                        trace_packet::<S, C, Masked<'_>>(
                            simd,
                            &of_packet,
                            rays_of,
                            hits,
                            &mut coherence,
                            stack,
                        )
                    };
                    if let Some(found) = found {
                        C::store(found, results_of);
                        trace_rest::<S, C, V>(simd, &settings, rays, results, first_left..first, stack);
                        first_left = last;
                    }
                }
                trace_rest::<S, C, V>(simd, &settings, rays, results, first_left..count, stack);
                if settings.bvh.moving.is_some() {
                    go_on_through_moving::<S, C, V>(simd, &settings, rays, results, stack);
                }
            },
        );
    }
}

/// True if the rays of a packet see everything. Packets are compiled for two kinds of visibility only: for
/// everything, and for the general case.
#[inline(always)]
fn is_about_everything<'a, V: Visibility<'a>>(settings: &Settings<'_>) -> bool {
    !V::HAS_ORIGIN
        || !V::SELECTS && (0..RAYS).all(|number| settings.origin_of(number) == OriginPrimitive::NONE)
}

/// Traces a range of rays that form no packets.
#[inline(never)]
fn trace_rest<'a, S: Simd, C: BatchQuery, V: Visibility<'a>>(
    simd: S,
    settings: &Settings<'a>,
    rays: &[Ray],
    results: &mut [C::Result],
    left: Range<usize>,
    stack: &mut Stack,
) {
    let settings = &settings.from(left.start);
    let (rays, results) = (&rays[left.clone()], &mut results[left]);
    if rays.len() > 1 && interleaved::pays(settings.bvh) {
        return trace_interleaved::<S, C, V>(simd, settings, rays, results, stack);
    }
    simd.vectorize(
        #[inline(always)]
        || {
            for (number, (ray, result)) in rays.iter().zip(results).enumerate() {
                let visibility = V::of(settings, number);
                *result = trace(simd, settings.bvh, ray, C::start, visibility, (), stack).collector.result();
            }
        },
    );
}

/// Computes each result in its place, on several threads where there are many.
pub(crate) fn for_each<I: Sync, R: Send>(
    items: &[I],
    results: &mut [R],
    compute: impl Fn(usize, &I, &mut R) + Sync,
) {
    for_batches(items, results, |first, items, results| {
        let each = items.iter().zip(results).enumerate();
        each.for_each(|(number, (item, result))| compute(first + number, item, result));
    });
}

/// Computes results batch by batch; `compute` takes the index of the batch's first item too.
fn for_batches<I: Sync, R: Send>(
    items: &[I],
    results: &mut [R],
    compute: impl Fn(usize, &[I], &mut [R]) + Sync,
) {
    if items.len() <= BATCH {
        return compute(0, items, results);
    }
    let batches: Vec<_> = items.chunks(BATCH).zip(results.chunks_mut(BATCH).map(Mutex::new)).collect();
    parallel::for_each(batches.len(), &|batch| {
        let (items, results) = &batches[batch];
        compute(batch * BATCH, items, &mut results.lock().expect("each is locked once"));
    });
}
