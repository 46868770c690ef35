//! The moving part of a tree: triangles and instances with positions at several times.
//!
//! The times are equally spaced from 0 to 1, and between two of them every coordinate and every entry of a map is linear.
//! One topology serves all times; each has boxes and corners of its own, so that boxes are linear in time, too: Grünschloß,
//! Stich, Nawaz, Keller (2011), "MSBVH: An Efficient Acceleration Data Structure for Ray Traced Motion Blur". An instance may
//! have maps at more times than there are boxes, which are around its whole way then. What stands
//! still is in the tree that has this part, and costs what it costs without it.

use std::borrow::Cow;

use super::{Bvh, Instance};
use crate::aabb::Aabb;
use crate::affine::Affine;
use crate::conservative::TriangleBlock;
use crate::item::Leaf;
use crate::node::Node;
use crate::vector::{round_down, round_up, wide};

/// Times by which boxes are padded beyond those of a standing tree: half of it for the rounding of boxes between two times,
/// half for that of the corners. Either errs by 3 · 2⁻²⁴ of the largest coordinate; a padding is 2 · 2⁻²⁴ of it.
const PADDINGS: usize = 4;

/// The moving part of a tree. There are at least two times.
#[derive(Debug)]
pub(crate) struct Moving {
    times: Vec<AtTime>,
    pub(crate) leaves: Vec<Leaf>,
    /// By instance id: its map at each of its own times; empty for what stands still.
    maps: Vec<Box<[Affine]>>,
    /// The box around everything at all times.
    pub(crate) bounds: Aabb,
    /// The largest coordinate at any time.
    pub(crate) largest: f32,
}

/// Boxes and corners at one time.
#[derive(Debug)]
struct AtTime {
    nodes: Vec<Node>,
    triangles: Vec<TriangleBlock>,
}

/// A time between two of a tree's.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment {
    earlier: usize,
    /// 0 at the earlier time, 1 at the next.
    pub(crate) fraction: f32,
}

/// A tree, or its moving part at a moment.
#[derive(Clone, Copy)]
pub(crate) enum Part<'t> {
    Standing(&'t Bvh),
    Moving(&'t Moving, Moment),
}

impl<'t> Part<'t> {
    /// A node.
    pub(crate) fn node(self, number: usize) -> Cow<'t, Node> {
        match self {
            Self::Standing(bvh) => Cow::Borrowed(&bvh.nodes[number]),
            Self::Moving(moving, moment) => Cow::Owned(moving.node(number, moment)),
        }
    }

    /// A block of triangles.
    pub(crate) fn block(self, number: usize) -> Cow<'t, TriangleBlock> {
        match self {
            Self::Standing(bvh) => Cow::Borrowed(&bvh.triangles[number]),
            Self::Moving(moving, moment) => Cow::Owned(moving.block(number, moment)),
        }
    }

    /// A leaf: spheres, procedural shapes or instances.
    pub(crate) fn leaf(self, number: usize) -> Leaf {
        match self {
            Self::Standing(bvh) => bvh.leaves[number],
            Self::Moving(moving, _) => moving.leaves[number],
        }
    }
}

impl Moving {
    /// The moving part with the topology of a tree over the boxes of all times, and boxes at so many `times`: `corners` gives a
    /// triangle's corners at a time, `maps` an instance's maps by id, at as many times or, if both are 2ᵏ + 1, at others.
    pub(crate) fn new(
        topology: Bvh,
        instances: &[Instance],
        maps: Vec<Box<[Affine]>>,
        times: usize,
        corners: impl Fn(usize, (u32, u32)) -> [[f32; 3]; 3],
    ) -> Self {
        let at_time = |time: usize| {
            let mut tree = Bvh {
                nodes: topology.nodes.clone(),
                leaves: topology.leaves.clone(),
                leaf_bounds: topology.leaf_bounds.clone(),
                ..Bvh::default()
            };
            let block = |block: &TriangleBlock| {
                let lanes = (0..block.count()).map(|lane| block.ids(lane));
                let all: Vec<_> = lanes.map(|ids| (corners(time, ids), ids.0, ids.1)).collect();
                TriangleBlock::new(&all)
            };
            tree.triangles = topology.triangles.iter().map(block).collect();
            if !tree.nodes.is_empty() {
                tree.fit(0, &|id| box_at(&instances[id].bvh, &maps[id], time, times));
            }
            tree.nodes.iter_mut().for_each(|node| (0..PADDINGS).for_each(|_| node.pad()));
            AtTime { nodes: tree.nodes, triangles: tree.triangles }
        };
        let times: Vec<AtTime> = (0..times).map(at_time).collect();
        let mut bounds = Aabb::EMPTY;
        for root in times.iter().filter_map(|at| at.nodes.first()) {
            root.children().for_each(|(_, child, _)| bounds.unite(&child));
        }
        let largest = bounds.min.iter().chain(&bounds.max).fold(0.0_f32, |largest, x| x.abs().max(largest));
        Self { times, leaves: topology.leaves, maps, bounds, largest }
    }

    /// Whether there is nothing in it that rays can hit.
    pub(crate) fn is_empty(&self) -> bool {
        self.times[0].nodes.is_empty()
    }

    /// Finds a time among the tree's. Times before 0, and NaN, are 0; those after 1 are 1.
    #[inline]
    pub(crate) fn moment(&self, time: f32) -> Moment {
        Moment::among(self.times.len(), time)
    }

    /// A node, with its boxes at a moment.
    #[inline(always)]
    pub(crate) fn node(&self, number: usize, moment: Moment) -> Node {
        let [earlier, later] = [0, 1].map(|step| &self.times[moment.earlier + step].nodes[number]);
        earlier.between(later, moment.fraction)
    }

    /// A block of triangles, with its corners at a moment.
    #[inline(always)]
    pub(crate) fn block(&self, number: usize, moment: Moment) -> TriangleBlock {
        let [earlier, later] = [0, 1].map(|step| &self.times[moment.earlier + step].triangles[number]);
        earlier.between(later, moment.fraction)
    }

    /// The map of an instance, world from object, at a moment; `None` where it stands still, and for no instance.
    pub(crate) fn map(&self, instance: u32, time: f32) -> Option<Affine> {
        let maps = self.maps.get(instance as usize)?;
        (!maps.is_empty()).then(|| Affine::at_time(maps, time))
    }

    /// Memory in bytes.
    pub(crate) fn memory(&self) -> usize {
        let of_time = |at: &AtTime| size_of_val(&*at.nodes) + size_of_val(&*at.triangles);
        size_of::<Self>()
            + self.times.iter().map(of_time).sum::<usize>()
            + size_of_val(&*self.leaves)
            + self.maps.iter().map(|maps| size_of::<Box<[Affine]>>() + size_of_val(&**maps)).sum::<usize>()
    }
}

/// The box of a tree that moves by `maps`, at one of the `times` of boxes, such that what is mixed from two of them is around the tree
/// at all times between.
fn box_at(bvh: &Bvh, maps: &[Affine], time: usize, times: usize) -> Aabb {
    let (steps, parts) = (times - 1, maps.len() - 1);
    if parts == steps {
        return bvh.bounds_under(&maps[time]);
    }
    // Both are powers of two: these fractions are exact.
    let at = |step: usize| bvh.bounds_under(&Affine::at_time(maps, step as f32 / steps as f32));
    let mut bounds = at(time);
    if parts < steps || bounds.is_empty() {
        return bounds;
    }
    // By how much the tree is outside of the mixed boxes where it bends: either end of the step becomes larger by that.
    let each = parts / steps;
    let (mut below, mut above) = ([0.0_f64; 3], [0.0_f64; 3]);
    for step in time.saturating_sub(1)..steps.min(time + 1) {
        let ends = [at(step), at(step + 1)];
        for part in 1..each {
            let bend = bvh.bounds_under(&maps[step * each + part]);
            let fraction = part as f64 / each as f64;
            let outside = |[from, to]: [f32; 2], bend: f32| {
                f64::from(from) * (1.0 - fraction) + f64::from(to) * fraction - f64::from(bend)
            };
            for axis in 0..3 {
                below[axis] = below[axis].max(outside(ends.map(|end| end.min[axis]), bend.min[axis]));
                above[axis] = above[axis].max(-outside(ends.map(|end| end.max[axis]), bend.max[axis]));
            }
        }
    }
    let (min, max) = (wide(bounds.min), wide(bounds.max));
    bounds.min = [0, 1, 2].map(|axis| round_down(min[axis] - below[axis]));
    bounds.max = [0, 1, 2].map(|axis| round_up(max[axis] + above[axis]));
    bounds
}

impl Moment {
    /// A time among a number of equally spaced ones, at least two.
    #[inline]
    pub(crate) fn among(times: usize, time: f32) -> Self {
        let steps = times - 1;
        let time = if time > 0.0 { time.min(1.0) } else { 0.0 };
        let place = time * steps as f32;
        let earlier = (place as usize).min(steps - 1);
        Self { earlier, fraction: place - earlier as f32 }
    }
}

impl Affine {
    /// A map at a time, of those at equally spaced times from 0 to 1, at least two, as queries interpolate them.
    ///
    /// ```
    /// use lookfrom_bvh::Affine;
    /// let up = Affine { translation: [0.0, 0.0, 4.0], ..Affine::IDENTITY };
    /// assert_eq!(Affine::at_time(&[Affine::IDENTITY, up, Affine::IDENTITY], 0.75).translation[2], 2.0);
    /// ```
    ///
    /// # Panics
    /// For fewer than two maps.
    pub fn at_time(maps: &[Self], time: f32) -> Self {
        let Moment { earlier, fraction } = Moment::among(maps.len(), time);
        maps[earlier].between(&maps[earlier + 1], f64::from(fraction))
    }
}

/// Finds a time among equally spaced ones from 0 to 1, at least two: the number of the last one before it, never that of the
/// last of all, and the part of the way to the next, as queries interpolate what moves.
///
/// ```
/// assert_eq!(lookfrom_bvh::moment(5, 0.375), (1, 0.5));
/// assert_eq!(lookfrom_bvh::moment(5, 1.0), (3, 1.0));
/// ```
///
/// # Panics
/// For fewer than two times.
pub fn moment(times: usize, time: f32) -> (usize, f32) {
    let Moment { earlier, fraction } = Moment::among(times, time);
    (earlier, fraction)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_in_their_range() {
        for times in 2..10 {
            for (time, before) in [(-1.0, 0.0), (f32::NAN, 0.0), (0.0, 0.0), (1.0, 1.0), (7.0, 1.0)] {
                let Moment { earlier, fraction } = Moment::among(times, time);
                assert_eq!((earlier as f32 + fraction) / (times - 1) as f32, before);
                assert!(earlier + 1 < times && (0.0..=1.0).contains(&fraction));
            }
            let Moment { earlier, fraction } = Moment::among(times, 0.3);
            assert!(((earlier as f32 + fraction) / (times - 1) as f32 - 0.3).abs() < 1e-6);
        }
    }
}
