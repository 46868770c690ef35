//! Packets: 64 coherent rays at once, such as those of neighbouring pixels.
//!
//! The packet traverses the tree as a whole, through every box that it may hit, by intervals of its rays' origins
//! and directions: Boulos, Wald, Shirley (2006), "Geometric and Arithmetic Culling Methods for Entire Ray Packets".
//! In a leaf the rays are processed in groups of eight, a ray in each lane: those that hit the leaf's box are
//! tested against one triangle or sphere after the other, by the same tests as single rays (against triangles two groups
//! at a time, where vectors are as wide). From a common origin most
//! triangles are excluded for a whole group first (see `common_origin`). Procedural shapes are asked for a group at once; instances
//! are left to the single-ray code, ray by ray. So the results are those of single rays, bit for bit.
//!
//! Trees of very few primitives need no traversal: any rays form packets, which are tested against everything.

use std::marker::PhantomData;

use crate::aabb::Aabb;
use crate::bvh::Bvh;
use crate::coherence::Coherence;
use crate::collector::PacketCollector;
use crate::eight_rays::EightRays;
use crate::error_bounds::LARGEST_FILTERED;
use crate::exact::ExactRay;
use crate::item::{Leaf, ProceduralItem};
use crate::lanes::{LANES, least, least_of_each};
use crate::node::{Child, Content, WIDTH};
use crate::packet_bounds::{PacketBounds, seem_alike};
use crate::procedural::ProceduralHit;
use crate::ray::{Hit, NONE, Ray};
use crate::ray8::{GROUPS, NO_BLOCK, RAYS, Ray8, Slabs8};
use crate::settings::Settings;
use crate::stack::{Stack, TraversalStack};
use crate::statistics::Statistics;
use crate::traverse::{TraversalState, other_leaf};
use crate::visibility::Visibility;
use lookfrom_simd::{LaneMask, Simd, f32x8, prelude::*};
use one_triangle::Pairs;

/// Number of rays from which on a packet is worthwhile that is not full, where any rays form packets.
const FEWEST: usize = 5;

/// Traces rays as a packet. Writes closest hits to `hits`, or returns the rays of an any-hit query that hit anything, bit i
/// for ray i. Returns `None` where the rays are too few, not coherent, or out of the usual range, or meet triangles one
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
    if bvh.nodes.is_empty() || !(bvh.largest < LARGEST_FILTERED) {
        return None;
    }
    let (is_tiny, is_full) = (is_tiny::<C>(bvh), rays.len() >= RAYS);
    if !(is_tiny && rays.len() >= FEWEST || is_full && seem_alike(rays) && coherence.start()) {
        return None;
    }
    simd.vectorize(
        #[inline(always)]
        || {
            let mut groups = [Ray8::empty(simd); GROUPS];
            let mut are_usual = true;
            for (index, (group, rays)) in groups.iter_mut().zip(rays.chunks(LANES)).enumerate() {
                *group = if rays.len() == LANES { Ray8::new(simd, rays) } else { Ray8::of_few(simd, rays) };
                are_usual &= group.usual == 0xff;
                if V::HAS_ORIGIN {
                    group.set_origins(simd, |lane| settings.origin_of(index * LANES + lane));
                }
            }
            let packet_bounds = match is_full && !(is_tiny && visits_all::<C>(bvh, rays)) {
                true => PacketBounds::around(simd, &groups, bvh.largest),
                false => None,
            };
            if !are_usual || packet_bounds.is_none() && !is_tiny {
                return None;
            }
            if !C::ANY_HIT {
                hits[..rays.len()].fill(Hit::MISS);
            }
            let mut packet = Packet::<S, C, V> {
                settings,
                rays,
                groups: &mut groups,
                slabs: None,
                pairs: None,
                hits,
                coherence,
                large: match packet_bounds {
                    Some(_) => f32::INFINITY,
                    None => bvh.bounds().half_area() * Pairs::<S>::LARGE,
                },
                question: PhantomData,
            };
            let stack = &mut TraversalStack::above(stack, 0);
            match packet_bounds {
                Some(packet_bounds) => {
                    let has_paid = packet.traverse(simd, &packet_bounds, stack, is_tiny);
                    if !is_tiny {
                        packet.coherence.end(has_paid);
                    }
                    if !has_paid {
                        return None;
                    }
                }
                None => packet.visit_all(simd, stack),
            }
            Some(packet.finish(simd))
        },
    )
}

/// Whether a tree has so few primitives that it is fastest to test any eight rays at once against all of them: measured
/// by `small_bench`. Four spheres cost as much as three triangles; rays of any-hit queries are soon done.
fn is_tiny<C: PacketCollector>(bvh: &Bvh) -> bool {
    let Statistics { triangles, spheres, procedurals, instances, .. } = bvh.statistics;
    let most = if C::ANY_HIT { 72 } else { 48 };
    4 * triangles + 3 * spheres + 4 * procedurals <= 4 * most && instances == 0
}

/// Whether the bounds of a full packet are not worth their cost: rays of several origins in a tree of very few leaves.
fn visits_all<C: PacketCollector>(bvh: &Bvh, rays: &[Ray]) -> bool {
    const FEW: usize = 3;
    bvh.triangles.len() + bvh.leaves.len() <= FEW && (C::ANY_HIT || rays[0].origin != rays[RAYS - 1].origin)
}

/// A packet during traversal.
struct Packet<'a, 'b, S: Simd, C, V> {
    settings: &'b Settings<'a>,
    rays: &'b [Ray],
    groups: &'b mut [Ray8<S>; GROUPS],
    /// For the tests of boxes, when the first one comes.
    slabs: Option<[Slabs8<S>; GROUPS]>,
    /// For the tests of triangles, likewise.
    pairs: Option<Pairs<S>>,
    /// The closest hits that are exact; empty for any-hit queries.
    hits: &'b mut [Hit],
    coherence: &'b mut Coherence,
    /// Half the area from which on a box is met by most groups: infinite for coherent rays.
    large: f32,
    question: PhantomData<(C, V)>,
}

impl<'a, S: Simd, C: PacketCollector, V: Visibility<'a>> Packet<'a, '_, S, C, V> {
    #[inline(always)]
    fn bvh(&self) -> &'a Bvh {
        self.settings.bvh
    }

    /// The end of each group's longest ray; −∞ when all are done.
    #[inline(always)]
    fn ends(&self) -> f32x8<S> {
        let [a, b, c, d, e, f, g, h] = &*self.groups;
        let ends = [-a.end, -b.end, -c.end, -d.end, -e.end, -f.end, -g.end, -h.end];
        -least_of_each(ends)
    }

    /// Returns false, before the end, where the packet does not pay.
    #[inline(always)]
    fn traverse(
        &mut self,
        simd: S,
        packet_bounds: &PacketBounds<S>,
        stack: &mut TraversalStack<'_>,
        pays_anyway: bool,
    ) -> bool {
        let mut ends = self.ends();
        let mut end = -least(-ends);
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
                Content::Triangles(number) => match packet_bounds.common_origin {
                    // Occlusion rays rarely have a common origin.
                    Some(origin) if !C::ANY_HIT => {
                        self.triangles_from(simd, origin, packet_bounds, number, ends, end)
                    }
                    _ => self.triangles(simd, number),
                },
                Content::Leaf(number) => self.other_leaf(simd, number, stack),
            };
            if !pays_anyway && !self.coherence.pays() {
                return false;
            }
            if shortened {
                ends = self.ends();
                end = -least(-ends);
            }
            current = stack.pop(end);
        }
        true
    }

    /// Visits all leaves.
    #[inline(always)]
    fn visit_all(&mut self, simd: S, stack: &mut TraversalStack<'_>) {
        for node in &self.bvh().nodes {
            for slot in 0..WIDTH {
                match node.child(slot).content() {
                    Content::Triangles(number) => self.triangles(simd, number),
                    Content::Leaf(number) => self.other_leaf(simd, number, stack),
                    Content::Node(_) => false,
                };
            }
        }
    }

    /// Whether to test triangles against all rays costs less than to test their box first.
    #[inline(always)]
    fn mostly_meets(&self, bounds: &Aabb) -> bool {
        bounds.half_area() > self.large
    }

    /// The rays of each group that are not done.
    #[inline(always)]
    fn under_way(&self) -> [u32; GROUPS] {
        let mut rays = [0; GROUPS];
        for index in 0..GROUPS {
            rays[index] = self.groups[index].end.simd_gt(f32::NEG_INFINITY).to_bitmask() as u32 & 0xff;
        }
        rays
    }

    /// The rays of each group that hit a box before their ends.
    #[inline(always)]
    fn meet(&mut self, simd: S, bounds: &Aabb) -> [u32; GROUPS] {
        let groups = &*self.groups;
        // Without closures, which would not be compiled for the level.
        if self.slabs.is_none() {
            self.slabs = Some(Slabs8::of_groups(simd, groups));
        }
        let mut meeting = [0; GROUPS];
        let Some(slabs) = &self.slabs else { return meeting };
        for index in 0..GROUPS {
            meeting[index] = slabs[index].meet(&groups[index], bounds);
        }
        meeting
    }

    /// Tests the rays that hit the box of a leaf without triangles: spheres and procedural shapes in lanes, others ray by ray. Returns
    /// false if none does.
    #[inline(never)]
    fn other_leaf(&mut self, simd: S, number: usize, stack: &mut TraversalStack<'_>) -> bool {
        simd.vectorize(
            #[inline(always)]
            || {
                let bvh = self.bvh();
                let (leaf, bounds) = (&bvh.leaves[number], &bvh.leaf_bounds[number]);
                let meeting = self.meet(simd, bounds);
                self.coherence.count(&meeting);
                match *leaf {
                    Leaf::Spheres { block } => {
                        self.spheres(simd, &bvh.spheres[block as usize], &meeting);
                        return meeting != [0; GROUPS];
                    }
                    Leaf::Procedurals { first, count } => {
                        let items = first as usize..(first + count) as usize;
                        self.procedurals(&bvh.procedurals[items], &meeting);
                        return meeting != [0; GROUPS];
                    }
                    Leaf::Capsules { .. } | Leaf::Instances { .. } => {}
                }
                for index in 0..GROUPS {
                    for lane in LaneMask(meeting[index]) {
                        let place = index * LANES + lane;
                        let ray = ExactRay::new(&self.rays[place]);
                        let mut state = self.state(place);
                        other_leaf(simd, bvh, leaf, (&ray, true), &mut state, stack);
                        self.update(place, &state.collector);
                    }
                }
                meeting != [0; GROUPS]
            },
        )
    }

    /// Tests procedural shapes against the rays that hit the box around them, eight side by side.
    #[inline(never)]
    fn procedurals(&mut self, items: &[ProceduralItem], meeting: &[u32; GROUPS]) {
        let bvh = self.bvh();
        for item in items {
            let ProceduralItem { geometry, primitive, .. } = *item;
            let Some(shapes) = bvh.shapes_of(item) else { continue };
            for (index, &meeting) in meeting.iter().enumerate() {
                let wanted = self.wanted(index, meeting, item);
                if wanted == 0 {
                    continue;
                }
                let asked = self.asked(index);
                let found = shapes.intersect_eight(primitive, &asked, wanted);
                for lane in LaneMask(wanted) {
                    let Some(ProceduralHit { t, u, v }) = found[lane] else { continue };
                    let place = index * LANES + lane;
                    if t > asked.t_min[lane] {
                        let mut state = self.state(place);
                        state.collector.commit(Hit { t, u, v, primitive, geometry, instance: NONE });
                        self.update(place, &state.collector);
                    }
                }
            }
        }
    }

    /// The rays of a group that are under way and see a shape, of those that meet its box.
    #[inline(always)]
    fn wanted(&self, index: usize, meeting: u32, item: &ProceduralItem) -> u32 {
        let mut wanted = 0;
        for lane in LaneMask(meeting) {
            let is_seen = !V::SELECTS
                || V::of(self.settings, index * LANES + lane).shows(item.geometry, item.primitive);
            let is_under_way = self.groups[index].end[lane] > f32::NEG_INFINITY;
            wanted |= u32::from(is_seen && is_under_way) << lane;
        }
        wanted
    }

    /// The rays of a group, up to a little beyond what is nearest so far: a hit at the same t may win the tie.
    #[inline(always)]
    fn asked(&self, index: usize) -> EightRays {
        let Ray8 { origin: [ox, oy, oz], direction: [dx, dy, dz], range: [t_min, _], end, .. } =
            self.groups[index];
        EightRays {
            origin: [ox.into(), oy.into(), oz.into()],
            t_min: t_min.into(),
            direction: [dx.into(), dy.into(), dz.into()],
            t_max: end.into(),
        }
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

    /// Intersects the deferred sure hits exactly. Returns the rays of an any-hit query that hit anything.
    #[inline(always)]
    fn finish(&mut self, simd: S) -> u64 {
        let mut found = 0;
        for index in 0..GROUPS {
            if C::ANY_HIT {
                let done = self.groups[index].end.simd_eq(f32::NEG_INFINITY);
                found |= (done.to_bitmask() & 0xff) << (index * LANES);
            } else {
                let deferred = !self.groups[index].block.simd_eq(NO_BLOCK);
                self.intersect_sure(simd, index, deferred);
            }
        }
        found
    }
}

mod one_triangle;
mod spheres;
#[cfg(test)]
mod tests;
mod triangles;
