//! Packets against single rays, for every query, at every SIMD level.

use std::sync::Arc;

use super::*;
use crate::collector::AnyHit;
use crate::dispatch::{dispatch, levels};
use crate::origin_primitive::OriginPrimitive;
use crate::ray::NONE;
use crate::stack::with_stack;
use crate::testing::Random;
use crate::visibility::Everything;
use crate::{Aabb, Affine, Builder, Faces, Procedural, ProceduralHit, Query, Sphere, Triangles};
use lookfrom_simd::Kernel;

/// Neighbouring rays toward a target, from one origin or several around a point; some have an end, some are invalid or
/// unusual.
fn neighbours(random: &mut Random, from: [f32; 3], target: [f32; 3], size: f32) -> Vec<Ray> {
    let (lens, opening) = (random.unit() < 0.3, size * random.size(-3, 0));
    let ends = random.unit() < 0.3;
    let odd = random.unit() < 0.1;
    let mut ray = |number: u32| {
        let origin = if lens { random.near(from, 0.01 * size) } else { from };
        let towards = random.near(target, opening);
        let direction = [0, 1, 2].map(|axis| towards[axis] - origin[axis]);
        let t_max = if ends { 2.0 * random.unit() } else { f32::INFINITY };
        let t_min = if odd && number == 17 { f32::NAN } else { 0.0 };
        Ray { origin, t_min, direction, t_max }
    };
    (0..150).map(&mut ray).collect()
}

#[test]
fn packets_say_what_single_rays_say() {
    let mut random = Random::new(9);
    let (mut hits, mut misses) = (0, 0);
    for _ in 0..60 {
        let (center, size) = (random.point_with_exponents(-6, 6), random.size(-6, 6));
        let mut positions: Vec<[f32; 3]> = (0..600).map(|_| random.near(center, size)).collect();
        // Repeated corners make degenerate and duplicate triangles.
        for corner in 1..60 {
            positions[10 * corner] = positions[corner];
        }
        let mut indices: Vec<[u32; 3]> = (0..300).map(|_| [0; 3].map(|_| random.below(600))).collect();
        indices.extend_from_within(..30);
        let mut builder = Builder::new();
        builder.triangles(Triangles { positions: &positions, indices: &indices });
        let mut bvh = builder.build().unwrap();
        for _ in 0..10 {
            let target = positions[random.below(600) as usize];
            // Some start in the planes of triangles.
            let from = match random.below(5) {
                0 => positions[random.below(600) as usize],
                _ => random.near(target, 4.0 * size),
            };
            let rays = neighbours(&mut random, from, target, size);
            for level in levels() {
                bvh.level = level;
                let mut together = vec![Hit::MISS; rays.len()];
                bvh.closest_hits(&rays, &mut together);
                for (ray, hit) in rays.iter().zip(&together) {
                    assert_eq!(*hit, bvh.closest_hit(ray), "{ray:?}");
                }
                let hit = together.iter().filter(|hit| hit.is_hit()).count();
                hits += hit;
                misses += rays.len() - hit;
            }
        }
    }
    assert!(hits > 10_000 && misses > 10_000, "{hits} hits, {misses} misses");
}

#[test]
fn rays_that_end_at_triangles_are_occluded_as_one_by_one() {
    let mut random = Random::new(31);
    let (mut blocked, mut open) = (0, 0);
    for round in 0..60 {
        let (center, size) = (random.point_with_exponents(-6, 6), random.size(-6, 6));
        // Few triangles are tested at once, more are in a tree.
        let count = if round % 2 == 0 { 20 } else { 200 };
        let positions: Vec<[f32; 3]> = (0..3 * count).map(|_| random.near(center, size)).collect();
        let indices: Vec<[u32; 3]> = (0..count).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
        let mut builder = Builder::new();
        builder.triangles(Triangles { positions: &positions, indices: &indices });
        let mut bvh = builder.build().unwrap();
        for _ in 0..5 {
            let (from, target) = (random.near(center, 2.0 * size), random.below(count) as usize);
            // From near a point to points of a triangle, where rounding decides whether they hit it.
            let rays: Vec<Ray> = (0..150)
                .map(|_| {
                    let origin = random.near(from, 0.01 * size);
                    let (u, v) = (random.unit(), random.unit());
                    let [u, v] = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] };
                    let [a, b, c] = indices[target].map(|vertex| positions[vertex as usize]);
                    let direction =
                        [0, 1, 2].map(|k| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]) - origin[k]);
                    let end = [1.0_f32, 1.0_f32.next_down(), 1.0_f32.next_up(), 0.999_999];
                    Ray { t_max: end[random.below(4) as usize], ..Ray::new(origin, direction) }
                })
                .collect();
            for level in levels() {
                bvh.level = level;
                let mut together = vec![false; rays.len()];
                let query = match round % 3 {
                    0 => bvh.query(),
                    _ => bvh.query().origin(OriginPrimitive { instance: NONE, geometry: 0, primitive: 7 }),
                };
                query.occluded_many(&rays, &mut together);
                for (ray, occluded) in rays.iter().zip(&together) {
                    assert_eq!(*occluded, query.occluded(ray), "{ray:?}");
                }
                let occluded = together.iter().filter(|occluded| **occluded).count();
                blocked += occluded;
                open += rays.len() - occluded;
            }
        }
    }
    assert!(blocked > 10_000 && open > 5_000, "{blocked} occluded, {open} not");
}

/// Boxes whose floors are hit by rays.
#[derive(Debug)]
struct Floors(Vec<Aabb>);

impl Procedural for Floors {
    fn count(&self) -> u32 {
        self.0.len() as u32
    }
    fn bounds(&self, primitive: u32) -> Aabb {
        self.0[primitive as usize]
    }
    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<ProceduralHit> {
        let Aabb { min, max } = self.0[primitive as usize];
        let t = (min[2] - ray.origin[2]) / ray.direction[2];
        let margin = [0, 1].map(|i| 1e-3 * (max[i] - min[i]));
        let inside = (0..2).all(|i| {
            let x = ray.origin[i] + t * ray.direction[i];
            min[i] + margin[i] < x && x < max[i] - margin[i]
        });
        (inside && ray.t_min < t && t < ray.t_max).then_some(ProceduralHit { t, u: 0.5, v: 0.25 })
    }
}

/// Triangles, spheres, procedural shapes and instances of these, with masks; `counts` is the number of each kind.
fn mixture(random: &mut Random, center: [f32; 3], size: f32, counts: [u32; 4]) -> Bvh {
    let [triangles, spheres, floors, instances] = counts;
    let point = |random: &mut Random| random.near(center, size);
    let positions: Vec<[f32; 3]> = (0..3 * triangles).map(|_| point(random)).collect();
    let indices: Vec<[u32; 3]> = (0..triangles).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mut balls = Vec::new();
    for _ in 0..spheres {
        balls.push(Sphere { center: point(random), radius: 0.2 * size * random.unit() });
    }
    let mut boxes = Vec::new();
    for _ in 0..floors {
        boxes.push(Aabb::around(&[point(random), point(random)]));
    }
    let mut builder = Builder::new();
    builder.triangles(Triangles { positions: &positions, indices: &indices });
    builder.spheres(&balls);
    builder.procedural(Arc::new(Floors(boxes)));
    for geometry in 0..3 {
        builder.geometry_mask(geometry, random.below(16) | 1);
    }
    let masks: Vec<u32> = (0..triangles).map(|_| random.below(16)).collect();
    builder.primitive_masks(0, &masks);
    if instances > 0 {
        let object = Arc::new(mixture(random, [0.0; 3], size, [40, 3, 2, 0]));
        for _ in 0..instances {
            let mut matrix = [0; 3].map(|_| [0; 3].map(|_| f64::from(0.4 * random.unit())));
            (0..3).for_each(|axis| matrix[axis][axis] -= 0.8);
            let translation = point(random).map(f64::from);
            let instance = builder.instance(object.clone(), Affine { matrix, translation });
            builder.instance_mask(instance, random.below(16));
        }
    }
    builder.build().unwrap()
}

/// True if the rays are traced as a packet.
struct GoTogether<'a>(&'a Bvh, &'a [Ray]);

impl Kernel for GoTogether<'_> {
    type Output = bool;
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> bool {
        let settings = Settings::new(self.0);
        with_stack(|stack| {
            trace_packet::<S, AnyHit, Everything>(
                simd,
                &settings,
                self.1,
                &mut [],
                &mut Coherence::default(),
                stack,
            )
            .is_some()
        })
    }
}

#[test]
fn packets_of_every_query_say_what_single_rays_say() {
    let mut random = Random::new(10);
    let (mut hits, mut misses, mut packets, mut excluded) = (0, 0, 0, 0);
    for round in 0..72 {
        let (center, size) = (random.point_with_exponents(-6, 6), random.size(-6, 6));
        // The last ones are so few that any rays form packets.
        let counts = [
            [300, 0, 0, 0],
            [200, 1, 0, 0],
            [100, 20, 20, 0],
            [60, 5, 5, 4],
            [0, 0, 0, 6],
            [2, 3, 0, 0],
            [12, 4, 0, 0],
            [36, 0, 0, 0],
            [30, 4, 0, 0],
        ][round % 9];
        let mut bvh = mixture(&mut random, center, size, counts);
        for _ in 0..6 {
            let target = random.near(center, size);
            let from = random.near(target, 4.0 * size);
            let mut rays = neighbours(&mut random, from, target, size);
            if random.unit() < 0.3 {
                for ray in &mut rays {
                    (ray.origin, ray.direction) = (random.near(center, 2.0 * size), random.direction());
                }
            }
            let faces = [Faces::Both, Faces::Front, Faces::Back][random.below(3) as usize];
            let mask = 1 << random.below(4);
            // Exclude the triangle that is hit first, so that the exclusion has an effect.
            let origins: Vec<OriginPrimitive> = rays
                .iter()
                .map(|ray| match random.below(3) {
                    0 => OriginPrimitive::NONE,
                    _ => OriginPrimitive::of(&bvh.closest_hit(ray)),
                })
                .collect();
            let kind = random.below(6);
            for level in levels() {
                bvh.level = level;
                packets += usize::from(dispatch(level, GoTogether(&bvh, &rays[..RAYS])));
                let query: Query<'_> = match kind {
                    0 => bvh.query(),
                    1 => bvh.query().mask(mask),
                    2 => bvh.query().faces(faces),
                    3 => bvh.query().mask(mask).faces(faces).origins(&origins),
                    _ => bvh.query().origins(&origins),
                };
                let mut together = vec![Hit::MISS; rays.len()];
                query.closest_hits(&rays, &mut together);
                let mut occluded = vec![false; rays.len()];
                query.occluded_many(&rays, &mut occluded);
                for (number, ray) in rays.iter().enumerate() {
                    let origin = if kind < 3 { OriginPrimitive::NONE } else { origins[number] };
                    let alone = query.origins(&[]).origin(origin);
                    let hit = alone.closest_hit(ray);
                    assert_eq!(together[number], hit, "{kind} {ray:?}");
                    assert_eq!(occluded[number], hit.is_hit(), "{kind} {ray:?}");
                    assert_eq!(alone.occluded(ray), hit.is_hit(), "{kind} {ray:?}");
                    // All hits, without those on the origin primitive.
                    let (mut all, mut expected) = (Vec::new(), Vec::new());
                    alone.all_hits(ray, &mut all);
                    alone.origin(OriginPrimitive::NONE).all_hits(ray, &mut expected);
                    let before = expected.len();
                    expected.retain(|hit| hit.geometry != 0 || OriginPrimitive::of(hit) != origin);
                    excluded += before - expected.len();
                    assert_eq!(all, expected, "{kind} {ray:?}");
                    assert_eq!(all.first().copied().unwrap_or(Hit::MISS), hit, "{kind} {ray:?}");
                    hits += usize::from(hit.is_hit());
                    misses += usize::from(!hit.is_hit());
                }
            }
        }
    }
    assert!(hits > 10_000 && misses > 10_000, "{hits} hits, {misses} misses");
    assert!(packets > 300 && excluded > 5000, "{packets} packets, {excluded} hits excluded");
}

#[test]
fn few_spheres_are_hit_by_any_number_of_rays_as_one_by_one() {
    let mut random = Random::new(47);
    let (mut hits, mut misses) = (0, 0);
    for _ in 0..300 {
        let (center, size) = (random.point_with_exponents(-6, 6), random.size(-6, 6));
        let count = 1 + random.below(12);
        let spheres: Vec<Sphere> = (0..count)
            .map(|_| Sphere { center: random.near(center, size), radius: size * random.size(-4, 0) })
            .collect();
        let mut builder = Builder::new();
        builder.spheres(&spheres);
        let mut bvh = builder.build().unwrap();
        let ray_count = 1 + random.below(150);
        let ray = |_| {
            let Sphere { center: c, radius } = spheres[random.below(count) as usize];
            // Some start on a sphere or inside, some touch one or pass it closely.
            let from = match random.below(3) {
                0 => c,
                1 => [c[0] + radius, c[1], c[2]],
                _ => random.near(center, 4.0 * size),
            };
            let beside = radius * [0.0, 0.5, 0.999_999, 1.0, 1.000_001][random.below(5) as usize];
            let toward = [c[0] - from[0], c[1] + beside - from[1], c[2] - from[2]];
            let direction = if random.unit() < 0.8 { toward } else { random.direction() };
            let t_max = if random.unit() < 0.3 { 1.0 } else { f32::INFINITY };
            Ray { t_max, ..Ray::new(from, direction) }
        };
        let rays: Vec<Ray> = (0..ray_count).map(ray).collect();
        for level in levels() {
            bvh.level = level;
            let (mut together, mut occluded) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
            bvh.closest_hits(&rays, &mut together);
            bvh.query().occluded_many(&rays, &mut occluded);
            for ((ray, hit), occluded) in rays.iter().zip(&together).zip(&occluded) {
                assert_eq!(*hit, bvh.closest_hit(ray), "{ray:?}");
                assert_eq!(*occluded, hit.is_hit(), "{ray:?}");
            }
            let hit = together.iter().filter(|hit| hit.is_hit()).count();
            hits += hit;
            misses += rays.len() - hit;
        }
    }
    assert!(hits > 10_000 && misses > 5_000, "{hits} hits, {misses} misses");
}
