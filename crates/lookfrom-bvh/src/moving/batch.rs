//! Batches of rays through the moving part of a tree, after what stands still.

use std::marker::PhantomData;

use crate::collector::BatchQuery;
use crate::dispatch::dispatch;
use crate::ray::Ray;
use crate::settings::Settings;
use crate::stack::with_stack;
use crate::visibility::Visibility;
use lookfrom_simd::{Kernel, Simd};

use super::continued;

/// Continues the queries of rays, each at its time.
pub(crate) fn trace_batch<'a, C: BatchQuery, V: Visibility<'a>>(
    settings: Settings<'a>,
    rays: &[Ray],
    results: &mut [C::Result],
) {
    if settings.bvh.moving.is_some() {
        let level = settings.bvh.level;
        dispatch(level, Batch::<C, V> { settings, rays, results, visibility: PhantomData });
    }
}

struct Batch<'a, 'b, C: BatchQuery, V> {
    settings: Settings<'a>,
    rays: &'b [Ray],
    results: &'b mut [C::Result],
    visibility: PhantomData<V>,
}

impl<'a, C: BatchQuery, V: Visibility<'a>> Kernel for Batch<'a, '_, C, V> {
    type Output = ();
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { settings, rays, results, .. } = self;
        with_stack(
            #[inline(always)]
            |stack| {
                for (number, (ray, result)) in rays.iter().zip(results).enumerate() {
                    let before = C::after(ray, result);
                    let visibility = V::of(&settings, number);
                    let at = (ray, settings.time_of(number));
                    *result = continued(simd, settings.bvh, at, before, (visibility, ()), stack).result();
                }
            },
        );
    }
}
