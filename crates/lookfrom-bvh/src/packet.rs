//! Many rays at once, where they run nearly alike: 64 at a time, as from neighbouring pixels.
//!
//! The packet goes down the tree as one, through every box that it may touch, by intervals of what its rays are; Boulos, Wald,
//! Shirley (2006), "Geometric and Arithmetic Culling Methods for Entire Ray Packets". In a leaf the rays go by groups of
//! eight, a ray in each lane: those that meet the leaf's box are tested against one triangle after the other, by the same filter
//! and the same decision as single rays. So the answers are theirs, bit for bit.

use crate::Bvh;
use crate::beam::{Beam, seem_alike};
use crate::exact::Exact;
use crate::filter::{LARGEST_FILTERED, SeenBlock, Sifted, TriangleLanes};
use crate::group::{GROUPS, Group, LANES, NO_BLOCK, RAYS, least};
use crate::node::{Child, Content};
use crate::query::{Any, Closest};
use crate::ray::{Hit, NONE, OriginPrimitive, Ray};
use crate::traverse::{Answer, cross_surely, decide, trace};
use crate::waiting::{Stack, Waiting, with_stack};
use lookfrom_simd::{Kernel, LaneMask, Simd, i32x8, prelude::*};

/// The closest hits of rays, in their order; as many as there are places for.
pub(crate) struct TraceMany<'a> {
    pub(crate) bvh: &'a Bvh,
    pub(crate) rays: &'a [Ray],
    /// What the first of them leave.
    pub(crate) left: &'a [OriginPrimitive],
    pub(crate) hits: &'a mut [Hit],
}

impl Kernel for TraceMany<'_> {
    type Output = ();
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { bvh, rays, left, hits } = self;
        with_stack(
            #[inline(always)]
            |stack| {
                for (first, (rays, hits)) in rays.chunks(RAYS).zip(hits.chunks_mut(RAYS)).enumerate() {
                    if !trace_packet(simd, bvh, rays, hits, stack) {
                        let left = left.get(first * RAYS..).unwrap_or_default();
                        trace_singly(simd, bvh, (rays, left), hits, stack);
                    }
                }
            },
        );
    }
}

/// Whether rays meet anything, in their order; as many as there are places for.
pub(crate) struct OccludedMany<'a> {
    pub(crate) bvh: &'a Bvh,
    pub(crate) rays: &'a [Ray],
    /// What the first of them leave.
    pub(crate) left: &'a [OriginPrimitive],
    pub(crate) occluded: &'a mut [bool],
}

impl Kernel for OccludedMany<'_> {
    type Output = ();
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { bvh, rays, left, occluded } = self;
        let mut hits = [Hit::MISS; RAYS];
        with_stack(
            #[inline(always)]
            |stack| {
                for (first, (rays, occluded)) in rays.chunks(RAYS).zip(occluded.chunks_mut(RAYS)).enumerate()
                {
                    if trace_packet(simd, bvh, rays, &mut hits[..rays.len()], stack) {
                        for (hit, occluded) in hits.iter().zip(occluded) {
                            *occluded = hit.is_hit();
                        }
                    } else {
                        let left = left.get(first * RAYS..).unwrap_or_default();
                        occlude_singly(simd, bvh, (rays, left), occluded, stack);
                    }
                }
            },
        );
    }
}

#[inline(never)]
fn occlude_singly<S: Simd>(
    simd: S,
    bvh: &Bvh,
    (rays, left): (&[Ray], &[OriginPrimitive]),
    occluded: &mut [bool],
    stack: &mut Stack,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            for (number, (ray, occluded)) in rays.iter().zip(occluded).enumerate() {
                let left = left.get(number).copied().unwrap_or(OriginPrimitive::NONE);
                *occluded = trace(simd, bvh, ray, |ray| Any::leaving(ray, left), (), stack).found;
            }
        },
    );
}

#[inline(never)]
fn trace_singly<S: Simd>(
    simd: S,
    bvh: &Bvh,
    (rays, left): (&[Ray], &[OriginPrimitive]),
    hits: &mut [Hit],
    stack: &mut Stack,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            for (number, (ray, hit)) in rays.iter().zip(hits).enumerate() {
                let left = left.get(number).copied().unwrap_or(OriginPrimitive::NONE);
                *hit = trace(simd, bvh, ray, |ray| Closest::leaving(ray, left), (), stack).hit;
            }
        },
    );
}

/// Traces rays as a packet. False, and nothing done, where they are not alike, too few, or out of the usual range.
#[inline(never)]
fn trace_packet<S: Simd>(simd: S, bvh: &Bvh, rays: &[Ray], hits: &mut [Hit], stack: &mut Stack) -> bool {
    if rays.len() < RAYS
        || hits.len() < RAYS
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
            hits[..RAYS].fill(Hit::MISS);
            let mut packet = Packet { bvh, rays, groups, hits };
            packet.traverse(simd, &beam, &mut Waiting { stack, bottom: 0, height: 0 });
            packet.finish();
            true
        },
    )
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
                for lane in LaneMask(open) {
                    self.decide((number, of), index, lane);
                }
                for lane in LaneMask(unclear) {
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
        self.groups[index].shorten(lane, answer.query.hit.t);
    }

    /// A ray's query as it stands.
    #[inline(always)]
    fn answer(&self, place: usize) -> Answer<Closest, ()> {
        Answer { instance: NONE, query: Closest::after(&self.rays[place], self.hits[place]), watch: () }
    }

    /// Decides where the sure hits are, and tells all.
    #[inline(always)]
    fn finish(&mut self) {
        for place in 0..RAYS {
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
    use crate::dispatch::levels;
    use crate::ray::{Hit, Ray};
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
