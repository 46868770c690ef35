//! Light tree: one of many lights, chosen in proportion to its estimated contribution.
//!
//! Conty Estevez & Kulla 2018 (importance of light clusters, surface area orientation heuristic); the bounds of an
//! importance as in pbrt-v4. `derivation` is for the inspector.

mod derivation;
mod sight;

use glam::Vec3;
use lookfrom_simd::{Float, LaneMask, Simd, f32x8, prelude::*};

use super::choice::ChosenLight;
use super::cone::{Cone, angle};
use crate::core::lanes::{LANES, by_lane};
use crate::core::parallel;
use crate::core::sampler::ONE_MINUS_EPSILON;
use crate::core::vector::Vector;
use sight::{Sight, probability_of_first, sin_of};

/// Number of buckets per axis for candidate splits.
const BUCKETS: usize = 12;

/// Light bounds: box, cone of normals, emission angle and power.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightBounds {
    /// Minimum corner, in render space.
    pub(super) min: Vec3,
    /// Maximum corner.
    pub(super) max: Vec3,
    /// The directions of the surfaces' normals (or of the axis of a spot).
    pub(super) normals: Cone,
    /// Cosine of the largest angle to a normal at which light is emitted.
    pub(super) cos_emission: f32,
    /// Whether the other side emits light too.
    pub(super) two_sided: bool,
    /// Power, in any unit: ≥ 0.
    pub(super) power: f32,
}

/// A tree over lights with a position.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    /// For each light of the world, the bit trail from the root to its leaf, the first branch in the lowest bit; `None`
    /// where it is not in the tree.
    ways: Vec<Option<u64>>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    sight: Sight,
    /// A light, or the index of the second child; the first one follows its parent.
    link: Link,
}

#[derive(Clone, Copy, Debug)]
enum Link {
    Light(u32),
    Second(u32),
}

impl Tree {
    /// A tree over lights with their indices, of `count` lights in the world. Lights without power are left out.
    pub(super) fn new(lights: &[(u32, LightBounds)], count: usize) -> Self {
        let mut lights: Vec<(u32, LightBounds)> =
            lights.iter().copied().filter(|(_, b)| b.power > 0.0).collect();
        let mut tree = Self { nodes: Vec::new(), ways: vec![None; count] };
        if let Some((light, bounds)) = lights.first() {
            let placeholder = Node { sight: bounds.sight(), link: Link::Light(*light) };
            tree.nodes = vec![placeholder; 2 * lights.len() - 1];
            build(&mut tree.nodes, 0, &mut lights, 0);
            tree.find_ways(0, 0, 0);
        }
        tree
    }

    /// Whether there is no light in it.
    pub(super) fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The only light in it.
    #[inline]
    pub(super) fn only(&self) -> Option<u32> {
        match self.nodes[..] {
            [Node { link: Link::Light(light), .. }] => Some(light),
            _ => None,
        }
    }

    fn find_ways(&mut self, node: usize, way: u64, depth: u32) {
        match self.nodes[node].link {
            Link::Light(light) => self.ways[light as usize] = Some(way),
            Link::Second(second) => {
                self.find_ways(node + 1, way, depth + 1);
                self.find_ways(second as usize, way | 1 << depth, depth + 1);
            }
        }
    }

    /// A light for `u ∈ [0, 1)` and its probability at a point with the unit normal `n` (or zero, where there is none);
    /// `None` if none of several lights can reach `p`.
    pub(super) fn sample(&self, p: Vec3, n: Vec3, mut u: f32) -> Option<ChosenLight> {
        let mut probability = 1.0;
        let mut node = 0;
        loop {
            match self.nodes.get(node)?.link {
                Link::Light(light) => return Some(ChosenLight { light, probability, rest: u }),
                Link::Second(second) => {
                    let (share, exists) = self.first_share(node, second as usize, p, n);
                    if !exists {
                        return None;
                    }
                    let first = u < share;
                    let of_this = if first { share } else { 1.0 - share };
                    u = (if first { u / share } else { (u - share) / of_this }).min(ONE_MINUS_EPSILON);
                    probability *= of_this;
                    node = if first { node + 1 } else { second as usize };
                }
            }
        }
    }

    /// The probability with which [`Tree::sample`] chooses a light.
    pub(super) fn probability(&self, p: Vec3, n: Vec3, light: u32) -> f32 {
        let Some(mut way) = self.ways.get(light as usize).copied().flatten() else { return 0.0 };
        let mut probability = 1.0;
        let mut node = 0;
        loop {
            match self.nodes[node].link {
                Link::Light(_) => return probability,
                Link::Second(second) => {
                    let (share, exists) = self.first_share(node, second as usize, p, n);
                    if !exists {
                        return 0.0;
                    }
                    let first = way & 1 == 0;
                    probability *= if first { share } else { 1.0 - share };
                    if probability == 0.0 {
                        return 0.0;
                    }
                    node = if first { node + 1 } else { second as usize };
                    way >>= 1;
                }
            }
        }
    }

    /// The probability of the first of two children, and whether either can be chosen.
    fn first_share(&self, node: usize, second: usize, p: Vec3, n: Vec3) -> (f32, bool) {
        let children = [&self.nodes[node + 1].sight, &self.nodes[second].sight];
        probability_of_first(children.map(|child| child.importance(p.into(), n.into())))
    }

    /// [`Tree::sample`] for eight points at once, in the lanes of a mask.
    #[inline(always)]
    pub(super) fn sample_lanes<S: Simd>(
        &self,
        simd: S,
        p: Vector<f32x8<S>>,
        n: Vector<f32x8<S>>,
        mut u: f32x8<S>,
        mask: u32,
    ) -> [Option<ChosenLight>; LANES] {
        let mut chosen = [None; LANES];
        let Some(root) = self.nodes.first() else { return chosen };
        let mut probability = f32x8::splat(simd, 1.0);
        // The first and the second child of the node that each lane has come to; done lanes stay where they are.
        let mut below = match root.link {
            Link::Light(light) => {
                return by_lane!(lane => match mask & 1 << lane {
                    0 => None,
                    _ => Some(ChosenLight { light, probability: 1.0, rest: u[lane] }),
                });
            }
            Link::Second(second) => [[1, second as usize]; LANES],
        };
        let mut active = mask;
        while active != 0 {
            let first = by_lane!(lane => &self.nodes[below[lane][0]].sight);
            let second = by_lane!(lane => &self.nodes[below[lane][1]].sight);
            let importances =
                [Sight::gather(simd, &first).importance(p, n), Sight::gather(simd, &second).importance(p, n)];
            let (share, exists) = probability_of_first(importances);
            let is_first = u.simd_lt(share);
            let of_this = is_first.select(share, -share + 1.0);
            let rest = is_first.select(u, u - share) / of_this;
            u = Float::min(rest, rest.like(ONE_MINUS_EPSILON));
            probability *= of_this;
            let (is_first, exists) = (is_first.to_bitmask() as u32, exists.to_bitmask() as u32);
            active &= exists;
            for lane in LaneMask(active) {
                let node = below[lane][usize::from(is_first & 1 << lane == 0)];
                match self.nodes[node].link {
                    Link::Light(light) => {
                        let (probability, rest) = (probability[lane], u[lane]);
                        chosen[lane] = Some(ChosenLight { light, probability, rest });
                        active &= !(1 << lane);
                    }
                    Link::Second(second) => below[lane] = [node + 1, second as usize],
                }
            }
        }
        chosen
    }
}

/// Builds the subtree over the lights into `nodes`, the first of which has index `first` in the tree; returns the
/// bounds.
fn build(nodes: &mut [Node], first: u32, lights: &mut [(u32, LightBounds)], depth: u32) -> LightBounds {
    /// Number of lights from which a subtree is built in a parallel task.
    const PARALLEL: usize = 2048;
    if let [(light, bounds)] = *lights {
        nodes[0] = Node { sight: bounds.sight(), link: Link::Light(light) };
        return bounds;
    }
    // Below depth 32 the lights are halved, so that 64 bits are enough for 2³² lights.
    let middle = if depth < 32 { divide(lights) } else { lights.len() / 2 };
    let is_large = lights.len() > PARALLEL;
    let (left, right) = lights.split_at_mut(middle);
    let (root, below) = nodes.split_at_mut(1);
    let (of_left, of_right) = below.split_at_mut(2 * middle - 1);
    let second = first + 2 * middle as u32;
    let mut build_left = || build(of_left, first + 1, left, depth + 1);
    let mut build_right = || build(of_right, second, right, depth + 1);
    let (a, b) =
        if is_large { parallel::join(build_left, build_right) } else { (build_left(), build_right()) };
    let bounds = a.union(&b);
    root[0] = Node { sight: bounds.sight(), link: Link::Second(second) };
    bounds
}

impl LightBounds {
    fn union(&self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            normals: self.normals.union(other.normals),
            cos_emission: self.cos_emission.min(other.cos_emission),
            two_sided: self.two_sided || other.two_sided,
            power: self.power + other.power,
        }
    }

    fn center(&self) -> Vec3 {
        0.5 * (self.min + self.max)
    }

    fn sight(&self) -> Sight {
        Sight {
            center: self.center().into(),
            radius: 0.5 * (self.max - self.min).length(),
            axis: self.normals.axis.into(),
            cos_normals: self.normals.cos,
            sin_normals: sin_of(self.normals.cos),
            cos_emission: self.cos_emission,
            power: self.power,
            two_sided: if self.two_sided { 1.0 } else { 0.0 },
        }
    }

    /// Surface area × solid angle of the normals with their emission: the cost of the bounds (SAOH).
    fn cost(&self) -> f32 {
        let theta_o = angle(self.normals.cos);
        let theta_e = angle(self.cos_emission);
        let theta_w = (theta_o + theta_e).min(std::f32::consts::PI);
        let (sin_o, cos_o) = libm::sincosf(theta_o);
        let spread = 2.0 * std::f32::consts::PI * (1.0 - cos_o)
            + 0.5
                * std::f32::consts::PI
                * (2.0 * theta_w * sin_o - libm::cosf(theta_o - 2.0 * theta_w) - 2.0 * theta_o * sin_o
                    + cos_o);
        let d = self.max - self.min;
        // The second term is for points in a row, whose box has no area.
        let extent = d.x * d.y + d.y * d.z + d.z * d.x + 1e-3 * d.length_squared();
        self.power * spread * 2.0 * extent
    }
}

/// Orders the lights for the best split and returns its index, neither 0 nor their number.
fn divide(lights: &mut [(u32, LightBounds)]) -> usize {
    if lights.len() == 2 {
        return 1;
    }
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for (_, bounds) in lights.iter() {
        (low, high) = (low.min(bounds.center()), high.max(bounds.center()));
    }
    let extent = high - low;
    let bucket_of = |bounds: &LightBounds, axis: usize| {
        let place = (bounds.center()[axis] - low[axis]) / extent[axis];
        ((place * BUCKETS as f32) as usize).min(BUCKETS - 1)
    };
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in (0..3).filter(|&axis| extent[axis] > 0.0) {
        let mut buckets: [Option<LightBounds>; BUCKETS] = [None; BUCKETS];
        for (_, bounds) in lights.iter() {
            let bucket = &mut buckets[bucket_of(bounds, axis)];
            *bucket = Some(bucket.map_or(*bounds, |sum| sum.union(bounds)));
        }
        // Cost of the lights below each candidate split, and then of those above.
        let mut below = [None; BUCKETS];
        let mut sum: Option<LightBounds> = None;
        for at in 1..BUCKETS {
            if let Some(bucket) = &buckets[at - 1] {
                let union = sum.map_or(*bucket, |sum| sum.union(bucket));
                below[at] = Some(union.cost());
                sum = Some(union);
            }
        }
        // Splits of thin boxes along their thin sides cost more.
        let stretch = extent.max_element() / extent[axis];
        let mut sum: Option<LightBounds> = None;
        for at in (1..BUCKETS).rev() {
            if let Some(bucket) = &buckets[at] {
                sum = Some(sum.map_or(*bucket, |sum| sum.union(bucket)));
            }
            // Where the bucket below is empty, the next split down is the same.
            let (Some(above), Some(below)) = (&sum, below[at]) else { continue };
            let cost = stretch * (below + above.cost());
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, at));
            }
        }
    }
    let Some((_, axis, at)) = best else { return lights.len() / 2 };
    partition(lights, |bounds| bucket_of(bounds, axis) < at)
}

/// Partitions the lights and returns the number of those that come first.
fn partition(lights: &mut [(u32, LightBounds)], comes_first: impl Fn(&LightBounds) -> bool) -> usize {
    let mut middle = 0;
    for index in 0..lights.len() {
        if comes_first(&lights[index].1) {
            lights.swap(middle, index);
            middle += 1;
        }
    }
    middle
}

#[cfg(test)]
mod tests;
