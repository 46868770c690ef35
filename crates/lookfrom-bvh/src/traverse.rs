//! Traversal of rays, one at a time; its steps serve the traversal of several rays in turn too (see `interleaved`).
//!
//! Generic over the query ([`Collector`]: the closest hit, any hit, all hits), over the part of the geometry that
//! the ray sees ([`Visibility`]) and over who is told of it ([`Listener`]). Children are visited from near to far; subtrees beyond
//! the query's current end are skipped. The order of visits never affects a result: ends are compared with an error
//! margin (see `node`), and ties are decided by ids (see `Hit`).

use crate::bvh::Bvh;
use crate::collector::Collector;
use crate::conservative::{RayLanes, TriangleBlock};
use crate::exact::ExactRay;
use crate::node::{Child, Content, Slabs};
use crate::observer::Listener;
use crate::prepared::PreparedRay;
use crate::ray::{Hit, NONE, Ray};
use crate::stack::{Stack, TraversalStack};
use crate::triangle;
use crate::triangle::Crossing;
use crate::visibility::{Visibility, shown};
use lookfrom_simd::Simd;

mod leaf;

pub(crate) use leaf::other_leaf;

/// A ray's state during traversal: its instance, collector, visibility and observer.
pub(crate) struct TraversalState<C, V, O> {
    /// The instance that the ray is in.
    pub(crate) instance: u32,
    pub(crate) collector: C,
    pub(crate) visibility: V,
    pub(crate) observer: O,
}

/// Traces a ray in the world. Returns its state at the end.
#[inline(always)]
pub(crate) fn trace<'a, S: Simd, C: Collector, V: Visibility<'a>, O: Listener>(
    simd: S,
    bvh: &Bvh,
    ray: &Ray,
    start: impl FnOnce(&Ray) -> C,
    visibility: V,
    observer: O,
    stack: &mut Stack,
) -> TraversalState<C, V, O> {
    let mut state = TraversalState { instance: NONE, collector: start(ray), visibility, observer };
    if bvh.nodes.is_empty() || !(ray.t_min < ray.t_max) {
        return state;
    }
    let stack = &mut TraversalStack::above(stack, 0);
    if let Some(prepared) = PreparedRay::usual(simd, ray, bvh.largest) {
        // Recomputed where it is needed: few rays need it, and the black box prevents computing it for all.
        let exact = || ExactRay::new(std::hint::black_box(ray));
        traverse(simd, bvh, &prepared, exact, &mut state, stack);
    } else {
        trace_any(simd, bvh, &ExactRay::new(ray), &mut state, stack);
    }
    state
}

/// Traces any ray, in the world or in an object's space, through a tree that is not empty. Returns true if no more
/// hits are needed.
///
/// Not inlined, so that the loop over the outer tree keeps its registers; compiled for the level again inside.
#[inline(never)]
pub(crate) fn trace_any<'a, S: Simd, C: Collector, V: Visibility<'a>, O: Listener>(
    simd: S,
    bvh: &Bvh,
    exact: &ExactRay,
    state: &mut TraversalState<C, V, O>,
    stack: &mut TraversalStack<'_>,
) -> bool {
    simd.vectorize(
        #[inline(always)]
        || {
            PreparedRay::new(simd, exact, bvh.largest)
                .is_some_and(|prepared| traverse(simd, bvh, &prepared, || *exact, state, stack))
        },
    )
}

/// Traces a ray through one tree that is not empty.
#[inline(always)]
fn traverse<'a, S: Simd, C: Collector, V: Visibility<'a>, O: Listener>(
    simd: S,
    bvh: &Bvh,
    ray: &PreparedRay,
    exact: impl Fn() -> ExactRay + Copy,
    state: &mut TraversalState<C, V, O>,
    stack: &mut TraversalStack<'_>,
) -> bool {
    let slabs = Slabs::new(simd, ray);
    let mut path = TreePath::new(ray, state);
    'ray: loop {
        // Descend, each time to the nearest child that the ray enters.
        while let Content::Node(number) = path.current.content() {
            match path.enter(simd, bvh, number, &slabs, state, stack) {
                Some(child) => path.current = child,
                None => break 'ray,
            }
        }
        if path.test_leaf(simd, bvh, ray, exact, state, stack) {
            return true;
        }
        match path.leave_leaf(ray, state, stack) {
            Some(child) => path.current = child,
            None => break,
        }
    }
    path.finish(exact, state)
}

/// A ray's path through one tree: the visits of which all traversals of rays consist.
pub(crate) struct TreePath<'t> {
    /// The node or leaf to visit next.
    pub(crate) current: Child,
    /// The scaled distance beyond which nothing is visited.
    end: f32,
    deferred: Option<DeferredHit<'t>>,
}

impl<'t> TreePath<'t> {
    #[inline(always)]
    pub(crate) fn new<C: Collector, V, O>(ray: &PreparedRay, state: &TraversalState<C, V, O>) -> Self {
        Self { current: Child::ROOT, end: ray.end(state.collector.end()), deferred: None }
    }

    /// Visits a node. Returns the nearest child that the ray enters, after which the others go on the stack; if it
    /// enters none, the next from the stack.
    #[inline(always)]
    pub(crate) fn enter<S: Simd, C: Collector, V, O: Listener>(
        &self,
        simd: S,
        bvh: &Bvh,
        number: usize,
        slabs: &Slabs<S>,
        state: &mut TraversalState<C, V, O>,
        stack: &mut TraversalStack<'_>,
    ) -> Option<Child> {
        let node = &bvh.nodes[number];
        let entered = node.enter(simd, slabs, self.end);
        if let Some(observer) = state.observer.observer() {
            observer.node(state.instance, number as u32);
            observer.boxes(state.instance, node.count() as u32, entered.children.count_ones());
        }
        if entered.children == 0 {
            stack.pop(self.end)
        } else {
            Some(stack.push_all_but_nearest::<S, C>(node, &entered))
        }
    }

    /// Tests the primitives of a leaf. Returns true if no more hits are needed. `stack` is for the trees of instances.
    #[inline(always)]
    pub(crate) fn test_leaf<'a, S: Simd, C: Collector, V: Visibility<'a>, O: Listener>(
        &mut self,
        simd: S,
        bvh: &'t Bvh,
        ray: &PreparedRay,
        exact: impl Fn() -> ExactRay + Copy,
        state: &mut TraversalState<C, V, O>,
        stack: &mut TraversalStack<'_>,
    ) -> bool {
        match self.current.content() {
            Content::Triangles(number) => {
                let block = &bvh.triangles[number];
                let ray_lanes = RayLanes::new(simd, ray);
                triangles(simd, block, &ray_lanes, exact, &mut self.end, &mut self.deferred, state)
            }
            Content::Leaf(number) => {
                let ray = (&exact(), ray.is_usual());
                other_leaf(simd, bvh, &bvh.leaves[number], ray, state, stack)
            }
            Content::Node(_) => false,
        }
    }

    /// The next child from the stack, after a leaf.
    #[inline(always)]
    pub(crate) fn leave_leaf<C: Collector, V, O>(
        &mut self,
        ray: &PreparedRay,
        state: &TraversalState<C, V, O>,
        stack: &mut TraversalStack<'_>,
    ) -> Option<Child> {
        let decided = ray.end(state.collector.end());
        self.end = if decided < self.end { decided } else { self.end };
        stack.pop(self.end)
    }

    /// Ends the path with the exact test that was deferred. Returns true if no more hits are needed.
    #[inline(always)]
    pub(crate) fn finish<C: Collector, V, O>(
        &self,
        exact: impl Fn() -> ExactRay,
        state: &mut TraversalState<C, V, O>,
    ) -> bool {
        self.deferred
            .as_ref()
            .is_some_and(|&DeferredHit { block, lane, .. }| intersect_sure(block, lane, exact, state))
    }
}

#[inline(always)]
fn triangles<'a, 'b, S: Simd, C: Collector, V: Visibility<'b>, O: Listener>(
    simd: S,
    block: &'a TriangleBlock,
    ray_lanes: &RayLanes<S>,
    exact: impl Fn() -> ExactRay,
    end: &mut f32,
    deferred: &mut Option<DeferredHit<'a>>,
    state: &mut TraversalState<C, V, O>,
) -> bool {
    if let Some(observer) = state.observer.observer() {
        for lane in 0..block.count() {
            let (geometry, primitive) = block.ids(lane);
            observer.candidate(state.instance, geometry, primitive);
        }
    }
    let mut tested = block.test_conservatively(simd, ray_lanes, *end);
    if V::SELECTS {
        let shown = shown(&state.visibility, block, &exact(), tested.kept);
        tested.kept.0 &= shown;
        tested.surely_hit.0 &= shown;
    }
    if C::ANY_HIT {
        let is_hit = |&lane: &usize| !state.visibility.is_origin(state.instance, block.ids(lane));
        if let Some(lane) = tested.surely_hit.into_iter().find(is_hit) {
            let (geometry, primitive) = block.ids(lane);
            return state.collector.commit(Hit { t: exact().t_min, geometry, primitive, ..Hit::MISS });
        }
    }
    for lane in tested.kept {
        if V::HAS_ORIGIN && state.visibility.is_origin(state.instance, block.ids(lane)) {
            continue;
        }
        if C::NEAREST_FIRST && !C::ANY_HIT && tested.surely_hit.0 >> lane & 1 != 0 {
            // A sure hit ends the ray; its exact test is deferred, and skipped if another hit is surely nearer.
            let [first, last] = tested.between();
            let (first, last) = (first[lane], last[lane]);
            if let Some(earlier) = deferred {
                if first > earlier.last {
                    continue;
                }
                if last >= earlier.first {
                    intersect_exact(earlier.block, earlier.lane, &exact(), state);
                }
            }
            *deferred = Some(DeferredHit { block, lane, first, last });
            *end = if last < *end { last } else { *end };
        } else if intersect_exact(block, lane, &exact(), state) {
            return true;
        }
    }
    false
}

/// Tests the triangles of a block that lasts only for the test.
#[inline(always)]
pub(crate) fn test_block<'a, S: Simd, C: Collector, V: Visibility<'a>, O: Listener>(
    simd: S,
    block: &TriangleBlock,
    ray_lanes: &RayLanes<S>,
    exact: &ExactRay,
    end: &mut f32,
    state: &mut TraversalState<C, V, O>,
) -> bool {
    let mut deferred = None;
    triangles(simd, block, ray_lanes, || *exact, end, &mut deferred, state)
        || deferred.is_some_and(|hit| intersect_sure(hit.block, hit.lane, || *exact, state))
}

/// A sure hit with bounds of its distance, whose exact test is deferred.
struct DeferredHit<'a> {
    block: &'a TriangleBlock,
    lane: usize,
    first: f32,
    last: f32,
}

/// Intersects a triangle exactly and reports a hit.
#[cold]
#[inline(never)]
pub(crate) fn intersect_exact<C: Collector, V, O>(
    block: &TriangleBlock,
    lane: usize,
    ray: &ExactRay,
    state: &mut TraversalState<C, V, O>,
) -> bool {
    triangle::intersect_exact(ray, &block.corners(lane), block.extent(lane))
        .is_some_and(|crossing| report(crossing, block, lane, state))
}

/// Reports a sure hit, intersected exactly.
///
/// Not inlined: compiled for AVX-512, its scattered loads become vectors of 512 bits, which slow down the
/// surrounding code.
#[inline(never)]
pub(crate) fn intersect_sure<C: Collector, V, O>(
    block: &TriangleBlock,
    lane: usize,
    exact: impl Fn() -> ExactRay,
    state: &mut TraversalState<C, V, O>,
) -> bool {
    report(triangle::intersect_sure(&exact(), &block.corners(lane)), block, lane, state)
}

/// Reports a hit.
#[inline(always)]
pub(crate) fn report<C: Collector, V, O>(
    crossing: Crossing,
    block: &TriangleBlock,
    lane: usize,
    state: &mut TraversalState<C, V, O>,
) -> bool {
    let (geometry, primitive) = block.ids(lane);
    let Crossing { t, u, v } = crossing;
    state.collector.commit(Hit { t, u, v, primitive, geometry, instance: state.instance })
}

#[cfg(test)]
mod tests {
    use crate::dispatch::levels;
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
                        bvh.query().all_hits(ray, &mut all);
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
