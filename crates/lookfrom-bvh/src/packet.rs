//! Packets: 64 coherent rays at once, such as those of neighbouring pixels.
//!
//! The packet traverses the tree as a whole, through every box that it may hit, by intervals of its rays' origins
//! and directions: Boulos, Wald, Shirley (2006), "Geometric and Arithmetic Culling Methods for Entire Ray Packets".
//! In a leaf the rays are processed in groups of eight, a ray in each lane: those that hit the leaf's box are
//! tested against one triangle after the other, by the same tests as single rays. Spheres, procedural shapes and
//! instances are left to the single-ray code, ray by ray. So the results are those of single rays, bit for bit.

use std::marker::PhantomData;

use crate::Bvh;
use crate::coherence::Coherence;
use crate::collector::PacketCollector;
use crate::conservative::{CommonOriginBlock, ConservativeTest, LARGEST_FILTERED, TriangleLanes};
use crate::exact::ExactRay;
use crate::leaf::other_leaf;
use crate::node::{Child, Content};
use crate::packet_bounds::{PacketBounds, seem_alike};
use crate::query::Settings;
use crate::ray::{Hit, NONE, Ray};
use crate::ray8::{GROUPS, LANES, NO_BLOCK, RAYS, Ray8, least};
use crate::stack::{Stack, TraversalStack};
use crate::traverse::{TraversalState, intersect_sure, report};
use crate::triangle;
use crate::visibility::{Faces, Visibility};
use lookfrom_simd::{LaneMask, Simd, i32x8, prelude::*};

/// Traces rays as a packet. Returns the rays that hit anything, bit i for ray i; closest hits are written to
/// `hits`. Returns `None` where the rays are too few, not coherent, or out of the usual range, or meet triangles one
/// by one; `hits` mean nothing then.
#[inline(never)]
pub(crate) fn trace_packet<'a, S: Simd, C: PacketCollector, V: Visibility<'a>>(
    simd: S,
    settings: &Settings<'a>,
    rays: &[Ray],
    hits: &mut [Hit],
    coherence: &mut Coherence,
    stack: &mut Stack,
) -> Option<u64> {
    let bvh = settings.bvh;
    if rays.len() < RAYS || !seem_alike(rays) || bvh.nodes.is_empty() || !(bvh.largest < LARGEST_FILTERED) {
        return None;
    }
    if !coherence.start() {
        return None;
    }
    simd.vectorize(
        #[inline(always)]
        || {
            let mut groups = [Ray8::empty(simd); GROUPS];
            for (index, (group, rays)) in groups.iter_mut().zip(rays.chunks_exact(LANES)).enumerate() {
                *group = Ray8::new(simd, rays);
                if V::HAS_ORIGIN {
                    group.set_origins(simd, |lane| settings.origin_of(index * LANES + lane));
                }
            }
            let packet_bounds = PacketBounds::around(simd, &groups, bvh.largest)?;
            if !C::ANY_HIT {
                hits[..RAYS].fill(Hit::MISS);
            }
            let mut packet =
                Packet::<S, C, V> { settings, rays, groups, hits, coherence, question: PhantomData };
            let stack = &mut TraversalStack { entries: stack, bottom: 0, height: 0 };
            let has_paid = packet.traverse(simd, &packet_bounds, stack);
            packet.coherence.end(has_paid);
            has_paid.then(|| packet.finish())
        },
    )
}

/// A packet during traversal.
struct Packet<'a, 'b, S: Simd, C, V> {
    settings: &'b Settings<'a>,
    rays: &'b [Ray],
    groups: [Ray8<S>; GROUPS],
    /// The closest hits that are exact; empty for any-hit queries.
    hits: &'b mut [Hit],
    coherence: &'b mut Coherence,
    question: PhantomData<(C, V)>,
}

impl<'a, S: Simd, C: PacketCollector, V: Visibility<'a>> Packet<'a, '_, S, C, V> {
    #[inline(always)]
    fn bvh(&self) -> &'a Bvh {
        self.settings.bvh
    }

    /// The end of the longest ray; −∞ when all are done.
    #[inline(always)]
    fn end(&self) -> f32 {
        let mut longest = self.groups[0].end;
        for group in &self.groups[1..] {
            longest = longest.max(group.end);
        }
        -least(-longest)
    }

    /// Returns false, before the end, where the packet does not pay.
    #[inline(always)]
    fn traverse(&mut self, simd: S, packet_bounds: &PacketBounds<S>, stack: &mut TraversalStack<'_>) -> bool {
        let mut end = self.end();
        let mut current = Some(Child::ROOT);
        while let Some(child) = current {
            let shortened = match child.content() {
                Content::Node(number) => {
                    let node = &self.bvh().nodes[number];
                    let entered = packet_bounds.enter(simd, node, end);
                    if entered.children != 0 {
                        current = Some(stack.push_all_but_nearest::<S, C>(node, &entered));
                        continue;
                    }
                    false
                }
                Content::Triangles(number) => self.triangles(simd, packet_bounds, number),
                Content::Leaf(number) => self.other_leaf(simd, number, stack),
            };
            if !self.coherence.pays() {
                return false;
            }
            if shortened {
                end = self.end();
            }
            current = stack.pop(end);
        }
        true
    }

    /// Tests a block of triangles. Returns false where no ray hits its box.
    #[inline(always)]
    fn triangles(&mut self, simd: S, packet_bounds: &PacketBounds<S>, number: usize) -> bool {
        let block = &self.bvh().triangles[number];
        let bounds = block.bounds(simd).padded();
        let mut meeting = [0; GROUPS];
        let mut any = 0;
        for (meeting, group) in meeting.iter_mut().zip(&self.groups) {
            *meeting = group.meet(&bounds);
            any |= *meeting;
        }
        self.coherence.count(&meeting);
        if any == 0 {
            return false;
        }
        // Occlusion rays rarely have a common origin.
        if !C::ANY_HIT
            && let Some(origin) = packet_bounds.common_origin
        {
            let common = CommonOriginBlock::new(simd, block, origin);
            self.test(simd, number, &mut meeting, |of, group| {
                common.test_conservatively(simd, of, &group.ray_lanes, group.length, group.end)
            });
        } else {
            self.test(simd, number, &mut meeting, |of, group| {
                TriangleLanes::splat(simd, block, of).test_conservatively(simd, &group.ray_lanes, group.end)
            });
        }
        true
    }

    /// Tests a block of triangles against those rays of each group that may hit it. For closest hits nothing here
    /// branches on the outcome of a test, because it could not be predicted.
    #[inline(always)]
    fn test(
        &mut self,
        simd: S,
        number: usize,
        meeting: &mut [u32; GROUPS],
        test_conservatively: impl Fn(usize, &Ray8<S>) -> ConservativeTest<S>,
    ) {
        let block = &self.bvh().triangles[number];
        let (visibility, count) = (V::of(self.settings, 0), block.count());
        for index in 0..GROUPS {
            for of in 0..count {
                let rays = meeting[index];
                if rays == 0 {
                    break;
                }
                let (geometry, primitive) = block.ids(of);
                if V::SELECTS && !visibility.shows(geometry, primitive) {
                    continue;
                }
                let group = &mut self.groups[index];
                let tested = test_conservatively(of, group);
                let (mut sure, mut kept) = (tested.sure, tested.kept.0 & rays);
                if V::HAS_ORIGIN {
                    let is_other = !group.start_on(simd, geometry, primitive);
                    sure &= is_other;
                    kept &= is_other.to_bitmask() as u32;
                }
                if V::SELECTS && visibility.faces() != Faces::Both {
                    // The sign of a sure hit's determinant is also sure.
                    let is_front = tested.looks_at_front();
                    sure &= if visibility.faces() == Faces::Front { is_front } else { !is_front };
                }
                let open = kept & !tested.surely_hit.0;
                if C::ANY_HIT {
                    // A ray that is surely occluded is done.
                    group.retire(simd, sure);
                    meeting[index] &= !(sure.to_bitmask() as u32);
                    for lane in LaneMask(open) {
                        if self.intersect_exact((number, of), index, lane) {
                            meeting[index] &= !(1 << lane);
                        }
                    }
                    continue;
                }

                // Defer the exact test of a sure hit, unless another hit is surely nearer.
                let [first, last] = tested.between();
                let nearer = sure & first.simd_le(group.last);
                let unclear = nearer & last.simd_ge(group.first);
                let (blocks, lanes) = (group.block, group.lane);
                group.first = nearer.select(first, group.first);
                group.last = nearer.select(last, group.last);
                group.end = nearer.select(last.min(group.end), group.end);
                group.block = nearer.select(i32x8::splat(simd, number as i32), blocks);
                group.lane = nearer.select(i32x8::splat(simd, of as i32), lanes);

                // Test exactly the hits that are not sure, and sure hits whose distances overlap.
                let unclear = unclear.to_bitmask() as u32 & rays;
                if open | unclear != 0 {
                    for lane in LaneMask(open) {
                        self.intersect_exact((number, of), index, lane);
                    }
                    for lane in LaneMask(unclear) {
                        self.intersect_exact((blocks[lane] as usize, lanes[lane] as usize), index, lane);
                    }
                }
            }
        }
    }

    /// Tests a ray exactly against a triangle that is not its origin primitive. Returns true if the ray is done.
    #[cold]
    #[inline(never)]
    fn intersect_exact(&mut self, (block, of): (usize, usize), index: usize, lane: usize) -> bool {
        let place = index * LANES + lane;
        let ray = ExactRay::new(&self.rays[place]);
        let block = &self.bvh().triangles[block];
        let corners = block.corners(of);
        let Some(crossing) = triangle::intersect_exact(&ray, &corners, block.extent(of)) else {
            return false;
        };
        let mut state = self.state(place);
        if V::SELECTS && !state.visibility.faces().shows(|| triangle::is_front(&ray, &corners)) {
            return false;
        }
        report(crossing, block, of, &mut state);
        self.update(place, &state.collector)
    }

    /// Tests the rays that hit the box of a leaf without triangles, one by one. Returns false if none does.
    #[inline(never)]
    fn other_leaf(&mut self, simd: S, number: usize, stack: &mut TraversalStack<'_>) -> bool {
        simd.vectorize(
            #[inline(always)]
            || {
                let bvh = self.bvh();
                let (leaf, bounds) = (&bvh.leaves[number], &bvh.leaf_bounds[number]);
                let mut any = false;
                for index in 0..GROUPS {
                    for lane in LaneMask(self.groups[index].meet(bounds)) {
                        any = true;
                        let place = index * LANES + lane;
                        let ray = ExactRay::new(&self.rays[place]);
                        let mut state = self.state(place);
                        other_leaf(simd, bvh, leaf, &ray, &mut state, stack);
                        self.update(place, &state.collector);
                    }
                }
                any
            },
        )
    }

    /// The current state of a ray.
    #[inline(always)]
    fn state(&self, place: usize) -> TraversalState<C, V, ()> {
        let hit = if C::ANY_HIT { Hit::MISS } else { self.hits[place] };
        let end = self.groups[place / LANES].end[place % LANES];
        let collector = C::resume(&self.rays[place], hit, end);
        let visibility = V::of(self.settings, place);
        TraversalState { instance: NONE, collector, visibility, observer: () }
    }

    /// Stores a ray's hit. Returns true if the ray is done.
    #[inline(always)]
    fn update(&mut self, place: usize, collector: &C) -> bool {
        let (group, lane) = (&mut self.groups[place / LANES], place % LANES);
        if !C::ANY_HIT {
            self.hits[place] = collector.hit();
            group.shorten(lane, collector.hit().t);
        } else if collector.found() {
            group.end[lane] = f32::NEG_INFINITY;
        }
        C::ANY_HIT && collector.found()
    }

    /// Intersects the deferred sure hits exactly. Returns the rays that hit anything.
    #[inline(always)]
    fn finish(&mut self) -> u64 {
        let mut found = 0;
        for place in 0..RAYS {
            let group = &self.groups[place / LANES];
            if C::ANY_HIT {
                found |= u64::from(group.end[place % LANES] == f32::NEG_INFINITY) << place;
                continue;
            }
            let (block, lane) = (group.block[place % LANES], group.lane[place % LANES]);
            if block != NO_BLOCK {
                let mut state = self.state(place);
                let block = &self.bvh().triangles[block as usize];
                intersect_sure(block, lane as usize, || ExactRay::new(&self.rays[place]), &mut state);
                self.hits[place] = state.collector.hit();
            }
            found |= u64::from(self.hits[place].is_hit()) << place;
        }
        found
    }
}

#[cfg(test)]
mod tests;
