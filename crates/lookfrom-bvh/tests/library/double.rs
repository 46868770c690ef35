//! Do rays in f64 meet what rays in f32 meet? And are they as fine as they say?

use std::sync::Arc;

use lookfrom_bvh::{
    Affine, Builder, Bvh, Hit, HitF64, NONE, Quality, Ray, RayF64, Sphere, Triangles, reference,
};

use crate::shapes::Squares;
use crate::testing::Random;

struct Soup {
    corners: Vec<[[f32; 3]; 3]>,
    spheres: Vec<Sphere>,
    squares: Vec<([f32; 3], f32)>,
}

impl Soup {
    /// Around a center; often of whole numbers, so that edges and corners are met and ties happen.
    fn random(random: &mut Random, center: [f32; 3], size: f32) -> Self {
        let whole = random.unit() < 0.5;
        let point = |random: &mut Random| match whole {
            true => center.map(|x| x + size * (random.below(5) as f32 - 2.0)),
            false => random.near(center, 2.0 * size),
        };
        let mut soup = Self { corners: Vec::new(), spheres: Vec::new(), squares: Vec::new() };
        for i in 0..60 {
            let next = [0; 3].map(|_| point(random));
            soup.corners.push(if random.below(10) == 0 && i > 0 { soup.corners[i - 1] } else { next });
        }
        for _ in 0..10 {
            soup.spheres.push(Sphere { center: point(random), radius: size });
            soup.squares.push((point(random), size));
        }
        soup
    }

    fn build(&self, quality: Quality) -> Bvh {
        let positions: Vec<[f32; 3]> = self.corners.iter().flatten().copied().collect();
        let indices: Vec<[u32; 3]> = (0..60).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mut builder = Builder::new();
        builder.quality(quality).triangles(Triangles { positions: &positions, indices: &indices });
        builder.spheres(&self.spheres);
        builder.procedural(Arc::new(Squares(self.squares.clone())));
        builder.build().unwrap()
    }
}

fn placed(bvh: Bvh, maps: &[Affine]) -> Bvh {
    let bvh = Arc::new(bvh);
    let mut builder = Builder::new();
    for map in maps {
        builder.instance(bvh.clone(), *map);
    }
    builder.build().unwrap()
}

fn ids(hit: &HitF64) -> (u32, u32, u32) {
    (hit.instance, hit.geometry, hit.primitive)
}

fn rounded(hit: &HitF64) -> Hit {
    let [t, u, v] = [hit.t, hit.u, hit.v].map(|x| x as f32);
    Hit { t, u, v, primitive: hit.primitive, geometry: hit.geometry, instance: hit.instance }
}

/// The order of hits in f32.
fn sorted(mut hits: Vec<Hit>) -> Vec<Hit> {
    hits.sort_by_key(|hit| (hit.instance.wrapping_add(1), hit.geometry, hit.primitive));
    hits.sort_by(|a, b| (a.t + 0.0).total_cmp(&(b.t + 0.0)));
    hits
}

#[test]
fn rays_that_are_numbers_of_f32_get_the_same_answers() {
    let mut random = Random::new(61);
    let (mut hits, mut misses, mut ties) = (0, 0, 0);
    for round in 0..120 {
        let size = random.size(-8, 8);
        let center = match round % 3 {
            0 => [0.0; 3],
            _ => random.point_with_exponents(-4, 3).map(|x| x * size),
        };
        let soup = Soup::random(&mut random, center, size);
        let mut bvh = soup.build([Quality::Fast, Quality::Balanced, Quality::Best][round % 3]);
        if round % 4 == 3 {
            let maps: Vec<Affine> = (0..3)
                .map(|_| {
                    let mut matrix = [0; 3].map(|_| [0; 3].map(|_| f64::from(0.5 * random.unit())));
                    (0..3).for_each(|i| matrix[i][i] -= 1.5);
                    Affine { matrix, translation: random.near([0.0; 3], size).map(f64::from) }
                })
                .collect();
            bvh = placed(bvh, &maps);
        }
        let whole = random.unit() < 0.5;
        let (mut all, mut all64) = (Vec::new(), Vec::<HitF64>::new());
        for _ in 0..200 {
            let bounds = bvh.bounds();
            let target = [0, 1, 2].map(|i| bounds.min[i] + random.unit() * (bounds.max[i] - bounds.min[i]));
            let from = match whole {
                true => center.map(|x| x + size * (random.below(9) as f32 - 4.0)),
                false => random.near(target, size * 3.0),
            };
            let stretch = random.size(-8, 8) / size;
            let toward = if whole { center } else { target };
            let mut ray = Ray::new(from, [0, 1, 2].map(|i| (toward[i] - from[i]) * stretch));
            if random.below(4) == 0 {
                ray.direction = random.direction();
            }
            match random.below(5) {
                0 => ray.t_max = random.size(-2, 2) / stretch,
                1 => ray.t_min = -random.size(-2, 2) / stretch,
                2 => ray.t_min = random.size(-2, 0) / stretch,
                _ => {}
            }
            bvh.query().all_hits(&ray, &mut all);
            bvh.query().all_hits(&RayF64::from(ray), &mut all64);
            assert!(all64.is_sorted_by(|a, b| a.t <= b.t));
            // What f32 rounds to an end of the range is not in it.
            all64.retain(|hit| hit.t as f32 > ray.t_min && (hit.t as f32) < ray.t_max);
            // Both roots of a sphere that are one in f32 are one hit there.
            let mut expected = sorted(all64.iter().map(rounded).collect());
            expected.dedup_by(|a, b| a == b && a.geometry == 1);
            assert_eq!(all, expected, "{ray:?}");

            let (closest, closest64) = (bvh.closest_hit(&ray), bvh.query().closest_hit(&RayF64::from(ray)));
            assert_eq!(bvh.query().occluded(&RayF64::from(ray)), closest64.is_hit());
            let at_an_end = !(closest64.t as f32 > ray.t_min && (closest64.t as f32) < ray.t_max);
            if closest64.is_hit() && at_an_end {
                continue;
            }
            assert_eq!(closest64, all64.first().copied().unwrap_or(HitF64::MISS), "{ray:?}");
            assert_eq!(closest.t, closest64.t as f32);
            if closest != rounded(&closest64) {
                assert!(closest64.is_hit() && all.contains(&rounded(&closest64)), "{ray:?}");
                ties += 1;
            }
            hits += usize::from(closest.is_hit());
            misses += usize::from(!closest.is_hit());
        }
    }
    assert!(hits > 5000 && misses > 3000 && ties < hits / 10, "{hits} hits, {misses} misses, {ties} ties");
}

#[test]
fn rays_in_f64_agree_with_the_reference() {
    // Far away and close together, where f32 could not even say where the rays start.
    let mut random = Random::new(62);
    let (mut hits, mut misses) = (0, 0);
    for _ in 0..3000 {
        let size = random.size(-6, 6);
        let center = random.point_with_exponents(-2, 3).map(|x| x * size);
        let corners = [0; 3].map(|_| random.near(center, size));
        let ball = Sphere { center: random.near(center, size), radius: 0.3 * size };
        let mut builder = Builder::new();
        builder.triangles(Triangles { positions: &corners, indices: &[[0, 1, 2]] });
        builder.spheres(&[ball]);
        let bvh = builder.build().unwrap();
        let wide = |p: [f32; 3]| p.map(f64::from);
        let shapes = [
            reference::Shape::Triangle(corners.map(wide)),
            reference::Shape::Sphere(wide(ball.center), f64::from(ball.radius)),
        ];
        let mut found = Vec::new();
        for _ in 0..10 {
            let fine = |random: &mut Random, p: [f32; 3], size: f32| {
                p.map(|x| f64::from(x) + f64::from(size) * (f64::from(random.unit()) - 0.5 + 1e-9 / 3.0))
            };
            let (a, b) = (fine(&mut random, center, 8.0 * size), fine(&mut random, center, 2.0 * size));
            let d = [0, 1, 2].map(|i| (b[i] - a[i]) / 3.0);
            bvh.query().all_hits(&RayF64::new(a, d), &mut found);
            let expected = reference::all(&shapes, a, d, 0.0, f64::INFINITY);
            // The nearest of each, as the reference gives them.
            found.sort_by_key(|hit| hit.geometry);
            found.dedup_by_key(|hit| hit.geometry);
            let shapes_found: Vec<usize> = found.iter().map(|hit| hit.geometry as usize).collect();
            let shapes_expected: Vec<usize> = expected.iter().map(|&(shape, _)| shape).collect();
            assert_eq!(shapes_found, shapes_expected, "{a:?} {d:?}");
            for (hit, (_, t)) in found.iter().zip(&expected) {
                // Grazing hits of the reference have errors of their own.
                assert!((hit.t - t).abs() < 1e-9 * t.abs().max(1.0), "{hit:?} {t}");
                assert_eq!((hit.instance, hit.primitive), (NONE, 0));
            }
            hits += found.len();
            misses += usize::from(found.is_empty());
        }
    }
    assert!(hits > 3000 && misses > 5000, "{hits} hits, {misses} misses");
}

#[test]
fn finer_than_f32() {
    // Two walls closer than f32 can tell from where the ray starts; the lower ids are behind.
    let wall = |z: f32| [[-1.0, -1.0, z], [1.0, -1.0, z], [0.0, 1.0, z]];
    let positions = [wall(f32::EPSILON), wall(0.0)].concat();
    let mut builder = Builder::new();
    builder.triangles(Triangles { positions: &positions, indices: &[[0, 1, 2], [3, 4, 5]] });
    let bvh = builder.build().unwrap();
    let ray = Ray::new([0.0, 0.0, -100.0], [0.0, 0.0, 1.0]);
    let hit = bvh.query().closest_hit(&RayF64::from(ray));
    assert_eq!((ids(&hit), hit.t), ((NONE, 0, 1), 100.0));
    assert_eq!(bvh.closest_hit(&ray).primitive, 0, "a tie in f32");
    assert!(!bvh.query().occluded(&RayF64 { t_max: 100.0, ..ray.into() }));
    assert!(bvh.query().occluded(&RayF64 { t_max: 100.000_000_000_001, ..ray.into() }));
    // Between the two.
    let between = RayF64 { t_min: 100.0 + 1e-9, t_max: 100.0 + 1e-7, ..ray.into() };
    assert_eq!(bvh.query().closest_hit(&between), HitF64::MISS);
}

#[test]
fn what_cannot_be_traced_misses() {
    let mut builder = Builder::new();
    builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    let bvh = builder.build().unwrap();
    let good = RayF64::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
    assert!(bvh.query().occluded(&good));
    for bad in [
        RayF64 { origin: [f64::NAN, 0.0, 3.0], ..good },
        RayF64 { origin: [0.0, 0.0, 1e300], ..good },
        RayF64 { direction: [0.0, -0.0, 0.0], ..good },
        RayF64 { direction: [0.0, 0.0, -1e-60], ..good },
        RayF64 { direction: [0.0, f64::INFINITY, -1.0], ..good },
        RayF64 { t_max: f64::NAN, ..good },
        RayF64 { t_min: 2.0, t_max: 1.0, ..good },
    ] {
        assert!(!bvh.query().occluded(&bad) && !bvh.query().closest_hit(&bad).is_hit(), "{bad:?}");
    }
    assert_eq!(Bvh::default().query().closest_hit(&good), HitF64::MISS);
    let scene = placed(bvh, &[Affine { translation: [0.5, 0.0, 0.0], ..Affine::IDENTITY }]);
    assert_eq!(ids(&scene.query().closest_hit(&good)), (0, 0, 0));
}
