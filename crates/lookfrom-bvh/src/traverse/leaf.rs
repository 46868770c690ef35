//! Leaves without triangles: spheres, procedural shapes, instances.

use std::ops::Range;

use super::{TraversalState, trace_any};
use crate::bvh::Bvh;
use crate::capsule::CapsuleBlock;
use crate::collector::Collector;
use crate::exact::ExactRay;
use crate::item::{Leaf, ProceduralItem};
use crate::observer::Listener;
use crate::ray::{Hit, NONE, Ray};
use crate::sphere::{self, SphereBlock, SphereItem};
use crate::stack::TraversalStack;
use crate::visibility::Visibility;
use lookfrom_simd::{LaneMask, Simd};

/// Tests the primitives of a leaf without triangles. A ray is usual if it is one of the world whose numbers need no care.
#[inline(never)]
pub(crate) fn other_leaf<'a, S: Simd, C: Collector, V: Visibility<'a>, O: Listener>(
    simd: S,
    bvh: &Bvh,
    leaf: &Leaf,
    (ray, is_usual): (&ExactRay, bool),
    state: &mut TraversalState<C, V, O>,
    stack: &mut TraversalStack<'_>,
) -> bool {
    let range = |first: u32, count: u32| first as usize..(first + count) as usize;
    match *leaf {
        Leaf::Spheres { block } => spheres(simd, &bvh.spheres[block as usize], (ray, is_usual), state),
        Leaf::Procedurals { first, count } => {
            procedurals(bvh, &bvh.procedurals[range(first, count)], LaneMask((1 << count) - 1), ray, state)
        }
        Leaf::Capsules { block, first, count } => {
            let items = &bvh.procedurals[range(first, count.into())];
            capsules(simd, bvh, (&bvh.capsules[block as usize], items), ray, state)
        }
        Leaf::Instances { first, count } => instances(simd, bvh, range(first, count), ray, state, stack),
    }
}

#[inline(always)]
fn spheres<'a, S: Simd, C: Collector, V: Visibility<'a>, O: Listener>(
    simd: S,
    block: &SphereBlock,
    (ray, is_usual): (&ExactRay, bool),
    state: &mut TraversalState<C, V, O>,
) -> bool {
    let instance = state.instance;
    if let Some(observer) = state.observer.observer() {
        block.items().for_each(|item| observer.candidate(instance, item.geometry, item.primitive));
    }
    let kept = match is_usual {
        true => simd.vectorize(
            #[inline(always)]
            || block.may_hit(simd, ray),
        ),
        false => LaneMask(block.used()),
    };
    for lane in kept {
        let SphereItem { shape, geometry, primitive } = block.item(lane);
        if V::SELECTS && !state.visibility.shows(geometry, primitive) {
            continue;
        }
        let Some([t1, t2]) = sphere::intersect_exact(ray, &shape) else { continue };
        if V::SELECTS && state.visibility.crossings() && t1 == t2 {
            continue;
        }
        let roots = if t1 < t2 { &[t1, t2][..] } else { &[t1][..] };
        for (root, &t) in roots.iter().enumerate() {
            if t > ray.t_min
                && (!V::SELECTS || state.visibility.faces().shows(|| root == 0))
                && state.collector.commit(Hit { t, u: 0.0, v: 0.0, primitive, geometry, instance })
            {
                return true;
            }
        }
    }
    false
}

#[inline(always)]
fn capsules<'a, S: Simd, C: Collector, V: Visibility<'a>, O: Listener>(
    simd: S,
    bvh: &Bvh,
    (block, items): (&CapsuleBlock, &[ProceduralItem]),
    ray: &ExactRay,
    state: &mut TraversalState<C, V, O>,
) -> bool {
    let range = [ray.t_min, state.collector.end()];
    let kept = simd.vectorize(
        #[inline(always)]
        || block.may_hit(simd, items.len(), ray, range),
    );
    // An observer hears of all candidates, as of those in boxes of their own.
    let is_observed = state.observer.observer().is_some();
    let tested = if is_observed { LaneMask((1 << items.len()) - 1) } else { kept };
    tested.0 != 0 && procedurals(bvh, items, tested, ray, state)
}

/// Tests some of the items of a leaf.
#[inline(never)]
fn procedurals<'a, C: Collector, V: Visibility<'a>, O: Listener>(
    bvh: &Bvh,
    items: &[ProceduralItem],
    tested: LaneMask,
    ray: &ExactRay,
    state: &mut TraversalState<C, V, O>,
) -> bool {
    for item in tested.map(|place| &items[place]) {
        let (geometry, primitive, instance) = (item.geometry, item.primitive, state.instance);
        if let Some(observer) = state.observer.observer() {
            observer.candidate(instance, geometry, primitive);
        }
        if V::SELECTS && !state.visibility.shows(geometry, primitive) {
            continue;
        }
        // Query one step beyond the end: a hit at the same t may win the tie.
        let t_max = state.collector.end().next_up();
        let [origin, direction] = [ray.origin, ray.direction].map(|x| x.map(|x| x as f32));
        let asked = Ray { origin, t_min: ray.t_min, direction, t_max };
        let found = bvh.shapes_of(item).and_then(|shapes| shapes.intersect(primitive, &asked));
        let Some(found) = found else { continue };
        if found.t > ray.t_min
            && state.collector.commit(Hit {
                t: found.t,
                u: found.u,
                v: found.v,
                primitive,
                geometry,
                instance,
            })
        {
            return true;
        }
    }
    false
}

/// Traces a ray through instances.
fn instances<'a, S: Simd, C: Collector, V: Visibility<'a>, O: Listener>(
    simd: S,
    bvh: &Bvh,
    mut range: Range<usize>,
    exact: &ExactRay,
    state: &mut TraversalState<C, V, O>,
    stack: &mut TraversalStack<'_>,
) -> bool {
    range.any(|place| {
        if V::SELECTS && !state.visibility.enter_instance(place) {
            return false;
        }
        let instance = &bvh.instances[place];
        let inside = instance.ray_in_object(exact);
        let TraversalStack { entries, height, .. } = stack;
        state.instance = place as u32;
        let stop = trace_any(
            simd,
            &instance.bvh,
            &inside,
            state,
            &mut TraversalStack { entries, bottom: *height, height: *height },
        );
        state.instance = NONE;
        if V::SELECTS {
            state.visibility.leave_instance();
        }
        stop
    })
}
