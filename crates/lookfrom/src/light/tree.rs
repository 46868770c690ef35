//! Many lights, few samples: a tree over lights by which one is chosen in proportion to what it may send to a place.
//!
//! Conty Estevez & Kulla 2018 (importance of bundles of lights, cost of a division by their orientation); the bounds of
//! an importance as pbrt-v4 has them.

use glam::Vec3;

use super::cone::{Cone, angle};
use crate::sampler::ONE_MINUS_EPSILON;

/// How many parts of an axis are tried as places to divide at.
const BUCKETS: usize = 12;

/// Where a light stands, where it looks and how much it sends out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bundle {
    /// Least corner, in render space.
    pub(super) min: Vec3,
    /// Greatest corner.
    pub(super) max: Vec3,
    /// The directions of the surfaces' normals (or of the axis of a spot).
    pub(super) normals: Cone,
    /// Cosine of the greatest angle to a normal at which light is sent out.
    pub(super) cos_emission: f32,
    /// Whether the other side sends light too.
    pub(super) two_sided: bool,
    /// Power, in any unit: ≥ 0.
    pub(super) power: f32,
}

/// A tree over lights with a place.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    /// For each light of the world, the turns from the root to its leaf, the first in the lowest bit; `None` where it is
    /// not in the tree.
    ways: Vec<Option<u64>>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bundle: Bundle,
    /// A light, or the index of the second child; the first one follows its parent.
    link: Link,
}

#[derive(Clone, Copy, Debug)]
enum Link {
    Light(u32),
    Second(u32),
}

impl Tree {
    /// A tree over lights with their numbers, of `count` lights in the world. Lights without power are left out.
    pub(super) fn new(lights: &[(u32, Bundle)], count: usize) -> Self {
        let mut tree = Self { nodes: Vec::new(), ways: vec![None; count] };
        let mut lights: Vec<(u32, Bundle)> = lights.iter().copied().filter(|(_, b)| b.power > 0.0).collect();
        if !lights.is_empty() {
            tree.build(&mut lights, 0, 0);
        }
        tree
    }

    /// Whether there is no light in it.
    pub(super) fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    fn build(&mut self, lights: &mut [(u32, Bundle)], way: u64, depth: u32) -> Bundle {
        let node = self.nodes.len();
        if let [(light, bundle)] = *lights {
            self.nodes.push(Node { bundle, link: Link::Light(light) });
            self.ways[light as usize] = Some(way);
            return bundle;
        }
        // Below 40 turns the tree is halved, so that 64 bits are always enough.
        let middle = if depth < 40 { divide(lights) } else { lights.len() / 2 };
        let (left, right) = lights.split_at_mut(middle);
        let placeholder = left[0].1;
        self.nodes.push(Node { bundle: placeholder, link: Link::Second(0) });
        let first = self.build(left, way, depth + 1);
        let second_index = self.nodes.len() as u32;
        let second = self.build(right, way | 1 << depth, depth + 1);
        let bundle = first.union(&second);
        self.nodes[node] = Node { bundle, link: Link::Second(second_index) };
        bundle
    }

    /// A light for `u ∈ [0, 1)` and its probability; `None` where none can send anything to `p`.
    pub(super) fn sample(&self, p: Vec3, n: Vec3, mut u: f32) -> Option<(u32, f32)> {
        let mut probability = 1.0;
        let mut node = 0;
        loop {
            match self.nodes.get(node)?.link {
                Link::Light(light) => {
                    // a tree of one light is chosen without a look at it
                    let possible = node > 0 || self.nodes[0].bundle.importance(p, n) > 0.0;
                    return possible.then_some((light, probability));
                }
                Link::Second(second) => {
                    let share = self.first_share(node, second as usize, p, n)?;
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
                Link::Light(_) if node == 0 && self.nodes[0].bundle.importance(p, n) <= 0.0 => return 0.0,
                Link::Light(_) => return probability,
                Link::Second(second) => {
                    let Some(share) = self.first_share(node, second as usize, p, n) else { return 0.0 };
                    let first = way & 1 == 0;
                    probability *= if first { share } else { 1.0 - share };
                    node = if first { node + 1 } else { second as usize };
                    way >>= 1;
                }
            }
        }
    }

    fn first_share(&self, node: usize, second: usize, p: Vec3, n: Vec3) -> Option<f32> {
        let first = self.nodes[node + 1].bundle.importance(p, n);
        let second = self.nodes[second].bundle.importance(p, n);
        let sum = first + second;
        (sum > 0.0).then(|| first / sum)
    }
}

impl Bundle {
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

    /// An upper bound, up to the variation of distance within the bundle, of what arrives at `p` with normal `n`.
    fn importance(&self, p: Vec3, n: Vec3) -> f32 {
        let center = self.center();
        let radius = 0.5 * (self.max - self.min).length();
        let to_p = p - center;
        // Near and inside, distance says nothing.
        let distance2 = to_p.length_squared().max(radius);
        let Some(wi) = to_p.try_normalize() else { return self.power / distance2 };

        // θ to the axis, less the spread of the normals, less what the box fills of the view.
        let mut cos_axis = self.normals.axis.dot(wi);
        if self.two_sided {
            cos_axis = cos_axis.abs();
        }
        let length2 = to_p.length_squared();
        let cos_box =
            if length2 <= radius * radius { -1.0 } else { (1.0 - radius * radius / length2).max(0.0).sqrt() };
        let least = angle_less(angle_less((cos_axis, sin_of(cos_axis)), self.normals.cos), cos_box);
        if least.0 <= self.cos_emission {
            return 0.0;
        }
        // At the surface: the least angle between its normal and the box, on either side.
        let cos_surface = wi.dot(n).abs();
        let at_surface = angle_less((cos_surface, sin_of(cos_surface)), cos_box);
        (self.power * least.0 / distance2 * at_surface.0).max(0.0)
    }

    /// Surface area × solid angle of the normals with their emission: how much is lost by asking for one of the bundle.
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
        self.power * spread * 2.0 * (d.x * d.y + d.y * d.z + d.z * d.x)
    }
}

fn sin_of(cos: f32) -> f32 {
    (1.0 - cos * cos).max(0.0).sqrt()
}

/// Cosine and sine of max(0, a − b), for angles by (cos, sin) and cosine.
fn angle_less((cos_a, sin_a): (f32, f32), cos_b: f32) -> (f32, f32) {
    if cos_a > cos_b {
        return (1.0, 0.0);
    }
    let sin_b = sin_of(cos_b);
    (cos_a * cos_b + sin_a * sin_b, sin_a * cos_b - cos_a * sin_b)
}

/// Orders the lights so that they are best divided at the given place.
fn divide(lights: &mut [(u32, Bundle)]) -> usize {
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for (_, bundle) in lights.iter() {
        (low, high) = (low.min(bundle.center()), high.max(bundle.center()));
    }
    let extent = high - low;
    let bucket_of = |bundle: &Bundle, axis: usize| {
        let place = (bundle.center()[axis] - low[axis]) / extent[axis];
        ((place * BUCKETS as f32) as usize).min(BUCKETS - 1)
    };
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in (0..3).filter(|&axis| extent[axis] > 0.0) {
        let mut buckets: [Option<Bundle>; BUCKETS] = [None; BUCKETS];
        for (_, bundle) in lights.iter() {
            let bucket = &mut buckets[bucket_of(bundle, axis)];
            *bucket = Some(bucket.map_or(*bundle, |sum| sum.union(bundle)));
        }
        let join = |part: &[Option<Bundle>]| part.iter().flatten().copied().reduce(|a, b| a.union(&b));
        // Thin boxes are dear along their thin sides.
        let stretch = extent.max_element() / extent[axis];
        for at in 1..BUCKETS {
            let (Some(below), Some(above)) = (join(&buckets[..at]), join(&buckets[at..])) else { continue };
            let cost = stretch * (below.cost() + above.cost());
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, at));
            }
        }
    }
    let Some((_, axis, at)) = best else { return lights.len() / 2 };
    lights.sort_by_key(|(light, bundle)| (bucket_of(bundle, axis) >= at, *light));
    lights.partition_point(|(_, bundle)| bucket_of(bundle, axis) < at)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bundles(count: u32) -> Vec<(u32, Bundle)> {
        let mut seed = 7_u32;
        let mut next = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / 16_777_216.0
        };
        (0..count)
            .map(|light| {
                let min = Vec3::new(next(), next(), next()) * 10.0;
                let bundle = Bundle {
                    min,
                    max: min + Vec3::new(next(), next(), next()),
                    normals: Cone { axis: crate::warp::uniform_sphere([next(), next()]), cos: 1.0 - next() },
                    cos_emission: 0.0,
                    two_sided: light % 3 == 0,
                    power: 0.1 + next(),
                };
                (light, bundle)
            })
            .collect()
    }

    #[test]
    fn probabilities_sum_to_one_and_are_those_of_samples() {
        for count in [1, 2, 3, 17, 200] {
            let lights = bundles(count);
            let tree = Tree::new(&lights, count as usize);
            for (p, n) in [(Vec3::splat(5.0), Vec3::Y), (Vec3::new(-30.0, 2.0, 1.0), Vec3::X)] {
                let sum: f32 = (0..count).map(|light| tree.probability(p, n, light)).sum();
                assert!((sum - 1.0).abs() < 1e-4 || sum == 0.0, "{count} {sum}");
                for k in 0..500 {
                    let u = (k as f32 + 0.5) / 500.0;
                    let Some((light, probability)) = tree.sample(p, n, u) else { continue };
                    assert!((probability - tree.probability(p, n, light)).abs() < 1e-6);
                }
            }
        }
    }

    #[test]
    fn near_lights_are_chosen_more_often() {
        let at = |x: f32| Bundle {
            min: Vec3::new(x, 3.0, 0.0),
            max: Vec3::new(x, 3.0, 0.0),
            normals: Cone::ALL,
            cos_emission: 0.0,
            two_sided: false,
            power: 1.0,
        };
        let tree = Tree::new(&[(0, at(0.0)), (1, at(10.0))], 2);
        assert!(tree.probability(Vec3::ZERO, Vec3::Y, 0) > 0.9);
    }

    #[test]
    fn a_thousand_lights_in_one_place_are_no_trouble() {
        let one = bundles(1)[0].1;
        let lights: Vec<(u32, Bundle)> = (0..1000).map(|light| (light, one)).collect();
        let tree = Tree::new(&lights, 1000);
        let p = one.center() + one.normals.axis * 3.0;
        assert!((tree.probability(p, Vec3::Y, 500) - 1e-3).abs() < 1e-4);
    }
}
