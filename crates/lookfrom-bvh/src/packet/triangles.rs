//! Packets against blocks of triangles.

use super::Packet;
use super::one_triangle::OneTriangle;
use crate::collector::PacketCollector;
use crate::common_origin::CommonOriginBlock;
use crate::conservative::{TriangleBlock, TriangleLanes};
use crate::exact::ExactRay;
use crate::faces::Faces;
use crate::lanes::LANES;
use crate::packet_bounds::PacketBounds;
use crate::ray::{Hit, NONE};
use crate::ray8::{GROUPS, Ray8};
use crate::traverse::report;
use crate::triangle;
use crate::visibility::Visibility;
use lookfrom_simd::{LaneMask, Simd, f32x8, mask32x8, prelude::*};

impl<'a, S: Simd, C: PacketCollector, V: Visibility<'a>> Packet<'a, '_, S, C, V> {
    /// The triangles of a block that the rays see.
    #[inline(always)]
    fn shown(&self, number: usize) -> u32 {
        let block = &self.bvh().triangles[number];
        let all = (1 << block.count()) - 1;
        if !V::SELECTS {
            return all;
        }
        let visibility = V::of(self.settings, 0);
        LaneMask(all).fold(0, |shown, lane| {
            let (geometry, primitive) = block.ids(lane);
            shown | u32::from(visibility.shows(geometry, primitive)) << lane
        })
    }

    /// Tests a block of triangles. Returns false where no ray hits its box.
    #[inline(always)]
    pub(super) fn triangles(&mut self, simd: S, number: usize) -> bool {
        self.test(simd, number, self.shown(number))
    }

    /// Tests a block of triangles against rays from one origin. Returns false where no ray hits it.
    #[inline(always)]
    pub(super) fn triangles_from(
        &mut self,
        simd: S,
        origin: [f32; 3],
        packet_bounds: &PacketBounds<S>,
        number: usize,
        ends: f32x8<S>,
        end: f32,
    ) -> bool {
        let block = &self.bvh().triangles[number];
        let mut shown = self.shown(number);
        let seen = CommonOriginBlock::new(simd, block, origin, packet_bounds.length);
        let unclear = shown & !seen.clear;
        if V::SELECTS {
            shown &= match V::of(self.settings, 0).faces() {
                Faces::Both => !0,
                Faces::Front => seen.front,
                Faces::Back => !seen.front,
            };
        }
        let entered = shown & seen.enter(simd, &packet_bounds.whole_beam(simd, end));
        let (beams, mut tests, mut hitting) = (packet_bounds.beams(ends), 0, 0_u64);
        for of in LaneMask(entered) {
            let groups = seen.beams_that_enter(simd, of, &beams);
            tests += groups.count_ones();
            for index in LaneMask(groups) {
                let group = &self.groups[index];
                let tested = seen.test(simd, of, group.direction, group.start, group.end);
                hitting |= (tested.kept.to_bitmask() & 0xff) << (index * LANES);
                let between = [tested.first, tested.last];
                self.take(simd, (number, of), index, tested.kept, tested.sure, between);
            }
        }
        self.coherence.count_common(entered != 0, tests, hitting.count_ones());
        let mut any = tests != 0;
        if unclear != 0 {
            any |= self.test(simd, number, unclear);
        }
        any
    }

    /// Takes the outcome of a conservative test: the rays of a group that may hit a triangle, and those that surely
    /// do, between two distances. The exact tests of sure hits are deferred.
    #[inline(always)]
    pub(super) fn take(
        &mut self,
        simd: S,
        place @ (block, of): (usize, usize),
        index: usize,
        mut kept: mask32x8<S>,
        mut sure: mask32x8<S>,
        between: [f32x8<S>; 2],
    ) {
        let group = &mut self.groups[index];
        if V::HAS_ORIGIN {
            let (geometry, primitive) = self.settings.bvh.triangles[block].ids(of);
            let is_other = !group.start_on(simd, geometry, primitive);
            sure &= is_other;
            kept &= is_other;
        }
        let nearest = group.defer(simd, place, sure, between);
        let open = (kept & !nearest).to_bitmask() as u32 & 0xff;
        if open != 0 {
            self.intersect_open(simd, place, index, open, sure.to_bitmask() as u32);
        }
    }

    /// Tests some rays of a group exactly against a triangle, which a mask's rays surely hit: these all at once.
    #[cold]
    #[inline(never)]
    fn intersect_open(
        &mut self,
        simd: S,
        place @ (number, of): (usize, usize),
        index: usize,
        open: u32,
        sure: u32,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let block = &self.bvh().triangles[number];
                if open & sure != 0 {
                    let TriangleLanes { corners, .. } = TriangleLanes::splat(simd, block, of);
                    self.intersect_corners(index, open & sure, corners, [(block, of); LANES]);
                    for lane in LaneMask(open & sure) {
                        self.groups[index].shorten(lane, self.hits[index * LANES + lane].t);
                    }
                }
                for lane in LaneMask(open & !sure) {
                    self.intersect_exact(place, index, lane);
                }
            },
        );
    }

    /// Tests some of a block's triangles against those rays that hit its box. Returns false where none does.
    #[inline(always)]
    fn test(&mut self, simd: S, number: usize, triangles: u32) -> bool {
        let block = &self.bvh().triangles[number];
        let visibility = V::of(self.settings, 0);
        let bounds = block.bounds(simd).padded();
        let meeting = &mut match self.mostly_meets(&bounds) {
            true => self.under_way(),
            false => self.meet(simd, &bounds),
        };
        self.coherence.count(meeting);
        if *meeting == [0; GROUPS] {
            return false;
        }
        let faces = if V::SELECTS { visibility.faces() } else { Faces::Both };
        for of in LaneMask(triangles) {
            let lanes = TriangleLanes::splat(simd, block, of);
            self.test_one(simd, &OneTriangle { place: (number, of), lanes, faces }, meeting);
        }
        true
    }

    /// Tests a ray exactly against a triangle that is not its origin primitive. Returns true if the ray is done.
    #[cold]
    #[inline(never)]
    pub(super) fn intersect_exact(&mut self, (block, of): (usize, usize), index: usize, lane: usize) -> bool {
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

    /// Intersects the deferred sure hits of a group exactly.
    #[inline(always)]
    pub(super) fn intersect_sure(&mut self, simd: S, index: usize, deferred: mask32x8<S>) {
        let deferred = deferred.to_bitmask() as u32 & 0xff;
        if deferred == 0 {
            return;
        }
        let (group, bvh) = (&self.groups[index], self.bvh());
        let first = deferred.trailing_zeros() as usize;
        let (number, of) = (group.block[first], group.lane[first]);
        let same = group.block.simd_eq(number) & group.lane.simd_eq(of);
        if deferred & !(same.to_bitmask() as u32) == 0 {
            // One triangle for all: its corners are loaded once.
            let (block, of) = (&bvh.triangles[number as usize], of as usize);
            let TriangleLanes { corners, .. } = TriangleLanes::splat(simd, block, of);
            return self.intersect_corners(index, deferred, corners, [(block, of); LANES]);
        }
        // The other lanes have any triangle.
        let of: [i32; LANES] = group.lane.into();
        let at = |lane: usize| (&bvh.triangles[group.block[lane].max(0) as usize], of[lane] as usize);
        let triangles = [at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7)];
        let column = |corner: usize, axis: usize| {
            let at = |lane: usize| {
                let (block, of): (&TriangleBlock, usize) = triangles[lane];
                block.coordinate(corner, axis, of)
            };
            f32x8::load_array(simd, [at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7)])
        };
        let corner = |corner: usize| [column(corner, 0), column(corner, 1), column(corner, 2)];
        let corners = [corner(0), corner(1), corner(2)];
        self.intersect_corners(index, deferred, corners, triangles);
    }

    /// Intersects some rays of a group exactly with a triangle each, given by its corners, and by its block and lane.
    #[inline(always)]
    fn intersect_corners(
        &mut self,
        index: usize,
        rays: u32,
        corners: [[f32x8<S>; 3]; 3],
        triangles: [(&TriangleBlock, usize); LANES],
    ) {
        let Ray8 { origin, direction, .. } = self.groups[index];
        let [t, u, v] = triangle::intersect_sure_lanes(origin, direction, corners);
        let [t, u, v]: [[f32; LANES]; 3] = [t.into(), u.into(), v.into()];
        for lane in LaneMask(rays) {
            let place = index * LANES + lane;
            let (block, of) = triangles[lane];
            let (geometry, primitive) = block.ids(of);
            let hit = Hit { t: t[lane], u: u[lane], v: v[lane], primitive, geometry, instance: NONE };
            if hit.t < self.rays[place].t_max && hit.precedes(&self.hits[place]) {
                self.hits[place] = hit;
            }
        }
    }
}
