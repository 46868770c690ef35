//! Shapes in capsules: the same hits as of the same shapes without, by every query.

use std::sync::Arc;

use lookfrom_bvh::{
    Aabb, Affine, Builder, Bvh, Capsule, Hit, Procedural, ProceduralHit, Quality, Ray, RayF64,
};

use crate::testing::Random;

/// Sticks, hit where a ray is nearest to their middle line.
#[derive(Clone, Debug)]
struct Sticks {
    sticks: Arc<Vec<Capsule>>,
    tells_capsules: bool,
}

impl Procedural for Sticks {
    fn count(&self) -> u32 {
        self.sticks.len() as u32
    }

    fn bounds(&self, primitive: u32) -> Aabb {
        let Capsule { ends: [a, b], radius } = self.sticks[primitive as usize];
        let min = [0, 1, 2].map(|axis| (a[axis].min(b[axis]) - radius).next_down());
        let max = [0, 1, 2].map(|axis| (a[axis].max(b[axis]) + radius).next_up());
        Aabb { min, max }
    }

    fn capsule(&self, primitive: u32) -> Option<Capsule> {
        self.tells_capsules.then(|| self.sticks[primitive as usize])
    }

    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<ProceduralHit> {
        let Capsule { ends, radius } = self.sticks[primitive as usize];
        let [o, d, a, b] = [ray.origin, ray.direction, ends[0], ends[1]].map(|v| v.map(f64::from));
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let minus = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
        let along = |a: [f64; 3], t: f64, b: [f64; 3]| [0, 1, 2].map(|axis| a[axis] + t * b[axis]);

        // Across the ray: the parts of vectors that are perpendicular to it.
        let across = |v: [f64; 3]| along(v, -dot(v, d) / dot(d, d), d);
        let (from, way) = (across(minus(a, o)), across(minus(b, a)));
        let share = (-dot(from, way) / dot(way, way).max(1e-300)).clamp(0.0, 1.0);
        let off = along(from, share, way);
        let t = (dot(minus(along(a, share, minus(b, a)), o), d) / dot(d, d)) as f32;
        // (A little thinner than the capsule, for the rounding of all this.)
        let is_hit = dot(off, off).sqrt() < 0.999 * f64::from(radius) && t > ray.t_min && t < ray.t_max;
        is_hit.then_some(ProceduralHit { t, u: share as f32, v: 0.5 })
    }
}

/// A tuft of sticks, and instances of another one.
fn tuft(sticks: &Arc<Vec<Capsule>>, maps: &[Affine], quality: Quality, tells_capsules: bool) -> Bvh {
    let of = |sticks: &Arc<Vec<Capsule>>| {
        let mut builder = Builder::new();
        builder.procedural(Arc::new(Sticks { sticks: sticks.clone(), tells_capsules }));
        builder.quality(quality);
        builder
    };
    let object = Arc::new(of(sticks).build().unwrap());
    let mut builder = of(sticks);
    maps.iter().for_each(|map| {
        builder.instance(object.clone(), *map);
    });
    builder.build().unwrap()
}

#[test]
fn capsules_change_no_hit() {
    let mut random = Random::new(17);
    let (mut hits, mut misses) = (0, 0);
    for round in 0..24 {
        let (center, size) = (random.point_with_exponents(-3, 3), random.size(-3, 3));
        let sticks: Vec<_> = (0..400)
            .map(|number| {
                let root = random.near(center, size);
                let end = random.near(root, 0.2 * size);
                // One that no ray can hit.
                let radius = if number == 0 { f32::NAN } else { size * random.size(-4, -2) };
                Capsule { ends: [root, end], radius }
            })
            .collect();
        let sticks = Arc::new(sticks);
        let maps: Vec<_> = (0..3)
            .map(|_| {
                let mut matrix = [0; 3].map(|_| [0; 3].map(|_| f64::from(0.4 * random.unit())));
                (0..3).for_each(|axis| matrix[axis][axis] -= 0.8);
                Affine { matrix, translation: random.near(center, size).map(f64::from) }
            })
            .collect();
        let quality = [Quality::Fast, Quality::Balanced, Quality::Best][round % 3];
        let [with, without] = [true, false].map(|tells| tuft(&sticks, &maps, quality, tells));
        let (counted, all) = (with.validate().unwrap(), without.validate().unwrap());
        assert_eq!((counted.procedurals, counted.left_out), (all.procedurals, all.left_out));
        assert!(2 * counted.leaves < all.leaves && with.memory() < without.memory());

        let rays: Vec<Ray> = (0..400)
            .map(|_| {
                let origin = random.near(center, 2.0 * size);
                let target = sticks[1 + random.below(399) as usize].ends[0];
                let toward = [0, 1, 2].map(|axis| target[axis] - origin[axis]);
                let direction = if random.unit() < 0.7 { toward } else { random.direction() };
                let t_max = if random.unit() < 0.3 { 1.0 } else { f32::INFINITY };
                let t_min = if random.unit() < 0.2 { -1.0 } else { 0.0 };
                Ray { origin, t_min, direction, t_max }
            })
            .collect();
        let [mut ours, mut theirs] = [Vec::new(), Vec::new()];
        for ray in &rays {
            let closest = with.closest_hit(ray);
            assert_eq!(closest, without.closest_hit(ray), "{ray:?}");
            assert_eq!(with.occluded(ray), closest.is_hit(), "{ray:?}");
            with.query().all_hits(ray, &mut ours);
            without.query().all_hits(ray, &mut theirs);
            assert_eq!(ours, theirs, "{ray:?}");
            let double = RayF64::from(*ray);
            assert_eq!(with.query().closest_hit(&double), without.query().closest_hit(&double));
            let found = usize::from(closest.is_hit());
            (hits, misses) = (hits + found, misses + 1 - found);
        }
        let [mut ours, mut theirs] = [vec![Hit::MISS; rays.len()], vec![Hit::MISS; rays.len()]];
        with.closest_hits(&rays, &mut ours);
        without.closest_hits(&rays, &mut theirs);
        assert_eq!(ours, theirs);
    }
    assert!(hits > 3000 && misses > 1000, "{hits} hits, {misses} misses");
}
