//! Eight rays of a packet, one in each lane.

use crate::aabb::Aabb;
use crate::conservative::{self, RayLanes};
use crate::origin_primitive::OriginPrimitive;
use crate::prepared::{self, FAR, LARGEST_RECIPROCAL, SHORT};
use crate::ray::{NONE, Ray};
use lookfrom_simd::{Simd, f32x8, i32x8, mask32x8, prelude::*};

/// Number of rays in a group.
pub(crate) const LANES: usize = 8;

/// Number of groups in a packet.
pub(crate) const GROUPS: usize = 8;

/// Number of rays in a packet.
pub(crate) const RAYS: usize = LANES * GROUPS;

/// Marks the absence of a block.
pub(crate) const NO_BLOCK: i32 = -1;

/// Eight rays, one in each lane, and their closest hits so far.
#[derive(Clone, Copy)]
pub(crate) struct Ray8<S: Simd> {
    pub(crate) ray_lanes: RayLanes<S>,
    /// The lanes of usual rays; the contents of the others are meaningless.
    pub(crate) usual: u32,
    /// The largest component of each direction.
    pub(crate) length: f32x8<S>,
    pub(crate) near_reciprocal: [f32x8<S>; 3],
    pub(crate) far_reciprocal: [f32x8<S>; 3],
    pub(crate) near_product: [f32x8<S>; 3],
    pub(crate) far_product: [f32x8<S>; 3],
    pub(crate) end: f32x8<S>,
    /// Bounds of the distance of a sure hit whose exact test is deferred; ∞ where there is none.
    pub(crate) first: f32x8<S>,
    pub(crate) last: f32x8<S>,
    /// That hit's block and its lane in it.
    pub(crate) block: i32x8<S>,
    pub(crate) lane: i32x8<S>,
    /// Geometry and primitive of the rays' origin triangles that are not in instances.
    origin_ids: [i32x8<S>; 2],
}

impl<S: Simd> Ray8<S> {
    /// No rays.
    #[inline(always)]
    pub(crate) fn empty(simd: S) -> Self {
        let zero = f32x8::splat(simd, 0.0);
        let (zeros, number) = ([zero; 3], i32x8::splat(simd, NO_BLOCK));
        Self {
            ray_lanes: RayLanes::of_rays(simd, zeros, zeros, zero, zero),
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
            origin_ids: [number; 2],
        }
    }

    #[inline(always)]
    pub(crate) fn new(simd: S, rays: &[Ray]) -> Self {
        let row = |lane: usize| {
            let Ray { origin: [ox, oy, oz], t_min, direction: [dx, dy, dz], t_max } = rays[lane];
            f32x8::load_array(simd, [ox, oy, oz, t_min, dx, dy, dz, t_max])
        };
        let mut v = [row(0), row(1), row(2), row(3), row(4), row(5), row(6), row(7)];
        // Three perfect shuffles transpose the rows to columns.
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
            ray_lanes: RayLanes::of_rays(simd, origin, direction, first, length * conservative::ERROR),
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
            origin_ids: [i32x8::splat(simd, NONE as i32); 2],
        }
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
        let end = t + (t.abs() * prepared::ROOM + prepared::TINY);
        self.end[lane] = smaller(end, self.end[lane]);
    }

    /// The rays that hit a box before their ends.
    #[inline(always)]
    pub(crate) fn meet(&self, bounds: &Aabb) -> u32 {
        let mut near = self.ray_lanes.t_min;
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

/// The minimum of the lanes.
#[inline(always)]
pub(crate) fn least<S: Simd>(numbers: f32x8<S>) -> f32 {
    let numbers: [f32; LANES] = numbers.into();
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| smaller(numbers[i], numbers[i + 4]));
    smaller(smaller(a, b), smaller(c, d))
}

#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
