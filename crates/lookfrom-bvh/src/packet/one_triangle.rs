//! A triangle against the groups of a packet: the outcome of its conservative test, and groups in pairs where vectors are
//! wide enough for sixteen rays.

use super::Packet;
use crate::collector::PacketCollector;
use crate::conservative::{ConservativeTest, RayLanes, TriangleEdges, TriangleLanes};
use crate::faces::Faces;
use crate::lanes::LANES;
use crate::ray8::{GROUPS, Ray8};
use crate::triangle;
use crate::visibility::Visibility;
use lookfrom_simd::{LaneMask, Simd, f32x8, f32x16, mask32x8, prelude::*};

/// All lanes of a group.
const ALL: u32 = (1 << LANES) - 1;

/// A triangle that a packet is tested against: its block and its lane there, itself in every lane, and the faces that
/// rays see.
pub(super) struct OneTriangle<S: Simd> {
    pub(super) place: (usize, usize),
    pub(super) lanes: TriangleLanes<S>,
    pub(super) faces: Faces,
}

/// The outcome of a triangle's test against a group of rays. Of masks bit i is for lane i.
struct Tested<S: Simd> {
    /// Rays that do not surely miss it.
    kept: u32,
    /// Rays that surely hit it before their ends, and those whose line surely crosses it.
    surely_hit: u32,
    surely_crossed: u32,
    /// The sure hits, and those at the front.
    sure: mask32x8<S>,
    is_front: mask32x8<S>,
    /// Bounds of the distances of sure hits.
    between: [f32x8<S>; 2],
}

impl<S: Simd> Tested<S> {
    #[inline(always)]
    fn new(tested: &ConservativeTest<S>) -> Self {
        Self {
            kept: tested.kept.0,
            surely_hit: tested.surely_hit.0,
            surely_crossed: tested.surely_crossed.to_bitmask() as u32,
            sure: tested.sure,
            is_front: tested.looks_at_front(),
            between: tested.between(),
        }
    }

    /// The results of two groups that were tested side by side.
    #[inline(always)]
    fn halves(simd: S, tested: &ConservativeTest<S, f32x16<S>>) -> [Self; 2] {
        let crossed = tested.surely_crossed.to_bitmask() as u32;
        let [first, last] = tested.between();
        let (first, last) = (simd.split_f32x16(first), simd.split_f32x16(last));
        let sure = simd.split_mask32x16(tested.sure);
        let is_front = simd.split_mask32x16(tested.looks_at_front());
        [
            Self {
                kept: tested.kept.0 & ALL,
                surely_hit: tested.surely_hit.0 & ALL,
                surely_crossed: crossed & ALL,
                sure: sure.0,
                is_front: is_front.0,
                between: [first.0, last.0],
            },
            Self {
                kept: tested.kept.0 >> LANES,
                surely_hit: tested.surely_hit.0 >> LANES,
                surely_crossed: crossed >> LANES & ALL,
                sure: sure.1,
                is_front: is_front.1,
                between: [first.1, last.1],
            },
        ]
    }
}

/// Pairs of groups side by side, where vectors are wide enough for sixteen rays.
pub(super) struct Pairs<S: Simd>([RayLanes<S, f32x16<S>>; GROUPS / 2]);

impl<S: Simd> Pairs<S> {
    /// Whether vectors are that wide.
    const PAY: bool = <S::f32s as SimdBase<S>>::LEN >= 2 * LANES;

    /// The part of a scene's area from which on testing a box of triangles costs more than it saves for rays that cross the
    /// scene anywhere: the test of one takes as long as one of a triangle, or as two where those are in pairs.
    pub(super) const LARGE: f32 = if Self::PAY { 0.1 } else { 0.3 };

    #[inline(always)]
    fn new(simd: S, [a, b, c, d, e, f, g, h]: &[Ray8<S>; GROUPS]) -> Self {
        Self([a.beside(simd, b), c.beside(simd, d), e.beside(simd, f), g.beside(simd, h)])
    }
}

impl<'a, S: Simd, C: PacketCollector, V: Visibility<'a>> Packet<'a, '_, S, C, V> {
    /// Tests a triangle against the rays of each group that a mask has.
    #[inline(always)]
    pub(super) fn test_one(&mut self, simd: S, triangle: &OneTriangle<S>, meeting: &mut [u32; GROUPS]) {
        let edges = triangle.lanes.edges();
        if Pairs::<S>::PAY {
            return self.test_pairs(simd, triangle, &edges.twice(simd), meeting);
        }
        for index in 0..GROUPS {
            if meeting[index] == 0 {
                continue;
            }
            let group = &self.groups[index];
            let ray_lanes = group.ray_lanes(simd);
            let sides = edges.test_sides(&ray_lanes);
            if !sides.outside.all_true() {
                let tested = edges.test_range(simd, &ray_lanes, group.end, &sides);
                self.settle(simd, triangle, index, &Tested::new(&tested), meeting);
            }
        }
    }

    /// The test with two groups at a time.
    #[inline(always)]
    fn test_pairs(
        &mut self,
        simd: S,
        triangle: &OneTriangle<S>,
        edges: &TriangleEdges<S, f32x16<S>>,
        meeting: &mut [u32; GROUPS],
    ) {
        if self.pairs.is_none() {
            self.pairs = Some(Pairs::new(simd, self.groups));
        }
        for pair in 0..GROUPS / 2 {
            let Some(Pairs(pairs)) = &self.pairs else { return };
            let [a, b] = [2 * pair, 2 * pair + 1];
            if meeting[a] | meeting[b] == 0 {
                continue;
            }
            let sides = edges.test_sides(&pairs[pair]);
            if sides.outside.all_true() {
                continue;
            }
            let end = simd.combine_f32x8(self.groups[a].end, self.groups[b].end);
            let tested = edges.test_range(simd, &pairs[pair], end, &sides);
            let [low, high] = Tested::halves(simd, &tested);
            if low.kept & meeting[a] != 0 {
                self.settle(simd, triangle, a, &low, meeting);
            }
            if high.kept & meeting[b] != 0 {
                self.settle(simd, triangle, b, &high, meeting);
            }
        }
    }

    /// Takes the outcome of a triangle's test against a group.
    #[inline(always)]
    fn settle(
        &mut self,
        simd: S,
        &OneTriangle { place, ref lanes, faces }: &OneTriangle<S>,
        index: usize,
        tested: &Tested<S>,
        meeting: &mut [u32; GROUPS],
    ) {
        let (number, of) = place;
        let (mut sure, mut kept) = (tested.sure, tested.kept & meeting[index]);
        if faces != Faces::Both {
            // The sign of a sure hit's determinant is also sure.
            sure &= if faces == Faces::Front { tested.is_front } else { !tested.is_front };
            kept &= !(tested.surely_hit & !(sure.to_bitmask() as u32));
        }
        if !C::ANY_HIT {
            let kept = mask32x8::from_bitmask(simd, u64::from(kept));
            self.take(simd, place, index, kept, sure, tested.between);
            return;
        }
        let mut open = kept & !tested.surely_hit;
        let group = &mut self.groups[index];
        if V::HAS_ORIGIN {
            let (geometry, primitive) = self.settings.bvh.triangles[number].ids(of);
            let is_other = !group.start_on(simd, geometry, primitive);
            sure &= is_other;
            open &= is_other.to_bitmask() as u32;
        }
        // Where only the range is in doubt, as of rays that end at a light, t decides.
        let crossed = tested.surely_crossed & open;
        if faces == Faces::Both && crossed != 0 {
            let Ray8 { origin, direction, .. } = *group;
            let [t, ..] = triangle::intersect_sure_lanes(origin, direction, lanes.corners);
            let [t_min, t_max] = group.range;
            let crossed = mask32x8::from_bitmask(simd, crossed.into());
            sure |= crossed & t.simd_gt(t_min) & t.simd_lt(t_max);
            open &= !(crossed.to_bitmask() as u32);
        }
        // A ray that is surely occluded is done.
        group.retire(simd, sure);
        meeting[index] &= !(sure.to_bitmask() as u32);
        for lane in LaneMask(open) {
            if self.intersect_exact(place, index, lane) {
                meeting[index] &= !(1 << lane);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conservative::TriangleBlock;
    use crate::dispatch::{dispatch_or_scalar, levels_and_scalar};
    use crate::ray::Ray;
    use crate::testing::Random;
    use lookfrom_simd::Kernel;

    /// The result for a group: the rays of masks, and the bounds of sure hits.
    type Known = ([u32; 5], [[f32; LANES]; 2]);

    struct TwoGroups<'a>(&'a TriangleBlock, &'a [Ray]);

    impl Kernel for TwoGroups<'_> {
        /// Results of two groups, one by one and side by side.
        type Output = [[Known; 2]; 2];

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let Self(block, rays) = self;
            let groups = [Ray8::new(simd, &rays[..LANES]), Ray8::new(simd, &rays[LANES..])];
            let edges = TriangleLanes::splat(simd, block, 0).edges();
            let known = |tested: &Tested<S>| -> Known {
                let sure = tested.sure.to_bitmask() as u32;
                let front = tested.is_front.to_bitmask() as u32 & sure;
                let masks = [tested.kept, tested.surely_hit, tested.surely_crossed, sure, front];
                let zero = f32x8::splat(simd, 0.0);
                (masks, tested.between.map(|bound| tested.sure.select(bound, zero).into()))
            };
            let alone = |group: &Ray8<S>| {
                let lanes = group.ray_lanes(simd);
                known(&Tested::new(&edges.test_range(simd, &lanes, group.end, &edges.test_sides(&lanes))))
            };
            let (wide, lanes) = (edges.twice(simd), groups[0].beside(simd, &groups[1]));
            let end = simd.combine_f32x8(groups[0].end, groups[1].end);
            let tested = wide.test_range(simd, &lanes, end, &wide.test_sides(&lanes));
            [[alone(&groups[0]), alone(&groups[1])], Tested::halves(simd, &tested).map(|half| known(&half))]
        }
    }

    #[test]
    fn two_groups_side_by_side_are_two_one_by_one() {
        let mut random = Random::new(17);
        let (levels, mut hits) = (levels_and_scalar(), 0);
        for round in 0..20_000 {
            let center = random.point_with_exponents(-8, 8);
            let size = random.size(-8, 8);
            let corners = [0; 3].map(|_| random.near(center, size));
            let rays: Vec<Ray> = (0..2 * LANES)
                .map(|_| {
                    let (origin, target) = (random.near(center, 4.0 * size), random.near(center, size));
                    let direction = [0, 1, 2].map(|axis| target[axis] - origin[axis]);
                    Ray { t_max: 2.0 * random.unit() + 0.1, ..Ray::new(origin, direction) }
                })
                .collect();
            let block = TriangleBlock::new(&[(corners, 0, 0)]);
            let [one_by_one, together] =
                dispatch_or_scalar(levels[round % levels.len()], TwoGroups(&block, &rays));
            assert_eq!(one_by_one, together, "{corners:?} {rays:?}");
            hits += one_by_one[0].0[1].count_ones();
        }
        assert!(hits > 5000, "{hits}");
    }
}
