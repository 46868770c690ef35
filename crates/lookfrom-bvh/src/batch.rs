//! Batches of rays: divided among threads, then traced in packets where they are coherent,
//! otherwise one by one, or several in turn where the tree is large.

use std::marker::PhantomData;
use std::ops::Range;

use crate::coherence::Coherence;
use crate::collector::{AnyHit, ClosestHit, PacketCollector};
use crate::dispatch::dispatch;
use crate::interleaved::{self, answer_in_turn};
use crate::origin_primitive::OriginPrimitive;
use crate::packet::trace_packet;
use crate::ray::{Hit, Ray};
use crate::ray8::RAYS;
use crate::settings::{Settings, VisibilityKind};
use crate::stack::{Stack, with_stack};
use crate::traverse::trace;
use crate::visibility::{Everything, ExceptOrigin, Masked, Visibility};
use lookfrom_simd::{Kernel, Simd};

/// Number of rays (or points) in one task of a thread.
#[cfg(feature = "parallel")]
const BATCH: usize = 4096;

/// A query for many rays, with one result for each.
pub(crate) trait Question: PacketCollector {
    type Answer: Send;

    fn ask(ray: &Ray) -> Self;

    fn answer(&self) -> Self::Answer;

    /// Traces rays as a packet; returns false where they cannot form one, or it does not pay. The answers mean nothing
    /// then.
    fn trace_packet<'a, S: Simd, V: Visibility<'a>>(
        simd: S,
        settings: &Settings<'a>,
        rays: &[Ray],
        answers: &mut [Self::Answer],
        coherence: &mut Coherence,
        stack: &mut Stack,
    ) -> bool;
}

impl Question for ClosestHit {
    type Answer = Hit;

    #[inline(always)]
    fn ask(ray: &Ray) -> Self {
        Self::new(ray)
    }

    #[inline(always)]
    fn answer(&self) -> Hit {
        self.hit
    }

    #[inline(always)]
    fn trace_packet<'a, S: Simd, V: Visibility<'a>>(
        simd: S,
        settings: &Settings<'a>,
        rays: &[Ray],
        hits: &mut [Hit],
        coherence: &mut Coherence,
        stack: &mut Stack,
    ) -> bool {
        hits.len() >= rays.len()
            && trace_packet::<S, Self, V>(simd, settings, rays, hits, coherence, stack).is_some()
    }
}

impl Question for AnyHit {
    type Answer = bool;

    #[inline(always)]
    fn ask(ray: &Ray) -> Self {
        Self::new(ray)
    }

    #[inline(always)]
    fn answer(&self) -> bool {
        self.found
    }

    #[inline(always)]
    fn trace_packet<'a, S: Simd, V: Visibility<'a>>(
        simd: S,
        settings: &Settings<'a>,
        rays: &[Ray],
        occluded: &mut [bool],
        coherence: &mut Coherence,
        stack: &mut Stack,
    ) -> bool {
        let found = trace_packet::<S, Self, V>(simd, settings, rays, &mut [], coherence, stack);
        if let Some(found) = found {
            for (ray, occluded) in occluded.iter_mut().enumerate() {
                *occluded = found >> ray & 1 != 0;
            }
        }
        found.is_some()
    }
}

/// The closest hit of each ray.
pub(crate) fn closest_hits(settings: &Settings<'_>, rays: &[Ray], hits: &mut [Hit]) {
    answer::<ClosestHit>(settings, rays, hits);
}

/// True for each ray that has a hit.
pub(crate) fn occluded_many(settings: &Settings<'_>, rays: &[Ray], occluded: &mut [bool]) {
    answer::<AnyHit>(settings, rays, occluded);
}

fn answer<C: Question>(settings: &Settings<'_>, rays: &[Ray], answers: &mut [C::Answer]) {
    for_batches(rays, answers, |first, rays, answers| {
        let settings = settings.from(first);
        match settings.visibility_kind() {
            VisibilityKind::Everything => Batch::<C, Everything>::trace(settings, rays, answers),
            VisibilityKind::ExceptOrigin => Batch::<C, ExceptOrigin>::trace(settings, rays, answers),
            VisibilityKind::Masked => Batch::<C, Masked<'_>>::trace(settings, rays, answers),
        }
    });
}

/// The results for rays, in their order; as many as fit into `answers`.
struct Batch<'a, 'b, C: Question, V> {
    settings: Settings<'a>,
    rays: &'b [Ray],
    answers: &'b mut [C::Answer],
    visibility: PhantomData<V>,
}

impl<'a, 'b, C: Question, V: Visibility<'a>> Batch<'a, 'b, C, V> {
    fn trace(settings: Settings<'a>, rays: &'b [Ray], answers: &'b mut [C::Answer]) {
        dispatch(settings.bvh.level, Self { settings, rays, answers, visibility: PhantomData });
    }
}

impl<'a, C: Question, V: Visibility<'a>> Kernel for Batch<'a, '_, C, V> {
    type Output = ();
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { settings, rays, answers, .. } = self;
        with_stack(
            #[inline(always)]
            |stack| {
                let count = rays.len().min(answers.len());
                let mut coherence = Coherence::default();
                // The rays from here on that no packet has traced.
                let mut first_left = 0;
                for first in (0..count).step_by(RAYS) {
                    let last = (first + RAYS).min(count);
                    let of_packet = settings.from(first);
                    let (rays_of, answers_of) = (&rays[first..last], &mut answers[first..last]);
                    let is_traced = if is_about_everything::<V>(&of_packet) {
                        C::trace_packet::<S, Everything>(
                            simd,
                            &of_packet,
                            rays_of,
                            answers_of,
                            &mut coherence,
                            stack,
                        )
                    } else {
                        C::trace_packet::<S, Masked<'_>>(
                            simd,
                            &of_packet,
                            rays_of,
                            answers_of,
                            &mut coherence,
                            stack,
                        )
                    };
                    if is_traced {
                        answer_left::<S, C, V>(simd, &settings, rays, answers, first_left..first, stack);
                        first_left = last;
                    }
                }
                answer_left::<S, C, V>(simd, &settings, rays, answers, first_left..count, stack);
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

/// Answers a range of rays that form no packets.
#[inline(never)]
fn answer_left<'a, S: Simd, C: Question, V: Visibility<'a>>(
    simd: S,
    settings: &Settings<'a>,
    rays: &[Ray],
    answers: &mut [C::Answer],
    left: Range<usize>,
    stack: &mut Stack,
) {
    let settings = &settings.from(left.start);
    let (rays, answers) = (&rays[left.clone()], &mut answers[left]);
    if rays.len() > 1 && interleaved::pays(settings.bvh) {
        return answer_in_turn::<S, C, V>(simd, settings, rays, answers, stack);
    }
    simd.vectorize(
        #[inline(always)]
        || {
            for (number, (ray, answer)) in rays.iter().zip(answers).enumerate() {
                let visibility = V::of(settings, number);
                *answer = trace(simd, settings.bvh, ray, C::ask, visibility, (), stack).answer();
            }
        },
    );
}

/// Computes each result in its place, on several threads where there are many.
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

/// The same, batch by batch, with the index of the batch's first element.
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
