//! The one loop: which primitives does a ray meet?
//!
//! Generic over what is asked ([`Query`]: the closest hit, any hit, all hits) and over who watches ([`Observer`]). Children are
//! visited from near to far; what lies beyond the query's current end is skipped. The order of visits never shows in
//! a result: ends are compared with room for errors (see `node`), and ties are decided by ids (see `Hit`).

use std::ops::Range;

use crate::Bvh;
use crate::bvh::{Leaf, SphereItem};
use crate::dispatch::dispatch;
use crate::exact::Exact;
use crate::filter::{Sieve, TriangleBlock};
use crate::instance::Instance;
use crate::node::{Child, Content, Slabs};
use crate::prepared::Prepared;
use crate::query::Query;
use crate::ray::{Hit, NONE, Ray};
use crate::selection::shown;
use crate::triangle::Crossing;
use crate::waiting::{Stack, Waiting, with_stack};
use crate::watch::Observer;
use crate::{sphere, triangle};
use lookfrom_simd::{Kernel, LaneMask, Simd};

/// Traces one ray at the best level that there is, and gives back the query. `ask` makes it: inside of the code for the level, so
/// that it may live in registers.
pub(crate) struct Trace<'a, F, W> {
    pub(crate) bvh: &'a Bvh,
    pub(crate) ray: &'a Ray,
    pub(crate) ask: F,
    pub(crate) watch: W,
}

impl<Q: Query, F: FnOnce(&Ray) -> Q, W: Observer> Trace<'_, F, W> {
    #[inline(always)]
    pub(crate) fn go(self) -> Q {
        dispatch(self.bvh.level, self)
    }
}

impl<Q: Query, F: FnOnce(&Ray) -> Q, W: Observer> Kernel for Trace<'_, F, W> {
    type Output = Q;
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Q {
        let Self { bvh, ray, ask, watch } = self;
        with_stack(
            #[inline(always)]
            |stack| trace(simd, bvh, ray, ask, watch, stack),
        )
    }
}

/// Traces a ray in the world.
#[inline(always)]
pub(crate) fn trace<S: Simd, Q: Query, W: Observer>(
    simd: S,
    bvh: &Bvh,
    ray: &Ray,
    ask: impl FnOnce(&Ray) -> Q,
    watch: W,
    stack: &mut Stack,
) -> Q {
    let mut answer = Answer { instance: NONE, query: ask(ray), watch };
    if bvh.nodes.is_empty() || !(ray.t_min < ray.t_max) {
        return answer.query;
    }
    let waiting = &mut Waiting { stack, bottom: 0, height: 0 };
    if let Some(shadow) = Prepared::usual(simd, ray, bvh.largest) {
        // Made anew where it is needed: few rays need it, and the black box keeps it from being made for all.
        let exact = || Exact::new(std::hint::black_box(ray));
        traverse(simd, bvh, &shadow, exact, &mut answer, waiting);
    } else {
        trace_any(simd, bvh, &Exact::new(ray), &mut answer, waiting);
    }
    answer.query
}

/// Traces any ray, in the world or in an object's space, through a tree that is not empty. Returns true where the query wants
/// no more, as all that follow.
///
/// Not inlined, so that the loop over the outer tree keeps its registers; compiled for the level again inside.
#[inline(never)]
fn trace_any<S: Simd, Q: Query, W: Observer>(
    simd: S,
    bvh: &Bvh,
    exact: &Exact,
    answer: &mut Answer<Q, W>,
    waiting: &mut Waiting<'_>,
) -> bool {
    simd.vectorize(
        #[inline(always)]
        || {
            Prepared::new(simd, exact, bvh.largest)
                .is_some_and(|shadow| traverse(simd, bvh, &shadow, || *exact, answer, waiting))
        },
    )
}

/// Takes a ray into instances.
fn instances<S: Simd, Q: Query, W: Observer>(
    simd: S,
    bvh: &Bvh,
    mut range: Range<usize>,
    exact: &Exact,
    answer: &mut Answer<Q, W>,
    waiting: &mut Waiting<'_>,
) -> bool {
    range.any(|place| {
        if Q::SELECTS && !answer.query.enter_instance(place) {
            return false;
        }
        let Instance { bvh, id, world_from_object, object_from_world } = &bvh.instances[place];
        let inside = exact.in_object(world_from_object, object_from_world);
        let Waiting { stack, height, .. } = waiting;
        answer.instance = *id;
        let stop =
            trace_any(simd, bvh, &inside, answer, &mut Waiting { stack, bottom: *height, height: *height });
        answer.instance = NONE;
        if Q::SELECTS {
            answer.query.leave_instance();
        }
        stop
    })
}

/// Traces a ray through one tree that is not empty.
#[inline(always)]
fn traverse<S: Simd, Q: Query, W: Observer>(
    simd: S,
    bvh: &Bvh,
    ray: &Prepared,
    exact: impl Fn() -> Exact + Copy,
    answer: &mut Answer<Q, W>,
    waiting: &mut Waiting<'_>,
) -> bool {
    let slabs = Slabs::new(simd, ray);
    let mut current = Child::ROOT;
    let mut end = ray.end(answer.query.end());
    let mut undecided = None;
    'ray: loop {
        // Go down, each time to the nearest child that the ray enters; the others wait.
        while let Content::Node(number) = current.content() {
            answer.watch.node(answer.instance, number as u32);
            let node = &bvh.nodes[number];
            let entered = node.enter(simd, &slabs, end);
            let next = if entered.children == 0 {
                waiting.pop(end)
            } else {
                Some(waiting.push_all_but_nearest::<S, Q>(node, &entered))
            };
            match next {
                Some(child) => current = child,
                None => break 'ray,
            }
        }

        // Test what is in a leaf.
        let stop = match current.content() {
            Content::Triangles(number) => {
                let block = &bvh.triangles[number];
                let sieve = Sieve::new(simd, ray);
                triangles(simd, block, &sieve, exact, &mut end, &mut undecided, answer)
            }
            Content::Leaf(number) => other_leaf(simd, bvh, &bvh.leaves[number], &exact(), answer, waiting),
            Content::Node(_) => false,
        };
        if stop {
            return true;
        }
        let decided = ray.end(answer.query.end());
        end = if decided < end { decided } else { end };
        match waiting.pop(end) {
            Some(child) => current = child,
            None => break,
        }
    }
    undecided.is_some_and(|Undecided { block, lane, .. }| cross_surely(block, lane, exact, answer))
}

/// Whom to tell.
pub(crate) struct Answer<Q, W> {
    /// In which instance the ray is.
    pub(crate) instance: u32,
    pub(crate) query: Q,
    pub(crate) watch: W,
}

#[inline(always)]
fn triangles<'a, S: Simd, Q: Query, W: Observer>(
    simd: S,
    block: &'a TriangleBlock,
    sieve: &Sieve<S>,
    exact: impl Fn() -> Exact,
    end: &mut f32,
    undecided: &mut Option<Undecided<'a>>,
    answer: &mut Answer<Q, W>,
) -> bool {
    if W::LISTENS {
        for lane in 0..block.count() {
            let (geometry, primitive) = block.ids(lane);
            answer.watch.candidate(answer.instance, geometry, primitive);
        }
    }
    let mut sifted = block.filter(simd, sieve, *end);
    if Q::SELECTS {
        let shown = shown(&answer.query, block, &exact(), sifted.kept);
        sifted.kept.0 &= shown;
        sifted.surely_hit.0 &= shown;
    }
    if Q::ANY_HIT && sifted.surely_hit != LaneMask(0) {
        let (geometry, primitive) = block.ids(sifted.surely_hit.0.trailing_zeros() as usize);
        return answer.query.accept(Hit { t: exact().t_min, geometry, primitive, ..Hit::MISS });
    }
    for lane in sifted.kept {
        if Q::NEAREST_FIRST && sifted.surely_hit.0 >> lane & 1 != 0 {
            // A sure hit ends the ray; it is decided later, if none is surely nearer.
            let [first, last] = sifted.between();
            let (first, last) = (first[lane], last[lane]);
            if let Some(earlier) = undecided {
                if first > earlier.last {
                    continue;
                }
                if last >= earlier.first {
                    decide(earlier.block, earlier.lane, &exact(), answer);
                }
            }
            *undecided = Some(Undecided { block, lane, first, last });
            *end = if last < *end { last } else { *end };
        } else if answer.instance == NONE && answer.query.leaves(block.ids(lane)) {
            // A ray that leaves a triangle is so near to it that the filter cannot tell; who asks can.
        } else if decide(block, lane, &exact(), answer) {
            return true;
        }
    }
    false
}

/// A triangle that is surely hit, between two distances, and waits for its decision.
struct Undecided<'a> {
    block: &'a TriangleBlock,
    lane: usize,
    first: f32,
    last: f32,
}

/// Decides whether and where a triangle is hit, and tells.
#[cold]
#[inline(never)]
pub(crate) fn decide<Q: Query, W: Observer>(
    block: &TriangleBlock,
    lane: usize,
    ray: &Exact,
    answer: &mut Answer<Q, W>,
) -> bool {
    triangle::decide(ray, &block.corners(lane), block.extent(lane))
        .is_some_and(|crossing| tell(crossing, block, lane, answer))
}

/// The same for a triangle that is surely hit.
///
/// Not inlined: compiled for AVX-512, its scattered loads become vectors of 512 bits, which slow down all that is around them.
#[inline(never)]
pub(crate) fn cross_surely<Q: Query, W: Observer>(
    block: &TriangleBlock,
    lane: usize,
    exact: impl Fn() -> Exact,
    answer: &mut Answer<Q, W>,
) -> bool {
    tell(triangle::cross_surely(&exact(), &block.corners(lane)), block, lane, answer)
}

/// Tells where a triangle is hit.
#[inline(always)]
fn tell<Q: Query, W: Observer>(
    crossing: Crossing,
    block: &TriangleBlock,
    lane: usize,
    answer: &mut Answer<Q, W>,
) -> bool {
    let (geometry, primitive) = block.ids(lane);
    let Crossing { t, u, v } = crossing;
    answer.query.accept(Hit { t, u, v, primitive, geometry, instance: answer.instance })
}

/// Tests what is not a triangle.
#[inline(never)]
fn other_leaf<S: Simd, Q: Query, W: Observer>(
    simd: S,
    bvh: &Bvh,
    leaf: &Leaf,
    ray: &Exact,
    answer: &mut Answer<Q, W>,
    waiting: &mut Waiting<'_>,
) -> bool {
    let range = |first: u32, count: u32| first as usize..(first + count) as usize;
    match *leaf {
        Leaf::Spheres { first, count } => spheres(&bvh.spheres[range(first, count)], ray, answer),
        Leaf::Procedurals { first, count } => procedurals(bvh, range(first, count), ray, answer),
        Leaf::Instances { first, count } => instances(simd, bvh, range(first, count), ray, answer, waiting),
    }
}

fn spheres<Q: Query, W: Observer>(spheres: &[SphereItem], ray: &Exact, answer: &mut Answer<Q, W>) -> bool {
    for item in spheres {
        let (geometry, primitive, instance) = (item.geometry, item.primitive, answer.instance);
        answer.watch.candidate(instance, geometry, primitive);
        if Q::SELECTS && !answer.query.shows(geometry, primitive) {
            continue;
        }
        let Some([t1, t2]) = sphere::decide(ray, &item.shape) else { continue };
        let roots = if t1 < t2 { &[t1, t2][..] } else { &[t1][..] };
        for (root, &t) in roots.iter().enumerate() {
            if t > ray.t_min
                && (!Q::SELECTS || answer.query.shows_face(|| root == 0))
                && answer.query.accept(Hit { t, u: 0.0, v: 0.0, primitive, geometry, instance })
            {
                return true;
            }
        }
    }
    false
}

fn procedurals<Q: Query, W: Observer>(
    bvh: &Bvh,
    range: Range<usize>,
    ray: &Exact,
    answer: &mut Answer<Q, W>,
) -> bool {
    for item in &bvh.procedurals[range] {
        let (geometry, primitive, instance) = (item.geometry, item.primitive, answer.instance);
        answer.watch.candidate(instance, geometry, primitive);
        if Q::SELECTS && !answer.query.shows(geometry, primitive) {
            continue;
        }
        // Ask one step beyond the end: a hit at the same t may win the tie.
        let t_max = answer.query.end().next_up();
        let [origin, direction] = [ray.origin, ray.direction].map(|x| x.map(|x| x as f32));
        let asked = Ray { origin, t_min: ray.t_min, direction, t_max };
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
