//! Packets against spheres: eight rays and one sphere, excluded in f32 and decided in f64.

use super::Packet;
use crate::collector::PacketCollector;
use crate::faces::Faces;
use crate::lanes::{LANES, splat_all};
use crate::ray::{Hit, NONE};
use crate::ray8::{GROUPS, Ray8};
use crate::sphere::{self, Line, Sphere, SphereBlock, SphereFilter, SphereItem};
use crate::visibility::Visibility;
use lookfrom_simd::{LaneMask, Simd, f32x8, f64x8, mask32x8, prelude::*};

impl<'a, S: Simd, C: PacketCollector, V: Visibility<'a>> Packet<'a, '_, S, C, V> {
    /// Tests spheres against those rays of each group that hit their box.
    #[inline(always)]
    pub(super) fn spheres(&mut self, simd: S, block: &SphereBlock, meeting: &[u32; GROUPS]) {
        let used = LaneMask(block.used());
        for index in 0..GROUPS {
            if meeting[index] == 0 {
                continue;
            }
            let Ray8 { origin, direction, .. } = self.groups[index];
            let filter = SphereFilter::new(origin, direction);
            let mut lines = None;
            for lane in used {
                let item = block.item(lane);
                if V::SELECTS && !V::of(self.settings, 0).shows(item.geometry, item.primitive) {
                    continue;
                }
                let Sphere { center, radius } = item.shape;
                let may_hit = filter.may_hit(splat_all(simd, center), f32x8::splat(simd, radius));
                let may_hit = may_hit.to_bitmask() as u32 & meeting[index];
                if may_hit != 0 {
                    if lines.is_none() {
                        lines = Some(sphere::lines(origin, direction));
                    }
                    let Some(lines) = &lines else { continue };
                    self.sphere(simd, &item, lines, index, may_hit);
                }
            }
        }
    }

    /// Tests a sphere against some rays of a group.
    #[inline(always)]
    fn sphere(&mut self, simd: S, item: &SphereItem, lines: &Line<f64x8<S>>, index: usize, rays: u32) {
        let group = &mut self.groups[index];
        let rays = mask32x8::from_bitmask(simd, u64::from(rays));
        let Some((is_hit, [near, far])) = sphere::intersect_lanes(simd, lines, &item.shape, rays) else {
            return;
        };
        let [t_min, t_max] = group.range;
        let (mut enters, mut leaves) = (near.simd_gt(t_min), far.simd_gt(t_min) & near.simd_lt(far));
        if V::SELECTS {
            let faces = V::of(self.settings, 0).faces();
            enters &= mask32x8::splat(simd, faces != Faces::Back);
            leaves &= mask32x8::splat(simd, faces != Faces::Front);
        }
        let t = enters.select(near, far);
        let found = is_hit & (enters | leaves) & t.simd_lt(t_max) & t.simd_le(group.end);
        if C::ANY_HIT {
            group.retire(simd, found);
            return;
        }
        let by_lane: [f32; LANES] = t.into();
        let SphereItem { geometry, primitive, .. } = *item;
        let mut nearest = 0;
        for lane in LaneMask(found.to_bitmask() as u32) {
            let place = index * LANES + lane;
            let hit = Hit { t: by_lane[lane], u: 0.0, v: 0.0, primitive, geometry, instance: NONE };
            if hit.precedes(&self.hits[place]) {
                self.hits[place] = hit;
                nearest |= 1 << lane;
            }
        }
        self.groups[index].shorten_some(mask32x8::from_bitmask(simd, nearest), t);
    }
}
