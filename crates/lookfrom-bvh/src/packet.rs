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
use crate::query::{Closest, Query};
use crate::ray::{Hit, NONE, Ray};
use crate::simd::{Chosen, Simd, Work, f32x8, i32x8, prelude::*};
use crate::traverse::{Answer, Stack, Waiting, cross_surely, decide, trace, with_stack};
use crate::triangle::{self, LARGEST_FILTERED, Sieve, TriangleLanes};

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
    if rays.len() < SIZE || hits.len() < SIZE || !bvh.leaves.is_empty() || !(bvh.largest < LARGEST_FILTERED) {
        return false;
    }
    simd.vectorize(
        #[inline(always)]
        || {
            let Some(beam) = Beam::around(simd, rays, bvh.largest) else { return false };
            let Some(mut packet) = Packet::new(simd, bvh, rays) else { return false };
            packet.traverse(simd, &beam, &mut Waiting { stack, bottom: 0, height: 0 });
            packet.finish(hits);
            true
        },
    )
}

/// What holds for all rays of a packet, for a test of eight boxes at once.
struct Beam<S: Simd> {
    /// One of the origins.
    origin: [f32; 3],
    near_side: [usize; 3],
    /// Least and greatest 1 / direction, with room.
    reciprocal: [[f32x8<S>; 2]; 3],
    /// Least and greatest way from that origin to the others, in distances along the rays.
    offset: [[f32x8<S>; 2]; 3],
    t_min: i32x8<S>,
}

impl<S: Simd> Beam<S> {
    /// None where the rays are too different to go together.
    #[inline(always)]
    fn around(simd: S, rays: &[Ray], largest: f32) -> Option<Self> {
        let mut origins = Aabb::EMPTY;
        let mut directions = Aabb::EMPTY;
        let mut t_min = f32::INFINITY;
        for ray in rays {
            origins.extend(ray.origin);
            directions.extend(ray.direction);
            t_min = t_min.min(ray.t_min);
        }
        let greatest = |x: [f32; 3]| x.iter().fold(0.0_f32, |greatest, x| greatest.max(x.abs()));
        let spread = [0, 1, 2].map(|axis| directions.max[axis] - directions.min[axis]);
        let apart = [0, 1, 2].map(|axis| origins.max[axis] - origins.min[axis]);
        let alike = greatest(spread) < SPREAD * greatest(directions.min).min(greatest(directions.max))
            && greatest(apart) <= NEARNESS * largest;
        if !alike {
            return None;
        }

        let origin = rays[0].origin;
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
            near_side,
            reciprocal: reciprocal.map(splat),
            offset: offset.map(splat),
            t_min: i32x8::splat(simd, (t_min * (1.0 - prepared::ROOM)).to_bits() as i32),
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

/// Eight rays, one in each lane.
struct Group<S: Simd> {
    sieve: Sieve<S>,
    near_reciprocal: [f32x8<S>; 3],
    far_reciprocal: [f32x8<S>; 3],
    near_product: [f32x8<S>; 3],
    far_product: [f32x8<S>; 3],
    end: f32x8<S>,
    /// Between which distances a sure hit lies that waits for its decision; ∞ where there is none.
    first: f32x8<S>,
    last: f32x8<S>,
    /// That hit's block and lane.
    sure: [(u32, u32); LANES],
}

impl<S: Simd> Group<S> {
    /// None where a ray is not a usual one.
    #[inline(always)]
    fn new(simd: S, rays: &[Ray]) -> Option<Self> {
        let lanes = |of: &dyn Fn(&Ray) -> f32| {
            f32x8::load_array(
                simd,
                std::array::from_fn(
                    #[inline(always)]
                    |lane| of(&rays[lane]),
                ),
            )
        };
        let origin = [lanes(&|ray| ray.origin[0]), lanes(&|ray| ray.origin[1]), lanes(&|ray| ray.origin[2])];
        let direction =
            [lanes(&|ray| ray.direction[0]), lanes(&|ray| ray.direction[1]), lanes(&|ray| ray.direction[2])];
        let (t_min, t_max) = (lanes(&|ray| ray.t_min), lanes(&|ray| ray.t_max));
        let greatest = |[x, y, z]: [f32x8<S>; 3]| x.abs().max(y.abs()).max(z.abs());
        let length = greatest(direction);
        let usual = greatest(origin).simd_lt(FAR)
            & length.simd_lt(1.0 / SHORT)
            & length.simd_gt(SHORT)
            & t_min.simd_ge(0.0)
            & t_min.simd_lt(t_max);
        let nan = f32x8::splat(simd, 0.0);
        let finite = (origin[0] * nan + origin[1] * nan + origin[2] * nan).simd_eq(nan)
            & (direction[0] * nan + direction[1] * nan + direction[2] * nan).simd_eq(nan);
        if !(usual & finite).all_true() {
            return None;
        }

        let cap = f32x8::splat(simd, LARGEST_RECIPROCAL);
        let slabs = [0, 1, 2].map(
            #[inline(always)]
            |axis| prepared::slabs(simd, origin[axis], direction[axis], cap, 0.0),
        );
        let first = (t_min - (t_min * prepared::ROOM + prepared::TINY)).max(0.0);
        let none = f32x8::splat(simd, f32::INFINITY);
        Some(Self {
            sieve: Sieve::of_rays(simd, origin, direction, first, length * triangle::ERROR),
            near_reciprocal: slabs.map(|slab| slab[0]),
            far_reciprocal: slabs.map(|slab| slab[1]),
            near_product: slabs.map(|slab| slab[2]),
            far_product: slabs.map(|slab| slab[3]),
            end: t_max + (t_max.abs() * prepared::ROOM + prepared::TINY),
            first: none,
            last: none,
            sure: [(NONE, 0); LANES],
        })
    }

    /// Which rays meet a box before their ends.
    #[inline(always)]
    fn meet(&self, bounds: &Aabb) -> u32 {
        let mut near = self.sieve.t_min();
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
    answers: [Answer<Closest, ()>; SIZE],
}

impl<'a, S: Simd> Packet<'a, S> {
    #[inline(always)]
    fn new(simd: S, bvh: &'a Bvh, rays: &'a [Ray]) -> Option<Self> {
        let mut groups = [const { None }; GROUPS];
        for (group, rays) in groups.iter_mut().zip(rays.chunks_exact(LANES)) {
            *group = Some(Group::new(simd, rays)?);
        }
        let groups = groups.map(|group| group.expect("as many chunks as groups"));
        let answers =
            std::array::from_fn(|i| Answer { instance: NONE, query: Closest::new(&rays[i]), watch: () });
        Some(Self { bvh, rays, groups, answers })
    }

    /// The end of the longest ray.
    #[inline(always)]
    fn end(&self) -> f32 {
        let longest = self.groups.iter().map(|group| group.end).reduce(
            #[inline(always)]
            |a, b| a.max(b),
        );
        longest.map_or(0.0, |ends| ends.as_slice().iter().fold(0.0, |a, &b| if a > b { a } else { b }))
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
                && self.leaf(simd, number)
            {
                end = self.end();
            }
            current = waiting.pop(end);
        }
    }

    /// Tests a block of triangles. Whether something was hit.
    #[inline(always)]
    fn leaf(&mut self, simd: S, number: usize) -> bool {
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
        let mut hit = false;
        for lane in 0..block.count() {
            let triangle = TriangleLanes::splat(simd, block, lane);
            for index in 0..GROUPS {
                if meeting[index] != 0 {
                    hit |= self.test(simd, &triangle, (number, lane), index, meeting[index]);
                }
            }
        }
        hit
    }

    /// Tests a triangle against some rays of a group.
    #[inline(always)]
    fn test(
        &mut self,
        simd: S,
        triangle: &TriangleLanes<S>,
        place: (usize, usize),
        index: usize,
        rays: u32,
    ) -> bool {
        let group = &mut self.groups[index];
        let sifted = triangle.sift(simd, &group.sieve, group.end);
        let kept = sifted.kept.0 & rays;
        if kept == 0 {
            return false;
        }
        let sure = sifted.surely_hit.0 & rays;
        for lane in Chosen(kept & !sure) {
            self.decide(place, index, lane);
        }
        if sure != 0 {
            // Put off the decision, unless another sure hit is surely nearer; decide that where it may be as near.
            let group = &self.groups[index];
            let [first, last] = sifted.between();
            let nearer = sure & first.simd_le(group.last).to_bitmask() as u32;
            let unclear = nearer & last.simd_ge(group.first).to_bitmask() as u32;
            for lane in Chosen(unclear) {
                let (block, of) = self.groups[index].sure[lane];
                self.decide((block as usize, of as usize), index, lane);
            }
            let group = &mut self.groups[index];
            for lane in Chosen(nearer) {
                group.first[lane] = first[lane];
                group.last[lane] = last[lane];
                group.end[lane] = if last[lane] < group.end[lane] { last[lane] } else { group.end[lane] };
                group.sure[lane] = (place.0 as u32, place.1 as u32);
            }
        }
        true
    }

    /// Decides whether a ray meets a triangle.
    #[cold]
    #[inline(never)]
    fn decide(&mut self, (block, of): (usize, usize), index: usize, lane: usize) {
        let ray = &self.rays[index * LANES + lane];
        let answer = &mut self.answers[index * LANES + lane];
        decide(&self.bvh.triangles[block], of, &Exact::new(ray), answer);
        let t = answer.query.end();
        let end = t + (t.abs() * prepared::ROOM + prepared::TINY);
        let ends = &mut self.groups[index].end;
        ends[lane] = if end < ends[lane] { end } else { ends[lane] };
    }

    /// Decides where the sure hits are, and tells all.
    #[inline(always)]
    fn finish(mut self, hits: &mut [Hit]) {
        for (index, (hit, answer)) in hits.iter_mut().zip(&mut self.answers).enumerate() {
            let (block, lane) = self.groups[index / LANES].sure[index % LANES];
            if block != NONE {
                let block = &self.bvh.triangles[block as usize];
                cross_surely(block, lane as usize, || Exact::new(&self.rays[index]), answer);
            }
            *hit = answer.query.hit;
        }
    }
}
