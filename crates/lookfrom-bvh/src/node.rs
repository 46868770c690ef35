//! The node of the tree: eight boxes and their children, and the test of a ray against the eight boxes at once.
//!
//! Layout, 256 bytes, four cache lines:
//!
//! | bytes | content |
//! | --- | --- |
//! | 0..192 | `bounds[axis][side][child]`, f32: side 0 the minimum, side 1 the maximum; an empty child has +∞, −∞ |
//! | 192..224 | `child[child]`, u32: a [`Child`] |
//! | 224..256 | unused: indexing by a shift is faster than by a product |
//!
//! A [`Child`] has its kind in bits 30 and 31 and a number in the others: 0 a node, 2 a block of triangles, 3
//! another leaf. Example: `0x8000_0005` is triangle block 5.
//!
//! The box test never excludes a box that the exact ray hits: Ize (2013), "Robust BVH Ray Traversal", with a wider
//! error margin (see `prepared`), and the same margin for the end of the ray, so that a hit at exactly the distance
//! of the best one so far is still found and ties do not depend on the tree. Distances are along the scaled
//! direction.

use crate::aabb::Aabb;
use crate::prepared::PreparedRay;
use lookfrom_simd::{Simd, f32x8, i32x8, prelude::*};
use prefetch_index::prefetch_index;

/// Maximum number of children of a node.
pub(crate) const WIDTH: usize = 8;

/// Maximum depth of a tree.
pub(crate) const LARGEST_DEPTH: usize = 160;

/// A child: its kind and its number, packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Child(pub(crate) u32);

/// An unpacked [`Child`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Content {
    Node(usize),
    /// Number of the block.
    Triangles(usize),
    /// Index in `Bvh::leaves`.
    Leaf(usize),
}

impl Child {
    pub(crate) const ROOT: Self = Self(0);

    /// Upper limit of numbers, 2³⁰.
    pub(crate) const LIMIT: u64 = 1 << 30;

    pub(crate) fn node(number: usize) -> Self {
        Self(number as u32)
    }

    pub(crate) fn triangles(block: usize) -> Self {
        Self(2 << 30 | block as u32)
    }

    pub(crate) fn leaf(number: usize) -> Self {
        Self(3 << 30 | number as u32)
    }

    #[inline(always)]
    pub(crate) fn content(self) -> Content {
        let number = (self.0 & 0x3fff_ffff) as usize;
        match self.0 >> 30 {
            3 => Content::Leaf(number),
            2 => Content::Triangles(number),
            // Bit 30 is not set.
            _ => Content::Node(self.0 as usize),
        }
    }
}

#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node {
    bounds: [[[f32; WIDTH]; 2]; 3],
    child: [Child; WIDTH],
}

/// The children that a ray enters, and their distances.
pub(crate) struct Entered<S: Simd> {
    /// Bit i stands for child i.
    pub(crate) children: u32,
    /// A vector, so that it lies in one cache line.
    pub(crate) near: f32x8<S>,
}

/// A ray for the box test, in every lane.
pub(crate) struct Slabs<S: Simd> {
    near_side: [usize; 3],
    near_reciprocal: [f32x8<S>; 3],
    far_reciprocal: [f32x8<S>; 3],
    near_product: [f32x8<S>; 3],
    far_product: [f32x8<S>; 3],
    t_min: i32x8<S>,
}

impl<S: Simd> Slabs<S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, ray: &PreparedRay) -> Self {
        Self {
            near_side: ray.near_side,
            near_reciprocal: splat_all(simd, ray.near_reciprocal),
            far_reciprocal: splat_all(simd, ray.far_reciprocal),
            near_product: splat_all(simd, ray.near_product),
            far_product: splat_all(simd, ray.far_product),
            t_min: i32x8::splat(simd, ray.t_min.to_bits() as i32),
        }
    }
}

#[inline(always)]
fn splat_all<S: Simd>(simd: S, values: [f32; 3]) -> [f32x8<S>; 3] {
    [f32x8::splat(simd, values[0]), f32x8::splat(simd, values[1]), f32x8::splat(simd, values[2])]
}

impl Node {
    pub(crate) const EMPTY: Self = Self {
        bounds: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3],
        child: [Child::ROOT; WIDTH],
    };

    pub(crate) fn place(&mut self, slot: usize, bounds: &Aabb, child: Child) {
        for axis in 0..3 {
            self.bounds[axis][0][slot] = bounds.min[axis];
            self.bounds[axis][1][slot] = bounds.max[axis];
        }
        self.child[slot] = child;
    }

    #[inline(always)]
    pub(crate) fn child(&self, slot: usize) -> Child {
        self.child[slot & (WIDTH - 1)]
    }

    /// The box of a child, empty where there is none.
    pub(crate) fn child_bounds(&self, slot: usize) -> Aabb {
        Aabb {
            min: [0, 1, 2].map(|axis| self.bounds[axis][0][slot]),
            max: [0, 1, 2].map(|axis| self.bounds[axis][1][slot]),
        }
    }

    /// The children: their slots, boxes and contents.
    pub(crate) fn children(&self) -> impl Iterator<Item = (usize, Aabb, Content)> + '_ {
        (0..WIDTH).filter_map(|slot| {
            let bounds = self.child_bounds(slot);
            (!bounds.is_empty()).then(|| (slot, bounds, self.child(slot).content()))
        })
    }

    /// The number of children.
    pub(crate) fn count(&self) -> usize {
        (0..WIDTH).filter(|slot| !self.child_bounds(*slot).is_empty()).count()
    }

    /// One face of all children's boxes.
    #[inline(always)]
    pub(crate) fn face<S: Simd>(&self, simd: S, axis: usize, side: usize) -> f32x8<S> {
        f32x8::load_array_ref(simd, &self.bounds[axis][side & 1])
    }

    /// Pads the boxes of all children.
    pub(crate) fn pad(&mut self) {
        for slot in 0..WIDTH {
            let bounds = self.child_bounds(slot);
            if !bounds.is_empty() {
                self.place(slot, &bounds.padded(), self.child(slot));
            }
        }
    }

    /// This node with its boxes on the way to those of another with the same children.
    #[inline(always)]
    pub(crate) fn between(&self, later: &Self, fraction: f32) -> Self {
        let (part, rest) = (fraction, 1.0 - fraction);
        let mut node = self.clone();
        for axis in 0..3 {
            for side in 0..2 {
                for slot in 0..WIDTH {
                    let [a, b] = [self.bounds[axis][side][slot], later.bounds[axis][side][slot]];
                    // Empty boxes stay as they are: infinite.
                    let mixed = a * rest + b * part;
                    node.bounds[axis][side][slot] = if a.is_finite() { mixed } else { a };
                }
            }
        }
        node
    }

    /// Asks for all of the node's cache lines ahead of a visit.
    #[inline(always)]
    pub(crate) fn prefetch(&self) {
        for axis in 0..3 {
            prefetch_index(self.bounds.as_slice(), axis);
        }
        prefetch_index(self.child.as_slice(), 0);
    }

    /// The children that the ray hits between its `t_min` and a scaled end.
    ///
    /// Distances are compared as integers, which is faster: floats from 0 on are in the order of their bits, and
    /// the bits of all others are less.
    #[inline(always)]
    pub(crate) fn enter<S: Simd>(&self, simd: S, ray: &Slabs<S>, end: f32) -> Entered<S> {
        let face = |axis: usize, side: usize| self.face(simd, axis, side);
        let near = |axis: usize| {
            face(axis, ray.near_side[axis])
                .mul_sub(ray.near_reciprocal[axis], ray.near_product[axis])
                .bitcast::<i32x8<S>>()
        };
        let far = |axis: usize| {
            face(axis, ray.near_side[axis] ^ 1)
                .mul_sub(ray.far_reciprocal[axis], ray.far_product[axis])
                .bitcast::<i32x8<S>>()
        };
        let near = near(0).max(near(1)).max(near(2).max(ray.t_min));
        let far = far(0).min(far(1)).min(far(2).min(i32x8::splat(simd, end.to_bits() as i32)));
        let missed = near.simd_gt(far).to_bitmask() as u32;
        Entered { children: missed ^ 0xff, near: near.bitcast() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dispatch::{dispatch_or_scalar, levels_and_scalar};
    use crate::exact::ExactRay;
    use crate::ray::Ray;
    use lookfrom_simd::Kernel;

    struct Enter<'a>(&'a Node, &'a Ray);

    impl Kernel for Enter<'_> {
        type Output = u32;
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> u32 {
            let ray = PreparedRay::new(simd, &ExactRay::new(self.1), 10.0).unwrap();
            self.0.enter(simd, &Slabs::new(simd, &ray), ray.end(self.1.t_max)).children
        }
    }

    fn enters(bounds: &Aabb, ray: &Ray) -> bool {
        let mut node = Node::EMPTY;
        node.place(3, bounds, Child::triangles(7));
        let entered =
            levels_and_scalar().into_iter().map(|level| dispatch_or_scalar(level, Enter(&node, ray)));
        let entered: Vec<u32> = entered.collect();
        assert!(entered.iter().all(|&all| all == entered[0]), "every level says the same: {entered:?}");
        assert!(entered[0] & !8 == 0, "an empty child is never entered: {entered:?}");
        entered[0] == 8
    }

    #[test]
    fn children_are_packed_as_documented() {
        assert_eq!(Child::triangles(5), Child(0x8000_0005));
        assert_eq!(Child::triangles(5).content(), Content::Triangles(5));
        assert_eq!(Child::leaf(6).content(), Content::Leaf(6));
        assert_eq!(Child::node(7).content(), Content::Node(7));
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
        assert!(enters(&bounds, &ray.with_t_max(4.0)), "touching counts");
        assert!(!enters(&bounds, &ray.with_t_max(3.9)));
        assert!(!enters(&bounds, &Ray { t_min: 6.1, ..ray }));
        let behind = Ray { t_min: -6.0, t_max: -4.0, ..Ray::new([0.0, 0.0, 5.0], [0.0, 0.0, 1.0]) };
        assert!(enters(&bounds, &behind), "negative t");
    }
}
