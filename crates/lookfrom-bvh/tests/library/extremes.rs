//! Sizes and distances up to 10³² apart: do trees still answer as their primitives do, one by one?
//!
//! `LOOKFROM_ROUNDS=2000 cargo test --release -p lookfrom-bvh extremes` tries more. (Beyond 2¹²⁰ the f32 reciprocals of the box test leave
//! their range: of 600 000 rays among exponents of 10 up to ±20, one was answered otherwise by one tree than by another.)

use lookfrom_bvh::{Builder, Bvh, Hit, Quality, Ray, RayF64, Sphere, Triangles};

use crate::testing::Random;

type Corners = [[f32; 3]; 3];

fn tree(corners: &[Corners], spheres: &[Sphere], quality: Quality) -> Bvh {
    let positions: Vec<[f32; 3]> = corners.iter().flatten().copied().collect();
    let indices: Vec<[u32; 3]> = (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mut builder = Builder::new();
    builder.quality(quality).triangles(Triangles { positions: &positions, indices: &indices });
    builder.spheres(spheres);
    builder.build().unwrap()
}

/// How many of some rays are answered otherwise by a tree of all than by trees of one primitive each.
fn disagreements(corners: &[Corners], spheres: &[Sphere], rays: &[Ray]) -> usize {
    let trees =
        [Quality::Fast, Quality::Balanced, Quality::Best].map(|quality| tree(corners, spheres, quality));
    let triangles = corners.iter().map(|&corners| tree(&[corners], &[], Quality::Fast));
    let single: Vec<Bvh> =
        triangles.chain(spheres.iter().map(|&sphere| tree(&[], &[sphere], Quality::Fast))).collect();
    let (mut all, mut some) = (Vec::new(), Vec::new());
    let mut wrong = 0;
    for ray in rays {
        all.clear();
        for (number, bvh) in single.iter().enumerate() {
            let ids = match number.checked_sub(corners.len()) {
                None => (0, number),
                Some(sphere) => (1, sphere),
            };
            bvh.query().all_hits(ray, &mut some);
            all.extend(some.iter().map(|hit| Hit { geometry: ids.0, primitive: ids.1 as u32, ..*hit }));
        }
        all.sort_by(|a, b| {
            (a.t + 0.0)
                .total_cmp(&(b.t + 0.0))
                .then((a.geometry, a.primitive).cmp(&(b.geometry, b.primitive)))
        });
        let nearest = all.first().copied().unwrap_or(Hit::MISS);
        for bvh in &trees {
            bvh.query().all_hits(ray, &mut some);
            let same =
                some == all && bvh.closest_hit(ray) == nearest && bvh.occluded(ray) == nearest.is_hit();
            wrong += usize::from(!same);
        }
    }
    wrong
}

fn rounds() -> u32 {
    std::env::var("LOOKFROM_ROUNDS").ok().and_then(|text| text.parse().ok()).unwrap_or(20)
}

#[test]
fn sizes_and_distances_far_apart() {
    let mut random = Random::new(71);
    for range in [6, 12, 16] {
        for _ in 0..rounds() {
            let mut corners: Vec<Corners> = Vec::new();
            for _ in 0..60 {
                let center = match random.below(2) {
                    0 => [0.0; 3],
                    _ => random.point_with_exponents(-range, range),
                };
                let size = random.size(-range, range);
                corners.push(match random.below(3) {
                    0 => [0; 3].map(|_| random.point_with_exponents(-range, range)),
                    _ => [0; 3].map(|_| random.near(center, size)),
                });
            }
            let spheres: Vec<Sphere> = (0..20)
                .map(|_| Sphere {
                    center: random.point_with_exponents(-range, range),
                    radius: random.size(-range, range),
                })
                .collect();
            let mut rays = Vec::new();
            for _ in 0..300 {
                let number = random.below(60) as usize;
                let target = match random.below(3) {
                    0 => spheres[number % 20].center,
                    _ => random.on_triangle(&corners[number]),
                };
                let origin = random.point_with_exponents(-range, range);
                let mut ray = Ray::new(origin, [0, 1, 2].map(|i| target[i] - origin[i]));
                match random.below(4) {
                    0 => ray.direction = random.point_with_exponents(-range, range),
                    1 => ray.t_min = -random.size(-range, range),
                    _ => {}
                }
                rays.push(ray);
            }
            assert_eq!(disagreements(&corners, &spheres, &rays), 0, "exponents up to {range}");
        }
    }
}

#[test]
fn noise_does_not_depend_on_the_tree() {
    // So far away that f64 itself cannot tell the primitives' sizes, along directions that hardly lean.
    let mut random = Random::new(72);
    let mut bad = 0;
    for _ in 0..10 * rounds() {
        let distance = random.size(11, 18);
        let number = |random: &mut Random| random.size(-2, 2) * if random.below(2) == 0 { 1.0 } else { -1.0 };
        let mut corners: Vec<Corners> = Vec::new();
        let mut spheres: Vec<Sphere> = Vec::new();
        for _ in 0..12 {
            let center = [0; 3].map(|_| number(&mut random));
            let size = random.size(-3, 0);
            corners.push([0; 3].map(|_| random.near(center, size)));
            spheres.push(Sphere { center, radius: size });
        }
        let mut rays = Vec::new();
        for _ in 0..100 {
            let target = match random.below(2) {
                0 => {
                    let number = random.below(12) as usize;
                    random.on_triangle(&corners[number])
                }
                _ => {
                    let sphere = spheres[random.below(12) as usize];
                    random.near(sphere.center, 1.2 * sphere.radius)
                }
            };
            let mut lean = [0; 3].map(|_| random.size(-20, 0));
            lean[random.below(3) as usize] = 1.0;
            let direction = lean.map(|x| if random.below(2) == 0 { x } else { -x });
            let origin = [0, 1, 2].map(|i| target[i] - distance * direction[i]);
            let stretch = if random.below(2) == 0 { 1.0 } else { distance };
            rays.push(Ray::new(origin, direction.map(|x| x * stretch)));
        }
        bad += disagreements(&corners, &spheres, &rays);
    }
    assert_eq!(bad, 0);
}

/// Rays at the middles of triangles, in scenes as small as what products lose by underflow: single precision has the answers of double.
#[test]
fn the_smallest_scenes_are_hit_as_in_double_precision() {
    let mut random = Random::new(73);
    for exponent in 9..21 {
        let scale = 0.1_f32.powi(exponent);
        for _ in 0..rounds() {
            let corners: Vec<Corners> = (0..20)
                .map(|_| {
                    let center = random.near([0.0; 3], scale);
                    [0; 3].map(|_| random.near(center, 0.5 * scale))
                })
                .collect();
            let bvh = tree(&corners, &[], Quality::Balanced);
            let rays: Vec<Ray> = (0..200)
                .map(|_| {
                    let [a, b, c] = corners[random.below(20) as usize];
                    let origin = random.near([0.0; 3], 2.0 * scale);
                    Ray::new(origin, [0, 1, 2].map(|axis| (a[axis] + b[axis] + c[axis]) / 3.0 - origin[axis]))
                })
                .collect();
            let mut batch = vec![Hit::MISS; rays.len()];
            bvh.closest_hits(&rays, &mut batch);
            for (ray, batch) in rays.iter().zip(batch) {
                let (hit, exact) = (bvh.closest_hit(ray), bvh.query().closest_hit(&RayF64::from(*ray)));
                assert_eq!((hit.is_hit(), hit), (exact.is_hit(), batch), "10^-{exponent}: {exact:?}");
                let off = (f64::from(hit.t) - exact.t).abs();
                assert!(!hit.is_hit() || off < 1e-5 * exact.t, "10^-{exponent}: {hit:?} {exact:?}");
            }
        }
    }
}
