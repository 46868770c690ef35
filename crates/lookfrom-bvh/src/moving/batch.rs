//! Batches of rays through the moving part of a tree, after what stands still.

use crate::collector::BatchQuery;
use crate::ray::{NONE, Ray};
use crate::settings::Settings;
use crate::stack::Stack;
use crate::traverse::TraversalState;
use crate::visibility::Visibility;
use lookfrom_simd::Simd;

use super::continued;

/// Continues the queries of rays, each at its time, from their results so far.
#[inline(never)]
pub(crate) fn go_on_through_moving<'a, S: Simd, C: BatchQuery, V: Visibility<'a>>(
    simd: S,
    settings: &Settings<'a>,
    rays: &[Ray],
    results: &mut [C::Result],
    stack: &mut Stack,
) {
    for (number, (ray, result)) in rays.iter().zip(results).enumerate() {
        let (collector, visibility) = (C::after(ray, result), V::of(settings, number));
        let at = (ray, settings.time_of(number));
        let state = TraversalState { instance: NONE, collector, visibility, observer: () };
        *result = continued(simd, settings.bvh, at, state, stack).result();
    }
}
