//! Binned SAH splits of a set of primitives: Wald (2007).
//!
//! Centroids are binned on all three axes in one pass: Wald (2007), "On fast Construction of SAH-based Bounding
//! Volume Hierarchies". Minima and negated maxima are in one vector, so one instruction unites boxes.

use crate::aabb::Aabb;
use crate::conservative::BLOCK;
use lookfrom_simd::{Kernel, Simd, f32x4, f32x8, prelude::*, u32x4};

use super::reference::{Covered, Reference};

/// Maximum number of bins per axis.
pub(super) const MAX_BINS: usize = 32;

/// Number of bins for smaller sets, with less to clear.
const FEW_BINS: usize = 8;

/// Splits two or more references by moving those of the left side to the front. Returns their number and the boxes
/// of the two sides, or `None` where no split between bins separates anything.
pub(super) struct Split<'a> {
    pub(super) references: &'a mut [Reference],
    pub(super) centers: &'a Aabb,
    /// Per axis, at most [`MAX_BINS`].
    pub(super) bins: usize,
}

impl Kernel for Split<'_> {
    type Output = Option<(usize, [Covered; 2])>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        if self.bins <= FEW_BINS { self.split::<S, FEW_BINS>(simd) } else { self.split::<S, MAX_BINS>(simd) }
    }
}

impl Split<'_> {
    #[inline(always)]
    fn split<S: Simd, const BINS: usize>(self, simd: S) -> Option<(usize, [Covered; 2])> {
        let binning = Binning::new(simd, self.centers, self.bins);
        let mut bins = Bins::<S, BINS>::new(simd);
        for reference in &*self.references {
            let lanes = reference.lanes(simd);
            let numbers = binning.bins(simd, twice_center(lanes));
            for axis in 0..3 {
                let bin = numbers[axis] as usize % BINS;
                bins.boxes[bin][axis] = bins.boxes[bin][axis].min(lanes);
                bins.counts[bin][axis] += 1;
            }
        }
        let (axis, split) = bins.cheapest_split(simd, self.bins)?;

        // Move the left side to the front, without a branch, since it could not be predicted.
        let mut centers = [f32x8::splat(simd, f32::INFINITY); 2];
        let mut middle = 0;
        for place in 0..self.references.len() {
            let reference = self.references[place];
            let center = twice_center(reference.lanes(simd));
            let is_left = usize::from((binning.bins(simd, center)[axis] as usize) < split);
            let center = point(center);
            // The centres of the other side are moved to infinity.
            centers[0] = centers[0].min(center + f32x8::splat(simd, [f32::INFINITY, 0.0][is_left]));
            centers[1] = centers[1].min(center + f32x8::splat(simd, [0.0, f32::INFINITY][is_left]));
            self.references[place] = self.references[middle];
            self.references[middle] = reference;
            middle += is_left;
        }
        Some((middle, bins.covered(axis, split, self.bins, centers)))
    }
}

#[inline(always)]
fn twice_center<S: Simd>(lanes: f32x8<S>) -> f32x4<S> {
    let (min, negated_max) = lanes.split();
    min - negated_max
}

/// The box of a point.
#[inline(always)]
fn point<S: Simd>(center: f32x4<S>) -> f32x8<S> {
    center.combine(-center)
}

#[inline(always)]
fn aabb<S: Simd>(lanes: f32x8<S>) -> Aabb {
    let [x, y, z, _, u, v, w, _]: [f32; 8] = lanes.into();
    Aabb { min: [x, y, z], max: [-u, -v, -w] }
}

/// The map from centroids to bins.
struct Binning<S: Simd> {
    origin: f32x4<S>,
    scale: f32x4<S>,
    last: f32x4<S>,
}

impl<S: Simd> Binning<S> {
    #[inline(always)]
    fn new(simd: S, centers: &Aabb, bins: usize) -> Self {
        let [x, y, z] = centers.min;
        let [u, v, w] = [0, 1, 2].map(|axis| {
            let scale = bins as f32 / (centers.max[axis] - centers.min[axis]);
            if scale.is_finite() { scale } else { 0.0 }
        });
        Self {
            origin: f32x4::simd_from(simd, [x, y, z, 0.0]),
            scale: f32x4::simd_from(simd, [u, v, w, 0.0]),
            last: f32x4::splat(simd, (bins - 1) as f32),
        }
    }

    /// The bins on the three axes. (The fourth lane is unused.)
    #[inline(always)]
    fn bins(&self, simd: S, twice_center: f32x4<S>) -> [i32; 4] {
        let place = (twice_center - self.origin) * self.scale;
        simd.cvt_i32_f32x4(place.min(self.last)).into()
    }
}

/// The content of the bins of the three axes.
struct Bins<S: Simd, const BINS: usize> {
    boxes: [[f32x8<S>; 3]; BINS],
    counts: [[u32; 4]; BINS],
}

impl<S: Simd, const BINS: usize> Bins<S, BINS> {
    #[inline(always)]
    fn new(simd: S) -> Self {
        Self { boxes: [[f32x8::splat(simd, f32::INFINITY); 3]; BINS], counts: [[0; 4]; BINS] }
    }

    /// The axis of the cheapest split, and the first bin to its right.
    #[inline(always)]
    fn cheapest_split(&self, simd: S, bins: usize) -> Option<(usize, usize)> {
        // Sweep from the right: the boxes to the right of each split.
        let nothing = f32x4::splat(simd, f32::INFINITY);
        let mut right = [nothing; BINS];
        let mut side = Side::new(simd);
        for bin in (1..bins).rev() {
            right[bin] = side.add(simd, &self.boxes[bin], &self.counts[bin]);
        }
        // Sweep from the left and compare.
        let mut least = nothing;
        let mut best = f32x4::splat(simd, 0.0);
        let mut side = Side::new(simd);
        for bin in 1..bins {
            let cost = side.add(simd, &self.boxes[bin - 1], &self.counts[bin - 1]) + right[bin];
            let less = cost.simd_lt(least);
            least = less.select(cost, least);
            best = less.select(f32x4::splat(simd, bin as f32), best);
        }
        let (least, best): ([f32; 4], [f32; 4]) = (least.into(), best.into());
        let axis = (1..3).fold(0, |axis, other| if least[other] < least[axis] { other } else { axis });
        (least[axis] < f32::INFINITY).then_some((axis, best[axis] as usize))
    }

    /// The boxes of the two sides of a split.
    #[inline(always)]
    fn covered(&self, axis: usize, split: usize, bins: usize, centers: [f32x8<S>; 2]) -> [Covered; 2] {
        let mut sides = [self.boxes[0][axis], self.boxes[split][axis]];
        for bin in 1..bins {
            let side = usize::from(bin >= split);
            sides[side] = sides[side].min(self.boxes[bin][axis]);
        }
        [0, 1].map(
            #[inline(always)]
            |side| Covered { bounds: aabb(sides[side]), centers: aabb(centers[side]) },
        )
    }
}

/// One side of a split, for each axis.
struct Side<S: Simd> {
    bounds: [f32x8<S>; 3],
    /// Lane by lane.
    counts: u32x4<S>,
}

impl<S: Simd> Side<S> {
    #[inline(always)]
    fn new(simd: S) -> Self {
        Self { bounds: [f32x8::splat(simd, f32::INFINITY); 3], counts: u32x4::splat(simd, 0) }
    }

    /// Adds a bin of each axis. Returns, in a lane for each axis, half the area times the number of blocks, since
    /// the primitives of a block are tested together; infinity for an empty side. (The fourth lane is unused.)
    #[inline(always)]
    fn add(&mut self, simd: S, boxes: &[f32x8<S>; 3], counts: &[u32; 4]) -> f32x4<S> {
        self.counts += u32x4::load_array_ref(simd, counts);
        let mut extents = [f32x4::splat(simd, 0.0); 3];
        for axis in 0..3 {
            self.bounds[axis] = self.bounds[axis].min(boxes[axis]);
            let (min, negated_max) = self.bounds[axis].split();
            extents[axis] = min + negated_max;
        }
        // Transpose from a vector per split to a vector per dimension. Extents are negated, their products are not.
        let [a, b, c] = extents;
        let (xy_ac, xy_b) = (a.zip_low(c), b.zip_low(b));
        let [x, y] = [xy_ac.zip_low(xy_b), xy_ac.zip_high(xy_b)];
        let z = a.zip_high(c).zip_low(b.zip_high(b));
        let half_areas = (x * (y + z) + y * z).min(f32x4::splat(simd, 1e30));
        let blocks =
            simd.cvt_f32_u32x4((self.counts + u32x4::splat(simd, BLOCK as u32 - 1)) >> BLOCK.ilog2());
        let empty = self.counts.simd_eq(u32x4::splat(simd, 0));
        empty.select(f32x4::splat(simd, f32::INFINITY), half_areas * blocks)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::primitives::Kind;
    use crate::dispatch::{dispatch_or_scalar, levels_and_scalar};
    use crate::testing::Random;

    /// The cheapest split by a plain search: the least cost, and the references on its two sides.
    fn reference_split(
        references: &[Reference],
        centers: &Aabb,
        bins: usize,
    ) -> Option<(f32, [Vec<u32>; 2])> {
        let mut best: Option<(f32, [Vec<u32>; 2])> = None;
        for axis in 0..3 {
            let scale = bins as f32 / (centers.max[axis] - centers.min[axis]);
            let bin = |reference: &Reference| {
                let place = (reference.bounds().twice_center()[axis] - centers.min[axis]) * scale;
                if scale.is_finite() { (place as usize).min(bins - 1) } else { 0 }
            };
            for split in 1..bins {
                let sides: [Vec<Reference>; 2] = [true, false]
                    .map(|left| references.iter().copied().filter(|r| (bin(r) < split) == left).collect());
                if sides.iter().any(Vec::is_empty) {
                    continue;
                }
                let [left, right] = sides
                    .each_ref()
                    .map(|side| Covered::by(side).bounds.half_area() * side.len().div_ceil(BLOCK) as f32);
                if best.as_ref().is_none_or(|(least, _)| left + right < *least) {
                    best = Some((left + right, sides.map(|side| numbers(&side))));
                }
            }
        }
        best
    }

    fn numbers(references: &[Reference]) -> Vec<u32> {
        let mut numbers: Vec<u32> = references.iter().map(Reference::number).collect();
        numbers.sort_unstable();
        numbers
    }

    #[test]
    fn every_level_splits_as_the_plain_rule_does() {
        let mut random = Random::new(3);
        let (mut splits, mut none) = (0, 0);
        for round in 0..3000 {
            let count = 2 + random.below(if round % 10 == 0 { 300 } else { 12 });
            let (place, spread) = (random.point_with_exponents(-6, 6), random.size(-6, 6));
            let flat = random.below(4) as usize;
            let size = spread * random.size(-3, 1);
            let references: Vec<Reference> = (0..count)
                .map(|number| {
                    let mut center = random.near(place, spread);
                    (0..flat).for_each(|axis| center[axis] = place[axis]);
                    let corners = [random.near(center, size), random.near(center, size)];
                    Reference::new(&Aabb::around(&corners).padded(), number, Kind::Triangle)
                })
                .collect();
            let covered = Covered::by(&references);
            let bins = [4, 8, 16, MAX_BINS][random.below(4) as usize];
            let expected = reference_split(&references, &covered.centers, bins);
            for level in levels_and_scalar() {
                let mut sorted = references.clone();
                let split = dispatch_or_scalar(
                    level,
                    Split { references: &mut sorted, centers: &covered.centers, bins },
                );
                let Some((middle, sides)) = split else {
                    assert!(expected.is_none());
                    none += 1;
                    continue;
                };
                let (least, expected) = expected.as_ref().unwrap();
                let (left, right) = sorted.split_at(middle);
                let cost: f32 = [left, right]
                    .iter()
                    .map(|side| Covered::by(side).bounds.half_area() * side.len().div_ceil(BLOCK) as f32)
                    .sum();
                // The order of summation may decide between equally good splits.
                assert!((cost - least).abs() <= 1e-6 * least, "{cost}, not {least}");
                if cost == *least {
                    assert_eq!([numbers(left), numbers(right)], *expected);
                }
                assert_eq!(sides, [Covered::by(left), Covered::by(right)]);
                splits += 1;
            }
        }
        assert!(splits > 5000 && none > 0, "{splits} splits, none {none} times");
    }
}
