//! One node: eight boxes and what is in each, and the test of a ray against the eight at once.
//!
//! Layout, 256 bytes:
//!
//! | bytes | content |
//! | --- | --- |
//! | 0..192 | `bounds[axis][side][child]`, f32: side 0 the minimum, side 1 the maximum; an empty child has +∞, −∞ |
//! | 192..224 | `child[child]`, u32: number of the node; of a leaf, the first item in the array of its kind |
//! | 224..256 | `content[child]`, u32: 0 for a node (or nothing); of a leaf, kind in bits 0–2 and count from bit 3 up |
//!
//! Example: `content = 0x19` is a leaf of kind 1 (triangles) with 3 items: lanes 0 to 2 of the block `child` names.
//!
//! The box test never excludes a box that the exact ray meets: Ize (2013), "Robust BVH Ray Traversal", with the room
//! for errors widened to [`ROOM`], and the same room for the end of the ray, so that a hit at exactly the distance of
//! the best one so far is still found and ties do not depend on the tree.

use crate::aabb::Aabb;
use crate::prepared::Prepared;
use crate::simd::{Chosen, Lanes};

/// How many children a node has at most.
pub(crate) const WIDTH: usize = 8;

/// Room for rounding in distances along a ray, relative: 2⁻²⁰, sixteen units of rounding. Four are needed for a slab
/// (subtraction, reciprocal, product, and the f32 t that it is compared with), on either side.
const ROOM: f32 = 9.536_743e-7;

/// What a child is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Content {
    Node,
    Triangles(u32),
    Spheres(u32),
    Procedurals(u32),
    Instances(u32),
}

impl Content {
    pub(crate) fn pack(self) -> u32 {
        match self {
            Self::Node => 0,
            Self::Triangles(count) => 1 | (count << 3),
            Self::Spheres(count) => 2 | (count << 3),
            Self::Procedurals(count) => 3 | (count << 3),
            Self::Instances(count) => 4 | (count << 3),
        }
    }

    #[inline(always)]
    pub(crate) fn unpack(packed: u32) -> Self {
        let count = packed >> 3;
        match packed & 7 {
            0 => Self::Node,
            1 => Self::Triangles(count),
            2 => Self::Spheres(count),
            3 => Self::Procedurals(count),
            _ => Self::Instances(count),
        }
    }
}

#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node {
    bounds: [[Lanes<WIDTH>; 2]; 3],
    child: [u32; WIDTH],
    content: [u32; WIDTH],
}

/// Which children a ray enters, and where.
pub(crate) struct Entered {
    pub(crate) children: Chosen,
    pub(crate) near: [f32; WIDTH],
}

/// The end of a ray, with room for the errors of what is compared with it.
#[inline(always)]
pub(crate) fn with_room(t: f32) -> f32 {
    t + t.abs() * ROOM
}

impl Node {
    pub(crate) const EMPTY: Self = Self {
        bounds: [[Lanes([f32::INFINITY; WIDTH]), Lanes([f32::NEG_INFINITY; WIDTH])]; 3],
        child: [0; WIDTH],
        content: [0; WIDTH],
    };

    pub(crate) fn place(&mut self, slot: usize, bounds: &Aabb, child: u32, content: Content) {
        for axis in 0..3 {
            self.bounds[axis][0].0[slot] = bounds.min[axis];
            self.bounds[axis][1].0[slot] = bounds.max[axis];
        }
        self.child[slot] = child;
        self.content[slot] = content.pack();
    }

    #[inline(always)]
    pub(crate) fn child(&self, slot: usize) -> (u32, u32) {
        (self.child[slot], self.content[slot])
    }

    /// The box of a child, empty where there is none.
    pub(crate) fn child_bounds(&self, slot: usize) -> Aabb {
        Aabb {
            min: [0, 1, 2].map(|axis| self.bounds[axis][0].0[slot]),
            max: [0, 1, 2].map(|axis| self.bounds[axis][1].0[slot]),
        }
    }

    /// Which children the ray meets between its `t_min` and `t_max`.
    #[inline(always)]
    pub(crate) fn enter(&self, ray: &Prepared, t_max: f32) -> Entered {
        let mut near = [0.0; WIDTH];
        let mut far = [0.0; WIDTH];
        self.slabs(ray, t_max, &mut near, &mut far);
        Entered { children: Chosen::which::<WIDTH>(|child| near[child] <= far[child]), near }
    }

    /// Between which t the ray is inside each child, and in its range; with room.
    #[inline(never)]
    fn slabs(&self, ray: &Prepared, t_max: f32, near_out: &mut [f32; WIDTH], far_out: &mut [f32; WIDTH]) {
        let mut near = Lanes::splat(ray.t_min);
        let mut far = Lanes::splat(t_max);
        for axis in 0..3 {
            let side = ray.near_side[axis] & 1;
            let reciprocal = Lanes::splat(ray.reciprocal[axis]);
            let near_face = self.bounds[axis][side] - Lanes::splat(ray.near_origin[axis]);
            let far_face = self.bounds[axis][1 - side] - Lanes::splat(ray.far_origin[axis]);
            near = (near_face * reciprocal).max(near);
            far = (far_face * reciprocal).min(far);
        }
        *near_out = near.0;
        *far_out = (far + far.abs() * Lanes::splat(ROOM)).0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::Ray;

    fn enters(bounds: &Aabb, ray: &Ray) -> bool {
        let mut node = Node::EMPTY;
        node.place(3, bounds, 7, Content::Spheres(2));
        let entered = node.enter(&Prepared::new(ray).unwrap(), ray.t_max).children;
        let entered: Vec<usize> = entered.collect();
        assert!(entered.is_empty() || entered == [3], "an empty child is never entered: {entered:?}");
        entered == [3]
    }

    #[test]
    fn content_is_packed_as_documented() {
        assert_eq!(Content::Triangles(3).pack(), 0x19);
        for content in [Content::Node, Content::Spheres(4), Content::Procedurals(1), Content::Instances(1)] {
            assert_eq!(Content::unpack(content.pack()), content);
        }
        assert_eq!(size_of::<Node>(), 256);
    }

    #[test]
    fn rays_in_the_planes_of_a_box_enter_it() {
        for scale in [1e-8_f32, 1.0, 1e8] {
            let exact = Aabb { min: [-scale; 3], max: [scale; 3] };
            let bounds = exact.padded();
            for axis in 0..3 {
                for side in [-scale, 0.0, scale] {
                    for other in [-scale, 0.5 * scale, scale] {
                        let mut origin = [0.0; 3];
                        origin[axis] = -3.0 * scale;
                        origin[(axis + 1) % 3] = side;
                        origin[(axis + 2) % 3] = other;
                        for zero in [0.0, -0.0] {
                            let mut direction = [zero; 3];
                            direction[axis] = 1.0;
                            assert!(
                                enters(&bounds, &Ray::new(origin, direction)),
                                "{origin:?} {direction:?}"
                            );
                            direction[axis] = -1.0;
                            assert!(
                                !enters(&bounds, &Ray::new(origin, direction)),
                                "{origin:?} {direction:?}"
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn the_range_counts() {
        let bounds = Aabb { min: [-1.0; 3], max: [1.0; 3] };
        let ray = Ray::new([0.0, 0.0, -5.0], [0.0, 0.0, 1.0]);
        assert!(enters(&bounds, &ray));
        assert!(enters(&bounds, &ray.until(4.0)), "touching counts");
        assert!(!enters(&bounds, &ray.until(3.9)));
        assert!(!enters(&bounds, &Ray { t_min: 6.1, ..ray }));
        let behind = Ray { t_min: -6.0, t_max: -4.0, ..Ray::new([0.0, 0.0, 5.0], [0.0, 0.0, 1.0]) };
        assert!(enters(&bounds, &behind), "negative t");
    }
}
