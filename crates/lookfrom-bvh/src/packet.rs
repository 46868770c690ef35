//! Packets: 64 coherent rays at once, as from neighbouring pixels.
//!
//! The packet goes down the tree as one, through every box that it may touch, by intervals of its rays' origins and directions:
//! Boulos, Wald, Shirley (2006), "Geometric and Arithmetic Culling Methods for Entire Ray Packets". In a leaf the rays go by
//! groups of eight, a ray in each lane: those that meet the leaf's box are tested against one triangle after the other, by the
//! same tests as single rays. Spheres, procedural shapes and instances are left to the single-ray code, ray by ray. So the
//! answers are those of single rays, bit for bit.

use std::marker::PhantomData;

use crate::Bvh;
use crate::beam::{Beam, seem_alike};
use crate::collector::PacketCollector;
use crate::exact::Exact;
use crate::filter::{LARGEST_FILTERED, SeenBlock, Sifted, TriangleLanes};
use crate::group::{GROUPS, Group, LANES, NO_BLOCK, RAYS, least};
use crate::leaf::other_leaf;
use crate::node::{Child, Content};
use crate::query::Settings;
use crate::ray::{Hit, NONE, Ray};
use crate::stack::{Stack, Waiting};
use crate::traverse::{TraversalState, cross_surely, tell};
use crate::triangle;
use crate::visibility::{Faces, Visibility};
use lookfrom_simd::{LaneMask, Simd, i32x8, prelude::*};

/// Traces rays as a packet. Gives the rays that hit anything, bit i for ray i, and where the question is about the closest hits
/// writes them to `hits`. None, and nothing done, where the rays are not alike, too few, or out of the usual range.
#[inline(never)]
pub(crate) fn trace_packet<'a, S: Simd, C: PacketCollector, V: Visibility<'a>>(
    simd: S,
    settings: &Settings<'a>,
    rays: &[Ray],
    hits: &mut [Hit],
    stack: &mut Stack,
) -> Option<u64> {
    let bvh = settings.bvh;
    if rays.len() < RAYS || !seem_alike(rays) || bvh.nodes.is_empty() || !(bvh.largest < LARGEST_FILTERED) {
        return None;
    }
    simd.vectorize(
        #[inline(always)]
        || {
            let mut groups = [Group::empty(simd); GROUPS];
            for (index, (group, rays)) in groups.iter_mut().zip(rays.chunks_exact(LANES)).enumerate() {
                *group = Group::new(simd, rays);
                if V::HAS_ORIGIN {
                    group.set_origins(simd, |lane| settings.origin_of(index * LANES + lane));
                }
            }
            let beam = Beam::around(simd, &groups, bvh.largest)?;
            if !C::ANY_HIT {
                hits[..RAYS].fill(Hit::MISS);
            }
            let mut packet = Packet::<S, C, V> { settings, rays, groups, hits, question: PhantomData };
            packet.traverse(simd, &beam, &mut Waiting { stack, bottom: 0, height: 0 });
            Some(packet.finish())
        },
    )
}

/// A packet on its way.
struct Packet<'a, 'b, S: Simd, C, V> {
    settings: &'b Settings<'a>,
    rays: &'b [Ray],
    groups: [Group<S>; GROUPS],
    /// The closest hits that are decided; empty where any hit will do.
    hits: &'b mut [Hit],
    question: PhantomData<(C, V)>,
}

impl<'a, S: Simd, C: PacketCollector, V: Visibility<'a>> Packet<'a, '_, S, C, V> {
    #[inline(always)]
    fn bvh(&self) -> &'a Bvh {
        self.settings.bvh
    }

    /// The end of the longest ray; −∞ where all are done.
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
            let shortened = match child.content() {
                Content::Node(number) => {
                    let node = &self.bvh().nodes[number];
                    let entered = beam.enter(simd, node, end);
                    if entered.children != 0 {
                        current = Some(waiting.push_all_but_nearest::<S, C>(node, &entered));
                        continue;
                    }
                    false
                }
                Content::Triangles(number) => self.triangles(simd, beam, number),
                Content::Leaf(number) => self.other_leaf(simd, number, waiting),
            };
            if shortened {
                end = self.end();
            }
            current = waiting.pop(end);
        }
    }

    /// Tests a block of triangles. False where no ray meets its box.
    #[inline(always)]
    fn triangles(&mut self, simd: S, beam: &Beam<S>, number: usize) -> bool {
        let block = &self.bvh().triangles[number];
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
        // Occlusion rays hardly ever start at one point.
        if !C::ANY_HIT
            && let Some(origin) = beam.common_origin
        {
            let seen = SeenBlock::new(simd, block, origin);
            self.test(simd, number, &mut meeting, |of, group| {
                seen.sift(simd, of, &group.sieve, group.length, group.end)
            });
        } else {
            self.test(simd, number, &mut meeting, |of, group| {
                TriangleLanes::splat(simd, block, of).sift(simd, &group.sieve, group.end)
            });
        }
        true
    }

    /// Tests a block of triangles against those rays of each group that may meet it. For closest hits nothing here branches on the
    /// outcome of a test: it could not be predicted.
    #[inline(always)]
    fn test(
        &mut self,
        simd: S,
        number: usize,
        meeting: &mut [u32; GROUPS],
        sift: impl Fn(usize, &Group<S>) -> Sifted<S>,
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
                let sifted = sift(of, group);
                let (mut sure, mut kept) = (sifted.sure, sifted.kept.0 & rays);
                if V::HAS_ORIGIN {
                    let is_other = !group.start_on(simd, geometry, primitive);
                    sure &= is_other;
                    kept &= is_other.to_bitmask() as u32;
                }
                if V::SELECTS && visibility.faces() != Faces::Both {
                    // The sign of a sure hit's determinant is sure as well.
                    let is_front = sifted.looks_at_front();
                    sure &= if visibility.faces() == Faces::Front { is_front } else { !is_front };
                }
                let open = kept & !sifted.surely_hit.0;
                if C::ANY_HIT {
                    // A ray that is surely occluded is done.
                    group.retire(simd, sure);
                    meeting[index] &= !(sure.to_bitmask() as u32);
                    for lane in LaneMask(open) {
                        if self.decide((number, of), index, lane) {
                            meeting[index] &= !(1 << lane);
                        }
                    }
                    continue;
                }

                // Put off the decision of a sure hit, unless another is surely nearer.
                let [first, last] = sifted.between();
                let nearer = sure & first.simd_le(group.last);
                let unclear = nearer & last.simd_ge(group.first);
                let (blocks, lanes) = (group.block, group.lane);
                group.first = nearer.select(first, group.first);
                group.last = nearer.select(last, group.last);
                group.end = nearer.select(last.min(group.end), group.end);
                group.block = nearer.select(i32x8::splat(simd, number as i32), blocks);
                group.lane = nearer.select(i32x8::splat(simd, of as i32), lanes);

                // Decide the hits that are not sure, and sure hits that may be as near.
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
    }

    /// Decides whether a ray meets a triangle that is not its origin primitive. Returns true where the ray is done.
    #[cold]
    #[inline(never)]
    fn decide(&mut self, (block, of): (usize, usize), index: usize, lane: usize) -> bool {
        let place = index * LANES + lane;
        let ray = Exact::new(&self.rays[place]);
        let block = &self.bvh().triangles[block];
        let corners = block.corners(of);
        let Some(crossing) = triangle::decide(&ray, &corners, block.extent(of)) else { return false };
        let mut state = self.state(place);
        if V::SELECTS && !state.visibility.faces().shows(|| triangle::is_front(&ray, &corners)) {
            return false;
        }
        tell(crossing, block, of, &mut state);
        self.update(place, &state.collector)
    }

    /// Tests the rays that meet the box of a leaf without triangles, one by one. False where none does.
    #[inline(never)]
    fn other_leaf(&mut self, simd: S, number: usize, waiting: &mut Waiting<'_>) -> bool {
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
                        let ray = Exact::new(&self.rays[place]);
                        let mut state = self.state(place);
                        other_leaf(simd, bvh, leaf, &ray, &mut state, waiting);
                        self.update(place, &state.collector);
                    }
                }
                any
            },
        )
    }

    /// A ray's state as it stands.
    #[inline(always)]
    fn state(&self, place: usize) -> TraversalState<C, V, ()> {
        let hit = if C::ANY_HIT { Hit::MISS } else { self.hits[place] };
        let end = self.groups[place / LANES].end[place % LANES];
        let collector = C::resume(&self.rays[place], hit, end);
        let visibility = V::of(self.settings, place);
        TraversalState { instance: NONE, collector, visibility, observer: () }
    }

    /// Notes a ray's hit. Returns true where the ray is done.
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

    /// Decides where the sure hits are, and tells which rays hit anything.
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
                cross_surely(block, lane as usize, || Exact::new(&self.rays[place]), &mut state);
                self.hits[place] = state.collector.hit();
            }
            found |= u64::from(self.hits[place].is_hit()) << place;
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::collector::AnyHit;
    use crate::dispatch::{dispatch, levels};
    use crate::origin_primitive::OriginPrimitive;
    use crate::stack::with_stack;
    use crate::testing::Random;
    use crate::visibility::Everything;
    use crate::{Aabb, Affine, Builder, Procedural, ProceduralHit, Query, Sphere, Triangles};
    use lookfrom_simd::Kernel;

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

    /// Boxes, of which rays hit the floor.
    #[derive(Debug)]
    struct Floors(Vec<Aabb>);

    impl Procedural for Floors {
        fn count(&self) -> u32 {
            self.0.len() as u32
        }
        fn bounds(&self, primitive: u32) -> Aabb {
            self.0[primitive as usize]
        }
        fn intersect(&self, primitive: u32, ray: &Ray) -> Option<ProceduralHit> {
            let Aabb { min, max } = self.0[primitive as usize];
            let t = (min[2] - ray.origin[2]) / ray.direction[2];
            let margin = [0, 1].map(|i| 1e-3 * (max[i] - min[i]));
            let inside = (0..2).all(|i| {
                let x = ray.origin[i] + t * ray.direction[i];
                min[i] + margin[i] < x && x < max[i] - margin[i]
            });
            (inside && ray.t_min < t && t < ray.t_max).then_some(ProceduralHit { t, u: 0.5, v: 0.25 })
        }
    }

    /// Triangles, spheres, procedural shapes and instances of these, with masks; `counts` says how many of each kind.
    fn mixture(random: &mut Random, center: [f32; 3], size: f32, counts: [u32; 4]) -> Bvh {
        let [triangles, spheres, floors, instances] = counts;
        let point = |random: &mut Random| random.near(center, size);
        let positions: Vec<[f32; 3]> = (0..3 * triangles).map(|_| point(random)).collect();
        let indices: Vec<[u32; 3]> = (0..triangles).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mut balls = Vec::new();
        for _ in 0..spheres {
            balls.push(Sphere { center: point(random), radius: 0.2 * size * random.unit() });
        }
        let mut boxes = Vec::new();
        for _ in 0..floors {
            boxes.push(Aabb::around(&[point(random), point(random)]));
        }
        let mut builder = Builder::new();
        builder.triangles(Triangles { positions: &positions, indices: &indices });
        builder.spheres(&balls);
        builder.procedural(Arc::new(Floors(boxes)));
        for geometry in 0..3 {
            builder.geometry_mask(geometry, random.below(16) | 1);
        }
        let masks: Vec<u32> = (0..triangles).map(|_| random.below(16)).collect();
        builder.primitive_masks(0, &masks);
        if instances > 0 {
            let object = Arc::new(mixture(random, [0.0; 3], size, [40, 3, 2, 0]));
            for _ in 0..instances {
                let mut matrix = [0; 3].map(|_| [0; 3].map(|_| f64::from(0.4 * random.unit())));
                (0..3).for_each(|axis| matrix[axis][axis] -= 0.8);
                let translation = point(random).map(f64::from);
                let instance = builder.instance(object.clone(), Affine { matrix, translation });
                builder.instance_mask(instance, random.below(16));
            }
        }
        builder.build().unwrap()
    }

    /// Whether rays go as a packet.
    struct GoTogether<'a>(&'a Bvh, &'a [Ray]);

    impl Kernel for GoTogether<'_> {
        type Output = bool;
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> bool {
            let settings = Settings::new(self.0);
            with_stack(|stack| {
                trace_packet::<S, AnyHit, Everything>(simd, &settings, self.1, &mut [], stack).is_some()
            })
        }
    }

    #[test]
    fn packets_of_every_query_say_what_single_rays_say() {
        let mut random = Random::new(10);
        let (mut hits, mut misses, mut packets, mut excluded) = (0, 0, 0, 0);
        for round in 0..40 {
            let (center, size) = (random.point_with_exponents(-6, 6), random.size(-6, 6));
            let counts =
                [[300, 0, 0, 0], [200, 1, 0, 0], [100, 20, 20, 0], [60, 5, 5, 4], [0, 0, 0, 6]][round % 5];
            let mut bvh = mixture(&mut random, center, size, counts);
            for _ in 0..6 {
                let target = random.near(center, size);
                let rays = neighbours(&mut random, target, size);
                let faces = [Faces::Both, Faces::Front, Faces::Back][random.below(3) as usize];
                let mask = 1 << random.below(4);
                // Exclude the triangle that is hit first, so that the exclusion shows.
                let origins: Vec<OriginPrimitive> = rays
                    .iter()
                    .map(|ray| match random.below(3) {
                        0 => OriginPrimitive::NONE,
                        _ => OriginPrimitive::of(&bvh.closest_hit(ray)),
                    })
                    .collect();
                let kind = random.below(6);
                for level in levels() {
                    bvh.level = level;
                    packets += usize::from(dispatch(level, GoTogether(&bvh, &rays[..RAYS])));
                    let query: Query<'_> = match kind {
                        0 => bvh.query(),
                        1 => bvh.query().mask(mask),
                        2 => bvh.query().faces(faces),
                        3 => bvh.query().mask(mask).faces(faces).origins(&origins),
                        _ => bvh.query().origins(&origins),
                    };
                    let mut together = vec![Hit::MISS; rays.len()];
                    query.closest_hits(&rays, &mut together);
                    let mut occluded = vec![false; rays.len()];
                    query.occluded_many(&rays, &mut occluded);
                    for (number, ray) in rays.iter().enumerate() {
                        let origin = if kind < 3 { OriginPrimitive::NONE } else { origins[number] };
                        let alone = query.origins(&[]).origin(origin);
                        let hit = alone.closest_hit(ray);
                        assert_eq!(together[number], hit, "{kind} {ray:?}");
                        assert_eq!(occluded[number], hit.is_hit(), "{kind} {ray:?}");
                        assert_eq!(alone.occluded(ray), hit.is_hit(), "{kind} {ray:?}");
                        // All hits, without those on the triangle that the ray starts on.
                        let (mut all, mut expected) = (Vec::new(), Vec::new());
                        alone.all_hits(ray, &mut all);
                        alone.origin(OriginPrimitive::NONE).all_hits(ray, &mut expected);
                        let before = expected.len();
                        expected.retain(|hit| hit.geometry != 0 || OriginPrimitive::of(hit) != origin);
                        excluded += before - expected.len();
                        assert_eq!(all, expected, "{kind} {ray:?}");
                        assert_eq!(all.first().copied().unwrap_or(Hit::MISS), hit, "{kind} {ray:?}");
                        hits += usize::from(hit.is_hit());
                        misses += usize::from(!hit.is_hit());
                    }
                }
            }
        }
        assert!(hits > 10_000 && misses > 10_000, "{hits} hits, {misses} misses");
        assert!(packets > 300 && excluded > 5000, "{packets} packets, {excluded} hits excluded");
    }
}
