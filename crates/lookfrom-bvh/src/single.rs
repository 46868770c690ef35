//! Queries of single rays in single precision: one site of compiled code for each query and level.

use crate::batch;
use crate::bvh::Bvh;
use crate::collector::{AllHits, AnyHit, BatchQuery, ClosestHit, Collector};
use crate::dispatch::{dispatch, run_at_baseline};
use crate::moving::continued;
use crate::observer::{Listener, Observer};
use crate::ray::{Hit, Ray};
use crate::settings::{Settings, VisibilityKind};
use crate::stack::with_stack;
use crate::traverse::trace;
use crate::visibility::{Everything, Masked, Visibility};
use lookfrom_simd::{Kernel, Simd};

/// Traces one ray at the best available level and returns the collector. `start` creates it inside the code for the
/// level, so that it can be kept in registers.
struct Trace<'a, F, V, O> {
    bvh: &'a Bvh,
    ray: &'a Ray,
    time: f32,
    start: F,
    visibility: V,
    observer: O,
}

impl<'a, C: Collector, F: FnOnce(&Ray) -> C, V: Visibility<'a>, O: Listener> Kernel for Trace<'a, F, V, O> {
    type Output = C;
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> C {
        let Self { bvh, ray, time, start, visibility, observer } = self;
        with_stack(
            #[inline(always)]
            |stack| {
                let state = trace(simd, bvh, ray, start, visibility, observer, stack);
                match bvh.moving.is_some() {
                    false => state.collector,
                    true => continued(simd, bvh, (ray, time), state, stack),
                }
            },
        )
    }
}

#[inline(always)]
fn trace_everything<C: Collector>(bvh: &Bvh, (ray, time): (&Ray, f32), start: impl FnOnce(&Ray) -> C) -> C {
    dispatch(bvh.level, Trace { bvh, ray, time, start, visibility: Everything, observer: () })
}

/// The general case, with any settings.
#[inline(always)]
fn trace_selected<C: Collector>(settings: &Settings<'_>, ray: &Ray, start: impl FnOnce(&Ray) -> C) -> C {
    let (bvh, time) = (settings.bvh, settings.time_of(0));
    dispatch(bvh.level, Trace { bvh, ray, time, start, visibility: Masked::of(settings, 0), observer: () })
}

/// The general case, with an observer.
#[inline(always)]
fn trace_observed<C: Collector>(
    settings: &Settings<'_>,
    ray: &Ray,
    start: impl FnOnce(&Ray) -> C,
    observer: &mut dyn Observer,
) -> C {
    let (bvh, time) = (settings.bvh, settings.time_of(0));
    run_at_baseline(Trace { bvh, ray, time, start, visibility: Masked::of(settings, 0), observer })
}

/// The closest hit in the whole tree.
pub(crate) fn closest_hit_of_everything(bvh: &Bvh, ray: &Ray, time: f32) -> Hit {
    trace_everything(bvh, (ray, time), ClosestHit::start).hit
}

/// True if anything in the tree is hit.
pub(crate) fn occluded_by_everything(bvh: &Bvh, ray: &Ray, time: f32) -> bool {
    trace_everything(bvh, (ray, time), AnyHit::start).found
}

/// The closest hit.
pub(crate) fn closest_hit(settings: &Settings<'_>, ray: &Ray) -> Hit {
    if let VisibilityKind::Everything = settings.visibility_kind() {
        return closest_hit_of_everything(settings.bvh, ray, settings.time_of(0));
    }
    let mut hit = [Hit::MISS];
    batch::closest_hits(settings, &[*ray], &mut hit);
    hit[0]
}

/// True if there is a hit.
pub(crate) fn occluded(settings: &Settings<'_>, ray: &Ray) -> bool {
    if let VisibilityKind::Everything = settings.visibility_kind() {
        return occluded_by_everything(settings.bvh, ray, settings.time_of(0));
    }
    let mut occluded = [false];
    batch::occluded_many(settings, &[*ray], &mut occluded);
    occluded[0]
}

/// All hits, sorted. `hits` must be empty.
pub(crate) fn all_hits(settings: &Settings<'_>, ray: &Ray, hits: &mut Vec<Hit>) {
    let room = std::mem::take(hits);
    let all = move |ray: &Ray| AllHits::new(ray, room);
    *hits = match settings.visibility_kind() {
        VisibilityKind::Everything => trace_everything(settings.bvh, (ray, settings.time_of(0)), all).hits,
        _ => trace_selected(settings, ray, all).hits,
    };
    sort(hits);
}

/// The closest hit, with an observer.
pub(crate) fn observed_closest_hit(settings: &Settings<'_>, ray: &Ray, observer: &mut dyn Observer) -> Hit {
    trace_observed(settings, ray, ClosestHit::start, observer).hit
}

/// True if there is a hit, with an observer.
pub(crate) fn observed_occluded(settings: &Settings<'_>, ray: &Ray, observer: &mut dyn Observer) -> bool {
    trace_observed(settings, ray, AnyHit::start, observer).found
}

/// All hits, sorted, with an observer. `hits` must be empty.
pub(crate) fn observed_all_hits(
    settings: &Settings<'_>,
    ray: &Ray,
    hits: &mut Vec<Hit>,
    observer: &mut dyn Observer,
) {
    let room = std::mem::take(hits);
    *hits = trace_observed(settings, ray, move |ray: &Ray| AllHits::new(ray, room), observer).hits;
    sort(hits);
}

/// Sorts hits by t, and hits at equal t by rank.
fn sort(hits: &mut [Hit]) {
    // A zero is a zero, whatever its sign.
    hits.sort_unstable_by(|a, b| (a.t + 0.0).total_cmp(&(b.t + 0.0)).then_with(|| a.rank().cmp(&b.rank())));
}
