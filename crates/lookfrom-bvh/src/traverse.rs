//! The one loop: which primitives does a ray meet?
//!
//! Generic over what is asked ([`Query`]: the closest hit, any hit, all hits) and over who watches ([`Watch`]). Children are
//! visited from near to far; what lies beyond the query's current end is skipped. The order of visits never shows in
//! a result: ends are compared with room for errors (see `node`), and ties are decided by ids (see `Hit`).

use std::cell::Cell;

use crate::Bvh;
use crate::node::{Content, with_room};
use crate::prepared::Prepared;
use crate::query::Query;
use crate::ray::{Hit, NONE, Ray};
use crate::{sphere, triangle};

/// Listens while a ray is traced. Every method does nothing unless written; `()` listens to nothing and costs nothing.
pub trait Watch {
    /// The ray visits a node of a tree; `instance` is [`NONE`] in the outer tree.
    fn node(&mut self, instance: u32, node: u32) {
        let _ = (instance, node);
    }

    /// The ray is about to be tested against a primitive.
    fn candidate(&mut self, instance: u32, geometry: u32, primitive: u32) {
        let _ = (instance, geometry, primitive);
    }
}

impl Watch for () {}

/// A child that waits for its visit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pending {
    near: f32,
    index: u32,
    content: u32,
}

thread_local! {
    /// The last traversal's stack, kept so that a ray costs no allocation. Taken while in use, so a procedural that
    /// traces rays of its own gets a new one.
    static STACK: Cell<Vec<Pending>> = const { Cell::new(Vec::new()) };
}

/// Runs `work` with a stack.
pub(crate) fn with_stack<R>(work: impl FnOnce(&mut Vec<Pending>) -> R) -> R {
    let mut stack = STACK.take();
    stack.clear();
    let result = work(&mut stack);
    STACK.set(stack);
    result
}

/// Traces a ray through a tree. Returns true where the query wants no more.
pub(crate) fn traverse<Q: Query, W: Watch>(
    bvh: &Bvh,
    ray: &Prepared,
    instance: u32,
    query: &mut Q,
    watch: &mut W,
    stack: &mut Vec<Pending>,
) -> bool {
    if bvh.nodes.is_empty() {
        return false;
    }
    let base = stack.len();
    let mut current = Pending { near: f32::NEG_INFINITY, index: 0, content: Content::Node.pack() };
    loop {
        if current.near <= with_room(query.end()) {
            let first = current.index as usize;
            let stop = match Content::unpack(current.content) {
                Content::Node => {
                    // Visit the children that the ray enters, the nearest first.
                    watch.node(instance, current.index);
                    let node = &bvh.nodes[first];
                    let entered = node.enter(ray, query.end());
                    push_sorted(node, &entered, stack);
                    false
                }
                Content::Triangles(count) => {
                    triangles(bvh, ray, first, count, &mut Answer { instance, query, watch })
                }
                Content::Spheres(count) => {
                    spheres(bvh, ray, first, count, &mut Answer { instance, query, watch })
                }
                Content::Procedurals(count) => {
                    procedurals(bvh, ray, first, count, &mut Answer { instance, query, watch })
                }
                Content::Instances(count) => instances(bvh, ray, first, count, query, watch, stack),
            };
            if stop {
                stack.truncate(base);
                return true;
            }
        }
        if stack.len() == base {
            return false;
        }
        let Some(next) = stack.pop() else { return false };
        current = next;
    }
}

/// Pushes the children that were entered so that the nearest is popped first.
#[inline(always)]
fn push_sorted(node: &crate::node::Node, entered: &crate::node::Entered, stack: &mut Vec<Pending>) {
    let bottom = stack.len();
    for slot in entered.children {
        let (index, content) = node.child(slot);
        let child = Pending { near: entered.near[slot], index, content };
        stack.push(child);
        // Insert: what is farther stays below.
        let mut place = stack.len() - 1;
        while place > bottom && stack[place - 1].near < child.near {
            stack[place] = stack[place - 1];
            place -= 1;
        }
        stack[place] = child;
    }
}

/// Whom to tell.
struct Answer<'a, Q, W> {
    instance: u32,
    query: &'a mut Q,
    watch: &'a mut W,
}

#[inline(always)]
fn triangles<Q: Query, W: Watch>(
    bvh: &Bvh,
    ray: &Prepared,
    first: usize,
    count: u32,
    answer: &mut Answer<'_, Q, W>,
) -> bool {
    let block = &bvh.triangles[first];
    for lane in 0..count as usize {
        let (geometry, primitive) = block.ids(lane);
        answer.watch.candidate(answer.instance, geometry, primitive);
    }
    for lane in block.filter(ray, answer.query.end()).first(count) {
        if let Some(crossing) = triangle::decide(ray, &block.corners(lane)) {
            let (geometry, primitive) = block.ids(lane);
            let triangle::Crossing { t, u, v } = crossing;
            if answer.query.accept(Hit { t, u, v, primitive, geometry, instance: answer.instance }) {
                return true;
            }
        }
    }
    false
}

fn spheres<Q: Query, W: Watch>(
    bvh: &Bvh,
    ray: &Prepared,
    first: usize,
    count: u32,
    answer: &mut Answer<'_, Q, W>,
) -> bool {
    for item in &bvh.spheres[first..first + count as usize] {
        let (geometry, primitive, instance) = (item.geometry, item.primitive, answer.instance);
        answer.watch.candidate(instance, geometry, primitive);
        let Some([t1, t2]) = sphere::decide(ray, &item.shape) else { continue };
        let roots = if t1 < t2 { &[t1, t2][..] } else { &[t1][..] };
        for &t in roots {
            if t > ray.t_min && answer.query.accept(Hit { t, u: 0.0, v: 0.0, primitive, geometry, instance })
            {
                return true;
            }
        }
    }
    false
}

fn procedurals<Q: Query, W: Watch>(
    bvh: &Bvh,
    ray: &Prepared,
    first: usize,
    count: u32,
    answer: &mut Answer<'_, Q, W>,
) -> bool {
    for item in &bvh.procedurals[first..first + count as usize] {
        let (geometry, primitive, instance) = (item.geometry, item.primitive, answer.instance);
        answer.watch.candidate(instance, geometry, primitive);
        // Ask one step beyond the end: a hit at the same t may win the tie.
        let t_max = answer.query.end().next_up();
        let asked = Ray { origin: ray.origin, t_min: ray.t_min, direction: ray.direction, t_max };
        let Some(found) = bvh.procedural_shapes[item.shape as usize].intersect(primitive, &asked) else {
            continue;
        };
        if found.t > ray.t_min
            && answer.query.accept(Hit { t: found.t, u: found.u, v: found.v, primitive, geometry, instance })
        {
            return true;
        }
    }
    false
}

fn instances<Q: Query, W: Watch>(
    bvh: &Bvh,
    ray: &Prepared,
    first: usize,
    count: u32,
    query: &mut Q,
    watch: &mut W,
    stack: &mut Vec<Pending>,
) -> bool {
    bvh.instances[first..first + count as usize].iter().any(|instance| {
        debug_assert_ne!(instance.id, NONE);
        ray.in_object(&instance.world_from_object, &instance.object_from_world)
            .is_some_and(|inside| traverse(&instance.bvh, &inside, instance.id, query, watch, stack))
    })
}
