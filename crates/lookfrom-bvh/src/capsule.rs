//! Capsules around thin shapes, side by side: those of a leaf, of which one ray excludes most in single precision.

use crate::aabb::Aabb;
use crate::exact::ExactRay;
use crate::lanes::{LANES, greatest, splat_all};
use crate::vector::{cross, dot, round_up, subtract};
use lookfrom_simd::{LaneMask, Simd, f32x8, i32x8, prelude::*};

/// All points at most a radius away from a segment.
///
/// ```
/// use lookfrom_bvh::Capsule;
/// let capsule = Capsule { ends: [[0.0; 3], [0.0, 1.0, 0.0]], radius: 0.01 };
/// # assert_eq!(capsule.radius, 0.01);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// The ends of the segment.
    pub ends: [[f32; 3]; 2],
    /// Not negative.
    pub radius: f32,
}

/// The steps that numbers of a block are counted in, along its longest axis.
const STEPS: f64 = 30_000.0;

/// A radius that excludes nothing.
const EVERYWHERE: u16 = u16::MAX;

/// The capsules of one to eight procedural shapes, component by component.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct CapsuleBlock {
    /// `ends[axis][lane]`: the first end in the lower half, the second in the upper; in steps from the corner.
    ends: [[i32; LANES]; 3],
    /// In steps.
    radius: [u16; LANES],
    /// The least coordinates of the ends.
    corner: [f32; 3],
    step: f32,
}

impl CapsuleBlock {
    /// Packs the capsules of up to eight shapes.
    pub(crate) fn new(capsules: &[Option<Capsule>]) -> Self {
        let known = || capsules.iter().flatten();
        let mut bounds = Aabb::EMPTY;
        known().flat_map(|capsule| capsule.ends).for_each(|end| bounds.extend(end));
        let longest = (0..3).map(|axis| f64::from(bounds.max[axis]) - f64::from(bounds.min[axis]));
        let longest = longest.chain(known().map(|capsule| f64::from(capsule.radius))).fold(0.0, f64::max);
        let step = round_up(longest / STEPS).max(f32::MIN_POSITIVE);
        let corner = bounds.min;

        let mut block = Self { ends: [[0; LANES]; 3], radius: [EVERYWHERE; LANES], corner, step };
        let wide_step = f64::from(step);
        for (lane, capsule) in capsules.iter().enumerate() {
            let Some(Capsule { ends, radius }) = capsule else { continue };
            let mut off = [0.0_f64; 2];
            for axis in 0..3 {
                let steps = [0, 1].map(|end| {
                    let exact = (f64::from(ends[end][axis]) - f64::from(corner[axis])) / wide_step;
                    off[end] += (exact - exact.round()).powi(2);
                    exact.round() as i32
                });
                block.ends[axis][lane] = steps[0] | steps[1] << 16;
            }
            // Larger by what the ends were moved. (Not a number, which `max` would ignore: everywhere.)
            let moved = off[0].max(off[1]) + 0.0 * (off[0] + off[1]);
            let radius = f64::from(*radius) / wide_step + moved.sqrt();
            if radius < STEPS + 2.0 {
                block.radius[lane] = (radius * (1.0 + 1e-9)).ceil() as u16;
            }
        }
        block
    }

    /// The shapes, of `count`, that a ray rounded to single precision may hit at t from `t_min` to `t_max`; it surely misses all others.
    ///
    /// Seen along the direction d, a segment from a to b is the one from (a − o) × d to (b − o) × d, turned and |d| times as large; a
    /// capsule is excluded where that is farther from zero than r |d|. With units of rounding u = 2⁻²⁴ and m the greatest magnitude of
    /// a − o and b − o and the block's extent, both ends and the nearest point between them have errors below 100 u m |d|; the margin is 128.
    #[inline(always)]
    pub(crate) fn may_hit<S: Simd>(
        &self,
        simd: S,
        count: usize,
        ray: &ExactRay,
        [t_min, t_max]: [f32; 2],
    ) -> LaneMask {
        const MARGIN: f32 = 128.0 * f32::EPSILON / 2.0;
        // More than what products lose by underflow.
        const TINY: f32 = 1e-30;
        // Less than what overflows in the next step.
        const HUGE: f32 = 1e37;
        // More than the rounding of a distance, its square and its product.
        const ROUNDING: f32 = 1e-6;

        let used = LaneMask((1 << count) - 1);
        let d = ray.direction.map(|x| x as f32);
        let square = dot(d, d);
        if !(square > TINY && square < HUGE) {
            return used;
        }

        // The ends as seen from the origin.
        let corner = splat_all(simd, subtract(self.corner, ray.origin.map(|x| x as f32)));
        let direction = splat_all(simd, d);
        let steps = |number: i32x8<S>| number.to_float::<f32x8<S>>() * self.step;
        let first =
            |axis: usize| corner[axis] + steps(i32x8::load_array_ref(simd, &self.ends[axis]) & 0xffff);
        let second = |axis: usize| corner[axis] + steps(i32x8::load_array_ref(simd, &self.ends[axis]) >> 16);
        let (a, b) = ([first(0), first(1), first(2)], [second(0), second(1), second(2)]);
        let length = square.sqrt();
        let extent = f32x8::splat(simd, STEPS as f32 * self.step);
        let error = greatest(a).max(greatest(b)).max(extent) * (MARGIN * length);
        let radius = f32x8::from_fn(
            simd,
            #[inline(always)]
            |lane| if self.radius[lane] == EVERYWHERE { f32::INFINITY } else { f32::from(self.radius[lane]) },
        );
        let reach = radius * (self.step * length) + error;

        // Across the ray: the point nearest to it between the ends.
        let (start, end) = (cross(a, direction), cross(b, direction));
        let way = subtract(end, start);
        let way_square = dot(way, way);
        let zero = f32x8::splat(simd, 0.0);
        let share = (zero - dot(start, way)) / way_square.max(f32x8::splat(simd, f32::MIN_POSITIVE));
        let share = share.max(zero).min(f32x8::splat(simd, 1.0));
        let nearest = [start[0] + way[0] * share, start[1] + way[1] * share, start[2] + way[2] * share];
        let distance_square = dot(nearest, nearest);
        let is_apart = distance_square.simd_gt(reach * reach * (1.0 + 16.0 * ROUNDING) + TINY)
            & distance_square.simd_lt(HUGE)
            & way_square.simd_lt(HUGE);

        // Along the ray: before the first hit that counts, or behind the last.
        let (a, b) = (dot(a, direction), dot(b, direction));
        let is_finite = a.abs().max(b.abs()).simd_lt(HUGE);
        let [first, last] = [t_min - t_min.abs() * ROUNDING, t_max + t_max.abs() * ROUNDING];
        let is_before = (a.max(b) + reach).simd_lt(first * square);
        let is_behind = (a.min(b) - reach).simd_gt(last * square);
        let is_excluded = is_apart | (is_finite & (is_before | is_behind));
        LaneMask(!(is_excluded.to_bitmask() as u32) & used.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dispatch::{dispatch_or_scalar, levels_and_scalar};
    use crate::ray::Ray;
    use crate::testing::Random;
    use crate::vector::wide;
    use lookfrom_simd::Kernel;

    struct MayHit<'a>(&'a CapsuleBlock, &'a Ray, usize);

    impl Kernel for MayHit<'_> {
        type Output = LaneMask;
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> LaneMask {
            self.0.may_hit(simd, self.2, &ExactRay::new(self.1), [self.1.t_min, self.1.t_max])
        }
    }

    /// The closest approach of a line to a capsule's segment: t, and the distance.
    fn nearest(capsule: &Capsule, ray: &Ray) -> (f64, f64) {
        let [a, b] = capsule.ends.map(|end| subtract(wide(end), wide(ray.origin)));
        let d = wide(ray.direction);
        let (start, way) = (cross(a, d), cross(subtract(b, a), d));
        let share = (-dot(start, way) / dot(way, way).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let point = [0, 1, 2].map(|axis| a[axis] + share * (b[axis] - a[axis]));
        let off = cross(point, d);
        (dot(point, d) / dot(d, d), (dot(off, off) / dot(d, d)).sqrt())
    }

    #[test]
    fn what_is_hit_is_never_excluded() {
        let mut random = Random::new(41);
        let levels = levels_and_scalar();
        let (mut hits, mut kept, mut all) = (0, 0, 0);
        for round in 0..60_000 {
            // Every fourth round goes to the limits of the numbers.
            let wide_range = if round % 4 == 0 { 28 } else { 4 };
            let center = random.point_with_exponents(-wide_range, wide_range);
            let size = random.size(-wide_range, wide_range);
            let count = 1 + random.below(8);
            let capsules: Vec<_> = (0..count)
                .map(|_| {
                    let start = random.near(center, size);
                    let length = size * random.size(-4, 0);
                    Capsule { ends: [start, random.near(start, length)], radius: size * random.size(-6, -1) }
                })
                .collect();
            let block = CapsuleBlock::new(&capsules.iter().copied().map(Some).collect::<Vec<_>>());

            // A ray past the edge of one of them.
            let Capsule { ends: [a, b], radius } = capsules[random.below(count) as usize];
            let share = random.unit();
            let edge = random.direction();
            let off = radius * (1.0 + random.size(-9, 0) * if random.unit() < 0.5 { 1.0 } else { -1.0 })
                / dot(edge, edge).sqrt();
            let target = [0, 1, 2].map(|axis| a[axis] + share * (b[axis] - a[axis]) + off * edge[axis]);
            let away = random.size(-wide_range, wide_range);
            let origin = if random.unit() < 0.2 { target } else { random.near(target, away) };
            let stretch = random.size(-wide_range, wide_range);
            let direction = match random.unit() < 0.2 {
                true => random.direction(),
                false => [0, 1, 2].map(|axis| stretch * (target[axis] - origin[axis])),
            };
            let t_min = if random.unit() < 0.2 { -random.size(-3, 3) } else { 0.0 };
            let t_max = if random.unit() < 0.5 { f32::INFINITY } else { random.size(-3, 3) };
            let ray = Ray { origin, t_min, direction, t_max };
            let may_hit =
                dispatch_or_scalar(levels[round % levels.len()], MayHit(&block, &ray, capsules.len()));
            for (lane, capsule) in capsules.iter().enumerate() {
                let (t, distance) = nearest(capsule, &ray);
                let is_hit =
                    distance <= f64::from(capsule.radius) && t >= f64::from(t_min) && t <= f64::from(t_max);
                assert!(!is_hit || may_hit.0 >> lane & 1 == 1, "{capsule:?} {ray:?} {t} {distance}");
                hits += usize::from(is_hit);
            }
            kept += may_hit.count();
            all += count as usize;
        }
        assert!(15_000 < hits && hits < kept && kept < 2 * all / 3, "{hits} hits, {kept} kept of {all}");
    }

    #[test]
    fn the_margin_is_small_beside_a_hair() {
        // A hair of a tenth of a millimetre, a metre away: a ray that passes it by a fifth more than the radius.
        let hair = Capsule { ends: [[0.0, 0.0, 1.0], [0.0, 0.005, 1.0]], radius: 5e-5 };
        let block = CapsuleBlock::new(&[Some(hair), None]);
        let beside = |off: f32| Ray::new([off, 0.002, 0.0], [0.0, 0.0, 1.0]);
        for level in levels_and_scalar() {
            assert_eq!(dispatch_or_scalar(level, MayHit(&block, &beside(5e-5), 2)), LaneMask(0b11));
            assert_eq!(dispatch_or_scalar(level, MayHit(&block, &beside(6e-5), 2)), LaneMask(0b10));
        }
    }
}
