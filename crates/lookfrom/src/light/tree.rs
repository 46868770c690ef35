//! Light tree: one of many lights, chosen in proportion to its estimated contribution.
//!
//! Conty Estevez & Kulla 2018 (importance of light clusters, surface area orientation heuristic); the bounds of an
//! importance as in pbrt-v4.

mod sight;

use glam::Vec3;
use lookfrom_simd::{Float, LaneMask, Simd, f32x8, prelude::*};

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
    pub(super) fn sample(&self, p: Vec3, n: Vec3, mut u: f32) -> Option<(u32, f32)> {
        let mut probability = 1.0;
        let mut node = 0;
        loop {
            match self.nodes.get(node)?.link {
                Link::Light(light) => return Some((light, probability)),
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
    ) -> [Option<(u32, f32)>; LANES] {
        let mut chosen = [None; LANES];
        let Some(root) = self.nodes.first() else { return chosen };
        let mut probability = f32x8::splat(simd, 1.0);
        // The first and the second child of the node that each lane has come to; done lanes stay where they are.
        let mut below = match root.link {
            Link::Light(light) => {
                return by_lane!(lane => (mask & 1 << lane != 0).then_some((light, 1.0)));
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
                        chosen[lane] = Some((light, probability[lane]));
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
mod tests {
    use lookfrom_simd::{Kernel, dispatch, level};

    use super::*;
    use crate::core::hash;
    use crate::core::lanes::gather;

    fn bundles(count: u32) -> Vec<(u32, LightBounds)> {
        let mut seed = 7_u32;
        let mut next = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / 16_777_216.0
        };
        (0..count)
            .map(|light| {
                let min = Vec3::new(next(), next(), next()) * 10.0;
                let bounds = LightBounds {
                    min,
                    max: min + Vec3::new(next(), next(), next()),
                    normals: Cone {
                        axis: crate::core::warp::uniform_sphere([next(), next()]),
                        cos: 1.0 - next(),
                    },
                    cos_emission: 0.0,
                    two_sided: light % 3 == 0,
                    power: 0.1 + next(),
                };
                (light, bounds)
            })
            .collect()
    }

    /// Choices at eight points.
    struct Eight<'a>(&'a Tree, &'a [(Vec3, Vec3, f32); LANES], u32);

    impl Kernel for Eight<'_> {
        type Output = [Option<(u32, f32)>; LANES];
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let Self(tree, at, mask) = self;
            let p = gather(simd, &by_lane!(lane => at[lane].0.to_array()));
            let n = gather(simd, &by_lane!(lane => at[lane].1.to_array()));
            let u = f32x8::load_array(simd, by_lane!(lane => at[lane].2));
            tree.sample_lanes(simd, p, n, u, mask)
        }
    }

    #[test]
    fn eight_choices_at_once_are_eight_one_by_one() {
        let number = |k: u64, of: u64| (hash::pair(k, of) >> 40) as f32 / 16_777_216.0;
        let (mut chosen, mut none) = (0, 0);
        for count in [1, 2, 9, 300] {
            let tree = Tree::new(&bundles(count), count as usize);
            for round in 0..2000 {
                let at: [(Vec3, Vec3, f32); LANES] = std::array::from_fn(|lane| {
                    let k = 8 * round + lane as u64;
                    // From inside the boxes to far away, and also without a normal.
                    let size = libm::exp2(f64::from(number(k, 0)) * 80.0 - 20.0) as f32;
                    let p = Vec3::new(number(k, 1), number(k, 2), number(k, 3)) * size;
                    let n = if k.is_multiple_of(5) {
                        Vec3::ZERO
                    } else {
                        crate::core::warp::uniform_sphere([number(k, 4), number(k, 5)])
                    };
                    (p, n, number(k, 6))
                });
                let mask = hash::pair(round, 7) as u32 & 0xff;
                let together = dispatch(level(), Eight(&tree, &at, mask));
                for (lane, (p, n, u)) in at.into_iter().enumerate() {
                    let alone = (mask & 1 << lane != 0).then(|| tree.sample(p, n, u)).flatten();
                    assert_eq!(together[lane], alone, "{p} {n} {u}");
                    chosen += u32::from(alone.is_some());
                    none += u32::from(alone.is_none());
                }
            }
        }
        assert!(chosen > 10_000 && none > 10_000, "{chosen} chosen, {none} not");
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

    /// Prints nanoseconds per choice, and seconds per build.
    #[test]
    #[ignore = "a measurement: cargo test --release -p lookfrom light::tree -- --ignored --nocapture"]
    fn speed() {
        for count in [1, 2, 10, 1000, 100_000, 1_000_000] {
            let lights = bundles(count);
            let start = std::time::Instant::now();
            let tree = Tree::new(&lights, count as usize);
            let build = start.elapsed();
            let start = std::time::Instant::now();
            const TIMES: u32 = 200_000;
            let mut sum = 0.0;
            for k in 0..TIMES {
                let u = (k as f32 + 0.5) / TIMES as f32;
                let p = Vec3::new(10.0 * u, 10.0 * (1.0 - u), (k % 16) as f32);
                sum += tree.sample(p, Vec3::Y, u).map_or(0.0, |(_, probability)| probability);
            }
            let each = start.elapsed() / TIMES;
            println!("{count} lights: {each:?} a choice, built in {build:?}, sum {sum}");
        }
    }

    #[test]
    fn near_lights_are_chosen_more_often() {
        let at = |x: f32| LightBounds {
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
        let lights: Vec<(u32, LightBounds)> = (0..1000).map(|light| (light, one)).collect();
        let tree = Tree::new(&lights, 1000);
        let p = one.center() + one.normals.axis * 3.0;
        assert!((tree.probability(p, Vec3::Y, 500) - 1e-3).abs() < 1e-4);
    }

    #[test]
    fn at_lights_and_far_away_all_numbers_are_finite() {
        let point = |x: f32, power: f32| LightBounds {
            min: Vec3::X * x,
            max: Vec3::X * x,
            normals: Cone::ALL,
            cos_emission: 0.0,
            two_sided: false,
            power,
        };
        for (apart, powers) in [(1.0, [1.0, 1e-30]), (1e-25, [1.0, 1.0]), (1e25, [1e-20, 1.0])] {
            let tree = Tree::new(&[(0, point(0.0, powers[0])), (1, point(apart, powers[1]))], 2);
            for x in [0.0, apart, 0.5 * apart, 1e-30, 1e-10, 3.0, 1e10, 1e30] {
                for n in [Vec3::X, Vec3::Y, Vec3::ZERO] {
                    let [a, b] = [0, 1].map(|light| tree.probability(Vec3::X * x, n, light));
                    assert!(a > 0.0 && b > 0.0 && (a + b - 1.0).abs() < 1e-5, "{x} {n}: {a} {b}");
                }
            }
        }
    }

    /// Brute-force reference for positive importance: rays from points of the box along directions that a normal
    /// allows.
    #[test]
    fn whoever_may_shine_on_a_point_is_chosen_sometimes() {
        let mut seed = 3_u32;
        let mut next = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / 16_777_216.0
        };
        let lights = bundles(60);
        let tree = Tree::new(&lights, 60);
        for _ in 0..20_000 {
            let (light, bounds) = lights[(next() * 60.0) as usize];
            // a normal in the cone, and a direction in which it emits light
            let (s, t) = crate::core::warp::orthonormal_basis(bounds.normals.axis);
            let local =
                Vec3::from(crate::core::warp::uniform_cone([next(), next()], 1.0 - bounds.normals.cos));
            let mut normal = s * local.x + t * local.y + bounds.normals.axis * local.z;
            if bounds.two_sided && next() < 0.5 {
                normal = -normal;
            }
            let direction = crate::core::warp::cosine_hemisphere([next(), next()], normal);
            let from = bounds.min + (bounds.max - bounds.min) * Vec3::new(next(), next(), next());
            let p = from + direction * libm::exp2f(20.0 * next() - 10.0);
            if direction.dot(normal) > 1e-3 {
                let probability =
                    tree.probability(p, crate::core::warp::uniform_sphere([next(), next()]), light);
                assert!(probability > 0.0, "{p} {bounds:?}");
            }
        }
    }

    #[test]
    fn a_row_of_lights_is_divided_well() {
        let lights: Vec<(u32, LightBounds)> = (0..1024)
            .map(|light| {
                let at = Vec3::X * light as f32;
                let normals = Cone { axis: Vec3::Y, cos: 1.0 };
                (
                    light,
                    LightBounds {
                        min: at,
                        max: at,
                        normals,
                        cos_emission: 0.0,
                        two_sided: false,
                        power: 1.0,
                    },
                )
            })
            .collect();
        let tree = Tree::new(&lights, 1024);
        let deepest = tree.ways.iter().flatten().map(|way| 64 - way.leading_zeros()).max();
        assert!(deepest <= Some(16), "{deepest:?}");
    }
}
