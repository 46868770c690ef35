//! Eight rays of a packet, one in each lane.

use crate::aabb::Aabb;
use crate::conservative::RayLanes;
use crate::error_bounds::{ERROR, FAR, LARGEST_RECIPROCAL, ROOM, SHORT, TINY};
use crate::lanes::{LANES, combined, greatest, smaller};
use crate::origin_primitive::OriginPrimitive;
use crate::prepared;
use crate::ray::{NONE, Ray};
use lookfrom_simd::{Simd, f32x8, f32x16, i32x8, mask32x8, prelude::*, transposed};

/// Number of groups in a packet.
pub(crate) const GROUPS: usize = 8;

/// Number of rays in a packet.
pub(crate) const RAYS: usize = LANES * GROUPS;

/// Marks the absence of a block.
pub(crate) const NO_BLOCK: i32 = -1;

/// Eight rays, one in each lane, and their closest hits so far.
#[derive(Clone, Copy)]
pub(crate) struct Ray8<S: Simd> {
    pub(crate) origin: [f32x8<S>; 3],
    pub(crate) direction: [f32x8<S>; 3],
    /// The start of each ray, with a margin.
    pub(crate) start: f32x8<S>,
    /// The lanes of usual rays; the contents of the others are meaningless.
    pub(crate) usual: u32,
    /// The rays' `t_min` and `t_max`.
    pub(crate) range: [f32x8<S>; 2],
    /// `t_max` or the nearest hit so far, with a margin; −∞ for a ray that is done.
    pub(crate) end: f32x8<S>,
    /// A distance before which everything is surely nearer than all hits so far.
    pub(crate) limit: f32x8<S>,
    /// [`ERROR`] times the largest component of each direction.
    error: f32x8<S>,
    /// The block of a sure hit whose exact test is deferred, and its lane in it.
    pub(crate) block: i32x8<S>,
    pub(crate) lane: i32x8<S>,
    /// Geometry and primitive of the rays' origin triangles that are not in instances.
    origin_ids: [i32x8<S>; 2],
}

impl<S: Simd> Ray8<S> {
    /// No rays: all are done.
    #[inline(always)]
    pub(crate) fn empty(simd: S) -> Self {
        let zero = f32x8::splat(simd, 0.0);
        let (zeros, number) = ([zero; 3], i32x8::splat(simd, NO_BLOCK));
        Self {
            origin: zeros,
            direction: zeros,
            start: zero,
            usual: 0,
            range: [zero; 2],
            end: f32x8::splat(simd, f32::NEG_INFINITY),
            limit: zero,
            error: zero,
            block: number,
            lane: number,
            origin_ids: [number; 2],
        }
    }

    #[inline(always)]
    pub(crate) fn new(simd: S, rays: &[Ray]) -> Self {
        let row = |lane: usize| {
            let Ray { origin: [ox, oy, oz], t_min, direction: [dx, dy, dz], t_max } = rays[lane];
            f32x8::load_array(simd, [ox, oy, oz, t_min, dx, dy, dz, t_max])
        };
        let [ox, oy, oz, t_min, dx, dy, dz, t_max] =
            transposed([row(0), row(1), row(2), row(3), row(4), row(5), row(6), row(7)]);
        let (origin, direction) = ([ox, oy, oz], [dx, dy, dz]);
        let length = greatest(direction);
        let usual = greatest(origin).simd_lt(FAR)
            & length.simd_lt(1.0 / SHORT)
            & length.simd_gt(SHORT)
            & t_min.simd_ge(0.0)
            & t_min.simd_lt(t_max);
        let zero = f32x8::splat(simd, 0.0);
        let sum = |[x, y, z]: [f32x8<S>; 3]| x + y + z;
        let finite = ((sum(origin) + sum(direction)) * zero).simd_eq(zero);
        let end = with_room(t_max);
        Self {
            usual: (usual & finite).to_bitmask() as u32 & 0xff,
            origin,
            direction,
            start: (t_min - (t_min * ROOM + TINY)).max(0.0),
            range: [t_min, t_max],
            end,
            limit: end,
            error: length * ERROR,
            block: i32x8::splat(simd, NO_BLOCK),
            lane: i32x8::splat(simd, 0),
            origin_ids: [i32x8::splat(simd, NONE as i32); 2],
        }
    }

    /// Fewer than eight rays: the last fills the other lanes, where it is done.
    #[inline(always)]
    pub(crate) fn of_few(simd: S, rays: &[Ray]) -> Self {
        let last = rays.len() - 1;
        let mut all = [rays[last]; LANES];
        all[..last].copy_from_slice(&rays[..last]);
        let mut group = Self::new(simd, &all);
        group.retire(simd, mask32x8::from_bitmask(simd, 0xff << rays.len() & 0xff));
        group
    }

    /// The rays for the conservative test.
    #[inline(always)]
    pub(crate) fn ray_lanes(&self, simd: S) -> RayLanes<S> {
        RayLanes::of_rays(simd, self.origin, self.direction, self.start, self.error)
    }

    /// The rays of this group and of another for the conservative test.
    #[inline(always)]
    pub(crate) fn beside(&self, simd: S, other: &Self) -> RayLanes<S, f32x16<S>> {
        RayLanes::of_rays(
            simd,
            combined(simd, self.origin, other.origin),
            combined(simd, self.direction, other.direction),
            simd.combine_f32x8(self.start, other.start),
            simd.combine_f32x8(self.error, other.error),
        )
    }

    /// Sets the origin primitives of the rays, lane by lane.
    #[inline(always)]
    pub(crate) fn set_origins(&mut self, simd: S, origin: impl Fn(usize) -> OriginPrimitive) {
        let mut ids = [[NONE as i32; LANES]; 2];
        for lane in 0..LANES {
            let OriginPrimitive { instance, geometry, primitive } = origin(lane);
            if instance == NONE {
                (ids[0][lane], ids[1][lane]) = (geometry as i32, primitive as i32);
            }
        }
        self.origin_ids = [i32x8::load_array(simd, ids[0]), i32x8::load_array(simd, ids[1])];
    }

    /// The rays that start on a triangle that is not in an instance.
    #[inline(always)]
    pub(crate) fn start_on(&self, simd: S, geometry: u32, primitive: u32) -> mask32x8<S> {
        let [geometries, primitives] = self.origin_ids;
        geometries.simd_eq(i32x8::splat(simd, geometry as i32))
            & primitives.simd_eq(i32x8::splat(simd, primitive as i32))
    }

    /// Terminates rays: they hit no more boxes.
    #[inline(always)]
    pub(crate) fn retire(&mut self, simd: S, rays: mask32x8<S>) {
        self.end = rays.select(f32x8::splat(simd, f32::NEG_INFINITY), self.end);
    }

    /// Ends a ray at a hit, with the same margin as [`Self::new`], unless it already ends sooner.
    pub(crate) fn shorten(&mut self, lane: usize, t: f32) {
        let end = t + (t.abs() * ROOM + TINY);
        self.end[lane] = smaller(end, self.end[lane]);
        self.limit[lane] = smaller(end, self.limit[lane]);
    }

    /// Ends some rays at hits, as [`Self::shorten`].
    #[inline(always)]
    pub(crate) fn shorten_some(&mut self, rays: mask32x8<S>, t: f32x8<S>) {
        let end = with_room(t);
        self.end = (rays & end.simd_lt(self.end)).select(end, self.end);
        self.limit = (rays & end.simd_lt(self.limit)).select(end, self.limit);
    }

    /// Takes note of a triangle, the one of a block, that some rays surely hit between `first` and `last`. Returns
    /// the rays of which it is surely the nearest hit so far.
    #[inline(always)]
    pub(crate) fn defer(
        &mut self,
        simd: S,
        (block, of): (usize, usize),
        sure: mask32x8<S>,
        [first, last]: [f32x8<S>; 2],
    ) -> mask32x8<S> {
        let nearest = sure & last.simd_lt(self.limit);
        self.limit = nearest.select(first, self.limit);
        self.end = nearest.select(last, self.end);
        self.block = nearest.select(i32x8::splat(simd, block as i32), self.block);
        self.lane = nearest.select(i32x8::splat(simd, of as i32), self.lane);
        nearest
    }
}

/// Eight rays for the test of one box.
pub(crate) struct Slabs8<S: Simd> {
    /// By axis: the reciprocal of the direction near and far, and its products with the origin.
    axes: [[f32x8<S>; 4]; 3],
}

impl<S: Simd> Slabs8<S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, group: &Ray8<S>) -> Self {
        let Ray8 { origin: [ox, oy, oz], direction: [dx, dy, dz], .. } = *group;
        let cap = f32x8::splat(simd, LARGEST_RECIPROCAL);
        let slabs = |origin, direction| prepared::slabs(simd, origin, direction, cap, 0.0);
        Self { axes: [slabs(ox, dx), slabs(oy, dy), slabs(oz, dz)] }
    }

    /// All groups of a packet.
    #[inline(always)]
    pub(crate) fn of_groups(simd: S, [a, b, c, d, e, f, g, h]: &[Ray8<S>; GROUPS]) -> [Self; GROUPS] {
        [
            Self::new(simd, a),
            Self::new(simd, b),
            Self::new(simd, c),
            Self::new(simd, d),
            Self::new(simd, e),
            Self::new(simd, f),
            Self::new(simd, g),
            Self::new(simd, h),
        ]
    }

    /// The rays of the group that hit a box before their ends.
    #[inline(always)]
    pub(crate) fn meet(&self, group: &Ray8<S>, bounds: &Aabb) -> u32 {
        let mut near = group.start;
        let mut far = group.end;
        for axis in 0..3 {
            let [near_reciprocal, far_reciprocal, near_product, far_product] = self.axes[axis];
            let [a, b] = [bounds.min[axis], bounds.max[axis]];
            let at = |face: f32| near_reciprocal * face - near_product;
            near = near.max(at(a).min(at(b)));
            let at = |face: f32| far_reciprocal * face - far_product;
            far = far.min(at(a).max(at(b)));
        }
        near.simd_le(far).to_bitmask() as u32 & 0xff
    }
}

/// Ends of rays with the margin for boxes.
#[inline(always)]
fn with_room<S: Simd>(t: f32x8<S>) -> f32x8<S> {
    t + (t.abs() * ROOM + TINY)
}
