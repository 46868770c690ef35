//! The one loop: which primitives does a ray meet?
//!
//! Generic over what is asked ([`Query`]: the closest hit, any hit, all hits) and over who watches ([`Watch`]). Children are
//! visited from near to far; what lies beyond the query's current end is skipped. The order of visits never shows in
//! a result: ends are compared with room for errors (see `node`), and ties are decided by ids (see `Hit`).

use std::cell::Cell;

use crate::Bvh;
use crate::bvh::Leaf;
use crate::node::{Child, Content, Entered, Node, Slabs, WIDTH};
use crate::prepared::Prepared;
use crate::query::Query;
use crate::ray::{Hit, NONE, Ray};
use crate::simd::{Chosen, Simd, Work, at_level};
use crate::triangle::{Sieve, TriangleBlock};
use crate::{sphere, triangle};

/// Listens while a ray is traced. Every method does nothing unless written; `()` listens to nothing and costs nothing.
pub trait Watch {
    /// Whether [`Self::candidate`] is to be called at all.
    const LISTENS: bool = true;

    /// The ray visits a node of a tree; `instance` is [`NONE`] in the outer tree.
    fn node(&mut self, instance: u32, node: u32) {
        let _ = (instance, node);
    }

    /// The ray is about to be tested against a primitive.
    fn candidate(&mut self, instance: u32, geometry: u32, primitive: u32) {
        let _ = (instance, geometry, primitive);
    }
}

impl Watch for () {
    const LISTENS: bool = false;
}

/// A child that waits for its visit: where the ray enters it (f32 bits) above what it is. Positive distances are ordered
/// as these numbers are; the others only cost time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Pending(u64);

impl Pending {
    const NONE: Self = Self(0);

    #[inline(always)]
    fn new(near: f32, child: Child) -> Self {
        Self(u64::from(near.to_bits()) << 32 | u64::from(child.0))
    }

    #[inline(always)]
    fn near(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    #[inline(always)]
    fn child(self) -> Child {
        Child(self.0 as u32)
    }
}

/// Children that wait. Long enough for the tree, so that nothing is checked or allocated on the way.
#[derive(Default)]
pub(crate) struct Stack(Vec<Pending>);

thread_local! {
    /// The last traversal's stack, kept so that a ray costs no allocation. Taken while in use, so a procedural that
    /// traces rays of its own gets a new one.
    static STACK: Cell<Stack> = const { Cell::new(Stack(Vec::new())) };
}

/// Runs `work` with a stack that is long enough for a tree.
#[inline(always)]
pub(crate) fn with_stack<R>(bvh: &Bvh, work: impl FnOnce(&mut Stack) -> R) -> R {
    let mut stack = STACK.take();
    if stack.0.len() < bvh.stack_length {
        stack.0.resize(bvh.stack_length, Pending::NONE);
    }
    let result = work(&mut stack);
    STACK.set(stack);
    result
}

/// Traces one ray at the best level that there is.
pub(crate) struct Trace<'a, Q, W> {
    pub(crate) bvh: &'a Bvh,
    pub(crate) ray: &'a Ray,
    pub(crate) query: &'a mut Q,
    pub(crate) watch: &'a mut W,
}

impl<Q: Query, W: Watch> Trace<'_, Q, W> {
    #[inline(always)]
    pub(crate) fn go(self) {
        at_level(self.bvh.level, self);
    }
}

impl<Q: Query, W: Watch> Work for Trace<'_, Q, W> {
    type Output = ();
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { bvh, ray, query, watch } = self;
        let Some(ray) = Prepared::new(simd, ray) else { return };
        with_stack(
            bvh,
            #[inline(always)]
            |stack| outer(simd, bvh, &ray, query, watch, &mut stack.0),
        );
    }
}

/// Traces a ray through a tree and the trees in it.
#[inline(always)]
fn outer<S: Simd, Q: Query, W: Watch>(
    simd: S,
    bvh: &Bvh,
    ray: &Prepared,
    query: &mut Q,
    watch: &mut W,
    stack: &mut [Pending],
) -> bool {
    traverse(
        simd,
        bvh,
        ray,
        NONE,
        query,
        watch,
        stack,
        #[inline(always)]
        |leaf, query, watch, stack| match *leaf {
            Leaf::Instances { first, count } => instances(simd, bvh, ray, first, count, query, watch, stack),
            _ => primitives(bvh, ray, leaf, &mut Answer { instance: NONE, query, watch }),
        },
    )
}

/// Traces a ray through an instance's tree.
#[inline(always)]
fn inner<S: Simd, Q: Query, W: Watch>(
    simd: S,
    bvh: &Bvh,
    ray: &Prepared,
    instance: u32,
    query: &mut Q,
    watch: &mut W,
    stack: &mut [Pending],
) -> bool {
    traverse(
        simd,
        bvh,
        ray,
        instance,
        query,
        watch,
        stack,
        #[inline(always)]
        |leaf, query, watch, _| primitives(bvh, ray, leaf, &mut Answer { instance, query, watch }),
    )
}

/// Traces a ray through a tree. Returns true where the query wants no more.
#[inline(always)]
#[allow(clippy::too_many_arguments)] // One loop, and these are its state.
fn traverse<S: Simd, Q: Query, W: Watch>(
    simd: S,
    bvh: &Bvh,
    ray: &Prepared,
    instance: u32,
    query: &mut Q,
    watch: &mut W,
    stack: &mut [Pending],
    mut visit_leaf: impl FnMut(&Leaf, &mut Q, &mut W, &mut [Pending]) -> bool,
) -> bool {
    if bvh.nodes.is_empty() {
        return false;
    }
    let slabs = Slabs::new(simd, ray);
    let mut height = 0;
    let mut current = Child::ROOT;
    let mut end = ray.scaled_end(query.end());
    let mut waiting = None;
    'ray: loop {
        // Go down, each time to the nearest child that the ray enters; the others wait.
        while let Content::Node(number) = current.content() {
            watch.node(instance, number as u32);
            let node = &bvh.nodes[number];
            let entered = node.enter(simd, &slabs, end);
            match push::<S, Q>(node, &entered, stack, &mut height) {
                Some(child) => current = child,
                None => match pop(stack, &mut height, end) {
                    Some(child) => current = child,
                    None => break 'ray,
                },
            }
        }

        // Test what is in a leaf.
        let stop = match current.content() {
            Content::Triangles(number) => {
                let block = &bvh.triangles[number];
                triangles(
                    simd,
                    block,
                    ray,
                    &Sieve::new(simd, ray, bvh.largest),
                    &mut end,
                    &mut waiting,
                    &mut Answer { instance, query, watch },
                )
            }
            Content::Leaf(number) => visit_leaf(&bvh.leaves[number], query, watch, &mut stack[height..]),
            Content::Node(_) => false,
        };
        if stop {
            return true;
        }
        let decided = ray.scaled_end(query.end());
        end = if decided < end { decided } else { end };
        match pop(stack, &mut height, end) {
            Some(child) => current = child,
            None => break,
        }
    }
    waiting.is_some_and(|Waiting { block, lane, .. }| {
        decide(block, lane, ray, &mut Answer { instance, query, watch })
    })
}

/// The next child that is not beyond the end.
#[inline(always)]
fn pop(stack: &[Pending], height: &mut usize, end: f32) -> Option<Child> {
    while *height > 0 {
        *height -= 1;
        let pending = stack[*height];
        if pending.near() <= end {
            return Some(pending.child());
        }
    }
    None
}

/// Pushes the children that were entered but one, the nearest last, and returns that one, which is nearer.
#[inline(always)]
fn push<S: Simd, Q: Query>(
    node: &Node,
    entered: &Entered<S>,
    stack: &mut [Pending],
    height: &mut usize,
) -> Option<Child> {
    if entered.children == 0 {
        return None;
    }
    let mut children = entered.children;
    let first = next(node, entered, &mut children);
    if children == 0 {
        return Some(first.child());
    }
    let second = next(node, entered, &mut children);
    let (mut nearest, farther) =
        if Q::NEAREST_FIRST { (first.min(second), first.max(second)) } else { (first, second) };
    let bottom = *height;
    stack[bottom] = farther;
    *height += 1;
    while children != 0 {
        let mut waits = next(node, entered, &mut children);
        if Q::NEAREST_FIRST {
            (nearest, waits) = (nearest.min(waits), nearest.max(waits));
            // Insert: what is farther stays below.
            let mut place = *height;
            while place > bottom && stack[place - 1] < waits {
                stack[place] = stack[place - 1];
                place -= 1;
            }
            stack[place] = waits;
        } else {
            stack[*height] = waits;
        }
        *height += 1;
    }
    Some(nearest.child())
}

/// Takes the first of some children.
#[inline(always)]
fn next<S: Simd>(node: &Node, entered: &Entered<S>, children: &mut u32) -> Pending {
    let slot = children.trailing_zeros() as usize % WIDTH;
    *children &= children.wrapping_sub(1);
    Pending::new(entered.near[slot], node.child(slot))
}

/// Whom to tell.
struct Answer<'a, Q, W> {
    instance: u32,
    query: &'a mut Q,
    watch: &'a mut W,
}

#[inline(always)]
fn triangles<'a, S: Simd, Q: Query, W: Watch>(
    simd: S,
    block: &'a TriangleBlock,
    ray: &Prepared,
    sieve: &Sieve<S>,
    end: &mut f32,
    waiting: &mut Option<Waiting<'a>>,
    answer: &mut Answer<'_, Q, W>,
) -> bool {
    if W::LISTENS {
        for lane in 0..block.count() {
            let (geometry, primitive) = block.ids(lane);
            answer.watch.candidate(answer.instance, geometry, primitive);
        }
    }
    let sifted = block.filter(simd, sieve, *end);
    if Q::ANY_HIT && sifted.surely_hit != Chosen(0) {
        let (geometry, primitive) = block.ids(sifted.surely_hit.0.trailing_zeros() as usize);
        return answer.query.accept(Hit { t: ray.t_min, geometry, primitive, ..Hit::MISS });
    }
    for lane in sifted.kept {
        if Q::NEAREST_FIRST && sifted.surely_hit.0 >> lane & 1 != 0 {
            // A sure hit ends the ray; it is decided later, if none is surely nearer.
            let [first, last] = sifted.between();
            let (first, last) = (first[lane], last[lane]);
            if let Some(earlier) = waiting {
                if first > earlier.last {
                    continue;
                }
                if last >= earlier.first {
                    decide(earlier.block, earlier.lane, ray, answer);
                }
            }
            *waiting = Some(Waiting { block, lane, first, last });
            *end = if last < *end { last } else { *end };
        } else if decide(block, lane, ray, answer) {
            return true;
        }
    }
    false
}

/// A triangle that is surely hit, between two scaled t, and waits for its decision.
struct Waiting<'a> {
    block: &'a TriangleBlock,
    lane: usize,
    first: f32,
    last: f32,
}

/// Decides whether and where a triangle is hit, and tells.
#[inline(always)]
fn decide<Q: Query, W: Watch>(
    block: &TriangleBlock,
    lane: usize,
    ray: &Prepared,
    answer: &mut Answer<'_, Q, W>,
) -> bool {
    let Some(crossing) = triangle::decide(ray, &block.corners(lane), block.extent(lane)) else {
        return false;
    };
    let (geometry, primitive) = block.ids(lane);
    let triangle::Crossing { t, u, v } = crossing;
    answer.query.accept(Hit { t, u, v, primitive, geometry, instance: answer.instance })
}

/// Tests what is not a triangle and not an instance.
#[inline(never)]
fn primitives<Q: Query, W: Watch>(
    bvh: &Bvh,
    ray: &Prepared,
    leaf: &Leaf,
    answer: &mut Answer<'_, Q, W>,
) -> bool {
    match *leaf {
        Leaf::Spheres { first, count } => spheres(bvh, ray, first as usize, count, answer),
        Leaf::Procedurals { first, count } => procedurals(bvh, ray, first as usize, count, answer),
        Leaf::Instances { .. } => false,
    }
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
        let direction = ray.direction64.map(|x| x as f32);
        let asked = Ray { origin: ray.origin, t_min: ray.t_min, direction, t_max };
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

/// Not inlined, so that the loop over the outer tree keeps its registers; compiled for the level again inside.
#[inline(never)]
#[allow(clippy::too_many_arguments)]
fn instances<S: Simd, Q: Query, W: Watch>(
    simd: S,
    bvh: &Bvh,
    ray: &Prepared,
    first: u32,
    count: u32,
    query: &mut Q,
    watch: &mut W,
    stack: &mut [Pending],
) -> bool {
    let range = first as usize..(first + count) as usize;
    bvh.instances[range].iter().any(|instance| {
        debug_assert_ne!(instance.id, NONE);
        simd.vectorize(
            #[inline(always)]
            || {
                ray.in_object(simd, &instance.world_from_object, &instance.object_from_world).is_some_and(
                    |inside| inner(simd, &instance.bvh, &inside, instance.id, query, watch, stack),
                )
            },
        )
    })
}

#[cfg(test)]
mod tests {
    use crate::simd::levels;
    use crate::testing::Random;
    use crate::{Builder, Ray, Sphere, Triangles};

    #[test]
    fn every_level_gives_the_same_bits() {
        let mut random = Random::new(3);
        let (mut hits, mut misses) = (0, 0);
        for _ in 0..60 {
            let (center, size) = (random.point_with_exponents(-6, 6), random.size(-6, 6));
            let positions: Vec<[f32; 3]> = (0..600).map(|_| random.near(center, size)).collect();
            let indices: Vec<[u32; 3]> = (0..400).map(|_| [0; 3].map(|_| random.below(600))).collect();
            let mut builder = Builder::new();
            builder.triangles(Triangles { positions: &positions, indices: &indices });
            builder.spheres(&[Sphere { center: random.near(center, size), radius: 0.2 * size }]);
            let mut bvh = builder.build().unwrap();
            let rays: Vec<Ray> = (0..300)
                .map(|_| {
                    let origin = random.near(center, 2.0 * size);
                    let target = positions[random.below(600) as usize];
                    let toward = [0, 1, 2].map(|axis| target[axis] - origin[axis]);
                    let direction = if random.unit() < 0.7 { toward } else { random.direction() };
                    let t_max = if random.unit() < 0.5 { 1.0 } else { f32::INFINITY };
                    let t_min = if random.unit() < 0.2 { -1.0 } else { 0.0 };
                    Ray { origin, t_min, direction, t_max }
                })
                .collect();
            let mut answers = Vec::new();
            for level in levels() {
                bvh.level = level;
                let mut all = Vec::new();
                let answer: Vec<_> = rays
                    .iter()
                    .map(|ray| {
                        bvh.all_hits(ray, &mut all);
                        let closest = bvh.closest_hit(ray);
                        assert_eq!(all.first().copied(), closest.is_hit().then_some(closest), "{ray:?}");
                        assert_eq!(bvh.occluded(ray), closest.is_hit(), "{ray:?}");
                        let bits = [closest.t, closest.u, closest.v].map(f32::to_bits);
                        (bits, closest.primitive, closest.geometry, all.len())
                    })
                    .collect();
                answers.push(answer);
            }
            assert!(answers.iter().all(|answer| *answer == answers[0]));
            let found = answers[0].iter().filter(|answer| answer.3 > 0).count();
            hits += found;
            misses += rays.len() - found;
        }
        assert!(hits > 1000 && misses > 1000, "{hits} hits, {misses} misses");
    }
}
