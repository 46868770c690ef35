//! Batches of rays: dealt to threads, then in packets where they are coherent, and else one by one.

use std::marker::PhantomData;

use crate::collector::{AnyHit, ClosestHit};
use crate::dispatch::dispatch;
use crate::origin_primitive::OriginPrimitive;
use crate::packet::trace_packet;
use crate::query::{Needs, Settings};
use crate::ray::{Hit, Ray};
use crate::ray8::RAYS;
use crate::stack::{Stack, with_stack};
use crate::traverse::trace;
use crate::visibility::{Everything, ExceptOrigin, Masked, Visibility};
use lookfrom_simd::{Kernel, Simd};

/// Rays (or points) that one thread answers before it looks for others' work.
#[cfg(feature = "parallel")]
const BATCH: usize = 4096;

/// The closest hit of each ray.
pub(crate) fn closest_hits(settings: &Settings<'_>, rays: &[Ray], hits: &mut [Hit]) {
    let level = settings.bvh.level;
    for_batches(rays, hits, |first, rays, hits| {
        let settings = settings.from(first);
        match settings.needs() {
            Needs::Everything => dispatch(level, ClosestHits::<Everything>::new(settings, rays, hits)),
            Needs::ExceptOrigin => dispatch(level, ClosestHits::<ExceptOrigin>::new(settings, rays, hits)),
            Needs::Masked => dispatch(level, ClosestHits::<Masked<'_>>::new(settings, rays, hits)),
        }
    });
}

/// Whether each ray has a hit.
pub(crate) fn occluded_many(settings: &Settings<'_>, rays: &[Ray], occluded: &mut [bool]) {
    let level = settings.bvh.level;
    for_batches(rays, occluded, |first, rays, occluded| {
        let settings = settings.from(first);
        match settings.needs() {
            Needs::Everything => dispatch(level, OccludedMany::<Everything>::new(settings, rays, occluded)),
            Needs::ExceptOrigin => {
                dispatch(level, OccludedMany::<ExceptOrigin>::new(settings, rays, occluded));
            }
            Needs::Masked => dispatch(level, OccludedMany::<Masked<'_>>::new(settings, rays, occluded)),
        }
    });
}

/// The closest hits of rays, in their order; as many as there are places for.
struct ClosestHits<'a, 'b, V> {
    settings: Settings<'a>,
    rays: &'b [Ray],
    hits: &'b mut [Hit],
    visibility: PhantomData<V>,
}

impl<'a, 'b, V> ClosestHits<'a, 'b, V> {
    fn new(settings: Settings<'a>, rays: &'b [Ray], hits: &'b mut [Hit]) -> Self {
        Self { settings, rays, hits, visibility: PhantomData }
    }
}

impl<'a, V: Visibility<'a>> Kernel for ClosestHits<'a, '_, V> {
    type Output = ();
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { settings, rays, hits, .. } = self;
        with_stack(
            #[inline(always)]
            |stack| {
                for (packet, (rays, hits)) in rays.chunks(RAYS).zip(hits.chunks_mut(RAYS)).enumerate() {
                    let settings = settings.from(packet * RAYS);
                    let is_traced = hits.len() >= RAYS
                        && if is_about_everything::<V>(&settings) {
                            trace_packet::<S, ClosestHit, Everything>(simd, &settings, rays, hits, stack)
                        } else {
                            trace_packet::<S, ClosestHit, Masked<'_>>(simd, &settings, rays, hits, stack)
                        }
                        .is_some();
                    if !is_traced {
                        closest_hits_singly::<S, V>(simd, &settings, rays, hits, stack);
                    }
                }
            },
        );
    }
}

/// Whether rays have hits, in their order; as many as there are places for.
struct OccludedMany<'a, 'b, V> {
    settings: Settings<'a>,
    rays: &'b [Ray],
    occluded: &'b mut [bool],
    visibility: PhantomData<V>,
}

impl<'a, 'b, V> OccludedMany<'a, 'b, V> {
    fn new(settings: Settings<'a>, rays: &'b [Ray], occluded: &'b mut [bool]) -> Self {
        Self { settings, rays, occluded, visibility: PhantomData }
    }
}

impl<'a, V: Visibility<'a>> Kernel for OccludedMany<'a, '_, V> {
    type Output = ();
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { settings, rays, occluded, .. } = self;
        with_stack(
            #[inline(always)]
            |stack| {
                for (packet, (rays, occluded)) in rays.chunks(RAYS).zip(occluded.chunks_mut(RAYS)).enumerate()
                {
                    let settings = settings.from(packet * RAYS);
                    let found = if is_about_everything::<V>(&settings) {
                        trace_packet::<S, AnyHit, Everything>(simd, &settings, rays, &mut [], stack)
                    } else {
                        trace_packet::<S, AnyHit, Masked<'_>>(simd, &settings, rays, &mut [], stack)
                    };
                    if let Some(found) = found {
                        for (ray, occluded) in occluded.iter_mut().enumerate() {
                            *occluded = found >> ray & 1 != 0;
                        }
                    } else {
                        occluded_singly::<S, V>(simd, &settings, rays, occluded, stack);
                    }
                }
            },
        );
    }
}

/// Whether the rays of a packet see everything. Packets are compiled for two kinds of visibility only: for everything, and for the
/// general case.
#[inline(always)]
fn is_about_everything<'a, V: Visibility<'a>>(settings: &Settings<'_>) -> bool {
    !V::HAS_ORIGIN
        || !V::SELECTS && (0..RAYS).all(|number| settings.origin_of(number) == OriginPrimitive::NONE)
}

#[inline(never)]
fn closest_hits_singly<'a, S: Simd, V: Visibility<'a>>(
    simd: S,
    settings: &Settings<'a>,
    rays: &[Ray],
    hits: &mut [Hit],
    stack: &mut Stack,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            for (number, (ray, hit)) in rays.iter().zip(hits).enumerate() {
                let visibility = V::of(settings, number);
                *hit = trace(simd, settings.bvh, ray, ClosestHit::new, visibility, (), stack).hit;
            }
        },
    );
}

#[inline(never)]
fn occluded_singly<'a, S: Simd, V: Visibility<'a>>(
    simd: S,
    settings: &Settings<'a>,
    rays: &[Ray],
    occluded: &mut [bool],
    stack: &mut Stack,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            for (number, (ray, occluded)) in rays.iter().zip(occluded).enumerate() {
                let visibility = V::of(settings, number);
                *occluded = trace(simd, settings.bvh, ray, AnyHit::new, visibility, (), stack).found;
            }
        },
    );
}

/// Answers each question in its place, batch by batch on several threads where there are many.
pub(crate) fn for_each<Q: Sync, A: Send>(
    questions: &[Q],
    answers: &mut [A],
    answer: impl Fn(usize, &Q, &mut A) + Sync,
) {
    for_batches(questions, answers, |first, questions, answers| {
        let each = questions.iter().zip(answers).enumerate();
        each.for_each(|(number, (question, place))| answer(first + number, question, place));
    });
}

/// The same, batch by batch, with the number of its first question.
fn for_batches<Q: Sync, A: Send>(
    questions: &[Q],
    answers: &mut [A],
    answer: impl Fn(usize, &[Q], &mut [A]) + Sync,
) {
    #[cfg(feature = "parallel")]
    if questions.len() > BATCH {
        use rayon::prelude::*;
        questions
            .par_chunks(BATCH)
            .zip(answers.par_chunks_mut(BATCH))
            .enumerate()
            .for_each(|(batch, (questions, answers))| answer(batch * BATCH, questions, answers));
        return;
    }
    answer(0, questions, answers);
}
