//! Single rays through the moving part of a tree.

use crate::bvh::{Bvh, Moment, Moving};
use crate::collector::Collector;
use crate::conservative::RayLanes;
use crate::exact::ExactRay;
use crate::item::Leaf;
use crate::node::{Child, Content, Slabs};
use crate::observer::Listener;
use crate::prepared::PreparedRay;
use crate::ray::{NONE, Ray};
use crate::stack::{Stack, TraversalStack};
use crate::traverse::{TraversalState, test_block, trace_any};
use crate::visibility::Visibility;
use lookfrom_simd::Simd;

/// Continues a query of a ray of the world, after what stands still, with what moves.
#[inline(always)]
pub(crate) fn continued<'a, S: Simd, C: Collector, V: Visibility<'a>, O: Listener>(
    simd: S,
    bvh: &Bvh,
    (ray, time): (&Ray, f32),
    mut state: TraversalState<C, V, O>,
    stack: &mut Stack,
) -> C {
    if bvh.moving.is_some() && ray.t_min < ray.t_max && !state.collector.is_done() {
        trace_moving(simd, bvh, &ExactRay::new(ray), time, &mut state, &mut TraversalStack::above(stack, 0));
    }
    state.collector
}

/// Traces a ray, in the world or in an object's space, through the moving part of a tree, if it has one. Returns true if
/// no more hits are needed.
#[inline(never)]
pub(crate) fn trace_moving<'a, S: Simd, C: Collector, V: Visibility<'a>, O: Listener>(
    simd: S,
    bvh: &Bvh,
    ray: &ExactRay,
    time: f32,
    state: &mut TraversalState<C, V, O>,
    stack: &mut TraversalStack<'_>,
) -> bool {
    let Some(moving) = bvh.moving.as_deref().filter(|moving| !moving.is_empty()) else { return false };
    simd.vectorize(
        #[inline(always)]
        || {
            PreparedRay::new(simd, ray, moving.largest).is_some_and(|prepared| {
                let parts = Parts { bvh, moving, time, moment: moving.moment(time) };
                parts.traverse(simd, (ray, &prepared), state, stack)
            })
        },
    )
}

/// A tree and its moving part at a moment.
struct Parts<'t> {
    bvh: &'t Bvh,
    moving: &'t Moving,
    time: f32,
    moment: Moment,
}

impl Parts<'_> {
    #[inline(always)]
    fn traverse<'a, S: Simd, C: Collector, V: Visibility<'a>, O: Listener>(
        &self,
        simd: S,
        (ray, prepared): (&ExactRay, &PreparedRay),
        state: &mut TraversalState<C, V, O>,
        stack: &mut TraversalStack<'_>,
    ) -> bool {
        let Self { moving, moment, .. } = *self;
        let slabs = Slabs::new(simd, prepared);
        let lanes = RayLanes::new(simd, prepared);
        let mut end = prepared.end(state.collector.end());
        let mut next = Some(Child::ROOT);
        while let Some(current) = next {
            if let Content::Node(number) = current.content() {
                let node = moving.node(number, moment);
                let entered = node.enter(simd, &slabs, end);
                if let Some(observer) = state.observer.observer() {
                    observer.node(state.instance, number as u32);
                    observer.boxes(state.instance, node.count() as u32, entered.children.count_ones());
                }
                next = match entered.children {
                    0 => stack.pop(end),
                    _ => Some(stack.push_all_but_nearest::<S, C>(&node, &entered)),
                };
                continue;
            }
            let is_done = match current.content() {
                Content::Triangles(block) => {
                    let block = moving.block(block, moment);
                    test_block(simd, &block, &lanes, ray, &mut end, state)
                }
                Content::Leaf(leaf) => self.instances(simd, &moving.leaves[leaf], ray, state, stack),
                Content::Node(_) => false,
            };
            if is_done {
                return true;
            }
            let decided = prepared.end(state.collector.end());
            end = if decided < end { decided } else { end };
            next = stack.pop(end);
        }
        false
    }

    /// Traces a ray through instances where they are at the moment.
    #[inline(never)]
    fn instances<'a, S: Simd, C: Collector, V: Visibility<'a>, O: Listener>(
        &self,
        simd: S,
        leaf: &Leaf,
        ray: &ExactRay,
        state: &mut TraversalState<C, V, O>,
        stack: &mut TraversalStack<'_>,
    ) -> bool {
        let Leaf::Instances { first, count } = *leaf else { return false };
        (first..first + count).any(|id| {
            let instance = &self.bvh.instances[id as usize];
            let map = self.moving.map(id, self.time);
            let Some(inside) = map.and_then(|map| instance.ray_in_moved(&map, ray)) else { return false };
            if V::SELECTS && !state.visibility.enter_instance(id as usize) {
                return false;
            }
            state.instance = id;
            let mut above =
                TraversalStack { bottom: stack.height, height: stack.height, entries: stack.entries };
            let object = &*instance.bvh;
            let stop = !object.nodes.is_empty() && trace_any(simd, object, &inside, state, &mut above)
                || trace_moving(simd, object, &inside, self.time, state, &mut above);
            state.instance = NONE;
            if V::SELECTS {
                state.visibility.leave_instance();
            }
            stop
        })
    }
}
