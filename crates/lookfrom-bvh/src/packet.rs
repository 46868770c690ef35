//! Many rays at once, where they run nearly alike: 64 at a time, as from neighbouring pixels.
//!
//! The packet goes down the tree as one, through every box that it may touch, by intervals of what its rays are; Boulos, Wald,
//! Shirley (2006), "Geometric and Arithmetic Culling Methods for Entire Ray Packets". In a leaf the rays go by groups of
//! eight, a ray in each lane: those that meet the leaf's box are tested against one triangle after the other, by the same filter
//! and the same decision as single rays. So the answers are theirs, bit for bit.

use crate::Bvh;
use crate::aabb::Aabb;
use crate::exact::Exact;
use crate::node::{Child, Content, Entered, Node};
use crate::prepared::{self, FAR, LARGEST_RECIPROCAL, SHORT};
use crate::query::Closest;
use crate::ray::{Hit, NONE, Ray};
use crate::simd::{Chosen, Simd, Work, f32x8, i32x8, prelude::*};
use crate::traverse::{Answer, Stack, Waiting, cross_surely, decide, trace, with_stack};
use crate::triangle::{self, LARGEST_FILTERED, SeenBlock, Sieve, Sifted, TriangleLanes};

/// Rays in a group.
const LANES: usize = 8;

/// Groups in a packet.
const GROUPS: usize = 8;

/// Rays in a packet.
const SIZE: usize = LANES * GROUPS;

/// Directions of a packet differ by at most this part of their length.
const SPREAD: f32 = 0.25;

/// Origins of a packet differ by at most this part of the tree's largest coordinate.
const NEARNESS: f32 = 1.0 / 32.0;

/// The number of no block.
const NO_BLOCK: i32 = -1;

/// Far beyond every distance.
const BEYOND: f32 = 1e37;

/// The closest hits of rays, in their order; as many as there are places for.
pub(crate) struct TraceMany<'a> {
    pub(crate) bvh: &'a Bvh,
    pub(crate) rays: &'a [Ray],
    pub(crate) hits: &'a mut [Hit],
}

impl Work for TraceMany<'_> {
    type Output = ();
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { bvh, rays, hits } = self;
        with_stack(
            #[inline(always)]
            |stack| {
                for (rays, hits) in rays.chunks(SIZE).zip(hits.chunks_mut(SIZE)) {
                    if !trace_packet(simd, bvh, rays, hits, stack) {
                        trace_singly(simd, bvh, rays, hits, stack);
                    }
                }
            },
        );
    }
}

#[inline(never)]
fn trace_singly<S: Simd>(simd: S, bvh: &Bvh, rays: &[Ray], hits: &mut [Hit], stack: &mut Stack) {
    simd.vectorize(
        #[inline(always)]
        || {
            for (ray, hit) in rays.iter().zip(hits) {
                *hit = trace(simd, bvh, ray, Closest::new, (), stack).hit;
            }
        },
    );
}

/// Traces rays as a packet. False, and nothing done, where they are not alike, too few, or out of the usual range.
#[inline(never)]
fn trace_packet<S: Simd>(simd: S, bvh: &Bvh, rays: &[Ray], hits: &mut [Hit], stack: &mut Stack) -> bool {
    if rays.len() < SIZE
        || hits.len() < SIZE
        || !seem_alike(rays)
        || !bvh.leaves.is_empty()
        || !(bvh.largest < LARGEST_FILTERED)
    {
        return false;
    }
    simd.vectorize(
        #[inline(always)]
        || {
            let mut groups = [Group::empty(simd); GROUPS];
            for (group, rays) in groups.iter_mut().zip(rays.chunks_exact(LANES)) {
                *group = Group::new(simd, rays);
            }
            let Some(beam) = Beam::around(simd, &groups, bvh.largest) else { return false };
            hits[..SIZE].fill(Hit::MISS);
            let mut packet = Packet { bvh, rays, groups, hits };
            packet.traverse(simd, &beam, &mut Waiting { stack, bottom: 0, height: 0 });
            packet.finish();
            true
        },
    )
}

/// Whether the first and some other rays have like directions: a look before the work.
fn seem_alike(rays: &[Ray]) -> bool {
    let first = rays[0].direction;
    let length = first.iter().fold(0.0_f32, |length, x| length.max(x.abs()));
    [SIZE / 3, 2 * SIZE / 3, SIZE - 1]
        .iter()
        .all(|&other| (0..3).all(|axis| (rays[other].direction[axis] - first[axis]).abs() < SPREAD * length))
}

/// What holds for all rays of a packet, for a test of eight boxes at once.
struct Beam<S: Simd> {
    /// One of the origins.
    origin: [f32; 3],
    /// The origin of all rays, where that is one.
    common_origin: Option<[f32; 3]>,
    near_side: [usize; 3],
    /// Least and greatest 1 / direction, with room.
    reciprocal: [[f32x8<S>; 2]; 3],
    /// Least and greatest way from that origin to the others, in distances along the rays.
    offset: [[f32x8<S>; 2]; 3],
    t_min: i32x8<S>,
}

impl<S: Simd> Beam<S> {
    /// None where the rays are too different to go together, or not usual ones.
    #[inline(always)]
    fn around(simd: S, groups: &[Group<S>; GROUPS], largest: f32) -> Option<Self> {
        let mut usual = groups[0].usual;
        let mut t_min = groups[0].sieve.t_min;
        let (mut origins, mut directions) = ([groups[0].sieve.origin; 2], [groups[0].sieve.direction; 2]);
        for group in &groups[1..] {
            usual &= group.usual;
            t_min = t_min.min(group.sieve.t_min);
            for axis in 0..3 {
                let (o, d) = (group.sieve.origin[axis], group.sieve.direction[axis]);
                origins[0][axis] = origins[0][axis].min(o);
                origins[1][axis] = origins[1][axis].max(o);
                directions[0][axis] = directions[0][axis].min(d);
                directions[1][axis] = directions[1][axis].max(d);
            }
        }
        let boxed = |[min, max]: [[f32x8<S>; 3]; 2]| Aabb {
            min: [least(min[0]), least(min[1]), least(min[2])],
            max: [-least(-max[0]), -least(-max[1]), -least(-max[2])],
        };
        let (origins, directions) = (boxed(origins), boxed(directions));
        let greatest = |x: [f32; 3]| x.iter().fold(0.0_f32, |greatest, x| greatest.max(x.abs()));
        let spread = [0, 1, 2].map(|axis| directions.max[axis] - directions.min[axis]);
        let apart = [0, 1, 2].map(|axis| origins.max[axis] - origins.min[axis]);
        let alike = greatest(spread) < SPREAD * greatest(directions.min).min(greatest(directions.max))
            && greatest(apart) <= NEARNESS * largest;
        if usual != 0xff || !alike {
            return None;
        }

        let origin = origins.min;
        let splat = |[a, b]: [f32; 2]| [f32x8::splat(simd, a), f32x8::splat(simd, b)];
        let mut near_side = [0; 3];
        // An axis along which some rays go forth and some back limits nothing.
        let mut reciprocal = [[1.0 / BEYOND; 2]; 3];
        let mut offset = [[-BEYOND, BEYOND]; 3];
        for axis in 0..3 {
            let (slow, fast) = (directions.min[axis], directions.max[axis]);
            near_side[axis] = usize::from(fast < 0.0);
            if slow > SHORT || fast < -SHORT {
                let room = 4.0 * prepared::ROOM;
                let [a, b] = [1.0 / fast, 1.0 / slow];
                let (least, most) = (a.min(b), a.max(b));
                reciprocal[axis] = [least - least.abs() * room, most + most.abs() * room];
                let ways = [origins.min[axis] - origin[axis], origins.max[axis] - origin[axis]];
                let reach =
                    greatest([ways[0], ways[1], 0.0]) * greatest([least, most, 0.0]) * (1.0 + 2.0 * room);
                offset[axis] = [-reach, reach];
            }
        }
        Some(Self {
            origin,
            common_origin: (apart == [0.0; 3]).then_some(origin),
            near_side,
            reciprocal: reciprocal.map(splat),
            offset: offset.map(splat),
            t_min: i32x8::splat(simd, least(t_min).to_bits() as i32),
        })
    }

    /// Which children some ray may meet before the end, and where the first would. As [`Node::enter`] for one ray.
    #[inline(always)]
    fn enter(&self, simd: S, node: &Node, end: f32) -> Entered<S> {
        let way = |axis: usize, side: usize| node.face(simd, axis, side) - self.origin[axis];
        let near = |axis: usize| {
            let way = way(axis, self.near_side[axis]);
            let [least, most] = self.reciprocal[axis];
            ((way * least).min(way * most) - self.offset[axis][1]).bitcast::<i32x8<S>>()
        };
        let far = |axis: usize| {
            let way = way(axis, self.near_side[axis] ^ 1);
            let [least, most] = self.reciprocal[axis];
            ((way * least).max(way * most) - self.offset[axis][0]).bitcast::<i32x8<S>>()
        };
        let near = near(0).max(near(1)).max(near(2).max(self.t_min));
        let far = far(0).min(far(1)).min(far(2).min(i32x8::splat(simd, end.to_bits() as i32)));
        let missed = near.simd_gt(far).to_bitmask() as u32;
        Entered { children: missed ^ 0xff, near: near.bitcast() }
    }
}

/// The least of some numbers.
#[inline(always)]
fn least<S: Simd>(numbers: f32x8<S>) -> f32 {
    let numbers: [f32; LANES] = numbers.into();
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| smaller(numbers[i], numbers[i + 4]));
    smaller(smaller(a, b), smaller(c, d))
}

#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Eight rays, one in each lane.
#[derive(Clone, Copy)]
struct Group<S: Simd> {
    sieve: Sieve<S>,
    /// Which of them are usual rays; the others' lanes hold nothing of use.
    usual: u32,
    /// The longest component of their directions.
    length: f32x8<S>,
    near_reciprocal: [f32x8<S>; 3],
    far_reciprocal: [f32x8<S>; 3],
    near_product: [f32x8<S>; 3],
    far_product: [f32x8<S>; 3],
    end: f32x8<S>,
    /// Between which distances a sure hit lies that waits for its decision; ∞ where there is none.
    first: f32x8<S>,
    last: f32x8<S>,
    /// That hit's block and its lane in it.
    block: i32x8<S>,
    lane: i32x8<S>,
}

impl<S: Simd> Group<S> {
    /// No rays.
    #[inline(always)]
    fn empty(simd: S) -> Self {
        let zero = f32x8::splat(simd, 0.0);
        let (zeros, number) = ([zero; 3], i32x8::splat(simd, NO_BLOCK));
        Self {
            sieve: Sieve::of_rays(simd, zeros, zeros, zero, zero),
            usual: 0,
            length: zero,
            near_reciprocal: zeros,
            far_reciprocal: zeros,
            near_product: zeros,
            far_product: zeros,
            end: zero,
            first: zero,
            last: zero,
            block: number,
            lane: number,
        }
    }

    #[inline(always)]
    fn new(simd: S, rays: &[Ray]) -> Self {
        let row = |lane: usize| {
            let Ray { origin: [ox, oy, oz], t_min, direction: [dx, dy, dz], t_max } = rays[lane];
            f32x8::load_array(simd, [ox, oy, oz, t_min, dx, dy, dz, t_max])
        };
        let mut v = [row(0), row(1), row(2), row(3), row(4), row(5), row(6), row(7)];
        // Three times like shuffling cards, and rows are columns.
        for _ in 0..3 {
            let [a, b, c, d, e, f, g, h] = v;
            v = [
                a.zip_low(e),
                a.zip_high(e),
                b.zip_low(f),
                b.zip_high(f),
                c.zip_low(g),
                c.zip_high(g),
                d.zip_low(h),
                d.zip_high(h),
            ];
        }
        let [ox, oy, oz, t_min, dx, dy, dz, t_max] = v;
        let (origin, direction) = ([ox, oy, oz], [dx, dy, dz]);
        let greatest = |[x, y, z]: [f32x8<S>; 3]| x.abs().max(y.abs()).max(z.abs());
        let length = greatest(direction);
        let usual = greatest(origin).simd_lt(FAR)
            & length.simd_lt(1.0 / SHORT)
            & length.simd_gt(SHORT)
            & t_min.simd_ge(0.0)
            & t_min.simd_lt(t_max);
        let zero = f32x8::splat(simd, 0.0);
        let sum = |[x, y, z]: [f32x8<S>; 3]| x + y + z;
        let finite = ((sum(origin) + sum(direction)) * zero).simd_eq(zero);
        let cap = f32x8::splat(simd, LARGEST_RECIPROCAL);
        let slabs = |axis: usize| prepared::slabs(simd, origin[axis], direction[axis], cap, 0.0);
        let [x, y, z] = [slabs(0), slabs(1), slabs(2)];
        let first = (t_min - (t_min * prepared::ROOM + prepared::TINY)).max(0.0);
        let none = f32x8::splat(simd, f32::INFINITY);
        Self {
            usual: (usual & finite).to_bitmask() as u32 & 0xff,
            sieve: Sieve::of_rays(simd, origin, direction, first, length * triangle::ERROR),
            length,
            near_reciprocal: [x[0], y[0], z[0]],
            far_reciprocal: [x[1], y[1], z[1]],
            near_product: [x[2], y[2], z[2]],
            far_product: [x[3], y[3], z[3]],
            end: t_max + (t_max.abs() * prepared::ROOM + prepared::TINY),
            first: none,
            last: none,
            block: i32x8::splat(simd, NO_BLOCK),
            lane: i32x8::splat(simd, 0),
        }
    }

    /// Which rays meet a box before their ends.
    #[inline(always)]
    fn meet(&self, bounds: &Aabb) -> u32 {
        let mut near = self.sieve.t_min;
        let mut far = self.end;
        for axis in 0..3 {
            let [a, b] = [bounds.min[axis], bounds.max[axis]];
            let at = |face: f32| self.near_reciprocal[axis] * face - self.near_product[axis];
            near = near.max(at(a).min(at(b)));
            let at = |face: f32| self.far_reciprocal[axis] * face - self.far_product[axis];
            far = far.min(at(a).max(at(b)));
        }
        near.simd_le(far).to_bitmask() as u32 & 0xff
    }
}

/// A packet on its way.
struct Packet<'a, S: Simd> {
    bvh: &'a Bvh,
    rays: &'a [Ray],
    groups: [Group<S>; GROUPS],
    /// The closest hits that are decided.
    hits: &'a mut [Hit],
}

impl<S: Simd> Packet<'_, S> {
    /// The end of the longest ray.
    #[inline(always)]
    fn end(&self) -> f32 {
        let mut longest = self.groups[0].end;
        for group in &self.groups[1..] {
            longest = longest.max(group.end);
        }
        -least(-longest)
    }

    #[inline(always)]
    fn traverse(&mut self, simd: S, beam: &Beam<S>, waiting: &mut Waiting<'_>) {
        let mut end = self.end();
        let mut current = Some(Child::ROOT);
        while let Some(child) = current {
            if let Content::Node(number) = child.content() {
                let node = &self.bvh.nodes[number];
                let entered = beam.enter(simd, node, end);
                if entered.children != 0 {
                    current = Some(waiting.push_all_but_nearest::<S, Closest>(node, &entered));
                    continue;
                }
            } else if let Content::Triangles(number) = child.content()
                && self.leaf(simd, beam, number)
            {
                end = self.end();
            }
            current = waiting.pop(end);
        }
    }

    /// Tests a block of triangles. False where no ray meets its box.
    #[inline(always)]
    fn leaf(&mut self, simd: S, beam: &Beam<S>, number: usize) -> bool {
        let block = &self.bvh.triangles[number];
        let bounds = block.bounds(simd).padded();
        let mut meeting = [0; GROUPS];
        let mut any = 0;
        for (meeting, group) in meeting.iter_mut().zip(&self.groups) {
            *meeting = group.meet(&bounds);
            any |= *meeting;
        }
        if any == 0 {
            return false;
        }
        if let Some(origin) = beam.common_origin {
            let seen = SeenBlock::new(simd, block, origin);
            self.test(simd, number, &meeting, |of, group| {
                seen.sift(simd, of, &group.sieve, group.length, group.end)
            });
        } else {
            self.test(simd, number, &meeting, |of, group| {
                TriangleLanes::splat(simd, block, of).sift(simd, &group.sieve, group.end)
            });
        }
        true
    }

    /// Tests a block of triangles against those rays of each group that may meet it. Nothing here branches on what is hit: it could
    /// not be predicted.
    #[inline(always)]
    fn test(
        &mut self,
        simd: S,
        number: usize,
        meeting: &[u32; GROUPS],
        sift: impl Fn(usize, &Group<S>) -> Sifted<S>,
    ) {
        let count = self.bvh.triangles[number].count();
        let tests = (0..GROUPS)
            .filter(|&index| meeting[index] != 0)
            .flat_map(|index| (0..count).map(move |of| (index, of)));
        for (index, of) in tests {
            let rays = meeting[index];
            let group = &mut self.groups[index];
            let sifted = sift(of, group);

            // Put off the decision of a sure hit, unless another is surely nearer.
            let [first, last] = sifted.between();
            let nearer = sifted.sure & first.simd_le(group.last);
            let unclear = nearer & last.simd_ge(group.first);
            let (blocks, lanes) = (group.block, group.lane);
            group.first = nearer.select(first, group.first);
            group.last = nearer.select(last, group.last);
            group.end = nearer.select(last.min(group.end), group.end);
            group.block = nearer.select(i32x8::splat(simd, number as i32), blocks);
            group.lane = nearer.select(i32x8::splat(simd, of as i32), lanes);

            // Decide what the filter cannot tell, and sure hits that may be as near.
            let open = sifted.kept.0 & !sifted.surely_hit.0 & rays;
            let unclear = unclear.to_bitmask() as u32 & rays;
            if open | unclear != 0 {
                for lane in Chosen(open) {
                    self.decide((number, of), index, lane);
                }
                for lane in Chosen(unclear) {
                    self.decide((blocks[lane] as usize, lanes[lane] as usize), index, lane);
                }
            }
        }
    }

    /// Decides whether a ray meets a triangle.
    #[cold]
    #[inline(never)]
    fn decide(&mut self, (block, of): (usize, usize), index: usize, lane: usize) {
        let place = index * LANES + lane;
        let ray = &self.rays[place];
        let mut answer = self.answer(place);
        decide(&self.bvh.triangles[block], of, &Exact::new(ray), &mut answer);
        self.hits[place] = answer.query.hit;
        let end = smaller(ray.t_max, answer.query.hit.t);
        let end = end + (end.abs() * prepared::ROOM + prepared::TINY);
        let ends = &mut self.groups[index].end;
        ends[lane] = smaller(end, ends[lane]);
    }

    /// A ray's query as it stands.
    #[inline(always)]
    fn answer(&self, place: usize) -> Answer<Closest, ()> {
        Answer { instance: NONE, query: Closest::after(&self.rays[place], self.hits[place]), watch: () }
    }

    /// Decides where the sure hits are, and tells all.
    #[inline(always)]
    fn finish(&mut self) {
        for place in 0..SIZE {
            let group = &self.groups[place / LANES];
            let (block, lane) = (group.block[place % LANES], group.lane[place % LANES]);
            if block != NO_BLOCK {
                let mut answer = self.answer(place);
                let block = &self.bvh.triangles[block as usize];
                cross_surely(block, lane as usize, || Exact::new(&self.rays[place]), &mut answer);
                self.hits[place] = answer.query.hit;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::ray::{Hit, Ray};
    use crate::simd::levels;
    use crate::testing::Random;
    use crate::{Builder, Triangles};

    /// Neighbouring rays towards a target, from one origin or from several, some with an end, some of them odd.
    fn neighbours(random: &mut Random, target: [f32; 3], size: f32) -> Vec<Ray> {
        let from = random.near(target, 4.0 * size);
        let (lens, opening) = (random.unit() < 0.3, size * random.size(-3, 0));
        let ends = random.unit() < 0.3;
        let odd = random.unit() < 0.1;
        let mut ray = |number: u32| {
            let origin = if lens { random.near(from, 0.01 * size) } else { from };
            let towards = random.near(target, opening);
            let direction = [0, 1, 2].map(|axis| towards[axis] - origin[axis]);
            let t_max = if ends { 2.0 * random.unit() } else { f32::INFINITY };
            let t_min = if odd && number == 17 { f32::NAN } else { 0.0 };
            Ray { origin, t_min, direction, t_max }
        };
        (0..150).map(&mut ray).collect()
    }

    #[test]
    fn packets_say_what_single_rays_say() {
        let mut random = Random::new(9);
        let (mut hits, mut misses) = (0, 0);
        for _ in 0..60 {
            let (center, size) = (random.point_with_exponents(-6, 6), random.size(-6, 6));
            let mut positions: Vec<[f32; 3]> = (0..600).map(|_| random.near(center, size)).collect();
            // Doubled corners make flat and doubled triangles.
            for corner in 1..60 {
                positions[10 * corner] = positions[corner];
            }
            let mut indices: Vec<[u32; 3]> = (0..300).map(|_| [0; 3].map(|_| random.below(600))).collect();
            indices.extend_from_within(..30);
            let mut builder = Builder::new();
            builder.triangles(Triangles { positions: &positions, indices: &indices });
            let mut bvh = builder.build().unwrap();
            for _ in 0..10 {
                let target = positions[random.below(600) as usize];
                let rays = neighbours(&mut random, target, size);
                for level in levels() {
                    bvh.level = level;
                    let mut together = vec![Hit::MISS; rays.len()];
                    bvh.closest_hits(&rays, &mut together);
                    for (ray, hit) in rays.iter().zip(&together) {
                        assert_eq!(*hit, bvh.closest_hit(ray), "{ray:?}");
                    }
                    let hit = together.iter().filter(|hit| hit.is_hit()).count();
                    hits += hit;
                    misses += rays.len() - hit;
                }
            }
        }
        assert!(hits > 10_000 && misses > 10_000, "{hits} hits, {misses} misses");
    }
}
