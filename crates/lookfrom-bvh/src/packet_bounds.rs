//! Bounds of the rays of a packet, as an interval ray: one test of eight boxes serves them all. Boulos, Wald,
//! Shirley (2006).

use crate::aabb::Aabb;
use crate::common_origin::Beams;
use crate::error_bounds::{ROOM, SHORT};
use crate::lanes::{least, least_of_each};
use crate::node::{Entered, Node};
use crate::ray::Ray;
use crate::ray8::{GROUPS, RAYS, Ray8};
use lookfrom_simd::{Simd, f32x8, i32x8, prelude::*};

/// Largest difference of directions in a packet, relative to their length.
const SPREAD: f32 = 0.25;

/// Largest difference of origins in a packet, relative to the tree's largest coordinate.
const NEARNESS: f32 = 1.0 / 32.0;

/// A distance far beyond all others.
const BEYOND: f32 = 1e37;

/// True if the first and some other rays have similar directions: a quick check in advance.
pub(crate) fn seem_alike(rays: &[Ray]) -> bool {
    let first = rays[0].direction;
    let length = first.iter().fold(0.0_f32, |length, x| length.max(x.abs()));
    [RAYS / 3, 2 * RAYS / 3, RAYS - 1]
        .iter()
        .all(|&other| (0..3).all(|axis| (rays[other].direction[axis] - first[axis]).abs() < SPREAD * length))
}

/// Intervals that contain the origins and reciprocal directions of all rays of a packet.
pub(crate) struct PacketBounds<S: Simd> {
    /// The minimum corner of the box around the origins.
    origin: [f32; 3],
    /// The common origin of all rays, if they have one.
    pub(crate) common_origin: Option<[f32; 3]>,
    /// The center of the directions, and half of their extents: of each group, and of all rays.
    groups: [[f32x8<S>; 3]; 2],
    all: [[f32; 3]; 2],
    /// The largest component of a direction.
    pub(crate) length: f32,
    near_side: [usize; 3],
    /// Minimum and maximum of 1 / direction, with a margin.
    reciprocal: [[f32x8<S>; 2]; 3],
    /// The extent of the origins from there, in distances along the rays.
    offset: [f32x8<S>; 3],
    t_min: i32x8<S>,
}

impl<S: Simd> PacketBounds<S> {
    /// Returns `None` where the rays, which must be usual ones, are too different for a packet.
    #[inline(always)]
    pub(crate) fn around(simd: S, groups: &[Ray8<S>; GROUPS], largest: f32) -> Option<Self> {
        let mut t_min = groups[0].start;
        let mut origins = [groups[0].origin; 2];
        for group in &groups[1..] {
            t_min = t_min.min(group.start);
            for axis in 0..3 {
                let o = group.origin[axis];
                origins[0][axis] = origins[0][axis].min(o);
                origins[1][axis] = origins[1][axis].max(o);
            }
        }
        let [x, y, z] = [extremes(groups, 0), extremes(groups, 1), extremes(groups, 2)];
        let (min, max) = ([x[0], y[0], z[0]], [x[1], y[1], z[1]]);
        let (origins, directions) = (boxed(origins), boxed([min, max]));
        let greatest = |x: [f32; 3]| x.iter().fold(0.0_f32, |greatest, x| greatest.max(x.abs()));
        let spread = [0, 1, 2].map(|axis| directions.max[axis] - directions.min[axis]);
        let apart = [0, 1, 2].map(|axis| origins.max[axis] - origins.min[axis]);
        let alike = greatest(spread) < SPREAD * greatest(directions.min).min(greatest(directions.max))
            && greatest(apart) <= NEARNESS * largest;
        if !alike {
            return None;
        }

        let origin = origins.min;
        let splat = |[a, b]: [f32; 2]| [f32x8::splat(simd, a), f32x8::splat(simd, b)];
        let mut near_side = [0; 3];
        // An axis with directions of both signs does not limit anything.
        let mut reciprocal = [[1.0 / BEYOND; 2]; 3];
        let mut offset = [BEYOND; 3];
        for axis in 0..3 {
            let (slow, fast) = (directions.min[axis], directions.max[axis]);
            near_side[axis] = usize::from(fast < 0.0);
            if slow > SHORT || fast < -SHORT {
                let room = 4.0 * ROOM;
                let [a, b] = [1.0 / fast, 1.0 / slow];
                let (least, most) = (a.min(b), a.max(b));
                reciprocal[axis] = [least - least.abs() * room, most + most.abs() * room];
                offset[axis] = apart[axis] * least.abs().max(most.abs()) * (1.0 + 2.0 * room);
            }
        }
        let mut groups = [min, max];
        let (mut middle, mut rest) = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            let center = (min[axis] + max[axis]) * 0.5;
            (groups[0][axis], groups[1][axis]) = (center, max[axis] - center);
            middle[axis] = (directions.min[axis] + directions.max[axis]) * 0.5;
            rest[axis] = directions.max[axis] - middle[axis];
        }
        Some(Self {
            groups,
            all: [middle, rest],
            length: greatest(directions.min).max(greatest(directions.max)),
            origin,
            common_origin: (apart == [0.0; 3]).then_some(origin),
            near_side,
            reciprocal: reciprocal.map(splat),
            offset: offset.map(|offset| f32x8::splat(simd, offset)),
            t_min: i32x8::splat(simd, least(t_min).to_bits() as i32),
        })
    }

    /// The directions of each group, given the ends of its longest ray.
    #[inline(always)]
    pub(crate) fn beams(&self, ends: f32x8<S>) -> Beams<S> {
        let [center, half] = self.groups;
        Beams { center, half, end: ends }
    }

    /// The directions of all rays.
    #[inline(always)]
    pub(crate) fn whole_beam(&self, simd: S, end: f32) -> Beams<S> {
        let [[x, y, z], [to_x, to_y, to_z]] = self.all;
        let splat = |x: f32| f32x8::splat(simd, x);
        Beams {
            center: [splat(x), splat(y), splat(z)],
            half: [splat(to_x), splat(to_y), splat(to_z)],
            end: splat(end),
        }
    }

    /// The children that some ray may hit before the end, and a lower bound of the distances. As [`Node::enter`]
    /// for one ray.
    #[inline(always)]
    pub(crate) fn enter(&self, simd: S, node: &Node, end: f32) -> Entered<S> {
        let way = |axis: usize, side: usize| node.face(simd, axis, side) - self.origin[axis];
        let near = |axis: usize| {
            let way = way(axis, self.near_side[axis]);
            let [least, most] = self.reciprocal[axis];
            ((way * least).min(way * most) - self.offset[axis]).bitcast::<i32x8<S>>()
        };
        let far = |axis: usize| {
            let way = way(axis, self.near_side[axis] ^ 1);
            let [least, most] = self.reciprocal[axis];
            ((way * least).max(way * most) + self.offset[axis]).bitcast::<i32x8<S>>()
        };
        let near = near(0).max(near(1)).max(near(2).max(self.t_min));
        let far = far(0).min(far(1)).min(far(2).min(i32x8::splat(simd, end.to_bits() as i32)));
        let missed = near.simd_gt(far).to_bitmask() as u32;
        Entered { children: missed ^ 0xff, near: near.bitcast() }
    }
}

/// The box around least and greatest numbers of eight lanes, by axis.
#[inline(always)]
fn boxed<S: Simd>([min, max]: [[f32x8<S>; 3]; 2]) -> Aabb {
    Aabb {
        min: [least(min[0]), least(min[1]), least(min[2])],
        max: [-least(-max[0]), -least(-max[1]), -least(-max[2])],
    }
}

/// The minimum and the maximum of each group's directions on an axis.
#[inline(always)]
fn extremes<S: Simd>(groups: &[Ray8<S>; GROUPS], axis: usize) -> [f32x8<S>; 2] {
    let [a, b, c, d, e, f, g, h] = groups;
    let of = |group: &Ray8<S>| group.direction[axis];
    let directions = [of(a), of(b), of(c), of(d), of(e), of(f), of(g), of(h)];
    let [a, b, c, d, e, f, g, h] = directions;
    [least_of_each(directions), -least_of_each([-a, -b, -c, -d, -e, -f, -g, -h])]
}
