//! Blocks of spheres: those of a leaf, side by side, of which one ray excludes most in single precision.

use super::{Sphere, SphereFilter};
use crate::exact::ExactRay;
use crate::lanes::{LANES, splat_all};
use crate::ray::NONE;
use lookfrom_simd::{LaneMask, Simd, f32x8, prelude::*};

/// A sphere and its ids.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SphereItem {
    pub(crate) shape: Sphere,
    pub(crate) geometry: u32,
    pub(crate) primitive: u32,
}

/// One to eight spheres, component by component.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct SphereBlock {
    /// `center[axis][lane]`.
    center: [[f32; LANES]; 3],
    radius: [f32; LANES],
    geometry: [u32; LANES],
    /// [`NONE`] in unused lanes.
    primitive: [u32; LANES],
}

impl SphereBlock {
    /// Packs up to eight spheres.
    pub(crate) fn new(items: impl IntoIterator<Item = SphereItem>) -> Self {
        let mut block = Self {
            center: [[0.0; LANES]; 3],
            radius: [0.0; LANES],
            geometry: [NONE; LANES],
            primitive: [NONE; LANES],
        };
        for (lane, SphereItem { shape, geometry, primitive }) in items.into_iter().enumerate() {
            block.set_shape(lane, &shape);
            (block.geometry[lane], block.primitive[lane]) = (geometry, primitive);
        }
        block
    }

    /// Number of spheres.
    #[inline(always)]
    pub(crate) fn count(&self) -> usize {
        self.primitive.iter().filter(|&&primitive| primitive != NONE).count()
    }

    /// The sphere in a lane.
    #[inline(always)]
    pub(crate) fn item(&self, lane: usize) -> SphereItem {
        let lane = lane & (LANES - 1);
        let [x, y, z] = &self.center;
        let shape = Sphere { center: [x[lane], y[lane], z[lane]], radius: self.radius[lane] };
        SphereItem { shape, geometry: self.geometry[lane], primitive: self.primitive[lane] }
    }

    /// All spheres.
    #[inline(always)]
    pub(crate) fn items(&self) -> impl Iterator<Item = SphereItem> {
        (0..self.count()).map(|lane| self.item(lane))
    }

    /// Moves or resizes the sphere in a lane.
    pub(crate) fn set_shape(&mut self, lane: usize, shape: &Sphere) {
        for axis in 0..3 {
            self.center[axis][lane] = shape.center[axis];
        }
        self.radius[lane] = shape.radius;
    }

    /// The spheres that a ray may hit. It must be usual, and have numbers of single precision.
    #[inline(always)]
    pub(crate) fn may_hit<S: Simd>(&self, simd: S, ray: &ExactRay) -> LaneMask {
        let [[ox, oy, oz], [dx, dy, dz]] = [ray.origin, ray.direction];
        let origin = splat_all(simd, [ox as f32, oy as f32, oz as f32]);
        let direction = splat_all(simd, [dx as f32, dy as f32, dz as f32]);
        let [x, y, z] = &self.center;
        let center =
            [f32x8::load_array_ref(simd, x), f32x8::load_array_ref(simd, y), f32x8::load_array_ref(simd, z)];
        let radius = f32x8::load_array_ref(simd, &self.radius);
        let may_hit = SphereFilter::new(origin, direction).may_hit(center, radius);
        LaneMask(may_hit.to_bitmask() as u32 & self.used())
    }

    /// The lanes in use.
    #[inline(always)]
    pub(crate) fn used(&self) -> u32 {
        (1 << self.count()) - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dispatch::{dispatch_or_scalar, levels_and_scalar};
    use crate::prepared::PreparedRay;
    use crate::ray::Ray;
    use crate::sphere::intersect_exact;
    use crate::testing::Random;
    use lookfrom_simd::Kernel;

    struct MayHit<'a>(&'a SphereBlock, &'a Ray);

    impl Kernel for MayHit<'_> {
        /// `None` for a ray that is not usual.
        type Output = Option<LaneMask>;
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            PreparedRay::usual(simd, self.1, 1.0)?;
            Some(self.0.may_hit(simd, &ExactRay::new(self.1)))
        }
    }

    #[test]
    fn spheres_that_are_hit_are_never_excluded() {
        let mut random = Random::new(11);
        let levels = levels_and_scalar();
        let (mut hits, mut kept, mut all) = (0, 0, 0);
        for round in 0..40_000 {
            let center = random.point_with_exponents(-6, 6);
            let size = random.size(-6, 6);
            let count = 1 + random.below(8);
            let items = (0..count).map(|primitive| {
                let shape = Sphere { center: random.near(center, size), radius: size * random.size(-9, 1) };
                SphereItem { shape, geometry: 0, primitive }
            });
            let block = SphereBlock::new(items.collect::<Vec<_>>());
            assert_eq!(block.count(), count as usize);

            // Past the edge of a sphere, or from it.
            let Sphere { center: of, radius } = block.item(random.below(count) as usize).shape;
            let edge = random.direction().map(|x| x * radius * (1.0 + random.size(-24, -1)));
            let target = [0, 1, 2].map(|axis| of[axis] + edge[axis]);
            let away = random.size(-6, 6);
            let origin = if random.unit() < 0.2 { target } else { random.near(target, away) };
            let stretch = random.size(-6, 6);
            let direction = match random.unit() < 0.2 {
                true => random.direction(),
                false => [0, 1, 2].map(|axis| stretch * (target[axis] - origin[axis])),
            };
            let ray = Ray::new(origin, direction);
            let level = levels[round % levels.len()];
            let Some(may_hit) = dispatch_or_scalar(level, MayHit(&block, &ray)) else { continue };
            for lane in 0..count as usize {
                let found = intersect_exact(&ExactRay::new(&ray), &block.item(lane).shape);
                let is_hit = found.is_some_and(|[_, far]| far > 0.0);
                assert!(!is_hit || may_hit.0 >> lane & 1 == 1, "{:?} {ray:?}", block.item(lane));
                hits += usize::from(is_hit);
            }
            kept += may_hit.count();
            all += count as usize;
        }
        assert!(10_000 < hits && hits < kept && kept < all / 2, "{hits} hits, {kept} kept of {all}");
    }
}
