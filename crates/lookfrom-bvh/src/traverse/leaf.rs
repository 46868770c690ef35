//! Leaves without triangles: spheres, procedural shapes, instances.

use std::ops::Range;

use super::{TraversalState, trace_any};
use crate::bvh::Bvh;
use crate::collector::Collector;
use crate::exact::ExactRay;
use crate::item::Leaf;
use crate::observer::Observer;
use crate::ray::{Hit, NONE, Ray};
use crate::sphere::{self, SphereBlock, SphereItem};
use crate::stack::TraversalStack;
use crate::visibility::Visibility;
use lookfrom_simd::{LaneMask, Simd};

/// Tests the primitives of a leaf without triangles. A ray is usual if it is one of the world whose numbers need no care.
#[inline(never)]
pub(crate) fn other_leaf<'a, S: Simd, C: Collector, V: Visibility<'a>, O: Observer>(
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
        Leaf::Procedurals { first, count } => procedurals(bvh, range(first, count), ray, state),
        Leaf::Instances { first, count } => instances(simd, bvh, range(first, count), ray, state, stack),
    }
}

#[inline(always)]
fn spheres<'a, S: Simd, C: Collector, V: Visibility<'a>, O: Observer>(
    simd: S,
    block: &SphereBlock,
    (ray, is_usual): (&ExactRay, bool),
    state: &mut TraversalState<C, V, O>,
) -> bool {
    let instance = state.instance;
    if O::LISTENS {
        block.items().for_each(|item| state.observer.candidate(instance, item.geometry, item.primitive));
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

fn procedurals<'a, C: Collector, V: Visibility<'a>, O: Observer>(
    bvh: &Bvh,
    range: Range<usize>,
    ray: &ExactRay,
    state: &mut TraversalState<C, V, O>,
) -> bool {
    for item in &bvh.procedurals[range] {
        let (geometry, primitive, instance) = (item.geometry, item.primitive, state.instance);
        state.observer.candidate(instance, geometry, primitive);
        if V::SELECTS && !state.visibility.shows(geometry, primitive) {
            continue;
        }
        // Query one step beyond the end: a hit at the same t may win the tie.
        let t_max = state.collector.end().next_up();
        let [origin, direction] = [ray.origin, ray.direction].map(|x| x.map(|x| x as f32));
        let asked = Ray { origin, t_min: ray.t_min, direction, t_max };
        let Some(found) = bvh.procedural_shapes[item.shape as usize].intersect(primitive, &asked) else {
            continue;
        };
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
fn instances<'a, S: Simd, C: Collector, V: Visibility<'a>, O: Observer>(
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
